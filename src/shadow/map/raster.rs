//! The reference rasterizer of shadow maps.
//!
//! Corners are snapped to 1/256 of a texel; coverage is decided at texel centers with integer edge functions
//! and the top-left rule, for both sides of a face. The stored depth is that of the face's plane at the
//! texel's center, computed in `f64` and rounded once, so that snapping moves no surface.

use glam::DVec4;

use super::MapError;
use super::clip::clip;
use super::fit::is_outside;
use super::space::{LightSpace, unit_normal, wide};
use super::texel::Texel;
use crate::caster::CasterGroup;
use crate::geom::Light;
use crate::geom::predicate::side_of_light;
use crate::scene::Lamp;

/// Units of the snapped coordinates per texel.
pub(super) const SUBTEXELS: i64 = 256;
/// Faces are clipped this many texels beside the map. In snapped coordinates that is 2²⁸: edge functions stay
/// below 2⁶¹.
const GUARD_TEXELS: f64 = (1_u64 << 20) as f64;
/// The nearest that a face is drawn, of the near distance.
const NEAREST: f64 = 1.0 / 4096.0;
/// Bands of rows that are drawn side by side.
const BANDS: usize = 16;
/// Most bytes of a map.
pub(super) const MOST_BYTES: usize = 1 << 32;

/// Where the depth of a texel comes from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum DepthSource {
    /// The face's plane, at the texel's center.
    #[default]
    Plane,
    /// Interpolation between the snapped corners, as a device does without a depth of the fragment's own: the
    /// plane, moved by up to `(|a| + |b|) / 512`. Polygon offset works with this source alone.
    Interpolated,
}

impl DepthSource {
    /// Name on the command line.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Plane => "plane",
            Self::Interpolated => "interpolated",
        }
    }
}

/// Polygon offset of the casters, as a device computes it with a floating-point depth buffer: depth moves
/// away from the light by `constant·2^(e − 23) + slope_scale·max(|a|, |b|)`, with `e` the exponent of the
/// triangle's greatest depth.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PolygonOffset {
    /// Units of the depth.
    pub constant: i32,
    /// Factor of the greater slope per texel.
    pub slope_scale: f64,
}

/// A map of one light, with its space. Layers are stored one after another, each by rows from the top.
#[derive(Clone, Debug, PartialEq)]
pub struct ShadowMap<T> {
    space: LightSpace,
    texels: Vec<T>,
}

impl<T: Texel> ShadowMap<T> {
    /// Draws all faces of the casters, both sides. The result does not depend on the number of threads.
    ///
    /// # Errors
    ///
    /// [`MapError::Memory`] if the texels take more than 4 GiB, or cannot be allocated.
    pub fn draw(
        casters: &CasterGroup<'_>,
        light: &Light,
        space: LightSpace,
        depth: DepthSource,
        offset: PolygonOffset,
    ) -> Result<Self, MapError> {
        let side = space.size() as usize;
        let count = side * side * space.layers();
        let bytes = count * size_of::<T>();
        let error = MapError::Memory { size: space.size(), layers: space.layers(), bytes };
        let mut texels = Vec::new();
        if bytes > MOST_BYTES || texels.try_reserve_exact(count).is_err() {
            return Err(error);
        }
        texels.resize(count, T::default());
        let band = side.div_ceil(BANDS);
        for (layer, texels) in texels.chunks_exact_mut(side * side).enumerate() {
            let drawn = triangles(casters, light, &space, layer, depth, offset);
            crate::parallel::rows(texels, side * band, |index, rows| {
                let first = index * band;
                for triangle in &drawn {
                    triangle.draw(side, first, rows);
                }
            });
        }
        Ok(Self { space, texels })
    }

    /// The map of the scene under a lamp, with the depth of planes.
    pub(in crate::shadow) fn of_scene(
        casters: &CasterGroup<'_>,
        lamp: &Lamp,
        size: u32,
    ) -> Result<Self, MapError> {
        let space = LightSpace::of_scene(casters, lamp, size)?;
        Self::draw(casters, lamp.light(), space, DepthSource::Plane, PolygonOffset::default())
    }

    /// A map of given texels, as one that was read back from a device.
    #[cfg(all(test, feature = "gpu"))]
    pub(in crate::shadow) fn of_texels(space: LightSpace, texels: Vec<T>) -> Self {
        assert_eq!(texels.len(), (space.size() as usize).pow(2) * space.layers());
        Self { space, texels }
    }

    /// The space of the map.
    #[must_use]
    pub fn space(&self) -> &LightSpace {
        &self.space
    }

    /// All texels, layer after layer.
    #[must_use]
    pub fn texels(&self) -> &[T] {
        &self.texels
    }

    /// Texel (i, j) of a layer; `None` outside.
    #[must_use]
    pub fn texel(&self, layer: usize, i: i64, j: i64) -> Option<&T> {
        let side = i64::from(self.space.size());
        let inside = layer < self.space.layers() && (0..side).contains(&i) && (0..side).contains(&j);
        // Inside, both are below 2¹⁴.
        inside.then(|| &self.texels[(layer * side as usize + j as usize) * side as usize + i as usize])
    }

    #[cfg(test)]
    pub(super) fn clone_in(&self, space: LightSpace) -> Self {
        Self { space, texels: self.texels.clone() }
    }

    /// Memory of the texels, in bytes.
    #[must_use]
    pub fn bytes(&self) -> usize {
        self.texels.len() * size_of::<T>()
    }
}

/// A snapped triangle with its depth.
#[derive(Clone, Copy, Debug)]
pub(super) struct Triangle {
    /// Column and row in 1/256 of a texel; clockwise as seen, with rows downwards.
    pub(super) corners: [[i64; 2]; 3],
    pub(super) face: u32,
    depth: AffineDepth,
}

/// A depth that is affine in texels.
#[derive(Clone, Copy, Debug)]
struct AffineDepth {
    /// Depth at `from`.
    depth: f64,
    from: [f64; 2],
    slope: [f64; 2],
    /// Greatest depth of the corners. A center that only the snapped face covers may lie beyond it.
    most: f64,
}

impl AffineDepth {
    fn at(&self, i: i64, j: i64) -> f32 {
        let [tx, ty] = [i, j].map(|x| x as f64 + 0.5);
        let depth = self.depth + self.slope[0] * (tx - self.from[0]) + self.slope[1] * (ty - self.from[1]);
        depth.min(self.most).max(0.0) as f32
    }
}

/// The snapped triangles of one layer, in the order of the faces. Faces whose plane contains the light cast
/// no shadow, and are left out.
pub(super) fn triangles(
    casters: &CasterGroup<'_>,
    light: &Light,
    space: &LightSpace,
    layer: usize,
    depth: DepthSource,
    offset: PolygonOffset,
) -> Vec<Triangle> {
    let mut found = Vec::new();
    let mut face = 0;
    for caster in casters.casters() {
        let mesh = caster.mesh();
        for triangle in mesh.triangles() {
            let corners = triangle.map(|vertex| mesh.positions()[vertex as usize]);
            push_face(&mut found, space, layer, light, corners, face, depth, offset);
            face += 1;
        }
    }
    found
}

#[expect(clippy::too_many_arguments, reason = "called once, in the loop above")]
fn push_face(
    found: &mut Vec<Triangle>,
    space: &LightSpace,
    layer: usize,
    light: &Light,
    corners: [[f32; 3]; 3],
    face: u32,
    depth: DepthSource,
    offset: PolygonOffset,
) {
    let at = corners.map(|p| DVec4::from(space.homogeneous(layer, wide(p))));
    if is_outside(at) || side_of_light(corners, light).is_zero() {
        return;
    }
    let guard = 2.0 * GUARD_TEXELS / f64::from(space.size());
    let polygon = clip(at, guard, space.nearest() * NEAREST);
    let half = 0.5 * f64::from(space.size());
    let projected = |p: &DVec4| ([(p.x / p.z + 1.0) * half, (1.0 - p.y / p.z) * half], p.w / p.z);
    let snap = |[tx, ty]: [f64; 2]| [tx, ty].map(|x| (x * SUBTEXELS as f64).round() as i64);
    let most = polygon.corners().iter().fold(0.0_f64, |most, p| most.max(p.w / p.z));
    let plane = unit_normal(corners).map(|normal| space.plane(layer, normal, wide(corners[0])));
    for pair in polygon.corners().get(1..).unwrap_or_default().windows(2) {
        let fan = [&polygon.corners()[0], &pair[0], &pair[1]].map(projected);
        let mut corners = fan.map(|(at, _)| snap(at));
        let area = edge(corners[0], corners[1], corners[2]);
        if area == 0 {
            continue;
        }
        let depth = match (depth, plane) {
            (DepthSource::Plane, Some(plane)) => {
                let from = [half; 2];
                AffineDepth { depth: plane.center, from, slope: plane.slope, most }
            }
            // A face of which rounding leaves no plane.
            _ => interpolated(corners, fan.map(|(_, d)| d), area, offset),
        };
        if !(depth.depth + depth.slope[0] + depth.slope[1]).is_finite() {
            continue;
        }
        if area < 0 {
            corners.swap(1, 2);
        }
        found.push(Triangle { corners, face, depth });
    }
}

/// Depth between snapped corners.
fn interpolated(corners: [[i64; 2]; 3], depths: [f64; 3], area: i64, offset: PolygonOffset) -> AffineDepth {
    let texels = corners.map(|corner| corner.map(|x| x as f64 / SUBTEXELS as f64));
    let [p, q, r] = texels;
    let area = area as f64 / (SUBTEXELS * SUBTEXELS) as f64;
    let [to_q, to_r] = [depths[1] - depths[0], depths[2] - depths[0]];
    let slope = [
        (to_q * (r[1] - p[1]) - to_r * (q[1] - p[1])) / area,
        (to_r * (q[0] - p[0]) - to_q * (r[0] - p[0])) / area,
    ];
    let most = depths.into_iter().fold(0.0, f64::max);
    // A device works in f32; its exponents end at −126.
    let exponent = most.log2().floor().max(-126.0);
    let moved = f64::from(offset.constant) * (exponent - 23.0).exp2()
        + offset.slope_scale * slope[0].abs().max(slope[1].abs());
    AffineDepth { depth: depths[0] - moved, from: p, slope, most: most - moved }
}

/// Twice the signed area of the triangle p, q, r, in snapped units.
fn edge(p: [i64; 2], q: [i64; 2], r: [i64; 2]) -> i64 {
    (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0])
}

impl Triangle {
    /// Draws the triangle into some rows of a layer.
    fn draw<T: Texel>(&self, side: usize, first: usize, rows: &mut [T]) {
        let center = SUBTEXELS / 2;
        let end = first + rows.len() / side;
        let [low, high] = self.extent(1);
        // The first center at or below `low`, and the first one beyond `high`.
        let from = ((low - center + SUBTEXELS - 1).div_euclid(SUBTEXELS)).max(first as i64);
        let to = ((high - center).div_euclid(SUBTEXELS) + 1).min(end as i64);
        for j in from..to {
            let [from, to] = self.span(SUBTEXELS * j + center, side);
            let row = &mut rows[(j as usize - first) * side..][..side];
            for i in from..to {
                row[i as usize].draw(self.depth.at(i, j), self.face);
            }
        }
    }

    /// Columns whose centers are covered on the row of centers at `y`.
    fn span(&self, y: i64, side: usize) -> [i64; 2] {
        let center = SUBTEXELS / 2;
        let [low, high] = self.extent(0);
        let (mut from, mut to) = (low, high);
        for k in 0..3 {
            let (p, q) = (self.corners[k], self.corners[(k + 1) % 3]);
            let [dx, dy] = [q[0] - p[0], q[1] - p[1]];
            // Covered where along − dy·(x − p) is at least `least`: centers on a top or a left edge are.
            let along = dx * (y - p[1]);
            let least = i64::from(!(dy < 0 || dy == 0 && dx > 0));
            match dy.signum() {
                0 if along < least => return [0, 0],
                0 => {}
                -1 => from = from.max(p[0] - (along - least).div_euclid(-dy)),
                _ => to = to.min(p[0] + (along - least).div_euclid(dy)),
            }
        }
        let from = (from - center + SUBTEXELS - 1).div_euclid(SUBTEXELS).max(0);
        [from, ((to - center).div_euclid(SUBTEXELS) + 1).min(side as i64)]
    }

    fn extent(&self, axis: usize) -> [i64; 2] {
        let [p, q, r] = self.corners.map(|corner| corner[axis]);
        [p.min(q).min(r), p.max(q).max(r)]
    }

    /// The depth that the triangle has at a texel's center.
    #[cfg(test)]
    pub(super) fn depth_at(&self, i: i64, j: i64) -> f32 {
        self.depth.at(i, j)
    }
}
