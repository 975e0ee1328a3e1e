//! The exact hard shadow, blurred among the samples of the view: the technique `contact-blur`.
//!
//! (D. Odin, *Shadows*, 2016, calls it contact hardening.) The width is that of `pcss`; the mean is over
//! samples near the same plane that fall into the penumbra's window on the map. What errs: windows cut by the
//! rim of the picture or by what stands before it, and surfaces seen at a glancing angle.

use glam::DVec3;

use super::horizon::AboveHorizon;
use super::light_map::LightMap;
use super::{SoftMapOptions, Taps};
use crate::caster::CasterGroup;
use crate::oracle::{PrimaryHit, Verdict};
use crate::scene::Lamp;
use crate::shadow::LampShadow;
use crate::shadow::map::{MapError, unit_normal, wide};
use crate::shadow::{Answer, Claim, Samples, Visibility, is_front_lit};

/// Samples on each side that are looked at: the cost is bounded, and a wider penumbra is blurred less.
const MOST_AWAY: usize = 32;
/// How far from the plane a sample may lie: of the scene's diagonal, and of its distance.
const OFF_PLANE: [f64; 2] = [0.002, 0.05];
/// Least cosine between normals.
const LEAST_COSINE: f64 = 0.9;

#[derive(Debug)]
struct ContactBlur<'a> {
    map: LightMap<'a>,
    diagonal: f64,
}

/// A front-lit sample.
#[derive(Clone, Copy, Debug)]
struct Shaded {
    point: DVec3,
    normal: DVec3,
    is_lit: bool,
    /// Layer and position on the map, and half-widths of the penumbra; `None` without a penumbra.
    window: Option<(usize, [f64; 2], [f64; 2])>,
    reads: u32,
}

pub(in crate::shadow) fn contact_blur<'a>(
    casters: &'a CasterGroup<'a>,
    lamp: &Lamp,
    options: SoftMapOptions,
) -> Result<Box<dyn LampShadow + 'a>, MapError> {
    let map = LightMap::prepare(casters, lamp, options.size)?;
    let bounds = casters.bounds();
    let diagonal = (wide(bounds.high) - wide(bounds.low)).length();
    Ok(Box::new(AboveHorizon::new(ContactBlur { map, diagonal }, lamp)))
}

impl ContactBlur<'_> {
    fn shaded(&self, hit: &PrimaryHit) -> Option<Shaded> {
        let light = self.map.lamp.light();
        if !is_front_lit(hit, light) {
            return None;
        }
        let normal = unit_normal(hit.corners).unwrap_or_default() * f64::from(hit.side.value());
        let is_lit = self.map.casters.oracle().verdict(hit.point, light) != Verdict::Shadowed;
        let mut reads = 0;
        let receiver = self.map.receiver(hit).filter(|receiver| receiver.is_sound() && receiver.k[0] > 0.0);
        let window = receiver.and_then(|mut receiver| {
            let half = receiver.penumbra(Taps::All);
            reads = receiver.reads;
            Some((receiver.layer, receiver.at, half?))
        });
        Some(Shaded { point: wide(hit.point), normal, is_lit, window, reads })
    }

    /// Whether `other` counts for the sample.
    fn is_near(&self, own: &Shaded, other: &Shaded, layer: usize, at: [f64; 2], half: [f64; 2]) -> bool {
        let away = other.point - own.point;
        let [of_diagonal, of_distance] = OFF_PLANE;
        own.normal.dot(other.normal) > LEAST_COSINE
            && away.dot(own.normal).abs() <= of_diagonal * self.diagonal + of_distance * away.length()
            && self.map.space().at_layer(layer, other.point).is_some_and(|other| {
                (other.tx - at[0]).abs() <= half[0] && (other.ty - at[1]).abs() <= half[1]
            })
    }

    /// The part of the samples in the window that is lit: square rings of samples, until one adds none.
    fn blurred(&self, all: &[Option<Shaded>], row_len: usize, index: usize, own: &Shaded) -> f64 {
        let Some((layer, at, half)) = own.window else { return f64::from(u8::from(own.is_lit)) };
        let (x, y) = (index % row_len, index / row_len);
        let (mut lit, mut count) = (u32::from(own.is_lit), 1);
        for ring in 1..=MOST_AWAY {
            let before = count;
            let rows = y.saturating_sub(ring)..=(y + ring).min(all.len() / row_len - 1);
            for j in rows {
                let is_end = j + ring == y || j == y + ring;
                for i in x.saturating_sub(ring)..=(x + ring).min(row_len - 1) {
                    if !(is_end || i + ring == x || i == x + ring) {
                        continue;
                    }
                    let Some(other) = &all[j * row_len + i] else { continue };
                    if self.is_near(own, other, layer, at, half) {
                        lit += u32::from(other.is_lit);
                        count += 1;
                    }
                }
            }
            if count == before {
                break;
            }
        }
        f64::from(lit) / f64::from(count)
    }
}

impl LampShadow for ContactBlur<'_> {
    fn shade(&self, samples: &Samples) -> Visibility {
        let mut all: Vec<Option<Shaded>> = vec![None; samples.len()];
        crate::parallel::rows(&mut all, samples.row_len(), |row, shaded| {
            for (shaded, hit) in shaded.iter_mut().zip(samples.row(row)) {
                *shaded = hit.as_ref().and_then(|hit| self.shaded(hit));
            }
        });
        Visibility::of_indexed(samples, self.map.lamp.light(), Claim::Approximate, |index, _| {
            let Some(own) = &all[index] else { return Answer::of(0.0) };
            let value = self.blurred(&all, samples.row_len(), index, own) as f32;
            Answer { is_exact: true, reads: own.reads, ..Answer::of(value) }
        })
    }

    fn bytes(&self) -> usize {
        self.map.bytes()
    }

    fn texel_world(&self) -> Option<f64> {
        Some(self.map.texel_world())
    }

    fn bias_world(&self) -> Option<f64> {
        Some(self.map.bias_world())
    }
}

#[cfg(test)]
mod tests {
    use crate::shadow::soft::tests::{SQUARE, square_fraction, values, worst};

    #[test]
    fn contact_blur_is_near_the_visible_part_of_a_half_plane() {
        let found = values("contact-blur:size=256", SQUARE, 0.0);
        let mean = |truth: &dyn Fn(f64) -> f64| {
            found.iter().map(|&(x, value)| (value - truth(x)).abs()).sum::<f64>() / found.len() as f64
        };
        // Windows end at the picture's rim and at 32 samples.
        let blurred = mean(&|x| square_fraction(x, 0.0));
        assert!(blurred < 0.06, "{blurred}");
        // The sabotage: the mask as it is.
        let hard = mean(&|x| if x < 0.0 { 0.0 } else { 1.0 });
        assert!(hard > 2.0 * blurred, "{hard} {blurred}");
        assert!(worst(&found, |x| square_fraction(x, 0.0)) < 0.5);
    }
}
