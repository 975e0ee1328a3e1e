//! Many small files in one run: the numbers are those of what was put into each.

use std::collections::BTreeMap;
use std::fs;

use serde_json::Value;
use umbrage::testing::corpus::{Specimen, specimen};

use super::Folder;

/// A folder with the first files of the corpus.
fn folder(count: u32) -> (Folder, BTreeMap<String, Specimen>) {
    let folder = Folder::new();
    fs::create_dir(folder.path("files")).unwrap();
    let files = (0..count).map(specimen).map(|file| (file.name.clone(), file)).collect::<BTreeMap<_, _>>();
    for (name, file) in &files {
        fs::write(folder.path("files").join(name), &file.bytes).unwrap();
    }
    (folder, files)
}

/// What one run of `check` says otherwise than it should: file, name, number found, number put in.
fn differing(
    folder: &Folder,
    files: &BTreeMap<String, Specimen>,
) -> Vec<(String, &'static str, Value, usize)> {
    let run = folder.run("check files --json-lines --limit 0");
    assert!(run.code < 2, "{}", run.stderr);
    let mut differing = Vec::new();
    let mut lines = 0;
    for line in run.stdout.lines() {
        let report: Value = serde_json::from_str(line).unwrap();
        let name = report["file"].as_str().unwrap().rsplit(['/', '\\']).next().unwrap().to_owned();
        for (number, expected) in files[&name].numbers.entries() {
            let found = &report["total"][number];
            if *found != expected {
                differing.push((name.clone(), number, found.clone(), expected));
            }
        }
        lines += 1;
    }
    assert_eq!(lines, files.len(), "a line for each file");
    differing
}

fn holds(count: u32) {
    let (folder, mut files) = folder(count);
    assert_eq!(differing(&folder, &files), []);
    // Not vacuous: every kind of defect is there, many times.
    let sum = |number: usize| files.values().map(|file| file.numbers.entries()[number].1).sum::<usize>();
    for number in 0..10 {
        assert!(sum(number) as u32 > count / 20, "{}", files["0000.obj"].numbers.entries()[number].0);
    }
    // Fault injected: in one file the last face is left out, in another the list is wrong.
    let [text, listed] = ["0006.off", "0009.glb"];
    let off = String::from_utf8(files[text].bytes.clone()).unwrap();
    let mut lines: Vec<&str> = off.lines().collect();
    lines.pop();
    let header: Vec<usize> = lines[1].split(' ').map(|number| number.parse().unwrap()).collect();
    let header = format!("{} {} 0", header[0], header[1] - 1);
    lines[1] = &header;
    fs::write(folder.path("files").join(text), lines.join("\n") + "\n").unwrap();
    files.get_mut(listed).unwrap().numbers.misoriented_edges += 1;
    let mut caught: Vec<String> = differing(&folder, &files).into_iter().map(|(name, ..)| name).collect();
    caught.sort();
    caught.dedup();
    assert_eq!(caught, [text, listed]);
}

#[test]
fn corpus_of_many_files_has_the_defects_that_were_put_in() {
    holds(160);
}

#[test]
#[ignore = "a thousand files; `benches/corpus.py` also measures them"]
fn corpus_of_a_thousand_files_has_the_defects_that_were_put_in() {
    holds(1000);
}
