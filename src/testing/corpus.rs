//! Small files with known defects: what a report on many files has to find in each.
//!
//! The numbers follow from what was put in, by counting, not from any code that looks for it.

use std::fmt::Write as _;

use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use hashbrown::HashSet;

use super::shapes;
use crate::mesh::Mesh;
use crate::random::SplitMix64;
use crate::write::{Layer, Model, Target, to_bytes};

/// A file of the corpus.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Specimen {
    /// The name, with the extension of its format.
    pub name: String,
    /// The content.
    pub bytes: Vec<u8>,
    /// What a report has to find.
    pub numbers: Numbers,
}

/// Numbers of a report, under the same names.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[expect(missing_docs, reason = "named as in a report, which says what they are")]
pub struct Numbers {
    pub faces: usize,
    pub shells: usize,
    pub boundary_edges: usize,
    pub boundary_loops: usize,
    pub non_manifold_edges: usize,
    pub misoriented_edges: usize,
    pub collapsed_faces: usize,
    pub duplicate_faces: usize,
    pub t_junctions: usize,
    pub inside_out_shells: usize,
}

impl Numbers {
    /// The names and the numbers.
    #[must_use]
    pub fn entries(&self) -> [(&'static str, usize); 10] {
        [
            ("faces", self.faces),
            ("shells", self.shells),
            ("boundary_edges", self.boundary_edges),
            ("boundary_loops", self.boundary_loops),
            ("non_manifold_edges", self.non_manifold_edges),
            ("misoriented_edges", self.misoriented_edges),
            ("collapsed_faces", self.collapsed_faces),
            ("duplicate_faces", self.duplicate_faces),
            ("t_junctions", self.t_junctions),
            ("inside_out_shells", self.inside_out_shells),
        ]
    }
}

/// File number `index` of the corpus: a closed surface of some hundred faces, with up to five defects far
/// from each other. Formats take turns: OBJ, GLB, binary PLY and STL as they are written here; text PLY, STL,
/// OFF and a glTF with its buffer inside.
///
/// ```
/// use umbrage::testing::corpus::specimen;
/// let file = specimen(12);
/// let scene = umbrage::read::read_bytes(&file.bytes, &file.name)?;
/// assert_eq!(scene.meshes[0].face_count(), file.numbers.faces);
/// # Ok::<(), umbrage::read::ReadError>(())
/// ```
#[must_use]
pub fn specimen(index: u32) -> Specimen {
    let mut random = SplitMix64(u64::from(index) + 1);
    let mut draft = Draft::new(&mut random);
    for _ in 0..random.below(6) {
        draft.spoil(&mut random);
    }
    let numbers = Numbers { faces: draft.triangles.len(), ..draft.numbers };
    let (extension, bytes) = encoded(&draft, index);
    Specimen { name: format!("{index:04}.{extension}"), bytes, numbers }
}

/// A mesh that is being spoiled.
struct Draft {
    positions: Vec<[f32; 3]>,
    triangles: Vec<[u32; 3]>,
    /// Vertices near a defect, where no other one goes.
    taken: HashSet<u32>,
    numbers: Numbers,
}

impl Draft {
    fn new(random: &mut SplitMix64) -> Self {
        let shape = match random.below(3) {
            0 => shapes::torus(12 + random.below(12) as u32, 8 + random.below(8) as u32, 2.0, 0.75),
            1 => shapes::icosphere(2),
            _ => shapes::torus_knot(2, 3, 24 + random.below(24) as u32, 5, 0.375),
        };
        // Powers of two round nothing.
        let scale = 2_f32.powi(random.below(13) as i32 - 6);
        let (positions, triangles, ..) = shapes::scaled(&shape, scale).into_parts();
        Self {
            positions,
            triangles,
            taken: HashSet::new(),
            numbers: Numbers { shells: 1, ..Numbers::default() },
        }
    }

    /// A face none of whose vertices is near a defect; its neighborhood is then taken.
    fn spot(&mut self, random: &mut SplitMix64) -> Option<usize> {
        let free = |&face: &usize| !self.triangles[face].iter().any(|vertex| self.taken.contains(vertex));
        let face = (0..40).map(|_| random.below(self.triangles.len())).find(free)?;
        let corners = self.triangles[face];
        let near = self.triangles.iter().filter(|other| other.iter().any(|vertex| corners.contains(vertex)));
        let near: Vec<u32> = near.flatten().copied().collect();
        self.taken.extend(near);
        Some(face)
    }

    fn spoil(&mut self, random: &mut SplitMix64) {
        let Some(face) = self.spot(random) else { return };
        let [a, b, c] = self.triangles[face];
        let new = self.positions.len() as u32; // a small mesh
        let at = |vertex: u32| self.positions[vertex as usize];
        let numbers = &mut self.numbers;
        match random.below(7) {
            // A hole.
            0 => {
                self.triangles.remove(face);
                numbers.boundary_edges += 3;
                numbers.boundary_loops += 1;
            }
            // A face turned over disagrees with three neighbors.
            1 => {
                self.triangles[face].swap(1, 2);
                numbers.misoriented_edges += 3;
            }
            // A face twice, wound like the first or against it: three edges of three faces.
            2 | 3 => {
                self.triangles.push(if random.below(2) == 0 { [b, c, a] } else { [a, c, b] });
                numbers.duplicate_faces += 1;
                numbers.non_manifold_edges += 3;
            }
            // A face with two equal corners has no edges.
            4 => {
                self.triangles.push([a, b, a]);
                numbers.collapsed_faces += 1;
            }
            // A fin: a third face at an edge, open at the two others.
            5 => {
                let size = at(b)[0].abs().max(at(b)[1].abs()).max(at(b)[2].abs());
                self.positions.push(at(a).map(|x| 3.0 * x + size));
                self.triangles.push([a, b, new]);
                numbers.non_manifold_edges += 1;
                numbers.boundary_edges += 2;
                numbers.boundary_loops += 1;
            }
            // A face cut in two at an edge whose other face is not: one long edge on two short ones.
            _ => {
                let (p, q) = (at(a), at(b));
                self.positions.push([0, 1, 2].map(|i| 0.5 * p[i] + 0.5 * q[i]));
                self.triangles[face] = [a, new, c];
                self.triangles.push([new, b, c]);
                numbers.boundary_edges += 3;
                numbers.boundary_loops += 1;
                numbers.t_junctions += 1;
            }
        }
        // A closed shell beside it that is inside out.
        if random.below(4) == 0 {
            let far = self.positions.iter().flatten().fold(0.0_f32, |most, x| most.max(x.abs())) * 4.0;
            let (positions, triangles, ..) = shapes::octahedron().into_parts();
            let first = self.positions.len() as u32;
            self.positions.extend(positions.iter().map(|p| p.map(|x| far + 0.125 * far * x)));
            self.triangles.extend(triangles.iter().map(|&[a, b, c]| [first + a, first + c, first + b]));
            self.taken.extend(first..self.positions.len() as u32);
            self.numbers.shells += 1;
            self.numbers.inside_out_shells += 1;
        }
    }
}

/// The file extension and the bytes of a mesh, in one of eight formats.
fn encoded(draft: &Draft, index: u32) -> (&'static str, Vec<u8>) {
    let (positions, triangles) = (&draft.positions, &draft.triangles);
    let written = |target: Target| {
        let mesh = Mesh::new(positions.clone(), triangles.clone()).expect("finite, with indices in range");
        to_bytes(&Model { layers: vec![Layer::from(&mesh)] }, target).expect("a plain mesh in any format")
    };
    let vertices = |before: &str| {
        positions.iter().fold(String::new(), |mut text, [x, y, z]| {
            let _ = writeln!(text, "{before}{x} {y} {z}");
            text
        })
    };
    let faces = triangles.iter().fold(String::new(), |mut text, [a, b, c]| {
        let _ = writeln!(text, "3 {a} {b} {c}");
        text
    });
    let (points, count) = (positions.len(), triangles.len());
    match index % 8 {
        0 => ("obj", written(Target::Obj)),
        1 => ("glb", written(Target::Glb)),
        2 => ("ply", written(Target::Ply)),
        3 => ("stl", written(Target::Stl)),
        4 => {
            let header = format!(
                "ply\nformat ascii 1.0\nelement vertex {points}\nproperty float x\nproperty float y\nproperty float \
                 z\nelement face {count}\nproperty list uchar int vertex_indices\nend_header\n"
            );
            ("ply", (header + &vertices("") + &faces).into_bytes())
        }
        5 => {
            let mut text = String::from("solid corpus\n");
            for corners in triangles {
                text.push_str("facet normal 0 0 0\nouter loop\n");
                for [x, y, z] in corners.map(|vertex| positions[vertex as usize]) {
                    let _ = writeln!(text, "vertex {x} {y} {z}");
                }
                text.push_str("endloop\nendfacet\n");
            }
            ("stl", (text + "endsolid corpus\n").into_bytes())
        }
        6 => ("off", (format!("OFF\n{points} {count} 0\n") + &vertices("") + &faces).into_bytes()),
        _ => ("gltf", gltf(positions, triangles).into_bytes()),
    }
}

fn gltf(positions: &[[f32; 3]], triangles: &[[u32; 3]]) -> String {
    let mut buffer: Vec<u8> = positions.iter().flatten().flat_map(|x| x.to_le_bytes()).collect();
    let (split, corners) = (buffer.len(), 3 * triangles.len());
    buffer.extend(triangles.iter().flatten().flat_map(|index| index.to_le_bytes()));
    let end = |pick: fn(f32, f32) -> f32| {
        let ends = [0, 1, 2].map(|i| positions.iter().map(|p| p[i]).reduce(pick).unwrap_or(0.0));
        format!("{ends:?}")
    };
    format!(
        r#"{{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[0]}}],"nodes":[{{"mesh":0}}],
"meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"indices":1}}]}}],
"accessors":[{{"bufferView":0,"componentType":5126,"type":"VEC3","count":{},"min":{},"max":{}}},
{{"bufferView":1,"componentType":5125,"type":"SCALAR","count":{corners}}}],
"bufferViews":[{{"buffer":0,"byteLength":{split}}},{{"buffer":0,"byteOffset":{split},"byteLength":{}}}],
"buffers":[{{"byteLength":{},"uri":"data:application/octet-stream;base64,{}"}}]}}
"#,
        positions.len(),
        end(f32::min),
        end(f32::max),
        4 * corners,
        buffer.len(),
        BASE64_STANDARD.encode(&buffer)
    )
}
