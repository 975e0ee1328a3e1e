//! `umbrage render`: a picture with shadows.

mod animation;
mod planned;

use std::path::{Path, PathBuf};

use umbrage::ambient::PointRays;
use umbrage::caster::Caster;
#[cfg(feature = "gpu")]
use umbrage::geom::Light;
#[cfg(feature = "gpu")]
use umbrage::gpu::{Gpu, GpuError};
use umbrage::mesh::{FaceId, Mesh, Part};
use umbrage::plan::Budget;
use umbrage::render;
use umbrage::render::{CLAY, Picture, ShadedLight, View};
use umbrage::scene::{Lamp, Material};
#[cfg(feature = "gpu")]
use umbrage::shadow::stencil::{StencilMethod, ZPassVerdict, zpass_verdict};
use umbrage::shadow::{Request, Samples, Technique, Visibility};
#[cfg(feature = "gpu")]
use umbrage::view::Projection;
use umbrage::view::Size;

use super::input::{Source, SourceArgs};
use super::lights;
use super::parsers::{large, refuse_overwriting, require_folder};
use super::plan::{FalloffArg, Saved, shaded};
use super::pose::seconds;
use super::progress::Progress;
use super::resources::{AdapterArgs, ThreadArgs};
use super::search::Searcher;
use super::shadow::ShadowArgs;
#[cfg(feature = "gpu")]
use super::stencil_render::{Shadowing, Stage};
use super::view::ViewArgs;
use super::{Failure, Outcome, output};

/// Picture: shadows by a stencil pass or by exact ray cast, flat faces, plain shading
///
/// Shading is for the eye: a light is as strong far away as near, unless --falloff says otherwise. Lights
/// asked for share one brightness; those of a file keep the ratio that their candela and lux have at the
/// center of the scene, a spot light within its cone. Rays and stencil shade alike; a stencil pass says of
/// each light how its shells were counted. A point that a ray only grazes is drawn lit.
#[derive(Clone, Debug, clap::Args)]
pub(crate) struct Args {
    #[command(flatten)]
    source: SourceArgs,

    #[command(flatten)]
    view: ViewArgs,

    /// Width and height in pixels, each at most 16384
    #[arg(long, value_name = "WxH", default_value = "960x540", allow_hyphen_values = true)]
    size: Size,

    #[command(flatten)]
    shadow: ShadowArgs,

    /// What of the shadows may be wrong, and how long a picture may take: error=F,light=F,level=N,time=16ms;
    /// for --shadow auto, as in umbrage plan [default: exact, in the least time]
    ///
    /// With --shadow TECHNIQUE the error is compared with this, and said.
    #[arg(long, value_name = "BUDGET")]
    budget: Option<Budget>,

    /// How many points are compared with the exact ray cast after --shadow auto or a plan, at first; more if
    /// they do not tell; 0 for no check [default: 3000]
    #[arg(long, value_name = "N", value_parser = large, allow_negative_numbers = true)]
    check: Option<u64>,

    /// How many samples a pixel is the mean of: 1, 4, 9 or 16; where rays find shadows, pixels at edges only
    ///
    /// [default: 4 in a stencil pass, 9 for rays]
    #[arg(long, value_name = "N", value_parser = parse_samples, allow_negative_numbers = true)]
    samples: Option<u32>,

    /// How a light weakens with the distance
    ///
    /// Either way a light is as strong at the center of the scene. For example: --falloff physical with
    /// --light point:0,3,0,range=20.
    #[arg(long, value_enum, default_value_t = FalloffArg::Plain)]
    falloff: FalloffArg,

    /// Darken ambient light by what hides the sky: 64 exact rays from each visible point
    ///
    /// The picture is made on the CPU then.
    #[arg(long)]
    ambient: bool,

    /// Add a large floor below everything: lowest in z for stl, md2 and 3mf, lowest in y for others
    #[arg(long)]
    ground: bool,

    /// Where the picture is written, as PNG in sRGB (required) without --animate
    #[arg(
        short,
        long,
        value_name = "OUT.png",
        required_unless_present = "animate",
        conflicts_with = "animate"
    )]
    output: Option<PathBuf>,

    /// Instead of one picture, --fps of them for each second of a clip, or of md2; `%04d` in the name is the
    /// number of the picture, from 0, with four digits [default: one picture]
    ///
    /// Without such a number the frames become one animated PNG, which plays for ever; its name ends in .png
    /// or .apng. A camera that is fitted, and a default light, are those of all frames together. At most
    /// 10000 frames. For example: --animate walk_%04d.png --clip Walk --fps 30.
    #[arg(long, value_name = "OUT_%04d.png", conflicts_with_all = ["time", "frame"])]
    animate: Option<PathBuf>,

    /// The time of the first picture in seconds, for --animate [default: the first key of the clip; 0 for
    /// md2]
    #[arg(long, value_name = "T", value_parser = seconds, allow_negative_numbers = true)]
    from: Option<f64>,

    /// The time that no picture is after, in seconds, for --animate [default: the last key of the clip; the
    /// last frame of md2]
    #[arg(long, value_name = "T", value_parser = seconds, allow_negative_numbers = true)]
    to: Option<f64>,

    #[command(flatten)]
    threads: ThreadArgs,

    #[command(flatten)]
    adapter: AdapterArgs,
}

/// How the picture is made, once that is settled.
enum Renderer {
    /// Ray by ray, with more rays at edges.
    Rays,
    /// Sample by sample, each lamp by the CPU form of its technique.
    Samples,
    /// Sample by sample, as a plan says.
    Planned,
    #[cfg(feature = "gpu")]
    Device(Box<Gpu>),
}

/// Whether a technique runs on the CPU alone, beside rays.
fn is_of_samples(technique: Option<Technique>) -> bool {
    let plain = matches!(technique, None | Some(Technique::Rays | Technique::None | Technique::Dark));
    !plain && !counts(technique)
}

/// Whether a technique is counted in a stencil.
fn counts(technique: Option<Technique>) -> bool {
    matches!(technique, Some(Technique::Stencil | Technique::ZFail | Technique::ZPass))
}

impl ShadowArgs {
    /// A plan if any lamp leaves it to us. Otherwise a stencil pass if any lamp asks for one, and no other
    /// asks for a technique of the CPU. Where some lamps count and others cast rays, or one asks for a
    /// technique of the CPU, all is done on the CPU, on the same samples; ambient light by rays is of the
    /// CPU, too.
    fn settle(&self, adapter: &AdapterArgs, ambient: bool) -> Result<Renderer, Failure> {
        if self.asks_for(|technique| technique.is_none()) {
            adapter.unused("--shadow auto and plans are of the CPU");
            return Ok(Renderer::Planned);
        }
        if self.asks_for(is_of_samples) {
            return Ok(Renderer::Samples);
        }
        if ambient {
            adapter.unused("--ambient is of rays, on the CPU");
            return Ok(if self.asks_for(counts) { Renderer::Samples } else { Renderer::Rays });
        }
        match self.asks_for(counts) {
            true if self.asks_for(|technique| technique == Some(Technique::Rays)) => Ok(Renderer::Samples),
            true => self.device(adapter),
            false => Ok(Renderer::Rays),
        }
    }

    #[cfg(feature = "gpu")]
    fn device(&self, adapter: &AdapterArgs) -> Result<Renderer, Failure> {
        Ok(Renderer::Device(Box::new(adapter.open("--shadow")?)))
    }

    #[cfg(not(feature = "gpu"))]
    fn device(&self, adapter: &AdapterArgs) -> Result<Renderer, Failure> {
        adapter.refuse()?;
        Err(Failure::new("--shadow: this build cannot use a graphics adapter", "use --shadow rays"))
    }
}

/// Rays from each visible point for ambient light.
const AMBIENT_RAYS: u32 = 64;

/// Samples along each side of a pixel.
const STENCIL_SAMPLES: u32 = 2;
const RAYS_SAMPLES: u32 = 3;

pub(crate) fn parse_samples(text: &str) -> Result<u32, String> {
    match text {
        "1" => Ok(1),
        "4" => Ok(2),
        "9" => Ok(3),
        "16" => Ok(4),
        _ => Err("write 1, 4, 9 or 16".to_owned()),
    }
}

/// Refuses a name that no picture can be written under, judging by the extension.
pub(crate) fn require_png(path: &Path) -> Result<(), Failure> {
    if path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("png")) {
        return Ok(());
    }
    Err(Failure::new("pictures are written as PNG only", "name a file that ends in .png").in_file(path))
}

pub(crate) fn run(args: Args) -> Result<Outcome, Failure> {
    if let Some(pattern) = args.animate.clone() {
        return animation::run(&args, &pattern);
    }
    for (option, is_asked) in [("--from", args.from.is_some()), ("--to", args.to.is_some())] {
        if is_asked {
            let problem = format!("{option} is for --animate");
            return Err(Failure::new(problem, "add --animate OUT_%04d.png, or use --time"));
        }
    }
    let output = args.output.clone().expect("the parser requires it");
    require_png(&output)?;
    refuse_overwriting("--output", Some(&output), &args.source.file)?;
    require_folder(&output)?;
    args.view.refuse()?; // before the file is read
    let renderer = args.shadow.settle(&args.adapter, args.ambient)?;
    args.threads.apply()?;

    let saved = args.shadow.plan()?.map(|path| Ok::<_, Failure>((path, Saved::read(path)?))).transpose()?;
    let (picture, outcome) = draw(&args, &renderer, saved, args.source.load()?)?;
    picture.write_png(&output)?;
    output::wrote(&output);
    Ok(outcome)
}

/// The picture of a scene, and whether it keeps within its budget.
fn draw(
    args: &Args,
    renderer: &Renderer,
    saved: Option<(&Path, Saved)>,
    mut source: Source,
) -> Result<(Picture, Outcome), Failure> {
    let techniques = args.shadow.of_lamps(&source.lights)?;
    let camera =
        args.view.choose(&source.cameras, &args.source.file, &source.bounds, source.up, args.size)?;
    let ground = if args.ground {
        let ground = source.add_ground();
        Some(ground.map_err(|error| Failure::new(error, "leave out --ground").in_file(&args.source.file))?)
    } else {
        None
    };
    // Without faces there is nothing to plan: the rays of the picture meet nothing, and cost as little.
    let is_empty = source.seen().mesh().face_count() == 0;
    let is_planned = matches!(renderer, Renderer::Planned);
    if is_planned && (!is_empty || saved.is_some()) {
        return planned::run(args, &source, camera, ground, &techniques, saved);
    }
    let lamps = shining_lamps(args, &source, &techniques);
    // What is dark is not asked for.
    let casting: Vec<(Lamp, Option<Technique>)> = (source.lights.iter().cloned().zip(techniques))
        .filter(|&(_, technique)| technique != Some(Technique::Dark))
        .collect();
    let is_hard = |technique: Option<Technique>| !technique.is_some_and(Technique::is_soft);
    lights::note_centers(casting.iter().filter(|&&(_, technique)| is_hard(technique)).map(|(lamp, _)| lamp));

    let colors = colors(source.seen().mesh(), &source.materials);
    let paint = |face: FaceId| colors.get(face.index()).copied().unwrap_or(CLAY);
    let (up, size) = (source.up, args.size);
    let view = |samples| View {
        camera,
        size,
        lamps: &lamps,
        casters: None,
        up,
        ground,
        paint: &paint,
        edge_samples: args.samples.unwrap_or(samples),
        ambient: None,
    };
    let ambient = args.ambient.then(|| PointRays::new(AMBIENT_RAYS));
    let ambient = ambient.as_ref();
    let picture = match renderer {
        Renderer::Rays | Renderer::Planned => by_rays(source, view(RAYS_SAMPLES), ambient)?,
        Renderer::Samples => by_samples(&source, &view(STENCIL_SAMPLES), &casting, ambient, &args.adapter)?,
        #[cfg(feature = "gpu")]
        Renderer::Device(gpu) => by_stencil(gpu, &source, view(STENCIL_SAMPLES), &casting)?,
    };
    Ok((picture, Outcome::Sound))
}

/// The lamps that shine, in their order: all but those that are dark.
fn shining_lamps(args: &Args, source: &Source, techniques: &[Option<Technique>]) -> Vec<ShadedLight> {
    let physical = args.falloff == FalloffArg::Physical;
    let mut lamps = shaded(source, args.source.lights.were_asked_for(), physical);
    if args.falloff == FalloffArg::Plain && source.lights.iter().any(|lamp| lamp.range.is_some()) {
        output::say("note: a light's range is not applied: --falloff physical ends the light there");
    }
    for (shaded, &technique) in lamps.iter_mut().zip(techniques) {
        shaded.shadow = technique != Some(Technique::None);
    }
    let lit = lamps.into_iter().zip(techniques).filter(|(_, technique)| **technique != Some(Technique::Dark));
    lit.map(|(lamp, _)| lamp).collect()
}

/// The base color of each face; empty if no material states one, so that all faces are of clay.
pub(crate) fn colors(mesh: &Mesh, materials: &[Material]) -> Vec<[f32; 3]> {
    let color = |part: &Part| materials.get(part.material? as usize)?.base_color;
    if mesh.parts().iter().all(|part| color(part).is_none()) {
        return Vec::new();
    }
    let mut colors = vec![CLAY; mesh.face_count()];
    for part in mesh.parts() {
        colors[part.faces.start as usize..part.faces.end as usize].fill(color(part).unwrap_or(CLAY));
    }
    colors
}

/// Lets go of the meshes: the ray casts have faces of their own.
fn by_rays(source: Source, view: View<'_>, ambient: Option<&PointRays>) -> Result<Picture, Failure> {
    let Source { caster, seen, .. } = source;
    let casters = caster.into_oracle();
    let seen = seen.map(Caster::into_oracle);
    let progress = Progress::bar("rendering", view.steps());
    let open = |point, normal| ambient.map_or(1.0, |rays| rays.openness(&casters, point, normal));
    let view = View { casters: Some(&casters), ambient: ambient.map(|_| &open as _), ..view };
    let picture = render::render(seen.as_ref().unwrap_or(&casters), &view, &|steps| progress.done(steps));
    drop(progress);
    picture.map_err(|error| Failure::new(error, "choose a smaller --size"))
}

/// Each lamp by the CPU form of its technique, or by a search on an adapter.
fn by_samples(
    source: &Source,
    view: &View<'_>,
    casting: &[(Lamp, Option<Technique>)],
    ambient: Option<&PointRays>,
    adapter: &AdapterArgs,
) -> Result<Picture, Failure> {
    let searcher = Searcher::open(adapter, casting.iter().filter_map(|&(_, technique)| technique))?;
    let progress = Progress::spinner("rendering");
    let casters = source.group();
    let open = |point, normal| ambient.map_or(1.0, |rays| rays.openness(casters.oracle(), point, normal));
    let view = &View { ambient: ambient.map(|_| &open as _), ..*view };
    let projection = view.camera.projection(view.size, view.camera.near([source.seen().mesh()], view.size));
    let samples = Samples::of_view(&casters, &projection, view.size, view.edge_samples)
        .map_err(|error| Failure::new(error, "choose a smaller --size"))?;
    let shade = |(lamp, technique): &(Lamp, Option<Technique>)| {
        let request = Request { casters: &casters, lamp, samples: &samples };
        searcher.shade(technique.unwrap_or(Technique::Rays), &request)
    };
    let visibility: Vec<Visibility> = casting.iter().map(shade).collect::<Result<_, Failure>>()?;
    let picture = render::render_samples(&samples, view, &visibility);
    drop(progress);
    for (lamp, technique) in casting {
        let name = technique.unwrap_or(Technique::Rays);
        let place = searcher.place(name);
        output::say(format_args!("note: {}: {name}, on {place}", lights::lamp_label(lamp)));
    }
    picture.map_err(|error| Failure::new(error, "choose a smaller --size"))
}

/// Says of each light how it was counted.
#[cfg(feature = "gpu")]
fn by_stencil(
    gpu: &Gpu,
    source: &Source,
    view: View<'_>,
    casting: &[(Lamp, Option<Technique>)],
) -> Result<Picture, GpuError> {
    let progress = Progress::spinner("rendering");
    let shadowing = |(_, technique): &(Lamp, Option<Technique>)| match technique {
        Some(Technique::None) => Shadowing::Lit,
        Some(Technique::ZFail) => Shadowing::Counted(Some(StencilMethod::ZFail)),
        Some(Technique::ZPass) => Shadowing::Counted(Some(StencilMethod::ZPass)),
        _ => Shadowing::Counted(None),
    };
    let shadows: Vec<Shadowing> = casting.iter().map(shadowing).collect();
    let stage = Stage::new(gpu, [&source.caster, source.seen()], view, &shadows)?;
    let picture = stage.picture()?;
    drop(progress);
    output::say(format_args!("note: stencil pass on {}", output::plain(&gpu.name())));
    for ((lamp, casting), shadowing) in view.lamps.iter().zip(&stage.castings).zip(&shadows) {
        let how = casting.as_ref().map_or("no shadow".to_owned(), |casting| casting.methods.summary());
        let label = lights::spot_label(&lamp.light, lamp.cone.is_some(), "");
        output::say(format_args!("note: {label}: {how}"));
        if matches!(shadowing, Shadowing::Counted(Some(StencilMethod::ZPass))) {
            say_of_zpass(&source.caster, &stage.projection, &lamp.light, &label);
        }
    }
    Ok(picture)
}

/// Says whether the z-pass that was asked for is right.
#[cfg(feature = "gpu")]
fn say_of_zpass(caster: &Caster, projection: &Projection, light: &Light, label: &str) {
    match zpass_verdict(caster, projection, light) {
        ZPassVerdict::Wrong => output::say(format_args!(
            "warning: {label}: the near rectangle of the camera is in this light's shadow, so z-pass counts \
             wrongly and the picture is wrong; use --shadow zfail or stencil"
        )),
        ZPassVerdict::Right => output::say(format_args!("note: {label}: z-pass is proven to be right")),
        _ => {}
    }
}
