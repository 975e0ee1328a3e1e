//! umbrage beside the crates that it is measured against: the same mesh, one run, turns taken. What each row means:
//! `benches/README.md`.

#[expect(dead_code, reason = "shared with the stages, which read more formats")]
#[path = "../../stages/files.rs"]
mod files;
#[path = "../../stages/machine.rs"]
mod machine;
#[expect(dead_code, reason = "shared with the stages, which have limits")]
#[path = "../../stages/measure.rs"]
mod measure;
#[path = "../../stages/obvhs_triangles.rs"]
mod obvhs_triangles;
#[path = "../../stages/report.rs"]
mod report;

mod edges;
mod rays;
mod read;
mod weld;

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use measure::{Bench, Target};
use umbrage::mesh::{Mesh, Weld};
use umbrage::testing::shapes;
use umbrage::scene::Scope;

const USAGE: &str = "\
cargo run --release --manifest-path benches/peers/Cargo.toml -- [OPTIONS] [FILE]

FILE           a mesh; without one, generated meshes, and a scanned head where the real meshes are there
--quick        small meshes, two rounds: whether it runs and answers right, not how fast it is
--filter NAME  only stages whose name holds NAME
--csv OUT      the rows as a table for other programs
";

#[derive(Debug, Default)]
struct Options {
    quick: bool,
    filter: String,
    csv: Option<PathBuf>,
    file: Option<PathBuf>,
}

/// A welded mesh, and what the edge table should take of meshopt's time on it.
struct Subject {
    mesh: Mesh,
    edges: Target,
}

fn main() -> ExitCode {
    report::exit(options(std::env::args().skip(1)), USAGE, run)
}

/// `None` where only help is wanted.
fn options(mut arguments: impl Iterator<Item = String>) -> Result<Option<Options>, String> {
    let mut options = Options::default();
    while let Some(argument) = arguments.next() {
        let mut value = || arguments.next().ok_or(format!("{argument} wants a value"));
        match argument.as_str() {
            "--quick" => options.quick = true,
            "--filter" => options.filter = value()?,
            "--csv" => options.csv = Some(value()?.into()),
            "--help" | "-h" => return Ok(None),
            other if other.starts_with('-') => return Err(format!("{other} is not an option")),
            file if options.file.is_none() => options.file = Some(file.into()),
            other => return Err(format!("one file, not also {other}")),
        }
    }
    Ok(Some(options))
}

fn run(options: &Options) -> Result<(), String> {
    let machine = machine::Machine::look(options.quick);
    report::print(&format!("{machine}{}", versions())).map_err(|error| error.to_string())?;
    let mut bench = Bench::new(options.quick, &options.filter, machine.touched_bytes_per_ns);
    let subjects = subjects(options)?;
    for subject in &subjects {
        edges::run(&mut bench, subject);
        weld::run(&mut bench, &subject.mesh);
        rays::run(&mut bench, &subject.mesh);
    }
    // Of one mesh: what a reader does depends little on what it reads.
    read::run(&mut bench, &subjects[0].mesh);
    if bench.rows.is_empty() {
        return Err(format!("no stage is named {}; see benches/README.md", options.filter));
    }
    options.csv.as_ref().map_or(Ok(()), |path| report::save(path, &report::csv(&bench.rows)))
}

fn subjects(options: &Options) -> Result<Vec<Subject>, String> {
    if let Some(file) = &options.file {
        return Ok(vec![Subject { mesh: mesh(file)?, edges: Target::None }]);
    }
    let n = if options.quick { 50 } else { 1000 };
    let torus = shapes::shuffled(&shapes::torus(n, n, 2.0, 0.75), 1).with_name(format!("shuffled torus {n}"));
    let mut subjects = vec![
        Subject {
            mesh: shapes::icosphere(if options.quick { 4 } else { 8 }),
            edges: Target::Ratio(1.0 / 15.0),
        },
        Subject { mesh: torus, edges: Target::Ratio(1.0 / 10.0) },
    ];
    let folder = std::env::var("UMBRAGE_MESHES")
        .unwrap_or_else(|_| concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/meshes").to_owned());
    let head = Path::new(&folder).join("igea.glb");
    match (options.quick, mesh(&head)) {
        (true, _) => {}
        (false, Ok(mesh)) => subjects.push(Subject { mesh, edges: Target::None }),
        (false, Err(problem)) => eprintln!("SKIPPED, the scanned head: {problem}"),
    }
    Ok(subjects)
}

/// All of a file as one mesh, vertices in the same place joined.
fn mesh(file: &Path) -> Result<Mesh, String> {
    let scene = umbrage::read::read(file).map_err(|error| error.to_string())?;
    let meshes = scene.bake(Scope::Scene).map_err(|error| format!("{}: {error}", file.display()))?;
    let mesh = meshes.into_iter().next().filter(|mesh| mesh.face_count() > 0);
    let mesh = mesh.ok_or(format!("{}: there are no faces; name a mesh with some", file.display()))?;
    let name = file.file_stem().map_or(String::new(), |stem| stem.to_string_lossy().into_owned());
    Ok(umbrage::mesh::weld(&mesh, Weld::Exact).mesh.with_name(name))
}

/// The peers as they were locked.
fn versions() -> String {
    let lock = include_str!("../Cargo.lock");
    let version = |name: &str| {
        let version = lock.split_once(&format!("name = \"{name}\"\nversion = \""))?.1.split('"').next()?;
        Some(format!("{name} {version}"))
    };
    let all: Vec<String> =
        ["meshopt", "obvhs", "parry3d", "stl_io", "tobj"].into_iter().filter_map(version).collect();
    format!("peers      {}\n", all.join(", "))
}
