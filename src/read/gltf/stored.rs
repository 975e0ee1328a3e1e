//! A glTF as it is stored: for a writer that adds to the file and leaves the rest as it is.

use std::collections::HashMap;
use std::fs;
use std::path::Path;

use glam::{DMat4, Mat4};
use gltf::json::Value;

use super::accessor;
use super::asset::Asset;
use super::component::Component;
use super::container;
use super::document::{Document, Kind};
use super::mesh;
use super::node;
use super::notes::Notes;
use super::uri::{self, Uri};
use crate::read::{Format, ReadError};

/// Most bytes of an image beside the document: 1 GiB.
const MOST_IMAGE: u64 = 1 << 30;

/// An open file.
pub(crate) struct Stored<'a> {
    asset: Asset<'a>,
    folder: Option<&'a Path>,
}

/// A mesh where the scene places it: in the order of the instances of the scene that the reader makes.
pub(crate) struct Placed {
    /// `None` in a file without nodes.
    pub(crate) node: Option<usize>,
    pub(crate) mesh: usize,
    pub(crate) world_from_mesh: Mat4,
    /// Whether the node places its mesh many times.
    pub(crate) instanced: bool,
}

/// The triangles of a primitive, in the order of the faces that the reader makes of it.
pub(crate) struct Primitive {
    /// Its index in the mesh.
    pub(crate) index: usize,
    /// The accessor of its positions.
    pub(crate) position: usize,
    pub(crate) vertices: usize,
    pub(crate) triangles: Vec<[u32; 3]>,
}

/// The elements of an accessor as they are stored, sparse ones in place: the first `size` bytes of each.
pub(crate) struct Elements {
    pub(crate) size: usize,
    pub(crate) bytes: Vec<[u8; 16]>,
}

/// Opens the file that `bytes` are, for `work`. `folder` is where its buffers and images lie.
pub(crate) fn open<T, E: From<ReadError>>(
    bytes: &[u8],
    format: Format,
    folder: Option<&Path>,
    work: impl FnOnce(&Stored<'_>) -> Result<T, E>,
) -> Result<T, E> {
    // What there is to say has been said by the reader.
    let notes = Notes::default();
    let (json, bin) = match format {
        Format::Glb => container::split(bytes, &notes)?,
        _ => (bytes, None),
    };
    let document = Document::parse(json, format, &notes)?;
    work(&Stored { asset: Asset::new(&document, &notes, bin, folder, bytes.len()), folder })
}

impl Stored<'_> {
    /// The document.
    pub(crate) fn root(&self) -> &Value {
        self.asset.document.root()
    }

    pub(crate) fn placed(&self) -> Result<Vec<Placed>, ReadError> {
        let document = self.asset.document;
        let mut placed = Vec::new();
        for at in node::scene_nodes(document, self.asset.notes)? {
            let node = document.item(Kind::Node, at.index)?;
            let Some(mesh) = node.link("mesh", document, Kind::Mesh)?.filter(|_| !at.hidden) else {
                continue;
            };
            let skinned = node.link("skin", document, Kind::Skin)?.is_some();
            let world = if skinned { DMat4::IDENTITY } else { at.world_from_node };
            let instanced = node.extension("EXT_mesh_gpu_instancing").is_some();
            placed.push(Placed { node: Some(at.index), mesh, world_from_mesh: world.as_mat4(), instanced });
        }
        if document.list(Kind::Node).is_empty() {
            let alone = |mesh| Placed { node: None, mesh, world_from_mesh: Mat4::IDENTITY, instanced: false };
            placed.extend((0..document.list(Kind::Mesh).len()).map(alone));
        }
        Ok(placed)
    }

    /// The primitives of a mesh that have triangles: those that the reader makes parts of.
    pub(crate) fn primitives(&self, mesh: usize) -> Result<Vec<Primitive>, ReadError> {
        let document = self.asset.document;
        let object = document.item(Kind::Mesh, mesh)?;
        let mut primitives = Vec::new();
        for (index, primitive) in object.objects("primitives", "primitive")?.enumerate() {
            let primitive = primitive?;
            let Some(read) = mesh::read_primitive(&self.asset, &primitive)? else { continue };
            let attributes = primitive.required("attributes", primitive.object("attributes")?)?;
            let position = attributes.link("POSITION", document, Kind::Accessor)?;
            let position = attributes.required("POSITION", position)?;
            let (vertices, triangles) = (read.positions.len(), read.triangles);
            primitives.push(Primitive { index, position, vertices, triangles });
        }
        Ok(primitives)
    }

    pub(crate) fn elements(&self, accessor: usize) -> Result<Elements, ReadError> {
        let (component, width, _) = self.shape(accessor)?;
        let size = component.bytes() * width;
        let object = self.asset.document.item(Kind::Accessor, accessor)?;
        let bytes = accessor::elements(&self.asset, &object, size, [0; 16], |bytes| {
            let mut element = [0; 16];
            element[..size].copy_from_slice(bytes);
            element
        })?;
        Ok(Elements { size, bytes })
    }

    /// The elements of an accessor as numbers, which may be none; 1 for those that it does not have.
    pub(crate) fn numbers(&self, accessor: usize) -> Result<Vec<[f32; 4]>, ReadError> {
        let (component, width, normalized) = self.shape(accessor)?;
        let size = component.bytes();
        let object = self.asset.document.item(Kind::Accessor, accessor)?;
        accessor::elements(&self.asset, &object, size * width, [0.0; 4], |bytes| {
            let number = |axis: usize| component.float(&bytes[axis * size..], normalized);
            std::array::from_fn(|axis| if axis < width { number(axis) } else { 1.0 })
        })
    }

    /// What an accessor is made of: components, how many an element has, whether they are fractions.
    fn shape(&self, accessor: usize) -> Result<(Component, usize, bool), ReadError> {
        let object = self.asset.document.item(Kind::Accessor, accessor)?;
        let width = match object.required("type", object.text("type")?)? {
            "SCALAR" => 1,
            "VEC2" => 2,
            "VEC3" => 3,
            "VEC4" => 4,
            other => return Err(object.error(format!("is of type {other}, but an attribute is a vector"))),
        };
        Ok((Component::of(&object)?, width, object.flag("normalized")?))
    }

    /// All buffers in one, and where each of them begins there. A buffer without bytes (one that stands in
    /// for compressed data) begins nowhere.
    pub(crate) fn buffers(&self) -> Result<(Vec<u8>, Vec<Option<usize>>), ReadError> {
        let document = self.asset.document;
        let (mut all, mut starts, mut seen) = (Vec::new(), Vec::new(), HashMap::new());
        for index in 0..document.list(Kind::Buffer).len() {
            let bytes = match self.asset.buffer(index) {
                Ok(bytes) => bytes,
                Err(_) if !document.item(Kind::Buffer, index)?.has("uri") => {
                    starts.push(None);
                    continue;
                }
                Err(error) => return Err(error),
            };
            // A file that many buffers name stands once.
            let start = *seen.entry((bytes.as_ptr(), bytes.len())).or_insert_with(|| {
                all.resize(all.len().next_multiple_of(4), 0);
                all.extend_from_slice(bytes);
                all.len() - bytes.len()
            });
            starts.push(Some(start));
        }
        Ok((all, starts))
    }

    /// The bytes of an image that lies beside the document; `None` if the URI holds it itself, or if it
    /// cannot be read from the folder of the document.
    pub(crate) fn image(&self, uri: &str) -> Option<Vec<u8>> {
        let Ok(Uri::Relative { decoded, as_written }) = uri::parse(uri) else { return None };
        let folder = self.folder?;
        let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
        let folder = folder.canonicalize().ok()?;
        let read = |path: &Path| {
            // Canonical, so that a symbolic link cannot lead out of the folder.
            let path = folder.join(path).canonicalize().ok().filter(|path| path.starts_with(&folder))?;
            let found = fs::metadata(&path).ok()?;
            if found.is_file() && found.len() <= MOST_IMAGE { fs::read(&path).ok() } else { None }
        };
        decoded.iter().chain(&as_written).find_map(|path| read(path))
    }
}
