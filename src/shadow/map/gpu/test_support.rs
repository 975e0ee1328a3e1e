//! What tests of passes with marks begin with: a caster seen by a camera, on both sides.

use crate::caster::{Caster, CasterGroup, GpuCaster};
use crate::gpu::Gpu;
use crate::gpu::raster::GpuSamples;
use crate::mesh::Mesh;
use crate::scene::Lamp;
use crate::shadow::map::{ExactOptions, LightSpace};
use crate::shadow::{Depth, Samples};
use crate::testing::shapes;
use crate::view::{Camera, Size, Up};

/// Options of the techniques with marks.
pub(super) const OPTIONS: ExactOptions = ExactOptions { size: 64, reach: 1 };

/// The same caster, lamp and view on the CPU and on a device.
pub(super) struct Twins<'a> {
    pub(super) casters: CasterGroup<'a>,
    pub(super) lamp: Lamp,
    pub(super) samples: Samples,
    pub(super) on_device: GpuCaster,
    pub(super) drawn: GpuSamples,
    pub(super) space: LightSpace,
}

impl<'a> Twins<'a> {
    /// A view of this many pixels that shows all of the caster.
    pub(super) fn new(gpu: &Gpu, caster: &'a Caster, lamp: &str, [width, height]: [u32; 2]) -> Self {
        let casters = CasterGroup::new(vec![caster]);
        let size = Size::new(width, height).unwrap();
        let projection = Camera::fit(&casters.bounds(), Up::Z, size.aspect()).projection(size, 1.0 / 16.0);
        let samples = Samples::of_view(&casters, &projection, size, 1).unwrap();
        let lamp: Lamp = lamp.parse().unwrap();
        let on_device = GpuCaster::upload(gpu, caster).unwrap();
        let drawn = on_device.samples(&projection, size, Depth::Plane).unwrap();
        let space = LightSpace::of_scene(&casters, &lamp, OPTIONS.size).unwrap();
        Self { casters, lamp, samples, on_device, drawn, space }
    }
}

/// A ring and a knot, each over a floor.
pub(super) fn casters() -> [Caster; 2] {
    let floor = shapes::translated(&shapes::scaled(&shapes::sheet(1), 12.0), [-6.0, -6.0, -2.0]);
    [shapes::torus(24, 12, 2.0, 0.7), shapes::torus_knot(2, 3, 60, 9, 0.35)]
        .map(|shape| Caster::new(Mesh::concat(&[floor.clone(), shape]).unwrap()))
}
