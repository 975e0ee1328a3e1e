//! Ambient occlusion in files: a glTF with it added and nothing else changed, or a new file.
//!
//! | form | what is written | shown by viewers as |
//! |---|---|---|
//! | [`Form::Texture`] | a ramp as occlusion texture, a coordinate a vertex | less indirect light |
//! | [`Form::Color`] | `COLOR_0`, times what is there | less light of any kind |
//! | [`Form::Attribute`] | `_OCCLUSION`, openness as `f32` | nothing |
//!
//! Every form may have `_BENT` beside it: mean open directions, which turn with their node as normals do.
//!
//! A vertex with several values is split: indices and all attributes are rewritten, those of morph targets
//! too, and strips and fans become single triangles. A mesh that several nodes show becomes one a node, for
//! its openness differs. The buffers of the file become its binary chunk, images beside it become part of it.
//! What was rewritten stays in the file, unused.

mod document;
mod edit;
mod layers;
mod material;
mod primitive;
mod ramp;
mod split;

use std::fs;
use std::path::{Path, PathBuf};

use serde_json::{Value, json};

use super::{Layer, Model, Target, WriteError, glb, to_bytes};
use crate::mesh::Mesh;
use crate::read::stored;
use crate::read::{Format, Place, ReadError};

pub use layers::with_occlusion;

/// How much of an even sky each corner of each face sees.
#[derive(Clone, Copy, Debug)]
pub struct Occlusion<'a> {
    /// For each face, the indices of the values of its corners.
    pub corners: &'a [[u32; 3]],
    /// From 0, nothing of the sky, to 1, all that is above the surface.
    pub openness: &'a [f32],
    /// Mean open directions in the world, of length 1 or 0.
    pub bent: Option<&'a [[f32; 3]]>,
}

/// What openness is written as.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Form {
    /// An occlusion texture.
    #[default]
    Texture,
    /// Vertex colors, linear.
    Color,
    /// A vertex attribute of its own.
    Attribute,
}

/// How openness is written.
#[derive(Clone, Debug)]
pub struct OcclusionOptions {
    /// As what.
    pub form: Form,
    /// Whether an occlusion texture or attribute that is there is replaced; if not, it is an error.
    pub replace: bool,
    /// The material of primitives that have none.
    fresh: Value,
}

/// A file with occlusion.
#[derive(Clone, Debug)]
pub struct Written {
    /// The bytes of the GLB.
    pub bytes: Vec<u8>,
    /// What there is to say about it, for people.
    pub notes: Vec<String>,
}

/// A glTF or GLB file that is to be written again with more in it.
#[derive(Clone, Debug)]
pub struct GltfFile {
    bytes: Vec<u8>,
    format: Format,
    folder: Option<PathBuf>,
}

impl OcclusionOptions {
    /// Openness in this form; nothing is replaced.
    #[must_use]
    pub fn new(form: Form) -> Self {
        Self { form, replace: false, fresh: json!({}) }
    }

    /// The same, but what is there already is replaced.
    #[must_use]
    pub fn replacing(self, replace: bool) -> Self {
        Self { replace, ..self }
    }
}

impl GltfFile {
    /// Opens a file. A packed one must be unpacked first.
    ///
    /// # Errors
    ///
    /// [`ReadError`] if it cannot be read, or is no glTF.
    pub fn open(path: impl AsRef<Path>) -> Result<Self, ReadError> {
        let path = path.as_ref();
        let unreadable = |error| ReadError::new(None, Place::File, format!("cannot be read: {error}"));
        let bytes = fs::read(path).map_err(|error| unreadable(error).in_file(path))?;
        let folder = path.parent().map(Path::to_owned);
        Self::of(bytes, folder).map_err(|error| error.in_file(path))
    }

    /// A file in memory: it must hold its buffers itself.
    ///
    /// # Errors
    ///
    /// [`ReadError`] if it is no glTF.
    pub fn from_bytes(bytes: Vec<u8>) -> Result<Self, ReadError> {
        Self::of(bytes, None)
    }

    fn of(bytes: Vec<u8>, folder: Option<PathBuf>) -> Result<Self, ReadError> {
        let format = if bytes.starts_with(b"glTF") { Format::Glb } else { Format::Gltf };
        if matches!(bytes[..], [0x1f, 0x8b, ..] | [b'P', b'K', ..]) {
            let problem = "is packed, and only a glTF itself can be added to";
            return Err(ReadError::new(None, Place::File, problem).remedy("unpack it first"));
        }
        Ok(Self { bytes, format, folder })
    }

    /// The file with occlusion, as GLB.
    ///
    /// `corners` has the faces of [`Scene::bake`](crate::scene::Scene::bake), in their order, of the parts
    /// that `kept` is true for: one flag for each of
    /// [`Scene::placed_parts`](crate::scene::Scene::placed_parts), or `None` for all of them. Other parts
    /// stay as they are.
    ///
    /// # Errors
    ///
    /// As [`GltfFile::check`]; and [`WriteError`] if the faces are not those of this file.
    ///
    /// # Panics
    ///
    /// Panics if `corners` names a value that is not there.
    ///
    /// ```
    /// use umbrage::scene::Scope;
    /// use umbrage::testing::shapes;
    /// use umbrage::write::{Form, GltfFile, Layer, Model, Occlusion, OcclusionOptions, Target, to_bytes};
    ///
    /// let model = Model { layers: vec![Layer::from(&shapes::cube())] };
    /// let file = GltfFile::from_bytes(to_bytes(&model, Target::Glb)?)?;
    /// let occlusion = Occlusion { corners: &[[0; 3]; 12], openness: &[0.5], bent: None };
    /// let written = file.with_occlusion(None, &occlusion, &OcclusionOptions::new(Form::Attribute))?;
    /// let back = umbrage::read::read_bytes(&written.bytes, "cube.glb")?.bake(Scope::Mesh)?;
    /// assert_eq!(back[0].triangles(), shapes::cube().triangles());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn with_occlusion(
        &self,
        kept: Option<&[bool]>,
        occlusion: &Occlusion<'_>,
        options: &OcclusionOptions,
    ) -> Result<Written, WriteError> {
        assert!(occlusion.bent.is_none_or(|bent| bent.len() == occlusion.openness.len()), "one bent a value");
        let folder = self.folder.as_deref();
        let edited = stored::open(&self.bytes, self.format, folder, |stored| {
            edit::add(stored, kept, occlusion, options)
        })?;
        let mut bytes = Vec::new();
        glb::container(edited.json, edited.bytes, &mut bytes)?;
        Ok(Written { bytes, notes: edited.notes })
    }

    /// Whether occlusion can be added, before any of it is computed.
    ///
    /// # Errors
    ///
    /// [`WriteError`] with what stands in the way: a node that places its mesh many times
    /// (EXT_mesh_gpu_instancing), a mesh compressed with Draco, an occlusion texture or attribute that is
    /// there already, four sets of texture coordinates; or what [`read`](crate::read::read) refuses.
    pub fn check(&self, kept: Option<&[bool]>, options: &OcclusionOptions) -> Result<(), WriteError> {
        stored::open(&self.bytes, self.format, self.folder.as_deref(), |stored| {
            edit::plan(stored, kept, Some(options)).map(|_| ())
        })
    }

    /// The normals that the file gives the corners of each face, in the world; `None` where it has none. Zero
    /// is one that is no direction.
    ///
    /// # Errors
    ///
    /// [`WriteError`] if the file cannot be read, or a node places its mesh many times.
    pub fn normals(&self, kept: Option<&[bool]>) -> Result<Vec<Option<[[f32; 3]; 3]>>, WriteError> {
        stored::open(&self.bytes, self.format, self.folder.as_deref(), |stored| edit::normals(stored, kept))
    }
}

/// A new GLB of meshes with occlusion: a node each, of a rough, non-metallic material.
///
/// # Errors
///
/// [`WriteError`] if the meshes are too large for the format, or have other faces than `corners`.
pub fn glb_with_occlusion(
    meshes: &[Mesh],
    occlusion: &Occlusion<'_>,
    form: Form,
) -> Result<Written, WriteError> {
    let model = Model { layers: meshes.iter().map(Layer::from).collect() };
    let file = GltfFile::from_bytes(to_bytes(&model, Target::Glb)?)?;
    // Without a material a surface is a mirror, which has no indirect light of its own color.
    let fresh = json!({"pbrMetallicRoughness": {"metallicFactor": 0, "roughnessFactor": 1}});
    file.with_occlusion(None, occlusion, &OcclusionOptions { form, replace: false, fresh })
}
