//! Shadow volumes of a caster, ready for stencil counting, with the reason for every choice.

use super::{Counting, DepthComplexity, ShellMethods, StencilMethod, max_depth_complexity};
use crate::caster::Caster;
use crate::facing::CasterFaces;
use crate::geom::Light;
use crate::shadow::volume::{Caps, ShadowVolume, ShellFaces};
use crate::view::Projection;

/// The shadow volumes of a mesh for one light and one camera.
#[derive(Clone, Debug)]
pub struct StencilVolumes {
    /// The casting sign of each face: one entry per face.
    pub signs: Vec<i8>,
    /// The choice of casting faces, per shell.
    pub faces: ShellFaces,
    /// The choice of counting method, per shell.
    pub methods: ShellMethods,
    /// Bound of the number of casting faces that a ray from the light can cross.
    pub layers: DepthComplexity,
    /// The volumes: one without caps for the z-pass shells, one with both caps for the z-fail shells. A
    /// method without shells has no volume.
    pub volumes: Vec<(StencilMethod, ShadowVolume)>,
}

/// Number of values of an eight-bit stencil: counts below this number cannot wrap.
const STENCIL_LIMIT: u32 = 256;

impl Caster {
    /// Chooses the casting faces for `light` and the counting method of each shell for a camera, and builds
    /// the volumes.
    ///
    /// `faces` and `method`, if given, are used as they are, proven or not. Without `faces`, half of a
    /// shell's faces cast if this is proven to be enough, which requires [`Caster::proofs`]. Without
    /// `method`, z-pass counts the shells for which z-pass is proven correct.
    ///
    /// ```
    /// use umbrage::caster::Caster;
    /// use umbrage::shadow::stencil::StencilMethod;
    /// use umbrage::testing::shapes;
    /// use umbrage::view::{Projection, ProjectionKind};
    /// let (right, up, forward) = ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]);
    /// let kind = ProjectionKind::InfinitePerspective;
    /// let camera = Projection { eye: [0.0, 0.0, 5.0], right, up, forward, near: 0.1, kind };
    /// let caster = Caster::new(shapes::cube());
    /// let shadow = caster.stencil_volumes(&"point:0,9,5".parse()?, &camera, None, None);
    /// assert_eq!(shadow.methods.choices[0].what, StencilMethod::ZPass);
    /// # Ok::<(), umbrage::geom::LightError>(())
    /// ```
    #[must_use]
    pub fn stencil_volumes(
        &self,
        light: &Light,
        projection: &Projection,
        faces: Option<CasterFaces>,
        method: Option<StencilMethod>,
    ) -> StencilVolumes {
        let faces = self.shell_faces(light, faces);
        let signs = faces.signs(self.shells(), &self.facing(light));
        let methods = match method {
            None => self.shell_boxes().choose(self.mesh(), projection, light),
            Some(method) => ShellMethods::all(method, self.shells().count),
        };
        let volumes = StencilMethod::ALL
            .into_iter()
            .filter(|&method| methods.count(method) > 0)
            .map(|method| (method, self.counted_volume(light, &signs, &methods, method)))
            .collect();
        let layers = max_depth_complexity(self.mesh(), &signs, light, STENCIL_LIMIT);
        StencilVolumes { signs, faces, methods, layers, volumes }
    }

    /// The volume of the shells counted by one method.
    fn counted_volume(
        &self,
        light: &Light,
        signs: &[i8],
        methods: &ShellMethods,
        method: StencilMethod,
    ) -> ShadowVolume {
        let signs = methods.signs_of(method, self.shells(), signs);
        let caps = match method {
            StencilMethod::ZPass => Caps::None,
            StencilMethod::ZFail => Caps::Both,
        };
        self.volume_of_signs(light, &signs, caps)
    }
}

impl StencilVolumes {
    /// The storage that the counts need: the stencil's eight bits if the counts are proven to fit, otherwise
    /// integers.
    ///
    /// ```
    /// use umbrage::caster::Caster;
    /// use umbrage::shadow::stencil::Counting;
    /// use umbrage::testing::shapes;
    /// use umbrage::view::{Projection, ProjectionKind};
    ///
    /// let (right, up, forward) = ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]);
    /// let (eye, kind) = ([0.0, 0.0, 5.0], ProjectionKind::default());
    /// let camera = Projection { eye, right, up, forward, near: 0.1, kind };
    /// let cube = Caster::new(shapes::cube());
    /// let shadow = cube.stencil_volumes(&"point:0,9,5".parse()?, &camera, None, None);
    /// assert_eq!(shadow.counting(), Counting::Stencil); // a ray crosses at most 12 faces
    /// # Ok::<(), umbrage::geom::LightError>(())
    /// ```
    #[must_use]
    pub fn counting(&self) -> Counting {
        if self.layers.is_below() { Counting::Stencil } else { Counting::Integer }
    }
}

#[cfg(feature = "gpu")]
mod on_device {
    use super::StencilVolumes;
    use crate::caster::Caster;
    use crate::gpu::{Gpu, GpuError};
    use crate::shadow::stencil::{Draw, StencilMethod};
    use crate::shadow::volume::{GpuVolume, VolumePieces};

    /// Device copy of the volumes of a [`StencilVolumes`].
    #[derive(Clone, Debug)]
    pub struct GpuStencilVolumes {
        volumes: Vec<(StencilMethod, GpuVolume)>,
    }

    impl StencilVolumes {
        /// Copies the volumes of `caster` to the device, in connected pieces that can be drawn apart
        /// ([`StencilPass::within`](crate::shadow::stencil::StencilPass::within)).
        ///
        /// # Errors
        ///
        /// Those of [`GpuVolume::upload`].
        ///
        /// # Panics
        ///
        /// Panics if the volumes are those of another mesh.
        pub fn upload_in_pieces(&self, gpu: &Gpu, caster: &Caster) -> Result<GpuStencilVolumes, GpuError> {
            let upload = |(method, volume): &(_, _)| {
                let signs = self.methods.signs_of(*method, caster.shells(), &self.signs);
                let pieces = VolumePieces::of(caster.mesh(), &signs, volume);
                Ok((*method, GpuVolume::upload_in_pieces(gpu, volume, &pieces)?))
            };
            Ok(GpuStencilVolumes { volumes: self.volumes.iter().map(upload).collect::<Result<_, _>>()? })
        }

        /// Copies the volumes to the device.
        ///
        /// # Errors
        ///
        /// Those of [`GpuVolume::upload`].
        pub fn upload(&self, gpu: &Gpu) -> Result<GpuStencilVolumes, GpuError> {
            let upload = |(method, volume): &(_, _)| Ok((*method, GpuVolume::upload(gpu, volume)?));
            Ok(GpuStencilVolumes { volumes: self.volumes.iter().map(upload).collect::<Result<_, _>>()? })
        }
    }

    impl GpuStencilVolumes {
        /// The draw calls of a stencil pass.
        #[must_use]
        pub fn draws(&self) -> Vec<Draw<'_>> {
            self.volumes.iter().map(|(method, volume)| Draw { volume, method: *method }).collect()
        }
    }
}

#[cfg(feature = "gpu")]
pub use on_device::GpuStencilVolumes;
