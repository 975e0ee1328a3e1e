//! The border of a mesh as loops without a vertex twice.

use crate::topology::Topology;

/// The border, in the directions that patches run.
pub(super) struct Loops {
    /// The vertices of each loop, three or more, each once.
    pub(super) loops: Vec<Vec<u32>>,
    /// The vertices of what does not close.
    pub(super) chains: Vec<Vec<u32>>,
}

/// Walks along the border. Where the walk comes to a vertex that it has passed, a loop is cut off; where it
/// ends, it takes back its last edges, which close to no loop. Linear in the border, but for a sort.
pub(super) fn loops(topology: &Topology) -> Loops {
    // A patch runs against the face at each edge.
    let mut edges: Vec<[u32; 2]> = topology
        .edges()
        .filter(|&edge| topology.valence(edge) == 1)
        .filter_map(|edge| topology.half_edges(edge).next())
        .map(|half_edge| [topology.head(half_edge).0, topology.tail(half_edge).0])
        .collect();
    edges.sort_unstable();
    // The next edge of each vertex that is not used yet, by the index of the vertex's first edge.
    let first = |vertex: u32| edges.partition_point(|edge| edge[0] < vertex);
    let mut next: Vec<usize> = (0..edges.len()).collect();
    let mut take = |vertex: u32| {
        let start = first(vertex);
        let edge = *next.get(start)?;
        let to = edges.get(edge).filter(|edge| edge[0] == vertex)?[1];
        next[start] += 1;
        Some(to)
    };
    let mut found = Loops { loops: Vec::new(), chains: Vec::new() };
    // The index of each vertex on the walk, by its first edge. One without an outgoing edge ends the walk.
    let mut on_walk = vec![usize::MAX; edges.len()];
    for start in edges.iter().map(|edge| edge[0]) {
        let mut walk = vec![start];
        let mut back: Vec<u32> = Vec::new();
        on_walk[first(start)] = 0;
        while let Some(&at) = walk.last() {
            let Some(to) = take(at) else {
                // Nothing leads on: what led here is no part of a loop.
                walk.pop();
                if has_edge(&edges, first(at), at) {
                    on_walk[first(at)] = usize::MAX;
                }
                if walk.is_empty() {
                    end(&mut back, at, &mut found.chains);
                } else {
                    back.push(at);
                }
                continue;
            };
            // Edges that were taken back before this one are a chain of their own.
            end(&mut back, at, &mut found.chains);
            let slot = first(to);
            match has_edge(&edges, slot, to).then(|| on_walk[slot]) {
                Some(place) if place != usize::MAX => {
                    for &vertex in &walk[place + 1..] {
                        on_walk[first(vertex)] = usize::MAX;
                    }
                    found.loops.push(walk.drain(place + 1..).chain([to]).collect());
                }
                other => {
                    if other.is_some() {
                        on_walk[slot] = walk.len();
                    }
                    walk.push(to);
                }
            }
        }
    }
    found
}

fn has_edge(edges: &[[u32; 2]], slot: usize, vertex: u32) -> bool {
    edges.get(slot).is_some_and(|edge| edge[0] == vertex)
}

/// Ends the chain of edges that were taken back, which began at `from`.
fn end(back: &mut Vec<u32>, from: u32, chains: &mut Vec<Vec<u32>>) {
    if !back.is_empty() {
        back.push(from);
        back.reverse();
        chains.push(std::mem::take(back));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::Mesh;
    use crate::random::SplitMix64;
    use crate::testing::shapes;

    fn of(mesh: &Mesh) -> Loops {
        loops(&Topology::of(mesh))
    }

    /// Every edge of the border is in one loop or chain, and no loop has a vertex twice.
    fn assert_all_there(mesh: &Mesh, found: &Loops) {
        let topology = Topology::of(mesh);
        let border = topology.edges().filter(|&edge| topology.valence(edge) == 1);
        let mut wanted: Vec<[u32; 2]> = border
            .map(|edge| topology.half_edges(edge).next().unwrap())
            .map(|half_edge| [topology.head(half_edge).0, topology.tail(half_edge).0])
            .collect();
        let closed = found.loops.iter().flat_map(|ring| {
            (0..ring.len()).map(|i| [ring[i], ring[(i + 1) % ring.len()]]).collect::<Vec<_>>()
        });
        let open = found.chains.iter().flat_map(|chain| chain.windows(2).map(|pair| [pair[0], pair[1]]));
        let mut edges: Vec<[u32; 2]> = closed.chain(open).collect();
        edges.sort_unstable();
        wanted.sort_unstable();
        assert_eq!(edges, wanted);
        for ring in &found.loops {
            let mut vertices = ring.clone();
            vertices.sort_unstable();
            vertices.dedup();
            assert!(ring.len() > 2 && vertices.len() == ring.len(), "{ring:?}");
        }
    }

    #[test]
    fn loops_are_the_border_and_have_no_vertex_twice() {
        let lengths = |mesh: &Mesh| {
            let found = of(mesh);
            assert_all_there(mesh, &found);
            let mut lengths: Vec<usize> = found.loops.iter().map(Vec::len).collect();
            lengths.sort_unstable();
            (lengths, found.chains.len())
        };
        assert_eq!(lengths(&shapes::open_cube()), (vec![4], 0));
        assert_eq!(lengths(&shapes::cube()), (vec![], 0));
        // Two triangles that touch at a vertex: two loops, though the border is connected.
        let positions = (0..5).map(|k| [k as f32, (k * k) as f32, 0.0]).collect();
        let bow_tie = Mesh::new(positions, vec![[0, 1, 2], [2, 3, 4]]).unwrap();
        assert_eq!(lengths(&bow_tie), (vec![3, 3], 0));
        // The strip's windings disagree at one edge, so that its border does not run on there.
        let (_, chains) = lengths(&shapes::mobius(9));
        assert!(chains > 0);
        let mut random = SplitMix64(3);
        for _ in 0..200 {
            let faces = (0..12).map(|_| [(); 3].map(|()| random.below(8) as u32)).collect();
            let mesh = Mesh::new((0..8).map(|k| [k as f32, 0.0, 0.0]).collect(), faces).unwrap();
            assert_all_there(&mesh, &of(&mesh));
        }
    }

    #[test]
    fn a_lost_edge_of_the_border_would_be_seen() {
        let mesh = shapes::open_cube();
        let mut found = of(&mesh);
        found.loops[0].pop(); // fault injected
        assert!(std::panic::catch_unwind(|| assert_all_there(&mesh, &found)).is_err());
    }
}
