//! Biases: how much nearer to the light a stored depth must be than a receiver, to shadow it.
//!
//! On a receiver's plane a texel's center `(Δu, Δv)` beside the lookup stores the depth
//! `d + a·Δu + b·Δv`. The least bias that never lets the plane shadow itself is the greatest such rise over
//! the filter's texels: `reach·(|a| + |b|)`, and rounding. All ways follow from it; none is tuned.

use std::fmt;

use glam::DVec3;

use super::raster::{DepthSource, PolygonOffset};
use super::receiver::Tap;
use super::space::{LightSpace, Spread};

/// How far from a lookup the centers of a filter's texels lie, in texels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Reach {
    /// Along each axis.
    Square(f64),
    /// Bilinear taps in a disk of this radius.
    Disk(f64),
}

impl Reach {
    /// The greatest rise `a·Δu + b·Δv` over the texels: attained at a corner of the square.
    #[must_use]
    pub fn bound(self, [a, b]: [f64; 2]) -> f64 {
        match self {
            Self::Square(reach) => reach * (a.abs() + b.abs()),
            Self::Disk(radius) => radius * a.hypot(b) + a.abs() + b.abs(),
        }
    }

    /// The bound for a slope of length 1 in the worst direction.
    #[must_use]
    pub fn worst(self) -> f64 {
        match self {
            Self::Square(reach) => reach * std::f64::consts::SQRT_2,
            Self::Disk(radius) => radius + std::f64::consts::SQRT_2,
        }
    }

    /// Factor of `max(|a|, |b|)` that is never below the bound, and equal to it where `|a| = |b|`.
    #[must_use]
    pub fn slope_scale(self) -> f64 {
        match self {
            Self::Square(reach) => 2.0 * reach,
            Self::Disk(radius) => radius * std::f64::consts::SQRT_2 + 2.0,
        }
    }

    /// Texels along an axis.
    #[must_use]
    pub fn extent(self) -> f64 {
        match self {
            Self::Square(reach) => reach,
            Self::Disk(radius) => radius + 1.0,
        }
    }

    fn plus(self, texels: f64) -> Self {
        match self {
            Self::Square(reach) => Self::Square(reach + texels),
            Self::Disk(radius) => Self::Disk(radius + texels * std::f64::consts::SQRT_2),
        }
    }
}

/// A way to bias the comparison of depths.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Bias {
    /// The bound on the receiver's own plane.
    Receiver,
    /// The receiver's plane at each texel's center, and half a texel of slack for faces that are smaller than
    /// a texel (John Isidoro, *Shadow Mapping: GPU-based Tips and Techniques*, GDC 2006).
    #[default]
    Texel,
    /// One number for all receivers: the bound of a plane that meets the light at 76°.
    Constant,
    /// Polygon offset of the casters: `slope_scale` times the caster's slope.
    Offset,
    /// A smaller depth range for casters: of a spot or a cube a part of the depth. A linear depth would get
    /// no bias at its far end, and has the constant one.
    Range,
    /// The lookup moves along the receiver's normal (Daniel Holbert, *Saying "Goodbye" to Shadow Acne*, GDC
    /// 2011).
    Normal,
    /// The bound, but at most half the gap to the second depth (Daniel Weiskopf and Thomas Ertl, *Shadow
    /// Mapping Based on Dual Depth Layers*, Eurographics 2003).
    Second,
}

/// Tangent of the steepest plane that [`Bias::Constant`] and [`Bias::Range`] cover: 76°.
const STEEPEST: f64 = 4.0;
/// Units of polygon offset for the rounding of a depth.
const OFFSET_UNITS: i32 = 4;
/// By how much snapped corners move an interpolated depth: half a unit along each axis on either side.
const SNAPPED: f64 = 1.0 / 256.0;
/// Texels of slack of [`Bias::Texel`]: a face smaller than a texel may end at its center.
const SLACK: f64 = 0.5;

impl Bias {
    /// All ways.
    pub const ALL: [Self; 7] =
        [Self::Receiver, Self::Texel, Self::Constant, Self::Offset, Self::Range, Self::Normal, Self::Second];

    /// Name on the command line.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Receiver => "receiver",
            Self::Texel => "texel",
            Self::Constant => "constant",
            Self::Offset => "offset",
            Self::Range => "range",
            Self::Normal => "normal",
            Self::Second => "second",
        }
    }
}

impl fmt::Display for Bias {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// A bias for the texels of one filter in one space.
#[derive(Clone, Copy, Debug)]
pub struct Rule {
    bias: Bias,
    reach: Reach,
    space: LightSpace,
    /// Factor of every bias: 1, but for faults injected by tests.
    factor: f64,
    slack: f64,
}

impl Rule {
    /// The rule of a bias for a filter's reach.
    #[must_use]
    pub fn new(bias: Bias, reach: Reach, depth: DepthSource, space: &LightSpace) -> Self {
        let reach = match depth {
            DepthSource::Plane => reach,
            DepthSource::Interpolated => reach.plus(SNAPPED),
        };
        Self { bias, reach, space: *space, factor: 1.0, slack: SLACK }
    }

    /// How far the texels lie from a lookup, with what an interpolated depth adds.
    #[cfg(feature = "gpu")]
    pub(super) fn reach(&self) -> Reach {
        self.reach
    }

    /// The polygon offset of the casters; none but for [`Bias::Offset`].
    #[must_use]
    pub fn polygon_offset(&self) -> PolygonOffset {
        match self.bias {
            Bias::Offset => {
                PolygonOffset { constant: OFFSET_UNITS, slope_scale: self.factor * self.reach.slope_scale() }
            }
            _ => PolygonOffset::default(),
        }
    }

    /// By how much a lookup moves along the unit normal that points to the light's side, in mesh units; 0 but
    /// for [`Bias::Normal`].
    ///
    /// The clearance of a point that moves by `o` is `o / (n·l)` along the light, the bound for a slope of
    /// `(n·u, n·v)` per mesh unit is that of the filter times a texel over `n·l`: `o` is the filter's bound
    /// times a texel. A central texel grows with the distance to which the point moves.
    #[must_use]
    pub fn normal_offset(&self, layer: usize, normal: DVec3, point: DVec3) -> f64 {
        if self.bias != Bias::Normal {
            return 0.0;
        }
        let frame = self.space.frame(layer);
        let along = [normal.dot(frame.right), normal.dot(frame.up)];
        let bound = self.factor * self.reach.bound(along) / f64::from(self.space.size());
        match self.space.spread() {
            Spread::Parallel { half, .. } => bound * 2.0 * half,
            Spread::Central { tan, .. } => {
                let part = bound * 2.0 * tan;
                // Below 1 for all but the coarsest maps.
                let left = (1.0 - part * normal.dot(frame.axis)).max(1.0 / 16.0);
                part * (point - self.space.origin()).dot(frame.axis).max(0.0) / left
            }
        }
    }

    /// How far from a receiver's position its texels may lie, in texels along an axis.
    #[must_use]
    pub fn footprint(&self) -> f64 {
        // The lookup moves by the filter's bound at most.
        let moved = if self.bias == Bias::Normal { self.reach.worst() } else { 0.0 };
        self.reach.extent() + moved
    }

    /// Whether a stored depth, over the `second` one below it, shadows the receiver of a tap.
    #[must_use]
    pub fn blocks(&self, tap: &Tap, stored: f32, second: Option<f32>) -> bool {
        let stored = f64::from(stored);
        let rounding = self.space.rounding(tap.d);
        // A slope that is no number: the light lies in the receiver's plane, as near as f64 can tell. Neither
        // answer is right or wrong there; the plane does not shadow itself.
        if !(tap.slope[0] + tap.slope[1]).is_finite() {
            return false;
        }
        let [rise_u, rise_v] = [0, 1].map(|axis| tap.slope[axis] * tap.away[axis]);
        let bound = self.factor * self.reach.bound(tap.slope);
        let bias = match self.bias {
            Bias::Receiver => bound,
            Bias::Texel => {
                self.factor * (rise_u + rise_v) + self.slack * (tap.slope[0].abs() + tap.slope[1].abs())
            }
            Bias::Constant => self.factor * self.steepest(1.0),
            Bias::Range => match self.space.spread() {
                Spread::Parallel { .. } => self.factor * self.steepest(1.0),
                // Casters are drawn with (1 − β)·stored, β = κ/(1 + κ): the receiver needs a part κ of its
                // depth.
                Spread::Central { .. } => self.factor * self.steepest(tap.d),
            },
            Bias::Offset | Bias::Normal => 0.0,
            Bias::Second => match second {
                Some(second) if second > 0.0 => bound.min(0.5 * (stored - f64::from(second))),
                _ => bound,
            },
        };
        // Across a seam the tap has its own distance from the lookup.
        let bias = if tap.is_across { bias.max(rise_u.abs() + rise_v.abs()) } else { bias };
        stored > tap.d + bias + rounding
    }

    /// The bound of the steepest plane that a bias for all receivers covers, at a depth of at most `d`.
    pub(super) fn steepest(&self, d: f64) -> f64 {
        let texels = f64::from(self.space.size());
        self.reach.worst()
            * match self.space.spread() {
                Spread::Parallel { half, range, .. } => 2.0 * half / (texels * range) * STEEPEST,
                // A slope is at most d·(2 tan / N) / cos θ.
                Spread::Central { tan, .. } => d * 2.0 * tan / texels * (1.0 + STEEPEST * STEEPEST).sqrt(),
            }
    }

    /// The bias of a plane that meets the light at 45° in the worst direction, in texels: how far behind an
    /// occluder its shadow begins. At the distance where the depth is 1 for [`Bias::Constant`].
    #[must_use]
    pub fn texels_at_45(&self) -> f64 {
        match self.bias {
            Bias::Texel => self.slack * std::f64::consts::SQRT_2,
            Bias::Constant | Bias::Range => self.reach.worst() * STEEPEST,
            _ => self.reach.worst(),
        }
    }

    /// The same rule with a fault: every bias times `factor`, and other slack.
    #[cfg(test)]
    pub(super) fn with_fault(self, factor: f64, slack: f64) -> Self {
        Self { factor, slack, ..self }
    }
}
