//! Inconsistent windings, and transforms that reverse windings.

use umbrage::check::DefectKind;
use umbrage::facing::{CasterFaces, classify};
use umbrage::glam::{Mat4, Vec3};
use umbrage::mesh::Mesh;
use umbrage::scene::{Instance, Scene, Scope};
use umbrage::silhouette::Silhouette;
use umbrage::testing::shapes;

use super::figures::*;

/// Guards against pairing half-edges by direction, which finds a boundary where a strip closes with a twist.
#[test]
fn hard_05_orientation_of_a_moebius_strip_has_one_seam_and_no_false_border() {
    for segments in [3, 24] {
        let (strip, n) = (shapes::mobius(segments), segments as usize);
        let c = counts(&strip);
        assert_eq!((c.boundary_edges, c.boundary_loops, c.misoriented_edges), (2 * n, 1, 1));
        assert_eq!((c.euler_characteristic, c.shells, c.watertight, c.balanced), (0, 1, false, false));
    }
    let strip = shapes::mobius(24);
    let topology = topology(&strip);
    // At the seam the strip lies flat: its faces have opposite orientations, and there is no outline.
    let light = point(0.9, 0.05, 7.0);
    let seam = topology.edges().find(|&edge| topology.is_misoriented(edge)).unwrap();
    let facing = classify(&strip, &light);
    let beside: Vec<i8> = topology.uses(seam).map(|(face, _)| facing[face.index()].sign()).collect();
    assert_eq!(beside[0] * beside[1], -1, "{beside:?}");
    let outline = |casters: CasterFaces| {
        let silhouette = Silhouette::extract(&topology, &casters.signs(&facing));
        silhouette.edges.iter().any(|edge| edge.edge == seam)
    };
    assert!(!outline(CasterFaces::All));
    for side in [1.0, -1.0] {
        let light = point(0.9, 0.05, 7.0 * side);
        expect_crossings(&strip, &light, &[([0.9, 0.05, -7.0 * side], 1), ([-0.7, 0.05, -7.0 * side], 0)]);
        expect_agreement(&strip, &light);
    }
    // Negative test: with front faces alone the seam is a false boundary, and half the strip casts nothing.
    assert!(outline(CasterFaces::Front));
}

/// Guards against any use of the winding alone: with a winding a face's facing is reversed too, and the
/// volume is unchanged.
#[test]
fn hard_05_orientation_of_any_faces_leaves_the_volume_as_it_was() {
    let cube = shapes::cube();
    for light in [point(3.0, 5.0, 7.0), point(0.1, 0.2, 0.3), point(1.0, 0.5, 4.0), sun(0.0, -1.0, 0.0)] {
        let expected = shadow(&cube, &light);
        let mut differ = 0;
        // All combinations of windings of the twelve faces.
        for turned in 0..1_u32 << 12 {
            let (positions, mut triangles, ..) = cube.clone().into_parts();
            for (face, triangle) in triangles.iter_mut().enumerate() {
                if turned >> face & 1 == 1 {
                    triangle.swap(1, 2);
                }
            }
            let mesh = Mesh::new(positions, triangles).unwrap();
            let volume = shadow(&mesh, &light);
            assert_eq!(volume.triangles().len(), expected.triangles().len(), "{turned:b}");
            assert_eq!(
                volume.triangles()[volume.sides()],
                expected.triangles()[expected.sides()],
                "{turned:b}"
            );
            assert!(volume.boundary_sum().is_closed());
            // Negative test: front faces alone depend on the windings of all but edge-on faces.
            let front = cast(&mesh, &light, CasterFaces::Front).1;
            differ += usize::from(front.triangles() != cast(&cube, &light, CasterFaces::Front).1.triangles());
        }
        let edge_on = figures(&cube, &light).0[2];
        assert_eq!(differ, (1 << 12) - (1 << edge_on), "{light}");
    }
}

/// Guards against calling everything a boundary, or nothing: each fault of a winding has its own name.
#[test]
fn hard_05_orientation_defects_are_told_apart() {
    let (sound, mixed, inverted) =
        (shapes::cube(), shapes::misoriented_cube(), shapes::inside_out(&shapes::cube()));
    // Boundary edges, misoriented edges, shells inside out; watertight.
    let found = |mesh: &Mesh| {
        let c = counts(mesh);
        ([c.boundary_edges, c.misoriented_edges, c.inside_out_shells], c.watertight)
    };
    for (mesh, expected, watertight, volume) in [
        (&sound, [0, 0, 0], true, 8.0),
        (&mixed, [0, 3, 0], false, 8.0 - 4.0 / 3.0),
        (&inverted, [0, 0, 1], true, -8.0),
    ] {
        let c = counts(mesh);
        assert_eq!(found(mesh), (expected, watertight));
        // Negative test: each of the other two meshes instead.
        let like_it = [&sound, &mixed, &inverted].map(|mesh| found(mesh) == (expected, watertight));
        assert_eq!(like_it.iter().filter(|&&like_it| like_it).count(), 1, "{like_it:?}");
        assert!(c.even);
        assert!((c.signed_volume - volume).abs() < 1e-12, "{}", c.signed_volume);
        let light = point(3.0, 5.0, 7.0);
        expect_crossings(
            mesh,
            &light,
            &[([-3.0, -5.0, -7.25], 2), ([0.1, 0.2, 0.3], 1), ([4.0, 5.0, 6.0], 0)],
        );
        expect_agreement(mesh, &light);
    }
    let items = report(&mixed).items(DefectKind::MisorientedEdge, &mixed, &topology(&mixed), 9);
    assert_eq!(items.len(), 3);
}

fn baked(mesh: &Mesh, world_from_mesh: Mat4) -> Mesh {
    let mut scene = Scene::of(mesh.clone());
    scene.instances = vec![Instance { mesh: 0, name: String::new(), world_from_mesh }];
    scene.bake(Scope::Mesh).unwrap().remove(0)
}

/// Guards against a mirror that turns a solid inside out, and against normals transformed by the matrix
/// itself.
#[test]
fn hard_15_transform_that_mirrors_turns_the_windings_with_it() {
    let scale = |x, y, z| Mat4::from_scale(Vec3::new(x, y, z));
    // A shear: x gains half of y, and volumes do not change.
    let shear = Mat4::from_cols_array(&[
        1.0, 0.0, 0.0, 0.0, 0.5, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0,
    ]);
    for (transform, volume) in [
        (Mat4::IDENTITY, 8.0),
        (scale(-1.0, 1.0, 1.0), 8.0),
        (scale(-1.0, -1.0, 1.0), 8.0),
        (scale(-1.0, -1.0, -1.0), 8.0),
        (scale(4.0, 0.5, -0.25), 4.0),
        (shear, 8.0),
        (shear * scale(1.0, -2.0, 1.0), 16.0),
        (Mat4::from_translation(Vec3::new(5.0, -3.0, 2.0)) * scale(-2.0, 2.0, 2.0), 64.0),
    ] {
        let mesh = baked(&shapes::cube(), transform);
        let c = counts(&mesh);
        assert_eq!((c.signed_volume, c.sound(), c.inside_out_shells), (volume, true, 0), "{transform}");
        // Lit from far along a diagonal of the box, a box has three front sides, whatever the transform.
        let [x, y, z] = transform.transform_point3(Vec3::new(31.0, 52.0, 73.0)).to_array();
        let light = point(x, y, z);
        expect_figures(&[(&mesh, light, ([6, 6, 0], 6, 12))]);
        let behind = transform.transform_point3(Vec3::new(-31.0, -52.0, -73.25)).to_array();
        expect_crossings(&mesh, &light, &[(behind, 2)]);
        expect_agreement(&mesh, &light);
    }
    // The sign of the determinant counts, however small: 2⁻¹⁸⁰ here is below every usual epsilon.
    let tiny = 2.0_f32.powi(-60);
    for factor in [tiny, -tiny] {
        let mesh = baked(&shapes::cube(), scale(factor, tiny, tiny));
        assert_eq!(counts(&mesh).inside_out_shells, 0, "{factor:e}");
        assert_eq!(counts(&mesh).signed_volume, 8.0 * f64::from(tiny).powi(3));
    }
    // Negative test: positions mirrored, windings unchanged.
    assert_eq!(counts(&shapes::scaled(&shapes::cube(), -1.0)).inside_out_shells, 1);
}

/// Guards against a determinant of zero taken for either sign, and against flat faces that open the volume.
#[test]
fn hard_15_transform_that_flattens_leaves_a_closed_volume() {
    let scaled = |z| {
        let flat = baked(&shapes::cube(), Mat4::from_scale(Vec3::new(1.0, 1.0, z)));
        umbrage::mesh::weld(&flat, umbrage::mesh::Weld::Exact).mesh
    };
    let light = point(0.3, 0.2, 5.0);
    let found = |mesh: &Mesh| {
        let c = counts(mesh);
        assert_eq!((c.boundary_edges, c.balanced), (0, true));
        ([c.collapsed_faces, c.zero_area_faces, c.duplicate_faces], figures(mesh, &light).0)
    };
    // Top and bottom coincide, the four sides collapse to lines.
    let (flat, expected) = (scaled(0.0), ([8, 0, 2], [2, 2, 8]));
    assert_eq!(found(&flat), expected);
    assert_eq!(counts(&flat).signed_volume, 0.0);
    // Negative test: a scale of nearly zero.
    assert_ne!(found(&scaled(f32::MIN_POSITIVE)), expected);
    expect_crossings(&flat, &light, &[([0.35, -0.1, -2.0], 2), ([9.0, 0.1, -2.0], 0)]);
    expect_agreement(&flat, &light);
}
