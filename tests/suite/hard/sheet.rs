//! Sheets: one layer of faces, lit from either side, single and double; and meshes with few or no faces.

use umbrage::facing::CasterFaces;
use umbrage::mesh::Mesh;
use umbrage::testing::shapes;

use super::figures::*;

/// Guards against casting front faces (or back faces) alone: one of the two lights would shine through the
/// sheet.
#[test]
fn hard_01_sheet_casts_whichever_side_the_light_is_on() {
    let sheet = shapes::sheet(1);
    let (above, below) = (point(0.3, 0.4, 5.0), point(0.3, 0.4, -5.0));
    // A square of two triangles: four silhouette edges of multiplicity 1, since both faces have the same
    // orientation.
    expect_figures(&[(&sheet, above, ([2, 0, 0], 4, 4)), (&sheet, below, ([0, 2, 0], 4, 4))]);
    for (light, side) in [(above, -1.0), (below, 1.0)] {
        let behind = [0.6, 0.5, 3.0 * side];
        expect_crossings(&sheet, &light, &[(behind, 1), ([0.6, 0.5, -3.0 * side], 0), ([2.5, 0.5, side], 0)]);
        expect_agreement(&sheet, &light);
    }
    // Negative test: front faces alone.
    assert_eq!(winding(&sheet, &above, CasterFaces::Front, [0.6, 0.5, -3.0]), Some(1));
    assert_eq!(winding(&sheet, &below, CasterFaces::Front, [0.6, 0.5, 3.0]), Some(0));
}

/// A mesh with each of its faces twice, in the same orientation.
fn doubled(mesh: &Mesh) -> Mesh {
    let (positions, mut triangles, ..) = mesh.clone().into_parts();
    triangles.extend_from_within(..);
    Mesh::new(positions, triangles).unwrap()
}

/// Guards against merging equal faces, against cancelling opposite ones, and against edges with only two
/// slots.
#[test]
fn hard_04_duplicate_faces_are_reported_and_each_counts() {
    let light = point(0.3, 0.4, 5.0);
    let below = [0.6, 0.5, -3.0];
    let (same, opposite) = (doubled(&shapes::sheet(1)), shapes::double_sheet());
    for (mesh, duplicates, balanced, misoriented) in [(&same, [2, 0], false, 4), (&opposite, [0, 2], true, 0)]
    {
        let c = counts(mesh);
        assert_eq!([c.duplicate_same_winding, c.duplicate_opposite_winding], duplicates);
        // The diagonal has four faces, each side of the square two.
        assert_eq!((c.non_manifold_edges, c.max_faces_per_edge, c.boundary_edges), (1, 4, 0));
        assert_eq!(
            (c.misoriented_edges, c.balanced, c.even, c.watertight),
            (misoriented, balanced, true, false)
        );
        expect_crossings(mesh, &light, &[(below, 2), ([0.6, 0.5, 3.0], 0)]);
        expect_agreement(mesh, &light);
    }
    // Opposite windings face opposite sides, so their multiplicities add up as well.
    expect_figures(&[(&same, light, ([4, 0, 0], 4, 8)), (&opposite, light, ([2, 2, 0], 4, 8))]);
    // Negative tests: the mesh without its duplicates, and the sum of windings without the facing.
    expect_crossings(&shapes::sheet(1), &light, &[(below, 1)]);
    assert_eq!(winding(&opposite, &light, CasterFaces::Front, below), Some(1));
}

/// Guards against dropping a face because its edges have no free slot.
#[test]
fn hard_04_duplicate_of_one_face_of_a_cube_deepens_the_shadow_of_that_half_alone() {
    let mesh = shapes::duplicated_face();
    let light = point(3.0, 5.0, 7.0);
    // The cube's hexagon with multiplicity 2. The three edges of the third triangle get one more; one of them
    // already lies on the hexagon.
    expect_figures(&[(&shapes::cube(), light, ([6, 6, 0], 6, 12)), (&mesh, light, ([7, 6, 0], 8, 15))]);
    assert_eq!(cast(&mesh, &light, CasterFaces::All).0.max_multiplicity(), 3);
    // Through the doubled triangle of the top, x < y, and through the other triangle.
    let below = |x: f32, y: f32| -> [f32; 3] {
        // From the light through (x, y, 1) to z = −2.
        let t = 9.0 / 6.0;
        [3.0 + (x - 3.0) * t, 5.0 + (y - 5.0) * t, -2.0]
    };
    expect_crossings(&mesh, &light, &[(below(-0.5, 0.5), 3), (below(0.5, -0.3), 2)]);
    expect_crossings(&shapes::cube(), &light, &[(below(-0.5, 0.5), 2)]);
}

/// Guards against division by the number of faces, empty trees and buffers, and empty volumes that shadow
/// everything.
#[test]
fn hard_20_empty_meshes_cast_nothing_and_are_sound() {
    let collapsed = Mesh::new(vec![[0.0; 3], [1.0; 3]], vec![[0, 0, 0], [0, 1, 0], [1, 1, 0]]).unwrap();
    let pointless = Mesh::new(vec![[2.0; 3]; 3], vec![]).unwrap();
    for (mesh, faces) in [(&Mesh::default(), 0), (&pointless, 0), (&collapsed, 3)] {
        let c = counts(mesh);
        assert_eq!((c.faces, c.collapsed_faces, c.edges, c.shells), (faces, faces, 0, 0));
        assert_eq!((c.euler_characteristic, c.signed_volume, c.sound()), (0, 0.0, true));
        for light in [point(0.25, 0.5, 0.75), point(0.0, 0.0, 0.0), sun(0.0, -1.0, 0.0)] {
            expect_figures(&[(mesh, light, ([0, 0, faces], 0, 0))]);
            expect_crossings(mesh, &light, &[([0.25, -3.0, 9.0], 0)]);
            expect_agreement(mesh, &light);
        }
    }
    // Negative test: a mesh that is not empty differs from the empty ones.
    let triangle = Mesh::new(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]]).unwrap();
    assert_ne!(figures(&triangle, &point(0.25, 0.5, 0.75)), ([0, 0, 0], 0, 0));
}

/// Guards against assuming neighbors: none of the three edges has one.
#[test]
fn hard_20_one_triangle_casts_a_prism() {
    let triangle = Mesh::new(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]]).unwrap();
    let c = counts(&triangle);
    assert_eq!((c.boundary_edges, c.boundary_loops, c.shells, c.euler_characteristic), (3, 1, 1, 1));
    let (lamp, day) = (point(0.25, 0.25, 2.0), sun(0.0, 0.0, -1.0));
    expect_figures(&[(&triangle, lamp, ([1, 0, 0], 3, 3)), (&triangle, day, ([1, 0, 0], 3, 3))]);
    expect_crossings(&triangle, &day, &[([0.25, 0.25, -9.0], 1), ([0.75, 0.75, -9.0], 0)]);
    // At twice the distance from the light the shadow is twice as large.
    expect_crossings(
        &triangle,
        &lamp,
        &[([-0.125, 1.5, -2.0], 1), ([0.75, 1.25, -2.0], 0), ([0.75, 0.5, -2.0], 1)],
    );
    let caster = umbrage::caster::Caster::new(triangle);
    let casting = caster.stencil_volumes(&lamp, &projection(), None, None);
    assert_eq!(casting.faces.choices[0].what, CasterFaces::All);
    assert_eq!(casting.faces.choices[0].to_string(), "the shell is not watertight");
}

fn projection() -> umbrage::view::Projection {
    umbrage::view::Projection {
        eye: [0.0, 0.0, 8.0],
        right: [1.0, 0.0, 0.0],
        up: [0.0, 1.0, 0.0],
        forward: [0.0, 0.0, -1.0],
        near: 0.5,
        kind: Default::default(),
    }
}

/// Guards against a direction of length zero, which would extrude every volume to no point at all.
#[test]
fn hard_20_light_that_is_none_is_an_error_that_says_so() {
    use umbrage::geom::Light;
    let message = |light: Result<Light, umbrage::geom::LightError>| light.unwrap_err().to_string();
    let zero = "a directional light needs a direction that is not 0,0,0";
    assert_eq!(message(Light::directional([0.0; 3])), zero);
    assert_eq!(message(Light::directional([-0.0, 0.0, -0.0])), zero);
    assert_eq!(message("directional:0,0,0".parse()), zero);
    assert_eq!(message("directional:1e-60,0,0".parse()), zero);
    assert_eq!(message(Light::point([0.0, f32::NAN, 0.0])), "a light needs finite coordinates, not NaN");
    assert_eq!(
        message(Light::directional([f32::INFINITY, 0.0, 0.0])),
        "a light needs finite coordinates, not inf"
    );
    assert_eq!(message("point:1e39,0,0".parse()), "a light needs finite coordinates, not inf");
    // A point light at the origin and the smallest direction are valid lights.
    assert!(Light::point([0.0; 3]).is_ok());
    let smallest = Light::directional([0.0, f32::from_bits(1), 0.0]).unwrap();
    assert_eq!(figures(&shapes::cube(), &smallest), ([2, 2, 8], 8, 8));
}
