//! Skinned meshes: vertices of one position that joints move differently stay apart in repair.

use assert_cmd::cargo::cargo_bin_cmd;
use serde_json::{Value, json};
use umbrage::mesh::{Mesh, Weld, weld};
use umbrage::read::read_bytes;
use umbrage::repair::{Options, prepare, shadow_indices};

use super::{Builder, f32s};

/// A band of two quads, each with vertices of its own. The joints of the second quad are the first one's, or
/// others; two of its corners lie at those of the first. Weightless joints and the order of joints differ.
struct Band {
    positions: Vec<[f32; 3]>,
    joints: Vec<[u8; 4]>,
    weights: Vec<[f32; 4]>,
}

impl Band {
    fn new(second: u8) -> Self {
        let x = [0.0, 1.0, 1.0, 0.0, 1.0, 2.0, 2.0, 1.0];
        let y = [0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 1.0, 1.0];
        let joints = (0..8).map(|vertex| match vertex {
            0..4 => [0, 1, 9, 9],
            _ => [1, second, 3, 3],
        });
        let weights =
            (0..8).map(|vertex| if vertex < 4 { [0.25, 0.75, 0.0, 0.0] } else { [0.75, 0.25, 0.0, 0.0] });
        Self {
            positions: (0..8).map(|vertex| [x[vertex], y[vertex], 0.0]).collect(),
            joints: joints.collect(),
            weights: weights.collect(),
        }
    }

    fn builder(&self, skinned: bool) -> Builder {
        let mut builder = Builder::mesh(&self.positions, 4, Some(&[0, 1, 2, 0, 2, 3, 4, 5, 6, 4, 6, 7]));
        let joints = builder.accessor(5121, "VEC4", 8, self.joints.as_flattened());
        let weights = builder.accessor(5126, "VEC4", 8, &f32s(self.weights.as_flattened()));
        let attributes = &mut builder.doc["meshes"][0]["primitives"][0]["attributes"];
        (attributes["JOINTS_0"], attributes["WEIGHTS_0"]) = (joints.into(), weights.into());
        if skinned {
            builder.doc["nodes"] = json!([{"mesh": 0, "skin": 0}]);
            builder.doc["skins"] = json!([{"joints": [0]}]);
        }
        builder
    }

    fn mesh(&self, skinned: bool) -> Mesh {
        read_bytes(&self.builder(skinned).glb(), "a.glb").unwrap().meshes.remove(0)
    }

    /// Where each vertex is once joint `k` has moved by `k²` along z.
    fn posed(&self) -> Vec<f32> {
        let moved = |vertex: usize| {
            let by = self.joints[vertex].iter().zip(self.weights[vertex]);
            by.map(|(&joint, weight)| f32::from(joint).powi(2) * weight).sum()
        };
        (0..8).map(moved).collect()
    }

    /// Corners of faces drawn by `indices` that the pose moves elsewhere than the file's own indices.
    fn torn(&self, mesh: &Mesh, indices: &[[u32; 3]]) -> usize {
        let posed = self.posed();
        let pairs = mesh.triangles().as_flattened().iter().zip(indices.as_flattened());
        pairs.filter(|&(&own, &other)| posed[own as usize] != posed[other as usize]).count()
    }
}

fn indices(mesh: &Mesh) -> (Vec<[u32; 3]>, usize) {
    let mut prepared = prepare(mesh.clone(), &Options::default()).unwrap();
    let weld = prepared.steps.remove(0);
    (shadow_indices(mesh, &prepared.mesh).unwrap(), weld.left)
}

#[test]
fn skin_that_parts_vertices_of_one_position_keeps_them_apart() {
    let parted = Band::new(2);
    let mesh = parted.mesh(true);
    let (found, apart) = indices(&mesh);
    assert_eq!((parted.torn(&mesh, &found), apart), (0, 2));
    // Fault injected: without its skin, the file reads as a band that tears in the pose.
    let still = parted.mesh(false);
    let (found, apart) = indices(&still);
    assert!(parted.torn(&still, &found) > 0 && apart == 0);
    // Where the same joints have the same weights, in whatever order, the band is one.
    let whole = Band::new(0);
    let (found, apart) = indices(&whole.mesh(true));
    assert_eq!((whole.torn(&whole.mesh(true), &found), apart), (0, 0));
    assert!(found.as_flattened().iter().all(|&vertex| vertex != 4 && vertex != 7));
    // All other commands weld by position, as before.
    assert_eq!(weld(&mesh, Weld::Exact).mesh.vertex_count(), 6);
}

#[test]
fn skin_that_cannot_be_read_is_noted_and_parts_nothing() {
    let band = Band::new(2);
    let mut builder = band.builder(true);
    let joints = builder.doc["meshes"][0]["primitives"][0]["attributes"]["JOINTS_0"].as_u64().unwrap();
    builder.doc["accessors"][joints as usize]["count"] = 7.into();
    let scene = read_bytes(&builder.glb(), "a.glb").unwrap();
    let said = "joints and weights that cannot be read ignored: has 7 joints and 8 weights for 8 vertices";
    assert!(scene.notes.iter().any(|note| note.contains(said)), "{:?}", scene.notes);
    assert_eq!(indices(&scene.meshes[0]).1, 0);
}

#[test]
fn skin_is_kept_apart_by_the_command_and_read_back_so() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("band.glb"), Band::new(2).builder(true).glb()).unwrap();
    let run = |arguments: &str| {
        let mut command = cargo_bin_cmd!("umbrage");
        let output = command.current_dir(folder.path()).args(arguments.split(' ')).output().unwrap();
        (output.status.code().unwrap(), String::from_utf8(output.stdout).unwrap())
    };
    let (code, text) = run("prepare band.glb -o out.glb --shadow-indices shadow.bin");
    assert!(code == 0 && text.contains("2 left") && text.contains("what the skin parts"), "{text}");
    let (code, text) = run("prepare band.glb -o out.ply --json");
    let document: Value = serde_json::from_str(&text).unwrap();
    assert_eq!((code, &document["steps"][0]["left"], &document["verified"]), (0, &2.into(), &true.into()));
    // STL cannot keep them apart: nothing is written.
    assert_eq!(run("prepare band.glb -o out.stl").0, 1);
    assert!(!folder.path().join("out.stl").exists());
}
