//! Ambient occlusion by disks that stand for the faces around each vertex, or for single faces.
//!
//! The method of Bunnell (*Dynamic Ambient Occlusion and Indirect Lighting*, GPU Gems 2, 2005) and Gomila
//! (*L'ambient occlusion*, 2006), with form factors that do not depend on the unit of length, and with a tree
//! over the disks. It is fast, and close to the truth on nearly convex scans. Disks behind one another count
//! as if they lay side by side, for which no bound exists: on folded surfaces the error is large. Passes
//! weaken this: from the second one on a disk counts by its own openness.

mod literal;
mod passes;
#[cfg(test)]
mod tests;
mod tree;

pub use literal::{Literal, LiteralForm};
pub use passes::Passes;

use glam::DVec3;

use super::{Ambient, Per, Receiver, Receivers};
use crate::geom::Aabb;
use crate::mesh::{FaceId, Mesh};
use crate::oracle::Curve;
use tree::{Disk, Seen, Tree};

/// What a disk stands for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Emitters {
    /// A third of the faces around a vertex, with their mean normal. Where the normals of a vertex cancel,
    /// there is no disk.
    #[default]
    Vertices,
    /// A face, at its middle.
    Faces,
}

/// The disks of some meshes in a tree.
///
/// ```
/// use umbrage::ambient::disks::{Disks, Emitters, Passes};
/// use umbrage::ambient::{Per, Receivers};
/// use umbrage::testing::shapes;
/// let torus = shapes::torus(48, 24, 2.0, 0.7);
/// let receivers = Receivers::of(&[&torus], Per::Vertex);
/// let mut disks = Disks::of(&[&torus], Emitters::Vertices);
/// disks.run(&Passes::default());
/// let found = disks.openness(receivers.list());
/// // Nothing hides the outside of the tube, and the hole in the middle is darker.
/// assert!(found.openness.iter().any(|&open| open > 0.99) && found.openness.iter().any(|&open| open < 0.9));
/// ```
#[derive(Clone, Debug)]
pub struct Disks {
    tree: Tree,
    /// The point and the normal of each disk.
    emitters: Vec<Receiver>,
    theta: f64,
}

/// Receivers per run.
const RUN: usize = 64;

impl Disks {
    /// Makes the disks and the tree, for [`Passes::default`]. Time: n log n.
    ///
    /// # Panics
    ///
    /// As [`Receivers::of`].
    #[must_use]
    pub fn of(meshes: &[&Mesh], emitters: Emitters) -> Self {
        let (emitters, disks): (Vec<Receiver>, Vec<Disk>) = disks(meshes, emitters).into_iter().unzip();
        Self { tree: Tree::over(&disks), emitters, theta: Passes::default().theta }
    }

    /// Number of disks.
    #[must_use]
    pub fn count(&self) -> usize {
        self.emitters.len()
    }

    /// Memory, in bytes.
    #[must_use]
    pub fn bytes(&self) -> usize {
        self.tree.bytes() + size_of_val(&*self.emitters)
    }

    /// The openness of receivers with the disks as they are weighted, on several threads if the feature
    /// `parallel` is on. With the mean open direction too.
    ///
    /// A receiver without a normal gets the share of all directions.
    #[must_use]
    pub fn openness(&self, receivers: &[Receiver]) -> Ambient {
        let (openness, bent) = self
            .seen(receivers)
            .into_iter()
            .zip(receivers)
            .map(|(seen, receiver)| (open(seen.hidden) as f32, bent(seen, receiver.normal)))
            .unzip();
        Ambient { openness, bent: Some(bent), ..Ambient::default() }
    }

    fn seen(&self, receivers: &[Receiver]) -> Vec<Seen> {
        // Along a curve, so that neighbors read the same blocks.
        let curve = Curve::in_box(&Aabb::around(receivers.iter().map(|receiver| receiver.point)));
        let mut order: Vec<(u32, u32)> =
            receivers.iter().zip(0..).map(|(receiver, index)| (curve.place(receiver.point), index)).collect();
        order.sort_unstable();
        let mut found = vec![Seen::default(); order.len()];
        crate::parallel::rows(&mut found, RUN, |run, found| {
            let mut run = order[run * RUN..].iter().map(|&(_, index)| receivers[index as usize]);
            self.tree.sums(&mut run, self.theta, found);
        });
        let mut seen = vec![Seen::default(); order.len()];
        for ((_, index), found) in order.into_iter().zip(found) {
            seen[index as usize] = found;
        }
        seen
    }
}

/// Disks add up as if no two overlapped, and they hide no more than everything.
fn open(hidden: f64) -> f64 {
    (1.0 - hidden).max(0.0)
}

/// The mean open direction: that of an empty hemisphere, 2/3 of the normal, less the hidden ones.
fn bent(seen: Seen, normal: Option<[f32; 3]>) -> [f32; 3] {
    let empty = normal.map_or(DVec3::ZERO, |normal| wide(normal) * (2.0 / 3.0));
    let open = if open(seen.hidden) > 0.0 { empty - seen.towards } else { DVec3::ZERO };
    open.normalize_or_zero().to_array().map(|x| x as f32)
}

/// The disks with an area and a normal, each with the receiver at its center.
fn disks(meshes: &[&Mesh], emitters: Emitters) -> Vec<(Receiver, Disk)> {
    let per = match emitters {
        Emitters::Vertices => Per::Vertex,
        Emitters::Faces => Per::Face,
    };
    let receivers = Receivers::of(meshes, per);
    let mut areas = vec![0.0; receivers.list().len()];
    for (corners, area) in receivers.corners().iter().zip(face_areas(meshes)) {
        for &corner in corners {
            areas[corner as usize] += area / 3.0;
        }
    }
    let disk = |(&receiver, area): (&Receiver, f64)| {
        let normal = wide(receiver.normal?);
        (area > 0.0).then_some((receiver, Disk { center: wide(receiver.point), normal, area }))
    };
    receivers.list().iter().zip(areas).filter_map(disk).collect()
}

/// The area of each face of all meshes, in sequence.
fn face_areas<'a>(meshes: &'a [&Mesh]) -> impl Iterator<Item = f64> + 'a {
    let area = |corners: [[f32; 3]; 3]| {
        let [a, b, c] = corners.map(wide);
        0.5 * (b - a).cross(c - a).length()
    };
    meshes
        .iter()
        .flat_map(move |mesh| (0..mesh.face_count()).map(move |i| area(mesh.corners(FaceId::new(i)))))
}

fn wide(v: [f32; 3]) -> DVec3 {
    DVec3::from(v.map(f64::from))
}
