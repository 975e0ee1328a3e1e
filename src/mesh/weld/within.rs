//! Welding within a distance, by a hash grid.

use hashbrown::{HashMap, HashSet};

use super::{Merged, Used};

/// Merges vertices by the rule of [`Weld::Within`](super::Weld::Within). Kept vertices are more than
/// `distance` apart in some frame. A grid cell a few times as wide therefore holds few of them, and all
/// candidates lie in the cells that a box around a vertex overlaps: mostly one or two along an axis.
pub(super) fn merged(frames: &[&[[f32; 3]]], used: &Used, distance: f64) -> Merged {
    let near = |a: u32, b: u32| {
        frames.iter().all(|frame| {
            let square =
                |i: usize| (f64::from(frame[a as usize][i]) - f64::from(frame[b as usize][i])).powi(2);
            square(0) + square(1) + square(2) <= distance * distance
        })
    };
    let per_length = 1.0 / (WIDTH * distance);
    let cell_in = |frame: &[[f32; 3]], vertex: usize| frame[vertex].map(|x| cell(f64::from(x), per_length));
    // The grid uses one frame, since vertices within the distance in all frames are so in any of them.
    // Vertices that coincide in one frame may be far apart in another, so the first frame with the most
    // occupied cells is taken.
    let spread = |frame: &[[f32; 3]]| {
        used.iter()
            .map(|vertex| cell_in(frame, vertex as usize).map(cell_bits))
            .collect::<HashSet<[u64; 3]>>()
            .len()
    };
    let key = match frames {
        [only] => only,
        _ => frames.iter().rev().max_by_key(|frame| spread(frame)).expect("the positions are there"),
    };
    // More than the rounding of `near` lets in. Rounding keeps the order of a box's ends and its vertices.
    let reach = distance * (1.0 + 4.0 * f64::EPSILON);
    // The last kept vertex of each cell, and for each kept vertex the one before it in its cell.
    let mut cells: HashMap<(u64, u64, u64), u32> = HashMap::new();
    let mut kept: Vec<(u32, Option<u32>)> = Vec::new();
    Merged::by(used, |vertex, new| {
        let mut found: Option<u32> = None;
        for_each_cell(key[vertex as usize], reach, per_length, |key| {
            let mut next = cells.get(&key).copied();
            while let Some(welded) = next {
                let (other, before) = kept[welded as usize];
                if found.is_none_or(|best| welded < best) && near(vertex, other) {
                    found = Some(welded);
                }
                next = before;
            }
        });
        if found.is_none() {
            let before = cells.insert(bits(cell_in(key, vertex as usize)), new);
            kept.push((vertex, before));
        }
        found
    })
}

/// Side of a cell in distances: narrower cells are more to look up, wider ones hold more vertices.
const WIDTH: f64 = 3.0;

/// The number of the cell of a coordinate. The planes x = 0, y = 0 and z = 0, on which many vertices of
/// symmetric and of flat meshes lie, run through the middle of cells: between two cells, each vertex on them
/// would ask both.
#[inline(always)]
fn cell(x: f64, per_length: f64) -> f64 {
    (x * per_length + 0.5).floor()
}

fn cell_bits(cell: f64) -> u64 {
    (cell + 0.0).to_bits()
}

fn bits([x, y, z]: [f64; 3]) -> (u64, u64, u64) {
    (cell_bits(x), cell_bits(y), cell_bits(z))
}

/// Calls `visit` once with each cell that the box around a point overlaps.
#[inline(always)]
fn for_each_cell(at: [f32; 3], reach: f64, per_length: f64, mut visit: impl FnMut((u64, u64, u64))) {
    // A box is less wide than a cell. Cell numbers stay f64: where adding one changes nothing, the grid of
    // f32 itself is coarser than the cells, and both ends are the same or next to each other.
    let (mut low, mut high) = ([0.0; 3], [0.0; 3]);
    for i in 0..3 {
        let x = f64::from(at[i]);
        (low[i], high[i]) = (cell(x - reach, per_length), cell(x + reach, per_length));
    }
    // One bit an axis: whether its upper cell is meant.
    for corner in 0..8 {
        let is_upper = |i: usize| corner >> i & 1 == 1;
        if (0..3).all(|i| !is_upper(i) || low[i] != high[i]) {
            let end = |i: usize| if is_upper(i) { high[i] } else { low[i] };
            visit(bits([end(0), end(1), end(2)]));
        }
    }
}
