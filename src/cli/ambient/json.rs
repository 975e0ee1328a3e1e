//! The JSON document of `umbrage ambient`.

use serde_json::{Value, json};

use super::input::Input;
use super::inside::Worst;
use super::{Args, Found};

pub(super) fn document(args: &Args, input: &Input, found: &Found, worst: Option<&Worst>) -> Value {
    json!({
        "file": args.file.to_string_lossy(),
        "format": input.format.map(|format| format.name()),
        "receivers": found.receivers,
        "method": args.method.name(),
        "rays": found.rays,
        "mean_openness": found.mean_openness,
        "standard_error": found.standard_error,
        "inside": found.inside,
        "fit": args.fit,
        "worst_inside": worst.map(Worst::document),
        "seconds": found.seconds,
    })
}
