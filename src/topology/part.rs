//! Which vertices hang together through edges.

use super::shell::Components;
use super::star::NONE;

/// The connected components of the vertices, met in ascending order with their smaller neighbors.
///
/// Each vertex joins the tree of one smaller neighbor, or starts one: no search. Its other edges may join two
/// trees; they wait until there are many, so that the trees at their ends are looked up side by side, wherever
/// in memory they are, and only the edges between different trees go through union-find over the trees.
pub(super) struct Parts {
    /// The tree of each vertex met so far.
    tree_of: Vec<u32>,
    trees: Components,
    /// Vertices that wait to join the tree of another.
    hooks: Vec<[u32; 2]>,
    /// Edges that wait: the larger vertices and the smaller ones, from the back.
    larger: Vec<u32>,
    smaller: Vec<u32>,
    first_waiting: usize,
    pairs: Vec<[u32; 2]>,
}

impl Parts {
    const BATCH: usize = 2048;

    pub(super) fn new(vertex_count: usize) -> Self {
        Self {
            tree_of: vec![NONE; vertex_count],
            trees: Components::new(0),
            hooks: Vec::with_capacity(Self::BATCH),
            larger: vec![0; Self::BATCH],
            smaller: vec![0; Self::BATCH],
            first_waiting: Self::BATCH,
            pairs: vec![[0; 2]; Self::BATCH + 1],
        }
    }

    /// Adds a vertex and one of its smaller neighbors, if it has any. Vertices come once, in ascending order.
    #[inline]
    pub(super) fn add(&mut self, vertex: u32, smaller: Option<u32>) {
        match smaller {
            Some(other) => self.hooks.push([vertex, other]),
            None => self.tree_of[vertex as usize] = self.trees.push(),
        }
    }

    /// Connects a vertex that was added with smaller ones: the last `count` of `ends`.
    #[inline]
    pub(super) fn connect<const N: usize>(&mut self, vertex: u32, ends: &[u32; N], count: usize) {
        if self.first_waiting < N {
            self.join();
        }
        // All places are written, those that count stay.
        let end = self.first_waiting;
        self.smaller[end - N..end].copy_from_slice(ends);
        self.larger[end - N..end].fill(vertex);
        self.first_waiting -= count;
    }

    /// Joins the trees at the ends of the edges that wait.
    fn join(&mut self) {
        for [vertex, other] in self.hooks.drain(..) {
            self.tree_of[vertex as usize] = self.tree_of[other as usize];
        }
        let mut count = 0;
        for (&a, &b) in self.larger[self.first_waiting..].iter().zip(&self.smaller[self.first_waiting..]) {
            let pair = [self.tree_of[a as usize], self.tree_of[b as usize]];
            self.pairs[count] = pair;
            count += usize::from(self.trees.may_differ(pair));
        }
        for &[a, b] in &self.pairs[..count] {
            self.trees.join(a, b);
        }
        self.first_waiting = Self::BATCH;
    }

    /// How many components there are.
    pub(super) fn count(mut self) -> usize {
        self.join();
        self.trees.count()
    }
}
