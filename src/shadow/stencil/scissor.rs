//! Scissor rectangles: where in a picture a volume can count anything at all.
//!
//! All triangles of a closed volume add up to its winding number at the visible point. So at any pixel either
//! all of them are drawn or none, and none is right where the winding number is 0: outside of the shadow
//! volume of the casters' box. A plane that parts that volume from the visible points of a tile proves it.
//! Unlike a stencil mask, a scissor saves the fragments on every rasterizer.
//!
//! # Effect of rounding
//!
//! A rasterizer moves corners by up to 1/256 pixel, and rounds the depth of a side. The plane of a side that
//! is seen under a small angle turns the two into errors of depth that are in proportion: one pixel is at
//! least 2⁻¹⁴ of the picture's width, and a depth is rounded by some 2⁻²⁰ of itself, so the error of depth is
//! less than that of a ray one pixel beside; so is that of a point that is found by its depth. Hence the box
//! of a visible point is grown by what one pixel covers at its distance, and by 2⁻¹⁸ of the coordinates. Then
//! the drawn counts are the same, byte for byte.

use glam::{DVec2, DVec3};

use super::fault::{Fault, Faults};
use crate::geom::{Aabb, Light};
use crate::gpu::GpuError;
use crate::oracle::PrimaryHit;
use crate::scene::Lamp;
use crate::shadow::tiles::{SIDE, Tiles};
use crate::shadow::volume::parting::{LampBox, Parting};
use crate::shadow::{GpuSamples, Samples};
use crate::view::Projection;

/// A rectangle of pixels, or of samples where a pixel has several: columns from the left, rows from the top.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(in crate::shadow) struct PixelRectangle {
    pub(in crate::shadow) x: u32,
    pub(in crate::shadow) y: u32,
    pub(in crate::shadow) width: u32,
    pub(in crate::shadow) height: u32,
}

/// Pixels that take as long as the corners of a triangle, roughly, on a software rasterizer.
const TRIANGLE: usize = 32;

/// The visible points of a picture, in tiles of 16 by 16 samples with a box each: where volumes can matter.
///
/// [`StencilPass::within`](super::StencilPass::within) draws a volume only in the tiles that it may shadow.
///
/// Memory: 24 bytes per 256 samples.
#[derive(Clone, Debug)]
pub struct ReceiverTiles {
    tiles: Tiles,
    /// Samples in a row, and rows.
    size: [u32; 2],
    pub(super) faults: Faults,
}

impl ReceiverTiles {
    /// The tiles of all samples that see a surface. Counts stay the same at every one of them.
    #[must_use]
    pub fn of(samples: &Samples) -> Self {
        Self::of_some(samples, |_| true)
    }

    /// The tiles of the samples whose face looks towards a light; all others are dark without a count. So the
    /// light that reaches each sample stays the same.
    #[must_use]
    pub fn facing(samples: &Samples, light: &Light) -> Self {
        Self::of_some(samples, |hit| crate::shadow::is_front_lit(hit, light))
    }

    /// The tiles of all samples on a device. Waits for their depth, and reads it back.
    ///
    /// # Errors
    ///
    /// [`GpuError::TooLarge`] if the depth does not fit one buffer, [`GpuError::OutOfMemory`],
    /// [`GpuError::Lost`].
    pub fn read(samples: &GpuSamples) -> Result<Self, GpuError> {
        let (projection, size) = (samples.projection(), samples.size());
        let depth = samples.download_depth()?;
        let [width, height] = [size.width(), size.height()];
        let eye = DVec3::from(projection.eye.map(f64::from));
        let point = |index: usize| {
            // Reversed: 0 is infinitely far, and nothing is seen.
            let at = f64::from(projection.near) / f64::from(Some(depth[index]).filter(|&depth| depth > 0.0)?);
            let [x, y] = [index % width as usize, index / width as usize].map(|i| 2.0 * i as f64 + 1.0);
            let ndc = DVec2::new(x / f64::from(width) - 1.0, 1.0 - y / f64::from(height));
            Some(eye + at * projection.ray(ndc))
        };
        Ok(Self::of_points(projection, [width, height], point))
    }

    fn of_some(samples: &Samples, counts: impl Fn(&PrimaryHit) -> bool) -> Self {
        let row_len = samples.row_len();
        let size = [row_len, samples.len() / row_len.max(1)].map(|side| side as u32); // sides of a picture
        let point = |index: usize| {
            let hit = samples.hits()[index].as_ref().filter(|hit| counts(hit))?;
            Some(DVec3::from(hit.point.map(f64::from)))
        };
        Self::of_points(samples.projection(), size, point)
    }

    /// `point` gives the visible point of a sample that counts.
    fn of_points(projection: &Projection, size: [u32; 2], point: impl Fn(usize) -> Option<DVec3>) -> Self {
        let [row_len, rows] = size.map(f64::from);
        let step = |ndc: DVec2| (projection.ray(ndc) - projection.ray(DVec2::ZERO)).abs();
        let across = step(DVec2::new(2.0 / row_len, 0.0)) + step(DVec2::new(0.0, 2.0 / rows));
        let [eye, forward] = [projection.eye, projection.forward].map(|p| DVec3::from(p.map(f64::from)));
        let around = |p: DVec3| {
            let reach = if projection.is_orthographic() { 1.0 } else { forward.dot(p - eye).abs() };
            let grown = across * reach + (p.abs() + eye.abs()).max_element() / f64::from(1 << 18);
            Aabb { low: (p - grown).as_vec3().into(), high: (p + grown).as_vec3().into() }
        };
        let count = size[0] as usize * size[1] as usize;
        let tiles = Tiles::of_boxes(size[0] as usize, count, |index| point(index).map(around));
        Self { tiles, size, faults: Faults::default() }
    }

    /// Samples in a row, and rows.
    pub(in crate::shadow) fn size(&self) -> [u32; 2] {
        self.size
    }

    /// Where a closed volume of casting faces in `bounds` may count: disjoint rectangles; none if it counts
    /// nowhere. The volume is drawn once for each, so a volume of many `triangles` takes a single one, around
    /// all tiles, unless smaller ones save more pixels than [`TRIANGLE`] for each triangle.
    pub(in crate::shadow) fn rectangles(
        &self,
        light: &Light,
        bounds: &Aabb,
        triangles: usize,
    ) -> Vec<PixelRectangle> {
        let lamp = LampBox::of(&Lamp::from(*light));
        let mut parting = Parting::new(lamp, self.faults.has(Fault::BoxOfCasters));
        let kept = self.tiles.kept(|tile| parting.parts_box(tile, bounds));
        let runs = runs(&kept, self.tiles.columns());
        let around = runs
            .iter()
            .copied()
            .reduce(|a, b| [a[0].min(b[0]), a[1].min(b[1]), a[2].max(b[2]), a[3].max(b[3])]);
        let Some(around) = around else { return Vec::new() };
        let area = |rect: &[usize; 4]| (rect[2] - rect[0]) * (rect[3] - rect[1]) * SIDE * SIDE;
        let cost =
            |tiles: &[[usize; 4]]| tiles.iter().map(area).sum::<usize>() + TRIANGLE * triangles * tiles.len();
        let chosen = if cost(&runs) < cost(&[around]) { runs } else { vec![around] };
        chosen.into_iter().map(|tiles| self.pixels(tiles)).collect()
    }

    /// The samples of a rectangle of tiles.
    fn pixels(&self, [left, top, right, bottom]: [usize; 4]) -> PixelRectangle {
        let less = u32::from(self.faults.has(Fault::OnePixelLess));
        let at = |tile: usize, most: u32| ((tile * SIDE) as u32).min(most);
        let [x, y] = [at(left, self.size[0]), at(top, self.size[1])];
        let [right, bottom] = [at(right, self.size[0]), at(bottom, self.size[1])].map(|end| end - less);
        PixelRectangle { x, y, width: right - x, height: bottom - y }
    }
}

/// Rectangles of tiles that are kept, as `[left, top, right, bottom]`: runs within a row, and runs that are
/// the same in one row after another.
fn runs(kept: &[bool], columns: usize) -> Vec<[usize; 4]> {
    let mut found: Vec<[usize; 4]> = Vec::new();
    for (row, tiles) in kept.chunks(columns.max(1)).enumerate() {
        let mut column = 0;
        for run in tiles.chunk_by(|a, b| a == b) {
            let (from, to) = (column, column + run.len());
            column = to;
            if run[0] {
                match found.iter_mut().find(|rect| [rect[0], rect[2], rect[3]] == [from, to, row]) {
                    Some(above) => above[3] = row + 1,
                    None => found.push([from, row, to, row + 1]),
                }
            }
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_cover_the_tiles_that_are_kept_once() {
        for (pattern, expected) in [("##/##", 1), ("#./.#", 2), ("##./##./#.#", 3), ("..", 0), ("#.#/#.#", 2)]
        {
            let columns = pattern.find('/').unwrap_or(pattern.len());
            let kept: Vec<bool> = pattern.chars().filter(|&c| c != '/').map(|c| c == '#').collect();
            let found = runs(&kept, columns);
            assert_eq!(found.len(), expected, "{pattern}");
            for (index, &kept) in kept.iter().enumerate() {
                let (x, y) = (index % columns, index / columns);
                let holds = |r: &&[usize; 4]| (r[0]..r[2]).contains(&x) && (r[1]..r[3]).contains(&y);
                assert_eq!(found.iter().filter(holds).count(), usize::from(kept), "{pattern} {index}");
            }
        }
    }
}
