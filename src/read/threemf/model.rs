//! One model part: its objects and what it builds, from XML.

use std::borrow::Cow;
use std::collections::HashMap;
use std::io::BufRead;

use quick_xml::XmlVersion;
use quick_xml::events::{BytesStart, Event};
use quick_xml::reader::Reader;

use crate::mesh::{Mesh, MeshError};
use crate::read::text::{counted, name, parse, quote};
use crate::read::{Format, Place, ReadError, refused};

/// Objects and build items of one part.
#[derive(Debug, Default)]
pub(super) struct Model {
    pub(super) objects: HashMap<u32, Object>,
    pub(super) build: Vec<Reference>,
    pub(super) notes: Vec<String>,
}

/// A mesh, or a group of other objects.
#[derive(Debug)]
pub(super) struct Object {
    /// Position among the objects of its part.
    pub(super) order: usize,
    pub(super) name: String,
    pub(super) mesh: Option<Mesh>,
    pub(super) components: Vec<Reference>,
}

/// An object somewhere, placed.
#[derive(Debug)]
pub(super) struct Reference {
    pub(super) object: u32,
    /// The part that holds the object; `None` for this one.
    pub(super) part: Option<String>,
    /// Row after row as the file has it; points are row vectors.
    pub(super) transform: [f32; 12],
}

const IDENTITY: [f32; 12] = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0];

/// Namespaces of required extensions that leave geometry as it is, or that are read.
const UNDERSTOOD: [&str; 3] = [
    "http://schemas.microsoft.com/3dmanufacturing/material/2015/02",
    "http://schemas.microsoft.com/3dmanufacturing/production/2015/06",
    "http://schemas.microsoft.com/3dmanufacturing/trianglesets/2021/07",
];

/// The elements around the current one, as far as they matter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Inside {
    Document,
    Model,
    Resources,
    Object,
    Mesh,
    Vertices,
    Triangles,
    Components,
    Build,
    /// An element that holds nothing more.
    Leaf,
}

/// The mesh that is being read.
#[derive(Debug, Default)]
struct Growing {
    id: u32,
    name: String,
    positions: Vec<[f32; 3]>,
    triangles: Vec<[u32; 3]>,
    has_mesh: bool,
    components: Vec<Reference>,
}

struct Parser<'a> {
    part: &'a str,
    model: Model,
    growing: Growing,
    skipped: u64,
}

impl Model {
    /// The other parts that this one names, in order.
    pub(super) fn other_parts(&self) -> impl Iterator<Item = &str> {
        let mut objects: Vec<&Object> = self.objects.values().collect();
        objects.sort_by_key(|object| object.order);
        let components = objects.into_iter().flat_map(|object| &object.components);
        components.chain(&self.build).filter_map(|reference| reference.part.as_deref())
    }

    pub(super) fn read(source: impl BufRead, part: &str) -> Result<Self, ReadError> {
        let mut reader = Reader::from_reader(source);
        reader.config_mut().expand_empty_elements = true;
        let mut parser = Parser { part, model: Self::default(), growing: Growing::default(), skipped: 0 };
        // One level an element; what is inside an unknown one is skipped by counting levels.
        let (mut levels, mut unknown) = (vec![Inside::Document], 0_u64);
        let mut buffer = Vec::new();
        loop {
            buffer.clear();
            let event = reader.read_event_into(&mut buffer);
            let at = reader.buffer_position();
            let event = event.map_err(|error| parser.broken(at, &error))?;
            match event {
                Event::Start(_) if unknown > 0 => unknown += 1,
                Event::Start(start) => {
                    let inside = levels[levels.len() - 1];
                    match parser.start(inside, &start, at)? {
                        Some(level) => levels.push(level),
                        None => {
                            unknown = 1;
                            parser.skipped += u64::from(inside == Inside::Mesh || inside == Inside::Object);
                        }
                    }
                }
                Event::End(_) if unknown > 0 => unknown -= 1,
                Event::End(_) => {
                    let left = levels.pop();
                    if left == Some(Inside::Object) {
                        parser.end_of_object(at)?;
                    }
                }
                Event::Eof if levels.len() > 1 => {
                    return Err(parser.error(at, "the part ends inside its model"));
                }
                Event::Eof => break,
                _ => {}
            }
        }
        if parser.skipped > 0 {
            let note = format!("{} inside objects of `{part}` ignored", counted(parser.skipped, "extension"));
            parser.model.notes.push(note);
        }
        Ok(parser.model)
    }
}

impl Parser<'_> {
    fn error(&self, at: u64, problem: impl Into<String>) -> ReadError {
        ReadError::new(Format::ThreeMf, Place::Item(format!("part `{}`, byte {at}", self.part)), problem)
    }

    fn broken(&self, at: u64, error: &dyn std::fmt::Display) -> ReadError {
        self.error(at, format!("the XML is not well-formed: {error}"))
    }

    /// Enters an element; `None` if it is unknown there.
    fn start(
        &mut self,
        inside: Inside,
        element: &BytesStart<'_>,
        at: u64,
    ) -> Result<Option<Inside>, ReadError> {
        let name = element.local_name();
        let name: &str = name.as_ref();
        Ok(Some(match (inside, name) {
            (Inside::Document, "model") => {
                self.require_understood(element, at)?;
                Inside::Model
            }
            (Inside::Document, _) => {
                let problem = format!("{} is not a 3MF model", quote(name.as_bytes()));
                return Err(self.error(at, problem));
            }
            (Inside::Model, "resources") => Inside::Resources,
            (Inside::Model, "build") => Inside::Build,
            (Inside::Resources, "object") => {
                let [id, name] = self.attributes(element, at, ["id", "name"])?;
                let id = self.number(id, "id", at)?;
                self.growing =
                    Growing { id, name: name.unwrap_or_default().into_owned(), ..Growing::default() };
                Inside::Object
            }
            (Inside::Object, "mesh") => {
                self.growing.has_mesh = true;
                Inside::Mesh
            }
            (Inside::Object, "components") => Inside::Components,
            (Inside::Mesh, "vertices") => Inside::Vertices,
            (Inside::Mesh, "triangles") => Inside::Triangles,
            (Inside::Vertices, "vertex") => {
                let point = self.attributes(element, at, ["x", "y", "z"])?;
                let mut position = [0.0; 3];
                for ((into, value), axis) in position.iter_mut().zip(point).zip(["x", "y", "z"]) {
                    *into = self.coordinate(value, axis, at)?;
                }
                self.growing.positions.push(position);
                Inside::Leaf
            }
            (Inside::Triangles, "triangle") => {
                let corners = self.attributes(element, at, ["v1", "v2", "v3"])?;
                let mut triangle = [0; 3];
                for ((into, value), name) in triangle.iter_mut().zip(corners).zip(["v1", "v2", "v3"]) {
                    *into = self.number(value, name, at)?;
                }
                let count = self.growing.positions.len();
                if let Some(corner) = triangle.iter().find(|&&corner| corner as usize >= count) {
                    let problem = format!("a triangle names vertex {corner}, but the mesh has {count}");
                    return Err(self.error(at, problem));
                }
                self.growing.triangles.push(triangle);
                Inside::Leaf
            }
            (Inside::Components, "component") => {
                let component = self.reference(element, at)?;
                self.growing.components.push(component);
                Inside::Leaf
            }
            (Inside::Build, "item") => {
                let item = self.reference(element, at)?;
                self.model.build.push(item);
                Inside::Leaf
            }
            _ => return Ok(None),
        }))
    }

    fn end_of_object(&mut self, at: u64) -> Result<(), ReadError> {
        let Growing { id, name, positions, triangles, has_mesh, components } =
            std::mem::take(&mut self.growing);
        let mesh = match has_mesh {
            false => None,
            true => Some(
                Mesh::new(positions, triangles)
                    .map_err(|error: MeshError| refused(Format::ThreeMf, &error))?,
            ),
        };
        let order = self.model.objects.len();
        if self.model.objects.insert(id, Object { order, name, mesh, components }).is_some() {
            return Err(self.error(at, format!("there are two objects {id}")));
        }
        Ok(())
    }

    /// Refuses a required extension that may change geometry.
    fn require_understood(&self, model: &BytesStart<'_>, at: u64) -> Result<(), ReadError> {
        let [required] = self.attributes(model, at, ["requiredextensions"])?;
        for prefix in required.as_deref().unwrap_or_default().split_ascii_whitespace() {
            let key = format!("xmlns:{prefix}");
            let [namespace] = self.attributes(model, at, [key.as_str()])?;
            let namespace = namespace.unwrap_or(Cow::Borrowed(prefix));
            if !UNDERSTOOD.contains(&namespace.as_ref()) {
                let problem = format!("the required extension `{}` is not read", name(namespace.as_bytes()));
                let remedy = "export the file without this extension, or as plain meshes";
                return Err(self.error(at, problem).remedy(remedy));
            }
        }
        Ok(())
    }

    fn reference(&self, element: &BytesStart<'_>, at: u64) -> Result<Reference, ReadError> {
        // The production extension's `path` has a prefix that the file chooses.
        let mut part = None;
        for attribute in element.attributes().flatten() {
            if attribute.key.local_name().as_ref() == "path" && attribute.key.prefix().is_some() {
                part = Some(attribute.value.trim_start_matches('/').to_owned());
            }
        }
        let [object, transform] = self.attributes(element, at, ["objectid", "transform"])?;
        let object = self.number(object, "objectid", at)?;
        let mut matrix = IDENTITY;
        if let Some(transform) = transform {
            let numbers: Option<Vec<f32>> = transform
                .split_ascii_whitespace()
                .map(|word| parse::<f32>(word.as_bytes()).filter(|x| x.is_finite()))
                .collect();
            matrix = numbers.and_then(|numbers| numbers.try_into().ok()).ok_or_else(|| {
                self.error(at, format!("the transform {} is not 12 numbers", quote(transform.as_bytes())))
            })?;
        }
        Ok(Reference { object, part, transform: matrix })
    }

    /// The values of the attributes of these names.
    fn attributes<'e, const N: usize>(
        &self,
        element: &'e BytesStart<'_>,
        at: u64,
        names: [&str; N],
    ) -> Result<[Option<Cow<'e, str>>; N], ReadError> {
        let mut values = [const { None }; N];
        let broken = |error: &dyn std::fmt::Display| self.broken(at, error);
        for attribute in element.attributes() {
            let attribute = attribute.map_err(|error| broken(&error))?;
            let key: &str = attribute.key.as_ref();
            if let Some(index) = names.iter().position(|name| *name == key) {
                let value = attribute.normalized_value(XmlVersion::Implicit1_0);
                values[index] = Some(value.map_err(|error| broken(&error))?);
            }
        }
        Ok(values)
    }

    fn number(&self, value: Option<Cow<'_, str>>, name: &str, at: u64) -> Result<u32, ReadError> {
        let value = value.unwrap_or_default();
        parse(value.trim().as_bytes())
            .ok_or_else(|| self.error(at, format!("{name} {} is not an index", quote(value.as_bytes()))))
    }

    fn coordinate(&self, value: Option<Cow<'_, str>>, axis: &str, at: u64) -> Result<f32, ReadError> {
        let value = value.unwrap_or_default();
        match parse::<f32>(value.trim().as_bytes()) {
            Some(x) if x.is_finite() => Ok(x),
            _ => {
                let problem =
                    format!("the coordinate {axis} {} is not a finite number", quote(value.as_bytes()));
                Err(self.error(at, problem))
            }
        }
    }
}

/// The target of the relationship to the first model part, in `_rels/.rels`.
pub(super) fn start_part(bytes: &[u8]) -> Option<String> {
    let mut reader = Reader::from_reader(bytes);
    reader.config_mut().expand_empty_elements = true;
    let mut buffer = Vec::new();
    loop {
        buffer.clear();
        match reader.read_event_into(&mut buffer).ok()? {
            Event::Start(element) => {
                let value = |name: &str| {
                    let found = element.attributes().flatten().find(|attribute| {
                        let key: &str = attribute.key.as_ref();
                        key == name
                    });
                    Some(found?.value.into_owned())
                };
                if value("Type").is_some_and(|kind| kind.ends_with("/3dmodel")) {
                    return value("Target").map(|target| target.trim_start_matches('/').to_owned());
                }
            }
            Event::Eof => return None,
            _ => {}
        }
    }
}
