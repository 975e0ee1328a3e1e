//! A glTF document that is added to: its JSON, and its buffers as one.

use std::collections::HashMap;
use std::rc::Rc;

use serde_json::{Map, Value, json};

use super::WriteError;
use crate::read::stored::{Elements, Stored};

/// `ARRAY_BUFFER` and `ELEMENT_ARRAY_BUFFER`.
pub(super) const VERTICES: u32 = 34962;
pub(super) const INDICES: u32 = 34963;

pub(super) struct Document<'s, 'a> {
    pub(super) stored: &'s Stored<'a>,
    pub(super) root: Value,
    bytes: Vec<u8>,
    elements: HashMap<usize, Rc<Elements>>,
}

impl<'s, 'a> Document<'s, 'a> {
    /// The document with all of its buffers in the binary chunk, and the images beside it too.
    pub(super) fn new(stored: &'s Stored<'a>, notes: &mut Vec<String>) -> Result<Self, WriteError> {
        let (bytes, starts) = stored.buffers()?;
        let mut document = Self { stored, root: stored.root().clone(), bytes, elements: HashMap::new() };
        document.move_buffers(&starts);
        document.take_in_images(notes);
        Ok(document)
    }

    /// Names the buffers as they are now: those with bytes are the first one.
    fn move_buffers(&mut self, starts: &[Option<usize>]) {
        let old: Vec<Value> = self.list("buffers").drain(..).collect();
        let first = starts.iter().position(Option::is_some);
        let mut chunk = first.map_or_else(|| json!({}), |first| old[first].clone());
        if let Some(chunk) = chunk.as_object_mut() {
            chunk.remove("uri");
        }
        let mut buffers = vec![chunk];
        let mut moved: Vec<(usize, usize)> = Vec::with_capacity(starts.len());
        for (start, buffer) in starts.iter().zip(old) {
            match start {
                Some(start) => moved.push((0, *start)),
                None => {
                    moved.push((buffers.len(), 0));
                    buffers.push(buffer);
                }
            }
        }
        *self.list("buffers") = buffers;
        for view in self.list("bufferViews") {
            move_view(view, &moved);
            let Some(extensions) = view.get_mut("extensions").and_then(Value::as_object_mut) else {
                continue;
            };
            for name in ["EXT_meshopt_compression", "KHR_meshopt_compression"] {
                extensions.get_mut(name).into_iter().for_each(|compressed| move_view(compressed, &moved));
            }
        }
    }

    /// Images in files of their own become part of the file.
    fn take_in_images(&mut self, notes: &mut Vec<String>) {
        for index in 0..self.list("images").len() {
            let image = &self.list("images")[index];
            let Some(uri) = image.get("uri").and_then(Value::as_str).map(str::to_owned) else { continue };
            if uri.trim_start().starts_with("data:") {
                continue;
            }
            let stated = image.get("mimeType").and_then(Value::as_str).map(str::to_owned);
            let bytes = self.stored.image(&uri);
            let kind = bytes.as_deref().and_then(|bytes| kind(bytes).map(str::to_owned).or(stated));
            let (Some(bytes), Some(kind)) = (bytes, kind) else {
                notes.push(format!(
                    "image {index}: not found beside the file, or of an unknown kind: still named by its path"
                ));
                continue;
            };
            let view = self.view(&bytes, None, None);
            if let Some(image) = self.list("images")[index].as_object_mut() {
                image.remove("uri");
                image.insert("bufferView".to_owned(), view.into());
                image.insert("mimeType".to_owned(), kind.into());
            }
        }
    }

    /// The list under `key`, which is there afterwards.
    pub(super) fn list(&mut self, key: &str) -> &mut Vec<Value> {
        let value = &mut self.root[key];
        if !value.is_array() {
            *value = Value::Array(Vec::new());
        }
        value.as_array_mut().expect("made one above")
    }

    /// Adds to the list under `key`.
    pub(super) fn push(&mut self, key: &str, value: Value) -> usize {
        let list = self.list(key);
        list.push(value);
        list.len() - 1
    }

    /// The object that the JSON pointer names.
    pub(super) fn object(&mut self, pointer: &str) -> Result<&mut Map<String, Value>, WriteError> {
        let wrong = || WriteError::new(format!("{pointer} is not an object"), "export the file again");
        self.root.pointer_mut(pointer).and_then(Value::as_object_mut).ok_or_else(wrong)
    }

    /// Appends the bytes of a buffer view.
    pub(super) fn view(&mut self, bytes: &[u8], target: Option<u32>, stride: Option<usize>) -> usize {
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        let mut view = json!({"buffer": 0, "byteOffset": self.bytes.len(), "byteLength": bytes.len()});
        if let Some(stride) = stride {
            view["byteStride"] = stride.into();
        }
        if let Some(target) = target {
            view["target"] = target.into();
        }
        self.bytes.extend_from_slice(bytes);
        self.push("bufferViews", view)
    }

    /// Appends an accessor of vertices, `size` bytes an element, at a stride that keeps it aligned.
    pub(super) fn attribute(
        &mut self,
        mut accessor: Value,
        size: usize,
        elements: impl ExactSizeIterator<Item = [u8; 16]>,
    ) -> usize {
        let stride = size.next_multiple_of(4);
        let count = elements.len();
        let mut bytes = Vec::with_capacity(count * stride);
        for mut element in elements {
            element[size..].fill(0);
            bytes.extend_from_slice(&element[..stride]);
        }
        accessor["bufferView"] = self.view(&bytes, Some(VERTICES), Some(stride)).into();
        accessor["count"] = count.into();
        self.push("accessors", accessor)
    }

    /// The elements of an accessor, read once.
    pub(super) fn elements(&mut self, accessor: usize) -> Result<Rc<Elements>, WriteError> {
        if let Some(elements) = self.elements.get(&accessor) {
            return Ok(Rc::clone(elements));
        }
        let elements = Rc::new(self.stored.elements(accessor)?);
        self.elements.insert(accessor, Rc::clone(&elements));
        Ok(elements)
    }

    /// The document as JSON, and the binary chunk.
    pub(super) fn finish(mut self) -> Result<(Vec<u8>, Vec<u8>), WriteError> {
        match self.bytes.len() {
            0 => {
                self.root.as_object_mut().map(|root| root.remove("buffers"));
            }
            length => self.list("buffers")[0]["byteLength"] = length.into(),
        }
        for key in ["images", "bufferViews"] {
            if self.list(key).is_empty() {
                self.root.as_object_mut().map(|root| root.remove(key));
            }
        }
        let json = serde_json::to_vec(&self.root)
            .map_err(|error| WriteError::new(format!("is not JSON: {error}"), "export the file again"))?;
        Ok((json, self.bytes))
    }
}

/// Moves a view, or what stands for one, along with its buffer.
fn move_view(view: &mut Value, moved: &[(usize, usize)]) {
    let Some(&(buffer, start)) = whole(view.get("buffer")).and_then(|old| moved.get(old)) else { return };
    view["buffer"] = buffer.into();
    if start > 0 {
        let offset = whole(view.get("byteOffset")).unwrap_or(0);
        view["byteOffset"] = offset.saturating_add(start).into();
    }
}

/// An index or a length; JSON may write 3 as 3.0, which the reader has accepted.
pub(super) fn whole(value: Option<&Value>) -> Option<usize> {
    let value = value?;
    value.as_u64().or_else(|| value.as_f64().map(|x| x as u64)).and_then(|x| usize::try_from(x).ok())
}

/// The media type of an image, by its first bytes.
fn kind(bytes: &[u8]) -> Option<&'static str> {
    match bytes {
        [0x89, b'P', b'N', b'G', ..] => Some("image/png"),
        [0xff, 0xd8, 0xff, ..] => Some("image/jpeg"),
        [b'R', b'I', b'F', b'F', _, _, _, _, b'W', b'E', b'B', b'P', ..] => Some("image/webp"),
        [0xab, b'K', b'T', b'X', b' ', b'2', b'0', ..] => Some("image/ktx2"),
        _ => None,
    }
}
