//! Vertices that nearly coincide, numbers that are not finite, and vertices in the middle of an edge.

use umbrage::check::DefectKind;
use umbrage::mesh::{Mesh, Weld, weld};
use umbrage::read::read_bytes;
use umbrage::scene::Scope;
use umbrage::testing::shapes;
use umbrage::write::{Layer, Model, Target, to_bytes};

use super::figures::*;

/// The octahedron as separate faces. Every second face (alternating over each edge) has `zero` in place of a
/// zero.
fn octahedron(zero: f32) -> Vec<[[f32; 3]; 3]> {
    let solid = shapes::octahedron();
    let faces = solid.triangles().iter().map(|face| face.map(|vertex| solid.positions()[vertex as usize]));
    faces
        .map(|corners| {
            let odd = corners.iter().flatten().product::<f32>() < 0.0
                || corners.iter().flatten().filter(|&&x| x < 0.0).count() % 2 == 1;
            corners.map(|p| p.map(|x| if odd && x == 0.0 { zero } else { x }))
        })
        .collect()
}

fn mesh(faces: &[[[f32; 3]; 3]]) -> Mesh {
    let triangles = (0..faces.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    Mesh::new(faces.as_flattened().to_vec(), triangles).unwrap()
}

fn obj(faces: &[[[f32; 3]; 3]]) -> String {
    let mut text = String::new();
    for [x, y, z] in faces.as_flattened() {
        text += &format!("v {x:?} {y:?} {z:?}\n");
    }
    (0..faces.len()).for_each(|i| text += &format!("f {} {} {}\n", 3 * i + 1, 3 * i + 2, 3 * i + 3));
    text
}

fn binary_stl(faces: &[[[f32; 3]; 3]]) -> Vec<u8> {
    let mut bytes = vec![0; 80];
    bytes.extend((faces.len() as u32).to_le_bytes());
    for corners in faces {
        bytes.extend([0; 12]);
        bytes.extend(corners.iter().flatten().flat_map(|x| x.to_le_bytes()));
        bytes.extend([0; 2]);
    }
    bytes
}

/// The mesh of a file, welded by `how`.
fn welded(bytes: &[u8], name: &str, how: Weld) -> Mesh {
    weld(&read_bytes(bytes, name).unwrap().bake(Scope::Mesh).unwrap()[0], how).mesh
}

/// Guards against hashing the bits of a position: the two zeros are equal, but their bits differ.
#[test]
fn hard_07_seam_between_the_two_zeros_closes() {
    let faces = octahedron(-0.0);
    let negative =
        |faces: &[[[f32; 3]; 3]]| faces.as_flattened().iter().flatten().any(|x| x.to_bits() == 1 << 31);
    assert!(negative(&faces) && obj(&faces).contains("-0.0"));
    for mesh in [
        weld(&mesh(&faces), Weld::Exact).mesh,
        welded(obj(&faces).as_bytes(), "a.obj", Weld::Exact),
        welded(&binary_stl(&faces), "a.stl", Weld::Exact),
    ] {
        let c = counts(&mesh);
        assert_eq!((mesh.vertex_count(), c.edges, c.boundary_edges, c.sound()), (6, 12, 0, true));
        expect_figures(&[(&mesh, point(3.0, 5.0, 6.5), ([4, 4, 0], 6, 12))]);
    }
}

/// Guards against calling a mesh closed, or open, without naming the distance: `sin π` is not 0.
#[test]
fn hard_07_seam_of_rounding_near_zero_needs_a_distance_and_none_in_ulps() {
    let faces = octahedron(2.7e-16);
    let separate = weld(&mesh(&faces), Weld::Exact).mesh;
    // Each vertex is doubled now, so all twelve edges are open on both sides.
    let found = report(&separate);
    assert_eq!(
        (separate.vertex_count(), found.counts.boundary_edges, found.counts.watertight),
        (12, 24, false)
    );
    assert_eq!(found.counts.near_miss_edges, 24);
    assert!(found.near_miss.iter().all(|near| near.edges == 24));
    for (distance, closes) in [(1e-16, false), (1e-9, true), (1e-7, true), (1e-4, true)] {
        for mesh in [
            weld(&mesh(&faces), Weld::Within(distance)).mesh,
            welded(&binary_stl(&faces), "a.stl", Weld::Within(distance)),
        ] {
            assert_eq!(counts(&mesh).sound(), closes, "{distance}");
            assert_eq!(mesh.vertex_count() == 6, closes, "{distance}");
        }
    }
    // Open or not, the volume is closed and agrees with the ray cast.
    let light = point(3.0, 5.0, 6.5);
    expect_figures(&[(&separate, light, ([4, 4, 0], 24, 24))]);
    expect_crossings(&separate, &light, &[([-3.0, -5.0, -7.25], 2), ([0.1, 0.2, 0.3], 1)]);
    expect_agreement(&separate, &light);
}

/// Guards against an epsilon in the exact weld, and against one that is too small in the weld within a
/// distance.
#[test]
fn hard_07_seam_of_one_ulp_stays_open_exactly_and_closes_at_that_distance() {
    let mesh = shapes::seam(1);
    let ulp = f32::EPSILON;
    for (how, boundary, vertices) in [
        (Weld::None, 8, 12),
        (Weld::Exact, 8, 12),
        (Weld::Within(ulp.next_down()), 8, 12),
        (Weld::Within(ulp), 0, 8),
        (Weld::Within(0.1), 0, 8),
    ] {
        let mesh = weld(&mesh, how).mesh;
        assert_eq!((counts(&mesh).boundary_edges, mesh.vertex_count()), (boundary, vertices), "{how:?}");
    }
    let light = point(9.0, 0.25, 1.0 + 0.5 * ulp);
    // Through the slit, which is one ulp high: the lid is above, the rest below.
    for light in [light, point(3.0, 5.0, 7.0)] {
        figures(&mesh, &light);
        expect_agreement(&mesh, &light);
    }
    expect_crossings(&mesh, &point(3.0, 5.0, 7.0), &[([-3.0, -5.0, -7.25], 2), ([0.1, 0.2, 0.3], 1)]);
}

/// A model of one frame and one face, whose vertices are scaled by 1 and moved along y by `offset`.
fn md2(offset: f32) -> Vec<u8> {
    let frames_at = 68 + 12;
    let end = frames_at + 40 + 3 * 4;
    let header: [u32; 16] = [8, 64, 64, 52, 0, 3, 0, 1, 0, 1, 68, 68, 68, frames_at, end, end];
    let mut bytes = b"IDP2".to_vec();
    bytes.extend(header.iter().flat_map(|field| field.to_le_bytes()));
    bytes.extend([0_u16, 1, 2, 0, 0, 0].iter().flat_map(|corner| corner.to_le_bytes()));
    bytes.extend([1.0, 1.0, 1.0, 0.0, offset, 0.0].iter().flat_map(|x: &f32| x.to_le_bytes()));
    bytes.extend([0; 16]);
    bytes.extend([[0, 0, 0, 0], [0, 0, 1, 0], [1, 0, 0, 0]].as_flattened());
    bytes
}

/// Guards against numbers that are not finite: a single NaN would turn every box, plane and tree of its mesh
/// into NaN.
#[test]
fn hard_07_seam_free_nan_and_infinity_in_a_file_are_errors_with_a_place() {
    let marker = 1234.5_f32;
    let (mut positions, triangles, ..) = shapes::tetrahedron().into_parts();
    positions[1][1] = marker;
    let tetrahedron = Mesh::new(positions, triangles).unwrap();
    let model = Model { layers: vec![Layer::from(&tetrahedron)] };
    let written = |name: &str| to_bytes(&model, Target::from_path(name).unwrap()).unwrap();
    let stl: Vec<_> = (0..4).map(|face| tetrahedron.corners(umbrage::mesh::FaceId::new(face))).collect();
    let in_text =
        |text: Vec<u8>, word: &str| String::from_utf8(text).unwrap().replace("1234.5", word).into_bytes();
    let in_bytes = |mut bytes: Vec<u8>, value: f32| {
        let places: Vec<usize> =
            (0..bytes.len() - 3).filter(|&i| bytes[i..i + 4] == marker.to_le_bytes()).collect();
        assert!(!places.is_empty());
        places.into_iter().for_each(|i| bytes[i..i + 4].copy_from_slice(&value.to_le_bytes()));
        bytes
    };
    let ascii_ply = b"ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
        element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 1234.5 0\n0 1 0\n3 0 1 2\n";
    let ascii_stl =
        b"solid a\nfacet normal 0 0 0\nouter loop\nvertex 0 0 0\nvertex 1 1234.5 0\nvertex 0 1 0\nendloop\n\
        endfacet\nendsolid a\n";
    for (value, word) in [(f32::NAN, "nan"), (f32::INFINITY, "inf"), (f32::NEG_INFINITY, "-inf")] {
        for (name, bytes, place) in [
            (
                "a.obj",
                in_text(b"v 0 0 0\nv 1 1234.5 0\nv 0 1 0\nf 1 2 3\n".to_vec(), word),
                "a.obj, line 2 (obj): ",
            ),
            ("a.ply", in_text(ascii_ply.to_vec(), word), "a.ply, line 11 (ply): "),
            ("b.ply", in_bytes(written("b.ply"), value), "b.ply, vertex 1 (ply): "),
            ("a.stl", in_text(ascii_stl.to_vec(), word), "a.stl, line 5 (stl): "),
            ("b.stl", in_bytes(binary_stl(&stl), value), "b.stl, byte "),
            ("a.glb", in_bytes(written("a.glb"), value), "accessor "),
            ("a.md2", md2(value), "a.md2, byte 80 (md2): "),
        ] {
            let error = read_bytes(&bytes, name).unwrap_err().to_string();
            assert!(error.contains(place) && error.contains("not a finite number"), "{name}: {error}");
            assert_eq!(error.lines().count(), 1, "{error}");
        }
    }
    // Negative test: with a number instead, each of the files is read.
    for (name, bytes) in [
        ("a.ply", ascii_ply.to_vec()),
        ("b.ply", written("b.ply")),
        ("a.stl", ascii_stl.to_vec()),
        ("b.stl", binary_stl(&stl)),
        ("a.glb", written("a.glb")),
        ("a.md2", md2(marker)),
    ] {
        let mesh = &read_bytes(&bytes, name).unwrap().bake(Scope::Mesh).unwrap()[0];
        assert!(mesh.positions().iter().any(|p| p[1] == marker), "{name}");
    }
}

/// Guards against cracks that no weld closes: a vertex lies in the middle of its neighbor's edge.
#[test]
fn hard_08_t_junction_is_reported_and_the_volume_is_closed_all_the_same() {
    let exact = shapes::t_junction();
    // Tilted by multiples of a tenth, and cut at a third: no f32 point lies on this edge.
    let (mut positions, triangles, ..) = exact.clone().into_parts();
    let lean = |x: f64, y: f64, z: f64| [x, y + 0.1 * x, z - 0.3 * x].map(|x| x as f32);
    for p in &mut positions[..8] {
        *p = lean(p[0].into(), p[1].into(), p[2].into());
    }
    positions[8] = lean(-1.0 / 3.0, -1.0, 1.0);
    let rounded = Mesh::new(positions, triangles).unwrap();
    for (mesh, exactly) in [(&exact, 1), (&rounded, 0)] {
        let c = counts(mesh);
        assert_eq!((c.t_junctions, c.t_junctions_exact), (1, exactly));
        assert_eq!((c.boundary_edges, c.boundary_loops, c.watertight, c.near_miss_edges), (3, 1, false, 0));
        let items = report(mesh).items(DefectKind::TJunction, mesh, &topology(mesh), 9);
        assert_eq!(items[0].position, mesh.positions()[8]);
        for light in [point(3.0, 5.0, 7.0), point(0.1, -4.0, 5.0), point(0.0, -1.0, 1.0), sun(0.0, 1.0, -1.0)]
        {
            figures(mesh, &light); // asserts that the volume is closed
            expect_agreement(mesh, &light);
        }
        expect_crossings(mesh, &point(3.0, 5.0, 7.0), &[([-3.0, -5.0, -7.25], 2), ([0.1, 0.2, 0.3], 1)]);
    }
    // The hexagon of the cube, except that one edge is replaced by three edges of multiplicity 1 along its
    // two copies.
    expect_figures(&[(&exact, point(3.0, 5.0, 7.0), ([7, 6, 0], 8, 5 * 2 + 3))]);
    // Negative test: a vertex off the edge makes a hole, not a T-junction.
    let (mut positions, triangles, ..) = exact.into_parts();
    positions[8][2] = 0.75;
    let hole = counts(&Mesh::new(positions, triangles).unwrap());
    assert_eq!((hole.t_junctions, hole.boundary_edges), (0, 3));
}
