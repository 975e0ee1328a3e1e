//! Filters: which texels a lookup reads, and how they weigh.

use std::fmt;

use super::bias::Reach;
use crate::random::r2;

/// A filter of compared texels (William Reeves, David Salesin and Robert Cook, *Rendering Antialiased Shadows
/// with Depth Maps*, SIGGRAPH 1987).
///
/// Box and tent weigh each texel by the part of the kernel that lies over it. A box of side 1 is the bilinear
/// filter. Poisson filters average bilinear lookups at points of a disk.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Filter {
    /// The texel that holds the lookup.
    Nearest,
    /// Four texels around the lookup.
    Bilinear,
    /// A box with a side of 3 texels.
    Box3,
    /// A box with a side of 5 texels.
    Box5,
    /// A tent with a side of 3 texels.
    Tent3,
    /// A tent with a side of 5 texels.
    Tent5,
    /// 16 bilinear lookups in a disk of radius 2 texels.
    Poisson16,
    /// 64 bilinear lookups in a disk of radius 2 texels.
    Poisson64,
}

/// Radius of the Poisson filters in texels: their bilinear taps reach as far as those of the 5 × 5 filters.
const DISK_TEXELS: f64 = 2.0;
/// Parts of a texel that have a shift of their own. A lookup's points depend on where it is on the map, so
/// that a value does not change with the camera.
const SHIFTS_PER_TEXEL: f64 = 8.0;

/// Lookups are moved to at most this far from the map's corner, in texels.
const FARTHEST: f64 = (1_u64 << 32) as f64;

impl Filter {
    /// All filters.
    pub const ALL: [Self; 8] = [
        Self::Nearest,
        Self::Bilinear,
        Self::Box3,
        Self::Box5,
        Self::Tent3,
        Self::Tent5,
        Self::Poisson16,
        Self::Poisson64,
    ];

    /// Name on the command line.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Nearest => "nearest",
            Self::Bilinear => "bilinear",
            Self::Box3 => "box3",
            Self::Box5 => "box5",
            Self::Tent3 => "tent3",
            Self::Tent5 => "tent5",
            Self::Poisson16 => "poisson16",
            Self::Poisson64 => "poisson64",
        }
    }

    /// How far from the lookup the centers of its texels lie.
    #[must_use]
    pub fn reach(self) -> Reach {
        match self {
            Self::Nearest => Reach::Square(0.5),
            Self::Bilinear => Reach::Square(1.0),
            Self::Box3 | Self::Tent3 => Reach::Square(2.0),
            Self::Box5 | Self::Tent5 => Reach::Square(3.0),
            Self::Poisson16 | Self::Poisson64 => Reach::Disk(DISK_TEXELS),
        }
    }

    /// Most texels read per lookup.
    #[must_use]
    pub fn reads(self) -> u32 {
        match self {
            Self::Nearest => 1,
            Self::Bilinear => 4,
            Self::Box3 | Self::Tent3 => 16,
            Self::Box5 | Self::Tent5 => 36,
            Self::Poisson16 => 4 * 16,
            Self::Poisson64 => 4 * 64,
        }
    }

    /// Calls `visit` with column, row and weight of each texel of a lookup. Weights are above 0; they add up
    /// to 1 but for rounding.
    pub fn for_each_texel(self, tx: f64, ty: f64, mut visit: impl FnMut(i64, i64, f64)) {
        // What lies farther outside is outside here too, and rows have numbers.
        let [tx, ty] = [tx, ty].map(|t| t.clamp(-FARTHEST, FARTHEST));
        let points = match self {
            Self::Nearest => return visit(tx.floor() as i64, ty.floor() as i64, 1.0),
            Self::Bilinear => return product(tx, ty, |x| part_of_box(x, 1.0), 1.0, visit),
            Self::Box3 => return product(tx, ty, |x| part_of_box(x, 3.0), 3.0, visit),
            Self::Box5 => return product(tx, ty, |x| part_of_box(x, 5.0), 5.0, visit),
            Self::Tent3 => return product(tx, ty, |x| part_of_tent(x, 3.0), 3.0, visit),
            Self::Tent5 => return product(tx, ty, |x| part_of_tent(x, 5.0), 5.0, visit),
            Self::Poisson16 => 16,
            Self::Poisson64 => 64,
        };
        let weight = 1.0 / f64::from(points);
        for_each_disk_point(points, shift(tx, ty), |x, y| {
            let (tx, ty) = (tx + DISK_TEXELS * x, ty + DISK_TEXELS * y);
            product(tx, ty, |x| part_of_box(x, 1.0), 1.0, |i, j, part| visit(i, j, weight * part));
        });
    }
}

impl fmt::Display for Filter {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// The part of a box of side 1 around 0, scaled to `side`, to the left of `x`.
fn part_of_box(x: f64, side: f64) -> f64 {
    (x / side + 0.5).clamp(0.0, 1.0)
}

/// The same of a tent.
fn part_of_tent(x: f64, side: f64) -> f64 {
    let x = (2.0 * x / side).clamp(-1.0, 1.0);
    0.5 + x - 0.5 * x * x.abs()
}

/// A kernel that is a product of two equal ones; `part` is the part of one to the left of a coordinate.
fn product(tx: f64, ty: f64, part: impl Fn(f64) -> f64, side: f64, mut visit: impl FnMut(i64, i64, f64)) {
    let count = side as usize + 1;
    let axis = |t: f64| {
        let first = (t - 0.5 * side).floor();
        let mut weights = [0.0; 6];
        for (k, weight) in weights.iter_mut().enumerate().take(count) {
            let low = first + k as f64 - t;
            *weight = part(low + 1.0) - part(low);
        }
        (first as i64, weights)
    };
    let ((left, columns), (top, rows)) = (axis(tx), axis(ty));
    for (j, row) in (top..).zip(&rows[..count]) {
        for (i, column) in (left..).zip(&columns[..count]) {
            if row * column > 0.0 {
                visit(i, j, row * column);
            }
        }
    }
}

/// The first points of an even sequence in a disk of radius 1, shifted on the torus (Cranley and Patterson,
/// *Randomization of Number Theoretic Methods for Multiple Integration*, 1976).
fn for_each_disk_point(count: u32, shift: [f64; 2], mut visit: impl FnMut(f64, f64)) {
    let mut left = count;
    // The disk takes up π/4 of the square, and the sequence is even: two points for each suffice.
    for k in 0..2 * count {
        let even = r2(k);
        let [x, y] = [0, 1].map(|axis| 2.0 * (shift[axis] + even[axis]).fract() - 1.0);
        if left > 0 && x * x + y * y <= 1.0 {
            visit(x, y);
            left -= 1;
        }
    }
}

/// Interleaved gradient noise (Jorge Jimenez, *Next Generation Post Processing in Call of Duty: Advanced
/// Warfare*, SIGGRAPH 2014).
pub(in crate::shadow) fn shift(tx: f64, ty: f64) -> [f64; 2] {
    let [x, y] = [tx, ty].map(|t| (SHIFTS_PER_TEXEL * t).floor());
    let noise = |x: f64, y: f64| {
        (52.982_918_9 * (0.067_110_56 * x + 0.005_837_15 * y).rem_euclid(1.0)).rem_euclid(1.0)
    };
    [noise(x, y), noise(y, x)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::SplitMix64;

    #[test]
    fn filter_weights_add_up_to_one_within_the_reach_and_are_centered() {
        let mut random = SplitMix64(3);
        for filter in Filter::ALL {
            let mut most_reads = 0;
            for turn in 0..300 {
                // Lookups at centers and at corners too.
                let [tx, ty] = match turn {
                    0 => [8.0, 8.0],
                    1 => [8.5, 8.5],
                    _ => [8.0 + random.unit(), -3.0 + random.unit()],
                };
                let (mut sum, mut reads, mut mean) = (0.0, 0, [0.0; 2]);
                filter.for_each_texel(tx, ty, |i, j, weight| {
                    let away = [i as f64 + 0.5 - tx, j as f64 + 0.5 - ty];
                    assert!(weight > 0.0);
                    sum += weight;
                    reads += 1;
                    mean = [mean[0] + weight * away[0], mean[1] + weight * away[1]];
                    match filter.reach() {
                        Reach::Square(reach) => assert!(away.iter().all(|x| x.abs() <= reach), "{filter}"),
                        Reach::Disk(radius) => {
                            let beyond = away.map(|x| (x.abs() - 1.0).max(0.0));
                            assert!(beyond[0].hypot(beyond[1]) <= radius + 1e-12, "{filter}");
                        }
                    }
                });
                assert!((sum - 1.0).abs() < 1e-12 && reads <= filter.reads(), "{filter} {sum}");
                most_reads = most_reads.max(reads);
                // Box filters are exact for what is affine. Nearest is off by half a texel, tents by less.
                let error = mean[0].abs().max(mean[1].abs());
                let exact = matches!(filter, Filter::Bilinear | Filter::Box3 | Filter::Box5);
                assert!(error < if exact { 1e-12 } else { 0.51 }, "{filter} {mean:?}");
            }
            assert_eq!(most_reads, filter.reads(), "{filter}");
        }
    }

    #[test]
    fn filter_of_an_edge_is_the_part_of_the_kernel_on_its_lit_side() {
        // Lit columns: those from 4 on.
        let value = |filter: Filter, tx: f64| {
            let mut lit = 0.0;
            filter.for_each_texel(tx, 0.3, |i, _, weight| lit += if i >= 4 { weight } else { 0.0 });
            lit
        };
        for (filter, tx, expected) in [
            (Filter::Nearest, 3.9, 0.0),
            (Filter::Nearest, 4.0, 1.0),
            (Filter::Bilinear, 3.75, 0.25),
            (Filter::Box3, 4.5, 2.0 / 3.0),
            (Filter::Box5, 2.0, 0.1),
            (Filter::Tent3, 4.0, 0.5),
            (Filter::Tent3, 4.75, 0.875),
            (Filter::Tent5, 2.75, 0.125),
        ] {
            assert!((value(filter, tx) - expected).abs() < 1e-12, "{filter} {tx}: {}", value(filter, tx));
        }
        // A disk's part on one side of a line, to within what its points resolve.
        for filter in [Filter::Poisson16, Filter::Poisson64] {
            assert!((value(filter, 4.0) - 0.5).abs() < 0.1 && value(filter, 7.1) > 1.0 - 1e-12);
        }
    }
}
