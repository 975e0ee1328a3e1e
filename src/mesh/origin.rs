//! The polygon of a file that a face was cut from.

use std::ops::Range;

use super::Mesh;
use super::steps::Steps;

/// The polygon of a file that a face is, or was cut from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct Origin {
    /// The number of the polygon among those of its mesh in the file, from 0.
    pub polygon: u32,
    /// The polygon's line in a text file, from 1.
    pub line: Option<u64>,
}

/// The polygons and lines of all faces, in the order of the faces.
///
/// Memory: some bytes for a file whose polygons all have the same number of corners, on lines at equal
/// distances. Otherwise 16 bytes for each change of the number of corners, and for each change of the
/// distance of lines; at most 16 bytes a polygon, since a run has two polygons at least.
#[derive(Clone, Debug, Default)]
pub(crate) struct Origins {
    /// The first face of each polygon.
    faces: Steps,
    /// The number of each polygon; empty if that is its index.
    polygons: Steps,
    /// The line of each polygon, 0 if it has none, up to the last one that has.
    lines: Steps,
}

impl Origins {
    /// The next polygon of a file.
    #[cfg(any(test, feature = "files"))]
    #[inline]
    pub(crate) fn push(&mut self, first_face: u32, line: Option<u64>) {
        self.faces.push(first_face.into());
        if let Some(line) = line {
            self.lines.push(line);
        }
    }

    /// The next `count` polygons of a file, of `triangles` triangles each.
    #[cfg(any(test, feature = "files"))]
    pub(crate) fn push_polygons(&mut self, first_face: u32, triangles: u32, count: u32) {
        self.faces.extend(first_face.into(), triangles, count);
    }

    /// Some faces of a mesh, as the next ones, from face `first_face` on.
    pub(crate) fn append(&mut self, mesh: &Mesh, faces: Range<u32>, first_face: u32) {
        let Some(origins) = mesh.origins.as_ref().filter(|_| !faces.is_empty()) else {
            let count = faces.end - faces.start;
            self.faces.extend(first_face.into(), 1, count);
            self.polygons.extend(faces.start.into(), 1, count);
            return;
        };
        if origins.have_lines() {
            // What came before on no line.
            self.lines.extend(0, 0, self.faces.len() - self.lines.len());
        }
        for index in origins.faces.index_of(faces.start.into())..origins.faces.len() {
            let first = origins.faces.get(index).unwrap_or(0).max(faces.start.into());
            if first >= u64::from(faces.end) {
                break;
            }
            let Origin { polygon, line } = origins.at(index);
            self.faces.push(u64::from(first_face) + first - u64::from(faces.start));
            self.polygons.push(polygon.into());
            if origins.have_lines() {
                self.lines.push(line.unwrap_or(0));
            }
        }
    }

    /// Whether any polygon has a line.
    fn have_lines(&self) -> bool {
        self.lines.len() > 0
    }

    /// Whether each of `face_count` faces is the polygon of its own number, on no line: nothing to remember.
    pub(crate) fn are_plain(&self, face_count: usize) -> bool {
        let as_many = self.faces.len() as usize == face_count;
        as_many && !self.have_lines() && self.faces.count_up() && self.polygons.count_up()
    }

    /// The polygon of a face.
    pub(crate) fn of(&self, face: u32) -> Origin {
        self.at(self.faces.index_of(face.into()))
    }

    fn at(&self, index: u32) -> Origin {
        let polygon = self.polygons.get(index).map_or(index, |polygon| polygon as u32); // it was one
        Origin { polygon, line: self.lines.get(index).filter(|&line| line > 0) }
    }

    /// Calls `each` with the faces of each polygon that has several, where there are `face_count` faces.
    #[cfg(any(test, feature = "files"))]
    pub(crate) fn for_each_n_gon(&self, face_count: u32, mut each: impl FnMut(Range<u32>)) {
        let mut runs = self.faces.runs().peekable();
        while let Some((first, step, count)) = runs.next() {
            let first = first as u32; // a face
            if step > 1 {
                (0..count - 1).for_each(|k| each(first + k * step..first + (k + 1) * step));
            }
            let last = first + (count - 1) * step;
            let end = runs.peek().map_or(face_count, |next| next.0 as u32);
            if end - last > 1 {
                each(last..end);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{FaceId, Part};
    use crate::random::SplitMix64;
    use crate::scene::{Scene, Scope};

    /// Origins of polygons of random sizes on random lines, and what they are, face by face.
    fn random(seed: u64) -> (Origins, Vec<Origin>) {
        let mut random = SplitMix64(seed);
        let mut below = |n: u64| random.next() % n;
        let (mut origins, mut naive) = (Origins::default(), Vec::new());
        let (mut line, variety) = (1, 1 + seed % 4);
        for polygon in 0..100 {
            line += 1 + below(variety) / 2;
            origins.push(naive.len() as u32, Some(line));
            let faces = if below(4) < variety { below(5) } else { 1 };
            naive.extend((0..faces).map(|_| Origin { polygon, line: Some(line) }));
        }
        (origins, naive)
    }

    fn soup(faces: usize) -> Mesh {
        let positions = (0..3 * faces).map(|i| [i as f32, (i * i) as f32, 1.0]).collect();
        Mesh::new(positions, (0..faces as u32).map(|f| [3 * f, 3 * f + 1, 3 * f + 2]).collect()).unwrap()
    }

    fn all(mesh: &Mesh) -> Vec<Origin> {
        (0..mesh.face_count()).map(|face| mesh.origin(FaceId::new(face))).collect()
    }

    #[test]
    fn origins_are_those_face_by_face() {
        for seed in 0..200 {
            let (origins, naive) = random(seed);
            let found: Vec<Origin> = (0..naive.len() as u32).map(|face| origins.of(face)).collect();
            assert_eq!(found, naive, "seed {seed}");
            let mut n_gons = Vec::new();
            origins.for_each_n_gon(naive.len() as u32, |faces| n_gons.push(faces));
            let expected: Vec<Range<u32>> = naive
                .chunk_by(|a, b| a == b)
                .map(|faces| {
                    let start = naive.partition_point(|origin| origin.polygon < faces[0].polygon) as u32;
                    start..start + faces.len() as u32
                })
                .filter(|faces| faces.len() > 1)
                .collect();
            assert_eq!(n_gons, expected, "seed {seed}");
        }
    }

    #[test]
    fn origins_of_equal_polygons_take_some_bytes() {
        for (corners, lines) in [(3, 7), (4, 1), (6, 2)] {
            let mut origins = Origins::default();
            (0..100_000).for_each(|i| origins.push(i * (corners - 2), Some(u64::from(10 + lines * i))));
            assert_eq!([&origins.faces, &origins.lines].map(|steps| steps.runs().count()), [1, 1]);
            let face = 77_777 * (corners - 2);
            let expected = Origin { polygon: 77_777, line: Some(u64::from(10 + lines * 77_777)) };
            assert_eq!([face, face + corners - 3].map(|face| origins.of(face)), [expected; 2]);
        }
        let mut triangles = Origins::default();
        triangles.push_polygons(0, 1, 1000);
        (1000..2000).for_each(|face| triangles.push(face, None));
        assert!(triangles.are_plain(2000));
        // Fault injected: the last polygon is of two triangles, or one before it.
        assert!(!triangles.are_plain(2001));
        triangles.push(2001, None);
        assert!(!triangles.are_plain(2002));
    }

    #[test]
    fn origins_follow_their_faces_through_scopes_and_joins() {
        for seed in 0..50 {
            let (origins, naive) = random(seed);
            let faces = naive.len() as u32;
            let cut = faces / 3;
            let mesh = soup(naive.len()).with_origins(origins);
            assert_eq!(all(&mesh), naive);
            let parts = vec![Part::new("low", 0..cut), Part::new("high", cut..faces)];
            let mut scene = Scene::of(mesh.clone().with_parts(parts));
            let pieces = scene.clone().bake(Scope::Primitive).unwrap();
            assert_eq!(pieces.iter().flat_map(all).collect::<Vec<_>>(), naive);
            // Without its first part.
            scene.retain(|part| part.names().any(|name| name == "high")).unwrap();
            let kept = scene.clone().bake(Scope::Mesh).unwrap().remove(0);
            assert_eq!(all(&kept), naive[cut as usize..]);
            // Twice, the second one moved and mirrored, beside a mesh that knows no lines.
            scene.instances.push(scene.instances[0].clone());
            scene.instances[1].world_from_mesh = glam::Mat4::from_scale(glam::vec3(-1.0, 2.0, 1.0));
            scene.meshes.push(soup(5));
            scene.instances.push(crate::scene::Instance { mesh: 1, ..scene.instances[0].clone() });
            let joined = scene.bake(Scope::Scene).unwrap().remove(0);
            let plain = (0..5).map(|polygon| Origin { polygon, line: None });
            let twice = [&naive[cut as usize..]; 2].concat();
            assert_eq!(all(&joined), twice.into_iter().chain(plain).collect::<Vec<_>>());
        }
    }
}
