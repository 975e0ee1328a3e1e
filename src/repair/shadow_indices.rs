//! The faces of a prepared mesh as indices into the vertices that it was made of.

use hashbrown::HashMap;

use crate::mesh::Mesh;

/// The faces of `prepared` with the vertices of `original`, of which it was made without moving any: of
/// several at one position the first, so that faces which touch share an index. For a pass that draws depth
/// alone from the vertex buffer that is there already.
///
/// `None` if a position of `prepared` is none of `original`'s, or if one of the meshes has frames, in which
/// vertices of one position may part.
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
    if !original.frames().is_empty() || !prepared.frames().is_empty() {
        return None;
    }
    let mut first = HashMap::with_capacity(prepared.vertex_count());
    for (vertex, position) in (0..).zip(original.positions()) {
        first.entry(position.map(f32::to_bits)).or_insert(vertex);
    }
    let vertices =
        prepared.positions().iter().map(|position| first.get(&position.map(f32::to_bits)).copied());
    let vertices: Vec<u32> = vertices.collect::<Option<_>>()?;
    Some(prepared.triangles().iter().map(|corners| corners.map(|vertex| vertices[vertex as usize])).collect())
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
