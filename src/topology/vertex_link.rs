//! Everything that can be decided from the one-ring of a vertex: its fans, and which components it connects.
//!
//! A face (v, x, y) is the directed edge x → y of the link of v. Faces that share an edge at v are link edges
//! that share an end, so the fans of v are the connected components of its link. Nearly always the link is
//! one cycle; that is tested without data-dependent branches. Any other link takes the slow path,
//! [`LinkBuilder::add_irregular`].
//!
//! Which edges are needed to connect the vertices: in the order of their numbers, vertex v is added to the
//! vertices below it. Lower-numbered neighbors that follow each other in the link are connected by an edge of
//! the mesh, so one edge from v to each run of them is enough (the lower link of Thomas Banchoff, *Critical
//! Points and Curvature for Embedded Polyhedra*, 1967). A link that is a cycle has as many runs as edges that
//! rise from below v to above it, or is one run.

use bytemuck::{Pod, Zeroable};
use multiversion::multiversion;

use super::components::{Components, NONE, VertexComponents};

/// An edge of the link of a vertex: the other two corners of a face, in the order of its winding.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub(super) struct LinkEdge {
    pub(super) from: u32,
    pub(super) to: u32,
}

/// Collects what the links of all vertices say, in ascending order of the vertices.
pub(super) struct LinkBuilder {
    /// At each vertex with several fans: the vertex, and the index of each fan's first edge within its link.
    pub(super) fans: Vec<[u32; 2]>,
    /// The number of vertices with a link.
    pub(super) vertices: usize,
    /// Whether two faces have the same three vertices.
    pub(super) repeats: bool,
    pub(super) components: VertexComponents,
    neighbors: Vec<u32>,
    edges: Vec<[u32; 2]>,
}

/// Adds the links of the vertices from `first` on: the end of each vertex's edges, which begin where the
/// previous vertex's end; and the edges, with [`SLACK`](super::counting_sort::SLACK) more past the last one.
#[multiversion(targets("x86_64+avx2+bmi1+bmi2"))]
pub(super) fn add(links: &mut LinkBuilder, first: u32, ends: &[u32], edges: &[LinkEdge]) {
    let mut start = 0;
    for (vertex, &end) in (first..).zip(ends) {
        let degree = (end - start) as usize;
        let at = start as usize;
        start = end;
        if degree == 0 {
            continue;
        }
        links.vertices += 1;
        let is_cycle = match degree {
            2..=8 => links.add_cycle::<8>(vertex, edges[at..].first_chunk().expect("slack"), degree),
            9..=16 => links.add_cycle::<16>(vertex, edges[at..].first_chunk().expect("slack"), degree),
            _ => false,
        };
        if !is_cycle {
            links.add_irregular(vertex, &edges[at..at + degree]);
        }
    }
}

impl LinkBuilder {
    pub(super) fn new(vertex_count: usize) -> Self {
        Self {
            fans: Vec::new(),
            vertices: 0,
            repeats: false,
            components: VertexComponents::new(vertex_count),
            neighbors: Vec::new(),
            edges: Vec::new(),
        }
    }

    /// Adds a link if it is one cycle, otherwise leaves everything unchanged. Only the first `degree` edges
    /// count.
    #[inline(always)]
    fn add_cycle<const N: usize>(&mut self, vertex: u32, edges: &[LinkEdge; N], degree: usize) -> bool {
        const { assert!(N <= 16, "a lane number has 4 bits") };
        // Lanes past `degree` match no vertex. (A comparison of 32 bits, as wide as the lanes.)
        let counts = |lane: usize| (lane as u32) < degree as u32;
        let (mut from, mut to) = ([NONE; N], [NONE; N]);
        for i in 0..N {
            from[i] = if counts(i) { edges[i].from } else { NONE };
            to[i] = if counts(i) { edges[i].to } else { NONE };
        }
        // For each edge the sum over all edges that begin at its end: 256 for each, plus its number. Lanes
        // past `degree` follow each other only, and their numbers are not 0.
        let mut followers = [0_u32; N];
        for j in 0..N {
            for i in 0..N {
                followers[i] += if from[j] == to[i] { 256 + j as u32 } else { 0 };
            }
        }
        let (mut not_one, mut first_follows) = (0, 0);
        let (mut lowest, mut rises) = (NONE, 0);
        for i in 0..N {
            not_one |= if counts(i) { followers[i] >> 8 ^ 1 } else { 0 };
            first_follows |= u32::from(followers[i] == 256);
            lowest = lowest.min(from[i]);
            rises += u32::from((from[i] < vertex) & (to[i] > vertex));
        }
        // The numbers of the followers, 4 bits each, in one register.
        let mut next = 0_u64;
        for i in 0..N {
            next |= u64::from(followers[i] & 15) << (4 * i);
        }
        // The walk from the first edge, N steps whatever the degree. If it visits all edges, each of them but
        // the first follows another; if the first one does too, the walk is one cycle.
        let (mut visited, mut at) = (0_u32, 0);
        for _ in 0..N {
            visited |= 1 << at;
            at = next >> (4 * at) & 15;
        }
        if not_one != 0 || first_follows == 0 || visited != (1 << degree) - 1 {
            return false;
        }
        self.repeats |= degree == 2;
        self.components.add(vertex, (lowest < vertex).then_some(lowest));
        if rises > 1 {
            self.connect_runs(vertex, &from, &to);
        }
        true
    }

    /// Connects a vertex with the last vertex of each run of lower-numbered neighbors.
    #[inline(never)]
    fn connect_runs(&mut self, vertex: u32, from: &[u32], to: &[u32]) {
        for (&from, &to) in from.iter().zip(to) {
            if from < vertex && to > vertex {
                self.components.connect(vertex, from);
            }
        }
    }

    /// Adds any link. k·log k for k edges.
    #[cold]
    #[inline(never)]
    fn add_irregular(&mut self, vertex: u32, link: &[LinkEdge]) {
        let Self { neighbors, edges, .. } = self;
        neighbors.clear();
        neighbors.extend(link.iter().flat_map(|edge| [edge.from, edge.to]));
        neighbors.sort_unstable();
        neighbors.dedup();
        let lower = neighbors.partition_point(|&other| other < vertex);
        self.components.add(vertex, neighbors[..lower].first().copied());
        for &other in neighbors[..lower].iter().skip(1) {
            self.components.connect(vertex, other);
        }
        if link.len() == 1 {
            return;
        }
        edges.clear();
        edges.extend(link.iter().map(|edge| [edge.from.min(edge.to), edge.from.max(edge.to)]));
        edges.sort_unstable();
        self.repeats |= edges.windows(2).any(|pair| pair[0] == pair[1]);
        let number = |other: u32| neighbors.partition_point(|&neighbor| neighbor < other) as u32;
        let mut fans = Components::new(neighbors.len());
        for edge in link {
            fans.join(number(edge.from), number(edge.to));
        }
        if fans.count() == 1 {
            return;
        }
        let mut met = vec![false; neighbors.len()];
        for (index, edge) in (0..).zip(link) {
            let fan = fans.find(number(edge.from)) as usize;
            if !std::mem::replace(&mut met[fan], true) {
                self.fans.push([vertex, index]);
            }
        }
    }
}
