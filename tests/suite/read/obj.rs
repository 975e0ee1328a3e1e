use super::{error, expect_errors, mesh, parts, scene};

pub(super) const SAMPLE: &[u8] = b"# a square and a triangle
o thing
v 0 0 0
v 1 0 0 1.0
v 1.5e0 1 -.25 0.5 0.5 0.5
v 0 1 0
vt 0 0
vn 0 0 1
g front
usemtl red
f 1/1/1 2/1/1 3//1 \\
  4
g back
f -1 -2 -4
l 1 2
";

const TRIANGLE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";

fn faces(text: &str) -> Vec<[u32; 3]> {
    mesh(text, "a.obj").triangles().to_vec()
}

#[test]
fn obj_sample_is_read_whole() {
    let scene = scene(SAMPLE, "a.obj");
    let mesh = &scene.meshes[0];
    assert_eq!(mesh.positions(), [[0.0; 3], [1.0, 0.0, 0.0], [1.5, 1.0, -0.25], [0.0, 1.0, 0.0]]);
    assert_eq!(mesh.triangles(), [[1, 2, 3], [1, 3, 0], [3, 2, 0]]);
    assert_eq!(parts(mesh), [("thing / front / red", 0..2), ("thing / back / red", 2..3)]);
    assert_eq!(
        scene.notes,
        ["1 n-gon cut into triangles", "1 statement ignored, the first on line 15 (`l`)"]
    );
}

#[test]
fn obj_corners_take_all_four_forms() {
    for corners in
        ["1 2 3", "1/7 2/8 3/9", "1//7 2//8 3//9", "1/4/7 2/5/8 3/6/9", "1/-1/-1 2/-1/-2 3/-2", "1/ 2/ 3/"]
    {
        assert_eq!(faces(&format!("{TRIANGLE}f {corners}\n")), [[0, 1, 2]], "{corners}");
    }
}

#[test]
fn obj_negative_indices_count_from_the_end() {
    let text = format!("{TRIANGLE}f -3 -2 -1\nv 5 5 5\nf -1 -4/-1/-1 2\n");
    assert_eq!(faces(&text), [[0, 1, 2], [3, 0, 1]]);
}

#[test]
fn obj_an_index_may_name_a_vertex_further_down() {
    assert_eq!(faces(&format!("f 3 2 1\n{TRIANGLE}")), [[2, 1, 0]]);
}

#[test]
fn obj_n_gons_become_triangles_in_their_sequence() {
    // A flat house and a quad beside it, whose second diagonal is the shorter one.
    let house = "v 0 0 0\nv 4 0 0\nv 4 4 0\nv 2 6 0\nv 0 4 0\nv 4 9 0\n";
    let text = format!("{house}f 1 2 3 4 5\nf 3 6 4 5\nf 1 2 3\n");
    let mesh = mesh(&text, "a.obj");
    let area = |faces: &[[u32; 3]]| -> f32 {
        let corner = |vertex: u32| mesh.positions()[vertex as usize];
        let half =
            |[a, b, c]: [[f32; 3]; 3]| 0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]));
        faces.iter().map(|face| half(face.map(corner))).sum()
    };
    assert_eq!((mesh.face_count(), area(&mesh.triangles()[..3])), (6, 20.0));
    assert_eq!(mesh.triangles()[3..], [[2, 5, 3], [2, 3, 4], [0, 1, 2]]);
    assert_eq!(scene(&text, "a.obj").notes, ["2 n-gons cut into triangles"]);
}

#[test]
fn obj_line_ends_blanks_comments_and_marks_do_not_matter() {
    let plain = format!("# c\n{TRIANGLE}f 1 2 3\n");
    let wanted = mesh(&plain, "a.obj");
    for other in [
        plain.replace('\n', "\r\n"),
        plain.replace('\n', "\r"),
        plain.replace('\n', " \t\n\n  \t"),
        plain.replace(' ', " \\\n "),
        plain.replace("# c\n", "# C:\\folder\\\n"),
        plain.replace('\n', " # more\n"),
        format!("\u{feff}{}", plain.trim_end()),
    ] {
        assert_eq!(mesh(&other, "a.obj"), wanted, "{other:?}");
    }
}

#[test]
fn obj_keeps_unreferenced_and_repeated_vertices_in_order() {
    let mesh = mesh("v 9 9 9\nv 0 0 0\nv 0 0 0\nv 1 0 0\nv 7 7 7\nf 2 3 4\n", "a.obj");
    assert_eq!(mesh.positions().iter().map(|p| p[0]).collect::<Vec<_>>(), [9.0, 0.0, 0.0, 1.0, 7.0]);
    assert_eq!(mesh.triangles(), [[1, 2, 3]]);
}

#[test]
fn obj_names_make_parts_that_cover_all_faces() {
    let face = "f 1 2 3\n";
    // Names without faces leave no part, and the same name twice in a row is one part.
    let text = format!(
        "{TRIANGLE}{face}g empty\ng a b\n{face}usemtl m\nusemtl\n{face}g a b\n{face}o last one \n{face}usemtl #1\n{face}"
    );
    let mesh = mesh(text, "a.obj");
    let wanted = [("", 0..1), ("a b", 1..4), ("last one / a b", 4..5), ("last one / a b / #1", 5..6)];
    assert_eq!(parts(&mesh), wanted);
    assert_eq!(self::mesh(format!("{TRIANGLE}g\n{face}g\n{face}"), "a.obj").parts(), []);
}

#[test]
fn obj_long_names_are_cut() {
    let mesh = mesh(format!("{TRIANGLE}g {}\nf 1 2 3\n", "é".repeat(5000)), "a.obj");
    assert_eq!(mesh.parts()[0].name, "é".repeat(50));
}

#[test]
fn obj_numbers_are_correctly_rounded() {
    // Halfway between two floats and just beside the middle, the smallest floats, the largest one, and a
    // minus zero.
    let text =
        "v 16777217 16777217.0000001 16777219\nv 1e-45 0.7e-45 1.17549435e-38\nv 3.4028235e38 -0 +.5\n";
    let largest = [f32::MAX, 0.0, 0.5];
    let wanted = [[16_777_216.0, 16_777_218.0, 16_777_220.0], [1e-45, 0.0, f32::MIN_POSITIVE], largest];
    let mesh = mesh(text, "a.obj");
    assert_eq!(mesh.positions(), wanted);
    assert!(mesh.positions()[2][1].is_sign_positive());
}

#[test]
fn obj_without_anything_is_an_empty_mesh() {
    assert_eq!(mesh("# nothing\n", "a.obj").vertex_count(), 0);
}

#[test]
fn obj_errors_name_the_line() {
    expect_errors(
        "a.obj",
        &[
            (
                b"# c\nv 1 2 nan\nf 1 1 1\n",
                ", line 2 (obj): a face has vertex 1, whose coordinate NaN is not a finite number of 32 bits",
            ),
            (
                b"v 1 -inf 2\nf -1 1 1\n",
                ", line 1 (obj): a face has vertex 1, whose coordinate -inf is not a finite number of 32 bits",
            ),
            (
                b"v 0 0 0\nv 1 2 1e39\nf 1 1 2\n",
                ", line 2 (obj): a face has vertex 2, whose coordinate 1e39 is not a finite number of 32 bits",
            ),
            (b"v 1 2 3,5\n", ", line 1 (obj): `3,5` is not a number"),
            (b"v 1 \\\n2\n", ", line 1 (obj): a position needs three numbers"),
            (b"v 1 2 3 v 4 5 6\n", ", line 1 (obj): `v` follows the position"),
            (b"v 0 0 0\nf 1 1 2\n", ", line 2 (obj): a face names vertex 2, but the file has 1 vertex"),
            (
                b"f 1 2 3\nf 1 2 4\nf 1 2 4\nv 0 0 0\nv 0 0 0\nv 0 0 0\n",
                ", line 2 (obj): a face names vertex 4, but the file has 3 vertices",
            ),
            (
                b"v 0 0 0\nf 1 -1 -2\n",
                ", line 2 (obj): a face names vertex -2, but the file has 1 vertex so far",
            ),
            (b"v 0 0 0\n\nf 0 1 1\n", ", line 3 (obj): a face names vertex 0, but indices count from 1"),
            (b"f 1 2 x\n", ", line 1 (obj): `x` is not a corner of a face"),
            (b"f 1 2 3/x\n", ", line 1 (obj): `3/x` is not a corner of a face"),
            (b"f 1 2 3.5\n", ", line 1 (obj): `3.5` is not a corner of a face"),
            (b"f 1 2 --3\n", ", line 1 (obj): `--3` is not a corner of a face"),
            (b"f 1/1/1/1 2 3\n", ", line 1 (obj): `1/1/1/1` is not a corner of a face"),
            (
                b"f 1 2 99999999999999999999999\n",
                ", line 1 (obj): a face names vertex 99999999999999999999999, but the file has 0 vertices so far",
            ),
        ],
    );
}

#[test]
fn obj_garbage_is_told_from_an_empty_mesh() {
    let wanted = "a.obj, line 2 (obj): `MZ\u{fffd}` is not a statement of a mesh, and the file holds no vertex; \
                  check that this is a Wavefront OBJ file";
    assert_eq!(error(b"\nMZ\x90 1\n", "a.obj"), wanted);
}
