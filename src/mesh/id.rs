//! Ids are types: four bytes each, the same on the CPU and the GPU.

use bytemuck::{Pod, Zeroable};

macro_rules! id {
    ($(#[$doc:meta])* $name:ident) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Pod, Zeroable)]
        #[repr(transparent)]
        pub struct $name(
            /// The index itself.
            pub u32,
        );

        impl $name {
            /// The id of the thing at `index`.
            ///
            /// # Panics
            ///
            /// Panics if `index` does not fit in 32 bits.
            #[inline]
            #[must_use]
            pub fn new(index: usize) -> Self {
                Self(u32::try_from(index).expect("an id is an index below 2^32"))
            }

            /// The id as an index into a slice.
            #[inline]
            #[must_use]
            pub fn index(self) -> usize {
                self.0 as usize
            }
        }
    };
}

id!(
    /// A vertex: an index into the positions.
    VertexId
);
id!(
    /// A half-edge: corner `h` of the triangle list, directed from that corner's vertex to the next one's.
    HalfEdgeId
);
id!(
    /// An undirected edge: an index into the edge table of a [`Topology`](crate::topology::Topology).
    EdgeId
);
id!(
    /// A face: an index into the triangles.
    FaceId
);
