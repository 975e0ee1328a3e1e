//! Tiles: boxes of neighboring samples, in a quadtree.

use crate::geom::Aabb;

/// Samples along each side of a tile.
const SIDE: usize = 16;

/// Most tiles that are looked at for one piece; beyond that nothing is claimed.
const MOST: usize = 64;

/// Boxes of tiles of samples, of 2 × 2 tiles, and so on up to a single box.
#[derive(Clone, Debug)]
pub(super) struct Tiles {
    /// From the tiles up.
    levels: Vec<Level>,
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
    pub(super) fn of(row_len: usize, count: usize, point: impl Fn(usize) -> Option<[f32; 3]>) -> Self {
        let (row_len, rows) = (row_len.max(1), count.div_ceil(row_len.max(1)));
        let mut level = Level::empty(row_len.div_ceil(SIDE).max(1), rows.div_ceil(SIDE).max(1));
        for index in 0..count {
            if let Some(p) = point(index) {
                let tile = index / row_len / SIDE * level.columns + index % row_len / SIDE;
                level.boxes[tile] = level.boxes[tile].join(&Aabb { low: p, high: p });
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
        Self { levels }
    }

    /// A box around all samples that count.
    #[cfg(test)]
    fn bounds(&self) -> Aabb {
        self.levels[self.levels.len() - 1].boxes[0]
    }

    /// The boxes of the tiles that hold a sample.
    pub(super) fn boxes(&self) -> impl Iterator<Item = &Aabb> {
        self.levels[0].boxes.iter().filter(|aabb| !aabb.is_empty())
    }

    /// Whether `is_apart` holds for boxes that together hold all samples. False after too many boxes.
    pub(super) fn all_apart(&self, mut is_apart: impl FnMut(&Aabb) -> bool) -> bool {
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
        }
        assert!(Tiles::of(0, 0, |_| None).bounds().is_empty());
    }
}
