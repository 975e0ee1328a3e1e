//! Connected components by union-find, and those of the vertices of a mesh.

/// A partition of `0..n` into sets, each led by its smallest member. Near-linear time.
///
/// Robert E. Tarjan, *Efficiency of a Good But Not Linear Set Union Algorithm*, 1975; with path halving
/// (Tarjan and van Leeuwen, 1984). The smallest member leads, so the result does not depend on the order of
/// the joins.
#[derive(Clone, Debug)]
pub(crate) struct Components {
    parent: Vec<u32>,
}

impl Components {
    /// `n` sets of one member each.
    ///
    /// # Panics
    ///
    /// Panics if `n` does not fit in 32 bits.
    #[must_use]
    pub(crate) fn new(n: usize) -> Self {
        let n = u32::try_from(n).expect("members are 32-bit ids");
        Self { parent: (0..n).collect() }
    }

    /// The leader of `member`'s set.
    #[inline]
    pub(crate) fn find(&mut self, mut member: u32) -> u32 {
        loop {
            let parent = self.parent[member as usize];
            if parent == member {
                return member;
            }
            let grandparent = self.parent[parent as usize];
            self.parent[member as usize] = grandparent;
            member = grandparent;
        }
    }

    /// Joins two sets; gives the leader of both.
    #[inline]
    pub(crate) fn join(&mut self, a: u32, b: u32) -> u32 {
        let (a, b) = (self.find(a), self.find(b));
        let leader = a.min(b);
        self.parent[a.max(b) as usize] = leader;
        leader
    }

    /// The number of each member's set, counted in the order of the leaders among `members`; and the number
    /// of sets. Members that are not wanted get `None`.
    pub(crate) fn number(mut self, wanted: impl Fn(u32) -> bool) -> (Vec<Option<u32>>, usize) {
        let mut number_of = vec![None; self.parent.len()];
        let mut count = 0;
        for member in 0..self.parent.len() as u32 {
            if !wanted(member) {
                continue;
            }
            let leader = self.find(member) as usize;
            if number_of[leader].is_none() {
                number_of[leader] = Some(count);
                count += 1;
            }
            number_of[member as usize] = number_of[leader];
        }
        (number_of, count as usize)
    }

    /// Adds a set of one member; gives that member.
    fn push(&mut self) -> u32 {
        let member = self.parent.len() as u32;
        self.parent.push(member);
        member
    }

    /// The number of sets.
    pub(super) fn count(&self) -> usize {
        (0..).zip(&self.parent).filter(|&(member, &parent)| member == parent).count()
    }
}

/// No vertex has this id, see [`Mesh::new`](crate::mesh::Mesh::new).
pub(super) const NONE: u32 = u32::MAX;

/// The connected components of the vertices of a mesh, which arrive in ascending order.
///
/// Each vertex takes the component of one lower-numbered neighbor, or starts a new one, without a union-find
/// lookup. Its edges to other lower-numbered neighbors are queued and handled in batches so that their cache
/// misses overlap; only edges between different components reach the union-find.
pub(super) struct VertexComponents {
    /// The component that each vertex took, an id of `sets`.
    component_of: Vec<u32>,
    sets: Components,
    /// Queued: a vertex and the neighbor whose component it takes.
    hooks: Vec<[u32; 2]>,
    /// Queued: edges that may join two components.
    edges: Vec<[u32; 2]>,
}

impl VertexComponents {
    const BATCH: usize = 2048;

    pub(super) fn new(vertex_count: usize) -> Self {
        Self {
            component_of: vec![NONE; vertex_count],
            sets: Components::new(0),
            hooks: Vec::with_capacity(Self::BATCH),
            edges: Vec::new(),
        }
    }

    /// Adds a vertex and one of its lower-numbered neighbors, if it has any. Each vertex comes once, in
    /// ascending order.
    #[inline(always)]
    pub(super) fn add(&mut self, vertex: u32, lower: Option<u32>) {
        match lower {
            Some(other) => self.hooks.push([vertex, other]),
            None => self.component_of[vertex as usize] = self.sets.push(),
        }
        if self.hooks.len() == Self::BATCH {
            self.join();
        }
    }

    /// Connects a vertex that was added with a lower-numbered one.
    #[inline]
    pub(super) fn connect(&mut self, vertex: u32, lower: u32) {
        self.edges.push([vertex, lower]);
        if self.edges.len() == Self::BATCH {
            self.join();
        }
    }

    /// Handles what is queued.
    #[inline(never)]
    fn join(&mut self) {
        for [vertex, other] in self.hooks.drain(..) {
            self.component_of[vertex as usize] = self.component_of[other as usize];
        }
        for edge in &mut self.edges {
            *edge = edge.map(|vertex| self.component_of[vertex as usize]);
        }
        for [a, b] in self.edges.drain(..) {
            // Equal parents: surely one set already, without a search.
            if self.sets.parent[a as usize] != self.sets.parent[b as usize] {
                self.sets.join(a, b);
            }
        }
    }

    /// The number of components.
    pub(super) fn count(mut self) -> usize {
        self.join();
        self.sets.count()
    }
}
