//! `umbrage.toml`: what is required of which files.

use std::fs;

use umbrage::testing::shapes;

use super::Folder;

/// A folder with meshes of several properties; each file alone fails without rules, but the cube.
fn folder() -> Folder {
    let folder = Folder::with_cubes();
    fs::create_dir_all(folder.path("props/small")).unwrap();
    folder.mesh("props/inward.obj", &shapes::inside_out(&shapes::cube()));
    folder.mesh("props/small/turned.ply", &shapes::misoriented_cube());
    folder.mesh("soup.ply", &shapes::soup(&shapes::cube()));
    folder.mesh("seam.obj", &shapes::seam(4));
    fs::write(folder.path("empty.stl"), "solid\nendsolid\n").unwrap();
    folder
}

/// Verdicts of `check FILES --summary` with these rules.
fn verdicts(folder: &Folder, rules: &str, arguments: &str) -> Vec<String> {
    fs::write(folder.path("umbrage.toml"), rules).unwrap();
    let run = folder.run(&format!("check {arguments} --summary"));
    run.stdout.lines().map(|line| line.split(':').next().unwrap().to_owned()).collect()
}

#[test]
fn rules_say_what_is_required_of_which_files() {
    let folder = folder();
    let files = "cube.obj props/inward.obj props/small/turned.ply empty.stl";
    let cases = [
        // No rule, and one for other files.
        ("", ["sound", "cracked", "cracked", "empty"]),
        ("[[rule]]\nfiles = \"*.glb\"\nrequire = \"even\"\n", ["sound", "cracked", "cracked", "empty"]),
        // By folder, also below it; by name alone.
        ("[[rule]]\nfiles = \"props/*\"\nrequire = [\"even\"]\n", ["sound", "sound", "sound", "empty"]),
        (
            "[[rule]]\nfiles = \"inward.*\"\nrequire = [\"watertight\"]\n",
            ["sound", "sound", "cracked", "empty"],
        ),
        (
            "[[rule]]\nfiles = [\"*.ply\", \"*.stl\"]\nrequire = [\"even\"]\nallow-empty = true\n",
            ["sound", "cracked", "sound", "sound"],
        ),
        // Of each key the last rule counts.
        (
            "[[rule]]\nfiles = \"*\"\nrequire = \"even\"\nallow-empty = true\n[[rule]]\nfiles = \"*.ply\"\nrequire = \"sound\"\n",
            ["sound", "sound", "cracked", "sound"],
        ),
    ];
    for (rules, expected) in cases {
        assert_eq!(verdicts(&folder, rules, files), expected, "{rules}");
        // Each in a process of its own.
        assert_eq!(verdicts(&folder, rules, &format!("{files} --file-timeout 100")), expected, "{rules}");
    }
    // A weld, and a search for what else would not be looked for.
    assert_eq!(verdicts(&folder, "", "soup.ply seam.obj"), ["sound", "cracked"]);
    let near = "[[rule]]\nfiles = \"seam.obj\"\nweld = 0.01\n[[rule]]\nfiles = \"soup*\"\nweld = \"none\"\n";
    assert_eq!(verdicts(&folder, near, "soup.ply seam.obj"), ["cracked", "sound"]);
    // What is one mesh: the groups of a cube are open by themselves.
    let groups = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\ng a\nf 1 3 2\nf 1 2 4\ng b\nf 2 3 4\nf 3 1 4\n";
    fs::write(folder.path("groups.obj"), groups).unwrap();
    let scope = |scope: &str| format!("[[rule]]\nfiles = \"groups.*\"\nscope = \"{scope}\"\n");
    for (asked, told, expected) in [
        ("mesh", "", "sound"),
        ("scene", "", "sound"),
        ("primitive", "", "cracked"),
        ("primitive", " --scope mesh", "sound"),
    ] {
        assert_eq!(
            verdicts(&folder, &scope(asked), &format!("groups.obj{told}")),
            [expected],
            "{asked}{told}"
        );
    }
    let crossed =
        "v -1 -1 0\nv 1 -1 0\nv 0 1 0\nv 0 0 -1\nv 0 0 1\nv 0 2 0\nf 1 2 3\nf 3 2 1\nf 4 5 6\nf 6 5 4\n";
    fs::write(folder.path("crossed.obj"), crossed).unwrap();
    let search =
        |asked: bool| format!("[[rule]]\nfiles = \"*\"\nrequire = \"even\"\nself-intersections = {asked}\n");
    assert_eq!(verdicts(&folder, &search(false), "crossed.obj"), ["sound"]);
    assert_eq!(verdicts(&folder, &search(true), "crossed.obj"), ["cracked"]);
}

#[test]
fn rules_give_way_to_the_command_line() {
    let folder = folder();
    let rules = "[[rule]]\nfiles = \"*\"\nrequire = \"even\"\nweld = \"none\"\n";
    assert_eq!(verdicts(&folder, rules, "soup.ply props/inward.obj"), ["cracked", "sound"]);
    assert_eq!(verdicts(&folder, rules, "soup.ply props/inward.obj --weld exact"), ["sound", "sound"]);
    assert_eq!(verdicts(&folder, rules, "props/inward.obj --weld exact --require sound"), ["cracked"]);
    // Another file of rules, instead.
    fs::write(folder.path("other.toml"), "# nothing\n").unwrap();
    assert_eq!(
        verdicts(&folder, rules, "soup.ply props/inward.obj --config other.toml"),
        ["sound", "cracked"]
    );
    // Balance is what --fast decides, whatever else is required.
    assert_eq!(folder.code("check props/inward.obj --fast"), 0);
    fs::write(folder.path("umbrage.toml"), "[[rule]]\nfiles = \"*\"\nweld = 0.5\n").unwrap();
    let run = folder.run("check cube.obj --fast");
    assert!(run.code == 2 && run.stderr.contains("cube.obj: --fast only decides"), "{}", run.stderr);
}

#[test]
fn rules_that_are_none_are_refused_with_their_line() {
    let folder = folder();
    for (rules, said) in [
        (
            "[[rule]]\nfiles = \"*\"\nrequired = \"even\"\n",
            "line 3: unknown key `required`; write one of files, require,",
        ),
        ("[[rules]]\nfiles = \"*\"\n", "line 1: unknown key `rules`; write [[rule]]"),
        ("\n\nweld = 1\n", "line 3: unknown key `weld`; write [[rule]]"),
        ("rule = 3\n", "line 1: `rule` is no list of tables; write [[rule]]"),
        ("# a\n[[rule]]\nrequire = \"even\"\n", "line 2: a rule without `files`; write files ="),
        ("[[rule]]\nfiles = []\n", "line 1: a rule without `files`"),
        ("[[rule]]\nfiles = 1\n", "line 2: `files` is no pattern or list of patterns; write files ="),
        (
            "[[rule]]\nfiles = \"*\"\nrequire = [\"even\", \"closed\"]\n",
            "line 3: unknown property `closed`; write one of not-empty, sound,",
        ),
        (
            "[[rule]]\nfiles = \"*\"\nallow-empty = \"yes\"\n",
            "line 3: `allow-empty` is no true or false; write true or false",
        ),
        ("[[rule]]\nfiles = \"*\"\nweld = -1\n", "line 3: `weld` is no weld; write weld ="),
        ("[[rule]]\nfiles = \"*\"\nweld = \"nan\"\n", "line 3: `weld` is no weld"),
        (
            "[[rule]]\nfiles = \"*\"\nscope = \"file\"\n",
            "line 3: `scope` is no scope; write scope = \"mesh\", \"primitive\" or \"scene\"",
        ),
        ("[[rule]]\nfiles = \"*\n", "line 2:"),
        ("[[rule]\n", "line 1:"),
    ] {
        fs::write(folder.path("umbrage.toml"), rules).unwrap();
        let run = folder.run("check cube.obj");
        assert_eq!((run.code, run.stdout.as_str()), (2, ""), "{rules}");
        assert!(run.stderr.contains(&format!("umbrage.toml: {said}")), "{rules}: {}", run.stderr);
        assert_eq!(run.stderr.lines().count(), 1, "{}", run.stderr);
    }
    fs::write(folder.path("umbrage.toml"), [0xff, 0xfe]).unwrap();
    assert!(folder.run("check cube.obj").stderr.contains("umbrage.toml: cannot be read"));
    let run = folder.run("check cube.obj --config missing.toml");
    assert!(run.code == 2 && run.stderr.contains("missing.toml: cannot be read"), "{}", run.stderr);
}
