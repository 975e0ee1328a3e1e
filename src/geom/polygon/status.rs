//! The sides that the sweep line meets, from below: a list in blocks, searched by halving.

/// Most sides of a block. The list of blocks is short then, and so is what an insertion moves.
const MOST: usize = 512;

/// A sorted list; the order is that of the caller's questions.
#[derive(Default)]
pub(super) struct Status {
    /// None is empty.
    blocks: Vec<Vec<u32>>,
}

/// Between two sides: a block, and an index within it that is at most its length.
#[derive(Clone, Copy)]
pub(super) struct Gap {
    block: usize,
    index: usize,
}

impl Status {
    pub(super) fn clear(&mut self) {
        self.blocks.clear();
    }

    pub(super) fn is_empty(&self) -> bool {
        self.blocks.is_empty()
    }

    /// The gap after all sides that are `below`, which come first.
    pub(super) fn gap(&self, below: impl Fn(u32) -> bool) -> Gap {
        let block = self.blocks.partition_point(|block| below(block[0])).saturating_sub(1);
        let index = self.blocks.get(block).map_or(0, |block| block.partition_point(|&side| below(side)));
        Gap { block, index }
    }

    /// The side below the gap.
    pub(super) fn before(&self, gap: Gap) -> Option<u32> {
        match gap.index.checked_sub(1) {
            Some(index) => Some(self.blocks[gap.block][index]),
            None => self.blocks[..gap.block].last()?.last().copied(),
        }
    }

    /// The sides above the gap, from below.
    pub(super) fn after(&self, gap: Gap) -> impl Iterator<Item = u32> + '_ {
        let (first, rest) = match self.blocks.get(gap.block..) {
            Some([first, rest @ ..]) => (&first[gap.index..], rest),
            _ => (&[][..], &[][..]),
        };
        first.iter().chain(rest.iter().flatten()).copied()
    }

    /// Puts `new` in the stead of the `count` sides above the gap.
    pub(super) fn replace(&mut self, gap: Gap, mut count: usize, new: &[u32]) {
        let Gap { block, index } = gap;
        if self.blocks.is_empty() {
            self.blocks.push(Vec::new());
        }
        let here = count.min(self.blocks[block].len() - index);
        self.blocks[block].splice(index..index + here, new.iter().copied());
        count -= here;
        // What is left lies in the next blocks.
        while count > 0 {
            let next = &mut self.blocks[block + 1];
            let here = count.min(next.len());
            next.drain(..here);
            count -= here;
            if next.is_empty() {
                self.blocks.remove(block + 1);
            }
        }
        if self.blocks[block].is_empty() {
            self.blocks.remove(block);
        } else if self.blocks[block].len() > MOST {
            let whole = std::mem::take(&mut self.blocks[block]);
            let pieces = whole.chunks(MOST / 2).map(<[u32]>::to_vec);
            self.blocks.splice(block..=block, pieces);
        }
    }
}
