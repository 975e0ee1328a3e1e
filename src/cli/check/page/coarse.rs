//! A mesh with fewer triangles, for the view: vertices in one cell of a grid become one of them.
//!
//! (Rossignac and Borrel, *Multi-resolution 3D approximations for rendering complex scenes*, 1993.) Linear
//! for each grid that is tried.

use std::collections::{HashMap, HashSet};

/// Triangles to draw, of a mesh that may have more.
pub(super) struct Coarse {
    /// For each vertex of the mesh the one that stands for it.
    pub(super) stand_in: Vec<u32>,
    pub(super) triangles: Vec<[u32; 3]>,
    /// Cells along each side of the grid; `None` if the mesh is drawn as it is.
    pub(super) cells: Option<u32>,
}

/// Cells along each side of a grid, finest first.
const GRIDS: [u32; 14] = [512, 384, 256, 192, 128, 96, 64, 48, 32, 16, 8, 4, 2, 1];

impl Coarse {
    /// At most `most` triangles; `positions` are in [−1, 1] along each axis.
    pub(super) fn of(positions: &[[f32; 3]], triangles: &[[u32; 3]], most: usize) -> Self {
        if triangles.len() <= most {
            let stand_in = (0..positions.len() as u32).collect(); // indices are u32
            return Self { stand_in, triangles: triangles.to_vec(), cells: None };
        }
        for cells in GRIDS {
            let stand_in = stand_ins(positions, cells);
            let left = merged(triangles.iter(), &stand_in);
            if left.len() <= most {
                return Self { stand_in, triangles: left, cells: Some(cells) };
            }
        }
        unreachable!("one cell leaves no triangle")
    }
}

fn stand_ins(positions: &[[f32; 3]], cells: u32) -> Vec<u32> {
    let mut first = HashMap::new();
    let cell = |x: f32| ((x + 1.0) * 0.5 * cells as f32).clamp(0.0, (cells - 1) as f32) as u32;
    let of = |(vertex, position): (u32, &[f32; 3])| *first.entry(position.map(cell)).or_insert(vertex);
    (0..).zip(positions).map(of).collect()
}

/// The triangles that are left between stand-ins, each once, in their order.
pub(super) fn merged<'a>(triangles: impl Iterator<Item = &'a [u32; 3]>, stand_in: &[u32]) -> Vec<[u32; 3]> {
    let mut seen = HashSet::new();
    let moved = triangles.map(|corners| corners.map(|corner| stand_in[corner as usize]));
    let has_area = |&[a, b, c]: &[u32; 3]| a != b && b != c && c != a;
    let mut is_new = |corners: &[u32; 3]| {
        let mut sorted = *corners;
        sorted.sort_unstable();
        seen.insert(sorted)
    };
    moved.filter(has_area).filter(|corners| is_new(corners)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use umbrage::testing::shapes;

    #[test]
    fn coarse_mesh_keeps_within_the_limit_and_to_the_shape() {
        let ball = shapes::icosphere(5);
        let whole = Coarse::of(ball.positions(), ball.triangles(), 20_480);
        assert_eq!((whole.triangles.len(), whole.cells), (20_480, None));
        for most in [20_479, 5000, 100, 0] {
            let coarse = Coarse::of(ball.positions(), ball.triangles(), most);
            assert!(coarse.triangles.len() <= most, "{most}");
            let cells = f64::from(coarse.cells.unwrap());
            // No vertex moves farther than a cell is long.
            for (vertex, &stand_in) in coarse.stand_in.iter().enumerate() {
                let [a, b] = [vertex, stand_in as usize].map(|index| ball.positions()[index]);
                let moved = [0, 1, 2].map(|axis| f64::from(a[axis] - b[axis]).abs());
                assert!(moved.iter().all(|&x| x <= 2.0 / cells * 1.001), "{most}");
            }
        }
        // As many as the limit allows, within a grid: not nothing.
        assert!(Coarse::of(ball.positions(), ball.triangles(), 5000).triangles.len() > 1000);
    }
}
