//! One file and its lights: the input of every command but `check`.

use std::path::PathBuf;

use umbrage::caster::{Caster, CasterGroup};
use umbrage::geom::Aabb;
use umbrage::mesh::{Mesh, MeshError};
use umbrage::render::Ground;
use umbrage::scene::{Lamp, Material, Pattern, Scene};
use umbrage::view::Up;

use super::lights::LightArgs;
use super::load::{MeshArgs, parse_pattern};
use super::pose::PoseArgs;
use super::view::Cameras;
use super::{Failure, load};

/// The file, how it is welded, and its lights.
#[derive(Clone, Debug, clap::Args)]
pub(crate) struct SourceArgs {
    /// A mesh file, or - for standard input: obj, gltf, glb, stl, ply, off, md2, 3mf; also in gzip or ZIP;
    /// recognized by its content, then by its extension
    pub(crate) file: PathBuf,

    #[command(flatten)]
    pub(crate) mesh: MeshArgs,

    #[command(flatten)]
    pub(crate) pose: PoseArgs,

    #[command(flatten)]
    pub(crate) cast: CastArgs,

    #[command(flatten)]
    pub(crate) lights: LightArgs,
}

/// What casts.
#[derive(Clone, Debug, Default, clap::Args)]
pub(crate) struct CastArgs {
    /// What has such a name is seen and receives shadows, but casts none: a node, mesh, part or material; may
    /// be repeated [default: everything casts]
    ///
    /// `*` stands for any characters, `?` for one; case counts. For example: --no-cast 'Sky*'.
    #[arg(long, value_name = "PATTERN", value_parser = parse_pattern)]
    no_cast: Vec<Pattern>,
}

impl CastArgs {
    pub(crate) fn no_cast(&self) -> &[Pattern] {
        &self.no_cast
    }
}

/// All meshes of a file as one caster, what is seen beside it, and the lights.
#[derive(Debug)]
pub(crate) struct Source {
    /// The format's name, as reports give it.
    pub(crate) format: Option<&'static str>,
    pub(crate) up: Up,
    pub(crate) caster: Caster,
    /// The caster's faces and then those that only receive; `None` if there are none such.
    pub(crate) seen: Option<Caster>,
    /// Of all that is seen.
    pub(crate) bounds: Aabb,
    pub(crate) lights: Vec<Lamp>,
    pub(crate) cameras: Cameras,
    pub(crate) materials: Vec<Material>,
}

impl SourceArgs {
    /// Reads, bakes, welds and joins the file, and chooses the lights. Notes go to standard error.
    pub(crate) fn load(&self) -> Result<Source, Failure> {
        self.of(self.scene()?, None)
    }

    /// The whole scene at the moment that is asked for.
    fn scene(&self) -> Result<Scene, Failure> {
        self.pose.apply(load::read_whole(&self.file)?, &self.file)
    }

    /// The same of a scene that was read. `bounds` is what lights without a place of their own are placed by,
    /// and what is looked at; that of the scene if there is none.
    pub(crate) fn of(&self, whole: Scene, bounds: Option<Aabb>) -> Result<Source, Failure> {
        let (baked, receivers) = self.mesh.visible(whole, &self.file, &self.cast.no_cast)?;
        let up = baked.up;
        let mesh = self.mesh.joined(baked.meshes, &self.file)?;
        load::note_no_faces(&self.file, &mesh);
        let seen = match receivers.is_empty() {
            true => None,
            false => {
                let receivers = self.mesh.joined(receivers, &self.file)?;
                let all = Mesh::concat(&[mesh.clone(), receivers]);
                Some(all.map_err(|error| Failure::new(error, "split the file").in_file(&self.file))?)
            }
        };
        let bounds = bounds.unwrap_or_else(|| load::bounds(seen.as_ref().unwrap_or(&mesh)));
        let lights = self.lights.resolve(baked.lights, bounds, up);
        let format = baked.format.map(|format| format.name());
        Ok(Source {
            format,
            up,
            caster: Caster::new(mesh),
            seen: seen.map(Caster::new),
            bounds,
            lights,
            cameras: baked.cameras,
            materials: baked.materials,
        })
    }
}

impl SourceArgs {
    /// All that casts, as one mesh, for questions without lights.
    pub(crate) fn load_caster(&self) -> Result<Mesh, Failure> {
        let (baked, _) = self.mesh.visible(self.scene()?, &self.file, &self.cast.no_cast)?;
        self.mesh.joined(baked.meshes, &self.file)
    }
}

impl Source {
    /// All that is seen: the caster, unless some of it only receives.
    pub(crate) fn seen(&self) -> &Caster {
        self.seen.as_ref().unwrap_or(&self.caster)
    }

    /// Adds a ground below all that is seen. It casts too, for light from below.
    pub(crate) fn add_ground(&mut self) -> Result<Ground, MeshError> {
        let below = |caster: &mut Caster, bounds: &Aabb, up| {
            let (mesh, ground) = Ground::below(
                std::mem::replace(caster, Caster::new(Mesh::default())).into_mesh(),
                bounds,
                up,
            )?;
            *caster = Caster::new(mesh);
            Ok(ground)
        };
        let ground = below(&mut self.caster, &self.bounds, self.up)?;
        match &mut self.seen {
            None => Ok(ground),
            Some(seen) => below(seen, &self.bounds, self.up),
        }
    }

    /// The caster in a scene with all that is seen.
    pub(crate) fn group(&self) -> CasterGroup<'_> {
        let group = CasterGroup::new(vec![&self.caster]);
        match &self.seen {
            None => group,
            Some(seen) => group.seen_with(seen),
        }
    }
}
