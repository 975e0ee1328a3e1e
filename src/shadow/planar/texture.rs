//! A texture of what flattened faces cover.

use super::boxes::Rect;
use super::matrix::Corner;
use super::polygon::clip;

/// A square texture over a rectangle of the plane. Each texel holds the greatest rise of the faces that cover
/// its center.
///
/// The *rise* is the height over the plane by the divisor: `h/(P·L − h)` for a light at a position, and
/// `h/(P·L)` for a directional one. It is affine on a flattened face, and a light that moves by e moves the
/// shadow by −e times the rise.
#[derive(Clone, Debug)]
pub(super) struct Texture {
    window: Rect,
    side: usize,
    /// Below 0 where nothing covers the texel.
    rises: Vec<f32>,
}

impl Texture {
    /// Draws polygons; `None` if the texels do not fit the memory, or the window is empty.
    pub(super) fn draw(
        window: Rect,
        side: u32,
        polygons: impl Iterator<Item = Vec<Corner<f64>>>,
    ) -> Option<Self> {
        let side = side as usize;
        let count = side * side;
        let mut rises = Vec::new();
        let is_sound = (0..2).all(|i| {
            let size = window.high[i] - window.low[i];
            size > 0.0 && size.is_finite()
        });
        if !is_sound || rises.try_reserve_exact(count).is_err() {
            return None;
        }
        rises.resize(count, -1.0);
        let mut texture = Self { window, side, rises };
        for polygon in polygons {
            texture.add(polygon);
        }
        Some(texture)
    }

    /// Draws one polygon. Cut to the window before the division, nothing is divided by zero.
    fn add(&mut self, mut polygon: Vec<Corner<f64>>) {
        let Rect { low, high } = self.window;
        for axis in 0..2 {
            clip(&mut polygon, |corner| corner[axis] - corner[2] * low[axis]);
            clip(&mut polygon, |corner| corner[2] * high[axis] - corner[axis]);
        }
        polygon.retain(|corner| corner[2] > 0.0);
        let corners: Vec<[f64; 3]> = polygon
            .iter()
            .map(|&[x, y, w, h]| {
                let [column, row] = self.texels([x / w, y / w]);
                [column, row, h / w]
            })
            .collect();
        let rows = corners.iter().map(|corner| corner[1]);
        let (first, last) = rows.fold((f64::INFINITY, 0.0), |(a, b), row| (row.min(a), row.max(b)));
        let mut row = center_from(first);
        while row < self.side && row as f64 + 0.5 < last {
            self.fill(&corners, row);
            row += 1;
        }
    }

    /// The texels of one row whose centers a convex polygon covers.
    fn fill(&mut self, corners: &[[f64; 3]], row: usize) {
        let y = row as f64 + 0.5;
        let mut ends = [[f64::INFINITY, 0.0], [f64::NEG_INFINITY, 0.0]];
        for (index, &a) in corners.iter().enumerate() {
            let b = corners[(index + 1) % corners.len()];
            if (a[1] <= y) == (b[1] <= y) {
                continue;
            }
            let share = (y - a[1]) / (b[1] - a[1]);
            let at = [a[0] + share * (b[0] - a[0]), a[2] + share * (b[2] - a[2])];
            if at[0] < ends[0][0] {
                ends[0] = at;
            }
            if at[0] > ends[1][0] {
                ends[1] = at;
            }
        }
        let [[left, low], [right, high]] = ends;
        let mut column = center_from(left);
        while column < self.side && (column as f64 + 0.5) < right {
            let share = (column as f64 + 0.5 - left) / (right - left);
            let rise = (low + share * (high - low)).max(0.0) as f32;
            let texel = &mut self.rises[row * self.side + column];
            *texel = texel.max(rise);
            column += 1;
        }
    }

    /// A point of the plane in texels.
    pub(super) fn texels(&self, at: [f64; 2]) -> [f64; 2] {
        let Rect { low, high } = self.window;
        [0, 1].map(|i| (at[i] - low[i]) / (high[i] - low[i]) * self.side as f64)
    }

    /// Lengths along the two axes of the plane in texels.
    pub(super) fn lengths(&self, lengths: [f64; 2]) -> [f64; 2] {
        let Rect { low, high } = self.window;
        [0, 1].map(|i| lengths[i] / (high[i] - low[i]) * self.side as f64)
    }

    /// The rise at a texel, given by its index; `None` where nothing covers it.
    pub(super) fn rise(&self, index: usize) -> Option<f64> {
        Some(self.rises[index]).filter(|rise| *rise >= 0.0).map(f64::from)
    }

    /// Number of texels.
    pub(super) fn len(&self) -> usize {
        self.rises.len()
    }

    /// The covered part around a position in texels, from the four nearest texels. Beyond the rim nothing is
    /// covered, or with `is_continued` what the rim is.
    pub(super) fn covered(&self, [x, y]: [f64; 2], is_continued: bool) -> f64 {
        let [i, j] = [x, y].map(|t| (t - 0.5).floor());
        let [u, v] = [x - 0.5 - i, y - 0.5 - j];
        let last = self.side as f64 - 1.0;
        let texel = |i: f64, j: f64| {
            let at = if is_continued { [i, j].map(|t| t.clamp(0.0, last)) } else { [i, j] };
            let is_inside = at.iter().all(|t| (0.0..=last).contains(t));
            let is_covered = is_inside && self.rises[at[1] as usize * self.side + at[0] as usize] >= 0.0;
            f64::from(u8::from(is_covered))
        };
        let row = |j: f64| (1.0 - u) * texel(i, j) + u * texel(i + 1.0, j);
        (1.0 - v) * row(j) + v * row(j + 1.0)
    }

    pub(super) fn bytes(&self) -> usize {
        size_of_val(&*self.rises)
    }
}

/// The first texel whose center is at or after a position.
fn center_from(position: f64) -> usize {
    // Negative numbers become 0, infinity the largest number.
    (position - 0.5).ceil() as usize
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::SplitMix64;

    const WINDOW: Rect = Rect { low: [-1.0, 0.0], high: [1.0, 4.0] };

    /// Against a loop over all texels and polygons, with divisors that reach zero.
    #[test]
    fn texture_holds_the_greatest_rise_over_each_center() {
        let mut random = SplitMix64(9);
        for side in [1, 7, 32] {
            let mut signed = |most: f64| most * (2.0 * random.unit() - 1.0);
            let polygons: Vec<Vec<Corner<f64>>> = (0..12)
                .map(|index| {
                    let plane = [signed(0.2), signed(0.2), 1.0 + signed(0.5)];
                    let corner = |_| {
                        let w = if index % 3 == 0 { signed(1.0).max(0.0) } else { 1.0 + signed(0.9) };
                        let [x, y] = [signed(1.5), 2.0 + signed(2.5)];
                        // Affine in the image: a rise as on a face.
                        [x * w, y * w, w, (plane[0] * x + plane[1] * y + plane[2]) * w]
                    };
                    (0..3).map(corner).collect()
                })
                .collect();
            let texture = Texture::draw(WINDOW, side, polygons.iter().cloned()).unwrap();
            let mut covered = 0;
            for index in 0..texture.len() {
                let [i, j] = [index % side as usize, index / side as usize]
                    .map(|k| (k as f64 + 0.5) / f64::from(side));
                let (x, y) = (2.0 * i - 1.0, 4.0 * j);
                let rises = polygons.iter().filter_map(|polygon| rise(polygon, [x, y]));
                let most = rises.reduce(f64::max).map(|rise| rise.max(0.0));
                let found = texture.rise(index);
                assert_eq!(found.is_some(), most.is_some(), "{side} {x} {y}");
                if let (Some(found), Some(most)) = (found, most) {
                    assert!((found - most).abs() < 1e-6, "{found} {most}");
                    covered += 1;
                }
            }
            assert!(side == 1 || covered > 10, "{covered}");
        }
        assert!(Texture::draw(Rect::EMPTY, 4, std::iter::empty()).is_none());
    }

    /// Solves for the point of a triangle whose image is (u, v).
    fn rise(triangle: &[Corner<f64>], [u, v]: [f64; 2]) -> Option<f64> {
        let at = |corner: &Corner<f64>| [corner[0] - u * corner[2], corner[1] - v * corner[2]];
        let [a, b, c] = [0, 1, 2].map(|i| at(&triangle[i]));
        let cross = |a: [f64; 2], b: [f64; 2]| a[0] * b[1] - a[1] * b[0];
        let shares = [cross(b, c), cross(c, a), cross(a, b)];
        let sum: f64 = shares.iter().sum();
        let is_inside = shares.iter().all(|share| share / sum >= 0.0);
        let mixed = |k: usize| (0..3).map(|i| shares[i] / sum * triangle[i][k]).sum::<f64>();
        (is_inside && mixed(2) > 0.0).then(|| mixed(3) / mixed(2))
    }

    #[test]
    fn texture_is_read_with_a_border_of_light() {
        let all =
            vec![[-1.0, 0.0, 1.0, 0.5], [1.0, 0.0, 1.0, 0.5], [1.0, 4.0, 1.0, 0.5], [-1.0, 4.0, 1.0, 0.5]];
        let texture = Texture::draw(WINDOW, 4, std::iter::once(all)).unwrap();
        assert_eq!(texture.covered([2.0, 2.3], false), 1.0);
        assert_eq!(texture.covered([0.0, 2.0], false), 0.5);
        assert_eq!(texture.covered([0.0, 2.0], true), 1.0);
        assert_eq!(texture.covered([-7.0, 2.0], false), 0.0);
        assert_eq!((texture.texels([0.0, 1.0]), texture.lengths([1.0, 1.0])), ([2.0, 1.0], [2.0, 1.0]));
        assert_eq!(texture.bytes(), 64);
    }
}
