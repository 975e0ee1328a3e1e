//! Fans: the faces around a vertex, as far as they hang together through edges at that vertex.

use super::Topology;
use crate::mesh::{FaceId, VertexId};

/// What the stars of the vertices tell.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Fans {
    /// At each vertex with several fans, the lowest-numbered face of each of them; ascending.
    pub(crate) several: Vec<(VertexId, FaceId)>,
    /// How many vertices have a face at all.
    pub(crate) vertices: usize,
    /// Whether the two faces of some edge have the same third vertex: without that, and without edges of
    /// three faces or more, no face is a duplicate.
    pub(crate) folded: bool,
}

impl Topology {
    /// Vertices whose faces form more than one fan, that is, are not all connected through edges at the
    /// vertex; ascending, each with its number of fans.
    #[must_use]
    pub fn non_manifold_vertices(&self) -> Vec<(VertexId, u32)> {
        let several = &self.survey().fans.several;
        several.chunk_by(|a, b| a.0 == b.0).map(|fans| (fans[0].0, fans.len() as u32)).collect()
    }

    /// Which vertices have several fans.
    pub(crate) fn fans(&self) -> &Fans {
        &self.survey().fans
    }
}
