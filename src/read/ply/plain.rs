//! Layouts that nearly every binary file has, read in runs: vertices of nothing but numbers, their positions
//! as `float`; triangles and quads that are one list of 32-bit indices after a byte.
//!
//! A run ends before the first item that is wrong or rare. That one is read as any other, which also finds
//! the words for what is wrong with it.

use super::header::{Element, Kind, Number};

/// The offset of the coordinates among the bytes of a vertex.
pub(super) struct Points {
    size: usize,
    axes: [usize; 3],
}

impl Points {
    /// `axes` are the properties that hold the coordinates.
    pub(super) fn of(element: &Element, axes: [usize; 3]) -> Option<Self> {
        let (mut size, mut starts) = (0, [0; 3]);
        for (at, property) in element.properties.iter().enumerate() {
            let Kind::Scalar(number) = property.kind else { return None };
            if let Some(axis) = axes.iter().position(|&axis| axis == at) {
                if number != Number::F32 {
                    return None;
                }
                starts[axis] = size;
            }
            size += number.bytes() as usize;
        }
        Some(Self { size, axes: starts })
    }

    /// Adds at most `most` vertices; how many bytes they had.
    pub(super) fn read(&self, bytes: &[u8], most: u64, positions: &mut Vec<[f32; 3]>) -> usize {
        let before = positions.len();
        for vertex in bytes.chunks_exact(self.size).take(usize::try_from(most).unwrap_or(usize::MAX)) {
            let [x, y, z] = self.axes;
            let position = [number(vertex, x), number(vertex, y), number(vertex, z)].map(f32::from_bits);
            if !(position[0].is_finite() & position[1].is_finite() & position[2].is_finite()) {
                break;
            }
            positions.push(position);
        }
        self.size * (positions.len() - before)
    }
}

/// What bounds the indices of faces.
pub(super) struct Polygons {
    /// Every index is below.
    end: u32,
}

impl Polygons {
    pub(super) fn of(element: &Element, vertex_count: u64) -> Option<Self> {
        let [property] = element.properties.as_slice() else { return None };
        let most = match property.kind {
            Kind::List { length: Number::U8 | Number::I8, item: Number::U32 } => u32::MAX,
            // What is negative has its top bit set.
            Kind::List { length: Number::U8 | Number::I8, item: Number::I32 } => 1 << 31,
            _ => return None,
        };
        Some(Self { end: u32::try_from(vertex_count).unwrap_or(u32::MAX).min(most) })
    }

    /// Adds at most `most` polygons of `N` corners, as fans around their first corner; how many there were,
    /// and how many bytes they had.
    #[inline]
    pub(super) fn read<const N: usize>(
        &self,
        bytes: &[u8],
        most: u64,
        triangles: &mut Vec<[u32; 3]>,
    ) -> (u64, usize) {
        let size = 1 + 4 * N; // how many corners, and these
        let mut count = 0;
        for face in bytes.chunks_exact(size).take(usize::try_from(most).unwrap_or(usize::MAX)) {
            let corners: [u32; N] = std::array::from_fn(|i| number(face, 1 + 4 * i));
            if usize::from(face[0]) != N || corners.iter().any(|&corner| corner >= self.end) {
                break;
            }
            for i in 2..N {
                triangles.push([corners[0], corners[i - 1], corners[i]]);
            }
            count += 1;
        }
        (count, size * count as usize)
    }
}

#[inline(always)]
fn number(bytes: &[u8], at: usize) -> u32 {
    u32::from_le_bytes(*bytes[at..].first_chunk().expect("inside the item"))
}
