//! Exact sides for many lights: precomputed planes, a filter with a proven bound, the exact predicate for the
//! rest.

use glam::DVec3;
use multiversion::multiversion;

use super::quantized::{Quantized, QuantizedPlanes};
use super::{facing_of, quantized};
use crate::built::{self, Part};
use crate::geom::{Aabb, Facing, Light, predicate};
use crate::mesh::{FaceId, Mesh};
use crate::parallel;

/// The planes of the faces of a mesh, laid out for a loop over all of them: 8 bytes per face in integers,
/// which decide nearly every side, and 20 bytes in `f32` for what they leave open.
///
/// ```
/// use umbrage::facing::{FacePlanes, classify};
/// use umbrage::geom::Light;
/// use umbrage::testing::shapes;
/// let mesh = shapes::icosphere(3);
/// let planes = FacePlanes::new(&mesh);
/// let mut facing = Vec::new(); // kept for its memory
/// for x in [1.0, 2.0, 3.0] {
///     let light = Light::point([x, 4.0, 5.0])?;
///     planes.classify_into(&mesh, &light, &mut facing);
///     assert_eq!(facing, classify(&mesh, &light));
/// }
/// # Ok::<(), umbrage::geom::LightError>(())
/// ```
///
/// Unit normals `n` and offsets `d` in `f32`, at a local origin `o` near the middle of the mesh, so that the
/// plane of a face is `n·(x − o) + d = 0`.
///
/// # The bound
///
/// With `l = L − o` rounded to `f32` (or `l` the direction, and `w = 0`), the side is the sign of `s = n·l +
/// w·d` wherever `|s| > E`, where, with `u = 2⁻²⁴`,
///
/// `E = 8u·(|nx·lx| + |ny·ly| + |nz·lz| + |w·d|) + e·(|lx| + |ly| + |lz| + w·r) + 2⁻¹⁴⁵`.
///
/// Why: each product carries three roundings (of `n`, of `l`, of itself) and two additions follow, so `s`
/// errs by less than `5u·(1 + 5u)` times the sum of magnitudes, itself computed within the same factor; three
/// more units cover computing `E`. Each of `n`, `l`, `d` and the products may instead be subnormal, with an
/// absolute error of 2⁻¹⁵⁰; of these, what is not multiplied by anything is covered by the last term, and
/// those that are, by `e`, which is at least 2⁻⁴⁸.
///
/// `e` bounds the error of the plane itself, from its construction in `f64` with `ε = 2⁻⁵³`. The cross
/// product errs by at most `4ε` times its products' magnitudes. Two vectors that differ by Δ differ in
/// direction by at most `2‖Δ‖ / (‖x‖ + ‖y‖)`, which is `1.5‖Δ‖ / ‖x‖` while `‖Δ‖` is below two thirds of the
/// length: `6ε` times the magnitudes over the length, which for a sliver is large, and `4ε` more for
/// normalizing. The offset errs by that times `r`, the largest `|x| + |y| + |z|` of a vertex from `o`, and
/// `6ε·r`. Where no normal can be formed `e` is infinite and the face is always decided exactly. A light so
/// far away that a product leaves `f32` makes `E` infinite or NaN, and again the exact predicate decides.
#[derive(Clone, Debug)]
pub struct FacePlanes {
    pub(crate) normal: [Vec<f32>; 3],
    pub(crate) offset: Vec<f32>,
    pub(crate) error: Vec<f32>,
    pub(crate) quantized: QuantizedPlanes,
    origin: [f32; 3],
    /// `r` above, rounded up.
    reach: f32,
}

/// A light relative to the local origin of planes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LocalLight {
    light: Light,
    pub(crate) quantized: Quantized,
    /// The same before it is rounded.
    pub(crate) direction: [f64; 4],
    l: [f32; 3],
    w: f32,
    /// `|lx| + |ly| + |lz| + w·r`.
    scale: f32,
    /// [`EVALUATION`] and [`UNDERFLOW`], which a test may make too small.
    evaluation: f32,
    underflow: f32,
}

impl LocalLight {
    /// The light as it is.
    pub(crate) fn light(&self) -> &Light {
        &self.light
    }

    /// `s` and `E` of one plane.
    #[inline(always)]
    pub(crate) fn height(&self, [x, y, z]: [f32; 3], d: f32, e: f32) -> (f32, f32) {
        let (x, y, z, d) = (x * self.l[0], y * self.l[1], z * self.l[2], d * self.w);
        let s = (x + y) + (z + d);
        let magnitudes = (x.abs() + y.abs()) + (z.abs() + d.abs());
        (s, magnitudes * self.evaluation + (e * self.scale + self.underflow))
    }

    /// `|s| − E` with the sign of `s`, or 0 where that is not positive, of planes given component by
    /// component: normals, offsets, errors. Returns the least magnitude of them. Each may be above the truth
    /// by half an ulp.
    ///
    /// Not inlined, and with lengths that the compiler does not know: then it is compiled to vector
    /// instructions.
    #[inline(never)]
    pub(crate) fn heights(&self, [x, y, z, d, e]: [&[f32]; 5], heights: &mut [f32]) -> f32 {
        for (((((height, x), y), z), d), e) in heights.iter_mut().zip(x).zip(y).zip(z).zip(d).zip(e) {
            let (s, bound) = self.height([*x, *y, *z], *d, *e);
            // A bound that is infinite or NaN leaves nothing.
            let above = s.abs() - bound;
            *height = if above > 0.0 { above.copysign(s) } else { 0.0 };
        }
        // Eight at once, then the remainder.
        let mut least = [f32::INFINITY; 8];
        let (eights, rest) = heights.as_chunks::<8>();
        for eight in eights {
            for (least, height) in least.iter_mut().zip(eight) {
                *least = if height.abs() < *least { height.abs() } else { *least };
            }
        }
        least.iter().chain(rest).fold(f32::INFINITY, |least, height| least.min(height.abs()))
    }
}

/// Faces per block: they stay in the first-level cache.
const RUN: usize = 256;
/// 8u with u = 2⁻²⁴. (On near ties 1u is caught, 2u was not.)
pub(crate) const EVALUATION: f32 = 4.0 * f32::EPSILON;
/// 2⁻¹⁴⁵: more than the 2⁻¹⁵⁰ that each of seven roundings may lose below the normal range.
pub(crate) const UNDERFLOW: f32 = f32::from_bits(1 << 4);

impl FacePlanes {
    /// Computes the planes of all faces. Linear time, about 15 ns per face, on several threads with the
    /// feature `parallel`. Memory: 28 bytes per face.
    #[must_use]
    pub fn new(mesh: &Mesh) -> Self {
        // (For performance, here and below: closures on arrays are not always inlined, which doubled the
        // time.)
        let at = |v: u32| mesh.positions()[v as usize];
        built::note(Part::Planes, mesh);
        // The box of each face first: one chain of comparisons over all vertices would be bound by their
        // latency.
        let around = |faces: &[[u32; 3]]| {
            let point = |v: u32| Aabb { low: at(v), high: at(v) };
            faces
                .iter()
                .fold(Aabb::EMPTY, |all, &[a, b, c]| all.join(&point(a).join(&point(b)).join(&point(c))))
        };
        let bounds = parallel::fold(mesh.triangles(), GRAIN, around, |a, b| a.join(&b));
        let origin = bounds.center();
        let far = |p: [f32; 3]| {
            let along = |i: usize| (f64::from(p[i]) - f64::from(origin[i])).abs();
            along(0) + along(1) + along(2)
        };
        let farthest = |faces: &[[u32; 3]]| {
            faces
                .iter()
                .fold(0.0, |most: f64, &[a, b, c]| most.max(far(at(a)).max(far(at(b))).max(far(at(c)))))
        };
        let reach = parallel::fold(mesh.triangles(), GRAIN, farthest, f64::max);
        let reach = round_up(reach);
        let n = mesh.face_count();
        let (mut numbers, mut quantized) = ([(); 5].map(|()| vec![0.0; n]), [(); 4].map(|()| vec![0; n]));
        let planes = PlanesMut {
            numbers: numbers.each_mut().map(Vec::as_mut_slice),
            quantized: quantized.each_mut().map(Vec::as_mut_slice),
        };
        make(mesh.positions(), mesh.triangles(), origin, reach, planes);
        let [x, y, z, offset, error] = numbers;
        let quantized = QuantizedPlanes::new(quantized);
        Self { normal: [x, y, z], offset, error, quantized, origin, reach }
    }

    /// One component of every unit normal.
    #[cfg(feature = "gpu")]
    pub(crate) fn normals(&self, axis: usize) -> &[f32] {
        &self.normal[axis]
    }

    /// The offset of every plane.
    #[cfg(feature = "gpu")]
    pub(crate) fn offsets(&self) -> &[f32] {
        &self.offset
    }

    /// `e` of every plane: infinite where there is no bound.
    #[cfg(feature = "gpu")]
    pub(crate) fn errors(&self) -> &[f32] {
        &self.error
    }

    /// The local origin.
    #[cfg(feature = "gpu")]
    pub(crate) fn origin(&self) -> [f32; 3] {
        self.origin
    }

    /// `r`, rounded up; infinite if it does not fit.
    pub(crate) fn reach(&self) -> f32 {
        self.reach
    }

    /// Unit normals and offsets, those of a face together, for random access.
    pub(crate) fn together(&self) -> Vec<[f32; 4]> {
        let [x, y, z] = &self.normal;
        (0..self.offset.len()).map(|face| [x[face], y[face], z[face], self.offset[face]]).collect()
    }

    /// Injects a fault: planes without their errors.
    #[cfg(all(test, feature = "gpu"))]
    pub(crate) fn forget_errors(&mut self) {
        self.error.fill(0.0);
    }

    /// The side of every face that `light` is on, exactly: as [`classify`](super::classify), faster.
    ///
    /// # Panics
    ///
    /// Panics if `mesh` has another number of faces than the planes were made of.
    #[must_use]
    pub fn classify(&self, mesh: &Mesh, light: &Light) -> Vec<Facing> {
        let mut facing = Vec::new();
        self.classify_into(mesh, light, &mut facing);
        facing
    }

    /// As [`FacePlanes::classify`], into a buffer that keeps its memory. Returns how many faces the filter
    /// left to the exact predicate.
    ///
    /// # Panics
    ///
    /// As [`FacePlanes::classify`].
    pub fn classify_into(&self, mesh: &Mesh, light: &Light, facing: &mut Vec<Facing>) -> usize {
        assert_eq!(mesh.face_count(), self.offset.len(), "the planes are of another mesh");
        facing.resize(mesh.face_count(), Facing::EdgeOn);
        let local = self.local(light);
        let mut exact = 0;
        for (first, facing) in (0..).step_by(RUN).zip(facing.chunks_mut(RUN)) {
            exact += match self.quantized.look(&local.quantized, first, facing) {
                0 => 0,
                few if few <= RUN / 16 => self.settle_each(mesh, &local, first, facing),
                _ => self.settle_all(mesh, &local, first, facing),
            };
        }
        exact
    }

    /// By the `f32` planes alone, with bounds that a test may make too small.
    #[cfg(all(test, feature = "gpu"))]
    pub(crate) fn classify_with(
        &self,
        mesh: &Mesh,
        light: &Light,
        facing: &mut Vec<Facing>,
        evaluation: f32,
        underflow: f32,
    ) -> usize {
        facing.resize(mesh.face_count(), Facing::EdgeOn);
        let local = LocalLight { evaluation, underflow, ..self.local(light) };
        let runs = (0..).step_by(RUN).zip(facing.chunks_mut(RUN));
        runs.map(|(first, facing)| self.settle_all(mesh, &local, first, facing)).sum()
    }

    /// Decides the sides that the integers leave open in a run of faces. Returns how often the predicate was
    /// asked.
    #[inline(never)]
    fn settle_each(&self, mesh: &Mesh, local: &LocalLight, first: usize, facing: &mut [Facing]) -> usize {
        let mut exact = 0;
        for (face, facing) in (first..).zip(facing).filter(|(_, facing)| **facing == Facing::EdgeOn) {
            let asked;
            (*facing, asked) = self.side(mesh, face, local);
            exact += usize::from(asked);
        }
        exact
    }

    /// As [`FacePlanes::settle_each`], for a run with many open sides: all planes by vector instructions.
    #[inline(never)]
    fn settle_all(&self, mesh: &Mesh, local: &LocalLight, first: usize, facing: &mut [Facing]) -> usize {
        let range = first..first + facing.len();
        let [nx, ny, nz] = [0, 1, 2].map(|i| &self.normal[i][range.clone()]);
        let (offset, error) = (&self.offset[range.clone()], &self.error[range]);
        // No branches, no bounds to check and one width throughout, so that it runs in vector registers.
        let mut sides = [0_i32; RUN];
        for (((((side, x), y), z), d), e) in sides.iter_mut().zip(nx).zip(ny).zip(nz).zip(offset).zip(error) {
            let (s, bound) = local.height([*x, *y, *z], *d, *e);
            *side = i32::from(s > bound) - i32::from(s < -bound);
        }
        for (facing, side) in facing.iter_mut().zip(&sides) {
            *facing = match side {
                1 => Facing::Front,
                -1 => Facing::Back,
                _ => Facing::EdgeOn,
            };
        }
        let mut exact = 0;
        for (face, facing) in (first..).zip(facing).filter(|(_, facing)| **facing == Facing::EdgeOn) {
            *facing = facing_of(mesh, FaceId::new(face), &local.light);
            exact += 1;
        }
        exact
    }

    /// A light relative to the local origin.
    pub(crate) fn local(&self, light: &Light) -> LocalLight {
        let xyz = light.xyz();
        let (l, w) = if light.is_directional() {
            (xyz, 0.0)
        } else {
            ([0, 1, 2].map(|i| (f64::from(xyz[i]) - f64::from(self.origin[i])) as f32), 1.0)
        };
        // (1 + 4u) covers the rounding of this sum.
        let scale = (l[0].abs() + l[1].abs() + l[2].abs() + w * self.reach) * (1.0 + 2.0 * f32::EPSILON);
        let (quantized, direction) = quantized::of_light(light, self.origin, self.reach);
        let (evaluation, underflow) = (EVALUATION, UNDERFLOW);
        LocalLight { light: *light, quantized, direction, l, w, scale, evaluation, underflow }
    }

    /// The side of one face, and whether the predicate was asked for it.
    #[inline]
    pub(crate) fn side_of(&self, mesh: &Mesh, face: usize, local: &LocalLight) -> (Facing, bool) {
        match quantized::height(self.quantized.get(face), &local.quantized) {
            quantized::FRONT.. => (Facing::Front, false),
            ..=quantized::BACK => (Facing::Back, false),
            _ => self.side(mesh, face, local),
        }
    }

    /// Whether no light casts a shadow by this face: its corners are collinear.
    pub(crate) fn is_flat(&self, mesh: &Mesh, face: FaceId) -> bool {
        // Where corners are collinear, no plane is known well enough for integers.
        self.quantized.get(face.index()) == [0; 4] && {
            let [a, b, c] = mesh.corners(face);
            predicate::collinear(a, b, c)
        }
    }

    /// The side of one face that the integers leave open, and whether the predicate was asked for it.
    #[inline]
    pub(crate) fn side(&self, mesh: &Mesh, face: usize, local: &LocalLight) -> (Facing, bool) {
        let [x, y, z] = &self.normal;
        let (s, bound) = local.height([x[face], y[face], z[face]], self.offset[face], self.error[face]);
        if s > bound {
            (Facing::Front, false)
        } else if s < -bound {
            (Facing::Back, false)
        } else {
            (facing_of(mesh, FaceId::new(face), &local.light), true)
        }
    }
}

/// Buffers for the planes of some faces: normals, offsets and errors; integers.
struct PlanesMut<'a> {
    numbers: [&'a mut [f32]; 5],
    quantized: [&'a mut [i16]; 4],
}

impl PlanesMut<'_> {
    fn split(self, at: usize) -> [Self; 2] {
        let (mut left, mut right) = (self.numbers, [(); 5].map(|()| &mut [][..]));
        for (left, right) in left.iter_mut().zip(&mut right) {
            (*left, *right) = std::mem::take(left).split_at_mut(at);
        }
        let (mut low, mut high) = (self.quantized, [(); 4].map(|()| &mut [][..]));
        for (low, high) in low.iter_mut().zip(&mut high) {
            (*low, *high) = std::mem::take(low).split_at_mut(at);
        }
        [Self { numbers: left, quantized: low }, Self { numbers: right, quantized: high }]
    }
}

/// Faces whose planes one thread makes: a fifth of a millisecond.
const GRAIN: usize = 1 << 14;

fn make(positions: &[[f32; 3]], triangles: &[[u32; 3]], origin: [f32; 3], reach: f32, planes: PlanesMut<'_>) {
    if triangles.len() <= GRAIN {
        return make_in_order(positions, triangles, origin, reach, planes);
    }
    let half = triangles.len() / 2;
    let ([left, right], (first, second)) = (planes.split(half), triangles.split_at(half));
    parallel::join(
        || make(positions, first, origin, reach, left),
        || make(positions, second, origin, reach, right),
    );
}

/// Corners are fetched for some faces at once, and their planes made in vector registers: no branches
/// between.
#[multiversion(targets("x86_64+avx2+bmi1+bmi2"))]
fn make_in_order(
    positions: &[[f32; 3]],
    triangles: &[[u32; 3]],
    origin: [f32; 3],
    reach: f32,
    mut planes: PlanesMut<'_>,
) {
    const BLOCK: usize = 64;
    let mut corners = [[[0.0; BLOCK]; 3]; 3];
    let (mut numbers, mut whole) = ([[0.0; BLOCK]; 5], [[0; BLOCK]; 4]);
    for (first, triangles) in (0..).step_by(BLOCK).zip(triangles.chunks(BLOCK)) {
        for (place, triangle) in triangles.iter().enumerate() {
            for (corner, &v) in corners.iter_mut().zip(triangle) {
                for (row, x) in corner.iter_mut().zip(positions[v as usize]) {
                    row[place] = x;
                }
            }
        }
        for i in 0..BLOCK {
            let [a, b, c] = &corners;
            let at = |corner: &[[f32; BLOCK]; 3]| [corner[0][i], corner[1][i], corner[2][i]];
            let plane = plane([at(a), at(b), at(c)], origin, f64::from(reach));
            let [x, y, z, w] = quantized::of_plane(plane.normal, plane.offset, plane.error, reach);
            (numbers[0][i], numbers[1][i], numbers[2][i]) = plane.normal.into();
            (numbers[3][i], numbers[4][i]) = (plane.offset, plane.error);
            (whole[0][i], whole[1][i], whole[2][i], whole[3][i]) = (x, y, z, w);
        }
        let (range, count) = (first..first + triangles.len(), triangles.len());
        for (to, from) in planes.numbers.iter_mut().zip(&numbers) {
            to[range.clone()].copy_from_slice(&from[..count]);
        }
        for (to, from) in planes.quantized.iter_mut().zip(&whole) {
            to[range.clone()].copy_from_slice(&from[..count]);
        }
    }
}

struct Plane {
    normal: [f32; 3],
    offset: f32,
    error: f32,
}

#[inline(always)]
fn plane([a, b, c]: [[f32; 3]; 3], origin: [f32; 3], reach: f64) -> Plane {
    const U: f64 = f64::EPSILON / 2.0;
    let wide = |[x, y, z]: [f32; 3]| DVec3::new(x.into(), y.into(), z.into());
    let (u, v) = (wide(b) - wide(a), wide(c) - wide(a));
    let normal = u.cross(v);
    let (p, q) = (u.abs(), v.abs());
    let magnitudes = (p.y * q.z + p.z * q.y) + (p.z * q.x + p.x * q.z) + (p.x * q.y + p.y * q.x);
    let length = (normal.x * normal.x + normal.y * normal.y + normal.z * normal.z).sqrt();
    // Per component of the unit normal: the cross product's own error, then normalizing's four roundings.
    let slack = 6.0 * U * magnitudes / length + 4.0 * U;
    let offset_slack = 4.0 * slack + 8.0 * U;
    // Not so of a normal of length 0, or one that may point anywhere.
    let known = (length > 0.0) & (slack < 1.0);
    let normal = normal / length;
    let a = wide(a) - wide(origin);
    let offset = -(normal.x * a.x + normal.y * a.y + normal.z * a.z) as f32;
    let bounded = known & offset.is_finite() & reach.is_finite();
    let keep = |x: f32| if known { x } else { 0.0 };
    Plane {
        normal: [keep(normal.x as f32), keep(normal.y as f32), keep(normal.z as f32)],
        offset: keep(offset),
        error: if bounded { round_up(offset_slack) } else { f32::INFINITY },
    }
}

/// The nearest `f32` that is not smaller than a number that is not negative.
#[inline(always)]
fn round_up(x: f64) -> f32 {
    let near = x as f32;
    f32::from_bits(near.to_bits() + u32::from(f64::from(near) < x))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::facing::classify;
    use proptest::prelude::*;

    fn coordinate() -> impl Strategy<Value = f32> {
        prop_oneof![
            (-4_i8..=4).prop_map(f32::from),
            -1.0_f32..1.0,
            (-4_i8..=4).prop_map(|x| f32::from(x) + 1000.0),
            (-1.0_f32..1.0).prop_map(|x| x * 1e-30),
            (-1.0_f32..1.0).prop_map(|x| x * 1e30),
            any::<f32>().prop_filter("finite", |x| x.is_finite()),
        ]
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(2000))]

        #[test]
        fn facing_by_planes_equals_the_predicate_face_by_face(
            positions in prop::collection::vec([coordinate(), coordinate(), coordinate()], 3..30),
            picks in prop::collection::vec([any::<u32>(), any::<u32>(), any::<u32>()], 1..100),
            light in [coordinate(), coordinate(), coordinate()],
            on_vertex in any::<bool>(),
            directional in any::<bool>(),
        ) {
            let n = positions.len() as u32;
            let light = if on_vertex { positions[0] } else { light };
            let triangles = picks.into_iter().map(|corners| corners.map(|c| c % n)).collect();
            let mesh = Mesh::new(positions, triangles).unwrap();
            let light = match Light::directional(light) {
                Ok(light) if directional => light,
                _ => Light::point(light).unwrap(),
            };
            prop_assert_eq!(FacePlanes::new(&mesh).classify(&mesh, &light), classify(&mesh, &light));
        }
    }

    #[test]
    fn facing_a_plane_without_its_error_term_is_caught() {
        // Planes exactly through the local origin, and the light there: every face is a tie. Corners on a
        // grid, so that sums are exact, and each face mirrored at the origin, so that the box is centered
        // there.
        let mut positions: Vec<[f32; 3]> = Vec::new();
        for i in 0..150_u16 {
            let grid = |k: u16| f32::from((i * k) % 251) / 256.0;
            let (a, b) = ([grid(7), -grid(31), grid(57)], [-grid(101), grid(13), grid(89) - 0.5]);
            let corners = [a, b, [0, 1, 2].map(|axis| -(a[axis] + b[axis]))];
            positions.extend(corners);
            positions.extend(corners.map(|p| p.map(|x| -x)));
        }
        let triangles = (0..300).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        let mesh = Mesh::new(positions, triangles).unwrap();
        let light = Light::point([0.0; 3]).unwrap();
        let mut planes = FacePlanes::new(&mesh);
        assert_eq!(planes.origin, [0.0; 3]);
        let facing = planes.classify(&mesh, &light);
        assert!(facing.iter().all(|&facing| facing == Facing::EdgeOn));
        planes.error.fill(0.0); // the fault injected
        assert_ne!(planes.classify(&mesh, &light), facing);
    }
}
