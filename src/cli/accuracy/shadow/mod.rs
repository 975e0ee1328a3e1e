//! `umbrage accuracy shadow`: error against time of every technique, for each light and one view.

mod chosen;
mod document;
mod page;
mod panels;
mod pictures;
mod text;
mod words;

use std::path::{Path, PathBuf};

use serde_json::{Value, json};
use umbrage::accuracy::ShadowAccuracy;
use umbrage::caster::CasterGroup;
use umbrage::mesh::FaceId;
use umbrage::render::{CLAY, MemoryError, View};
use umbrage::scene::Lamp;
use umbrage::shadow::{Samples, Technique};
use umbrage::view::{Camera, Projection, Size};

use super::{Args, chart};
use crate::cli::input::Source;
use crate::cli::output::{self, Output};
use crate::cli::progress::Progress;
use crate::cli::render::colors;
use crate::cli::search;
use crate::cli::{Failure, Outcome};
use chosen::Chosen;
use pictures::Pictures;

/// The default size of the view.
const SIZE: (u32, u32) = (480, 270);

/// What was measured of one file.
struct Measured {
    file: PathBuf,
    size: Size,
    samples: usize,
    lights: Vec<Lamp>,
    found: Vec<ShadowAccuracy>,
    /// What the planner would choose, one entry per lamp.
    chosen: Vec<Option<Chosen>>,
    /// One entry per lamp, if a page shows them.
    pictures: Vec<Pictures>,
}

pub(super) fn run(args: &Args) -> Result<Outcome, Failure> {
    let mut out = Output::new();
    let mut outcome = Outcome::Sound;
    let mut documents = Vec::new();
    let mut table = text::HEADER.to_owned();
    let mut panels = Vec::new();
    let mut all = Vec::new();
    for (index, file) in args.files.iter().enumerate() {
        match measure(file, args) {
            Ok(measured) => {
                if !measured.found.iter().all(ShadowAccuracy::claims_hold) {
                    outcome = outcome.max(Outcome::Unsound);
                }
                table += &measured.csv();
                panels
                    .extend(measured.found.iter().map(|found| panels::error_against_time(&measured, found)));
                if args.json {
                    documents.push(measured.document());
                } else {
                    out.text(format_args!("{}{}", if index > 0 { "\n" } else { "" }, measured.text()))?;
                    out.flush()?;
                }
                all.push(measured);
            }
            Err(failure) => {
                output::say(&failure);
                outcome = outcome.max(Outcome::Incomplete);
                documents.push(json!({ "file": file.to_string_lossy(), "error": failure.to_string() }));
            }
        }
    }
    if args.json {
        // One file is one document; several are a list of them.
        let document = if documents.len() == 1 { documents.remove(0) } else { Value::Array(documents) };
        out.json(&document)?;
    }
    out.flush()?;
    super::save(args.csv.as_deref(), || table)?;
    super::save(args.svg.as_deref(), || chart::svg(&panels))?;
    let command: Vec<String> = std::env::args().skip(1).collect();
    super::save(args.html.as_deref(), || page::page(&all, &format!("umbrage {}", command.join(" "))))?;
    Ok(outcome)
}

/// Every technique, and the plain map twice more at twice the resolution: what texels alone are good for.
fn default_rows() -> Vec<Technique> {
    let doubled = |technique: Technique| {
        let sizes: &[&str] =
            if technique.name() == "map" { &["map:size=2048", "map:size=4096"] } else { &[] };
        let finer = sizes.iter().map(|text| text.parse().expect("within the range of sizes"));
        std::iter::once(technique).chain(finer)
    };
    Technique::ALL.into_iter().flat_map(doubled).collect()
}

fn measure(file: &Path, args: &Args) -> Result<Measured, Failure> {
    let mut source = args.source(file).load()?;
    let size = args.size.unwrap_or(Size::new(SIZE.0, SIZE.1).expect("in range"));
    let camera = args.view.choose(&source.cameras, file, &source.bounds, source.up, size)?;
    if args.ground {
        source.add_ground().map_err(|error| Failure::new(error, "leave out --ground").in_file(file))?;
    }
    let Source { ref caster, ref lights, .. } = source;
    if caster.mesh().face_count() == 0 {
        let problem = "there are no faces to cast or to receive a shadow";
        return Err(Failure::new(problem, "name a mesh that has some").in_file(file));
    }
    let projection: Projection = camera.projection(size, camera.near([source.seen().mesh()], size));
    // A technique that searches on an adapter is measured beside its twin on the CPU.
    let searches = args.shadow.iter().any(|&technique| search::needs_adapter(technique));
    let techniques: Vec<Technique> = match args.shadow.is_empty() {
        true => default_rows(),
        false => args.shadow.iter().map(|&technique| search::on_cpu(technique)).collect(),
    };
    if searches {
        args.adapter.open("search=device")?;
    }
    let steps = (1 + techniques.len() as u64) * lights.len() as u64;
    let progress = Progress::bar(format!("measuring {}", file.display()), steps);
    let casters = source.group();
    let view = |casters: &CasterGroup<'_>| {
        Samples::of_view(casters, &projection, size, args.samples.unwrap_or(1))
            .map_err(|error| Failure::new(error, "use a smaller --size").in_file(file))
    };
    let done = |steps| progress.done(steps);
    let (samples, mut found) =
        ShadowAccuracy::measure(&casters, lights, &techniques, view, args.rounds, &done)?;
    drop(progress);
    if args.shadow.is_empty() || searches {
        add_device(args, &casters, &samples, &mut found)?;
    }
    if searches {
        for light in &mut found {
            light.rows.retain(|row| row.device.is_none() || search::needs_adapter(row.technique));
        }
    }
    let pictures = match &args.html {
        None => Vec::new(),
        Some(_) => pictures(&source, camera, &samples, &found)
            .map_err(|error| Failure::new(error, "use a smaller --size").in_file(file))?,
    };
    let chosen = found.iter().map(|found| Chosen::of(&casters, &samples, found)).collect();
    let lights = lights.clone();
    Ok(Measured { file: file.to_owned(), size, samples: samples.len(), lights, found, chosen, pictures })
}

/// The pictures of all lamps.
fn pictures(
    source: &Source,
    camera: Camera,
    samples: &Samples,
    found: &[ShadowAccuracy],
) -> Result<Vec<Pictures>, MemoryError> {
    let colors = colors(source.seen().mesh(), &source.materials);
    let paint = |face: FaceId| colors.get(face.index()).copied().unwrap_or(CLAY);
    let view = View {
        camera,
        size: samples.size(),
        lamps: &[],
        casters: None,
        up: source.up,
        ground: None,
        paint: &paint,
        edge_samples: samples.per_side(),
        ambient: None,
    };
    let progress = Progress::bar("drawing the page", found.len() as u64);
    let draw = |found: &ShadowAccuracy| {
        let pictures = Pictures::of(found, samples, &view);
        progress.done(1);
        pictures
    };
    found.iter().map(draw).collect()
}

/// Adds the rows of a graphics adapter, where there is one.
#[cfg(feature = "gpu")]
fn add_device(
    args: &Args,
    casters: &CasterGroup<'_>,
    samples: &Samples,
    found: &mut [ShadowAccuracy],
) -> Result<(), Failure> {
    let gpu = match args.adapter.find()? {
        Ok(gpu) => gpu,
        Err(error) => {
            output::say(format_args!("note: no rows of a graphics adapter: {error}"));
            return Ok(());
        }
    };
    if samples.per_side() > 1 {
        output::say("note: no rows of a graphics adapter: they need --samples 1");
        return Ok(());
    }
    let progress = Progress::spinner(format!("measuring on {}", gpu.name()));
    for light in &mut *found {
        if let Err(error) = light.add_device(&gpu, casters, samples, args.rounds) {
            drop(progress);
            output::say(format_args!("note: no rows of a graphics adapter: {error}"));
            return Ok(());
        }
    }
    drop(progress);
    let mut said = Vec::new();
    for only in found.iter().flat_map(|light| &light.cpu_only) {
        if !said.contains(only) {
            let (technique, lacks) = only;
            output::say(format_args!(
                "note: {technique} has a row of the CPU only; not built on a device: {lacks}"
            ));
            said.push(*only);
        }
    }
    Ok(())
}

#[cfg(not(feature = "gpu"))]
fn add_device(
    args: &Args,
    _: &CasterGroup<'_>,
    _: &Samples,
    _: &mut [ShadowAccuracy],
) -> Result<(), Failure> {
    args.adapter.refuse()
}
