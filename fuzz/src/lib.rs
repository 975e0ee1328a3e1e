//! Fuzz targets of umbrage: one entry for all of them.

mod body;

/// Runs the target of this name on `data`; panics where a claim of that target does not hold.
pub fn run(target: &str, data: &[u8]) {
    let (_, body) = body::TARGETS.iter().find(|(name, _)| *name == target).expect("a target of this name");
    body(data);
}

/// What the target `cli` needs beside its body, since the command belongs to no library.
pub mod command {
    use crate::body::command;

    /// The arguments that `data` encodes.
    pub fn arguments(data: &[u8]) -> Vec<String> {
        command::arguments(data)
    }

    /// Panics unless the message of the command is one line.
    pub fn is_one_line(refusal: &str) {
        command::is_one_line(refusal);
    }
}
