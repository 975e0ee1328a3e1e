//! What is known of each mutant, in a file that outlasts a run; and those that change nothing.

use std::collections::HashMap;
use std::fs::{self, File, OpenOptions};
use std::io::Write;
use std::path::Path;

use crate::plan::{self, Plan};

/// What came of a mutant in this run or an earlier one.
#[derive(Clone, Debug, PartialEq)]
pub enum Known {
    Caught(String),
    TimedOut(String),
    Missed,
    Unreached,
    DoesNotBuild,
}

/// Results by mutant, with the hashes of the changed file and of the test binary.
pub struct Results {
    known: HashMap<String, (u64, u64, Known)>,
    file: File,
}

impl Results {
    /// Reads what earlier runs found, unless it shall be forgotten.
    pub fn open(path: &Path, fresh: bool) -> Result<Self, String> {
        let fail = |error: std::io::Error| format!("{}: {error}", path.display());
        if fresh && path.exists() {
            fs::remove_file(path).map_err(fail)?;
        }
        let mut known = HashMap::new();
        for line in fs::read_to_string(path).unwrap_or_default().lines() {
            let [hash, state, outcome, test, key] = line.splitn(5, '\t').collect::<Vec<_>>()[..] else {
                continue;
            };
            let number = |text| u64::from_str_radix(text, 16);
            let (Ok(hash), Ok(state)) = (number(hash), number(state)) else { continue };
            let outcome = match outcome {
                "caught" => Known::Caught(test.to_owned()),
                "timed out" => Known::TimedOut(test.to_owned()),
                "missed" => Known::Missed,
                "not reached" => Known::Unreached,
                "does not build" => Known::DoesNotBuild,
                _ => continue,
            };
            known.insert(key.to_owned(), (hash, state, outcome));
        }
        let file = OpenOptions::new().create(true).append(true).open(path).map_err(fail)?;
        Ok(Self { known, file })
    }

    /// What is known of a mutant of a file with this hash.
    pub fn known(&self, key: &str, hash: u64) -> Option<&Known> {
        self.known.get(key).filter(|(of, ..)| *of == hash).map(|(.., known)| known)
    }

    /// Whether a mutant needs no run. One that was missed does once the test binary is another.
    pub fn is_settled(&self, key: &str, hash: u64, state: u64) -> bool {
        match self.known.get(key) {
            Some((of, ..)) if *of != hash => false,
            Some((_, of, Known::Missed | Known::Unreached)) => *of == state,
            Some(_) => true,
            None => false,
        }
    }

    /// Adds a line.
    pub fn add(&mut self, key: &str, hash: u64, state: u64, known: &Known) -> Result<(), String> {
        if self.known(key, hash) == Some(known) && *known == Known::DoesNotBuild {
            return Ok(());
        }
        let (outcome, test) = match known {
            Known::Caught(test) => ("caught", test.as_str()),
            Known::TimedOut(test) => ("timed out", test.as_str()),
            Known::Missed => ("missed", ""),
            Known::Unreached => ("not reached", ""),
            Known::DoesNotBuild => ("does not build", ""),
        };
        self.known.insert(key.to_owned(), (hash, state, known.clone()));
        writeln!(self.file, "{hash:x}\t{state:x}\t{outcome}\t{test}\t{key}")
            .map_err(|error| error.to_string())
    }
}

/// Mutants that change nothing that can be seen, with the reason: `FILE: PART OF THE CHANGE -- REASON` a line.
/// Fails if
/// a line fits no mutant.
pub fn equivalent(path: &Path, plan: &Plan) -> Result<HashMap<String, String>, String> {
    let mut all = HashMap::new();
    if !path.exists() {
        return Ok(all);
    }
    for line in plan::lines(&plan::read(path)?) {
        let parsed =
            line.split_once(" -- ").and_then(|(what, reason)| Some((what.split_once(": ")?, reason)));
        let ((file, change), reason) =
            parsed.ok_or_else(|| format!("{}: not FILE: CHANGE -- REASON: {line}", path.display()))?;
        let fits = plan.mutants.iter().filter(|mutant| mutant.file == file && mutant.name.contains(change));
        let before = all.len();
        all.extend(fits.map(|mutant| (mutant.key(), reason.to_owned())));
        if all.len() == before {
            return Err(format!("{}: fits no mutant, or none that is not listed: {line}", path.display()));
        }
    }
    Ok(all)
}
