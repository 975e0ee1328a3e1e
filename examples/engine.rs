//! An engine's two paths, headless: arrays of its own and a moving light; first into its own index buffer on the
//! processor, then on a device in its own command encoder. Run it by `cargo run --release --example engine`.

use std::time::Instant;

use umbrage::caster::{Caster, GpuCaster};
use umbrage::geom::Light;
use umbrage::gpu::{Gpu, wgpu};
use umbrage::shadow::Depth;
use umbrage::shadow::stencil::{Draw, StencilFrame, StencilMethod, StencilPass};
use umbrage::shadow::volume::{Caps, FrameExtruder, GpuExtrusion, VolumeShaders};
use umbrage::view::{Camera, Size, Up};

const FRAMES: u32 = 100;

/// 400 boxes on a plane, as an engine has them: positions and three indices per triangle.
fn arrays() -> (Vec<[f32; 3]>, Vec<u32>) {
    const BOX: [[u32; 4]; 6] =
        [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let (mut positions, mut indices) = (Vec::new(), Vec::new());
    for i in 0..400_u16 {
        let (first, [x, z]) = (positions.len() as u32, [i % 20, i / 20].map(|i| 2.0 * f32::from(i)));
        let corner = |k: u8| [x + f32::from(k & 1), f32::from(k >> 1 & 1), z + f32::from(k >> 2)];
        positions.extend((0..8).map(corner));
        indices.extend(BOX.iter().flat_map(|&[a, b, c, d]| [a, b, c, a, c, d]).map(|v| first + v));
    }
    (positions, indices)
}

fn light(frame: u32) -> Light {
    Light::point([20.0 + 0.01 * frame as f32, 30.0, -15.0]).expect("finite")
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let (positions, indices) = arrays();
    let caster = Caster::from_indexed(&positions, &indices)?;

    // 1. On the processor. Upload `caster.mesh().positions()` and the static triangles once; per frame write the rest.
    let mut extruder = FrameExtruder::new(&caster, None);
    let mut buffer = vec![[0; 3]; 4 * caster.mesh().face_count()];
    let (start, mut triangles) = (Instant::now(), 0);
    for frame in 0..FRAMES {
        triangles += extruder.write(&caster, &light(frame), Caps::Both, &mut buffer)?.triangle_count();
    }
    let (each, time) = (triangles / FRAMES as usize, start.elapsed() / FRAMES);
    println!("processor: {each} triangles a frame, {time:.1?}; silhouette {:?}", extruder.method().map(|m| m.what));

    // 2. On a device: yours, by `Gpu::from_device(device, queue)`; here any.
    let gpu = Gpu::new(None)?;
    let (shaders, pass) = (VolumeShaders::new(&gpu)?, StencilPass::new(&gpu, Depth::Plane)?);
    let on_device = GpuCaster::upload(&gpu, &caster)?;
    let extrusion = GpuExtrusion::new(&shaders, &on_device, Caps::Both, None)?;
    let size = Size::new(256, 256)?;
    let camera = Camera::look_at([20.0, 25.0, 60.0], [20.0, 0.0, 20.0], 0.8, Up::Y)?.projection(size, 0.1);
    let target = gpu.device().create_texture(&wgpu::TextureDescriptor {
        label: None,
        size: wgpu::Extent3d { width: 256, height: 256, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: StencilFrame::FORMAT,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT,
        view_formats: &[],
    });
    let (view, store) = (target.create_view(&Default::default()), wgpu::StoreOp::Store);
    for frame in 0..3 {
        let mut encoder = gpu.device().create_command_encoder(&Default::default());
        let volume = extrusion.record(&mut encoder, &light(frame))?;
        let draws = [Draw { volume: &volume, method: StencilMethod::ZFail }];
        let drawn = pass.prepare(&camera, size, &on_device, &draws)?;
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &view,
                depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(0.0), store }),
                stencil_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(0), store }),
            }),
            ..Default::default()
        });
        drawn.draw_receivers(&mut pass); // or your own depth, reversed; then light what has stencil 0
        drawn.draw_volumes(&mut pass);
        drop(pass);
        gpu.queue().submit([encoder.finish()]);
    }
    println!("device: {}, every volume fits: {}", gpu.name(), extrusion.download_demand()?.exceeded == 0);
    Ok(())
}
