//! Pictures by exact ray cast: every pixel's visible point, its verdict for each lamp, and plain shading. Then the
//! same picture with the shadows that a stencil pass counts.

mod color;
#[cfg(feature = "gpu")]
mod gpu;
mod ground;
mod overlay;
#[cfg(feature = "files")]
mod png;
mod shade;
mod verdicts;

use glam::Vec3;

#[cfg(feature = "gpu")]
pub use gpu::{LampShadow, render_stencil};
pub use ground::Ground;
pub use overlay::{Line, Marker, Overlay};
pub use shade::ShadedLight;
pub use verdicts::{verdict_color, verdicts};

use crate::mesh::FaceId;
use crate::oracle::Oracle;
use crate::parallel;
use crate::view::{Camera, Pinhole, Size, Up};

/// Rows of pixels from the top, each from the left: red, green, blue in sRGB, and alpha.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Picture {
    /// How many there are.
    pub size: Size,
    /// Row after row.
    pub pixels: Vec<[u8; 4]>,
}

/// What is to be seen, and how.
#[derive(Clone, Copy)]
pub struct View<'a> {
    /// From where.
    pub camera: Camera,
    /// How large.
    pub size: Size,
    /// Under which light.
    pub lamps: &'a [ShadedLight],
    /// Where ambient light comes from.
    pub up: Up,
    /// The ground, if the mesh has one.
    pub ground: Option<Ground>,
    /// The color of a face that is not the ground: how much it reflects of linear red, green, blue.
    pub paint: &'a (dyn Fn(FaceId) -> [f32; 3] + Sync),
    /// Rays along each side of a pixel at an edge: its square is the number of rays. 1: no smoothing.
    pub edge_samples: u32,
}

/// A light, slightly warm gray for faces that have no color of their own.
pub const CLAY: [f32; 3] = [0.60, 0.585, 0.56];

const GROUND: Vec3 = Vec3::new(0.52, 0.53, 0.55);

/// The background at the lower and the upper edge of a picture.
const BELOW: Vec3 = Vec3::new(0.60, 0.62, 0.65);
const ABOVE: Vec3 = Vec3::new(0.42, 0.48, 0.56);

/// Neighboring pixels whose bytes differ by more than this have an edge between them.
const EDGE: u8 = 20;

/// Why there is no picture: its pixels, with what is needed to compute them, do not fit the memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("a picture of {0} pixels does not fit the memory")]
pub struct MemoryError(pub Size);

/// A buffer with a `value` for each pixel.
fn buffer<T: Copy>(size: Size, value: T) -> Result<Vec<T>, MemoryError> {
    let mut buffer = Vec::new();
    buffer.try_reserve_exact(size.pixels()).map_err(|_| MemoryError(size))?;
    buffer.resize(size.pixels(), value);
    Ok(buffer)
}

impl View<'_> {
    /// How many steps [`render`] reports.
    #[must_use]
    pub fn steps(&self) -> u64 {
        u64::from(self.size.height()) * if self.edge_samples > 1 { 2 } else { 1 }
    }
}

/// Renders the faces of `oracle`.
///
/// A pixel is the color along the ray through its middle; where it differs from a neighbor, the mean of
/// `edge_samples`² rays. Grazing counts as lit. `progress` hears of steps done, [`View::steps`] in all, from any
/// thread. With the feature `parallel`, rows are shared among threads; the bytes do not depend on how.
///
/// About 2 µs a ray and thread for a mesh of some 10⁵ faces, and 1 µs more a lamp; 4 bytes a pixel, with smoothing 8.
///
/// # Errors
///
/// [`MemoryError`] if those bytes are not to be had.
pub fn render(
    oracle: &Oracle,
    view: &View<'_>,
    progress: &(dyn Fn(u64) + Sync),
) -> Result<Picture, MemoryError> {
    let pinhole = Pinhole::new(&view.camera, view.size);
    let width = view.size.width() as usize;
    let mut pixels = buffer(view.size, [0; 4])?;
    // Taken before the work, not after half of it.
    let mut plain = if view.edge_samples > 1 { buffer(view.size, [0; 4])? } else { Vec::new() };
    parallel::rows(&mut pixels, width, |y, row| {
        for (x, pixel) in row.iter_mut().enumerate() {
            *pixel = color::encode(sample(oracle, view, &pinhole, x as f64 + 0.5, y as f64 + 0.5));
        }
        progress(1);
    });
    if view.edge_samples > 1 {
        plain.copy_from_slice(&pixels);
        parallel::rows(&mut pixels, width, |y, row| {
            for (x, pixel) in row.iter_mut().enumerate() {
                if is_at_edge(&plain, view.size, x, y) {
                    *pixel = smooth(oracle, view, &pinhole, x, y);
                }
            }
            progress(1);
        });
    }
    Ok(Picture { size: view.size, pixels })
}

/// The light that comes along the ray through a place in the picture.
fn sample(oracle: &Oracle, view: &View<'_>, pinhole: &Pinhole, x_px: f64, y_px: f64) -> Vec3 {
    let background = BELOW.lerp(ABOVE, 1.0 - (y_px / f64::from(view.size.height())) as f32);
    let direction = pinhole.ray(x_px, y_px);
    let Some(seen) = oracle.first_visible(pinhole.eye(), direction) else { return background };
    let direction = Vec3::from(direction);
    match &view.ground {
        Some(ground) if seen.face >= ground.first_face => {
            let fade = ground.fade(seen.point);
            if fade >= 1.0 {
                return background;
            }
            shade::shade(oracle, view, &seen, direction, GROUND).lerp(background, fade)
        }
        _ => shade::shade(oracle, view, &seen, direction, (view.paint)(seen.face).into()),
    }
}

/// The mean over a grid of rays. Each is cut at white first, lest one highlight outweigh its neighbors.
fn smooth(oracle: &Oracle, view: &View<'_>, pinhole: &Pinhole, x: usize, y: usize) -> [u8; 4] {
    let n = view.edge_samples;
    let place = |at: usize, i: u32| at as f64 + (f64::from(i) + 0.5) / f64::from(n);
    let mut sum = Vec3::ZERO;
    for i in 0..n * n {
        let light = sample(oracle, view, pinhole, place(x, i % n), place(y, i / n));
        sum += light.min(Vec3::ONE);
    }
    color::encode(sum / (n * n) as f32)
}

/// Whether a pixel differs from one of its eight neighbors.
fn is_at_edge(pixels: &[[u8; 4]], size: Size, x: usize, y: usize) -> bool {
    let (width, height) = (size.width() as usize, size.height() as usize);
    let here = pixels[y * width + x];
    let mut neighbors = (y.saturating_sub(1)..(y + 2).min(height))
        .flat_map(|y| (x.saturating_sub(1)..(x + 2).min(width)).map(move |x| y * width + x));
    neighbors.any(|at| pixels[at].iter().zip(here).any(|(a, b)| a.abs_diff(b) > EDGE))
}
