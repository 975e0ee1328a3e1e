//! Index buffers beside the written mesh.

use std::path::{Path, PathBuf};

use umbrage::mesh::Mesh;
use umbrage::repair::shadow_indices;
use umbrage::topology::Topology;
use umbrage::write::write_atomic;

use super::Args;
use crate::cli::{Failure, output};

/// Bytes that are to be written to a file.
pub(super) struct Buffer {
    path: PathBuf,
    bytes: Vec<u8>,
}

/// The mesh as it was read, if an index buffer into it was asked for. Refuses buffers of several meshes.
pub(super) fn original(args: &Args, meshes: &[Mesh]) -> Result<Option<Mesh>, Failure> {
    for (option, path) in [("--shadow-indices", &args.shadow_indices), ("--adjacency", &args.adjacency)] {
        if path.is_some() && meshes.len() != 1 {
            let problem = format!("{option} is for one mesh, and there are {}", meshes.len());
            return Err(Failure::new(problem, "choose one by --only, or join them with --scope scene")
                .in_file(&args.file));
        }
    }
    Ok(args.shadow_indices.is_some().then(|| meshes[0].clone()))
}

/// The buffers that were asked for.
pub(super) fn of(args: &Args, original: Option<&Mesh>, meshes: &[&Mesh]) -> Result<Vec<Buffer>, Failure> {
    let mut buffers = Vec::new();
    let Some(&mesh) = meshes.first() else { return Ok(buffers) };
    if let (Some(path), Some(original)) = (&args.shadow_indices, original) {
        let indices = shadow_indices(original, mesh).ok_or_else(|| {
            let problem = "--shadow-indices: the file has frames, in which equal vertices may part";
            Failure::new(problem, "leave it out").in_file(&args.file)
        })?;
        buffers.push(Buffer::of(path, indices.as_flattened()));
    }
    if let Some(path) = &args.adjacency {
        let topology = Topology::of(mesh);
        let adjacency = topology.adjacency().map_err(|edge| {
            let [a, b] = topology.vertices(edge);
            let faces = topology.valence(edge);
            let problem = format!("--adjacency: the edge from vertex {} to {} has {faces} faces", a.0, b.0);
            Failure::new(problem, "add --split").in_file(&args.file)
        })?;
        buffers.push(Buffer::of(path, adjacency.as_flattened()));
    }
    Ok(buffers)
}

impl Buffer {
    fn of(path: &Path, indices: &[u32]) -> Self {
        let bytes = indices.iter().flat_map(|index| index.to_le_bytes()).collect();
        Self { path: path.to_owned(), bytes }
    }
}

/// Writes each buffer, completely or not at all.
pub(super) fn write(buffers: Vec<Buffer>) -> Result<(), Failure> {
    for Buffer { path, bytes } in buffers {
        write_atomic(&path, |writer| writer.write_all(&bytes))?;
        output::wrote(&path);
    }
    Ok(())
}
