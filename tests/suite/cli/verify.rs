//! `umbrage verify`.

use serde_json::Value;
use umbrage::caster::Caster;
use umbrage::scene::Scope;
use umbrage::testing::shapes;
use umbrage::verify::points::{Options, Verification, Verifier};

use super::{Folder, assert_shape, keys};

#[test]
fn verify_json_has_the_agreed_keys_in_order() {
    let folder = Folder::with_cubes();
    let document = folder.json("verify cube.obj --light point:2,3,5 --points 500");
    assert_shape("verify", &document);
    assert_eq!(
        keys(&document),
        "file format points agree grazing disagree bound_95 strata pixels pixel_agree pixel_grazing \
         pixel_disagree judges lights stencil"
    );
}

#[test]
fn verify_sums_over_the_lights_and_repeats_itself_for_a_seed() {
    let folder = Folder::new();
    folder.mesh("book.obj", &shapes::book(5));
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
    assert!(run.stdout.contains("\nverdict: all methods agree\n"), "{}", run.stdout);
    assert!(run.stdout.starts_with("open.obj\nlights: point:0.2,0.3,9\n"), "{}", run.stdout);
    assert!(run.stdout.lines().last().is_some_and(|line| line.starts_with("grazing: ")), "{}", run.stdout);
    for refused in ["--points 0", "--light directional:0,0,0"] {
        assert_eq!(folder.code(&format!("verify cube.obj {refused}")), 2, "{refused}");
    }
}

#[test]
fn verify_json_of_a_light_is_that_of_the_library() {
    let folder = Folder::with_cubes();
    let said = &folder.json("verify open.obj --light point:2,3,5 --points 500 --seed 3")["lights"][0];
    let mesh = umbrage::read::read(folder.path("open.obj")).unwrap().bake(Scope::Scene).unwrap().remove(0);
    let caster = Caster::new(umbrage::mesh::weld(&mesh, umbrage::mesh::Weld::Exact).mesh);
    let options = Options { points: 500, seed: 3, keep: 10 };
    let light = "point:2,3,5".parse().unwrap();
    let mut found = Verifier::new(&caster).verify(&light, &options, &|_| {});
    let same = |found: &Verification| {
        // Through text as well, since reading decimals may round.
        let text = serde_json::to_string(found).unwrap();
        let Value::Object(found) = serde_json::from_str(&text).unwrap() else { panic!("an object") };
        assert_eq!(found.len(), 8, "five counts and three lists");
        found.iter().all(|(key, value)| said[key] == *value)
    };
    assert!(same(&found), "{said:#}");
    // Negative test: a disagreement.
    found.strata[0].disagree += 1;
    assert!(!same(&found));
}

#[cfg(feature = "gpu")]
mod gpu {
    use std::fs;
    use std::process::{Command, Output};

    use umbrage::testing::shapes;

    use super::super::{Folder, assert_shape};
    use crate::support::gpu;

    #[test]
    fn verify_gpu_json_has_pixels_that_add_up() {
        if gpu().is_none() {
            return;
        }
        let folder = Folder::with_cubes();
        let lights = "--light point:-3,6,1 --light directional:1,-1,0.2";
        let run = |more: &str| {
            folder.json(&format!("verify cube.obj {lights} --points 100 --gpu --size 96x64 {more}"))
        };
        let document = run("--threads 1");
        assert_shape("verify_gpu", &document);
        let of = |value: &serde_json::Value, key: &str| value[key].as_u64().unwrap();
        let each = document["lights"].as_array().unwrap();
        for key in ["pixels", "pixel_agree", "pixel_grazing", "pixel_disagree"] {
            assert_eq!(of(&document, key), each.iter().map(|light| of(light, key)).sum::<u64>(), "{key}");
        }
        assert_eq!((of(&document, "pixels"), of(&document, "pixel_disagree")), (2 * 96 * 64, 0));
        for light in each {
            let agree = of(light, "pixel_agree");
            assert_eq!(agree + of(light, "pixel_grazing"), 96 * 64);
            for pass in light["passes"].as_array().unwrap() {
                assert!(["sky", "lit", "shadowed"].iter().all(|key| of(pass, key) > 200), "{pass}");
                assert_eq!(pass["counting"], "stencil");
            }
        }
        // Nothing lies between the lamp and the camera: z-pass is proven correct, and compared too.
        assert_eq!(each[0]["passes"][1]["method"], "zpass");
        assert_eq!(document, run("--threads 2"));
    }

    #[test]
    fn verify_gpu_prints_the_method_with_its_reason_and_draws() {
        if gpu().is_none() {
            return;
        }
        let folder = Folder::with_cubes();
        let lights = "--light point:2,3,5 --light point:0.1,0.2,0.3";
        let run =
            folder.run(&format!("verify open.obj {lights} --points 100 --gpu --size 64x64 --picture a.png"));
        assert_eq!(run.code, 0, "{}{}", run.stdout, run.stderr);
        for words in [
            "zfail for 1 shell: z-fail was asked for",
            "counted in the stencil",
            "verdict: all methods agree\n",
        ] {
            assert!(run.stdout.contains(words), "{words}: {}", run.stdout);
        }
        assert!(run.stderr.contains("wrote a.png: background sky, light gray lit"), "{}", run.stderr);
        for name in ["a.png", "a-2.png"] {
            let reader = png::Decoder::new(std::io::Cursor::new(fs::read(folder.path(name)).unwrap()));
            let info = reader.read_info().unwrap();
            assert_eq!((info.info().width, info.info().height), (64, 64));
        }
    }

    #[test]
    fn verify_gpu_takes_any_view_and_any_mesh() {
        if gpu().is_none() {
            return;
        }
        let folder = Folder::with_cubes();
        folder.mesh("tiny.obj", &shapes::scaled(&shapes::cube(), 1e-30));
        folder.mesh("huge.ply", &shapes::scaled(&shapes::cube(), 1e37));
        fs::write(folder.path("empty.obj"), "v 1 2 3\n").unwrap();
        for arguments in [
            "cube.obj --size 1x1",
            "cube.obj --size 3x200",
            "cube.obj --eye 0.1,0.2,0.3 --target 5,5,5 --fov 120", // inside
            "cube.obj --eye 9,9,9 --target 99,99,99",              // nothing in view
            "tiny.obj",
            "huge.ply",
            "empty.obj",
        ] {
            let run = folder
                .run(&format!("verify {arguments} --points 50 --gpu --light point:2,3,5 --picture a.png"));
            assert_eq!(run.code, 0, "{arguments}: {}{}", run.stdout, run.stderr);
        }
    }

    #[test]
    fn verify_gpu_overflow_is_counted_in_whole_numbers_instead() {
        if gpu().is_none() {
            return;
        }
        let folder = Folder::new();
        folder.mesh("nested.ply", &shapes::nested_cubes(300));
        let document = folder.json("verify nested.ply --light point:9,8,7 --points 50 --gpu --size 32x32");
        assert_eq!(document["lights"][0]["passes"][0]["counting"], "integer");
        assert_eq!(document["pixel_disagree"], 0);
    }

    /// Runs the command with one more environment variable, such as a Vulkan loader that finds no driver.
    fn with(folder: &Folder, variable: (&str, &str), arguments: &[&str]) -> Output {
        Command::new(assert_cmd::cargo::cargo_bin!("umbrage"))
            .current_dir(folder.path("."))
            .args(arguments)
            .env(variable.0, variable.1)
            .output()
            .unwrap()
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn verify_gpu_without_an_adapter_names_the_package() {
        let folder = Folder::with_cubes();
        let run =
            with(&folder, ("VK_DRIVER_FILES", "/does/not/exist.json"), &["verify", "cube.obj", "--gpu"]);
        let said = String::from_utf8(run.stderr).unwrap();
        assert_eq!((run.status.code(), run.stdout.len()), (Some(2), 0), "{said}");
        assert!(
            said.contains("umbrage: no graphics adapter") && said.contains("mesa-vulkan-drivers"),
            "{said}"
        );
    }

    #[test]
    fn verify_gpu_adapter_that_is_not_there_is_refused_with_the_ones_that_are() {
        if gpu().is_none() {
            return;
        }
        let folder = Folder::with_cubes();
        let run = folder.run("verify cube.obj --gpu --adapter no-such-card");
        assert_eq!((run.code, run.stdout.as_str()), (2, ""));
        assert!(
            run.stderr.contains("`no-such-card`") && run.stderr.contains("choose one of: "),
            "{}",
            run.stderr
        );
        let run = with(&folder, ("UMBRAGE_ADAPTER", "no-such-card"), &["verify", "cube.obj", "--gpu"]);
        assert_eq!(run.status.code(), Some(2));
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn verify_gpu_of_more_pixels_than_memory_is_refused_in_one_line() {
        if gpu().is_none() {
            return;
        }
        let folder = Folder::with_cubes();
        let command = "ulimit -v 4000000; exec \"$0\" verify cube.obj --light point:3,5,4 --points 10 --threads 2 \
                       --gpu --size 16384x16384";
        let output = Command::new("sh")
            .current_dir(folder.path("."))
            .args(["-c", command])
            .arg(assert_cmd::cargo::cargo_bin!("umbrage"))
            .output()
            .unwrap();
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{said}");
        assert!(said.contains("--size") && !said.contains("panicked"), "{said}");
    }
}
