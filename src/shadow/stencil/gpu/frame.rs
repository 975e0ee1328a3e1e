//! The pass in somebody else's frame: recorded into the caller's encoder, with nothing submitted and nothing waited for.

use super::pipelines::{Drawing, VolumeBuffers};
use super::{Draw, Pipelines, Receivers, StencilPass};
use crate::gpu::raster::FORMAT;
use crate::gpu::{GpuError, wgpu};
use crate::shadow::stencil::StencilMethod;
use crate::shadow::volume::Part;
use crate::view::Projection;
use crate::view::Size;

/// What one camera sees of receivers and volumes, ready to be drawn in a render pass of the caller's.
///
/// The pass has no color attachment and a depth-stencil attachment of [`StencilFrame::FORMAT`] with one sample, cleared
/// to depth 0 (infinitely far: depth is reversed) and stencil 0. Afterwards the stencil of a pixel is how many volumes
/// its visible point is in, modulo 256; light it where that is 0.
#[derive(Clone, Debug)]
pub struct StencilFrame {
    pipelines: Pipelines,
    receivers: wgpu::BindGroup,
    triangles: wgpu::Buffer,
    corners: u32,
    volumes: Vec<(StencilMethod, wgpu::BindGroup, VolumeBuffers)>,
}

impl StencilPass {
    /// Prepares a frame for a picture of `size`. The volumes may be ones that earlier commands of the same encoder write.
    ///
    /// # Errors
    ///
    /// [`GpuError::OutOfMemory`], [`GpuError::Lost`].
    pub fn prepare(
        &self,
        projection: &Projection,
        size: Size,
        receivers: &Receivers,
        volumes: &[Draw<'_>],
    ) -> Result<StencilFrame, GpuError> {
        let frame = self.gpu.uniform(&self.frame(projection, size, receivers)?)?;
        let bind = |draw: &Draw<'_>| {
            let (bind, _) = self.bind_volume(projection, size, draw.volume)?;
            Ok((draw.method, bind, draw.volume.into()))
        };
        Ok(StencilFrame {
            pipelines: self.pipelines.clone(),
            receivers: self.bind_receivers(&frame, receivers)?,
            triangles: receivers.triangles.clone(),
            corners: receivers.corners,
            volumes: volumes.iter().map(bind).collect::<Result<_, _>>()?,
        })
    }
}

impl StencilFrame {
    /// The format of the depth-stencil attachment.
    pub const FORMAT: wgpu::TextureFormat = FORMAT;

    /// Draws the receivers' depth. Leave it out if the attachment holds it already, reversed and of this projection; then
    /// every caster must have been drawn, both of its sides.
    pub fn draw_receivers(&self, pass: &mut wgpu::RenderPass<'_>) {
        pass.set_bind_group(0, &self.receivers, &[]);
        self.pipelines.receivers.all(pass, &self.triangles, self.corners);
    }

    /// Counts the volumes, after the depth is there.
    pub fn draw_volumes(&self, pass: &mut wgpu::RenderPass<'_>) {
        let pipelines = &self.pipelines;
        for (method, bind, volume) in &self.volumes {
            draw_volume(pass, *method, bind, volume, pipelines.stencil());
        }
    }
}

/// Draws the parts of one volume that its method asks for, with the pipelines for z-pass sides, z-fail sides and caps.
pub(super) fn draw_volume(
    pass: &mut wgpu::RenderPass<'_>,
    method: StencilMethod,
    bind: &wgpu::BindGroup,
    volume: &VolumeBuffers,
    [zpass, zfail, caps]: [&Drawing; 3],
) {
    pass.set_bind_group(0, bind, &[]);
    match method {
        StencilMethod::ZPass => zpass.part(pass, volume, Part::Sides),
        StencilMethod::ZFail => {
            zfail.part(pass, volume, Part::Sides);
            caps.part(pass, volume, Part::LightCap);
            caps.part(pass, volume, Part::DarkCap);
        }
    }
}
