//! Tiles: boxes of neighboring samples, in a quadtree.

use std::ops::Range;

use crate::geom::Aabb;

/// Samples along each side of a tile.
pub(crate) const SIDE: usize = 16;

/// Most tiles that are looked at for one piece; beyond that nothing is claimed.
const MOST: usize = 64;

/// Boxes of tiles of samples, of 2 × 2 tiles, and so on up to a single box.
#[derive(Clone, Debug)]
pub(crate) struct Tiles {
    /// From the tiles up.
    levels: Vec<Level>,
    row_len: usize,
    count: usize,
}

#[derive(Clone, Debug)]
struct Level {
    columns: usize,
    rows: usize,
    boxes: Vec<Aabb>,
}

impl Level {
    fn empty(columns: usize, rows: usize) -> Self {
        Self { columns, rows, boxes: vec![Aabb::EMPTY; columns * rows] }
    }
}

impl Tiles {
    /// The tiles of `count` samples in rows of `row_len`; `point` gives the sample's point if it counts.
    pub(crate) fn of(row_len: usize, count: usize, point: impl Fn(usize) -> Option<[f32; 3]>) -> Self {
        Self::of_boxes(row_len, count, |index| point(index).map(|p| Aabb { low: p, high: p }))
    }

    /// The same, with a box around each sample that counts.
    pub(crate) fn of_boxes(row_len: usize, count: usize, around: impl Fn(usize) -> Option<Aabb>) -> Self {
        let (row_len, rows) = (row_len.max(1), count.div_ceil(row_len.max(1)));
        let mut level = Level::empty(row_len.div_ceil(SIDE).max(1), rows.div_ceil(SIDE).max(1));
        for index in 0..count {
            if let Some(own) = around(index) {
                let tile = index / row_len / SIDE * level.columns + index % row_len / SIDE;
                level.boxes[tile] = level.boxes[tile].join(&own);
            }
        }
        let mut levels = vec![level];
        while let Some(below) = levels.last().filter(|level| level.boxes.len() > 1) {
            let mut level = Level::empty(below.columns.div_ceil(2), below.rows.div_ceil(2));
            for (index, aabb) in below.boxes.iter().enumerate() {
                let parent = index / below.columns / 2 * level.columns + index % below.columns / 2;
                level.boxes[parent] = level.boxes[parent].join(aabb);
            }
            levels.push(level);
        }
        Self { levels, row_len, count }
    }

    /// A box around all samples that count.
    #[cfg(test)]
    fn bounds(&self) -> Aabb {
        self.levels[self.levels.len() - 1].boxes[0]
    }

    /// The boxes of the tiles that hold a sample.
    pub(crate) fn boxes(&self) -> impl Iterator<Item = &Aabb> {
        self.levels[0].boxes.iter().filter(|aabb| !aabb.is_empty())
    }

    /// The samples of the tiles whose boxes overlap a box, as ranges within rows.
    pub(crate) fn overlapping(&self, bounds: &Aabb) -> impl Iterator<Item = Range<usize>> {
        let (columns, bounds) = (self.levels[0].columns, *bounds);
        let tiles = self.levels[0].boxes.iter().enumerate().filter(move |(_, tile)| tile.overlaps(&bounds));
        tiles.flat_map(move |(tile, _)| {
            let [from, to] = [0, 1].map(|next| ((tile % columns + next) * SIDE).min(self.row_len));
            let rows = (tile / columns * SIDE..).take(SIDE).map(move |row| row * self.row_len);
            rows.map(move |row| (row + from).min(self.count)..(row + to).min(self.count))
        })
    }

    /// The columns of tiles in a row.
    #[cfg(feature = "gpu")]
    pub(crate) fn columns(&self) -> usize {
        self.levels[0].columns
    }

    /// For each tile, row by row: whether it holds a sample, and `is_apart` holds neither for its box nor for
    /// one around it.
    #[cfg(feature = "gpu")]
    pub(crate) fn kept(&self, mut is_apart: impl FnMut(&Aabb) -> bool) -> Vec<bool> {
        let mut kept = vec![true];
        for (height, level) in self.levels.iter().enumerate().rev() {
            let above = self.levels.get(height + 1);
            let is_kept = |(index, aabb): (usize, &Aabb)| {
                let parent = |above: &Level| {
                    kept[index / level.columns / 2 * above.columns + index % level.columns / 2]
                };
                above.is_none_or(parent) && !aabb.is_empty() && !is_apart(aabb)
            };
            kept = level.boxes.iter().enumerate().map(is_kept).collect();
        }
        kept
    }

    /// Whether `is_apart` holds for boxes that together hold all samples. False after too many boxes.
    pub(crate) fn all_apart(&self, mut is_apart: impl FnMut(&Aabb) -> bool) -> bool {
        // Each level adds at most three to what waits.
        let mut waiting = [(0, 0, 0); 3 * 32 + 1];
        waiting[0] = (self.levels.len() - 1, 0, 0);
        let (mut count, mut looks) = (1, MOST);
        while count > 0 {
            count -= 1;
            let (height, column, row) = waiting[count];
            let level = &self.levels[height];
            let aabb = &level.boxes[row * level.columns + column];
            if aabb.is_empty() || is_apart(aabb) {
                continue;
            }
            looks -= 1;
            if height == 0 || looks == 0 {
                return false;
            }
            let below = &self.levels[height - 1];
            for (dx, dy) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
                let (column, row) = (2 * column + dx, 2 * row + dy);
                if column < below.columns && row < below.rows {
                    waiting[count] = (height - 1, column, row);
                    count += 1;
                }
            }
        }
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tiles_hold_every_sample_and_tell_apart_what_is() {
        for (row_len, rows) in [(1, 1), (16, 16), (17, 33), (100, 3), (160, 90)] {
            let at = |index: usize| [(index % row_len) as f32, (index / row_len) as f32, 1.0];
            let counts = |index: usize| (index % 7 != 3).then(|| at(index));
            let tiles = Tiles::of(row_len, row_len * rows, counts);
            let all = Aabb::around((0..row_len * rows).filter_map(counts));
            assert_eq!(tiles.bounds(), all);
            assert!(tiles.all_apart(|aabb| !aabb.contains([-1.0; 3])));
            let points =
                (0..row_len * rows).filter_map(counts).filter(|&p| tiles.all_apart(|b| !b.contains(p)));
            assert_eq!(points.count(), 0);
            #[cfg(feature = "gpu")]
            {
                // What is kept is what no plane parts, tile by tile.
                let is_apart = |aabb: &Aabb| aabb.low[0] > 20.0 || aabb.high[1] < 18.0;
                let is_kept = |aabb: &Aabb| !aabb.is_empty() && !is_apart(aabb);
                let expected: Vec<bool> = tiles.levels[0].boxes.iter().map(is_kept).collect();
                assert_eq!(tiles.kept(is_apart), expected);
                assert_eq!(tiles.columns(), row_len.div_ceil(SIDE));
            }
            let mut found: Vec<usize> = tiles.overlapping(&all).flatten().collect();
            found.sort_unstable();
            assert!(found.into_iter().eq(0..row_len * rows));
            let corner = Aabb { low: at(0), high: at(0) };
            assert!(tiles.overlapping(&corner).flatten().any(|sample| sample == 0));
            assert!(tiles.overlapping(&corner).flatten().all(|sample| sample % row_len < SIDE));
        }
        assert!(Tiles::of(0, 0, |_| None).bounds().is_empty());
    }
}
