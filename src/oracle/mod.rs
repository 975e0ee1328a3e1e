//! The exact ray cast: what lies between a point and a light.
//!
//! A tree finds the faces that the way to the light may meet; five orientation signs decide each of them
//! (`meet.rs`). Signs on shared edges are antisymmetric, so no ray slips between two triangles, and what is
//! only touched is declared, not guessed.

mod meet;
#[cfg(feature = "reference")]
mod reference;
mod visible;

pub use meet::{Meeting, meet};
#[cfg(feature = "reference")]
pub use reference::{Reference, reference};
#[cfg(feature = "reference")]
pub(crate) use reference::{WholeLight, WholePlane};
pub use visible::Visible;

use crate::geom::bvh::Bvh;
use crate::geom::{Aabb, Light, Segment};
use crate::mesh::{FaceId, Mesh};
use crate::silhouette::Facing;

/// What is true of a point and a light.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Verdict {
    /// The open segment to the light does not even touch the closed surface.
    Lit,
    /// The open segment to the light properly crosses a face.
    Shadowed,
    /// It touches the surface without properly crossing a face: both answers are right.
    Grazing,
}

/// How often the open segment from a point to a light meets the faces.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Crossings {
    /// Faces crossed that have the light in front of them.
    pub front: u32,
    /// Faces crossed that have the light behind them.
    pub back: u32,
    /// Faces that are touched: at an edge, at a corner, or along their plane.
    pub touching: u32,
}

impl Crossings {
    /// What the counts mean for the point.
    #[must_use]
    pub fn verdict(&self) -> Verdict {
        if self.front + self.back > 0 {
            Verdict::Shadowed
        } else if self.touching > 0 {
            Verdict::Grazing
        } else {
            Verdict::Lit
        }
    }
}

/// The first face along a ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Which face.
    pub face: FaceId,
    /// How far, in lengths of the ray's direction. Rounded: for drawing, not for deciding.
    pub t: f64,
}

/// The faces of a mesh in a tree, ready for exact queries. Owns what it needs: about 100 bytes a face.
#[derive(Clone, Debug)]
pub struct Oracle {
    tree: Bvh,
    /// Corners in the order of the tree's leaves.
    triangles: Vec<[[f32; 3]; 3]>,
}

impl Oracle {
    /// Builds the tree over all faces of `mesh`. Those without area cannot be crossed, only touched. About 300 ns
    /// a face. Memory: 104 bytes a face, 128 at its peak.
    #[must_use]
    pub fn build(mesh: &Mesh) -> Self {
        let corners = |face: &[u32; 3]| face.map(|vertex| mesh.positions()[vertex as usize]);
        let boxes: Vec<Aabb> = mesh.triangles().iter().map(|face| Aabb::around(corners(face))).collect();
        let tree = Bvh::build(&boxes);
        let triangles = tree.order().iter().map(|&face| corners(&mesh.triangles()[face as usize])).collect();
        Self { tree, triangles }
    }

    /// Whether `p` is in shadow. Stops at the first face that is properly crossed.
    ///
    /// ```
    /// use umbrage::{geom::Light, mesh::solid, oracle::{Oracle, Verdict}};
    /// let oracle = Oracle::build(&solid::cube());
    /// let light = Light::point([0.1, 0.2, 5.0])?;
    /// assert_eq!(oracle.verdict([0.3, 0.1, -4.0], &light), Verdict::Shadowed);
    /// assert_eq!(oracle.verdict([3.0, 0.0, 0.0], &light), Verdict::Lit);
    /// # Ok::<(), umbrage::geom::LightError>(())
    /// ```
    #[must_use]
    pub fn verdict(&self, p: [f32; 3], light: &Light) -> Verdict {
        let segment = Segment::to_light(p, light);
        let mut verdict = Verdict::Lit;
        self.tree.walk(
            |aabb| segment.may_meet(aabb),
            |slot| match meet(p, light, self.triangles[slot]) {
                Meeting::None => true,
                Meeting::Touching => {
                    verdict = Verdict::Grazing;
                    true
                }
                Meeting::Crossing(_) => {
                    verdict = Verdict::Shadowed;
                    false
                }
            },
        );
        verdict
    }

    /// All faces between `p` and `light`, counted by side.
    #[must_use]
    pub fn crossings(&self, p: [f32; 3], light: &Light) -> Crossings {
        let mut crossings = Crossings::default();
        self.for_each_meeting(p, light, |_, meeting| match meeting {
            Meeting::Crossing(Facing::Front) => crossings.front += 1,
            Meeting::Crossing(_) => crossings.back += 1,
            _ => crossings.touching += 1,
        });
        crossings
    }

    /// Visits every face that the open segment from `p` to `light` crosses or touches.
    pub fn for_each_meeting(&self, p: [f32; 3], light: &Light, mut visit: impl FnMut(FaceId, Meeting)) {
        let segment = Segment::to_light(p, light);
        self.tree.walk(
            |aabb| segment.may_meet(aabb),
            |slot| {
                let meeting = meet(p, light, self.triangles[slot]);
                if meeting != Meeting::None {
                    visit(FaceId(self.tree.order()[slot]), meeting);
                }
                true
            },
        );
    }

    /// The tree, and the corners of the faces in the order of its leaves.
    #[cfg(feature = "reference")]
    pub(crate) fn parts(&self) -> (&Bvh, &[[[f32; 3]; 3]]) {
        (&self.tree, &self.triangles)
    }

    /// The box around all faces.
    #[must_use]
    pub fn bounds(&self) -> Aabb {
        self.tree.bounds()
    }
}
