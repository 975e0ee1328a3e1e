//! The JSON of `umbrage check` against its schema, `data/check.schema.json`.

use std::fs;
use std::path::Path;

use serde_json::{Value, json};
use umbrage::check::{DefectKind, Requirement};
use umbrage::testing::shapes;

use super::{Folder, real};

fn schema() -> Value {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/check.schema.json");
    serde_json::from_slice(&fs::read(path).unwrap()).unwrap()
}

/// What is wrong with a value by a schema, if anything: place and reason.
///
/// The part of JSON Schema, draft 2020-12, that the file uses; another keyword is a panic, so that none is
/// overlooked.
fn wrong(root: &Value, schema: &Value, value: &Value, at: &str) -> Option<String> {
    let is_a = |name: &Value| match name.as_str().unwrap() {
        "null" => value.is_null(),
        "boolean" => value.is_boolean(),
        "string" => value.is_string(),
        "array" => value.is_array(),
        "object" => value.is_object(),
        "number" => value.is_number(),
        "integer" => value.is_i64() || value.is_u64(),
        other => panic!("unknown type {other}"),
    };
    for (keyword, asked) in schema.as_object().unwrap() {
        let holds = match keyword.as_str() {
            "$schema" | "$defs" | "title" | "description" | "required" => true,
            "type" => asked.as_array().map_or_else(|| is_a(asked), |names| names.iter().any(is_a)),
            "const" => value == asked,
            "enum" => asked.as_array().unwrap().contains(value),
            "minimum" => value.as_f64().is_none_or(|x| x >= asked.as_f64().unwrap()),
            "minItems" => value.as_array().is_none_or(|items| items.len() as u64 >= asked.as_u64().unwrap()),
            "maxItems" => value.as_array().is_none_or(|items| items.len() as u64 <= asked.as_u64().unwrap()),
            "anyOf" => {
                let all = asked.as_array().unwrap().iter();
                let reasons: Option<Vec<String>> = all.map(|one| wrong(root, one, value, at)).collect();
                match reasons {
                    Some(reasons) => return Some(reasons.join("; or ")),
                    None => true,
                }
            }
            "$ref" => {
                let name = asked.as_str().unwrap().strip_prefix("#/$defs/").unwrap();
                let found = wrong(root, &root["$defs"][name], value, at);
                if found.is_some() {
                    return found;
                }
                true
            }
            "items" => {
                let mut items = value.as_array().into_iter().flatten().enumerate();
                let found = items.find_map(|(i, item)| wrong(root, asked, item, &format!("{at}/{i}")));
                if found.is_some() {
                    return found;
                }
                true
            }
            "properties" => {
                let Some(object) = value.as_object() else { continue };
                let asked = asked.as_object().unwrap();
                let found = object
                    .iter()
                    .find_map(|(key, value)| wrong(root, asked.get(key)?, value, &format!("{at}/{key}")));
                let required = schema["required"].as_array().unwrap();
                let missing = required.iter().find(|key| !object.contains_key(key.as_str().unwrap()));
                if let Some(reason) = found.or_else(|| missing.map(|key| format!("{at}: no {key}"))) {
                    return Some(reason);
                }
                true
            }
            "additionalProperties" => {
                assert_eq!(asked, false);
                let Some(object) = value.as_object() else { continue };
                object.keys().all(|key| schema["properties"].get(key).is_some())
            }
            other => panic!("unknown keyword {other}"),
        };
        if !holds {
            return Some(format!("{at}: not {keyword} {asked}"));
        }
    }
    None
}

/// Panics where a document is not as the schema says.
pub(super) fn require(document: &Value) {
    let schema = schema();
    assert_eq!(wrong(&schema, &schema, document, ""), None);
}

#[test]
fn schema_describes_every_kind_of_report() {
    let schema = schema();
    let folder = Folder::with_cubes();
    for (name, mesh) in [
        ("inward.obj", shapes::inside_out(&shapes::cube())),
        ("edge.obj", shapes::cubes_sharing_edge()),
        ("vertex.obj", shapes::cubes_sharing_vertex()),
        ("turned.obj", shapes::misoriented_cube()),
        ("seam.obj", shapes::seam(4)),
        ("named.glb", shapes::open_cube().with_name("a\"b")),
    ] {
        folder.mesh(name, &mesh);
    }
    fs::write(folder.path("empty.stl"), "solid\nendsolid\n").unwrap();
    fs::write(
        folder.path("crossed.obj"),
        "v -1 -1 0\nv 1 -1 0\nv 0 1 0\nv 0 0 -1\nv 0 0 1\nv 0 2 0\nf 1 2 3\nf 4 5 6\n",
    )
    .unwrap();
    let files = "cube.obj open.obj garbled.stl missing.obj inward.obj edge.obj vertex.obj turned.obj seam.obj \
                 named.glb empty.stl crossed.obj";
    let options = [
        "",
        "--self-intersections",
        "--weld none --scope scene --limit 0",
        "--require even,manifold",
        "--fast",
    ];
    let mut kinds = Vec::new();
    for option in options {
        let arguments = format!("check {files} {option} --json");
        let run = folder.run(&arguments.split_whitespace().collect::<Vec<_>>().join(" "));
        let document: Value = serde_json::from_str(&run.stdout).unwrap();
        assert_eq!(wrong(&schema, &schema, &document, ""), None, "{option}");
        let meshes =
            document["files"].as_array().unwrap().iter().flat_map(|file| file["meshes"].as_array().unwrap());
        let defects = meshes.flat_map(|mesh| mesh["defects"].as_array().cloned().unwrap_or_default());
        kinds.extend(defects.map(|defect| defect["kind"].as_str().unwrap().to_owned()));
    }
    for kind in
        ["boundary_loop", "non_manifold_edge", "misoriented_edge", "inside_out_shell", "self_intersection"]
    {
        assert!(kinds.iter().any(|found| found == kind), "{kind} was among them");
    }
    let lines =
        folder.run(&format!("check {} --json-lines", files.split_whitespace().collect::<Vec<_>>().join(" ")));
    assert_eq!(lines.stdout.lines().count(), 12);
    for line in lines.stdout.lines() {
        assert_eq!(wrong(&schema, &schema, &serde_json::from_str(line).unwrap(), ""), None, "{line}");
    }
    if let Some(file) = real("openscad_nonmanifold.obj") {
        let document = folder.json(&format!("check {} --self-intersections", file.display()));
        assert_eq!(wrong(&schema, &schema, &document, ""), None);
    }
}

#[test]
fn schema_names_what_the_library_names() {
    let schema = schema();
    let defect = &schema["$defs"]["defect"]["properties"]["kind"]["enum"];
    assert_eq!(*defect, json!(DefectKind::ALL.map(DefectKind::name)));
    let requirement =
        &schema["$defs"]["file"]["properties"]["requirements"]["items"]["properties"]["name"]["enum"];
    assert_eq!(*requirement, json!(Requirement::ALL.map(Requirement::name)));
}

#[test]
fn schema_refuses_documents_that_differ_in_one_place() {
    let schema = schema();
    let folder = Folder::with_cubes();
    let document = folder.json("check open.obj");
    assert_eq!(wrong(&schema, &schema, &document, ""), None);
    type Spoil = fn(&mut Value);
    let faults: [(&str, Spoil); 9] = [
        ("version", |document| document["version"] = 2.into()),
        ("verdict", |document| document["verdict"] = "fine".into()),
        ("additionalProperties", |document| document["more"] = 1.into()),
        ("no \"error\"", |document| {
            document["files"][0].as_object_mut().unwrap().remove("error");
        }),
        ("faces", |document| document["files"][0]["meshes"][0]["faces"] = (-1).into()),
        ("edges", |document| document["files"][0]["meshes"][0]["edges"] = 1.5.into()),
        ("kind", |document| document["files"][0]["meshes"][0]["defects"][0]["kind"] = "hole".into()),
        ("position", |document| {
            document["files"][0]["meshes"][0]["defects"][0]["at"][0]["position"] = json!([1, 2]);
        }),
        ("files", |document| document["files"] = json!({})),
    ];
    for (said, spoil) in faults {
        let mut document = document.clone();
        spoil(&mut document);
        let reason = wrong(&schema, &schema, &document, "").unwrap_or_else(|| panic!("{said} was let pass"));
        assert!(reason.contains(said), "{said}: {reason}");
    }
}

#[test]
fn check_baseline_of_another_version_is_refused() {
    let folder = Folder::with_cubes();
    let text = folder.run("check open.obj --json").stdout;
    fs::write(folder.path("now.json"), &text).unwrap();
    assert_eq!(folder.code("check open.obj --baseline now.json"), 0);
    // The first reports had none.
    fs::write(folder.path("old.json"), text.replacen("  \"version\": 1,\n", "", 1)).unwrap();
    assert_eq!(folder.code("check open.obj --baseline old.json"), 0);
    fs::write(folder.path("new.json"), text.replacen("\"version\": 1,", "\"version\": 2,", 1)).unwrap();
    let run = folder.run("check open.obj --baseline new.json");
    assert!(run.code == 2 && run.stderr.contains("version 2"), "{}", run.stderr);
}
