//! Index buffers and lists beside the written mesh.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use umbrage::mesh::Mesh;
use umbrage::repair::{IndexMap, shadow_indices};
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
    if let Some((option, _)) = args.beside().next().filter(|_| meshes.len() != 1) {
        let problem = format!("{option} is for one mesh, and there are {}", meshes.len());
        return Err(Failure::new(problem, "choose one by --only, or join them with --scope scene")
            .in_file(&args.file));
    }
    Ok(args.shadow_indices.is_some().then(|| meshes[0].clone()))
}

/// The buffers that were asked for.
pub(super) fn of(
    args: &Args,
    original: Option<&Mesh>,
    map: Option<&(IndexMap, IndexMap)>,
    meshes: &[&Mesh],
) -> Result<Vec<Buffer>, Failure> {
    let mut buffers = Vec::new();
    let Some(&mesh) = meshes.first() else { return Ok(buffers) };
    if let (Some(path), Some(original)) = (&args.shadow_indices, original) {
        let indices = shadow_indices(original, mesh).ok_or_else(|| {
            let problem = "--shadow-indices: a vertex of the result is none of the file's";
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
    if let Some(path) = &args.edges {
        buffers.push(edges(path, &Topology::of(mesh)));
    }
    if let (Some(path), Some(map)) = (&args.map, map) {
        buffers.push(index_map(path, map));
    }
    Ok(buffers)
}

/// The list of edges, as JSON or as integers.
fn edges(path: &Path, topology: &Topology) -> Buffer {
    if !is_json(path) {
        let mut words = vec![topology.edge_count() as u32]; // ids of edges have 32 bits
        for edge in topology.edge_list() {
            // A negative number is stored as its two's complement.
            words.extend([edge.a.0, edge.b.0, edge.multiplicity as u32, edge.faces.len() as u32]);
            words.extend(edge.faces.iter().map(|face| face.0));
        }
        return Buffer::of(path, &words);
    }
    let mut text = String::from("{\"edges\":[");
    for (index, edge) in topology.edge_list().enumerate() {
        let comma = if index > 0 { ",\n" } else { "\n" };
        let _ = write!(text, "{comma}{{\"a\":{},\"b\":{},\"faces\":", edge.a.0, edge.b.0);
        list(&mut text, edge.faces.iter().map(|face| face.0));
        let _ = write!(text, ",\"multiplicity\":{}}}", edge.multiplicity);
    }
    text.push_str("\n]}\n");
    Buffer { path: path.to_owned(), bytes: text.into_bytes() }
}

/// Where the old vertices and faces are, as JSON or as integers.
fn index_map(path: &Path, (vertices, faces): &(IndexMap, IndexMap)) -> Buffer {
    if !is_json(path) {
        let mut words = Vec::new();
        for map in [vertices, faces] {
            let (starts, new) = map.to_lists();
            words.push(map.len() as u32); // a mesh has fewer vertices and faces
            words.extend_from_slice(starts);
            words.extend_from_slice(new);
        }
        return Buffer::of(path, &words);
    }
    let mut text = String::from("{");
    for (key, map) in [("vertices", vertices), ("faces", faces)] {
        let _ = write!(text, "{}\"{key}\":[", if key == "faces" { "],\n" } else { "" });
        for (index, new) in map.iter().enumerate() {
            text.push_str(if index > 0 { "," } else { "" });
            list(&mut text, new.iter().copied());
        }
    }
    text.push_str("]}\n");
    Buffer { path: path.to_owned(), bytes: text.into_bytes() }
}

fn list(text: &mut String, numbers: impl Iterator<Item = u32>) {
    text.push('[');
    for (index, number) in numbers.enumerate() {
        let _ = write!(text, "{}{number}", if index > 0 { "," } else { "" });
    }
    text.push(']');
}

fn is_json(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("json"))
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
