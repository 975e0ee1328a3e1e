//! Wavefront OBJ: one object per layer, one group per part.

use std::io::{self, Write};
use std::ops::Range;

use super::{Elements, GENERATOR, Layer, Model};

/// Writes text. Coordinates are the shortest decimals that read back as the same `f32`, never with an
/// exponent; indices count from 1 through the whole file.
pub(super) fn write(model: &Model, writer: &mut dyn Write) -> io::Result<()> {
    writeln!(writer, "# {GENERATOR}")?;
    // A group lasts until the next one: if any layer has groups, every layer names its own.
    let grouped = model.layers.iter().any(|layer| !layer.parts.is_empty());
    let mut first = 1_u64;
    for layer in &model.layers {
        writeln!(writer, "o {}", plain(&layer.name))?;
        for [x, y, z] in &layer.positions {
            writeln!(writer, "v {x} {y} {z}")?;
        }
        let (keyword, corners) = match layer.elements {
            Elements::Triangles(_) => ("f", 3),
            Elements::Lines(_) => ("l", 2),
            Elements::Points(_) => ("p", 1),
        };
        for (name, elements) in runs(layer) {
            if grouped {
                writeln!(writer, "g {}", plain(name))?;
            }
            let indices = &layer.elements.indices()[elements.start * corners..elements.end * corners];
            for element in indices.chunks_exact(corners) {
                write!(writer, "{keyword}")?;
                for &index in element {
                    write!(writer, " {}", first + u64::from(index))?;
                }
                writeln!(writer)?;
            }
        }
        first += layer.positions.len() as u64;
    }
    Ok(())
}

/// All elements in order as named ranges; elements of no part are in the group "default" of the format.
fn runs(layer: &Layer) -> Vec<(&str, Range<usize>)> {
    let mut runs = Vec::with_capacity(2 * layer.parts.len() + 1);
    let mut done = 0;
    for part in &layer.parts {
        let [start, end] = [part.faces.start, part.faces.end].map(|face| face as usize);
        runs.push(("default", done..start));
        runs.push((part.name.as_str(), start..end));
        done = end;
    }
    runs.push(("default", done..layer.elements.len()));
    runs.retain(|(_, elements)| !elements.is_empty());
    runs
}

/// The name on one line, so that no reader takes it for a comment, a continued line or an empty name.
fn plain(name: &str) -> String {
    let name = name.replace(|c: char| c.is_control() || c == '#' || c == '\\', "_");
    if name.trim().is_empty() { "unnamed".to_owned() } else { name }
}

#[cfg(test)]
mod tests {
    use crate::mesh::Part;
    use crate::testing::shapes;
    use crate::write::{Elements, Layer, Model, Target, to_bytes};

    fn text(layers: Vec<Layer>) -> String {
        let text = String::from_utf8(to_bytes(&Model { layers }, Target::Obj).unwrap()).unwrap();
        let head = format!("# umbrage {}\n", env!("CARGO_PKG_VERSION"));
        text.strip_prefix(&head).unwrap().to_owned()
    }

    #[test]
    fn obj_layers_are_objects_and_indices_run_on() {
        let positions = vec![[0.0, -0.5, 1e-3], [1.0, 2.5, 0.1], [3.0, 1e10, -1.0]];
        let layers =
            [Elements::Triangles(vec![[0, 1, 2]]), Elements::Lines(vec![[2, 0]]), Elements::Points(vec![1])]
                .map(|elements| Layer {
                    name: "a".to_owned(),
                    positions: positions.clone(),
                    elements,
                    ..Layer::default()
                });
        let vertices = "v 0 -0.5 0.001\nv 1 2.5 0.1\nv 3 10000000000 -1\n";
        let wanted = format!("o a\n{vertices}f 1 2 3\no a\n{vertices}l 6 4\no a\n{vertices}p 8\n");
        assert_eq!(text(layers.into()), wanted);
    }

    #[test]
    fn obj_parts_are_groups_and_gaps_are_the_default_group() {
        let part = |name: &str, faces| Part::new(name, faces);
        let parts = vec![part("one", 1..2), part("none", 2..2), part("two\nf 9 9 9", 2..3)];
        let layer = Layer {
            positions: vec![[0.0; 3]],
            elements: Elements::Points(vec![0; 4]),
            parts,
            ..Layer::default()
        };
        let plain = Layer { parts: vec![], ..layer.clone() };
        let vertex = "o unnamed\nv 0 0 0\n";
        let wanted = format!(
            "{vertex}g default\np 1\ng one\np 1\ng two_f 9 9 9\np 1\ng default\np 1\n\
             {vertex}g default\np 2\np 2\np 2\np 2\n"
        );
        assert_eq!(text(vec![layer, plain]), wanted);
    }

    #[test]
    fn obj_coordinates_read_back_bit_for_bit() {
        let values = [f32::MIN_POSITIVE, f32::from_bits(1), f32::MAX, 1.0 / 3.0, 16_777_217.0, -0.1, 5e-39];
        let positions: Vec<_> = values.iter().map(|&x| [x, -x, x.cbrt()]).collect();
        let layer = Layer { positions: positions.clone(), ..Layer::default() };
        let text = text(vec![layer]);
        assert!(!text[text.find('v').unwrap()..].contains('e'), "an exponent: {text}");
        let read = text.lines().filter_map(|line| line.strip_prefix("v ")).map(|line| {
            let mut numbers = line.split(' ').map(|number| number.parse::<f32>().unwrap().to_bits());
            [(); 3].map(|()| numbers.next().unwrap())
        });
        assert!(read.eq(positions.iter().map(|p| p.map(f32::to_bits))));
    }

    #[test]
    fn obj_of_a_mesh_keeps_its_name_and_parts() {
        let text = text(vec![Layer::from(&shapes::hollow_cube())]);
        let marks: Vec<_> = text.lines().filter(|line| line.starts_with(['o', 'g'])).collect();
        assert_eq!(marks, ["o hollow cube", "g outer", "g cavity"]);
        assert_eq!(text.lines().filter(|line| line.starts_with("f ")).count(), 24);
    }
}
