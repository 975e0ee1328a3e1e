//! `umbrage check --html`: what the page holds, against defects that were put into the mesh.

use std::fs;

use serde_json::Value;
use umbrage::mesh::Mesh;
use umbrage::testing::shapes;
use umbrage::write::{Layer, Model, write};

use super::{Folder, keys};

/// The data of a page, as its script reads it.
fn data(page: &str) -> Value {
    let (_, rest) = page.split_once("<script type=\"application/json\" id=\"data\">").unwrap();
    let (text, _) = rest.split_once("</script>").unwrap();
    serde_json::from_str(text).unwrap()
}

/// Bytes of base64.
fn decoded(value: &Value) -> Vec<u8> {
    let digit = |letter: u8| match letter {
        b'A'..=b'Z' => letter - b'A',
        b'a'..=b'z' => letter - b'a' + 26,
        b'0'..=b'9' => letter - b'0' + 52,
        b'+' => 62,
        b'/' => 63,
        _ => panic!("not base64: {letter}"),
    };
    let letters = value.as_str().unwrap().trim_end_matches('=').as_bytes();
    let groups = letters.chunks(4).flat_map(|group| {
        let bits = group.iter().fold(0_u32, |bits, &letter| bits << 6 | u32::from(digit(letter)));
        let bits = bits << (6 * (4 - group.len()));
        bits.to_be_bytes()[1..group.len()].to_vec()
    });
    groups.collect()
}

/// Little-endian numbers of three, as positions.
fn positions(value: &Value) -> Vec<[f32; 3]> {
    let numbers: Vec<f32> =
        decoded(value).chunks(4).map(|bytes| f32::from_le_bytes(bytes.try_into().unwrap())).collect();
    numbers.chunks(3).map(|point| point.try_into().unwrap()).collect()
}

fn page_of(folder: &Folder, arguments: &str) -> String {
    let run = folder.run(&format!("check {arguments} --html out.html"));
    assert_ne!(run.code, 2, "{}", run.stderr);
    assert!(run.stderr.contains("wrote out.html"), "{}", run.stderr);
    fs::read_to_string(folder.path("out.html")).unwrap()
}

/// Kind, count and the number of rows.
fn kinds(data: &Value) -> Vec<(String, u64, u64)> {
    let kinds = data["kinds"].as_array().unwrap().iter();
    kinds
        .map(|kind| {
            let name = kind["kind"].as_str().unwrap().to_owned();
            (name, kind["count"].as_u64().unwrap(), kind["listed"].as_u64().unwrap())
        })
        .collect()
}

#[test]
fn check_page_holds_the_defects_that_were_put_in() {
    let folder = Folder::new();
    // A cube without its upper side, and two cubes that share a vertex: a hole and a pinched vertex.
    let hole = shapes::open_cube().with_name("hole");
    let pinch = shapes::translated(&shapes::cubes_sharing_vertex(), [6.0, 0.0, 0.0]).with_name("pinch");
    write(&Model { layers: [&hole, &pinch].map(Layer::from).to_vec() }, folder.path("two.glb")).unwrap();
    let page = page_of(&folder, "two.glb");
    let data = data(&page);
    assert_eq!(keys(&data), "file verdict triangles positions indices kinds defects");
    assert_eq!((&data["file"], &data["verdict"]), (&"two.glb".into(), &"cracked".into()));
    let kind = &data["kinds"][0];
    assert_eq!(
        keys(kind),
        "kind code severity color count at_least effect listed lines spots faces",
        "the worst first"
    );
    assert_eq!(kinds(&data), [("boundary_loop".to_owned(), 1, 1), ("non_manifold_vertex".to_owned(), 1, 1)]);
    let defects = data["defects"].as_array().unwrap();
    let defect = &defects[0];
    assert_eq!(keys(defect), "position name faces origins face_count length kind mesh view");
    assert_eq!(keys(&defect["view"]), "at reach normal lines");
    assert_eq!((&defect["mesh"], &defect["view"]["lines"]), (&"hole".into(), &serde_json::json!([0, 4])));
    assert_eq!((&defects[1]["mesh"], &defects[1]["kind"]), (&"pinch".into(), &"non_manifold_vertex".into()));
    // As many triangles as both have; every index names a position; all within the sphere of the view.
    let faces = hole.face_count() + pinch.face_count();
    assert_eq!(data["triangles"], serde_json::json!({ "drawn": faces, "all": faces, "cells": null }));
    let points = positions(&data["positions"]);
    let indices = decoded(&data["indices"]);
    assert_eq!(indices.len(), 12 * faces);
    assert!(
        indices
            .chunks(4)
            .all(|index| (u32::from_le_bytes(index.try_into().unwrap()) as usize) < points.len())
    );
    assert!(points.iter().all(|point| point.iter().map(|x| x * x).sum::<f32>() <= 1.0001));
    // The four lines of the hole end at corners of the mesh, and nowhere else is an edge open.
    let ends = positions(&data["kinds"][0]["lines"]["ends"]);
    assert_eq!(ends.len(), 8);
    assert!(ends.iter().all(|end| points.contains(end)), "{ends:?}");
    // The list and the pictures are in the page for readers without scripts.
    assert_eq!(page.matches("<tr class=\"defect\">").count(), 2);
    assert_eq!(page.matches("src=\"data:image/png;base64,").count(), 6);
    let effect = kind["effect"].as_str().unwrap();
    assert!(page.contains(&format!("Worst effect on the shadow: {effect}.")));
    // It asks for nothing from elsewhere.
    for outside in ["http:", "https:", "href=", "@import", "url(", "src=\"/"] {
        assert!(!page.contains(outside), "{outside}");
    }
    // Fault injected: the same cube closed has no such defect.
    folder.mesh("cube.obj", &shapes::cube());
    let sound = page_of(&folder, "cube.obj");
    assert!(sound.contains("No defects.") && !sound.contains("<tr class=\"defect\">"));
    assert_eq!(self::data(&sound)["kinds"], Value::Array(vec![]));
}

#[test]
fn check_page_colors_the_faces_of_shells_and_turns_up_what_lies_up() {
    let folder = Folder::new();
    let tall = shapes::inside_out(&shapes::cube());
    let facet = |[a, b, c]: [[f32; 3]; 3]| {
        let vertex = |[x, y, z]: [f32; 3]| format!("vertex {x} {y} {}\n", 5.0 * z);
        format!("facet normal 0 0 0\nouter loop\n{}{}{}endloop\nendfacet\n", vertex(a), vertex(b), vertex(c))
    };
    let facets: String = tall
        .triangles()
        .iter()
        .map(|corners| facet(corners.map(|at| tall.positions()[at as usize])))
        .collect();
    fs::write(folder.path("inward.stl"), format!("solid\n{facets}endsolid\n")).unwrap();
    let data = data(&page_of(&folder, "inward.stl"));
    assert_eq!(kinds(&data), [("inside_out_shell".to_owned(), 1, 1)]);
    assert_eq!(decoded(&data["kinds"][0]["faces"]), decoded(&data["indices"]), "all twelve");
    // z is up in STL, and y in the view.
    let points = positions(&data["positions"]);
    let largest = |axis: usize| points.iter().map(|point| point[axis]).fold(0.0, f32::max);
    assert!(largest(1) > 4.0 * largest(2), "{points:?}");
}

#[test]
fn check_page_escapes_whatever_a_file_says() {
    let folder = Folder::new();
    let odd = "</script><img src=x onerror=alert(1)>\"'&<!--";
    folder.mesh("a.glb", &shapes::open_cube().with_name(odd));
    let page = page_of(&folder, "a.glb");
    let data = data(&page);
    assert_eq!(data["defects"][0]["mesh"], odd, "read back as it was");
    assert!(!page.contains("<img src=x") && !page.contains("<!--"));
    // The two scripts: data and code.
    assert_eq!((page.matches("<script").count(), page.matches("</script>").count()), (2, 2));
    if cfg!(unix) {
        let name = "b<i>\"'&.obj";
        folder.mesh(name, &shapes::open_cube());
        let page = page_of(&folder, name);
        assert!(page.contains("b&lt;i&gt;&quot;'&amp;.obj") && !page.contains("<i>"));
    }
}

#[test]
fn check_page_lists_and_draws_up_to_a_limit_and_says_so() {
    let folder = Folder::new();
    let triangle = |i: u16| {
        let x = f32::from(i) * 2.0;
        Mesh::new(vec![[x, 0.0, 0.0], [x + 1.0, 0.0, 0.0], [x, 1.0, 0.0]], vec![[0, 1, 2]]).unwrap()
    };
    let many: Vec<Mesh> = (0..7000).map(triangle).collect();
    folder.mesh("many.ply", &Mesh::concat(&many).unwrap());
    let page = page_of(&folder, "many.ply");
    let data = data(&page);
    assert_eq!(kinds(&data), [("boundary_loop".to_owned(), 7000, 500)]);
    // All lines of what is listed, and every second of the others.
    let drawn = 1500 + 19_500 / 2;
    assert_eq!(data["kinds"][0]["lines"]["drawn"], drawn);
    assert_eq!(data["kinds"][0]["lines"]["all"], 21_000);
    assert_eq!(positions(&data["kinds"][0]["lines"]["ends"]).len(), 2 * drawn);
    assert_eq!(data["defects"][499]["view"]["lines"], serde_json::json!([1497, 3]));
    assert_eq!(page.matches("<tr class=\"defect\">").count(), 500);
    for said in [
        "The first 500 are listed; 6,500 more are not.",
        "The view draws 11,250 of 21,000 lines of the kind boundary loop.",
        "The list ends after 500 defects of a kind; check --json --limit N lists more.",
    ] {
        assert!(page.contains(said), "{said}");
    }
    // Below the limits nothing is said.
    folder.mesh("few.ply", &Mesh::concat(&many[..3]).unwrap());
    let page = page_of(&folder, "few.ply");
    assert!(!page.contains("more are not") && !page.contains("The list ends"));
}

#[test]
fn check_page_is_the_same_bytes_for_any_number_of_threads() {
    let folder = Folder::new();
    folder.mesh("a.obj", &shapes::cubes_sharing_edge());
    let pages = ["1", "2", "2"].map(|threads| page_of(&folder, &format!("a.obj --threads {threads}")));
    assert!(pages[0] == pages[1] && pages[1] == pages[2]);
    // Fault injected: one vertex elsewhere is seen.
    folder.mesh("a.obj", &shapes::translated(&shapes::cubes_sharing_edge(), [0.0, 0.0, 1.0]));
    assert!(page_of(&folder, "a.obj") != pages[0]);
}

#[test]
fn check_page_of_a_mesh_at_the_ends_of_the_range_has_finite_numbers() {
    let folder = Folder::new();
    let huge = "v 3e38 3e38 3e38\nv -3e38 -3e38 -3e38\nv 0 3e38 0\nv 1e-45 0 0\nf 1 2 3\nf 2 3 4\n";
    fs::write(folder.path("huge.obj"), huge).unwrap();
    fs::write(folder.path("point.obj"), "v 1 1 1\nv 1 1 1\nv 1 1 1\nf 1 2 3\n").unwrap();
    fs::write(folder.path("empty.stl"), "solid\nendsolid\n").unwrap();
    for file in ["huge.obj", "point.obj --weld none", "empty.stl"] {
        let data = data(&page_of(&folder, &format!("{file} --self-intersections")));
        let points = positions(&data["positions"]);
        assert!(points.iter().flatten().all(|x| x.is_finite()), "{file}");
        for defect in data["defects"].as_array().unwrap() {
            assert!(defect["view"]["reach"].is_number(), "{file}: {defect}");
        }
    }
}

#[test]
fn check_page_is_of_one_file_and_not_written_over_it() {
    let folder = Folder::with_cubes();
    fs::write(folder.path("cube.html"), fs::read(folder.path("cube.obj")).unwrap()).unwrap();
    for (arguments, said) in [
        (
            "check cube.obj open.obj --html a.html",
            "--html writes one file, and there are 2 to check; check one file",
        ),
        ("check cube.obj --html a.png", "--html writes another format; name a file that ends in .html"),
        ("check cube.html --html cube.html", "--html"),
        ("check cube.obj --html no/a.html", "there is no folder no"),
        ("check cube.obj --fast --html a.html", "--html needs more"),
    ] {
        let run = folder.run(arguments);
        assert!(run.code == 2 && run.stderr.contains(said), "{arguments}: {}", run.stderr);
    }
    assert_eq!(folder.code("check missing.obj --html a.html"), 2);
    assert!(!folder.path("a.html").exists());
}
