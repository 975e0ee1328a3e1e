//! `umbrage render`: a picture with exact shadows.

use std::path::{Path, PathBuf};

use umbrage::geom::Light;
use umbrage::oracle::Oracle;
use umbrage::picture::{self, CLAY, Ground, Lamp, View};
use umbrage::scene::{Camera, Size, Up};

use super::machine::ThreadArgs;
use super::output;
use super::progress::Progress;
use super::source::{Source, SourceArgs};
use super::values::refuse_overwriting;
use super::view::ViewArgs;
use super::{Failure, Outcome};

/// Picture: every pixel's visible point and its shadow by exact ray cast, flat faces, plain shading
///
/// Shading is for the eye, shadows are exact: a light is as strong far away as near. Lights asked for share one
/// brightness; those of a file keep the ratio that their candela and lux have at the centre of the scene, a spot
/// light within its cone. A point that a ray only grazes is drawn lit.
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

    /// Add a large floor below everything: lowest in z for stl and md2, lowest in y for every other format
    #[arg(long)]
    ground: bool,

    /// Where the picture is written, as PNG in sRGB (required)
    #[arg(short, long, value_name = "OUT.png")]
    output: PathBuf,

    #[command(flatten)]
    threads: ThreadArgs,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum Method {
    /// The fastest that is built
    Auto,
    /// Stencil counting in front of what is seen (not built yet)
    Zpass,
    /// Stencil counting behind what is seen (not built yet)
    Zfail,
    /// Exact ray cast
    Rays,
}

impl Method {
    fn settle(self) -> Result<(), Failure> {
        let refuse = |name| Err(Failure::not_built(format_args!("--method {name}"), "use --method rays"));
        match self {
            Self::Auto => {
                output::say("note: --method auto: no GPU pass in this build: rays");
                Ok(())
            }
            Self::Rays => Ok(()),
            Self::Zpass => refuse("zpass"),
            Self::Zfail => refuse("zfail"),
        }
    }
}

/// Rays along each side of a pixel at an edge.
const EDGE_SAMPLES: u32 = 3;

/// Whether a picture can be written under this name, as far as the name tells.
pub(crate) fn require_png(path: &Path) -> Result<(), Failure> {
    if path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("png")) {
        return Ok(());
    }
    Err(Failure::new("pictures are written as PNG only", "name a file that ends in .png").in_file(path))
}

pub(crate) fn run(args: Args) -> Result<Outcome, Failure> {
    require_png(&args.output)?;
    refuse_overwriting("--output", Some(&args.output), &args.source.file)?;
    let asked = args.view.camera(Up::Y)?; // nonsense is refused before the file is read
    args.method.settle()?;
    args.threads.apply()?;

    let Source { up, mesh, bounds, lights, camera: of_file, .. } = args.source.load()?;
    let camera = match asked {
        Some(_) => args.view.camera(up)?,
        None => of_file.inspect(|_| output::say("note: no --eye: using the camera of the file")),
    };
    let camera = camera.unwrap_or_else(|| Camera::fit(&bounds, up, args.size.aspect()));
    let lamps = if args.source.lights.were_asked_for() {
        Lamp::equal(&lights.iter().map(|light| light.light).collect::<Vec<Light>>())
    } else {
        Lamp::balanced(&lights, &bounds)
    };
    let (mesh, ground) = if args.ground {
        let (mesh, ground) = Ground::under(mesh, up)
            .map_err(|error| Failure::new(error, "leave out --ground").in_file(&args.source.file))?;
        (mesh, Some(ground))
    } else {
        (mesh, None)
    };

    let view = View {
        camera,
        size: args.size,
        lamps: &lamps,
        up,
        ground,
        paint: &|_| CLAY,
        edge_samples: EDGE_SAMPLES,
    };
    let oracle = Oracle::build(&mesh);
    drop(mesh);
    let progress = Progress::bar("rendering", view.steps());
    let picture = picture::render(&oracle, &view, &|steps| progress.done(steps));
    drop(progress);
    let picture = picture.map_err(|error| Failure::new(error, "choose a smaller --size"))?;
    picture.write_png(&args.output)?;
    output::wrote(&args.output);
    Ok(Outcome::Sound)
}
