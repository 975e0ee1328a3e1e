//! From a mesh and a light to volumes that are ready to be counted, with the reason for every choice.

use super::{Asked, Counting, DepthComplexity, MethodPlan, ShellBoxes, StencilMethod, max_depth_complexity};
use crate::caster::ShellProof;
use crate::facing::FacePlanes;
use crate::geom::Light;
use crate::mesh::Mesh;
use crate::shadow::volume::{Caps, Faces, Plan, ShadowVolume};
use crate::silhouette::Silhouette;
use crate::topology::{Shells, Topology};
use crate::view::Projection;

/// A mesh prepared for many lights and cameras.
#[derive(Clone, Debug)]
pub struct Caster<'mesh> {
    mesh: &'mesh Mesh,
    topology: Topology,
    shells: Shells,
    boxes: ShellBoxes,
    planes: FacePlanes,
    proofs: Vec<ShellProof>,
    faces: Faces,
}

/// What a mesh casts from one light, for one camera.
#[derive(Clone, Debug)]
pub struct StencilVolumes {
    /// The sign that each face casts with: one entry a face.
    pub signs: Vec<i8>,
    /// Which faces cast, shell by shell.
    pub faces: Plan,
    /// How they are counted, shell by shell.
    pub methods: MethodPlan,
    /// How many casting faces a ray from the light can cross.
    pub layers: DepthComplexity,
    /// The volumes: one for the shells that z-pass is right for, without caps, one with caps for the others. A method
    /// without shells has none.
    pub volumes: Vec<(StencilMethod, ShadowVolume)>,
}

/// One more than eight bits can hold.
const STENCIL_LIMIT: u32 = 256;

impl<'mesh> Caster<'mesh> {
    /// Builds the topology of `mesh`, its planes, and what the choice of methods needs. With [`Faces::Auto`] the proofs
    /// that half the faces are enough take the longest, some microseconds a face; they pay where the mesh is drawn
    /// often.
    #[must_use]
    pub fn new(mesh: &'mesh Mesh, faces: Faces) -> Self {
        let topology = Topology::build_surveyed(mesh.vertex_count(), mesh.triangles().to_vec());
        let shells = topology.shells();
        let proofs = match faces {
            Faces::Auto => ShellProof::of(mesh, &topology, &shells),
            Faces::All | Faces::Front => Vec::new(),
        };
        let (boxes, planes) = (ShellBoxes::new(mesh, &shells), FacePlanes::new(mesh));
        Self { mesh, topology, shells, boxes, planes, proofs, faces }
    }

    /// The mesh.
    #[must_use]
    pub fn mesh(&self) -> &'mesh Mesh {
        self.mesh
    }

    /// Its edge table.
    #[must_use]
    pub fn topology(&self) -> &Topology {
        &self.topology
    }

    /// Decides which faces cast from `light` and how each shell is counted by a camera, and makes the volumes.
    #[must_use]
    pub fn cast(&self, light: &Light, projection: &Projection, asked: Asked) -> StencilVolumes {
        let faces = Plan::choose(self.mesh, &self.shells, &self.proofs, light, self.faces);
        let signs = faces.signs(&self.shells, &self.planes.classify(self.mesh, light));
        let methods = match asked {
            Asked::Auto => self.boxes.choose(self.mesh, projection, light),
            _ => MethodPlan::choose(self.mesh, &self.shells, projection, light, asked),
        };
        let volumes = [StencilMethod::ZPass, StencilMethod::ZFail]
            .into_iter()
            .filter(|&method| methods.count(method) > 0)
            .map(|method| (method, self.volume(light, &signs, &methods, method)))
            .collect();
        let layers = max_depth_complexity(self.mesh, &signs, light, STENCIL_LIMIT);
        StencilVolumes { signs, faces, methods, layers, volumes }
    }

    /// The volume of those shells that are counted by one method.
    fn volume(
        &self,
        light: &Light,
        signs: &[i8],
        methods: &MethodPlan,
        method: StencilMethod,
    ) -> ShadowVolume {
        let counted =
            |shell: Option<u32>| shell.is_some_and(|shell| methods.choices[shell as usize].method == method);
        let signs: Vec<i8> = self
            .shells
            .of_face
            .iter()
            .zip(signs)
            .map(|(&shell, &sign)| if counted(shell) { sign } else { 0 })
            .collect();
        let silhouette = Silhouette::extract(&self.topology, &signs);
        let caps = match method {
            StencilMethod::ZPass => Caps::None,
            StencilMethod::ZFail => Caps::Both,
        };
        ShadowVolume::extrude(self.mesh, &self.topology, light, &signs, &silhouette, caps)
    }
}

impl StencilVolumes {
    /// How the counts must be kept: in the stencil's eight bits wherever it is proven that they hold them.
    #[must_use]
    pub fn counting(&self) -> Counting {
        if self.layers.is_below() { Counting::Stencil } else { Counting::Integer }
    }
}

#[cfg(feature = "gpu")]
mod on_device {
    use super::StencilVolumes;
    use crate::gpu::{Gpu, GpuError};
    use crate::shadow::stencil::Draw;
    use crate::shadow::stencil::StencilMethod;
    use crate::shadow::volume::GpuVolume;

    /// The volumes of a [`StencilVolumes`] on the device.
    #[derive(Clone, Debug)]
    pub struct GpuStencilVolumes {
        volumes: Vec<(StencilMethod, GpuVolume)>,
    }

    impl StencilVolumes {
        /// Copies the volumes to the device.
        ///
        /// # Errors
        ///
        /// As [`GpuVolume::upload`].
        pub fn upload(&self, gpu: &Gpu) -> Result<GpuStencilVolumes, GpuError> {
            let upload = |(method, volume): &(_, _)| Ok((*method, GpuVolume::upload(gpu, volume)?));
            Ok(GpuStencilVolumes { volumes: self.volumes.iter().map(upload).collect::<Result<_, _>>()? })
        }
    }

    impl GpuStencilVolumes {
        /// What a stencil pass draws.
        #[must_use]
        pub fn draws(&self) -> Vec<Draw<'_>> {
            self.volumes.iter().map(|(method, volume)| Draw { volume, method: *method }).collect()
        }
    }
}

#[cfg(feature = "gpu")]
pub use on_device::GpuStencilVolumes;
