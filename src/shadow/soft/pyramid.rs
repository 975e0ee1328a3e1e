//! Least and greatest depths of the tiles of a map, and of larger and larger squares of tiles.

use crate::shadow::map::ShadowMap;

/// Side of a tile in texels.
pub(super) const TILE: usize = 8;
/// Cells along each side of a box that are looked at.
const SPAN: i64 = 4;

/// Bound of the ratio between a point's depths in two neighboring layers of a cube, up to one layer's side
/// beyond the rim.
pub(super) const MOST_RATIO: f64 = 3.0;

/// Least and greatest depth of a square of texels.
pub(super) type Range = [f32; 2];

/// The range of no texels.
pub(super) const EMPTY: Range = [f32::INFINITY, 0.0];

#[derive(Debug)]
pub(super) struct Pyramid {
    layers: Vec<Vec<Level>>,
    most: f32,
    /// Side of the map in texels.
    size: i64,
}

#[derive(Debug)]
struct Level {
    side: usize,
    /// Side of a cell in texels.
    cell: i64,
    cells: Vec<Range>,
}

impl Pyramid {
    pub(super) fn of(map: &ShadowMap<f32>) -> Self {
        let side = map.space().size() as usize;
        let layers: Vec<_> =
            map.texels().chunks_exact(side * side).map(|texels| levels(texels, side)).collect();
        let tops = layers.iter().filter_map(|levels| levels.last()?.cells.first());
        let most = tops.fold(0.0, |most: f32, top| most.max(top[1]));
        Self { most, size: side as i64, layers }
    }

    /// A bound of the depths in terms of any layer.
    pub(super) fn most(&self) -> f64 {
        let most = f64::from(self.most);
        if self.layers.len() > 1 { MOST_RATIO * most } else { most }
    }

    /// The greatest depth.
    pub(super) fn most_drawn(&self) -> f32 {
        self.most
    }

    /// Tiles along a side.
    pub(super) fn side(&self) -> usize {
        self.layers[0][0].side
    }

    /// The tile in column `i` and row `j` of tiles.
    pub(super) fn tile(&self, layer: usize, i: usize, j: usize) -> Range {
        let level = &self.layers[layer][0];
        level.cells[j * level.side + i]
    }

    /// A bound of the greatest depth within a box of a layer, and the number of cells that were read. A box
    /// that reaches beyond a layer of a cube is bounded by all layers.
    pub(super) fn most_within(&self, layer: usize, at: [f64; 2], half_sides: [f64; 2]) -> (f64, u32) {
        // Beyond any map, so that numbers stay small.
        let within = |t: f64| t.floor().clamp(-1.0, self.size as f64) as i64;
        let ends =
            [0, 1].map(|axis| [within(at[axis] - half_sides[axis]), within(at[axis] + half_sides[axis])]);
        let is_beyond = ends.iter().any(|&[low, high]| low < 0 || high >= self.size);
        if is_beyond && self.layers.len() > 1 {
            let half = 0.5 * self.size as f64;
            let farthest = |axis: usize| ((at[axis] - half).abs() + half_sides[axis]) / half;
            let ratio = farthest(0).max(farthest(1)).clamp(1.0, MOST_RATIO);
            return (ratio * f64::from(self.most), 0);
        }
        let (most, cells) = self.most_of_texels(layer, ends.map(|end| end.map(|t| t as i32)));
        (f64::from(most), cells)
    }

    /// A bound of the greatest depth of the texels from column to column and from row to row, as far as they
    /// lie on a layer, and the number of cells that were read.
    pub(super) fn most_of_texels(&self, layer: usize, ends: [[i32; 2]; 2]) -> (f32, u32) {
        let ends = ends.map(|end| end.map(|t| i64::from(t).clamp(0, self.size - 1)));
        let levels = &self.layers[layer];
        let fits =
            |level: &&Level| ends.iter().all(|[low, high]| high / level.cell - low / level.cell < SPAN);
        // The last level is one cell.
        let level = levels.iter().find(fits).unwrap_or(&levels[levels.len() - 1]);
        let [columns, rows] =
            ends.map(|[low, high]| (low / level.cell) as usize..=(high / level.cell) as usize);
        let (mut most, mut cells) = (0.0_f32, 0);
        for j in rows {
            for &[_, greatest] in &level.cells[j * level.side..][columns.clone()] {
                most = most.max(greatest);
                cells += 1;
            }
        }
        (most, cells)
    }

    pub(super) fn bytes(&self) -> usize {
        self.layers.iter().flatten().map(|level| level.cells.len() * size_of::<Range>()).sum()
    }
}

fn levels(texels: &[f32], side: usize) -> Vec<Level> {
    let mut level = Level {
        side: side.div_ceil(TILE),
        cell: TILE as i64,
        cells: joined(side, TILE, |index| [texels[index]; 2]),
    };
    let mut levels = Vec::new();
    while level.side > 1 {
        let cells = joined(level.side, 2, |index| level.cells[index]);
        let next = Level { side: level.side.div_ceil(2), cell: 2 * level.cell, cells };
        levels.push(std::mem::replace(&mut level, next));
    }
    levels.push(level);
    levels
}

/// Joins squares of `by` × `by` cells of a square with this side.
fn joined(side: usize, by: usize, cell: impl Fn(usize) -> Range) -> Vec<Range> {
    let new = side.div_ceil(by);
    let mut cells = vec![EMPTY; new * new];
    for j in 0..side {
        for i in 0..side {
            let ([least, most], into) = (cell(j * side + i), &mut cells[j / by * new + i / by]);
            *into = [into[0].min(least), into[1].max(most)];
        }
    }
    cells
}
