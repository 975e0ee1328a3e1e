//! The edges of a triangle list and what is counted of them, by looking at all pairs.

use std::collections::BTreeSet;

/// What is counted; see `umbrage::check::Counts` for the terms.
#[derive(Debug, PartialEq)]
pub(crate) struct Counts {
    pub(crate) edges: usize,
    pub(crate) boundary: usize,
    pub(crate) non_manifold: usize,
    pub(crate) misoriented: usize,
    pub(crate) max_faces: usize,
    pub(crate) balanced: bool,
    pub(crate) even: bool,
    pub(crate) shells: usize,
    pub(crate) loops: usize,
    pub(crate) pinched: usize,
    pub(crate) collapsed: usize,
    pub(crate) duplicates: [usize; 2],
    pub(crate) euler: i64,
}

/// The half-edges `(face, tail, head)` of faces with three different corners, in order.
pub(crate) fn half_edges(triangles: &[[u32; 3]]) -> Vec<(usize, u32, u32)> {
    let sound = triangles.iter().enumerate().filter(|(_, corners)| !has_collapsed(**corners));
    sound.flat_map(|(face, &[a, b, c])| [(face, a, b), (face, b, c), (face, c, a)]).collect()
}

/// The faces at an edge, each with its direction along it.
pub(crate) type Uses = Vec<(usize, i32)>;

/// The undirected edges, ascending, with the faces at each, ascending.
pub(crate) fn edges(triangles: &[[u32; 3]]) -> Vec<([u32; 2], Uses)> {
    let half_edges = half_edges(triangles);
    let ends: BTreeSet<[u32; 2]> = half_edges.iter().map(|&(_, a, b)| [a.min(b), a.max(b)]).collect();
    let uses = |[low, high]: [u32; 2]| {
        let along = half_edges.iter().filter_map(|&(face, tail, head)| match (tail, head) {
            _ if (tail, head) == (low, high) => Some((face, 1)),
            _ if (tail, head) == (high, low) => Some((face, -1)),
            _ => None,
        });
        along.collect()
    };
    ends.into_iter().map(|ends| (ends, uses(ends))).collect()
}

pub(crate) fn counts(triangles: &[[u32; 3]]) -> Counts {
    let edges = edges(triangles);
    let sound: Vec<[u32; 3]> = triangles.iter().copied().filter(|&corners| !has_collapsed(corners)).collect();
    let having = |test: &dyn Fn(&Uses) -> bool| edges.iter().filter(|edge| test(&edge.1)).count();
    let sum = |uses: &Uses| uses.iter().map(|(_, direction)| direction).sum::<i32>();
    let common = |f: [u32; 3], g: [u32; 3]| f.iter().filter(|vertex| g.contains(vertex)).count();
    let boundary: Vec<[u32; 2]> =
        edges.iter().filter(|(_, uses)| uses.len() == 1).map(|(ends, _)| *ends).collect();
    let vertices: BTreeSet<u32> = sound.iter().flatten().copied().collect();
    // Two faces at a vertex are in one fan if they share another vertex too: that is an edge at this one.
    let fans = |vertex: u32| {
        let around: Vec<[u32; 3]> = sound.iter().copied().filter(|face| face.contains(&vertex)).collect();
        groups(around.len(), |i, j| common(around[i], around[j]) >= 2)
    };
    Counts {
        edges: edges.len(),
        boundary: boundary.len(),
        non_manifold: having(&|uses| uses.len() > 2),
        misoriented: having(&|uses| uses.len() == 2 && sum(uses) != 0),
        max_faces: edges.iter().map(|(_, uses)| uses.len()).max().unwrap_or(0),
        balanced: having(&|uses| sum(uses) != 0) == 0,
        even: having(&|uses| uses.len() % 2 == 1) == 0,
        shells: groups(sound.len(), |i, j| common(sound[i], sound[j]) >= 2),
        loops: groups(boundary.len(), |i, j| boundary[i].iter().any(|vertex| boundary[j].contains(vertex))),
        pinched: vertices.iter().filter(|&&vertex| fans(vertex) > 1).count(),
        collapsed: triangles.len() - sound.len(),
        duplicates: duplicates(&sound),
        euler: vertices.len() as i64 - edges.len() as i64 + sound.len() as i64,
    }
}

/// Faces beyond the first with the same vertices: those that run as the first one does, and the others.
fn duplicates(faces: &[[u32; 3]]) -> [usize; 2] {
    let mut found = [0; 2];
    for (i, &face) in faces.iter().enumerate() {
        let set: BTreeSet<u32> = face.into();
        if let Some(&[a, b, c]) = faces[..i].iter().find(|&&other| BTreeSet::from(other) == set) {
            found[usize::from(![[a, b, c], [b, c, a], [c, a, b]].contains(&face))] += 1;
        }
    }
    found
}

/// How many groups there are of `n` things of which any two for which `joined` holds are in one.
pub(crate) fn groups(n: usize, joined: impl Fn(usize, usize) -> bool) -> usize {
    let mut seen = vec![false; n];
    let mut count = 0;
    for first in 0..n {
        if std::mem::replace(&mut seen[first], true) {
            continue;
        }
        count += 1;
        let mut waiting = vec![first];
        while let Some(i) = waiting.pop() {
            for j in 0..n {
                if !seen[j] && joined(i, j) {
                    seen[j] = true;
                    waiting.push(j);
                }
            }
        }
    }
    count
}

fn has_collapsed([a, b, c]: [u32; 3]) -> bool {
    a == b || b == c || c == a
}
