//! The faces of a prepared mesh as indices into the vertices that it was made of.

use std::hash::Hash;

use hashbrown::HashMap;

use super::skin::in_every_frame;
use crate::mesh::Mesh;

/// The faces of `prepared` with the vertices of `original`, of which it was made without moving any: of
/// several at one position the first, so that faces which touch share an index. For a pass that draws depth
/// alone from the vertex buffer that is there already.
///
/// Vertices that a skin moves differently, or that part in a frame (a morph target), keep indices of their
/// own: an index stands for all poses.
///
/// `None` if a vertex of `prepared` is none of `original`'s.
///
/// ```
/// use umbrage::mesh::Weld;
/// use umbrage::{repair, testing::shapes};
/// let soup = shapes::soup(&shapes::cube());
/// let (welded, _) = repair::weld(soup.clone(), Weld::Exact);
/// let indices = repair::shadow_indices(&soup, &welded).expect("nothing has moved");
/// assert_eq!((soup.triangles()[1], indices[1]), ([3, 4, 5], [0, 2, 5]));
/// ```
#[must_use]
pub fn shadow_indices(original: &Mesh, prepared: &Mesh) -> Option<Vec<[u32; 3]>> {
    let is_still = |mesh: &Mesh| mesh.frames().is_empty() && mesh.skin().is_none();
    let vertices = if is_still(original) && is_still(prepared) {
        firsts(original, prepared, |mesh, vertex| mesh.positions()[vertex].map(f32::to_bits))?
    } else {
        firsts(original, prepared, |mesh, vertex| {
            (in_every_frame(mesh, vertex), mesh.skin().map(|skin| skin[vertex]))
        })?
    };
    Some(prepared.triangles().iter().map(|corners| corners.map(|vertex| vertices[vertex as usize])).collect())
}

/// For each vertex of `prepared` the first of `original` with the same key; `None` if one has none.
fn firsts<K: Eq + Hash>(
    original: &Mesh,
    prepared: &Mesh,
    key: impl Fn(&Mesh, usize) -> K,
) -> Option<Vec<u32>> {
    let mut first = HashMap::with_capacity(prepared.vertex_count());
    for (id, vertex) in (0..).zip(0..original.vertex_count()) {
        first.entry(key(original, vertex)).or_insert(id);
    }
    (0..prepared.vertex_count()).map(|vertex| first.get(&key(prepared, vertex)).copied()).collect()
}

#[cfg(test)]
mod tests {
    use super::super::test_support::corners;
    use super::*;
    use crate::repair::{Options, prepare};
    use crate::testing::shapes;

    #[test]
    fn shadow_indices_name_the_first_vertex_of_each_position() {
        let all = Options { split: true, fill: Some(Default::default()), ..Options::default() };
        for shape in [shapes::cubes_sharing_edge(), shapes::uv_capsule(7, 2, 1.0, 1.0), shapes::open_cube()] {
            let original = shapes::soup(&shape);
            let prepared = prepare(original.clone(), &all).unwrap().mesh;
            let indices = shadow_indices(&original, &prepared).unwrap();
            let drawn = Mesh::new(original.positions().to_vec(), indices.clone()).unwrap();
            assert_eq!(corners(&drawn), corners(&prepared));
            let at = |vertex: u32| original.positions()[vertex as usize];
            let is_first = |&vertex: &u32| (0..vertex).all(|lower| at(lower) != at(vertex));
            assert!(indices.as_flattened().iter().all(is_first));
            // Fault injected: the soup's own indices.
            assert!(!original.triangles().as_flattened().iter().all(is_first));
        }
        let moved = shapes::translated(&shapes::cube(), [0.5, 0.0, 0.0]);
        assert_eq!(shadow_indices(&shapes::cube(), &moved), None);
    }
}
