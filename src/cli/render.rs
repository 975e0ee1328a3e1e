//! `umbrage render`: a picture with exact shadows.

use std::path::{Path, PathBuf};

use umbrage::caster::Caster;
#[cfg(feature = "gpu")]
use umbrage::gpu::{Gpu, GpuError};
use umbrage::mesh::{FaceId, Mesh, Part};
use umbrage::render;
use umbrage::render::{CLAY, Ground, Picture, ShadedLight, View};
use umbrage::scene::Material;
#[cfg(feature = "gpu")]
use umbrage::shadow::stencil::{StencilMethod, ZPassVerdict, zpass_verdict};
use umbrage::view::Size;

use super::input::{Source, SourceArgs};
#[cfg(feature = "gpu")]
use super::lights;
use super::parsers::{refuse_overwriting, require_folder};
use super::progress::Progress;
use super::resources::{AdapterArgs, ThreadArgs};
#[cfg(feature = "gpu")]
use super::stencil_render::Stage;
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

    /// How shadows are found
    #[arg(long, value_enum, default_value_t = Method::Auto)]
    method: Method,

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

    /// Add a large floor below everything: lowest in z for stl and md2, lowest in y for every other format
    #[arg(long)]
    ground: bool,

    /// Where the picture is written, as PNG in sRGB (required)
    #[arg(short, long, value_name = "OUT.png")]
    output: PathBuf,

    #[command(flatten)]
    threads: ThreadArgs,

    #[command(flatten)]
    adapter: AdapterArgs,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum FalloffArg {
    /// Not at all: as strong far away as near
    Plain,
    /// With the inverse square of the distance, and ending at the light's range, as KHR_lights_punctual
    /// defines it
    Physical,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum Method {
    /// A stencil pass where there is a graphics adapter, for each light and shell as it is right; else rays
    Auto,
    /// Stencil counting in front of what is seen; wrong where the eye is in a shadow
    Zpass,
    /// Stencil counting behind what is seen; right everywhere
    Zfail,
    /// Exact ray cast
    Rays,
}

/// How shadows are found, once that is settled.
enum Way {
    Rays,
    #[cfg(feature = "gpu")]
    Stencil {
        gpu: Box<Gpu>,
        asked: Option<StencilMethod>,
    },
}

impl Method {
    #[cfg(feature = "gpu")]
    fn settle(self, adapter: &AdapterArgs) -> Result<Way, Failure> {
        let asked = match self {
            Self::Rays => return Ok(Way::Rays),
            Self::Auto => {
                return Ok(match adapter.find()? {
                    Ok(gpu) => Way::Stencil { gpu: Box::new(gpu), asked: None },
                    Err(error) => {
                        note_rays(&error);
                        Way::Rays
                    }
                });
            }
            Self::Zpass => StencilMethod::ZPass,
            Self::Zfail => StencilMethod::ZFail,
        };
        Ok(Way::Stencil { gpu: Box::new(adapter.open("--method")?), asked: Some(asked) })
    }

    #[cfg(not(feature = "gpu"))]
    fn settle(self, adapter: &AdapterArgs) -> Result<Way, Failure> {
        adapter.refuse()?;
        let name = match self {
            Self::Rays | Self::Auto => return Ok(Way::Rays),
            Self::Zpass => "zpass",
            Self::Zfail => "zfail",
        };
        Err(Failure::new(
            format_args!("--method {name}: this build cannot use a graphics adapter"),
            "use --method rays",
        ))
    }
}

#[cfg(feature = "gpu")]
fn note_rays(error: &GpuError) {
    output::say(format_args!("note: --method auto: rays: {error}"));
}

/// Samples along each side of a pixel.
#[cfg(feature = "gpu")]
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
    require_png(&args.output)?;
    refuse_overwriting("--output", Some(&args.output), &args.source.file)?;
    require_folder(&args.output)?;
    args.view.refuse()?; // before the file is read
    let way = args.method.settle(&args.adapter)?;
    args.threads.apply()?;

    let Source { up, caster, bounds, lights: of_scene, cameras, materials, .. } = args.source.load()?;
    let camera = args.view.choose(&cameras, &args.source.file, &bounds, up, args.size)?;
    let mut lamps = if args.source.lights.were_asked_for() {
        ShadedLight::equal(&of_scene)
    } else {
        ShadedLight::balanced(&of_scene, &bounds)
    };
    if args.falloff == FalloffArg::Physical {
        for (shaded, lamp) in lamps.iter_mut().zip(&of_scene) {
            *shaded = shaded.with_physical_falloff(lamp.range, &bounds);
        }
    }
    let (caster, ground) = if args.ground {
        let (mesh, ground) = Ground::under(caster.into_mesh(), up)
            .map_err(|error| Failure::new(error, "leave out --ground").in_file(&args.source.file))?;
        (Caster::new(mesh), Some(ground))
    } else {
        (caster, None)
    };

    let colors = colors(caster.mesh(), &materials);
    let paint = |face: FaceId| colors.get(face.index()).copied().unwrap_or(CLAY);
    let view = |samples| View {
        camera,
        size: args.size,
        lamps: &lamps,
        up,
        ground,
        paint: &paint,
        edge_samples: args.samples.unwrap_or(samples),
    };
    let picture = match way {
        Way::Rays => by_rays(caster, &view(RAYS_SAMPLES))?,
        #[cfg(feature = "gpu")]
        Way::Stencil { gpu, asked } => match by_stencil(&gpu, &caster, view(STENCIL_SAMPLES), asked) {
            Ok(picture) => picture,
            // Anything but a defect of ours.
            Err(error) if asked.is_none() && !matches!(error, GpuError::Wgpu(_)) => {
                note_rays(&error);
                by_rays(caster, &view(RAYS_SAMPLES))?
            }
            Err(error) => return Err(error.into()),
        },
    };
    picture.write_png(&args.output)?;
    output::wrote(&args.output);
    Ok(Outcome::Sound)
}

/// The base color of each face; empty if no material states one, so that all faces are of clay.
fn colors(mesh: &Mesh, materials: &[Material]) -> Vec<[f32; 3]> {
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

/// Lets go of the mesh: the ray cast has faces of its own.
fn by_rays(caster: Caster, view: &View<'_>) -> Result<Picture, Failure> {
    let oracle = caster.into_oracle();
    let progress = Progress::bar("rendering", view.steps());
    let picture = render::render(&oracle, view, &|steps| progress.done(steps));
    drop(progress);
    picture.map_err(|error| Failure::new(error, "choose a smaller --size"))
}

/// Says of each light how it was counted.
#[cfg(feature = "gpu")]
fn by_stencil(
    gpu: &Gpu,
    caster: &Caster,
    view: View<'_>,
    asked: Option<StencilMethod>,
) -> Result<Picture, GpuError> {
    let progress = Progress::spinner("rendering");
    let stage = Stage::new(gpu, caster, view, asked)?;
    let picture = stage.picture()?;
    drop(progress);
    output::say(format_args!("note: stencil pass on {}", output::plain(&gpu.name())));
    for (lamp, casting) in view.lamps.iter().zip(&stage.castings) {
        let label = lights::spot_label(&lamp.light, lamp.cone.is_some(), "");
        output::say(format_args!("note: {label}: {}", casting.methods.summary()));
        if asked == Some(StencilMethod::ZPass) {
            match zpass_verdict(caster, &stage.projection, &lamp.light) {
                ZPassVerdict::Wrong => output::say(format_args!(
                    "warning: {label}: the near rectangle of the camera is in this light's shadow, so z-pass \
                     counts wrongly and the picture is wrong; use --method zfail or auto"
                )),
                ZPassVerdict::Right => {
                    output::say(format_args!("note: {label}: z-pass is proven to be right"))
                }
                _ => {}
            }
        }
    }
    Ok(picture)
}
