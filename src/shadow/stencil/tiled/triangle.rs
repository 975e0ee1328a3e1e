//! A triangle of a volume as seen from the eye: a homogeneous rasterizer, which needs no clipping.
//!
//! (Marc Olano and Trey Greer, *Triangle Scan Conversion Using 2D Homogeneous Coordinates*, 1997.) The edges
//! and the eye span three planes. A ray from the eye runs through the triangle if it lies on the same side of
//! all three, and the point where it does so lies before or behind the sample by the side of the triangle's
//! own plane that the sample is on. Corners at infinity are no special case.
//!
//! Signs are those of `f64` where this is certain, otherwise exact. A ray that runs exactly through an edge
//! is decided as if the eye were moved by an infinitesimal step, the same for all triangles and samples: the
//! ray then meets exactly one of two triangles that continue each other. (Herbert Edelsbrunner and Ernst
//! Mücke, *Simulation of Simplicity*, 1990.)

use super::fault::{Fault, Faults};
use super::form::{Form, Local};
use super::view::{Cell, View};
use crate::geom::predicate::{Homogeneous, Sign, directions_turn, orient3d_homogeneous};
use crate::shadow::volume::{ShadowVolume, axes};

/// A triangle, prepared for one eye.
#[derive(Clone, Debug)]
pub(super) struct SeenTriangle {
    corners: [u32; 3],
    copies: i32,
    edges: [Form; 3],
    /// `None` if all corners lie at infinity.
    plane: Option<Form>,
    /// The sign of the edges where a ray meets the triangle: for a finite one the side that the eye is on.
    inside: Sign,
    /// Whether the eye lies in the triangle's plane.
    is_edge_on: bool,
}

/// How the ray from the eye through a sample meets a triangle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Meeting {
    Miss,
    /// The sample lies on the triangle, or rays at the sample do not tell sides apart.
    On,
    /// Between the eye and the sample; the number is what it adds to the count.
    Before(i32),
    /// Behind the sample, infinitely far included.
    Behind(i32),
}

/// Where a triangle lies in a tile.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Place {
    /// In front of all points of the tile.
    Before,
    /// Behind all points of the tile.
    Behind,
    /// It may cross the tile between its depths.
    Across,
}

impl SeenTriangle {
    /// `None` if no ray meets the triangle: it is flat at infinity.
    pub(super) fn of(volume: &ShadowVolume, view: &View, (corners, copies): ([u32; 3], i32)) -> Option<Self> {
        let exact = corners.map(|corner| volume.vertex(corner));
        let is_finite = exact.iter().any(Homogeneous::is_finite);
        let [a, b, c] = exact;
        let (inside, is_edge_on) = if is_finite {
            let side = orient3d_homogeneous([a, b, c, view.eye()]);
            (moved(view.eye(), |eye| orient3d_homogeneous([a, b, c, eye])), side.is_zero())
        } else {
            (directions_turn(exact), false)
        };
        let [eye, a, b, c] = [view.eye(), a, b, c].map(|point| Local::of(point, view.origin));
        let edges = [(a, b), (b, c), (c, a)].map(|(a, b)| Form::through([eye, a, b]));
        let plane = is_finite.then(|| Form::through([a, b, c]));
        let triangle = Self { corners, copies, edges, plane, inside, is_edge_on };
        (!inside.is_zero()).then_some(triangle)
    }

    /// Where the triangle lies in a cell; `None` if no ray through the cell meets it.
    pub(super) fn place(&self, cell: &Cell) -> Option<Place> {
        if self.is_edge_on {
            return match self.plane.and_then(|plane| plane.sign_within(cell)) {
                Some(_) => None,
                None => Some(Place::Across),
            };
        }
        if self.edges.iter().any(|edge| edge.sign_across(cell) == Some(-self.inside)) {
            return None;
        }
        let Some(plane) = self.plane else { return Some(Place::Behind) };
        Some(match plane.sign_within(cell) {
            None => Place::Across,
            // The form has the opposite sign of the orientation.
            Some(side) if -side == self.inside => Place::Behind,
            Some(_) => Place::Before,
        })
    }

    /// Whether a ray through the cell may meet the triangle.
    pub(super) fn may_meet(&self, cell: &Cell) -> bool {
        self.is_edge_on || self.edges.iter().all(|edge| edge.sign_across(cell) != Some(-self.inside))
    }

    /// How the ray through a sample meets the triangle.
    pub(super) fn meet(&self, volume: &ShadowVolume, view: &View, p: [f32; 3], faults: Faults) -> Meeting {
        let local = view.local(p);
        let reach = local.abs().element_sum();
        if self.is_edge_on && self.plane.is_some_and(|plane| plane.sign(local, reach).is_some()) {
            return Meeting::Miss;
        }
        let mut is_certain = !self.is_edge_on;
        for edge in &self.edges {
            match edge.sign(local, reach) {
                Some(sign) if sign != self.inside => return Meeting::Miss,
                Some(_) => {}
                None => is_certain = false,
            }
        }
        let exactly = || self.meet_exactly(volume, view, p, faults);
        match self.plane {
            _ if !is_certain => exactly(),
            None => Meeting::Behind(self.copies * self.inside.value()),
            Some(plane) => match plane.sign(local, reach) {
                None => exactly(),
                Some(side) if -side == self.inside => Meeting::Behind(self.copies * self.inside.value()),
                Some(_) => Meeting::Before(-self.copies * self.inside.value()),
            },
        }
    }

    /// The same by exact signs.
    #[cold]
    fn meet_exactly(&self, volume: &ShadowVolume, view: &View, p: [f32; 3], faults: Faults) -> Meeting {
        let [a, b, c] = volume.corners(self.corners);
        let at = Homogeneous::point(p);
        let edges = [(a, b), (b, c), (c, a)].map(|(a, b)| {
            let side = |eye| orient3d_homogeneous([at, eye, a, b]);
            if faults.has(Fault::TieMisses) { side(view.eye()) } else { moved(view.eye(), side) }
        });
        if faults.has(Fault::TieMisses) && edges.contains(&Sign::Zero) {
            return Meeting::Miss;
        }
        if edges.contains(&-self.inside) {
            // Also of a triangle behind the eye.
            return Meeting::Miss;
        }
        if edges.contains(&Sign::Zero) {
            return Meeting::On;
        }
        let value = |from: Sign| self.copies * from.value();
        if self.plane.is_none() {
            return Meeting::Behind(value(self.inside));
        }
        match orient3d_homogeneous([a, b, c, at]) {
            Sign::Zero => Meeting::On,
            from if from == self.inside => Meeting::Behind(value(from)),
            from => Meeting::Before(value(from)),
        }
    }

    /// Whether this is the face with these corners.
    pub(super) fn is_face(&self, volume: &ShadowVolume, corners: [[f32; 3]; 3]) -> bool {
        let own = self.corners.map(|corner| volume.positions().get(corner as usize));
        own.iter().all(|own| own.is_some_and(|own| corners.contains(own)))
    }
}

/// A sign at the eye moved by an infinitesimal step along an axis, an infinitely shorter one along the next,
/// and so on: the first sign that is not 0.
fn moved(eye: Homogeneous, sign: impl Fn(Homogeneous) -> Sign) -> Sign {
    let steps = std::iter::once(eye).chain(axes());
    steps.map(sign).find(|sign| !sign.is_zero()).unwrap_or(Sign::Zero)
}
