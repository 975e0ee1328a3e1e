//! `umbrage demo`: all of it on a generated scene.

mod moving;
#[cfg(feature = "gpu")]
mod pixels;
mod tour;

use std::f32::consts::FRAC_PI_2;
use std::path::{Path, PathBuf};

use umbrage::caster::Caster;
use umbrage::glam::{Mat4, Vec3};
#[cfg(feature = "gpu")]
use umbrage::gpu::{Gpu, GpuError};
use umbrage::mesh::Mesh;
use umbrage::render;
use umbrage::render::{CLAY, Picture, ShadedLight, View};
use umbrage::scene::{Instance, Lamp, Scene, Scope};
use umbrage::testing::shapes;
use umbrage::verify::points::{Options, Verification, Verifier};
use umbrage::view::{Camera, Size, Up};
use umbrage::write::{self, Layer, Model, write_atomic};

use super::load::MeshArgs;
use super::output::Output;
use super::progress::Progress;
use super::resources::{AdapterArgs, ThreadArgs};
use super::{Failure, Outcome, check, output, silhouette, verify, volume};

/// All of it on a generated scene: report, silhouettes, volumes, pictures, verification, and a tour of the
/// other commands
///
/// A torus knot, a sphere and an open sheet over a ground, with a point light and a directional light. Open
/// the .glb files in any glTF viewer. With a graphics adapter picture.png shows the shadows of a stencil pass
/// on the left and of exact ray cast on the right, and verdicts.png where the two agree; without one, the ray
/// cast alone. The tour prints each command as one would type it: prepare, silhouette, volume, plan, render
/// with soft shadows and ambient occlusion, the accuracy of every technique as a page, and an animation.
#[derive(Clone, Debug, clap::Args)]
pub(crate) struct Args {
    /// The folder that everything is written into; made if it is missing
    #[arg(long, value_name = "DIR", default_value = "umbrage-demo")]
    out: PathBuf,

    /// Leave out the tour of the other commands, which takes most of the time
    #[arg(long)]
    short: bool,

    #[command(flatten)]
    threads: ThreadArgs,

    #[command(flatten)]
    adapter: AdapterArgs,
}

/// Points verified per light, and the size of the picture.
const POINTS: usize = 20_000;
const SIZE: (u32, u32) = (960, 540);
/// The size of each of two pictures side by side.
#[cfg(feature = "gpu")]
const HALF: (u32, u32) = (720, 405);

pub(crate) fn run(args: Args) -> Result<Outcome, Failure> {
    let found = find(&args.adapter)?;
    args.threads.apply()?;
    std::fs::create_dir_all(&args.out).map_err(|error| {
        let problem = format!("the folder cannot be made: {error}");
        Failure::new(problem, "choose another folder with --out").in_file(&args.out)
    })?;
    let at = |name: &str| args.out.join(name);
    let mut out = Output::new();

    // 1. The scene goes through a file, as any other would.
    let file = at("scene.glb");
    let meshes = scene().bake(Scope::Mesh).expect("the scene is finite and small");
    write::write(&Model { layers: meshes.iter().map(Layer::from).collect() }, &file)?;
    let load = MeshArgs::default();
    let caster = Caster::new(load.joined(load.read(&file)?.meshes, &file)?);
    let lights = lights();

    // 2. The crack report.
    let (report, document, marks) = check::full(&file)?;
    out.text(format_args!("Cracks: {report}\n"))?;
    out.flush()?;
    write_atomic(at("report.json"), |writer| writeln!(writer, "{document:#}"))?;
    write::write(&marks, at("marked.glb"))?;

    // 3. Silhouettes and volumes.
    let (table, model) = silhouette::of_lights(&file, &caster, &lights);
    out.text(format_args!("Silhouettes: {table}\n\n"))?;
    write::write(&model, at("silhouettes.glb"))?;
    let (table, models, closed) = volume::of_lights(&file, &caster, &lights);
    out.text(format_args!("Volumes: {table}\n"))?;
    for (index, model) in models.iter().enumerate() {
        write::write(model, at(&format!("volume-{index}.glb")))?;
    }
    out.flush()?;

    // 4. The pictures, and the verification of pixels.
    let (files, pixels_agree) = pictures(found, &caster, &lights, &args.out, &mut out)?;
    out.flush()?;

    // 5. The verification of points.
    let results = judge(&caster, &lights);
    let table = verify::text(&file, &lights, &results);
    out.text(format_args!("Verification: {table}\n"))?;
    write_atomic(at("verification.txt"), |writer| writer.write_all(table.as_bytes()))?;
    let mut opens = Vec::new();
    if !args.short {
        // 6. The other commands, and a scene that moves for them.
        let unreadable =
            |error| Failure::new(format!("cannot be read again: {error}"), "try again").in_file(&file);
        let glb = std::fs::read(&file).map_err(unreadable)?;
        write_atomic(at("moving.glb"), |writer| writer.write_all(&moving::with_clip(&glb)))?;
        opens = tour::run(&args.out, &mut out)?;
    }
    out.text(format_args!(
        "\nWritten to {}: scene, marked, silhouettes, volume-0, volume-1 (.glb), report.json, {files}, \
         verification.txt\n",
        output::plain(&args.out.to_string_lossy())
    ))?;
    if !opens.is_empty() {
        out.text(format_args!("Open first: {}\n", opens.join(", ")))?;
    }
    out.flush()?;
    let agreed = results.iter().all(Verification::agrees);
    Ok(if agreed && pixels_agree && closed { Outcome::Sound } else { Outcome::Unsound })
}

/// An upright knot, a sphere, a tilted open sheet, and the ground; y is up.
fn scene() -> Scene {
    let move_to = |x, y, z| Mat4::from_translation(Vec3::new(x, y, z));
    let scale = |factor| Mat4::from_scale(Vec3::splat(factor));
    // A sheet of n × n unit quads in the plane z = 0, as a unit square around the origin.
    let square = |n: f32| scale(1.0 / n) * move_to(-0.5 * n, -0.5 * n, 0.0);
    let lean = Mat4::from_rotation_y(-0.45) * Mat4::from_rotation_x(-0.3);
    let parts: [(&str, Mesh, Mat4); 4] = [
        ("torus knot", shapes::torus_knot(2, 3, 240, 24, 0.4), move_to(-1.5, 1.75, 0.0) * scale(0.52)),
        ("sphere", shapes::icosphere(4), move_to(1.25, 0.9, 1.3) * scale(0.9)),
        ("sheet", shapes::sheet(8), move_to(1.9, 1.3, -1.3) * lean * scale(2.2) * square(8.0)),
        ("ground", shapes::sheet(1), Mat4::from_rotation_x(-FRAC_PI_2) * scale(16.0) * square(1.0)),
    ];
    let mut scene = Scene::default();
    for (mesh, (name, shape, world_from_mesh)) in parts.into_iter().enumerate() {
        scene.meshes.push(shape.with_name(name));
        scene.instances.push(Instance { mesh, name: name.to_owned(), world_from_mesh });
    }
    scene
}

/// A warm lamp above to the left, and a cooler sun from the right.
fn lights() -> Vec<Lamp> {
    [("lamp", "point:-3.5,6,5", [1.0, 0.92, 0.8]), ("sun", "directional:-0.9,-1,-0.75", [0.8, 0.9, 1.0])]
        .map(|(name, light, color)| Lamp {
            name: name.to_owned(),
            color,
            ..light.parse().expect("written above")
        })
        .to_vec()
}

/// Runs `work` with the view that pictures show.
fn with_view<T>(
    mesh: &Mesh,
    lights: &[Lamp],
    (width, height): (u32, u32),
    work: impl FnOnce(View<'_>) -> T,
) -> T {
    let size = Size::new(width, height).expect("a small picture");
    let fov = 34_f32.to_radians();
    let camera =
        Camera::look_at([2.2, 3.9, 9.6], [0.1, 1.15, 0.0], fov, Up::Y).expect("the eye is not the target");
    let color = |light: &Lamp| light.color;
    let mut lamps = ShadedLight::equal(lights);
    for (lamp, tint) in lamps.iter_mut().zip(lights.iter().map(color)) {
        lamp.color = [0, 1, 2].map(|i| lamp.color[i] * tint[i]);
    }
    let paint = |face| match mesh.part_name(face) {
        Some(name) if name.starts_with("torus knot") => [0.72, 0.36, 0.22],
        Some(name) if name.starts_with("sphere") => [0.30, 0.48, 0.66],
        Some(name) if name.starts_with("sheet") => [0.62, 0.62, 0.30],
        _ => CLAY,
    };
    let (up, paint) = (Up::Y, &paint);
    work(View {
        camera,
        size,
        lamps: &lamps,
        casters: None,
        up,
        ground: None,
        paint,
        edge_samples: 4,
        ambient: None,
    })
}

fn by_rays(caster: &Caster, lights: &[Lamp], size: (u32, u32)) -> Result<Picture, Failure> {
    with_view(caster.mesh(), lights, size, |view| {
        let progress = Progress::bar("drawing", view.steps());
        render::render(caster.oracle(), &view, &|steps| progress.done(steps))
    })
    .map_err(|error| Failure::new(error, "free some memory"))
}

/// The adapter that was asked for, or any; or the reason why there is none.
#[cfg(feature = "gpu")]
type Found = Result<Gpu, GpuError>;
/// This build has no graphics.
#[cfg(not(feature = "gpu"))]
struct Found;

#[cfg(feature = "gpu")]
fn find(adapter: &AdapterArgs) -> Result<Found, Failure> {
    adapter.find()
}

#[cfg(not(feature = "gpu"))]
fn find(adapter: &AdapterArgs) -> Result<Found, Failure> {
    adapter.refuse().map(|()| Found)
}

/// Writes the pictures into a folder: the names of their files, and whether all pixels agree.
#[cfg(feature = "gpu")]
fn pictures(
    found: Found,
    caster: &Caster,
    lights: &[Lamp],
    folder: &Path,
    out: &mut Output,
) -> Result<(&'static str, bool), Failure> {
    let judged = found.and_then(|gpu| {
        with_view(caster.mesh(), lights, HALF, |view| pixels::judge(&gpu, caster, view, lights))
    });
    match judged {
        Ok(judged) => {
            let rays = by_rays(caster, lights, HALF)?;
            pixels::beside(&[&judged.picture, &rays]).write_png(folder.join("picture.png"))?;
            judged.verdicts.write_png(folder.join("verdicts.png"))?;
            out.text(format_args!("Pixels: {}\n", judged.text))?;
            Ok(("picture.png, verdicts.png", judged.agrees))
        }
        Err(error) => {
            output::say(format_args!("note: no stencil pass, the picture comes from the ray cast: {error}"));
            by_rays(caster, lights, SIZE)?.write_png(folder.join("picture.png"))?;
            Ok(("picture.png", true))
        }
    }
}

#[cfg(not(feature = "gpu"))]
fn pictures(
    _: Found,
    caster: &Caster,
    lights: &[Lamp],
    folder: &Path,
    _: &mut Output,
) -> Result<(&'static str, bool), Failure> {
    by_rays(caster, lights, SIZE)?.write_png(folder.join("picture.png"))?;
    output::say("note: the picture comes from the ray cast: this build cannot use a graphics adapter");
    Ok(("picture.png", true))
}

fn judge(caster: &Caster, lights: &[Lamp]) -> Vec<Verification> {
    let verifier = Verifier::new(caster);
    let options = Options { points: POINTS, ..Options::default() };
    let progress = Progress::bar("judging points", (lights.len() * POINTS) as u64);
    lights
        .iter()
        .map(|light| verifier.verify(light.light(), &options, &|points| progress.done(points)))
        .collect()
}
