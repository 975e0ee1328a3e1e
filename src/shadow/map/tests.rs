//! Tests of light spaces and of the rasterizer.

use glam::DVec3;

use super::raster::{SUBTEXELS, triangles};
use super::space::{unit_normal, wide};
use super::*;
use crate::caster::{Caster, CasterGroup};
use crate::geom::Light;
use crate::mesh::Mesh;
use crate::random::SplitMix64;
use crate::scene::Lamp;
use crate::testing::shapes;

/// A parallel space, a spot's and a cube's.
pub(super) const LAMPS: [&str; 4] = [
    "directional:0.3,-1,0.2",
    "spot:1,9,2:-0.1,-1,-0.2:35,20",
    "point:0.3,6,-1",
    "directional:0,-1,0", // along the axis that `up` prefers
];

pub(super) fn lamp(text: &str) -> Lamp {
    text.parse().unwrap()
}

/// A knot and a tilted sheet below it.
pub(super) fn scene() -> Caster {
    let sheet = shapes::translated(&shapes::scaled(&shapes::sheet(3), 2.0), [-3.0, -3.0, -2.0]);
    // From the plane z = −2 to one that rises with x.
    let tilted = sheet.positions().iter().map(|&[x, y, z]| [x, z + 0.125 * x, y]).collect();
    let sheet = Mesh::new(tilted, sheet.triangles().to_vec()).unwrap();
    Caster::new(Mesh::concat(&[shapes::torus_knot(2, 3, 40, 7, 0.4), sheet]).unwrap())
}

#[test]
fn space_finds_points_where_it_puts_them() {
    let caster = scene();
    let casters = CasterGroup::new(vec![&caster]);
    let mut random = SplitMix64(7);
    for text in LAMPS {
        let space = LightSpace::of_scene(&casters, &lamp(text), 64).unwrap();
        for _ in 0..400 {
            let layer = random.below(space.layers());
            let [tx, ty] = [random.unit() * 64.0, random.unit() * 64.0];
            let d = 0.01 + 0.99 * random.unit();
            let p = space.point(layer, tx, ty, d);
            let found = space.at(p).unwrap();
            assert_eq!(found.layer, layer, "{text}");
            let error = [found.tx - tx, found.ty - ty, (found.d - d) / d].map(f64::abs);
            assert!(error.iter().all(|&error| error < 1e-10), "{text} {found:?}: {error:?}");
        }
        // Rows of the picture: upwards in clip space is to the first texel row; the frame is orthonormal.
        let Frame { right, up, axis } = *space.frame(0);
        let ahead = space.point(0, 32.0, 32.0, 0.5);
        let [beside, above] = [right, up].map(|row| space.at(ahead + 0.01 * row).unwrap());
        assert!(beside.tx > 32.0 && above.ty < 32.0, "{text}");
        let products =
            [right.dot(up), right.dot(axis), up.dot(axis), right.length() - 1.0, up.length() - 1.0];
        assert!(products.iter().all(|x| x.abs() < 1e-12));
        // Texels are fixed to the light: another scene, the same rows.
        let other = Caster::new(shapes::cube());
        let other = LightSpace::of_scene(&CasterGroup::new(vec![&other]), &lamp(text), 32).unwrap();
        assert_eq!(other.frame(0), space.frame(0));
    }
}

#[test]
fn space_slope_is_the_change_of_depth_between_points_of_a_plane() {
    let caster = scene();
    let casters = CasterGroup::new(vec![&caster]);
    let mut random = SplitMix64(11);
    for text in LAMPS {
        let space = LightSpace::of_scene(&casters, &lamp(text), 256).unwrap();
        for _ in 0..300 {
            let p = DVec3::from([0; 3].map(|_| 4.0 * random.unit() - 2.0));
            let normal = DVec3::from([0; 3].map(|_| random.unit() - 0.5)).normalize();
            let Some(at) = space.at(p) else { continue };
            let (slope, plane) = (space.slope(at.layer, normal, p), space.plane(at.layer, normal, p));
            if slope[0].abs() + slope[1].abs() > 1.0 {
                continue; // nearly edge-on
            }
            assert!((plane.at(at.tx, at.ty) - at.d).abs() < 1e-9, "{text}");
            let aside = normal.any_orthonormal_vector();
            for along in [aside, normal.cross(aside)] {
                let q = p + 0.05 * along;
                let Some(other) = space.at_layer(at.layer, q) else { continue };
                let expected = slope[0] * (other.tx - at.tx) + slope[1] * (other.ty - at.ty);
                assert!((other.d - at.d - expected).abs() < 1e-9 * (1.0 + other.d), "{text}");
                // The sabotage: a forgotten flip of the rows.
                let flipped = slope[0] * (other.tx - at.tx) - slope[1] * (other.ty - at.ty);
                let visible = (slope[1] * (other.ty - at.ty)).abs() > 1e-6;
                assert!(!visible || (other.d - at.d - flipped).abs() > 1e-7);
            }
        }
    }
}

#[test]
fn space_of_a_scene_holds_the_scene_and_its_near_distance_lies_before_every_caster() {
    let caster = scene();
    let casters = CasterGroup::new(vec![&caster]);
    for text in LAMPS {
        let space = LightSpace::of_scene(&casters, &lamp(text), 64).unwrap();
        // The sheet lies below the knot, before nothing: the first 560 faces are the knot's.
        for &[v, ..] in &caster.mesh().triangles()[..560] {
            let at = space.at(wide(caster.mesh().positions()[v as usize])).unwrap();
            assert!(at.d > 0.0 && at.d < 1.0, "{text} {at:?}");
            if !text.starts_with("spot") {
                // Two texels are free around a parallel map. A cube has no rim.
                let rim = if space.layers() == 1 { 2.0 } else { 0.0 };
                let inside = rim - 1e-9..=64.0 - rim + 1e-9;
                assert!(inside.contains(&at.tx) && inside.contains(&at.ty), "{text} {at:?}");
            }
        }
    }
    // A large ground with nothing behind it leaves the texels as they are; with a second ground behind it the
    // map covers the first ground, and texels grow.
    let half = |meshes: &[Mesh]| {
        let caster = Caster::new(Mesh::concat(meshes).unwrap());
        let casters = CasterGroup::new(vec![&caster]);
        let space = LightSpace::of_scene(&casters, &lamp("directional:0.3,0.1,-1"), 64).unwrap();
        assert!(
            caster.mesh().positions().iter().all(|&p| (0.0..1.0).contains(&space.at(wide(p)).unwrap().d))
        );
        space.texel_world(DVec3::ZERO)
    };
    let ground = shapes::translated(&shapes::scaled(&shapes::sheet(1), 512.0), [-256.0, -256.0, -1.0]);
    let below = shapes::translated(&ground, [0.0, 0.0, -1.0]);
    let alone = half(&[shapes::cube()]);
    assert_eq!(half(&[shapes::cube(), ground.clone()]), alone);
    assert!(half(&[shapes::cube(), ground, below]) > 50.0 * alone);
    // The nearest part of a face may be its inside: a plate before the light, far larger than its distance.
    let plate =
        Caster::new(shapes::translated(&shapes::scaled(&shapes::sheet(1), 64.0), [-30.0, -30.0, 0.0]));
    let plates = CasterGroup::new(vec![&plate]);
    let space = LightSpace::of_scene(&plates, &lamp("point:0,0,0.5"), 64).unwrap();
    let Spread::Central { near, .. } = space.spread() else { panic!("a cube") };
    assert!((near - 0.99 * 0.5).abs() < 1e-12, "{near}");
}

#[test]
fn space_takes_a_cube_where_a_cone_is_wide() {
    let caster = scene();
    let casters = CasterGroup::new(vec![&caster]);
    let layers = |text: &str| LightSpace::of_scene(&casters, &lamp(text), 16).unwrap().layers();
    assert_eq!(layers("spot:0,9,0:0,-1,0:67"), 1);
    for wide in ["spot:0,9,0:0,-1,0:68", "spot:0,9,0:0,-1,0:89.9", "spot:0,9,0:0,-1,0:90", "point:0,9,0"] {
        assert_eq!(layers(wide), 6, "{wide}");
    }
    for size in [0, MAX_SIZE + 1, u32::MAX] {
        let error = LightSpace::of_scene(&casters, &lamp(LAMPS[0]), size).unwrap_err();
        assert_eq!(error, MapError::Size { size });
        assert!(error.to_string().starts_with(&format!("size={size} ")), "{error}");
    }
}

/// The penumbra law: what K does when map, light or near distance change.
#[test]
fn space_penumbra_scale_doubles_with_the_map_and_with_the_light_and_near_cancels() {
    let caster = scene();
    let casters = CasterGroup::new(vec![&caster]);
    for text in &LAMPS[..3] {
        let of =
            |size, extent| LightSpace::of_scene(&casters, &lamp(text), size).unwrap().penumbra_scale(extent);
        // The free rim is a smaller part of a larger map.
        let ratio = of(2048, 0.1) / of(1024, 0.1);
        assert!((ratio - 2.0).abs() < 0.01, "{text} {ratio}");
        assert_eq!(of(1024, 0.25), 2.0 * of(1024, 0.125));
        // A half-plane at depth b over a receiver at depth r, seen from the light's rim: the shift in texels.
        let space = LightSpace::of_scene(&casters, &lamp(text), 1024).unwrap();
        let extent = 0.125;
        let k = space.penumbra_scale(extent);
        let frame = *space.frame(0);
        let blocker = space.point(0, 500.0, 500.0, 0.75);
        let rim = match space.spread() {
            Spread::Central { .. } => (blocker - space.origin() - extent * frame.right).normalize(),
            Spread::Parallel { .. } => (-frame.axis - extent * frame.right).normalize(),
        };
        // On along that ray until depth ½.
        let [mut low, mut high] = [0.0, 1e4];
        for _ in 0..200 {
            let middle = 0.5 * (low + high);
            let deep = space.at_layer(0, blocker + middle * rim).is_none_or(|at| at.d < 0.5);
            *(if deep { &mut high } else { &mut low }) = middle;
        }
        let met = space.at_layer(0, blocker + low * rim).unwrap();
        let shift = 500.0 - met.tx;
        assert!((shift - k * (0.75 - 0.5)).abs() < 1e-6, "{text}: {shift} and {}", k * 0.25);
        // The sabotage: a mean of linear distances instead of depths.
        if let Spread::Central { near, .. } = space.spread() {
            let linear = near * near * (1.0 / 0.5 - 1.0 / 0.75) * 0.5 * 0.75 / near;
            let wrong = k * near / (0.5 * (near / 0.5 + near / 0.75));
            assert!((wrong - k * linear).abs() > 0.01 * k);
        }
    }
}

/// Coverage of a center, written down without the top-left rule: the center is moved to the right by far less
/// than a unit, and downwards by far less than that, so that it never lies on an edge.
fn covers(corners: [[i64; 2]; 3], i: i64, j: i64) -> bool {
    let scale = |x: i64| i128::from(x) << 64;
    let center = [scale(SUBTEXELS * i + SUBTEXELS / 2) + (1 << 32), scale(SUBTEXELS * j + SUBTEXELS / 2) + 1];
    let sides = [0, 1, 2].map(|k| {
        let [p, q] = [corners[k], corners[(k + 1) % 3]];
        let [dx, dy] = [0, 1].map(|axis| i128::from(q[axis] - p[axis]));
        dx * (center[1] - scale(p[1])) - dy * (center[0] - scale(p[0]))
    });
    sides.iter().all(|&side| side > 0) || sides.iter().all(|&side| side < 0)
}

#[test]
fn raster_equals_a_loop_over_all_faces_per_texel() {
    let meshes = [
        scene().into_mesh(),
        shapes::menger_sponge(1),
        shapes::double_sheet(),
        shapes::icosphere(2),
        shapes::nested_cubes(3),
    ];
    let mut covered = 0;
    for mesh in meshes {
        let caster = Caster::new(mesh);
        let casters = CasterGroup::new(vec![&caster]);
        for (text, source) in LAMPS
            .into_iter()
            .flat_map(|text| [DepthSource::Plane, DepthSource::Interpolated].map(|s| (text, s)))
        {
            let (lamp, size) = (lamp(text), 37);
            let space = LightSpace::of_scene(&casters, &lamp, size).unwrap();
            let offset = PolygonOffset::default();
            let named = ShadowMap::<Named>::draw(&casters, lamp.light(), space, source, offset).unwrap();
            let plain = ShadowMap::<f32>::draw(&casters, lamp.light(), space, source, offset).unwrap();
            let layered = ShadowMap::<Layered>::draw(&casters, lamp.light(), space, source, offset).unwrap();
            for layer in 0..space.layers() {
                let all = triangles(&casters, lamp.light(), &space, layer, source, offset);
                for (j, i) in (0..i64::from(size)).flat_map(|j| (0..i64::from(size)).map(move |i| (j, i))) {
                    let mut depths: Vec<(f32, u32)> = all
                        .iter()
                        .filter(|triangle| covers(triangle.corners, i, j))
                        .map(|triangle| (triangle.depth_at(i, j), triangle.face))
                        .collect();
                    depths.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
                    let first = depths.first().copied();
                    let second = depths.iter().find(|depth| Some(depth.0) < first.map(|first| first.0));
                    let texel = named.texel(layer, i, j).unwrap();
                    assert_eq!(
                        (texel.depth(), texel.face()),
                        (first.map_or(0.0, |f| f.0), first.map(|f| f.1))
                    );
                    assert_eq!(plain.texel(layer, i, j), Some(&texel.depth()));
                    let layered = layered.texel(layer, i, j).unwrap();
                    assert_eq!(
                        (layered.depth(), layered.second()),
                        (texel.depth(), second.map_or(0.0, |s| s.0))
                    );
                    covered += u32::from(first.is_some());
                }
            }
            assert_eq!(named.texel(0, -1, 0), None);
            assert_eq!(named.texel(space.layers(), 0, 0), None);
        }
    }
    assert!(covered > 20_000, "{covered}");
}

/// The exact ray cast along the light's ray through each texel's center: the same depth, the same face, but
/// where an edge passes within the snapping.
#[test]
fn raster_equals_the_exact_ray_cast_through_texel_centers() {
    let caster = scene();
    let casters = CasterGroup::new(vec![&caster]);
    for text in LAMPS {
        let (lamp, size) = (lamp(text), 96);
        let space = LightSpace::of_scene(&casters, &lamp, size).unwrap();
        let map = ShadowMap::<Named>::draw(
            &casters,
            lamp.light(),
            space,
            DepthSource::Plane,
            PolygonOffset::default(),
        )
        .unwrap();
        let (mut same, mut different) = (0, 0);
        for layer in 0..space.layers() {
            for (j, i) in (0..size).flat_map(|j| (0..size).map(move |i| (j, i))) {
                let [from, direction] = space.ray(layer, i, j).map(|v| v.as_vec3().to_array());
                let hit = caster.oracle().first_hit(from, direction);
                let texel = map.texel(layer, i64::from(i), i64::from(j)).unwrap();
                // Neighbors of the same depth may share an edge here, so the face may be the next one.
                let depth = hit.map_or(0.0, |hit| {
                    let at = wide(from) + hit.t * wide(direction);
                    let lookup = space.at_layer(layer, at).unwrap();
                    let normal = unit_normal(caster.mesh().corners(hit.face)).unwrap();
                    let plane = space.plane(layer, normal, wide(caster.mesh().corners(hit.face)[0]));
                    assert!((plane.at(lookup.tx, lookup.ty) - lookup.d).abs() < 1e-5 * lookup.d);
                    plane.at(f64::from(i) + 0.5, f64::from(j) + 0.5)
                });
                // The ray is rounded to f32: to 2⁻²⁴ of coordinates up to 10, over slopes up to 100.
                let equal = (f64::from(texel.depth()) - depth).abs() <= 1e-5 * depth;
                *(if equal { &mut same } else { &mut different }) += 1;
            }
        }
        // A center lies within 1/256 texel of an edge in few texels.
        assert!(different * 200 < same, "{text}: {different} of {same}");
    }
}

#[test]
fn raster_of_a_light_on_a_face_or_inside_the_mesh_loses_no_other_face() {
    // A light inside a closed shape: every texel of all six layers is covered. (An even side: no center lies
    // in a plane of the axes, where a face that nearly contains the light covers a center by its snapping
    // alone.)
    for (mesh, at) in [
        (shapes::icosphere(2), "point:0.2,-0.3,0.1"),
        (shapes::cube(), "point:0.999999,0.1,0.2"), // as near to a face as it gets
        (shapes::cube(), "point:0.999,0.999,0.999"),
        (shapes::scaled(&shapes::cube(), 1e30), "point:3e29,1e29,-5e29"),
        (shapes::scaled(&shapes::cube(), 1e-30), "point:3e-31,1e-31,-5e-31"),
    ] {
        let caster = Caster::new(mesh);
        let casters = CasterGroup::new(vec![&caster]);
        let lamp = lamp(at);
        let space = LightSpace::of_scene(&casters, &lamp, 34).unwrap();
        let depth = |lamp: &Lamp, space| {
            let (source, offset) = (DepthSource::Plane, PolygonOffset::default());
            ShadowMap::<f32>::draw(&casters, lamp.light(), space, source, offset).unwrap()
        };
        let map = depth(&lamp, space);
        assert!(map.texels().iter().all(|&d| d > 0.0), "{at}");
    }
    // A light in the plane of one side: this side casts no shadow, the other five are complete.
    let caster = Caster::new(shapes::cube());
    let casters = CasterGroup::new(vec![&caster]);
    let lamp = lamp("point:1,0.1,0.2");
    let space = LightSpace::of_scene(&casters, &lamp, 34).unwrap();
    let map = ShadowMap::<f32>::draw(
        &casters,
        &Light::point([1.0, 0.1, 0.2]).unwrap(),
        space,
        DepthSource::Plane,
        PolygonOffset::default(),
    )
    .unwrap();
    let empty =
        (0..6).map(|layer| map.texels()[layer * 34 * 34..][..34 * 34].iter().filter(|d| **d == 0.0).count());
    let empty: Vec<usize> = empty.collect();
    assert_eq!(empty[..2], [34 * 34, 0]); // towards +x nothing, towards −x the opposite side
    assert!(empty[2..].iter().all(|&count| count < 34 * 34 * 2 / 3), "{empty:?}");
}
