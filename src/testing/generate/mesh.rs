//! Small meshes, of about 1 to 70 faces.

use std::ops::RangeInclusive;

use super::solid::{bent, boxes, voxel_solid};
use super::{Damage, Draw, Scale, damage, position};
use crate::mesh::Mesh;
use crate::testing::shapes;
use crate::verify::points::feature::{along, combined, nudged, rounded};

/// What kind of mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Shape {
    /// One of the generated shapes.
    Known,
    /// A random solid of unit cells, as it is or with its vertices moved.
    Voxels,
    /// A few boxes on a grid that run into each other.
    Boxes,
    /// A known solid with its vertices moved, perhaps around another one.
    Bent,
    /// A few random tetrahedra that run into each other.
    Tetrahedra,
    /// Triangles on the points of a tiny grid: full of coincident and collinear corners.
    Grid,
    /// Triangles on scattered vertices, some of them shared.
    Soup,
    /// Triangles and tetrahedra with a height of 1e-7 and less of their length.
    Sliver,
    /// Triangles on vertices of any bits that are finite.
    Bits,
    /// Triangles on vertices of all these kinds.
    Mixed,
}

/// Vertices and faces before they become a mesh.
#[derive(Clone, Debug, Default)]
pub(crate) struct Draft {
    pub(crate) positions: Vec<[f32; 3]>,
    pub(crate) triangles: Vec<[u32; 3]>,
}

/// Any small mesh with a face: of any shape, half of them damaged, at any scale.
pub fn mesh(draw: &mut dyn Draw) -> Mesh {
    let pieces = draw.pick(&[0, 0, 0, 0, 1, 2, 4, 12]);
    let scale = if draw.below(4) < 3 { Scale::One } else { draw.pick(&Scale::ALL) };
    let mut draft = draw.pick(&Shape::ALL).draw(draw);
    for _ in 0..pieces {
        damage(draw, Damage::KINDS, &mut draft);
    }
    scale.apply(draw, &mut draft.positions);
    draft.into()
}

/// The first [`CLOSED`] of them are closed; the simplest of both kinds come first.
pub(super) const KNOWN: [fn() -> Mesh; 25] = [
    shapes::tetrahedron,
    shapes::octahedron,
    shapes::cube,
    shapes::hollow_cube,
    shapes::figure_eight_prism,
    shapes::cubes_sharing_edge,
    shapes::cubes_sharing_vertex,
    || shapes::inside_out(&shapes::octahedron()),
    || shapes::icosphere(0),
    || shapes::nested_cubes(2),
    || shapes::torus(5, 3, 2.0, 0.75),
    || shapes::sheet(1),
    shapes::double_sheet,
    shapes::open_cube,
    shapes::misoriented_cube,
    shapes::duplicated_face,
    shapes::t_junction,
    shapes::collinear_face,
    shapes::sliver,
    || shapes::seam(1),
    || shapes::sheet(3),
    || shapes::book(3),
    || shapes::book(18),
    || shapes::mobius(5),
    || shapes::uv_capsule(3, 1, 1.0, 0.5),
];

/// See [`KNOWN`].
pub(super) const CLOSED: usize = 11;

impl Shape {
    /// All shapes, the simplest first.
    pub(crate) const ALL: [Self; 10] = {
        use Shape::{Bent, Bits, Boxes, Grid, Known, Mixed, Sliver, Soup, Tetrahedra, Voxels};
        [Known, Voxels, Boxes, Bent, Tetrahedra, Grid, Soup, Sliver, Bits, Mixed]
    };

    /// A mesh with a face.
    pub(crate) fn draw(self, draw: &mut dyn Draw) -> Draft {
        match self {
            Self::Known => draw.pick(&KNOWN)().into(),
            Self::Voxels => voxels(draw),
            Self::Boxes => boxes(draw).into(),
            Self::Bent => around(draw),
            Self::Tetrahedra => tetrahedra(draw),
            Self::Grid => {
                let most = 1 + draw.between(0, 2);
                soup(draw, |draw| [(); 3].map(|()| draw.between(0, most) as f32))
            }
            Self::Soup => {
                let grain = draw.pick(&GRAINS);
                soup(draw, |draw| scattered(draw, grain))
            }
            Self::Sliver => slivers(draw),
            Self::Bits => soup(draw, |draw| [(); 3].map(|()| draw.bits())),
            Self::Mixed => soup(draw, position),
        }
    }
}

/// Coordinates are multiples of one over these; the finest is none at all. Coarse ones make sums exact.
const GRAINS: [f64; 4] = [8.0, 1024.0, 4096.0, 9e15];

/// A point of the cube [−1, 1]³.
fn scattered(draw: &mut dyn Draw, grain: f64) -> [f32; 3] {
    rounded([(); 3].map(|()| (draw.signed() * grain).round() / grain))
}

/// 1 to 24 faces over 3 to 14 vertices.
fn soup(draw: &mut dyn Draw, vertex: impl Fn(&mut dyn Draw) -> [f32; 3]) -> Draft {
    let (slots, vertices) = (1 + draw.index(24), 3 + draw.index(12));
    let positions: Vec<[f32; 3]> = (0..vertices).map(|_| vertex(draw)).collect();
    let triangles = faces(draw, 1..=slots, vertices);
    Draft { positions, triangles }
}

/// Faces between `vertices`: seven in eight have three different corners, the others any.
pub(crate) fn faces(draw: &mut dyn Draw, count: RangeInclusive<usize>, vertices: usize) -> Vec<[u32; 3]> {
    let n = vertices as u32; // few
    draw.list(*count.start(), *count.end(), |draw| {
        let is_any = draw.below(8) == 7 || n < 3;
        let [a, mut b, mut c] = [0, 1, 2].map(|corner| draw.below(n.saturating_sub(corner).max(1)));
        if !is_any {
            // Of the vertices without a, and of those without a and b.
            b += u32::from(b >= a);
            c += u32::from(c >= a.min(b));
            c += u32::from(c >= a.max(b));
        }
        [a, b, c]
    })
}

fn voxels(draw: &mut dyn Draw) -> Draft {
    let size = [3, 2, 2].map(|most| 1 + draw.below(most));
    let mut draft = Draft::from(voxel_solid(draw, size));
    match draw.below(3) {
        0 => {}
        1 => draft.bend(draw, 0.25),
        _ => draft.positions.iter_mut().for_each(|p| *p = nudged(draw, p.map(f64::from))),
    }
    draft
}

/// A bent solid; one in three has a cavity, or a core that faces outwards.
fn around(draw: &mut dyn Draw) -> Draft {
    let inner = draw.below(6);
    let mut draft = Draft::from(bent(draw, 0.4));
    if inner >= 4 {
        let core = shapes::scaled(&shapes::octahedron(), 0.25);
        draft.join(if inner == 4 { core } else { shapes::inside_out(&core) }.into());
    }
    draft
}

/// A closed tetrahedron: at half of all corners inside out.
const TETRAHEDRON: [[u32; 3]; 4] = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];

fn tetrahedra(draw: &mut dyn Draw) -> Draft {
    let (slots, grain) = (1 + draw.index(4), draw.pick(&GRAINS));
    joined(draw.list(1, slots, |draw| {
        let positions = (0..4).map(|_| scattered(draw, grain)).collect();
        Draft { positions, triangles: TETRAHEDRON.to_vec() }
    }))
}

fn slivers(draw: &mut dyn Draw) -> Draft {
    let slots = 1 + draw.index(5);
    joined(draw.list(1, slots, |draw| {
        let (kind, grain) = (draw.below(3), draw.pick(&GRAINS));
        let [a, b, c] = [(); 3].map(|()| scattered(draw, grain).map(f64::from));
        let height = 0.5_f64.powi(23 + draw.between(0, 39));
        // A needle beside an edge, alone or between two faces that a third one closes; or a flat tetrahedron.
        let beside = if kind < 2 { along([a, b], 0.375) } else { combined([a, b, c], 1.0 / 3.0, 1.0 / 3.0) };
        let off = rounded(beside.map(|x| x + 0.5 * draw.signed() * height));
        let [a, b, c] = [a, b, c].map(rounded);
        match kind {
            0 => Draft { positions: vec![a, b, off], triangles: vec![[0, 1, 2]] },
            _ => Draft { positions: vec![a, b, c, off], triangles: TETRAHEDRON.to_vec() },
        }
    }))
}

fn joined(drafts: Vec<Draft>) -> Draft {
    let mut all = Draft::default();
    drafts.into_iter().for_each(|draft| all.join(draft));
    all
}

impl From<Mesh> for Draft {
    fn from(mesh: Mesh) -> Self {
        let (positions, triangles, ..) = mesh.into_parts();
        Self { positions, triangles }
    }
}

impl From<Draft> for Mesh {
    fn from(draft: Draft) -> Self {
        Self::new(draft.positions, draft.triangles).expect("drafts are finite and in range")
    }
}

impl Draft {
    /// Appends another one; no vertex is shared.
    pub(super) fn join(&mut self, other: Self) {
        let first = self.positions.len() as u32;
        self.positions.extend(other.positions);
        self.triangles.extend(other.triangles.into_iter().map(|face| face.map(|vertex| vertex + first)));
    }

    /// Moves half of the coordinates by up to `most`.
    pub(super) fn bend(&mut self, draw: &mut dyn Draw, most: f64) {
        for p in &mut self.positions {
            *p = rounded(p.map(|x| {
                let (is_moved, by) = (draw.flag(), draw.signed() * most);
                if is_moved { f64::from(x) + by } else { x.into() }
            }));
        }
    }
}
