use ply_rs_bw::parser::Parser;
use ply_rs_bw::ply::{DefaultElement, Property};

use super::{error, expect_errors, mesh, scene};

pub(super) const SAMPLE: &[u8] = b"ply
format ascii 1.0
comment made by hand
element vertex 5
property float x
property uchar red
property double y
property short z
element face 2
property list uchar int vertex_indices
property list uchar float texcoord
element tristrips 1
property list int int vertex_indices
element edge 1
property int vertex1
property int vertex2
end_header
0 255 0 0
1 255 0 0
1 255 1 0
0 255 1 0
0.1 255 0.1 -3
4 0 1 2 3 2 0.5 0.5
3 0 4 1 0
10 0 1 2 3 -1 0 1 1 4 2
0 1
";

/// The sample in binary.
pub(super) fn binary(big_endian: bool) -> Vec<u8> {
    let text = std::str::from_utf8(SAMPLE).unwrap();
    let encoding = if big_endian { "binary_big_endian" } else { "binary_little_endian" };
    let (header, data) = text.split_at(text.find("end_header\n").unwrap() + 11);
    let mut bytes = header.replace("ascii", encoding).into_bytes();
    let mut put = |mut raw: Vec<u8>| {
        if big_endian {
            raw.reverse();
        }
        bytes.extend(raw);
    };
    let int = |word: &str| word.parse::<i32>().unwrap().to_le_bytes().to_vec();
    let float = |word: &str| word.parse::<f32>().unwrap().to_le_bytes().to_vec();
    for (row, line) in data.lines().enumerate() {
        let words: Vec<&str> = line.split(' ').collect();
        match row {
            0..5 => {
                put(float(words[0]));
                put(vec![255]);
                put(words[2].parse::<f64>().unwrap().to_le_bytes().to_vec());
                put(words[3].parse::<i16>().unwrap().to_le_bytes().to_vec());
            }
            5..7 => {
                let corners: usize = words[0].parse().unwrap();
                put(vec![corners as u8]);
                words[1..=corners].iter().for_each(|word| put(int(word)));
                put(vec![words[corners + 1].parse().unwrap()]);
                words[corners + 2..].iter().for_each(|word| put(float(word)));
            }
            _ => words.iter().for_each(|word| put(int(word))),
        }
    }
    bytes
}

fn with(from: &str, to: &str) -> Vec<u8> {
    let text = std::str::from_utf8(SAMPLE).unwrap();
    assert!(text.contains(from), "{from}");
    text.replacen(from, to, 1).into_bytes()
}

#[test]
fn ply_sample_is_read_whole_in_every_encoding() {
    for bytes in [SAMPLE.to_vec(), binary(false), binary(true)] {
        let scene = scene(bytes, "a.ply");
        let mesh = &scene.meshes[0];
        let square = [[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
        assert_eq!(mesh.positions(), [&square[..], &[[0.1, 0.1, -3.0]]].concat());
        let faces = [[0, 1, 2], [0, 2, 3], [0, 4, 1]];
        let strips = [[0, 1, 2], [2, 1, 3], [1, 4, 2]];
        assert_eq!(mesh.triangles(), [faces, strips].concat());
        let notes = [
            "1 edge element ignored",
            "1 n-gon cut into triangles",
            "2 triangle strips cut into triangles",
            "2 stitching triangles of strips skipped",
        ];
        assert_eq!(scene.notes, notes);
    }
}

#[test]
fn ply_strips_turn_every_second_triangle_and_a_restart_begins_anew() {
    let strip = |indices: &str| {
        let count = indices.split(' ').count();
        mesh(with("10 0 1 2 3 -1 0 1 1 4 2", &format!("{count} {indices}")), "a.ply").triangles()[3..]
            .to_vec()
    };
    assert_eq!(strip("0 1 2 3 4"), [[0, 1, 2], [2, 1, 3], [2, 3, 4]]);
    assert_eq!(strip("0 1 2 -1 1 2 3 4"), [[0, 1, 2], [1, 2, 3], [3, 2, 4]]);
    assert_eq!(strip("0 1 2 2 3 4"), [[0, 1, 2], [3, 2, 4]]); // stitches count, so the last one is the fourth
    assert_eq!(strip("0 1 0 2"), [[0, 1, 2]]); // there and back
    assert_eq!(strip("-1 -1 0 1 -1 2"), [[0; 3]; 0]);
}

#[test]
fn ply_text_agrees_with_binary_and_with_an_independent_reader() {
    for bytes in [SAMPLE.to_vec(), binary(false), binary(true)] {
        let wanted = Parser::<DefaultElement>::new().read_ply(&mut &bytes[..]).unwrap();
        let number = |property: &Property| property.to_f32_lossy().unwrap();
        let positions = wanted.payload["vertex"].iter().map(|v| ["x", "y", "z"].map(|axis| number(&v[axis])));
        let mesh = mesh(&bytes, "a.ply");
        assert_eq!(mesh.positions(), positions.collect::<Vec<_>>());
        let last = wanted.payload["face"].last().unwrap()["vertex_indices"].to_u32_list().unwrap();
        assert_eq!(mesh.triangles()[2].to_vec(), last);
    }
}

#[test]
fn ply_takes_every_type_and_both_names_of_the_list() {
    for number in [
        "char", "int8", "uchar", "uint8", "short", "int16", "ushort", "uint16", "int", "int32", "uint",
        "uint32",
    ] {
        let text = SAMPLE.to_vec();
        let text = String::from_utf8(text).unwrap();
        let text = text.replacen(
            "list uchar int vertex_indices",
            &format!("list {number} {number} vertex_index"),
            1,
        );
        assert_eq!(mesh(text, "a.ply").face_count(), 6, "{number}");
    }
    for number in ["float32", "double", "float64"] {
        assert_eq!(mesh(with("property float x", &format!("property {number} x")), "a.ply").face_count(), 6);
    }
}

#[test]
fn ply_lines_may_end_in_crlf_or_cr() {
    let text = String::from_utf8(SAMPLE.to_vec()).unwrap();
    let wanted = mesh(SAMPLE, "a.ply");
    for end in ["\r\n", "\r", " \n\n"] {
        let text = text.replace('\n', end).replace("ply \n", "ply\n");
        assert_eq!(mesh(text, "a.ply"), wanted, "{end:?}");
    }
}

#[test]
fn ply_binary_may_have_a_crlf_header() {
    let bytes = binary(false);
    let end = bytes.windows(11).position(|window| window == b"end_header\n").unwrap() + 11;
    let header = String::from_utf8(bytes[..end].to_vec()).unwrap().replace('\n', "\r\n");
    assert_eq!(mesh([header.as_bytes(), &bytes[end..]].concat(), "a.ply"), mesh(&bytes, "a.ply"));
}

#[test]
fn ply_without_faces_is_a_point_cloud() {
    let text = "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\nend_header\n1 2 3";
    let mesh = mesh(text, "a.ply");
    assert_eq!((mesh.positions(), mesh.face_count()), (&[[1.0, 2.0, 3.0]][..], 0));
}

#[test]
fn ply_claims_beyond_the_file_are_refused_at_once() {
    for encoding in ["ascii", "binary_little_endian", "binary_big_endian"] {
        for count in ["4000000000", "18446744073709551615"] {
            for element in ["vertex", "face", "tristrips", "edge"] {
                let vertex = if element == "vertex" { count } else { "0" };
                let text = format!(
                    "ply\nformat {encoding} 1.0\nelement vertex {vertex}\nproperty uchar x\nproperty uchar y\n\
                     property uchar z\nelement {element} {count}\nproperty list uchar int vertex_indices\nend_header\n1234"
                );
                let message = error(text, "a.ply");
                assert!(message.ends_with("but only 4 bytes follow it; export the file again"), "{message}");
            }
        }
        // A list that claims more than the rest of the file, and items without data, are refused as quickly.
        let header =
            format!("ply\nformat {encoding} 1.0\nelement nothing 18446744073709551615\nelement face 1\n");
        let list = header + "property list uint int vertex_indices\nend_header\n";
        let message = error([list.as_bytes(), &[0x39; 8]].concat(), "a.ply");
        assert!(
            message.contains("vertex 9999")
                || message.contains("vertex 960051513")
                || message.contains("fewer"),
            "{message}"
        );
    }
}

#[test]
fn ply_text_errors_name_the_line() {
    let short = with("10 0 1 2 3 -1 0 1 1 4 2\n0 1\n", "");
    expect_errors(
        "a.ply",
        &[
            (
                &with("0.1 255", "nan 255"),
                ", line 22 (ply): a face has vertex 4, whose coordinate NaN is not a finite number of 32 bits",
            ),
            (
                &with("255 0.1", "255 1e300"),
                ", line 22 (ply): a face has vertex 4, whose coordinate 1e300 is not a finite number of 32 bits",
            ),
            (&with("0.1 255", "0,1 255"), ", line 22 (ply): `0,1` is not a number"),
            (&with("0.1 -3", "0.1 -3.5"), ", line 22 (ply): `-3.5` is not an integer"),
            (
                &with("0.1 -3", "0.1"),
                ", line 22 (ply): the line holds fewer numbers than the header declares",
            ),
            (
                &with("4 0 1 2 3", "4 0 1 2 5"),
                ", line 23 (ply): a face names vertex 5, but the file has 5 vertices",
            ),
            (
                &with("4 0 1 2 3", "4 0 1 2 -1"),
                ", line 23 (ply): a face names vertex -1, but the file has 5 vertices",
            ),
            (&with("10 0", "10 -2"), ", line 25 (ply): a face names vertex -2, but the file has 5 vertices"),
            (&with("3 0 4 1 0", "-3 0 4 1 0"), ", line 24 (ply): -3 is not the length of a list"),
            (
                &with("3 0 4 1 0", "4000000000 0 4 1 0"),
                ", line 24 (ply): the line holds fewer numbers than the header declares",
            ),
            (&short, ", line 24 (ply): the file ends before element tristrips, item 0"),
            (&with("property uchar red", "property color red"), ", line 6 (ply): `color` is not a PLY type"),
            (&with("property uchar red", "property uchar"), ", line 6 (ply): a property needs a name"),
            (
                &with("list uchar int", "list float int"),
                ", line 10 (ply): the length of a list must be an integer",
            ),
            (&with("element edge 1", "element edge -1"), ", line 14 (ply): `-1` is not a count of elements"),
            (&with("element edge 1", "elemnt edge 1"), ", line 14 (ply): `elemnt` is not a header statement"),
            (
                &with("property int vertex1", "propery int vertex1"),
                ", line 15 (ply): `propery` is not a header statement",
            ),
            (&with("end_header\n", ""), ", line 17 (ply): `0` is data, but `end_header` is missing"),
            (
                &with("end_header\n", "end\x01header\n"),
                ", line 17 (ply): `end\u{fffd}header` is data, but `end_header` is missing",
            ),
            (&with("format ascii", "format utf8"), ", line 2 (ply): `utf8` is not a PLY encoding"),
            (&with("format ascii 1.0\n", ""), ", line 16 (ply): the header declares no format"),
            (&with("element vertex 5\n", ""), ", line 4 (ply): a property is declared before any element"),
            (
                b"ply\nformat ascii 1.0\n",
                ", line 2 (ply): the file ends inside the header, before `end_header`",
            ),
            (b"plx\n", ", line 1 (ply): a PLY file begins with the line `ply`, this one does not"),
        ],
    );
}

#[test]
fn ply_header_errors_name_the_element() {
    expect_errors(
        "a.ply",
        &[
            (&with("property double y", "property double v"), " (ply): element vertex has no number y"),
            (&with("property uchar red", "property uchar x"), " (ply): element vertex declares x twice"),
            (
                &with("int vertex_indices", "int corners"),
                " (ply): element face has no list of integers vertex_indices",
            ),
            (
                &with("int vertex_indices", "float vertex_indices"),
                " (ply): element face has no list of integers vertex_indices",
            ),
            (&with("element edge 1", "element vertex 1"), " (ply): the header declares element vertex twice"),
            (
                &with("element vertex 5", "element vertex 500"),
                " (ply): the header declares 500 vertex elements, but only 113 bytes follow it",
            ),
        ],
    );
}

#[test]
fn ply_binary_errors_name_the_item() {
    let mut nan = binary(false);
    let data = nan.windows(11).position(|window| window == b"end_header\n").unwrap() + 11;
    nan[data + 15..data + 19].copy_from_slice(&f32::NAN.to_le_bytes());
    let mut index = binary(true);
    let face = index.windows(11).position(|window| window == b"end_header\n").unwrap() + 11 + 5 * 15;
    index[face + 1 + 3] = 77;
    let whole = binary(false);
    let cut = format!(", byte {} (ply): the file ends inside element edge, item 0", whole.len() - 4);
    expect_errors(
        "a.ply",
        &[
            (
                &nan,
                ", vertex 1 (ply): a face has vertex 1, whose coordinate NaN is not a finite number of 32 bits",
            ),
            (&index, ", element face, item 0 (ply): a face names vertex 77, but the file has 5 vertices"),
            (&whole[..whole.len() - 1], &cut),
        ],
    );
}

/// A file of many vertices and faces in either byte order, larger than one read: rare items among plain ones.
fn large(big: bool, signed: bool, quads: bool, seed: u64) -> Vec<u8> {
    // A linear congruential generator, its upper half (Donald E. Knuth, *MMIX*).
    let mut state = seed;
    let mut below = move |end: u32| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (((state >> 32) * u64::from(end)) >> 32) as u32
    };
    let (vertices, faces) = (9_000 + below(1000), 30_000);
    let (extra, index) = (below(3) as usize, if signed { "int" } else { "uint" });
    // Headers of equal length, so that all offsets are equal.
    let order = if big { "comment be\nformat binary_big" } else { "comment\nformat binary_little" };
    let mut bytes = format!("ply\n{order}_endian 1.0\nelement vertex {vertices}\nproperty uchar a\n");
    bytes += "property float z\nproperty float x\nproperty float y\n";
    bytes += &"property short b\n".repeat(extra);
    bytes += &format!("element face {faces}\nproperty list uchar {index} vertex_indices\nend_header\n");
    let mut bytes = bytes.into_bytes();
    let mut put = |number: &mut [u8]| {
        if big {
            number.reverse();
        }
        bytes.extend_from_slice(number);
    };
    for _ in 0..vertices {
        put(&mut [below(256) as u8]);
        for _ in 0..3 {
            put(&mut (below(1000) as f32 / 7.0).to_le_bytes());
        }
        for _ in 0..extra {
            put(&mut (below(1 << 16) as u16).to_le_bytes());
        }
    }
    let mut corners = 3;
    for _ in 0..faces {
        // Runs of triangles and of quads, and single polygons of more corners.
        if quads && (corners > 4 || below(50) == 0) {
            corners = 3 + below(4);
        }
        put(&mut [corners as u8]);
        for _ in 0..corners {
            put(&mut below(vertices).to_le_bytes());
        }
    }
    bytes
}

#[test]
fn ply_runs_of_plain_items_agree_with_items_read_one_by_one() {
    let folder = tempfile::tempdir().unwrap();
    for seed in 0..8 {
        let (signed, quads) = (seed % 2 == 0, seed % 4 < 2);
        // In the other byte order nothing is read in runs.
        let [mut little, big] = [false, true].map(|order| large(order, signed, quads, seed));
        let (run, single) = (mesh(&little, "a.ply"), mesh(&big, "a.ply"));
        assert!(run.face_count() >= 30_000 && (run.face_count() > 30_000) == quads);
        assert_eq!(
            (run.positions(), run.triangles()),
            (single.positions(), single.triangles()),
            "seed {seed}"
        );
        // A file arrives in pieces, which may end within an item.
        let path = folder.path().join("a.ply");
        std::fs::write(&path, &little).unwrap();
        assert_eq!(umbrage::read::read(&path).unwrap().meshes[0], run);
        // Negative test: one bit of the last index.
        let last = little.len() - 4;
        little[last] ^= 1;
        assert_ne!(mesh(&little, "a.ply").triangles(), single.triangles());
    }
}

#[test]
fn ply_runs_end_before_what_is_wrong() {
    let [little, big] = [false, true].map(|order| large(order, true, false, 1));
    let start = little.windows(11).position(|window| window == b"end_header\n").unwrap() + 11;
    let faces = little.len() - 30_000 * 13;
    let vertex = (faces - start) / mesh(&little, "a.ply").vertex_count();
    let error = |mut bytes: Vec<u8>, at: usize, number: [u8; 4]| {
        bytes[at..at + 4].copy_from_slice(&number);
        error(bytes, "a.ply")
    };
    for item in [0, 1, 5_000, 8_999] {
        let at = start + item * vertex + 1;
        let text = error(little.clone(), at, f32::NAN.to_le_bytes());
        assert!(text.contains(&format!(", vertex {item} (ply)")), "{text}");
        assert_eq!(text, error(big.clone(), at, f32::NAN.to_be_bytes()));
    }
    for item in [0, 1, 20_000, 29_999] {
        let at = faces + 13 * item + 5;
        for index in [10_000_i32, -1, i32::MIN] {
            let text = error(little.clone(), at, index.to_le_bytes());
            assert!(text.contains(&format!("element face, item {item} ")), "{text}");
            assert_eq!(text, error(big.clone(), at, index.to_be_bytes()));
        }
        for cut in [0, 1, 12] {
            let [little, big] =
                [&little, &big].map(|bytes| super::error(&bytes[..faces + 13 * item + cut], "a.ply"));
            assert_eq!(little, big);
        }
    }
}
