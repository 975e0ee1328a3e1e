//! `umbrage.toml`: what is required of which files.
//!
//! ```toml
//! [[rule]]
//! files = ["props/*", "*.stl"]
//! require = ["watertight", "no-duplicates"]
//! weld = 0.001
//! ```

use std::path::Path;

use clap::ValueEnum;
use toml_edit::{Document, Item, TableLike, Value};
use umbrage::check::Requirement;
use umbrage::mesh::Weld;
use umbrage::scene::Pattern;

use super::Args;
use crate::cli::error::Failure;
use crate::cli::load::{ScopeArg, parse_weld};

/// The file that is read without `--config`, in the working folder.
const FILE: &str = "umbrage.toml";

/// The keys of a rule.
const KEYS: [&str; 6] = ["files", "require", "allow-empty", "self-intersections", "weld", "scope"];

/// The rules of a file, in its order.
#[derive(Default)]
pub(super) struct Rules(Vec<Rule>);

/// What a rule says of its files; `None` where it says nothing.
#[derive(Default)]
struct Rule {
    files: Vec<Pattern>,
    require: Option<Vec<Requirement>>,
    allow_empty: Option<bool>,
    self_intersections: Option<bool>,
    weld: Option<Weld>,
    scope: Option<ScopeArg>,
}

impl Rules {
    /// Those of `config`, or of the file in the working folder; none where there is no such file.
    pub(super) fn find(config: Option<&Path>) -> Result<Self, Failure> {
        match config {
            Some(path) => Self::read(path),
            None if Path::new(FILE).exists() => Self::read(Path::new(FILE)),
            None => Ok(Self::default()),
        }
    }

    fn read(path: &Path) -> Result<Self, Failure> {
        let text = std::fs::read_to_string(path).map_err(|error| {
            let problem = format!("cannot be read: {error}");
            Failure::new(problem, "name a file of rules by --config, or leave it out").in_file(path)
        })?;
        Self::parse(&text).map_err(|wrong| wrong.in_file(path, &text))
    }

    fn parse(text: &str) -> Result<Self, Wrong> {
        let document = Document::parse(text).map_err(|error| {
            let message = error.message().lines().next().unwrap_or("is no TOML").to_owned();
            Wrong {
                at: error.span().map_or(0, |span| span.start),
                problem: message,
                remedy: "write TOML".to_owned(),
            }
        })?;
        let mut rules = Vec::new();
        for (key, item) in document.iter() {
            let at =
                document.key(key).and_then(|key| key.span()).or(item.span()).map_or(0, |span| span.start);
            if key != "rule" {
                return Err(Wrong::new(at, format!("unknown key `{key}`"), "write [[rule]] above its keys"));
            }
            let tables = item.as_array_of_tables();
            let tables =
                tables.ok_or_else(|| Wrong::new(at, "`rule` is no list of tables", "write [[rule]]"))?;
            for table in tables {
                rules.push(Rule::of(table, table.span().map_or(at, |span| span.start))?);
            }
        }
        Ok(Self(rules))
    }

    /// The arguments for a file: of each key the last rule for this file that has it, unless the command line
    /// says something itself.
    pub(super) fn apply(&self, args: &Args, file: &Path) -> Args {
        let mut of_file = args.clone();
        let path = file.to_string_lossy().replace('\\', "/");
        let path = path.strip_prefix("./").unwrap_or(&path);
        let rules = || self.0.iter().rev().filter(|rule| rule.covers(path));
        if args.require.is_empty() && !args.fast {
            of_file.require = rules().find_map(|rule| rule.require.clone()).unwrap_or_default();
        }
        of_file.allow_empty |= rules().find_map(|rule| rule.allow_empty).unwrap_or(false);
        of_file.self_intersections |=
            !args.fast && rules().find_map(|rule| rule.self_intersections).unwrap_or(false);
        if let Some(weld) = rules().find_map(|rule| rule.weld) {
            of_file.mesh.weld_unless_told(weld);
        }
        if let Some(scope) = rules().find_map(|rule| rule.scope) {
            of_file.mesh.scope_unless_told(scope);
        }
        of_file
    }
}

impl Rule {
    fn of(table: &dyn TableLike, start: usize) -> Result<Self, Wrong> {
        let mut rule = Self::default();
        for (key, item) in table.iter() {
            let span = table.key(key).and_then(|key| key.span()).or(item.span());
            let at = span.map_or(start, |span| span.start);
            let wrong = |what: &str| {
                Wrong::new(at, format!("`{key}` is no {what}"), &format!("write {}", example(key)))
            };
            match key {
                "files" => {
                    let names = texts(item).ok_or_else(|| wrong("pattern or list of patterns"))?;
                    rule.files = names.into_iter().map(Pattern::new).collect();
                }
                "require" => {
                    let names = texts(item).ok_or_else(|| wrong("list of properties"))?;
                    let parsed = names.iter().map(|name| name.parse().map_err(|_| name));
                    let parsed: Result<Vec<Requirement>, _> = parsed.collect();
                    rule.require = Some(parsed.map_err(|name| {
                        let known = Requirement::ALL.map(Requirement::name).join(", ");
                        Wrong::new(at, format!("unknown property `{name}`"), &format!("write one of {known}"))
                    })?);
                }
                "allow-empty" => {
                    rule.allow_empty = Some(item.as_bool().ok_or_else(|| wrong("true or false"))?);
                }
                "self-intersections" => {
                    rule.self_intersections = Some(item.as_bool().ok_or_else(|| wrong("true or false"))?);
                }
                "weld" => rule.weld = Some(weld(item).ok_or_else(|| wrong("weld"))?),
                "scope" => rule.scope = Some(scope(item).ok_or_else(|| wrong("scope"))?),
                _ => {
                    let remedy = format!("write one of {}", KEYS.join(", "));
                    return Err(Wrong::new(at, format!("unknown key `{key}`"), &remedy));
                }
            }
        }
        match rule.files.is_empty() {
            true => {
                Err(Wrong::new(start, "a rule without `files`", "write files = \"*.glb\", or \"*\" for all"))
            }
            false => Ok(rule),
        }
    }

    /// Whether one of the patterns takes the path, or, if it names no folder, the name of the file.
    fn covers(&self, path: &str) -> bool {
        let name = path.rsplit('/').next().unwrap_or(path);
        self.files.iter().any(|pattern| {
            let has_folder = pattern.to_string().contains('/');
            pattern.matches(if has_folder { path } else { name })
        })
    }
}

/// A right value of a key.
fn example(key: &str) -> &'static str {
    match key {
        "files" => "files = [\"props/*\", \"*.stl\"]",
        "require" => "require = [\"watertight\"]",
        "weld" => "weld = \"exact\", \"none\", or a distance above 0",
        "scope" => "scope = \"mesh\", \"primitive\" or \"scene\"",
        _ => "true or false",
    }
}

/// One text, or a list of texts.
fn texts(item: &Item) -> Option<Vec<String>> {
    match item.as_value()? {
        Value::String(text) => Some(vec![text.value().clone()]),
        Value::Array(list) => list.iter().map(|value| value.as_str().map(str::to_owned)).collect(),
        _ => None,
    }
}

fn weld(item: &Item) -> Option<Weld> {
    let text = match item.as_value()? {
        Value::String(text) if text.value().parse::<f64>().is_err() => text.value().clone(),
        Value::Float(number) => number.value().to_string(),
        Value::Integer(number) => number.value().to_string(),
        _ => return None,
    };
    parse_weld(&text).ok()
}

fn scope(item: &Item) -> Option<ScopeArg> {
    ScopeArg::from_str(item.as_str()?, false).ok()
}

/// What is wrong in a file, and where: bytes before it.
#[derive(Debug)]
struct Wrong {
    at: usize,
    problem: String,
    remedy: String,
}

impl Wrong {
    fn new(at: usize, problem: impl Into<String>, remedy: &str) -> Self {
        Self { at, problem: problem.into(), remedy: remedy.to_owned() }
    }

    fn in_file(self, path: &Path, text: &str) -> Failure {
        let line = 1 + text.bytes().take(self.at).filter(|&byte| byte == b'\n').count();
        Failure::new(format_args!("line {line}: {}", self.problem), self.remedy).in_file(path)
    }
}
