//! Costs: read from a file, or measured.

use std::fs;
use std::path::Path;

use umbrage::plan::{CostKey, Costs};

use crate::cli::Failure;
use crate::cli::progress::Progress;

/// The costs of a file, or the built-in ones.
pub(crate) fn read_costs(path: Option<&Path>) -> Result<Costs, Failure> {
    let Some(path) = path else { return Ok(Costs::default()) };
    let text = fs::read_to_string(path).map_err(|error| {
        let remedy = "name a file that `umbrage plan --calibrate` wrote";
        Failure::new(format_args!("--costs cannot be read: {error}"), remedy).in_file(path)
    })?;
    // Its errors name the remedy.
    Costs::from_json(&text, &CostKey::here())
        .map_err(|error| Failure::of(error.to_string(), None).in_file(path))
}

/// The costs of this machine.
pub(crate) fn measured_costs() -> Costs {
    let _progress = Progress::spinner("measuring this machine");
    Costs::calibrate()
}
