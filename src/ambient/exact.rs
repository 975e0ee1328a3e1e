//! Ambient occlusion by the analytic form: no samples, no noise.
//!
//! The sky is six lights at infinity, and Lambert's formula measures what the outlines of all faces leave of
//! them ([`crate::oracle::area`]). A receiver lies off its point by nothing at all, in the direction of its
//! normal, or at a hard edge into its own faces: a face through the point hides what is beyond those of its
//! sides that the point is not on. This is the rule of the rays too. A receiver without a normal has no such side, and faces through it hide nothing.

use super::{Ambient, Receiver, Receivers};
use crate::mesh::FaceId;
use crate::oracle::area::{SoftOracle, UnderSky};

/// The openness of receivers, with an error bound.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Exact {
    /// See [`Ambient::openness`]; one value each, in their order.
    pub openness: Vec<f64>,
    /// No value differs from the truth by more than this.
    pub bound: f64,
}

/// Works out how much of the sky no face hides from each receiver, on several threads if the feature
/// `parallel` is on. `soft` is over the same meshes as the receivers; more meshes may follow. `progress` is
/// called with the number of further receivers that are done, from any thread.
///
/// Time: about 0.1 µs per receiver and face above its horizon.
///
/// ```
/// use umbrage::ambient::{Per, Receivers, exact};
/// use umbrage::oracle::area::SoftOracle;
/// use umbrage::testing::shapes;
/// let torus = shapes::torus(24, 12, 2.0, 0.7);
/// let receivers = Receivers::of(&[&torus], Per::Vertex);
/// let found = exact(&SoftOracle::build(&torus), &receivers, &|_| {});
/// // Nothing hides anything from the outermost point, and the hole is darker.
/// let x = |index: usize| receivers.list()[index].point[0].abs();
/// let farthest = (0..found.openness.len()).max_by(|&a, &b| x(a).total_cmp(&x(b))).unwrap();
/// assert!((found.openness[farthest] - 1.0).abs() <= found.bound && found.bound < 1e-9);
/// assert!(found.openness.iter().any(|&open| open < 0.9));
/// ```
#[must_use]
pub fn exact(soft: &SoftOracle<'_>, receivers: &Receivers, progress: &(dyn Fn(u64) + Sync)) -> Exact {
    let faces = receivers.faces();
    let under_sky = |(index, receiver)| {
        let &Receiver { point, normal, ref face } = receiver;
        let own: &[FaceId] = face.as_ref().map_or(faces.of(index), std::slice::from_ref);
        let off = normal.map_or([0.0; 3], |normal| receivers.off(index, normal));
        UnderSky { point, normal, own, is_middle: face.is_some(), off }
    };
    let list: Vec<UnderSky<'_>> = receivers.list().iter().enumerate().map(under_sky).collect();
    let found = soft.open_sky(&list, progress);
    Exact {
        bound: found.iter().fold(0.0, |most, open| open.bound.max(most)),
        openness: found.into_iter().map(|open| open.share).collect(),
    }
}

impl From<Exact> for Ambient {
    /// Rounded, and without the bound.
    fn from(found: Exact) -> Self {
        let openness = found.openness.into_iter().map(|open| open as f32).collect();
        Self { openness, ..Self::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ambient::{Effort, Per, RayOptions, Ring};
    use crate::mesh::Mesh;
    use crate::testing::shapes;

    const RAYS: u32 = 1024;

    /// The largest difference between the analytic form and rays, over some receivers.
    fn apart(mesh: &Mesh, per: Per, moved: f32) -> f64 {
        let all = Receivers::of(&[mesh], per);
        let some = all.only(&all.spread(12));
        let soft = SoftOracle::build(mesh);
        let options = RayOptions { effort: Effort::Rays(RAYS), ring: Ring::Off, ..RayOptions::default() };
        let (rays, _) = Ambient::by_rays(soft.oracle(), &some, &options, &|_| {});
        let mut others = some.clone();
        for Receiver { point, normal, .. } in &mut others.list {
            let normal = normal.unwrap_or_default();
            *point = std::array::from_fn(|i| point[i] + moved * normal[i]);
        }
        let found = exact(&soft, &others, &|_| {});
        assert!(found.bound < 1e-9, "{}", found.bound);
        let differences = found.openness.iter().zip(&rays.openness);
        differences.map(|(exact, rays)| (exact - f64::from(*rays)).abs()).fold(0.0, f64::max)
    }

    #[test]
    fn analytic_openness_agrees_with_rays_on_open_non_manifold_and_doubled_meshes() {
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
                let apart = apart(mesh, per, 0.0);
                assert!(apart < within, "{} per {per:?}: {apart}", mesh.name);
            }
        }
        // The sabotage: receivers that are moved off the surface.
        assert!(apart(&meshes[0], Per::Corner, 0.2) > within);
    }
}
