//! What the report of one file adds to that of all.

use std::path::Path;

use serde_json::{Value, json};
use umbrage::check::Verdict;

use super::overview::{Row, Summary};
use super::report::FileReport;
use super::text::Report;
use super::{Args, json};
use crate::cli::color::Painter;
use crate::cli::error::Failure;

/// The parts of the report of one file that are kept when the file is done.
pub(super) struct Fragment {
    pub(super) row: Row,
    /// The entry of the JSON document, of which all other documents are made; null where none is asked for.
    pub(super) entry: Value,
    /// What is printed of the file itself.
    pub(super) text: String,
}

impl Fragment {
    pub(super) fn of(
        file: &Path,
        report: &Result<FileReport, Failure>,
        args: &Args,
        painter: Painter,
    ) -> Self {
        let entry = if args.wants_entries() {
            json::entry(&file.to_owned(), report, args.limit)
        } else {
            Value::Null
        };
        let text = match report {
            _ if args.json || args.quiet => String::new(),
            _ if args.json_lines => format!("{}\n", json::line(&entry)),
            _ if args.summary => format!("{}\n", Summary { file, report, painter }),
            Ok(report) => Report { report, limit: args.limit, painter }.to_string(),
            Err(_) => String::new(),
        };
        Self { row: Row::of(report), entry, text }
    }

    pub(super) fn to_json(&self) -> Value {
        json!({
            "verdict": self.row.verdict.map(Verdict::name),
            "numbers": self.row.numbers,
            "entry": self.entry,
            "text": self.text,
        })
    }

    /// `None` if the bytes are no fragment.
    pub(super) fn read(bytes: &[u8]) -> Option<Self> {
        let mut value: Value = serde_json::from_slice(bytes).ok()?;
        let verdicts = [Verdict::Sound, Verdict::NotProven, Verdict::Empty, Verdict::Cracked];
        let verdict = match &value["verdict"] {
            Value::Null => None,
            name => Some(verdicts.into_iter().find(|verdict| *name == verdict.name())?),
        };
        let numbers = match value["numbers"].as_array() {
            Some(numbers) => {
                let numbers: Option<Vec<usize>> =
                    numbers.iter().map(|x| usize::try_from(x.as_u64()?).ok()).collect();
                Some(numbers?.try_into().ok()?)
            }
            None => None,
        };
        let text = value["text"].as_str()?.to_owned();
        Some(Self { row: Row { verdict, numbers }, entry: value["entry"].take(), text })
    }
}
