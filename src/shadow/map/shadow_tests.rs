//! Tests of what maps show, against closed forms and the exact ray cast.

use glam::DVec3;

use super::cpu::Drawn;
use super::neighborhood::Around;
use super::space::{unit_normal, wide};
use super::tests::lamp;
use super::*;
use crate::caster::{Caster, CasterGroup};
use crate::geom::predicate::side_of_light;
use crate::mesh::{FaceId, Mesh};
use crate::oracle::Verdict;
use crate::random::SplitMix64;
use crate::scene::Lamp;
use crate::shadow::{Request, Samples, Technique};
use crate::testing::shapes;
use crate::verify::errors::{Errors, Made, Truth};
use crate::view::{Camera, Size, Up};

/// The square [−1, 1]² at height 1 over the square [−4, 4]² at height 0.
fn plate_over_floor() -> Caster {
    let square =
        |half: f32, z| shapes::translated(&shapes::scaled(&shapes::sheet(1), 2.0 * half), [-half, -half, z]);
    Caster::new(Mesh::concat(&[square(1.0, 1.0), square(4.0, 0.0)]).unwrap())
}

fn drawn(casters: &CasterGroup<'_>, lamp: &Lamp, options: &MapOptions) -> Drawn {
    let space = LightSpace::of_scene(casters, lamp, options.size).unwrap();
    let rule = Rule::new(options.bias, options.filter.reach(), options.depth, &space);
    Drawn::draw(casters, lamp.light(), options, space, rule).unwrap()
}

/// The shadow of a square on a plane under a sun is the square, shifted: the area in which the map differs
/// from it is at most half a texel's width along its perimeter.
#[test]
fn map_of_a_square_over_a_plane_is_the_shifted_square() {
    let caster = plate_over_floor();
    let casters = CasterGroup::new(vec![&caster]);
    let options = MapOptions { size: 128, filter: Filter::Nearest, ..MapOptions::DEFAULT };
    let mut random = SplitMix64(21);
    let (mut all, mut all_moved, cases) = (0.0, 0.0, 12);
    for _ in 0..cases {
        let [lx, ly] = [0; 2].map(|_| 1.6 * random.unit() - 0.8);
        let sun = lamp(&format!("directional:{},{},-1", -lx, -ly));
        let (lx, ly) = (f64::from(sun.light().xyz()[0]), f64::from(sun.light().xyz()[1]));
        let drawn = drawn(&casters, &sun, &options);
        let texel = drawn.space().texel_world(DVec3::ZERO) * (1.0 + lx * lx + ly * ly).sqrt();
        // Part of the floor's lattice points that differ, with the lookup moved by a part of a texel.
        let differing = |moved: f64| {
            let (steps, mut count) = (200, 0);
            let frame = *drawn.space().frame(0);
            let moved = moved * drawn.space().texel_world(DVec3::ZERO) * (frame.right + frame.up);
            for (i, j) in (0..steps).flat_map(|i| (0..steps).map(move |j| (i, j))) {
                let [x, y] = [i, j].map(|i| 6.0 * (f64::from(i) + 0.5) / f64::from(steps) - 3.0);
                let dark = (x + lx).abs() < 1.0 && (y + ly).abs() < 1.0;
                let value = drawn.value_at(DVec3::new(x, y, 0.0) + moved, DVec3::Z);
                count += u32::from((value < 0.5) != dark);
            }
            36.0 * f64::from(count) / f64::from(steps * steps)
        };
        let perimeter = 8.0;
        let found = differing(0.0);
        // The lattice resolves a boundary to half its spacing.
        assert!(found <= perimeter * (0.5 * texel + 0.015), "{found} of {}", perimeter * texel);
        all += found / (perimeter * texel);
        // The sabotage: the lookup is off by half a texel.
        all_moved += differing(0.5) / (perimeter * texel);
    }
    let [mean, moved] = [all, all_moved].map(|sum| sum / f64::from(cases));
    assert!(mean < 0.3 && moved > 1.3 * mean, "{mean} and {moved} of half a texel");
}

/// An L before each wall of a room, as no axis maps it to itself.
fn room() -> Caster {
    let solid = shapes::voxels([3, 3, 1], |[x, y, _]| x == 0 || y == 0 && x < 2);
    let mut meshes = vec![shapes::scaled(&shapes::cube(), 8.0)];
    for axis in 0..3 {
        for sign in [-1.0_f32, 1.0] {
            let positions = solid.positions().iter().map(|&[x, y, z]| {
                let mut p = [0.0; 3];
                (p[axis], p[(axis + 1) % 3], p[(axis + 2) % 3]) = (sign * (3.0 + z), x - 1.3, y - 1.4);
                p
            });
            meshes.push(Mesh::new(positions.collect(), solid.triangles().to_vec()).unwrap());
        }
    }
    Caster::new(Mesh::concat(&meshes).unwrap())
}

/// Points of the faces of a caster, evenly by face, with their normals: those that face the light and on
/// which the ray cast decides.
fn points(caster: &Caster, lamp: &Lamp, count: usize, seed: u64) -> Vec<(DVec3, DVec3, bool)> {
    let mut random = SplitMix64(seed);
    let mut found = Vec::new();
    while found.len() < count {
        let corners = caster.mesh().corners(FaceId::new(random.below(caster.mesh().face_count())));
        let side = side_of_light(corners, lamp.light());
        let Some(normal) = unit_normal(corners).filter(|_| !side.is_zero()) else { continue };
        let normal = normal * f64::from(side.value());
        let (mut u, mut v) = (random.unit(), random.unit());
        if u + v > 1.0 {
            (u, v) = (1.0 - u, 1.0 - v);
        }
        let [a, b, c] = corners.map(wide);
        let p = a + (b - a) * u + (c - a) * v;
        // Strictly before the face.
        let lifted = (p + 1e-5 * normal).as_vec3().to_array();
        match caster.oracle().verdict(lifted, lamp.light()) {
            Verdict::Grazing => {}
            verdict => found.push((wide(lifted), normal, verdict == Verdict::Lit)),
        }
    }
    found
}

fn wrong(drawn: &Drawn, points: &[(DVec3, DVec3, bool)]) -> usize {
    points.iter().filter(|&&(p, normal, lit)| (drawn.value_at(p, normal) >= 0.5) != lit).count()
}

#[test]
fn map_of_a_shape_without_symmetry_has_no_axis_flipped() {
    let caster = room();
    let casters = CasterGroup::new(vec![&caster]);
    // The room itself casts: directional lights see none of it.
    let shapes = Caster::new(room_without_walls());
    let open = CasterGroup::new(vec![&shapes]);
    for text in ["directional:0.3,-1,0.2", "spot:0.2,0.3,-0.1:1,0.1,0.1:50", "point:0.2,0.3,-0.1"] {
        let lamp = lamp(text);
        let (caster, casters) = if text.starts_with('d') { (&shapes, &open) } else { (&caster, &casters) };
        let drawn = drawn(casters, &lamp, &MapOptions { size: 256, ..MapOptions::DEFAULT });
        let inside = |p: &(DVec3, DVec3, bool)| {
            // Outside the cone a spot's map says nothing.
            drawn
                .space()
                .at(p.0)
                .is_some_and(|at| (0.0..256.0).contains(&at.tx) && (0.0..256.0).contains(&at.ty))
        };
        let points: Vec<_> = points(caster, &lamp, 3000, 17).into_iter().filter(inside).collect();
        let dark = points.iter().filter(|point| !point.2).count();
        let count = wrong(&drawn, &points);
        assert!(dark * 10 > points.len() && count * 20 < points.len(), "{text}: {count} of {}", points.len());
        // The sabotage: an axis of the lookup is flipped, or two layers are exchanged.
        let flips: [fn(&mut LightSpace); 3] = [
            |space| space.frames.iter_mut().for_each(|frame| frame.right = -frame.right),
            |space| space.frames.iter_mut().for_each(|frame| frame.up = -frame.up),
            |space| space.frames.swap(2, 3),
        ];
        for (index, flip) in
            flips.into_iter().enumerate().filter(|(index, _)| *index < 2 || text.starts_with('p'))
        {
            let mut space = *drawn.space();
            flip(&mut space);
            let count = wrong(&drawn.clone_in(space), &points);
            assert!(count * 12 > points.len(), "{text} {index}: {count} of {}", points.len());
        }
    }
}

fn room_without_walls() -> Mesh {
    let (positions, triangles, ..) = room().into_mesh().into_parts();
    Mesh::new(positions, triangles[12..].to_vec()).unwrap()
}

/// A plane through the seams of a cube: each tap beyond one is compared in its own layer.
#[test]
fn map_of_a_cube_has_no_seam_on_a_plane() {
    let square = shapes::translated(&shapes::scaled(&shapes::sheet(1), 12.0), [-6.0, -6.0, -0.7]);
    let tilted = square.positions().iter().map(|&[x, y, z]| [x, y, z + 0.1 * x]).collect();
    let caster = Caster::new(Mesh::new(tilted, square.triangles().to_vec()).unwrap());
    let casters = CasterGroup::new(vec![&caster]);
    let lamp = lamp("point:0.1,0.2,0.3");
    let corners = caster.mesh().corners(FaceId(0));
    let normal = unit_normal(corners).unwrap();
    let mut random = SplitMix64(9);
    for filter in [Filter::Bilinear, Filter::Box3, Filter::Box5, Filter::Poisson16] {
        for bias in Bias::ALL {
            let depth = if bias == Bias::Offset { DepthSource::Interpolated } else { DepthSource::Plane };
            let options = MapOptions { size: 48, bias, filter, depth, ..MapOptions::DEFAULT };
            let drawn = drawn(&casters, &lamp, &options);
            let space = *drawn.space();
            let (mut across, mut broken, mut broken_naively) = (0, 0, 0);
            for _ in 0..2500 {
                let [x, y] = [0; 2].map(|_| 6.0 * random.unit() - 3.0);
                let p = DVec3::new(x, y, -0.7 + 0.1 * x);
                broken += usize::from(drawn.value_at(p, normal) < 1.0);
                // The sabotage: the depth of the receiver's own layer, whatever the tap's.
                let receiver = Receiver::new(&space, p, normal).unwrap();
                let at = *receiver.lookup();
                filter.for_each_texel(at.tx, at.ty, |i, j, _| {
                    let tap = receiver.tap(i, j).unwrap();
                    if !tap.is_across {
                        return;
                    }
                    across += 1;
                    let naive = Tap { d: at.d, slope: [0.0; 2], is_across: false, ..tap };
                    broken_naively += usize::from(drawn.blocks_tap(&naive));
                });
            }
            assert_eq!(broken, 0, "{filter} {bias}");
            assert!(across > 100, "{across}");
            let is_flat = matches!(bias, Bias::Constant | Bias::Range | Bias::Offset);
            assert!(is_flat || broken_naively > 0, "{filter} {bias}");
        }
    }
}

/// Camera above the scene, at the size of a stamp.
fn view(casters: &CasterGroup<'_>, eye: [f32; 3], target: [f32; 3]) -> Samples {
    let size = Size::new(80, 60).unwrap();
    let camera = Camera::look_at(eye, target, 0.9, Up::Z).unwrap();
    Samples::of_view(casters, &camera.projection(size, 0.05), size, 1).unwrap()
}

fn floor_and(mesh: Mesh) -> Caster {
    let floor = shapes::translated(&shapes::scaled(&shapes::sheet(1), 12.0), [-6.0, -6.0, -3.0]);
    Caster::new(Mesh::concat(&[mesh, floor]).unwrap())
}

fn corpus() -> Vec<Caster> {
    let knot = shapes::torus_knot(2, 3, 60, 8, 0.4);
    let sponge = shapes::translated(&shapes::scaled(&shapes::menger_sponge(2), 0.4), [-1.8, -1.8, -1.8]);
    let open = shapes::mobius(24);
    let fine = shapes::icosphere(4);
    [knot, sponge, open, fine].map(floor_and).into()
}

const CORPUS_LAMPS: [&str; 3] = ["directional:0.7,0.2,-1", "point:-3,2,6", "spot:1,-2,7:-0.1,0.3,-1:50"];

#[test]
fn map_ids_are_never_falsely_dark_but_for_the_interior_clause() {
    let (mut wrong_lit, mut dropped) = (0, 0);
    for caster in corpus() {
        let casters = CasterGroup::new(vec![&caster]);
        let samples = view(&casters, [5.0, -8.0, 6.0], [0.0, 0.0, -1.0]);
        for text in CORPUS_LAMPS {
            let lamp = lamp(text);
            let request = Request { casters: &casters, lamp: &lamp, samples: &samples };
            let truth = Truth::of(&request);
            let made = Made { texel: Some(0.05), ..Made::default() };
            let options = ExactOptions { size: 200, reach: 1 };
            let shadow = IdShadow::prepare(&casters, &lamp, &options).unwrap();
            let tested = Errors::of(&request, &shadow.shade_with(&samples, false), &truth, &made);
            assert_eq!([tested.acne, tested.alias_dark, tested.turned_away], [0; 3], "{text}");
            let all = Errors::of(&request, &shadow.shade(&samples), &truth, &made);
            assert!(all.wrong <= tested.wrong && all.acne + all.alias_dark <= 2, "{text}: {all:?}");
            assert!(all.wrong * 20 < all.judged, "{text}: {all:?}");
            wrong_lit += tested.leak + tested.alias_lit;
            // The sabotage: a candidate is a shadow without a test.
            let untested = IdShadow::prepare(&casters, &lamp, &options).unwrap().without_test();
            let untested = Errors::of(&request, &untested.shade(&samples), &truth, &made);
            dropped += untested.acne + untested.alias_dark;
        }
    }
    assert!(wrong_lit > 0 && dropped > 1000, "{wrong_lit} {dropped}");
}

#[test]
fn hybrid_errs_by_lost_shadows_alone_and_one_texel_is_too_few() {
    let (mut asked, mut judged, mut one_texel) = (0, 0, 0);
    for caster in corpus() {
        let casters = CasterGroup::new(vec![&caster]);
        let samples = view(&casters, [5.0, -8.0, 6.0], [0.0, 0.0, -1.0]);
        for text in CORPUS_LAMPS {
            let lamp = lamp(text);
            let request = Request { casters: &casters, lamp: &lamp, samples: &samples };
            let truth = Truth::of(&request);
            let made = Made { texel: Some(0.05), ..Made::default() };
            let shadow =
                HybridShadow::prepare(&casters, &lamp, &ExactOptions { size: 256, reach: 1 }).unwrap();
            let visibility = shadow.shade(&samples);
            let errors = Errors::of(&request, &visibility, &truth, &made);
            assert_eq!([errors.acne, errors.alias_dark], [0; 2], "{text}: {errors:?}");
            assert!(errors.wrong * 100 < errors.judged, "{text}: {errors:?}");
            asked += visibility.asked_exactly();
            judged += errors.judged;
            // The sabotage: certain by one texel.
            one_texel +=
                Errors::of(&request, &shadow.shade_within(&samples, Around::Reach(0)), &truth, &made).wrong;
        }
    }
    assert!(asked > 0 && asked * 3 < judged, "{asked} of {judged}");
    assert!(one_texel > 100, "{one_texel}");
}

/// A camera that sees little of the floor, and a caster behind the eye.
#[test]
fn map_fitted_to_the_view_keeps_casters_behind_the_eye_and_is_finer() {
    let high = shapes::translated(&shapes::icosphere(2), [0.0, 0.0, 9.0]);
    let floor = shapes::translated(&shapes::scaled(&shapes::sheet(1), 64.0), [-32.0, -32.0, -3.0]);
    let far = [-29.0, 29.0].map(|x| shapes::translated(&shapes::cube(), [x, x, 0.0]));
    let caster = Caster::new(Mesh::concat(&[high, floor, far[0].clone(), far[1].clone()]).unwrap());
    let casters = CasterGroup::new(vec![&caster]);
    let samples = view(&casters, [0.5, -1.0, 0.5], [0.0, 0.0, -3.0]);
    let sun = lamp("directional:0.02,0.03,-1");
    let request = Request { casters: &casters, lamp: &sun, samples: &samples };
    let truth = Truth::of(&request);
    let dark = truth.verdicts().iter().filter(|verdict| **verdict == Some(Verdict::Shadowed)).count();
    assert!(dark > 300, "{dark}");
    let errors = |text: &str| {
        let technique: Technique = text.parse().unwrap();
        Errors::of(&request, &technique.shade(&request).unwrap(), &truth, &Made::default()).wrong
    };
    let [of_scene, of_view] = ["map:size=128", "map:size=128,fit=view"].map(errors);
    assert!(of_view * 4 < of_scene && of_view * 25 < dark as u64, "{of_view} and {of_scene} of {dark}");
    // What lies outside the map is lit.
    let space = LightSpace::of_scene(&casters, &sun, 128).unwrap().of_view(&samples, 1)[0];
    let rule = Rule::new(Bias::Receiver, Filter::Bilinear.reach(), DepthSource::Plane, &space);
    let drawn = Drawn::draw(&casters, sun.light(), &MapOptions::DEFAULT, space, rule).unwrap();
    for p in [[30.0, 0.0, -3.0], [0.0, -30.0, -3.0], [1e30, 0.0, 0.0]] {
        assert_eq!(drawn.value_at(DVec3::from(p), DVec3::Z), 1.0);
    }
    assert_eq!(drawn.value_at(DVec3::new(0.0, 0.0, -3.0), DVec3::Z), 0.0);
}

/// Cascades: finer where the view is near, and no seam between them in what is dark or lit throughout.
#[test]
fn map_cascades_have_no_seam_and_are_finer_near_the_eye() {
    // A lattice of plates over a long floor, and a roof over half of it that shades all below.
    let floor = shapes::translated(&shapes::scaled(&shapes::sheet(1), 96.0), [-48.0, -8.0, -3.0]);
    let roof = shapes::translated(&shapes::scaled(&shapes::sheet(1), 90.0), [-90.0, -8.0, 6.0]);
    let mut meshes = vec![floor, roof];
    for k in 0..12_u16 {
        let plate = shapes::scaled(&shapes::sheet(1), 1.5);
        meshes.push(shapes::translated(&plate, [1.5, 5.0 * f32::from(k), 0.0]));
    }
    let caster = Caster::new(Mesh::concat(&meshes).unwrap());
    let casters = CasterGroup::new(vec![&caster]);
    let sun = lamp("directional:0.01,0.02,-1");
    let samples = view(&casters, [0.5, -4.0, -1.0], [0.5, 20.0, -3.0]);
    let request = Request { casters: &casters, lamp: &sun, samples: &samples };
    let truth = Truth::of(&request);
    let wrong = |text: &str| {
        let technique: Technique = text.parse().unwrap();
        Errors::of(&request, &technique.shade(&request).unwrap(), &truth, &Made::default()).wrong
    };
    let [scene, one, three] =
        ["", ",fit=view", ",fit=view,cascades=3"].map(|fit| wrong(&format!("map:size=96{fit}")));
    assert!(4 * three < 3 * scene && three < one, "{scene} {one} {three}");
    let mut naive = 0;
    let is_below = |[x, y, z]: [f32; 3]| x < -8.0 && (-3.0..70.0).contains(&y) && z < -2.0;
    for filter in [Filter::Bilinear, Filter::Box5, Filter::Poisson16] {
        for bias in [Bias::Receiver, Bias::Normal] {
            let options = MapOptions { size: 96, filter, bias, ..MapOptions::DEFAULT };
            let scene = drawn(&casters, &sun, &options);
            let maps: Vec<Drawn> = (scene.space().of_view(&samples, 3).into_iter())
                .map(|space| {
                    let rule = Rule::new(bias, filter.reach(), options.depth, &space);
                    Drawn::draw(&casters, sun.light(), &options, space, rule).unwrap()
                })
                .collect();
            assert!(maps.len() >= 2, "{}", maps.len());
            assert!(maps.windows(2).all(|pair| texel(&pair[0]) < texel(&pair[1])));
            // Seen points, and points of the floor along the borders of the squares.
            let mut points: Vec<DVec3> = samples.hits().iter().flatten().map(|hit| wide(hit.point)).collect();
            for map in &maps {
                let plane = map.space().plane(0, DVec3::Z, DVec3::new(0.0, 0.0, -3.0));
                for k in 0..600_u16 {
                    let (across, along) = (0.005 * f64::from(k), f64::from(k % 96) + 0.3);
                    for [tx, ty] in
                        [[across, along], [96.0 - across, along], [along, across], [along, 96.0 - across]]
                    {
                        points.push(map.space().point(0, tx, ty, plane.at(tx, ty)));
                    }
                }
            }
            let mut checked = 0;
            for p in points.into_iter().filter(|p| is_below(p.as_vec3().into())) {
                let up = DVec3::Z;
                let map = maps.iter().find(|map| map.holds(p)).unwrap_or(&scene);
                assert_eq!(map.value_at(p, up), 0.0, "{filter} {bias} {p}");
                checked += 1;
                // The sabotage: the first map on which the position lies, whatever its filter reads.
                let at = |map: &&Drawn| map.space().at(p).is_some_and(|at| map.space().shows(&at));
                let map = maps.iter().find(at).unwrap_or(&scene);
                naive += u32::from(map.value_at(p, up) > 0.0);
            }
            assert!(checked > 200, "{filter} {bias} {checked}");
        }
    }
    assert!(naive > 5, "{naive}");
}

fn texel(map: &Drawn) -> f64 {
    map.space().texel_world(DVec3::ZERO)
}

/// The camera moves by a third of a texel: no verdict of a point changes.
#[test]
fn map_fitted_to_the_view_is_stable_under_motion_of_the_camera() {
    let caster = floor_and(shapes::torus_knot(2, 3, 60, 8, 0.4));
    let far = Caster::new(
        Mesh::concat(&[caster.mesh().clone(), shapes::translated(&shapes::cube(), [60.0, 50.0, -3.0])])
            .unwrap(),
    );
    let casters = CasterGroup::new(vec![&far]);
    let sun = lamp("directional:0.4,0.3,-1");
    let scene = LightSpace::of_scene(&casters, &sun, 256).unwrap();
    let first = view(&casters, [1.0, -2.0, 2.0], [0.0, 0.0, -2.0]);
    let space = scene.of_view(&first, 1)[0];
    let texel = space.texel_world(DVec3::ZERO);
    let draw = |space| {
        let rule = Rule::new(Bias::Receiver, Filter::Bilinear.reach(), DepthSource::Plane, &space);
        Drawn::draw(&casters, sun.light(), &MapOptions::DEFAULT, space, rule).unwrap()
    };
    let still = draw(space);
    let points: Vec<(DVec3, DVec3)> = first
        .hits()
        .iter()
        .flatten()
        .filter(|hit| side_of_light(hit.corners, sun.light()) == hit.side)
        .map(|hit| (wide(hit.point), unit_normal(hit.corners).unwrap() * f64::from(hit.side.value())))
        .collect();
    let differing = |other: &Drawn| {
        let lit = |drawn: &Drawn, (p, normal): (DVec3, DVec3)| drawn.value_at(p, normal) >= 0.5;
        points.iter().filter(|&&point| lit(&still, point) != lit(other, point)).count()
    };
    let (mut moved_maps, mut naive) = (0, 0);
    for step in 1..=6_u16 {
        let by = (f64::from(step) * texel / 3.0) as f32;
        let moved = view(&casters, [1.0 + by, -2.0, 2.0], [by, 0.0, -2.0]);
        let space = scene.of_view(&moved, 1)[0];
        assert_eq!(space.spread(), still.space().spread());
        moved_maps += usize::from(space.origin() != still.space().origin());
        assert_eq!(differing(&draw(space)), 0, "{step}");
        // The sabotage: the square follows the camera, without whole texels.
        let shift = f64::from(step) / 3.0 * texel * space.frame(0).right;
        naive += differing(&draw(LightSpace { origin: still.space().origin() + shift, ..space }));
    }
    assert!(moved_maps > 0 && naive > 50, "{moved_maps} {naive}");
}

#[test]
fn map_of_lamps_and_scenes_at_the_limits_is_right_or_refused() {
    let value = |caster: &Caster, text: &str, p: [f64; 3], normal: DVec3| {
        let casters = CasterGroup::new(vec![caster]);
        drawn(&casters, &lamp(text), &MapOptions { size: 64, ..MapOptions::DEFAULT })
            .value_at(DVec3::from(p), normal)
    };
    // At 1e30 and at 1e−30 the picture is that at 1.
    for scale in [1.0_f32, 1e30, 1e-30] {
        let caster = plate_over_floor();
        let caster = Caster::new(shapes::scaled(caster.mesh(), scale));
        let s = f64::from(scale);
        for text in [format!("point:0,0,{}", 4.0 * scale), "directional:0,0,-1".to_owned()] {
            assert_eq!(value(&caster, &text, [0.1 * s, 0.2 * s, 0.0], DVec3::Z), 0.0, "{text}");
            assert_eq!(value(&caster, &text, [3.0 * s, 2.5 * s, 0.0], DVec3::Z), 1.0, "{text}");
        }
    }
    // No casters: lit. A light at the point itself: lit.
    let empty = Caster::new(Mesh::default());
    assert_eq!(value(&empty, "point:0,0,4", [0.0; 3], DVec3::Z), 1.0);
    assert_eq!(value(&empty, "directional:0,0,-1", [0.0; 3], DVec3::Z), 1.0);
    assert_eq!(value(&plate_over_floor(), "point:0,0,0", [0.0; 3], DVec3::Z), 1.0);
    // A light on the mesh, just above the plate: what is below it is dark, the plate is lit.
    let caster = plate_over_floor();
    assert_eq!(value(&caster, "point:0.1,0.2,1.001", [0.3, 0.3, 0.0], DVec3::Z), 0.0);
    assert_eq!(value(&caster, "point:0.1,0.2,1.001", [0.3, 0.3, 1.0], DVec3::Z), 1.0);
    // Sizes: one texel is a map; none, or more than there may be, is an error that names the option.
    let casters = CasterGroup::new(vec![&caster]);
    let prepare = |text: &str, lamp: &str| {
        let technique: Technique = text.parse().unwrap();
        technique.prepare(&casters, &self::lamp(lamp)).map(|_| ()).map_err(|error| error.to_string())
    };
    assert_eq!(prepare("map:size=1", "point:0,0,4"), Ok(()));
    let error = prepare("map:size=16384", "point:0,0,4").unwrap_err();
    assert!(error.starts_with("map:size=16384: size=16384 takes 6144 MiB in 6 layers"), "{error}");
    let error = prepare("hybrid-3x3:size=16384", "spot:0,0,4:0,0,-1:80").unwrap_err();
    assert!(error.contains("6144 MiB in 6 layers"), "{error}");
    let offset = MapOptions { bias: Bias::Offset, ..MapOptions::DEFAULT };
    let refused = MapShadow::prepare(&casters, &lamp("point:0,0,4"), &offset).unwrap_err();
    assert_eq!(refused, MapError::OffsetOfPlane);
    let none = ExactOptions { reach: 0, ..ExactOptions::DEFAULT };
    assert_eq!(
        IdShadow::prepare(&casters, &lamp("point:0,0,4"), &none).unwrap_err(),
        MapError::Reach { reach: 0 }
    );
}
