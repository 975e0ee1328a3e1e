//! `umbrage view`: a window.
//!
//! What a person changes is a [`State`](state::State), which knows no window. A thread of its own draws what
//! the state asks for, as `umbrage render` does; the window shows the answer, and lines over it.

#![cfg_attr(not(feature = "viewer"), allow(dead_code, reason = "tests use a part of it"))]

#[cfg(feature = "viewer")]
mod app;
#[cfg(feature = "viewer")]
mod canvas;
#[cfg(feature = "viewer")]
mod open;
#[cfg(feature = "viewer")]
mod panels;

// What needs no window is tested in every build.
#[cfg(any(test, feature = "viewer"))]
mod colors;
#[cfg(any(test, feature = "viewer"))]
mod defects;
#[cfg(any(all(test, feature = "gpu"), feature = "viewer"))]
mod device;
#[cfg(any(all(test, feature = "gpu"), feature = "viewer"))]
mod frame;
#[cfg(any(test, feature = "viewer"))]
mod handle;
#[cfg(any(test, feature = "viewer"))]
mod orbit;
#[cfg(any(test, feature = "viewer"))]
mod pace;
#[cfg(any(test, feature = "viewer"))]
mod state;
#[cfg(any(test, feature = "viewer"))]
mod strokes;
#[cfg(any(all(test, feature = "gpu"), feature = "viewer"))]
mod worker;

use std::path::PathBuf;

use umbrage::view::Size;

use super::input::SourceArgs;
use super::parsers::{refuse_overwriting, require_folder};
use super::render::require_png;
use super::resources::{AdapterArgs, ThreadArgs};
use super::shadow::ShadowArgs;
use super::view::ViewArgs;
use super::{Failure, Outcome};

/// Keys of `--help`.
const KEYS: &str = "\
In the window:
  drag                turn the view; on a light, or on the divider: move it
  right drag          move the view
  wheel               come nearer; over a light: move the light nearer
  T, L                next technique of a light, next light
  M                   picture, difference to the truth, light grid
  1 to 6              truth, silhouette, shadow volume, caps, defects, handles
  N                   fly to the next defect
  ?                   help
  Q                   close the window

Another file that is dropped on the window is opened with the same options.";

/// Window: move the lights, and see silhouette, volume and defects, and each technique beside the truth
///
/// It is a part of builds with the feature viewer: cargo install umbrage --features viewer.
///
/// Pictures are made as by umbrage render: `stencil`, `zfail` and `zpass` on a graphics adapter if there is
/// one, all other techniques on the CPU. While something moves they are coarse, so that they are prompt.
#[derive(Clone, Debug, clap::Args)]
#[command(after_help = KEYS)]
pub(crate) struct Args {
    #[command(flatten)]
    source: SourceArgs,

    #[command(flatten)]
    view: ViewArgs,

    #[command(flatten)]
    shadow: ShadowArgs,

    /// Width and height of the window, each at most 16384
    #[arg(long, value_name = "WxH", default_value = "1280x800", allow_hyphen_values = true)]
    size: Size,

    /// What a pixel shows at first
    #[arg(long, value_enum, default_value_t = ModeArg::Picture)]
    mode: ModeArg,

    /// What is shown beside or over the picture at first; may be repeated, or given as a list with commas
    /// [default: lights]
    #[arg(long, value_enum, value_name = "LAYER", value_delimiter = ',')]
    show: Vec<LayerArg>,

    /// Colors of the panels
    #[arg(long, value_enum, default_value_t = ThemeArg::System)]
    theme: ThemeArg,

    /// Add a large floor below everything: lowest in z for stl, md2 and 3mf, lowest in y for others
    #[arg(long)]
    ground: bool,

    /// Write what the window shows, as soon as all is drawn, and close it [default: it stays open]
    #[arg(long, value_name = "OUT.png")]
    screenshot: Option<PathBuf>,

    #[command(flatten)]
    threads: ThreadArgs,

    #[command(flatten)]
    adapter: AdapterArgs,
}

/// What a pixel stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum ModeArg {
    /// The lit scene
    Picture,
    /// The difference of a light's shadow from the truth, in false colors
    Difference,
    /// What the light grid proves of each point
    Grid,
}

/// What is shown beside or over the picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum LayerArg {
    /// The truth, left of a divider
    Truth,
    /// Silhouette edges
    Silhouette,
    /// Edges of the shadow volume
    Volume,
    /// The faces of its caps: toward the light yellow, away from it blue
    Caps,
    /// Defects of the meshes
    Defects,
    /// Handles of the lights
    Lights,
}

/// Colors of the panels.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum ThemeArg {
    /// As the desktop says; dark, where it says nothing
    System,
    Light,
    Dark,
}

pub(crate) fn run(args: Args) -> Result<Outcome, Failure> {
    if let Some(path) = &args.screenshot {
        require_png(path)?;
        refuse_overwriting("--screenshot", Some(path), &args.source.file)?;
        require_folder(path)?;
    }
    if let Some(path) = args.shadow.plan()? {
        let problem = format!("--shadow {}: a window draws no saved plan", path.display());
        return Err(Failure::new(problem, "use umbrage render, or --shadow auto"));
    }
    args.view.refuse()?;
    open(args)
}

#[cfg(feature = "viewer")]
use open::open;

#[cfg(not(feature = "viewer"))]
fn open(args: Args) -> Result<Outcome, Failure> {
    // Options of the window alone.
    let Args { size: _, mode: _, show: _, theme: _, ground: _, threads: _, adapter: _, .. } = args;
    let problem = "this build has no window: it was built without the feature viewer";
    Err(Failure::new(problem, "cargo install umbrage --features viewer, or use umbrage render"))
}
