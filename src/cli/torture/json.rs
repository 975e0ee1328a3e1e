//! The document of `umbrage torture --json`.

use std::path::Path;

use serde_json::{Map, Value};
use umbrage::testing::torture::Torture;

use crate::cli::json::{append, insert_after};
use crate::cli::output::number;

/// What was found, and what it took.
pub(super) fn document(found: &Torture, seed: u64, seconds: f64, case: Option<&Path>) -> Value {
    let mut document = Map::new();
    append(&mut document, found);
    insert_after(&mut document, "bound_95", "seconds", number(seconds));
    insert_after(&mut document, "strata", "seed", seed);
    let rate = number(found.total().queries as f64 / seconds);
    insert_after(&mut document, "bound_95_rounds", "queries_per_second", rate);
    document.insert("case".to_owned(), case.map(|path| path.to_string_lossy()).into());
    Value::Object(document)
}
