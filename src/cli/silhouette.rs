//! `umbrage silhouette`: the edges where the side of the light changes.

use std::path::{Path, PathBuf};

use serde_json::{Value, json};
use umbrage::caster::Caster;
use umbrage::facing::{CasterFaces, classify};
use umbrage::geom::{Facing, Light};
#[cfg(feature = "gpu")]
use umbrage::gpu::Gpu;
use umbrage::mesh::{EdgeId, Mesh, VertexId};
use umbrage::render::Line;
use umbrage::scene::Lamp;
#[cfg(feature = "gpu")]
use umbrage::silhouette::{GpuSilhouette, SilhouetteShaders};
use umbrage::silhouette::{Silhouette, SilhouetteMethod, SilhouetteTree};
use umbrage::topology::Topology;
use umbrage::write::{self, Elements, Layer, Model, Target};

use super::input::{Source, SourceArgs};
use super::output::{self, Output, Table, plain};
use super::parsers::refuse_overwriting;
use super::progress::Progress;
use super::resources::{AdapterArgs, ThreadArgs};
use super::sketch::{SILHOUETTE, Sketch, SketchArgs};
use super::{Failure, Outcome, lights};

/// Silhouette: the edges of a mesh where the side that a light is on changes
///
/// Every side is decided exactly. Each mesh of the file is welded by itself; the counts are over all of them.
#[derive(Clone, Debug, clap::Args)]
#[command(after_long_help = "Examples:\n  \
    umbrage silhouette model.glb --light point:2,5,3 --picture silhouette.png\n  \
    umbrage silhouette model.glb --light directional:0.3,-1,0.2 -o edges.obj\n  \
    umbrage silhouette model.glb --light point:2,5,3 --json")]
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

    #[command(flatten)]
    sketch: SketchArgs,

    /// Print one JSON document instead of a table: `file`, `format`, and `lights` with one object per light
    #[arg(long)]
    json: bool,

    #[command(flatten)]
    threads: ThreadArgs,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum Method {
    /// Scan or tree, whichever is cheaper for this number of lights
    Auto,
    /// All faces, then all edges
    Scan,
    /// A tree of edges, for many lights on one mesh
    Tree,
    /// Compute shaders on a graphics adapter
    Gpu,
}

/// How silhouettes are found, and why so.
enum Finder {
    /// The exact predicate for every face, then all edges.
    Scan,
    /// A tree of edges.
    Tree(Box<SilhouetteTree>),
    /// The mesh on a graphics adapter.
    #[cfg(feature = "gpu")]
    Device(Box<GpuSilhouette>),
}

impl Finder {
    fn name(&self) -> &'static str {
        match self {
            Self::Scan => "scan",
            Self::Tree(_) => "tree",
            #[cfg(feature = "gpu")]
            Self::Device(_) => "gpu",
        }
    }

    /// The silhouettes of all faces and of front faces, the sides, and how many of them the filter left to
    /// the exact predicate.
    fn find(&mut self, mesh: &Mesh, topology: &Topology, light: &Light) -> Result<Looked, Failure> {
        match self {
            Self::Scan => Ok(scan(mesh, topology, light)),
            Self::Tree(tree) => {
                let mut facing = Vec::new();
                let unsure_faces = tree.planes().classify_into(mesh, light, &mut facing);
                let [all, front] = [CasterFaces::All, CasterFaces::Front]
                    .map(|casters| tree.silhouette(mesh, topology, light, casters));
                Ok(Looked { facing, all, front, unsure_faces })
            }
            #[cfg(feature = "gpu")]
            Self::Device(device) => {
                let unsure_faces = device.classify(mesh, light)?;
                let of = |casters: CasterFaces| {
                    device.set_masks(&vec![casters.mask(); mesh.face_count()])?;
                    device.extract()
                };
                let (all, front) = (of(CasterFaces::All)?, of(CasterFaces::Front)?);
                Ok(Looked { facing: device.download_facing()?, all, front, unsure_faces })
            }
        }
    }
}

fn scan(mesh: &Mesh, topology: &Topology, light: &Light) -> Looked {
    let facing = classify(mesh, light);
    let [all, front] = [CasterFaces::All, CasterFaces::Front]
        .map(|casters| Silhouette::extract(topology, &casters.signs(&facing)));
    // Every face was decided by the exact predicate: none is unsure.
    Looked { facing, all, front, unsure_faces: 0 }
}

/// What a finder reports for one light.
struct Looked {
    facing: Vec<Facing>,
    all: Silhouette,
    front: Silhouette,
    unsure_faces: usize,
}

/// What was found for one light.
struct Found {
    name: String,
    light: Light,
    /// Whether the light is a spot light.
    spot: bool,
    front_faces: usize,
    edge_on_faces: usize,
    outline_edges: usize,
    loops: usize,
    /// With all faces casting.
    silhouette: Silhouette,
    unsure_faces: usize,
}

pub(crate) fn run(args: Args) -> Result<Outcome, Failure> {
    args.threads.apply()?;
    let adapter = match args.method {
        Method::Gpu => Some(args.adapter.open("--method gpu")?),
        Method::Auto | Method::Scan | Method::Tree => {
            args.adapter.unused("silhouettes are found on the processor; add --method gpu");
            None
        }
    };
    if let Some(path) = &args.output {
        Target::from_path(path)?;
    }
    refuse_overwriting("--output", args.output.as_deref(), &args.source.file)?;
    args.sketch.refuse(&args.source.file)?;
    let mut source = args.source.load()?;
    let lights = std::mem::take(&mut source.lights);
    let Source { format, caster, .. } = &source;
    lights::note_centers(&lights);
    let mesh = caster.mesh();

    let progress = Progress::spinner("finding silhouettes");
    let topology = caster.topology();
    let chosen = SilhouetteMethod::choose(mesh.face_count(), lights.len());
    let (method, reason) = match (args.method, &adapter) {
        (Method::Auto, _) => (chosen.what, chosen.to_string()),
        (Method::Tree, _) => (SilhouetteMethod::Tree, "asked for".to_owned()),
        (_, Some(adapter)) => (SilhouetteMethod::Scan, on_adapter(adapter)),
        (_, None) => (SilhouetteMethod::Scan, "asked for".to_owned()),
    };
    let mut finder = match (adapter, method) {
        (Some(adapter), _) => on_device(&adapter, caster)?,
        (None, SilhouetteMethod::Scan) => Finder::Scan,
        (None, _) => Finder::Tree(Box::new(SilhouetteTree::new(mesh, topology))),
    };
    let look = |light: Lamp| {
        let looked = finder.find(mesh, topology, light.light())?;
        Ok(found(topology, light, looked))
    };
    let found = lights.into_iter().map(look).collect::<Result<Vec<Found>, Failure>>()?;
    drop(progress);

    if let Some(path) = &args.output {
        let layers = found.iter().enumerate().map(|(index, found)| lines(mesh, topology, index, found));
        write::write(&Model { layers: layers.collect() }, path)?;
        output::wrote(path);
    }
    if args.sketch.is_asked() {
        let sketches = found.iter().map(|found| sketch(mesh, topology, &args.source.file, found)).collect();
        args.sketch.draw(&source, &args.source.file, &source.bounds, sketches)?;
    }
    let mut out = Output::new();
    if args.json {
        let lights: Vec<Value> =
            found.iter().map(|found| document(topology, found, finder.name(), &reason)).collect();
        out.json(&json!({ "file": args.source.file.to_string_lossy(), "format": format, "lights": lights }))?;
    } else {
        out.text(table(&args.source.file, topology, &found))?;
        out.text(format_args!("\n  method {}: {reason}\n", finder.name()))?;
    }
    out.flush()?;
    Ok(Outcome::Sound)
}

#[cfg(feature = "gpu")]
fn on_adapter(gpu: &Gpu) -> String {
    format!("asked for; runs on {}", gpu.name())
}

#[cfg(feature = "gpu")]
fn on_device(gpu: &Gpu, caster: &Caster) -> Result<Finder, Failure> {
    let on_device = umbrage::caster::GpuCaster::upload(gpu, caster)?;
    Ok(Finder::Device(Box::new(GpuSilhouette::new(&SilhouetteShaders::new(gpu)?, &on_device)?)))
}

#[cfg(not(feature = "gpu"))]
fn on_adapter(none: &std::convert::Infallible) -> String {
    match *none {}
}

#[cfg(not(feature = "gpu"))]
fn on_device(none: &std::convert::Infallible, _: &Caster) -> Result<Finder, Failure> {
    match *none {}
}

/// The silhouettes of several lights: a table, and a layer of lines for each.
pub(super) fn of_lights(file: &Path, caster: &Caster, lights: &[Lamp]) -> (String, Model) {
    let (mesh, topology) = (caster.mesh(), caster.topology());
    let look = |light: &Lamp| found(topology, light.clone(), scan(mesh, topology, light.light()));
    let found: Vec<Found> = lights.iter().map(look).collect();
    let layers = found.iter().enumerate().map(|(index, found)| lines(mesh, topology, index, found));
    (table(file, topology, &found), Model { layers: layers.collect() })
}

fn found(topology: &Topology, lamp: Lamp, looked: Looked) -> Found {
    let (light, spot, name) = (*lamp.light(), lamp.cone.is_some(), lamp.name);
    let Looked { facing, all, front, unsure_faces } = looked;
    let count = |wanted| facing.iter().filter(|&&facing| facing == wanted).count();
    Found {
        name,
        light,
        spot,
        front_faces: count(Facing::Front),
        edge_on_faces: count(Facing::EdgeOn),
        outline_edges: front.edges.len(),
        loops: all.loops(topology).len(),
        silhouette: all,
        unsure_faces,
    }
}

fn document(topology: &Topology, found: &Found, method: &str, reason: &str) -> Value {
    json!({
        "light": found.light,
        "name": lights::name(&found.name),
        "faces": topology.face_count(),
        "front_faces": found.front_faces,
        "edge_on_faces": found.edge_on_faces,
        "edges": topology.edge_count(),
        "silhouette_edges": found.silhouette.edges.len(),
        "outline_edges": found.outline_edges,
        "max_multiplicity": found.silhouette.max_multiplicity(),
        "loops": found.loops,
        "method": method,
        "reason": reason,
        "unsure_faces": found.unsure_faces,
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
        let light = lights::spot_label(&found.light, found.spot, &found.name);
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
/// The silhouette over the mesh.
fn sketch(mesh: &Mesh, topology: &Topology, file: &Path, found: &Found) -> Sketch {
    let edges = &found.silhouette.edges;
    let ends = |edge: EdgeId| topology.vertices(edge).map(|vertex| mesh.positions()[vertex.index()]);
    let lines = edges.iter().map(|edge| Line { ends: ends(edge.edge), color: SILHOUETTE });
    let name = plain(&file.file_name().unwrap_or_default().to_string_lossy());
    let label = lights::spot_label(&found.light, found.spot, &found.name);
    let edges = output::counted(edges.len(), "edge", "edges");
    let loops = output::counted(found.loops, "loop", "loops");
    let key = format!("silhouette: {edges}, {loops}; dimmed where hidden");
    Sketch {
        light: found.light,
        titles: vec![format!("{name}: silhouette seen from {label}")],
        lines: lines.collect(),
        keys: vec![(SILHOUETTE, key)],
        glass: None,
    }
}

fn lines(mesh: &Mesh, topology: &Topology, index: usize, found: &Found) -> Layer {
    let ends: Vec<[VertexId; 2]> =
        found.silhouette.edges.iter().map(|edge| topology.vertices(edge.edge)).collect();
    let mut used: Vec<VertexId> = ends.iter().flatten().copied().collect();
    used.sort_unstable();
    used.dedup();
    let place = |vertex| used.binary_search(&vertex).expect("the ends are all there") as u32;
    Layer {
        name: format!("silhouette {index} {}", lights::spot_label(&found.light, found.spot, &found.name)),
        color: Some([1.0, 0.5, 0.0, 1.0]),
        positions: used.iter().map(|vertex| mesh.positions()[vertex.index()]).collect(),
        elements: Elements::Lines(ends.iter().map(|ends| ends.map(place)).collect()),
        ..Layer::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use umbrage::scene::Lamp;
    use umbrage::testing::shapes;

    #[test]
    fn silhouette_lines_of_a_cube_are_a_hexagon() {
        let mesh = shapes::cube();
        let topology = Topology::of(&mesh);
        let light: Lamp = "directional:-1,-1,-1".parse().unwrap();
        let looked = scan(&mesh, &topology, light.light());
        let found = found(&topology, light, looked);
        let counts = (found.front_faces, found.edge_on_faces, found.outline_edges, found.loops);
        assert_eq!(counts, (6, 0, 6, 1));
        let layer = lines(&mesh, &topology, 0, &found);
        assert_eq!((layer.positions.len(), layer.elements.len()), (6, 6));
    }
}
