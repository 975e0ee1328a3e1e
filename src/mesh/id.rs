//! Typed ids of vertices, half-edges, edges and faces: four bytes each, with the same layout on the CPU and
//! the GPU.

use bytemuck::{Pod, Zeroable};

macro_rules! id {
    ($(#[$doc:meta])* $name:ident) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Pod, Zeroable)]
        #[repr(transparent)]
        pub struct $name(
            /// The index.
            pub u32,
        );

        impl $name {
            /// The id of the element at `index`.
            ///
            /// # Panics
            ///
            /// Panics if `index` does not fit in 32 bits.
            #[inline]
            #[must_use]
            pub fn new(index: usize) -> Self {
                Self(u32::try_from(index).expect("an id is an index below 2^32"))
            }

            /// The id as a slice index.
            #[inline]
            #[must_use]
            pub fn index(self) -> usize {
                self.0 as usize
            }
        }
    };
}

id!(
    /// Id of a vertex: an index into the positions.
    VertexId
);
id!(
    /// Id of a half-edge: corner `h` of the triangle list, directed from the vertex of that corner to the
    /// vertex of the next corner of the same triangle.
    HalfEdgeId
);
id!(
    /// Id of an undirected edge: an index into the edge table of a [`Topology`](crate::topology::Topology).
    EdgeId
);
id!(
    /// Id of a face: an index into the triangles.
    FaceId
);
