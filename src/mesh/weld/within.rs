//! Vertices that lie within a distance of each other become one.

use hashbrown::{HashMap, HashSet};

use super::{Merged, Used};

/// Kept vertices lie more than `distance` apart (in some frame), so a cell of that size holds few of them and
/// those in reach lie in the 27 cells around.
pub(super) fn merged(frames: &[&[[f32; 3]]], used: &Used, distance: f64) -> Merged {
    let near = |a: u32, b: u32| {
        frames.iter().all(|frame| {
            let square =
                |i: usize| (f64::from(frame[a as usize][i]) - f64::from(frame[b as usize][i])).powi(2);
            square(0) + square(1) + square(2) <= distance * distance
        })
    };
    // Cell numbers stay f64: where they pass 2^53 the f32 grid itself is coarser than the cells.
    let cell_in =
        |frame: &[[f32; 3]], vertex: usize| frame[vertex].map(|x| (f64::from(x) / distance).floor());
    // By any one frame, as those in reach are so in all; where vertices lie in one place in some frame, another
    // parts them. The first of those that part them best.
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
    // Beyond 2^53 adding one changes nothing, and a cell must not be visited twice.
    let axis = |x: f64| [Some(x), Some(x - 1.0).filter(|y| *y != x), Some(x + 1.0).filter(|y| *y != x)];
    for x in axis(home[0]).into_iter().flatten() {
        for y in axis(home[1]).into_iter().flatten() {
            for z in axis(home[2]).into_iter().flatten() {
                visit([x, y, z].map(cell_bits));
            }
        }
    }
}
