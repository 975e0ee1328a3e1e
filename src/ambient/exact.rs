//! Ambient occlusion by the analytic form: no samples, no noise.
//!
//! The sky is six lights at infinity, and Lambert's formula measures what the outlines of all faces leave of
//! them ([`crate::oracle::area`]). A receiver lies off its point by nothing at all, in the direction of its
//! normal: a face through the point hides what is beyond those of its sides that the point is not on. This is
//! the rule of the rays too. A receiver without a normal has no such side, and faces through it hide nothing.

use std::ops::Range;

use super::{Ambient, Receiver, Receivers};
use crate::oracle::area::{HardEdges, Open, SoftOracle, UnderSky};

/// The openness of receivers, with an error bound.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Exact {
    /// See [`Ambient::openness`]; one value each, in their order.
    pub openness: Vec<f64>,
    /// No value differs from the truth by more than this.
    pub bound: f64,
    /// See [`Ambient::bent`]; only from [`exact_bent_part`]. Before it gets the length 1 a direction has the
    /// length 2/3 if nothing is hidden, and is off by no more than the bound; what is shorter than the bound
    /// is 0.
    pub bent: Option<Vec<[f32; 3]>>,
}

/// Works out how much of the sky no face hides from each receiver, on several threads if the feature
/// `parallel` is on. About 0.1 µs per receiver and face above its horizon.
///
/// ```
/// use umbrage::ambient::{Receiver, exact};
/// use umbrage::oracle::area::SoftOracle;
/// use umbrage::testing::shapes;
/// // Below the middle of a long wall's foot, half of the sky is left.
/// let wall = SoftOracle::build(&shapes::cuboid([1.0, -1e6, 0.0], [2.0, 1e6, 1e6]));
/// let receiver = Receiver { point: [0.0; 3], normal: Some([0.0, 0.0, 1.0]), face: None };
/// let found = exact(&wall, &[receiver]);
/// assert!((found.openness[0] - 0.5).abs() < 1e-6 && found.bound < 1e-6);
/// ```
#[must_use]
pub fn exact(soft: &SoftOracle<'_>, receivers: &[Receiver]) -> Exact {
    measured(soft, receivers, HardEdges { off: &|_| None, is_own: &|_, _| false }, false)
}

/// As [`exact`], for a part of receivers that know their faces: at a hard edge, each is on its own side of
/// walls that contain its normal, as it is for rays.
///
/// # Panics
///
/// Panics if there are no such receivers.
///
/// ```
/// use umbrage::ambient::{Per, Receivers, exact_part};
/// use umbrage::oracle::area::SoftOracle;
/// use umbrage::testing::shapes;
/// let room = shapes::inside_out(&shapes::cube());
/// let receivers = Receivers::of(&[&room], Per::Corner);
/// let found = exact_part(&SoftOracle::build(&room), &receivers, 3..9);
/// assert!(found.openness.iter().all(|&open| open < 1e-12));
/// ```
#[must_use]
pub fn exact_part(soft: &SoftOracle<'_>, receivers: &Receivers, part: Range<usize>) -> Exact {
    part_measured(soft, receivers, part, false)
}

/// [`exact_part`], with the bent normals: the mean open directions, in closed form too.
///
/// # Panics
///
/// Panics if there are no such receivers.
///
/// ```
/// use umbrage::ambient::{Per, Receivers, exact_bent_part};
/// use umbrage::oracle::area::SoftOracle;
/// use umbrage::testing::shapes;
/// let cube = shapes::cube();
/// let receivers = Receivers::of(&[&cube], Per::Face);
/// let found = exact_bent_part(&SoftOracle::build(&cube), &receivers, 0..12);
/// // Nothing is hidden, so that the mean direction is the normal.
/// for (bent, receiver) in found.bent.unwrap().iter().zip(receivers.list()) {
///     let normal = receiver.normal.unwrap();
///     assert!((0..3).all(|i| (bent[i] - normal[i]).abs() < 1e-6));
/// }
/// ```
#[must_use]
pub fn exact_bent_part(soft: &SoftOracle<'_>, receivers: &Receivers, part: Range<usize>) -> Exact {
    part_measured(soft, receivers, part, true)
}

fn part_measured(soft: &SoftOracle<'_>, receivers: &Receivers, part: Range<usize>, bent: bool) -> Exact {
    let (first, sides) = (part.start, &receivers.sides);
    let off = |index: usize| {
        let normal = receivers.list[first + index].normal?;
        Some(sides.off(first + index, normal)).filter(|&off| off != normal)
    };
    let is_own = |index: usize, face| sides.is_own(first + index, face);
    measured(soft, &receivers.list[part], HardEdges { off: &off, is_own: &is_own }, bent)
}

fn measured(soft: &SoftOracle<'_>, receivers: &[Receiver], edges: HardEdges<'_>, bent: bool) -> Exact {
    let under_sky = |&Receiver { point, normal, face }: &Receiver| UnderSky { point, normal, face };
    let receivers: Vec<UnderSky> = receivers.iter().map(under_sky).collect();
    let found = soft.open_sky(&receivers, edges, bent);
    let direction = |open: &Open| match open.bent {
        bent if bent.length() <= open.bound => [0.0; 3],
        bent => bent.normalize_or_zero().to_array().map(|x| x as f32),
    };
    Exact {
        bound: found.iter().fold(0.0, |most, open| open.bound.max(most)),
        bent: bent.then(|| found.iter().map(direction).collect()),
        openness: found.into_iter().map(|open| open.share).collect(),
    }
}

impl From<Exact> for Ambient {
    /// Rounded, and without the bound.
    fn from(found: Exact) -> Self {
        let openness = found.openness.into_iter().map(|open| open as f32).collect();
        Self { openness, bent: found.bent, ..Self::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ambient::{Effort, Per, RayOptions, Ring};
    use crate::mesh::Mesh;
    use crate::testing::shapes;

    const RAYS: u32 = 1024;

    /// The largest difference between the analytic form and rays, over some receivers. With `is_off` the
    /// analytic form is asked about points off the surface.
    fn apart(mesh: &Mesh, per: Per, is_off: bool) -> f64 {
        let all = Receivers::of(&[mesh], per);
        let some = all.only(&all.spread(12));
        let soft = SoftOracle::build(mesh);
        let options = RayOptions { effort: Effort::Rays(RAYS), ring: Ring::Off, ..RayOptions::default() };
        let (rays, _) = Ambient::by_rays(soft.oracle(), &some, &options, &|_| {});
        let moved = |receiver: &Receiver| {
            let normal = receiver.normal.unwrap_or_default();
            let point = std::array::from_fn(|i| receiver.point[i] + 0.2 * normal[i]);
            Receiver { point, ..*receiver }
        };
        let found = match is_off {
            true => exact(&soft, &some.list().iter().map(moved).collect::<Vec<_>>()),
            false => exact_part(&soft, &some, 0..some.list().len()),
        };
        assert!(found.bound < 1e-9, "{}", found.bound);
        let differences = found.openness.iter().zip(&rays.openness);
        differences.map(|(exact, rays)| (exact - f64::from(*rays)).abs()).fold(0.0, f64::max)
    }

    #[test]
    fn analytic_openness_agrees_with_rays_on_open_non_manifold_and_doubled_meshes() {
        // Six times the error that rays have been measured to have.
        let within = 6.0 * 0.4 * f64::from(RAYS).powf(-0.75);
        let meshes = [
            shapes::book(5),
            shapes::mobius(14),
            shapes::double_sheet(),
            shapes::cubes_sharing_edge(),
            shapes::nested_cubes(2),
            shapes::t_junction(),
            shapes::duplicated_face(),
            shapes::open_cube(),
            shapes::inside_out(&shapes::torus(12, 8, 2.0, 0.7)),
        ];
        for mesh in &meshes {
            for per in [Per::Vertex, Per::Corner, Per::Face] {
                let apart = apart(mesh, per, false);
                assert!(apart < within, "{} per {per:?}: {apart}", mesh.name);
            }
        }
        // The sabotage: receivers that are moved off the surface.
        assert!(apart(&meshes[0], Per::Corner, true) > within);
    }

    #[test]
    fn analytic_bent_normals_agree_with_those_of_rays() {
        let mut leaning = 0;
        for mesh in &[shapes::book(5), shapes::menger_sponge(1), shapes::mobius(14)] {
            let all = Receivers::of(&[mesh], Per::Corner);
            let some = all.only(&all.spread(12));
            let soft = SoftOracle::build(mesh);
            let options = RayOptions {
                effort: Effort::Rays(4096),
                ring: Ring::Off,
                bent: true,
                ..RayOptions::default()
            };
            let (rays, _) = Ambient::by_rays(soft.oracle(), &some, &options, &|_| {});
            let found = exact_bent_part(&soft, &some, 0..some.list().len());
            let (bent, of_rays) = (found.bent.unwrap(), rays.bent.unwrap());
            for (index, (bent, of_rays)) in bent.iter().zip(&of_rays).enumerate() {
                // The mean direction of little has little certainty.
                if found.openness[index] < 0.05 {
                    continue;
                }
                let apart: f64 = (0..3).map(|i| f64::from(bent[i] - of_rays[i]).powi(2)).sum();
                assert!(apart.sqrt() < 0.02, "{}, {index}: {bent:?} {of_rays:?}", mesh.name);
                // The sabotages: the direction to what hides, and the normal itself.
                let normal = some.list()[index].normal.unwrap_or(*bent);
                let along: f32 = (0..3).map(|i| bent[i] * normal[i]).sum();
                assert!(along > 0.0);
                leaning += usize::from(along < 0.99);
            }
        }
        assert!(leaning > 5, "{leaning} directions lean");
    }
}
