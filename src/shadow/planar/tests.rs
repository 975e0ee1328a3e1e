//! Planar shadows against the exact ray cast, and closed forms.

use super::coverage::{Coverage, is_on_line};
use super::matrix::{Corner, Flattening};
use super::polygon::clip;
use super::{Coefficients, Plane};
use crate::caster::{Caster, CasterGroup};
use crate::geom::Light;
use crate::mesh::{FaceId, Mesh};
use crate::oracle::Verdict;
use crate::random::SplitMix64;
use crate::scene::Lamp;
use crate::shadow::{Claim, Request, Samples, Technique, Visibility};
use crate::testing::shapes;
use crate::view::{Camera, Size, Up};

fn plane(text: &str) -> Plane {
    let numbers: Vec<f64> = text.split('/').map(|number| number.parse().unwrap()).collect();
    Coefficients::new(numbers.try_into().unwrap()).unwrap().plane()
}

fn light(text: &str) -> Light {
    *text.parse::<Lamp>().unwrap().light()
}

/// Whether a point of the plane is in shadow, in plain `f64` over all faces: the polygons of the statement,
/// with either clip left out.
fn covers_plainly(mesh: &Mesh, plane: &Plane, light: &Light, p: [f32; 3], clips: [bool; 2]) -> bool {
    let Some(plane) = plane.towards(light) else { return false };
    let flattening = Flattening::<f64>::new(&plane, light);
    let [x, y, w, _] = flattening.at(p);
    (0..mesh.face_count()).any(|face| {
        let mut polygon = mesh.corners(FaceId::new(face)).map(|corner| flattening.at(corner)).to_vec();
        if clips[0] {
            clip(&mut polygon, |corner| corner[3]);
        }
        if clips[1] {
            clip(&mut polygon, |corner| corner[2]);
        }
        holds(&polygon, [x / w, y / w], clips[1])
    })
}

/// Whether the image of a convex polygon contains a point. After the second clip no divisor is below zero;
/// one of zero is a direction.
fn holds(polygon: &[Corner<f64>], [u, v]: [f64; 2], is_clipped: bool) -> bool {
    let beside = |&[x, y, w, _]: &Corner<f64>| {
        let side = if w < 0.0 && !is_clipped { -1.0 } else { 1.0 };
        [side * (x - u * w), side * (y - v * w)]
    };
    let corners: Vec<[f64; 2]> = polygon.iter().map(beside).collect();
    let turns = (0..corners.len()).map(|i| {
        let ([ax, ay], [bx, by]) = (corners[i], corners[(i + 1) % corners.len()]);
        ax * by - ay * bx
    });
    let turns: Vec<f64> = turns.filter(|turn| *turn != 0.0).collect();
    turns.len() > 2 && (turns.iter().all(|turn| *turn > 0.0) || turns.iter().all(|turn| *turn < 0.0))
}

/// A random point of an axis-parallel plane, exactly on it.
fn point_on(axis: usize, at: f32, random: &mut SplitMix64) -> [f32; 3] {
    let mut p = [0; 3].map(|_| (12.0 * random.unit() - 6.0) as f32);
    p[axis] = at;
    p
}

/// What goes wrong at points of planes.
#[derive(Debug, Default)]
struct Tally {
    judged: u64,
    dark: u64,
    wrong: u64,
    /// With the sign of the line alone.
    wrong_on_line: u64,
    /// Wrong in plain `f64` with both clips, without the first, and without the second.
    wrong_plainly: [u64; 3],
}

/// `count` points for each of some meshes, planes and lights.
fn tally(count: u32, plainly: u32) -> Tally {
    let at = shapes::translated;
    let meshes = [
        at(&shapes::icosphere(2), [0.3, -0.2, 0.4]),
        shapes::torus_knot(2, 3, 40, 6, 0.4),
        at(&shapes::menger_sponge(1), [-1.25, -1.75, -0.25]),
        at(&shapes::scaled(&shapes::sheet(3), 0.75), [-1.0, -1.0, 1.5]),
    ];
    let lights =
        ["point:0.5,0.25,1.25", "point:1,-2,9", "spot:-3,2,2.5:1,0,-1:30", "directional:0.3,-0.5,-1"];
    let planes =
        [(2, 0.0, "0/0/1/0"), (2, -0.5, "0/0/-2/-1"), (0, -1.5, "1/0/0/1.5"), (1, 0.125, "0/8/0/-1")];
    let mut random = SplitMix64(11);
    let mut tally = Tally::default();
    for mesh in &meshes {
        let caster = Caster::new(mesh.clone());
        let casters = CasterGroup::new(vec![&caster]);
        for lamp in lights {
            let light = light(lamp);
            for (axis, at, numbers) in planes {
                let plane = plane(numbers);
                assert!(plane.height([at; 3]).abs() < 1e-12);
                let coverage = Coverage::new(&casters, &plane, &light).unwrap();
                for index in 0..count {
                    let p = point_on(axis, at, &mut random);
                    let verdict = caster.oracle().verdict(p, &light);
                    if verdict == Verdict::Grazing {
                        continue;
                    }
                    let is_dark = verdict == Verdict::Shadowed;
                    tally.judged += 1;
                    tally.dark += u64::from(is_dark);
                    tally.wrong += u64::from(coverage.covers(p) != Some(is_dark));
                    if index < plainly {
                        let on_line = mesh_faces(mesh).any(|face| is_on_line(p, &light, face));
                        tally.wrong_on_line += u64::from(on_line != is_dark);
                        for (wrong, clips) in
                            tally.wrong_plainly.iter_mut().zip([[true, true], [false, true], [true, false]])
                        {
                            let found = covers_plainly(mesh, &plane, &light, p, clips);
                            *wrong += u64::from(found != is_dark);
                        }
                    }
                }
            }
        }
    }
    tally
}

fn mesh_faces(mesh: &Mesh) -> impl Iterator<Item = [[f32; 3]; 3]> {
    (0..mesh.face_count()).map(|face| mesh.corners(FaceId::new(face)))
}

#[test]
fn planar_coverage_equals_the_exact_verdict_and_without_a_clip_it_does_not() {
    let tally = tally(200, 60);
    assert!(tally.judged > 12_000 && tally.dark > 1000, "{tally:?}");
    assert_eq!((tally.wrong, tally.wrong_plainly[0]), (0, 0), "{tally:?}");
    // Faults injected: the whole line instead of the segment; either clip left out.
    assert!(tally.wrong_on_line > 50, "{tally:?}");
    assert!(tally.wrong_plainly[1] > 50 && tally.wrong_plainly[2] > 50, "{tally:?}");
}

/// The long form: 10⁶ points.
///
/// `cargo test --release --lib -- --ignored planar_coverage_of_a_million`
#[test]
#[ignore = "takes minutes without optimization; tests/long.sh planar_coverage"]
fn planar_coverage_of_a_million_points_equals_the_exact_verdict() {
    let tally = tally(16_000, 0);
    assert!(tally.judged > 1_000_000 && tally.dark > 100_000 && tally.wrong == 0, "{tally:?}");
}

fn shadow_of(mesh: Mesh, light: &Light) -> impl Fn([f32; 2]) -> bool + use<> {
    let caster = Caster::new(mesh);
    let coverage = Coverage::new(&CasterGroup::new(vec![&caster]), &plane("0/0/1/0"), light).unwrap();
    move |[x, y]| coverage.covers([x, y, 0.0]).unwrap()
}

/// The square ±1 at a height.
fn square(z: f32) -> Mesh {
    shapes::translated(&shapes::scaled(&shapes::sheet(1), 2.0), [-1.0, -1.0, z])
}

#[test]
fn planar_shadow_of_a_square_is_twice_as_large_and_none_from_behind_or_beyond() {
    let light = light("point:0,0,4");
    let covers = shadow_of(square(2.0), &light);
    for (at, expected) in [(0.25, true), (1.999, true), (2.0, false), (2.001, false)] {
        for [x, y] in [[at, 0.5], [-at, 0.5], [0.5, at], [-0.125, -at]] {
            assert_eq!(covers([x, y]), expected, "{x} {y}");
        }
    }
    for z in [5.0, -1.0, 4.0] {
        let none = shadow_of(square(z), &light);
        assert!((0..400).all(|i| !none([(i % 20) as f32 - 9.7, (i / 20) as f32 - 9.6])), "{z}");
    }
    // The shadows of the classic matrix: mirrored, twice as large, and of what is below.
    let ground = plane("0/0/1/0");
    let plainly =
        |z, at: [f32; 2], clips| covers_plainly(&square(z), &ground, &light, [at[0], at[1], 0.0], clips);
    assert!(plainly(5.0, [3.5, 3.6], [true, false]) && !plainly(5.0, [3.5, 3.6], [true, true]));
    assert!(plainly(-1.0, [0.5, 0.6], [false, true]) && !plainly(-1.0, [0.5, 0.6], [true, true]));
}

/// A wall from z = −1 to 1 throws a shadow from its upper half alone, from the plane on.
#[test]
fn planar_shadow_of_a_sunken_wall_begins_at_the_plane_without_a_gap() {
    let corners = [[-1.0, 0.0, -1.0], [1.0, 0.0, -1.0], [1.0, 0.0, 1.0], [-1.0, 0.0, 1.0]];
    let wall = Mesh::new(corners.to_vec(), vec![[0, 1, 2], [0, 2, 3]]).unwrap();
    // Towards a light in the direction (0, −1, 1): the shadow is 0 < y < 1.
    let covers = shadow_of(wall, &light("directional:0,1,-1"));
    let least = f32::from_bits(1);
    for (y, expected) in
        [(0.5, true), (least, true), (0.999, true), (0.0, false), (-least, false), (1.0, false)]
    {
        assert_eq!(covers([0.25, y]), expected, "{y}");
    }
}

#[test]
fn planar_shadow_of_a_cube_is_the_hexagon() {
    let cube = shapes::cuboid([0.0; 3], [2.0; 3]);
    let light = light("directional:-1,-1,-1");
    let flattening = Flattening::<f64>::new(&plane("0/0/1/0"), &light);
    let mut images: Vec<[i32; 2]> = cube
        .positions()
        .iter()
        .map(|&p| {
            let [x, y, w, _] = flattening.at(p);
            [x / w, y / w].map(|it| it as i32)
        })
        .collect();
    images.sort_unstable();
    assert_eq!(images, [[-2, -2], [-2, 0], [0, -2], [0, 0], [0, 0], [0, 2], [2, 0], [2, 2]]);
    let covers = shadow_of(cube, &light);
    let inside = |x: f32, y: f32| x.abs() < 2.0 && y.abs() < 2.0 && (x - y).abs() < 2.0;
    for i in 0..1600 {
        // Off the lines between the corners.
        let [x, y] = [i % 40, i / 40].map(|k| k as f32 / 8.0 - 2.47);
        let y = y + 0.03;
        assert_eq!(covers([x, y]), inside(x, y), "{x} {y}");
    }
}

#[test]
fn planar_shadow_of_a_light_in_the_plane_is_none() {
    let caster = Caster::new(shapes::cube());
    let casters = CasterGroup::new(vec![&caster]);
    for lamp in ["point:3,1,0", "directional:1,2,0"] {
        assert!(Coverage::new(&casters, &plane("0/0/1/0"), &light(lamp)).is_none());
    }
    // From behind, the plane is lit on its other side.
    let below = Coverage::new(&casters, &plane("0/0/1/3"), &light("point:0.25,0.125,-9")).unwrap();
    assert_eq!(below.covers([0.0, 0.0, -3.0]), Some(false));
    let above = Coverage::new(&casters, &plane("0/0/1/-3"), &light("point:0.25,0.125,-9")).unwrap();
    assert_eq!(above.covers([0.0, 0.0, 3.0]), Some(true));
}

/// A floor, turned by an angle that rounds its corners, with a caster on it that reaches through it, and a
/// view from above.
fn tilted(quads: u32, mesh: &Mesh) -> Caster {
    let (sin, cos) = 0.4_f32.sin_cos();
    let floor =
        shapes::translated(&shapes::scaled(&shapes::sheet(quads), 12.0 / quads as f32), [-6.0, -6.0, 0.0]);
    let turned = |mesh: &Mesh| {
        let turn = |[x, y, z]: [f32; 3]| [cos * x - sin * z + 0.3, y, sin * x + cos * z];
        let positions = mesh.positions().iter().map(|&p| turn(p)).collect();
        Mesh::new(positions, mesh.triangles().to_vec()).unwrap()
    };
    Caster::new(Mesh::concat(&[turned(&floor), turned(mesh)]).unwrap())
}

fn with_samples(caster: &Caster, work: impl FnOnce(&CasterGroup<'_>, &Samples)) {
    let casters = CasterGroup::new(vec![caster]);
    let size = Size::new(64, 48).unwrap();
    let camera = Camera::look_at([2.0, -9.0, 9.0], [0.3, 0.0, 0.0], 0.9, Up::Z).unwrap();
    let samples = Samples::of_view(&casters, &camera.projection(size, 0.125), size, 1).unwrap();
    work(&casters, &samples);
}

#[test]
fn planar_takes_the_plane_of_most_samples_and_rays_for_all_others() {
    for mesh in [shapes::torus_knot(2, 3, 40, 6, 0.4), shapes::menger_sponge(1)] {
        for quads in [1, 2] {
            let caster = tilted(quads, &mesh);
            with_samples(&caster, |casters, samples| {
                for lamp in ["point:1,-2,9", "directional:0.3,0.5,-1", "point:0.5,0.5,2.25,radius=1"] {
                    let lamp: Lamp = lamp.parse().unwrap();
                    let request = Request { casters, lamp: &lamp, samples };
                    let of = |technique: &str| -> Visibility {
                        technique.parse::<Technique>().unwrap().shade(&request).unwrap()
                    };
                    let (rays, planar) = (of("rays"), of("planar"));
                    assert_eq!(planar.values(), rays.values(), "{lamp}");
                    assert_eq!(planar.claim(), Claim::Exact);
                    // Exactly the samples that are not of the floor are passed to rays.
                    let is_floor = |face: FaceId| face.index() < 2 * (quads * quads) as usize;
                    let others = samples.hits().iter().zip(planar.asked());
                    let others = others.filter(|(hit, asked)| **asked && !is_floor(hit.unwrap().face));
                    assert_eq!(planar.asked_exactly(), others.count() as u64, "{lamp}");
                    // A plane that holds nothing: all are.
                    let none = of("planar:plane=0/0/1/-77");
                    let asked = planar.asked().iter().filter(|asked| **asked).count() as u64;
                    assert_eq!((none.values(), none.asked_exactly()), (rays.values(), asked));
                }
            });
        }
    }
}

#[test]
fn planar_options_are_read_back_and_refused_by_name() {
    let parsed = |text: &str| text.parse::<Technique>().map(|technique| technique.to_string());
    for text in ["planar", "planar:plane=0/0/1/-2.5", "planar:plane=0.1/-3/1e-7/0"] {
        assert_eq!(parsed(text).unwrap().parse::<Technique>(), text.parse());
    }
    assert_eq!(parsed("planar:plane=-0/0/2/0").unwrap(), "planar:plane=0/0/2/0");
    assert_eq!(parsed("planar:plane=most").unwrap(), "planar");
    for value in ["0/0/0/1", "1/2/3", "1/2/3/4/5", "a/0/1/0", "inf/0/0/1", ""] {
        let error = parsed(&format!("planar:plane={value}")).unwrap_err().to_string();
        assert!(error.contains("is not `most`, or a plane A/B/C/D"), "{error}");
    }
}
