//! The surface of a lamp as a point sees it: a parallelogram or a disk, and light points on it.

use glam::DVec3;

use super::{Lamp, LampShape};
use crate::geom::Light;

/// The surface of a lamp, seen from one point: `center + x·across + y·along` with x and y from −1 to 1, or
/// with x² + y² ≤ 1 for a disk.
///
/// Of a directional lamp these are directions towards the light, on the plane at distance 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Patch {
    pub(crate) center: DVec3,
    pub(crate) across: DVec3,
    pub(crate) along: DVec3,
    pub(crate) is_round: bool,
    pub(crate) is_directional: bool,
}

impl Lamp {
    /// The lamp's surface, seen from `p`; `None` for a lamp without extent. The disk of a sphere faces `p`.
    pub(crate) fn patch(&self, p: [f32; 3]) -> Option<Patch> {
        let wide = |v: [f32; 3]| DVec3::from(v.map(f64::from));
        let disk = |center: DVec3, axis: DVec3, radius: f64, is_directional| {
            let (across, along) = axis.any_orthonormal_pair();
            let [across, along] = [across, along].map(|axis| axis * radius);
            Patch { center, across, along, is_round: true, is_directional }
        };
        Some(match &self.shape {
            LampShape::Hard(_) => return None,
            LampShape::Disk { center, radius } => {
                let center = wide(center.xyz());
                // A point at the center sees the disk from any side: there is no right one.
                let axis = (wide(p) - center).try_normalize().unwrap_or(DVec3::Z);
                disk(center, axis, f64::from(*radius), false)
            }
            LampShape::Sun { center, half_angle_rad } => {
                // The square of any f32 but 0 is a normal f64.
                let axis = wide(center.xyz()).normalize();
                // Half the sky has no disk at distance 1: the largest angle below it stands for it.
                let angle = half_angle_rad.min(std::f32::consts::FRAC_PI_2.next_down());
                disk(axis, axis, f64::from(angle).tan(), true)
            }
            LampShape::Rectangle(rectangle) => {
                let [a, b] = rectangle.edges().map(|edge| 0.5 * wide(edge));
                let center = wide(rectangle.corner()) + a + b;
                Patch { center, across: a, along: b, is_round: false, is_directional: false }
            }
        })
    }
}

impl Patch {
    /// The light of a point of the surface, rounded to `f32`. `u` and `v`, from 0 to 1, are mapped to the
    /// surface so that areas keep their ratios.
    pub(crate) fn light(&self, [u, v]: [f64; 2]) -> Light {
        let [x, y] = [u, v].map(|t| 2.0 * t - 1.0);
        let [x, y] = if self.is_round { concentric(x, y) } else { [x, y] };
        let at = self.center + self.across * x + self.along * y;
        let largest = f64::from(f32::MAX);
        let at = at.clamp(DVec3::splat(-largest), DVec3::splat(largest));
        let light = match self.is_directional {
            true => Light::directional((-at).as_vec3().to_array()),
            false => Light::point(at.as_vec3().to_array()),
        };
        light.expect("finite, and no direction of a disk at distance 1 is zero")
    }
}

/// A point of the square from −1 to 1, mapped to the unit disk: each square around the origin becomes a
/// circle (Shirley and Chiu, *A Low Distortion Map Between Disk and Square*, 1997).
pub(crate) fn concentric(x: f64, y: f64) -> [f64; 2] {
    use std::f64::consts::FRAC_PI_4;
    let (radius, angle) = match x.abs() > y.abs() {
        true => (x, FRAC_PI_4 * (y / x)),
        false if y == 0.0 => return [0.0, 0.0],
        false => (y, 2.0 * FRAC_PI_4 - FRAC_PI_4 * (x / y)),
    };
    let (sin, cos) = angle.sin_cos();
    [radius * cos, radius * sin]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::r2;

    fn points(lamp: &str, from: [f32; 3], n: u32) -> Vec<DVec3> {
        let patch = lamp.parse::<Lamp>().unwrap().patch(from).unwrap();
        (0..n).map(|i| DVec3::from(patch.light(r2(i)).xyz().map(f64::from))).collect()
    }

    #[test]
    fn patch_points_lie_on_the_lamp_and_average_to_its_center() {
        let n = 4096;
        let mean = |points: &[DVec3]| points.iter().sum::<DVec3>() / f64::from(n);
        // The mean of r² over a disk of radius R is R²/2; a map that is not area-preserving has another.
        let spread = |points: &[DVec3], center: DVec3| {
            points.iter().map(|p| p.distance_squared(center)).sum::<f64>() / f64::from(n)
        };
        let disk = points("point:1,2,3,radius=0.5", [1.0, -7.0, 3.0], n);
        let center = DVec3::new(1.0, 2.0, 3.0);
        assert!(disk.iter().all(|p| (p.y - 2.0).abs() < 1e-6 && p.distance(center) < 0.500_001));
        assert!(mean(&disk).distance(center) < 1e-3 && (spread(&disk, center) - 0.125).abs() < 1e-3);

        let rectangle = points("rect:0,5,0:2,0,0:0,0,4", [0.0; 3], n);
        assert!(rectangle.iter().all(|p| p.y == 5.0 && (0.0..=2.0).contains(&p.x)));
        assert!(mean(&rectangle).distance(DVec3::new(1.0, 5.0, 2.0)) < 2e-3);

        // Towards a sun that travels down: up, and at most the angle away.
        let sun = points("directional:0,-3,0,angle=30", [9.0; 3], n);
        let tan = 30_f64.to_radians().tan();
        assert!(sun.iter().all(|p| p.y == 1.0 && p.x.hypot(p.z) < tan * 1.000_001));
        assert!((spread(&sun, DVec3::Y) - tan * tan / 2.0).abs() < 1e-3);
    }

    #[test]
    fn patch_of_extreme_lamps_is_finite_and_of_hard_ones_is_none() {
        for lamp in ["point:3e38,0,0,radius=3e38", "directional:0,-1,0,angle=90", "point:0,0,0,radius=1e-45"]
        {
            for from in [[0.0; 3], [-3e38; 3]] {
                assert!(points(lamp, from, 9).iter().all(|p| p.is_finite()), "{lamp}");
            }
        }
        assert_eq!("point:1,2,3".parse::<Lamp>().unwrap().patch([0.0; 3]), None);
    }

    #[test]
    fn concentric_map_of_a_square_reaches_the_rim_and_the_center() {
        assert_eq!(concentric(0.0, 0.0), [0.0, 0.0]);
        for [x, y] in [[1.0, 0.0], [-1.0, 0.5], [0.3, 1.0], [1.0, -1.0], [-0.7, -1.0]] {
            let [a, b] = concentric(x, y);
            assert!((a.hypot(b) - 1.0).abs() < 1e-15, "{x} {y}");
            assert!(a * x >= 0.0 && b * y >= 0.0, "the same quadrant");
        }
    }
}
