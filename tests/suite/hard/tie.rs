//! Lights exactly in planes, on edges and on vertices, and at the adjacent floats.

use umbrage::facing::{FacePlanes, classify};
use umbrage::geom::{Facing, Light};
use umbrage::glam::Vec3;
use umbrage::mesh::Mesh;
use umbrage::shadow::volume::{Caps, ShadowVolume};
use umbrage::silhouette::Silhouette;
use umbrage::testing::shapes;

use super::figures::*;

/// Guards against a tolerance about zero: on the cube's planes, edges and corners each ulp changes the closed
/// form.
#[test]
fn hard_09_tie_of_a_light_with_a_cube_is_exact_to_the_ulp() {
    let cube = shapes::cube();
    let (on, out, within) = (1.0, 1.0_f32.next_up(), 1.0_f32.next_down());
    #[rustfmt::skip]
    let rows = [
        // In the plane of the top, outside the top; above; below.
        (point(5.0, 0.3, on),            ([2, 8, 2], 7, 3 * 2 + 4)),
        (point(5.0, 0.3, out),           ([4, 8, 0], 6, 12)),
        (point(5.0, 0.3, within),        ([2, 10, 0], 4, 8)),
        // In the top itself; above; inside the cube.
        (point(0.2, 0.3, on),            ([0, 10, 2], 4, 4)),
        (point(0.2, 0.3, out),           ([2, 10, 0], 4, 8)),
        (point(0.2, 0.3, within),        ([0, 12, 0], 0, 0)),
        // On an edge; off the edge in one direction, in the other, in both.
        (point(on, 0.25, on),            ([0, 8, 4], 6, 6)),
        (point(out, 0.25, on),           ([2, 8, 2], 7, 3 * 2 + 4)),
        (point(within, 0.25, on),        ([0, 10, 2], 4, 4)),
        (point(out, 0.25, out),          ([4, 8, 0], 6, 12)),
        (point(out, 0.25, within),       ([2, 10, 0], 4, 8)),
        // On a corner; off the corner along one axis, along all.
        (point(on, on, on),              ([0, 6, 6], 6, 6)),
        (point(out, on, on),             ([2, 6, 4], 8, 2 * 2 + 6)),
        (point(within, on, on),          ([0, 8, 4], 6, 6)),
        (point(out, out, out),           ([6, 6, 0], 6, 12)),
        (point(within, within, within),  ([0, 12, 0], 0, 0)),
        // Along one axis, along two, along none.
        (sun(0.0, 0.0, -1.0),            ([2, 2, 8], 8, 8)),
        (sun(-1.0, 0.0, -1.0),           ([4, 4, 4], 10, 2 * 2 + 8)),
        (sun(-1.0, -f32::from_bits(1), -1.0), ([6, 6, 0], 6, 12)),
    ];
    expect_figures(&rows.map(|(light, expected)| (&cube, light, expected)));
    for (light, _) in rows {
        expect_agreement(&cube, &light);
    }
    // Negative test: a light rounded to three digits does not have the figures of its row, unless the light
    // is a tie.
    let is_rejected = |(light, expected): &(Light, Figures)| {
        let xyz = light.xyz().map(|x| (x * 1000.0).round() / 1000.0);
        let rounded =
            if light.is_directional() { Light::directional(xyz.map(|x| -x)) } else { Light::point(xyz) };
        figures(&cube, &rounded.unwrap()) != *expected
    };
    assert_eq!(rows.iter().filter(|row| is_rejected(row)).count(), 13);
}

/// Guards against normalizing a vector of length zero: a vertex at the light is extruded to (0, 0, 0, 0).
#[test]
fn hard_09_tie_of_a_light_on_a_vertex_extrudes_nothing_from_it() {
    for mesh in
        [shapes::cube(), shapes::octahedron(), shapes::book(5), shapes::mobius(12), shapes::t_junction()]
    {
        let topology = topology(&mesh);
        for (index, &vertex) in mesh.positions().iter().enumerate() {
            let light = Light::point(vertex).unwrap();
            figures(&mesh, &light);
            // Every face at this vertex is edge-on: the vertex is in no cap and on no side.
            let facing = classify(&mesh, &light);
            let around =
                mesh.triangles().iter().zip(&facing).filter(|(face, _)| face.contains(&(index as u32)));
            assert!(
                around.clone().count() > 0 && around.into_iter().all(|(_, &facing)| facing == Facing::EdgeOn)
            );
            let volume = shadow(&mesh, &light);
            let far = |volume: &ShadowVolume| {
                let all = 0..volume.vertex_count() as u32;
                all.filter(|&v| volume.vertex(v).to_f64() == [0.0; 4]).count()
            };
            assert_eq!(far(&volume), 0);
            // Even if all faces are made to cast, the volume is closed and contains this vertex.
            let signs = vec![1; mesh.face_count()];
            let silhouette = Silhouette::extract(&topology, &signs);
            let forced = ShadowVolume::extrude(&mesh, &topology, &light, &signs, &silhouette, Caps::Both);
            assert!(
                forced.boundary_sum().is_closed() && forced.to_f32().iter().flatten().all(|x| x.is_finite())
            );
            assert_eq!(far(&forced), 1);
        }
        expect_agreement(&mesh, &Light::point(mesh.positions()[0]).unwrap());
    }
}

/// Three hundred faces whose planes all pass through the origin, exactly: of two opposite points and a third.
fn through_the_origin() -> Mesh {
    let mut state = 1_u32;
    let mut next = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 8) as f32 / 8_388_608.0 - 1.0
    };
    let mut positions = Vec::new();
    for _ in 0..300 {
        let (a, b) = ([next(), next(), next()], [next(), next(), next()]);
        positions.extend([a, b, a.map(|x| -0.5 * x)]);
    }
    Mesh::new(positions, (0..300).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect()).unwrap()
}

/// Guards against a filter with a constant bound, which decides a side for more than half of such ties.
#[test]
fn hard_09_tie_of_all_planes_at_the_origin_is_found_by_every_way() {
    let mesh = through_the_origin();
    expect_figures(&[(&mesh, point(0.0, 0.0, 0.0), ([0, 0, 300], 0, 0))]);
    expect_crossings(&mesh, &point(0.0, 0.0, 0.0), &[]);
    expect_agreement(&mesh, &point(0.0, 0.0, 0.0));

    // The smallest step off the origin decides all of them, by the sign of a × b, which f64 holds exactly.
    for axis in 0..3 {
        let mut step = [0.0; 3];
        step[axis] = f32::from_bits(1);
        let light = Light::point(step).unwrap();
        let exact = |face: &[u32; 3]| {
            let [a, b, _] = face.map(|v| mesh.positions()[v as usize].map(f64::from));
            let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
            let (left, right) = (a[i] * b[j], a[j] * b[i]);
            i8::from(left > right) - i8::from(left < right)
        };
        let expected: Vec<i8> = mesh.triangles().iter().map(exact).collect();
        let signs = |facing: Vec<Facing>| facing.iter().map(|facing| facing.sign()).collect::<Vec<_>>();
        assert_eq!(signs(classify(&mesh, &light)), expected);
        assert_eq!(signs(FacePlanes::new(&mesh).classify(&mesh, &light)), expected);
        assert!(expected.contains(&1) && expected.contains(&-1) && !expected.contains(&0));
    }

    // Negative test: the same sign in f32 is no tie for most of them.
    let naive = |face: &[u32; 3]| {
        let [a, b, c] = face.map(|v| Vec3::from(mesh.positions()[v as usize]));
        (b - a).cross(c - a).dot(-a)
    };
    assert!(mesh.triangles().iter().filter(|face| naive(face) != 0.0).count() > 100);
}

/// Guards against special cases of the light at the origin of the mesh: a book's pages all pass through the
/// origin.
#[test]
fn hard_09_tie_of_a_light_on_the_spine_of_a_book_casts_nothing() {
    for pages in [1, 2, 5, 18] {
        let book = shapes::book(pages);
        let n = pages as usize;
        for z in [0.0, 0.25, 1.0, -3.0, 7.5] {
            expect_figures(&[(&book, point(0.0, 0.0, z), ([0, 0, n], 0, 0))]);
        }
        expect_agreement(&book, &point(0.0, 0.0, 0.25));
        // One ulp off the origin most pages have a side again.
        let beside = figures(&book, &point(f32::from_bits(1), -f32::from_bits(1), 0.25));
        assert!(beside.0[2] < n.max(2), "{beside:?}");
    }
}
