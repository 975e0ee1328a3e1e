//! Whether a sample lies at the boundary of a shadow.

use glam::DVec3;

use crate::geom::Light;
use crate::geom::predicate::side_of_point;
use crate::oracle::{Oracle, PrimaryHit, Verdict};

/// Radii of the rings around a sample that are searched for a shadow boundary, in texels.
const RINGS: [f64; 2] = [1.0, 2.0];
/// Directions searched per ring.
const DIRECTIONS: u32 = 16;

/// Whether the exact verdict changes within two texels of a sample, on the plane of the sample's face.
pub(super) fn changes_nearby(
    oracle: &Oracle,
    light: &Light,
    hit: &PrimaryHit,
    verdict: Verdict,
    texel: f64,
) -> bool {
    let [a, b, c] = hit.corners.map(|corner| DVec3::from(corner.map(f64::from)));
    let normal = (b - a).cross(c - a).normalize_or_zero();
    let across = normal.any_orthonormal_vector();
    let along = normal.cross(across);
    let point = DVec3::from(hit.point.map(f64::from));
    RINGS.iter().any(|ring| {
        (0..DIRECTIONS).any(|i| {
            let (sin, cos) = (f64::from(i) * std::f64::consts::TAU / f64::from(DIRECTIONS)).sin_cos();
            let beside = point + (across * cos + along * sin) * (ring * texel);
            lifted(hit, normal, beside).is_some_and(|beside| oracle.verdict(beside, light) != verdict)
        })
    })
}

/// A point near a sample, moved off the face's plane until the point lies strictly on the visible side. The
/// steps start at one unit in the last place and double, as for [`PrimaryHit::point`]. `None` if `f32` has no
/// such point.
fn lifted(hit: &PrimaryHit, normal: DVec3, beside: DVec3) -> Option<[f32; 3]> {
    let away = normal * f64::from(hit.side.value());
    let largest = beside.abs().max_element().min(f64::from(f32::MAX)) as f32;
    let mut step = f64::from(largest.next_up()) - f64::from(largest);
    for _ in 0..f32::MANTISSA_DIGITS {
        let at: [f32; 3] = (beside + away * step).as_vec3().into();
        if at.iter().all(|x| x.is_finite()) && side_of_point(hit.corners, at) == hit.side {
            return Some(at);
        }
        step *= 2.0;
    }
    None
}
