//! Pictures with stencil shadows: from a mesh and a view to pixels, with a description per light.

use umbrage::caster::{Caster, GpuCaster};
use umbrage::facing::CasterFaces;
use umbrage::gpu::{Gpu, GpuError};
use umbrage::render::{Picture, View, render_visibility};
use umbrage::shadow::Depth;
use umbrage::shadow::stencil::{GpuStencilVolumes, ShadowMask, StencilMethod, StencilPass, StencilVolumes};
use umbrage::view::Projection;

/// A mesh and a view, with the volumes of each lamp.
pub(crate) struct Stage<'a> {
    caster: &'a Caster,
    view: View<'a>,
    pass: StencilPass,
    on_device: GpuCaster,
    pub(crate) projection: Projection,
    /// One entry per lamp.
    pub(crate) castings: Vec<StencilVolumes>,
    volumes: Vec<GpuStencilVolumes>,
}

impl<'a> Stage<'a> {
    /// All faces cast: proving that half of them are enough
    /// takes longer than drawing the other half once.
    pub(crate) fn new(
        gpu: &Gpu,
        caster: &'a Caster,
        view: View<'a>,
        asked: Option<StencilMethod>,
    ) -> Result<Self, GpuError> {
        let projection = view.camera.projection(view.size, view.camera.near([caster.mesh()], view.size));
        if projection.is_orthographic() {
            return Err(GpuError::NotBuilt("an orthographic camera"));
        }
        let castings: Vec<_> = (view.lamps.iter())
            .map(|lamp| caster.stencil_volumes(&lamp.light, &projection, Some(CasterFaces::All), asked))
            .collect();
        let volumes = castings.iter().map(|casting| casting.upload(gpu)).collect::<Result<_, _>>()?;
        let pass = StencilPass::new(gpu, Depth::Plane)?;
        let on_device = GpuCaster::upload(gpu, caster)?;
        Ok(Self { caster, view, pass, on_device, projection, castings, volumes })
    }

    /// The lit picture.
    pub(crate) fn picture(&self) -> Result<Picture, GpuError> {
        let samples = self.view.samples(&self.on_device, &self.projection, self.pass.depth())?;
        render_visibility(&samples, self.caster, &self.view, |lamp| {
            self.pass.visibility(&samples, &self.volumes[lamp].draws(), self.castings[lamp].counting())
        })
    }

    /// The counts of one lamp.
    pub(crate) fn mask(&self, lamp: usize) -> Result<ShadowMask, GpuError> {
        let (draws, counting) = (self.volumes[lamp].draws(), self.castings[lamp].counting());
        self.pass.mask(&self.projection, self.view.size, &self.on_device, &draws, counting)
    }
}
