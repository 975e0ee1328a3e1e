use std::io::Cursor;

use umbrage::mesh::Mesh;

use super::{expect_errors, mesh, parts, scene};

pub(super) const SAMPLE: &[u8] = b"solid first part
 facet normal 0 0 1
  outer loop
   vertex 0 0 0
   vertex 1 0 0
   vertex 0 1.5e-1 0
  endloop
 endfacet
endsolid first part
solid second
 facet normal nan nan nan
  outer loop
   vertex 0 0 1
   vertex 1 0 1
   vertex 0 1 1
  endloop
 endfacet
endsolid
";

/// A binary file of `triangles`.
pub(super) fn binary(triangles: &[[[f32; 3]; 3]]) -> Vec<u8> {
    let mut bytes = vec![b' '; 80];
    bytes.extend((triangles.len() as u32).to_le_bytes());
    for triangle in triangles {
        bytes.extend([0xff; 12]); // a normal of NaN: readers must ignore it
        bytes.extend(triangle.as_flattened().iter().flat_map(|value| value.to_le_bytes()));
        bytes.extend([0, 0]);
    }
    bytes
}

const TRIANGLES: [[[f32; 3]; 3]; 2] = [
    [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.15, 0.0]],
    [[0.0, 0.0, 1.0], [1.0, 0.0, 1.0], [0.0, 1.0, 1.0]],
];

#[test]
fn stl_text_and_binary_are_soups_in_file_order() {
    for bytes in [SAMPLE.to_vec(), binary(&TRIANGLES)] {
        let mesh = mesh(bytes, "a.stl");
        assert_eq!(mesh.positions(), TRIANGLES.as_flattened());
        assert_eq!(mesh.triangles(), [[0, 1, 2], [3, 4, 5]]);
    }
}

#[test]
fn stl_several_solids_are_parts_and_one_names_the_mesh() {
    assert_eq!(parts(&mesh(SAMPLE, "a.stl")), [("first part", 0..1), ("second", 1..2)]);
    let end = SAMPLE.windows(12).position(|window| window == b"solid second").unwrap();
    let one = mesh(&SAMPLE[..end], "a.stl");
    assert_eq!((one.name.as_str(), one.parts().len(), one.face_count()), ("first part", 0, 1));
}

#[test]
fn stl_text_may_be_upper_case_and_unnamed() {
    let text = String::from_utf8(SAMPLE.to_vec()).unwrap().to_uppercase().replace("SECOND", "");
    let mesh = mesh(text.replace('\n', "\r\n"), "a.bin");
    assert_eq!(parts(&mesh), [("FIRST PART", 0..1), ("", 1..2)]);
}

#[test]
fn stl_solids_without_faces_are_no_parts() {
    assert_eq!(mesh("solid\nendsolid\n", "a.stl"), Mesh::default());
    let text = [b"solid empty\nendsolid empty\n", SAMPLE].concat();
    assert_eq!(parts(&mesh(text, "a.stl")), [("first part", 0..1), ("second", 1..2)]);
}

#[test]
fn stl_binary_may_begin_with_solid() {
    let mut bytes = binary(&TRIANGLES);
    bytes[..12].copy_from_slice(b"solid binary");
    assert_eq!(mesh(&bytes, "a.stl").face_count(), 2);
    bytes.extend([1, 2, 3]);
    assert_eq!(mesh(&bytes, "a.stl").face_count(), 2);
}

#[test]
fn stl_binary_bytes_after_the_last_triangle_are_noted() {
    let mut bytes = binary(&TRIANGLES);
    bytes.push(7);
    let scene = scene(bytes, "a.stl");
    assert_eq!(
        (scene.meshes[0].face_count(), scene.notes),
        (2, vec!["1 byte after the last triangle ignored".into()])
    );
}

#[test]
fn stl_binary_longer_than_a_chunk_is_read_whole() {
    let triangles: Vec<_> = (0..10_000).map(|i| TRIANGLES[0].map(|[x, y, z]| [x + i as f32, y, z])).collect();
    assert_eq!(mesh(binary(&triangles), "a.stl").positions(), triangles.as_flattened());
}

#[test]
fn stl_agrees_with_an_independent_reader() {
    let one_solid =
        String::from_utf8(SAMPLE.to_vec()).unwrap().replace("endsolid first part\nsolid second\n", "");
    for bytes in [one_solid.replace("nan", "0").into_bytes(), binary(&TRIANGLES)] {
        let mut cursor = Cursor::new(&bytes);
        let wanted = stl_io::create_stl_reader(&mut cursor).unwrap();
        let wanted: Vec<_> =
            wanted.flat_map(|triangle| triangle.unwrap().vertices.map(|vertex| vertex.0)).collect();
        assert_eq!(mesh(&bytes, "a.stl").positions(), wanted);
    }
}

#[test]
fn stl_binary_errors_name_the_byte() {
    let sound = binary(&TRIANGLES);
    let with = |at: usize, bytes: &[u8]| {
        let mut file = sound.clone();
        file[at..at + bytes.len()].copy_from_slice(bytes);
        file
    };
    let nan = with(84 + 50 + 12 + 4 * 4, &f32::NAN.to_le_bytes());
    expect_errors(
        "a.stl",
        &[
            (&[0; 83], " (stl): a binary STL has at least 84 bytes, but the file has 83"),
            (&with(80, &[3]), ", byte 80 (stl): the header counts 3 triangles, but the file holds 2"),
            (&with(80, &[1]), ", byte 80 (stl): the header counts 1 triangle, but the file holds 2"),
            (
                &with(80, &[0xff; 4]),
                ", byte 80 (stl): the header counts 4294967295 triangles, but the file holds 2",
            ),
            (&sound[..183], ", byte 80 (stl): the header counts 2 triangles, but the file holds 1"),
            (&nan, ", byte 162 (stl): triangle 1 has the coordinate NaN, which is not a finite number"),
        ],
    );
}

#[test]
fn stl_text_errors_name_the_line() {
    let text = String::from_utf8(SAMPLE.to_vec()).unwrap();
    let with = |from: &str, to: &str| text.replacen(from, to, 1).into_bytes();
    let lines = |count: usize| {
        text.lines().take(count).flat_map(|line| [line, "\n"]).collect::<String>().into_bytes()
    };
    expect_errors(
        "a.stl",
        &[
            (&with("1.5e-1", "NaN"), ", line 6 (stl): the coordinate `NaN` is not a finite number"),
            (&with("1.5e-1", "1.5.1"), ", line 6 (stl): `1.5.1` is not a number"),
            (&with("1.5e-1", ""), ", line 6 (stl): a position needs three numbers"),
            (&with("1.5e-1", "1 2"), ", line 6 (stl): `endloop` is wanted, not `0`"),
            (&with("   vertex 1 0 0\n", ""), ", line 6 (stl): `vertex` is wanted, not `endloop`"),
            (&with("  endloop", "vertex 0 0 0"), ", line 7 (stl): `endloop` is wanted, not `vertex`"),
            (&with("  outer loop\n", ""), ", line 3 (stl): `outer loop` is wanted, not `vertex`"),
            (&lines(4), ", line 4 (stl): the file ends where `vertex` is wanted"),
            (&[&lines(9)[..], b"x"].concat(), ", line 10 (stl): `solid` is wanted, not `x`"),
        ],
    );
}
