//! Solids with known damage.

use proptest::collection::vec;
use proptest::prelude::*;
use proptest::sample::Index;

use crate::mesh::Mesh;

/// One thing that was done to a mesh. Faces are numbered as they were at that moment.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Damage {
    /// A face was taken out; those after it moved down by one.
    Dropped(u32),
    /// A face was wound the other way.
    Turned(u32),
    /// A face was added a second time, at the end.
    Doubled(u32),
    /// A face was added a second time, at the end, wound the other way.
    DoubledTurned(u32),
    /// A new vertex, the rounded middle of the face's first edge, and the face cut in two there; its
    /// neighbor was not: a T-junction. The second half stands at the end.
    Split(u32),
    /// The third corner of a face became its second.
    Collapsed(u32),
    /// A face got its own copy of its first vertex, at the same place: welding undoes it.
    Unwelded(u32),
}

/// A mesh, and what was done to it, in that order.
#[derive(Clone, Debug)]
pub struct Damaged {
    /// The mesh as it is now.
    pub mesh: Mesh,
    /// What was done.
    pub damage: Vec<Damage>,
}

/// Meshes from `meshes`, each with one to `most` pieces of random [`Damage`]. Shrinks towards little damage.
///
/// # Panics
///
/// Panics if `most` is 0.
pub fn damaged(
    meshes: impl Strategy<Value = Mesh> + Clone,
    most: usize,
) -> impl Strategy<Value = Damaged> + Clone {
    let kind = prop_oneof![
        Just(Damage::Dropped as fn(u32) -> Damage),
        Just(Damage::Turned as fn(u32) -> Damage),
        Just(Damage::Doubled as fn(u32) -> Damage),
        Just(Damage::DoubledTurned as fn(u32) -> Damage),
        Just(Damage::Split as fn(u32) -> Damage),
        Just(Damage::Collapsed as fn(u32) -> Damage),
        Just(Damage::Unwelded as fn(u32) -> Damage),
    ];
    (meshes, vec((kind, any::<Index>()), 1..=most)).prop_map(|(mesh, picks)| {
        let (mut positions, mut triangles, ..) = mesh.into_parts();
        let mut damage = Vec::with_capacity(picks.len());
        for (kind, face) in picks {
            if !triangles.is_empty() {
                let done = kind(face.index(triangles.len()) as u32); // few faces
                apply(done, &mut positions, &mut triangles);
                damage.push(done);
            }
        }
        Damaged { mesh: Mesh::new(positions, triangles).expect("finite, and in range"), damage }
    })
}

fn apply(damage: Damage, positions: &mut Vec<[f32; 3]>, triangles: &mut Vec<[u32; 3]>) {
    let new = positions.len() as u32; // few vertices
    match damage {
        Damage::Dropped(face) => {
            triangles.remove(face as usize);
        }
        Damage::Turned(face) => triangles[face as usize].swap(1, 2),
        Damage::Doubled(face) => triangles.push(triangles[face as usize]),
        Damage::DoubledTurned(face) => {
            let [a, b, c] = triangles[face as usize];
            triangles.push([a, c, b]);
        }
        Damage::Split(face) => {
            let [a, b, c] = triangles[face as usize];
            let [p, q] = [a, b].map(|vertex| positions[vertex as usize]);
            positions.push(std::array::from_fn(|i| 0.5 * p[i] + 0.5 * q[i]));
            triangles[face as usize] = [a, new, c];
            triangles.push([new, b, c]);
        }
        Damage::Collapsed(face) => triangles[face as usize][2] = triangles[face as usize][1],
        Damage::Unwelded(face) => {
            positions.push(positions[triangles[face as usize][0] as usize]);
            triangles[face as usize][0] = new;
        }
    }
}
