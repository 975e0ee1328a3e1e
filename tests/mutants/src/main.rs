//! Mutation testing with every mutant in one test binary, chosen at run time.
//!
//! Mutant schemata: R. Untch, A. J. Offutt, M. J. Harrold, "Mutation analysis using mutant schemata", ISSTA 1993.
//! The tree is copied, and each place of its files that can change asks which change is in force. One build holds
//! all of them. Tests are traced first, one process each: a mutant meets only those that come by, the quickest
//! first.

mod build;
mod defaults;
mod plan;
mod points;
mod results;
mod run;

use std::collections::HashSet;
use std::fs;
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::{Duration, Instant};

use results::{Known, Results};
use run::Outcome;

const USAGE: &str = "usage: umbrage-mutants [PART…] [OPTION…]
  --tree DIR       the crate under test (default: .)
  --lists DIR      parts.txt, named.txt and equivalent.txt (default: tests/mutants in the tree)
  --out DIR        the changed copy and the results (default: target/mutants in the tree)
  --cargo OPTION   passed to cargo test; may be given several times
  --only TEXT      mutants that have TEXT in `FILE:LINE:COLUMN: CHANGE`
  --shard I/N      every Nth mutant, from the Ith (I from 0)
  --workers N      tests at a time (default: 2)
  --minutes M      begins no mutant after M minutes; the next run goes on
  --slowest S      leaves out tests that take longer than S seconds without a mutant (default: 600)
  --fresh          forgets the results of earlier runs
  --list           lists the mutants, and builds nothing
  --report         tells what earlier runs found, and runs nothing";

struct Arguments {
    parts: Vec<String>,
    tree: PathBuf,
    lists: Option<PathBuf>,
    out: Option<PathBuf>,
    cargo: Vec<String>,
    only: Option<String>,
    shard: (usize, usize),
    workers: usize,
    minutes: f64,
    slowest: f64,
    fresh: bool,
    list: bool,
    report: bool,
}

impl Default for Arguments {
    fn default() -> Self {
        Self {
            parts: Vec::new(),
            tree: ".".into(),
            lists: None,
            out: None,
            cargo: Vec::new(),
            only: None,
            shard: (0, 1),
            workers: 2,
            minutes: f64::INFINITY,
            slowest: 600.0,
            fresh: false,
            list: false,
            report: false,
        }
    }
}

fn arguments() -> Result<Arguments, String> {
    let mut all = Arguments::default();
    let mut rest = std::env::args().skip(1);
    while let Some(word) = rest.next() {
        let mut value = || rest.next().ok_or(format!("{word} needs a value\n{USAGE}"));
        let bad = |value: &str| format!("{word}: not understood: {value}\n{USAGE}");
        match word.as_str() {
            "--tree" => all.tree = value()?.into(),
            "--lists" => all.lists = Some(value()?.into()),
            "--out" => all.out = Some(value()?.into()),
            "--cargo" => all.cargo.push(value()?),
            option if option.starts_with("--cargo=") => all.cargo.push(option["--cargo=".len()..].into()),
            "--only" => all.only = Some(value()?),
            "--shard" => {
                let text = value()?;
                let parsed = text.split_once('/').and_then(|(i, n)| Some((i.parse().ok()?, n.parse().ok()?)));
                all.shard = parsed.filter(|(i, n)| i < n).ok_or_else(|| bad(&text))?;
            }
            "--workers" => {
                let text = value()?;
                all.workers = text.parse().ok().filter(|&n| n > 0).ok_or_else(|| bad(&text))?;
            }
            "--minutes" => {
                let text = value()?;
                all.minutes = text.parse().map_err(|_| bad(&text))?;
            }
            "--slowest" => {
                let text = value()?;
                all.slowest =
                    text.parse().ok().filter(|s| (0.0..1e6).contains(s)).ok_or_else(|| bad(&text))?;
            }
            "--fresh" => all.fresh = true,
            "--list" => all.list = true,
            "--report" => all.report = true,
            "--help" | "-h" => return Err(USAGE.into()),
            option if option.starts_with('-') => return Err(format!("no such option: {option}\n{USAGE}")),
            part => all.parts.push(part.into()),
        }
    }
    Ok(all)
}

fn main() -> ExitCode {
    match arguments().and_then(|arguments| work(&arguments)) {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::from(1),
        Err(message) => {
            eprintln!("{message}");
            ExitCode::from(2)
        }
    }
}

/// Whether nothing is missed.
fn work(arguments: &Arguments) -> Result<bool, String> {
    let root = fs::canonicalize(&arguments.tree)
        .map_err(|error| format!("{}: {error}", arguments.tree.display()))?;
    let lists = arguments.lists.clone().unwrap_or_else(|| root.join("tests/mutants"));
    let mut parts = plan::parts(&lists.join("parts.txt"))?;
    if let Some(unknown) = arguments.parts.iter().find(|name| parts.iter().all(|part| part.name != **name)) {
        let names = parts.iter().map(|part| part.name.as_str()).collect::<Vec<_>>().join(", ");
        return Err(format!("no such part: {unknown}; there are: {names}"));
    }
    let whole = plan::make(&root, &lists, plan::parts(&lists.join("parts.txt"))?)?;
    let equivalent = results::equivalent(&lists.join("equivalent.txt"), &whole)?;
    if !arguments.parts.is_empty() {
        parts.retain(|part| arguments.parts.contains(&part.name));
    }
    let plan = plan::make(&root, &lists, parts)?;
    if arguments.list {
        for mutant in &plan.mutants {
            println!("{}", mutant.key());
        }
        return Ok(true);
    }

    let start = Instant::now();
    let out = arguments.out.clone().unwrap_or_else(|| root.join("target/mutants"));
    fs::create_dir_all(&out).map_err(|error| format!("{}: {error}", out.display()))?;
    let mut results = Results::open(&out.join("results.tsv"), arguments.fresh)?;
    let keys = plan.mutants.iter().map(plan::Mutant::key).collect::<Vec<_>>();
    if arguments.report {
        return Ok(report(&plan, &keys, &results, &equivalent, arguments) == 0);
    }
    let mut given_up = HashSet::new();
    for (index, mutant) in plan.mutants.iter().enumerate() {
        if results.known(&keys[index], mutant.hash) == Some(&Known::DoesNotBuild) {
            given_up.insert(index as u32);
        }
    }
    let options =
        build::Options { root: root.clone(), copy: out.join("tree"), cargo: arguments.cargo.clone() };
    let path = build::build(&options, &plan, &mut given_up)?;
    for &index in &given_up {
        let mutant = &plan.mutants[index as usize];
        results.add(&keys[index as usize], mutant.hash, 0, &Known::DoesNotBuild)?;
    }
    let built = start.elapsed();
    // Other tests left out: what was missed may be caught.
    let state = plan::hash(&fs::read(&path).map_err(|error| format!("{}: {error}", path.display()))?)
        ^ plan::hash(arguments.slowest.to_string().as_bytes());
    let binary = run::Binary { path, folder: options.copy };

    let is_of = |name: &str, part: &plan::Part| part.tests.iter().any(|test| name.starts_with(test.as_str()));
    let names = binary.tests()?;
    let names =
        names.into_iter().filter(|name| plan.parts.iter().any(|part| is_of(name, part))).collect::<Vec<_>>();
    eprintln!("built in {:.1} minutes; tracing {} tests", built.as_secs_f64() / 60.0, names.len());
    let (tests, failed) =
        binary.trace(&names, arguments.workers, &out, state, Duration::from_secs_f64(arguments.slowest))?;
    for name in &failed {
        eprintln!("fails without a mutant or is too slow, and is left out: {name}");
    }
    let traced = start.elapsed();
    eprintln!("traced in {:.1} minutes", (traced - built).as_secs_f64() / 60.0);
    let reaching = run::by_point(&tests);

    let wanted = (0..plan.mutants.len())
        .filter(|&index| index % arguments.shard.1 == arguments.shard.0)
        .filter(|&index| arguments.only.as_ref().is_none_or(|text| keys[index].contains(text.as_str())))
        .filter(|&index| !given_up.contains(&(index as u32)) && !equivalent.contains_key(&keys[index]))
        .collect::<Vec<_>>();
    let mut to_do = wanted
        .iter()
        .copied()
        .filter(|&index| !results.is_settled(&keys[index], plan.mutants[index].hash, state))
        .collect::<Vec<_>>();
    // A changed constant is missed more often than other mutants, and what is missed meets all tests.
    to_do.sort_by_key(|&index| plan.mutants[index].name.starts_with("constant "));
    let done = std::sync::atomic::AtomicUsize::new(0);
    let results = std::sync::Mutex::new(results);
    let failures = run::each(to_do.len(), arguments.workers, |number| {
        if start.elapsed() > Duration::from_secs_f64((arguments.minutes * 60.0).min(1e9)) {
            return Ok(());
        }
        let index = to_do[number];
        let mutant = &plan.mutants[index];
        let part = &plan.parts[mutant.part];
        let tests = reaching.get(&mutant.first).map_or(&[][..], |tests| tests);
        let tests = tests.iter().copied().filter(|test| is_of(&test.name, part)).collect::<Vec<_>>();
        let outcome = binary.judge(index as u32, &tests);
        let known = match &outcome {
            Outcome::Caught(by) => Known::Caught(by.clone()),
            Outcome::TimedOut(by) => Known::TimedOut(by.clone()),
            Outcome::Missed => Known::Missed,
            Outcome::Unreached => Known::Unreached,
        };
        let done = done.fetch_add(1, std::sync::atomic::Ordering::Relaxed) + 1;
        if done.is_multiple_of(100) {
            let minutes = (start.elapsed() - traced).as_secs_f64() / 60.0;
            eprintln!("{done} of {} mutants in {minutes:.1} minutes", to_do.len());
        }
        let mut results = results.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
        results.add(&keys[index], mutant.hash, state, &known)
    });
    failures.into_iter().collect::<Result<Vec<()>, String>>()?;
    let results = results.into_inner().unwrap_or_else(|poisoned| poisoned.into_inner());
    let missed = report(&plan, &keys, &results, &equivalent, arguments);
    println!(
        "{:.1} minutes, of them {:.1} to build",
        start.elapsed().as_secs_f64() / 60.0,
        built.as_secs_f64() / 60.0
    );
    Ok(missed == 0)
}

/// Prints the table of the parts and what is missed. Returns how many are.
fn report(
    plan: &plan::Plan,
    keys: &[String],
    results: &Results,
    equivalent: &std::collections::HashMap<String, String>,
    arguments: &Arguments,
) -> usize {
    println!(
        "| part | mutants | caught | timed out | missed | not reached | equivalent | do not build | not run |"
    );
    println!("|---|---|---|---|---|---|---|---|---|");
    let mut missed = Vec::new();
    for (number, part) in plan.parts.iter().enumerate() {
        let mut counts = [0; 8];
        for (index, mutant) in plan.mutants.iter().enumerate().filter(|(_, mutant)| mutant.part == number) {
            counts[0] += 1;
            if equivalent.contains_key(&keys[index]) {
                counts[5] += 1;
                continue;
            }
            let column = match results.known(&keys[index], mutant.hash) {
                Some(Known::Caught(_)) => 1,
                Some(Known::TimedOut(_)) => 2,
                Some(Known::Missed) => 3,
                Some(Known::Unreached) => 4,
                Some(Known::DoesNotBuild) => 6,
                None => 7,
            };
            counts[column] += 1;
            if matches!(column, 3 | 4) {
                missed.push(format!("{}{}", keys[index], if column == 4 { " (not reached)" } else { "" }));
            }
        }
        let counts = counts.map(|count| count.to_string()).join(" | ");
        println!("| {} | {counts} |", part.name);
    }
    if arguments.only.is_none() && !missed.is_empty() {
        println!("\nmissed:");
    }
    let shown = |line: &&String| arguments.only.as_ref().is_none_or(|text| line.contains(text.as_str()));
    let mut count = 0;
    for line in missed.iter().filter(shown) {
        println!("{line}");
        count += 1;
    }
    count
}

#[cfg(test)]
mod tests;
