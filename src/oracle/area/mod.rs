//! How much of a light with an extent a point sees: the analytic fraction, with its error bound, and a judge
//! by exact rays beside it.
//!
//! The outline of everything between the receiver and the light is projected onto the light (`chain.rs`), and
//! a sweep measures what it winds around (`sweep.rs`, `measure.rs`, `form.rs`). A point of the light is
//! hidden if and only if the winding number around it is not 0, for any mesh: open, non-manifold, with
//! duplicate faces. Sides of faces are exact, so that faces seen edge-on, and those of which the receiver is
//! a corner, hide nothing. [`SoftOracle::sampled`] shares no code with this but the sign of a determinant.

mod batch;
mod bent;
mod chain;
mod fault;
mod form;
mod frame;
mod light;
mod measure;
mod polygon;
mod pyramid;
mod sample;
mod sky;
mod sweep;
#[cfg(test)]
mod closed_tests;
#[cfg(test)]
mod judge_tests;
#[cfg(test)]
mod rational_tests;
#[cfg(test)]
mod sky_tests;

use std::borrow::Cow;

use multiversion::multiversion;

pub use light::{AreaLight, AreaLightError};
pub use sample::Sampled;

use self::chain::Chain;
use self::form::{Form, horizon};
use self::frame::{EPSILON, wide};
use self::light::Shape;
use self::measure::{Area, outline_edges};
use self::pyramid::{Flat, Pyramid};
pub(crate) use self::sky::{HardEdges, Open, UnderSky};
use self::sweep::{AtLeft, Kind, Sink, Sweep, Trapezoid};
use super::Oracle;
use crate::mesh::{Mesh, Weld, weld};

/// A point that light may reach.
///
/// ```
/// use umbrage::oracle::area::Receiver;
/// let receiver: Receiver = [0.0, 1.0, 2.0].into();
/// assert_eq!(Receiver::facing([0.0, 1.0, 2.0], [0.0, 0.0, 1.0]).point, receiver.point);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Receiver {
    /// The point.
    pub point: [f32; 3],
    /// The normal of its surface, of any length; asks for [`Visible::form`].
    pub normal: Option<[f32; 3]>,
}

impl Receiver {
    /// A point of a surface with this normal.
    #[must_use]
    pub fn facing(point: [f32; 3], normal: [f32; 3]) -> Self {
        Self { point, normal: Some(normal) }
    }
}

impl From<[f32; 3]> for Receiver {
    fn from(point: [f32; 3]) -> Self {
        Self { point, normal: None }
    }
}

/// How much of a light a point sees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Visible {
    /// The visible share of the light's area, 0 to 1.
    pub fraction: f64,
    /// The true share differs from [`Visible::fraction`] by no more than this.
    pub bound: f64,
    /// The irradiance of the receiver, over π times the radiance of the light: ∫ cos θ dω / π over what is
    /// visible and above the receiver's horizon. `None` if no normal was given.
    pub form: Option<f64>,
    /// Faces that may hide part of the light.
    pub faces: u32,
    /// Their edges that no other of these faces cancels.
    pub edges: u32,
}

/// The exact ray cast, extended to lights with an area. Besides the [`Oracle`] it holds 12 bytes per face.
///
/// ```
/// use umbrage::oracle::area::{AreaLight, SoftOracle};
/// use umbrage::testing::shapes;
/// let soft = SoftOracle::build(&shapes::cuboid([0.0, -1.0, 2.0], [9.0, 1.0, 2.5]));
/// // The light is 2 wide and 4 above the point, and the lower edge of the cuboid halves it.
/// let light = AreaLight::parallelogram([-1.0, -1.0, 4.0], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0])?;
/// let seen = soft.visible([0.0; 3], &light).expect("the point is not in the plane of the light");
/// assert!((seen.fraction - 0.5).abs() <= seen.bound && seen.bound < 1e-12);
/// # Ok::<(), umbrage::oracle::area::AreaLightError>(())
/// ```
#[derive(Clone, Debug)]
pub struct SoftOracle<'a> {
    oracle: Cow<'a, Oracle>,
    /// Vertices after an exact weld over all meshes, in the order of the oracle's slots.
    corners: Vec<[u32; 3]>,
    #[cfg(test)]
    faults: fault::Faults,
}

/// Buffers of a query.
#[derive(Debug, Default)]
struct Scratch {
    chain: Chain,
    sweep: Sweep,
}

impl SoftOracle<'static> {
    /// Builds an [`Oracle`] of its own over `mesh`, and the table of welded corners.
    #[must_use]
    pub fn build(mesh: &Mesh) -> Self {
        Self::over(&[mesh])
    }

    /// The same over several meshes; see [`Oracle::over`].
    ///
    /// # Panics
    ///
    /// As [`Oracle::over`].
    #[must_use]
    pub fn over(meshes: &[&Mesh]) -> Self {
        Self::with(Cow::Owned(Oracle::over(meshes)))
    }
}

impl<'a> SoftOracle<'a> {
    /// Over the faces of a ray caster that there is already. Time: that of an exact weld of all corners.
    #[must_use]
    pub fn new(oracle: &'a Oracle) -> Self {
        Self::with(Cow::Borrowed(oracle))
    }

    fn with(oracle: Cow<'a, Oracle>) -> Self {
        let corners = welded(&oracle.triangles, |x| x);
        Self {
            oracle,
            corners,
            #[cfg(test)]
            faults: fault::Faults::default(),
        }
    }

    /// The ray caster.
    #[must_use]
    pub fn oracle(&self) -> &Oracle {
        &self.oracle
    }

    /// Memory besides that of the ray caster, in bytes.
    #[must_use]
    pub fn bytes(&self) -> usize {
        size_of_val(&*self.corners)
    }

    /// How much of `light` is visible from a point, and with a normal also how strongly it lights the
    /// surface. `None` if nothing can be told: the point lies exactly in the plane of the light, where the
    /// light has no extent, or is the center of a disk that faces its receiver, or is not finite.
    ///
    /// Cost: about 0.2 µs if no face is near the pyramid between point and light, otherwise about 5 µs, and
    /// 0.2 µs per face of the answer.
    #[must_use]
    pub fn visible(&self, receiver: impl Into<Receiver>, light: &AreaLight) -> Option<Visible> {
        self.visible_with(receiver.into(), light, &mut Scratch::default())
    }

    fn visible_with(&self, receiver: Receiver, light: &AreaLight, scratch: &mut Scratch) -> Option<Visible> {
        let p = receiver.point;
        if p.iter().any(|x| !x.is_finite()) {
            return None;
        }
        let (frame, shape) = light.seen_from(p)?;
        let reach = self.oracle.tree.reach(p);
        let pyramid = match Pyramid::new(frame, p, reach) {
            Ok(pyramid) => pyramid,
            Err(Flat::EdgeOn) => return None,
            Err(Flat::Unresolved) => {
                let form = receiver.normal.map(|_| 0.0);
                return Some(Visible { fraction: 0.5, bound: 0.5, form, faces: 0, edges: 0 });
            }
        };
        let Scratch { chain, sweep } = scratch;
        chain.clear();
        #[cfg(test)]
        {
            chain.faults = self.faults;
        }
        gather(self, &pyramid, reach, chain);
        let (faces, normal) = (chain.faces, receiver.normal.map(|normal| wide(normal).normalize_or_zero()));
        if faces == 0 && normal.is_none() {
            return Some(Visible {
                fraction: 1.0,
                bound: pyramid.least_error() / light.share,
                form: None,
                faces,
                edges: 0,
            });
        }
        chain.project(&pyramid);
        let mut at_left = AtLeft { chain: chain.at_left, light: 1, horizon: 0 };
        if let Shape::Polygon(outline) = shape {
            chain.edges.extend(outline_edges(outline, Kind::Light));
            at_left.light = 0;
        }
        if let Some(normal) = normal {
            at_left.horizon = i32::from(horizon(&pyramid, normal, &mut chain.edges));
        }
        let form = normal.map(|normal| Form::new(&pyramid, normal, *shape == Shape::Disk));
        let mut measures = Measures { area: Area::new(shape), form };
        sweep.run(&mut chain.edges, &mut chain.left, at_left, chain.faults, &mut measures);
        let Measures { area, form } = measures;
        let doubtful = if chain.doubtful { 1.0 } else { 0.0 };
        let error = pyramid.least_error() + chain.moved + sweep.lost + area.error + 2.0 * EPSILON;
        Some(Visible {
            fraction: (1.0 - area.total() / light.share).clamp(0.0, 1.0),
            bound: (error / light.share + 8.0 * frame.rounding + doubtful).min(1.0),
            form: form.map(|form| form.total()),
            faces,
            edges: chain.outlines,
        })
    }
}

struct Measures<'a> {
    area: Area,
    form: Option<Form<'a>>,
}

impl Sink for Measures<'_> {
    fn covered(&mut self, part: Trapezoid) {
        self.area.add(part);
    }

    fn visible(&mut self, part: Trapezoid) {
        if let Some(form) = &mut self.form {
            form.add(part);
        }
    }
}

/// The corners of all triangles as ids: equal exactly where positions are, after `rounded`.
fn welded(triangles: &[[[f32; 3]; 3]], rounded: impl Fn([f32; 3]) -> [f32; 3]) -> Vec<[u32; 3]> {
    let positions = triangles.iter().flatten().map(|&x| rounded(x)).collect();
    let faces = (0..triangles.len() as u32).map(|face| [3 * face, 3 * face + 1, 3 * face + 2]).collect();
    // The oracle holds no more faces than a mesh, with finite corners.
    let soup = Mesh::new(positions, faces).expect("these are the corners of meshes");
    weld(&soup, Weld::Exact).mesh.triangles().to_vec()
}

/// The traversal, with AVX2 instructions where the processor has them.
#[multiversion(targets("x86_64+avx2+bmi1+bmi2+lzcnt"))]
fn gather(soft: &SoftOracle<'_>, pyramid: &Pyramid, reach: [f64; 3], chain: &mut Chain) {
    let (sides, count) = pyramid.sides(reach);
    soft.oracle.tree.walk_within(pyramid.p, reach, &sides[..count], |slot| {
        chain.add(pyramid, soft.oracle.triangles[slot], soft.corners[slot]);
    });
}
