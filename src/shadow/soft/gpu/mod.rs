//! Soft shadows on a device: what techniques read beside a [`GpuMap`], and the techniques.
//!
//! [`SoftPass`] makes the pyramid of a map: least and greatest depths of squares of texels, the same numbers
//! as on the CPU. [`PcssPass`] and [`SearchPass`] fill a visibility texture from it, and cut each value at
//! the share of the lamp above the plane of the sample's own face. A device computes positions and depths of
//! receivers in `f32`, the CPU in `f64`.

mod lamp;
mod pcss;
mod search;
mod shade;
#[cfg(test)]
mod tests;

pub use pcss::PcssPass;
pub use search::SearchPass;
#[cfg(test)]
pub(super) use search::source as search_source;

use self::lamp::LampUniform;
use self::shade::Shade;
use crate::gpu::raster;
use crate::gpu::{Gpu, GpuError, Kernel, Shader, wgpu};
use crate::scene::Lamp;
use crate::shadow::map::gpu::{GpuMap, SOURCE as MAP};

const SOFT: &str = include_str!("soft.wgsl");

/// What the shaders of all soft techniques start with.
fn source(technique: &str) -> String {
    format!("{}{MAP}{SOFT}{technique}", raster::SOURCE)
}

/// The compiled passes that make a [`GpuSoftMap`], for one device.
#[derive(Clone, Debug)]
pub struct SoftPass {
    gpu: Gpu,
    tiles: Kernel,
    join: Kernel,
}

/// A map's pyramid, and the lamp.
#[derive(Clone, Debug)]
pub struct GpuSoftMap {
    pyramid: wgpu::Buffer,
    lamp: LampUniform,
    /// Cells of all levels.
    cells: usize,
}

impl GpuSoftMap {
    /// Memory on the device, in bytes, without the map.
    #[must_use]
    pub fn bytes(&self) -> usize {
        self.cells * size_of::<[f32; 2]>()
    }
}

impl SoftPass {
    /// Compiles the shaders.
    ///
    /// # Errors
    ///
    /// [`GpuError::Lost`], [`GpuError::OutOfMemory`].
    pub fn new(gpu: &Gpu) -> Result<Self, GpuError> {
        let module = Shader::new("pyramid of a map", &source("")).module(gpu)?;
        Ok(Self {
            gpu: gpu.clone(),
            tiles: Kernel::new(gpu, &module, "tiles")?,
            join: Kernel::new(gpu, &module, "join")?,
        })
    }

    /// The pyramid of a map under a lamp. Submits without waiting.
    ///
    /// # Errors
    ///
    /// [`GpuError::TooLarge`] if it does not fit a buffer; [`GpuError::OutOfMemory`]; [`GpuError::Lost`].
    pub fn prepare(&self, map: &GpuMap, lamp: &Lamp) -> Result<GpuSoftMap, GpuError> {
        let sides = sides(map.space().size() as usize);
        let cells_of = |side: &usize| map.space().layers() * side * side;
        let cells = sides.iter().map(cells_of).sum();
        let pyramid = self.gpu.storage::<[f32; 2]>("pyramid of a map", cells)?;
        let light = self.gpu.uniform(&map.uniform)?;
        let tiles = self.tiles.bind_all(
            &self.gpu,
            [
                (6, light.as_entire_binding()),
                (7, wgpu::BindingResource::TextureView(&map.view)),
                (10, pyramid.as_entire_binding()),
            ],
        )?;
        let levels = (1..sides.len() as u32).map(|level| {
            let level = self.gpu.uniform(&level)?;
            self.join.bind(&self.gpu, &[(6, &light), (10, &pyramid), (11, &level)])
        });
        let levels = levels.collect::<Result<Vec<_>, _>>()?;
        self.gpu.submit(|encoder| {
            self.tiles.record(encoder, &tiles, cells_of(&sides[0]));
            for (level, side) in levels.iter().zip(&sides[1..]) {
                self.join.record(encoder, level, cells_of(side));
            }
        })?;
        Ok(GpuSoftMap { pyramid, lamp: LampUniform::new(lamp, map), cells })
    }
}

/// Cells along a side of each level.
fn sides(size: usize) -> Vec<usize> {
    let mut sides = vec![size.div_ceil(8)];
    while let Some(&side) = sides.last().filter(|&&side| side > 1) {
        sides.push(side.div_ceil(2));
    }
    sides
}
