//! Generated scenes of six families, with lamps inside, outside and on them, and with views.

use crate::mesh::Mesh;
use crate::random::SplitMix64;
use crate::scene::Lamp;
use crate::testing::scenes::{Place, city};
use crate::testing::shapes;
use crate::view::{Camera, Projection, Size, Up};

/// A scene with its lamps and cameras.
pub(super) struct Family {
    pub(super) name: &'static str,
    pub(super) casters: Vec<Mesh>,
    pub(super) lamps: Vec<Lamp>,
    pub(super) cameras: Vec<Camera>,
}

pub(super) const SIZE: [u32; 2] = [40, 30];

impl Family {
    pub(super) fn projections(&self) -> Vec<(Projection, Size)> {
        let size = Size::new(SIZE[0], SIZE[1]).unwrap();
        let near = |camera: &Camera| camera.near(&self.casters, size);
        self.cameras.iter().map(|camera| (camera.projection(size, near(camera)), size)).collect()
    }
}

/// One scene of each family.
pub(super) fn families(seed: u64) -> Vec<Family> {
    let mut random = SplitMix64(seed);
    vec![street(seed), rooms(&mut random), sheets(&mut random), part(&mut random), nested(&mut random), one()]
}

fn lamps(texts: &[String]) -> Vec<Lamp> {
    texts.iter().map(|text| text.parse().unwrap_or_else(|error| panic!("{text}: {error}"))).collect()
}

fn camera(eye: [f32; 3], target: [f32; 3]) -> Camera {
    Camera::look_at(eye, target, 0.9, Up::Y).unwrap()
}

/// Somewhere in a box around the origin.
fn within(random: &mut SplitMix64, half: [f32; 3]) -> [f32; 3] {
    half.map(|half| half * (2.0 * random.unit() as f32 - 1.0))
}

fn street(seed: u64) -> Family {
    let city = city(seed, 40);
    let house = city.casters[0].bounds().unwrap();
    let [x, y, z] = [0, 1, 2].map(|i| 0.5 * (house[0][i] + house[1][i]));
    let [on_x, on_y, on_z] = city.casters[0].positions()[3];
    let cameras = Place::ALL.map(|place| city.camera(place));
    let lamps = lamps(&[
        "directional:0.5,-0.8,0.33".to_owned(),
        "directional:0.9,-0.25,0.35".to_owned(),
        "point:1,4,-3,range=25".to_owned(),
        format!("point:{x},{y},{z}"),
        format!("point:{on_x},{on_y},{on_z}"),
        "spot:2,12,1:0.3,-1,0.2:35,20,range=30".to_owned(),
        "point:5,14,9,radius=0.5".to_owned(),
    ]);
    let casters = std::iter::once(city.ground).chain(city.casters).collect();
    Family { name: "street", casters, lamps, cameras: cameras.to_vec() }
}

/// Closed rooms, each with furniture; lamps in a room and outside, and eyes in a room and outside.
fn rooms(random: &mut SplitMix64) -> Family {
    let mut casters = vec![shapes::cuboid([-20.0, -0.5, -10.0], [20.0, -0.1, 10.0])];
    for room in [-8.0, 0.0, 8.0] {
        let wall =
            |low: [f32; 3], high: [f32; 3]| shapes::translated(&shapes::cuboid(low, high), [room, 0.0, 0.0]);
        // Inner and outer walls: two shells, the inner one a cavity.
        casters.push(wall([-3.5, 0.0, -3.5], [3.5, 3.5, 3.5]));
        casters.push(shapes::inside_out(&wall([-3.0, 0.25, -3.0], [3.0, 3.0, 3.0])));
        for _ in 0..4 {
            let [x, _, z] = within(random, [2.3, 0.0, 2.3]);
            let [w, h, d] = [(); 3].map(|()| 0.2 + 0.4 * random.unit() as f32);
            casters.push(wall([x - w, 0.3, z - d], [x + w, 0.3 + 2.0 * h, z + d]));
        }
    }
    let lamps = lamps(&[
        "point:0.1,2.5,0.2".to_owned(),
        "point:8.3,2.7,0.1,range=6".to_owned(),
        "point:4,9,12".to_owned(),
        "point:3.5,1,0.5".to_owned(),
        "spot:-8,2.8,0:0.3,-1,0.2:50,30,range=9".to_owned(),
        "directional:0.2,-1,-0.3".to_owned(),
    ]);
    let cameras = vec![camera([2.7, 2.2, 2.6], [-1.0, 0.5, -1.0]), camera([6.0, 9.0, 19.0], [0.0, 1.0, 0.0])];
    Family { name: "rooms", casters, lamps, cameras }
}

/// Many sheets of two faces, some of them twice.
fn sheets(random: &mut SplitMix64) -> Family {
    let mut casters = vec![shapes::cuboid([-9.0, -3.0, -9.0], [9.0, -2.5, 9.0])];
    for index in 0..30 {
        let center = within(random, [5.0, 2.4, 5.0]);
        let axis = random.below(3);
        let half = [0, 1, 2].map(|i| if i == axis { 0.0 } else { 0.2 + random.unit() as f32 });
        let corner = |signs: [f32; 2]| {
            let mut p = center;
            p[(axis + 1) % 3] += signs[0] * half[(axis + 1) % 3];
            p[(axis + 2) % 3] += signs[1] * half[(axis + 2) % 3];
            p
        };
        let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(corner);
        let sheet = Mesh::new(corners.to_vec(), vec![[0, 1, 2], [0, 2, 3]]).unwrap();
        if index % 5 == 0 {
            casters.push(sheet.clone());
        }
        casters.push(sheet);
    }
    let [x, y, z] = casters[1].positions()[0];
    let lamps = lamps(&[
        "point:0.3,0.1,0.2".to_owned(),
        "point:1,9,2".to_owned(),
        format!("point:{x},{y},{z}"),
        "directional:0.1,-1,0.2".to_owned(),
        "directional:0,-1,0,angle=2".to_owned(),
        "spot:0,6,0:0.1,-1,0:30,20,range=10".to_owned(),
    ]);
    let cameras = vec![camera([7.0, 5.0, 8.0], [0.0, -1.0, 0.0]), camera([0.5, 0.2, 0.4], [4.0, -2.0, 3.0])];
    Family { name: "sheets", casters, lamps, cameras }
}

/// A part on a table, small parts on, above and below it.
fn part(random: &mut SplitMix64) -> Family {
    let mut casters = vec![shapes::cuboid([-6.0, -0.5, -6.0], [6.0, 0.0, 6.0])];
    casters.push(match random.below(3) {
        0 => shapes::translated(&shapes::torus(16, 8, 1.5, 0.6), [0.0, 2.2, 0.0]),
        1 => shapes::translated(&shapes::menger_sponge(1), [-0.5, 1.0, -0.5]),
        _ => shapes::translated(&shapes::hollow_cube(), [0.0, 2.0, 0.0]),
    });
    for _ in 0..14 {
        let at = within(random, [5.0, 2.5, 5.0]);
        let small = shapes::scaled(&shapes::cube(), 0.1 + 0.2 * random.unit() as f32);
        casters.push(shapes::translated(&small, at));
    }
    let lamps = lamps(&[
        "point:2,8,3".to_owned(),
        "point:0.1,2.2,0.05".to_owned(),
        "directional:0.4,-1,0.3".to_owned(),
        "directional:-0.6,0.9,0.2".to_owned(),
        "spot:3,5,3:-0.5,-1,-0.5:25,15,range=9".to_owned(),
        "rect:-1,6,-1:2,0,0:0,0,2".to_owned(),
    ]);
    let above = camera([5.0, 6.0, 7.0], [0.0, 0.5, 0.0]);
    let cameras = vec![above, camera([-7.0, 1.0, 2.0], [0.0, 0.5, 0.0]), above.orthographic(5.0).unwrap()];
    Family { name: "part", casters, lamps, cameras }
}

/// Shells in shells on a table.
fn nested(random: &mut SplitMix64) -> Family {
    let mut casters = vec![shapes::cuboid([-9.0, -5.5, -9.0], [9.0, -5.0, 9.0]), shapes::nested_cubes(3)];
    let center = within(random, [2.0, 0.5, 2.0]);
    let placed = |mesh: &Mesh, size: f32, at: [f32; 3]| shapes::translated(&shapes::scaled(mesh, size), at);
    let beside = [center[0] + 9.0, center[1], center[2]];
    for size in [2.0, 0.9, 0.4] {
        casters.push(placed(&shapes::icosphere(1), size, beside));
    }
    // One that sticks out, one that touches from inside.
    casters.push(placed(&shapes::cube(), 0.5, [beside[0] + 1.9, beside[1], beside[2]]));
    casters.push(placed(&shapes::cube(), 0.5, [0.0, -0.5, 0.0]));
    let [x, y, z] = beside;
    let lamps = lamps(&[
        "point:4,14,5".to_owned(),
        format!("point:{x},{y},{z}"),
        format!("point:{},{y},{z}", x + 0.6),
        "directional:0.3,-1,0.2".to_owned(),
        "point:0.1,0.1,0.2,range=12".to_owned(),
    ]);
    let cameras = vec![camera([10.0, 9.0, 14.0], [3.0, -2.0, 0.0]), camera([x, y, z + 0.6], [x, y - 1.0, z])];
    Family { name: "nested", casters, lamps, cameras }
}

fn one() -> Family {
    let triangle = vec![[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 2.0, 0.5]];
    let casters = vec![Mesh::new(triangle, vec![[0, 1, 2]]).unwrap()];
    let texts = ["point:0.1,1,3", "point:0.1,1,-3", "point:-1,0,0", "directional:0,0,1", "directional:0,1,0"];
    let lamps = lamps(&texts.map(str::to_owned));
    let cameras = vec![camera([0.5, 1.0, 4.0], [0.0, 0.7, 0.0]), camera([0.5, 1.0, -4.0], [0.0, 0.7, 0.0])];
    Family { name: "one", casters, lamps, cameras }
}
