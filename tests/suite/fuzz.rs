//! The fuzz targets without a fuzzer: past finds, ordinary inputs, and an injected fault that each target
//! must report.

#[path = "../../fuzz/src/body/mod.rs"]
pub(crate) mod body;

use std::fs;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};

use assert_cmd::cargo::cargo_bin_cmd;
use body::{TARGETS, command, meshopt, oracle, read, shadow, threemf, topology};
use umbrage::check::CrackReport;
use umbrage::facing::classify;
use umbrage::geom::{Facing, Light};
use umbrage::mesh::{Mesh, Weld, weld};
use umbrage::oracle::Oracle;
use umbrage::read::read_bytes;
use umbrage::testing::generate::Bytes;
use umbrage::testing::shapes;
use umbrage::topology::Topology;

/// The files of a folder of the project, sorted by name; none if there is no such folder.
fn files(folder: &str) -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join(folder);
    let Ok(entries) = fs::read_dir(folder) else { return Vec::new() };
    let mut files: Vec<PathBuf> = entries.map(|entry| entry.unwrap().path()).collect();
    files.sort();
    files
}

fn replay(target: &str, path: &Path) {
    let data = fs::read(path).unwrap();
    let (_, body) = TARGETS.iter().find(|(name, _)| *name == target).unwrap();
    eprintln!("{target}: {}", path.display());
    body(&data);
    if target == "cli" {
        runs_in_a_scratch_folder(&data);
    }
}

/// Runs the command itself, of which the target only has the parser: the command must exit with a proper code
/// and not panic.
fn runs_in_a_scratch_folder(data: &[u8]) {
    let arguments = command::arguments(data);
    let folder = tempfile::tempdir().unwrap();
    let output = cargo_bin_cmd!("umbrage").current_dir(&folder).args(&arguments).output().unwrap();
    let stderr = String::from_utf8(output.stderr).unwrap();
    let code = output.status.code().unwrap_or(-1);
    assert!((0..=2).contains(&code), "{arguments:?}: {code}, {stderr}");
    assert!(!stderr.contains("panicked"), "{arguments:?}: {stderr}");
}

/// Whether `judge` panics.
fn fails(judge: impl FnOnce()) -> bool {
    catch_unwind(AssertUnwindSafe(judge)).is_err()
}

#[test]
fn fuzz_finds_stay_fixed() {
    for folder in files("fuzz/regressions") {
        let target = folder.file_name().unwrap().to_str().unwrap().to_owned();
        assert!(TARGETS.iter().any(|(name, _)| *name == target), "{target} is no target");
    }
    for (target, _) in TARGETS {
        files(&format!("fuzz/regressions/{target}")).iter().for_each(|path| replay(target, path));
    }
}

/// The bytes of a find mean what its name says, and its claim still fails where its exception is left out.
#[test]
fn fuzz_finds_are_what_their_names_say() {
    for (name, is_so) in [
        ("light_at_a_corner", (|at, p, _| at == p) as fn([f32; 3], [f32; 3], [f32; 3]) -> bool),
        ("light_on_an_edge", |at, p, q| p != q && [0, 1, 2].map(|i| 0.5 * (p[i] + q[i])) == at),
    ] {
        let data =
            fs::read(format!("{}/fuzz/regressions/shadow/{name}", env!("CARGO_MANIFEST_DIR"))).unwrap();
        let (mesh, light, points) = shadow::drawn(&mut Bytes::new(&data));
        let vertices = mesh.positions();
        let pairs = vertices.iter().flat_map(|&p| vertices.iter().map(move |&q| (p, q)));
        assert!(
            !light.is_directional() && pairs.into_iter().any(|(p, q)| is_so(light.xyz(), p, q)),
            "{name}: {light}"
        );
        assert_eq!((mesh.face_count(), vertices.len()), (4, 4), "{name}");
        let facing = classify(&mesh, &light);
        assert!(!fails(|| shadow::judge(&mesh, &light, &points, &facing)));
        assert!(fails(|| shadow::judge_signs(&mesh, &light, &points, &facing, &[-1; 4])), "{name}");
    }
}

#[test]
fn fuzz_readers_pass_ordinary_files() {
    for (target, extension, folder) in [
        ("read_obj", "obj", "data/closed"),
        ("read_gltf", "gltf", "fuzz/seeds/read_gltf"),
        ("read_gltf", "glb", "data/format"),
        ("read_stl", "stl", "data/format"),
        ("read_stl", "stl", "fuzz/seeds/read_stl"),
        ("read_ply", "ply", "data/format"),
        ("read_ply", "ply", "fuzz/seeds/read_ply"),
        ("read_off", "off", "fuzz/seeds/read_off"),
        ("read_md2", "md2", "fuzz/seeds/read_md2"),
    ] {
        let mut read = 0;
        for path in files(folder).iter().filter(|path| path.extension().is_some_and(|is| is == extension)) {
            let scene = read_bytes(&fs::read(path).unwrap(), path).unwrap_or_else(|error| panic!("{error}"));
            assert!(scene.meshes.iter().any(|mesh| mesh.face_count() > 0), "{}", path.display());
            replay(target, path);
            read += 1;
        }
        assert!(read > 0, "no .{extension} in {folder}");
    }
}

#[test]
fn fuzz_3mf_model_reaches_the_reader() {
    let model =
        fs::read(Path::new(env!("CARGO_MANIFEST_DIR")).join("fuzz/seeds/read_3mf/parts.model")).unwrap();
    let package = threemf::package(&model);
    let scene = read_bytes(&package, "a.3mf").unwrap();
    assert_eq!((scene.meshes.len(), scene.instances.len()), (1, 3));
    threemf::run(&model);
    threemf::run(&package);
    // Fault injected: the checksum of another model.
    let mut damaged = package;
    let at = damaged.len() / 2;
    damaged[at] ^= 1;
    assert!(read_bytes(&damaged, "a.3mf").is_err());
}

#[test]
fn fuzz_ordinary_bytes_pass() {
    // Short inputs are bare solids, long ones are soups.
    for length in [0, 1, 4, 16, 64, 256] {
        for start in 0..16_u32 {
            let byte = |i: u32| ((start + 1).wrapping_mul(2_654_435_761).wrapping_mul(i + 1) >> 17) as u8;
            let mut data: Vec<u8> = (0..length).map(byte).collect();
            if let Some(first) = data.first_mut() {
                *first = start as u8; // each solid once
            }
            TARGETS.iter().for_each(|(_, body)| body(&data));
        }
    }
    files("fuzz/seeds/cli").iter().for_each(|path| replay("cli", path));
}

#[test]
fn fuzz_arguments_stay_in_their_folder() {
    for data in [&b"\xff\x09/etc/a.md"[..], b"\xff\x02..", b"\x50\x05../.."] {
        let arguments = command::arguments(data);
        assert_eq!(arguments.len(), 1);
        assert!(arguments.iter().all(|text| !text.contains(['/', '\\']) && text != ".."), "{arguments:?}");
    }
}

#[test]
fn fuzz_a_wrong_answer_fails_its_target() {
    let (cube, light) = (shapes::cube(), Light::point([3.0, 4.0, 5.0]).unwrap());
    let points = [[-3.0, -4.0, -5.0], [0.0, 0.0, 9.0]];
    let topology_of = |mesh: &Mesh| Topology::of(mesh);
    let with = |change: fn(&mut Vec<[u32; 3]>)| {
        let (positions, mut triangles, ..) = cube.clone().into_parts();
        change(&mut triangles);
        Mesh::new(positions, triangles).unwrap()
    };

    // Fault injected: a face is turned.
    let turned = with(|triangles| triangles[0].swap(1, 2));
    assert!(!fails(|| topology::judge(&cube, &topology_of(&cube))));
    assert!(fails(|| topology::judge(&cube, &topology_of(&turned))));

    // Fault injected: nothing is welded, or not as far as necessary.
    let soup = shapes::soup(&cube);
    assert!(!fails(|| topology::judge_exact_weld(&soup, &weld(&soup, Weld::Exact))));
    assert!(fails(|| topology::judge_exact_weld(&soup, &weld(&soup, Weld::None))));
    assert!(!fails(|| topology::judge_weld_within(&cube, 2.0, &weld(&cube, Weld::Within(2.0)))));
    assert!(fails(|| topology::judge_weld_within(&cube, 2.0, &weld(&cube, Weld::Exact))));

    // Fault injected: the same triangles elsewhere. Mirrored, they enclose the opposite volume; moved away,
    // one intersects no other.
    let elsewhere = |mesh: &Mesh, place: fn([f32; 3]) -> [f32; 3]| {
        let (positions, triangles, ..) = mesh.clone().into_parts();
        Mesh::new(positions.into_iter().map(place).collect(), triangles).unwrap()
    };
    let report = |mesh: &Mesh| {
        let mut report = CrackReport::of(mesh, &topology_of(mesh));
        report.add_self_intersections(mesh, &topology_of(mesh), usize::MAX);
        report
    };
    let mirrored = elsewhere(&cube, |[x, y, z]| [-x, y, z]);
    assert!(!fails(|| topology::judge_report(&cube, &topology_of(&cube), &report(&cube))));
    assert!(fails(|| topology::judge_report(&cube, &topology_of(&cube), &report(&mirrored))));
    let corners = [
        [0.0, 0.0, 0.0],
        [4.0, 0.0, 0.0],
        [0.0, 4.0, 0.0],
        [1.0, 1.0, -1.0],
        [1.0, 1.0, 1.0],
        [9.0, 1.0, 0.0],
    ];
    let crossed = Mesh::new(corners.to_vec(), vec![[0, 1, 2], [3, 4, 5]]).unwrap();
    let apart = elsewhere(&crossed, |[x, y, z]| [x, y, if z == 0.0 && x < 9.0 { 100.0 } else { z }]);
    assert!(!fails(|| topology::judge_report(&crossed, &topology_of(&crossed), &report(&crossed))));
    assert!(fails(|| topology::judge_report(&crossed, &topology_of(&crossed), &report(&apart))));

    // Fault injected: one face is classified as its opposite.
    let mut facing = classify(&cube, &light);
    assert!(!fails(|| shadow::judge(&cube, &light, &points, &facing)));
    facing[0] = if facing[0] == Facing::Front { Facing::Back } else { Facing::Front };
    assert!(fails(|| shadow::judge(&cube, &light, &points, &facing)));

    // Fault injected: the tree has lost the faces that are crossed.
    let lost = Oracle::build(&with(|triangles| triangles.truncate(1)));
    assert!(!fails(|| oracle::judge(&cube, &Oracle::build(&cube), points[0], &light)));
    assert!(fails(|| oracle::judge(&cube, &lost, points[0], &light)));

    // Fault injected: a file holds another mesh, or an error has two lines.
    assert!(!fails(|| read::is_same(&cube, std::slice::from_ref(&cube), "cube")));
    assert!(fails(|| read::is_same(&cube, std::slice::from_ref(&turned), "cube")));
    assert!(!fails(|| read::is_one_line("a.obj, line 1: is wrong; export it again", "a.obj")));
    assert!(fails(|| read::is_one_line("a.obj, line 1: is\nwrong; export it again", "a.obj")));
    // Fault injected: a byte of the stream, or another element.
    let elements: Vec<u8> = (0..240).map(|i: u32| (i * i / 7) as u8).collect();
    for (mode, stride) in [(0, 12), (1, 4), (2, 2)] {
        let mut elements = elements.clone();
        if mode == 1 {
            elements.iter_mut().skip(3).step_by(4).for_each(|byte| *byte = 0);
        }
        let stream = meshopt::encoded(mode, stride, &elements);
        assert!(!fails(|| meshopt::judge(mode, stride, &elements, &stream)), "{mode}");
        let mut wrong = stream.clone();
        wrong[stream.len() / 2] ^= 4;
        assert!(fails(|| meshopt::judge(mode, stride, &elements, &wrong)), "{mode}");
        elements[6] ^= 1;
        assert!(fails(|| meshopt::judge(mode, stride, &elements, &stream)), "{mode}");
    }
    assert!(!fails(|| command::is_one_line("unexpected argument; --help lists what is allowed")));
    assert!(fails(|| command::is_one_line("unexpected\nargument; --help lists what is allowed")));
}
