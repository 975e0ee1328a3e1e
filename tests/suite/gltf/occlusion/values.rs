//! The values that were written are those that were asked for, corner by corner.

use super::*;

/// The openness that each corner of a primitive shows.
fn shown(back: &Back, mesh: usize, primitive: usize, form: Form) -> Vec<[f64; 3]> {
    let first = |name: &str| {
        let corners = back.corners(mesh, primitive, &format!("attributes/{name}"));
        corners.into_iter().map(|face| face.map(|corner| corner[0])).collect::<Vec<_>>()
    };
    match form {
        Form::Attribute => first("_OCCLUSION"),
        Form::Color => first("COLOR_0"),
        Form::Texture => {
            let material = back.primitive(mesh, primitive)["material"].as_u64().unwrap() as usize;
            let texture = &back.doc["materials"][material]["occlusionTexture"];
            let set = texture["texCoord"].as_u64().unwrap_or(0);
            let sample = |u: f64| back.sample(texture["index"].as_u64().unwrap() as usize, u);
            first(&format!("TEXCOORD_{set}")).into_iter().map(|face| face.map(sample)).collect()
        }
    }
}

/// The same for all primitives that the scene shows, in the order of its faces; `plain` are those without
/// colors of their own.
fn all(back: &Back, form: Form, mirrored: &[usize]) -> Vec<[f64; 3]> {
    let mut values = Vec::new();
    for (node, mesh) in back.shown().into_iter().enumerate() {
        for primitive in 0..back.doc["meshes"][mesh]["primitives"].as_array().unwrap().len() {
            if back.primitive(mesh, primitive)["mode"] == 0 {
                continue;
            }
            // A mirrored node has its faces turned by the reader: corners 0, 2, 1.
            let turn = |[a, b, c]: [f64; 3]| if mirrored.contains(&node) { [a, c, b] } else { [a, b, c] };
            values.extend(shown(back, mesh, primitive, form).into_iter().map(turn));
        }
    }
    values
}

/// The largest error of what is shown.
fn error(values: &[[f64; 3]], corners: &[[u32; 3]], openness: &[f32]) -> f64 {
    assert_eq!(values.len(), corners.len());
    let pairs = values.as_flattened().iter().zip(corners.as_flattened());
    pairs.map(|(value, &corner)| (value - f64::from(openness[corner as usize])).abs()).fold(0.0, f64::max)
}

fn without_colors() -> Builder {
    let mut builder = rich();
    builder.doc["meshes"][0]["primitives"][4]["attributes"].as_object_mut().unwrap().remove("COLOR_0");
    builder
}

#[test]
fn occlusion_values_are_those_asked_for_in_every_form() {
    let before = without_colors().glb();
    let (corners, openness) = different(faces_of(&before));
    for (form, most) in
        [(Form::Attribute, 0.0), (Form::Texture, 1.0 / 512.0 / 8.0), (Form::Color, HALF_STEP + 1e-9)]
    {
        let written = add(&before, &corners, &openness, &OcclusionOptions::new(form));
        let back = Back::of(&written.bytes);
        let found = error(&all(&back, form, &[1]), &corners, &openness);
        assert!(found <= most, "{form:?}: {found}");
        // Two corners swapped are seen, and so is a mirrored node taken for a plain one.
        let mut swapped = corners.clone();
        swapped[5].swap(0, 2);
        assert!(error(&all(&back, form, &[1]), &swapped, &openness) > 0.01, "{form:?}");
        assert!(error(&all(&back, form, &[]), &corners, &openness) > 0.01, "{form:?}");
    }
}

#[test]
fn occlusion_texture_without_the_half_texel_would_be_seen() {
    let before = without_colors().glb();
    let (corners, openness) = different(faces_of(&before));
    let written = add(&before, &corners, &openness, &OcclusionOptions::new(Form::Texture));
    let back = Back::of(&written.bytes);
    let plain = openness.iter().map(|&x| (f64::from(x) - back.sample(1, f64::from(x))).abs());
    // Half a texel at both ends, where there is another one beside it; a bound above has an eighth of that.
    assert!(plain.fold(0.0, f64::max) > 0.9 / 512.0);
}

#[test]
fn occlusion_that_is_equal_at_a_vertex_splits_nothing() {
    let before = without_colors().glb();
    let faces = faces_of(&before);
    for form in FORMS {
        let written = add(&before, &vec![[0, 1, 1]; faces], &[0.25, 0.25], &OcclusionOptions::new(form));
        let (old, new) = (Back::of(&before), Back::of(&written.bytes));
        for (mesh, was) in new.shown().into_iter().zip(old.shown()) {
            for primitive in [0, 1, 2, 4].into_iter().take(if was == 0 { 4 } else { 1 }) {
                let [new, old] = [new.primitive(mesh, primitive), old.primitive(was, primitive)];
                assert_eq!([&new["indices"], &new["mode"]], [&old["indices"], &old["mode"]]);
                assert_eq!(new["attributes"]["POSITION"], old["attributes"]["POSITION"]);
            }
        }
        assert!(error(&all(&new, form, &[1]), &vec![[0; 3]; faces], &[0.25]) <= HALF_STEP);
    }
}

#[test]
fn occlusion_multiplies_colors_in_their_own_precision_and_keeps_alpha() {
    let colors: [[f32; 4]; 4] =
        [[1.0, 0.5, 0.25, 0.75], [0.0, 1.0, 0.125, 1.0], [0.5; 4], [1.0, 1.0, 1.0, 0.0]];
    let bytes = |scale: f32| colors.as_flattened().iter().map(move |x| (x * scale).round());
    let u8s: Vec<u8> = bytes(255.0).map(|x| x as u8).collect();
    let shorts: Vec<u16> = bytes(65535.0).map(|x| x as u16).collect();
    for (component, data, most) in [
        (5121, u8s, 1.01 / 255.0),
        (5123, u16s(&shorts), 1.01 / 65535.0),
        (5126, f32s(colors.as_flattened()), 1e-7),
    ] {
        let mut builder = Builder::square();
        let color = builder.accessor(component, "VEC4", 4, &data);
        builder.doc["accessors"][color]["normalized"] = (component != 5126).into();
        builder.doc["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = color.into();
        let openness = [0.75, 0.5, 1.0, 0.25];
        let corners = [[0, 1, 2], [2, 3, 0]]; // the vertices 0, 1, 2 and 2, 1, 3
        let written = add(&builder.glb(), &corners, &openness, &OcclusionOptions::new(Form::Color));
        let back = Back::of(&written.bytes);
        let faces = back.corners(0, 0, "attributes/COLOR_0");
        for (face, vertices) in [[0, 1, 2], [2, 1, 3]].into_iter().enumerate() {
            for (corner, vertex) in vertices.into_iter().enumerate() {
                let open = f64::from(openness[corners[face][corner] as usize]);
                for channel in 0..4 {
                    let factor = if channel < 3 { open } else { 1.0 };
                    let wanted = f64::from(colors[vertex][channel]) * factor;
                    let found = faces[face][corner][channel];
                    assert!((found - wanted).abs() <= most, "{component}: {found} {wanted}");
                }
            }
        }
    }
}

#[test]
fn occlusion_bent_directions_turn_with_their_node_as_normals_do() {
    let mut builder = Builder::square();
    builder.doc["nodes"] = json!([{"mesh": 0, "scale": [1, 2, 4], "rotation": [0, 0, 0.6, 0.8]}]);
    let bent = [[0.0, 0.6, 0.8], [0.0; 3], [0.36, 0.48, 0.8], [-1.0, 0.0, 0.0]];
    let occlusion = Occlusion { corners: &[[0, 1, 2], [2, 1, 3]], openness: &[0.5; 4], bent: Some(&bent) };
    let file = GltfFile::from_bytes(builder.glb()).unwrap();
    let written = file.with_occlusion(None, &occlusion, &OcclusionOptions::new(Form::Attribute)).unwrap();
    let back = Back::of(&written.bytes);
    let node = glam::DMat4::from_scale_rotation_translation(
        glam::DVec3::new(1.0, 2.0, 4.0),
        glam::DQuat::from_array([0.0, 0.0, 0.6, 0.8]),
        glam::DVec3::ZERO,
    );
    let normals = node.inverse().transpose();
    for (face, corners) in back.corners(0, 0, "attributes/_BENT").into_iter().zip(occlusion.corners) {
        for (found, &corner) in face.iter().zip(corners) {
            let world = normals.transform_vector3(glam::DVec3::from_slice(found)).normalize_or_zero();
            let wanted = glam::DVec3::from(bent[corner as usize].map(f64::from));
            assert!((world - wanted).length() < 1e-6, "{world} {wanted}");
        }
    }
    // Directions of travel would not do.
    let face = &back.corners(0, 0, "attributes/_BENT")[0][0];
    let travel = node.transform_vector3(glam::DVec3::from_slice(face)).normalize();
    assert!((travel - glam::DVec3::from(bent[0].map(f64::from))).length() > 0.1);
}

#[test]
fn occlusion_normals_are_those_of_the_file_in_the_world() {
    let mut builder = Builder::square();
    let normals = builder.positions(&[[0.0, 0.0, 1.0], [f32::NAN, 0.0, 0.0], [0.0; 3], [0.6, 0.0, 0.8]]);
    builder.doc["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] = normals.into();
    builder.doc["nodes"] = json!([{"mesh": 0, "scale": [2, 1, -1]}, {"mesh": 0, "scale": [0, 1, 1]}]);
    builder.doc["scenes"] = json!([{"nodes": [0, 1]}]);
    let file = GltfFile::from_bytes(builder.glb()).unwrap();
    let found = file.normals(None, &OcclusionOptions::new(Form::Color)).unwrap();
    let tilted = glam::Vec3::new(0.3, 0.0, -0.8).normalize();
    // Mirrored: the corners of the faces are 0, 2, 1 and 2, 3, 1.
    let [down, none] = [[0.0, 0.0, -1.0], [0.0; 3]];
    assert_eq!(found[0], Some([down, none, none]));
    let second = found[1].unwrap();
    assert_eq!([second[0], second[2]], [none; 2]);
    assert!((glam::Vec3::from(second[1]) - tilted).length() < 1e-6);
    assert_eq!(found[2..], [None, None]);
}

#[test]
fn occlusion_of_some_parts_leaves_the_others_as_they_are() {
    let before = without_colors().glb();
    // left: strip, fan, none, list; right: the same; single.
    let kept = [false, true, false, true, true, false, false, false, false];
    let faces = 6 + 3 + 6;
    let (corners, openness) = different(faces);
    for form in FORMS {
        let file = GltfFile::from_bytes(before.clone()).unwrap();
        let occlusion = Occlusion { corners: &corners, openness: &openness, bent: None };
        let written = file.with_occlusion(Some(&kept), &occlusion, &OcclusionOptions::new(form)).unwrap();
        assert_eq!(world(&written.bytes), world(&before));
        let (old, new) = (Back::of(&before), Back::of(&written.bytes));
        let [left, right, single] = new.shown()[..] else { panic!() };
        for (mesh, was, primitive) in
            [(left, 0, 0), (left, 0, 2), (right, 0, 1), (right, 0, 4), (single, 1, 0)]
        {
            assert_eq!(new.primitive(mesh, primitive), old.primitive(was, primitive), "{form:?}");
        }
        assert_eq!(
            new.doc["materials"].as_array().unwrap()[..2],
            old.doc["materials"].as_array().unwrap()[..]
        );
        let mut values = shown(&new, left, 1, form);
        values.extend(shown(&new, left, 4, form));
        values.extend(shown(&new, right, 0, form).into_iter().map(|[a, b, c]| [a, c, b]));
        assert!(error(&values, &corners, &openness) <= HALF_STEP + 1e-9, "{form:?}");
        // A flag more or less, or other faces, are refused.
        let bad = file.with_occlusion(Some(&kept[1..]), &occlusion, &OcclusionOptions::new(form));
        assert!(bad.unwrap_err().to_string().contains("other faces"));
        assert!(file.with_occlusion(None, &occlusion, &OcclusionOptions::new(form)).is_err());
    }
}
