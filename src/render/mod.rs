//! Pictures by exact ray cast: primary visibility, exact verdicts for each lamp, and plain shading. Also the
//! same pictures with the visibility that any technique computes, on the CPU and on a graphics device.

mod color;
#[cfg(feature = "gpu")]
mod gpu;
mod ground;
mod knowledge;
#[cfg(test)]
mod lamps_tests;
mod overlay;
#[cfg(feature = "files")]
mod png;
mod samples;
mod shade;
mod veil;
mod verdicts;

use glam::Vec3;

#[cfg(feature = "files")]
pub use self::png::AnimatedPng;
#[cfg(feature = "gpu")]
pub use gpu::render_visibility;
pub use ground::Ground;
pub use knowledge::{Knowledge, knowledge};
pub use overlay::{Line, Marker, Overlay};
pub use samples::render_samples;
pub use shade::{Falloff, ShadedLight};
pub use veil::veil;
pub use verdicts::{verdict_color, verdicts};

use crate::mesh::FaceId;
use crate::oracle::{Oracle, PrimaryHit};
use crate::parallel;
use crate::view::{Camera, Rays, Size, Up};

/// An image of 8-bit sRGB pixels with alpha, row by row from the top.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Picture {
    /// Width and height in pixels.
    pub size: Size,
    /// Red, green, blue in sRGB, and alpha: row by row from the top, each row from the left.
    pub pixels: Vec<[u8; 4]>,
}

/// Input of [`render`]: camera, lamps, materials and quality.
#[derive(Clone, Copy)]
pub struct View<'a> {
    /// The camera.
    pub camera: Camera,
    /// Width and height of the picture.
    pub size: Size,
    /// The lamps, each with its shadow.
    pub lamps: &'a [ShadedLight],
    /// The faces that cast in [`render`]; `None` if all that is seen casts.
    pub casters: Option<&'a Oracle>,
    /// Up direction of the hemispheric ambient light.
    pub up: Up,
    /// The ground, if the mesh has one ([`Ground::under`]).
    pub ground: Option<Ground>,
    /// The color of a face that is not the ground: its reflectance in linear red, green, blue.
    pub paint: &'a (dyn Fn(FaceId) -> [f32; 3] + Sync),
    /// Samples along each side of a pixel at an edge: the number of rays is the square. 1 for no
    /// antialiasing.
    pub edge_samples: u32,
    /// How much of the ambient light arrives at a visible point, by its position and the normal of its seen
    /// side, from 0 to 1; `None` for all of it. Pictures of a device do not ask.
    pub ambient: Option<&'a (dyn Fn([f32; 3], [f32; 3]) -> f32 + Sync)>,
}

/// Default color of faces: a light, slightly warm gray, in linear red, green, blue.
pub const CLAY: [f32; 3] = [0.60, 0.585, 0.56];

const GROUND: Vec3 = Vec3::new(0.52, 0.53, 0.55);

/// Color of the background at the lower edge of a picture.
const BELOW: Vec3 = Vec3::new(0.60, 0.62, 0.65);
/// Color of the background at the upper edge of a picture.
const ABOVE: Vec3 = Vec3::new(0.42, 0.48, 0.56);

/// Difference of two neighboring pixels, in sRGB bytes, above which they are antialiased.
const EDGE: u8 = 20;

/// Error of a picture that does not fit the memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("a picture of {0} pixels does not fit the memory")]
pub struct MemoryError(pub Size);

/// A buffer with one `value` per pixel.
fn buffer<T: Copy>(size: Size, value: T) -> Result<Vec<T>, MemoryError> {
    let mut buffer = Vec::new();
    buffer.try_reserve_exact(size.pixels()).map_err(|_| MemoryError(size))?;
    buffer.resize(size.pixels(), value);
    Ok(buffer)
}

impl View<'_> {
    /// Number of steps that [`render`] reports.
    #[must_use]
    pub fn steps(&self) -> u64 {
        u64::from(self.size.height()) * if self.edge_samples > 1 { 2 } else { 1 }
    }
}

/// Renders the faces of `oracle`.
///
/// A pixel is the color along the ray through its center. Where a pixel differs from a neighbor, it is the
/// mean of `edge_samples`² rays. A grazing sample counts as lit. `progress` is called with the number of
/// steps done, [`View::steps`] in all, from any thread. With the feature `parallel`, rows are shared among
/// threads; the bytes do not depend on the number of threads.
///
/// Cost: about 2 µs per ray and thread for a mesh of some 10⁵ faces, and 1 µs more per lamp. Memory: 4 bytes
/// per pixel, 8 with antialiasing.
///
/// # Errors
///
/// [`MemoryError`] if this memory cannot be allocated.
///
/// ```
/// use umbrage::geom::Light;
/// use umbrage::oracle::Oracle;
/// use umbrage::render::{CLAY, ShadedLight, View, render};
/// use umbrage::testing::shapes;
/// use umbrage::view::{Camera, Size, Up};
///
/// let oracle = Oracle::build(&shapes::cube());
/// let size = Size::new(32, 24).unwrap();
/// let lamps = ShadedLight::equal(&[Light::point([3.0, 5.0, 4.0])?]);
/// let view = View {
///     camera: Camera::fit(&oracle.bounds(), Up::Y, size.aspect()),
///     size,
///     lamps: &lamps,
///     casters: None,
///     up: Up::Y,
///     ground: None,
///     paint: &|_| CLAY,
///     edge_samples: 1,
///     ambient: None,
/// };
/// let picture = render(&oracle, &view, &|_| {})?;
/// assert_eq!(picture.pixels.len(), 32 * 24);
/// assert_ne!(picture.pixels[12 * 32 + 16], picture.pixels[0]); // the cube before the background
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn render(
    oracle: &Oracle,
    view: &View<'_>,
    progress: &(dyn Fn(u64) + Sync),
) -> Result<Picture, MemoryError> {
    let rays = view.camera.rays(view.size);
    let width = view.size.width() as usize;
    let mut pixels = buffer(view.size, [0; 4])?;
    // Both buffers are allocated before the work, so that failure is early.
    let mut plain = if view.edge_samples > 1 { buffer(view.size, [0; 4])? } else { Vec::new() };
    parallel::rows(&mut pixels, width, |y, row| {
        for (x, pixel) in row.iter_mut().enumerate() {
            *pixel = color::encode(sample(oracle, view, &rays, x as f64 + 0.5, y as f64 + 0.5));
        }
        progress(1);
    });
    if view.edge_samples > 1 {
        plain.copy_from_slice(&pixels);
        parallel::rows(&mut pixels, width, |y, row| {
            for (x, pixel) in row.iter_mut().enumerate() {
                if is_at_edge(&plain, view.size, x, y) {
                    *pixel = smooth(oracle, view, &rays, x, y);
                }
            }
            progress(1);
        });
    }
    Ok(Picture { size: view.size, pixels })
}

/// The light that comes along the ray through a position in the picture.
fn sample(oracle: &Oracle, view: &View<'_>, rays: &Rays, x_px: f64, y_px: f64) -> Vec3 {
    let ray = rays.ray(x_px, y_px);
    let near = view.camera.near.unwrap_or(0.0).into();
    let seen = oracle.first_visible_beyond(ray.origin, ray.direction, near);
    let casters = view.casters.unwrap_or(oracle);
    color_at(view, rays, [x_px, y_px], seen.as_ref(), |lamp, hit| {
        shade::exact(casters, &view.lamps[lamp], hit.point)
    })
}

/// The color at a position in the picture where `seen` is visible. `visibility` says how much of a lamp, by
/// its index, reaches it.
fn color_at(
    view: &View<'_>,
    rays: &Rays,
    [x_px, y_px]: [f64; 2],
    seen: Option<&PrimaryHit>,
    visibility: impl Fn(usize, &PrimaryHit) -> f32,
) -> Vec3 {
    let background = BELOW.lerp(ABOVE, 1.0 - (y_px / f64::from(view.size.height())) as f32);
    let Some(seen) = seen else { return background };
    let direction = rays.direction(x_px, y_px).normalize().as_vec3();
    let lit = |base| shade::shade(view, seen, direction, base, |lamp| visibility(lamp, seen));
    match &view.ground {
        Some(ground) if seen.face >= ground.first_face => match ground.fade(seen.point) {
            1.0.. => background,
            fade => lit(GROUND).lerp(background, fade),
        },
        _ => lit((view.paint)(seen.face).into()),
    }
}

/// The mean over a grid of rays. Each is cut at white first, lest one highlight outweigh its neighbors.
fn smooth(oracle: &Oracle, view: &View<'_>, rays: &Rays, x: usize, y: usize) -> [u8; 4] {
    let n = view.edge_samples;
    let position = |at: usize, i: u32| at as f64 + (f64::from(i) + 0.5) / f64::from(n);
    let mut sum = Vec3::ZERO;
    for i in 0..n * n {
        let light = sample(oracle, view, rays, position(x, i % n), position(y, i / n));
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
