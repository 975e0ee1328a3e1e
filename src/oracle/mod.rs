//! The exact ray cast: what lies between a point and a light.
//!
//! A tree finds the faces that the way to the light may meet, in `f32` but without losing one; five orientation signs
//! decide each of them, by a filter for all five or, where that is not certain, one by one (`meet.rs`). Signs on shared edges are antisymmetric, so no ray slips between two triangles, and what is
//! only touched is declared, not guessed.

mod batch;
mod primary_hit;
pub(crate) mod segment_filter;
mod segment_triangle;
#[cfg(test)]
mod tests;

pub use primary_hit::PrimaryHit;
pub use segment_triangle::{Intersection, intersect};

use multiversion::multiversion;

use crate::built::{self, Part};
use crate::geom::Facing;
use crate::geom::bvh::{Bvh, Step, WideBvh};
use crate::geom::predicate::{Homogeneous, Sign};
use crate::geom::{Aabb, Light};
use crate::mesh::{FaceId, MAX_TRIANGLES, Mesh};
use crate::oracle::segment_filter::{Outcome, SegmentFilter};

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

/// The faces of a mesh in a tree, ready for exact queries. Owns what it needs: about 50 bytes a face, 8 of them the tree.
#[derive(Clone, Debug)]
pub struct Oracle {
    pub(crate) tree: WideBvh,
    /// Faces in the order of the tree's leaves.
    order: Vec<u32>,
    /// The first face of each mesh, and the number of all faces.
    first_faces: Vec<u32>,
    /// Corners in the order of the tree's leaves.
    pub(crate) triangles: Vec<[[f32; 3]; 3]>,
}

impl Oracle {
    /// Builds the tree over all faces of `mesh`. Those without area cannot be crossed, only touched. About 400 ns
    /// a face. Memory: 128 bytes a face at its peak.
    #[must_use]
    pub fn build(mesh: &Mesh) -> Self {
        built::note(Part::Oracle, mesh);
        Self::over(&[mesh])
    }

    /// Builds one tree over the faces of several meshes. Faces are numbered mesh after mesh; [`Oracle::mesh_face`]
    /// separates the two. Costs and memory are those of [`Oracle::build`].
    ///
    /// # Panics
    ///
    /// Panics if the meshes together have more than [`MAX_TRIANGLES`](crate::mesh::MAX_TRIANGLES) faces.
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
            first_faces.push(first_faces[first_faces.len() - 1] + mesh.face_count() as u32); // fits as all do
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

    /// The mesh of a face, as its index in [`Oracle::over`], and the face's number in that mesh.
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

    /// Whether `p` is in shadow. Stops at the first face that is properly crossed.
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

    /// Asks the face in slot `first` before all others; leaves the one there that was crossed, if any.
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

    /// Calls `visit` with the slot of every face that is met, as far as it wants to go; `NEAREST` as in [`WideBvh::walk`].
    #[inline(always)]
    fn meetings<const NEAREST: bool>(
        &self,
        p: [f32; 3],
        light: &Light,
        way: &SegmentFilter,
        mut visit: impl FnMut(usize, Intersection) -> Step,
    ) {
        self.tree.walk::<NEAREST>(p, light, |slot| {
            let triangle = &self.triangles[slot];
            match way.passes(triangle) {
                Outcome::Missed => Step::On,
                Outcome::Crossed(Sign::Positive) => visit(slot, Intersection::Crossing(Facing::Front)),
                Outcome::Crossed(_) => visit(slot, Intersection::Crossing(Facing::Back)),
                Outcome::Unsure => match intersect_exactly(p, light, triangle) {
                    Intersection::None => Step::On,
                    meeting => visit(slot, meeting),
                },
            }
        });
    }

    /// The way to a light, ready to be compared with faces.
    #[inline(always)]
    fn way(&self, p: [f32; 3], light: &Light) -> SegmentFilter {
        // How far any coordinate of a corner may be from that of the point.
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

    /// All faces between `p` and `light`, counted by side.
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

    /// Visits every face that the open segment from `p` to `light` crosses or touches.
    pub fn for_each_meeting(&self, p: [f32; 3], light: &Light, mut visit: impl FnMut(FaceId, Intersection)) {
        self.meetings::<false>(p, light, &self.way(p, light), |slot, meeting| {
            visit(FaceId(self.order[slot]), meeting);
            Step::On
        });
    }

    /// The box around all faces.
    #[must_use]
    pub fn bounds(&self) -> Aabb {
        self.tree.bounds()
    }
}

/// The mesh that a face belongs to, and the face's number there: the last mesh that begins at or before it and is not
/// empty.
#[inline]
fn split(first_faces: &[u32], face: u32) -> (usize, u32) {
    if let [0, _] = first_faces {
        return (0, face);
    }
    let mesh = first_faces.partition_point(|&first| first <= face) - 1;
    (mesh, face - first_faces[mesh])
}

/// The walk, with AVX2's instructions where the processor has them: a third fewer for a node.
#[multiversion(targets("x86_64+avx2+bmi1+bmi2+lzcnt"))]
fn verdict(oracle: &Oracle, p: [f32; 3], light: &Light) -> Verdict {
    let mut none = usize::MAX;
    oracle.verdict_trying(p, light, &mut none)
}

/// Out of the way of what is certain.
#[cold]
#[inline(never)]
fn intersect_exactly(p: [f32; 3], light: &Light, triangle: &[[f32; 3]; 3]) -> Intersection {
    intersect(p, light, *triangle)
}
