//! The JSON of a glTF: items by kind and index, fields by their expected type. Every error names the item.
//!
//! Fields are taken from plain JSON values, not from the `gltf` crate's typed document. That one refuses
//! legal files for what casts no shadow (a scene without nodes, a texture whose only image is an
//! extension's), cuts indices to 32 bits, drops the extensions that say geometry is compressed, and its
//! validation indexes unchecked, so that a malformed file panics.

use std::fmt;

use gltf::json::{Value, deserialize};

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
}

impl Document {
    /// Parses UTF-8 JSON. The parser refuses nesting beyond 128 levels, so nothing behind it can recurse
    /// deeper.
    pub(super) fn parse(json: &[u8], format: Format) -> Result<Self, ReadError> {
        let json = json.strip_prefix(b"\xef\xbb\xbf").unwrap_or(json);
        let root: Value = deserialize::from_slice(json).map_err(|error| {
            let text = error.to_string();
            let (problem, line, column) =
                (text.split(" at line ").next().unwrap_or_default(), error.line(), error.column());
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
        })?;
        let document = Self { root };
        let wrong = |problem: String| ReadError::new(None, Place::File, problem);
        let version = document.root.pointer("/asset/version").and_then(Value::as_str);
        match version {
            Some(version) if version.starts_with("2.") => {}
            Some(version) => {
                let problem = format!("is glTF version {version}, but only version 2 can be read");
                return Err(wrong(problem).remedy("export as glTF 2.0"));
            }
            None => return Err(wrong("states no glTF version (asset.version)".to_owned())),
        }
        for pointer in Kind::ALL.map(Kind::pointer).into_iter().chain(["/extensionsRequired"]) {
            if document.root.pointer(pointer).is_some_and(|list| !list.is_array()) {
                return Err(wrong(format!("{} is not a list", &pointer[1..])));
            }
        }
        document.check_extensions()?;
        Ok(document)
    }

    /// Refuses a required extension unless it leaves geometry alone or is one that this reader knows.
    fn check_extensions(&self) -> Result<(), ReadError> {
        let required = self.root.pointer("/extensionsRequired").and_then(Value::as_array);
        for name in required.into_iter().flatten() {
            let name = name.as_str().unwrap_or("(not a name)");
            let subject = name.split_once('_').map_or("", |(_vendor, subject)| subject);
            let harmless = ["materials_", "texture_", "image_", "lights_", "animation_", "xmp"];
            if name == "KHR_mesh_quantization" || harmless.iter().any(|start| subject.starts_with(start)) {
                continue;
            }
            let problem = format!("requires the extension {name}, which is not supported");
            let remedy = if is_compression(name) {
                "export without mesh compression"
            } else {
                "export without this extension"
            };
            return Err(ReadError::new(None, Place::File, problem).remedy(remedy));
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

    /// The document as an object.
    pub(super) fn object(&self) -> Object<'_> {
        Object { place: "document".to_owned(), value: &self.root }
    }

    /// Whether the document says that it uses this extension.
    pub(super) fn uses(&self, extension: &str) -> bool {
        let used = self.root.get("extensionsUsed").and_then(Value::as_array);
        used.is_some_and(|used| used.iter().any(|name| name == extension))
    }
}

/// Whether an extension replaces the plain data of meshes by a compressed form.
pub(super) fn is_compression(extension: &str) -> bool {
    extension.contains("_compression")
}

/// An object of the document, with its name in errors.
pub(super) struct Object<'a> {
    pub(super) place: String,
    value: &'a Value,
}

impl<'a> Object<'a> {
    /// The name of an item in errors and notes: "accessor 3".
    pub(super) fn place(kind: Kind, index: usize) -> String {
        format!("{kind} {index}")
    }

    pub(super) fn new(place: String, value: &'a Value) -> Result<Self, ReadError> {
        let object = Self { place, value };
        if value.is_object() { Ok(object) } else { Err(object.error("is not an object")) }
    }

    pub(super) fn error(&self, problem: impl Into<String>) -> ReadError {
        ReadError::new(None, Place::Item(self.place.clone()), problem)
    }

    /// The name in the file, or else kind and index.
    pub(super) fn name(&self) -> String {
        self.given_name().unwrap_or_else(|| self.place.clone())
    }

    /// The name in the file, if it has one; cut where it is very long, for every instance and part holds a
    /// copy.
    pub(super) fn given_name(&self) -> Option<String> {
        let name = self.value.get("name").and_then(Value::as_str).filter(|name| !name.is_empty())?;
        Some(text::name(name.as_bytes()))
    }

    /// The object under `key`.
    pub(super) fn object(&self, key: &str) -> Result<Option<Object<'a>>, ReadError> {
        self.value.get(key).map(|value| Object::new(format!("{}, {key}", self.place), value)).transpose()
    }

    /// What an extension says here.
    pub(super) fn extension(&self, name: &str) -> Option<Object<'a>> {
        let value = self.value.get("extensions")?.get(name)?;
        Some(Object { place: format!("{}, {name}", self.place), value })
    }

    /// The extension by which the data of this item is compressed, if it is.
    pub(super) fn compression(&self) -> Option<&'a str> {
        let extensions = self.value.get("extensions")?.as_object()?;
        extensions.keys().map(String::as_str).find(|name| is_compression(name))
    }

    /// The elements of a list; none if the key is absent.
    pub(super) fn list(&self, key: &str) -> Result<&'a [Value], ReadError> {
        match self.value.get(key) {
            None => Ok(&[]),
            Some(Value::Array(list)) => Ok(list),
            Some(_) => Err(self.error(format!("{key} is not a list"))),
        }
    }

    /// The objects of a list, called `name 0`, `name 1`, …
    pub(super) fn objects(
        &self,
        key: &str,
        name: &str,
    ) -> Result<impl Iterator<Item = Result<Object<'a>, ReadError>>, ReadError> {
        let list = self.list(key)?.iter().enumerate();
        Ok(list.map(move |(index, value)| Object::new(format!("{}, {name} {index}", self.place), value)))
    }

    pub(super) fn text(&self, key: &str) -> Result<Option<&'a str>, ReadError> {
        let wrong = || self.error(format!("{key} is not a text"));
        self.value.get(key).map(|value| value.as_str().ok_or_else(wrong)).transpose()
    }

    pub(super) fn flag(&self, key: &str) -> Result<bool, ReadError> {
        match self.value.get(key) {
            None => Ok(false),
            Some(value) => value.as_bool().ok_or_else(|| self.error(format!("{key} is not true or false"))),
        }
    }

    /// A count, an offset, an index.
    pub(super) fn whole(&self, key: &str) -> Result<Option<usize>, ReadError> {
        let wrong = |value| self.error(format!("{key} is {}, which is not a count", shown(value)));
        self.value.get(key).map(|value| whole(value).ok_or_else(|| wrong(value))).transpose()
    }

    /// Finite numbers, `N` of them.
    pub(super) fn numbers<const N: usize>(&self, key: &str) -> Result<Option<[f64; N]>, ReadError> {
        let Some(value) = self.value.get(key) else { return Ok(None) };
        let wrong = || self.error(format!("{key} is not a list of {N} numbers"));
        let list = value.as_array().filter(|list| list.len() == N).ok_or_else(wrong)?;
        let mut numbers = [0.0; N];
        for (number, value) in numbers.iter_mut().zip(list) {
            *number = value.as_f64().ok_or_else(wrong)?;
        }
        Ok(Some(numbers))
    }

    /// A finite number that `f32` can hold.
    pub(super) fn number(&self, key: &str) -> Result<Option<f32>, ReadError> {
        let wrong = |value| self.error(format!("{key} is {}, which is not a 32-bit number", shown(value)));
        let finite = |value: &Value| value.as_f64().map(|x| x as f32).filter(|x| x.is_finite());
        self.value.get(key).map(|value| finite(value).ok_or_else(|| wrong(value))).transpose()
    }

    /// The index under `key`, of an item that exists.
    pub(super) fn link(
        &self,
        key: &str,
        document: &Document,
        kind: Kind,
    ) -> Result<Option<usize>, ReadError> {
        let Some(index) = self.whole(key)? else { return Ok(None) };
        self.existing(index, document, kind).map(Some)
    }

    /// The indices in the list under `key`, of items that exist.
    pub(super) fn links(&self, key: &str, document: &Document, kind: Kind) -> Result<Vec<usize>, ReadError> {
        let index = |value| {
            let wrong = || self.error(format!("{key} holds {}, which is not an index", shown(value)));
            self.existing(whole(value).ok_or_else(wrong)?, document, kind)
        };
        self.list(key)?.iter().map(index).collect()
    }

    fn existing(&self, index: usize, document: &Document, kind: Kind) -> Result<usize, ReadError> {
        match document.list(kind).len() {
            count if index < count => Ok(index),
            count => Err(self.error(format!("names {kind} {index}, but there are {count}"))),
        }
    }

    /// The value, or an error that `key` is missing.
    pub(super) fn required<T>(&self, key: &str, value: Option<T>) -> Result<T, ReadError> {
        value.ok_or_else(|| self.error(format!("{key} is missing")))
    }
}

/// An integer; JSON may write 3 as 3.0.
fn whole(value: &Value) -> Option<usize> {
    // 2^53: beyond it, an f64 stands for several integers.
    let from_float =
        |x: f64| (x.fract() == 0.0 && (0.0..=9_007_199_254_740_992.0).contains(&x)).then_some(x as u64);
    let whole = value.as_u64().or_else(|| value.as_f64().and_then(from_float))?;
    usize::try_from(whole).ok()
}

/// A value in a message: numbers and short texts as they are, anything that may be long by its type.
fn shown(value: &Value) -> String {
    match value {
        Value::String(text) if text.len() > 40 => "a long text".to_owned(),
        Value::Array(_) => "a list".to_owned(),
        Value::Object(_) => "an object".to_owned(),
        _ => value.to_string(),
    }
}
