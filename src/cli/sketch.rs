//! Pictures that explain: the mesh as a lamp sees it, with lines over it.

use std::path::{Path, PathBuf};

use umbrage::facing::classify;
use umbrage::geom::{Aabb, Facing, Light};
use umbrage::mesh::{FaceId, Mesh};
use umbrage::oracle::Oracle;
use umbrage::render::{Line, Marker, Overlay, veil};
use umbrage::view::{Camera, Size};

use super::caption::{Key, captioned};
use super::input::Source;
use super::parsers::{refuse_overwriting, require_folder};
use super::progress::Progress;
use super::render::require_png;
use super::view::ViewArgs;
use super::{Failure, output};

/// Where a picture goes, and from where it is seen.
#[derive(Clone, Debug, clap::Args)]
pub(crate) struct SketchArgs {
    /// Draw it over the mesh, with a legend below; that of a second light is OUT-2.png, and so on
    /// [default: nothing is drawn]
    ///
    /// Faces on the light's side are bright, all others dark. Lines are dimmed where the mesh hides them.
    #[arg(long, value_name = "OUT.png")]
    picture: Option<PathBuf>,

    /// Width and height of the picture in pixels, each at most 16384, without the legend
    #[arg(long, value_name = "WxH", default_value = "960x540", allow_hyphen_values = true)]
    size: Size,

    #[command(flatten)]
    view: ViewArgs,
}

/// Colors with one meaning in all such pictures.
pub(crate) const SILHOUETTE: [u8; 3] = [225, 60, 0];
pub(crate) const SIDES: [u8; 3] = [0, 80, 190];
pub(crate) const FAR_END: [u8; 3] = [20, 30, 90];
const LAMP: [u8; 3] = [250, 200, 40];
const LIT: [u8; 3] = [236, 226, 200];
const UNLIT: [u8; 3] = [110, 116, 134];

/// What is drawn of one light.
pub(crate) struct Sketch {
    pub(crate) light: Light,
    /// The first lines of the legend.
    pub(crate) titles: Vec<String>,
    pub(crate) lines: Vec<Line>,
    /// What the lines are.
    pub(crate) keys: Vec<Key>,
    /// A translucent surface.
    pub(crate) glass: Option<Mesh>,
}

impl SketchArgs {
    pub(crate) fn is_asked(&self) -> bool {
        self.picture.is_some()
    }

    /// Refuses what cannot be drawn, before any work.
    pub(crate) fn refuse(&self, file: &Path) -> Result<(), Failure> {
        self.view.refuse()?;
        match &self.picture {
            Some(path) => {
                require_png(path)?;
                require_folder(path)?;
                refuse_overwriting("--picture", Some(path), file)
            }
            None if self.view.was_asked_for() => {
                let problem = "--eye, --camera and --near are for a picture";
                Err(Failure::new(problem, "add --picture OUT.png, or leave them out"))
            }
            None => Ok(()),
        }
    }

    /// Draws the sketches, one a light. `bounds` is what a view without an eye shows.
    pub(crate) fn draw(
        &self,
        source: &Source,
        file: &Path,
        bounds: &Aabb,
        sketches: Vec<Sketch>,
    ) -> Result<(), Failure> {
        let Some(path) = &self.picture else { return Ok(()) };
        let camera = self.view.choose(&source.cameras, file, bounds, source.up, self.size)?;
        for (index, sketch) in sketches.into_iter().enumerate() {
            let path = output::numbered(path, index + 1);
            refuse_overwriting("--picture", Some(&path), file)?;
            self.draw_one(source, &camera, sketch, &path)?;
        }
        Ok(())
    }

    fn draw_one(&self, source: &Source, camera: &Camera, sketch: Sketch, path: &Path) -> Result<(), Failure> {
        let Sketch { light, titles, lines, mut keys, glass } = sketch;
        let steps = if glass.is_some() { 3 } else { 2 };
        let progress = Progress::bar("drawing", steps * u64::from(self.size.height()));
        let mesh = source.seen.as_ref().unwrap_or(&source.caster);
        let facing = classify(mesh.mesh(), &light);
        let side = |(face, facing): (usize, &Facing)| {
            (FaceId(face as u32), if *facing == Facing::Front { LIT } else { UNLIT })
        };
        let [width, height] = [self.size.width(), self.size.height()].map(f64::from);
        let at = camera.rays(self.size).project(light.xyz());
        let is_within =
            at.is_some_and(|at| (0.0..width).contains(&at.x_px) && (0.0..height).contains(&at.y_px));
        let is_seen = !light.is_directional() && is_within;
        let lamp = is_seen.then(|| Marker { at: light.xyz(), color: LAMP });
        keys.push((LIT, "faces on the light's side".to_owned()));
        keys.push((UNLIT, "faces away from it".to_owned()));
        keys.extend(lamp.map(|lamp| (lamp.color, "light".to_owned())));
        let overlay = Overlay {
            order: vec![FAR_END, SIDES, SILHOUETTE],
            lines,
            spots: lamp.into_iter().collect(),
            faces: facing.iter().enumerate().map(side).collect(),
        };
        let done = |steps| progress.done(steps);
        let picture = overlay.render_from(*camera, mesh.oracle(), source.up, self.size, &done);
        let mut picture = picture.map_err(|error| Failure::new(error, "choose a smaller --size"))?;
        if let Some(glass) = glass {
            veil(&mut picture, camera, mesh.oracle(), &Oracle::build(&glass), SIDES, &done);
        }
        drop(progress);
        let titles: Vec<&str> = titles.iter().map(String::as_str).collect();
        captioned(picture, &titles, &keys).write_png(path)?;
        output::wrote(path);
        Ok(())
    }
}
