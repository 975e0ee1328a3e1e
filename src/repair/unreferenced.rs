//! The step that drops vertices without a face.

use super::change::Step;
use super::weld::weld;
use crate::mesh::{Mesh, Weld};

/// Drops the vertices that no face uses; the others keep their order.
///
/// Guarantee: faces keep their number and order, and corners their positions, bit for bit. Vertices with
/// equal positions stay apart.
///
/// ```
/// use umbrage::mesh::Mesh;
/// use umbrage::{repair, testing::shapes};
/// let soup = shapes::soup(&shapes::cube());
/// assert_eq!(repair::drop_unreferenced(soup).1.count, 0);
/// let (positions, triangles, ..) = shapes::cube().into_parts();
/// let half = Mesh::new(positions, triangles[..2].to_vec())?;
/// assert_eq!(repair::drop_unreferenced(half).0.vertex_count(), 4);
/// # Ok::<(), umbrage::mesh::MeshError>(())
/// ```
#[must_use]
pub fn drop_unreferenced(mesh: Mesh) -> (Mesh, Step) {
    let (mesh, step) = weld(mesh, Weld::None);
    (mesh, Step { name: "unreferenced", ..step })
}
