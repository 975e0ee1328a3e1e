//! The step that makes vertices one.

use super::change::{ChangeKind, Step};
use super::index_map::IndexMap;
use super::skin;
use crate::mesh::{Mesh, VertexId, Weld};

/// Makes vertices one by the rule `how`, and drops those that no face uses.
///
/// Vertices that a skin of the file moves differently stay apart, so that no pose tears the mesh, and no pose
/// joins what it parts ([`ChangeKind::KeptApart`]).
///
/// Guarantee: faces keep their number and order. With [`Weld::Exact`] every corner keeps its position in
/// every frame, bit for bit; within a distance no corner moves farther than that, and
/// [`Step::largest_move`] is the largest move that was made.
///
/// ```
/// use umbrage::mesh::Weld;
/// use umbrage::{repair, testing::shapes};
/// let (mesh, step) = repair::weld(shapes::soup(&shapes::cube()), Weld::Exact);
/// assert_eq!((mesh.vertex_count(), step.count, step.largest_move), (8, 36 - 8, 0.0));
/// ```
#[must_use]
pub fn weld(mesh: Mesh, how: Weld) -> (Mesh, Step) {
    weld_with(mesh, how, true)
}

/// [`weld`], which may leave out [`Step::vertices`]: a third of its time.
pub(super) fn weld_with(mesh: Mesh, how: Weld, map: bool) -> (Mesh, Step) {
    let name = if matches!(how, Weld::Within(_)) { "weld-within" } else { "weld" };
    let mut step = Step::new(name);
    let old = mesh.vertex_count();
    // Only these can move.
    let before = matches!(how, Weld::Within(_)).then(|| mesh.clone());
    // What was merged is where it was; what is dropped is nowhere afterwards.
    let mut unused = unused(&mesh).into_iter();
    let welded = skin::weld(mesh, how);
    if welded.mesh.vertex_count() == old {
        if how != Weld::None {
            skin::list_kept_apart(&welded.mesh, &mut step);
        }
        return (welded.mesh, step);
    }
    if map {
        let new_of = (0..old as u32).map(|vertex| welded.vertex_of(VertexId(vertex)).map(|new| new.0));
        step.vertices = Some(IndexMap::forward(new_of));
    }
    let mut next = 0;
    for vertex in 0..old as u32 {
        if step.changes.len() == Step::LISTED {
            break;
        }
        match welded.vertex_of(VertexId(vertex)) {
            None => {
                let at = unused.next().expect("as many as are listed");
                step.add(ChangeKind::VertexDropped, Some(vertex), None, at);
            }
            // Kept vertices stay in their order, the first of each point.
            Some(VertexId(new)) if new == next => next += 1,
            Some(VertexId(new)) => {
                let old = before.as_ref().map(|before| before.positions()[vertex as usize]);
                let at = old.unwrap_or_else(|| welded.mesh.positions()[new as usize]);
                step.add(ChangeKind::VertexMerged, Some(vertex), Some(new), at);
            }
        }
    }
    step.count = old - welded.mesh.vertex_count();
    if let Some(before) = before {
        let moved = |vertex: u32| {
            let new = welded.vertex_of(VertexId(vertex))?.index();
            let frames = before.frames().iter().zip(welded.mesh.frames());
            let pairs = frames.map(|(old, new)| (&old[..], &new[..]));
            let pairs = pairs.chain([(before.positions(), welded.mesh.positions())]);
            Some(pairs.map(|(old, moved)| distance(old[vertex as usize], moved[new])).fold(0.0, f64::max))
        };
        step.largest_move = (0..old as u32).filter_map(moved).fold(0.0, f64::max);
    }
    if how != Weld::None {
        skin::list_kept_apart(&welded.mesh, &mut step);
    }
    (welded.mesh, step)
}

/// The positions of the first vertices that no face uses, as many as a step lists.
fn unused(mesh: &Mesh) -> Vec<[f32; 3]> {
    let mut is_used = vec![false; mesh.vertex_count()];
    mesh.triangles().as_flattened().iter().for_each(|&vertex| is_used[vertex as usize] = true);
    let unused = mesh.positions().iter().zip(is_used).filter(|&(_, is_used)| !is_used);
    unused.map(|(&position, _)| position).take(Step::LISTED).collect()
}

fn distance(p: [f32; 3], q: [f32; 3]) -> f64 {
    (0..3).map(|i| (f64::from(p[i]) - f64::from(q[i])).powi(2)).sum::<f64>().sqrt()
}

#[cfg(test)]
mod tests {
    use super::super::test_support::corners;
    use super::*;
    use crate::testing::shapes;

    #[test]
    fn weld_keeps_every_corner_bit_for_bit_and_counts_what_it_merged() {
        let unused = |mesh: &Mesh| {
            let (mut positions, triangles, ..) = mesh.clone().into_parts();
            positions.insert(0, [9.0; 3]);
            Mesh::new(positions, triangles.iter().map(|t| t.map(|vertex| vertex + 1)).collect()).unwrap()
        };
        for shape in [shapes::cube(), shapes::torus(7, 5, 2.0, 0.5), shapes::mobius(9)] {
            let soup = unused(&shapes::soup(&shape));
            let (mesh, step) = weld(soup.clone(), Weld::Exact);
            assert_eq!(corners(&mesh), corners(&soup));
            assert_eq!(mesh.vertex_count(), shape.vertex_count());
            assert_eq!(step.count, 1 + 3 * shape.face_count() - shape.vertex_count());
            assert_eq!((step.changes[0].kind, step.changes[0].old), (ChangeKind::VertexDropped, Some(0)));
            for change in step.changes.iter().filter(|change| change.kind == ChangeKind::VertexMerged) {
                assert_eq!(mesh.positions()[change.new.unwrap() as usize], change.at);
            }
            // Nothing is left to do.
            assert_eq!(weld(mesh, Weld::Exact).1.count, 0);
            // Fault injected: one coordinate in its last place.
            let (mut positions, triangles, ..) = soup.clone().into_parts();
            positions[4][1] = positions[4][1].next_up();
            assert_ne!(corners(&Mesh::new(positions, triangles).unwrap()), corners(&soup));
        }
    }

    #[test]
    fn weld_counts_what_it_does_not_list() {
        // Twelve hundred vertices that no face uses come before a soup of more than a thousand doubles.
        let (mut positions, mut triangles, ..) = shapes::soup(&shapes::icosphere(3)).into_parts();
        let unused = (0..1200).map(|k| [9.0 + k as f32, 0.0, 0.0]);
        positions.splice(0..0, unused);
        triangles.as_flattened_mut().iter_mut().for_each(|vertex| *vertex += 1200);
        let mesh = Mesh::new(positions, triangles).unwrap();
        let (with, without) = (weld(mesh.clone(), Weld::Exact), weld_with(mesh.clone(), Weld::Exact, false));
        assert_eq!((with.0.vertex_count(), with.1.count), (642, 1200 + 3840 - 642));
        assert_eq!(with.1.changes.len(), Step::LISTED);
        for (place, change) in with.1.changes.iter().enumerate() {
            assert_eq!((change.kind, change.old), (ChangeKind::VertexDropped, Some(place as u32)));
            assert_eq!(change.at, mesh.positions()[place]);
        }
        // The map is all that may be left out.
        assert!(with.1.vertices.is_some() && without.1.vertices.is_none());
        assert_eq!(Step { vertices: None, ..with.1 }, without.1);
    }

    #[test]
    fn weld_within_tells_the_largest_move_that_it_made() {
        for ulps in [1, 5, 40] {
            let gap = f64::from(ulps) * f64::from(f32::EPSILON);
            let (mesh, step) = weld(shapes::seam(ulps), Weld::Within(0.01));
            assert_eq!((mesh.vertex_count(), step.count, step.name), (8, 4, "weld-within"));
            assert_eq!(step.largest_move, gap);
            // Fault injected: a distance below the gap moves nothing.
            let (_, step) = weld(shapes::seam(ulps), Weld::Within(0.9 * gap as f32));
            assert_eq!((step.count, step.largest_move), (0, 0.0));
        }
    }
}
