//! `umbrage render` and `umbrage check --picture`.

use std::fs;

use umbrage::mesh::Mesh;
use umbrage::testing::shapes;

use super::Folder;
use crate::support::gpu;

/// Width, height and pixels.
pub(super) fn png(folder: &Folder, name: &str) -> (u32, u32, Vec<u8>) {
    let bytes = fs::read(folder.path(name)).unwrap();
    let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().unwrap();
    let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut pixels).unwrap();
    (info.width, info.height, pixels)
}

#[test]
fn render_writes_the_same_picture_whatever_the_threads() {
    let folder = Folder::with_cubes();
    let run = folder.run("render cube.obj --ground --size 64x48 --method rays -o a.png");
    assert_eq!((run.code, run.stdout.as_str()), (0, ""), "{}", run.stderr);
    assert_eq!(folder.code("render cube.obj --ground --size 64x48 --method rays -o b.png --threads 1"), 0);
    assert_eq!(fs::read(folder.path("a.png")).unwrap(), fs::read(folder.path("b.png")).unwrap());
    let (width, height, pixels) = png(&folder, "a.png");
    assert_eq!((width, height, pixels.len()), (64, 48, 64 * 48 * 4));
}

#[test]
fn render_takes_the_eye_the_lights_and_the_ground_that_are_asked_for() {
    let folder = Folder::with_cubes();
    let rest = "--size 64x48 --method rays -o a.png";
    let mut seen = Vec::new();
    for asked in [
        "--light point:3,5,4",
        "--light point:3,5,4 --light directional:1,-1,0",
        "--light point:3,5,4 --ground",
        "--light point:3,5,4 --eye -4,3,2 --target 0,0,0",
        "--light point:3,5,4 --eye -4,3,2 --target 0,0,0 --fov 60",
    ] {
        let run = folder.run(&format!("render cube.obj {asked} {rest}"));
        assert_eq!((run.code, run.stderr.as_str()), (0, "umbrage: wrote a.png\n"), "{asked}");
        let picture = png(&folder, "a.png");
        assert!(!seen.contains(&picture), "{asked} changes nothing");
        seen.push(picture);
    }
}

#[test]
fn check_draws_the_open_edges_in_red_and_says_so() {
    let folder = Folder::with_cubes();
    folder.mesh("bow.obj", &shapes::cubes_sharing_vertex());
    let run = folder.run("check open.obj --picture a.png");
    assert_eq!(run.code, 1);
    assert!(run.stderr.contains("red boundary_loop"), "{}", run.stderr);
    let red = |name: &str| {
        let (width, height, pixels) = png(&folder, name);
        assert_eq!((width, height), (960, 540));
        pixels.chunks(4).filter(|pixel| pixel[0] > 200 && pixel[1] < 60 && pixel[2] < 60).count()
    };
    // Four edges, each some hundred pixels long and two wide.
    assert!(red("a.png") > 500, "{}", red("a.png"));
    let run = folder.run("check cube.obj --picture b.png");
    assert_eq!((run.code, red("b.png")), (0, 0));
    assert!(run.stderr.ends_with("wrote b.png: no defects\n"), "{}", run.stderr);
    assert!(folder.run("check bow.obj --picture c.png").stderr.contains("cyan non_manifold_vertex"));
}

#[cfg(target_os = "linux")]
#[test]
fn render_of_more_pixels_than_memory_is_refused_in_one_line() {
    let folder = Folder::with_cubes();
    // The pixels alone take 1 GiB.
    let command = "ulimit -v 1000000; exec \"$0\" render cube.obj --light point:3,5,4 --method rays --threads 2 \
                   --size 16384x16384 -o a.png";
    let output = std::process::Command::new("sh")
        .current_dir(folder.path("."))
        .args(["-c", command])
        .arg(assert_cmd::cargo::cargo_bin!("umbrage"))
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(2));
    assert_eq!(
        String::from_utf8_lossy(&output.stderr),
        "umbrage: a picture of 16384x16384 pixels does not fit the memory; choose a smaller --size\n"
    );
}

#[test]
fn render_says_when_the_camera_is_the_file_s_own() {
    let folder = Folder::new();
    let document = r#"{"asset":{"version":"2.0"},
        "cameras":[{"type":"perspective","perspective":{"yfov":0.7,"znear":0.1}}],
        "nodes":[{"camera":0}],"scenes":[{"nodes":[0]}],"scene":0}"#;
    fs::write(folder.path("a.gltf"), document).unwrap();
    let rest = "--light point:3,5,4 --method rays --size 8x8 -o a.png";
    let note = "note: no --eye: using the camera of the file";
    assert!(folder.run(&format!("render a.gltf {rest}")).stderr.contains(note));
    assert!(!folder.run(&format!("render a.gltf --eye 1,2,3 --target 0,0,0 {rest}")).stderr.contains(note));
}

#[test]
fn render_by_stencil_pass_is_the_ray_cast_but_at_edges() {
    if gpu().is_none() {
        return;
    }
    let folder = Folder::with_cubes();
    // The eye is in no shadow, so zpass is correct too.
    let scene = "cube.obj --light point:3,5,4 --light directional:1,-1,0 --ground --size 96x64 --samples 1";
    assert_eq!(folder.code(&format!("render {scene} --method rays -o rays.png")), 0);
    let (.., rays) = png(&folder, "rays.png");
    for method in ["auto", "zpass", "zfail"] {
        let run = folder.run(&format!("render {scene} --shadow {method} -o a.png"));
        assert_eq!((run.code, run.stdout.as_str()), (0, ""), "{}", run.stderr);
        let named = if method == "auto" { "z" } else { method };
        for light in ["point:3,5,4", "directional:1,-1,0"] {
            assert!(run.stderr.contains(&format!("note: {light}: {named}")), "{}", run.stderr);
        }
        let (width, height, pixels) = png(&folder, "a.png");
        assert_eq!((width, height), (96, 64));
        let differs = |(a, b): &(&[u8], &[u8])| a.iter().zip(*b).any(|(a, b)| a.abs_diff(*b) > 2);
        let differing = pixels.chunks(4).zip(rays.chunks(4)).filter(differs).count();
        assert!(differing <= 6, "{method}: {differing} of 6144");
    }
    let run = folder.run(&format!("render {scene} --adapter none-such -o b.png"));
    assert!(run.code == 2 && run.stderr.contains("no graphics adapter is named like `none-such`"));
    assert!(!folder.path("b.png").exists());
}

#[cfg(target_os = "linux")]
#[test]
fn render_without_an_adapter_falls_back_only_where_it_may() {
    let folder = Folder::with_cubes();
    let rest = "cube.obj --light point:3,5,4 --size 32x24 -o a.png";
    for method in ["zpass", "zfail"] {
        let run = folder.run_without_adapter(&format!("render --method {method} {rest}"));
        assert_eq!((run.code, run.stderr.lines().count()), (2, 1), "{}", run.stderr);
        assert!(run.stderr.contains("apt-get install mesa-vulkan-drivers"), "{}", run.stderr);
        assert!(!folder.path("a.png").exists());
    }
    let run = folder.run_without_adapter(&format!("render {rest}"));
    assert_eq!(run.code, 0, "{}", run.stderr);
    assert!(run.stderr.starts_with("umbrage: note: --shadow auto: rays: "), "{}", run.stderr);
    assert!(run.stderr.contains("apt-get install mesa-vulkan-drivers"), "{}", run.stderr);
    let auto = fs::read(folder.path("a.png")).unwrap();
    assert_eq!(folder.code(&format!("render --method rays {rest}")), 0);
    assert_eq!(fs::read(folder.path("a.png")).unwrap(), auto);
    assert_eq!(folder.run_without_adapter(&format!("render --adapter llvmpipe {rest}")).code, 2);
}

#[test]
fn render_says_of_zpass_that_was_asked_for_whether_it_is_wrong() {
    if gpu().is_none() {
        return;
    }
    let folder = Folder::new();
    let slab = shapes::cuboid([-2.0, 1.0, -2.0], [2.0, 1.5, 2.0]);
    let floor = shapes::cuboid([-9.0, -1.2, -9.0], [9.0, -1.0, 9.0]);
    folder.mesh("slab.obj", &Mesh::concat(&[slab, floor]).unwrap());
    let wall = shapes::cuboid([-9.0, -9.0, -6.2], [9.0, 9.0, -6.0]);
    folder.mesh("torus.obj", &Mesh::concat(&[shapes::torus(24, 12, 2.0, 0.7), wall]).unwrap());
    let run = |file: &str, light: &str, view: &str, method: &str| {
        let rest = format!("--light {light} {view} --size 32x24 --method {method} -o a.png");
        folder.run(&format!("render {file} {rest}")).stderr
    };
    let (wrong, right) =
        ("so z-pass counts wrongly and the picture is wrong", "z-pass is proven to be right");
    // Below the slab and behind the torus; above it and beside it.
    for (file, light, dark, lit) in [
        ("slab.obj", "point:0,9,0", "--eye 0.5,0,0.25 --target 3,-1,0", "--eye 3,5,3 --target 0,1,0"),
        ("torus.obj", "directional:0,0,-1", "--eye 2,0,-3 --target 4,0,-6", "--eye 0,9,5 --target 0,0,0"),
    ] {
        let said = run(file, light, dark, "zpass");
        assert!(said.contains(wrong) && said.contains(&format!("warning: {light}: ")), "{said}");
        let said = run(file, light, lit, "zpass");
        assert!(!said.contains(wrong) && said.contains(right), "{said}");
        assert!(!run(file, light, dark, "zfail").contains("wrong"));
        // The pictures are what is said of them.
        let picture = |view: &str, method: &str| {
            run(file, light, view, method);
            png(&folder, "a.png")
        };
        assert!(picture(dark, "zpass") != picture(dark, "zfail"), "{file}");
        assert!(picture(lit, "zpass") == picture(lit, "zfail"), "{file}");
    }
}

/// A search on an adapter draws what the search of the CPU draws, but for texels at edges.
#[test]
fn render_searches_on_an_adapter_where_it_is_told_to() {
    let folder = Folder::with_cubes();
    let rest = "cube.obj --ground --size 48x36 --samples 4 --light point:3,5,4,radius=0.5 -o a.png";
    let on = |search: &str| format!("render {rest} --shadow single-sample:size=128,search={search}");
    if cfg!(target_os = "linux") {
        let run = folder.run_without_adapter(&on("device"));
        assert!(run.code == 2 && run.stderr.contains("mesa-vulkan-drivers"), "{}", run.stderr);
    }
    if gpu().is_none() {
        return;
    }
    let picture = |command: &str| {
        let run = folder.run(command);
        assert_eq!(run.code, 0, "{}", run.stderr);
        (png(&folder, "a.png").2, run.stderr)
    };
    let ((cpu, said), (device, said_of_device)) = (picture(&on("cpu")), picture(&on("device")));
    assert!(said.contains(", on the CPU") && !said_of_device.contains(", on the CPU"), "{said_of_device}");
    let differ = |other: &[u8]| cpu.iter().zip(other).filter(|(a, b)| a.abs_diff(**b) > 4).count();
    assert!(differ(&device) * 50 < cpu.len(), "{}", differ(&device));
    // Fault injected: the hard shadow.
    let (hard, _) = picture(&format!("render {rest} --shadow rays"));
    assert!(differ(&hard) > 4 * differ(&device) + 20, "{} {}", differ(&hard), differ(&device));
}

#[test]
fn render_takes_a_technique_for_each_light() {
    let folder = Folder::with_cubes();
    let view = "--ground --size 48x36 --samples 1";
    let (key, fill) = ("--light point:3,5,4", "--light directional:1,-1,0");
    let picture = |rest: &str| {
        let run = folder.run(&format!("render cube.obj {view} {rest} -o a.png"));
        assert_eq!(run.code, 0, "{rest}: {}", run.stderr);
        png(&folder, "a.png").2
    };
    let rays = picture(&format!("{key} {fill} --shadow rays"));
    // A dark lamp shines no less for the others: lamps share one brightness.
    let one_dark = picture(&format!("{key} {fill} --shadow rays --shadow 2=dark"));
    let all_dark = picture(&format!("{key} {fill} --shadow dark"));
    let unshadowed = picture(&format!("{key} {fill} --shadow none"));
    let brightness = |pixels: &[u8]| pixels.iter().map(|&byte| u64::from(byte)).sum::<u64>();
    let sums = [&all_dark, &one_dark, &rays, &unshadowed].map(|pixels| brightness(pixels));
    assert!(sums.is_sorted_by(|a, b| a < b), "{sums:?}");
    // Counting beside rays is done on the CPU, without an adapter; both are exact.
    let run = folder.run_without_adapter(&format!(
        "render cube.obj {view} {key} {fill} --shadow rays --shadow 2=zfail -o mixed.png"
    ));
    assert_eq!(run.code, 0, "{}", run.stderr);
    assert!(run.stderr.contains("note: directional:1,-1,0: zfail, on the CPU"), "{}", run.stderr);
    assert!(png(&folder, "mixed.png").2 == rays);
    for (shadow, line) in [
        (
            "--shadow 3=rays",
            "--shadow 3=: there is no such light; use the name of a light, or a number from 1 to 2",
        ),
        ("--shadow rays --shadow dark", "--shadow dark: there is one for all lamps already; "),
        ("--shadow ray", "`ray` is not a technique; write one of rays, stencil,"),
    ] {
        let run = folder.run(&format!("render cube.obj {key} {fill} {shadow} -o b.png"));
        assert!(run.code == 2 && run.stderr.contains(line), "{}", run.stderr);
        assert!(!folder.path("b.png").exists());
    }
}

#[test]
fn render_by_stencil_pass_takes_lamps_without_a_shadow() {
    if gpu().is_none() {
        return;
    }
    let folder = Folder::with_cubes();
    let scene = "cube.obj --light point:3,5,4 --light directional:1,-1,0 --ground --size 96x64 --samples 1";
    let mut pictures = Vec::new();
    for (first, second) in [("rays", "none"), ("zfail", "none"), ("zfail", "dark"), ("rays", "dark")] {
        let run = folder.run(&format!("render {scene} --shadow {first} --shadow 2={second} -o a.png"));
        assert_eq!(run.code, 0, "{}", run.stderr);
        assert_eq!(run.stderr.contains("note: stencil pass on"), first == "zfail", "{}", run.stderr);
        pictures.push(png(&folder, "a.png").2);
    }
    let differing = |a: usize, b: usize| {
        let differs = |(a, b): &(&[u8], &[u8])| a.iter().zip(*b).any(|(a, b)| a.abs_diff(*b) > 2);
        pictures[a].chunks(4).zip(pictures[b].chunks(4)).filter(differs).count()
    };
    assert!(differing(0, 1) <= 6 && differing(2, 3) <= 6, "{} {}", differing(0, 1), differing(2, 3));
    assert!(differing(0, 2) > 100 && differing(1, 3) > 100);
}
