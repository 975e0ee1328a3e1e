//! Every command of the README runs.

use super::*;

const README: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/README.md");

/// The lines of the README's shell blocks that run the command, without comments.
fn commands() -> Vec<String> {
    let text = fs::read_to_string(README).unwrap();
    let mut commands = Vec::new();
    let mut is_shell = false;
    for line in text.lines() {
        match line.strip_prefix("```") {
            Some(kind) => is_shell = kind == "sh",
            None if is_shell => {
                let command = line.split(" #").next().unwrap_or_default().trim();
                commands.extend(command.strip_prefix("umbrage ").map(str::to_owned));
            }
            None => {}
        }
    }
    commands
}

/// The same with less work: small pictures, few rounds.
fn quick(command: &str) -> String {
    let more = match command.split(' ').next().unwrap() {
        "render" | "plan" => " --size 48x36",
        "accuracy" => " --size 24x18 --rounds 1",
        "ambient" => " --rays 4",
        _ => "",
    };
    let fewer = command.replace("--points 10000", "--points 500").replace("--queries 1e5", "--queries 1000");
    fewer + more
}

#[test]
fn readme_has_only_commands_that_run() {
    let folder = animate::folder(); // with moving.gltf
    let model = Model { layers: vec![Layer::from(&shapes::torus(12, 6, 2.0, 0.7))] };
    write(&model, folder.path("model.glb")).unwrap();
    fs::create_dir(folder.path("assets")).unwrap();
    write(&model, folder.path("assets/model.glb")).unwrap();
    let commands = commands();
    assert!(commands.len() > 10, "{commands:?}");
    for command in &commands {
        let (arguments, into) = match command.split_once(" > ") {
            Some((arguments, file)) => (arguments, Some(file)),
            None => (command.as_str(), None),
        };
        let arguments = quick(arguments);
        let run = folder.run(&arguments);
        assert_eq!(run.code, 0, "umbrage {arguments}: {}", run.stderr);
        if let Some(file) = into {
            fs::write(folder.path(file), run.stdout).unwrap();
        }
        let mut words = command.split(' ');
        while let Some(word) = words.next() {
            if ["-o", "--animate", "--picture", "--html", "--junit", "--svg"].contains(&word) {
                let file = words.next().unwrap();
                assert!(fs::metadata(folder.path(file)).unwrap().len() > 100, "{command}: {file}");
            }
        }
    }
    // Negative test: a command with a slip is none.
    assert_eq!(folder.code("check model.glb --no-such-option"), 2);
}

#[test]
fn readme_names_every_technique_and_no_other() {
    let text = fs::read_to_string(README).unwrap();
    let table = text.split("| names | what they are | promise |").nth(1).expect("the table of techniques");
    let table = table.split("\n\n").next().unwrap();
    let named: std::collections::BTreeSet<&str> = (table.lines())
        .filter_map(|row| row.split('|').nth(1))
        .flat_map(|cell| cell.split('`').skip(1).step_by(2))
        .collect();
    let mut built: std::collections::BTreeSet<&str> =
        umbrage::shadow::Technique::ALL.iter().map(|technique| technique.name()).collect();
    built.insert("auto");
    assert_eq!(named, built);
}
