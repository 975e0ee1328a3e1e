//! The crack report as JUnit XML, which build servers show as tests: one suite for a file, one case for a
//! mesh.

use quick_xml::Writer;
use quick_xml::events::{BytesDecl, BytesText, Event};
use serde_json::Value;
use umbrage::check::{DefectKind, Verdict};

use super::json::name_of;
use super::text::noun;
use crate::cli::output::plain;

/// All files, as the bytes of a document; of the entries of their JSON.
pub(super) fn document(entries: &[Value]) -> Result<Vec<u8>, std::io::Error> {
    let files: Vec<(String, Vec<Case>)> =
        entries.iter().map(|entry| (file_of(entry), cases(entry))).collect();
    let mut writer = Writer::new_with_indent(Vec::new(), b' ', 2);
    writer.write_event(Event::Decl(BytesDecl::new("1.0", Some("UTF-8"), None)))?;
    let all = totals(files.iter().flat_map(|(_, cases)| cases));
    let root = writer.create_element("testsuites").with_attribute(("name", "umbrage check"));
    let root = all.iter().fold(root, |root, (name, count)| root.with_attribute((*name, count.as_str())));
    root.write_inner_content(|writer| files.iter().try_for_each(|(file, cases)| suite(writer, file, cases)))?;
    let mut bytes = writer.into_inner();
    bytes.push(b'\n');
    Ok(bytes)
}

/// A mesh, or a file that has none, or that could not be read.
struct Case {
    name: String,
    wrong: Option<Wrong>,
}

/// What is wrong with a case.
struct Wrong {
    /// `failure`, or `error` where nothing could be checked.
    element: &'static str,
    code: String,
    text: String,
}

impl Wrong {
    fn failure(code: impl Into<String>, text: impl Into<String>) -> Self {
        Self { element: "failure", code: code.into(), text: text.into() }
    }
}

fn file_of(entry: &Value) -> String {
    plain(entry["file"].as_str().unwrap_or_default())
}

fn list(value: &Value) -> &[Value] {
    value.as_array().map_or(&[], Vec::as_slice)
}

fn is_sound(value: &Value) -> bool {
    value["verdict"] == Verdict::Sound.name()
}

/// A case for each mesh; one for a file without meshes; one more for the poses, if they were asked for.
fn cases(entry: &Value) -> Vec<Case> {
    let meshes = list(&entry["meshes"]);
    let mut cases: Vec<Case> = match (entry["error"].as_str(), meshes) {
        (Some(error), _) => {
            let wrong = Wrong { element: "error", code: "UNREADABLE".to_owned(), text: error.to_owned() };
            vec![Case { name: "file".to_owned(), wrong: Some(wrong) }]
        }
        (None, []) => {
            let empty = || Wrong::failure("EMPTY", "there are no faces to check");
            vec![Case { name: "file".to_owned(), wrong: (!is_sound(entry)).then(empty) }]
        }
        (None, meshes) => {
            let wrong = |mesh| Wrong::failure(codes(mesh), reasons(entry, mesh));
            let case = |(index, mesh)| Case {
                name: name_of(mesh, index),
                wrong: (!is_sound(mesh)).then(|| wrong(mesh)),
            };
            meshes.iter().enumerate().map(case).collect()
        }
    };
    if let Some(frames) = entry.get("frames") {
        let poses = list(&frames["list"]);
        let bad = poses.iter().filter(|pose| !is_sound(pose)).count();
        let kinds: Vec<String> = list(&frames["kinds"])
            .iter()
            .filter_map(|found| Some(kind_of(found)?.code().to_owned()))
            .collect();
        let text = || format!("{bad} of {} poses: {}", poses.len(), kinds.join(" "));
        let wrong = (bad > 0).then(|| Wrong::failure(kinds.join(" "), text()));
        cases.push(Case { name: "all poses".to_owned(), wrong });
    }
    cases
}

/// Cases, failures and errors, as attributes.
fn totals<'a>(cases: impl Iterator<Item = &'a Case>) -> [(&'static str, String); 3] {
    let mut totals = [("tests", 0), ("failures", 0), ("errors", 0)];
    for case in cases {
        totals[0].1 += 1;
        match &case.wrong {
            Some(wrong) if wrong.element == "error" => totals[2].1 += 1,
            Some(_) => totals[1].1 += 1,
            None => {}
        }
    }
    totals.map(|(name, count)| (name, count.to_string()))
}

fn suite(writer: &mut Writer<Vec<u8>>, file: &str, cases: &[Case]) -> Result<(), std::io::Error> {
    let element = writer.create_element("testsuite").with_attribute(("name", file));
    let element = totals(cases.iter())
        .iter()
        .fold(element, |element, (name, count)| element.with_attribute((*name, count.as_str())));
    element.write_inner_content(|writer| cases.iter().try_for_each(|of| case(writer, file, of)))?;
    Ok(())
}

fn case(writer: &mut Writer<Vec<u8>>, file: &str, case: &Case) -> Result<(), std::io::Error> {
    let element = writer.create_element("testcase").with_attribute(("classname", file));
    let element = element.with_attribute(("name", case.name.as_str()));
    let Some(Wrong { element: kind, code, text }) = &case.wrong else {
        element.write_empty()?;
        return Ok(());
    };
    element.write_inner_content(|writer| {
        let first = text.lines().next().unwrap_or_default();
        let failure = writer
            .create_element(*kind)
            .with_attribute(("type", code.as_str()))
            .with_attribute(("message", first));
        failure.write_text_content(BytesText::new(text))?;
        Ok(())
    })?;
    Ok(())
}

fn kind_of(found: &Value) -> Option<DefectKind> {
    DefectKind::ALL.into_iter().find(|kind| found["kind"] == kind.name())
}

/// The codes of all defects, or the verdict.
fn codes(mesh: &Value) -> String {
    if mesh["verdict"] == Verdict::Empty.name() {
        return "EMPTY".to_owned();
    }
    let codes: Vec<&str> = list(&mesh["defects"]).iter().filter_map(|found| found["code"].as_str()).collect();
    if codes.is_empty() { "NOT_PROVEN".to_owned() } else { codes.join(" ") }
}

/// The verdict, and a line for each defect that is listed.
fn reasons(entry: &Value, mesh: &Value) -> String {
    let asked: Vec<&str> =
        list(&entry["requirements"]).iter().filter_map(|asked| asked["name"].as_str()).collect();
    let verdict = mesh["verdict"].as_str().unwrap_or_default();
    let mut lines = vec![format!("{verdict}; required: {}", asked.join(", "))];
    for found in list(&mesh["defects"]) {
        let Some(kind) = kind_of(found) else { continue };
        let (least, count) = match found["count"].as_u64() {
            Some(count) => ("", count),
            None => ("at least ", found["at_least"].as_u64().unwrap_or(0)),
        };
        lines.push(format!("{least}{count} {}", noun(kind, usize::try_from(count).unwrap_or(usize::MAX))));
        for at in list(&found["at"]) {
            let position: Vec<String> =
                list(&at["position"]).iter().filter_map(Value::as_f64).map(|x| x.to_string()).collect();
            let line = at["origins"][0]["line"].as_u64();
            let line = line.map_or_else(String::new, |line| format!(", line {line}"));
            let name = plain(at["name"].as_str().unwrap_or_default());
            lines.push(format!("  at {} ({name}{line})", position.join(" ")));
        }
    }
    lines.join("\n")
}
