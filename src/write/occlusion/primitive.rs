//! One primitive: its vertices split where they have several values, and the values as an attribute.

use std::collections::HashMap;

use serde_json::{Value, json};

use super::document::{Document, INDICES, whole};
use super::split::{NONE, Split};
use super::{Form, Occlusion, WriteError};
use crate::read::stored::Primitive;

/// Component types of glTF.
const U8: u32 = 5121;
const U16: u32 = 5123;
const U32: u32 = 5125;
const F32: u32 = 5126;

/// The name of the attribute that holds openness, and of that with mean open directions.
pub(super) const OCCLUSION: &str = "_OCCLUSION";
pub(super) const BENT: &str = "_BENT";

/// A primitive of the document, and what it gets.
pub(super) struct Target<'a> {
    /// JSON pointer.
    pub(super) pointer: String,
    pub(super) primitive: &'a Primitive,
    pub(super) split: Split,
    /// The accessor of the colors that the file has.
    pub(super) color: Option<usize>,
}

impl Target<'_> {
    /// Copies vertices that have several values: indices and all attributes, those of morph targets too.
    pub(super) fn split(&self, document: &mut Document<'_, '_>) -> Result<(), WriteError> {
        if self.split.copies.is_empty() {
            return Ok(());
        }
        let mut new_of_old = HashMap::new();
        let mut lists = vec![format!("{}/attributes", self.pointer)];
        let targets = document.root.pointer(&format!("{}/targets", self.pointer)).and_then(Value::as_array);
        let targets = targets.map_or(0, Vec::len);
        lists.extend((0..targets).map(|target| format!("{}/targets/{target}", self.pointer)));
        for list in lists {
            let names: Vec<String> = document.object(&list)?.keys().cloned().collect();
            for name in names {
                let old = document.object(&list)?.get(&name);
                let old = whole(old).ok_or_else(|| bad(&list, &name, "is not the index of an accessor"))?;
                let new = match new_of_old.get(&old) {
                    Some(&new) => new,
                    None => {
                        let new = self.copy(document, old, &list, &name)?;
                        new_of_old.insert(old, new);
                        new
                    }
                };
                document.object(&list)?.insert(name, Value::from(new));
            }
        }
        let indices = self.index_accessor(document);
        let primitive = document.object(&self.pointer)?;
        primitive.insert("indices".to_owned(), indices.into());
        // Strips and fans are single triangles now.
        if primitive.contains_key("mode") {
            primitive.insert("mode".to_owned(), 4.into());
        }
        Ok(())
    }

    /// A copy of an accessor, with its split vertices at the end.
    fn copy(
        &self,
        document: &mut Document<'_, '_>,
        old: usize,
        list: &str,
        name: &str,
    ) -> Result<usize, WriteError> {
        let elements = document.elements(old)?;
        if elements.bytes.len() != self.primitive.vertices {
            let problem =
                format!("has {} elements for {} vertices", elements.bytes.len(), self.primitive.vertices);
            return Err(bad(list, name, &problem));
        }
        // A copy is no farther out than its vertex: the bounds stay.
        let mut accessor = Value::Object(document.object(&format!("/accessors/{old}"))?.clone());
        for key in ["sparse", "byteOffset"] {
            accessor.as_object_mut().and_then(|accessor| accessor.remove(key));
        }
        let all: Vec<[u8; 16]> = (elements.bytes.iter().copied())
            .chain(self.split.copies.iter().map(|&vertex| elements.bytes[vertex as usize]))
            .collect();
        Ok(document.attribute(accessor, elements.size, all.into_iter()))
    }

    fn index_accessor(&self, document: &mut Document<'_, '_>) -> usize {
        let corners = self.split.triangles.as_flattened();
        // The largest index of each type restarts strips.
        let short = self.split.receivers.len() <= usize::from(u16::MAX);
        let (component, bytes): (u32, Vec<u8>) = match short {
            true => (U16, corners.iter().flat_map(|&corner| (corner as u16).to_le_bytes()).collect()),
            false => (U32, corners.iter().flat_map(|corner| corner.to_le_bytes()).collect()),
        };
        let view = document.view(&bytes, Some(INDICES), None);
        let accessor =
            json!({"bufferView": view, "componentType": component, "count": corners.len(), "type": "SCALAR"});
        document.push("accessors", accessor)
    }

    /// Adds the values as the attribute of a form; `set` is the texture coordinate of a texture.
    pub(super) fn add(
        &self,
        document: &mut Document<'_, '_>,
        form: Form,
        set: usize,
        occlusion: &Occlusion<'_>,
    ) -> Result<(), WriteError> {
        let open = |&receiver: &u32| match receiver {
            NONE => 1.0,
            _ => occlusion.openness[receiver as usize],
        };
        let values = self.split.receivers.iter().map(open);
        let (name, accessor) = match form {
            Form::Texture => {
                let accessor = json!({"componentType": F32, "type": "VEC2"});
                let elements = values.map(|open| packed(&super::ramp::coordinates(open)));
                (format!("TEXCOORD_{set}"), document.attribute(accessor, 8, elements))
            }
            Form::Attribute => {
                let accessor = json!({"componentType": F32, "type": "SCALAR"});
                (OCCLUSION.to_owned(), document.attribute(accessor, 4, values.map(|open| packed(&[open]))))
            }
            Form::Color => {
                let (component, colors) = self.colors(document, values)?;
                let size = match component {
                    U8 => 4,
                    U16 => 8,
                    _ => 16,
                };
                let accessor =
                    json!({"componentType": component, "type": "VEC4", "normalized": component != F32});
                let elements = colors.iter().map(|&color| color_bytes(component, color));
                ("COLOR_0".to_owned(), document.attribute(accessor, size, elements))
            }
        };
        let attributes = format!("{}/attributes", self.pointer);
        document.object(&attributes)?.insert(name, accessor.into());
        Ok(())
    }

    /// The colors of the file, or white, times the values; and the component type of both.
    fn colors(
        &self,
        document: &Document<'_, '_>,
        values: impl Iterator<Item = f32>,
    ) -> Result<(u32, Vec<[f32; 4]>), WriteError> {
        let Some(color) = self.color else {
            return Ok((U8, values.map(|open| [open, open, open, 1.0]).collect()));
        };
        let component = whole(document.stored.root().pointer(&format!("/accessors/{color}/componentType")));
        let component = [U8, U16].into_iter().find(|&known| component == Some(known as usize)).unwrap_or(F32);
        let old = document.stored.numbers(color)?;
        let of = |vertex: usize| match vertex.checked_sub(self.primitive.vertices) {
            None => vertex,
            Some(copy) => self.split.copies[copy] as usize,
        };
        let times = |(vertex, open): (usize, f32)| {
            let [red, green, blue, alpha] = *old.get(of(vertex)).unwrap_or(&[1.0; 4]);
            [red * open, green * open, blue * open, alpha]
        };
        Ok((component, values.enumerate().map(times).collect()))
    }

    /// Adds mean open directions, in the space of the mesh: a reader turns them as it turns normals.
    pub(super) fn add_bent(
        &self,
        document: &mut Document<'_, '_>,
        bent: &[[f32; 3]],
        world_from_mesh: glam::Mat4,
    ) -> Result<(), WriteError> {
        // Normals go to the world by the inverse transpose, so back by the transpose.
        let to_mesh = glam::Mat3::from_mat4(world_from_mesh).transpose().as_dmat3();
        let of = |&receiver: &u32| match receiver {
            NONE => [0.0; 3],
            _ => {
                let world = glam::DVec3::from(bent[receiver as usize].map(f64::from));
                (to_mesh * world).normalize_or_zero().as_vec3().to_array()
            }
        };
        let elements = self.split.receivers.iter().map(|receiver| packed(&of(receiver)));
        let accessor = document.attribute(json!({"componentType": F32, "type": "VEC3"}), 12, elements);
        let attributes = format!("{}/attributes", self.pointer);
        document.object(&attributes)?.insert(BENT.to_owned(), accessor.into());
        Ok(())
    }
}

fn bad(list: &str, name: &str, problem: &str) -> WriteError {
    WriteError::new(format!("{list}/{name} {problem}"), "export the file again")
}

fn packed(numbers: &[f32]) -> [u8; 16] {
    let mut bytes = [0; 16];
    for (four, number) in bytes.chunks_exact_mut(4).zip(numbers) {
        four.copy_from_slice(&number.to_le_bytes());
    }
    bytes
}

/// A linear color of this component type.
fn color_bytes(component: u32, color: [f32; 4]) -> [u8; 16] {
    let mut bytes = [0; 16];
    match component {
        U8 => color.iter().zip(&mut bytes).for_each(|(x, byte)| *byte = (x * 255.0).round() as u8),
        U16 => {
            for (two, x) in bytes.chunks_exact_mut(2).zip(color) {
                two.copy_from_slice(&((x * 65535.0).round() as u16).to_le_bytes());
            }
        }
        _ => bytes = packed(&color),
    }
    bytes
}
