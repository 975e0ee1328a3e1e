//! The frame of a planar polygon, and its outline in the frame's coordinates.

use super::frame::{EPSILON, Frame, Plane, wide};
use super::light::AreaLightError;

const ON_A_LINE: AreaLightError = AreaLightError::NoArea("its corners lie on one line");

/// The bounding rectangle in the polygon's plane, and the corners in its coordinates.
///
/// The plane goes through three corners: the first one, a; the corner b farthest from it; the corner c
/// farthest from the line ab. Every corner is a + s(b − a) + t(c − a) with |t| ≤ 1 and |s| ≤ 2. Corners that
/// were rounded to `f32` lie within √3·2⁻²⁴·M of a true plane, M the largest coordinate, so none lies farther
/// than (1 + |1 − s − t| + |s| + |t|)·√3·2⁻²⁴·M < 2⁻²⁰·M from that of a, b and c.
pub(super) fn planar(corners: &[[f32; 3]]) -> Result<(Frame, Vec<[f64; 2]>), AreaLightError> {
    let Some(&a) = corners.first() else { return Err(ON_A_LINE) };
    let from_a = |&x: &[f32; 3]| wide(x) - wide(a);
    let farthest = |size: &dyn Fn(&[f32; 3]) -> f64| {
        corners.iter().copied().max_by(|x, y| size(x).total_cmp(&size(y))).unwrap_or(a)
    };
    let b = farthest(&|x| from_a(x).length_squared());
    let e1 = from_a(&b);
    let c = farthest(&|x| e1.cross(from_a(x)).length_squared());
    let e2 = from_a(&c);
    if e1.cross(e2).length_squared() == 0.0 {
        return Err(ON_A_LINE);
    }
    // At a right angle to e1.
    let across = e2 - e1 * (e1.dot(e2) / e1.length_squared());
    let normal = e1.cross(e2).normalize();
    let largest = corners.iter().flatten().fold(0.0_f64, |most, &x| most.max(f64::from(x).abs()));
    let mut outline = Vec::with_capacity(corners.len());
    for (corner, x) in corners.iter().enumerate() {
        let x = from_a(x);
        let distance = normal.dot(x).abs();
        if distance > largest * 2f64.powi(-20) {
            return Err(AreaLightError::NotPlanar { corner, distance });
        }
        outline.push([x.dot(e1) / e1.length_squared(), x.dot(across) / across.length_squared()]);
    }
    let bounds = |axis: usize| {
        outline
            .iter()
            .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| [low.min(x[axis]), high.max(x[axis])])
    };
    let [u, v] = [bounds(0), bounds(1)];
    for x in &mut outline {
        *x = [(x[0] - u[0]) / (u[1] - u[0]), (x[1] - v[0]) / (v[1] - v[0])];
    }
    // A dozen roundings of numbers up to the polygon's length, seen against its width.
    let rounding = 32.0 * EPSILON * (e1.length() / across.length());
    let frame = Frame {
        anchor: a,
        offset: u[0] * e1 + v[0] * across,
        e1: (u[1] - u[0]) * e1,
        e2: (v[1] - v[0]) * across,
        plane: Plane::Through([a, b, c]),
        at_infinity: false,
        rounding,
    };
    Ok((frame, outline))
}
