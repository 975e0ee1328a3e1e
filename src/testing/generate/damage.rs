//! Damage that is done to a mesh, piece by piece.

use super::mesh::Draft;
use super::{Draw, faces, position};
use crate::verify::points::feature::{along, nudged, rounded};

/// One thing that was done to a mesh. Faces and vertices are numbered as they were at that moment.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Damage {
    /// A face was taken out; those after it moved down by one.
    Dropped(u32),
    /// A face was wound the other way.
    Turned(u32),
    /// A face was added a second time, at the end.
    Doubled(u32),
    /// A face was added a second time, at the end, wound the other way.
    DoubledTurned(u32),
    /// A new vertex, the rounded middle of the face's first edge, and the face cut in two there; its neighbor
    /// was not: a T-junction. The second half is the last face.
    Split(u32),
    /// The third corner of a face became its second.
    Collapsed(u32),
    /// A face got its own copy of its first vertex, at the same position: welding undoes it.
    Unwelded(u32),
    /// A face got its own copy of its first vertex, at a position up to two ulps away: a seam.
    Torn(u32, [f32; 3]),
    /// A vertex was moved: onto another one, or anywhere.
    Moved(u32, [f32; 3]),
    /// A face was added between any three vertices.
    Added([u32; 3]),
}

impl Damage {
    /// How many kinds there are.
    pub(crate) const KINDS: u32 = 10;

    /// How many kinds, the first ones, unbalance an edge of every closed mesh.
    pub(crate) const UNBALANCING: u32 = 7;

    fn apply(self, Draft { positions, triangles }: &mut Draft) {
        let new = positions.len() as u32; // few vertices
        let mut own_corner = |face: u32, p: Option<[f32; 3]>| {
            let corner = &mut triangles[face as usize][0];
            positions.push(p.unwrap_or(positions[*corner as usize]));
            *corner = new;
        };
        match self {
            Self::Unwelded(face) => own_corner(face, None),
            Self::Torn(face, p) => own_corner(face, Some(p)),
            Self::Moved(vertex, p) => positions[vertex as usize] = p,
            Self::Added(face) => triangles.push(face),
            Self::Dropped(face) => _ = triangles.remove(face as usize),
            Self::Turned(face) => triangles[face as usize].swap(1, 2),
            Self::Doubled(face) => triangles.push(triangles[face as usize]),
            Self::DoubledTurned(face) => {
                let [a, b, c] = triangles[face as usize];
                triangles.push([a, c, b]);
            }
            Self::Split(face) => {
                let [a, b, c] = triangles[face as usize];
                let ends = [a, b].map(|vertex| positions[vertex as usize].map(f64::from));
                positions.push(rounded(along(ends, 0.5)));
                triangles[face as usize] = [a, new, c];
                triangles.push([new, b, c]);
            }
            Self::Collapsed(face) => triangles[face as usize][2] = triangles[face as usize][1],
        }
    }
}

/// Does one piece of damage of the first `kinds` kinds, and returns it; `None` where there is no face.
///
/// The last face is not dropped, but turned.
pub(crate) fn damage(draw: &mut dyn Draw, kinds: u32, draft: &mut Draft) -> Option<Damage> {
    let count = draft.triangles.len();
    let (kind, face) = (draw.below(kinds), draw.below(count.max(1) as u32));
    let [first, ..] = *draft.triangles.get(face as usize)?;
    let at = draft.positions[first as usize];
    let done = match kind {
        0 if count > 1 => Damage::Dropped(face),
        0 | 1 => Damage::Turned(face),
        2 => Damage::Doubled(face),
        3 => Damage::DoubledTurned(face),
        4 => Damage::Split(face),
        5 => Damage::Collapsed(face),
        6 => Damage::Unwelded(face),
        7 => Damage::Torn(face, nudged(draw, at.map(f64::from))),
        8 if draw.flag() => Damage::Moved(first, position(draw)),
        8 => Damage::Moved(first, draw.pick(&draft.positions)),
        _ => Damage::Added(faces(draw, 1..=1, draft.positions.len())[0]),
    };
    done.apply(draft);
    Some(done)
}
