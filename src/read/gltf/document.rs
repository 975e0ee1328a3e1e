//! The JSON of a glTF: its version, its extensions, its items by kind and index.
//!
//! Values are taken from plain JSON values, not from the `gltf` crate's typed document. That one refuses
//! legal files for what casts no shadow (a scene without nodes, a texture whose only image is an
//! extension's), cuts indices to 32 bits, drops the extensions that say geometry is compressed, and its
//! validation indexes unchecked, so that a malformed file panics.

use std::fmt;

use gltf::json::{Value, deserialize};

use super::extension::{self, Effect};
use super::notes::Notes;
use super::object::Object;

use crate::read::{Format, Place, ReadError, text};

/// The kinds of items that an index in the document may refer to.
#[derive(Clone, Copy, Debug)]
pub(super) enum Kind {
    Scene,
    Node,
    Mesh,
    Material,
    Accessor,
    BufferView,
    Buffer,
    Skin,
    Camera,
    Light,
}

impl Kind {
    const ALL: [Self; 10] = [
        Self::Scene,
        Self::Node,
        Self::Mesh,
        Self::Material,
        Self::Accessor,
        Self::BufferView,
        Self::Buffer,
        Self::Skin,
        Self::Camera,
        Self::Light,
    ];

    /// The list of items of this kind in the document, as a JSON pointer (RFC 6901).
    fn pointer(self) -> &'static str {
        match self {
            Self::Scene => "/scenes",
            Self::Node => "/nodes",
            Self::Mesh => "/meshes",
            Self::Material => "/materials",
            Self::Accessor => "/accessors",
            Self::BufferView => "/bufferViews",
            Self::Buffer => "/buffers",
            Self::Skin => "/skins",
            Self::Camera => "/cameras",
            Self::Light => "/extensions/KHR_lights_punctual/lights",
        }
    }
}

impl fmt::Display for Kind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Scene => "scene",
            Self::Node => "node",
            Self::Mesh => "mesh",
            Self::Material => "material",
            Self::Accessor => "accessor",
            Self::BufferView => "buffer view",
            Self::Buffer => "buffer",
            Self::Skin => "skin",
            Self::Camera => "camera",
            Self::Light => "light",
        })
    }
}

/// A parsed document whose version and required extensions this reader supports.
pub(super) struct Document {
    root: Value,
    /// Whether positions may be small integers (KHR_mesh_quantization).
    pub(super) quantized: bool,
}

impl Document {
    /// Parses UTF-8 JSON. The parser refuses nesting beyond 128 levels, so nothing behind it can recurse
    /// deeper.
    pub(super) fn parse(json: &[u8], format: Format, notes: &Notes) -> Result<Self, ReadError> {
        let json = json.strip_prefix(b"\xef\xbb\xbf").unwrap_or(json);
        let blank = |byte: &u8| *byte == 0 || byte.is_ascii_whitespace();
        let end = json.iter().rposition(|byte| !blank(byte)).map_or(0, |last| last + 1);
        let zeros = usize::from(json[end..].contains(&0));
        notes.add_many("padded with zero bytes behind the JSON", "document", zeros);
        let root: Value = deserialize::from_slice(&json[..end]).map_err(|error| not_json(&error, format))?;
        let mut document = Self { root, quantized: false };
        document.check_version(notes)?;
        for kind in Kind::ALL {
            if document.root.pointer(kind.pointer()).is_some_and(|list| !list.is_array()) {
                let problem = format!("{} is not a list", &kind.pointer()[1..]);
                match kind {
                    Kind::Material | Kind::Camera | Kind::Light => {
                        notes.because("materials, cameras or lamps left out", "document", || problem);
                    }
                    _ => return Err(ReadError::new(None, Place::File, problem)),
                }
            }
        }
        document.check_extensions(notes)?;
        document.quantized = document.uses("KHR_mesh_quantization");
        Ok(document)
    }

    fn check_version(&self, notes: &Notes) -> Result<(), ReadError> {
        let wrong = |problem: String| ReadError::new(None, Place::File, problem);
        let stated = self.root.pointer("/asset/version");
        // Written as a number, 2.0 is meant all the same.
        let version = stated.map(|stated| stated.as_str().map_or_else(|| stated.to_string(), str::to_owned));
        match version {
            Some(version) if version == "2" || version.starts_with("2.") => {
                let mended = stated.is_some_and(|stated| !stated.is_string());
                notes.add_many("version that is not a text read as one", "asset", usize::from(mended));
                Ok(())
            }
            None if ["/nodes", "/meshes"]
                .iter()
                .any(|list| self.root.pointer(list).is_some_and(Value::is_array)) =>
            {
                notes.add("no version stated (asset.version): read as glTF 2.0", "document");
                Ok(())
            }
            Some(version) => {
                let problem = format!(
                    "is glTF version {}, but only version 2 can be read",
                    text::quote(version.as_bytes())
                );
                Err(wrong(problem).remedy("export as glTF 2.0"))
            }
            None => Err(wrong("states no glTF version (asset.version)".to_owned())
                .remedy("name a glTF file, or export it again as glTF 2.0")),
        }
    }

    /// Refuses a required extension that changes what the plain data means and is not read; one that leaves
    /// geometry alone gets a note.
    fn check_extensions(&self, notes: &Notes) -> Result<(), ReadError> {
        for (list, required) in [("extensionsRequired", true), ("extensionsUsed", false)] {
            let names = match self.root.get(list) {
                None => continue,
                Some(Value::Array(names)) => names,
                Some(_) => {
                    notes.add("list of extensions that is none passed over", list);
                    continue;
                }
            };
            for name in names.iter().map(|name| name.as_str().unwrap_or_default()) {
                match extension::effect(name) {
                    Some((Effect::Changed, remedy)) if required => {
                        let problem = format!("requires the extension {name}, which is not supported");
                        return Err(ReadError::new(None, Place::File, problem).remedy(remedy));
                    }
                    Some((Effect::Changed, _)) => {
                        let what = "extension that changes geometry, but is not required, not read";
                        notes.because(what, list, || name.to_owned());
                    }
                    None if required => {
                        let what =
                            "required extension that leaves geometry alone, as far as is known, not read";
                        notes.because(what, list, || text::quote(name.as_bytes()));
                    }
                    _ => {}
                }
            }
        }
        Ok(())
    }

    /// All items of a kind.
    pub(super) fn list(&self, kind: Kind) -> &[Value] {
        self.root.pointer(kind.pointer()).and_then(Value::as_array).map_or(&[], Vec::as_slice)
    }

    /// The item of this kind and index, which must exist.
    pub(super) fn item(&self, kind: Kind, index: usize) -> Result<Object<'_>, ReadError> {
        let place = Object::place(kind, index);
        match self.list(kind).get(index) {
            Some(value) => Object::new(place, value),
            None => Err(ReadError::new(None, Place::Item(place), "does not exist")),
        }
    }

    /// The document as it is.
    pub(super) fn root(&self) -> &Value {
        &self.root
    }

    /// The document as an object.
    pub(super) fn object(&self) -> Object<'_> {
        Object::document(&self.root)
    }

    /// Whether the document says that it uses this extension.
    pub(super) fn uses(&self, extension: &str) -> bool {
        let lists = ["extensionsUsed", "extensionsRequired"].map(|list| self.root.get(list));
        let names = |list: Option<&Value>| {
            list.and_then(Value::as_array).is_some_and(|names| names.iter().any(|name| name == extension))
        };
        lists.into_iter().any(names)
    }
}

fn not_json(error: &gltf::json::Error, format: Format) -> ReadError {
    let text = error.to_string();
    let problem = text.split(" at line ").next().unwrap_or_default();
    let (line, column) = (error.line(), error.column());
    match format {
        Format::Glb => ReadError::new(
            None,
            Place::Item("JSON chunk".to_owned()),
            format!("is not JSON: {problem} (line {line}, column {column})"),
        ),
        _ => ReadError::new(
            None,
            Place::Line(line as u64),
            format!("is not JSON: {problem} (column {column})"),
        ),
    }
}
