//! From a caster and a light to volumes that are ready to be counted, with the reason for every choice.

use super::{Counting, DepthComplexity, ShellMethods, StencilMethod, max_depth_complexity};
use crate::caster::Caster;
use crate::facing::CasterFaces;
use crate::geom::Light;
use crate::shadow::volume::{Caps, ShadowVolume, ShellFaces};
use crate::view::Projection;

/// What a mesh casts from one light, for one camera.
#[derive(Clone, Debug)]
pub struct StencilVolumes {
    /// The sign that each face casts with: one entry a face.
    pub signs: Vec<i8>,
    /// Which faces cast, shell by shell.
    pub faces: ShellFaces,
    /// How they are counted, shell by shell.
    pub methods: ShellMethods,
    /// How many casting faces a ray from the light can cross.
    pub layers: DepthComplexity,
    /// The volumes: one for the shells that z-pass is right for, without caps, one with caps for the others. A method
    /// without shells has none.
    pub volumes: Vec<(StencilMethod, ShadowVolume)>,
}

/// One more than eight bits can hold.
const STENCIL_LIMIT: u32 = 256;

impl Caster {
    /// Decides which faces cast from `light` and how each shell is counted by a camera, and makes the volumes.
    ///
    /// `faces` and `method` are used as they are if they are asked for, proven or not. Without `faces` half of them cast
    /// where that is proven to be enough, which takes [`Caster::proofs`]; without `method` z-pass counts the shells
    /// that it is proven right for.
    ///
    /// ```
    /// use umbrage::caster::Caster;
    /// use umbrage::shadow::stencil::StencilMethod;
    /// use umbrage::testing::shapes;
    /// use umbrage::view::Projection;
    /// let (right, up, forward) = ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]);
    /// let camera = Projection { eye: [0.0, 0.0, 5.0], right, up, forward, near: 0.1 };
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

    /// The volume of those shells that are counted by one method.
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
