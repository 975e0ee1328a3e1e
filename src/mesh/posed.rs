//! Posed meshes: their vertices are one by where they stand at rest, so that adjacency is that of every pose.

use std::sync::Arc;

use hashbrown::HashMap;

use super::weld::{Weld, Welded, weld_in_place};
use super::{Mesh, VertexId};

/// Welds a posed mesh: vertices are one if they are at rest, in all frames, and if the same joints move them
/// by the same weights. Of those that become one the first one's position stays, and equal ones are moved
/// alike.
pub(super) fn weld(mut mesh: Mesh, rest: &[[f32; 3]], how: Weld) -> Welded {
    let posed = std::mem::replace(&mut mesh.positions, rest.to_vec());
    if let Some(movers) = mesh.skin.take() {
        mesh.frames.extend(as_frames(&movers));
    }
    let mut welded = weld_in_place(mesh, how);
    welded.mesh.frames = Vec::new();
    let mut positions = vec![[0.0; 3]; welded.mesh.vertex_count()];
    for (vertex, &position) in posed.iter().enumerate().rev() {
        if let Some(new) = welded.vertex_of(VertexId(vertex as u32)) {
            positions[new.index()] = position;
        }
    }
    welded.mesh.positions = positions;
    welded
}

/// Numbers as frames in which vertices of different numbers are farther apart than any weld distance: the
/// corners of a cube of the side 2 · `f32::MAX`, three bits of the number a frame.
pub(crate) fn as_frames(numbers: &[u32]) -> Vec<Vec<[f32; 3]>> {
    let bits = 32 - numbers.iter().max().map_or(0, |most| most.leading_zeros()).min(32);
    let far = |number: u32, bit: u32| match number.checked_shr(bit).unwrap_or(0) & 1 {
        0 => -f32::MAX,
        _ => f32::MAX,
    };
    let frame =
        |first: u32| numbers.iter().map(|&number| [0, 1, 2].map(|axis| far(number, first + axis))).collect();
    (0..bits).step_by(3).map(frame).collect()
}

/// What moves the vertices of posed meshes one after the other, and where they stand at rest. Equal numbers
/// of different meshes are the same mover; where frames differ, so do the movers.
pub(super) fn concatenated(meshes: &[Mesh]) -> (Vec<[f32; 3]>, Vec<u32>) {
    let (mut rest, mut movers) = (Vec::new(), Vec::new());
    let mut numbers: HashMap<(u32, Vec<[u32; 3]>), u32> = HashMap::new();
    for mesh in meshes {
        rest.extend_from_slice(mesh.rest.as_deref().unwrap_or(&mesh.positions));
        for vertex in 0..mesh.vertex_count() {
            let mover = mesh.skin.as_ref().map_or(0, |skin| skin[vertex]);
            let frames = mesh.frames.iter().map(|frame| frame[vertex].map(f32::to_bits)).collect();
            let next = numbers.len() as u32; // at most one a vertex
            movers.push(*numbers.entry((mover, frames)).or_insert(next));
        }
    }
    (rest, movers)
}

/// The same positions, each moved; −0.0 becomes +0.0, as everywhere in a mesh.
pub(crate) fn moved(
    positions: Option<&Arc<Vec<[f32; 3]>>>,
    by: impl Fn([f32; 3]) -> [f32; 3],
) -> Option<Arc<Vec<[f32; 3]>>> {
    positions
        .map(|positions| Arc::new(positions.iter().map(|&position| by(position).map(|x| x + 0.0)).collect()))
}
