//! Volumes that are written to files: closed, and as far as they say they hold the whole shadow.

use umbrage::caster::Caster;
use umbrage::geom::{Aabb, Light};
use umbrage::mesh::{FaceId, Mesh, Weld, weld};
use umbrage::oracle::{Oracle, Verdict};
use umbrage::scene::Scope;
use umbrage::shadow::volume::{Caps, FiniteVolume};
use umbrage::testing::shapes;
use umbrage::write::{Elements, Layer, Model, write};

use super::figures::*;

/// Numbers from −1 to 1.
struct Random(u64);

impl Random {
    fn next(&mut self) -> f32 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 40) as f32 / (1 << 23) as f32 - 1.0
    }
}

fn bounds(mesh: &Mesh) -> Aabb {
    Aabb::around(mesh.positions().iter().copied())
}

/// The volume as a file holds it, read back and welded.
fn read_back(volume: &FiniteVolume, name: &str) -> Mesh {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    let part = |range: &std::ops::Range<usize>| Layer {
        positions: volume.positions.clone(),
        elements: Elements::Triangles(volume.triangles[range.clone()].to_vec()),
        ..Layer::default()
    };
    let layers = [&volume.light_cap, &volume.sides, &volume.dark_cap].map(part).to_vec();
    write(&Model { layers }, &path).unwrap();
    let mesh = umbrage::read::read(&path).unwrap().bake(Scope::Scene).unwrap().remove(0);
    weld(&mesh, Weld::Exact).mesh
}

/// The winding number of a closed mesh at a point: crossings outwards less crossings inwards.
fn winding(oracle: &Oracle, p: [f32; 3]) -> i64 {
    let sky = Light::directional([0.123, -0.456, 0.789]).unwrap();
    let crossings = oracle.crossings(p, &sky);
    assert_eq!(crossings.touching, 0, "{p:?}");
    i64::from(crossings.front) - i64::from(crossings.back)
}

/// Shadowed points within `distance` of the caster, and how many of them the written volume does not hold.
fn shadowed_and_missed(caster: &Caster, light: &Light, written: &Mesh, distance: f32) -> [usize; 2] {
    let (mut random, hull) = (Random(5), bounds(caster.mesh()));
    let oracle = Oracle::build(written);
    let mut counts = [0; 2];
    let mesh = caster.mesh();
    let reach = distance + hull.diagonal() as f32;
    for face in (0..mesh.face_count()).cycle().take(4000).map(FaceId::new) {
        // Somewhere behind a point of a face.
        let ([a, b, c], [u, v]) = (mesh.corners(face), [(); 2].map(|()| random.next().abs()));
        let [u, v] = if u + v > 1.0 { [1.0 - u, 1.0 - v] } else { [u, v] };
        let on = [0, 1, 2].map(|i| a[i] + u * (b[i] - a[i]) + v * (c[i] - a[i]));
        let light_at = light.xyz();
        let away = match light.is_directional() {
            true => light_at.map(|x| -x),
            false => [0, 1, 2].map(|i| on[i] - light_at[i]),
        };
        let length = away.iter().map(|x| x * x).sum::<f32>().sqrt();
        let far = random.next().abs() * reach / length;
        let p = [0, 1, 2].map(|i| on[i] + far * away[i]);
        let beside = |i: usize| (p[i] - p[i].clamp(hull.low[i], hull.high[i])).powi(2);
        let away = (beside(0) + beside(1) + beside(2)).sqrt();
        if away < distance && caster.oracle().verdict(p, light) == Verdict::Shadowed {
            counts[0] += 1;
            counts[1] += usize::from(winding(&oracle, p) < 1);
        }
    }
    counts
}

fn casters() -> [(&'static str, Mesh); 7] {
    [
        ("box", shapes::cuboid([-0.5; 3], [0.5; 3])),
        ("slab", shapes::cuboid([-5.0, -0.1, -5.0], [5.0, 0.1, 5.0])),
        ("torus", shapes::torus(24, 12, 2.0, 0.7)),
        ("sheet", shapes::sheet(3)),
        ("box far out", shapes::cuboid([999.5, -0.5, -0.5], [1000.5, 0.5, 0.5])),
        (
            "two shells",
            Mesh::concat(&[shapes::icosphere(1), shapes::cuboid([0.5, 2.0, 0.2], [1.5, 2.5, 1.0])]).unwrap(),
        ),
        ("sheets on an edge", shapes::book(3)),
    ]
}

/// Guards against a directional light's volume as a pyramid to one point, and against a point light's cap that
/// bends towards the caster: both lose shadow that lies well within the stated distance.
#[test]
fn hard_29_written_volume_is_closed_and_holds_every_shadowed_point_that_it_covers() {
    for (name, mesh) in casters() {
        let (hull, caster) = (bounds(&mesh), Caster::new(mesh.clone()));
        let (center, diagonal) = (hull.center(), hull.diagonal() as f32);
        let from_center = |by: [f32; 3]| point(center[0] + by[0], center[1] + by[1], center[2] + by[2]);
        let over = hull.high[1] - center[1];
        let lights = [
            sun(0.3, -1.0, 0.1),
            sun(0.0, -1.0, 0.0),
            from_center([0.01, over + 0.05, 0.02]),
            from_center([0.3 * diagonal, over + 0.5 * diagonal, 0.4 * diagonal]),
            from_center([30.0 * diagonal, 50.0 * diagonal, -20.0 * diagonal]),
            from_center([0.01, 0.02, 0.03]),
        ];
        for light in lights {
            let distance = 2.0 * diagonal;
            let volume = caster.volume(&light, Caps::Both);
            let finite = volume.finite(distance, &hull);
            assert_eq!(finite.covers, f64::from(distance), "{name} {light}");
            if finite.triangles.is_empty() {
                continue;
            }
            for file in ["a.obj", "a.ply", "a.glb"] {
                let written = read_back(&finite, file);
                let found = report(&written).counts;
                assert!(found.balanced && found.boundary_edges == 0, "{name} {light} {file}: {found:?}");
                let [shadowed, missed] = shadowed_and_missed(&caster, &light, &written, distance);
                assert!(missed == 0, "{name} {light} {file}: {missed} of {shadowed} points missed");
                assert!(shadowed > 500, "{name} {light}: {shadowed}");
            }
            // Negative test: what ends at an eighth of the distance does not hold it.
            let short = read_back(&caster.volume(&light, Caps::Both).finite(0.01 * diagonal, &hull), "a.ply");
            let [_, missed] = shadowed_and_missed(&caster, &light, &short, 4.0 * distance);
            assert!(missed > 0, "{name} {light}: nothing is missed");
        }
    }
}

/// Guards against promises beyond f32: a volume that has to end earlier says so.
#[test]
fn hard_29_written_volume_says_what_it_covers_at_the_end_of_f32() {
    for size in [1e30_f32, 1e37, 3.4e38] {
        let mesh = shapes::scaled(&shapes::cube(), size);
        let (hull, caster) = (bounds(&mesh), Caster::new(mesh));
        for light in
            [sun(0.3, -1.0, 0.1), point(0.5 * size, 1.0 * size, 0.0), point(size, size.next_up(), size)]
        {
            let finite = caster.volume(&light, Caps::Both).finite(f32::MAX, &hull);
            assert!(finite.positions.iter().flatten().all(|x| x.is_finite()), "{size} {light}");
            let most = f64::from(f32::MAX);
            assert!((0.0..=most).contains(&finite.covers), "{size} {light}");
            assert!(size < 1e31 || finite.covers < most, "{size} {light}: {}", finite.covers);
            assert!(size > 1e31 || finite.covers > f64::from(size), "{size} {light}: {}", finite.covers);
        }
    }
    // Nothing casts: nothing is missing.
    let empty = Caster::new(Mesh::new(Vec::new(), Vec::new()).unwrap());
    let finite = empty.volume(&sun(0.0, -1.0, 0.0), Caps::Both).finite(5.0, &Aabb::EMPTY);
    assert_eq!((finite.covers, finite.positions.len()), (5.0, 0));
}
