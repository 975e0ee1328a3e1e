//! The size of a hole: length, area, distance from its plane.

use crate::repair::Patch;

/// The hole with these corners; nothing is known of its patch.
pub(super) fn of(points: &[[f32; 3]]) -> Patch {
    let points: Vec<[f64; 3]> = points.iter().map(|p| p.map(f64::from)).collect();
    let n = points.len();
    let next = |i: usize| points[(i + 1) % n];
    let length = (0..n).map(|i| norm(minus(next(i), points[i]))).sum();
    let mean: [f64; 3] = std::array::from_fn(|axis| points.iter().map(|p| p[axis]).sum::<f64>() / n as f64);
    let normal = (0..n).fold([0.0; 3], |sum, i| {
        let turned = cross(minus(points[i], mean), minus(next(i), mean));
        std::array::from_fn(|axis| sum[axis] + turned[axis])
    });
    let size = norm(normal);
    let height = |p: &[f64; 3]| dot(minus(*p, mean), normal).abs();
    let highest = points.iter().map(height).fold(0.0, f64::max);
    // Without a normal every plane through the mean is as good.
    let off_plane = if size > 0.0 { highest / size } else { 0.0 };
    Patch { edges: n, length, area: None, off_plane, meets: None, left: None }
}

/// The area of some triangles.
pub(super) fn area(triangles: impl Iterator<Item = [[f32; 3]; 3]>) -> f64 {
    triangles.map(triangle_area).sum()
}

#[inline]
pub(super) fn triangle_area([a, b, c]: [[f32; 3]; 3]) -> f64 {
    let [a, b, c] = [a, b, c].map(|p| [f64::from(p[0]), f64::from(p[1]), f64::from(p[2])]);
    0.5 * norm(cross(minus(b, a), minus(c, a)))
}

/// The distance of two points.
#[inline]
pub(super) fn distance(p: [f32; 3], q: [f32; 3]) -> f64 {
    norm(minus(p.map(f64::from), q.map(f64::from)))
}

#[inline]
fn minus(p: [f64; 3], q: [f64; 3]) -> [f64; 3] {
    [p[0] - q[0], p[1] - q[1], p[2] - q[2]]
}

#[inline]
fn cross(u: [f64; 3], v: [f64; 3]) -> [f64; 3] {
    [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]
}

#[inline]
fn dot(u: [f64; 3], v: [f64; 3]) -> f64 {
    u[0] * v[0] + u[1] * v[1] + u[2] * v[2]
}

#[inline]
fn norm(v: [f64; 3]) -> f64 {
    dot(v, v).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shape_of_a_rectangle_and_of_a_raised_corner() {
        let flat = [[0.0, 0.0, 1.0], [3.0, 0.0, 1.0], [3.0, 4.0, 1.0], [0.0, 4.0, 1.0]];
        let shape = of(&flat);
        assert_eq!((shape.edges, shape.length, shape.off_plane), (4, 14.0, 0.0));
        assert_eq!(area([[flat[0], flat[1], flat[2]], [flat[0], flat[2], flat[3]]].into_iter()), 12.0);
        // Two opposite corners up and two down: the plane stays level.
        let saddle = [0, 1, 2, 3].map(|i| [flat[i][0], flat[i][1], if i % 2 == 0 { 1.5 } else { 0.5 }]);
        assert_eq!(of(&saddle).off_plane, 0.5);
    }
}
