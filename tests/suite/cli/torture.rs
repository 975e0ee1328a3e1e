//! `umbrage torture`.

use std::fs;

use super::{Folder, assert_shape, keys};

#[test]
fn torture_json_has_the_agreed_keys_in_order() {
    let folder = Folder::new();
    let document = folder.json("torture --queries 5_000");
    assert_shape("torture", &document);
    assert_eq!(
        keys(&document),
        "queries disagree ties bound_95 seconds strata seed rounds bound_95_rounds queries_per_second \
         plain_f32_wrong faces faces_wrong plain_f32_faces_wrong volumes open_volumes judged_by_whole_numbers grazing \
         abstained disagreements case"
    );
    assert!(keys(&document["strata"][0]).starts_with("name queries wrong plain_f32_wrong "));
    assert_eq!((document["queries"].as_u64(), document["disagree"].as_u64()), (Some(5000), Some(0)));
    assert!(document["case"].is_null() && folder.names().is_empty(), "nothing is written");
}

#[test]
fn torture_repeats_itself_for_a_seed_on_any_number_of_threads() {
    let folder = Folder::new();
    let run = |more: &str| {
        let mut document = folder.json(&format!("torture --queries 2e4 {more}"));
        for timed in ["seconds", "queries_per_second"] {
            assert!(document[timed].take().as_f64().is_some_and(|number| number > 0.0));
        }
        document
    };
    let one = run("--seed 3 --threads 1");
    assert_eq!(one, run("--seed 3 --threads 2"));
    assert_eq!(one, run("--seed 3 --threads 8"));
    assert_ne!(one["strata"], run("--seed 4")["strata"]);
}

#[test]
fn torture_prints_a_table_and_exits_with_zero() {
    let folder = Folder::new();
    let run = folder.run("torture --queries 3000");
    assert_eq!((run.code, run.stderr.as_str()), (0, ""));
    for words in
        ["3000 queries from seed 1, ", "\n  generic ", "\n  everything ", "\n  all ", " volumes open"]
    {
        assert!(run.stdout.contains(words), "{words}: {}", run.stdout);
    }
    assert!(
        run.stdout.contains("\nverdict: all methods agree: with 95 % confidence they disagree on less than ")
    );
    assert!(run.stdout.lines().last().is_some_and(|line| line.starts_with("ties: ")), "{}", run.stdout);
}

const TETRAHEDRON: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";

#[test]
fn torture_replays_a_case_that_was_written_by_hand() {
    let folder = Folder::new();
    for (comments, said) in [
        (
            "# light point:0.2,0.2,9\n# point 0.2,0.3,-2\n",
            "1 front and 1 back faces crossed, 0 touched: shadowed",
        ),
        ("# light directional:0,0,-1\n# point 0,0,-2\n# signs 9\n", "touched: grazing"),
        ("# point 3,3,3\n# light point:5,5,5\n# said: whatever\n", "0 touched: lit"),
    ] {
        fs::write(folder.path("case.obj"), format!("{comments}{TETRAHEDRON}")).unwrap();
        let run = folder.run("torture --replay case.obj");
        assert_eq!((run.code, run.stderr.as_str()), (0, ""), "{comments}");
        assert!(run.stdout.starts_with("case.obj: 4 faces, "), "{}", run.stdout);
        assert!(run.stdout.contains(said), "{said}: {}", run.stdout);
        assert!(run.stdout.ends_with("verdict: all methods agree\n"), "{}", run.stdout);
    }
    fs::write(folder.path("case.obj"), "# light point:1,2,3\n# point 1,2,3\nv 0 0 0\n").unwrap();
    assert_eq!(folder.run("torture --replay case.obj").code, 0, "a mesh without faces");
}

#[test]
fn torture_refuses_to_replay_what_is_no_case() {
    let folder = Folder::with_cubes();
    for (name, text, problem) in [
        ("a.obj", TETRAHEDRON.to_owned(), "no comment line starts with `# light `"),
        ("b.obj", format!("# light point:1,2,3\n{TETRAHEDRON}"), "no comment line starts with `# point `"),
        (
            "c.obj",
            format!("# light point:1,2\n# point 1,2,3\n{TETRAHEDRON}"),
            "c.obj, line 1: `point:1,2` is not a",
        ),
        (
            "d.obj",
            format!("# light point:1,2,3\n# point 1,2,inf\n{TETRAHEDRON}"),
            "d.obj, line 2: `1,2,inf` is no",
        ),
        (
            "e.obj",
            format!("# light point:1,2,3\n# point 1,2,3\n# signs x\n{TETRAHEDRON}"),
            "`x` is no whole number",
        ),
        ("f.obj", "# light point:1,2,3\n# point 1,2,3\nf 1 2 3\n".to_owned(), "f.obj"),
    ] {
        fs::write(folder.path(name), text).unwrap();
        let run = folder.run(&format!("torture --replay {name}"));
        assert_eq!((run.code, run.stdout.as_str()), (2, ""), "{name}");
        assert!(run.stderr.contains(problem) && run.stderr.contains("; "), "{name}: {}", run.stderr);
        assert_eq!(run.stderr.lines().count(), 1, "{}", run.stderr);
    }
    for name in ["missing.obj", "folder"] {
        assert_eq!(folder.code(&format!("torture --replay {name}")), 2, "{name}");
    }
}
