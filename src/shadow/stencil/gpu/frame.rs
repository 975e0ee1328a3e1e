//! Recording the pass into the caller's encoder: nothing is submitted, and nothing waits.

use std::ops::Range;

use super::{Draw, Pipelines, StencilPass};
use crate::caster::GpuCaster;
use crate::gpu::raster::{Drawing, FORMAT};
use crate::gpu::{Gpu, GpuError, wgpu};
use crate::shadow::stencil::StencilMethod;
use crate::shadow::stencil::scissor::PixelRectangle;
use crate::shadow::volume::{GpuVolume, Part};
use crate::view::{Projection, Size};

/// The draws of one camera, for a render pass of the caller's.
///
/// The pass has no color attachment and a depth-stencil attachment of [`StencilFrame::FORMAT`] with one
/// sample, cleared to depth 0 (infinitely far: depth is reversed) and stencil 0. Afterwards the stencil of a
/// pixel is the number of volumes that its visible point is in, modulo 256; light the pixel where that is 0.
#[derive(Clone, Debug)]
pub struct StencilFrame {
    pipelines: Pipelines,
    receivers: wgpu::BindGroup,
    triangles: wgpu::Buffer,
    corners: u32,
    volumes: Vec<(StencilMethod, wgpu::BindGroup, GpuVolume)>,
}

impl StencilPass {
    /// Prepares a frame for a picture of `size`. Earlier commands of the same encoder may write the volumes.
    ///
    /// # Errors
    ///
    /// [`GpuError::Subnormal`] if the receivers are too small to be drawn, [`GpuError::OutOfMemory`],
    /// [`GpuError::Lost`].
    pub fn prepare(
        &self,
        projection: &Projection,
        size: Size,
        receivers: &GpuCaster,
        volumes: &[Draw<'_>],
    ) -> Result<StencilFrame, GpuError> {
        let receivers = receivers.receivers()?;
        let frame = self.gpu.uniform(&receivers.frame(projection, size)?)?;
        let bind = |draw: &Draw<'_>| {
            let frame = self.volume_frame(projection, size, draw.volume)?;
            Ok((draw.method, self.bind_volume(&frame, draw.volume)?, draw.volume.clone()))
        };
        Ok(StencilFrame {
            pipelines: self.pipelines.clone(),
            receivers: self.gpu.bind_group(&self.pipelines.receivers.layout, receivers.bindings(&frame))?,
            triangles: receivers.triangles,
            corners: receivers.corners,
            volumes: volumes.iter().map(bind).collect::<Result<_, _>>()?,
        })
    }
}

impl StencilFrame {
    /// The format of the depth-stencil attachment.
    pub const FORMAT: wgpu::TextureFormat = FORMAT;

    /// An attachment for [`StencilFrame::record`], for those who have none.
    ///
    /// # Errors
    ///
    /// [`GpuError::Picture`] if the device has no textures of this size, [`GpuError::OutOfMemory`].
    pub fn attachment(gpu: &Gpu, size: Size) -> Result<wgpu::Texture, GpuError> {
        Ok(gpu.texture("depth and stencil", size, FORMAT)?.texture)
    }

    /// Draws receivers and volumes in a render pass of its own, which clears the attachment first.
    pub fn record(&self, encoder: &mut wgpu::CommandEncoder, attachment: &wgpu::TextureView) {
        let store = wgpu::StoreOp::Store;
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: attachment,
                depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(0.0), store }),
                stencil_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(0), store }),
            }),
            ..wgpu::RenderPassDescriptor::default()
        });
        self.draw_receivers(&mut pass);
        self.draw_volumes(&mut pass);
    }

    /// Draws the receivers' depth. Leave it out if the attachment holds the depth already, reversed and of
    /// this projection; then both sides of every caster must have been drawn.
    pub fn draw_receivers(&self, pass: &mut wgpu::RenderPass<'_>) {
        self.pipelines.receivers.draw(pass, &self.receivers, &self.triangles, self.corners);
    }

    /// Counts the volumes, after the depth is drawn.
    pub fn draw_volumes(&self, pass: &mut wgpu::RenderPass<'_>) {
        let pipelines = &self.pipelines;
        for (method, bind, volume) in &self.volumes {
            draw_volume(pass, *method, bind, volume, pipelines.stencil());
        }
    }
}

/// Some corners of each part of a volume, and where in the picture they are drawn.
#[derive(Clone, Debug)]
pub(super) struct Scissored {
    pub(super) corners: Vec<[Range<u32>; 3]>,
    pub(super) rectangles: Vec<PixelRectangle>,
}

/// Draws the pieces of one volume, each within its rectangles; then the whole picture is drawn into again.
pub(super) fn draw_within(
    pass: &mut wgpu::RenderPass<'_>,
    draw: &Draw<'_>,
    scissored: &[Scissored],
    [zpass, zfail, caps]: [&Drawing; 3],
    size: Size,
) {
    let [sides, caps] = match draw.method {
        StencilMethod::ZPass => [zpass, caps],
        StencilMethod::ZFail => [zfail, caps],
    };
    for part in Part::ALL {
        let drawing = if part == Part::Sides { sides } else { caps };
        if draw.method == StencilMethod::ZPass && part != Part::Sides {
            continue;
        }
        for Scissored { corners, rectangles } in scissored {
            for rect in rectangles {
                pass.set_scissor_rect(rect.x, rect.y, rect.width, rect.height);
                for corners in corners.iter().map(|parts| parts[part as usize].clone()) {
                    if !corners.is_empty() {
                        drawing.some(pass, draw.volume.triangles(), corners);
                    }
                }
            }
        }
    }
    pass.set_scissor_rect(0, 0, size.width(), size.height());
}

/// Draws the parts of one volume that its method asks for, with the pipelines for z-pass sides, z-fail sides
/// and caps.
pub(super) fn draw_volume(
    pass: &mut wgpu::RenderPass<'_>,
    method: StencilMethod,
    bind: &wgpu::BindGroup,
    volume: &GpuVolume,
    [zpass, zfail, caps]: [&Drawing; 3],
) {
    pass.set_bind_group(0, bind, &[]);
    match method {
        StencilMethod::ZPass => draw_part(pass, zpass, volume, Part::Sides),
        StencilMethod::ZFail => {
            draw_part(pass, zfail, volume, Part::Sides);
            draw_part(pass, caps, volume, Part::LightCap);
            draw_part(pass, caps, volume, Part::DarkCap);
        }
    }
}

/// Draws a part of a volume whose bindings are set.
pub(super) fn draw_part(pass: &mut wgpu::RenderPass<'_>, drawing: &Drawing, volume: &GpuVolume, part: Part) {
    drawing.indirect(pass, volume.triangles(), volume.arguments(), part.offset());
}
