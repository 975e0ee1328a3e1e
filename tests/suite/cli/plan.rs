//! `umbrage plan`, and `umbrage render` by a plan.

use std::fs;

use serde_json::{Value, json};
use umbrage::mesh::Mesh;
use umbrage::testing::shapes;

use super::render::png;
use super::{Folder, keys};

const VIEW: &str = "--eye 7,6,8 --target 0,0,0 --size 48x36";

/// A floor, a torus over it, and a cube below that no light of these tests reaches the eye past.
fn folder() -> Folder {
    let folder = Folder::new();
    let floor = shapes::cuboid([-9.0, -2.0, -9.0], [9.0, -1.5, 9.0]);
    let below = shapes::translated(&shapes::cube(), [0.0, -5.0, 0.0]);
    let scene = Mesh::concat(&[floor, shapes::torus(24, 12, 2.0, 0.7), below]).unwrap();
    folder.mesh("scene.obj", &scene);
    folder.mesh("cube.obj", &shapes::cube());
    folder
}

#[test]
fn plan_has_the_agreed_keys_and_meets_an_exact_budget() {
    let folder = folder();
    let document = folder.json(&format!("plan scene.obj --light point:1,9,2 {VIEW}"));
    assert_eq!(
        keys(&document),
        "file budget samples probe lights dropped effects total not_computed planning_ms meets_budget measured"
    );
    assert_eq!(document["budget"], json!({ "error": 0.0, "light": null, "level": 0.0, "time_ms": null }));
    assert_eq!((&document["meets_budget"], &document["measured"]), (&true.into(), &Value::Null));
    let light = &document["lights"][0];
    assert_eq!(keys(light), "light name facing shadowed casters kept technique groups grid");
    assert_eq!(light["light"], "point:1,9,2");
    let group = &light["groups"][0];
    assert_eq!(
        keys(group),
        "receivers samples technique parameters error evidence bound_95 time_ms cost_evidence reason rejected"
    );
    assert_eq!((&group["bound_95"], &group["evidence"]), (&0.0.into(), &"exact".into()));
    assert_eq!(keys(&group["rejected"][0]), "technique parameters error evidence time_ms why");
    assert_eq!(keys(&document["dropped"][0]), "light caster receiver test class bound count");
    // The cube below casts on nothing that is seen.
    let dropped = document["dropped"].as_array().unwrap();
    assert!(dropped.iter().any(|it| it["caster"].is_u64()), "{dropped:?}");
    assert!(light["kept"].as_u64() < light["casters"].as_u64());
}

#[test]
fn plan_prints_a_line_and_a_reason_for_each_light_and_what_is_not_computed() {
    let folder = folder();
    let run =
        folder.run(&format!("plan scene.obj --light point:1,9,2 --light directional:0.2,-1,0.1 {VIEW}"));
    assert_eq!(run.code, 0, "{}", run.stderr);
    for wanted in [
        "scene.obj: plan for 2 lights in a view of 48x36, ",
        "budget: exact, in the least time\n",
        "light 1: point:1,9,2: ",
        "light 2: directional:0.2,-1,0.1: ",
        "\nnot computed:\n",
        "; the budget is met\n",
    ] {
        assert!(run.stdout.contains(wanted), "{wanted}: {}", run.stdout);
    }
}

#[test]
fn plan_of_all_techniques_has_no_error_beyond_what_is_proven() {
    let folder = folder();
    for rest in ["--budget error=0", "--budget error=0.02"] {
        let lights = "--light point:1,9,2 --light point:4,7,2,radius=0.4";
        let run = folder.run(&format!("plan scene.obj {lights} {VIEW} --all --json {rest}"));
        assert_eq!(run.code, 0, "{}", run.stderr);
        let document: Value = serde_json::from_str(&run.stdout).unwrap();
        let mut compared = 0;
        for group in document["lights"]
            .as_array()
            .unwrap()
            .iter()
            .flat_map(|light| light["groups"].as_array().unwrap())
        {
            let truth = group["true_error"].as_f64().unwrap();
            assert!(group["measured_ms"].as_f64().is_some());
            let rivals = group["rejected"].as_array().unwrap();
            // The counter on the CPU counts its work, rays have none.
            for technique in rivals.iter().chain([group]).filter(|it| it["measured_ms"].is_number()) {
                let counts = technique["technique"] == "counter";
                assert_eq!(technique["updates"].is_u64(), counts, "{technique}");
                assert_eq!(technique["fragments"].is_u64(), counts, "{technique}");
            }
            if ["exact", "proven"].contains(&group["evidence"].as_str().unwrap()) {
                assert!(truth <= group["bound_95"].as_f64().unwrap(), "{group}");
                compared += 1;
            }
            // What was rejected, and has no error by its evidence, has none.
            for other in group["rejected"].as_array().unwrap() {
                if other["evidence"] == "exact" && other["error"] == 0.0 {
                    assert_eq!(other["true_error"].as_f64().unwrap_or(0.0), 0.0, "{other}");
                    compared += 1;
                }
            }
        }
        assert!(compared > 2, "{compared}");
        let measured = &document["measured"];
        assert_eq!(keys(measured), "time_ms checked wrong bound_99 fell_back");
        assert!(measured["checked"].as_u64().unwrap() > 100);
    }
}

#[test]
fn plan_that_cannot_be_made_is_refused_with_the_reason() {
    let folder = folder();
    folder.mesh("empty.obj", &Mesh::default());
    fs::write(folder.path("costs.json"), "{").unwrap();
    for (arguments, wanted) in [
        ("plan empty.obj", "empty.obj: there are no faces to cast or to receive a shadow; name a mesh"),
        (
            "plan scene.obj --eye 0,30,0 --target 0,60,1",
            "the view shows no surface that could receive a shadow",
        ),
        ("plan scene.obj --budget error=2", "error=2: `2` is not a fraction from 0 to 1"),
        ("plan scene.obj --budget error=0,error=1", "`error` is given twice"),
        ("plan scene.obj --costs costs.json", "costs are no JSON"),
        ("plan scene.obj --costs none.json", "--costs cannot be read"),
        ("plan scene.obj --no-camera", "not built yet: --no-camera"),
        ("plan scene.obj --picture a.jpg", "pictures are written as PNG only"),
        ("plan", "<FILE>"),
        ("render cube.obj -o a.png --shadow none.json", "none.json: the plan cannot be read"),
        ("render cube.obj -o a.png --shadow costs.json", "costs.json: no JSON"),
        ("render cube.obj -o a.png --shadow costs.json --shadow rays", "a plan is for all lights"),
    ] {
        let run = folder.run(&format!("{arguments} --size 48x36").replace("plan --size 48x36", "plan"));
        assert_eq!(run.code, 2, "{arguments}: {}", run.stdout);
        assert!(run.stderr.contains(wanted), "{arguments}: {}", run.stderr);
    }
}

#[test]
fn render_by_a_saved_plan_is_exact_and_refuses_another_scene_light_or_view() {
    let folder = folder();
    let scene = format!("--light point:1,9,2 {VIEW}");
    assert_eq!(folder.code(&format!("plan scene.obj {scene} -o plan.json")), 0);
    let draw = |shadow: &str, name: &str| {
        let run = folder.run(&format!("render scene.obj {scene} --samples 4 --shadow {shadow} -o {name}"));
        assert_eq!(run.code, 0, "{}", run.stderr);
        (png(&folder, name), run.stderr)
    };
    let (planned, said) = draw("plan.json", "a.png");
    assert!(said.contains("note: point:1,9,2: ") && said.contains("samples compared, 0 wrong"), "{said}");
    // The picture of another exact technique, on the same samples.
    assert_eq!(planned, draw("zpass-plus", "b.png").0);
    assert_eq!(planned, draw("auto", "c.png").0);
    assert_ne!(planned, draw("none", "d.png").0);
    for (file, rest, wanted) in [
        ("cube.obj", scene.clone(), "the plan is for another scene; write it anew"),
        ("scene.obj", scene.replace("1,9,2", "1,9,3"), "the plan is for other lamps; write it anew"),
        ("scene.obj", scene.replace("7,6,8", "7,6,9"), "the plan is for another view; write it anew"),
        ("scene.obj", scene.replace("48x36", "48x40"), "the plan is for another view; write it anew"),
        (
            "scene.obj",
            format!("{scene} --falloff physical"),
            "the plan is for another falloff; write it anew",
        ),
    ] {
        let run = folder.run(&format!("render {file} {rest} --shadow plan.json -o e.png"));
        assert_eq!(run.code, 2, "{wanted}");
        assert!(run.stderr.contains(&format!("plan.json: {wanted}")), "{}", run.stderr);
        assert!(!folder.path("e.png").exists());
    }
}

#[test]
fn render_by_a_plan_that_is_wrong_falls_back_and_says_so_unless_it_is_not_checked() {
    let folder = folder();
    let scene = format!("--light point:1,9,2 {VIEW}");
    assert_eq!(folder.code(&format!("plan scene.obj {scene} -o plan.json")), 0);
    let mut plan: Value = serde_json::from_slice(&fs::read(folder.path("plan.json")).unwrap()).unwrap();
    // The plan now leaves out the shadow, and says that this is exact.
    plan["saved"]["lights"][0]["groups"] = json!([{ "receivers": "all", "technique": "none" }]);
    fs::write(folder.path("wrong.json"), plan.to_string()).unwrap();
    let draw = |rest: &str, name: &str| {
        let run = folder.run(&format!("render scene.obj {scene} --samples 4 {rest} -o {name}"));
        assert_eq!(run.code, 0, "{}", run.stderr);
        (png(&folder, name), run.stderr)
    };
    let right = draw("--shadow plan.json", "right.png").0;
    let (checked, said) = draw("--shadow wrong.json", "a.png");
    assert!(said.contains("0 % allowed, so rays took over"), "{said}");
    assert_eq!(checked, right);
    let (unchecked, said) = draw("--shadow wrong.json --check 0", "b.png");
    assert!(said.contains("; not checked"), "{said}");
    assert_ne!(unchecked, right);
}

#[test]
fn plan_draws_what_is_proven_in_false_colors() {
    let folder = folder();
    let run = folder.run(&format!("plan scene.obj --light point:1,9,2 {VIEW} --picture a.png"));
    assert_eq!(run.code, 0, "{}", run.stderr);
    for wanted in ["yellow proven lit: ", "blue proven dark: ", "wrote a.png"] {
        assert!(run.stderr.contains(wanted), "{}", run.stderr);
    }
    let (width, height, pixels) = png(&folder, "a.png");
    assert_eq!((width, height), (48, 36));
    let yellow = pixels.chunks(4).filter(|pixel| pixel[0] > 130 && pixel[1] > 120 && pixel[2] < 70).count();
    assert!(yellow > 100, "{yellow}");
}

#[test]
fn plan_measures_this_machine_and_takes_the_costs_back() {
    let folder = folder();
    assert_eq!(folder.code("plan --calibrate -o costs.json"), 0);
    let run = folder.run(&format!("plan scene.obj --light point:1,9,2 {VIEW} --costs costs.json"));
    assert_eq!(run.code, 0, "{}", run.stderr);
    let mut costs: Value = serde_json::from_slice(&fs::read(folder.path("costs.json")).unwrap()).unwrap();
    costs["machine"]["cpu"] = "another".into();
    fs::write(folder.path("stale.json"), costs.to_string()).unwrap();
    let run = folder.run(&format!("plan scene.obj {VIEW} --costs stale.json"));
    assert!(
        run.code == 2 && run.stderr.contains("costs of another machine: cpu: `another`"),
        "{}",
        run.stderr
    );
}
