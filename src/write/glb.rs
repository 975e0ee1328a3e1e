//! glTF 2.0, binary container: one node, mesh and primitive per layer.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::io::{self, Write};

use gltf::binary::{Glb, Header};
use gltf::json;
use json::accessor::{ComponentType, GenericComponentType, Type};
use json::buffer::{self, Target, View};
use json::extensions::material::Unlit;
use json::material::{AlphaMode, EmissiveFactor, PbrBaseColorFactor, PbrMetallicRoughness, StrengthFactor};
use json::mesh::{Mode, Primitive, Semantic};
use json::validation::{Checked, USize64};
use json::{Accessor, Index, Material, Root, Value};

use super::{Elements, GENERATOR, Layer, Model, WriteError};

/// Writes positions and `_W` as `f32`, indices as `u32`, each in its own buffer view.
///
/// A color becomes an unlit, two-sided material; readers without that extension get a rough, non-metallic
/// one. A layer without elements is a node without a mesh: the format has no empty accessor.
pub(super) fn write(model: &Model, writer: &mut dyn Write) -> Result<(), WriteError> {
    let drawn = |layer: &&Layer| !layer.elements.is_empty();
    let words: u64 = model
        .layers
        .iter()
        .filter(drawn)
        .map(|layer| {
            let vertex_words = 3 + u64::from(layer.w.is_some()) + u64::from(layer.quality.is_some());
            vertex_words * layer.positions.len() as u64 + layer.elements.indices().len() as u64
        })
        .sum();
    let bytes = words.saturating_mul(4);
    if bytes > u64::from(u32::MAX) {
        return Err(too_large(bytes));
    }
    let mut file = File { root: Root::default(), bytes: Vec::with_capacity(bytes as usize) };
    file.root.asset.generator = Some(GENERATOR.to_owned());
    let nodes: Vec<_> = model.layers.iter().map(|layer| file.node(layer)).collect();
    // The format has no empty scene, either.
    if !nodes.is_empty() {
        let scene = json::Scene { extensions: None, extras: None, name: None, nodes };
        file.root.scene = Some(file.root.push(scene));
    }
    if !file.bytes.is_empty() {
        let byte_length = USize64::from(file.bytes.len());
        file.root.buffers.push(json::Buffer {
            byte_length,
            name: None,
            uri: None,
            extensions: None,
            extras: None,
        });
    }

    let json = json::serialize::to_vec(&file.root).map_err(io::Error::other)?;
    container(json, file.bytes, writer)
}

/// Writes a document and its binary chunk.
pub(super) fn container(json: Vec<u8>, bytes: Vec<u8>, writer: &mut dyn Write) -> Result<(), WriteError> {
    // The header, two chunk headers, and up to three bytes of padding each.
    let length = 12 + 2 * 8 + json.len() as u64 + bytes.len() as u64 + 6;
    let Ok(length) = u32::try_from(length) else {
        return Err(too_large(length));
    };
    let bin = (!bytes.is_empty()).then_some(Cow::Owned(bytes));
    // `to_writer` computes the length itself.
    let header = Header { magic: *b"glTF", version: 2, length };
    Glb { header, json: Cow::Owned(json), bin }.to_writer(writer).map_err(|error| match error {
        gltf::Error::Io(error) | gltf::Error::Binary(gltf::binary::Error::Io(error)) => error.into(),
        other => WriteError::from(io::Error::other(other)),
    })
}

fn too_large(bytes: u64) -> WriteError {
    let problem = format!("{bytes} bytes are more than a GLB can hold (2^32 - 1)");
    WriteError::new(problem, "write less to a file, or use .ply")
}

/// The two chunks under construction.
struct File {
    root: Root,
    bytes: Vec<u8>,
}

impl File {
    fn node(&mut self, layer: &Layer) -> Index<json::Node> {
        let name = (!layer.name.is_empty()).then(|| layer.name.clone());
        let mesh = (!layer.elements.is_empty()).then(|| {
            let primitives = vec![self.primitive(layer)];
            let name = name.clone();
            self.root.push(json::Mesh { extensions: None, extras: None, name, primitives, weights: None })
        });
        self.root.push(json::Node { mesh, name, ..json::Node::default() })
    }

    fn primitive(&mut self, layer: &Layer) -> Primitive {
        let mut attributes = BTreeMap::new();
        let positions = layer.positions.as_flattened().iter().map(|x| x.to_le_bytes());
        let positions = self.accessor(
            Type::Vec3,
            ComponentType::F32,
            Target::ArrayBuffer,
            layer.positions.len(),
            positions,
        );
        // The format requires the bounding box of positions.
        let bound = |pick: fn(f32, f32) -> f32| {
            let corner =
                layer.positions.iter().copied().reduce(|p, q| std::array::from_fn(|i| pick(p[i], q[i])));
            corner.map(|corner| Value::from(corner.to_vec()))
        };
        let accessor = &mut self.root.accessors[positions.value()];
        (accessor.min, accessor.max) = (bound(f32::min), bound(f32::max));
        attributes.insert(Checked::Valid(Semantic::Positions), positions);
        if let Some(w) = &layer.w {
            let bytes = w.iter().map(|w| w.to_le_bytes());
            let w = self.accessor(Type::Scalar, ComponentType::F32, Target::ArrayBuffer, w.len(), bytes);
            attributes.insert(Checked::Valid(Semantic::Extras("W".to_owned())), w);
        }
        if let Some(quality) = &layer.quality {
            let bytes = quality.iter().map(|value| value.to_le_bytes());
            let (scalar, component) = (Type::Scalar, ComponentType::F32);
            let quality = self.accessor(scalar, component, Target::ArrayBuffer, quality.len(), bytes);
            attributes.insert(Checked::Valid(Semantic::Extras("QUALITY".to_owned())), quality);
        }
        let indices = layer.elements.indices();
        let bytes = indices.iter().map(|index| index.to_le_bytes());
        let target = Target::ElementArrayBuffer;
        let indices = self.accessor(Type::Scalar, ComponentType::U32, target, indices.len(), bytes);
        let mode = match layer.elements {
            Elements::Triangles(_) => Mode::Triangles,
            Elements::Lines(_) => Mode::Lines,
            Elements::Points(_) => Mode::Points,
        };
        Primitive {
            attributes,
            extensions: None,
            extras: None,
            indices: Some(indices),
            material: layer.color.map(|color| self.material(&layer.name, color)),
            mode: Checked::Valid(mode),
            targets: None,
        }
    }

    /// Appends values of four bytes, which keeps everything aligned.
    fn accessor(
        &mut self,
        type_: Type,
        component_type: ComponentType,
        target: Target,
        count: usize,
        values: impl Iterator<Item = [u8; 4]>,
    ) -> Index<Accessor> {
        let start = self.bytes.len();
        for value in values {
            self.bytes.extend_from_slice(&value);
        }
        let view = self.root.push(View {
            buffer: Index::<buffer::Buffer>::new(0),
            byte_length: USize64::from(self.bytes.len() - start),
            byte_offset: Some(USize64::from(start)),
            byte_stride: None,
            name: None,
            target: Some(Checked::Valid(target)),
            extensions: None,
            extras: None,
        });
        self.root.push(Accessor {
            buffer_view: Some(view),
            byte_offset: None,
            count: USize64::from(count),
            component_type: Checked::Valid(GenericComponentType(component_type)),
            extensions: None,
            extras: None,
            type_: Checked::Valid(type_),
            min: None,
            max: None,
            name: None,
            normalized: false,
            sparse: None,
        })
    }

    fn material(&mut self, name: &str, color: [f32; 4]) -> Index<Material> {
        const UNLIT: &str = "KHR_materials_unlit";
        if self.root.extensions_used.is_empty() {
            self.root.extensions_used.push(UNLIT.to_owned());
        }
        self.root.push(Material {
            alpha_mode: Checked::Valid(if color[3] < 1.0 { AlphaMode::Blend } else { AlphaMode::Opaque }),
            double_sided: true,
            name: (!name.is_empty()).then(|| name.to_owned()),
            pbr_metallic_roughness: PbrMetallicRoughness {
                base_color_factor: PbrBaseColorFactor(color),
                metallic_factor: StrengthFactor(0.0),
                roughness_factor: StrengthFactor(1.0),
                ..PbrMetallicRoughness::default()
            },
            emissive_factor: EmissiveFactor([0.0; 3]),
            extensions: Some(json::extensions::material::Material { unlit: Some(Unlit {}) }),
            ..Material::default()
        })
    }
}

#[cfg(test)]
mod tests {
    use gltf::Gltf;
    use gltf::mesh::{Mode, Semantic};

    use crate::testing::shapes;
    use crate::write::{Elements, Layer, Model, Target, to_bytes};

    fn bytes(layers: Vec<Layer>) -> Vec<u8> {
        let bytes = to_bytes(&Model { layers }, Target::Glb).unwrap();
        assert_eq!(bytes.len() % 4, 0);
        assert_eq!(u32::from_le_bytes(bytes[8..12].try_into().unwrap()) as usize, bytes.len());
        bytes
    }

    /// The layers of a file, read by another reader, which validates what it reads.
    fn read(bytes: &[u8]) -> Vec<Layer> {
        let file = Gltf::from_slice(bytes).unwrap();
        let blob = file.blob.as_deref().unwrap_or_default();
        let nodes = file.default_scene().unwrap().nodes();
        let layers = nodes.map(|node| {
            let mut layer = Layer { name: node.name().unwrap_or_default().to_owned(), ..Layer::default() };
            let Some(mesh) = node.mesh() else { return layer };
            assert_eq!(mesh.primitives().len(), 1);
            let primitive = mesh.primitives().next().unwrap();
            let reader = primitive.reader(|_| Some(blob));
            layer.positions = reader.read_positions().unwrap().collect();
            let indices: Vec<u32> = reader.read_indices().unwrap().into_u32().collect();
            layer.elements = match primitive.mode() {
                Mode::Triangles => Elements::Triangles(indices.as_chunks().0.to_vec()),
                Mode::Lines => Elements::Lines(indices.as_chunks().0.to_vec()),
                Mode::Points => Elements::Points(indices),
                other => panic!("{other:?}"),
            };
            layer.w = primitive.get(&Semantic::Extras("W".to_owned())).map(|accessor| {
                gltf::accessor::Iter::<f32>::new(accessor, |_| Some(blob)).unwrap().collect()
            });
            let material = primitive.material();
            layer.color = material.index().map(|_| {
                assert!(material.unlit() && material.double_sided());
                material.pbr_metallic_roughness().base_color_factor()
            });
            layer
        });
        layers.collect()
    }

    fn layers() -> Vec<Layer> {
        let cube = Layer { name: "cube".to_owned(), ..Layer::from(&shapes::cube()) };
        let odd = vec![[f32::MIN_POSITIVE, f32::from_bits(1), 0.1], [f32::MAX, -f32::MAX, 1.0 / 3.0]];
        let lines = Layer {
            name: "silhouette \"é\"".to_owned(),
            color: Some([1.0, 0.5, 0.0, 0.25]),
            positions: odd,
            w: Some(vec![0.0, 1.0]),
            elements: Elements::Lines(vec![[0, 1], [1, 0]]),
            ..Layer::default()
        };
        let points = Layer { elements: Elements::Points(vec![1, 1, 0]), color: None, ..lines.clone() };
        vec![cube, lines, points]
    }

    #[test]
    fn glb_reads_back_bit_for_bit() {
        let read = read(&bytes(layers()));
        assert_eq!(read, layers());
        for (read, written) in read.iter().zip(&layers()) {
            let bits = |layer: &Layer| {
                layer.positions.as_flattened().iter().map(|x| x.to_bits()).collect::<Vec<_>>()
            };
            assert_eq!(bits(read), bits(written));
        }
    }

    #[test]
    fn glb_comparison_notices_one_flipped_bit() {
        let mut bytes = bytes(layers());
        let last = bytes.len() - 4; // an index of the last layer
        bytes[last] ^= 1;
        assert_ne!(read(&bytes), layers());
    }

    #[test]
    fn glb_positions_have_their_bounds() {
        let file = Gltf::from_slice(&bytes(layers())).unwrap();
        let primitives: Vec<_> = file.meshes().map(|mesh| mesh.primitives().next().unwrap()).collect();
        let bounds: Vec<_> =
            primitives.iter().map(|p| (p.bounding_box().min, p.bounding_box().max)).collect();
        assert_eq!(bounds[0], ([-1.0; 3], [1.0; 3]));
        let low = [f32::MIN_POSITIVE, -f32::MAX, 0.1];
        assert_eq!(bounds[1], (low, [f32::MAX, f32::from_bits(1), 1.0 / 3.0]));
        let generator = file.document.into_json().asset.generator.unwrap();
        assert_eq!(generator, format!("umbrage {}", env!("CARGO_PKG_VERSION")));
    }

    #[test]
    fn glb_skips_what_is_empty() {
        let empty = Layer { name: "nothing".to_owned(), positions: vec![[1.0; 3]], ..Layer::default() };
        let read_back = read(&bytes(vec![empty, layers().remove(0)]));
        assert_eq!(read_back[0], Layer { name: "nothing".to_owned(), ..Layer::default() });
        assert_eq!(read_back[1], layers()[0]);
        assert_eq!(read(&bytes(vec![Layer::default()])), [Layer::default()]);
        let nothing = Gltf::from_slice(&bytes(vec![])).unwrap();
        assert!(nothing.scenes().len() == 0 && nothing.blob.is_none());
    }
}
