//! Joining the reports of the library into the documents of the commands.

use serde::Serialize;
use serde_json::{Map, Value};

/// A report of the library as a value.
pub(crate) fn to_value(report: &impl Serialize) -> Value {
    serde_json::to_value(report).expect("reports are numbers, texts, lists, and objects with texts as keys")
}

/// Adds the entries of a report to an object, in order.
pub(crate) fn append(object: &mut Map<String, Value>, report: &impl Serialize) {
    let Value::Object(entries) = to_value(report) else { unreachable!("the report is an object") };
    object.extend(entries);
}

/// Adds an entry to an object, right after another one.
pub(crate) fn insert_after(
    object: &mut Map<String, Value>,
    before: &str,
    key: &str,
    value: impl Into<Value>,
) {
    let at = object.keys().position(|key| key == before).expect("the report has this key");
    object.shift_insert(at + 1, key.to_owned(), value.into());
}
