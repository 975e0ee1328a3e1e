//! `umbrage accuracy`.

use std::fs;

use serde_json::Value;
use umbrage::testing::shapes;

use super::{Folder, assert_shape, keys};
use crate::chart::well_formed;

const FEW: &str = "--light point:2,3,5 --queries 500 --rounds 1";

/// A folder with the cubes and with meshes on which rounding decides something.
fn folder() -> Folder {
    let folder = Folder::with_cubes();
    folder.mesh("torus.obj", &shapes::torus(24, 12, 2.0, 0.7));
    folder
}

/// A document without its times, which differ between runs.
fn timeless(mut document: Value) -> Value {
    for file in document["files"].as_array_mut().unwrap() {
        for method in file["methods"].as_array_mut().unwrap() {
            for key in ["ratio", "prepare_ns_per_face", "dominated"] {
                method[key].take();
            }
            let strata = method["strata"].as_array_mut().unwrap().iter_mut().collect::<Vec<_>>();
            for row in strata {
                redact(row);
            }
            redact(method);
        }
    }
    document
}

fn redact(row: &mut Value) {
    let times = ["min_ns", "ns_per_query", "max_ns"].map(|key| row[key].take().as_f64().unwrap());
    assert!(times[0] > 0.0 && times[0] <= times[1] && times[1] <= times[2], "{times:?}");
}

#[test]
fn accuracy_json_has_the_agreed_keys_in_order() {
    let folder = folder();
    for what in ["facing", "visibility"] {
        let document = folder.json(&format!("accuracy {what} torus.obj {FEW}"));
        assert_shape(&format!("accuracy_{what}"), &document);
        assert_eq!(keys(&document), "what queries seed rounds files");
        let file = &document["files"][0];
        assert_eq!(keys(file), "file format error mesh lights exact_is_right judged_by_all_faces methods");
        assert_eq!(
            keys(&file["methods"][0]),
            "name exact ns_per_query min_ns max_ns ratio prepare_ns_per_face wrong queries ties judged bound_95 \
             dominated strata"
        );
        assert_eq!(
            keys(&file["methods"][0]["strata"][0]),
            "name queries ties judged wrong bound_95 ns_per_query min_ns max_ns"
        );
        assert_eq!((&document["what"], &file["mesh"]["faces"]), (&what.into(), &576.into()));
        let methods = file["methods"].as_array().unwrap();
        assert!(methods.iter().all(|method| method["exact"] == false || method["wrong"] == 0), "{file}");
        assert!(methods.iter().any(|method| method["dominated"] == false), "{file}");
    }
}

#[test]
fn accuracy_repeats_itself_for_a_seed_but_for_times() {
    let folder = folder();
    for what in ["facing", "visibility"] {
        let run =
            |more: &str| timeless(folder.json(&format!("accuracy {what} torus.obj cube.obj {FEW} {more}")));
        let one = run("--seed 3");
        assert_eq!(one, run("--seed 3"));
        assert_ne!(one["files"], run("--seed 4")["files"]);
        assert_eq!(one["files"].as_array().unwrap().len(), 2);
    }
}

#[test]
fn accuracy_prints_tables_and_what_exactness_costs() {
    let folder = folder();
    for (what, named) in [
        ("facing", ["plain f64", "filtered planes", "always exact", "one_ulp_off"]),
        ("visibility", ["plain f32", "exact ray cast", "whole numbers", "behind_vertex"]),
    ] {
        let run = folder.run(&format!("accuracy {what} torus.obj cube.obj {FEW}"));
        assert_eq!((run.code, run.stderr.as_str()), (0, ""));
        assert!(
            run.stdout.starts_with(&format!("torus.obj: {what}, 288 vertices, 576 faces, seed 1, 1 round"))
        );
        for words in named.into_iter().chain([
            "\nlights: point:2,3,5\ntruth: every ",
            "\n  method ",
            "\n  ns ",
            "\n  wrong of queries ",
            "\n\ncube.obj: ",
            "\nexactness removes ",
            "\nverdict: no exact method was wrong\n",
        ]) {
            assert!(run.stdout.contains(words), "{words}: {}", run.stdout);
        }
        assert!(run.stdout.lines().last().is_some_and(|line| line.starts_with("ns: ")), "{}", run.stdout);
    }
}

/// The records of a CSV table (RFC 4180).
fn records(text: &str) -> Vec<Vec<String>> {
    let (mut records, mut fields, mut field) = (Vec::new(), Vec::new(), String::new());
    let (mut quoted, mut rest) = (false, text.chars().peekable());
    while let Some(c) = rest.next() {
        match c {
            '"' if quoted && rest.peek() == Some(&'"') => field.extend(rest.next()),
            '"' => quoted = !quoted,
            ',' if !quoted => fields.push(std::mem::take(&mut field)),
            '\r' if !quoted => {
                assert_eq!(rest.next(), Some('\n'), "records end with both");
                fields.push(std::mem::take(&mut field));
                records.push(std::mem::take(&mut fields));
            }
            c => field.push(c),
        }
    }
    assert!(fields.is_empty() && field.is_empty() && !quoted, "the last record ends too");
    records
}

#[test]
fn accuracy_csv_has_a_row_for_each_file_method_and_stratum() {
    let folder = folder();
    fs::rename(folder.path("cube.obj"), folder.path("a,b.obj")).unwrap();
    for (what, methods, strata) in [("facing", 5, 8), ("visibility", 3, 7)] {
        let run = folder.run(&format!("accuracy {what} torus.obj a,b.obj {FEW} --csv out.csv"));
        assert_eq!((run.code, run.stderr.as_str()), (0, "umbrage: wrote out.csv\n"));
        let records = records(&fs::read_to_string(folder.path("out.csv")).unwrap());
        let column = |name: &str| records[0].iter().position(|other| other == name).unwrap();
        assert_eq!(records.len(), 1 + 2 * methods * (strata + 1));
        assert!(records.iter().all(|record| record.len() == records[0].len()));
        let of = |name: &str| -> Vec<&str> {
            let rows = records[1..].iter().filter(|record| record[column("file")] == name);
            rows.map(|record| record[column("stratum")].as_str()).collect()
        };
        assert_eq!(of("torus.obj"), of("a,b.obj"));
        assert_eq!(of("torus.obj").iter().filter(|&&stratum| stratum == "all").count(), methods);
        for record in &records[1..] {
            let number = |name: &str| record[column(name)].parse::<f64>().unwrap();
            assert!(number("min_ns") <= number("median_ns") && number("median_ns") <= number("max_ns"));
            let method = record[column("method")].as_str();
            let prepared = method == "filtered planes" || (what == "visibility" && method != "whole numbers");
            assert_eq!(!record[column("prepare_ns_per_face")].is_empty(), prepared, "{method}");
            assert!(number("wrong") <= number("judged") && number("judged") <= number("queries"));
            assert_eq!(
                record[column("bound_95")].is_empty(),
                number("wrong") > 0.0 || number("judged") == 0.0
            );
        }
    }
}

/// The texts of a chart with their positions: left, baseline, size, content.
fn texts(svg: &str) -> Vec<(f64, f64, f64, String)> {
    let attribute = |tag: &str, name: &str| -> Option<f64> {
        tag.split(&format!(" {name}=\"")).nth(1)?.split('"').next()?.parse().ok()
    };
    let tags = svg.split("<text").skip(1).filter(|text| !text.contains("text-anchor"));
    tags.map(|text| {
        let (tag, content) = text.split_once('>').unwrap();
        let content = content.split("</text>").next().unwrap().to_owned();
        let size = attribute(tag, "font-size").unwrap_or(13.0);
        (attribute(tag, "x").unwrap(), attribute(tag, "y").unwrap(), size, content)
    })
    .collect()
}

#[test]
fn accuracy_svg_is_well_formed_and_no_text_runs_over_another() {
    let folder = folder();
    for (what, methods) in [("facing", 5), ("visibility", 3)] {
        let run = folder.run(&format!("accuracy {what} torus.obj cube.obj {FEW} --svg out.svg"));
        assert_eq!((run.code, run.stderr.as_str()), (0, "umbrage: wrote out.svg\n"));
        let svg = fs::read_to_string(folder.path("out.svg")).unwrap();
        assert!(well_formed(&svg) && !svg.contains("NaN") && !svg.contains("inf"), "{svg}");
        assert_eq!(svg.matches("<title>").count(), 2 * methods);
        assert_eq!(svg.matches("prefers-color-scheme:dark").count(), 1);
        // Methods without wrong answers have hollow marks.
        let hollow = svg.matches("stroke:currentColor").count();
        assert!(hollow >= 2 * (methods - 2) && hollow <= 2 * methods, "{hollow}");
        assert_no_text_runs_over_another(&svg);
    }
}

fn assert_no_text_runs_over_another(svg: &str) {
    let texts = texts(svg);
    for (i, (x, y, size, text)) in texts.iter().enumerate() {
        let width = |size: f64, text: &str| 0.5 * size * text.chars().count() as f64;
        assert!(*x >= 0.0 && x + width(*size, text) <= 760.0, "{text}");
        for (other_x, other_y, other_size, other) in &texts[..i] {
            let beside = *x >= other_x + width(*other_size, other) || *other_x >= x + width(*size, text);
            assert!(beside || (y - other_y).abs() >= size.min(*other_size), "{text} over {other}");
        }
    }
}

#[test]
fn accuracy_of_shadows_page_is_one_file_with_every_technique_beside_the_truth() {
    let folder = folder();
    fs::copy(folder.path("torus.obj"), folder.path("a<b>&.obj")).unwrap();
    let techniques = "--shadow rays --shadow samples:n=4 --shadow none --rounds 1 --html a.html";
    let view = "--ground --light point:2,3,5,radius=0.5 --size 64x48";
    let run = folder.run(&format!("accuracy shadow a<b>&.obj {view} {techniques}"));
    assert_eq!(run.code, 0, "{}", run.stderr);
    let page = fs::read_to_string(folder.path("a.html")).unwrap();
    assert!(
        page.starts_with("<!DOCTYPE html>") && page.contains("a&lt;b&gt;&amp;.obj") && !page.contains("a<b>")
    );
    assert_eq!(page.matches("<section class=\"technique\">").count(), 3);
    // The truth; of each row a picture and its errors, and three enlarged regions.
    assert_eq!(page.matches("src=\"data:image/png;base64,").count(), 1 + 3 * (2 + 3));
    assert!(!page.contains("src=\"http") && !page.contains("href=") && !page.contains("@import"));
    assert_eq!(page.matches("<svg").count(), 2);
    // Sabotage of the table: no light at all has the largest mean error, and says so.
    let cells: Vec<&str> = page.split("<td>samples:n=4</td>").nth(1).unwrap().split("<td").take(12).collect();
    assert!(cells.iter().any(|cell| cell.contains("data-value=\"0.0")), "{cells:?}");
    // Other questions have no such page.
    assert_eq!(folder.code("accuracy facing torus.obj --html a.html"), 2);
}

#[test]
fn accuracy_of_several_files_measures_those_that_can_be_read() {
    let folder = folder();
    fs::write(folder.path("empty.obj"), "v 1 2 3\n").unwrap();
    let arguments = format!("accuracy facing cube.obj garbled.stl empty.obj {FEW}");
    let run = folder.run(&format!("{arguments} --json --csv out.csv"));
    assert_eq!(run.code, 2, "what could not be read outranks everything");
    assert!(run.stderr.contains("umbrage: garbled.stl"), "{}", run.stderr);
    assert!(run.stderr.contains("empty.obj: there are no faces to ask about; "), "{}", run.stderr);
    let document: Value = serde_json::from_str(&run.stdout).unwrap();
    let errors = [0, 1, 2].map(|file| document["files"][file]["error"].as_str().map(str::to_owned));
    assert!(errors[0].is_none() && errors[1].is_some() && errors[2].is_some(), "{errors:?}");
    for file in [1, 2] {
        let entry = &document["files"][file];
        assert_eq!(keys(entry), keys(&document["files"][0]));
        assert!(["mesh", "lights", "methods", "exact_is_right"].iter().all(|key| entry[key].is_null()));
    }
    assert_eq!(records(&fs::read_to_string(folder.path("out.csv")).unwrap()).len(), 1 + 5 * 9);

    let run = folder.run(&format!("accuracy facing garbled.stl {FEW} --csv none.csv --svg none.svg"));
    assert_eq!((run.code, run.stdout.as_str()), (2, ""));
    assert!(!folder.path("none.csv").exists() && !folder.path("none.svg").exists());
}

#[test]
fn accuracy_takes_any_mesh_and_any_light() {
    let folder = Folder::new();
    folder.mesh("tiny.obj", &shapes::scaled(&shapes::cube(), 1e-38));
    folder.mesh("huge.ply", &shapes::scaled(&shapes::cube(), 1e37));
    fs::write(folder.path("line.obj"), "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\nf 1 1 1\n").unwrap();
    for file in ["tiny.obj", "huge.ply", "line.obj"] {
        for what in ["facing", "visibility"] {
            for light in ["point:0,0,0", "point:3e38,-3e38,1e-45", "directional:1e-45,3e38,0"] {
                let run = folder.run(&format!(
                    "accuracy {what} {file} --light {light} --queries 40 --rounds 1 --svg out.svg"
                ));
                assert_eq!(run.code, 0, "{what} {file} {light}: {}{}", run.stdout, run.stderr);
                assert!(well_formed(&fs::read_to_string(folder.path("out.svg")).unwrap()));
            }
        }
    }
}

#[test]
fn accuracy_of_shadows_has_the_agreed_keys_and_every_technique() {
    let folder = folder();
    let asked = "--light point:2,3,5 --light directional:0,-1,0.2 --size 48x32 --rounds 1";
    let document = folder.json(&format!("accuracy shadow torus.obj {asked}"));
    assert_eq!(keys(&document), "file samples lights");
    assert_eq!((&document["samples"], document["lights"].as_array().unwrap().len()), (&1536.into(), 2));
    for light in document["lights"].as_array().unwrap() {
        assert_eq!(keys(light), "name truth rows plan");
        assert_eq!(keys(&light["truth"]), "method bound");
        let rows = light["rows"].as_array().unwrap();
        let all: Vec<&str> =
            umbrage::shadow::Technique::ALL.iter().map(|technique| technique.name()).collect();
        let (on_cpu, on_device): (Vec<&Value>, Vec<&Value>) =
            rows.iter().partition(|row| row["device"].is_null());
        let names = |rows: &[&Value]| -> Vec<String> {
            rows.iter().map(|row| row["technique"].as_str().unwrap().to_owned()).collect()
        };
        // The map is there three times: at its default size, at twice and at four times that.
        let mut found = names(&on_cpu);
        found.dedup();
        assert_eq!((found, on_cpu.len()), (all.iter().map(|&name| name.to_owned()).collect(), all.len() + 2));
        let sizes = on_cpu.iter().filter(|row| row["technique"] == "map");
        let sizes: Vec<u64> = sizes.map(|row| row["parameters"]["size"].as_u64().unwrap()).collect();
        assert_eq!(sizes, [1024, 2048, 4096]);
        // Then the device form of those that have one, where there is an adapter.
        let on_device = names(&on_device);
        assert!(
            on_device.is_empty()
                || on_device.starts_with(&["stencil".into(), "zfail".into(), "zpass".into()])
        );
        let maps =
            ["map", "pcf", "hybrid-3x3", "pcss", "single-sample", "hybrid", "zpass-plus"].map(str::to_owned);
        assert!(on_device.is_empty() || maps.iter().all(|map| on_device.contains(map)), "{on_device:?}");
        assert!(on_device.iter().all(|name| all.contains(&name.as_str())), "{on_device:?}");
        assert!(rows[on_cpu.len()..].iter().all(|row| row["device"].is_string()));
        for row in rows {
            assert_eq!(
                keys(row),
                "technique parameters device claim judged wrong acne leak alias_dark alias_lit outside asked_exactly \
                 mean_error mean_signed_error p99_error max_error penumbra_mean_error reads fragments updates bias_world texel_world \
                 prepare_ms frame_ms readback_ms bytes dominated_by"
            );
            assert!(row["judged"].as_u64().unwrap() > 100);
            // Only what rasterizes volumes on the CPU counts its work.
            let counts =
                ["counter", "zpass-reversed", "reconstruct"].contains(&row["technique"].as_str().unwrap());
            assert_eq!(row["updates"].is_u64() && row["fragments"].is_u64(), counts, "{row}");
            let exact = row["claim"] == "exact" || row["claim"] == "within_footprint";
            assert!(!exact || row["wrong"] == 0, "{row}");
            assert!(row["frame_ms"].as_f64().unwrap() >= 0.0);
        }
        // Unshadowed light (`none`) or no light at all (`dark`) is wrong somewhere.
        let wrong = |name: &str| {
            let row = rows.iter().find(|row| row["technique"] == name).unwrap();
            row["wrong"].as_u64().unwrap()
        };
        assert!(wrong("none") + wrong("dark") > 0);
    }
}

/// A search on an adapter has a row of its own, beside that of the CPU; without an adapter it is refused.
#[test]
fn accuracy_of_a_search_on_a_device_is_beside_that_of_the_cpu() {
    let folder = folder();
    let asked = "accuracy shadow torus.obj --light point:2,3,5,radius=0.3 --size 48x32 --rounds 1 \
                 --shadow single-sample:size=64,search=device";
    if cfg!(target_os = "linux") {
        let run = folder.run_without_adapter(asked);
        assert!(run.code == 2 && run.stderr.contains("mesa-vulkan-drivers"), "{}", run.stderr);
    }
    if crate::support::gpu().is_none() {
        return;
    }
    let document = folder.json(asked);
    let rows = document["lights"][0]["rows"].as_array().unwrap();
    let found: Vec<_> =
        rows.iter().map(|row| (row["device"].is_string(), row["parameters"]["search"].as_str())).collect();
    assert_eq!(found, [(false, Some("cpu")), (true, Some("device"))]);
    let errors = [0, 1].map(|row: usize| rows[row]["mean_error"].as_f64().unwrap());
    assert!((errors[0] - errors[1]).abs() < 0.01, "{errors:?}");
}

#[test]
fn accuracy_of_shadows_is_drawn_for_each_light_with_a_mark_for_each_row() {
    let folder = folder();
    let asked =
        "--light point:2,3,5 --light directional:0,-1,0.2 --size 48x32 --rounds 1 --svg a.svg --csv a.csv";
    assert_eq!(folder.code(&format!("accuracy shadow torus.obj {asked}")), 0);
    let svg = fs::read_to_string(folder.path("a.svg")).unwrap();
    assert!(well_formed(&svg));
    assert_no_text_runs_over_another(&svg);
    let rows = fs::read_to_string(folder.path("a.csv")).unwrap().lines().count() - 1;
    assert_eq!(svg.matches("<title>").count(), rows);
    assert_eq!(svg.matches("Error against time: shadows of one light").count(), 2);
    // Rays are never wrong, and their mark is hollow; no light at all is wrong where the light is.
    let of = |name: &str| svg.lines().find(|line| line.contains(&format!("<title>{name}: "))).unwrap();
    assert!(of("rays").contains("class=\"paper\"") && !of("dark").contains("class=\"paper\""));
}

#[test]
fn accuracy_of_shadows_refuses_what_is_about_queries_and_the_others_what_is_about_views() {
    let folder = folder();
    for (arguments, line) in [
        (
            "accuracy shadow torus.obj --queries 5",
            "--queries: `accuracy shadow` asks about every sample of its view",
        ),
        ("accuracy facing torus.obj --size 9x9", "--size: only `accuracy shadow` has a view"),
    ] {
        let output = folder.run(arguments);
        assert_eq!(output.code, 2, "{arguments}");
        assert!(output.stderr.contains(line), "{arguments}");
    }
}

/// A folder with a folded mesh and one with hard edges.
fn ambient_folder() -> Folder {
    let folder = folder();
    folder.mesh("sponge.obj", &shapes::menger_sponge(1));
    folder
}

const FEW_RECEIVERS: &str = "--queries 40 --rounds 1";

#[test]
fn accuracy_of_ambient_has_the_agreed_keys_and_a_row_for_each_method() {
    let folder = ambient_folder();
    for (file, judged) in [("torus.obj", 40), ("sponge.obj", 40), ("cube.obj", 24)] {
        let document = folder.json(&format!("accuracy ambient {file} {FEW_RECEIVERS}"));
        assert_eq!(keys(&document), "file receivers judged truth rows");
        assert_eq!((&document["file"], &document["judged"]), (&file.into(), &judged.into()));
        assert_eq!(keys(&document["truth"]), "method bound");
        assert!(document["truth"]["bound"].as_f64().unwrap() < 1e-9);
        let rows = document["rows"].as_array().unwrap();
        let names: Vec<&str> = rows.iter().map(|row| row["method"].as_str().unwrap()).collect();
        let mut all = vec!["constant"];
        all.extend([["rays"; 8].as_slice(), &["disks"; 3], &["literal"; 2], &["exact"]].concat());
        assert_eq!(names, all);
        for row in rows {
            assert_eq!(
                keys(row),
                "method parameters mean_error rms_error p99_error prepare_ms ns_per_receiver dominated_by"
            );
            assert!(row["rms_error"].as_f64() >= row["mean_error"].as_f64());
        }
        assert_eq!(rows[1]["parameters"], serde_json::json!({ "rays": 4, "smooth": "none" }));
        assert_eq!(rows[10]["parameters"]["theta"], 0.5);
        assert!(rows[0]["parameters"].is_null());
        // On a cube nothing hides anything; elsewhere 256 rays are nearer to the truth than 4.
        let error = |row: usize| rows[row]["mean_error"].as_f64().unwrap();
        assert!(if file == "cube.obj" { error(1) == 0.0 } else { error(7) < error(1) });
    }
    let several = folder.json(&format!("accuracy ambient cube.obj torus.obj {FEW_RECEIVERS}"));
    assert_eq!(several.as_array().unwrap().len(), 2);
}

#[test]
fn accuracy_of_ambient_takes_other_numbers_of_rays() {
    let folder = ambient_folder();
    let document = folder.json(&format!("accuracy ambient sponge.obj {FEW_RECEIVERS} --rays 28,512"));
    let rows = document["rows"].as_array().unwrap();
    assert_eq!(rows.len(), 1 + 4 + 3 + 2 + 1);
    for (row, (rays, smooth)) in
        rows[1..].iter().zip([(28, "none"), (28, "ring"), (512, "none"), (512, "ring")])
    {
        assert_eq!(row["parameters"], serde_json::json!({ "rays": rays, "smooth": smooth }));
    }
    assert!(rows[3]["mean_error"].as_f64() < rows[1]["mean_error"].as_f64());
}

#[test]
fn accuracy_of_ambient_prints_a_table_and_draws_a_mark_for_each_row() {
    let folder = ambient_folder();
    let outputs = "--svg a.svg --csv a.csv";
    let run = folder.run(&format!("accuracy ambient sponge.obj torus.obj {FEW_RECEIVERS} {outputs}"));
    assert_eq!(run.code, 0, "{}", run.stderr);
    assert!(run.stdout.contains("rays:rays=64,smooth=ring") && run.stdout.contains("truth: analytic"));
    assert!(!run.stderr.contains("--light"), "{}", run.stderr);
    let svg = fs::read_to_string(folder.path("a.svg")).unwrap();
    assert!(well_formed(&svg));
    assert_no_text_runs_over_another(&svg);
    let csv = fs::read_to_string(folder.path("a.csv")).unwrap();
    let columns = csv.lines().next().unwrap().split(',').count();
    assert_eq!((csv.lines().count(), columns), (1 + 2 * 15, 12));
    // All but the constant, which takes no time.
    assert_eq!(svg.matches("<title>").count(), 2 * 14);
    let of = |name: &str| svg.lines().find(|line| line.contains(&format!("<title>{name}: "))).unwrap();
    assert!(of("exact").contains("class=\"paper\"") && !of("literal").contains("class=\"paper\""));
}

#[test]
fn accuracy_of_ambient_refuses_lights_views_and_empty_meshes() {
    let folder = ambient_folder();
    for (arguments, line) in [
        (
            "torus.obj --light point:1,2,3",
            "--light: the light of `accuracy ambient` comes from the whole sky",
        ),
        ("torus.obj --size 9x9", "--size: only `accuracy shadow` has a view"),
        ("torus.obj --queries 0", "--queries 0 is not between 1 and"),
        ("torus.obj --rays 16,0", "write a whole number from 1 to 1048576"),
        ("missing.obj --csv a.csv", "missing.obj"),
    ] {
        let run = folder.run(&format!("accuracy ambient {arguments}"));
        assert_eq!(run.code, 2, "{arguments}");
        assert!(run.stderr.contains(line), "{arguments}: {}", run.stderr);
    }
    assert!(!folder.path("a.csv").exists());
    let run = folder.run("accuracy facing torus.obj --rays 16");
    assert!(run.code == 2 && run.stderr.contains("--rays: only `accuracy ambient`"), "{}", run.stderr);
}
