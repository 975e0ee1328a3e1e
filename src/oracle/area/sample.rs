//! The judge: exact shadow rays to points of the light.

use super::frame::wide;
use super::light::Shape;
use super::{AreaLight, SoftOracle};
use crate::geom::Light;
use crate::oracle::Verdict;
use crate::random::SplitMix64;

/// An estimate of [`Visible::fraction`](super::Visible::fraction) by rays.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sampled {
    /// The share of rays that are not shadowed.
    pub fraction: f64,
    /// Standard error of the mean, from four groups of rays.
    pub standard_error: f64,
    /// Number of rays.
    pub rays: u32,
}

/// Groups of rays with shifts of their own: the points of one group depend on each other, so that only the
/// spread of groups tells an error.
const GROUPS: u32 = 4;

impl SoftOracle<'_> {
    /// Casts about `n` exact rays, at least 4, to points of the light. Grazing ones count as lit: they have
    /// measure 0. The error is about 0.4·n^(−¾) where a shadow's outline crosses the light.
    ///
    /// The points are those of the R2 sequence (Roberts, *The Unreasonable Effectiveness of Quasirandom
    /// Sequences*, 2018), shifted at random and rounded to `f32`. `None` as for [`SoftOracle::visible`].
    #[must_use]
    pub fn sampled(&self, p: [f32; 3], light: &AreaLight, n: u32, seed: u64) -> Option<Sampled> {
        let points = Points::new(p, light)?;
        let mut random = SplitMix64(seed);
        let each = n.div_ceil(GROUPS).max(1);
        let mut means = [0.0; GROUPS as usize];
        for mean in &mut means {
            let shift = [random.unit(), random.unit()];
            let (mut lit, mut cast) = (0_u32, 0_u32);
            // A polygon takes up at least a part in 2²⁰ of its bounding rectangle, or few points are cast.
            for i in 0..u64::from(each) << 20 {
                if cast == each {
                    break;
                }
                let Some(light) = points.light(r2(i, shift)) else { continue };
                cast += 1;
                lit += u32::from(self.oracle().verdict(p, &light) != Verdict::Shadowed);
            }
            *mean = f64::from(lit) / f64::from(cast.max(1));
        }
        let groups = f64::from(GROUPS);
        let fraction = means.iter().sum::<f64>() / groups;
        let spread: f64 = means.iter().map(|mean| (mean - fraction).powi(2)).sum();
        let standard_error = (spread / (groups * (groups - 1.0))).sqrt();
        Some(Sampled { fraction, standard_error, rays: each * GROUPS })
    }
}

/// A point of the R2 sequence in the unit square.
fn r2(i: u64, shift: [f64; 2]) -> [f64; 2] {
    // The root of x³ = x + 1.
    const PLASTIC: f64 = 1.324_717_957_244_746;
    let steps = [1.0 / PLASTIC, 1.0 / (PLASTIC * PLASTIC)];
    [0, 1].map(|k| (shift[k] + i as f64 * steps[k]).fract())
}

/// A light as a map from the unit square to points of it, all of equal weight.
struct Points<'a> {
    corner: [f64; 3],
    edges: [[f64; 3]; 2],
    shape: &'a Shape,
    at_infinity: bool,
}

impl<'a> Points<'a> {
    fn new(p: [f32; 3], light: &'a AreaLight) -> Option<Self> {
        if p.iter().any(|x| !x.is_finite()) {
            return None;
        }
        let (frame, shape) = light.seen_from(p)?;
        if frame.side(p).is_some_and(|side| side.is_zero()) {
            return None;
        }
        let corner = (wide(frame.anchor) + frame.offset).to_array();
        let edges = [frame.e1.to_array(), frame.e2.to_array()];
        Some(Self { corner, edges, shape, at_infinity: frame.at_infinity })
    }

    /// The light's point for a point of the square; `None` outside of a polygon.
    fn light(&self, [s, t]: [f64; 2]) -> Option<Light> {
        let [u, v] = match self.shape {
            Shape::Full => [s, t],
            Shape::Disk => {
                let (radius, turn) = (0.5 * s.sqrt(), std::f64::consts::TAU * t);
                [0.5 + radius * turn.cos(), 0.5 + radius * turn.sin()]
            }
            Shape::Polygon(outline) => {
                if turns(outline, [s, t]) == 0 {
                    return None;
                }
                [s, t]
            }
        };
        let [e1, e2] = self.edges;
        let at = [0, 1, 2].map(|i| (self.corner[i] + u * e1[i] + v * e2[i]) as f32);
        if self.at_infinity { Light::directional(at.map(|x| -x)).ok() } else { Light::point(at).ok() }
    }
}

/// How often a closed chain winds around a point.
fn turns(outline: &[[f64; 2]], [x, y]: [f64; 2]) -> i32 {
    let mut turns = 0;
    for (i, a) in outline.iter().enumerate() {
        let b = outline[(i + 1) % outline.len()];
        if (a[1] <= y) != (b[1] <= y) {
            let side = (b[0] - a[0]) * (y - a[1]) - (x - a[0]) * (b[1] - a[1]);
            if (side > 0.0) == (b[1] > a[1]) && side != 0.0 {
                turns += if b[1] > a[1] { 1 } else { -1 };
            }
        }
    }
    turns
}
