//! Polygons, cut by planes.

use super::interval::Number;

/// Cuts a convex polygon to where an affine function of its corners is not negative (Ivan Sutherland and Gary
/// Hodgman, *Reentrant Polygon Clipping*, 1974). A corner whose sign is not certain stays, and both its edges
/// are cut: the corners that are left span all that is left in truth.
pub(super) fn clip<T: Number, const N: usize>(polygon: &mut Vec<[T; N]>, side: impl Fn(&[T; N]) -> T) {
    if polygon.iter().all(|corner| side(corner).is_not_negative()) {
        return;
    }
    let mut kept = Vec::with_capacity(polygon.len() + 1);
    let mut from = polygon[polygon.len() - 1]; // not empty, or nothing is to be cut
    for &to in polygon.iter() {
        let (before, after) = (side(&from), side(&to));
        let ends = [before, after];
        if !ends.iter().all(|end| end.is_negative()) && !ends.iter().all(|end| end.is_not_negative()) {
            let share = before.share_of(before - after);
            kept.push(std::array::from_fn(|i| from[i] + (to[i] - from[i]) * share));
        }
        if !after.is_negative() {
            kept.push(to);
        }
        from = to;
    }
    *polygon = kept;
}

#[cfg(test)]
mod tests {
    use super::super::interval::Interval;
    use super::*;

    #[test]
    fn polygon_is_cut_where_the_function_is_zero() {
        let square = || vec![[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0]];
        let mut half = square();
        clip(&mut half, |&[x, _]| 1.0 - x);
        assert_eq!(half, [[0.0, 0.0], [1.0, 0.0], [1.0, 4.0], [0.0, 4.0]]);
        let mut none = square();
        clip(&mut none, |&[x, _]| -1.0 - x);
        assert!(none.is_empty());
        clip(&mut none, |&[x, _]| x);
        assert!(none.is_empty());
        let mut all = square();
        clip(&mut all, |&[x, _]| x);
        assert_eq!(all, square());
    }

    #[test]
    fn polygon_of_intervals_keeps_what_is_not_certain() {
        let wide = |x: f64| Interval { low: x - 0.5, high: x + 0.5 };
        let corners = [[0.0, 0.0], [4.0, 0.0], [0.0, 4.0]];
        let mut polygon: Vec<[Interval; 2]> = corners.map(|corner| corner.map(wide)).to_vec();
        clip(&mut polygon, |&[x, _]| x - Interval::of(0.25));
        assert!(corners.iter().all(|corner| polygon.contains(&corner.map(wide))), "0 may be 0.5");
        clip(&mut polygon, |&[x, _]| x - Interval::of(2.0));
        let least = polygon.iter().fold(f64::INFINITY, |least, [x, _]| least.min(x.low));
        assert!(polygon.len() >= 3 && least <= 2.0, "{polygon:?}");
    }
}
