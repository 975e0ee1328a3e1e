//! STL, binary: all layers as one list of triangles.

use std::io::Write;

use super::{Elements, GENERATOR, Model, WriteError};

/// Writes three positions a triangle, bit for bit, with the unit normal, or zeros where it has no area.
///
/// The format has no vertices that faces share: whoever reads it joins equal positions again, whether they
/// were one or not. It holds triangles alone, without names.
pub(super) fn write(model: &Model, writer: &mut dyn Write) -> Result<(), WriteError> {
    let mut layers = Vec::with_capacity(model.layers.len());
    for layer in &model.layers {
        match &layer.elements {
            Elements::Triangles(triangles) if layer.w.is_none() => layers.push((&layer.positions, triangles)),
            _ => {
                let problem =
                    format!("layer {:?}: STL holds triangles between finite points alone", layer.name);
                return Err(WriteError::new(problem, "use .ply or .glb"));
            }
        }
    }
    let faces: usize = layers.iter().map(|(_, triangles)| triangles.len()).sum();
    let Ok(count) = u32::try_from(faces) else {
        return Err(WriteError::new(format!("{faces} triangles are more than an STL counts"), "use .ply"));
    };
    // 80 bytes of comment; it must not begin with "solid", as text does.
    writer.write_all(format!("{GENERATOR:<80}").as_bytes())?;
    writer.write_all(&count.to_le_bytes())?;
    for (positions, triangles) in layers {
        for corners in triangles {
            let corners = corners.map(|vertex| positions[vertex as usize]);
            for x in [normal(corners)].iter().chain(&corners).flatten() {
                writer.write_all(&x.to_le_bytes())?;
            }
            writer.write_all(&[0; 2])?;
        }
    }
    Ok(())
}

/// The unit normal; zeros where the triangle has no area.
fn normal([a, b, c]: [[f32; 3]; 3]) -> [f32; 3] {
    let from = |p: [f32; 3]| std::array::from_fn(|i| f64::from(p[i]) - f64::from(a[i]));
    let (u, v): ([f64; 3], [f64; 3]) = (from(b), from(c));
    let normal = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
    let length = normal.iter().map(|x| x * x).sum::<f64>().sqrt();
    if length > 0.0 { normal.map(|x| (x / length) as f32) } else { [0.0; 3] }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::shapes;
    use crate::write::{Layer, Target, to_bytes};

    #[test]
    fn stl_has_the_corners_and_normals_of_each_face() {
        for mesh in [shapes::octahedron(), shapes::torus(5, 4, 2.0, 0.3), shapes::collinear_face()] {
            let bytes = to_bytes(&Model { layers: vec![Layer::from(&mesh)] }, Target::Stl).unwrap();
            let stl = stl_io::read_stl(&mut std::io::Cursor::new(&bytes)).unwrap();
            assert_eq!(stl.faces.len(), mesh.face_count());
            for (face, read) in (0..).zip(&stl.faces) {
                let corners = mesh.corners(crate::mesh::FaceId(face));
                let found = read.vertices.map(|vertex| <[f32; 3]>::from(stl.vertices[vertex]));
                assert_eq!(found, corners);
                let normal = <[f32; 3]>::from(read.normal);
                let length: f32 = normal.iter().map(|x| x * x).sum();
                let flat = crate::geom::predicate::collinear(corners[0], corners[1], corners[2]);
                assert!((length - f32::from(u8::from(!flat))).abs() <= 4.0 * f32::EPSILON);
            }
        }
    }

    #[test]
    fn stl_refuses_what_it_cannot_hold() {
        let sound = Layer::from(&shapes::tetrahedron());
        let lines = Layer { elements: Elements::Lines(vec![[0, 1]]), ..sound.clone() };
        let far = Layer { w: Some(vec![0.0; 4]), ..sound };
        for layer in [lines, far] {
            assert!(to_bytes(&Model { layers: vec![layer] }, Target::Stl).is_err());
        }
    }
}
