//! Where the vertices or faces of a mesh are after repair.

/// The new indices of each old one: none if it was dropped, several if it was split or cut. Several old ones
/// may have the same new one, if they were merged. 4 bytes per index.
///
/// ```
/// use umbrage::repair::{self, Options};
/// use umbrage::testing::shapes;
/// let mut options = Options::default();
/// options.map = true;
/// let soup = shapes::soup(&shapes::cube());
/// let prepared = repair::prepare(soup.clone(), &options)?;
/// let (vertices, _) = prepared.map.as_ref().expect("it was asked for");
/// let &[new] = vertices.of(3) else { panic!("it was merged") };
/// assert_eq!(prepared.mesh.positions()[new as usize], soup.positions()[3]);
/// # Ok::<(), umbrage::mesh::MeshError>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct IndexMap {
    /// Where the new indices of each old one start in `new`; then the length of `new`.
    starts: Vec<u32>,
    new: Vec<u32>,
}

impl IndexMap {
    /// Each of `count` indices as it is.
    #[must_use]
    pub(super) fn identity(count: usize) -> Self {
        // A mesh has fewer vertices, and fewer faces, than 32-bit numbers.
        Self { starts: (0..=count as u32).collect(), new: (0..count as u32).collect() }
    }

    /// From the new index of each old one, if it has one.
    pub(super) fn forward(new_of: impl Iterator<Item = Option<u32>>) -> Self {
        let (mut starts, mut new) = (vec![0], Vec::new());
        for index in new_of {
            new.extend(index);
            starts.push(new.len() as u32);
        }
        Self { starts, new }
    }

    /// From the old index, below `count`, of each new one.
    pub(super) fn backward(old_of: &[u32], count: usize) -> Self {
        let mut starts = vec![0; count + 1];
        for &old in old_of {
            starts[old as usize + 1] += 1;
        }
        for old in 0..count {
            starts[old + 1] += starts[old];
        }
        let (mut next, mut new) = (starts.clone(), vec![0; old_of.len()]);
        for (index, &old) in (0..).zip(old_of) {
            let slot = &mut next[old as usize];
            new[*slot as usize] = index;
            *slot += 1;
        }
        Self { starts, new }
    }

    /// This map, and then `next`.
    pub(super) fn then(&self, next: &Self) -> Self {
        let (mut starts, mut new) = (Vec::with_capacity(self.starts.len()), Vec::new());
        starts.push(0);
        for old in 0..self.len() as u32 {
            let from = new.len();
            new.extend(self.of(old).iter().flat_map(|&middle| next.of(middle)));
            new[from..].sort_unstable();
            starts.push(new.len() as u32);
        }
        Self { starts, new }
    }

    /// The new indices of an old one, ascending.
    ///
    /// # Panics
    ///
    /// Panics if `old` is not below [`IndexMap::len`].
    #[must_use]
    pub fn of(&self, old: u32) -> &[u32] {
        let [start, end] = [old as usize, old as usize + 1].map(|at| self.starts[at] as usize);
        &self.new[start..end]
    }

    /// The number of old indices.
    #[must_use]
    pub fn len(&self) -> usize {
        self.starts.len() - 1
    }

    /// Whether there are no old indices.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The new indices of all old ones in order, and where those of each old one start; then the number of
    /// all. For buffers.
    #[must_use]
    pub fn to_lists(&self) -> (&[u32], &[u32]) {
        (&self.starts, &self.new)
    }

    /// The new indices of each old one.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = &[u32]> {
        self.starts.windows(2).map(|ends| &self.new[ends[0] as usize..ends[1] as usize])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn index_maps_are_followed_one_after_the_other() {
        // 1 is dropped, 0 and 3 become one; then 1 is split, with a new index at the end.
        let merged = IndexMap::forward([Some(0), None, Some(1), Some(0)].into_iter());
        let split = IndexMap::backward(&[0, 1, 1], 2);
        let both = merged.then(&split);
        let lists: Vec<_> = both.iter().collect();
        assert_eq!(lists, [&[0][..], &[], &[1, 2], &[0]]);
        assert_eq!((both.of(2), both.len()), (&[1, 2][..], 4));
        assert_eq!(IndexMap::identity(4).then(&both), both);
        assert_eq!(both.then(&IndexMap::identity(3)), both);
        // Fault injected: the maps in the wrong order are another map.
        assert_ne!(split.then(&merged), both);
    }
}
