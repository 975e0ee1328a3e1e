//! A plane, and the projection from a light onto it.
//!
//! (James Blinn, *Me and My (Fake) Shadow*, 1988; the two clips are those that the classic matrix lacks.)
//! With the plane `P = (a, d)`, the height `h(v) = a·v + d` and the light `L = (l, λ)` the matrix
//! `M = (P·L)·I − L·Pᵀ` sends every point along its light ray onto the plane, and divides by
//! `P·L − λ·h(v)`. Points behind the plane (`h ≤ 0`) and points beyond the light (`λ·h ≥ P·L`) arrive on the
//! plane as well; they are no casters and have to be clipped.
//!
//! For a point p of the plane in front of which the light is, the open segment from p to the light properly
//! crosses a face exactly if p lies in the interior of `M·(face ∩ {0 < h, λ·h < P·L})`, and the face is not
//! edge-on to the light.

use glam::{DMat4, DVec3, DVec4};

use super::boxes::Rect;
use super::interval::{Interval, Number};
use super::polygon::clip;
use crate::geom::Light;

/// A plane in space, stored as a unit normal and a point of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plane {
    pub(super) normal: DVec3,
    pub(super) origin: DVec3,
}

/// The matrix `(P·L)·I − L·Pᵀ` of homogeneous coordinates: the flattening onto the plane `P·v = 0` from the
/// light L, exact where the products are.
///
/// ```
/// use glam::DVec4;
/// use umbrage::shadow::planar::flattening;
/// let (ground, light) = (DVec4::new(0.0, 0.0, 1.0, 0.0), DVec4::new(0.0, 0.0, 4.0, 1.0));
/// let shadow = flattening(ground, light) * DVec4::new(1.0, -1.0, 2.0, 1.0);
/// assert_eq!(shadow / shadow.w, DVec4::new(2.0, -2.0, 0.0, 1.0));
/// ```
#[must_use]
pub fn flattening(plane: DVec4, light: DVec4) -> DMat4 {
    let height = plane.dot(light);
    let column = |j: usize| DVec4::AXES[j] * height - light * plane[j];
    DMat4::from_cols(column(0), column(1), column(2), column(3))
}

impl Plane {
    /// The plane `a·x + b·y + c·z + d = 0`; `None` if a, b and c are all zero, or a number is not finite.
    ///
    /// ```
    /// use umbrage::shadow::planar::Plane;
    /// let plane = Plane::new([0.0, 2.0, 0.0, -4.0]).unwrap();
    /// assert_eq!(plane.height([7.0, 5.0, 1.0]), 3.0);
    /// assert_eq!(Plane::new([0.0, 0.0, 0.0, 1.0]), None);
    /// ```
    #[must_use]
    pub fn new([a, b, c, d]: [f64; 4]) -> Option<Self> {
        let direction = DVec3::new(a, b, c);
        let largest = direction.abs().max_element();
        let scaled = direction / largest;
        let normal = scaled / scaled.length();
        let origin = normal * (-d / largest / scaled.length());
        (normal.is_finite() && origin.is_finite()).then_some(Self { normal, origin })
    }

    /// The plane of a face, rounded; `None` for a face without area.
    pub(super) fn of_face(corners: [[f32; 3]; 3]) -> Option<Self> {
        let [a, b, c] = corners.map(|corner| DVec3::from(corner.map(f64::from)));
        Some(Self { normal: (b - a).cross(c - a).try_normalize()?, origin: a })
    }

    /// The distance of a point from the plane: positive on the side of (a, b, c). Rounded.
    #[must_use]
    pub fn height(&self, p: [f32; 3]) -> f64 {
        self.normal.dot(DVec3::from(p.map(f64::from)) - self.origin)
    }

    /// Whether the plane passes through all three corners, as far as `f32` tells: within half a unit in the
    /// last place of each coordinate.
    pub(crate) fn holds(&self, corners: [[f32; 3]; 3]) -> bool {
        corners.iter().all(|&corner| {
            // A coordinate was rounded by at most 2⁻²⁴ of itself; the height takes a few roundings of f64.
            let slack = (0..3).map(|i| {
                let own = f64::from(corner[i]).abs();
                self.normal[i].abs()
                    * (own * (-24_f64).exp2() + (own + self.origin[i].abs()) * (-50_f64).exp2())
            });
            self.height(corner).abs() <= slack.sum()
        })
    }

    pub(super) fn flipped(&self) -> Self {
        Self { normal: -self.normal, ..*self }
    }

    /// The plane with the light in front; `None` if the light is in the plane, or too near to tell.
    pub(super) fn towards(&self, light: &Light) -> Option<Self> {
        [*self, self.flipped()].into_iter().find(|plane| {
            let height = Flattening::<Interval>::new(plane, light).height;
            height.is_positive()
        })
    }

    /// The two coordinates that say where a point of the plane is: all but the one that the normal is nearest
    /// to.
    pub(super) fn axes(&self) -> [usize; 2] {
        let size = self.normal.abs();
        let most = (1..3).fold(0, |best, i| if size[i] > size[best] { i } else { best });
        [(most + 1) % 3, (most + 2) % 3]
    }
}

/// A point's image times its divisor, the divisor, and the point's height: x, y, w, h. All four are affine in
/// the point, and x/w, y/w are coordinates on the plane, from the plane's origin.
pub(super) type Corner<T> = [T; 4];

/// The projection from a light onto a plane, without the translation that a matrix would round away: the
/// light and all points are taken from the plane's origin.
#[derive(Clone, Copy, Debug)]
pub(super) struct Flattening<T> {
    normal: [T; 3],
    origin: [T; 3],
    /// The light's position from the origin, or the direction to it.
    pub(super) light: [T; 3],
    /// `P·L`.
    pub(super) height: T,
    is_directional: bool,
    axes: [usize; 2],
}

impl<T: Number> Flattening<T> {
    pub(super) fn new(plane: &Plane, light: &Light) -> Self {
        let [normal, origin] = [plane.normal, plane.origin].map(|v| v.to_array().map(T::of));
        let mut way = light.xyz().map(|x| T::of(x.into()));
        if !light.is_directional() {
            way = std::array::from_fn(|i| way[i] - origin[i]);
        }
        let height = dot(normal, way);
        let is_directional = light.is_directional();
        Self { normal, origin, light: way, height, is_directional, axes: plane.axes() }
    }

    /// A point, with its image.
    pub(super) fn at(&self, p: [f32; 3]) -> Corner<T> {
        let p: [T; 3] = std::array::from_fn(|i| T::of(p[i].into()) - self.origin[i]);
        let h = dot(self.normal, p);
        let [x, y] = self.axes.map(|axis| p[axis] * self.height - self.light[axis] * h);
        [x, y, if self.is_directional { self.height } else { self.height - h }, h]
    }

    /// The part of a face in front of the plane and before the light. In front of the plane is what is higher
    /// than `−slack`.
    pub(super) fn clipped(&self, corners: [[f32; 3]; 3], slack: f64) -> Vec<Corner<T>> {
        let mut polygon = corners.map(|corner| self.at(corner)).to_vec();
        clip(&mut polygon, |corner| corner[3] + T::of(slack));
        if !self.is_directional {
            clip(&mut polygon, |corner| corner[2]);
        }
        polygon
    }
}

impl Flattening<Interval> {
    /// A rectangle of the plane that contains the image of a clipped polygon.
    pub(super) fn around(polygon: &[Corner<Interval>]) -> Rect {
        let mut rect = Rect::EMPTY;
        for &[x, y, w, _] in polygon {
            let [x, y] = [x, y].map(|it| it.over(w.at_least_zero()));
            rect = rect.join(&Rect { low: [x.low, y.low], high: [x.high, y.high] });
        }
        rect
    }
}

fn dot<T: Number>(a: [T; 3], b: [T; 3]) -> T {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::SplitMix64;

    fn integers(random: &mut SplitMix64) -> DVec4 {
        DVec4::from_array([0; 4].map(|_| random.below(41) as f64 - 20.0))
    }

    /// In integers, where nothing is rounded.
    #[test]
    fn flattening_sends_the_light_to_nothing_and_all_points_along_their_rays_onto_the_plane() {
        let mut random = SplitMix64(5);
        for _ in 0..500 {
            let (plane, light, v) = (integers(&mut random), integers(&mut random), integers(&mut random));
            let matrix = flattening(plane, light);
            assert_eq!(matrix * light, DVec4::ZERO);
            assert_eq!(matrix.transpose() * plane, DVec4::ZERO, "the image lies on the plane");
            assert_eq!(matrix * v, v * plane.dot(light) - light * plane.dot(v));
            // A point of the plane stays: (P·L)·v of what is sent there.
            let there = matrix * v;
            assert_eq!(matrix * there, there * plane.dot(light));
            // The sabotage: the product the other way round.
            let turned = flattening(light, plane);
            assert!(turned == matrix || turned * light != DVec4::ZERO);
        }
    }

    #[test]
    fn flattening_of_a_corner_is_that_of_the_matrix() {
        let plane = Plane::new([0.0, 0.0, 1.0, 0.0]).unwrap();
        for (light, of_matrix) in [
            (Light::point([0.0, 1.0, 4.0]).unwrap(), DVec4::new(0.0, 1.0, 4.0, 1.0)),
            (Light::directional([-1.0, 0.0, -2.0]).unwrap(), DVec4::new(1.0, 0.0, 2.0, 0.0)),
        ] {
            let matrix = flattening(DVec4::new(0.0, 0.0, 1.0, 0.0), of_matrix);
            for p in [[1.0, -1.0, 2.0], [3.0, 2.0, -1.0], [0.5, 0.0, 0.0], [2.0, 1.0, 6.0]] {
                let image = matrix * DVec4::new(p[0].into(), p[1].into(), p[2].into(), 1.0);
                let [x, y, w, h] = Flattening::<f64>::new(&plane, &light).at(p);
                assert_eq!(([x, y, w], h), ([image.x, image.y, image.w], f64::from(p[2])));
            }
        }
    }

    #[test]
    fn plane_holds_a_corner_within_half_a_unit_of_its_last_place() {
        let plane = Plane::new([0.6, 0.8, 0.0, -0.1]).unwrap();
        let on = |x: f32| [x, ((0.1 - 0.6 * f64::from(x)) / 0.8) as f32, 3.0];
        assert!(plane.holds([on(0.3), on(-77.0), on(1e5)]));
        let beside = |x: f32, steps: usize| (0..steps).fold(on(x), |[x, y, z], _| [x, y.next_up(), z]);
        assert!(!plane.holds([on(0.3), on(-77.0), beside(0.3, 4)]));
        assert_eq!(Plane::new([f64::NAN, 0.0, 0.0, 0.0]), None);
        // Numbers whose squares overflow.
        assert!(Plane::new([1e300, 0.0, 0.0, -1e300]).unwrap().holds([[1.0, 5.0, 7.0]; 3]));
    }
}
