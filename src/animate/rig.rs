//! The rig: node tree, skins and clips, and where they put what a scene holds.

use std::sync::Arc;

use glam::{DMat4, DVec3, Mat4};

use super::clip::{Channel, Clip, Property};
use super::fault::{Fault, Faults};
use super::pose::{Pose, PoseError};
use super::skin::{Influences, Skin};
use super::track;
use super::transform::Local;

/// What moves a scene: the node tree of its file, skins and clips. Empty where nothing moves.
///
/// The parts are the reader's; what can be asked of it are the clips.
#[derive(Clone, Debug, Default)]
pub struct Rig {
    /// Parents before children.
    pub(crate) nodes: Vec<Node>,
    pub(crate) skins: Vec<Skin>,
    pub(crate) clips: Vec<Clip>,
    pub(crate) influences: Arc<Influences>,
    /// One an instance of the scene; none if there is nothing to pose.
    pub(crate) placings: Vec<Placing>,
    /// The node of each lamp.
    pub(crate) lamp_nodes: Vec<usize>,
    /// The node of each camera.
    pub(crate) camera_nodes: Vec<usize>,
    /// Why it cannot be posed: place, problem and remedy.
    pub(crate) problem: Option<String>,
    /// What a reader says of a scene that is not posed, and that a posed one makes false.
    pub(crate) notes_at_rest: Vec<String>,
    /// What a reader says of a scene that is posed.
    pub(crate) notes: Vec<String>,
    /// Of a posed scene, one an instance.
    pub(crate) at_rest: Vec<AtRest>,
}

/// Where an instance of a posed scene stands at rest: there its vertices are welded.
#[derive(Clone, Copy, Debug)]
pub(crate) struct AtRest {
    pub(crate) world_from_mesh: Mat4,
    /// Equal for instances that a clip moves as one; 0 where it moves none.
    pub(crate) mover: u32,
}

/// A node.
#[derive(Clone, Debug)]
pub(crate) struct Node {
    /// Before it in the list.
    pub(crate) parent: Option<usize>,
    pub(crate) local: Local,
    /// Weights of the morph targets of its mesh.
    pub(crate) weights: Vec<f32>,
    /// Its name in errors.
    pub(crate) place: String,
}

/// Where an instance hangs.
#[derive(Clone, Debug)]
pub(crate) struct Placing {
    /// `None` if nothing moves it.
    pub(crate) node: Option<usize>,
    pub(crate) skin: Option<usize>,
    /// Below the node, where it places its mesh many times.
    pub(crate) node_from_mesh: Option<DMat4>,
}

/// All nodes at a moment.
pub(crate) struct Posed {
    pub(crate) world_from_node: Vec<DMat4>,
    /// Weights of the morph targets of each node.
    pub(crate) weights: Vec<Vec<f64>>,
    /// The nearest node at or above each that the clip moves: what has the same one moves as one.
    pub(crate) moved_by: Vec<Option<usize>>,
    /// Of each skin, what its joints do to a vertex of the bind pose.
    pub(super) joints: Vec<Vec<DMat4>>,
}

impl Rig {
    /// The clips, in the order of the file.
    #[must_use]
    pub fn clips(&self) -> &[Clip] {
        &self.clips
    }

    /// Whether nothing moves: no clip, no skin and no morph target.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.placings.is_empty()
    }

    /// The clip of a pose; `None` if there are none.
    pub(crate) fn clip(&self, pose: &Pose) -> Result<Option<&Clip>, PoseError> {
        if let Some(problem) = &self.problem {
            return Err(PoseError::Unusable(problem.clone()));
        }
        let clip = match pose.clip {
            Some(clip) => {
                let count = self.clips.len();
                Some(self.clips.get(clip).ok_or(PoseError::NoClip { clip, count })?)
            }
            None => self.clips.first(),
        };
        match clip.and_then(|clip| clip.problem.as_deref()) {
            Some(problem) => Err(PoseError::Unusable(problem.to_owned())),
            None => Ok(clip),
        }
    }

    /// All nodes at a time of a clip; as they stand without one. Linear in nodes, channels and joints.
    pub(crate) fn at(&self, clip: Option<&Clip>, time: f64) -> Result<Posed, PoseError> {
        self.at_with(clip, time, Faults::default())
    }

    pub(super) fn at_with(&self, clip: Option<&Clip>, time: f64, faults: Faults) -> Result<Posed, PoseError> {
        let mut locals: Vec<Local> = self.nodes.iter().map(|node| node.local).collect();
        let weights = |node: &Node| node.weights.iter().copied().map(f64::from).collect();
        let mut weights: Vec<Vec<f64>> = self.nodes.iter().map(weights).collect();
        let mut own = vec![false; self.nodes.len()];
        for channel in clip.iter().flat_map(|clip| &clip.channels) {
            let Channel { node, property, track } = channel;
            let value = track.at(time, *property == Property::Rotation, faults);
            if *property == Property::Weights {
                weights[*node] = value;
                continue;
            }
            own[*node] = true;
            let Local::Parts { mut translation, mut rotation, mut scale } = locals[*node].in_parts() else {
                unreachable!("it is in parts")
            };
            match property {
                Property::Translation => translation = DVec3::from_slice(&value),
                Property::Scale => scale = DVec3::from_slice(&value),
                _ => rotation = track::quaternion(&value),
            }
            locals[*node] = Local::Parts { translation, rotation, scale };
        }
        let mut world_from_node: Vec<DMat4> = Vec::with_capacity(self.nodes.len());
        let mut moved_by: Vec<Option<usize>> = Vec::with_capacity(self.nodes.len());
        for (index, (node, local)) in self.nodes.iter().zip(&locals).enumerate() {
            let parent = node.parent.filter(|_| !faults.has(Fault::Parent));
            let world_from_parent = parent.map_or(DMat4::IDENTITY, |parent| world_from_node[parent]);
            let world = world_from_parent * local.matrix();
            if !world.as_mat4().is_finite() {
                let problem = format!("{}: the clip moves it beyond the range of 32-bit floats", node.place);
                return Err(PoseError::Unusable(problem));
            }
            world_from_node.push(world);
            let above = node.parent.and_then(|parent| moved_by[parent]);
            moved_by.push(own[index].then_some(index).or(above));
        }
        let joints = self.skins.iter().map(|skin| skin.matrices(&world_from_node, faults)).collect();
        Ok(Posed { world_from_node, weights, moved_by, joints })
    }

    /// The matrices of the joints of a skin, for vertices of these numbers.
    pub(super) fn joints<'a>(
        &self,
        skin: usize,
        numbers: &[u32],
        posed: &'a Posed,
    ) -> Result<&'a [DMat4], PoseError> {
        let Skin { place, problem, .. } = &self.skins[skin];
        if let Some(problem) = problem {
            return Err(PoseError::Unusable(problem.clone()));
        }
        let joints = &posed.joints[skin];
        match self.influences.largest_joint(numbers) {
            Some(joint) if joint as usize >= joints.len() => {
                let count = joints.len();
                let problem = format!("{place}: a vertex is moved by joint {joint}, but there are {count}");
                Err(PoseError::Unusable(problem))
            }
            _ => Ok(joints),
        }
    }

    /// Forgets the instances that are not kept.
    pub(crate) fn retain(&mut self, kept: &[bool]) {
        let mut next = kept.iter();
        self.placings.retain(|_| next.next().is_none_or(|&kept| kept));
        let mut next = kept.iter();
        self.at_rest.retain(|_| next.next().is_none_or(|&kept| kept));
    }
}
