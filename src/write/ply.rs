//! PLY, binary little-endian: all layers as one list of vertices, one of faces, one of edges.

use std::io::Write;

use super::{Elements, GENERATOR, Layer, Model, WriteError};

/// Writes the element `vertex` with `x y z`, then `red green blue alpha` where any layer has a color (the
/// other layers are opaque white), then `w` and `quality` where any layer has one (the other layers have 1);
/// a color is darkened by the quality; the element
/// `face` with a list of three indices, and the element `edge` with two, each where there are any. Points are
/// vertices that no element names. A comment per layer says where it begins.
pub(super) fn write(model: &Model, writer: &mut dyn Write) -> Result<(), WriteError> {
    let layers = &model.layers;
    let vertex_count: u64 = layers.iter().map(|layer| layer.positions.len() as u64).sum();
    if vertex_count > 1 << 32 {
        let problem = format!("{vertex_count} vertices are more than PLY indices of 32 bits can name");
        return Err(WriteError::new(problem, "write fewer layers to a file"));
    }
    let colored = layers.iter().any(|layer| layer.color.is_some() || layer.quality.is_some());
    let valued = layers.iter().any(|layer| layer.quality.is_some());
    let homogeneous = layers.iter().any(|layer| layer.w.is_some());
    let faces: usize = layers.iter().map(|layer| triangles(layer).len()).sum();
    let edges: usize = layers.iter().map(|layer| lines(layer).len()).sum();

    writeln!(writer, "ply\nformat binary_little_endian 1.0\ncomment {GENERATOR}")?;
    for layer in layers {
        let what = match layer.elements {
            Elements::Triangles(_) => "triangles",
            Elements::Lines(_) => "lines",
            Elements::Points(_) => "points",
        };
        let name = layer.name.replace(char::is_control, "_");
        let (vertices, elements) = (layer.positions.len(), layer.elements.len());
        writeln!(writer, "comment layer {vertices} vertices, {elements} {what}: {name}")?;
    }
    writeln!(writer, "element vertex {vertex_count}")?;
    writeln!(writer, "property float x\nproperty float y\nproperty float z")?;
    if colored {
        for channel in ["red", "green", "blue", "alpha"] {
            writeln!(writer, "property uchar {channel}")?;
        }
    }
    if homogeneous {
        writeln!(writer, "property float w")?;
    }
    if valued {
        writeln!(writer, "property float quality")?;
    }
    if faces > 0 {
        writeln!(writer, "element face {faces}\nproperty list uchar uint vertex_indices")?;
    }
    if edges > 0 {
        writeln!(writer, "element edge {edges}\nproperty uint vertex1\nproperty uint vertex2")?;
    }
    writeln!(writer, "end_header")?;

    for layer in layers {
        let color = layer.color.unwrap_or([1.0; 4]);
        for (vertex, position) in layer.positions.iter().enumerate() {
            for x in position {
                writer.write_all(&x.to_le_bytes())?;
            }
            let quality = layer.quality.as_ref().map_or(1.0, |quality| quality[vertex]);
            if colored {
                let [red, green, blue, alpha] = color;
                writer.write_all(&bytes_of([red * quality, green * quality, blue * quality, alpha]))?;
            }
            if homogeneous {
                let w = layer.w.as_ref().map_or(1.0, |w| w[vertex]);
                writer.write_all(&w.to_le_bytes())?;
            }
            if valued {
                writer.write_all(&quality.to_le_bytes())?;
            }
        }
    }
    // Indices run on through the layers; their sum was checked above.
    let mut first = 0;
    for layer in layers {
        for triangle in triangles(layer) {
            writer.write_all(&[3])?;
            for index in triangle {
                writer.write_all(&(first + index).to_le_bytes())?;
            }
        }
        first = first.wrapping_add(layer.positions.len() as u32);
    }
    let mut first = 0;
    for layer in layers {
        for index in lines(layer).as_flattened() {
            writer.write_all(&(first + index).to_le_bytes())?;
        }
        first = first.wrapping_add(layer.positions.len() as u32);
    }
    Ok(())
}

fn triangles(layer: &Layer) -> &[[u32; 3]] {
    if let Elements::Triangles(triangles) = &layer.elements { triangles } else { &[] }
}

fn lines(layer: &Layer) -> &[[u32; 2]] {
    if let Elements::Lines(lines) = &layer.elements { lines } else { &[] }
}

/// Color as PLY viewers expect it: sRGB (IEC 61966-2-1) in eight bits, opacity linear.
fn bytes_of(color: [f32; 4]) -> [u8; 4] {
    let [red, green, blue, alpha] = color.map(f64::from);
    let curve = |x: f64| if x <= 0.003_130_8 { 12.92 * x } else { 1.055 * x.powf(1.0 / 2.4) - 0.055 };
    [curve(red), curve(green), curve(blue), alpha].map(|x| (x * 255.0).round() as u8)
}

#[cfg(test)]
mod tests {
    use crate::testing::shapes;
    use crate::write::{Elements, Layer, Model, Target, to_bytes};

    /// The header's lines after the maker's, and the bytes after it.
    fn parts(layers: Vec<Layer>) -> (Vec<String>, Vec<u8>) {
        let bytes = to_bytes(&Model { layers }, Target::Ply).unwrap();
        let end = b"end_header\n";
        let at = bytes.windows(end.len()).position(|window| window == end).unwrap();
        let header = String::from_utf8(bytes[..at].to_vec()).unwrap();
        let lines: Vec<String> = header.lines().map(str::to_owned).collect();
        let maker = format!("comment umbrage {}", env!("CARGO_PKG_VERSION"));
        assert_eq!(lines[..3], ["ply", "format binary_little_endian 1.0", &maker]);
        (lines[3..].to_vec(), bytes[at + end.len()..].to_vec())
    }

    fn layer(elements: Elements) -> Layer {
        let positions = vec![[1.0, 2.0, -3.0], [0.5, 0.0, 0.0], [f32::MAX, f32::MIN_POSITIVE, 0.1]];
        Layer { name: "a\nelement x 1".to_owned(), positions, elements, ..Layer::default() }
    }

    #[test]
    fn ply_of_triangles_and_lines_is_these_bytes() {
        let layers =
            vec![layer(Elements::Triangles(vec![[0, 1, 2]])), layer(Elements::Lines(vec![[2, 0], [0, 1]]))];
        let positions: Vec<u8> =
            layers.iter().flat_map(|l| l.positions.as_flattened()).flat_map(|x| x.to_le_bytes()).collect();
        let (header, bytes) = parts(layers);
        assert_eq!(
            header,
            [
                "comment layer 3 vertices, 1 triangles: a_element x 1",
                "comment layer 3 vertices, 2 lines: a_element x 1",
                "element vertex 6",
                "property float x",
                "property float y",
                "property float z",
                "element face 1",
                "property list uchar uint vertex_indices",
                "element edge 2",
                "property uint vertex1",
                "property uint vertex2",
            ]
        );
        let mut wanted = positions;
        wanted.push(3);
        for index in [0_u32, 1, 2, 5, 3, 3, 4] {
            wanted.extend(index.to_le_bytes());
        }
        assert_eq!(bytes, wanted);
    }

    #[test]
    fn ply_of_points_has_vertices_alone() {
        let (header, bytes) = parts(vec![layer(Elements::Points(vec![1]))]);
        assert_eq!(header.iter().filter(|line| line.starts_with("element")).count(), 1);
        assert_eq!(bytes.len(), 36);
    }

    #[test]
    fn ply_color_and_w_stand_in_every_vertex() {
        let mut marked = layer(Elements::Points(vec![]));
        marked.color = Some([1.0, 0.0, 0.214_041_14, 0.5]);
        marked.w = Some(vec![0.0, 1.0, 2.0]);
        let (header, bytes) = parts(vec![marked, layer(Elements::Points(vec![]))]);
        let properties: Vec<_> = header.iter().filter_map(|line| line.strip_prefix("property ")).collect();
        let wanted = ["float x", "float y", "float z", "uchar red", "uchar green", "uchar blue"];
        assert_eq!(properties[..6], wanted);
        assert_eq!(properties[6..], ["uchar alpha", "float w"]);
        assert_eq!(bytes.len(), 6 * 20);
        let tail = |vertex: usize| {
            let tail = &bytes[vertex * 20 + 12..][..8];
            ([tail[0], tail[1], tail[2], tail[3]], f32::from_le_bytes([tail[4], tail[5], tail[6], tail[7]]))
        };
        assert_eq!(tail(0), ([255, 0, 128, 128], 0.0));
        assert_eq!(tail(2), ([255, 0, 128, 128], 2.0));
        assert_eq!(tail(3), ([255; 4], 1.0));
    }

    #[test]
    fn ply_is_read_by_another_reader() {
        use ply_rs_bw::parser::Parser;
        use ply_rs_bw::ply::{DefaultElement, Property};
        let cube = shapes::cube();
        let bytes = to_bytes(&Model { layers: vec![Layer::from(&cube)] }, Target::Ply).unwrap();
        let ply = Parser::<DefaultElement>::new().read_ply(&mut bytes.as_slice()).unwrap();
        let read: Vec<_> = ply.payload["vertex"]
            .iter()
            .map(|vertex| ["x", "y", "z"].map(|key| vertex[key].clone()))
            .collect();
        assert!(
            read.iter().eq(cube
                .positions()
                .iter()
                .map(|p| p.map(Property::Float))
                .collect::<Vec<_>>()
                .iter())
        );
        let faces: Vec<_> = ply.payload["face"].iter().map(|face| face["vertex_indices"].clone()).collect();
        let wanted: Vec<_> = cube.triangles().iter().map(|t| Property::ListUInt(t.to_vec())).collect();
        assert_eq!(faces, wanted);
    }
}
