//! Pictures with stencil shadows against exact pictures of the same view.

use umbrage::caster::{Caster, GpuCaster};
use umbrage::facing::{CasterFaces, classify};
use umbrage::geom::{Aabb, Light};
use umbrage::glam;
use umbrage::gpu::{Gpu, GpuError};
use umbrage::mesh::{FaceId, Mesh};
use umbrage::oracle::Oracle;
use umbrage::render::{CLAY, Ground, Picture, ShadedLight, View, render_visibility};
use umbrage::scene::SpotCone;
use umbrage::shadow::stencil::{Counting, Draw, StencilMethod, StencilPass};
use umbrage::shadow::volume::{Caps, GpuVolume, ShadowVolume};
use umbrage::shadow::{Depth, GpuSamples, GpuVisibility};
use umbrage::silhouette::Silhouette;
use umbrage::testing::shapes;
use umbrage::topology::Topology;
use umbrage::view::{Camera, Up};

use super::{QUIET, bounds, light, render, size};
use crate::support::gpu;

/// An injected fault: what is left out.
#[derive(Clone, Copy, PartialEq)]
enum Fault {
    None,
    /// The caps of the volumes.
    Caps,
    /// The volume of the first lamp.
    Volume,
}

struct Subject {
    mesh: Mesh,
    ground: Ground,
    bounds: Aabb,
    camera: Camera,
    lamps: Vec<ShadedLight>,
}

impl Subject {
    fn new(mesh: Mesh, eye: [f32; 3], lamps: Vec<ShadedLight>) -> Self {
        let bounds = bounds(&mesh);
        let (mesh, ground) = Ground::under(mesh, Up::Y).unwrap();
        let camera = Camera::look_at(eye, bounds.center(), 0.8, Up::Y).unwrap();
        Self { mesh, ground, bounds, camera, lamps }
    }

    fn view(&self, edge_samples: u32) -> View<'_> {
        View {
            camera: self.camera,
            size: size("96x64"),
            lamps: &self.lamps,
            casters: None,
            up: Up::Y,
            ground: Some(self.ground),
            paint: &|face: FaceId| if face.index().is_multiple_of(7) { [0.7, 0.3, 0.1] } else { CLAY },
            edge_samples,
            ambient: None,
        }
    }

    fn by_stencil(&self, gpu: &Gpu, depth: Depth, counting: Counting, samples: u32, fault: Fault) -> Picture {
        let topology = Topology::of(&self.mesh);
        let caps = if fault == Fault::Caps { Caps::None } else { Caps::Both };
        let volume = |lamp: &ShadedLight| {
            let signs = CasterFaces::All.signs(&classify(&self.mesh, &lamp.light));
            let silhouette = Silhouette::extract(&topology, &signs);
            let volume = ShadowVolume::extrude(&self.mesh, &topology, &lamp.light, &signs, &silhouette, caps);
            GpuVolume::upload(gpu, &volume).unwrap()
        };
        let volumes: Vec<GpuVolume> = self.lamps.iter().map(volume).collect();
        let pass = StencilPass::new(gpu, depth).unwrap();
        self.on_device(gpu, depth, samples, |lamp, samples| {
            let draw = [Draw { volume: &volumes[lamp], method: StencilMethod::ZFail }];
            let draws = if fault == Fault::Volume && lamp == 0 { &[] } else { &draw[..] };
            pass.visibility(samples, draws, counting)
        })
    }

    /// The picture with the visibility of each lamp.
    fn on_device(
        &self,
        gpu: &Gpu,
        depth: Depth,
        samples: u32,
        visibility: impl Fn(usize, &GpuSamples) -> Result<GpuVisibility, GpuError>,
    ) -> Picture {
        let view = self.view(samples);
        let projection = self.camera.projection(view.size, 1e-3 * self.bounds.diagonal() as f32);
        let caster = Caster::new(self.mesh.clone());
        let uploaded = GpuCaster::upload(gpu, &caster).unwrap();
        let samples = view.samples(&uploaded, &projection, depth).unwrap();
        render_visibility(&samples, &caster, &view, |lamp| visibility(lamp, &samples)).unwrap()
    }
}

/// Number of pixels that differ by more than `most` in any channel.
fn differing(a: &Picture, b: &Picture, most: u8) -> usize {
    assert_eq!(a.size, b.size);
    let differ = |(a, b): &(&[u8; 4], &[u8; 4])| a.iter().zip(*b).any(|(a, b)| a.abs_diff(*b) > most);
    a.pixels.iter().zip(&b.pixels).filter(differ).count()
}

fn subjects() -> [Subject; 4] {
    let equal =
        |lights: &[&str]| ShadedLight::equal(&lights.iter().map(|text| light(text)).collect::<Vec<Light>>());
    let knot = shapes::translated(&shapes::torus_knot(2, 3, 60, 10, 0.4), [0.0, 1.0, 0.0]);
    let mut spot = equal(&["point:2,5,3"]);
    let direction = glam::Vec3::new(-2.0, -5.0, -3.0).normalize().into();
    spot[0].cone = Some(SpotCone { direction, inner_rad: 0.1, outer_rad: 0.35 });
    [
        Subject::new(knot, [3.0, 4.0, 9.0], equal(&["point:3,9,4", "directional:0.3,-1,-0.2"])),
        // The eye is in a shadow.
        Subject::new(shapes::menger_sponge(2), [-1.0, 0.2, 0.6], equal(&["directional:1,-0.6,-0.9"])),
        // Faces in the lights' planes, and an open mesh.
        Subject::new(shapes::open_cube(), [1.5, 3.0, 3.5], equal(&["directional:0,-1,0", "point:-3,4,0"])),
        Subject::new(shapes::icosphere(3), [1.0, 3.0, 5.0], spot),
    ]
}

/// Bytes may differ by this much where only rounding differs: light is summed in half floats.
const NOISE: u8 = 2;

/// Number of the 6144 pixels that may differ by more: a pixel's center lies in a rasterizer's footprint of an
/// edge.
const AT_EDGES: usize = 6;

#[test]
fn stencil_picture_is_the_exact_one_but_at_edges() {
    let Some(gpu) = gpu() else { return };
    let mut unshadowed = 0;
    for (number, subject) in subjects().iter().enumerate() {
        let exact = render(&Oracle::build(&subject.mesh), &subject.view(1), QUIET);
        let wrong = |depth, counting, fault| {
            differing(&subject.by_stencil(&gpu, depth, counting, 1, fault), &exact, NOISE)
        };
        for counting in [Counting::Stencil, Counting::Integer] {
            let sound = wrong(Depth::Plane, counting, Fault::None);
            assert!(sound <= AT_EDGES, "{number} {counting:?}: {sound}");
            let open = wrong(Depth::Plane, counting, Fault::Caps);
            assert!(open > 50 * AT_EDGES, "{number} {counting:?}: {open}");
            unshadowed += wrong(Depth::Plane, counting, Fault::Volume);
        }
        let interpolated = wrong(Depth::Interpolated, Counting::Stencil, Fault::None);
        assert!(interpolated <= 10 * AT_EDGES, "{number}: {interpolated}");
    }
    assert!(unshadowed > 200 * AT_EDGES, "{unshadowed}");
}

#[test]
fn stencil_picture_has_the_falloff_of_the_exact_one() {
    let Some(gpu) = gpu() else { return };
    let lights = ["point:2,3,2", "point:-1,2.5,0.5", "directional:0.3,-1,-0.2"].map(light);
    for range in [None, Some(4.0)] {
        // Much larger and smaller than the scene too: lengths are scaled on the device.
        for scale in [1.0, 1e15, 1e-15] {
            let mesh = shapes::scaled(&shapes::icosphere(3), scale);
            let mut lamps = ShadedLight::equal(&lights.map(|light| scaled(&light, scale)));
            let bounds = bounds(&mesh);
            let plain = Subject::new(mesh.clone(), [1.0, 3.0, 5.0].map(|x| x * scale), lamps.clone());
            for lamp in &mut lamps {
                *lamp = lamp.with_physical_falloff(range.map(|range| range * scale), &bounds);
            }
            let subject = Subject { lamps, ..plain };
            let exact = render(&Oracle::build(&subject.mesh), &subject.view(1), QUIET);
            let picture =
                |subject: &Subject| subject.by_stencil(&gpu, Depth::Plane, Counting::Stencil, 1, Fault::None);
            let wrong = differing(&picture(&subject), &exact, NOISE);
            assert!(wrong <= AT_EDGES, "{range:?} {scale}: {wrong}");
            // The fault: a device that knows of no falloff, or of no range.
            let endless = |lamp: &ShadedLight| lamp.with_physical_falloff(None, &bounds);
            let lamps = if range.is_none() {
                ShadedLight::equal(&lights.map(|light| scaled(&light, scale)))
            } else {
                subject.lamps.iter().map(endless).collect()
            };
            let missed = differing(&picture(&Subject { lamps, ..subject }), &exact, NOISE);
            assert!(missed > 50 * AT_EDGES, "{range:?} {scale}: {missed}");
        }
    }
}

/// The same light where everything is `scale` times as large.
fn scaled(light: &Light, scale: f32) -> Light {
    let xyz = light.xyz().map(|x| x * scale);
    if light.is_directional() { *light } else { Light::point(xyz).unwrap() }
}

#[test]
fn stencil_picture_smooths_as_the_exact_one() {
    let Some(gpu) = gpu() else { return };
    for (number, subject) in subjects().iter().enumerate() {
        let exact = render(&Oracle::build(&subject.mesh), &subject.view(2), QUIET);
        for counting in [Counting::Stencil, Counting::Integer] {
            let picture = subject.by_stencil(&gpu, Depth::Plane, counting, 2, Fault::None);
            // The exact picture takes several rays only where a pixel differs from its neighbor by 20.
            let [more, edges] = [NOISE, 20].map(|most| differing(&picture, &exact, most));
            assert!(more <= 10 * AT_EDGES && edges <= AT_EDGES, "{number} {counting:?}: {more} {edges}");
        }
        // Negative test: without smoothing hundreds of pixels differ.
        let plain = subject.by_stencil(&gpu, Depth::Plane, Counting::Stencil, 1, Fault::None);
        assert!(differing(&plain, &exact, NOISE) > 10 * AT_EDGES, "{number}");
    }
}

#[test]
fn stencil_picture_of_coinciding_faces_is_lit_once() {
    let Some(gpu) = gpu() else { return };
    let lamps = ShadedLight::equal(&[light("point:3,5,4")]);
    let twice = Mesh::concat(&[shapes::icosphere(2), shapes::icosphere(2)]).unwrap();
    let [once, twice] = [shapes::icosphere(2), twice].map(|mesh| {
        let subject = Subject::new(mesh, [1.0, 3.0, 5.0], lamps.clone());
        subject.by_stencil(&gpu, Depth::Plane, Counting::Stencil, 1, Fault::None)
    });
    assert_eq!(differing(&once, &twice, NOISE), 0);
}

#[test]
fn stencil_picture_does_not_depend_on_the_unit() {
    let Some(gpu) = gpu() else { return };
    let picture = |exponent: i32| {
        let scaled = |p: [f32; 3]| p.map(|x| x * 2_f32.powi(exponent));
        let mesh = shapes::scaled(&shapes::torus_knot(2, 3, 60, 10, 0.4), 2_f32.powi(exponent));
        let lamp = Light::point(scaled([3.0, 9.0, 4.0])).unwrap();
        let lamps = ShadedLight::equal(&[lamp, light("directional:0.3,-1,-0.2")]);
        let subject = Subject::new(mesh, scaled([3.0, 4.0, 9.0]), lamps);
        subject.by_stencil(&gpu, Depth::Plane, Counting::Stencil, 1, Fault::None)
    };
    for exponent in [-40, 40] {
        assert_eq!(differing(&picture(exponent), &picture(0), 0), 0, "{exponent}");
    }
}

#[test]
fn stencil_picture_of_nothing_is_background_and_one_too_large_an_error() {
    let Some(gpu) = gpu() else { return };
    let subject = Subject::new(shapes::cube(), [1.0, 3.0, 5.0], ShadedLight::equal(&[light("point:3,5,4")]));
    let empty = Caster::new(Mesh::default());
    let uploaded = GpuCaster::upload(&gpu, &empty).unwrap();
    let view = View { lamps: &[], ground: None, ..subject.view(1) };
    let projection = subject.camera.projection(view.size, 0.1);
    let samples = view.samples(&uploaded, &projection, Depth::Plane).unwrap();
    let none = |_| unreachable!("there is no lamp");
    let picture = render_visibility(&samples, &empty, &view, none).unwrap();
    assert_eq!(differing(&picture, &render(&Oracle::build(empty.mesh()), &view, QUIET), 1), 0);
    for edge_samples in [2, u32::MAX] {
        let view = View { size: size("16384x1"), edge_samples, ..view };
        let error = view.samples(&uploaded, &projection, Depth::Plane).unwrap_err();
        assert!(matches!(error, GpuError::Picture { .. }), "{error}");
    }
    let view = View { size: size("16384x4097"), ..view };
    let error = view.samples(&uploaded, &projection, Depth::Plane).unwrap_err();
    assert!(matches!(error, GpuError::TooLarge { .. }), "{error}");
}

#[test]
fn stencil_picture_multiplies_the_light_of_a_lamp_by_its_visibility() {
    let Some(gpu) = gpu() else { return };
    let mut changed = 0;
    for (number, subject) in subjects().iter().enumerate() {
        let constant = |lamps: &[ShadedLight], value: f32| {
            let subject = Subject { mesh: subject.mesh.clone(), lamps: lamps.to_vec(), ..*subject };
            subject.on_device(&gpu, Depth::Plane, 1, |_, samples| {
                GpuVisibility::constant(&gpu, samples.size(), value)
            })
        };
        let scaled = |by: f32| {
            let scale = |lamp: &ShadedLight| ShadedLight { color: lamp.color.map(|x| by * x), ..*lamp };
            subject.lamps.iter().map(scale).collect::<Vec<_>>()
        };
        // Dark: as without lamps. Half: as lamps of half the color, to the bit, since light is linear in the color and
        // powers of two are exact. Lit: as without volumes.
        assert_eq!(constant(&subject.lamps, 0.0), constant(&[], 1.0), "{number}");
        assert_eq!(constant(&subject.lamps, 0.5), constant(&scaled(0.5), 1.0), "{number}");
        let pass = StencilPass::new(&gpu, Depth::Plane).unwrap();
        let unshadowed = subject
            .on_device(&gpu, Depth::Plane, 1, |_, samples| pass.visibility(samples, &[], Counting::Stencil));
        assert_eq!(constant(&subject.lamps, 1.0), unshadowed, "{number}");
        // The injected fault: a visibility that is not what it should be.
        let fault = constant(&subject.lamps, 0.25);
        changed += differing(&fault, &constant(&scaled(0.5), 1.0), NOISE);
        assert_ne!(fault, constant(&[], 1.0), "{number}");
    }
    assert!(changed > 500, "{changed}");
    // An independent reference: on a sphere alone nothing is shadowed but the faces that turn away, which stay dark.
    let lamps = ShadedLight::equal(&[light("point:3,5,4")]);
    let sphere = Subject::new(shapes::icosphere(3), [1.0, 3.0, 5.0], lamps);
    let view = View { ground: None, ..sphere.view(1) };
    let caster = Caster::new(shapes::icosphere(3));
    let uploaded = GpuCaster::upload(&gpu, &caster).unwrap();
    let projection = sphere.camera.projection(view.size, 0.1);
    let samples = view.samples(&uploaded, &projection, Depth::Plane).unwrap();
    let lit = |value| {
        render_visibility(&samples, &caster, &view, |_| GpuVisibility::constant(&gpu, samples.size(), value))
    };
    let exact = render(caster.oracle(), &view, QUIET);
    assert!(differing(&lit(1.0).unwrap(), &exact, NOISE) <= AT_EDGES);
    assert!(differing(&lit(0.5).unwrap(), &exact, NOISE) > 10 * AT_EDGES);
}
