//! Coordinates at the ends of the range of f32, through files and all checks.

use umbrage::facing::CasterFaces;
use umbrage::mesh::{Mesh, Weld, weld};
use umbrage::read::read_bytes;
use umbrage::scene::Scope;
use umbrage::testing::shapes;
use umbrage::write::{Layer, Model, Target, to_bytes};

use super::figures::*;

/// The mesh written and read again in each format that keeps all digits, and welded.
fn through_files(mesh: &Mesh) -> Vec<Mesh> {
    let model = Model { layers: vec![Layer::from(mesh)] };
    let read = |name: &str| {
        let bytes = to_bytes(&model, Target::from_path(name).unwrap()).unwrap();
        let baked = read_bytes(&bytes, name).unwrap().bake(Scope::Scene).unwrap();
        weld(&baked[0], Weld::Exact).mesh.with_name(format!("{} by {name}", mesh.name))
    };
    ["a.obj", "a.ply", "a.glb"].map(read).to_vec()
}

/// A cube from `low` to `high` in a file of its own, lit from beyond its upper corner.
struct Row {
    mesh: Mesh,
    light: [f32; 3],
    behind: [f32; 3],
    volume: f64,
    cubes: usize,
}

fn rows() -> Vec<Row> {
    let cube =
        |name: &str, low: f32, high: f32| shapes::cuboid([low; 3], [high; 3]).with_name(name.to_owned());
    let (tiny, huge, largest, smallest) = (1e-30_f32, 1e30_f32, 3.4e38_f32, f32::from_bits(1));
    let cubic = |side: f32| f64::from(side).powi(3);
    let far = 2.0_f32.powi(21);
    let row = |mesh, light, behind, volume| Row { mesh, light, behind, volume, cubes: 1 };
    vec![
        row(
            cube("tiny", -tiny, tiny),
            [3.0, 5.0, 7.0].map(|x| x * tiny),
            [-3.0, -5.0, -7.25].map(|x| x * tiny),
            8.0 * cubic(tiny),
        ),
        row(
            cube("huge", -huge, huge),
            [3.0, 5.0, 7.0].map(|x| x * huge),
            [-3.0, -5.0, -7.25].map(|x| x * huge),
            8.0 * cubic(huge),
        ),
        // No point light fits far beyond this cube: a sun.
        row(
            cube("largest", -largest, largest),
            [0.0; 3],
            [-largest, -largest, -largest],
            8.0 * cubic(largest),
        ),
        // A cube one ulp wide.
        row(
            cube("smallest", 0.0, smallest),
            [3.0, 5.0, 7.0].map(|x| x * smallest),
            [-2.0, -4.0, -6.0].map(|x| x * smallest),
            cubic(smallest),
        ),
        // A cube 2²⁰ diagonals from the origin, where coordinates are multiples of a quarter.
        row(
            cube("far", far - 1.0, far + 1.0),
            [3.0, 5.0, 7.0].map(|x| x + far),
            [-3.0, -5.0, -7.25].map(|x| x + far),
            8.0,
        ),
        Row {
            mesh: Mesh::concat(&[cube("huge", huge, 3.0 * huge), cube("tiny", -tiny, tiny)])
                .unwrap()
                .with_name("both"),
            light: [5.0, 7.0, 9.0].map(|x| x * huge),
            behind: [-1.0, -3.0, -5.5].map(|x| x * huge),
            volume: 8.0 * cubic(huge),
            cubes: 2,
        },
    ]
}

/// Guards against overflow, underflow, and any constant that is valid for meshes of moderate size only.
#[test]
fn hard_17_coordinates_at_either_end_of_f32_keep_every_number() {
    for Row { mesh, light, behind, volume, cubes } in rows() {
        let light = if light == [0.0; 3] {
            sun(-3.0, -5.0, -7.5)
        } else {
            umbrage::geom::Light::point(light).unwrap()
        };
        for mesh in through_files(&mesh) {
            let found = report(&mesh);
            let c = found.counts;
            assert_eq!(
                (mesh.vertex_count(), c.edges, c.faces),
                (8 * cubes, 18 * cubes, 12 * cubes),
                "{}",
                mesh.name
            );
            assert_eq!(
                (c.shells, c.sound(), c.zero_area_faces, c.near_miss_edges),
                (cubes, true, 0, 0),
                "{}",
                mesh.name
            );
            assert!(
                (c.signed_volume - volume).abs() <= 1e-6 * volume,
                "{}: {} {volume}",
                mesh.name,
                c.signed_volume
            );
            expect_figures(&[(&mesh, light, ([6 * cubes, 6 * cubes, 0], 6 * cubes, 12 * cubes))]);
            if mesh.name.starts_with("largest") {
                // The corner itself is in its own shadow: one step inwards, one face lies on the segment.
                let within = behind.map(f32::next_up);
                expect_crossings(&mesh, &light, &[(within, 1)]);
            } else {
                expect_crossings(&mesh, &light, &[(behind, 2)]);
            }
            expect_agreement(&mesh, &light);
            // Export to f32 stays finite, whatever is subtracted.
            assert!(shadow(&mesh, &light).to_f32().iter().flatten().all(|x| x.is_finite()));
        }
    }
}

/// Guards against ties created by rounding: lights on the vertices of such meshes, and across all their
/// range.
#[test]
fn hard_17_coordinates_at_either_end_agree_for_lights_on_their_vertices() {
    for Row { mesh, .. } in rows() {
        for vertex in [0, mesh.vertex_count() - 1] {
            let light = umbrage::geom::Light::point(mesh.positions()[vertex]).unwrap();
            assert!(figures(&mesh, &light).0[2] >= 6, "{}", mesh.name);
            expect_agreement(&mesh, &light);
        }
        for light in [point(0.0, 1e-45, 1e30), point(3.4e38, -3.4e38, 3.4e38), sun(1e-45, 0.0, 3.4e38)] {
            figures(&mesh, &light);
            expect_agreement(&mesh, &light);
        }
    }
    // Negative test: a single ulp of the largest coordinate is noticed.
    let largest = &rows()[2].mesh;
    let (mut positions, triangles, ..) = largest.clone().into_parts();
    positions[7][2] = positions[7][2].next_down();
    let moved = Mesh::new(positions, triangles).unwrap();
    let in_its_top = point(0.0, 0.0, 3.4e38);
    assert_ne!(figures(&moved, &in_its_top), figures(largest, &in_its_top));
}

/// Guards against trusting a mesh that has lost its digits. Far from the origin a ball becomes a heap of
/// coincident vertices, and the rest of the ball still casts a closed volume.
#[test]
fn hard_17_coordinates_that_coincide_far_away_collapse_into_a_closed_rest() {
    let far = 2.0_f32.powi(21);
    let ball = shapes::translated(&shapes::icosphere(3), [far; 3]);
    let welded = weld(&ball, Weld::Exact).mesh;
    let c = counts(&welded);
    assert!(welded.vertex_count() < ball.vertex_count() && c.collapsed_faces > 0, "{c:?}");
    // Collapsing edges leaves a cycle a cycle.
    assert!(c.balanced && c.even && c.boundary_edges == 0, "{c:?}");
    let light = point(far + 3.0, far + 5.0, far + 7.0);
    figures(&welded, &light);
    expect_agreement(&welded, &light);
    expect_crossings(&welded, &light, &[([far - 3.0, far - 5.0, far - 7.25], 2)]);
    assert_eq!(winding(&welded, &light, CasterFaces::Front, [far - 3.0, far - 5.0, far - 7.25]), Some(1));
    // Negative test: near the origin nothing collapses.
    assert_eq!(counts(&weld(&shapes::icosphere(3), Weld::Exact).mesh).collapsed_faces, 0);
}
