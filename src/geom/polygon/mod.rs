//! Polygons to triangles: every corner stays a corner, every side is used once in its direction, and no two
//! triangles of a polygon overlap unless it crosses itself.
//!
//! A polygon is seen along the axis that its normal is closest to, in the exact plane of the two others. It
//! may be concave, touch itself, and run round its holes over bridges (a side walked there and back).
//! Triangles without area are made only where corners coincide or where the polygon has no width. The result
//! depends on positions alone, not on the first corner.

mod cut;
mod monotone;
mod outline;
mod quad;
mod status;
mod sweep;

pub(crate) use cut::Cutter;
pub(crate) use quad::Quad;
