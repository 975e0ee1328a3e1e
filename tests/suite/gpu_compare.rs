//! Pixel comparison on masks of the device: faults must be found and classified correctly.

use umbrage::caster::{Caster, GpuCaster};
use umbrage::facing::{CasterFaces, classify};
use umbrage::geom::Light;
use umbrage::gpu::Gpu;
use umbrage::mesh::{FaceId, Mesh};
use umbrage::shadow::Depth;
use umbrage::shadow::stencil::{Counting, Draw, ShadowMask, StencilMethod, StencilPass};
use umbrage::shadow::volume::{Caps, GpuVolume, ShadowVolume};
use umbrage::silhouette::Silhouette;
use umbrage::testing::shapes;
use umbrage::topology::Topology;
use umbrage::verify::pixels::{Comparison, PixelVerdict, Rendered, compare};
use umbrage::view::{Camera, Projection, Size, Up};

use crate::support::gpu;

/// One mesh, light and camera.
struct Scene<'a> {
    mesh: &'a Mesh,
    light: Light,
    caster: Caster,
    size: Size,
    projection: Projection,
}

impl<'a> Scene<'a> {
    fn new(mesh: &'a Mesh, light: [f32; 3], eye: [f32; 3], target: [f32; 3]) -> Self {
        let caster = Caster::new(mesh.clone());
        let size = Size::new(96, 96).unwrap();
        let camera = Camera::look_at(eye, target, 0.7, Up::Y).unwrap();
        let projection = camera.projection(size, camera.near([mesh], size));
        Self { mesh, light: Light::point(light).unwrap(), caster, size, projection }
    }

    fn signs(&self) -> Vec<i8> {
        CasterFaces::All.signs(&classify(self.mesh, &self.light))
    }

    /// The device's counts if faces cast with these signs.
    fn mask(&self, gpu: &Gpu, signs: &[i8], counting: Counting) -> ShadowMask {
        let topology = Topology::of(self.mesh);
        let silhouette = Silhouette::extract(&topology, signs);
        let volume = ShadowVolume::extrude(self.mesh, &topology, &self.light, signs, &silhouette, Caps::Both);
        let volume = GpuVolume::upload(gpu, &volume).unwrap();
        let pass = StencilPass::new(gpu, Depth::Plane).unwrap();
        let receivers = GpuCaster::upload(gpu, &self.caster).unwrap();
        let draw = Draw { volume: &volume, method: StencilMethod::ZFail };
        pass.mask(&self.projection, self.size, &receivers, &[draw], counting).unwrap()
    }

    fn compare(&self, mask: &ShadowMask, signs: &[i8], unsure: &[FaceId]) -> Comparison {
        let rendered = Rendered {
            caster: &self.caster,
            seen: None,
            signs,
            light: &self.light,
            projection: &self.projection,
            seen_from: 0.0,
            mask,
            unsure,
        };
        compare(&rendered, 3, &|_| {})
    }
}

/// A torus lit from above; the eye sees the shadow that one half casts on the other.
fn torus() -> Mesh {
    shapes::torus(24, 12, 2.0, 0.7)
}

#[test]
fn compare_agrees_on_what_is_right_and_knows_the_sky() {
    let Some(gpu) = gpu() else { return };
    let mesh = torus();
    let scene = Scene::new(&mesh, [3.0, 4.0, 5.0], [2.0, -5.0, 4.0], [0.0; 3]);
    let signs = scene.signs();
    let found = scene.compare(&scene.mask(&gpu, &signs, Counting::Stencil), &signs, &[]);
    assert!(found.agrees() && found.mismatches.is_empty(), "{:?}", found.mismatches);
    for verdict in [PixelVerdict::Sky, PixelVerdict::Lit, PixelVerdict::Shadowed] {
        assert!(found.count(verdict) > 500, "{verdict:?}: {}", found.count(verdict));
    }
    let away = Scene::new(&mesh, [3.0, 4.0, 5.0], [0.0, 0.0, 9.0], [0.0, 0.0, 99.0]);
    let found = away.compare(&away.mask(&gpu, &signs, Counting::Integer), &signs, &[]);
    assert_eq!(found.count(PixelVerdict::Sky), away.size.pixels());
}

#[test]
fn compare_finds_one_face_that_casts_no_shadow() {
    let Some(gpu) = gpu() else { return };
    let mesh = torus();
    let scene = Scene::new(&mesh, [3.0, 4.0, 5.0], [2.0, -5.0, 4.0], [0.0; 3]);
    let signs = scene.signs();
    // The face that shadows most of the view, and a face that lies on no shadow ray.
    let camera = Camera::look_at([2.0, -5.0, 4.0], [0.0; 3], 0.7, Up::Y).unwrap();
    let mut met = vec![0; mesh.face_count()];
    for place in 0..scene.size.pixels() {
        let (x, y) = ((place % 96) as f64 + 0.5, (place / 96) as f64 + 0.5);
        let ray = camera.ray(x, y, scene.size);
        let seen = scene.caster.oracle().first_visible(ray.origin, ray.direction);
        let Some(seen) = seen else { continue };
        met[seen.face.index()] += 1;
        scene.caster.oracle().for_each_meeting(seen.point, &scene.light, |face, _| met[face.index()] += 1);
    }
    let casting = (0..met.len()).filter(|&face| signs[face] == 1);
    let face = FaceId::new(casting.max_by_key(|&face| met[face]).expect("some face is lit"));
    let other = FaceId::new(met.iter().position(|&count| count == 0).expect("some face is out of the way"));
    let mut spoiled = signs.clone();
    spoiled[face.index()] = 0;
    let mask = scene.mask(&gpu, &spoiled, Counting::Integer);

    let found = scene.compare(&mask, &signs, &[]);
    let real = found.count(PixelVerdict::Real);
    assert!(!found.agrees() && real > 3, "{real} pixels");
    assert_eq!(found.mismatches.len(), 3);
    for mismatch in &found.mismatches {
        assert_eq!(found.verdicts[(mismatch.y * 96 + mismatch.x) as usize], PixelVerdict::Real);
        assert_eq!(mismatch.counted.map(|count| count as u32 + 1), mismatch.exact, "{mismatch:?}");
    }

    // The same pixels are excused, and counted as unsure, if that face's side was left to f32.
    let excused = scene.compare(&mask, &signs, &[face]);
    assert_eq!((excused.count(PixelVerdict::Real), excused.count(PixelVerdict::Unsure)), (0, real));
    assert!(!excused.agrees() && excused.mismatches.is_empty());
    assert_eq!(scene.compare(&mask, &signs, &[other]).count(PixelVerdict::Real), real);
}

#[test]
fn compare_calls_a_wrapped_stencil_an_overflow() {
    let Some(gpu) = gpu() else { return };
    let mesh = shapes::nested_cubes(300);
    // The eye sees the dark sides of the outermost cube: each inner cube is crossed twice.
    let scene = Scene::new(&mesh, [1000.0, 900.0, 800.0], [-1800.0, -1300.0, -1500.0], [0.0; 3]);
    let signs = scene.signs();
    let casting = scene.caster.stencil_volumes(&scene.light, &scene.projection, Some(CasterFaces::All), None);
    assert_eq!(casting.counting(), Counting::Integer, "{}", casting.layers);
    let wrapped = scene.compare(&scene.mask(&gpu, &signs, Counting::Stencil), &signs, &[]);
    assert!(wrapped.count(PixelVerdict::Overflow) > 500 && !wrapped.agrees(), "{:?}", wrapped.mismatches);
    assert_eq!(wrapped.count(PixelVerdict::Real), 0);
    let whole = scene.compare(&scene.mask(&gpu, &signs, Counting::Integer), &signs, &[]);
    assert_eq!((whole.count(PixelVerdict::Overflow), whole.count(PixelVerdict::Real)), (0, 0));
    assert!(whole.count(PixelVerdict::Shadowed) > 500);
}
