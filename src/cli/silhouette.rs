//! `umbrage silhouette`: the edges where the side of the light changes.

use std::path::{Path, PathBuf};

use serde_json::{Value, json};
use umbrage::geom::Light;
use umbrage::mesh::{Mesh, VertexId};
use umbrage::scene::SceneLight;
use umbrage::silhouette::{Casters, Facing, Silhouette, classify};
use umbrage::topology::Topology;
use umbrage::write::{self, Elements, Layer, Model, Target};

use super::lights;
use super::machine::AdapterArgs;
use super::output::{self, Output, Table, plain};
use super::progress::Progress;
use super::source::{Source, SourceArgs};
use super::values::refuse_overwriting;
use super::{Failure, Outcome};

/// Silhouette: the edges of a mesh where the side that a light is on changes
///
/// Every side is decided exactly. Each mesh of the file is welded by itself; the counts are over all of them.
#[derive(Clone, Debug, clap::Args)]
pub(crate) struct Args {
    #[command(flatten)]
    source: SourceArgs,

    /// How the silhouette is found; the result is the same
    #[arg(long, value_enum, default_value_t = Method::Auto)]
    method: Method,

    #[command(flatten)]
    adapter: AdapterArgs,

    /// Write the silhouette edges as lines, a layer for each light [default: nothing is written]
    #[arg(short, long, value_name = "OUT.{obj,ply,glb}")]
    output: Option<PathBuf>,

    /// Print one JSON document instead of a table: `file`, `format`, and `lights` with an object for each light
    #[arg(long)]
    json: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum Method {
    /// The cheapest that is built
    Auto,
    /// All faces, then all edges
    Scan,
    /// A tree of edges, for many lights on one mesh (not built yet)
    Tree,
    /// A compute shader (not built yet)
    Gpu,
}

impl Method {
    /// Why the silhouettes are found by a scan, the only method there is so far.
    fn reason(self) -> Result<&'static str, Failure> {
        let refuse = |name| Err(Failure::not_built(format_args!("--method {name}"), "use --method scan"));
        match self {
            Self::Auto => Ok("one look a light: a scan of all edges costs less than building anything first"),
            Self::Scan => Ok("asked for"),
            Self::Tree => refuse("tree"),
            Self::Gpu => refuse("gpu"),
        }
    }
}

/// What was found for one light.
struct Found {
    name: String,
    light: Light,
    front_faces: usize,
    edge_on_faces: usize,
    outline_edges: usize,
    loops: usize,
    /// With all faces casting.
    silhouette: Silhouette,
}

pub(crate) fn run(args: Args) -> Result<Outcome, Failure> {
    args.adapter.refuse()?;
    let reason = args.method.reason()?;
    if let Some(path) = &args.output {
        Target::from_path(path)?;
    }
    refuse_overwriting("--output", args.output.as_deref(), &args.source.file)?;
    let Source { format, mesh, lights, .. } = args.source.load()?;

    let progress = Progress::spinner("finding silhouettes");
    let topology = Topology::build(mesh.vertex_count(), mesh.triangles().to_vec());
    let found: Vec<Found> = lights.into_iter().map(|light| find(&mesh, &topology, light)).collect();
    drop(progress);

    if let Some(path) = &args.output {
        let layers = found.iter().enumerate().map(|(index, found)| lines(&mesh, &topology, index, found));
        write::write(&Model { layers: layers.collect() }, path)?;
        output::wrote(path);
    }
    let mut out = Output::new();
    if args.json {
        let lights: Vec<Value> = found.iter().map(|found| document(&topology, found, reason)).collect();
        out.json(&json!({ "file": args.source.file.to_string_lossy(), "format": format, "lights": lights }))?;
    } else {
        out.text(table(&args.source.file, &topology, &found))?;
        out.text(format_args!("\n  method scan: {reason}\n"))?;
    }
    out.flush()?;
    Ok(Outcome::Sound)
}

/// The silhouettes of several lights: a table, and a layer of lines for each.
pub(super) fn of_lights(
    file: &Path,
    mesh: &Mesh,
    topology: &Topology,
    lights: &[SceneLight],
) -> (String, Model) {
    let found: Vec<Found> = lights.iter().map(|light| find(mesh, topology, light.clone())).collect();
    let layers = found.iter().enumerate().map(|(index, found)| lines(mesh, topology, index, found));
    (table(file, topology, &found), Model { layers: layers.collect() })
}

fn find(mesh: &Mesh, topology: &Topology, SceneLight { name, light, .. }: SceneLight) -> Found {
    let facing = classify(mesh, &light);
    let count = |wanted| facing.iter().filter(|&&facing| facing == wanted).count();
    let silhouette = Silhouette::extract(topology, &Casters::All.signs(&facing));
    let outline = Silhouette::extract(topology, &Casters::Front.signs(&facing));
    Found {
        name,
        light,
        front_faces: count(Facing::Front),
        edge_on_faces: count(Facing::EdgeOn),
        outline_edges: outline.edges.len(),
        loops: silhouette.loops(topology).len(),
        silhouette,
    }
}

fn document(topology: &Topology, found: &Found, reason: &str) -> Value {
    json!({
        "light": found.light.to_string(),
        "name": lights::name(&found.name),
        "faces": topology.face_count(),
        "front_faces": found.front_faces,
        "edge_on_faces": found.edge_on_faces,
        "edges": topology.edge_count(),
        "silhouette_edges": found.silhouette.edges.len(),
        "outline_edges": found.outline_edges,
        "max_multiplicity": found.silhouette.max_multiplicity(),
        "loops": found.loops,
        "method": "scan",
        "reason": reason,
        // A scan asks the exact predicate for every face.
        "unsure_faces": 0,
    })
}

fn table(file: &Path, topology: &Topology, found: &[Found]) -> String {
    let mut table = Table::new(&[
        "light",
        "faces",
        "front",
        "edge-on",
        "edges",
        "silhouette",
        "outline",
        "loops",
        "multiplicity",
    ]);
    for found in found {
        let light = lights::label(&found.light, &found.name);
        let counts = [
            topology.face_count(),
            found.front_faces,
            found.edge_on_faces,
            topology.edge_count(),
            found.silhouette.edges.len(),
            found.outline_edges,
            found.loops,
            found.silhouette.max_multiplicity() as usize,
        ];
        table.row(std::iter::once(light).chain(counts.iter().map(usize::to_string)).collect());
    }
    format!("{}\n{table}", plain(&file.to_string_lossy()))
}

/// The silhouette edges as lines between the vertices that they use.
fn lines(mesh: &Mesh, topology: &Topology, index: usize, found: &Found) -> Layer {
    let ends: Vec<[VertexId; 2]> =
        found.silhouette.edges.iter().map(|edge| topology.vertices(edge.edge)).collect();
    let mut used: Vec<VertexId> = ends.iter().flatten().copied().collect();
    used.sort_unstable();
    used.dedup();
    let place = |vertex| used.binary_search(&vertex).expect("the ends are all there") as u32;
    Layer {
        name: format!("silhouette {index} {}", lights::label(&found.light, &found.name)),
        colour: Some([1.0, 0.5, 0.0, 1.0]),
        positions: used.iter().map(|vertex| mesh.positions()[vertex.index()]).collect(),
        elements: Elements::Lines(ends.iter().map(|ends| ends.map(place)).collect()),
        ..Layer::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use umbrage::mesh::solid;
    use umbrage::scene::SceneLight;

    #[test]
    fn silhouette_lines_of_a_cube_are_a_hexagon() {
        let mesh = solid::cube();
        let topology = Topology::build(mesh.vertex_count(), mesh.triangles().to_vec());
        let light = "directional:-1,-1,-1".parse().unwrap();
        let light = SceneLight { name: String::new(), light, colour: [1.0; 3], intensity: 1.0, spot: None };
        let found = find(&mesh, &topology, light);
        let counts = (found.front_faces, found.edge_on_faces, found.outline_edges, found.loops);
        assert_eq!(counts, (6, 0, 6, 1));
        let layer = lines(&mesh, &topology, 0, &found);
        assert_eq!((layer.positions.len(), layer.elements.len()), (6, 6));
    }
}
