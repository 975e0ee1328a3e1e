//! Lines, markers and tinted faces over a picture, to show people where something is.

use std::ops::Range;

use glam::DVec2;

use super::{CLAY, MemoryError, Picture, ShadedLight, View, buffer, render};
use crate::geom::Light;
use crate::mesh::FaceId;
use crate::oracle::Oracle;
use crate::parallel;
use crate::view::{Camera, Projected, Rays, Size, Up};

/// Annotations of a mesh: lines color by color, then markers.
///
/// ```
/// use umbrage::oracle::Oracle;
/// use umbrage::render::{Line, Overlay};
/// use umbrage::testing::shapes;
/// use umbrage::view::{Size, Up};
///
/// let oracle = Oracle::build(&shapes::cube());
/// let size = Size::new(32, 24).unwrap();
/// let line = Line { ends: [[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0]], color: [225, 60, 0] };
/// let overlay = Overlay { lines: vec![line], ..Overlay::default() };
/// let with_line = overlay.render(&oracle, Up::Y, size, &|_| {})?;
/// assert_ne!(with_line, Overlay::default().render(&oracle, Up::Y, size, &|_| {})?);
/// # Ok::<(), umbrage::render::MemoryError>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Overlay {
    /// Straight line segments in world space.
    pub lines: Vec<Line>,
    /// Discs of a fixed size in the picture.
    pub spots: Vec<Marker>,
    /// Faces with a color (sRGB) of their own. The first entry of a face counts.
    pub faces: Vec<(FaceId, [u8; 3])>,
    /// Colors (sRGB) of lines in the order in which they are drawn, the last one on top; all others are below
    /// these.
    pub order: Vec<[u8; 3]>,
}

/// A line segment over a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Line {
    /// The two end points, in world space.
    pub ends: [[f32; 3]; 2],
    /// sRGB.
    pub color: [u8; 3],
}

/// A disc over a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Marker {
    /// The center of the disc, in world space.
    pub at: [f32; 3],
    /// sRGB.
    pub color: [u8; 3],
}

const LINE_RADIUS_PX: f64 = 1.25;
const SPOT_RADIUS_PX: f64 = 4.5;

/// Opacity of an annotation behind a face.
const HIDDEN_ALPHA: f64 = 0.35;

/// Depth tolerance, in diagonals of the box: an annotation that lies less than this behind a face is taken to
/// lie on the face. Affects dimming only.
const SKIN: f64 = 1.0 / 256.0;

impl Overlay {
    /// Draws the faces of `oracle` in light gray from a fitted camera, and the annotations over them, dimmed
    /// where a face hides them. `progress` is called with the number of steps done, 2 × height in all, from
    /// any thread.
    ///
    /// # Errors
    ///
    /// [`MemoryError`] if 12 bytes per pixel cannot be allocated.
    pub fn render(
        &self,
        oracle: &Oracle,
        up: Up,
        size: Size,
        progress: &(dyn Fn(u64) + Sync),
    ) -> Result<Picture, MemoryError> {
        self.render_from(Camera::fit(&oracle.bounds(), up, size.aspect()), oracle, up, size, progress)
    }

    /// The same from a camera of the caller's.
    ///
    /// # Errors
    ///
    /// [`MemoryError`] if 12 bytes per pixel cannot be allocated.
    pub fn render_from(
        &self,
        camera: Camera,
        oracle: &Oracle,
        up: Up,
        size: Size,
        progress: &(dyn Fn(u64) + Sync),
    ) -> Result<Picture, MemoryError> {
        let mut tints = self.faces.clone();
        tints.sort_by_key(|tint| tint.0); // stable: the first entry of a face stays first
        let paint = |face: FaceId| {
            let at = tints.partition_point(|tint| tint.0 < face);
            tints.get(at).filter(|tint| tint.0 == face).map_or(CLAY, |tint| tint.1.map(linear))
        };
        let lamps = headlights(&camera);
        let view = View {
            camera,
            size,
            lamps: &lamps,
            casters: None,
            up,
            ground: None,
            paint: &paint,
            edge_samples: 1,
            ambient: None,
        };
        let mask = buffer(size, 0.0)?;
        let mut picture = render(oracle, &view, progress)?;
        let depths = depths(oracle, &camera, size, progress)?;
        let skin = SKIN * oracle.bounds().diagonal();
        self.draw(Canvas { picture: &mut picture, depths: &depths, skin, mask }, &camera.rays(size));
        Ok(picture)
    }

    fn draw(&self, mut canvas: Canvas<'_>, rays: &Rays) {
        // A margin of 5 % keeps the round ends of cut lines outside of the picture.
        let mut lines = self.lines.clone();
        let rank = |color| self.order.iter().position(|&other| other == color);
        lines.sort_by_key(|line| (rank(line.color), line.color));
        for lines in lines.chunk_by(|a, b| a.color == b.color) {
            for line in lines {
                if let Some([a, b]) = rays.project_segment(line.ends, 0.05) {
                    canvas.stroke(a, b, LINE_RADIUS_PX);
                }
            }
            canvas.paint(lines[0].color, canvas.everywhere());
        }
        for spot in &self.spots {
            if let Some([at, _]) = rays.project_segment([spot.at; 2], 0.05) {
                for (radius, color) in [(SPOT_RADIUS_PX + 1.5, [30; 3]), (SPOT_RADIUS_PX, spot.color)] {
                    let touched = canvas.stroke(at, at, radius);
                    canvas.paint(color, touched);
                }
            }
        }
    }
}

/// Two lights, from the upper left and from the right of the eye, that shade every visible surface.
fn headlights(camera: &Camera) -> Vec<ShadedLight> {
    let (forward, up) = (camera.forward, camera.up);
    let right = forward.cross(up).normalize_or_zero();
    let travels = [forward - 0.7 * up + 0.6 * right, forward + 0.1 * up - 0.8 * right];
    let lights = travels.into_iter().filter_map(|travel| Light::directional(travel.into()).ok());
    ShadedLight::equal(&lights.collect::<Vec<_>>())
}

/// Depth of the first hit through each pixel's center, along the camera's forward direction; infinite for
/// none.
fn depths(
    oracle: &Oracle,
    camera: &Camera,
    size: Size,
    progress: &(dyn Fn(u64) + Sync),
) -> Result<Vec<f32>, MemoryError> {
    let rays = camera.rays(size);
    let mut depths = buffer(size, f32::INFINITY)?;
    parallel::rows(&mut depths, size.width() as usize, |y, row| {
        for (x, depth) in row.iter_mut().enumerate() {
            let ray = rays.ray(x as f64 + 0.5, y as f64 + 0.5);
            if let Some(hit) = oracle.first_hit(ray.origin, ray.direction) {
                *depth = hit.t as f32;
            }
        }
        progress(1);
    });
    Ok(depths)
}

/// A picture with its depths.
struct Canvas<'a> {
    picture: &'a mut Picture,
    depths: &'a [f32],
    skin: f64,
    /// Coverage per pixel of the current color: overlapping strokes of one color are blended once.
    mask: Vec<f32>,
}

impl Canvas<'_> {
    /// The columns and the rows of the picture.
    fn everywhere(&self) -> [Range<usize>; 2] {
        [self.picture.size.width(), self.picture.size.height()].map(|side| 0..side as usize)
    }

    /// Adds a line with round ends to the mask, or a disc if both ends are equal. The edge is soft over one
    /// pixel. Returns columns and rows that contain all pixels touched.
    fn stroke(&mut self, a: Projected, b: Projected, radius: f64) -> [Range<usize>; 2] {
        let width = self.picture.size.width() as usize;
        let (from, to) = (DVec2::new(a.x_px, a.y_px), DVec2::new(b.x_px, b.y_px));
        let along = to - from;
        let reach = DVec2::splat(radius + 0.5);
        let (low, high) = (from.min(to) - reach, from.max(to) + reach);
        let rows = pixels(low.y, high.y, self.picture.size.height());
        for y in rows.clone() {
            // Only the part of the row that is near the line: where the line is within reach above or below.
            let (mut left, mut right) = (low.x, high.x);
            if along.y.abs() > along.x.abs() {
                let middle = from.x + along.x * (y as f64 + 0.5 - from.y) / along.y;
                left = left.max(middle - 2.0 * reach.x);
                right = right.min(middle + 2.0 * reach.x);
            } else if along.y != 0.0 {
                let crossing = |y: f64| from.x + along.x * (y - from.y) / along.y;
                let (p, q) =
                    (crossing(y as f64 + 0.5 - 2.0 * reach.y), crossing(y as f64 + 0.5 + 2.0 * reach.y));
                left = left.max(p.min(q));
                right = right.min(p.max(q));
            }
            for x in pixels(left, right, self.picture.size.width()) {
                let at = DVec2::new(x as f64 + 0.5, y as f64 + 0.5);
                let s = if along == DVec2::ZERO {
                    0.0
                } else {
                    ((at - from).dot(along) / along.length_squared()).clamp(0.0, 1.0)
                };
                let coverage = (radius + 0.5 - at.distance(from + along * s)).clamp(0.0, 1.0);
                // Where lines lie on each other most pixels are covered already: no depth could add to them.
                if coverage as f32 > self.mask[y * width + x] {
                    // 1 / depth is linear in the picture.
                    let depth = 1.0 / ((1.0 - s) / a.depth + s / b.depth);
                    let alpha = if self.hides(x, y, depth) { HIDDEN_ALPHA } else { 1.0 };
                    let mask = &mut self.mask[y * width + x];
                    *mask = mask.max((coverage * alpha) as f32);
                }
            }
        }
        [pixels(low.x, high.x, self.picture.size.width()), rows]
    }

    /// Blends a color over the masked pixels of some columns and rows, and clears their mask.
    fn paint(&mut self, color: [u8; 3], [columns, rows]: [Range<usize>; 2]) {
        let width = self.picture.size.width() as usize;
        for y in rows {
            let row = y * width + columns.start..y * width + columns.end.max(columns.start);
            let pixels = &mut self.picture.pixels[row.clone()];
            for (pixel, mask) in pixels.iter_mut().zip(&mut self.mask[row]) {
                if *mask > 0.0 {
                    blend(pixel, color, std::mem::take(mask));
                }
            }
        }
    }

    /// Whether the mesh is nearer than `depth` at a pixel and at all its neighbors. (At a silhouette, half of
    /// the pixels beneath a line see what lies behind the mesh.)
    fn hides(&self, x: usize, y: usize, depth: f64) -> bool {
        let (width, height) = (self.picture.size.width() as usize, self.picture.size.height() as usize);
        let mut near = (y.saturating_sub(1)..(y + 2).min(height))
            .flat_map(|y| (x.saturating_sub(1)..(x + 2).min(width)).map(move |x| y * width + x));
        near.all(|at| f64::from(self.depths[at]) + self.skin < depth)
    }
}

fn blend(pixel: &mut [u8; 4], color: [u8; 3], alpha: f32) {
    for (under, over) in pixel.iter_mut().zip(color) {
        *under = (f32::from(*under) + alpha * (f32::from(over) - f32::from(*under)) + 0.5) as u8;
    }
}

/// The pixels that an interval touches, within `0..side`.
fn pixels(low: f64, high: f64, side: u32) -> Range<usize> {
    let within = |x: f64| x.clamp(0.0, f64::from(side)) as usize;
    within(low.floor())..within(high.ceil())
}

/// From sRGB.
fn linear(byte: u8) -> f32 {
    let x = f32::from(byte) / 255.0;
    if x <= 0.040_45 { x / 12.92 } else { ((x + 0.055) / 1.055).powf(2.4) }
}
