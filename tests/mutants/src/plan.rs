//! The parts, their files, and the numbered mutants of all of them.

use std::cmp::Reverse;
use std::collections::{HashMap, HashSet};
use std::fs;
use std::path::{Path, PathBuf};

use crate::points::{self, Form, Point};

/// A part of the code, as `parts.txt` lists it.
pub struct Part {
    pub name: String,
    /// Files, and folders with all that is in them; relative to the tree.
    pub files: Vec<String>,
    /// Beginnings of the paths of the tests that judge it.
    pub tests: Vec<String>,
}

/// A mutant: one change at one place, or at all uses of a constant.
pub struct Mutant {
    pub part: usize,
    pub file: String,
    pub line: usize,
    pub column: usize,
    pub name: String,
    /// The first mutant of its point: what a trace marks.
    pub first: u32,
    /// A hash of the file that it changes.
    pub hash: u64,
}

impl Mutant {
    /// What tells it from all others, as long as its file is as it is.
    pub fn key(&self) -> String {
        format!("{}:{}:{}: {}", self.file, self.line, self.column, self.name)
    }
}

/// A place to rewrite: the mutants `first..` stand there.
pub struct Place {
    pub first: u32,
    pub point: Point,
}

/// All mutants, and the places of each file.
pub struct Plan {
    pub parts: Vec<Part>,
    pub mutants: Vec<Mutant>,
    pub files: Vec<(String, Vec<Place>)>,
}

/// The parts in a file: `NAME | FILE… | TEST…` a line.
pub fn parts(path: &Path) -> Result<Vec<Part>, String> {
    let text = read(path)?;
    let words = |text: &str| text.split_whitespace().map(str::to_owned).collect::<Vec<_>>();
    lines(&text)
        .map(|line| match line.split('|').collect::<Vec<_>>()[..] {
            [name, files, tests] => {
                Ok(Part { name: name.trim().to_owned(), files: words(files), tests: words(tests) })
            }
            _ => Err(format!("{}: not NAME | FILES | TESTS: {line}", path.display())),
        })
        .collect()
}

/// Lines that are neither empty nor a comment.
pub fn lines(text: &str) -> impl Iterator<Item = &str> {
    text.lines().map(str::trim).filter(|line| !line.is_empty() && !line.starts_with('#'))
}

pub fn read(path: &Path) -> Result<String, String> {
    fs::read_to_string(path).map_err(|error| format!("{}: {error}", path.display()))
}

/// FNV-1a.
pub fn hash(bytes: &[u8]) -> u64 {
    bytes
        .iter()
        .fold(0xcbf2_9ce4_8422_2325, |hash, &byte| (hash ^ u64::from(byte)).wrapping_mul(0x100_0000_01b3))
}

/// Rust files under a path, in order.
fn rust_files(path: &Path, into: &mut Vec<PathBuf>) -> Result<(), String> {
    if path.is_file() {
        into.push(path.to_owned());
        return Ok(());
    }
    let entries = fs::read_dir(path).map_err(|error| format!("{}: {error}", path.display()))?;
    let mut entries = entries
        .map(|entry| entry.map(|entry| entry.path()))
        .collect::<Result<Vec<_>, _>>()
        .map_err(|error| error.to_string())?;
    entries.sort();
    for entry in entries {
        if entry.is_dir() || entry.extension().is_some_and(|end| end == "rs") {
            rust_files(&entry, into)?;
        }
    }
    Ok(())
}

/// Tests and what they inject, and what the tested build leaves out.
fn is_left_out(path: &str) -> bool {
    path.split('/').any(|step| {
        let step = step.trim_end_matches(".rs");
        matches!(step, "tests" | "test_support" | "fault" | "gpu" | "tiled") || step.ends_with("_tests")
    })
}

/// Named mutants: `FILE: EXPRESSION => EXPRESSION` a line, by file.
fn named(path: &Path) -> Result<HashMap<String, Vec<(String, String)>>, String> {
    let mut all: HashMap<String, Vec<_>> = HashMap::new();
    if !path.exists() {
        return Ok(all);
    }
    for line in lines(&read(path)?) {
        let parsed = line.split_once(": ").and_then(|(file, rest)| Some((file, rest.split_once(" => ")?)));
        let (file, (from, to)) = parsed
            .ok_or_else(|| format!("{}: not FILE: EXPRESSION => EXPRESSION: {line}", path.display()))?;
        all.entry(file.to_owned()).or_default().push((from.to_owned(), to.to_owned()));
    }
    Ok(all)
}

/// The mutants of `parts` in the tree `root`. `folder` holds the list of named ones.
pub fn make(root: &Path, folder: &Path, parts: Vec<Part>) -> Result<Plan, String> {
    let named = named(&folder.join("named.txt"))?;
    let mut found = Vec::new();
    let mut known = HashSet::new();
    for (number, part) in parts.iter().enumerate() {
        for file in &part.files {
            let mut paths = Vec::new();
            rust_files(&root.join(file), &mut paths)?;
            for path in paths {
                let file = path.strip_prefix(root).map_err(|error| error.to_string())?;
                let file = file.to_string_lossy().replace('\\', "/");
                if is_left_out(&file) || !known.insert(file.clone()) {
                    continue;
                }
                let source = read(&path)?;
                let named = named.get(&file).map_or(&[][..], |named| named);
                let one = points::find(&source, named).map_err(|error| format!("{file}: {error}"))?;
                if let Some(missing) = one.named.iter().position(|&count| count == 0) {
                    return Err(format!("{file}: named.txt names what is not there: {}", named[missing].0));
                }
                found.push((number, file, hash(source.as_bytes()), one));
            }
        }
    }
    // Which file a constant is of: the one that uses it, else the only one that has one of that name.
    let mut owners: HashMap<&str, Vec<usize>> = HashMap::new();
    for (index, (.., one)) in found.iter().enumerate() {
        for constant in &one.constants {
            owners.entry(&constant.name).or_default().push(index);
        }
    }
    let owner = |user: usize, name: &str| match owners.get(name)?[..] {
        [only] => Some(only),
        ref several => several.contains(&user).then_some(user),
    };
    let mut mutants: Vec<Mutant> = Vec::new();
    let mut numbers = HashMap::new();
    for (index, (part, file, hash, one)) in found.iter().enumerate() {
        for constant in &one.constants {
            let used = found.iter().enumerate().any(|(user, (.., other))| {
                other.uses.iter().any(|(name, _)| *name == constant.name && owner(user, name) == Some(index))
            });
            if !used {
                continue;
            }
            let first = mutants.len() as u32;
            numbers.insert((index, constant.name.clone()), (first, constant.changes.clone()));
            mutants.extend(constant.changes.iter().map(|change| Mutant {
                part: *part,
                file: file.clone(),
                line: constant.line,
                column: constant.column,
                name: change.name.clone(),
                first,
                hash: *hash,
            }));
        }
    }
    let places = |user: usize, one: &points::Found| -> Vec<(u32, String, Vec<points::Change>)> {
        let of = |name: &String| owner(user, name).and_then(|index| numbers.get(&(index, name.clone())));
        one.uses
            .iter()
            .map(|(name, _)| {
                of(name).map_or((0, name.clone(), Vec::new()), |(first, changes)| {
                    (*first, name.clone(), changes.clone())
                })
            })
            .collect()
    };
    let uses = found.iter().enumerate().map(|(user, (.., one))| places(user, one)).collect::<Vec<_>>();
    let mut files = Vec::new();
    for ((part, file, hash, one), uses) in found.into_iter().zip(uses) {
        let source = read(&root.join(&file))?;
        let mut all = Vec::new();
        for point in one.points {
            let first = mutants.len() as u32;
            let within =
                if point.function.is_empty() { String::new() } else { format!("{}: ", point.function) };
            mutants.extend(point.changes.iter().map(|change| Mutant {
                part,
                file: file.clone(),
                line: point.line,
                column: point.column,
                name: format!("{within}{}", change.name),
                first,
                hash,
            }));
            all.push(Place { first, point });
        }
        for ((_, mut point), (first, _, changes)) in one.uses.into_iter().zip(uses) {
            let text = source[point.at.clone()].to_owned();
            point.changes = changes;
            for change in &mut point.changes {
                change.text = change.text.replace('@', &text);
            }
            if !point.changes.is_empty() {
                all.push(Place { first, point });
            }
        }
        files.push((file, all));
    }
    // The trace has a place for each.
    if mutants.len() > 1 << 16 {
        return Err(format!("{} mutants are more than 65536: run fewer parts at a time", mutants.len()));
    }
    Ok(Plan { parts, mutants, files })
}

/// The text of a file with the mutants of `places` that are not in `given_up`, and which bytes of it are there
/// because of which.
pub fn rewrite(source: &str, places: &[Place], given_up: &HashSet<u32>) -> (String, Vec<Spot>) {
    // At equal bytes: ends before beginnings, inner ends before outer ones, outer beginnings before inner ones.
    let mut pieces: Vec<Piece> = Vec::new();
    let mut order = (0..places.len()).collect::<Vec<_>>();
    order.sort_by_key(|&index| (places[index].point.at.start, Reverse(places[index].point.at.end)));
    for (rank, &index) in order.iter().enumerate() {
        let Place { first, point } = &places[index];
        let left = (0..point.changes.len() as u32).filter(|change| !given_up.contains(&(first + change)));
        let left = left.collect::<Vec<_>>();
        if left.is_empty() {
            continue;
        }
        let switch = format!("crate::mutant::at({first})");
        let (before, after) = ((point.at.start, 1, rank as isize), (point.at.end, 0, -(rank as isize)));
        let arms = |before: &str, after: &str| {
            let arm = |&change: &u32| {
                let text = &point.changes[change as usize].text;
                (Some(first + change), format!("{change} => {before}{text}{after},\n"))
            };
            left.iter().map(arm).collect::<Vec<_>>()
        };
        let plain = |text: &str| vec![(None, text.to_owned())];
        match point.form {
            Form::Expression => {
                let text =
                    [plain(&format!("(match {switch} {{\n")), arms("(", ")"), plain("_ => (")].concat();
                pieces.push(Piece { key: before, text, place: index });
                pieces.push(Piece { key: after, text: plain(")})"), place: index });
            }
            Form::Body => {
                let text =
                    [plain(&format!("match {switch} {{\n")), arms("", ""), plain("_ => {}\n}\n")].concat();
                pieces.push(Piece { key: before, text, place: index });
            }
            Form::Arm => {
                let text = vec![(Some(*first), format!(" if {switch} != 0"))];
                pieces.push(Piece { key: after, text, place: index });
            }
        }
    }
    pieces.sort_by_key(|piece| piece.key);
    let (mut text, mut spots, mut from) = (String::new(), Vec::new(), 0);
    let mut opened: HashMap<usize, usize> = HashMap::new();
    for Piece { key: (at, ..), text: added, place } in pieces {
        text.push_str(&source[from..at]);
        from = at;
        let start = text.len();
        for (mutant, part) in added {
            let start = text.len();
            text.push_str(&part);
            if let Some(mutant) = mutant {
                spots.push(Spot { bytes: start..text.len(), mutants: mutant..mutant + 1 });
            }
        }
        let Place { first, point } = &places[place];
        let all = *first..first + point.changes.len() as u32;
        if point.form != Form::Expression {
            spots.push(Spot { bytes: start..text.len(), mutants: all });
        } else if let Some(start) = opened.remove(&place) {
            spots.push(Spot { bytes: start..text.len(), mutants: all });
        } else {
            opened.insert(place, start);
        }
    }
    text.push_str(&source[from..]);
    (text, spots)
}

/// Text that is added to a file.
struct Piece {
    /// Where, and its order among those that are added there.
    key: (usize, u8, isize),
    /// Its parts, with the mutants that they are.
    text: Vec<(Option<u32>, String)>,
    place: usize,
}

/// Bytes of a rewritten file that are there because of some mutants.
pub struct Spot {
    pub bytes: std::ops::Range<usize>,
    pub mutants: std::ops::Range<u32>,
}
