//! Single-sample soft shadows: the technique `single-sample`.
//!
//! (Stefan Brabec and Hans-Peter Seidel, *Single Sample Soft Shadows using Depth Maps*, Graphics Interface
//! 2002, after Parker, Shirley and Smits 1998.) The distance to the nearest change between blocked and open
//! texels gives the visible part of the lamp, inside the hard shadow and outside it. What errs: an umbra that
//! no light point leaves is found where an occluder is smaller than the lamp, and corners are too dark.
//!
//! `literal=yes` is the transcription of A. Schiltknecht (*Ombres douces en temps réel*, 2009), taken word
//! for word, but for its comparison without a bias, which would fill most pictures with acne. Its profile has
//! its light inside the shadow, its widths mix texels with depths, and an inner point asks the lit surface
//! found instead of the blocker above it.

use super::horizon::AboveHorizon;
use super::light_map::{LightMap, Receiver};
use super::offsets::offsets;
use super::{Search, SingleSampleOptions};
use crate::caster::CasterGroup;
use crate::oracle::PrimaryHit;
use crate::scene::Lamp;
use crate::shadow::LampShadow;
use crate::shadow::map::MapError;
use crate::shadow::soft::blocks::Blocks;
use crate::shadow::{Answer, Claim, Samples, Visibility};

#[derive(Debug)]
struct SingleSample<'a> {
    map: LightMap<'a>,
    options: SingleSampleOptions,
}

pub(in crate::shadow) fn single_sample<'a>(
    casters: &'a CasterGroup<'a>,
    lamp: &Lamp,
    options: SingleSampleOptions,
) -> Result<Box<dyn LampShadow + 'a>, MapError> {
    if options.search == Search::Device {
        return Err(MapError::Device);
    }
    let map = LightMap::prepare(casters, lamp, options.size)?;
    Ok(Box::new(AboveHorizon::new(SingleSample { map, options }, lamp)))
}

impl SingleSample<'_> {
    fn answer(&self, hit: &PrimaryHit) -> Answer {
        match self.options.literal {
            false => self.map.answer(hit, |receiver| receiver.single_sample()),
            true => self.map.answer(hit, |receiver| receiver.single_sample_of_2009()),
        }
    }
}

impl LampShadow for SingleSample<'_> {
    fn shade(&self, samples: &Samples) -> Visibility {
        let (light, claim) = (self.map.lamp.light(), Claim::Approximate);
        if self.options.adaptive == 0 {
            return Visibility::of(samples, light, claim, |hit| self.answer(hit));
        }
        let blocks = Blocks::of(&self.map, samples, self.options.adaptive as usize, |hit| self.answer(hit));
        Visibility::of_indexed(samples, light, claim, |index, hit| {
            blocks.answer(index).unwrap_or_else(|| self.answer(hit))
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

impl Receiver<'_> {
    /// The visible part of the lamp.
    fn single_sample(&mut self) -> f64 {
        let Some(change) = self.change() else { return 1.0 };
        let q = change.distance();
        self.profile(if change.is_inner != 0 { -q } else { q })
    }

    /// The pseudo-code of 2009.
    fn single_sample_of_2009(&mut self) -> f64 {
        /// In texels: `r_scale` times a depth from 0 to 1 that is nearly 1 for everything, and `r_bias`.
        const R_SCALE: f64 = 3.0;
        const R_BIAS: f64 = 1.0;
        const R_FACT: f64 = 0.5;
        const STEP: f64 = 1.0;
        let [column, row] = self.at.map(|t| t.floor() as i64);
        let Some((_, is_inner)) = self.look(column, row) else { return 1.0 };
        let r_max = R_SCALE * (1.0 - self.d).abs() + R_BIAS;
        let mut r = STEP;
        while r <= r_max {
            let ring = |distance: f32| (f64::from(distance) - r).abs() < 0.5 * STEP;
            let near = offsets().iter().take_while(|offset| f64::from(offset.distance) < r + STEP);
            for offset in near.filter(|offset| ring(offset.distance)) {
                let found = self.look(column + i64::from(offset.i), row + i64::from(offset.j));
                let Some((found, _)) = found.filter(|(_, blocks)| *blocks != is_inner) else { continue };
                // Texels over a difference of depths: far above 1 but for the nearest of contacts.
                let part = (f64::from(offset.distance) / (r_max * (found - self.d).abs())).clamp(0.0, 1.0);
                return if is_inner { R_FACT * part } else { 1.0 - R_FACT * part };
            }
            r += STEP;
        }
        if is_inner { 0.0 } else { 1.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::caster::Caster;
    use crate::mesh::Mesh;
    use crate::shadow::soft::tests::{SQUARE, SUN, disk_fraction, square_fraction, values, worst};
    use crate::shadow::{Request, Technique};
    use crate::testing::shapes;
    use crate::view::{Camera, Size, Up};

    #[test]
    fn single_sample_equals_the_visible_part_of_an_aligned_half_plane() {
        for size in [128, 256] {
            let width = f64::from(size) / 8.0;
            let technique = format!("single-sample:size={size}");
            let square = values(&technique, SQUARE, 0.0);
            let error = worst(&square, |x| square_fraction(x, 0.0));
            assert!(error < 1.5 / width, "{size}: {error}");
            for angle in [0.0, 0.5] {
                let sun = values(&technique, SUN, angle);
                let error = worst(&sun, disk_fraction);
                assert!(error < 3.0 / width, "{size} {angle}: {error}");
            }
            // The sabotage: the profile of 2009, with its light inside the shadow.
            let inverted =
                |x: f64| if x < 0.0 { 0.5 - square_fraction(x, 0.0) } else { 1.5 - square_fraction(x, 0.0) };
            assert!(
                worst(&square, |x| if x.abs() < 1.0 { inverted(x) } else { square_fraction(x, 0.0) }) > 0.4
            );
            let literal = values(&format!("single-sample:size={size},literal=yes"), SQUARE, 0.0);
            assert!(worst(&literal, |x| square_fraction(x, 0.0)) > 0.4);
        }
    }

    /// Below a small occluder a large lamp is nearly whole; the nearest edge knows of one side alone.
    #[test]
    fn single_sample_below_a_small_occluder_is_wrong_and_reported_so() {
        let floor = shapes::translated(&shapes::scaled(&shapes::sheet(1), 4.0), [-2.0, -2.0, 0.0]);
        let small = shapes::translated(&shapes::scaled(&shapes::sheet(1), 0.25), [-0.125, -0.125, 2.0]);
        let caster = Caster::new(Mesh::concat(&[floor, small]).unwrap());
        let casters = CasterGroup::new(vec![&caster]);
        let size = Size::new(24, 18).unwrap();
        let camera = Camera::look_at([0.0, -0.3, 1.0], [0.0; 3], 0.3, Up::Z).unwrap();
        let samples = Samples::of_view(&casters, &camera.projection(size, 0.125), size, 1).unwrap();
        let lamp: Lamp = SQUARE.parse().unwrap();
        let request = Request { casters: &casters, lamp: &lamp, samples: &samples };
        let of =
            |technique: &str| {
                let technique: Technique = technique.parse().unwrap();
                let found = technique.shade(&request).unwrap();
                found.values().iter().zip(samples.hits()).fold(1.0_f32, |least, (&value, hit)| {
                    if hit.is_some() { least.min(value) } else { least }
                })
            };
        // The closed form 1 − (e·z_r / ((z_r − z_b)·R))² for half-sizes e of the occluder and R of the lamp.
        let truth = 1.0 - (0.125 * 4.0 / 2.0_f32).powi(2);
        assert!((of("samples:n=256") - truth).abs() < 0.02);
        assert!(of("single-sample:size=256") <= 0.5);
        assert!(of("penumbra-map:size=256") <= 0.5 && of("penumbra-map:size=256,profile=full") == 0.0);
        assert!((of("pcss:size=256,blockers=all,taps=all") - truth).abs() < 0.05);
    }

    #[test]
    fn single_sample_with_tiles_equals_the_search_of_all_texels() {
        let mut random = crate::random::SplitMix64(2);
        let sheet = shapes::translated(&shapes::scaled(&shapes::sheet(3), 2.0), [-3.0, -3.0, -1.5]);
        let caster = Caster::new(Mesh::concat(&[shapes::torus_knot(2, 3, 40, 7, 0.4), sheet]).unwrap());
        let casters = CasterGroup::new(vec![&caster]);
        let size = Size::new(40, 30).unwrap();
        let camera = Camera::fit(&casters.bounds(), Up::Z, size.aspect());
        let samples = Samples::of_view(&casters, &camera.projection(size, 0.125), size, 1).unwrap();
        let (mut reads, mut brute) = (0, 0);
        for lamp in [
            "directional:0.3,0.2,-1,angle=12",
            "spot:1,2,9:-0.1,-0.2,-1:35,radius=0.6",
            "rect:0,0,6:2,0,0:0,1,1",
            "point:0,0.2,1,radius=0.3", // within the knot: all layers of a cube
        ] {
            let map = LightMap::prepare(&casters, &lamp.parse().unwrap(), 600).unwrap();
            let mut inside = 0;
            for hit in samples.hits().iter().flatten().filter(|_| random.below(4) == 0) {
                let Some(mut receiver) = map.receiver(hit) else { continue };
                if !receiver.is_sound() {
                    continue;
                }
                let Some(by_tiles) = receiver.change() else { continue };
                reads += std::mem::take(&mut receiver.reads);
                let by_texels = receiver.change_by_texels();
                brute += receiver.reads;
                assert_eq!(Some(by_tiles), by_texels, "{lamp} {receiver:?}");
                inside += u32::from(by_tiles.distance() < 1.0);
            }
            assert!(inside > 15, "{lamp} {inside}");
        }
        assert!(reads * 2 < brute, "{reads} {brute}");
    }

    /// A floor with a penumbra on it and a small plate in the lit part.
    fn adaptive(block: u32, technique: impl Fn(&Samples, &LightMap<'_>) -> Visibility) -> Vec<Visibility> {
        let floor = shapes::translated(&shapes::scaled(&shapes::sheet(1), 8.0), [-4.0, -4.0, 0.0]);
        let plate = shapes::translated(&shapes::scaled(&shapes::sheet(1), 1.0), [0.5, -0.5, 2.0]);
        let step = shapes::translated(&shapes::scaled(&shapes::sheet(1), 0.5), [-1.0, -0.5, 0.05]);
        let caster = Caster::new(Mesh::concat(&[floor, plate, step]).unwrap());
        let casters = CasterGroup::new(vec![&caster]);
        let size = Size::new(50, 39).unwrap();
        let camera = Camera::look_at([0.0, -3.0, 5.0], [0.0; 3], 0.7, Up::Z).unwrap();
        let samples = Samples::of_view(&casters, &camera.projection(size, 0.125), size, 1).unwrap();
        let lamp: Lamp = "rect:-0.5,-0.5,4:1,0,0:0,1,0".parse().unwrap();
        let request = Request { casters: &casters, lamp: &lamp, samples: &samples };
        let of = |adaptive| {
            let options = SingleSampleOptions { size: 256, adaptive, ..SingleSampleOptions::DEFAULT };
            Technique::SingleSample(options).shade(&request).unwrap()
        };
        let map = LightMap::prepare(&casters, &lamp, 256).unwrap();
        vec![of(0), of(block), technique(&samples, &map)]
    }

    #[test]
    fn adaptive_sampling_of_single_samples_is_full_and_otherwise_near() {
        let full_again = |samples: &Samples, map: &LightMap<'_>| {
            Visibility::of(samples, map.lamp.light(), Claim::Approximate, |hit| {
                map.answer(hit, |receiver| receiver.single_sample())
            })
        };
        let found = adaptive(1, full_again);
        assert_eq!(found[0].values(), found[1].values());
        for block in [2, 4, 8] {
            // The sabotage: blocks that agree in everything, whatever their shells and hard shadows.
            let careless = |samples: &Samples, map: &LightMap<'_>| {
                let answer = |hit: &PrimaryHit| map.answer(hit, |receiver| receiver.single_sample());
                let mut blocks = Blocks::of(map, samples, block as usize, answer);
                blocks.forget_ids();
                Visibility::of_indexed(samples, map.lamp.light(), Claim::Approximate, |index, hit| {
                    blocks.answer(index).unwrap_or_else(|| answer(hit))
                })
            };
            let found = adaptive(block, careless);
            let [full, near, careless] = &found[..] else { panic!() };
            let mean = |other: &Visibility| {
                let pairs = full.values().iter().zip(other.values());
                pairs.map(|(a, b)| f64::from((a - b).abs())).sum::<f64>() / full.values().len() as f64
            };
            assert!(mean(near) < 0.012, "{block} {}", mean(near));
            assert!(mean(careless) > 1.5 * mean(near), "{block} {} {}", mean(careless), mean(near));
            assert!(near.reads() * 3 < full.reads() * 2, "{block} {} {}", near.reads(), full.reads());
        }
    }
}
