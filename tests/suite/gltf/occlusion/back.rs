//! A GLB taken apart by hand: what each corner of a primitive has, by no code of the library.

use serde_json::Value;

pub(super) struct Back {
    pub(super) doc: Value,
    pub(super) bin: Vec<u8>,
}

impl Back {
    pub(super) fn of(glb: &[u8]) -> Self {
        let word = |at: usize| u32::from_le_bytes(glb[at..at + 4].try_into().unwrap()) as usize;
        assert_eq!((&glb[..4], word(8)), (&b"glTF"[..], glb.len()));
        let json = &glb[20..20 + word(12)];
        let start = 20 + word(12) + 8;
        let doc: Value = serde_json::from_slice(json).unwrap();
        let bin = glb[start..start + word(start - 8)].to_vec();
        assert!(doc["buffers"][0]["byteLength"].as_u64().unwrap() as usize <= bin.len());
        Self { doc, bin }
    }

    /// The mesh of each node of the scene that has one.
    pub(super) fn shown(&self) -> Vec<usize> {
        let nodes = self.doc["scenes"][0]["nodes"].as_array().unwrap();
        let mesh = |node: &Value| self.doc["nodes"][node.as_u64().unwrap() as usize]["mesh"].as_u64();
        nodes.iter().filter_map(mesh).map(|mesh| mesh as usize).collect()
    }

    pub(super) fn primitive(&self, mesh: usize, primitive: usize) -> &Value {
        &self.doc["meshes"][mesh]["primitives"][primitive]
    }

    /// The names of attributes in a list of them.
    pub(super) fn names(&self, mesh: usize, primitive: usize, list: &str) -> Vec<String> {
        let list = self.primitive(mesh, primitive).pointer(&format!("/{list}"));
        list.and_then(Value::as_object).into_iter().flat_map(|list| list.keys().cloned()).collect()
    }

    /// The bytes of a view.
    pub(super) fn view(&self, index: usize) -> &[u8] {
        let view = &self.doc["bufferViews"][index];
        assert_eq!(view["buffer"], 0);
        &self.bin[view["byteOffset"].as_u64().unwrap_or(0) as usize..]
            [..view["byteLength"].as_u64().unwrap() as usize]
    }

    /// The elements of an accessor as numbers.
    pub(super) fn elements(&self, accessor: usize) -> Vec<Vec<f64>> {
        let accessor = &self.doc["accessors"][accessor];
        let view = accessor["bufferView"].as_u64().unwrap() as usize;
        let bytes = self.view(view);
        let width = match accessor["type"].as_str().unwrap() {
            "SCALAR" => 1,
            "VEC2" => 2,
            "VEC3" => 3,
            "VEC4" => 4,
            other => panic!("{other}"),
        };
        let normalized = accessor["normalized"] == true;
        let (size, most) = match accessor["componentType"].as_u64().unwrap() {
            5121 => (1, 255.0),
            5123 => (2, 65535.0),
            5125 | 5126 => (4, 1.0),
            other => panic!("{other}"),
        };
        let is_float = accessor["componentType"] == 5126;
        let number = |at: usize| {
            let bytes = &bytes[at..at + size];
            let mut word = [0; 4];
            word[..size].copy_from_slice(bytes);
            match is_float {
                true => f64::from(f32::from_le_bytes(word)),
                false if normalized => f64::from(u32::from_le_bytes(word)) / most,
                false => f64::from(u32::from_le_bytes(word)),
            }
        };
        let stride =
            self.doc["bufferViews"][view]["byteStride"].as_u64().map_or(width * size, |s| s as usize);
        assert!(self.doc["bufferViews"][view]["byteStride"].is_null() || stride.is_multiple_of(4));
        let first = accessor["byteOffset"].as_u64().unwrap_or(0) as usize;
        let count = accessor["count"].as_u64().unwrap() as usize;
        let element =
            |index: usize| (0..width).map(|axis| number(first + index * stride + axis * size)).collect();
        (0..count).map(element).collect()
    }

    /// The vertices of the faces of a primitive.
    pub(super) fn faces(&self, mesh: usize, primitive: usize) -> Vec<[usize; 3]> {
        let primitive = self.primitive(mesh, primitive);
        let position = primitive["attributes"]["POSITION"].as_u64().unwrap() as usize;
        let vertices = self.doc["accessors"][position]["count"].as_u64().unwrap() as usize;
        let indices: Vec<usize> = match primitive["indices"].as_u64() {
            Some(accessor) => {
                self.elements(accessor as usize).iter().map(|index| index[0] as usize).collect()
            }
            None => (0..vertices).collect(),
        };
        match primitive["mode"].as_u64().unwrap_or(4) {
            4 => indices.as_chunks().0.to_vec(),
            5 => (0..indices.len() - 2)
                .map(|i| if i % 2 == 0 { [i, i + 1, i + 2] } else { [i, i + 2, i + 1] })
                .map(|face| face.map(|corner| indices[corner]))
                .collect(),
            6 => (1..indices.len() - 1).map(|i| [indices[i], indices[i + 1], indices[0]]).collect(),
            other => panic!("{other}"),
        }
    }

    /// What each corner has of an attribute: `attributes/POSITION`, `targets/0/NORMAL`.
    pub(super) fn corners(&self, mesh: usize, primitive: usize, attribute: &str) -> Vec<[Vec<f64>; 3]> {
        let accessor = self.primitive(mesh, primitive).pointer(&format!("/{attribute}"));
        let elements = self.elements(accessor.unwrap().as_u64().unwrap() as usize);
        let faces = self.faces(mesh, primitive);
        faces.into_iter().map(|face| face.map(|corner| elements[corner].clone())).collect()
    }

    /// The red of a texture of one row at `u`, filtered linearly and clamped, as the sampler must say.
    pub(super) fn sample(&self, texture: usize, u: f64) -> f64 {
        let texture = &self.doc["textures"][texture];
        let sampler = &self.doc["samplers"][texture["sampler"].as_u64().unwrap() as usize];
        assert_eq!([&sampler["magFilter"], &sampler["minFilter"]], [9729, 9729]);
        assert_eq!([&sampler["wrapS"], &sampler["wrapT"]], [33071, 33071]);
        let image = &self.doc["images"][texture["source"].as_u64().unwrap() as usize];
        assert_eq!(image["mimeType"], "image/png");
        let png = self.view(image["bufferView"].as_u64().unwrap() as usize);
        let mut reader = png::Decoder::new(std::io::Cursor::new(png)).read_info().unwrap();
        let mut texels = vec![0; reader.output_buffer_size().unwrap()];
        let info = reader.next_frame(&mut texels).unwrap();
        assert_eq!((info.width, info.height, info.color_type), (256, 1, png::ColorType::Grayscale));
        let at = u * 256.0 - 0.5;
        let texel = |at: f64| f64::from(texels[at.clamp(0.0, 255.0) as usize]) / 255.0;
        let (low, part) = (at.floor(), at - at.floor());
        texel(low) * (1.0 - part) + texel(low + 1.0) * part
    }
}
