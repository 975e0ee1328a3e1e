//! A picture by stencil shadows: from a mesh and a view to pixels, and what can be said of each light.

use umbrage::geom::{Aabb, Projection};
use umbrage::gpu::{Gpu, GpuError};
use umbrage::mesh::Mesh;
use umbrage::picture::{LampShadow, Picture, View, render_stencil};
use umbrage::scene::Camera;
use umbrage::stencil::{Depth, Draw, Receivers, ShadowMask, StencilMethod, StencilPass};
use umbrage::topology::Topology;

use super::casting::{Casting, casting};

/// A mesh before an eye, with the volumes of each lamp.
pub(crate) struct Stage<'a> {
    mesh: &'a Mesh,
    view: View<'a>,
    pass: StencilPass,
    receivers: Receivers,
    pub(crate) projection: Projection,
    /// One a lamp.
    pub(crate) castings: Vec<Casting>,
}

impl<'a> Stage<'a> {
    /// `bounds` are those of what the eye looks at, without a ground.
    pub(crate) fn new(
        gpu: &Gpu,
        mesh: &'a Mesh,
        bounds: &Aabb,
        view: View<'a>,
        asked: Option<StencilMethod>,
    ) -> Result<Self, GpuError> {
        let projection = view.camera.projection(view.size, near(&view.camera, bounds));
        let topology = Topology::build(mesh.vertex_count(), mesh.triangles().to_vec());
        let casting = |light| casting(gpu, mesh, &topology, light, &projection, asked);
        let castings = view.lamps.iter().map(|lamp| casting(&lamp.light)).collect::<Result<_, _>>()?;
        let pass = StencilPass::new(gpu, Depth::Plane)?;
        let receivers = Receivers::upload(gpu, mesh)?;
        Ok(Self { mesh, view, pass, receivers, projection, castings })
    }

    /// The lit picture.
    pub(crate) fn picture(&self) -> Result<Picture, GpuError> {
        let draws: Vec<_> = self.castings.iter().map(draws).collect();
        let shadows: Vec<_> = draws
            .iter()
            .zip(&self.castings)
            .map(|(draws, casting)| LampShadow { draws, counting: casting.counting })
            .collect();
        render_stencil(&self.pass, self.mesh, &self.receivers, &self.view, &self.projection, &shadows)
    }

    /// What is counted for one lamp, without its light.
    pub(crate) fn mask(&self, casting: &Casting) -> Result<ShadowMask, GpuError> {
        self.pass.mask(&self.projection, self.view.size, &self.receivers, &draws(casting), casting.counting)
    }
}

fn draws(casting: &Casting) -> Vec<Draw<'_>> {
    casting.volumes.iter().map(|(volume, method)| Draw { volume, method: *method }).collect()
}

/// Closer than a 4096th of the way to the middle, or of the diagonal from within, nothing is seen.
fn near(camera: &Camera, bounds: &Aabb) -> f32 {
    let [x, y, z] = bounds.centre();
    let distance = f64::from(camera.eye.distance([x, y, z].into()));
    let reach = distance.max(bounds.diagonal()) / 4096.0;
    (reach as f32).clamp(f32::MIN_POSITIVE, f32::MAX)
}
