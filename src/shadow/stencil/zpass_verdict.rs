//! Whether z-pass counts correctly for all shells together.

use glam::DVec3;

use super::StencilMethod;
use crate::caster::Caster;
use crate::geom::Light;
use crate::oracle::Verdict;
use crate::view::Projection;

/// What is known of z-pass counts for a caster, a light and a camera.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum ZPassVerdict {
    /// Correct: no face can lie between the light and the near rectangle.
    Right,
    /// Wrong: a point of the near rectangle, rounded to `f32`, is in shadow by the exact ray cast. At every
    /// pixel seen through such a point the count is off by the number of faces between it and the light.
    Wrong,
    /// Neither is proven.
    Unknown,
}

/// Points of the near rectangle that are asked, in a row and in a column.
const STEPS: u32 = 9;

/// Whether z-pass counts correctly if all faces of `caster` cast. Builds the ray cast unless the proof
/// succeeds.
///
/// ```
/// use umbrage::caster::Caster;
/// use umbrage::shadow::stencil::{ZPassVerdict, zpass_verdict};
/// use umbrage::testing::shapes;
/// use umbrage::view::{Projection, ProjectionKind};
/// let (right, up, forward) = ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]);
/// let kind = ProjectionKind::InfinitePerspective;
/// let camera = Projection { eye: [0.0, 0.0, 5.0], right, up, forward, near: 0.1, kind };
/// let cube = Caster::new(shapes::cube());
/// assert_eq!(zpass_verdict(&cube, &camera, &"point:0,9,5".parse()?), ZPassVerdict::Right);
/// assert_eq!(zpass_verdict(&cube, &camera, &"point:0,0,-5".parse()?), ZPassVerdict::Wrong);
/// # Ok::<(), umbrage::geom::LightError>(())
/// ```
#[must_use]
pub fn zpass_verdict(caster: &Caster, projection: &Projection, light: &Light) -> ZPassVerdict {
    let methods = caster.shell_boxes().choose(caster.mesh(), projection, light);
    if methods.choices.iter().all(|choice| choice.what == StencilMethod::ZPass) {
        return ZPassVerdict::Right;
    }
    let [corner, right, _, left] = projection.near_corners();
    let step = |i: u32| f64::from(i) / f64::from(STEPS - 1);
    let at = |i, j| corner + step(i) * (right - corner) + step(j) * (left - corner);
    let in_shadow = |p: DVec3| {
        let p: [f32; 3] = p.as_vec3().into();
        p.iter().all(|x| x.is_finite()) && caster.oracle().verdict(p, light) == Verdict::Shadowed
    };
    let mut points = (0..STEPS).flat_map(|i| (0..STEPS).map(move |j| at(i, j)));
    if points.any(in_shadow) { ZPassVerdict::Wrong } else { ZPassVerdict::Unknown }
}
