use std::fmt::Write as _;
use std::io::{Cursor, Write as _};

use zip::ZipWriter;
use zip::write::SimpleFileOptions;

use crate::check::CrackReport;
use crate::mesh::Mesh;
use crate::read::{Format, ReadError, read_bytes};
use crate::scene::{Scene, Scope};
use crate::testing::shapes;
use crate::topology::Topology;
use crate::view::Up;

const NAMESPACES: &str = r#"xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02"
    xmlns:p="http://schemas.microsoft.com/3dmanufacturing/production/2015/06"
    xmlns:s="http://schemas.microsoft.com/3dmanufacturing/slice/2015/07""#;

/// A package of these parts.
fn package(parts: &[(&str, &str)]) -> Vec<u8> {
    let mut writer = ZipWriter::new(Cursor::new(Vec::new()));
    for (name, text) in parts {
        writer.start_file(*name, SimpleFileOptions::default()).unwrap();
        writer.write_all(text.as_bytes()).unwrap();
    }
    writer.finish().unwrap().into_inner()
}

/// A mesh as an object.
fn object(id: u32, mesh: &Mesh) -> String {
    let mut text = format!("<object id=\"{id}\" name=\"{}\" type=\"model\"><mesh>\n<vertices>", mesh.name);
    for [x, y, z] in mesh.positions() {
        let _ = write!(text, "<vertex x=\"{x}\" y=\"{y}\" z=\"{z}\" />");
    }
    text += "</vertices><triangles>";
    for [a, b, c] in mesh.triangles() {
        let _ = write!(text, "<triangle v1=\"{a}\" v2=\"{b}\" v3=\"{c}\" p1=\"0\" />");
    }
    text + "</triangles></mesh></object>"
}

fn model(resources: &str, build: &str) -> String {
    format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<model unit=\"millimeter\" {NAMESPACES}>\n<resources>\
         <basematerials id=\"9\"><base name=\"a\" displaycolor=\"#FFF\"/></basematerials>{resources}</resources>\
         <build>{build}</build></model>"
    )
}

fn read(parts: &[(&str, &str)]) -> Result<Scene, ReadError> {
    read_bytes(&package(parts), "a.3mf")
}

fn read_model(resources: &str, build: &str) -> Result<Scene, ReadError> {
    read(&[("3D/3dmodel.model", &model(resources, build))])
}

/// Placed meshes: name, faces, and the least corner of the box.
fn placed(scene: Scene) -> Vec<(String, usize, [f32; 3])> {
    let meshes = scene.bake(Scope::Mesh).unwrap();
    meshes.into_iter().map(|mesh| (mesh.name.clone(), mesh.face_count(), mesh.bounds().unwrap()[0])).collect()
}

#[test]
fn threemf_meshes_are_those_that_were_written_where_the_build_has_them() {
    let (cube, ball) = (shapes::cube().with_name("cube"), shapes::icosphere(1).with_name("ball"));
    let resources = object(1, &cube) + &object(7, &ball);
    let build = "<item objectid=\"1\"/><item objectid=\"1\" transform=\"1 0 0 0 1 0 0 0 1 10 20 30\"/>\
                 <item objectid=\"7\" transform=\"-2 0 0 0 2 0 0 0 2 0 0 0\"/>";
    let scene = read_model(&resources, build).unwrap();
    assert_eq!((scene.format, scene.up, scene.notes.len()), (Some(Format::ThreeMf), Up::Z, 0));
    assert_eq!(scene.meshes[0].positions(), cube.positions());
    assert_eq!(scene.meshes[1].triangles(), ball.triangles());
    let mirrored = scene.clone().bake(Scope::Mesh).unwrap().remove(2);
    assert_eq!(
        CrackReport::of(&mirrored, &Topology::of(&mirrored)).counts.inside_out_shells,
        0,
        "turned back"
    );
    let wanted = [
        ("cube".to_owned(), 12, [-1.0; 3]),
        ("cube".to_owned(), 12, [9.0, 19.0, 29.0]),
        ("ball".to_owned(), 80, [-2.0; 3]),
    ];
    assert_eq!(placed(scene), wanted);
}

#[test]
fn threemf_components_are_placed_by_the_transforms_of_all_levels() {
    // A quarter turn about z as rows: x to y; then three along x in the turned space, which is y outside.
    let resources = object(1, &shapes::cube())
        + "<object id=\"2\"><components><component objectid=\"1\" transform=\"1 0 0 0 1 0 0 0 1 3 0 0\"/>\
           <component objectid=\"1\"/></components></object>";
    let build = "<item objectid=\"2\" transform=\"0 1 0 -1 0 0 0 0 1 0 0 100\"/>";
    let found = placed(read_model(&resources, build).unwrap());
    let corners: Vec<[f32; 3]> = found.iter().map(|(_, _, low)| *low).collect();
    assert_eq!(corners, [[-1.0, 2.0, 99.0], [-1.0, -1.0, 99.0]]);
}

#[test]
fn threemf_parts_are_followed_by_path_and_the_first_is_the_one_that_relationships_name() {
    let other = model(&object(5, &shapes::icosphere(0)), "<item objectid=\"5\"/>");
    let root = model(
        "<object id=\"1\"><components><component p:path=\"/3D/Objects/a.model\" objectid=\"5\"/></components></object>",
        "<item objectid=\"1\"/><item p:path=\"/3D/Objects/a.model\" objectid=\"5\"/>",
    );
    let rels = "<Relationships xmlns=\"x\"><Relationship Id=\"r\" Target=\"/main.model\" \
                Type=\"http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel\"/></Relationships>";
    let parts =
        [("3D/Objects/a.model", other.as_str()), ("_rels/.rels", rels), ("main.model", root.as_str())];
    let found = placed(read(&parts).unwrap());
    assert_eq!(found.iter().map(|(_, faces, _)| *faces).collect::<Vec<_>>(), [20, 20]);
    // Without the relationships the other part is the first, and builds itself.
    assert_eq!(placed(read(&[parts[0], parts[2]]).unwrap()).len(), 1);
}

#[test]
fn threemf_that_builds_nothing_has_all_its_meshes_and_says_so() {
    let scene = read_model(&object(1, &shapes::cube()), "").unwrap();
    assert_eq!(scene.notes, ["the file builds nothing: all 1 mesh object placed"]);
    assert_eq!(placed(scene).len(), 1);
    let empty = read_model("", "").unwrap();
    assert!(empty.instances.is_empty() && empty.notes.is_empty());
}

#[test]
fn threemf_that_is_wrong_is_refused_with_its_part_and_byte() {
    let cube = object(1, &shapes::cube());
    let item = "<item objectid=\"1\"/>";
    let deep = "<object id=\"1\"><components><component objectid=\"1\"/></components></object>";
    // Two components on each level: 2⁴⁰ empty objects.
    let mut doubling = "<object id=\"0\"><components/></object>".to_owned();
    for id in 1..=40 {
        let component = format!("<component objectid=\"{}\"/>", id - 1);
        let _ =
            write!(doubling, "<object id=\"{id}\"><components>{component}{component}</components></object>");
    }
    for (resources, build, problem) in [
        (cube.replace("v1=\"0\"", "v1=\"8\""), item, "a triangle names vertex 8, but the mesh has 8"),
        (cube.replacen("x=\"1\"", "x=\"nan\"", 1), item, "the coordinate x `nan` is not a finite number"),
        (cube.replacen("y=\"1\"", "", 1), item, "the coordinate y `` is not a finite number"),
        (cube.replacen("v2=\"1\"", "v2=\"-1\"", 1), item, "v2 `-1` is not an index"),
        (cube.clone() + &cube, item, "there are two objects 1"),
        (cube.clone(), "<item objectid=\"2\"/>", "object 2 is used, but not there"),
        (
            cube.clone(),
            "<item objectid=\"1\" transform=\"1 0 0\"/>",
            "the transform `1 0 0` is not 12 numbers",
        ),
        (cube.replace("</mesh>", ""), item, "the XML is not well-formed"),
        (deep.to_owned(), item, "object 1 is a component of itself"),
        (doubling, "<item objectid=\"40\"/>", "places more than"),
    ] {
        let error = read_model(&resources, build).unwrap_err();
        assert_eq!(error.format, Some(Format::ThreeMf));
        let line = error.to_string();
        assert!(line.contains(problem) && line.contains("part `3D/3dmodel.model`"), "{line}");
    }
}

#[test]
fn threemf_extensions_are_refused_if_they_are_required_and_change_geometry() {
    let text = model(&object(1, &shapes::cube()), "<item objectid=\"1\"/>");
    let requiring = |prefix: &str| text.replace("unit=", &format!("requiredextensions=\"{prefix}\" unit="));
    let read = |text: &str| read(&[("3D/3dmodel.model", text)]);
    assert!(read(&requiring("p")).is_ok());
    let line = read(&requiring("p s")).unwrap_err().to_string();
    assert!(
        line.contains("slice/2015/07") && line.contains("export the file without this extension"),
        "{line}"
    );
    // Not required: its vertices are none of the mesh.
    let slices =
        "</triangles><s:slices><s:vertices><vertex x=\"9\" y=\"9\" z=\"9\"/></s:vertices></s:slices>";
    let scene = read(&text.replace("</triangles>", slices)).unwrap();
    assert_eq!(scene.notes, ["1 extension inside objects of `3D/3dmodel.model` ignored"]);
    assert_eq!(scene.meshes[0].vertex_count(), 8);
}

#[test]
fn threemf_that_is_cut_short_or_damaged_is_an_answer_or_one_line() {
    let whole =
        package(&[("3D/3dmodel.model", &model(&object(1, &shapes::cube()), "<item objectid=\"1\"/>"))]);
    assert!(read_bytes(&whole, "a.3mf").is_ok());
    for at in 0..whole.len() {
        let cut = read_bytes(&whole[..at], "a.3mf").unwrap_err().to_string();
        assert!(cut.lines().count() == 1 && cut.contains("; "), "{cut}");
        let mut damaged = whole.clone();
        damaged[at] ^= 1 << (at % 8);
        if let Err(error) = read_bytes(&damaged, "a.3mf") {
            assert_eq!(error.to_string().lines().count(), 1, "{error}");
        }
    }
}
