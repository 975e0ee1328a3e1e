//! Slips around plain geometry: read as if they were not there, with a note that names them.

use umbrage::mesh::Mesh;
use umbrage::scene::Scene;
use umbrage::testing::shapes;

use super::{error, parts, scene, stl};

fn shapes_here() -> [Mesh; 3] {
    [shapes::cube(), shapes::icosphere(2), shapes::tetrahedron()]
}

/// Asserts that `bytes` are read as `shape`, or as its soup, with these notes.
#[track_caller]
fn same(bytes: impl AsRef<[u8]>, name: &str, shape: &Mesh, notes: &[&str]) -> Scene {
    let wanted = if name.ends_with("stl") { shapes::soup(shape) } else { shape.clone() };
    let scene = scene(bytes, name);
    assert_eq!(scene.meshes[0].positions(), wanted.positions());
    assert_eq!(scene.meshes[0].triangles(), wanted.triangles());
    assert_eq!(scene.notes, notes);
    scene
}

/// A shape in OBJ: `color` after each position, `more` at the end.
fn obj(shape: &Mesh, color: &str, more: &str) -> String {
    let vertices = shape.positions().iter().map(|[x, y, z]| format!("v {x} {y} {z}{color}\n"));
    let faces = shape.triangles().iter().map(|corners| {
        let [a, b, c] = corners.map(|vertex| vertex + 1);
        format!("f {a} {b} {c}\n")
    });
    vertices.chain(faces).collect::<String>() + more
}

#[test]
fn obj_words_behind_a_position_need_be_no_numbers() {
    for shape in shapes_here() {
        let count = shape.vertex_count();
        for (color, each) in [
            ("", 0),
            (" 1", 0),
            (" 0.5 1e-3 +1", 0),
            (" nan nan nan", 3),
            (" 1 -nan(ind) 1.#IND", 2),
            (" red", 1),
        ] {
            let file = obj(&shape, color, "");
            if each == 0 {
                same(file, "a.obj", &shape, &[]);
                continue;
            }
            let word = color.split(' ').find(|word| {
                word.parse::<f32>().is_ok_and(|value| value.is_nan())
                    || word.parse::<f32>().is_err() && !word.is_empty()
            });
            let note = format!(
                "{} color or weight values ignored for not being a number, the first on line 1 (`{}`)",
                each * count,
                word.unwrap()
            );
            same(file, "a.obj", &shape, &[&note]);
        }
    }
    // Negative test: what is needed.
    let message = error("v 0 0 nan 1 1 1\nf 1 1 1\n", "a.obj");
    assert!(message.contains("line 1 (obj): a face has vertex 1, whose coordinate NaN is not"), "{message}");
    assert!(error("v 0 0 0 v 1 1 1\n", "a.obj").contains("line 1 (obj): `v` follows the position"));
}

#[test]
fn obj_faces_of_fewer_than_three_corners_are_left_out() {
    for shape in shapes_here() {
        let lines = shape.vertex_count() + shape.face_count();
        let note = format!("3 faces of fewer than three corners left out, the first on line {}", lines + 1);
        let scene = same(obj(&shape, "", "f 1 2\nf 3/1\nf\n"), "a.obj", &shape, &[&note]);
        assert_eq!(scene.meshes[0].parts(), []);
        // They begin no part.
        let named = obj(&shape, "", "g more\nf 1 2\ng last\nf 1 2 3\n");
        let count = shape.face_count() as u32;
        assert_eq!(parts(&super::mesh(named, "a.obj")), [("", 0..count), ("last", count..count + 1)]);
    }
    let alone = scene("v 0 0 0\nv 1 0 0\nf 1 2\n", "a.obj");
    assert_eq!((alone.meshes[0].face_count(), alone.notes.len()), (0, 1));
    // Negative test: what is named must still be there.
    assert!(error("v 0 0 0\nf 1 2\n", "a.obj").contains("line 2 (obj): a face names vertex 2"));
}

/// A shape in text PLY: the columns after the coordinates, and what each line of vertices and of faces ends in.
fn ply(shape: &Mesh, columns: &str, vertex: &str, face: &str) -> String {
    let mut text = format!(
        "ply\nformat ascii 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\n{columns}\
         element face {}\nproperty list uchar int vertex_indices\nend_header\n",
        shape.vertex_count(),
        shape.face_count()
    );
    shape.positions().iter().for_each(|[x, y, z]| text += &format!("{x} {y} {z}{vertex}\n"));
    shape.triangles().iter().for_each(|[a, b, c]| text += &format!("3 {a} {b} {c}{face}\n"));
    text
}

#[test]
fn ply_columns_that_are_not_read_may_hold_anything() {
    let columns = "property float nx\nproperty uchar red\nproperty list uchar float more\n";
    for shape in shapes_here() {
        let count = shape.vertex_count();
        for (words, each, first) in [
            (" nan 255 1 0.5", 0, ""),
            (" -nan(ind) 255 0", 1, "-nan(ind)"),
            (" nan(0x7f) 0.5 2 1.#IND x", 4, "nan(0x7f)"),
            (" 0 1.#INF 1 -inf", 1, "1.#INF"),
        ] {
            let note = format!("{} unread values of another type", each * count);
            let note = format!("{note} than declared, the first on line 13 (`{first}`)");
            let notes = if each > 0 { vec![note.as_str()] } else { vec![] };
            same(ply(&shape, columns, words, ""), "a.ply", &shape, &notes);
        }
        // Negative test: the length of a list is needed.
        let message = error(ply(&shape, columns, " 0 0 x 1", ""), "a.ply");
        assert!(message.contains("line 13 (ply): `x` is not an integer"), "{message}");
    }
}

#[test]
fn ply_lines_may_hold_more_than_the_header_declares() {
    for shape in shapes_here() {
        let note = format!(
            "{} lines with more than the header declares, the first on line 10 (`7`)",
            shape.vertex_count()
        );
        same(ply(&shape, "", " 7 8", ""), "a.ply", &shape, &[&note]);
        let line = 10 + shape.vertex_count();
        let note = format!(
            "{} lines with more than the header declares, the first on line {line} (`#`)",
            shape.face_count()
        );
        same(ply(&shape, "", "", " # a face"), "a.ply", &shape, &[&note]);
    }
}

#[test]
fn ply_header_lines_of_no_meaning_are_noted() {
    for shape in shapes_here() {
        let sound = ply(&shape, "", "", "");
        for (junk, first) in [
            ("made in 2024\n", "made"),
            ("TextureFile a.png\n", "TextureFile"),
            ("ref\u{e9}rence\n", "ref\u{e9}rence"),
        ] {
            let text = sound.replacen("element vertex", &format!("{junk}element vertex"), 1);
            same(text, "a.ply", &shape, &[&format!("1 line of the header ignored, on line 3 (`{first}`)")]);
        }
        let text = sound.replacen("property float y", "some words\nproperty float y\nand more", 1);
        same(text, "a.ply", &shape, &["2 lines of the header ignored, the first on line 5 (`some`)"]);
        // Negative test: what may be a misspelt declaration, or data.
        for (from, to) in
            [("element face", "elemnt face"), ("property float z", "propety float z"), ("end_header\n", "")]
        {
            assert!(error(sound.replacen(from, to, 1), "a.ply").contains(" (ply): `"));
        }
    }
}

#[test]
fn ply_vertices_of_no_face_need_no_position() {
    for shape in shapes_here() {
        let (count, first) = (shape.vertex_count(), shape.positions()[0]);
        for word in ["nan", "-inf", "1e39", "-nan(ind)", "1.#QNAN"] {
            let text = ply(&shape, "", "", "").replacen(
                &format!("vertex {count}"),
                &format!("vertex {}", count + 2),
                1,
            );
            let [a, b, c] = shape.triangles()[0];
            let face = format!("3 {a} {b} {c}\n");
            let with = text.replacen(&face, &format!("0 {word} 0\n{word} 1 1\n{face}"), 1);
            let scene = scene(&with, "a.ply");
            assert_eq!(scene.meshes[0].positions()[count..], [first; 2]);
            assert_eq!(scene.meshes[0].bounds(), shape.bounds());
            assert_eq!(scene.meshes[0].triangles(), shape.triangles());
            let line = 10 + count;
            let note = format!(
                "2 vertices of no face without a finite position put where another one lies, the first is vertex {count} on line {line}"
            );
            assert_eq!(scene.notes, [note]);
            // Negative test: a face has it.
            let used = with.replacen(&face, &format!("3 {a} {b} {}\n", count + 1), 1);
            let message = error(used, "a.ply");
            let line = line + 1;
            assert!(
                message.contains(&format!(", line {line} (ply): a face has vertex {}, whose", count + 1)),
                "{message}"
            );
        }
    }
}

#[test]
fn ply_faces_of_fewer_than_three_corners_are_left_out() {
    for shape in shapes_here() {
        let (count, vertices) = (shape.face_count(), shape.vertex_count());
        let text =
            ply(&shape, "", "", "").replacen(&format!("face {count}"), &format!("face {}", count + 3), 1);
        let note = format!(
            "3 faces of fewer than three corners left out, the first on line {}",
            10 + vertices + count
        );
        same(text + "2 0 1\n0\n1 2\n", "a.ply", &shape, &[&note]);
        for big in [false, true] {
            same(
                binary_ply(&shape, big, &[7]),
                "a.ply",
                &shape,
                &["1 face of fewer than three corners left out, at element face, item 0"],
            );
            same(binary_ply(&shape, big, &[]), "a.ply", &shape, &[]);
        }
    }
    let none = "ply\nformat ascii 1.0\nelement vertex 1\nproperty int x\nproperty int y\nproperty int z\n\
                element face 1\nproperty list int int vertex_index\nend_header\n0 0 0\n1 0\n";
    assert_eq!(scene(none, "a.ply").meshes[0].face_count(), 0);
}

/// A shape in binary PLY, coordinates and indices of 64 bits; before the faces of the shape a face of the
/// corners `first`, if there are any.
fn binary_ply(shape: &Mesh, big: bool, first: &[u64]) -> Vec<u8> {
    let order = if big { "big" } else { "little" };
    let faces = shape.face_count() + usize::from(!first.is_empty());
    let mut bytes = format!(
        "ply\nformat binary_{order}_endian 1.0\nelement vertex {}\nproperty ulong id\nproperty double x\n\
         property double y\nproperty double z\nproperty int64 more\nelement face {faces}\n\
         property list long uint64 vertex_indices\nend_header\n",
        shape.vertex_count()
    )
    .into_bytes();
    let mut put = |number: [u8; 8]| {
        bytes.extend(if big { number.into_iter().rev().collect::<Vec<_>>() } else { number.to_vec() });
    };
    for position in shape.positions() {
        put(u64::MAX.to_le_bytes());
        position.iter().for_each(|&value| put(f64::from(value).to_le_bytes()));
        put(i64::MIN.to_le_bytes());
    }
    let mut face = |corners: &[u64]| {
        put((corners.len() as u64).to_le_bytes());
        corners.iter().for_each(|vertex| put(vertex.to_le_bytes()));
    };
    if !first.is_empty() {
        face(&first.iter().map(|vertex| vertex % shape.vertex_count() as u64).collect::<Vec<_>>());
    }
    shape.triangles().iter().for_each(|corners| face(&corners.map(u64::from)));
    bytes
}

#[test]
fn ply_integers_of_64_bits_are_read() {
    for shape in shapes_here() {
        for big in [false, true] {
            let mut bytes = binary_ply(&shape, big, &[]);
            same(&bytes, "a.ply", &shape, &[]);
            // Negative test: an index beyond 32 bits.
            let last = bytes.len() - if big { 5 } else { 4 };
            bytes[last] = 1;
            assert!(error(&bytes, "a.ply").contains("a face names vertex 4294967"));
        }
    }
    let text = "ply\nformat ascii 1.0\nelement vertex 1\nproperty int64 x\nproperty uint64 y\nproperty long z\nend_header\n\
                -9223372036854775808 18446744073709551615 16777217\n";
    let wanted = [-9_223_372_036_854_775_808.0, 18_446_744_073_709_551_616.0, 16_777_216.0];
    assert_eq!(super::mesh(text, "a.ply").positions(), [wanted]);
}

#[test]
fn ply_faces_may_have_another_name() {
    for shape in shapes_here() {
        let (sound, count) = (ply(&shape, "", "", ""), shape.face_count());
        for name in ["polygon", "Triangle", "faces"] {
            let note = format!("{count} {name} elements read as faces, since there is no element face");
            same(sound.replacen("element face", &format!("element {name}"), 1), "a.ply", &shape, &[&note]);
        }
        // Negative test: lines; and what is beside faces.
        for name in ["edge", "polyline", "tetrahedron"] {
            let scene = scene(sound.replacen("element face", &format!("element {name}"), 1), "a.ply");
            assert_eq!(
                (scene.meshes[0].face_count(), scene.notes),
                (0, vec![format!("{count} {name} elements ignored")])
            );
        }
        let both = sound.replacen(
            "end_header\n",
            "element polygon 1\nproperty list int int vertex_index\nend_header\n",
            1,
        );
        same(both + "3 0 1 2\n", "a.ply", &shape, &["1 polygon element ignored"]);
    }
}

/// A shape in text STL, each word of a line behind `blank`, each line behind `end`.
fn stl_text(shape: &Mesh, [solid, endsolid]: [&str; 2], blank: &str, end: &str) -> String {
    let mut text = format!("{solid}{end}");
    for corners in shape.triangles() {
        text += &format!("facet normal 0 -0 1{end} outer loop{end}");
        for vertex in corners {
            let [x, y, z] = shape.positions()[*vertex as usize];
            text += &format!("  vertex {x} {y} {z}{end}");
        }
        text += &format!(" endloop{end}endfacet{end}");
    }
    text += &format!("{endsolid}{end}");
    text.replace(' ', blank)
}

#[test]
fn stl_text_may_lie_on_any_lines() {
    for shape in shapes_here() {
        let soup = shapes::soup(&shape);
        for (blank, end) in [(" ", "\n"), ("\t", "\r\n"), (" \x0b\x0c", "\r"), ("   ", "\n\n \n")] {
            let text = stl_text(&shape, ["solid a b", "endsolid a b"], blank, end);
            let scene = same(&text, "a.stl", &shape, &[]);
            assert_eq!(scene.meshes[0].name, "a b");
            same(text.to_uppercase(), "a.stl", &shape, &[]);
            same(text.to_uppercase().replace("FACET", "Facet"), "b.stl", &shape, &[]);
        }
        let faces = soup.face_count();
        let note = format!("{faces} facets not at the beginning of a line, the first on line 1");
        let one_line = stl_text(&shape, ["solid a b", "endsolid a b"], " ", " ");
        let scene = same(&one_line, "a.stl", &shape, &[&note]);
        assert_eq!(scene.meshes[0].name, "a b");
        let twice = super::mesh(one_line.repeat(2), "a.stl");
        let count = faces as u32;
        assert_eq!(parts(&twice), [("a b", 0..count), ("a b", count..2 * count)]);
        // A word a line, which also parts `solid` from its name.
        let scattered = one_line.replacen(" a b", "", 1).replace(" a b", "").replace(' ', "\n");
        same(&scattered, "a.stl", &shape, &[]);
        // Negative test: the line of an error, and a number lost or too many.
        let line = scattered.lines().position(|line| line == "vertex").unwrap() + 1;
        let lost = scattered.replacen("vertex\n", "vertex\nx", 1);
        assert!(error(lost, "a.stl").starts_with(&format!("a.stl, line {} (stl): `x", line + 1)));
        let lost = scattered.replacen("endloop\n", "7\nendloop\n", 1);
        assert!(error(lost, "a.stl").contains("`endloop` is wanted, not `7`"));
    }
}

#[test]
fn stl_keywords_may_be_misspelt_doubled_or_missing() {
    for shape in shapes_here() {
        let faces = shape.face_count();
        let lines = 2 + 7 * faces;
        let last = |what: &str| format!("{what}, on line {lines}");
        for (solid, endsolid, notes) in [
            ("solid", "endsolid", vec![]),
            ("solid", "endsolidabc", vec![last("1 keyword run together with a name") + " (`endsolidabc`)"]),
            (
                "solidabc",
                "endsolid",
                vec!["1 keyword run together with a name, on line 1 (`solidabc`)".into()],
            ),
            ("solid a", "end solid a", vec![last("1 keyword read in two words")]),
            ("solid a", "", vec![format!("1 solid without its end, on line {}", lines - 1)]),
            ("solid a", "endsolid a\nendsolid", vec![format!("1 solid ended twice, on line {}", lines + 1)]),
            ("solid a\nsolid a", "endsolid a", vec!["1 solid begun twice, on line 2".into()]),
            ("", "endsolid", vec!["1 solid without its beginning, on line 2".into()]),
            (
                "solid a",
                "endsolid a\0\0\x1a",
                vec![format!("3 control bytes taken as blank, from line {lines} on")],
            ),
            ("solid my solid part", "endsolid my solid part", vec![]),
            ("solid the facet", "endsolid the facet", vec![]),
        ] {
            let text = stl_text(&shape, [solid, endsolid], " ", "\n");
            let notes: Vec<&str> = notes.iter().map(String::as_str).collect();
            let scene = same(&text, "a.stl", &shape, &notes);
            assert_eq!(scene.meshes[0].parts(), []);
        }
        let text = stl_text(&shape, ["solid", "end solid"], " ", "\n")
            .replace("endfacet", "end facet")
            .replace("endloop", "end loop");
        same(
            text,
            "a.stl",
            &shape,
            &[&format!("{} keywords read in two words, the first on line 7", 2 * faces + 1)],
        );
        // Two solids, the first without its end: both stay.
        let open = stl_text(&shape, ["solid a", ""], " ", "\n")
            + &stl_text(&shape, ["solid b", "endsolid"], " ", "\n");
        let count = faces as u32;
        assert_eq!(parts(&super::mesh(open, "a.stl")), [("a", 0..count), ("b", count..2 * count)]);
        // Negative test: a facet that is not whole.
        for lost in ["endfacet", "endloop", "outer loop"] {
            let text = stl_text(&shape, ["solid a", "endsolid a"], " ", "\n").replacen(lost, "", 1);
            assert!(error(text, "a.stl").contains("` is wanted, not `"), "{lost}");
        }
    }
}

#[test]
fn stl_text_that_is_short_may_be_padded_with_zeros() {
    let text = "solid\nendsolid\n".to_owned() + &"\0".repeat(500);
    assert_eq!(scene(&text, "a.stl").notes, ["500 control bytes taken as blank, from line 3 on"]);
    // Negative test: a binary file that begins with the word.
    assert!(
        error("solid\n".to_owned() + &"\0".repeat(478), "a.stl").contains("the header counts 0 triangles")
    );
}

/// Binary STL with attributes behind each triangle: of `length(i)` bytes behind triangle i.
fn payload(shape: &Mesh, length: impl Fn(usize) -> u16) -> Vec<u8> {
    let soup = shapes::soup(shape);
    let mut bytes = stl::binary(soup.positions().as_chunks().0);
    let triangles = bytes.split_off(84);
    for (i, record) in triangles.chunks(50).enumerate() {
        bytes.extend(&record[..48]);
        bytes.extend(length(i).to_le_bytes());
        bytes.extend((0..length(i)).map(|at| at as u8 ^ 0x7f));
    }
    bytes
}

#[test]
fn stl_attributes_behind_triangles_are_skipped() {
    for shape in shapes_here() {
        let faces = shape.face_count();
        for length in
            [(|_| 6) as fn(usize) -> u16, |i| (i % 3) as u16, |_| 50, |i| if i == 1 { 1000 } else { 0 }]
        {
            let bytes = payload(&shape, length);
            let sum: usize = (0..faces).map(|i| usize::from(length(i))).sum();
            let note = format!("{sum} bytes of attributes behind triangles skipped");
            same(&bytes, "a.stl", &shape, &[&note]);
            same([&b"solid"[..], &bytes[5..]].concat(), "a.stl", &shape, &[&note]);
            // Negative test: a byte too few, or too many: never read as coordinates.
            let longer = [&bytes[..], &[0]].concat();
            for damaged in [&bytes[..bytes.len() - 1], &longer] {
                let message = error(damaged, "a.stl");
                assert!(
                    message.contains("do not add up") || message.contains("the header counts"),
                    "{message}"
                );
            }
        }
        // Colors in the two bytes themselves are no counts, whether or not a byte follows the triangles.
        let mut bytes = stl::binary(shapes::soup(&shape).positions().as_chunks().0);
        (0..faces).for_each(|i| bytes[84 + 50 * i + 48..][..2].copy_from_slice(&0x7c1f_u16.to_le_bytes()));
        same(&bytes, "a.stl", &shape, &[]);
        same([&bytes[..], b"\n"].concat(), "a.stl", &shape, &["1 byte after the last triangle ignored"]);
    }
}

#[test]
fn obj_vertices_of_no_face_need_no_position() {
    for shape in shapes_here() {
        let (count, first) = (shape.vertex_count(), shape.positions()[0]);
        for word in ["nan", "-inf", "1e39", "-nan(ind)", "1.#QNAN"] {
            let vertex = |[x, y, z]: &[f32; 3]| format!("v {x} {y} {z}\n");
            let face = |[a, b, c]: &[u32; 3]| format!("f {} {} {}\n", a + 1, b + 1, c + 1);
            let vertices: String = shape.positions().iter().map(vertex).collect();
            let faces: String = shape.triangles().iter().map(face).collect();
            let with = format!("{vertices}v 0 {word} 0\nv {word} 1 1\n{faces}");
            let scene = scene(&with, "a.obj");
            assert_eq!(scene.meshes[0].positions()[count..], [first; 2]);
            assert_eq!(scene.meshes[0].bounds(), shape.bounds());
            assert_eq!(scene.meshes[0].triangles(), shape.triangles());
            let line = count + 1;
            let note = format!(
                "2 vertices of no face without a finite position put where another one lies, the first is vertex {line} on line {line}"
            );
            assert_eq!(scene.notes, [note]);
            // Negative test: a face has it.
            let message = error(format!("{with}f 1 2 -1\n"), "a.obj");
            let line = line + 1;
            assert!(
                message.contains(&format!(", line {line} (obj): a face has vertex {line}, whose")),
                "{message}"
            );
        }
    }
}
