//! Exact ray casting: which faces lie between a point and a light.
//!
//! A conservative `f32` BVH traversal collects the triangles that the shadow ray may hit. Five orientation
//! signs decide each triangle: a filter for all five signs (`segment_filter.rs`), or exact predicates one by
//! one where the filter is not certain (`segment_triangle.rs`). Signs on shared edges are antisymmetric, so
//! no ray slips between two triangles. A ray that only touches the surface is reported as such, never
//! guessed.

pub mod area;
mod batch;
mod expected;
mod fault;
mod from_surface;
mod margin;
mod primary_hit;
pub(crate) mod segment_filter;
mod segment_triangle;
#[cfg(test)]
mod tests;

pub(crate) use batch::Curve;
pub use expected::ExpectedHits;
pub(crate) use from_surface::sorted_corners;
pub use primary_hit::PrimaryHit;
pub use segment_triangle::{Intersection, intersect};

use multiversion::multiversion;

use crate::built::{self, Part};
use crate::geom::bvh::{Bvh, Step, WideBvh};
use crate::geom::predicate::{Homogeneous, Sign, side_of_light};
use crate::geom::{Aabb, Facing, Light};
use crate::mesh::{FaceId, MAX_TRIANGLES, Mesh};
use crate::oracle::segment_filter::{Outcome, SegmentFilter};

/// Visibility of a light from a point, decided exactly.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Verdict {
    /// The open segment to the light does not touch the closed surface.
    Lit,
    /// The open segment to the light properly crosses a face.
    Shadowed,
    /// The open segment to the light touches the surface without properly crossing a face: both answers are
    /// right.
    Grazing,
}

/// Number of faces that the open segment from a point to a light crosses or touches.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Crossings {
    /// Faces crossed whose front side the light is on.
    pub front: u32,
    /// Faces crossed whose back side the light is on.
    pub back: u32,
    /// Faces touched: at an edge, at a corner, or along their plane.
    pub touching: u32,
}

impl Crossings {
    /// The verdict that follows from the counts.
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

/// First face along a ray; see [`Oracle::first_hit`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// The face.
    pub face: FaceId,
    /// Distance, in lengths of the ray's direction. Rounded: for drawing, not for deciding.
    pub t: f64,
}

/// Ray caster over the faces of one or several meshes, with exact answers. Owns its data: about 50 bytes per
/// face, 8 of them the BVH.
#[derive(Clone, Debug)]
pub struct Oracle {
    pub(crate) tree: WideBvh,
    /// Face ids in the order of the BVH leaves.
    order: Vec<u32>,
    /// First face id of each mesh, then the number of all faces.
    first_faces: Vec<u32>,
    /// Corner positions in the order of the BVH leaves.
    pub(crate) triangles: Vec<[[f32; 3]; 3]>,
}

impl Oracle {
    /// Builds the BVH over all faces of `mesh`. Faces without area cannot be crossed, only touched. About 400
    /// ns per face. Peak memory: 128 bytes per face.
    #[must_use]
    pub fn build(mesh: &Mesh) -> Self {
        built::note(Part::Oracle, mesh);
        Self::over(&[mesh])
    }

    /// Builds one BVH over the faces of several meshes. Faces are numbered mesh after mesh;
    /// [`Oracle::mesh_face`] converts a number to a mesh and a face. Time and memory are those of
    /// [`Oracle::build`].
    ///
    /// # Panics
    ///
    /// Panics if the meshes together have more than [`MAX_TRIANGLES`] faces.
    ///
    /// ```
    /// use umbrage::geom::Light;
    /// use umbrage::mesh::FaceId;
    /// use umbrage::oracle::{Oracle, Verdict};
    /// use umbrage::testing::shapes;
    /// let roof = shapes::translated(&shapes::cube(), [0.0, 5.0, 0.0]);
    /// let oracle = Oracle::over(&[&shapes::cube(), &roof]);
    /// let light = Light::directional([0.1, -1.0, 0.2])?;
    /// assert_eq!(oracle.verdict([0.1, 2.0, 0.1], &light), Verdict::Shadowed);
    /// assert_eq!(oracle.mesh_face(FaceId(14)), (1, FaceId(2)));
    /// # Ok::<(), umbrage::geom::LightError>(())
    /// ```
    #[must_use]
    pub fn over(meshes: &[&Mesh]) -> Self {
        let faces = meshes.iter().map(|mesh| mesh.face_count()).sum::<usize>();
        assert!(faces <= MAX_TRIANGLES, "{faces} faces; at most {MAX_TRIANGLES} fit");
        let mut first_faces = vec![0];
        for mesh in meshes {
            first_faces.push(first_faces[first_faces.len() - 1] + mesh.face_count() as u32); // the sum fits
        }
        let mut boxes = Vec::with_capacity(faces);
        for mesh in meshes {
            boxes.extend((0..mesh.face_count()).map(|face| Aabb::around(mesh.corners(FaceId::new(face)))));
        }
        let binary = Bvh::build(&boxes);
        drop(boxes);
        let (tree, order) = binary.into_wide();
        let corners = |&face: &u32| {
            let (mesh, face) = split(&first_faces, face);
            meshes[mesh].corners(FaceId(face))
        };
        let triangles = order.iter().map(corners).collect();
        Self { tree, order, first_faces, triangles }
    }

    /// The mesh of a face, as its index in [`Oracle::over`], and the id of the face in that mesh.
    ///
    /// # Panics
    ///
    /// Panics if there is no such face.
    #[must_use]
    pub fn mesh_face(&self, face: FaceId) -> (usize, FaceId) {
        assert!(face.0 < self.first_faces[self.first_faces.len() - 1], "there is no face {}", face.0);
        let (mesh, face) = split(&self.first_faces, face.0);
        (mesh, FaceId(face))
    }

    /// Whether `p` is in shadow. Stops at the first face that the segment properly crosses.
    ///
    /// ```
    /// use umbrage::geom::Light;
    /// use umbrage::testing::shapes;
    /// use umbrage::oracle::{Oracle, Verdict};
    /// let oracle = Oracle::build(&shapes::cube());
    /// let light = Light::point([0.1, 0.2, 5.0])?;
    /// assert_eq!(oracle.verdict([0.3, 0.1, -4.0], &light), Verdict::Shadowed);
    /// assert_eq!(oracle.verdict([3.0, 0.0, 0.0], &light), Verdict::Lit);
    /// # Ok::<(), umbrage::geom::LightError>(())
    /// ```
    #[must_use]
    pub fn verdict(&self, p: [f32; 3], light: &Light) -> Verdict {
        verdict(self, p, light)
    }

    /// The verdict, testing the face in slot `first` before all others. If another face is found to be
    /// crossed, `first` is set to its slot.
    #[inline(always)]
    fn verdict_trying(&self, p: [f32; 3], light: &Light, first: &mut usize) -> Verdict {
        let way = self.way(p, light);
        if self.triangles.get(*first).is_some_and(|face| matches!(way.passes(face), Outcome::Crossed(_))) {
            return Verdict::Shadowed;
        }
        let mut verdict = Verdict::Lit;
        self.meetings::<false>(p, light, &way, |slot, meeting| match meeting {
            Intersection::Crossing(_) => {
                *first = slot;
                verdict = Verdict::Shadowed;
                Step::Stop
            }
            _ => {
                verdict = Verdict::Grazing;
                Step::On
            }
        });
        verdict
    }

    /// Calls `visit` with the slot of every face that the segment meets, until `visit` stops the traversal;
    /// `NEAREST` is as in [`WideBvh::walk`].
    #[inline(always)]
    fn meetings<const NEAREST: bool>(
        &self,
        p: [f32; 3],
        light: &Light,
        way: &SegmentFilter,
        visit: impl FnMut(usize, Intersection) -> Step,
    ) {
        self.meetings_to::<NEAREST>(p, light, way, None, visit);
    }

    /// As [`Oracle::meetings`], but no farther than a parameter of the segment from the start.
    #[inline(always)]
    fn meetings_to<const NEAREST: bool>(
        &self,
        p: [f32; 3],
        light: &Light,
        way: &SegmentFilter,
        end: Option<f64>,
        mut visit: impl FnMut(usize, Intersection) -> Step,
    ) {
        self.tree.walk_to::<NEAREST>(p, light, end, |slot| match self.meeting(p, light, way, slot) {
            Intersection::None => Step::On,
            meeting => visit(slot, meeting),
        });
    }

    /// How the segment meets the face in a slot.
    #[inline(always)]
    fn meeting(&self, p: [f32; 3], light: &Light, way: &SegmentFilter, slot: usize) -> Intersection {
        let triangle = &self.triangles[slot];
        match way.passes(triangle) {
            Outcome::Missed => Intersection::None,
            Outcome::Crossed(Sign::Positive) => Intersection::Crossing(Facing::Front),
            Outcome::Crossed(_) => Intersection::Crossing(Facing::Back),
            Outcome::Unsure => intersect_exactly(p, light, triangle),
        }
    }

    /// The segment to a light, prepared for the filter.
    #[inline(always)]
    fn way(&self, p: [f32; 3], light: &Light) -> SegmentFilter {
        // Largest difference between a coordinate of a corner and that of the point.
        let Aabb { low, high } = self.tree.bounds();
        let mut reach = 0.0_f64;
        for i in 0..3 {
            let p = f64::from(p[i]);
            for far in [f64::from(high[i]) - p, p - f64::from(low[i])] {
                reach = if far > reach { far } else { reach };
            }
        }
        SegmentFilter::new(p, Homogeneous::light(light), reach)
    }

    /// Number of faces between `p` and `light`, by side.
    ///
    /// ```
    /// use umbrage::geom::Light;
    /// use umbrage::oracle::{Crossings, Oracle};
    /// use umbrage::testing::shapes;
    /// let oracle = Oracle::build(&shapes::cube());
    /// // Up through the bottom, which faces away from the light, and out through the top.
    /// let crossings = oracle.crossings([0.3, 0.1, -4.0], &Light::point([0.1, 0.2, 5.0])?);
    /// assert_eq!(crossings, Crossings { front: 1, back: 1, touching: 0 });
    /// # Ok::<(), umbrage::geom::LightError>(())
    /// ```
    #[must_use]
    pub fn crossings(&self, p: [f32; 3], light: &Light) -> Crossings {
        let mut crossings = Crossings::default();
        self.meetings::<false>(p, light, &self.way(p, light), |_, meeting| {
            match meeting {
                Intersection::Crossing(Facing::Front) => crossings.front += 1,
                Intersection::Crossing(_) => crossings.back += 1,
                _ => crossings.touching += 1,
            }
            Step::On
        });
        crossings
    }

    /// Calls `visit` with every face that the open segment from `p` to `light` crosses or touches, in no
    /// particular order.
    ///
    /// ```
    /// use umbrage::geom::{Facing, Light};
    /// use umbrage::oracle::{Intersection, Oracle};
    /// use umbrage::testing::shapes;
    /// let cube = shapes::cube();
    /// let oracle = Oracle::build(&cube);
    /// let mut sides = Vec::new();
    /// oracle.for_each_meeting([0.3, 0.1, 0.0], &Light::point([0.1, 0.2, 5.0])?, |face, meeting| {
    ///     assert!(cube.corners(face).iter().all(|corner| corner[2] == 1.0)); // a face of the top
    ///     sides.push(meeting);
    /// });
    /// assert_eq!(sides, [Intersection::Crossing(Facing::Front)]);
    /// # Ok::<(), umbrage::geom::LightError>(())
    /// ```
    pub fn for_each_meeting(&self, p: [f32; 3], light: &Light, mut visit: impl FnMut(FaceId, Intersection)) {
        self.meetings::<false>(p, light, &self.way(p, light), |slot, meeting| {
            visit(FaceId(self.order[slot]), meeting);
            Step::On
        });
    }

    /// Calls `visit` with every face that a segment to `light` may meet which begins within `slack` of `p` in
    /// each coordinate: by its box, which nothing decides exactly. `slack` is at least two units in the last
    /// place of `p`'s largest coordinate.
    pub(crate) fn for_each_candidate(
        &self,
        p: [f32; 3],
        slack: f32,
        light: &Light,
        mut visit: impl FnMut(FaceId, [[f32; 3]; 3]),
    ) {
        self.tree.walk_loosely(p, slack, light, |slot| {
            visit(FaceId(self.order[slot]), self.triangles[slot]);
            Step::On
        });
    }

    /// Bounding box of all faces.
    #[must_use]
    pub fn bounds(&self) -> Aabb {
        self.tree.bounds()
    }
}

/// The mesh that contains a face, and the number of the face there: the last mesh that starts at or before
/// the face and is not empty.
#[inline]
fn split(first_faces: &[u32], face: u32) -> (usize, u32) {
    if let [0, _] = first_faces {
        return (0, face);
    }
    let mesh = first_faces.partition_point(|&first| first <= face) - 1;
    (mesh, face - first_faces[mesh])
}

/// The traversal, with AVX2 instructions where the processor has them: a third fewer instructions per node.
#[multiversion(targets("x86_64+avx2+bmi1+bmi2+lzcnt"))]
fn verdict(oracle: &Oracle, p: [f32; 3], light: &Light) -> Verdict {
    let mut none = usize::MAX;
    oracle.verdict_trying(p, light, &mut none)
}

/// Kept out of line, so that the certain cases stay small.
#[cold]
#[inline(never)]
fn intersect_exactly(p: [f32; 3], light: &Light, triangle: &[[f32; 3]; 3]) -> Intersection {
    // A segment that starts at a corner, as rays from vertices do, leaves the plane there for good.
    if triangle.contains(&p) && !side_of_light(*triangle, light).is_zero() {
        return Intersection::None;
    }
    intersect(p, light, *triangle)
}
