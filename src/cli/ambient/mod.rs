//! `umbrage ambient`: ambient occlusion, written into a file.

mod compute;
mod input;
mod inside;
mod json;
mod save;
mod text;

use std::path::PathBuf;
use std::time::Instant;

use umbrage::ambient::{MOST_INSIDE, MOST_RAYS, Per};
use umbrage::write::{Form, Target};

use super::input::CastArgs;
use super::load::MeshArgs;
use super::output::{self, Output};
use super::parsers::{distance, refuse_overwriting, require_folder};
use super::resources::ThreadArgs;
use super::{Failure, Outcome};
use input::Input;

/// Ambient occlusion: how much of an even sky each corner of each face sees, written into the model
///
/// Rays start at exactly the vertex, without an offset: no acne, and no light through thin walls. A glTF gets
/// the values and is otherwise the same: materials, animations and extras stay; its buffers, and images
/// beside it, become part of the GLB. A vertex with several values is split, and a mesh that several nodes
/// show becomes one a node. What --only leaves out stays as it is. Models in other formats are written anew,
/// without materials; a PLY gets `quality` and colors.
///
/// Meshes hide each other, and a point in another solid has the value 0. Where a file has normals (glTF),
/// they are used; else faces meet smoothly below 60 degrees.
#[derive(Clone, Debug, clap::Args)]
#[command(after_long_help = "Examples:\n  \
    umbrage ambient model.glb -o baked.glb\n  \
    umbrage ambient model.glb -o baked.glb --error 0.005 --as attribute --bent\n  \
    umbrage ambient scan.stl -o scan.ply --rays 256\n  \
    umbrage ambient hall.glb -o baked.glb --fit --inside 20000\n  \
    umbrage ambient room.glb -o baked.glb --distance 2 --ambient-falloff linear")]
pub(crate) struct Args {
    /// A mesh file, or - for standard input: obj, gltf, glb, stl, ply, off, md2, 3mf; also in gzip or ZIP;
    /// recognized by its content, then by its extension
    file: PathBuf,

    /// Where the model with occlusion is written (required)
    #[arg(short, long, value_name = "OUT.{glb,ply}")]
    output: PathBuf,

    /// How openness is worked out
    #[arg(long, value_enum, default_value_t = Method::Rays)]
    method: Method,

    /// How many rays from each point, at most 1048576 [default: 64]
    ///
    /// Up to 64 rays, a point takes the mean with those neighbors whose values differ from its own by no more
    /// than noise explains.
    #[arg(long, value_name = "N", value_parser = rays, conflicts_with = "error", allow_negative_numbers = true)]
    rays: Option<u32>,

    /// As many rays as keep the standard error of a value at this size [default: --rays decides]
    ///
    /// For example: --error 0.01, some 150 rays; half the error takes 2.5 times as many.
    #[arg(long, value_name = "E", value_parser = error, allow_negative_numbers = true)]
    error: Option<f64>,

    /// How far a face may be to hide, in mesh units [default: however far]
    #[arg(long, value_name = "DIST", value_parser = distance, allow_negative_numbers = true)]
    distance: Option<f32>,

    /// How a face hides within --distance
    #[arg(long, value_enum, default_value_t = FalloffArg::None)]
    ambient_falloff: FalloffArg,

    /// What has one value
    #[arg(long, value_enum, default_value_t = PerArg::Corner)]
    per: PerArg,

    /// Choose the values that fit what is inside faces best, not what is at their corners alone
    ///
    /// Viewers draw values linearly over a face, so the middle of a large face shows nothing that its corners
    /// do not see. The fit is by least squares, over three points in each of the --inside triangles; it takes
    /// some six times as long on a fine mesh. The worst error that is left is reported, with its face: one
    /// that is still large asks for smaller faces there.
    #[arg(long)]
    fit: bool,

    /// Cut the faces into about N triangles of even size, ask in the middle of each, and report the error of
    /// the values there, and the face with the worst one [default with --fit: 4096]
    ///
    /// A face is one triangle at least. With rays the error has their noise in it.
    #[arg(long, value_name = "N", value_parser = inside, allow_negative_numbers = true)]
    inside: Option<u32>,

    /// What the values are written as, in a GLB [default: texture]
    #[arg(long = "as", value_enum, value_name = "FORM")]
    form: Option<FormArg>,

    /// Write the mean open direction too, as the attribute _BENT: for lookups in a sky
    #[arg(long)]
    bent: bool,

    /// Replace an occlusion texture or attribute that the file has already
    #[arg(long)]
    replace: bool,

    #[command(flatten)]
    mesh: MeshArgs,

    #[command(flatten)]
    cast: CastArgs,

    /// Print one JSON document instead of text
    #[arg(long)]
    json: bool,

    #[command(flatten)]
    threads: ThreadArgs,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum Method {
    /// Exact rays: right for any mesh, with noise that falls as the number of rays rises
    Rays,
    /// The analytic form: no noise, some 4000 rays' time
    Exact,
    /// A disk a vertex in a tree: fast, close on nearly convex scans, far off on folded shapes
    Disks,
}

impl Method {
    fn name(self) -> &'static str {
        match self {
            Self::Rays => "rays",
            Self::Exact => "exact",
            Self::Disks => "disks",
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum FalloffArg {
    /// Fully
    None,
    /// Linearly less with the distance, up to nothing
    Linear,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum PerArg {
    /// Each position
    Vertex,
    /// Each position and normal: hard edges have a value on each side
    Corner,
    /// Each face, at its middle
    Face,
}

impl From<PerArg> for Per {
    fn from(per: PerArg) -> Self {
        match per {
            PerArg::Vertex => Self::Vertex,
            PerArg::Corner => Self::Corner,
            PerArg::Face => Self::Face,
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum FormArg {
    /// An occlusion texture: a ramp, and texture coordinates; darkens indirect light only
    Texture,
    /// Vertex colors, times those there are; darkens direct light too
    Color,
    /// An attribute _OCCLUSION of 32-bit floats, which viewers do not show
    Attribute,
}

impl From<FormArg> for Form {
    fn from(form: FormArg) -> Self {
        match form {
            FormArg::Texture => Self::Texture,
            FormArg::Color => Self::Color,
            FormArg::Attribute => Self::Attribute,
        }
    }
}

/// A number of rays from each point.
pub(super) fn rays(text: &str) -> Result<u32, String> {
    match text.parse() {
        Ok(rays) if (1..=MOST_RAYS).contains(&rays) => Ok(rays),
        _ => Err(format!("write a whole number from 1 to {MOST_RAYS}")),
    }
}

fn inside(text: &str) -> Result<u32, String> {
    match text.parse() {
        Ok(pieces) if (1..=MOST_INSIDE).contains(&pieces) => Ok(pieces),
        _ => Err(format!("write a whole number from 1 to {MOST_INSIDE}")),
    }
}

fn error(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(error) if error > 0.0 && error < 1.0 => Ok(error),
        _ => Err("write a number between 0 and 1".to_owned()),
    }
}

/// What was worked out, as reports give it.
struct Found {
    receivers: usize,
    /// From each receiver; `None` for a method without rays.
    rays: Option<u32>,
    ring: bool,
    mean_openness: f64,
    standard_error: Option<f64>,
    /// Receivers in another solid; `None` for a method that does not ask.
    inside: Option<usize>,
    seconds: f64,
}

pub(crate) fn run(args: Args) -> Result<Outcome, Failure> {
    let target = args.refuse()?;
    args.threads.apply()?;
    let input = Input::read(&args, target)?;
    let begun = Instant::now();
    let values = compute::values(&args, &input)?;
    let seconds = begun.elapsed().as_secs_f64();
    save::save(&args, target, &input, &values)?;
    let found = values.found(seconds);
    let mut out = Output::new();
    if args.json {
        out.json(&json::document(&args, &input, &found, values.worst.as_ref()))?;
    } else {
        out.text(text::report(&args, &found, values.worst.as_ref()))?;
    }
    out.flush()?;
    Ok(Outcome::Sound)
}

impl Args {
    /// Refuses bad arguments before any work is done.
    fn refuse(&self) -> Result<Target, Failure> {
        let target = Target::from_path(&self.output)?;
        let at = |failure: Failure| failure.in_file(&self.output);
        match target {
            Target::Obj | Target::Stl => {
                let name = if target == Target::Obj { "OBJ" } else { "STL" };
                let problem = format!("{name} has no values of vertices");
                return Err(at(Failure::new(problem, "name a .glb or .ply file")));
            }
            Target::Ply if self.form.is_some() || self.bent || self.replace => {
                let problem = "--as, --bent and --replace: a PLY has `quality` and colors";
                return Err(at(Failure::new(problem, "leave them out, or name a .glb file")));
            }
            _ => {}
        }
        let of_rays = [
            ("--rays", self.rays.is_some()),
            ("--error", self.error.is_some()),
            ("--distance", self.distance.is_some()),
        ];
        if self.method != Method::Rays
            && let Some((flag, _)) = of_rays.into_iter().find(|(_, asked)| *asked)
        {
            let problem = format!("{flag}: --method {} has none", self.method.name());
            return Err(Failure::new(problem, "leave it out, or use --method rays"));
        }
        if self.ambient_falloff == FalloffArg::Linear && self.distance.is_none() {
            return Err(Failure::new("--ambient-falloff linear has no end", "add --distance"));
        }
        if self.per == PerArg::Face && self.inside().is_some() {
            let flag = if self.fit { "--fit" } else { "--inside" };
            let problem = format!("{flag}: with --per face nothing is drawn between corners");
            return Err(Failure::new(problem, "leave one of them out"));
        }
        refuse_overwriting("--output", Some(&self.output), &self.file)?;
        require_folder(&self.output)?;
        Ok(target)
    }

    /// The number of triangles to ask in, if any.
    fn inside(&self) -> Option<u32> {
        self.inside.or(self.fit.then_some(4096))
    }

    fn form(&self) -> Form {
        self.form.map_or(Form::default(), Form::from)
    }
}

/// A note about the file that is read.
fn note(args: &Args, text: impl std::fmt::Display) {
    output::say(format_args!("note: {}: {text}", output::plain(&args.file.to_string_lossy())));
}
