//! Pictures with stencil shadows: from a mesh and a view to pixels, with a description per light.

use umbrage::caster::Caster;
use umbrage::facing::CasterFaces;
use umbrage::geom::Aabb;
use umbrage::gpu::{Gpu, GpuError};
use umbrage::render::{LampShadow, Picture, View, render_stencil};
use umbrage::shadow::stencil::{
    Depth, GpuStencilVolumes, Receivers, ShadowMask, StencilMethod, StencilPass, StencilVolumes,
};
use umbrage::view::Projection;

/// A mesh and a view, with the volumes of each lamp.
pub(crate) struct Stage<'a> {
    caster: &'a Caster,
    view: View<'a>,
    pass: StencilPass,
    receivers: Receivers,
    pub(crate) projection: Projection,
    /// One entry per lamp.
    pub(crate) castings: Vec<StencilVolumes>,
    on_device: Vec<GpuStencilVolumes>,
}

impl<'a> Stage<'a> {
    /// `bounds` are those of the mesh without a ground. All faces cast: proving that half of them are enough
    /// takes longer than drawing the other half once.
    pub(crate) fn new(
        gpu: &Gpu,
        caster: &'a Caster,
        bounds: &Aabb,
        view: View<'a>,
        asked: Option<StencilMethod>,
    ) -> Result<Self, GpuError> {
        let projection = view.camera.projection(view.size, view.camera.near(bounds, view.size));
        if projection.is_orthographic() {
            return Err(GpuError::NotBuilt("an orthographic camera"));
        }
        let castings: Vec<_> = (view.lamps.iter())
            .map(|lamp| caster.stencil_volumes(&lamp.light, &projection, Some(CasterFaces::All), asked))
            .collect();
        let on_device = castings.iter().map(|casting| casting.upload(gpu)).collect::<Result<_, _>>()?;
        let pass = StencilPass::new(gpu, Depth::Plane)?;
        let receivers = Receivers::upload(gpu, caster)?;
        Ok(Self { caster, view, pass, receivers, projection, castings, on_device })
    }

    /// The lit picture.
    pub(crate) fn picture(&self) -> Result<Picture, GpuError> {
        let draws: Vec<_> = self.on_device.iter().map(GpuStencilVolumes::draws).collect();
        let shadows: Vec<_> = draws
            .iter()
            .zip(&self.castings)
            .map(|(draws, casting)| LampShadow { draws, counting: casting.counting() })
            .collect();
        render_stencil(&self.pass, self.caster, &self.receivers, &self.view, &self.projection, &shadows)
    }

    /// Description of how one lamp is counted, without the lamp itself.
    pub(crate) fn mask(&self, lamp: usize) -> Result<ShadowMask, GpuError> {
        let (draws, counting) = (self.on_device[lamp].draws(), self.castings[lamp].counting());
        self.pass.mask(&self.projection, self.view.size, &self.receivers, &draws, counting)
    }
}
