//! The stencil pass against the exact oracle, pixel by pixel: on the real meshes, and on meshes that are hard
//! to draw.
//!
//! Long form:
//! `UMBRAGE_STENCIL_SIZE=512 cargo test --release --test suite stencil_pass_counts -- --nocapture`.

use umbrage::caster::{Caster, GpuCaster};
use umbrage::facing::CasterFaces;
use umbrage::geom::{Aabb, Light};
use umbrage::glam::Vec3;
use umbrage::gpu::{Gpu, wgpu};
use umbrage::mesh::{Mesh, Weld, weld};
use umbrage::oracle::{Oracle, Verdict};
use umbrage::scene::Scope;
use umbrage::shadow::Depth;
use umbrage::shadow::stencil::{
    Counting, Draw, ShadowMask, StencilFrame, StencilMethod, StencilPass, StencilVolumes,
};
use umbrage::shadow::volume::{Caps, GpuExtrusion, GpuVolume, Part, VolumeShaders};
use umbrage::testing::shapes;
use umbrage::topology::GpuTopology;
use umbrage::verify::pixels::{Comparison, PixelVerdict, Rendered, compare};
use umbrage::view::{Camera, Projection, Size, Up};

use crate::support::{gpu, real_meshes};

/// A mesh, ready to be compared from many views.
struct Stage<'a> {
    gpu: &'a Gpu,
    pass: &'a StencilPass,
    caster: Caster,
    faces: Option<CasterFaces>,
    receivers: GpuCaster,
    size: Size,
}

impl<'a> Stage<'a> {
    fn new(gpu: &'a Gpu, pass: &'a StencilPass, mesh: &Mesh, faces: Option<CasterFaces>, side: u32) -> Self {
        let caster = Caster::new(mesh.clone());
        Self {
            gpu,
            pass,
            receivers: GpuCaster::upload(gpu, &caster).unwrap(),
            caster,
            faces,
            size: Size::new(side, side).unwrap(),
        }
    }

    fn cast(&self, light: &Light, projection: &Projection, method: Option<StencilMethod>) -> StencilVolumes {
        self.caster.stencil_volumes(light, projection, self.faces, method)
    }

    fn mask(&self, projection: &Projection, draws: &[Draw<'_>], counting: Counting) -> ShadowMask {
        self.pass.mask(projection, self.size, &self.receivers, draws, counting).unwrap()
    }

    fn compare(&self, light: &Light, projection: &Projection, signs: &[i8], mask: &ShadowMask) -> Comparison {
        let caster = &self.caster;
        let rendered = Rendered {
            caster,
            seen: None,
            signs,
            light,
            projection,
            seen_from: projection.near,
            mask,
            unsure: &[],
        };
        compare(&rendered, 5, &|_| {})
    }

    /// Number of pixels per verdict, by z-fail, and by the chosen method if it differs for any shell. No
    /// pixel may be real.
    fn judge(&self, light: &Light, projection: &Projection, what: &str) -> [usize; 7] {
        let mut sum = [0; 7];
        for asked in [Some(StencilMethod::ZFail), None] {
            let casting = self.cast(light, projection, asked);
            if asked.is_none() && casting.methods.count(StencilMethod::ZPass) == 0 {
                continue;
            }
            let cast = casting.upload(self.gpu).unwrap();
            let mask = self.mask(projection, &cast.draws(), casting.counting());
            let result = self.compare(light, projection, &casting.signs, &mask);
            let counts = PixelVerdict::ALL.map(|verdict| result.count(verdict));
            eprintln!("{what} {light} {asked:?}: {counts:?}");
            assert!(result.agrees(), "{what} {light} {asked:?}: {counts:?} {:?}", result.mismatches);
            for (sum, count) in sum.iter_mut().zip(counts) {
                *sum += count;
            }
        }
        sum
    }
}

/// Lights: a point light outside, one inside the bounding box, and a directional one.
fn lights(bounds: &Aabb) -> [Light; 3] {
    let (center, size) = (bounds.center(), bounds.diagonal() as f32);
    let inside = |i: usize| center[i] + 0.21 * (bounds.high[i] - bounds.low[i]);
    [
        Light::point([center[0] + 0.7 * size, center[1] + 1.1 * size, center[2] + 0.4 * size]),
        Light::point([0, 1, 2].map(inside)),
        Light::directional([-0.3, -1.0, -0.45]),
    ]
    .map(|light| light.expect("finite and not zero"))
}

/// Eyes: outside, in a shadow, with a near plane that cuts the mesh and its volume, and nearby with a wide
/// view.
fn projections(oracle: &Oracle, light: &Light, size: Size) -> [(&'static str, Projection); 4] {
    let bounds = oracle.bounds();
    let (center, diagonal) = (bounds.center(), bounds.diagonal() as f32);
    let outside = Camera::fit(&bounds, Up::Y, size.aspect());
    let distance = (outside.eye - Vec3::from(center)).as_dvec3().length() as f32;
    let dark = (1..200_u32)
        .map(|i| {
            let turn = |k: u32| (i.wrapping_mul(k) >> 8) as f32 / (1 << 24) as f32 * 2.0 - 1.0;
            let unit = [0x9e37_79b1, 0x85eb_ca6b, 0xc2b2_ae35].map(turn);
            [0, 1, 2].map(|i| center[i] + 0.7 * diagonal * unit[i])
        })
        .find(|&p| oracle.verdict(p, light) == Verdict::Shadowed)
        .unwrap_or(center);
    let inside = Camera::look_at(dark, center.map(|x| x + 1e-3 * diagonal), 1.0, Up::Y).unwrap();
    let close = [0, 1, 2].map(|i| center[i] + 0.3 * (bounds.high[i] - bounds.low[i]));
    let wide = Camera::look_at(close, bounds.low, 120_f32.to_radians(), Up::Y).unwrap();
    let near = 1e-3 * diagonal;
    [
        ("outside", outside.projection(size, 0.3 * distance)),
        ("in a volume", inside.projection(size, near)),
        ("near plane cuts", outside.projection(size, 0.95 * distance)),
        ("120 degrees", wide.projection(size, near)),
    ]
}

/// Triangles in all directions over a few vertices: open, non-manifold and self-intersecting.
fn tangle(faces: u32) -> Mesh {
    let noise = |i: u32, k: u32| {
        (i.wrapping_mul(0x9e37_79b1) ^ k.wrapping_mul(0x85eb_ca6b)).wrapping_mul(0xc2b2_ae35)
    };
    let unit = |i, k| (noise(i, k) >> 8) as f32 / (1 << 24) as f32;
    let vertices = (0..20).map(|i| [0, 1, 2].map(|k| unit(i, k))).collect();
    let triangles = (0..faces).map(|i| [3, 4, 5].map(|k| (noise(i, k) >> 7) % 20)).collect();
    Mesh::new(vertices, triangles).unwrap()
}

#[test]
fn stencil_pass_counts_what_the_oracle_counts_on_every_real_mesh() {
    let (Some(gpu), Some(folder)) = (gpu(), real_meshes()) else { return };
    let side = std::env::var("UMBRAGE_STENCIL_SIZE").map_or(48, |n| n.parse().expect("a number of pixels"));
    let pass = StencilPass::new(&gpu, Depth::Plane).unwrap();
    let mut files: Vec<_> = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.sort();
    let (mut judged, mut sum) = (0, [0; 7]);
    for file in files {
        let Ok(scene) = umbrage::read::read(&file) else { continue }; // notes and facts, a buffer
        let name = file.file_name().expect("a file").to_string_lossy().into_owned();
        let meshes: Vec<Mesh> =
            scene.bake(Scope::Mesh).unwrap().iter().map(|mesh| weld(mesh, Weld::Exact).mesh).collect();
        let mesh = Mesh::concat(&meshes).unwrap();
        // Half the faces where this is proven, for meshes with quick proofs.
        let faces = if mesh.face_count() < 30_000 { None } else { Some(CasterFaces::All) };
        let stage = Stage::new(&gpu, &pass, &mesh, faces, side);
        for light in lights(&stage.caster.oracle().bounds()) {
            for (eye, projection) in projections(stage.caster.oracle(), &light, stage.size) {
                let counts = stage.judge(&light, &projection, &format!("{name} {eye}"));
                for (sum, count) in sum.iter_mut().zip(counts) {
                    *sum += count;
                }
            }
        }
        judged += 1;
    }
    eprintln!("{judged} meshes, {}: {:?}: {sum:?}", gpu.name(), PixelVerdict::ALL);
    assert_eq!(judged, 29);
    let [sky, lit, shadowed, ..] = sum;
    assert!(sky > 0 && lit > 0 && shadowed > 0);
}

#[test]
fn stencil_pass_adds_up_to_nothing_around_closed_volumes_and_to_something_without_caps() {
    let Some(gpu) = gpu() else { return };
    let pass = StencilPass::new(&gpu, Depth::Plane).unwrap();
    let solids = [
        shapes::torus_knot(2, 3, 120, 12, 0.3),
        shapes::mobius(40),
        shapes::sheet(3),
        shapes::menger_sponge(2),
        shapes::figure_eight_prism(),
        tangle(60),
    ];
    for mesh in solids {
        let stage = Stage::new(&gpu, &pass, &mesh, Some(CasterFaces::All), 64);
        let light = lights(&stage.caster.oracle().bounds())[0];
        let (_, projection) = projections(stage.caster.oracle(), &light, stage.size)[0];
        let casting = stage.cast(&light, &projection, Some(StencilMethod::ZFail));
        let volume = GpuVolume::upload(&gpu, &casting.volumes[0].1).unwrap();
        let sum = |parts: &[Part]| pass.signed_sum(&projection, stage.size, &[(&volume, parts)]).unwrap();
        assert!(sum(&Part::ALL).iter().all(|&sum| sum == 0));
        // Negative test: an open volume shows.
        assert!(sum(&[Part::Sides]).iter().any(|&sum| sum != 0));
        assert!(sum(&[Part::Sides, Part::DarkCap]).iter().any(|&sum| sum != 0));
    }
}

#[test]
fn stencil_pass_holds_where_drawing_is_hard() {
    let Some(gpu) = gpu() else { return };
    let pass = StencilPass::new(&gpu, Depth::Plane).unwrap();
    let cube = shapes::cube();
    let mirrored =
        Mesh::concat(&[cube.clone(), shapes::inside_out(&shapes::translated(&cube, [1.5, 0.25, 0.0]))]);
    let touching = Mesh::concat(&[cube.clone(), shapes::translated(&cube, [1.0, 0.0, 0.0])]);
    let cases = [
        ("one sheet", shapes::sheet(2)),
        ("a double sheet", shapes::double_sheet()),
        ("a Moebius strip", shapes::mobius(24)),
        ("eighteen faces on an edge", shapes::book(18)),
        ("inside out beside right way out", mirrored.unwrap()),
        ("coincident edges of two meshes", touching.unwrap()),
        ("a lobe of winding -1", shapes::figure_eight_prism()),
        ("a cavity", shapes::hollow_cube()),
        ("slivers", shapes::sliver()),
        ("a T-junction", shapes::t_junction()),
        ("poles of a capsule", shapes::uv_capsule(12, 6, 0.5, 1.0)),
        ("axis-aligned ties", shapes::menger_sponge(1)),
        ("everything at once", tangle(40)),
        ("small", shapes::scaled(&shapes::icosphere(2), 1e-30)),
        ("large", shapes::scaled(&shapes::icosphere(2), 1e30)),
        ("far from the origin", shapes::translated(&shapes::icosphere(2), [1e6, -2e6, 5e5])),
        (
            "one triangle",
            Mesh::new(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.5]], vec![[0, 1, 2]]).unwrap(),
        ),
    ];
    let mut sum = [0; 7];
    for (what, mesh) in &cases {
        let stage = Stage::new(&gpu, &pass, mesh, None, 40);
        let bounds = stage.caster.oracle().bounds();
        let diagonal = bounds.diagonal() as f32;
        let outside = projections(stage.caster.oracle(), &lights(&bounds)[0], stage.size)[0].1;
        let ahead = |t: f32| [0, 1, 2].map(|i| outside.eye[i] + t * outside.forward[i]);
        let mut all = lights(&bounds).to_vec();
        all.extend(
            [
                Light::point(mesh.positions()[0]),
                Light::point(outside.eye),
                Light::point(ahead(-diagonal)),
                Light::point(ahead(outside.near)),
                Light::point(bounds.center().map(|x| x + (40_f32).exp2() * diagonal.min(1e20))),
                Light::directional([0.0, -1.0, 0.0]),
                Light::directional(outside.forward),
                Light::directional(outside.forward.map(|x| -x)),
            ]
            .map(Result::unwrap),
        );
        for light in all {
            for (eye, projection) in projections(stage.caster.oracle(), &light, stage.size) {
                let counts = stage.judge(&light, &projection, &format!("{what}, {eye}"));
                for (sum, count) in sum.iter_mut().zip(counts) {
                    *sum += count;
                }
            }
        }
    }
    eprintln!("{:?}: {sum:?}", PixelVerdict::ALL);
}

#[test]
fn stencil_pass_counts_beyond_eight_bits_in_whole_numbers() {
    let Some(gpu) = gpu() else { return };
    let pass = StencilPass::new(&gpu, Depth::Plane).unwrap();
    for (shells, wraps) in [(60, false), (128, true), (256, true), (300, true)] {
        let mesh = shapes::nested_cubes(shells);
        let stage = Stage::new(&gpu, &pass, &mesh, Some(CasterFaces::All), 48);
        // Looking towards the light, so that the dark sides are visible.
        let (_, projection) =
            projections(stage.caster.oracle(), &Light::point([0.0; 3]).unwrap(), stage.size)[0];
        let light = Light::point(projection.eye.map(|x| -x)).unwrap();
        let casting = stage.cast(&light, &projection, Some(StencilMethod::ZFail));
        assert_eq!(casting.counting() == Counting::Integer, wraps, "{shells}: {:?}", casting.layers);
        let cast = casting.upload(&gpu).unwrap();
        let mask = stage.mask(&projection, &cast.draws(), casting.counting());
        assert!(stage.compare(&light, &projection, &casting.signs, &mask).agrees(), "{shells}");
        let pixels = (0..48).flat_map(|y| (0..48).map(move |x| (x, y)));
        let most = pixels.filter_map(|(x, y)| mask.count(x, y)).max();
        eprintln!("{shells} nested cubes: the largest count is {most:?}");
        // Eight bits hold the same counts, modulo 256. Negative test: trusting these counts.
        let stencil = stage.mask(&projection, &cast.draws(), Counting::Stencil);
        assert!(mask.raw().iter().zip(stencil.raw()).all(|(a, b)| a & 255 == *b));
        let result = stage.compare(&light, &projection, &casting.signs, &stencil);
        let overflown = result.count(PixelVerdict::Overflow);
        assert_eq!(overflown > 0, most > Some(255), "{shells}");
        assert_eq!(result.agrees(), overflown == 0);
    }
}

#[test]
fn stencil_pass_of_a_volume_without_a_face_is_caught() {
    let Some(gpu) = gpu() else { return };
    let pass = StencilPass::new(&gpu, Depth::Plane).unwrap();
    let mesh = shapes::torus_knot(2, 3, 60, 8, 0.3);
    let stage = Stage::new(&gpu, &pass, &mesh, Some(CasterFaces::All), 64);
    let light = lights(&stage.caster.oracle().bounds())[0];
    let (_, projection) = projections(stage.caster.oracle(), &light, stage.size)[0];
    let casting = stage.cast(&light, &projection, Some(StencilMethod::ZFail));
    // Negative test: without the last visible caster, the pixels behind it are lit.
    let whole = stage.caster.topology().triangles();
    let without = Mesh::new(mesh.positions().to_vec(), whole[..whole.len() - 40].to_vec()).unwrap();
    let other = Caster::new(without).stencil_volumes(
        &light,
        &projection,
        Some(CasterFaces::All),
        Some(StencilMethod::ZFail),
    );
    let cast = other.upload(&gpu).unwrap();
    let mask = stage.mask(&projection, &cast.draws(), Counting::Stencil);
    assert!(!stage.compare(&light, &projection, &casting.signs, &mask).agrees());
}

#[test]
fn stencil_frame_in_a_callers_encoder_counts_as_the_pass_of_our_own() {
    let Some(gpu) = gpu() else { return };
    let pass = StencilPass::new(&gpu, Depth::Plane).unwrap();
    let mesh = shapes::torus_knot(2, 3, 80, 10, 0.3);
    let stage = Stage::new(&gpu, &pass, &mesh, Some(CasterFaces::All), 64);
    let volumes = VolumeShaders::new(&gpu).unwrap();
    let extrusion = GpuExtrusion::new(&volumes, &stage.receivers, Caps::Both, None).unwrap();
    let texture = StencilFrame::attachment(&gpu, stage.size).unwrap();
    let back = gpu.device().create_buffer(&wgpu::BufferDescriptor {
        label: None,
        size: 64 * 256,
        usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    for (turn, light) in lights(&stage.caster.oracle().bounds()).into_iter().enumerate() {
        let (_, projection) = projections(stage.caster.oracle(), &light, stage.size)[0];
        // A single encoder from the light to the counts, submitted once.
        let mut encoder = gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let volume = extrusion.record(&mut encoder, &light).unwrap();
        let draw = Draw { volume: &volume, method: StencilMethod::ZFail };
        let frame = pass.prepare(&projection, stage.size, &stage.receivers, &[draw]).unwrap();
        let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
        if turn == 0 {
            frame.record(&mut encoder, &view);
        } else {
            // A render pass of the caller's.
            let store = wgpu::StoreOp::Store;
            let mut drawing = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                label: None,
                color_attachments: &[],
                depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                    view: &view,
                    depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(0.0), store }),
                    stencil_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(0), store }),
                }),
                timestamp_writes: None,
                occlusion_query_set: None,
                multiview_mask: None,
            });
            frame.draw_receivers(&mut drawing);
            frame.draw_volumes(&mut drawing);
            drop(drawing);
        }
        let layout =
            wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(256), rows_per_image: None };
        let mut from = texture.as_image_copy();
        from.aspect = wgpu::TextureAspect::StencilOnly;
        encoder.copy_texture_to_buffer(
            from,
            wgpu::TexelCopyBufferInfo { buffer: &back, layout },
            texture.size(),
        );
        gpu.attempt(|| gpu.queue().submit([encoder.finish()])).unwrap();
        let (sender, mapped) = std::sync::mpsc::channel();
        back.map_async(wgpu::MapMode::Read, .., move |result| sender.send(result).unwrap());
        gpu.device().poll(wgpu::PollType::wait_indefinitely()).unwrap();
        mapped.recv().unwrap().unwrap();
        let counts: Vec<i32> = back
            .get_mapped_range(..)
            .unwrap()
            .chunks_exact(256)
            .flat_map(|row| row[..64].iter().map(|&count| i32::from(count)).collect::<Vec<_>>())
            .collect();
        back.unmap();
        let casting = stage.cast(&light, &projection, Some(StencilMethod::ZFail));
        let cast = casting.upload(&gpu).unwrap();
        let mask = stage.mask(&projection, &cast.draws(), Counting::Stencil);
        assert!(counts == mask.raw(), "{light}");
        assert!(counts.iter().any(|&count| count != 0));
    }
}

#[test]
fn stencil_visibility_is_one_where_the_count_is_zero() {
    let Some(gpu) = gpu() else { return };
    let pass = StencilPass::new(&gpu, Depth::Plane).unwrap();
    for mesh in [shapes::torus_knot(2, 3, 80, 10, 0.3), shapes::menger_sponge(1)] {
        let stage = Stage::new(&gpu, &pass, &mesh, Some(CasterFaces::All), 64);
        let light = lights(&stage.caster.oracle().bounds())[0];
        for (what, projection) in projections(stage.caster.oracle(), &light, stage.size) {
            let samples = stage.receivers.samples(&projection, stage.size, Depth::Plane).unwrap();
            let cast = stage.cast(&light, &projection, Some(StencilMethod::ZFail)).upload(&gpu).unwrap();
            for counting in [Counting::Stencil, Counting::Integer] {
                let mask = stage.mask(&projection, &cast.draws(), counting);
                let expected: Vec<f32> = (0..64)
                    .flat_map(|y| (0..64).map(move |x| (x, y)))
                    .map(|(x, y)| if mask.count(x, y) == Some(0) { 1.0 } else { 0.0 })
                    .collect();
                let visibility = |draws: &[Draw<'_>]| {
                    pass.visibility(&samples, draws, counting).unwrap().download(&gpu).unwrap()
                };
                assert!(visibility(&cast.draws()) == expected, "{} {what} {counting:?}", mesh.name);
                // The injected fault: without its volumes nothing is dark but the sky.
                let unshadowed = visibility(&[]);
                assert!(unshadowed != expected, "{} {what} {counting:?}", mesh.name);
                let sky = mask.raw().len() - unshadowed.iter().filter(|&&lit| lit == 1.0).count();
                let seen = (0..64).flat_map(|y| (0..64).map(move |x| (x, y)));
                assert_eq!(sky, seen.filter(|&(x, y)| mask.count(x, y).is_none()).count());
            }
        }
    }
}

#[test]
fn stencil_pass_of_a_deforming_caster_counts_as_that_of_one_at_rest() {
    let Some(gpu) = gpu() else { return };
    let mesh = shapes::torus_knot(2, 3, 60, 8, 0.3);
    let topology = GpuTopology::upload(&gpu, Caster::new(mesh.clone()).topology()).unwrap();
    for depth in [Depth::Plane, Depth::Interpolated] {
        let pass = StencilPass::new(&gpu, depth).unwrap();
        let stage = Stage::new(&gpu, &pass, &mesh, Some(CasterFaces::All), 64);
        let vertices = stage.receivers.vertices().clone();
        let (largest, topology) = (stage.receivers.largest(), topology.clone());
        let deforming = GpuCaster::deforming(&gpu, vertices, largest, topology);
        let light = lights(&stage.caster.oracle().bounds())[0];
        let (_, projection) = projections(stage.caster.oracle(), &light, stage.size)[0];
        let casting = stage.cast(&light, &projection, Some(StencilMethod::ZFail));
        let cast = casting.upload(&gpu).unwrap();
        let mask = |receivers: &GpuCaster| {
            pass.mask(&projection, stage.size, receivers, &cast.draws(), Counting::Stencil).unwrap()
        };
        let moved = mask(&deforming);
        if depth == Depth::Plane {
            // Its normals are those of `f32`: the exact ray cast decides.
            assert!(stage.compare(&light, &projection, &casting.signs, &moved).agrees());
            assert!(moved.raw().iter().any(|&count| count != 0));
        } else {
            assert_eq!(moved, mask(&stage.receivers));
        }
        // The injected fault: vertices elsewhere.
        let shifted = shapes::translated(&mesh, [0.4, 0.0, 0.0]);
        let elsewhere = GpuCaster::upload(&gpu, &Caster::new(shifted)).unwrap();
        let elsewhere =
            GpuCaster::deforming(&gpu, elsewhere.vertices().clone(), largest, elsewhere.topology().clone());
        assert!(!stage.compare(&light, &projection, &casting.signs, &mask(&elsewhere)).agrees());
    }
}
