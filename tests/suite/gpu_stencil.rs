//! The stencil pass against the exact oracle, pixel by pixel, on the real meshes.
//!
//! `UMBRAGE_STENCIL_SIZE=512 cargo test --release --test suite stencil_counts -- --nocapture` is the long form.

use umbrage::compare::{Comparison, PixelVerdict, Rendered, compare};
use umbrage::geom::{Aabb, Light, Projection};
use umbrage::gpu::Gpu;
use umbrage::mesh::{Mesh, Weld, weld};
use umbrage::oracle::{Oracle, Verdict};
use umbrage::scene::{Camera, Scope, Size, Up};
use umbrage::silhouette::{Casters, Silhouette, classify};
use umbrage::stencil::{Counting, Depth, Draw, Receivers, StencilMethod, StencilPass};
use umbrage::topology::Topology;
use umbrage::volume::{Caps, GpuVolume, ShadowVolume};

use crate::support::{gpu, real_meshes};

/// A point light outside, one inside the bounding box, and a directional one.
fn lights(bounds: &Aabb) -> [Light; 3] {
    let (centre, size) = (bounds.centre(), bounds.diagonal() as f32);
    let inside = |i: usize| centre[i] + 0.21 * (bounds.high[i] - bounds.low[i]);
    [
        Light::point([centre[0] + 0.7 * size, centre[1] + 1.1 * size, centre[2] + 0.4 * size]),
        Light::point([0, 1, 2].map(inside)),
        Light::directional([-0.3, -1.0, -0.45]),
    ]
    .map(|light| light.expect("finite and not zero"))
}

/// An eye outside, one in a shadow, one whose near plane cuts the mesh and its volume, and one of a wide view close by.
fn projections(oracle: &Oracle, light: &Light, size: Size) -> [(&'static str, Projection); 4] {
    let bounds = oracle.bounds();
    let (centre, diagonal) = (bounds.centre(), bounds.diagonal() as f32);
    let outside = Camera::fit(&bounds, Up::Y, size.aspect());
    let distance = (outside.eye - glam(centre)).length();
    let dark = (1..200_u32)
        .map(|i| {
            let turn = |k: u32| (i.wrapping_mul(k) >> 8) as f32 / (1 << 24) as f32 * 2.0 - 1.0;
            [0x9e37_79b1, 0x85eb_ca6b, 0xc2b2_ae35].map(turn)
        })
        .map(|unit| [0, 1, 2].map(|i| centre[i] + 0.7 * diagonal * unit[i]))
        .find(|&p| oracle.verdict(p, light) == Verdict::Shadowed)
        .unwrap_or(centre);
    let inside = Camera::look_at(dark, centre.map(|x| x + 1e-3 * diagonal), 1.0, Up::Y).unwrap();
    let close = [0, 1, 2].map(|i| centre[i] + 0.3 * (bounds.high[i] - bounds.low[i]));
    let wide = Camera::look_at(close, bounds.low, 120_f32.to_radians(), Up::Y).unwrap();
    let near = 1e-3 * diagonal;
    [
        ("outside", outside.projection(size, 0.3 * distance)),
        ("in a volume", inside.projection(size, near)),
        ("near plane cuts", outside.projection(size, 0.95 * distance)),
        ("120 degrees", wide.projection(size, near)),
    ]
}

fn glam([x, y, z]: [f32; 3]) -> umbrage::glam::Vec3 {
    umbrage::glam::Vec3::new(x, y, z)
}

struct Caster<'a> {
    mesh: &'a Mesh,
    topology: Topology,
    oracle: Oracle,
    receivers: Receivers,
}

fn judge(
    gpu: &Gpu,
    pass: &StencilPass,
    caster: &Caster<'_>,
    light: &Light,
    size: Size,
    name: &str,
) -> [usize; 7] {
    let signs = Casters::All.signs(&classify(caster.mesh, light));
    let silhouette = Silhouette::extract(&caster.topology, &signs);
    let volume = ShadowVolume::extrude(caster.mesh, &caster.topology, light, &signs, &silhouette, Caps::Both);
    let volume = GpuVolume::upload(gpu, &volume).unwrap();
    let mut sum = [0; 7];
    for (eye, projection) in projections(&caster.oracle, light, size) {
        let draw = Draw { volume: &volume, method: StencilMethod::ZFail };
        let mask = pass.mask(&projection, size, &caster.receivers, &[draw], Counting::Integer).unwrap();
        let stencil = pass.mask(&projection, size, &caster.receivers, &[draw], Counting::Stencil).unwrap();
        for (a, b) in mask.raw().iter().zip(stencil.raw()) {
            assert_eq!(a & 255, *b, "{name} {eye}");
        }
        let rendered = Rendered {
            mesh: caster.mesh,
            signs: &signs,
            light,
            projection: &projection,
            mask: &mask,
            unsure: &[],
        };
        let result: Comparison = compare(&caster.oracle, &rendered, 5, &|_| {});
        let counts = PixelVerdict::ALL.map(|verdict| result.count(verdict));
        eprintln!("{name} {light} {eye}: {counts:?} {:?}", result.mismatches);
        for (sum, count) in sum.iter_mut().zip(counts) {
            *sum += count;
        }
    }
    sum
}

#[test]
fn stencil_counts_what_the_oracle_counts_on_every_real_mesh() {
    let (Some(gpu), Some(folder)) = (gpu(), real_meshes()) else { return };
    let side = std::env::var("UMBRAGE_STENCIL_SIZE").map_or(64, |n| n.parse().expect("a number of pixels"));
    let size = Size::new(side, side).unwrap();
    let pass = StencilPass::new(&gpu, Depth::Plane).unwrap();
    let mut files: Vec<_> = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.sort();
    let mut sum = [0; 7];
    for file in files {
        let Ok(scene) = umbrage::read::read(&file) else { continue }; // notes and facts, a buffer
        let name = file.file_name().expect("a file").to_string_lossy().into_owned();
        let meshes: Vec<Mesh> =
            scene.bake(Scope::Mesh).unwrap().iter().map(|mesh| weld(mesh, Weld::Exact).mesh).collect();
        let mesh = Mesh::concat(&meshes).unwrap();
        let caster = Caster {
            topology: Topology::build(mesh.vertex_count(), mesh.triangles().to_vec()),
            oracle: Oracle::build(&mesh),
            receivers: Receivers::upload(&gpu, &mesh).unwrap(),
            mesh: &mesh,
        };
        for light in lights(&caster.oracle.bounds()) {
            let counts = judge(&gpu, &pass, &caster, &light, size, &name);
            for (sum, count) in sum.iter_mut().zip(counts) {
                *sum += count;
            }
        }
    }
    eprintln!("{:?}: {sum:?}", PixelVerdict::ALL);
    assert_eq!(sum[PixelVerdict::Real as usize], 0);
}
