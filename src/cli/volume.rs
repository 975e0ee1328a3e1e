//! `umbrage volume`: the capped shadow volume of each light.

use std::ops::Range;
use std::path::{Path, PathBuf};

use serde_json::{Value, json};
use umbrage::Choice;
use umbrage::caster::Caster;
use umbrage::facing::CasterFaces;
use umbrage::geom::{Aabb, Light};
use umbrage::mesh::Mesh;
use umbrage::render::Line;
use umbrage::scene::Lamp;
use umbrage::shadow::volume;
use umbrage::shadow::volume::{ShadowVolume, ShellFaces};
use umbrage::write::{self, Elements, Layer, Model, Target};

use super::input::{Source, SourceArgs};
use super::output::{self, Output, Table, counted, plain, short, significant};
use super::parsers::{distance, refuse_overwriting};
use super::progress::Progress;
use super::resources::ThreadArgs;
use super::sketch::{FAR_END, SIDES, SILHOUETTE, Sketch, SketchArgs};
use super::{Failure, Outcome, lights, load};

/// Shadow volume: light cap, sides and dark cap, closed at infinity, with the certificate that it is closed
///
/// Each mesh of the file is welded separately; all of them cast together. Exits with 1 if a volume with both
/// caps is not closed.
#[derive(Clone, Debug, clap::Args)]
#[command(after_long_help = "Examples:\n  \
    umbrage volume model.glb --light directional:0.3,-1,0.2 --picture volume.png\n  \
    umbrage volume model.glb --light point:2,5,3 --far 50 -o volume.glb\n  \
    umbrage volume model.glb --light point:2,5,3 --far infinity -o volume.ply")]
pub(crate) struct Args {
    #[command(flatten)]
    source: SourceArgs,

    /// Which faces cast
    #[arg(long, value_enum, default_value_t = Faces::Auto)]
    faces: Faces,

    /// Which caps the volume has
    #[arg(long, value_enum, default_value_t = Caps::Auto)]
    caps: Caps,

    /// Write the volume in layers: light_cap, sides and dark_cap, each with the vertices that it uses
    ///
    /// Together they are closed: check them with --scope scene.
    ///
    /// [default: nothing is written]
    #[arg(short, long, value_name = "OUT.{glb,obj,ply}")]
    output: Option<PathBuf>,

    /// How far from the mesh the written volume holds the whole shadow, in mesh units; it ends a little
    /// beyond
    ///
    /// [default: 10 diagonals of the bounding box]. With `infinity`, GLB and PLY hold homogeneous vertices x,
    /// y, z, w: those of the mesh with w 1, and those at infinity with w 0 (in GLB the attribute _W): v - L
    /// of a vertex v and a point light L, or the direction in which a directional light travels. OBJ cannot.
    #[arg(long, value_name = "DIST|infinity", value_parser = parse_far, allow_negative_numbers = true)]
    far: Option<Far>,

    /// Print one JSON document instead of a table: `file`, `format`, and `lights` with one object per light
    ///
    /// At most 1000 shells per light are listed.
    #[arg(long)]
    json: bool,

    #[command(flatten)]
    sketch: SketchArgs,

    #[command(flatten)]
    threads: ThreadArgs,
}

/// Where a written volume ends.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Far {
    /// It holds the shadow up to this distance from the mesh.
    At(f32),
    /// Nowhere.
    Infinity,
}

fn parse_far(text: &str) -> Result<Far, String> {
    match text {
        "infinity" | "inf" => Ok(Far::Infinity),
        _ => distance(text)
            .map(Far::At)
            .map_err(|_| "write a distance above 0 in mesh units, or infinity".to_owned()),
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum Faces {
    /// Half the faces of a shell where that is proven to be enough, else all
    Auto,
    /// All faces; right for any mesh
    All,
    /// Front faces only, proven or not
    Front,
}

impl From<Faces> for Option<CasterFaces> {
    fn from(faces: Faces) -> Self {
        match faces {
            Faces::Auto => None,
            Faces::All => Some(CasterFaces::All),
            Faces::Front => Some(CasterFaces::Front),
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum Caps {
    /// Both: the position of the eye is not known here
    Auto,
    /// Light cap and dark cap, as z-fail counting needs them
    Both,
    /// Sides only, enough for z-pass counting with the eye outside
    None,
}

impl From<Caps> for volume::Caps {
    fn from(caps: Caps) -> Self {
        match caps {
            Caps::Auto | Caps::Both => Self::Both,
            Caps::None => Self::None,
        }
    }
}

/// Shells listed at most: a mesh may fall apart into single faces.
const SHELLS_LISTED: usize = 1000;

/// The volume of one light, and why it is as it is.
struct Built {
    name: String,
    light: Light,
    /// Whether the light is a spot light.
    spot: bool,
    faces: ShellFaces,
    volume: ShadowVolume,
    closed: bool,
    /// How far from the mesh the written volume holds the whole shadow; infinite for a volume without end.
    covers: Option<f64>,
}

pub(crate) fn run(args: Args) -> Result<Outcome, Failure> {
    args.threads.apply()?;
    if let Some(path) = &args.output {
        if Target::from_path(path)? == Target::Obj && args.far == Some(Far::Infinity) {
            let problem = "--far infinity: OBJ has no vertex at infinity";
            return Err(Failure::new(problem, "name a .glb or .ply file, or a distance").in_file(path));
        }
    } else if args.far.is_some() {
        output::say("note: --far has no effect without --output");
    }
    refuse_overwriting("--output", args.output.as_deref(), &args.source.file)?;
    args.sketch.refuse(&args.source.file)?;
    let mut source = args.source.load()?;
    let lights = std::mem::take(&mut source.lights);
    let Source { format, caster, .. } = &source;
    lights::note_centers(&lights);

    let progress = Progress::spinner("building shadow volumes");
    let mut built: Vec<Built> =
        lights.into_iter().map(|light| build(caster, light, args.faces.into(), args.caps.into())).collect();
    drop(progress);

    if let Some(path) = &args.output {
        let bounds = load::bounds(caster.mesh());
        let far = args.far.unwrap_or_else(|| Far::At(default_far(&bounds)));
        let layers = built.iter_mut().enumerate().flat_map(|(index, built)| {
            let mut suffix = if index == 0 { String::new() } else { format!(" {index}") };
            if !built.name.is_empty() {
                suffix += &format!(" ({})", short(&built.name));
            }
            let (layers, covers) = written(&built.volume, far, &bounds, &suffix);
            built.covers = Some(covers);
            layers
        });
        write::write(&Model { layers: layers.collect() }, path)?;
        output::wrote(path);
        for (index, covers) in built.iter().map(|built| built.covers).enumerate() {
            if let (Far::At(far), Some(covers)) = (far, covers)
                && covers < f64::from(far)
            {
                output::say(format_args!(
                    "note: light {index}: the written volume holds the shadow up to {} mesh units from the mesh, \
                     not {}: farther vertices would leave the range of f32",
                    significant(covers),
                    significant(f64::from(far))
                ));
            }
        }
    }
    if args.sketch.is_asked() {
        let (sketches, shown) = sketches(&args.source.file, &built, caster.mesh())?;
        args.sketch.draw(&source, &args.source.file, &shown, sketches)?;
    }
    let mut out = Output::new();
    if args.json {
        let lights: Vec<Value> = built.iter().map(document).collect();
        out.json(&json!({ "file": args.source.file.to_string_lossy(), "format": format, "lights": lights }))?;
    } else {
        out.text(text(&args.source.file, &built))?;
    }
    out.flush()?;
    let capped = volume::Caps::from(args.caps) == volume::Caps::Both;
    let sound = !capped || built.iter().all(|built| built.closed);
    Ok(if sound { Outcome::Sound } else { Outcome::Unsound })
}

/// The capped volumes of several lights, half the faces where that is proven to be enough: a table with the
/// reasons, the layers of each volume, and whether all are closed.
pub(super) fn of_lights(file: &Path, caster: &Caster, lights: &[Lamp]) -> (String, Vec<Model>, bool) {
    let build = |light: &Lamp| build(caster, light.clone(), None, volume::Caps::Both);
    let built: Vec<Built> = lights.iter().map(build).collect();
    let bounds = load::bounds(caster.mesh());
    let far = Far::At(default_far(&bounds));
    let models =
        built.iter().map(|built| Model { layers: written(&built.volume, far, &bounds, "").0 }).collect();
    (text(file, &built), models, built.iter().all(|built| built.closed))
}

fn build(caster: &Caster, lamp: Lamp, faces: Option<CasterFaces>, caps: volume::Caps) -> Built {
    let (name, light, spot) = (lamp.name.clone(), *lamp.light(), lamp.cone.is_some());
    let faces = caster.shell_faces(&light, faces);
    let volume = caster.volume_of(&light, &faces, caps);
    let closed = volume.boundary_sum().is_closed();
    Built { name, light, spot, faces, volume, closed, covers: None }
}

/// Ten diagonals, far outside any picture of the mesh.
fn default_far(bounds: &Aabb) -> f32 {
    let diagonal = bounds.diagonal();
    if diagonal > 0.0 { (10.0 * diagonal).min(f64::from(f32::MAX)) as f32 } else { 1.0 }
}

/// The volumes, cut off not far from the mesh, over the mesh; and the box that shows all of them.
fn sketches(file: &Path, built: &[Built], mesh: &Mesh) -> Result<(Vec<Sketch>, Aabb), Failure> {
    let bounds = &load::bounds(mesh);
    let far = (default_far(bounds) / 30.0).max(f32::MIN_POSITIVE);
    let mut shown = *bounds;
    let name = plain(&file.file_name().unwrap_or_default().to_string_lossy());
    let sketches = built.iter().map(|built| {
        let finite = built.volume.finite(far, bounds);
        shown = shown.join(&Aabb::around(finite.positions.iter().copied()));
        let sides = &finite.triangles[finite.sides.clone()];
        let lines = side_lines(&finite.positions, sides, built.volume.positions().len() as u32);
        let label = lights::spot_label(&built.light, built.spot, &built.name);
        let keys = vec![
            (SILHOUETTE, "silhouette".to_owned()),
            (SIDES, "sides, translucent".to_owned()),
            (FAR_END, "far end, cut for the picture".to_owned()),
        ];
        let title = format!("{name}: shadow volume of {label}");
        let closed = if built.closed { "closed" } else { "not closed" };
        let [light_cap, sides, dark_cap] =
            [built.volume.light_cap(), built.volume.sides(), built.volume.dark_cap()].map(|run| run.len());
        let numbers = format!(
            "triangles: light cap {light_cap}, sides {sides}, dark cap {dark_cap}; {closed} at infinity"
        );
        let mesh = Mesh::new(finite.positions, finite.triangles);
        let glass = Some(mesh.map_err(|error| Failure::new(error, "leave out --picture").in_file(file))?);
        Ok(Sketch { light: built.light, titles: vec![title, numbers], lines, keys, glass })
    });
    let sketches = sketches.collect::<Result<Vec<_>, Failure>>()?;
    Ok((sketches, shown))
}

/// The edges of the sides: those of the mesh, those of the far end, and some that run from one to the other.
/// Vertices from `vertices` on are those of the far end; two triangles are a side.
fn side_lines(positions: &[[f32; 3]], sides: &[[u32; 3]], vertices: u32) -> Vec<Line> {
    /// Lines away from the light at most: more would be a surface.
    const MOST_RULINGS: usize = 24;
    let step = (sides.len() / 2).div_ceil(MOST_RULINGS).max(1);
    let mut lines = Vec::with_capacity(sides.len());
    for (index, side) in sides.chunks(2).enumerate() {
        let edges = |corners: &[u32; 3]| {
            let [a, b, c] = *corners;
            [[a, b], [b, c], [c, a]]
        };
        let all: Vec<[u32; 2]> = side.iter().flat_map(edges).collect();
        for &[a, b] in &all {
            // What the two triangles share is no edge of the side.
            let color = match (a < vertices, b < vertices, all.contains(&[b, a])) {
                (.., true) => continue,
                (true, true, _) => SILHOUETTE,
                (false, false, _) => FAR_END,
                _ if index % step == 0 => SIDES,
                _ => continue,
            };
            lines.push(Line { ends: [a, b].map(|vertex| positions[vertex as usize]), color });
        }
    }
    lines
}

/// The layers of a volume as it is written, and how far from the mesh they hold the whole shadow.
fn written(volume: &ShadowVolume, far: Far, bounds: &Aabb, suffix: &str) -> (Vec<Layer>, f64) {
    match far {
        Far::At(far) => {
            let finite = volume.finite(far, bounds);
            let runs = [finite.light_cap, finite.sides, finite.dark_cap];
            (layers(&finite.positions, None, &finite.triangles, runs, suffix), finite.covers)
        }
        Far::Infinity => {
            let (positions, w): (Vec<_>, Vec<_>) =
                volume.to_f32().into_iter().map(|[x, y, z, w]| ([x, y, z], w)).unzip();
            let runs = [volume.light_cap(), volume.sides(), volume.dark_cap()];
            (layers(&positions, Some(&w), volume.triangles(), runs, suffix), f64::INFINITY)
        }
    }
}

/// Light cap, sides and dark cap, each with the vertices that it uses; empty ones are left out. A vertex on
/// the border of two of them is in both, bit for bit.
fn layers(
    positions: &[[f32; 3]],
    w: Option<&[f32]>,
    triangles: &[[u32; 3]],
    [light_cap, sides, dark_cap]: [Range<usize>; 3],
    suffix: &str,
) -> Vec<Layer> {
    let runs = [
        ("light_cap", light_cap, [1.0, 0.9, 0.3, 1.0]),
        ("sides", sides, [0.2, 0.3, 0.8, 0.4]),
        ("dark_cap", dark_cap, [0.1, 0.1, 0.2, 1.0]),
    ];
    runs.into_iter()
        .filter(|(_, run, _)| !run.is_empty())
        .map(|(name, run, color)| {
            let triangles = &triangles[run];
            let mut used: Vec<u32> = triangles.as_flattened().to_vec();
            used.sort_unstable();
            used.dedup();
            let place = |vertex| used.binary_search(&vertex).expect("every corner is used") as u32;
            Layer {
                name: format!("{name}{suffix}"),
                color: Some(color),
                positions: used.iter().map(|&vertex| positions[vertex as usize]).collect(),
                w: w.map(|w| used.iter().map(|&vertex| w[vertex as usize]).collect()),
                elements: Elements::Triangles(triangles.iter().map(|corners| corners.map(place)).collect()),
                ..Layer::default()
            }
        })
        .collect()
}

fn document(built: &Built) -> Value {
    let variant = |(shell, choice): (usize, &Choice<CasterFaces>)| json!({ "shell": shell, "variant": choice.what, "reason": choice.why });
    let volume = &built.volume;
    json!({
        "light": built.light,
        "name": lights::name(&built.name),
        "variant": built.faces.choices.iter().enumerate().take(SHELLS_LISTED).map(variant).collect::<Vec<_>>(),
        "vertices": volume.vertex_count(),
        "triangles": volume.triangles().len(),
        "light_cap": volume.light_cap().len(),
        "sides": volume.sides().len(),
        "dark_cap": volume.dark_cap().len(),
        "closed": built.closed,
        // Null where nothing is written, and where the volume has no end.
        "covers": built.covers.filter(|covers| covers.is_finite()),
        "infinite": built.covers.map(f64::is_infinite),
    })
}

fn text(file: &Path, built: &[Built]) -> String {
    let mut table =
        Table::new(&["light", "vertices", "triangles", "light cap", "sides", "dark cap", "closed"]);
    let mut reasons = String::new();
    for (index, built) in built.iter().enumerate() {
        let light = format!("{index} {}", lights::spot_label(&built.light, built.spot, &built.name));
        let volume = &built.volume;
        let counts = [
            volume.vertex_count(),
            volume.triangles().len(),
            volume.light_cap().len(),
            volume.sides().len(),
            volume.dark_cap().len(),
        ];
        let closed = if built.closed { "yes" } else { "no" };
        let counts = counts.iter().map(usize::to_string).chain([closed.to_owned()]);
        table.row(std::iter::once(light).chain(counts).collect());
        for (choice, count) in grouped(&built.faces.choices) {
            let shells = counted(count, "shell", "shells");
            reasons += &format!("  light {index}, {shells} {}: {choice}\n", choice.what.name());
        }
        reasons += &match built.covers {
            None => String::new(),
            Some(covers) if covers.is_infinite() => {
                format!("  light {index}, written with vertices at infinity, w 0\n")
            }
            Some(covers) => format!(
                "  light {index}, written: holds every shadowed point within {} mesh units of the mesh\n",
                significant(covers)
            ),
        };
    }
    format!("{}\n{table}\n{reasons}", plain(&file.to_string_lossy()))
}

/// Equal choices counted, in the order of their first shells.
fn grouped(choices: &[Choice<CasterFaces>]) -> Vec<(Choice<CasterFaces>, usize)> {
    let mut groups: Vec<(Choice<CasterFaces>, usize)> = Vec::new();
    for choice in choices {
        // Choices that print the same are the same here, and there are few reasons.
        let same = |group: &&mut (Choice<CasterFaces>, usize)| {
            group.0.what == choice.what && group.0.to_string() == choice.to_string()
        };
        match groups.iter_mut().find(same) {
            Some(group) => group.1 += 1,
            None => groups.push((*choice, 1)),
        }
    }
    groups
}

#[cfg(test)]
mod tests {
    use super::*;
    use umbrage::check::CrackReport;
    use umbrage::mesh::Mesh;
    use umbrage::testing::shapes;
    use umbrage::topology::Topology;

    fn built(mesh: Mesh, light: &str, faces: Option<CasterFaces>) -> Built {
        let light: Lamp = light.parse().unwrap();
        build(&Caster::new(mesh), light, faces, volume::Caps::Both)
    }

    #[test]
    fn volume_layers_have_the_vertices_they_use_and_close_together() {
        let built = built(shapes::cube(), "point:2,3,5", None);
        let bounds = Aabb { low: [-1.0; 3], high: [1.0; 3] };
        let (layers, covers) = written(&built.volume, Far::At(100.0), &bounds, "");
        assert_eq!(covers, 100.0);
        assert_eq!(
            layers.iter().map(|layer| layer.name.as_str()).collect::<Vec<_>>(),
            ["light_cap", "sides", "dark_cap"]
        );
        // Of the cube's 8 corners a front cap uses 7; its outline has 6.
        assert_eq!(layers.iter().map(|layer| layer.positions.len()).collect::<Vec<_>>(), [7, 12, 7]);
        let parts = layers.iter().map(|layer| match &layer.elements {
            Elements::Triangles(triangles) => Mesh::new(layer.positions.clone(), triangles.clone()).unwrap(),
            _ => panic!("a volume is triangles"),
        });
        let whole = Mesh::concat(&parts.collect::<Vec<_>>()).unwrap();
        let whole = umbrage::mesh::weld(&whole, umbrage::mesh::Weld::Exact).mesh;
        let topology = Topology::of(&whole);
        assert!(CrackReport::of(&whole, &topology).counts.sound());
    }

    #[test]
    fn volume_of_a_directional_light_has_a_dark_cap_when_it_ends_and_one_point_at_infinity_when_not() {
        let built = built(shapes::cube(), "directional:-1,-2,-3", Some(CasterFaces::All));
        let bounds = Aabb { low: [-1.0; 3], high: [1.0; 3] };
        let (finite, _) = written(&built.volume, Far::At(10.0), &bounds, " 1");
        assert_eq!(finite.len(), 3);
        assert!(finite.iter().all(|layer| layer.w.is_none()));
        let (infinite, covers) = written(&built.volume, Far::Infinity, &bounds, " 1");
        assert_eq!((infinite.len(), covers), (2, f64::INFINITY));
        let w = infinite[1].w.as_ref().unwrap();
        let at_infinity = w.iter().position(|&w| w == 0.0).unwrap();
        assert_eq!(infinite[1].positions[at_infinity], [-1.0, -2.0, -3.0]);
        assert!(built.closed);
    }

    #[test]
    fn volume_reasons_are_counted_over_shells() {
        let two = Mesh::concat(&[shapes::cube(), shapes::open_cube(), shapes::open_cube()]).unwrap();
        let built = built(two, "point:9,9,9", None);
        let counts: Vec<usize> = grouped(&built.faces.choices).iter().map(|group| group.1).collect();
        assert_eq!(counts.iter().sum::<usize>(), 3);
    }
}
