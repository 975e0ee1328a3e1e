//! Light space: where a point falls on a shadow map, and how near to the light.
//!
//! A point is projected by three rows, after the origin was subtracted from it; a matrix with the translation
//! in it would cost the distance to the world's origin. Depth is reversed: it grows towards the light, and 0
//! is farther than anything. A central projection (spot, cube) has `d = near / z`, a parallel one a linear
//! `d`. In both, depth is affine in texels on every plane: [`DepthPlane`] is exact, and so are the biases
//! that follow from it.

use glam::DVec3;

/// Rows of one layer of a map. `right` and `up` are those of clip space; texel rows run downwards.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// Unit vector along which the texel column grows.
    pub right: DVec3,
    /// Unit vector along which the texel row decreases.
    pub up: DVec3,
    /// Unit vector of the depth: towards a directional light; from a point light forwards.
    pub axis: DVec3,
}

/// The kind of a projection, with its constants.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Spread {
    /// A directional light: `d = (q·axis − lowest) / range`.
    Parallel {
        /// Half the side of the square that the map covers, in mesh units.
        half: f64,
        /// The depth 0, along the axis.
        lowest: f64,
        /// Depth 1 less depth 0, in mesh units.
        range: f64,
    },
    /// A light at the origin: `d = near / (q·axis)`, without a far plane.
    Central {
        /// Half the side of the square that a layer covers at distance 1.
        tan: f64,
        /// The distance along the axis at which depth is 1. Depth is above 1 where a caster is nearer.
        near: f64,
    },
}

/// The space of one light's map: origin, rows per layer, kind of projection, and side of the map in texels.
///
/// The basis depends on the light alone, so that texels do not move with the camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightSpace {
    pub(super) origin: DVec3,
    pub(super) frames: [Frame; 6],
    pub(super) layers: usize,
    pub(super) spread: Spread,
    pub(super) size: u32,
}

/// Position of a point on a map.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lookup {
    /// The layer.
    pub layer: usize,
    /// Texels from the left edge; texel (i, j) has its center at (i + ½, j + ½).
    pub tx: f64,
    /// Texels from the upper edge.
    pub ty: f64,
    /// Reversed depth.
    pub d: f64,
}

/// Reversed depth on a plane in one layer: affine in texels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DepthPlane {
    /// Depth at the center of the layer.
    pub center: f64,
    /// Change of depth per texel, to the right and downwards: `a` and `b`.
    pub slope: [f64; 2],
    half_texels: f64,
}

impl DepthPlane {
    /// Depth of the plane at a position of the layer.
    #[must_use]
    pub fn at(&self, tx: f64, ty: f64) -> f64 {
        self.center + self.slope[0] * (tx - self.half_texels) + self.slope[1] * (ty - self.half_texels)
    }
}

impl LightSpace {
    /// Side of a layer in texels.
    #[must_use]
    pub fn size(&self) -> u32 {
        self.size
    }

    /// Number of layers: six for a cube, otherwise one.
    #[must_use]
    pub fn layers(&self) -> usize {
        self.layers
    }

    /// Subtracted from a point before the rows are applied: the light, or a point in the middle of the map.
    #[must_use]
    pub fn origin(&self) -> DVec3 {
        self.origin
    }

    /// The rows of a layer.
    ///
    /// # Panics
    ///
    /// Panics if there is no such layer.
    #[must_use]
    pub fn frame(&self, layer: usize) -> &Frame {
        &self.frames[..self.layers][layer]
    }

    /// The kind of projection.
    #[must_use]
    pub fn spread(&self) -> Spread {
        self.spread
    }

    /// The layer of a cube that looks at a point: the axis of the greatest coordinate of the vector from the
    /// light, at a tie the lower axis. Other maps have layer 0 alone.
    #[must_use]
    pub fn layer_of(&self, p: DVec3) -> usize {
        if self.layers == 1 {
            return 0;
        }
        let q = (p - self.origin).to_array();
        let axis = (1..3).fold(0, |best, i| if q[i].abs() > q[best].abs() { i } else { best });
        2 * axis + usize::from(q[axis] < 0.0)
    }

    /// Position of a point on the map. `None` if the point is not in front of a light at the origin, or is
    /// too far beside the axis for numbers.
    #[must_use]
    pub fn at(&self, p: DVec3) -> Option<Lookup> {
        self.at_layer(self.layer_of(p), p)
    }

    /// Position of a point on a given layer, beside it where the layer does not show the point.
    #[must_use]
    pub fn at_layer(&self, layer: usize, p: DVec3) -> Option<Lookup> {
        let [x, y, w, dw] = self.homogeneous(layer, p);
        let half = 0.5 * f64::from(self.size);
        let lookup = Lookup { layer, tx: (x / w + 1.0) * half, ty: (1.0 - y / w) * half, d: dw / w };
        (w > 0.0 && (lookup.tx + lookup.ty + lookup.d).is_finite()).then_some(lookup)
    }

    /// Whether a position lies on the map. A cube shows everything.
    #[must_use]
    pub fn shows(&self, at: &Lookup) -> bool {
        let inside = 0.0..f64::from(self.size);
        self.layers > 1 || inside.contains(&at.tx) && inside.contains(&at.ty)
    }

    /// Clip coordinates x, y, w and depth times w: linear in the point.
    pub(in crate::shadow) fn homogeneous(&self, layer: usize, p: DVec3) -> [f64; 4] {
        let Frame { right, up, axis } = self.frames[layer];
        let q = p - self.origin;
        match self.spread {
            Spread::Parallel { half, lowest, range } => {
                [q.dot(right) / half, q.dot(up) / half, 1.0, (q.dot(axis) - lowest) / range]
            }
            Spread::Central { tan, near } => [q.dot(right) / tan, q.dot(up) / tan, q.dot(axis), near],
        }
    }

    /// Depth on the plane through `p` with this normal (of any length and either sign), in one layer. Not
    /// finite if the plane contains the direction to the light.
    #[must_use]
    pub fn plane(&self, layer: usize, normal: DVec3, p: DVec3) -> DepthPlane {
        let (along, offset) = (normal.dot(self.frames[layer].axis), normal.dot(p - self.origin));
        let center = match self.spread {
            Spread::Parallel { lowest, range, .. } => (offset / along - lowest) / range,
            Spread::Central { near, .. } => near * along / offset,
        };
        let slope = self.slope(layer, normal, p);
        DepthPlane { center, slope, half_texels: 0.5 * f64::from(self.size) }
    }

    /// Change of depth per texel, to the right and downwards, on the plane through `p` with this normal (of
    /// any length and either sign). Not finite if the plane contains the direction to the light.
    #[must_use]
    pub fn slope(&self, layer: usize, normal: DVec3, p: DVec3) -> [f64; 2] {
        let Frame { right, up, axis } = self.frames[layer];
        let factor = match self.spread {
            Spread::Parallel { half, range, .. } => -2.0 * half / (range * normal.dot(axis)),
            Spread::Central { tan, near } => near * 2.0 * tan / normal.dot(p - self.origin),
        } / f64::from(self.size);
        // Texel rows run against `up`.
        [factor * normal.dot(right), -factor * normal.dot(up)]
    }

    /// The distance at which depth is 1; 1 for a parallel projection, whose points all have w = 1.
    pub(super) fn nearest(&self) -> f64 {
        match self.spread {
            Spread::Parallel { .. } => 1.0,
            Spread::Central { near, .. } => near,
        }
    }

    /// Side of a texel in mesh units, at a point.
    #[must_use]
    pub fn texel_world(&self, p: DVec3) -> f64 {
        match self.spread {
            Spread::Parallel { half, .. } => 2.0 * half / f64::from(self.size),
            Spread::Central { tan, .. } => {
                2.0 * tan * self.distance(self.layer_of(p), p) / f64::from(self.size)
            }
        }
    }

    /// A difference of depth at a point, in mesh units along the axis. To first order for a central
    /// projection.
    #[must_use]
    pub fn depth_world(&self, p: DVec3, difference: f64) -> f64 {
        match self.spread {
            Spread::Parallel { range, .. } => difference * range,
            Spread::Central { near, .. } => difference * self.distance(self.layer_of(p), p).powi(2) / near,
        }
    }

    fn distance(&self, layer: usize, p: DVec3) -> f64 {
        self.frames[layer].axis.dot(p - self.origin)
    }

    /// The constant K of the penumbra law: a blocker at depth `b` over a receiver at depth `r` has a penumbra
    /// of half-width `K·(b − r)` texels. `extent` is the half-size of a light at the origin, in mesh units,
    /// or the tangent of half the angle that a directional light takes up.
    #[must_use]
    pub fn penumbra_scale(&self, extent: f64) -> f64 {
        match self.spread {
            Spread::Parallel { half, range, .. } => extent * range * f64::from(self.size) / (2.0 * half),
            Spread::Central { tan, near } => extent * f64::from(self.size) / (2.0 * tan * near),
        }
    }

    /// Allowance for rounding at a depth: four units of a depth of 24 bits. A linear depth is a sum of
    /// numbers near 1, whatever its value; `near / z` is a quotient, with a relative error.
    #[must_use]
    pub fn rounding(&self, d: f64) -> f64 {
        let units = 4.0 * (-24_f64).exp2();
        match self.spread {
            Spread::Parallel { .. } => units,
            Spread::Central { .. } => units * d,
        }
    }

    /// The point at a position and a depth of a layer: the inverse of [`LightSpace::at_layer`].
    #[must_use]
    pub fn point(&self, layer: usize, tx: f64, ty: f64, d: f64) -> DVec3 {
        let Frame { right, up, axis } = self.frames[layer];
        let half_texels = 0.5 * f64::from(self.size);
        let (x, y) = (tx / half_texels - 1.0, 1.0 - ty / half_texels);
        self.origin
            + match self.spread {
                Spread::Parallel { half, lowest, range } => {
                    half * (x * right + y * up) + (lowest + d * range) * axis
                }
                Spread::Central { tan, near } => near / d * (tan * (x * right + y * up) + axis),
            }
    }

    /// The light's ray through the center of a texel: a point of it and its direction, away from the light.
    /// The point is the light, or the ray's point at depth 1.
    #[must_use]
    pub fn ray(&self, layer: usize, i: u32, j: u32) -> [DVec3; 2] {
        let [tx, ty] = [i, j].map(|x| f64::from(x) + 0.5);
        let first = self.point(layer, tx, ty, 1.0);
        match self.spread {
            Spread::Parallel { .. } => [first, -self.frames[layer].axis],
            Spread::Central { near, .. } => [self.origin, (first - self.origin) / near],
        }
    }
}

/// A frame around an axis: `up` is as near to the world's y as the axis allows, or to its z where the axis is
/// nearest to y. `right × up` is `axis` times `handed`.
pub(super) fn frame_of(axis: DVec3, handed: f64) -> Frame {
    let along_y = axis.y.abs() >= axis.x.abs() && axis.y.abs() >= axis.z.abs();
    let near_up = if along_y { DVec3::Z } else { DVec3::Y };
    let up = (near_up - near_up.dot(axis) * axis).normalize();
    Frame { right: up.cross(axis) * handed, up, axis }
}

/// The six frames of a cube, in the order +x, −x, +y, −y, +z, −z, as graphics devices have them: each is
/// mirrored, `right × up = axis`.
pub(super) const CUBE: [Frame; 6] = {
    const fn frame(right: DVec3, up: DVec3, axis: DVec3) -> Frame {
        Frame { right, up, axis }
    }
    [
        frame(DVec3::NEG_Z, DVec3::Y, DVec3::X),
        frame(DVec3::Z, DVec3::Y, DVec3::NEG_X),
        frame(DVec3::X, DVec3::NEG_Z, DVec3::Y),
        frame(DVec3::X, DVec3::Z, DVec3::NEG_Y),
        frame(DVec3::X, DVec3::Y, DVec3::Z),
        frame(DVec3::NEG_X, DVec3::Y, DVec3::NEG_Z),
    ]
};

/// Unit normal of a face by its winding; `None` for a face without area.
pub(in crate::shadow) fn unit_normal(corners: [[f32; 3]; 3]) -> Option<DVec3> {
    let [a, b, c] = corners.map(wide);
    (b - a).cross(c - a).try_normalize()
}

pub(in crate::shadow) fn wide(p: [f32; 3]) -> DVec3 {
    DVec3::from(p.map(f64::from))
}
