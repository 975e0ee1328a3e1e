//! Stencil counting on a graphics adapter, at the samples of the CPU.

use umbrage::caster::{Caster, CasterGroup, GpuCaster};
use umbrage::facing::CasterFaces;
use umbrage::gpu::{Gpu, GpuError};
use umbrage::scene::Lamp;
use umbrage::shadow::stencil::{ReceiverTiles, StencilMethod, StencilPass};
use umbrage::shadow::{Claim, Depth, Samples, Technique, Visibility};
use umbrage::view::Size;

/// A scene on an adapter.
pub(super) struct Device {
    gpu: Gpu,
    pass: StencilPass,
    seen: GpuCaster,
}

/// How a technique counts on the adapter, if it does: by one method for all shells, or by the right one for
/// each.
pub(super) fn method(technique: Technique) -> Option<Option<StencilMethod>> {
    match technique {
        Technique::Stencil => Some(None),
        Technique::ZFail => Some(Some(StencilMethod::ZFail)),
        Technique::ZPass => Some(Some(StencilMethod::ZPass)),
        _ => None,
    }
}

impl Device {
    /// The adapter with what is seen of a scene.
    pub(super) fn new(gpu: &Gpu, seen: &Caster) -> Result<Self, GpuError> {
        let pass = StencilPass::new(gpu, Depth::Plane)?;
        Ok(Self { gpu: gpu.clone(), pass, seen: GpuCaster::upload(gpu, seen)? })
    }

    pub(super) fn name(&self) -> String {
        self.gpu.name()
    }

    /// Fraction of the lamp that reaches each sample: all faces cast.
    pub(super) fn visibility(
        &self,
        casters: &CasterGroup<'_>,
        lamp: &Lamp,
        samples: &Samples,
        method: Option<StencilMethod>,
    ) -> Result<Visibility, GpuError> {
        let [caster] = casters.casters() else { return Err(GpuError::NotBuilt("several casters")) };
        if samples.projection().is_orthographic() {
            return Err(GpuError::NotBuilt("an orthographic camera"));
        }
        let light = lamp.light();
        let side = |side: u32| side.saturating_mul(samples.per_side());
        let size = Size::new(side(samples.size().width()), side(samples.size().height()));
        let size = size.map_err(|_| GpuError::NotBuilt("so large a picture"))?;
        let volumes = caster.stencil_volumes(light, samples.projection(), Some(CasterFaces::All), method);
        let uploaded = volumes.upload_in_pieces(&self.gpu, caster)?;
        let drawn = self.seen.samples(samples.projection(), size, Depth::Plane)?;
        let pass = self.pass.within(ReceiverTiles::facing(samples, light));
        let found = pass.visibility(&drawn, &uploaded.draws(), volumes.counting())?;
        let values = found.download(&self.gpu)?;
        Ok(Visibility::from_values(samples, light, values, Claim::WithinFootprint))
    }
}
