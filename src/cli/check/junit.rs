//! The crack report as JUnit XML, which build servers show as tests: one suite for a file, one case for a
//! mesh.

use std::path::PathBuf;

use quick_xml::Writer;
use quick_xml::events::{BytesDecl, BytesText, Event};
use umbrage::check::Verdict;

use super::report::{FileReport, MeshReport};
use crate::cli::error::Failure;
use crate::cli::output::{counted, plain};

/// All files, as the bytes of a document.
pub(super) fn document(
    files: &[PathBuf],
    reports: &[Result<FileReport, Failure>],
) -> Result<Vec<u8>, std::io::Error> {
    let mut writer = Writer::new_with_indent(Vec::new(), b' ', 2);
    writer.write_event(Event::Decl(BytesDecl::new("1.0", Some("UTF-8"), None)))?;
    let totals = totals(reports);
    let counts = totals.each_ref().map(String::as_str);
    let root = writer.create_element("testsuites").with_attribute(("name", "umbrage check"));
    let root = NAMES.iter().zip(counts).fold(root, |root, (&name, count)| root.with_attribute((name, count)));
    root.write_inner_content(|writer| {
        for (file, report) in files.iter().zip(reports) {
            suite(writer, &plain(&file.to_string_lossy()), report)?;
        }
        Ok(())
    })?;
    let mut bytes = writer.into_inner();
    bytes.push(b'\n');
    Ok(bytes)
}

/// Attributes of a suite.
const NAMES: [&str; 3] = ["tests", "failures", "errors"];

/// Cases, failures and errors.
fn totals(reports: &[Result<FileReport, Failure>]) -> [String; 3] {
    let sum =
        |of: fn(&Result<FileReport, Failure>) -> usize| reports.iter().map(of).sum::<usize>().to_string();
    [sum(|report| of_file(report)[0]), sum(|report| of_file(report)[1]), sum(|report| of_file(report)[2])]
}

/// The same of one file: a file without meshes is one case.
fn of_file(report: &Result<FileReport, Failure>) -> [usize; 3] {
    match report {
        Err(_) => [1, 0, 1],
        Ok(report) if report.meshes.is_empty() => [1, usize::from(!report.sound()), 0],
        Ok(report) => [report.meshes.len(), report.meshes.iter().filter(|mesh| !mesh.sound()).count(), 0],
    }
}

fn suite(
    writer: &mut Writer<Vec<u8>>,
    file: &str,
    report: &Result<FileReport, Failure>,
) -> Result<(), std::io::Error> {
    let counts = of_file(report).map(|count| count.to_string());
    let element = writer.create_element("testsuite").with_attribute(("name", file));
    let element = NAMES
        .iter()
        .zip(&counts)
        .fold(element, |element, (&name, count)| element.with_attribute((name, count.as_str())));
    element.write_inner_content(|writer| {
        match report {
            Err(failure) => case(writer, file, "file", Some(("error", "unreadable", &failure.to_string())))?,
            Ok(report) if report.meshes.is_empty() => {
                let failure =
                    (!report.sound()).then_some(("failure", "EMPTY", "there are no faces to check"));
                case(writer, file, "file", failure)?;
            }
            Ok(report) => {
                for (index, mesh) in report.meshes.iter().enumerate() {
                    let name = match mesh.name.as_str() {
                        "" => format!("mesh {index}"),
                        name => plain(name),
                    };
                    let (code, text) = (codes(mesh), reasons(report, mesh));
                    let failure = (!mesh.sound()).then_some(("failure", code.as_str(), text.as_str()));
                    case(writer, file, &name, failure)?;
                }
            }
        }
        Ok(())
    })?;
    Ok(())
}

/// A case, with what is wrong: element, type, text.
fn case(
    writer: &mut Writer<Vec<u8>>,
    file: &str,
    name: &str,
    wrong: Option<(&str, &str, &str)>,
) -> Result<(), std::io::Error> {
    let element = writer.create_element("testcase").with_attribute(("classname", file));
    let element = element.with_attribute(("name", name));
    let Some((kind, code, text)) = wrong else {
        element.write_empty()?;
        return Ok(());
    };
    element.write_inner_content(|writer| {
        let first = text.lines().next().unwrap_or_default();
        let failure =
            writer.create_element(kind).with_attribute(("type", code)).with_attribute(("message", first));
        failure.write_text_content(BytesText::new(text))?;
        Ok(())
    })?;
    Ok(())
}

/// The codes of all defects, or the verdict.
fn codes(mesh: &MeshReport) -> String {
    if mesh.verdict == Verdict::Empty {
        return "EMPTY".to_owned();
    }
    let codes: Vec<&str> = mesh.defects.iter().map(|found| found.kind.code()).collect();
    if codes.is_empty() { "NOT_PROVEN".to_owned() } else { codes.join(" ") }
}

/// The verdict, and a line for each defect that is listed.
fn reasons(report: &FileReport, mesh: &MeshReport) -> String {
    let asked: Vec<&str> = report.requirements.iter().map(|asked| asked.name()).collect();
    let mut lines = vec![format!("{}; required: {}", mesh.verdict.name(), asked.join(", "))];
    for found in &mesh.defects {
        let words = found.kind.name().replace('_', " ");
        lines.push(counted(found.count, &words, &format!("{words}s")));
        for at in &found.at {
            let [x, y, z] = at.position;
            let line = at.faces.first().and_then(|face| face.origin.line);
            let line = line.map_or_else(String::new, |line| format!(", line {line}"));
            lines.push(format!("  at {x} {y} {z} ({}{line})", plain(&at.name)));
        }
    }
    lines.join("\n")
}
