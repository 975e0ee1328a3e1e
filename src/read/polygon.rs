//! The polygons of a file, cut into triangles by [`geom::polygon`](crate::geom::polygon).

use std::ops::Range;

use super::text::counted;
use crate::geom::polygon::{Cutter, Quad};
use crate::mesh::Origins;

/// The faces of a file, as they come: polygons of three corners or more.
///
/// Polygons are cut at the end, since a file may name vertices that come later. Until then each is a fan
/// around its first corner, which holds its corners in sequence, in as many triangles as it will have.
#[derive(Default)]
pub(super) struct Faces {
    pub(super) triangles: Vec<[u32; 3]>,
    origins: Origins,
    n_gons: u64,
    /// Faces of strips, which are cut already.
    strips: Range<u32>,
    /// The first and the previous corner of the current polygon, and how many there are.
    first: u32,
    previous: u32,
    corners: u64,
}

/// What [`Faces::cut`] makes of the faces of a file.
pub(super) struct Cut {
    pub(super) triangles: Vec<[u32; 3]>,
    pub(super) origins: Origins,
    pub(super) notes: Vec<String>,
}

impl Faces {
    /// The next corner of the current polygon.
    #[inline]
    pub(super) fn corner(&mut self, vertex: u32) {
        match self.corners {
            0 => self.first = vertex,
            1 => {}
            _ => self.triangles.push([self.first, self.previous, vertex]),
        }
        self.previous = vertex;
        self.corners += 1;
    }

    /// A polygon of three corners, on `line` of a text file: the same as three corners and an end, in less
    /// time.
    #[inline]
    pub(super) fn triangle(&mut self, corners: [u32; 3], line: Option<u64>) {
        self.origins.push(self.triangles.len() as u32, line);
        self.triangles.push(corners);
    }

    /// Ends the current polygon, from `line` of a text file, and returns the number of its corners. One of
    /// fewer than three is counted among the polygons of the file, and has no triangle.
    #[inline]
    pub(super) fn end(&mut self, line: Option<u64>) -> u64 {
        let corners = std::mem::take(&mut self.corners);
        let triangles = corners.saturating_sub(2);
        self.n_gons += u64::from(triangles > 1);
        // A count that does not fit 32 bits is refused by `Mesh::new` before origins are used.
        self.origins.push(self.triangles.len() as u32 - triangles as u32, line);
        corners
    }

    /// Counts the triangles that were added to the list since the last polygon, fans included: `count`
    /// polygons of `triangles` triangles each.
    pub(super) fn end_polygons(&mut self, count: u64, triangles: u32) {
        self.n_gons += if triangles > 1 { count } else { 0 };
        let first = (self.triangles.len() as u32).wrapping_sub(count as u32 * triangles);
        self.origins.push_polygons(first, triangles, count as u32);
    }

    /// Counts the triangles that were added to the list since face `first` as one polygon: a strip. All
    /// strips of a file come one after the other.
    pub(super) fn end_strip(&mut self, first: usize, line: Option<u64>) {
        if self.strips.is_empty() {
            self.strips.start = first as u32;
        }
        self.strips.end = self.triangles.len() as u32;
        self.origins.push(first as u32, line);
    }

    /// Cuts all polygons. Every corner must name one of the `positions`.
    pub(super) fn cut(mut self, positions: &[[f32; 3]]) -> Cut {
        let mut notes = Vec::new();
        if self.n_gons > 0 {
            let first_crossed = self.cut_n_gons(positions);
            notes.push(format!("{} cut into triangles", counted(self.n_gons, "n-gon")));
            if let (count @ 1.., Some(first)) = first_crossed {
                notes.push(self.crossed(count, first));
            }
        }
        Cut { triangles: self.triangles, origins: self.origins, notes }
    }

    /// How many polygons cross themselves, and the first face of the first of them.
    fn cut_n_gons(&mut self, positions: &[[f32; 3]]) -> (u64, Option<u32>) {
        let (mut crossed, mut first_crossed) = (0, None);
        let mut cutter = Cutter::default();
        self.origins.for_each_n_gon(self.triangles.len() as u32, |faces| {
            let first = faces.start;
            if self.strips.contains(&first) {
                return;
            }
            let fan = &mut self.triangles[faces.start as usize..faces.end as usize];
            let simple = match fan {
                [[a, b, c], last] => {
                    let corners = [*a, *b, *c, last[2]];
                    let quad = Quad::of(corners.map(|vertex| positions[vertex as usize]));
                    // By index, not by a branch: nobody can guess which diagonal is shorter.
                    let corner = |i: usize| corners[(quad.from + i) % 4];
                    fan[0] = [corner(0), corner(1), corner(2)];
                    fan[1] = [corner(0), corner(2), corner(3)];
                    !quad.crosses
                }
                _ => {
                    cutter.ring.clear();
                    cutter.ring.extend_from_slice(&fan[0][..2]);
                    cutter.ring.extend(fan.iter().map(|triangle| triangle[2]));
                    cutter.cut(positions, fan)
                }
            };
            if !simple {
                crossed += 1;
                first_crossed.get_or_insert(first);
            }
        });
        (crossed, first_crossed)
    }

    fn crossed(&self, count: u64, first: u32) -> String {
        let origin = self.origins.of(first);
        let polygons = match count {
            1 => "1 polygon crosses itself".to_owned(),
            _ => format!("{count} polygons cross themselves"),
        };
        let line = origin.line.map_or(String::new(), |line| format!("line {line}, "));
        format!("{polygons}, so that triangles overlap; the first: {line}polygon {}", origin.polygon)
    }
}
