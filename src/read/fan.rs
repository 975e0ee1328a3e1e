//! Polygons to triangles.

/// Cuts a polygon into a fan around its first corner, as its corners come.
///
/// The fan has the polygon's boundary, whatever the polygon's shape, so no crack can come of it; on a
/// polygon that is not convex it may fold over itself.
#[derive(Default)]
pub(super) struct Fan {
    first: u32,
    previous: u32,
    /// How many corners came.
    pub(super) corners: u64,
}

impl Fan {
    /// The next corner.
    #[inline]
    pub(super) fn corner(&mut self, vertex: u32, triangles: &mut Vec<[u32; 3]>) {
        match self.corners {
            0 => self.first = vertex,
            1 => {}
            _ => triangles.push([self.first, self.previous, vertex]),
        }
        self.previous = vertex;
        self.corners += 1;
    }
}
