//! The model: its faces in the order of its file, which of them hide, and the file itself where it is a glTF.

use std::path::Path;

use umbrage::mesh::Mesh;
use umbrage::read::Format;
use umbrage::scene::{Pattern, Scene};
use umbrage::write::{GltfFile, OcclusionOptions, Target};

use super::{Args, PerArg, note};
use crate::cli::{Failure, files, load};

/// Faces in two orders: that of the file, and that in which they are worked on, those that hide first.
pub(super) struct Input {
    pub(super) format: Option<Format>,
    /// As they are written, in the order of the file.
    pub(super) meshes: Vec<Mesh>,
    /// The meshes that hide.
    pub(super) casting: Vec<Mesh>,
    /// The meshes that only receive.
    pub(super) receiving: Vec<Mesh>,
    /// For each face that is worked on, its number in the order of the file.
    pub(super) order: Vec<u32>,
    /// The file to be added to.
    pub(super) gltf: Option<Gltf>,
    /// The normals of the file, in its order.
    pub(super) normals: Vec<Option<[[f32; 3]; 3]>>,
}

/// A glTF, and which of its parts are asked for.
pub(super) struct Gltf {
    pub(super) file: GltfFile,
    pub(super) kept: Vec<bool>,
    pub(super) options: OcclusionOptions,
}

impl Input {
    /// Reads the file, and refuses one that cannot be written.
    pub(super) fn read(args: &Args, target: Target) -> Result<Self, Failure> {
        let file = &args.file;
        let in_file = |failure: Failure| failure.in_file(file);
        // Standard input can be read once only.
        let bytes = files::is_standard_input(file).then(|| files::standard_input(file)).transpose()?;
        let whole = match &bytes {
            Some(bytes) => umbrage::read::read_bytes(bytes, file)?,
            None => load::read_whole(file)?,
        };
        let format = whole.format;
        let kept: Vec<bool> = whole.placed_parts().map(|part| args.mesh.shows(&part)).collect();
        let gltf = match format {
            Some(Format::Gltf | Format::Glb) => Gltf::open(args, target, bytes, kept)?,
            _ => None,
        };
        let mut scene = args.mesh.chosen(whole, file)?;
        load::leave_out_invisible(&mut scene, file)?;
        let casts = casts(args, &scene)?;
        let meshes = args.mesh.bake(scene, file)?;
        let faces: usize = meshes.iter().map(Mesh::face_count).sum();
        if faces == 0 {
            return Err(in_file(Failure::new("there are no faces", "name a mesh that has some")));
        }
        let normals = match &gltf {
            Some(gltf) if args.per == PerArg::Corner => {
                let normals = gltf.file.normals(Some(&gltf.kept), &gltf.options);
                // What cannot be added to (compressed data) may still be written anew.
                if target == Target::Glb {
                    normals.map_err(|error| in_file(error.into()))?
                } else {
                    normals.unwrap_or_default()
                }
            }
            _ => Vec::new(),
        };
        let mut input = Self {
            format,
            casting: Vec::new(),
            receiving: Vec::new(),
            order: (0..faces as u32).collect(),
            meshes,
            gltf: gltf.filter(|_| target == Target::Glb),
            normals,
        };
        input.divide(args, &casts)?;
        Ok(input)
    }

    /// Divides the meshes into those that hide and those that only receive, and welds them.
    fn divide(&mut self, args: &Args, casts: &[bool]) -> Result<(), Failure> {
        let is_cast = |face: u32| casts.get(face as usize) != Some(&false);
        let pick = |wanted: bool| -> Result<Vec<Mesh>, Failure> {
            let (mut first, mut picked) = (0, Vec::new());
            for mesh in &self.meshes {
                let faces = (first..).zip(mesh.triangles());
                let triangles = faces.filter(|&(face, _)| is_cast(face) == wanted).map(|(_, &t)| t).collect();
                first += mesh.face_count() as u32;
                let mesh = Mesh::new(mesh.positions().to_vec(), triangles);
                let mesh = mesh.map_err(|error| Failure::new(error, "split the file").in_file(&args.file))?;
                picked.push(if args.mesh.welds_within() { args.mesh.weld(mesh).mesh } else { mesh });
            }
            Ok(picked)
        };
        self.casting = pick(true)?;
        if casts.contains(&false) {
            self.receiving = pick(false)?;
            self.order.sort_by_key(|&face| !is_cast(face)); // stable
        }
        Ok(())
    }

    /// All meshes, in the order in which they are worked on.
    pub(super) fn all(&self) -> Vec<&Mesh> {
        self.casting.iter().chain(&self.receiving).collect()
    }
}

/// Whether each face hides; empty if all of them do.
fn casts(args: &Args, scene: &Scene) -> Result<Vec<bool>, Failure> {
    let no_cast: &[Pattern] = args.cast.no_cast();
    if no_cast.is_empty() {
        return Ok(Vec::new());
    }
    load::require_matches(scene, "--no-cast", no_cast).map_err(|failure| failure.in_file(&args.file))?;
    let mut casts = Vec::new();
    let mut parts = scene.placed_parts();
    for instance in &scene.instances {
        let mesh = &scene.meshes[instance.mesh];
        let first = casts.len();
        // Faces of no part hide, unless they are left out.
        let of_no_part = mesh.parts().len() > 1 && args.mesh.splits_parts();
        casts.resize(first + mesh.face_count(), true);
        let mut kept = vec![!of_no_part; mesh.face_count()];
        for part in parts.by_ref().take(mesh.parts().len().max(1)) {
            let faces = part.part.map_or(0..mesh.face_count() as u32, |part| part.faces.clone());
            let faces = faces.start as usize..faces.end as usize;
            kept[faces.clone()].fill(true);
            casts[first + faces.start..first + faces.end].fill(!load::matches_any(&part, no_cast));
        }
        let mut kept = (0..first).map(|_| true).chain(kept);
        casts.retain(|_| kept.next() == Some(true));
    }
    Ok(casts)
}

impl Gltf {
    /// The file, if it can be added to. Where another format is written it need not.
    fn open(
        args: &Args,
        target: Target,
        bytes: Option<Vec<u8>>,
        kept: Vec<bool>,
    ) -> Result<Option<Self>, Failure> {
        let file = match bytes {
            Some(bytes) => GltfFile::from_bytes(bytes).map_err(|error| error.in_file(&args.file)),
            None => GltfFile::open(Path::new(&args.file)),
        };
        let file = match file {
            Ok(file) => file,
            Err(_) if target != Target::Glb => return Ok(None),
            Err(error) => return Err(error.into()),
        };
        let options = OcclusionOptions::new(args.form()).replacing(args.replace);
        if target == Target::Glb {
            file.check(Some(&kept), &options).map_err(|error| Failure::from(error).in_file(&args.file))?;
        } else if args.per != PerArg::Corner {
            note(args, "its normals are not used");
        }
        Ok(Some(Self { file, kept, options }))
    }
}
