//! The part of a lamp's surface that lies above the plane of a face.

use std::f64::consts::PI;

use glam::DVec3;

use super::patch::Patch;

impl Patch {
    /// The share of the surface on the side of a plane through `p` that its normal points to, from 0 to 1.
    ///
    /// Height over the plane is linear on the surface: `h + x·a + y·b` in the surface's own x and y. So the
    /// plane cuts a segment off the disk, or a corner off the square.
    pub(crate) fn share_above(&self, p: DVec3, normal: DVec3) -> f64 {
        let toward = if self.is_directional { self.center } else { self.center - p };
        let h = normal.dot(toward);
        let (a, b) = (normal.dot(self.across).abs(), normal.dot(self.along).abs());
        let below = |h: f64| if self.is_round { disk_below(h / a.hypot(b)) } else { square_below(h, a, b) };
        // The center itself lies above the plane or below it, and the smaller part is found without loss.
        if h >= 0.0 { 1.0 - below(h) } else { below(-h) }
    }
}

/// The share of a disk beyond a chord at a distance of its center, in radii, from 0 on.
fn disk_below(distance: f64) -> f64 {
    // A surface parallel to the plane has no chord, and one within it neither: infinite, or 0/0.
    if distance.is_nan() || distance >= 1.0 {
        return 0.0;
    }
    (distance.acos() - distance * (1.0 - distance * distance).sqrt()) / PI
}

/// The share of the square from −1 to 1 where h + a·x + b·y is below 0; none of the three is negative.
fn square_below(h: f64, a: f64, b: f64) -> f64 {
    let (long, short) = (a.max(b), a.min(b));
    // How deep the lowest corner lies.
    let depth = long + short - h;
    if depth.is_nan() || depth <= 0.0 {
        return 0.0;
    }
    match depth < 2.0 * short {
        // A triangle with the sides depth/a and depth/b, of the square's area 4.
        true => depth / long * (depth / short) / 8.0,
        // A trapezoid: as wide as the square, as long as in its middle.
        false => (depth - short) / long / 2.0,
    }
}

#[cfg(test)]
mod tests {
    use super::super::Lamp;
    use super::*;

    /// The share of points of the surface above the plane.
    fn counted(patch: &Patch, p: DVec3, normal: DVec3) -> f64 {
        let n = 400;
        let cell = |i: i32| (f64::from(i) + 0.5) * 2.0 / f64::from(n) - 1.0;
        let (mut above, mut all) = (0, 0);
        for (x, y) in (0..n * n).map(|k| (cell(k % n), cell(k / n))) {
            if !patch.is_round || x * x + y * y <= 1.0 {
                let at = patch.center + patch.across * x + patch.along * y;
                let toward = if patch.is_directional { at } else { at - p };
                above += u32::from(normal.dot(toward) > 0.0);
                all += 1;
            }
        }
        f64::from(above) / f64::from(all)
    }

    #[test]
    fn horizon_share_is_that_of_many_points() {
        let mut partly = 0;
        for lamp in ["rect:-1,-1,4:2,0,1:0,3,0", "point:1,2,3,radius=2", "directional:1,0.5,-1,angle=40"] {
            let lamp: Lamp = lamp.parse().unwrap();
            for k in 0..200 {
                let [x, y, z] = [0, 1, 2].map(|axis| ((k * 37 + axis * 61) % 101) as f32 / 50.0 - 1.0);
                let p = [x * 0.5, z, 0.5 * y];
                let normal = DVec3::new(f64::from(x), f64::from(y), f64::from(z) * 0.3).normalize();
                let (patch, p) = (lamp.patch(p).unwrap(), DVec3::from(p.map(f64::from)));
                let (share, counted) = (patch.share_above(p, normal), counted(&patch, p, normal));
                partly += u32::from(share > 0.0 && share < 1.0);
                // A line through 400 × 400 points passes by at most 2 · 400 of them.
                assert!((share - counted).abs() < 5e-3, "{lamp:?} {k}: {share}, {counted}");
                // Fault injected: the other side.
                let other = patch.share_above(p, -normal);
                assert!(
                    (share + other - 1.0).abs() < 1e-12
                        && ((share - other).abs() < 1e-2 || (other - counted).abs() > 5e-3)
                );
            }
        }
        assert!(partly > 100, "{partly}");
    }

    #[test]
    fn horizon_through_the_middle_halves_and_a_parallel_one_does_not_cut() {
        for lamp in ["rect:-1,-1,4:2,0,0:0,2,0", "point:0,0,4,radius=1"] {
            let patch = lamp.parse::<Lamp>().unwrap().patch([0.0; 3]).unwrap();
            assert_eq!(patch.share_above(DVec3::ZERO, DVec3::Z), 1.0);
            assert_eq!(patch.share_above(DVec3::ZERO, -DVec3::Z), 0.0);
            assert!((patch.share_above(DVec3::ZERO, DVec3::X) - 0.5).abs() < f64::EPSILON);
        }
    }
}
