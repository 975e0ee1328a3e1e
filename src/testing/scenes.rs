//! Generated scenes: many casters on a ground, with views and lamps that ask for few of them.
//!
//! The same arguments give the same bytes on every platform, as for [`shapes`].

use crate::geom::Light;
use crate::mesh::Mesh;
use crate::random::SplitMix64;
use crate::scene::Lamp;
use crate::view::{Camera, Up};

use super::shapes;

/// A city: houses, sheds, crates and trees on lots along streets, and a ground. y is up.
#[derive(Clone, Debug)]
pub struct City {
    /// The ground, a square of two faces in the plane y = 0.
    pub ground: Mesh,
    /// What stands on it: one closed shell each.
    pub casters: Vec<Mesh>,
    /// Half the side of what is built on.
    pub reach: f32,
}

/// Where a city is seen from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Place {
    /// In a street, along it.
    Street,
    /// At a crossing, looking at a corner.
    Corner,
    /// From above.
    Air,
}

impl Place {
    /// All places.
    pub const ALL: [Self; 3] = [Self::Street, Self::Corner, Self::Air];

    /// Name in reports.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Street => "street",
            Self::Corner => "corner",
            Self::Air => "air",
        }
    }
}

/// Distance from lot to lot, and width of a street; each block has two lots along each side.
const LOT: f32 = 14.0;
const STREET: f32 = 9.0;

/// A city of `casters` closed shells, drawn from `seed`: about 12 faces each.
///
/// ```
/// let city = umbrage::testing::scenes::city(1, 30);
/// assert_eq!(city.casters.len(), 30);
/// let faces: usize = city.casters.iter().map(|mesh| mesh.face_count()).sum();
/// assert_eq!(city.scene().face_count(), faces + 2);
/// ```
#[must_use]
pub fn city(seed: u64, casters: usize) -> City {
    let mut random = SplitMix64(seed);
    // About five shells a lot.
    let side = (1..).find(|side| side * side * 5 >= casters).unwrap_or(1);
    let start = |lot: usize| LOT * lot as f32 + STREET * (lot / 2) as f32;
    let reach = 0.5 * (start(side) + STREET);
    let mut built = Vec::with_capacity(casters + 8);
    'lots: for row in 0..side {
        for column in 0..side {
            if built.len() >= casters {
                break 'lots;
            }
            let corner = [column, row].map(|lot| start(lot) - reach + 0.5 * STREET);
            lot(&mut random, corner, &mut built);
        }
    }
    while built.len() < casters {
        let [x, z] = [(); 2].map(|()| (2.0 * random.unit() as f32 - 1.0) * reach);
        built.push(block(&mut random, [x, z], 0.4, 1.0));
    }
    built.truncate(casters);
    let far = 2.0 * reach;
    let corners = vec![[-far, 0.0, -far], [-far, 0.0, far], [far, 0.0, far], [far, 0.0, -far]];
    let ground = Mesh::new(corners, vec![[0, 1, 2], [0, 2, 3]]).expect("finite").with_name("ground");
    City { ground, casters: built, reach }
}

impl City {
    /// The ground and all casters as one mesh: the ground is the first shell.
    #[must_use]
    pub fn scene(&self) -> Mesh {
        let all = std::iter::once(&self.ground).chain(&self.casters).cloned();
        Mesh::concat(&all.collect::<Vec<_>>()).expect("they fit").with_name("city")
    }

    /// The middle of the street nearest to the center.
    fn street(&self) -> f32 {
        let streets = (0..).map(|k| k as f32 * (2.0 * LOT + STREET) - self.reach);
        streets.take_while(|&x| x < 0.5 * STREET).last().unwrap_or(0.0)
    }

    /// The sun 54° high, the sun 14° high, and a lamp over the street, of the range 25.
    #[must_use]
    pub fn lamps(&self) -> [Lamp; 3] {
        let at = [self.street() + 2.0, 5.0, -0.35 * self.reach + 9.0];
        let sun = |travel| Light::directional(travel).expect("it travels").into();
        let lamp = Lamp::from(Light::point(at).expect("finite"));
        [sun([0.45, -0.81, 0.38]), sun([0.9, -0.24, 0.35]), Lamp { range: Some(25.0), ..lamp }]
    }

    /// A camera at a place of the city.
    #[must_use]
    pub fn camera(&self, place: Place) -> Camera {
        let street = self.street();
        let (eye, target, fov) = match place {
            Place::Street => ([street, 1.7, -0.35 * self.reach], [street + 0.3, 1.5, self.reach], 0.8),
            Place::Corner => ([street - 1.0, 1.7, street - 1.0], [street + 14.0, 2.0, street + 12.0], 0.9),
            Place::Air => {
                ([0.3 * self.reach, 0.8 * self.reach, -self.reach], [0.0, 0.0, 0.1 * self.reach], 0.8)
            }
        };
        Camera::look_at(eye, target, fov, Up::Y).expect("eye and target differ")
    }
}

/// A house, perhaps a shed, crates and trees.
fn lot(random: &mut SplitMix64, [x, z]: [f32; 2], built: &mut Vec<Mesh>) {
    let mut between = |low: f32, high: f32| low + (high - low) * random.unit() as f32;
    let (width, depth) = (between(6.0, 9.0), between(6.0, 9.0));
    let [x0, z0] = [x + between(1.0, 2.5), z + between(1.0, 2.5)];
    let (wall, roof) = (between(3.5, 9.0), between(1.0, 3.0));
    built.push(house([x0, z0], [x0 + width, z0 + depth], wall, wall + roof));
    for _ in 0..2 + random.below(4) {
        let [at_x, at_z] = [(); 2].map(|()| 1.0 + (LOT - 2.0) * random.unit() as f32);
        let at = [x + at_x, z + at_z];
        built.push(match random.below(4) {
            0 => block(random, at, 1.5, 2.6),
            1 | 2 => block(random, at, 0.5, 1.2),
            _ => tree(random, at),
        });
    }
}

/// A box on the ground, up to `most` wide to each side and up to `high`.
fn block(random: &mut SplitMix64, [x, z]: [f32; 2], most: f32, high: f32) -> Mesh {
    let [width, depth, height] = [most, most, high].map(|most| most * (0.5 + 0.5 * random.unit() as f32));
    shapes::cuboid([x - width, 0.0, z - depth], [x + width, height, z + depth]).with_name("block")
}

/// A crown that floats, as its trunk would cast next to nothing.
fn tree(random: &mut SplitMix64, [x, z]: [f32; 2]) -> Mesh {
    let radius = 0.8 + random.unit() as f32;
    let crown = shapes::scaled(&shapes::icosphere(0), radius);
    shapes::translated(&crown, [x, radius + 1.5 + random.unit() as f32, z]).with_name("tree")
}

/// Walls and a gable roof: V 10, E 24, F 16.
fn house([x0, z0]: [f32; 2], [x1, z1]: [f32; 2], wall: f32, ridge: f32) -> Mesh {
    let middle = 0.5 * (x0 + x1);
    let mut positions = Vec::with_capacity(10);
    for z in [z0, z1] {
        positions.extend([[x0, 0.0, z], [x1, 0.0, z], [x1, wall, z], [middle, ridge, z], [x0, wall, z]]);
    }
    let mut triangles = vec![[0, 4, 3], [0, 3, 2], [0, 2, 1], [5, 8, 9], [5, 7, 8], [5, 6, 7]];
    for k in 0..5 {
        let next = (k + 1) % 5;
        triangles.extend([[k, next, next + 5], [k, next + 5, k + 5]]);
    }
    Mesh::new(positions, triangles).expect("finite").with_name("house")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::check::CrackReport;
    use crate::topology::Topology;

    #[test]
    fn city_has_closed_shells_and_a_ground_below() {
        for (seed, casters) in [(1, 1), (2, 40), (3, 565)] {
            let city = city(seed, casters);
            assert_eq!(city.casters.len(), casters);
            for mesh in &city.casters {
                let report = CrackReport::of(mesh, &Topology::of(mesh));
                assert!(report.counts.sound() && report.counts.shells == 1, "{}", mesh.name);
                assert!(report.counts.signed_volume > 0.0, "{} is inside out", mesh.name);
            }
            let scene = city.scene();
            assert_eq!(Topology::of(&scene).shells().count, casters + 1);
        }
    }
}
