//! The connected parts of a volume: each is closed, and has counts of its own.

use super::fault::{Fault, Faults};
use super::triangle::SeenTriangle;
use super::view::{Cell, View};
use crate::geom::predicate::Homogeneous;
use crate::shadow::volume::{ShadowVolume, weighted, winding_of};
use crate::topology::Components;

/// Triangles of one part, each with its number of copies.
pub(super) type Part = Vec<([u32; 3], i32)>;

/// The parts, in the order of their first vertex. Triangles of different parts share no finite vertex, and no
/// vertex extruded from one; so every edge that cancels does so within a part.
fn parts(volume: &ShadowVolume) -> Vec<Part> {
    let mut components = Components::new(volume.positions().len());
    let finite = |triangle: [u32; 3]| triangle.into_iter().filter_map(|v| volume.finite_vertex(v));
    for &triangle in volume.triangles() {
        let mut all = finite(triangle);
        if let Some(first) = all.next() {
            all.for_each(|other| {
                components.join(first, other);
            });
        }
    }
    let (number_of, count) = components.number(|_| true);
    let mut parts = vec![Part::new(); count];
    for (triangle, copies) in weighted(volume) {
        if let Some(number) = finite(triangle).next().and_then(|vertex| number_of[vertex as usize]) {
            parts[number as usize].push((triangle, copies));
        }
    }
    parts
}

/// A closed volume, cut into its parts.
#[derive(Clone, Debug)]
pub(in crate::shadow) struct ClosedVolume {
    volume: ShadowVolume,
    parts: Vec<Part>,
}

impl ClosedVolume {
    /// `volume` has both caps.
    pub(in crate::shadow) fn new(volume: ShadowVolume) -> Self {
        let parts = parts(&volume);
        Self { volume, parts }
    }

    pub(super) fn parts(&self) -> impl Iterator<Item = (&ShadowVolume, &Part)> {
        self.parts.iter().map(|part| (&self.volume, part))
    }

    #[cfg(test)]
    pub(super) fn volume(&self) -> &ShadowVolume {
        &self.volume
    }

    /// Memory in bytes.
    pub(in crate::shadow) fn bytes(&self) -> usize {
        self.volume.bytes() + self.parts.iter().map(|part| size_of_val(&part[..])).sum::<usize>()
    }
}

/// A part, prepared for one eye.
#[derive(Debug)]
pub(super) struct SeenPart<'a> {
    pub(super) volume: &'a ShadowVolume,
    pub(super) triangles: Vec<SeenTriangle>,
    /// The winding number at the eye; `None` if the eye lies on the part, or at infinity.
    pub(super) at_eye: Option<i32>,
    /// The depths between which the part lies.
    depth: [f64; 2],
}

impl<'a> SeenPart<'a> {
    pub(super) fn of(volume: &'a ShadowVolume, part: &Part, view: &View, faults: Faults) -> Self {
        let winding = || winding_of(volume, part, view.point()?);
        Self {
            volume,
            triangles: part.iter().filter_map(|&one| SeenTriangle::of(volume, view, one)).collect(),
            at_eye: if faults.has(Fault::StartsAtZero) { Some(0) } else { winding() },
            depth: depths(volume, part, view),
        }
    }

    /// Whether the part lies before or behind all depths of a cell: its counts are 0 there.
    pub(super) fn is_apart(&self, cell: &Cell) -> bool {
        self.depth[0] > cell.bounds[1] || self.depth[1] < cell.bounds[0]
    }
}

/// The volume is `v + t·d` for points v and directions d of its hull, so its depths end at those of its
/// finite vertices where no direction leads on.
fn depths(volume: &ShadowVolume, part: &Part, view: &View) -> [f64; 2] {
    let [mut low, mut high] = [f64::INFINITY, f64::NEG_INFINITY];
    for vertex in part.iter().flat_map(|(triangle, _)| triangle).map(|&corner| volume.vertex(corner)) {
        let at = match vertex.is_finite() {
            true => vertex.row(view.origin),
            false => vertex.row([0.0; 3]),
        };
        let (depth, error) = view.depth(at.rounded().into());
        if Homogeneous::is_finite(&vertex) {
            (low, high) = (low.min(depth - error), high.max(depth + error));
        } else {
            low = if depth < error { f64::NEG_INFINITY } else { low };
            high = if depth > -error { f64::INFINITY } else { high };
        }
    }
    [low, high]
}
