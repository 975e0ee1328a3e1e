//! Members in sets, each on one of two sides of its set.

/// A partition of `0..n` into sets, each led by its smallest member, in which every member is on the side of
/// the leader or on the other one. Near-linear time: union-find with path halving, which carries the sides.
pub(super) struct Parity {
    parent: Vec<u32>,
    /// Whether a member is on the other side than its parent.
    differs: Vec<bool>,
}

impl Parity {
    /// `n` sets of one member each, which fit 32 bits.
    pub(super) fn new(n: usize) -> Self {
        Self { parent: (0..n as u32).collect(), differs: vec![false; n] }
    }

    /// The leader of a member, and whether the member is on the other side.
    pub(super) fn find(&mut self, mut member: u32) -> (u32, bool) {
        let mut side = false;
        loop {
            let at = member as usize;
            let parent = self.parent[at];
            if parent == member {
                return (member, side);
            }
            self.differs[at] ^= self.differs[parent as usize];
            self.parent[at] = self.parent[parent as usize];
            side ^= self.differs[at];
            member = self.parent[at];
        }
    }

    /// Puts two members into one set, on different sides or on one. Whether that is possible: `false` if they
    /// are in one set otherwise.
    pub(super) fn join(&mut self, a: u32, b: u32, differ: bool) -> bool {
        let ((a, a_side), (b, b_side)) = (self.find(a), self.find(b));
        let differ = differ ^ a_side ^ b_side;
        if a == b {
            return !differ;
        }
        let member = a.max(b) as usize;
        (self.parent[member], self.differs[member]) = (a.min(b), differ);
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::SplitMix64;

    #[test]
    fn sides_are_those_of_a_walk_over_all_joins() {
        for seed in 0..50 {
            let mut random = SplitMix64(seed);
            let side: Vec<bool> = (0..40).map(|_| random.below(2) == 1).collect();
            let mut parity = Parity::new(40);
            let mut sets: Vec<u32> = (0..40).collect();
            for _ in 0..30 {
                let (a, b) = (random.below(40), random.below(40));
                assert!(parity.join(a as u32, b as u32, side[a] != side[b]));
                let (from, to) = (sets[a].max(sets[b]), sets[a].min(sets[b]));
                sets.iter_mut().filter(|set| **set == from).for_each(|set| *set = to);
                // Fault injected: the opposite of what is known.
                assert!(!parity.join(b as u32, a as u32, side[a] == side[b]));
            }
            for member in 0..40 {
                let (leader, differs) = parity.find(member as u32);
                assert_eq!(leader, sets[member]);
                assert_eq!(differs, side[member] != side[leader as usize]);
            }
        }
    }
}
