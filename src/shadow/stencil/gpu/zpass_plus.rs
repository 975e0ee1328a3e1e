//! z-pass that starts with the counts of the near rectangle: the device form of `zpass-plus`.
//!
//! The casting faces between the light and the near rectangle are drawn first, seen from the light on the
//! near plane. (Samuel Hornus, Jared Hoberock, Sylvain Lefebvre, John C. Hart, *ZP+: Correct Z-pass Stencil
//! Shadows*, I3D 2005.) This projection and that of the sides round the same line differently: where sides
//! cut the near rectangle, a band one pixel wide is wrong. (Baran Usta, Leonardo Scandolo, Markus Billeter,
//! Ricardo Marroquim, Elmar Eisemann, *A Practical and Efficient Approach for Correct Z-Pass Stencil Shadow
//! Volumes*, HPG 2019.) A face that is nearer to a point light than 2⁻²⁴ of the way is left out. z-fail has
//! neither fault.

use wgpu::{CompareFunction, StencilFaceState, StencilOperation};

use super::pipelines::module;
use super::{StencilPass, frame};
use crate::gpu::raster::{Depth, Drawing, GpuVisibility, Pipeline, depth_stencil, everywhere};
use crate::gpu::{Gpu, GpuError};
use crate::shadow::GpuSamples;
use crate::shadow::volume::{GpuVolume, Part};

/// The compiled pass that starts at the near rectangle, for one device.
#[derive(Clone, Debug)]
pub struct ZPassPlusPass {
    pass: StencilPass,
    near_faces: Drawing,
}

impl ZPassPlusPass {
    /// Compiles the shaders.
    ///
    /// # Errors
    ///
    /// [`GpuError::Lost`], [`GpuError::OutOfMemory`].
    pub fn new(gpu: &Gpu, depth: Depth) -> Result<Self, GpuError> {
        let pass = StencilPass::new(gpu, depth)?;
        let add = StencilFaceState {
            compare: CompareFunction::Always,
            pass_op: StencilOperation::IncrementWrap,
            ..StencilFaceState::IGNORE
        };
        let near_faces = Pipeline {
            vertex: "near_vertex",
            fragment: None,
            targets: &[],
            depth_stencil: Some(depth_stencil(false, CompareFunction::Always, add, add)),
            layout: Some(&pass.pipelines.receivers.layout),
        };
        let near_faces = Drawing::new(near_faces, gpu, &module(gpu)?)?;
        Ok(Self { pass, near_faces })
    }

    /// The visibility of every sample: 1 where the counts of all `volumes` of one light, which have caps, add
    /// up to 0. A count of 256 passes for 0.
    ///
    /// # Errors
    ///
    /// As [`StencilPass::visibility`].
    pub fn visibility(
        &self,
        samples: &GpuSamples,
        volumes: &[&GpuVolume],
    ) -> Result<GpuVisibility, GpuError> {
        self.count_from(samples, volumes, true)
    }

    fn count_from(
        &self,
        samples: &GpuSamples,
        volumes: &[&GpuVolume],
        starts_near: bool,
    ) -> Result<GpuVisibility, GpuError> {
        let (pass, target) = (&self.pass, &samples.target);
        let visibility = GpuVisibility::hard(&pass.gpu, samples.size())?;
        let bind = |volume: &&GpuVolume| {
            let frame = pass.volume_frame(&samples.projection, samples.size(), volume)?;
            pass.bind_volume(&frame, volume)
        };
        let bindings = volumes.iter().map(bind).collect::<Result<Vec<_>, GpuError>>()?;
        let [sides, ..] = pass.pipelines.stencil();
        pass.gpu.submit(|encoder| {
            let mut counting = target.begin_counting(encoder);
            for (volume, bind) in volumes.iter().zip(&bindings) {
                counting.set_bind_group(0, bind, &[]);
                if starts_near {
                    frame::draw_part(&mut counting, &self.near_faces, volume, Part::LightCap);
                }
                frame::draw_part(&mut counting, sides, volume, Part::Sides);
            }
            drop(counting);
            let lit = target.begin_read_only(encoder, &[Some(visibility.0.attachment(true))]);
            everywhere(lit, &pass.pipelines.lit, None);
        })?;
        Ok(visibility)
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::*;
    use crate::caster::{Caster, CasterGroup, GpuCaster};
    use crate::gpu::tests::gpu;
    use crate::mesh::Mesh;
    use crate::oracle::Intersection;
    use crate::scene::Lamp;
    use crate::shadow::stencil::{Draw, StencilMethod, StencilPass};
    use crate::shadow::volume::Caps;
    use crate::testing::shapes;
    use crate::view::{Camera, Projection, Size, Up};

    /// Samples near which the number of casting faces beyond the near plane changes: the band.
    fn band(caster: &Caster, projection: &Projection, size: Size, lamp: &Lamp) -> Vec<bool> {
        let group = CasterGroup::new(vec![caster]);
        let [width, height] = [size.width(), size.height()];
        let count = |x: i64, y: i64| {
            let x = (2 * x + 1) as f64 / f64::from(width) - 1.0;
            let ray = projection.ray(DVec2::new(x, 1.0 - (2 * y + 1) as f64 / f64::from(height)));
            let near = f64::from(projection.near) * ray;
            let p = [0, 1, 2].map(|i| (f64::from(projection.eye[i]) + near[i]) as f32);
            let mut count = 0;
            group.oracle().for_each_meeting(p, lamp.light(), |_, meeting| {
                count += i32::from(matches!(meeting, Intersection::Crossing(_)));
            });
            count
        };
        let rows: Vec<Vec<i32>> = (-1..=i64::from(height))
            .map(|y| (-1..=i64::from(width)).map(|x| count(x, y)).collect())
            .collect();
        let around = |x: usize, y: usize| {
            let own = rows[y + 1][x + 1];
            rows[y..y + 3].iter().any(|row| row[x..x + 3].iter().any(|&other| other != own))
        };
        (0..size.pixels()).map(|index| around(index % width as usize, index / width as usize)).collect()
    }

    /// With the eye in a shadow, and with the near rectangle cut by sides.
    #[test]
    fn zpass_plus_on_a_device_equals_zfail_outside_of_its_band() {
        let Some(gpu) = gpu() else { return };
        let zpass_plus = ZPassPlusPass::new(&gpu, Depth::Plane).unwrap();
        let stencil = StencilPass::new(&gpu, Depth::Plane).unwrap();
        let size = Size::new(64, 48).unwrap();
        let floor = shapes::cuboid([-9.0, -3.0, -9.0], [9.0, -2.0, 9.0]);
        let caster = Caster::new(Mesh::concat(&[floor, shapes::torus(16, 9, 2.0, 0.7)]).unwrap());
        let receivers = GpuCaster::upload(&gpu, &caster).unwrap();
        // Of all samples: wrong outside of the band, without the start, in the band and wrong there.
        let mut found = [0; 4];
        for (eye, near) in [([1.9, -1.4, 0.3], 0.02), ([0.4, -1.3, 0.2], 0.3), ([-2.1, -1.2, 0.1], 1.5)] {
            let camera = Camera::look_at(eye, [0.3, -3.0, -4.0], 1.1, Up::Y).unwrap();
            let projection = camera.projection(size, near);
            let drawn = receivers.samples(&projection, size, Depth::Plane).unwrap();
            for lamp in ["point:0.5,9,0.3", "directional:-0.1,-1,0.05"] {
                let lamp: Lamp = lamp.parse().unwrap();
                let faces = caster.shell_faces(lamp.light(), None);
                let volume = caster.volume_of(lamp.light(), &faces, Caps::Both);
                let volume = GpuVolume::upload(&gpu, &volume).unwrap();
                let draw = [Draw { volume: &volume, method: StencilMethod::ZFail }];
                let zfail = stencil.visibility(&drawn, &draw, crate::shadow::stencil::Counting::Stencil);
                let zfail = zfail.unwrap().download(&gpu).unwrap();
                let band = band(&caster, &projection, size, &lamp);
                let mut compare = |starts_near: bool, at: usize| {
                    let values = zpass_plus.count_from(&drawn, &[&volume], starts_near).unwrap();
                    let values = values.download(&gpu).unwrap();
                    for ((value, expected), &in_band) in values.iter().zip(&zfail).zip(&band) {
                        found[at] += usize::from(!in_band && value != expected);
                        found[3] += usize::from(in_band && starts_near && value != expected);
                    }
                };
                compare(true, 0);
                // Fault injected: counts start at 0.
                compare(false, 1);
                found[2] += band.iter().filter(|&&band| band).count();
            }
        }
        eprintln!("{found:?}");
        let [wrong, started_at_zero, band, in_band] = found;
        assert!(wrong == 0 && started_at_zero > 2000 && band > 50 && in_band < band, "{found:?}");
    }
}
