//! A pixel comparison as a picture: gray for agreement, colors that stand out for the rest.

use glam::{DVec3, Vec3};

use super::{ABOVE, BELOW, MemoryError, Picture, buffer, color};
use crate::oracle::Oracle;
use crate::parallel;
use crate::verify::pixels::{Comparison, PixelVerdict};
use crate::view::{Projection, Rays};

/// Name and sRGB bytes of a verdict's color: grays for agreement, light blue for the sky. The hues of the
/// others differ in brightness too, so that nobody needs to distinguish red from green (Masataka Okabe and
/// Kei Ito, *Color Universal Design*, 2002).
#[must_use]
pub fn verdict_color(verdict: PixelVerdict) -> (&'static str, [u8; 3]) {
    match verdict {
        PixelVerdict::Sky => ("background", [187, 193, 201]),
        PixelVerdict::Lit => ("light gray", [222; 3]),
        PixelVerdict::Shadowed => ("dark gray", [92; 3]),
        PixelVerdict::Grazing => ("yellow", [240, 228, 66]),
        PixelVerdict::Unsure => ("sky blue", [86, 180, 233]),
        PixelVerdict::Overflow => ("blue", [0, 80, 190]),
        PixelVerdict::Real => ("vermilion", [225, 60, 0]),
    }
}

/// Brightness of a surface seen edge-on, relative to one seen from the front.
const EDGE_ON: f32 = 0.55;

/// Half the side of the square drawn at a pixel, in pixels.
const DOT_PX: u32 = 1;
/// Outer radius of the ring drawn around a real mismatch, in pixels.
const RING_PX: u32 = 7;

/// Draws the pixels of `comparison`. The faces of `oracle` are seen by `projection`, light where both methods
/// agree on lit, dark where they agree on shadowed. Every other pixel is a square of 3 × 3 in its verdict's
/// color, the most serious on top. A real mismatch also gets a ring with dark rims. [`verdict_color`] has
/// what the colors mean.
///
/// `progress` is called with the number of rows done, from any thread. Cost: one ray per pixel. Memory: 4
/// bytes per pixel.
///
/// # Errors
///
/// [`MemoryError`] if this memory cannot be allocated.
pub fn verdicts(
    oracle: &Oracle,
    projection: &Projection,
    comparison: &Comparison,
    progress: &(dyn Fn(u64) + Sync),
) -> Result<Picture, MemoryError> {
    let size = comparison.size;
    let width = size.width() as usize;
    let rays = Rays::new(projection, size);
    let near = f64::from(projection.near);
    let mut picture = Picture { size, pixels: buffer(size, [0; 4])? };
    parallel::rows(&mut picture.pixels, width, |y, row| {
        for (x, pixel) in row.iter_mut().enumerate() {
            let verdict = comparison.verdicts[y * width + x];
            let position = [x, y].map(|i| i as f64 + 0.5);
            let part = position[1] / f64::from(size.height());
            *pixel = agreeing(oracle, &rays, near, position, verdict)
                .unwrap_or_else(|| color::encode(BELOW.lerp(ABOVE, (1.0 - part) as f32)));
        }
        progress(1);
    });
    let at = |verdict| {
        let places = (0..).zip(&comparison.verdicts).filter(move |(_, other)| **other == verdict);
        places.map(move |(place, _): (u32, _)| [place % size.width(), place / size.width()])
    };
    // The rims of all rings come first: they must not cover the colored part of another ring.
    let reach = i64::from(RING_PX);
    for (color, radii) in
        [([30; 3], reach - 3..reach + 1), (verdict_color(PixelVerdict::Real).1, reach - 2..reach)]
    {
        let squared = radii.start * radii.start..radii.end * radii.end;
        for place in at(PixelVerdict::Real) {
            draw(&mut picture, place, RING_PX, color, |distance| squared.contains(&distance));
        }
    }
    for verdict in [PixelVerdict::Grazing, PixelVerdict::Unsure, PixelVerdict::Overflow, PixelVerdict::Real] {
        for place in at(verdict) {
            draw(&mut picture, place, DOT_PX, verdict_color(verdict).1, |_| true);
        }
    }
    Ok(picture)
}

/// The surface seen through a pixel's center, shaded by the angle between surface and ray.
fn agreeing(
    oracle: &Oracle,
    rays: &Rays,
    near: f64,
    [x, y]: [f64; 2],
    verdict: PixelVerdict,
) -> Option<[u8; 4]> {
    let ray = rays.ray(x, y);
    let seen = oracle.first_visible_beyond(ray.origin, ray.direction, near)?;
    let [a, b, c] = seen.corners.map(|corner| DVec3::from(corner.map(f64::from)));
    let normal = (b - a).cross(c - a).normalize_or_zero();
    let facing = normal.dot(rays.direction(x, y).normalize_or_zero()).abs() as f32;
    let gray = verdict_color(if verdict == PixelVerdict::Shadowed { verdict } else { PixelVerdict::Lit }).1;
    let [r, g, b] = (Vec3::from(gray.map(f32::from)) * (EDGE_ON + (1.0 - EDGE_ON) * facing)).to_array();
    Some([r as u8, g as u8, b as u8, 255])
}

/// Sets the pixels within `reach` in both directions whose squared distance is `wanted`.
fn draw(picture: &mut Picture, [x, y]: [u32; 2], reach: u32, color: [u8; 3], wanted: impl Fn(i64) -> bool) {
    let side = |at: u32, most: u32| at.saturating_sub(reach)..(at + reach + 1).min(most);
    let (width, height) = (picture.size.width(), picture.size.height());
    for v in side(y, height) {
        for u in side(x, width) {
            let (dx, dy) = (i64::from(u) - i64::from(x), i64::from(v) - i64::from(y));
            if wanted(dx * dx + dy * dy) {
                let [r, g, b] = color;
                picture.pixels[v as usize * width as usize + u as usize] = [r, g, b, 255];
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::shapes;
    use crate::view::{Camera, Size, Up};

    #[test]
    fn verdicts_stand_out_of_what_agrees_and_the_gravest_is_on_top() {
        let mesh = shapes::icosphere(2);
        let oracle = Oracle::build(&mesh);
        let size = Size::new(96, 80).unwrap();
        let camera = Camera::fit(&oracle.bounds(), Up::Y, size.aspect());
        let projection = camera.projection(size, camera.near([&mesh], size));
        let mut comparison =
            Comparison { size, verdicts: vec![PixelVerdict::Lit; size.pixels()], mismatches: Vec::new() };
        let at = |x: usize, y: usize| y * 96 + x;
        let draw = |comparison: &Comparison| verdicts(&oracle, &projection, comparison, &|_| {}).unwrap();
        let plain = draw(&comparison);
        comparison.verdicts[at(40, 40)] = PixelVerdict::Shadowed;
        let shadowed = draw(&comparison);
        assert!(shadowed.pixels[at(40, 40)][0] < plain.pixels[at(40, 40)][0] / 2);

        comparison.verdicts[at(50, 40)] = PixelVerdict::Real;
        comparison.verdicts[at(51, 40)] = PixelVerdict::Grazing;
        comparison.verdicts[0] = PixelVerdict::Real; // its ring is cut at the corner
        let picture = draw(&comparison);
        let count = |color: [u8; 3]| picture.pixels.iter().filter(|pixel| pixel[..3] == color).count();
        let [real, grazing] = [PixelVerdict::Real, PixelVerdict::Grazing].map(|v| verdict_color(v).1);
        assert!(count(real) > 100, "{}", count(real));
        // One column of the grazing square shows beside the real one.
        assert_eq!(count(grazing), 3);
        assert_eq!(picture.pixels[at(51, 40)][..3], real);
    }

    #[test]
    fn verdict_colors_differ_in_brightness() {
        let mut bright: Vec<f64> = PixelVerdict::ALL[3..]
            .iter()
            .map(|&verdict| {
                let [r, g, b] = verdict_color(verdict).1.map(f64::from);
                0.2126 * r + 0.7152 * g + 0.0722 * b
            })
            .collect();
        bright.sort_by(f64::total_cmp);
        assert!(bright.windows(2).all(|pair| pair[1] - pair[0] > 15.0), "{bright:?}");
    }
}
