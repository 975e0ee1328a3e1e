//! Small meshes, about 1 to 60 faces.

use crate::mesh::Mesh;
use crate::random::SplitMix64;
use crate::testing::shapes;
use crate::verify::points::draw::{nudged, rounded};

/// What kind of mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Shape {
    /// Triangles on scattered vertices, some of them shared.
    Soup,
    /// The same on the points of a tiny grid: full of coincident and collinear corners.
    Grid,
    /// A random solid of unit cells, as it is or with its vertices moved.
    Voxels,
    /// A tetrahedron, octahedron or icosahedron with its vertices moved, perhaps around another one.
    Ball,
    /// A few random tetrahedra that run into each other.
    Tetrahedra,
    /// A few boxes on a grid that run into each other.
    Boxes,
    /// One of the generated solids.
    Classic,
    /// Triangles and tetrahedra with a height of 1e-7 and less of their length.
    Sliver,
    /// Triangles on vertices of any bits that are finite.
    Bits,
}

/// Vertices and faces on the way to a mesh.
#[derive(Clone, Debug, Default)]
pub(crate) struct Draft {
    pub(crate) positions: Vec<[f32; 3]>,
    pub(crate) triangles: Vec<[u32; 3]>,
}

impl Shape {
    pub(crate) fn draw(self, random: &mut SplitMix64) -> Draft {
        match self {
            Self::Soup => {
                let grain = GRAINS[random.below(GRAINS.len())];
                soup(random, |random| scattered(random, grain))
            }
            Self::Grid => grid(random),
            Self::Voxels => voxels(random),
            Self::Ball => ball(random),
            Self::Tetrahedra => tetrahedra(random),
            Self::Boxes => boxes(random),
            Self::Classic => classic(random),
            Self::Sliver => slivers(random),
            Self::Bits => soup(random, |random| [(); 3].map(|()| bits(random))),
        }
    }
}

/// Coordinates are multiples of one over these; the finest is none at all. Coarse ones make sums exact.
const GRAINS: [f64; 4] = [8.0, 1024.0, 4096.0, 9e15];

/// A point of the cube [−1, 1]³.
fn scattered(random: &mut SplitMix64, grain: f64) -> [f32; 3] {
    rounded([(); 3].map(|()| ((2.0 * random.unit() - 1.0) * grain).round() / grain))
}

/// Any finite number, all exponents alike.
pub(crate) fn bits(random: &mut SplitMix64) -> f32 {
    let x = f32::from_bits(random.next() as u32);
    if x.is_finite() { x } else { 0.0 }
}

fn soup(random: &mut SplitMix64, mut vertex: impl FnMut(&mut SplitMix64) -> [f32; 3]) -> Draft {
    let faces = 1 + random.below(24);
    let vertices = 3 + random.below(faces + 1);
    let positions = (0..vertices).map(|_| vertex(random)).collect();
    let triangles = (0..faces).map(|_| {
        let a = random.below(vertices);
        let b = (a + 1 + random.below(vertices - 1)) % vertices;
        let (low, high) = (a.min(b), a.max(b));
        // One of the others.
        let mut c = random.below(vertices - 2);
        c += usize::from(c >= low);
        c += usize::from(c >= high);
        [a, b, c].map(|v| v as u32)
    });
    let triangles = triangles.collect();
    Draft { positions, triangles }
}

fn grid(random: &mut SplitMix64) -> Draft {
    let points = 2 + random.below(3);
    let faces = 1 + random.below(20);
    let vertices = 3 + random.below(12);
    let positions = (0..vertices).map(|_| [(); 3].map(|()| random.below(points) as f32)).collect();
    let triangles = (0..faces).map(|_| [(); 3].map(|()| random.below(vertices) as u32)).collect();
    Draft { positions, triangles }
}

fn voxels(random: &mut SplitMix64) -> Draft {
    let size = [1 + random.below(3), 1 + random.below(2), 1 + random.below(2)].map(|n| n as u32);
    let mask = random.next() & random.next() | 1;
    let mut draft = Draft::from(shapes::voxels(size, |[x, y, z]| mask >> (x + 3 * (y + 2 * z)) & 1 == 1));
    match random.below(3) {
        0 => draft.jitter(0.3, random),
        1 => draft.nudge(random),
        _ => {}
    }
    draft
}

fn ball(random: &mut SplitMix64) -> Draft {
    let base = match random.below(3) {
        0 => shapes::tetrahedron(),
        1 => shapes::octahedron(),
        _ => shapes::icosphere(0),
    };
    let mut draft = Draft::from(base);
    if random.below(3) > 0 {
        draft.jitter(0.4, random);
    }
    if random.below(3) == 0 {
        // A cavity, or a core that faces outwards.
        let inner = shapes::scaled(&shapes::octahedron(), 0.25);
        draft.join(Draft::from(if random.below(2) == 0 { shapes::inside_out(&inner) } else { inner }));
    }
    draft
}

fn tetrahedra(random: &mut SplitMix64) -> Draft {
    let grain = GRAINS[random.below(GRAINS.len())];
    let mut draft = Draft::default();
    for _ in 0..1 + random.below(4) {
        let corners = [(); 4].map(|()| scattered(random, grain));
        // Half of them inside out.
        draft.join(Draft {
            positions: corners.to_vec(),
            triangles: vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]],
        });
    }
    draft
}

fn boxes(random: &mut SplitMix64) -> Draft {
    let mut draft = Draft::default();
    for _ in 0..1 + random.below(3) {
        let low = [(); 3].map(|()| random.below(4));
        let high = low.map(|x| x + 1 + random.below(3));
        draft.join(Draft::from(shapes::cuboid(low.map(|x| x as f32), high.map(|x| x as f32))));
    }
    draft
}

fn classic(random: &mut SplitMix64) -> Draft {
    Draft::from(match random.below(18) {
        0 => shapes::figure_eight_prism(),
        1 => shapes::hollow_cube(),
        2 => shapes::mobius(3 + random.below(6) as u32),
        3 => shapes::book(1 + random.below(18) as u32),
        4 => shapes::double_sheet(),
        5 => shapes::open_cube(),
        6 => shapes::misoriented_cube(),
        7 => shapes::duplicated_face(),
        8 => shapes::t_junction(),
        9 => shapes::collinear_face(),
        10 => shapes::seam(random.below(3) as u32),
        11 => shapes::sliver(),
        12 => shapes::cubes_sharing_edge(),
        13 => shapes::cubes_sharing_vertex(),
        14 => shapes::uv_capsule(3, 1, 1.0, 0.5),
        15 => shapes::torus(3, 3, 2.0, 0.7),
        16 => shapes::nested_cubes(1 + random.below(3) as u32),
        _ => shapes::sheet(1 + random.below(3) as u32),
    })
}

fn slivers(random: &mut SplitMix64) -> Draft {
    let mut draft = Draft::default();
    for _ in 0..1 + random.below(5) {
        let grain = GRAINS[random.below(GRAINS.len())];
        let [a, b, c] = [(); 3].map(|()| scattered(random, grain).map(f64::from));
        let height = 0.5_f64.powi(23 + random.below(40) as i32);
        let mut off = |p: [f64; 3]| rounded([0, 1, 2].map(|i| p[i] + (random.unit() - 0.5) * height));
        let between = |t: f64| [0, 1, 2].map(|i| a[i] + t * (b[i] - a[i]));
        let (needle, flat) = (off(between(0.37)), off([0, 1, 2].map(|i| (a[i] + b[i] + c[i]) / 3.0)));
        let (a, b, c) = (rounded(a), rounded(b), rounded(c));
        draft.join(match random.below(3) {
            0 => Draft { positions: vec![a, b, needle], triangles: vec![[0, 1, 2]] },
            // A needle between two faces, closed by a third.
            1 => Draft {
                positions: vec![a, b, needle, c],
                triangles: vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]],
            },
            _ => Draft {
                positions: vec![a, b, c, flat],
                triangles: vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]],
            },
        });
    }
    draft
}

impl From<Mesh> for Draft {
    fn from(mesh: Mesh) -> Self {
        let (positions, triangles, ..) = mesh.into_parts();
        Self { positions, triangles }
    }
}

impl Draft {
    /// Appends another one; no vertex is shared.
    fn join(&mut self, other: Self) {
        let first = self.positions.len() as u32;
        self.positions.extend(other.positions);
        self.triangles.extend(other.triangles.into_iter().map(|face| face.map(|vertex| vertex + first)));
    }

    /// Moves every vertex by up to `most` along each axis.
    fn jitter(&mut self, most: f64, random: &mut SplitMix64) {
        for p in &mut self.positions {
            *p = rounded(p.map(|x| f64::from(x) + (2.0 * random.unit() - 1.0) * most));
        }
    }

    /// Moves every vertex by up to two ulps.
    fn nudge(&mut self, random: &mut SplitMix64) {
        for p in &mut self.positions {
            *p = nudged(p.map(f64::from), random);
        }
    }

    /// One to four defects.
    pub(crate) fn damage(&mut self, random: &mut SplitMix64) {
        for _ in 0..1 + random.below(4) {
            let face = random.below(self.triangles.len());
            let [a, b, c] = self.triangles[face];
            let vertices = self.positions.len();
            match random.below(9) {
                0 if self.triangles.len() > 1 => {
                    self.triangles.swap_remove(face);
                }
                1 => self.triangles[face] = [a, c, b],
                2 => self.triangles.push([a, b, c]),
                3 => self.triangles.push([b, a, c]),
                // Collapsed.
                4 => self.triangles.push([a, b, a]),
                // Collinear, with three vertices.
                5 => {
                    let [p, q] = [a, b].map(|v| self.positions[v as usize].map(f64::from));
                    self.positions.push(rounded([0, 1, 2].map(|i| 0.5 * (p[i] + q[i]))));
                    self.triangles.push([a, vertices as u32, b]);
                }
                // Two vertices at one place.
                6 => self.positions[a as usize] = self.positions[random.below(vertices)],
                // A seam of a few ulps: one corner of the face of its own.
                7 => {
                    let p = self.positions[a as usize].map(f64::from);
                    self.positions.push(nudged(p, random));
                    self.triangles[face] = [vertices as u32, b, c];
                }
                // A face between any three vertices.
                _ => self.triangles.push([(); 3].map(|()| random.below(vertices) as u32)),
            }
        }
    }
}
