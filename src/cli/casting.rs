//! Which volumes stand for the shadow of a light in a stencil pass, and how they are counted.

use umbrage::geom::{Light, Projection};
use umbrage::gpu::{Gpu, GpuError};
use umbrage::mesh::Mesh;
use umbrage::silhouette::{Casters, Silhouette, classify};
use umbrage::stencil::{Counting, StencilMethod};
use umbrage::topology::Topology;
use umbrage::volume::{Caps, GpuVolume, ShadowVolume};

use super::output::counted;

/// The volumes of one light.
pub(crate) struct Casting {
    /// Each with its method.
    pub(crate) volumes: Vec<(GpuVolume, StencilMethod)>,
    pub(crate) counting: Counting,
    /// The sign that each face casts with.
    pub(crate) signs: Vec<i8>,
    /// Which method counts how many shells, and why.
    pub(crate) said: String,
}

/// The volumes of `light` for an eye, all of them counted as `asked`, or as is right for that eye.
pub(crate) fn casting(
    gpu: &Gpu,
    mesh: &Mesh,
    topology: &Topology,
    light: &Light,
    _projection: &Projection,
    asked: Option<StencilMethod>,
) -> Result<Casting, GpuError> {
    let signs = Casters::All.signs(&classify(mesh, light));
    let silhouette = Silhouette::extract(topology, &signs);
    let volume = ShadowVolume::extrude(mesh, topology, light, &signs, &silhouette, Caps::Both);
    let volume = GpuVolume::upload(gpu, &volume)?;
    // As many volumes as there are faces can lie over each other, and eight bits hold 255.
    let counting = if mesh.face_count() < 256 { Counting::Stencil } else { Counting::Integer };
    let (method, name, reason) = match asked {
        Some(StencilMethod::ZPass) => {
            (StencilMethod::ZPass, "zpass", "asked for; wrong where the eye is in a shadow")
        }
        Some(StencilMethod::ZFail) => (StencilMethod::ZFail, "zfail", "asked for"),
        None => (StencilMethod::ZFail, "zfail", "right wherever the eye is"),
    };
    let shells = counted(topology.shells().count, "shell", "shells");
    Ok(Casting {
        volumes: vec![(volume, method)],
        counting,
        signs,
        said: format!("{name} for {shells}: {reason}"),
    })
}
