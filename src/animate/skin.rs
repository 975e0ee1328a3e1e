//! Skins: joints, and the weights by which they move vertices.

use glam::{DMat4, DVec3};

use super::fault::{Fault, Faults};

/// Joints and where they stood when the mesh was bound to them.
#[derive(Clone, Debug, Default)]
pub(crate) struct Skin {
    /// Indices into the nodes of the rig.
    pub(crate) joints: Vec<usize>,
    /// One a joint; `None` if all are the identity.
    pub(crate) inverse_binds: Option<Vec<DMat4>>,
    /// Its name in errors.
    pub(crate) place: String,
    /// Why it cannot be posed: place, problem and remedy.
    pub(crate) problem: Option<String>,
}

impl Skin {
    /// What each joint does to a vertex of the bind pose.
    pub(super) fn matrices(&self, world_from_node: &[DMat4], faults: Faults) -> Vec<DMat4> {
        let world = |(joint, &node): (usize, &usize)| match &self.inverse_binds {
            Some(inverse) if !faults.has(Fault::InverseBind) => world_from_node[node] * inverse[joint],
            _ => world_from_node[node],
        };
        self.joints.iter().enumerate().map(world).collect()
    }
}

/// Lists of joints and weights by number: vertices of one number are moved alike.
#[derive(Clone, Debug, Default)]
pub(crate) struct Influences {
    /// Where the list of each number begins, and the end of the last.
    starts: Vec<u32>,
    /// The joint and its weight; weights of a list add up to 1 as far as `f64` does.
    pairs: Vec<(u32, f64)>,
}

/// How many lists were mended.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Slips {
    /// Weights that did not add up to 1.
    pub(crate) sums: usize,
    /// Weights that added up to 0 or less, so that no joint moves the vertex.
    pub(crate) weightless: usize,
    /// Weights below 0.
    pub(crate) negative: usize,
}

/// How far the weights of a vertex may be from 1, for each of them: 2·10⁻⁷, as in §3.7.3.3 of the
/// specification.
const TOLERANCE: f64 = 2e-7;

impl Influences {
    /// Of lists of joints with weights that are not 0.
    pub(crate) fn new<'a>(lists: impl IntoIterator<Item = &'a [(u32, f32)]>) -> (Self, Slips) {
        Self::with(lists, Faults::default())
    }

    pub(super) fn with<'a>(
        lists: impl IntoIterator<Item = &'a [(u32, f32)]>,
        faults: Faults,
    ) -> (Self, Slips) {
        let (mut all, mut slips) = (Self { starts: vec![0], pairs: Vec::new() }, Slips::default());
        for list in lists {
            let weights = || list.iter().map(|&(_, weight)| f64::from(weight));
            let sum: f64 = weights().sum();
            slips.negative += usize::from(weights().any(|weight| weight < 0.0));
            if !list.is_empty() && sum > 0.0 {
                slips.sums += usize::from((sum - 1.0).abs() > TOLERANCE * list.len() as f64);
                let divisor = if faults.has(Fault::Normalize) { 1.0 } else { sum };
                let pairs = list.iter().zip(weights());
                all.pairs.extend(pairs.map(|(&(joint, _), weight)| (joint, weight / divisor)));
            } else {
                slips.weightless += 1;
            }
            all.starts.push(all.pairs.len() as u32); // a file of 2³² pairs does not fit the memory
        }
        (all, slips)
    }

    /// How many numbers there are.
    pub(crate) fn count(&self) -> usize {
        self.starts.len().saturating_sub(1)
    }

    fn of(&self, number: u32) -> &[(u32, f64)] {
        let number = number as usize;
        match self.starts.get(number..number + 2) {
            Some(ends) => &self.pairs[ends[0] as usize..ends[1] as usize],
            None => &[],
        }
    }

    /// The largest joint that one of these numbers names; `None` if they name none.
    pub(super) fn largest_joint(&self, numbers: &[u32]) -> Option<u32> {
        numbers.iter().flat_map(|&number| self.of(number)).map(|&(joint, _)| joint).max()
    }

    /// A position moved by the joints of a number. One that no joint moves stays.
    ///
    /// # Panics
    ///
    /// Panics if a joint has no matrix.
    pub(super) fn move_by(&self, number: u32, joints: &[DMat4], position: [f64; 3]) -> [f64; 3] {
        let list = self.of(number);
        if list.is_empty() {
            return position;
        }
        let position = DVec3::from(position);
        let moved =
            |&(joint, weight): &(u32, f64)| weight * joints[joint as usize].transform_point3(position);
        list.iter().map(moved).sum::<DVec3>().to_array()
    }
}
