//! Benches of every stage on generated meshes, with asserted answers. `benches/README.md` explains the rows.

mod area;
#[cfg(feature = "gpu")]
mod canvas;
#[cfg(feature = "gpu")]
mod chart;
#[path = "../../src/cli/chart.rs"]
mod svg;
mod facing;
mod files;
#[cfg(feature = "gpu")]
mod frames;
#[cfg(feature = "gpu")]
mod gpu;
#[cfg(feature = "gpu")]
mod gpu_topology;
mod grid;
mod growth;
mod light;
mod machine;
#[cfg(feature = "gpu")]
mod maps;
mod measure;
#[cfg(feature = "gpu")]
mod moving;
mod obvhs_triangles;
mod plan;
mod plot;
mod pose;
mod prepare;
mod read;
mod relevance;
mod report;
mod screen;
mod shadow;
mod ties;
mod topology;
mod visibility;
mod weld;

use std::path::PathBuf;
use std::process::ExitCode;

use measure::Bench;
use umbrage::mesh::{Mesh, Weld, weld};
use umbrage::scene::Scope;
use umbrage::testing::shapes;

const USAGE: &str = "\
cargo bench --bench stages -- [OPTIONS]

--quick        small meshes, two rounds: whether it runs and answers right, not how fast it is
--filter NAME  only stages whose name holds NAME
--csv OUT      the rows as a table for other programs
--chart OUT    the frame rates as a chart (SVG)
--growth OUT   time over size as a chart (SVG)
--record       the rows, the machine and the charts, dated, into benches/record/
";

#[derive(Debug, Default)]
struct Options {
    quick: bool,
    filter: String,
    csv: Option<PathBuf>,
    chart: Option<PathBuf>,
    growth: Option<PathBuf>,
    record: bool,
}

fn main() -> ExitCode {
    // Parallel code runs on one thread too.
    #[cfg(feature = "parallel")]
    rayon::ThreadPoolBuilder::new().num_threads(1).build_global().expect("nothing has asked for threads yet");
    report::exit(options(std::env::args().skip(1)), USAGE, run)
}

/// Parses the arguments. `None` if only the help was asked for.
fn options(mut arguments: impl Iterator<Item = String>) -> Result<Option<Options>, String> {
    let mut options = Options::default();
    while let Some(argument) = arguments.next() {
        let mut value = || arguments.next().ok_or(format!("{argument} wants a value"));
        match argument.as_str() {
            "--quick" => options.quick = true,
            "--filter" => options.filter = value()?,
            "--csv" => options.csv = Some(value()?.into()),
            "--chart" => options.chart = Some(value()?.into()),
            "--growth" => options.growth = Some(value()?.into()),
            "--record" => options.record = true,
            "--bench" => {} // added by `cargo bench`
            "--help" | "-h" => return Ok(None),
            other => return Err(format!("{other} is not an option")),
        }
    }
    Ok(Some(options))
}

fn run(options: &Options) -> Result<(), String> {
    let machine = machine::Machine::look(options.quick);
    report::print(&machine.to_string()).map_err(|error| error.to_string())?;
    let mut bench = Bench::new(options.quick, &options.filter, machine.touched_bytes_per_ns);
    let stages = [
        screen::run,
        topology::run,
        weld::run,
        facing::run,
        ties::run,
        shadow::run,
        light::run,
        visibility::run,
        grid::run,
        relevance::run,
        area::run,
        plan::run,
        read::run,
        prepare::run,
        pose::run,
    ];
    for stage in stages {
        stage(&mut bench);
    }
    #[cfg(feature = "gpu")]
    for stage in [gpu_topology::run, gpu::run, maps::run, moving::run] {
        stage(&mut bench);
    }
    #[cfg(feature = "gpu")]
    let chart = frames::run(&mut bench).map(|frames| chart::svg(&frames.adapter, &frames.curves));
    #[cfg(not(feature = "gpu"))]
    let chart: Option<String> = None;
    let growth = growth::run(&mut bench).map(|growth| growth.svg(&machine::cpu()));
    if bench.rows.is_empty() {
        return Err(format!("no stage is named {}; see benches/README.md", options.filter));
    }
    let csv = report::csv(&bench.rows);
    if let Some(path) = &options.csv {
        report::save(path, &csv)?;
    }
    let charts = [(&chart, &options.chart, "frames"), (&growth, &options.growth, "growth")];
    for (chart, path, _) in charts {
        if let (Some(path), Some(chart)) = (path, chart) {
            report::save(path, chart)?;
        }
    }
    if options.record {
        let folder = PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/benches/record"));
        report::save(&folder.join(format!("{}.csv", machine.date)), &csv)?;
        report::save(&folder.join(format!("{}.txt", machine.date)), &machine.to_string())?;
        for (chart, _, name) in charts {
            if let Some(chart) = chart {
                report::save(&folder.join(format!("{}-{name}.svg", machine.date)), chart)?;
            }
        }
    }
    Ok(())
}

/// 1.3 million triangles in generation order: consecutive faces are neighbors.
fn ordered(quick: bool) -> Mesh {
    shapes::icosphere(if quick { 4 } else { 8 })
}

/// A scanned head of 268,686 triangles if the real meshes are available, otherwise a torus with as many.
pub(crate) fn head(quick: bool) -> Mesh {
    let folder = std::env::var("UMBRAGE_MESHES")
        .unwrap_or_else(|_| concat!(env!("CARGO_MANIFEST_DIR"), "/../shared/meshes").to_owned());
    let read = || {
        let scene = umbrage::read::read(format!("{folder}/igea.glb")).ok()?;
        let mesh = scene.bake(Scope::Mesh).ok()?.into_iter().next()?;
        Some(weld(&mesh, Weld::Exact).mesh.with_name("igea"))
    };
    if quick {
        shapes::torus(40, 40, 2.0, 0.75)
    } else {
        read().unwrap_or_else(|| shapes::torus(366, 367, 2.0, 0.75))
    }
}

/// 2 million triangles in random order.
fn scattered(quick: bool) -> Mesh {
    let n = if quick { 50 } else { 1000 };
    shapes::shuffled(&shapes::torus(n, n, 2.0, 0.75), 1).with_name(format!("shuffled torus {n}"))
}

/// 0.7 million faces in few planes: many exact ties.
fn tied(quick: bool) -> Mesh {
    shapes::menger_sponge(if quick { 2 } else { 4 })
}
