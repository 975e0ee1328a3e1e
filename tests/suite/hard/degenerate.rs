//! Faces of zero or nearly zero area.

use umbrage::caster::ShellProof;
use umbrage::facing::CasterFaces;
use umbrage::mesh::{Mesh, Weld, weld};
use umbrage::shadow::volume::ShellFaces;
use umbrage::testing::shapes;

use super::figures::*;

/// Guards against normals of length zero: a collinear face is edge-on to every light, and still connects its
/// edges.
#[test]
fn hard_06_degenerate_collinear_face_carries_the_edges_beside_it() {
    let mesh = shapes::collinear_face();
    let c = counts(&mesh);
    assert_eq!((c.zero_area_faces, c.watertight, c.boundary_edges, c.signed_volume), (1, true, 0, 8.0));
    let light = point(3.0, 5.0, 7.0);
    // The cube's hexagon, except that the edge with the flat face counts as three edges of multiplicity 1.
    expect_figures(&[(&mesh, light, ([7, 6, 1], 8, 5 * 2 + 3))]);
    expect_crossings(&mesh, &light, &[([-3.0, -5.0, -7.25], 2), ([0.1, 0.2, 0.3], 1)]);
    // Lights along the flat face, from its ends, and from within the face.
    for light in
        [light, point(-9.0, -1.0, 1.0), point(0.0, -1.0, 1.0), point(-1.0, -1.0, 1.0), sun(1.0, 0.0, 0.0)]
    {
        assert!(figures(&mesh, &light).0[2] > 0);
        expect_agreement(&mesh, &light);
    }
    let (topology, shells) = (topology(&mesh), topology(&mesh).shells());
    let proofs = ShellProof::of(&mesh, &topology, &shells);
    assert_eq!(proofs, [ShellProof::ZeroAreaFace]);
    let plan = ShellFaces::choose(&mesh, &shells, &proofs, &light, None);
    assert_eq!(plan.choices[0].to_string(), "a face of the shell has no area");
    // Negative test: a cube without the flat face has the hexagon alone.
    assert_ne!(figures(&shapes::cube(), &light), figures(&mesh, &light));
}

/// Guards against dropping collapsed faces before their neighbors are joined, and against keeping them.
#[test]
fn hard_06_degenerate_poles_collapse_when_welded_and_the_rest_closes() {
    for (segments, rings) in [(3_u32, 1_u32), (8, 3), (13, 5)] {
        let (s, r) = (segments as usize, rings as usize);
        let capsule = shapes::uv_capsule(segments, rings, 1.0, 2.0);
        let open = counts(&capsule);
        assert!(open.boundary_edges > 0 && open.collapsed_faces == 0);
        assert_eq!(open.zero_area_faces, 2 * s, "each pole is so many vertices at one place");
        let welded = weld(&capsule, Weld::Exact).mesh;
        let c = counts(&welded);
        assert_eq!(
            (welded.vertex_count(), c.faces, c.collapsed_faces),
            (2 * r * s + 2, 2 * s * (2 * r + 1), 2 * s)
        );
        // Three half-edges per remaining face, two per edge.
        assert_eq!((c.edges, c.euler_characteristic, c.sound()), (3 * (4 * s * r) / 2, 2, true));
        let light = point(0.3, 0.2, 9.0);
        let (_, loops) = (
            figures(&welded, &light),
            cast(&welded, &light, CasterFaces::All).0.loops(&topology(&welded)).len(),
        );
        assert_eq!(loops, 1);
        for mesh in [&capsule, &welded] {
            expect_crossings(
                mesh,
                &light,
                &[([0.1, 0.05, -9.0], 2), ([0.1, 0.05, 0.2], 1), ([5.0, 0.1, 0.2], 0)],
            );
            expect_agreement(mesh, &light);
        }
    }
}

/// A sliver tetrahedron of this height.
fn sliver(height: f32) -> Mesh {
    let (mut positions, triangles, ..) = shapes::sliver().into_parts();
    positions[2][1] = height;
    Mesh::new(positions, triangles).unwrap().with_name(format!("a sliver of height {height:e}"))
}

/// Guards against an epsilon on the area or on the plane: three sides of the sliver nearly coincide, and each
/// counts.
#[test]
fn hard_06_degenerate_slivers_have_an_inside() {
    for height in [1e-7, 2.0_f32.powi(-40), 1e-30, f32::MIN_POSITIVE, f32::from_bits(64)] {
        let mesh = sliver(height);
        let c = counts(&mesh);
        assert_eq!((c.sound(), c.zero_area_faces, c.collapsed_faces), (true, 0, 0), "{}", mesh.name);
        let light = point(0.25, -3.0, 0.3);
        // The flat side at y = 0 is front-facing, the other three are back-facing.
        expect_figures(&[(&mesh, light, ([1, 3, 0], 3, 6))]);
        // Points inside, just outside, and far behind.
        let inside = [0.0, height / 8.0, 0.125];
        expect_crossings(
            &mesh,
            &light,
            &[(inside, 1), ([0.0, height * 2.0, 0.125], 2), ([0.1, 3.0, 0.2], 2), ([0.0, -height, 0.125], 0)],
        );
        expect_agreement(&mesh, &light);
        expect_agreement(&mesh, &point(0.25, height / 2.0, 0.3));
        // Negative test: a completely flat one has no inside, and its floor no area.
        let flat = sliver(0.0);
        assert_eq!((counts(&flat).zero_area_faces, counts(&flat).sound()), (1, true));
        assert_eq!(winding(&mesh, &light, CasterFaces::All, inside), Some(1));
        assert_ne!(winding(&flat, &light, CasterFaces::All, inside), Some(1));
    }
}
