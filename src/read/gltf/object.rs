//! An object of the JSON: its fields by their expected type, and its name in errors.

use gltf::json::Value;

use super::document::{Document, Kind};
use super::extension::{self, Effect};
use super::notes::Notes;
use crate::read::{Place, ReadError, text};

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

    /// The document itself.
    pub(super) fn document(root: &'a Value) -> Self {
        Self { place: "document".to_owned(), value: root }
    }

    pub(super) fn error(&self, problem: impl Into<String>) -> ReadError {
        ReadError::new(None, Place::Item(self.place.clone()), problem)
    }

    /// Whether there is anything under `key`.
    pub(super) fn has(&self, key: &str) -> bool {
        self.value.get(key).is_some()
    }

    /// Whether an accessor has no data of its own.
    pub(super) fn is_empty(&self) -> bool {
        ["bufferView", "sparse"].iter().all(|key| self.value.get(key).is_none())
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

    /// The error for an item without plain data that has an extension, which then is to hold it.
    pub(super) fn stored_elsewhere(&self) -> Option<ReadError> {
        let extensions = self.value.get("extensions")?.as_object()?;
        let rank = |name: &str| match extension::effect(name) {
            Some((Effect::Stored, _)) => 0,
            None => 1,
            Some(_) => 2,
        };
        let name = extensions.keys().min_by_key(|name| rank(name))?;
        let quoted = text::quote(name.as_bytes());
        let remedy = match extension::effect(name) {
            Some((Effect::Read, _)) => {
                let problem = format!("has no plain data, and no data of {quoted} that could be read");
                return Some(self.error(problem));
            }
            Some((_, remedy)) => remedy,
            None => "export without this extension",
        };
        let problem = format!("has no plain data, and its extension {quoted} is not supported");
        Some(self.error(problem).remedy(remedy))
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
        self.flag_or(key, false)
    }

    pub(super) fn flag_or(&self, key: &str, default: bool) -> Result<bool, ReadError> {
        match self.value.get(key) {
            None => Ok(default),
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

    /// The index under `key`, or a note: for what casts no shadow.
    pub(super) fn link_or_note(
        &self,
        key: &str,
        document: &Document,
        kind: Kind,
        what: &'static str,
        notes: &Notes,
    ) -> Option<usize> {
        self.link(key, document, kind).unwrap_or_else(|error| {
            notes.because(what, &self.place, || error.problem);
            None
        })
    }

    pub(super) fn existing(&self, index: usize, document: &Document, kind: Kind) -> Result<usize, ReadError> {
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
