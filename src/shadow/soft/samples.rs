//! The mean of several exact shadow rays, to points spread over the lamp.
//!
//! The light points are those of one sequence for all samples, as for the same number of hard shadows added
//! up: values have `n + 1` levels, and the mean error inside a penumbra falls with about `n^(−3/4)`.

use crate::caster::CasterGroup;
use crate::geom::Light;
use crate::oracle::{Oracle, Verdict};
use crate::random::r2;
use crate::scene::Lamp;
use crate::shadow::options::{Key, Options, set_number};
use crate::shadow::{Answer, Claim, LampShadow, Samples, Visibility};

/// Options of `samples`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct SamplesOptions {
    /// Number of light points, 1 to 65536.
    pub n: u32,
}

impl SamplesOptions {
    /// 64 light points.
    pub const DEFAULT: Self = Self { n: 64 };
}

impl Default for SamplesOptions {
    fn default() -> Self {
        Self::DEFAULT
    }
}

impl Options for SamplesOptions {
    const KEYS: &'static [Key] = &[Key { name: "n", takes: "a number from 1 to 65536" }];

    fn get(&self, _: &str) -> String {
        self.n.to_string()
    }

    fn set(&mut self, _: &str, value: &str) -> bool {
        set_number(&mut self.n, value, 1..=1 << 16)
    }
}

/// The lamp and the ray cast over all casters.
#[derive(Debug)]
pub(in crate::shadow) struct LampSamples<'a> {
    oracle: &'a Oracle,
    lamp: Lamp,
    /// The light points, in the unit square.
    points: Vec<[f64; 2]>,
}

impl<'a> LampSamples<'a> {
    pub(in crate::shadow) fn prepare(
        casters: &'a CasterGroup<'a>,
        lamp: &Lamp,
        options: SamplesOptions,
    ) -> Self {
        // A lamp without extent is one point.
        let n = if lamp.has_extent() { options.n.max(1) } else { 1 };
        Self { oracle: casters.oracle(), lamp: lamp.clone(), points: (0..n).map(r2).collect() }
    }

    /// A single ray to a lamp without extent is exact.
    fn claim(&self) -> Claim {
        if self.lamp.has_extent() { Claim::Approximate } else { Claim::Exact }
    }
}

impl LampShadow for LampSamples<'_> {
    /// One exact shadow ray per light point and front-lit sample. A grazing ray counts as lit.
    fn shade(&self, samples: &Samples) -> Visibility {
        Visibility::of(samples, self.lamp.light(), self.claim(), |hit| {
            let reaches = |light: &Light| self.oracle.verdict(hit.point, light) != Verdict::Shadowed;
            let lit = match self.lamp.patch(hit.point) {
                None => u32::from(reaches(self.lamp.light())),
                Some(patch) => self.points.iter().map(|&uv| u32::from(reaches(&patch.light(uv)))).sum(),
            };
            Answer::of(lit as f32 / self.points.len() as f32)
        })
    }

    fn bytes(&self) -> usize {
        size_of_val(&*self.points)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::caster::Caster;
    use crate::mesh::Mesh;
    use crate::shadow::{Request, Technique};
    use crate::testing::shapes;
    use crate::view::{Camera, Size, Up};

    /// A floor z = 0 under the half-plane x ≤ 0 (as far as a large plate reaches) at height 2, below a square
    /// lamp of half-size 1 at height 4: the visible fraction at (x, y, 0) is ½ + x/2 for |x| ≤ 1.
    fn values(n: u32) -> Vec<(f64, f32)> {
        let floor = shapes::translated(&shapes::scaled(&shapes::sheet(1), 4.0), [-2.0, -2.0, 0.0]);
        let plate = shapes::translated(&shapes::scaled(&shapes::sheet(1), 64.0), [-64.0, -32.0, 2.0]);
        let casters = [Caster::new(Mesh::concat(&[floor, plate]).unwrap())];
        let casters = CasterGroup::new(casters.iter().collect());
        let size = Size::new(64, 48).unwrap();
        let camera = Camera::look_at([0.2, -1.0, 1.5], [0.2, 0.0, 0.0], 0.9, Up::Z).unwrap();
        let samples = Samples::of_view(&casters, &camera.projection(size, 0.125), size, 1).unwrap();
        let lamp: Lamp = "rect:-1,-1,4:2,0,0:0,2,0".parse().unwrap();
        let request = Request { casters: &casters, lamp: &lamp, samples: &samples };
        let found = Technique::Samples(SamplesOptions { n }).shade(&request).unwrap();
        let hits = samples.hits().iter().zip(found.values());
        hits.filter_map(|(hit, &value)| Some((f64::from(hit.as_ref()?.point[0]), value))).collect()
    }

    #[test]
    fn samples_of_a_half_plane_err_by_less_as_there_are_more() {
        let errors = [4, 16, 64, 256].map(|n| {
            let found = values(n);
            let inside: Vec<f64> = found
                .iter()
                .filter(|(x, _)| x.abs() < 1.0)
                .map(|&(x, value)| (f64::from(value) - (0.5 + x / 2.0)).abs())
                .collect();
            assert!(inside.len() > 1000, "{}", inside.len());
            inside.iter().sum::<f64>() / inside.len() as f64
        });
        // One coordinate of the sequence alone is less even than areas are: its step is close to 3/4.
        assert!(errors.windows(2).all(|pair| pair[1] < 0.8 * pair[0]), "{errors:?}");
        assert!(errors[3] < 0.004, "{errors:?}");
        // Outside the penumbra every ray says the same.
        assert!(values(16).iter().all(|&(x, value)| x <= 1.0 || value == 1.0));
    }
}
