//! A scene at a moment.

use std::sync::Arc;

use glam::{DMat4, DVec3};
use hashbrown::HashMap;

use super::{Lamp, LampShape, MOST_INSTANCED, Scene};
use crate::animate::{AtRest, Deformed, Moment, Pose, PoseError, Posed, Rig, between};
use crate::geom::Light;
use crate::mesh::{Mesh, MeshError};
use crate::view::Camera;

/// What makes two instances have one posed mesh: mesh, skin, and a node of these morph weights, if they move
/// anything.
type Key = (usize, Option<usize>, Option<usize>);

impl Scene {
    /// Whether anything in it moves: a clip, a skin, morph targets or frames.
    #[must_use]
    pub fn moves(&self) -> bool {
        !self.rig.is_empty() || self.last_frame() > 0
    }

    /// The number of the last frame, where meshes store frames (MD2); 0 without.
    #[must_use]
    pub fn last_frame(&self) -> usize {
        match self.rig.is_empty() && self.rig.at_rest.is_empty() {
            true => self.meshes.iter().map(|mesh| mesh.frames().len()).max().unwrap_or(0),
            false => 0, // morph targets, or posed already
        }
    }

    /// The scene at a moment: instances, lamps and cameras where a clip moves them, skinned meshes where
    /// their joints put them, morph targets by their weights, frames between two of the file.
    ///
    /// Vertices and faces are the same ones in the same order, and [`weld`](fn@crate::mesh::weld) makes the
    /// same vertices one whatever the time: those that coincide at rest and that every time of the clip moves
    /// alike. So [`Caster::repose`](crate::caster::Caster::repose) takes the positions of another time. Where
    /// an instance mirrors, its faces are turned by [`Scene::bake`].
    ///
    /// Sums are in `f64`; a position is rounded to `f32` once in the space of its mesh, and once more where
    /// its instance is placed. Outside of the keys of a clip the nearest one is held, and a note says so. The
    /// posed scene has no clips, and to pose it again changes nothing: pose the one that was read.
    ///
    /// # Errors
    ///
    /// [`PoseError`] if there is no such clip or frame, if the file is wrong where it moves the scene, or if
    /// the pose carries something beyond `f32`.
    ///
    /// ```
    /// use umbrage::animate::Pose;
    /// use umbrage::scene::Scene;
    /// use umbrage::testing::shapes;
    /// let cube = shapes::cube();
    /// let lifted = cube.positions().iter().map(|&[x, y, z]| [x, y + 2.0, z]).collect();
    /// let scene = Scene::of(cube.with_frames(vec![lifted])?);
    /// // A quarter of the way from frame 0 to frame 1, at one frame a second.
    /// let posed = scene.pose(&Pose::at(0.25).fps(1.0))?;
    /// let bottom = |scene: &Scene| scene.meshes[0].bounds().map(|[low, _]| low[1]);
    /// assert_eq!((bottom(&scene), bottom(&posed)), (Some(-1.0), Some(-0.5)));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn pose(&self, pose: &Pose) -> Result<Scene, PoseError> {
        let time = pose.seconds();
        let is_rate = pose.fps.is_finite() && pose.fps > 0.0;
        for (what, value, fits) in [("frame rate", pose.fps, is_rate), ("time", time, time.is_finite())] {
            if !fits {
                return Err(PoseError::NoTime { what, value });
            }
        }
        let (count, placings) = (self.instances.len(), &self.rig.placings);
        if !placings.is_empty() && placings.len() != count {
            return Err(PoseError::Instances { count, posed: placings.len() });
        }
        let clip = self.rig.clip(pose)?;
        let nodes = self.rig.at(clip, time)?;
        let mut posed = Scene {
            meshes: Vec::new(),
            instances: Vec::with_capacity(count),
            rig: Rig { at_rest: Vec::with_capacity(count), ..Rig::default() },
            ..self.without_meshes()
        };
        self.place(&mut posed, &nodes)?;
        let same_weights = same_weights(&nodes);
        let mut slots: HashMap<Key, usize> = HashMap::new();
        let own: usize = self.meshes.iter().map(size).sum();
        let mut held = 0_usize;
        for (index, instance) in posed.instances.iter_mut().enumerate() {
            let key = self.key(index, instance.mesh, &same_weights);
            instance.mesh = match slots.get(&key) {
                Some(&slot) => slot,
                None => {
                    held = held.saturating_add(size(&self.meshes[key.0]));
                    let most = MOST_INSTANCED.max(own);
                    if held > most {
                        let (what, count) = ("vertices of posed meshes", held);
                        return Err(MeshError::TooLarge { what, count, most }.into());
                    }
                    posed.meshes.push(self.posed_mesh(&key, pose, &nodes)?);
                    slots.insert(key, posed.meshes.len() - 1);
                    posed.meshes.len() - 1
                }
            };
        }
        posed.notes.retain(|note| !self.rig.notes_at_rest.contains(note));
        posed.notes.extend(self.rig.notes.iter().cloned());
        posed.notes.extend(self.note_of_time(pose, time)?);
        Ok(posed)
    }

    /// A copy without meshes, instances and what moves them.
    fn without_meshes(&self) -> Scene {
        Scene {
            format: self.format,
            up: self.up,
            meshes: Vec::new(),
            instances: Vec::new(),
            materials: self.materials.clone(),
            lamps: self.lamps.clone(),
            cameras: self.cameras.clone(),
            left_out_cameras: self.left_out_cameras.clone(),
            notes: self.notes.clone(),
            rounding: self.rounding,
            rig: Rig::default(),
        }
    }

    /// Puts instances, lamps and cameras where their nodes are. What the clip does not move stays, to the
    /// bit.
    fn place(&self, posed: &mut Scene, nodes: &Posed) -> Result<(), PoseError> {
        let moved = |node: usize| nodes.moved_by[node].map(|mover| (mover, nodes.world_from_node[node]));
        for (index, instance) in self.instances.iter().enumerate() {
            let here = AtRest { world_from_mesh: instance.world_from_mesh, mover: 0 };
            let at_rest = self.rig.at_rest.get(index).copied().unwrap_or(here);
            let (mut instance, mut at_rest) = (instance.clone(), at_rest);
            let placing = self.rig.placings.get(index).filter(|placing| placing.skin.is_none());
            if let Some((placing, (mover, world))) =
                placing.and_then(|placing| Some((placing, moved(placing.node?)?)))
            {
                let world = world * placing.node_from_mesh.unwrap_or(DMat4::IDENTITY);
                instance.world_from_mesh = world.as_mat4();
                if !instance.world_from_mesh.is_finite() {
                    let problem = format!("{}: beyond the range of 32-bit floats", instance.name);
                    return Err(PoseError::Unusable(problem));
                }
                at_rest.mover = 1 + mover as u32; // nodes of a file that fits the memory
            }
            posed.instances.push(instance);
            posed.rig.at_rest.push(at_rest);
        }
        for (lamp, &node) in posed.lamps.iter_mut().zip(&self.rig.lamp_nodes) {
            if let Some((_, world)) = moved(node) {
                move_lamp(lamp, world);
            }
        }
        for (named, &node) in posed.cameras.iter_mut().zip(&self.rig.camera_nodes) {
            if let Some((_, world)) = moved(node) {
                move_camera(&mut named.camera, world);
            }
        }
        Ok(())
    }

    fn key(&self, instance: usize, mesh: usize, same_weights: &[Option<usize>]) -> Key {
        let Some(placing) = self.rig.placings.get(instance) else { return (mesh, None, None) };
        (mesh, placing.skin, placing.node.and_then(|node| same_weights[node]))
    }

    /// A mesh in its own space; a skinned one where its joints are.
    fn posed_mesh(&self, key: &Key, pose: &Pose, nodes: &Posed) -> Result<Mesh, PoseError> {
        let (mesh, skin) = (&self.meshes[key.0], key.1);
        let weights = key.2.map_or(&[][..], |node| &nodes.weights[node]);
        if self.rig.is_empty() {
            if mesh.frames().is_empty() || self.last_frame() == 0 {
                return Ok(mesh.clone());
            }
            let frames: Vec<&[[f32; 3]]> =
                [mesh.positions()].into_iter().chain(mesh.frames().iter().map(Vec::as_slice)).collect();
            return Ok(mesh.clone().posed(between(&frames, pose.frames()))?);
        }
        if skin.is_none() && weights.is_empty() {
            return Ok(mesh.clone().with_skin(None));
        }
        // Without joints and weights nothing moves a vertex.
        let skin = skin.and_then(|skin| Some((skin, mesh.skin()?)));
        let deformed = Deformed {
            positions: mesh.positions(),
            targets: mesh.frames(),
            weights,
            skin: skin.map(|(skin, numbers)| (skin, numbers.as_slice())),
        };
        let posed = mesh.clone().posed(deformed.at(&self.rig, nodes)?)?;
        let Some((skin, numbers)) = skin else { return Ok(posed.with_skin(None)) };
        // Equal for what moves alike, also in other meshes: behind the numbers of nodes.
        let first = (self.rig.influences.count() as u32).saturating_mul(skin as u32);
        let first = first.saturating_add(1 + self.rig.nodes.len() as u32);
        let movers: Arc<Vec<u32>> =
            numbers.iter().map(|&number| number.saturating_add(first)).collect::<Vec<_>>().into();
        Ok(posed.with_skin(Some(movers)))
    }

    /// What to say of a time outside of all keys, or where nothing moves.
    fn note_of_time(&self, pose: &Pose, time: f64) -> Result<Option<String>, PoseError> {
        if !self.moves() {
            return Ok(Some("nothing in it moves: no clip, no skin, no frames".to_owned()));
        }
        if self.rig.is_empty() {
            let last = self.last_frame();
            let frame = pose.frames();
            return match pose.moment {
                Moment::Frame(frame) if frame as usize > last => Err(PoseError::NoFrame { frame, last }),
                _ if frame < 0.0 || frame > last as f64 => Ok(Some(format!(
                    "time {time} s is frame {frame}, beyond frames 0 to {last}: the nearest one is held"
                ))),
                _ => Ok(None),
            };
        }
        let Some(clip) = self.rig.clip(pose)? else { return Ok(None) };
        let [start, end] = clip.span();
        let name = clip.name();
        Ok((time < start || time > end).then(|| {
            format!("time {time} s is outside of clip {name} ({start} to {end} s): the nearest key is held")
        }))
    }
}

/// For each node, the first one with the same morph weights; `None` where all are 0, which moves nothing.
fn same_weights(nodes: &Posed) -> Vec<Option<usize>> {
    let mut first: HashMap<Vec<u64>, usize> = HashMap::new();
    let of = |(node, weights): (usize, &Vec<f64>)| {
        let moves = weights.iter().any(|&weight| weight != 0.0);
        moves.then(|| *first.entry(weights.iter().map(|weight| weight.to_bits()).collect()).or_insert(node))
    };
    nodes.weights.iter().enumerate().map(of).collect()
}

/// The positions that a mesh holds, frames and rest included.
fn size(mesh: &Mesh) -> usize {
    mesh.vertex_count().saturating_mul(2 + mesh.frames().len())
}

/// A lamp of a file stands at the origin of its node and shines along −z. One whose node is flattened to no
/// direction keeps that of the file.
fn move_lamp(lamp: &mut Lamp, world: DMat4) {
    let travel = direction(world, DVec3::NEG_Z);
    if let LampShape::Hard(light) = &mut lamp.shape {
        let moved = match light.is_directional() {
            true => travel.map(|travel| Light::directional(travel.as_vec3().to_array())),
            false => Some(Light::point(world.w_axis.truncate().as_vec3().to_array())),
        };
        if let Some(Ok(moved)) = moved {
            *light = moved;
        }
    }
    if let (Some(cone), Some(travel)) = (&mut lamp.cone, travel) {
        cone.direction = travel.as_vec3().to_array();
    }
}

/// A camera of a file looks along −z of its node, with +y up; see [`move_lamp`].
fn move_camera(camera: &mut Camera, world: DMat4) {
    camera.eye = world.w_axis.truncate().as_vec3();
    if let (Some(forward), Some(up)) = (direction(world, DVec3::NEG_Z), direction(world, DVec3::Y)) {
        let (forward, up) = (forward.as_vec3(), up.as_vec3());
        if forward.cross(up) != glam::Vec3::ZERO {
            (camera.forward, camera.up) = (forward, up);
        }
    }
}

fn direction(world: DMat4, axis: DVec3) -> Option<DVec3> {
    world.transform_vector3(axis).try_normalize()
}
