//! Mesh file writers: one format per module, chosen by the extension, each file written completely or not at
//! all.
//!
//! | carries | `.obj` | `.ply` | `.glb` | [STL](Target::Stl) |
//! |---|---|---|---|---|
//! | positions, bit for bit | yes | yes | yes | yes |
//! | vertices that faces share | yes | yes | yes | no |
//! | layers | objects | one after another, named in comments | nodes | one after another |
//! | parts | groups | no | no | no |
//! | color | no | `red green blue alpha`, sRGB | an unlit material | no |
//! | homogeneous w | no | `w` | attribute `_W` | refused |
//! | quality | no | `quality`, and in the color | attribute `_QUALITY` | no |
//! | triangles, lines | `f`, `l` | elements `face`, `edge` | modes 4, 1 | triangles; lines are refused |
//! | points | `p` | the vertices alone | mode 0 | refused |
//!
//! The same model gives the same bytes.

mod atomic;
mod error;
mod glb;
mod obj;
mod occlusion;
mod ply;
mod stl;

use std::fmt;
use std::io::Write;
use std::path::Path;

// For the command, which is a crate of its own: it writes its tables and documents like every other file, and
// leaves nothing half written when a signal ends it.
#[doc(hidden)]
pub use atomic::{abandon, write_atomic};
pub use error::WriteError;
pub use occlusion::{
    Form, GltfFile, Occlusion, OcclusionOptions, Written, glb_with_occlusion, with_occlusion,
};

use crate::mesh::{Mesh, Part};

/// Name and version of this program, as files carry them.
const GENERATOR: &str = concat!("umbrage ", env!("CARGO_PKG_VERSION"));

/// Content of a file: layers in the same space.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Model {
    /// The layers, in the order of the file.
    pub layers: Vec<Layer>,
}

/// Vertices, and triangles, lines or points on them: a mesh, a silhouette, markers.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Layer {
    /// Name of the layer; may be empty.
    pub name: String,
    /// Linear red, green, blue and opacity, each from 0 to 1.
    pub color: Option<[f32; 4]>,
    /// Positions: finite, in mesh units, right-handed.
    pub positions: Vec<[f32; 3]>,
    /// Homogeneous w per vertex, if there is one: with 0 the position is a direction, and the vertex lies at
    /// infinity.
    pub w: Option<Vec<f32>>,
    /// A value per vertex from 0 to 1, if there is one: how bright it is, times the color.
    pub quality: Option<Vec<f32>>,
    /// Triangles, lines or points between the vertices.
    pub elements: Elements,
    /// Named ranges of elements, in ascending order and without overlap; may be empty.
    pub parts: Vec<Part>,
}

/// Indices into the positions of a [`Layer`].
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Elements {
    /// Faces, counter-clockwise from the front.
    Triangles(Vec<[u32; 3]>),
    /// Line segments.
    Lines(Vec<[u32; 2]>),
    /// Single vertices.
    Points(Vec<u32>),
}

impl Default for Elements {
    fn default() -> Self {
        Self::Triangles(Vec::new())
    }
}

impl Elements {
    /// Number of triangles, lines or points.
    #[must_use]
    pub fn len(&self) -> usize {
        match self {
            Self::Triangles(triangles) => triangles.len(),
            Self::Lines(lines) => lines.len(),
            Self::Points(points) => points.len(),
        }
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// All indices in order: three, two or one per element.
    #[must_use]
    pub fn indices(&self) -> &[u32] {
        match self {
            Self::Triangles(triangles) => triangles.as_flattened(),
            Self::Lines(lines) => lines.as_flattened(),
            Self::Points(points) => points,
        }
    }
}

impl From<&Mesh> for Layer {
    /// A copy of the mesh's first frame, without color.
    fn from(mesh: &Mesh) -> Self {
        Self {
            name: mesh.name.clone(),
            positions: mesh.positions().to_vec(),
            elements: Elements::Triangles(mesh.triangles().to_vec()),
            parts: mesh.parts().to_vec(),
            ..Self::default()
        }
    }
}

/// A file format that can be written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Target {
    /// Wavefront OBJ, text.
    Obj,
    /// Polygon file format, binary, little-endian.
    Ply,
    /// glTF 2.0, binary container.
    Glb,
    /// STL, binary: triangles alone. Never chosen by an extension, since it loses which faces share vertices.
    Stl,
}

impl Target {
    /// The format that the extension of `path` names, in any case; one that holds layers of any kind.
    ///
    /// # Errors
    ///
    /// [`WriteError`] if the extension is none of `obj`, `ply` and `glb`.
    pub fn from_path(path: impl AsRef<Path>) -> Result<Self, WriteError> {
        let path = path.as_ref();
        let extension = path.extension().map(|extension| extension.to_string_lossy().to_ascii_lowercase());
        match extension.as_deref() {
            Some("obj") => Ok(Self::Obj),
            Some("ply") => Ok(Self::Ply),
            Some("glb") => Ok(Self::Glb),
            other => {
                let problem = match other {
                    Some(other) => format!("the extension .{other} names no format that can be written"),
                    None => "the format is chosen by the extension, and there is none".to_owned(),
                };
                Err(WriteError::new(problem, "use .obj, .ply or .glb").in_file(path))
            }
        }
    }
}

impl fmt::Display for Target {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Obj => "obj",
            Self::Ply => "ply",
            Self::Glb => "glb",
            Self::Stl => "stl",
        })
    }
}

/// Writes `model` to the file `path`, in the format of its extension, completely or not at all.
///
/// The bytes go to a temporary file in the same folder, are flushed to the disk, and the file is then renamed
/// to `path` in one step. An existing file keeps its permissions; of a symbolic link, its target is replaced.
///
/// # Errors
///
/// [`WriteError`] if the extension is unknown, the model breaks the rules in [`Layer`] or is too large for
/// the format, or the file cannot be written. An existing file is then untouched.
pub fn write(model: &Model, path: impl AsRef<Path>) -> Result<(), WriteError> {
    let path = path.as_ref();
    let target = Target::from_path(path)?;
    write_atomic(path, |writer| write_to(model, target, writer))
}

/// Writes `model` as `target` into `writer`. Many small writes: buffer a file.
///
/// # Errors
///
/// [`WriteError`] if the model breaks the rules in [`Layer`] or is too large for the format, before the first
/// byte; or if `writer` fails.
pub fn write_to(model: &Model, target: Target, writer: &mut dyn Write) -> Result<(), WriteError> {
    for (index, layer) in model.layers.iter().enumerate() {
        check(layer).map_err(|(problem, remedy)| {
            WriteError::new(format!("layer {} ({:?}): {problem}", index + 1, layer.name), remedy)
        })?;
    }
    match target {
        Target::Obj => obj::write(model, writer)?,
        Target::Ply => ply::write(model, writer)?,
        Target::Glb => glb::write(model, writer)?,
        Target::Stl => stl::write(model, writer)?,
    }
    Ok(())
}

/// The bytes of `model` as `target`.
///
/// # Errors
///
/// [`WriteError`] if the model breaks the rules in [`Layer`] or is too large for the format.
///
/// ```
/// use umbrage::testing::shapes;
/// use umbrage::write::{Layer, Model, Target, to_bytes};
/// let model = Model { layers: vec![Layer::from(&shapes::cube())] };
/// assert!(to_bytes(&model, Target::Glb)?.starts_with(b"glTF"));
/// # Ok::<(), umbrage::write::WriteError>(())
/// ```
pub fn to_bytes(model: &Model, target: Target) -> Result<Vec<u8>, WriteError> {
    let mut bytes = Vec::new();
    write_to(model, target, &mut bytes)?;
    Ok(bytes)
}

/// Problem and remedy if a layer breaks its rules.
fn check(layer: &Layer) -> Result<(), (String, &'static str)> {
    let vertex_count = layer.positions.len();
    let far = "clamp it to a finite distance";
    if let Some(vertex) = layer.positions.iter().position(|p| !p.iter().all(|x| x.is_finite())) {
        return Err((format!("vertex {vertex} lies at {:?}", layer.positions[vertex]), far));
    }
    if let Some(w) = &layer.w {
        if w.len() != vertex_count {
            return Err((
                format!("{} values of w for {vertex_count} vertices", w.len()),
                "give one per vertex",
            ));
        }
        if let Some(vertex) = w.iter().position(|w| !w.is_finite()) {
            return Err((format!("vertex {vertex} has w = {}", w[vertex]), "give it a finite w"));
        }
    }
    if let Some(quality) = &layer.quality {
        if quality.len() != vertex_count {
            let problem = format!("{} values of quality for {vertex_count} vertices", quality.len());
            return Err((problem, "give one per vertex"));
        }
        if let Some(vertex) = quality.iter().position(|value| !(0.0..=1.0).contains(value)) {
            let problem = format!("vertex {vertex} has the quality {}", quality[vertex]);
            return Err((problem, "keep it from 0 to 1"));
        }
    }
    if let Some(color) = layer.color
        && !color.iter().all(|channel| (0.0..=1.0).contains(channel))
    {
        return Err((format!("the color is {color:?}"), "keep each channel from 0 to 1"));
    }
    if let Some(index) = layer.elements.indices().iter().find(|&&index| index as usize >= vertex_count) {
        return Err((format!("vertex {index} is named, of {vertex_count}"), "name vertices that exist"));
    }
    let mut end = 0;
    for Part { name, faces, .. } in &layer.parts {
        if faces.start < end || faces.end < faces.start || faces.end as usize > layer.elements.len() {
            let problem = format!("the part {name:?} is {faces:?}, of {}", layer.elements.len());
            return Err((problem, "keep parts ascending, apart and in range"));
        }
        end = faces.end;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;
    use crate::testing::shapes;

    #[test]
    fn target_follows_the_extension() {
        for (path, target) in [("a.obj", Target::Obj), ("b/c.PLY", Target::Ply), ("x.tar.glb", Target::Glb)] {
            assert_eq!(Target::from_path(path), Ok(target));
        }
        for path in ["a.stl", "a", "obj", ".obj"] {
            let line = Target::from_path(path).unwrap_err().to_string();
            assert!(line.starts_with(path) && line.ends_with("use .obj, .ply or .glb"), "{line}");
        }
    }

    #[test]
    fn write_makes_the_bytes_of_the_named_format() {
        let folder = tempfile::tempdir().unwrap();
        let model = Model { layers: vec![Layer::from(&shapes::cube())] };
        for (name, target) in [("a.obj", Target::Obj), ("a.ply", Target::Ply), ("a.glb", Target::Glb)] {
            let path = folder.path().join(name);
            write(&model, &path).unwrap();
            let bytes = fs::read(&path).unwrap();
            assert_eq!(bytes, to_bytes(&model, target).unwrap());
            assert_eq!(bytes, to_bytes(&model.clone(), target).unwrap());
        }
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 3);
    }

    #[test]
    fn write_of_a_bad_model_leaves_the_old_file() {
        let sound = Layer::from(&shapes::tetrahedron());
        let part = |faces| Part::new("p", faces);
        #[rustfmt::skip]
        let bad = [
            (Layer { positions: vec![[0.0, f32::INFINITY, 0.0]; 4], ..sound.clone() }, "vertex 0 lies at"),
            (Layer { positions: vec![[0.0; 3]; 3], ..sound.clone() }, "vertex 3 is named, of 3"),
            (Layer { w: Some(vec![1.0; 3]), ..sound.clone() }, "3 values of w for 4 vertices"),
            (Layer { w: Some(vec![f32::NAN; 4]), ..sound.clone() }, "w = NaN"),
            (Layer { quality: Some(vec![1.0; 3]), ..sound.clone() }, "3 values of quality for 4 vertices"),
            (Layer { quality: Some(vec![1.5; 4]), ..sound.clone() }, "vertex 0 has the quality 1.5"),
            (Layer { color: Some([0.0, 0.0, 1.5, 1.0]), ..sound.clone() }, "the color is"),
            (Layer { parts: vec![part(0..5)], ..sound.clone() }, "the part \"p\" is 0..5, of 4"),
            (Layer { parts: vec![part(1..2), part(0..1)], ..sound.clone() }, "the part \"p\" is 0..1"),
        ];
        let folder = tempfile::tempdir().unwrap();
        for name in ["a.obj", "a.ply", "a.glb"] {
            let path = folder.path().join(name);
            fs::write(&path, "old").unwrap();
            for (layer, wanted) in &bad {
                let model = Model { layers: vec![sound.clone(), layer.clone()] };
                let line = write(&model, &path).unwrap_err().to_string();
                assert!(line.contains("layer 2 (\"tetrahedron\"): ") && line.contains(wanted), "{line}");
                assert_eq!(fs::read(&path).unwrap(), b"old");
            }
        }
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 3);
    }
}
