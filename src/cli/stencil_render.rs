//! Pictures with stencil shadows: from meshes and a view to pixels, with a description per light.

use umbrage::caster::{Caster, GpuCaster};
use umbrage::facing::CasterFaces;
use umbrage::gpu::{Gpu, GpuError};
use umbrage::render::{Picture, ShadedLight, View, render_visibility};
use umbrage::shadow::stencil::{
    Counting, Draw, GpuStencilVolumes, ReceiverTiles, ShadowMask, StencilMethod, StencilPass, StencilVolumes,
};
use umbrage::shadow::{Depth, GpuVisibility};
use umbrage::view::Projection;

/// The shadow of one lamp.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Shadowing {
    /// Counted in a stencil pass, by one method for all shells or by the right one for each.
    Counted(Option<StencilMethod>),
    /// None: light passes through everything.
    Lit,
}

/// A scene and a view, with the volumes of each lamp.
pub(crate) struct Stage<'a> {
    seen: &'a Caster,
    view: View<'a>,
    pass: StencilPass,
    on_device: GpuCaster,
    pub(crate) projection: Projection,
    /// One entry per lamp; `None` without a shadow.
    pub(crate) castings: Vec<Option<StencilVolumes>>,
    volumes: Vec<Option<GpuStencilVolumes>>,
}

/// Samples whose depth is read back, for 8 bytes each, so that volumes are drawn only where they may count.
const MOST_READ: usize = 1 << 24;

impl<'a> Stage<'a> {
    /// `seen` has the faces of `caster` and those that only receive; `shadows` has one entry per lamp. All
    /// faces cast: proving that half of them are enough takes longer than drawing the other half once.
    pub(crate) fn new(
        gpu: &Gpu,
        [caster, seen]: [&'a Caster; 2],
        view: View<'a>,
        shadows: &[Shadowing],
    ) -> Result<Self, GpuError> {
        let projection = view.camera.projection(view.size, view.camera.near([seen.mesh()], view.size));
        if projection.is_orthographic() {
            return Err(GpuError::NotBuilt("an orthographic camera"));
        }
        let cast = |lamp: &ShadedLight, asked| {
            caster.stencil_volumes(&lamp.light, &projection, Some(CasterFaces::All), asked)
        };
        let castings: Vec<_> = (view.lamps.iter().zip(shadows))
            .map(|(lamp, shadowing)| match *shadowing {
                Shadowing::Counted(asked) => Some(cast(lamp, asked)),
                Shadowing::Lit => None,
            })
            .collect();
        let upload = |casting: &Option<StencilVolumes>| {
            casting.as_ref().map(|it| it.upload_in_pieces(gpu, caster)).transpose()
        };
        let volumes = castings.iter().map(upload).collect::<Result<_, _>>()?;
        let pass = StencilPass::new(gpu, Depth::Plane)?;
        let on_device = GpuCaster::upload(gpu, seen)?;
        Ok(Self { seen, view, pass, on_device, projection, castings, volumes })
    }

    /// The volumes of a lamp on the device, and how their layers are counted; `None` without a shadow.
    fn counted(&self, lamp: usize) -> Option<(Vec<Draw<'_>>, Counting)> {
        Some((self.volumes[lamp].as_ref()?.draws(), self.castings[lamp].as_ref()?.counting()))
    }

    /// The lit picture.
    pub(crate) fn picture(&self) -> Result<Picture, GpuError> {
        let samples = self.view.samples(&self.on_device, &self.projection, self.pass.depth())?;
        let pass = match samples.size().pixels() <= MOST_READ {
            true => self.pass.within(ReceiverTiles::read(&samples)?),
            false => self.pass.clone(),
        };
        render_visibility(&samples, self.seen, &self.view, |lamp| match self.counted(lamp) {
            Some((draws, counting)) => pass.visibility(&samples, &draws, counting),
            None => GpuVisibility::constant(self.on_device.gpu(), samples.size(), 1.0),
        })
    }

    /// The counts of one lamp.
    pub(crate) fn mask(&self, lamp: usize) -> Result<ShadowMask, GpuError> {
        let (draws, counting) = self.counted(lamp).unwrap_or((Vec::new(), Counting::Stencil));
        self.pass.mask(&self.projection, self.view.size, &self.on_device, &draws, counting)
    }
}
