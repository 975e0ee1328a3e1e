//! One file and its lights: the input of every command but `check`.

use std::path::PathBuf;

use umbrage::caster::Caster;
use umbrage::geom::Aabb;
use umbrage::scene::{Lamp, Material};
use umbrage::view::Up;

use super::lights::LightArgs;
use super::load::MeshArgs;
use super::view::Cameras;
use super::{Failure, load};

/// The file, how it is welded, and its lights.
#[derive(Clone, Debug, clap::Args)]
pub(crate) struct SourceArgs {
    /// A mesh file: obj, gltf, glb, stl, ply, md2; recognized by its content, then by its extension
    pub(crate) file: PathBuf,

    #[command(flatten)]
    pub(crate) mesh: MeshArgs,

    #[command(flatten)]
    pub(crate) lights: LightArgs,
}

/// All meshes of a file as one caster, and the lights.
#[derive(Debug)]
pub(crate) struct Source {
    /// The format's name, as reports give it.
    pub(crate) format: Option<&'static str>,
    pub(crate) up: Up,
    pub(crate) caster: Caster,
    pub(crate) bounds: Aabb,
    pub(crate) lights: Vec<Lamp>,
    pub(crate) cameras: Cameras,
    pub(crate) materials: Vec<Material>,
}

impl SourceArgs {
    /// Reads, bakes, welds and joins the file, and chooses the lights. Notes go to standard error.
    pub(crate) fn load(&self) -> Result<Source, Failure> {
        self.lights.refuse()?;
        let baked = self.mesh.read_visible(&self.file)?;
        let up = baked.up;
        let mesh = self.mesh.joined(baked.meshes, &self.file)?;
        load::note_no_faces(&self.file, &mesh);
        let bounds = load::bounds(&mesh);
        let lights = self.lights.resolve(baked.lights, bounds, up);
        let format = baked.format.map(|format| format.name());
        Ok(Source {
            format,
            up,
            caster: Caster::new(mesh),
            bounds,
            lights,
            cameras: baked.cameras,
            materials: baked.materials,
        })
    }
}
