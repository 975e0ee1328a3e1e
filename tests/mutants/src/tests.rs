//! The tool itself: an example whose mutants are known, and lists that fit nothing.

use std::fs;
use std::path::Path;

use super::{Arguments, work};

/// Arguments for the example, and a folder that is empty.
fn arguments(name: &str) -> Arguments {
    let out = std::env::temp_dir().join(format!("umbrage-mutants-{}-{name}", std::process::id()));
    let _ = fs::remove_dir_all(&out);
    let example = concat!(env!("CARGO_MANIFEST_DIR"), "/example");
    Arguments {
        tree: example.into(),
        lists: Some(example.into()),
        out: Some(out),
        cargo: vec!["--offline".into()],
        ..Arguments::default()
    }
}

/// The outcome of each mutant, as `OUTCOME CHANGE`, in order.
fn outcomes(out: &Path) -> Vec<String> {
    let text = fs::read_to_string(out.join("results.tsv")).unwrap();
    let of = |line: &str| {
        let fields = line.split('\t').collect::<Vec<_>>();
        format!("{}, {}", fields[2], fields[4].split_once(": ").unwrap().1)
    };
    let mut all = text.lines().map(of).collect::<Vec<_>>();
    all.sort();
    all
}

#[test]
fn known_mutants_end_as_they_must() {
    let arguments = arguments("known");
    let is_clean = work(&arguments).unwrap();
    let out = arguments.out.as_ref().unwrap();
    let all = outcomes(out);
    assert!(!is_clean, "missed ones are said");
    for expected in [
        "caught, constant to it.wrapping_add(1): FULL",
        "caught, constant to it.wrapping_sub(1): FULL",
        "caught, is_full: >= to >: count >= FULL",
        "caught, is_full: to FULL + 2: FULL",
        "caught, is_full: body to `true`",
        "missed, is_heavy: > to >=: weight > 100",
        "caught, is_heavy: > to <: weight > 100",
        "timed out, halvings: /= to %=: number /= 2",
        "not reached, is_forgotten: && to ||: a && b",
        "does not build, joined: + to -: left + right",
    ] {
        assert!(all.iter().any(|one| one == expected), "{expected} is not in {all:#?}");
    }
    // What is settled is not run again.
    assert!(!work(&arguments).unwrap());
    assert_eq!(outcomes(out), all);
    fs::remove_dir_all(out).unwrap();
}

#[test]
fn lists_that_fit_nothing_are_refused() {
    for (list, line) in [
        ("named.txt", "src/lib.rs: EMPTY => 0"),
        ("named.txt", "src/lib.rs: EMPTY"),
        ("equivalent.txt", "src/lib.rs: >= to <=: nothing -- a reason"),
        ("equivalent.txt", "src/lib.rs: >= to >"),
    ] {
        let mut arguments = arguments("lists");
        let lists = arguments.out.clone().unwrap().with_extension("lists");
        fs::create_dir_all(&lists).unwrap();
        fs::write(lists.join("parts.txt"), "all | src | tests::").unwrap();
        fs::write(lists.join(list), line).unwrap();
        arguments.lists = Some(lists.clone());
        arguments.list = true;
        let message = work(&arguments).unwrap_err();
        fs::remove_dir_all(&lists).unwrap();
        assert!(message.contains(list), "{line}: {message}");
    }
}
