//! The positions of a mesh that morph targets displace and joints move.

use super::fault::Faults;
use super::morph::morphed;
use super::pose::PoseError;
use super::rig::{Posed, Rig};

/// A mesh and what deforms it.
pub(crate) struct Deformed<'a> {
    /// At rest.
    pub(crate) positions: &'a [[f32; 3]],
    /// The positions at full weight of each morph target.
    pub(crate) targets: &'a [Vec<[f32; 3]>],
    /// Of the targets; those without one have weight 0.
    pub(crate) weights: &'a [f64],
    /// A skin of the rig, and for each vertex the number of its influences.
    pub(crate) skin: Option<(usize, &'a [u32])>,
}

impl Deformed<'_> {
    /// The positions at a moment, each rounded once: first displaced, then moved (§3.7.3.3 of the
    /// specification). Linear in vertices, times targets with a weight and joints of a vertex.
    pub(crate) fn at(&self, rig: &Rig, posed: &Posed) -> Result<Vec<[f32; 3]>, PoseError> {
        self.with(rig, posed, Faults::default())
    }

    pub(super) fn with(&self, rig: &Rig, posed: &Posed, faults: Faults) -> Result<Vec<[f32; 3]>, PoseError> {
        let Self { positions, targets, weights, skin } = self;
        let displaced = |(vertex, &rest): (usize, &[f32; 3])| morphed(rest, vertex, targets, weights, faults);
        let displaced = positions.iter().enumerate().map(displaced);
        let rounded = |position: [f64; 3]| position.map(|x| x as f32);
        let Some((skin, numbers)) = *skin else { return Ok(displaced.map(rounded).collect()) };
        let joints = rig.joints(skin, numbers, posed)?;
        let moved = displaced.zip(numbers);
        Ok(moved.map(|(at, &number)| rounded(rig.influences.move_by(number, joints, at))).collect())
    }
}
