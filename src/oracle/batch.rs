//! Shadow queries for many points towards one light.
//!
//! Segments that miss the bounding box of all faces are answered at once. The others are sorted along a
//! Morton curve (G. M. Morton, *A Computer Oriented Geodetic Data Base*, 1966) by their entry point into that
//! box, so that neighbors traverse the same part of the BVH. Each segment first tests the face that shadowed
//! the previous one. Any proper crossing is a shadow, so the order changes no answer.

use multiversion::multiversion;

use super::{Oracle, Verdict};
use crate::geom::{Aabb, Light};

/// Segments per run; each run starts without a face to try first.
const RUN: usize = 512;

impl Oracle {
    /// Writes the [`Oracle::verdict`] of each of `points` to `verdicts`, several times as fast where there
    /// are many, and on several threads if the feature `parallel` is on. Memory: up to 24 bytes per point.
    ///
    /// ```
    /// use umbrage::geom::Light;
    /// use umbrage::testing::shapes;
    /// use umbrage::oracle::{Oracle, Verdict};
    /// let oracle = Oracle::build(&shapes::cube());
    /// let light = Light::point([0.1, 0.2, 5.0])?;
    /// let mut verdicts = [Verdict::Grazing; 2];
    /// oracle.verdicts_into(&[[0.3, 0.1, -4.0], [3.0, 0.0, 0.0]], &light, &mut verdicts);
    /// assert_eq!(verdicts, [Verdict::Shadowed, Verdict::Lit]);
    /// # Ok::<(), umbrage::geom::LightError>(())
    /// ```
    ///
    /// # Panics
    ///
    /// Panics if `verdicts` and `points` differ in length, or if there are 2³² points or more.
    pub fn verdicts_into(&self, points: &[[f32; 3]], light: &Light, verdicts: &mut [Verdict]) {
        assert_eq!(points.len(), verdicts.len(), "a verdict for each point");
        assert!(u32::try_from(points.len()).is_ok(), "{} points; 2^32 are too many", points.len());
        verdicts.fill(Verdict::Lit);
        let curve = Curve::in_box(&self.bounds());
        // Position of a segment's entry point on the curve, and index of its start point.
        let mut ways: Vec<(u32, u32)> = Vec::new();
        for (&p, index) in points.iter().zip(0..) {
            if let Some(at) = self.tree.entry(p, light) {
                ways.push((curve.place(at), index));
            }
        }
        // Points that arrive in a coherent order, such as pixels, are not sorted: sort only if more than a
        // quarter of consecutive points lie in different cells of a 32 × 32 × 32 grid.
        let jumps = ways.windows(2).filter(|pair| (pair[0].0 ^ pair[1].0) >> 15 != 0).count();
        if jumps > ways.len() / 4 {
            ways.sort_unstable();
        }
        let mut found = vec![(0, Verdict::Lit); ways.len()];
        crate::parallel::rows(&mut found, RUN, |run, found| {
            verdicts_in_a_row(self, points, light, &ways[run * RUN..], found);
        });
        for (index, verdict) in found {
            verdicts[index as usize] = verdict;
        }
    }
}

/// The verdicts of one run in sequence, with AVX2 instructions where the processor has them.
#[multiversion(targets("x86_64+avx2+bmi1+bmi2+lzcnt"))]
fn verdicts_in_a_row(
    oracle: &Oracle,
    points: &[[f32; 3]],
    light: &Light,
    ways: &[(u32, u32)],
    found: &mut [(u32, Verdict)],
) {
    let mut last = usize::MAX;
    for (&(_, index), found) in ways.iter().zip(found) {
        *found = (index, oracle.verdict_trying(points[index as usize], light, &mut last));
    }
}

/// Morton curve through a box of 1024 cells along each axis.
pub(crate) struct Curve {
    low: [f32; 3],
    scale: [f32; 3],
}

impl Curve {
    pub(crate) fn in_box(&Aabb { low, high }: &Aabb) -> Self {
        // Every cell is correct, and the right one is fastest. Casts out of range saturate.
        Self { low, scale: [0, 1, 2].map(|i| 1023.0 / (high[i] - low[i])) }
    }

    #[inline]
    pub(crate) fn place(&self, at: [f32; 3]) -> u32 {
        let cell = |i: usize| spread((((at[i] - self.low[i]) * self.scale[i]) as u32).min(1023));
        cell(0) | cell(1) << 1 | cell(2) << 2
    }
}

/// The ten lowest bits of `x`, with two zeros before each.
#[inline]
fn spread(mut x: u32) -> u32 {
    x = (x | x << 16) & 0x0300_00ff;
    x = (x | x << 8) & 0x0300_f00f;
    x = (x | x << 4) & 0x030c_30c3;
    (x | x << 2) & 0x0924_9249
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::SplitMix64;
    use crate::testing::shapes;

    fn points(count: usize) -> Vec<[f32; 3]> {
        let mut random = SplitMix64(4);
        let mut next = || (random.below(33) as f32 - 16.0) / 4.0;
        (0..count).map(|_| [next(), next(), next()]).collect()
    }

    /// Whether `verdicts` equal those of single queries.
    fn right(oracle: &Oracle, points: &[[f32; 3]], light: &Light, verdicts: &[Verdict]) -> bool {
        points.iter().zip(verdicts).all(|(&p, &verdict)| oracle.verdict(p, light) == verdict)
    }

    #[test]
    fn batch_says_what_single_queries_say() {
        let (mut shadowed, mut caught) = (0, 0);
        for mesh in [
            shapes::cube(),
            shapes::torus(40, 20, 2.0, 0.75),
            shapes::menger_sponge(2),
            shapes::double_sheet(),
        ] {
            let oracle = Oracle::build(&mesh);
            let points = points(3000);
            for light in ["point:3,4,5", "point:0.25,0,0.5", "directional:0,-1,0", "directional:1e-30,-1,0.5"]
            {
                let light = light.parse().unwrap();
                let mut verdicts = vec![Verdict::Grazing; points.len()];
                oracle.verdicts_into(&points, &light, &mut verdicts);
                assert!(right(&oracle, &points, &light, &verdicts));
                shadowed += verdicts.iter().filter(|&&verdict| verdict == Verdict::Shadowed).count();
                // Fault injected: each point gets the verdict of its neighbor.
                verdicts.rotate_left(1);
                caught += usize::from(!right(&oracle, &points, &light, &verdicts));
            }
        }
        assert!(shadowed > 200 && caught > 8, "{shadowed} {caught}");
        Oracle::build(&shapes::cube()).verdicts_into(&[], &"point:1,2,3".parse().unwrap(), &mut []);
    }

    #[test]
    fn batch_of_neighbors_says_what_single_queries_say() {
        let oracle = Oracle::build(&shapes::torus(40, 20, 2.0, 0.75));
        let row: Vec<[f32; 3]> = (0..6000).map(|i| [i as f32 / 500.0 - 6.0, -1.5, 0.25]).collect();
        for light in ["point:1,4,0", "directional:0,-1,0"].map(|light| light.parse().unwrap()) {
            let mut verdicts = vec![Verdict::Grazing; row.len()];
            oracle.verdicts_into(&row, &light, &mut verdicts);
            assert!(right(&oracle, &row, &light, &verdicts));
            assert!(verdicts.contains(&Verdict::Shadowed) && verdicts.contains(&Verdict::Lit));
        }
    }

    #[test]
    fn batch_faces_that_only_shadowed_the_point_before_shadow_nothing() {
        let oracle = Oracle::build(&shapes::torus(40, 20, 2.0, 0.75));
        let light = Light::directional([0.1, -1.0, 0.2]).unwrap();
        let (mut tried, mut helped) = (usize::MAX, 0);
        for p in points(3000) {
            let before = tried;
            assert_eq!(oracle.verdict_trying(p, &light, &mut tried), oracle.verdict(p, &light));
            helped += usize::from(before != usize::MAX && tried != before);
        }
        assert!(helped > 10);
    }

    #[test]
    fn batch_curve_gives_each_cell_a_place_of_its_own() {
        let curve = Curve::in_box(&Aabb { low: [0.0; 3], high: [1023.0; 3] });
        let mut places: Vec<u32> = (0..4096_u32)
            .map(|i| curve.place([(i % 16 * 68) as f32, (i / 16 % 16 * 68) as f32, (i / 256 * 68) as f32]))
            .collect();
        places.sort_unstable();
        places.dedup();
        assert_eq!(places.len(), 4096);
        assert_eq!(curve.place([f32::NAN; 3]), 0);
    }
}
