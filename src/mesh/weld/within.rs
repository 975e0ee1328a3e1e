//! Welding within a distance, by a hash grid.

use hashbrown::{HashMap, HashSet};

use super::{Merged, Used};

/// Merges vertices by the rule of [`Weld::Within`](super::Weld::Within). Kept vertices are more than
/// `distance` apart in some frame. A grid cell of that size therefore holds few of them, and all candidates
/// lie in the 27 cells around a vertex.
pub(super) fn merged(frames: &[&[[f32; 3]]], used: &Used, distance: f64) -> Merged {
    let near = |a: u32, b: u32| {
        frames.iter().all(|frame| {
            let square =
                |i: usize| (f64::from(frame[a as usize][i]) - f64::from(frame[b as usize][i])).powi(2);
            square(0) + square(1) + square(2) <= distance * distance
        })
    };
    // Cell numbers stay f64: beyond 2^53 the f32 grid itself is coarser than the cells.
    let cell_in =
        |frame: &[[f32; 3]], vertex: usize| frame[vertex].map(|x| (f64::from(x) / distance).floor());
    // The grid uses one frame, since vertices within the distance in all frames are so in any of them.
    // Vertices that coincide in one frame may be far apart in another, so the first frame with the most
    // occupied cells is taken.
    let spread = |frame: &[[f32; 3]]| {
        used.iter().map(|vertex| cell_in(frame, vertex as usize).map(cell_bits)).collect::<HashSet<_>>().len()
    };
    let key = match frames {
        [only] => only,
        _ => frames.iter().rev().max_by_key(|frame| spread(frame)).expect("the positions are there"),
    };
    let cell = |vertex: u32| cell_in(key, vertex as usize);
    let mut cells: HashMap<[u64; 3], Vec<(u32, u32)>> = HashMap::new();
    Merged::by(used, |vertex, new| {
        let home = cell(vertex);
        let mut found: Option<u32> = None;
        for_each_neighbor(home, |key| {
            let Some(residents) = cells.get(&key) else { return };
            for &(other, welded) in residents {
                if found.is_none_or(|best| welded < best) && near(vertex, other) {
                    found = Some(welded);
                }
            }
        });
        if found.is_none() {
            cells.entry(home.map(cell_bits)).or_default().push((vertex, new));
        }
        found
    })
}

fn cell_bits(cell: f64) -> u64 {
    (cell + 0.0).to_bits()
}

fn for_each_neighbor(home: [f64; 3], mut visit: impl FnMut([u64; 3])) {
    // Beyond 2^53 adding one changes nothing, and no cell may be visited twice.
    let axis = |x: f64| [Some(x), Some(x - 1.0).filter(|y| *y != x), Some(x + 1.0).filter(|y| *y != x)];
    for x in axis(home[0]).into_iter().flatten() {
        for y in axis(home[1]).into_iter().flatten() {
            for z in axis(home[2]).into_iter().flatten() {
                visit([x, y, z].map(cell_bits));
            }
        }
    }
}
