//! `umbrage verify`.

use umbrage::mesh::solid;

use super::{Folder, assert_shape, keys};

#[test]
fn verify_json_has_the_agreed_keys_in_order() {
    let folder = Folder::with_cubes();
    let document = folder.json("verify cube.obj --light point:2,3,5 --points 500");
    assert_shape("verify", &document);
    assert_eq!(
        keys(&document),
        "file format points agree grazing disagree bound_95 strata pixels pixel_agree pixel_grazing \
         pixel_disagree judges lights"
    );
}

#[test]
fn verify_sums_over_the_lights_and_repeats_itself_for_a_seed() {
    let folder = Folder::new();
    folder.mesh("book.obj", &solid::book(5));
    let run = |more: &str| {
        let light = "--light point:2,3,5 --light directional:0,-1,0";
        folder.json(&format!("verify book.obj {light} --points 1000 {more}"))
    };
    let one = run("--seed 7 --threads 1");
    assert_eq!(one["points"], 2000);
    assert_eq!(one["disagree"], 0);
    assert_eq!(one["lights"].as_array().unwrap().len(), 2);
    let sum: u64 =
        one["lights"].as_array().unwrap().iter().map(|light| light["grazing"].as_u64().unwrap()).sum();
    assert_eq!(one["grazing"], sum);
    assert_eq!(one, run("--seed 7 --threads 2"));
    assert_ne!(one["lights"][0]["strata"], run("--seed 8")["lights"][0]["strata"]);
}

#[test]
fn verify_exit_code_is_zero_where_judges_agree_even_on_a_cracked_mesh() {
    let folder = Folder::with_cubes();
    let run = folder.run("verify open.obj --light point:0.2,0.3,9 --points 1000");
    assert_eq!(run.code, 0, "{}", run.stderr);
    assert!(run.stdout.contains("\nverdict: all judges agree\n"), "{}", run.stdout);
    assert!(run.stdout.starts_with("open.obj\nlights: point:0.2,0.3,9\n"), "{}", run.stdout);
    assert!(run.stdout.lines().last().is_some_and(|line| line.starts_with("grazing: ")), "{}", run.stdout);
    for refused in ["--points 0", "--light directional:0,0,0", "--gpu", "--picture x.png"] {
        assert_eq!(folder.code(&format!("verify cube.obj {refused}")), 2, "{refused}");
    }
}
