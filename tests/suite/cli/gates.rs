//! `umbrage check` in pipelines: one line a file, JSON Lines, JUnit, SARIF, comparison with an earlier report.

use std::fs;

use serde_json::Value;
use umbrage::mesh::Mesh;
use umbrage::testing::shapes;
use umbrage::write::{Layer, Model, write};

use super::Folder;

/// A folder with a closed cube, an open one, and a file that is no mesh.
const FILES: &str = "cube.obj open.obj garbled.stl";

#[test]
fn check_summary_lines_and_quiet_say_what_the_report_says() {
    let folder = Folder::with_cubes();
    let summary = folder.run(&format!("check {FILES} --summary"));
    assert_eq!(summary.code, 2);
    assert_eq!(
        summary.stdout.lines().collect::<Vec<_>>(),
        ["sound: cube.obj", "cracked: open.obj: 1 boundary loop", "error: garbled.stl"]
    );
    let quiet = folder.run(&format!("check {FILES} --quiet"));
    assert_eq!((quiet.code, quiet.stdout.as_str()), (2, ""));
    assert!(quiet.stderr.contains("garbled.stl"), "{}", quiet.stderr);
    let lines = folder.run(&format!("check {FILES} --json-lines"));
    let whole: Value = serde_json::from_str(&folder.run(&format!("check {FILES} --json")).stdout).unwrap();
    let entry = |line| {
        let mut entry: Value = serde_json::from_str(line).unwrap();
        assert_eq!(entry.as_object_mut().unwrap().shift_remove("version"), Some(1.into()));
        entry
    };
    let each: Vec<Value> = lines.stdout.lines().map(entry).collect();
    assert_eq!(Value::Array(each), whole["files"]);
    assert_eq!(folder.code("check cube.obj --json --summary"), 2, "one form of output at a time");
}

#[test]
fn check_colors_the_words_of_verdicts_and_nothing_else() {
    let folder = Folder::with_cubes();
    folder.mesh("hollow.obj", &shapes::inside_out(&shapes::cube()));
    fs::write(folder.path("empty.obj"), "v 0 0 0\n").unwrap();
    fs::write(folder.path("collapsed.obj"), "v 0 0 0\nf 1 1 1\n").unwrap();
    let without = |text: &str| {
        let mut parts = text.split('\x1b');
        let first = parts.next().unwrap().to_owned();
        first + &parts.map(|part| part.split_once('m').unwrap().1).collect::<String>()
    };
    let files = "cube.obj open.obj garbled.stl hollow.obj empty.obj collapsed.obj";
    for (form, words) in
        [("", 4 * 2 + 2 + 6), (" --summary", 6), (" --fast", 5), (" --json", 0), (" --json-lines", 0)]
    {
        let [plain, always, never] = ["", " --color always", " --color never"]
            .map(|color| folder.run(&format!("check {files}{form}{color}")));
        // Not a terminal: as without colors.
        assert_eq!(plain.stdout, never.stdout, "{form}");
        assert!(!plain.stdout.contains('\x1b'), "{form}");
        assert_eq!(without(&always.stdout), plain.stdout, "{form}: the same text, aligned alike");
        assert_eq!(always.stdout.matches("\x1b[0m").count(), words, "{form}: {}", always.stdout);
        assert_eq!((plain.code, always.code), (2, 2));
    }
    let colored = folder.run("check cube.obj open.obj garbled.stl --summary --color always").stdout;
    let lines: Vec<&str> = colored.lines().collect();
    assert_eq!(lines[0], "\x1b[32msound\x1b[0m: cube.obj");
    assert_eq!(lines[1], "\x1b[31mcracked\x1b[0m: open.obj: 1 boundary loop");
    assert_eq!(lines[2], "\x1b[31merror\x1b[0m: garbled.stl");
    assert_eq!(folder.code("check cube.obj --color sometimes"), 2);
}

/// On a terminal that `script` makes.
#[cfg(target_os = "linux")]
#[test]
fn check_on_a_terminal_is_colored_unless_the_environment_says_no() {
    let folder = Folder::with_cubes();
    if std::process::Command::new("script").arg("--version").output().is_err() {
        crate::support::skipped("no `script`, which makes a terminal");
        return;
    }
    let command = format!("{} check cube.obj --summary", assert_cmd::cargo::cargo_bin!("umbrage").display());
    for (environment, colored) in [
        ([("TERM", "xterm"), ("NO_COLOR", "")], true),
        ([("TERM", "xterm"), ("NO_COLOR", "1")], false),
        ([("TERM", "dumb"), ("NO_COLOR", "")], false),
    ] {
        let mut script = std::process::Command::new("script");
        script.args(["-qec", &command, "/dev/null"]).current_dir(folder.path("."));
        let output = script.envs(environment).output().unwrap();
        let text = String::from_utf8(output.stdout).unwrap();
        assert!(text.contains("cube.obj"), "{text}");
        assert_eq!(text.contains("\x1b[32msound\x1b[0m"), colored, "{environment:?}: {text}");
    }
}

#[test]
fn check_tables_fit_eighty_columns() {
    let folder = Folder::new();
    let name = "a name that is far too long for a table, as those of scanned parts are, part 17";
    let pieces = [("one", 0.0), (name, 1e7)].map(|(name, x)| {
        Layer::from(&shapes::translated(&shapes::icosphere(5), [x, 0.0, 0.0]).with_name(name))
    });
    write(&Model { layers: pieces.to_vec() }, folder.path("two.glb")).unwrap();
    let run = folder.run("check two.glb two.glb");
    // Names are cut in the middle, so that those that end differently do.
    assert!(run.stdout.contains("a name that…are, part 17"), "{}", run.stdout);
    for line in run.stdout.lines().filter(|line| !line.contains("two.glb")) {
        let is_prose = line.contains(": ") || line.contains("not proven") || line.starts_with("    at ");
        assert!(is_prose || line.chars().count() <= 80, "{line}");
    }
    assert!(run.stdout.contains("  mesh  ") && run.stdout.matches("oriented").count() == 3, "{}", run.stdout);
}

/// Elements of an XML document with their attributes, and the text of all; panics if it is not well-formed.
fn elements(text: &str) -> Vec<(String, Vec<(String, String)>)> {
    let mut reader = quick_xml::Reader::from_str(text);
    reader.config_mut().check_end_names = true;
    let mut found = Vec::new();
    loop {
        match reader.read_event().unwrap() {
            quick_xml::events::Event::Eof => return found,
            quick_xml::events::Event::Start(element) | quick_xml::events::Event::Empty(element) => {
                let name = element.name().as_ref().to_owned();
                let attributes = element.attributes().map(|attribute| {
                    let attribute = attribute.unwrap();
                    let key = attribute.key.as_ref().to_owned();
                    (key, attribute.value.into_owned())
                });
                found.push((name, attributes.collect()));
            }
            _ => {}
        }
    }
}

#[test]
fn check_junit_has_a_suite_a_file_and_a_case_a_mesh() {
    let folder = Folder::with_cubes();
    // A name that XML cannot hold as it is.
    let odd = shapes::open_cube().with_name("a<b&\"c\"");
    folder.mesh("odd.glb", &odd);
    let run = folder.run(&format!("check {FILES} odd.glb --junit out.xml"));
    assert_eq!(run.code, 2);
    let text = fs::read_to_string(folder.path("out.xml")).unwrap();
    let elements = elements(&text);
    let named = |name: &str| elements.iter().filter(|element| element.0 == name).collect::<Vec<_>>();
    let attribute = |element: &(String, Vec<(String, String)>), key: &str| {
        element.1.iter().find(|of| of.0 == key).map(|of| of.1.clone()).unwrap_or_default()
    };
    let root = named("testsuites")[0];
    let counts = ["tests", "failures", "errors"].map(|key| attribute(root, key));
    assert_eq!(counts, ["4", "2", "1"]);
    assert_eq!(named("testsuite").len(), 4);
    assert_eq!((named("testcase").len(), named("failure").len(), named("error").len()), (4, 2, 1));
    assert_eq!(attribute(named("failure")[0], "type"), "BOUNDARY_LOOP");
    assert!(text.contains("a&lt;b&amp;") && !text.contains("a<b"), "{text}");
    assert!(text.contains("1 boundary loop"), "{text}");
    // A kind of defect in the plural, and poses.
    let bow_ties = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv -1 0 0\nv 0 -1 0\nv 0 0 -1\nv 2 0 1\nv 2 1 0\n\
                    v 3 0 0\nv 3 1 1\nf 1 2 3\nf 1 5 6\nf 2 8 9\n";
    fs::write(folder.path("ties.obj"), bow_ties).unwrap();
    folder.run("check ties.obj --junit ties.xml");
    let ties = fs::read_to_string(folder.path("ties.xml")).unwrap();
    assert!(ties.contains("2 non manifold vertices") && !ties.contains("vertexs"), "{ties}");
    // Never over an input.
    let refused = folder.run("check cube.obj --junit cube.obj");
    assert_eq!(refused.code, 2, "{}", refused.stdout);
    assert_eq!(folder.code("check cube.obj --junit nowhere/out.xml"), 2);
}

#[test]
fn check_sarif_has_a_result_for_each_defect_with_its_line() {
    let folder = Folder::with_cubes();
    fs::copy(folder.path("open.obj"), folder.path("my file.obj")).unwrap();
    let mut command = folder.command("check open.obj --sarif out.sarif");
    command.arg("my file.obj").arg("garbled.stl");
    assert_eq!(command.output().unwrap().status.code(), Some(2));
    let document: Value =
        serde_json::from_str(&fs::read_to_string(folder.path("out.sarif")).unwrap()).unwrap();
    assert_eq!(document["version"], "2.1.0");
    let run = &document["runs"][0];
    let results = run["results"].as_array().unwrap();
    assert_eq!(results.len(), 2);
    let rules = run["tool"]["driver"]["rules"].as_array().unwrap();
    for result in results {
        assert_eq!((&result["ruleId"], &result["level"]), (&"BOUNDARY_LOOP".into(), &"error".into()));
        assert!(rules.iter().any(|rule| rule["id"] == result["ruleId"]), "every result has its rule");
        let line = result["locations"][0]["physicalLocation"]["region"]["startLine"].as_u64().unwrap();
        // The line of the file that the first polygon at the hole is written in.
        let text = fs::read_to_string(folder.path("open.obj")).unwrap();
        assert!(text.lines().nth(line as usize - 1).unwrap().starts_with("f "), "{line}");
    }
    let uri = &results[1]["locations"][0]["physicalLocation"]["artifactLocation"]["uri"];
    assert_eq!(uri, "my%20file.obj");
    let unread = &run["invocations"][0];
    assert_eq!(unread["executionSuccessful"], false);
    assert!(unread["toolExecutionNotifications"][0]["message"]["text"].as_str().unwrap().contains("garbled"));
}

#[test]
fn check_against_an_earlier_report_fails_on_what_is_new_alone() {
    let folder = Folder::with_cubes();
    let save = |file: &str, name: &str| {
        let run = folder.run(&format!("check {file} --json"));
        fs::write(folder.path(name), run.stdout).unwrap();
    };
    save("open.obj", "open.json");
    save("cube.obj", "cube.json");
    save("open.obj cube.obj", "both.json");
    // The same defects are old, whatever the file is called, where there is one.
    assert_eq!(folder.code("check open.obj --baseline open.json"), 0);
    folder.mesh("again.obj", &shapes::open_cube());
    assert_eq!(folder.code("check again.obj --baseline open.json"), 0);
    assert_eq!(folder.code("check open.obj cube.obj --baseline both.json"), 0);
    // New ones are named.
    let new = folder.run("check open.obj --baseline cube.json");
    assert_eq!(new.code, 1);
    assert!(
        new.stderr.contains("new: open.obj: BOUNDARY_LOOP: 1 boundary loop (0 before)"),
        "{}",
        new.stderr
    );
    let two = Mesh::concat(&[shapes::open_cube(), shapes::translated(&shapes::open_cube(), [5.0, 0.0, 0.0])]);
    folder.mesh("two.obj", &two.unwrap());
    let more = folder.run("check two.obj --baseline open.json");
    assert!(more.code == 1 && more.stderr.contains("2 boundary loops (1 before)"), "{}", more.stderr);
    // Fewer are no failure; a file that was not there before has only new defects.
    assert_eq!(folder.code("check cube.obj --baseline open.json"), 0);
    assert_eq!(folder.code("check two.obj cube.obj --baseline both.json"), 1);
    // What is no report is refused.
    fs::write(folder.path("other.json"), "{\"a\": 1}").unwrap();
    for (file, word) in
        [("other.json", "no report"), ("cube.obj", "no JSON"), ("missing.json", "cannot be read")]
    {
        let run = folder.run(&format!("check cube.obj --baseline {file}"));
        assert!(run.code == 2 && run.stderr.contains(word), "{}", run.stderr);
    }
}

#[test]
fn completions_and_manual_pages_know_every_command_and_option() {
    let folder = Folder::new();
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        let script = folder.run(&format!("completions {shell}"));
        assert_eq!(script.code, 0, "{}", script.stderr);
        for word in ["check", "volume", "baseline", "no-such-option"] {
            assert_eq!(script.stdout.contains(word), word != "no-such-option", "{shell} {word}");
        }
    }
    assert_eq!(folder.code("completions tcsh"), 2);
    assert_eq!(folder.code("man pages"), 0);
    let page = |name: &str| fs::read_to_string(folder.path(&format!("pages/{name}.1"))).unwrap();
    assert!(page("umbrage").contains(".TH umbrage 1"));
    assert!(page("umbrage-check").contains("\\-\\-baseline") && !page("umbrage-check").contains("no\\-such"));
}
