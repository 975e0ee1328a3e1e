use umbrage::mesh::Mesh;
use umbrage::testing::shapes;

use super::{error, expect_errors, mesh, scene};

pub(super) const SAMPLE: &[u8] = b"OFF # a square and a triangle
# comment
5 3 7
0 0 0
1 0 0 # x

1 1.5e0 -.25
0 1 0
9 9 9
4 0 1 2 3
3 3 2 0 255 0 0
2 0 1
";

/// A shape in binary: `extras` more numbers a vertex, `colors` a face.
fn big_endian(shape: &Mesh, keyword: &str, extras: usize, colors: usize) -> Vec<u8> {
    let mut bytes = format!("{keyword} BINARY\n").into_bytes();
    let mut put = |number: [u8; 4]| bytes.extend(number);
    let int = |number: usize| (number as i32).to_be_bytes();
    [shape.vertex_count(), shape.face_count(), 0].map(int).into_iter().for_each(&mut put);
    for position in shape.positions() {
        position.iter().for_each(|value| put(value.to_be_bytes()));
        (0..extras).for_each(|_| put([0x7f, 0xc0, 0, 0]));
    }
    for corners in shape.triangles() {
        put(int(3));
        corners.iter().for_each(|&vertex| put(vertex.to_be_bytes()));
        put(int(colors));
        (0..colors).for_each(|_| put([0x3f, 0x80, 0, 0]));
    }
    bytes
}

pub(super) fn binary() -> Vec<u8> {
    big_endian(&shapes::cube(), "OFF", 0, 1)
}

/// A shape as text: what follows the keyword, each position, and each face.
fn text(shape: &Mesh, keyword: &str, counts: &str, extras: &str, color: &str) -> String {
    let mut text = format!("{keyword}{} {}{counts}\n", shape.vertex_count(), shape.face_count());
    for [x, y, z] in shape.positions() {
        text += &format!("{x} {y} {z}{extras}\n");
    }
    for [a, b, c] in shape.triangles() {
        text += &format!("3 {a} {b} {c}{color}\n");
    }
    text
}

fn shapes_here() -> [Mesh; 3] {
    [shapes::cube(), shapes::icosphere(2), shapes::tetrahedron()]
}

fn same(bytes: impl AsRef<[u8]>, shape: &Mesh, notes: &[&str]) {
    let scene = scene(bytes, "a.off");
    assert_eq!(scene.format.map(|format| format.name()), Some("off"));
    assert_eq!(scene.meshes[0].positions(), shape.positions());
    assert_eq!(scene.meshes[0].triangles(), shape.triangles());
    assert_eq!(scene.notes, notes);
}

#[test]
fn off_sample_is_read_whole() {
    let scene = scene(SAMPLE, "a.off");
    let mesh = &scene.meshes[0];
    assert_eq!(mesh.positions(), [[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.5, -0.25], [0.0, 1.0, 0.0], [9.0; 3]]);
    assert_eq!((mesh.face_count(), mesh.triangles()[2]), (3, [3, 2, 0]));
    assert_eq!(scene.notes[0], "1 face of fewer than three corners left out, on line 12");
    assert!(scene.notes.len() == 2 && scene.notes[1].starts_with("1 n-gon cut into"), "{:?}", scene.notes);
}

#[test]
fn off_of_every_keyword_and_layout_is_the_same_mesh() {
    for shape in shapes_here() {
        for (keyword, counts, extras, color) in [
            ("OFF\n", " 0", "", ""),
            ("OFF ", "", "", ""),
            ("OFF # c\n\n# d\n", " # no edges", "  # e", " # f"),
            ("COFF\n", " 0", " 255 0 0 255", " 0.5 0.5 0.5"),
            ("NOFF\n", " 0", " 0 0 nan", " 7"),
            ("CNOFF\n", " 0", " 1 0 0 1 0 0 1", " 255 255 255 0"),
            ("STOFF\n", " 0", " 0.5 0.5", ""),
            ("STCNOFF\n", " 0", " 0.5 0.5 1 1 1 1 0 0 1", " 1 2"),
        ] {
            let file = text(&shape, keyword, counts, extras, color);
            same(&file, &shape, &[]);
            same(file.replace('\n', "\r\n"), &shape, &[]);
            same(file.replace('\n', "\r").replace(' ', "\t "), &shape, &[]);
            // Told by its content.
            assert_eq!(mesh(&file, "a.obj").triangles(), shape.triangles());
        }
    }
}

#[test]
fn off_slips_are_read_with_a_note() {
    for shape in shapes_here() {
        let count = shape.vertex_count();
        same(text(&shape, "", " 0", "", ""), &shape, &["1 keyword `OFF` missing, on line 1"]);
        same(text(&shape, "off\n", "", "", ""), &shape, &[]);
        let glued = format!("1 keyword run together with a count, on line 1 (`OFF{count}`)");
        same(text(&shape, "OFF", " 0", "", ""), &shape, &[&glued]);
        let colors = format!("{count} vertices with more than a position, the first on line 3");
        same(text(&shape, "OFF\n", " 0", " 1 0 0", ""), &shape, &[&colors]);
        let more = text(&shape, "OFF\n", " 0", "", "") + "the end\n";
        let line = 3 + count + shape.face_count();
        same(more, &shape, &[&format!("1 word after the last face ignored, on line {line}")]);
        // A vertex that is no number, of no face.
        let lost = text(&shape, "OFF\n", "", "", "").replacen('\n', " \n-nan(ind) 0 0\n", 2).replacen(
            " \n-nan(ind) 0 0\n",
            "\n",
            1,
        );
        let lost = lost.replacen(&format!("{count} "), &format!("{} ", count + 1), 1);
        let message = error(&lost, "a.off");
        assert!(
            message.starts_with("a.off, line 3 (off): a face has vertex 0, whose coordinate NaN"),
            "{message}"
        );
    }
    let lost = "OFF\n4 1\n1 2 3\n1 0 0\ninf 0 0\n0 1 0\n3 0 1 3\n";
    let scene = scene(lost, "a.off");
    assert_eq!(scene.meshes[0].positions()[2], [1.0, 2.0, 3.0]);
    assert!(scene.notes[0].starts_with("1 vertex of no face without a finite position"), "{:?}", scene.notes);
    assert!(scene.notes[0].ends_with("vertex 2 on line 5"), "{:?}", scene.notes);
}

#[test]
fn off_coordinates_that_moved_are_noted() {
    let text = "OFF\n3 1\n16777217 0 0\n16777220 0 0\n0 1 0\n3 0 1 2\n";
    assert_eq!(scene(text, "a.off").rounding, 1.0);
    assert_eq!(scene(text.replace("777217", "777216"), "a.off").rounding, 0.0);
}

#[test]
fn off_binary_is_the_same_mesh() {
    for shape in shapes_here() {
        for (keyword, extras) in [("OFF", 0), ("COFF", 4), ("NOFF", 3), ("CNOFF", 7), ("STOFF", 2)] {
            for colors in [0, 1, 4] {
                let bytes = big_endian(&shape, keyword, extras, colors);
                same(&bytes, &shape, &[]);
                // Negative test: one bit of the last index.
                let mut damaged = bytes;
                let last = damaged.len() - 4 * (colors + 1) - 1;
                damaged[last] ^= 1;
                assert_ne!(mesh(&damaged, "a.off").triangles(), shape.triangles());
            }
        }
    }
}

#[test]
fn off_text_errors_name_the_line() {
    let text = String::from_utf8(SAMPLE.to_vec()).unwrap();
    let with = |from: &str, to: &str| {
        assert!(text.contains(from), "{from}");
        text.replacen(from, to, 1).into_bytes()
    };
    expect_errors(
        "a.off",
        &[
            (&with("OFF", "OFG"), ", line 1 (off): an OFF file begins with the word `OFF`, not `OFG`"),
            (&with("5 3 7", "5 x"), ", line 3 (off): `x` is not a count of vertices or faces"),
            (&with("5 3 7", "-5 3"), ", line 3 (off): `-5` is not a count of vertices or faces"),
            (
                &with("5 3 7", "5000 3"),
                ", line 3 (off): the header counts 5000 vertices and 3 faces, but only 75 bytes follow it",
            ),
            (&with("1 1.5e0", "1 1,5"), ", line 7 (off): `1,5` is not a number"),
            (&with("1 1.5e0 -.25", "1 1.5e0"), ", line 7 (off): a position needs three numbers"),
            (
                &with("1 1.5e0", "1 1e39"),
                ", line 7 (off): a face has vertex 2, whose coordinate 1e39 is not a finite number of 32 bits",
            ),
            (&with("4 0 1 2 3", "4 0 1 2"), ", line 10 (off): the face counts 4 corners, but its line has 3"),
            (
                &with("4 0 1 2 3", "4 0 1 2 5"),
                ", line 10 (off): a face names vertex 5, but the file has 5 vertices",
            ),
            (
                &with("4 0 1 2 3", "4 0 1 2 -1"),
                ", line 10 (off): a face names vertex -1, but the file has 5 vertices",
            ),
            (&with("4 0 1 2 3", "4 0 1 2 x"), ", line 10 (off): `x` is not the index of a vertex"),
            (&with("4 0 1 2 3", "-4 0 1 2 3"), ", line 10 (off): `-4` is not a count of corners"),
            (&with("2 0 1\n", ""), ", line 11 (off): the file ends before face 2"),
            (b"OFF\n", ", line 1 (off): the file ends before its counts of vertices and faces"),
            (b"OFF\n# 3\n", ", line 2 (off): the file ends before its counts of vertices and faces"),
        ],
    );
    for keyword in ["4OFF", "nOFF", "4nOFF", "C4OFF"] {
        let message = error(with("OFF", keyword), "a.off");
        let wanted = format!(
            "a.off, line 1 (off): the vertices of a file in `{keyword}` are not points of space; \
             export it with three coordinates a vertex"
        );
        assert_eq!(message, wanted);
    }
}

#[test]
fn off_binary_errors_name_the_byte() {
    let sound = big_endian(&shapes::tetrahedron(), "OFF", 0, 0);
    let with = |at: usize, number: i32| {
        let mut bytes = sound.clone();
        bytes[11 + at..][..4].copy_from_slice(&number.to_be_bytes());
        bytes
    };
    let faces = 12 + 4 * 12;
    expect_errors(
        "a.off",
        &[
            (&with(0, -4), ", byte 11 (off): -4 is not a count"),
            (
                &with(0, 999),
                ", byte 11 (off): the header counts 999 vertices and 4 faces, but only 128 bytes follow it",
            ),
            (&with(faces + 4, 4), ", byte 75 (off): a face names vertex 4, but the file has 4 vertices"),
            (&with(faces + 16, -1), ", byte 87 (off): -1 is not a count"),
            (&sound[..sound.len() - 1], ", byte 147 (off): the file ends early"),
        ],
    );
}
