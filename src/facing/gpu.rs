//! The filter for the sides of faces that a shader can evaluate: planes and lights scaled so that nothing
//! overflows, and an error bound.

#[cfg(test)]
mod emulation;

use super::FacePlanes;
use super::planes::UNDERFLOW;
use crate::geom::Light;
use crate::geom::predicate::collinear;
use crate::mesh::{FaceId, Mesh};

/// 8.5·2⁻²³: what evaluating a plane twice costs, relative to the sum of the magnitudes.
///
/// Of 10⁶ near ties none is certified wrong down to 2·2⁻²³; 1.25·2⁻²³ is caught. The roundings of five
/// operations do not all fall the same way.
pub(crate) const EVALUATION: f32 = 8.5 * f32::EPSILON;
/// More than everything that is lost below the normal range, 2⁻¹²⁰; itself a normal number.
const FLOOR: f64 = 1e-36;
/// The `e` of a face that is always unsure: the bound is then four times the largest possible side.
pub(crate) const ALWAYS_UNSURE: f32 = 4.0;
/// The `e` of a face that is certainly edge-on: every side exceeds a negative bound, 0 too.
pub(crate) const ALWAYS_EDGE_ON: f32 = -4.0;

/// The parameters of a light; `Light` in `silhouette.wgsl`.
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub(crate) struct LightParameters {
    pub(crate) xyz: [f32; 3],
    pub(crate) w: f32,
    /// The factor of a plane's `e`.
    pub(crate) reach: f32,
    /// A constant term of every bound.
    pub(crate) floor: f32,
    /// The number of faces.
    pub(crate) faces: u32,
    pub(crate) padding: u32,
}

/// The planes of a mesh in units of its own size: a shader's twin of [`FacePlanes`].
///
/// # The bound
///
/// The side of a face is the sign of `S = N·l + w·D`, with its true unit normal `N` and offset `D` from the
/// local origin `o`, and `l = L − o` (or the direction, and `w = 0`). WGSL rounds `+` and `×` either way,
/// with a relative error below `u = 2⁻²³`, may reassociate, fuse and flush what is subnormal, and may assume
/// that nothing is infinite or NaN. So everything is brought near 1 by exact powers of two:
///
/// - offsets by `2ᵏ`, such that the reach `r` of the mesh comes to lie in [1, 2);
/// - `l` by `2ᵏ⁻ʲ` and `w` by `2⁻ʲ`, where `j ≥ 0` makes `|lx| + |ly| + |lz|` less than 2 (for a directional
///   light, whose length is free, `j` may be negative and makes it at least 1).
///
/// The sign of `S` stays, every term is below 4, and `T = |lx| + |ly| + |lz| + w·r` lies in [1, 4). What is
/// stored or computed differs from the truth by three parts.
///
/// 1. *Rounding.* On the host `n`, `l` and `d` are rounded to nearest: `u/2` each (forming `l` in `f64` adds
///    2⁻⁵³; `w` is a power of two). On the device each product is rounded once, and goes through at most
///    three additions, in whatever order: `4u`. Together at most `5u·(1 + 5u)` of the sum of magnitudes
///    `M = |nx·lx| + |ny·ly| + |nz·lz| + |w·d|`. But the shader uses `s` twice, once against the bound and
///    once for its sign, and a compiler may contract or reassociate each use in its own way: two evaluations
///    differ by `2 · 4u·(1 + 4u)·M` at most. Where one exceeds `8u·(1 + 4u)·M` in magnitude, every other has
///    its sign; where it exceeds `5u·(1 + 5u)·M`, so has `S`. The sum is computed within `5u` of itself, and
///    two more roundings follow until it is part of the bound; so `8.5u` times what is computed exceeds
///    `8.5u·(1 − 8u)·M`, which is more than enough for both. 2. *The plane.* As [`FacePlanes`] derives:
///    `e·T`. Two roundings lead to the bound: `T` is enlarged by `2⁻²⁰`. Where there is no finite `e`,
///    [`ALWAYS_UNSURE`] replaces it: no side is larger than `T·(1 + 5u)`. 3. *Underflow.* A value that is
///    flushed, or was rounded to a subnormal number, errs by at most 2⁻¹²⁶, times another factor below 2:
///    three normals, three coordinates, an offset, `w` (times `d`), four products, three sums, less than 16 ·
///    2⁻¹²⁵ = 2⁻¹²¹ in all, and twice that between two evaluations; 10⁻³⁶ is more. An offset that
///    [`FacePlanes`] rounded below the normal range *before* it was scaled erred by less than [`UNDERFLOW`]
///    then, which is `w·2ᵏ` as much now. `e` is at least 2⁻⁴⁸ and `T` at least 1, so no part of the bound is
///    flushed itself.
///
/// A mesh whose reach is not finite has no finite `e` anywhere, so every face is unsure. A face without area
/// is edge-on for every light; that is proven here, once, and stored as [`ALWAYS_EDGE_ON`].
#[derive(Clone, Debug)]
pub(crate) struct Filter {
    origin: [f32; 3],
    /// `k`.
    exponent: i32,
    /// `r` after scaling.
    reach: f64,
    faces: u32,
}

impl Filter {
    /// The units of a mesh, and its planes in them: five runs (x, y, z of the normals, offsets, `e`) with
    /// four faces an entry, the last filled up with faces that are edge-on.
    pub(crate) fn new(mesh: &Mesh, planes: &FacePlanes) -> (Self, Vec<[f32; 4]>) {
        let reach = f64::from(planes.reach());
        let (exponent, reach) = match reach {
            0.0 => (0, 1.0),
            reach if reach.is_finite() => {
                let k = -exponent_of(reach);
                (k, reach * power_of_two(k))
            }
            _ => (-130, 2.0), // three coordinates, each less than twice the largest f32
        };
        let unit = power_of_two(exponent);
        let n = mesh.face_count();
        let groups = n.div_ceil(4).max(1); // no buffer is empty
        let mut values = vec![[0.0; 4]; 5 * groups];
        values[4 * groups..].fill([ALWAYS_EDGE_ON; 4]);
        for face in 0..n {
            let (group, lane) = (face / 4, face % 4);
            for axis in 0..3 {
                values[axis * groups + group][lane] = planes.normals(axis)[face];
            }
            let offset = f64::from(planes.offsets()[face]) * unit;
            values[3 * groups + group][lane] = if offset.is_finite() { offset as f32 } else { 0.0 };
            values[4 * groups + group][lane] = match planes.errors()[face] {
                error if error.is_finite() => error.min(ALWAYS_UNSURE),
                _ => {
                    let [a, b, c] = mesh.corners(FaceId::new(face));
                    if collinear(a, b, c) { ALWAYS_EDGE_ON } else { ALWAYS_UNSURE }
                }
            };
        }
        let faces = n as u32; // a mesh has no more
        (Self { origin: planes.origin(), exponent, reach, faces }, values)
    }

    /// The length of a run in numbers.
    pub(crate) fn stride(&self) -> u32 {
        self.faces.next_multiple_of(4).max(4)
    }

    /// A light in the units of the mesh.
    pub(crate) fn light(&self, light: &Light) -> LightParameters {
        let xyz = light.xyz();
        let (l, w) = if light.is_directional() {
            (xyz.map(f64::from), 0.0)
        } else {
            let unit = power_of_two(self.exponent);
            ([0, 1, 2].map(|i| (f64::from(xyz[i]) - f64::from(self.origin[i])) * unit), 1.0)
        };
        let length = l[0].abs() + l[1].abs() + l[2].abs();
        let j = if light.is_directional() { exponent_of(length) } else { exponent_of(length).max(0) };
        let scale = power_of_two(-j);
        let (l, w) = (l.map(|x| x * scale), w * scale);
        let reach = (length * scale + w * self.reach) * (1.0 + power_of_two(-20));
        let floor = FLOOR + w * power_of_two(self.exponent) * f64::from(UNDERFLOW);
        LightParameters {
            xyz: l.map(|x| x as f32),
            w: w as f32,
            reach: (reach as f32).next_up(),
            floor: (floor as f32).next_up(),
            faces: self.faces,
            padding: 0,
        }
    }
}

/// `⌊log₂ x⌋` of a positive normal number; less than that of any `f32` for 0.
fn exponent_of(x: f64) -> i32 {
    (x.to_bits() >> 52) as i32 - 1023
}

/// `2ᵏ`, for `k` from −1022 to 1023.
fn power_of_two(k: i32) -> f64 {
    f64::from_bits(((1023 + k) as u64) << 52)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::shapes;

    #[test]
    fn filter_units_keep_every_light_and_plane_near_one() {
        for scale in [f32::MIN_POSITIVE, 1e-30, 1.0, 1e30, 1e38] {
            let mesh = shapes::scaled(&shapes::icosphere(1), scale);
            let (filter, values) = Filter::new(&mesh, &FacePlanes::new(&mesh));
            assert!(values.iter().flatten().all(|x| x.abs() <= 4.0), "{scale}");
            let far = [f32::MAX, -f32::MAX, 1.0];
            for xyz in [[0.0; 3], [scale, 2.0 * scale, 0.0], [f32::from_bits(1), 0.0, 0.0], far] {
                for light in [Light::point(xyz).ok(), Light::directional(xyz).ok()].into_iter().flatten() {
                    let LightParameters { xyz, w, reach, floor, .. } = filter.light(&light);
                    assert!(xyz.iter().map(|x| x.abs()).sum::<f32>() <= 2.0, "{scale} {light}");
                    assert!(
                        (1.0..=4.1).contains(&reach) && (0.0..=1.0).contains(&w),
                        "{scale} {light}: {reach}"
                    );
                    assert!(floor > 1e-36 && floor < 1e-3 || scale < 1e-35, "{scale} {light}: {floor}");
                }
            }
        }
    }

    #[test]
    fn filter_powers_of_two_are_exact() {
        for k in [-1022, -149, -1, 0, 1, 127, 280, 1023] {
            assert_eq!(power_of_two(k), 2.0_f64.powi(k));
            assert_eq!(exponent_of(1.75 * power_of_two(k)), k);
        }
        assert!(exponent_of(0.0) < -149);
    }
}
