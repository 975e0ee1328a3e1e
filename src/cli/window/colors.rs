//! False colors: where a technique differs from the truth, and which cap a face belongs to.

use umbrage::caster::CasterGroup;
use umbrage::geom::{Facing, Light};
use umbrage::glam::DVec3;
use umbrage::oracle::{PrimaryHit, Verdict};
use umbrage::render::{Knowledge, Picture};
use umbrage::shadow::{Samples, Visibility};

/// sRGB: too much light, too little, and what the exact ray only grazes.
pub(super) const TOO_LIT: [u8; 3] = [235, 120, 20];
pub(super) const TOO_DARK: [u8; 3] = [30, 90, 220];
pub(super) const GRAZING: [u8; 3] = [240, 205, 40];
/// Faces toward the light, and faces away from it.
pub(super) const LIGHT_CAP: [u8; 3] = [250, 215, 60];
pub(super) const DARK_CAP: [u8; 3] = [50, 80, 190];

/// How much of a lamp's light has to be wrong for the full color of a difference.
const FULL: f32 = 0.25;
/// Brightness where nothing is seen.
const BACKGROUND: f32 = 0.35;
/// Part of a pixel's color that its cap replaces.
const TINT: f32 = 0.45;

/// Paints a picture of samples with the difference of a visibility from the truth: gray where they agree.
pub(super) fn difference(
    picture: &mut Picture,
    samples: &Samples,
    casters: &CasterGroup<'_>,
    light: &Light,
    [shown, truth]: [&Visibility; 2],
    is_hard: bool,
) {
    let forward = DVec3::from(samples.projection().forward.map(f64::from));
    each_pixel(picture, samples, |pixel, of_pixel| {
        let mut sum = [0.0; 3];
        for index in of_pixel.clone() {
            let hit = samples.hits()[index].as_ref();
            let gray = hit.map_or(BACKGROUND, |hit| gray(hit, forward));
            let off = shown.values()[index] - truth.values()[index];
            let color = match hit {
                // The exact ray decides neither way.
                Some(hit) if off != 0.0 && is_hard && grazes(casters, hit, light) => GRAZING,
                _ if off > 0.0 => TOO_LIT,
                _ => TOO_DARK,
            };
            let part = if is_hard && off != 0.0 { 1.0 } else { (off.abs() / FULL).min(1.0) };
            for (sum, color) in sum.iter_mut().zip(color) {
                *sum += 255.0 * gray * (1.0 - part) + f32::from(color) * part;
            }
        }
        let count = of_pixel.count() as f32;
        let [r, g, b] = sum.map(|sum| (sum / count) as u8);
        *pixel = [r, g, b, 255];
    });
}

fn grazes(casters: &CasterGroup<'_>, hit: &PrimaryHit, light: &Light) -> bool {
    casters.oracle().verdict(hit.point, light) == Verdict::Grazing
}

/// A light gray that tells shape: darker where a face is seen from aside.
fn gray(hit: &PrimaryHit, forward: DVec3) -> f32 {
    let [a, b, c] = hit.corners.map(|corner| DVec3::from(corner.map(f64::from)));
    let normal = (b - a).cross(c - a).normalize_or_zero();
    (0.5 + 0.35 * normal.dot(forward).abs()) as f32
}

/// Paints a picture of samples by what is known of each.
pub(super) fn paint_known(picture: &mut Picture, samples: &Samples, known: &[Knowledge]) {
    let forward = DVec3::from(samples.projection().forward.map(f64::from));
    each_pixel(picture, samples, |pixel, of_pixel| {
        let mut sum = [0.0; 3];
        for index in of_pixel.clone() {
            let (color, bright) = match samples.hits()[index].as_ref() {
                Some(hit) => (known[index].color().1, gray(hit, forward) + 0.15),
                None => ([255; 3], BACKGROUND),
            };
            for (sum, color) in sum.iter_mut().zip(color) {
                *sum += f32::from(color) * bright;
            }
        }
        let count = of_pixel.count() as f32;
        let [r, g, b] = sum.map(|sum| (sum / count) as u8);
        *pixel = [r, g, b, 255];
    });
}

/// Tints the faces that cast by the cap that they belong to. `facing` has an entry for each of these.
pub(super) fn tint_caps(picture: &mut Picture, samples: &Samples, facing: &[Facing]) {
    each_pixel(picture, samples, |pixel, of_pixel| {
        let mut cap = None;
        for index in of_pixel {
            let hit = samples.hits()[index].as_ref();
            match hit.and_then(|hit| facing.get(hit.face.index())) {
                Some(Facing::Front) => cap = Some(LIGHT_CAP),
                Some(Facing::Back) => cap = Some(DARK_CAP),
                _ => {}
            }
        }
        for (under, over) in pixel.iter_mut().zip(cap.into_iter().flatten()) {
            *under = (f32::from(*under) * (1.0 - TINT) + f32::from(over) * TINT) as u8;
        }
    });
}

/// Calls `paint` with each pixel and the indices of its samples.
fn each_pixel(picture: &mut Picture, samples: &Samples, paint: impl Fn(&mut [u8; 4], Indices)) {
    let (width, n) = (picture.size.width() as usize, samples.per_side() as usize);
    for (at, pixel) in picture.pixels.iter_mut().enumerate() {
        paint(
            pixel,
            Indices { corner: (at / width * n) * width * n + at % width * n, row: width * n, n, next: 0 },
        );
    }
}

/// The indices of a pixel's samples.
#[derive(Clone)]
struct Indices {
    corner: usize,
    row: usize,
    n: usize,
    next: usize,
}

impl Iterator for Indices {
    type Item = usize;

    fn next(&mut self) -> Option<usize> {
        let k = self.next;
        (k < self.n * self.n).then(|| {
            self.next += 1;
            self.corner + k / self.n * self.row + k % self.n
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use umbrage::caster::Caster;
    use umbrage::shadow::{Claim, Request, Technique};
    use umbrage::testing::shapes;
    use umbrage::view::{Camera, Size, Up};

    #[test]
    fn difference_is_gray_where_a_technique_is_right_and_colored_by_the_sign_where_not() {
        let caster = Caster::new(shapes::cube());
        let casters = CasterGroup::new(vec![&caster]);
        let size = Size::new(16, 12).unwrap();
        let camera = Camera::fit(&casters.bounds(), Up::Y, size.aspect());
        for per_side in [1, 2] {
            let samples = Samples::of_view(&casters, &camera.projection(size, 0.1), size, per_side).unwrap();
            let lamp = "point:3,5,4".parse().unwrap();
            let request = Request { casters: &casters, lamp: &lamp, samples: &samples };
            let truth = Technique::Rays.shade(&request).unwrap();
            let dark = Technique::Dark.shade(&request).unwrap();
            let paint = |shown: [&Visibility; 2]| {
                let mut picture = Picture { size, pixels: vec![[0; 4]; size.pixels()] };
                difference(&mut picture, &samples, &casters, lamp.light(), shown, true);
                picture.pixels
            };
            let middle = 6 * 16 + 8;
            assert!(paint([&truth, &truth]).iter().all(|[r, g, b, _]| r == g && g == b));
            assert_eq!(paint([&dark, &truth])[middle][..3], TOO_DARK);
            assert_eq!(paint([&truth, &dark])[middle][..3], TOO_LIT);
            assert_eq!(paint([&dark, &truth])[0], paint([&truth, &truth])[0], "the background agrees");
            // A little of a soft shadow is a pale color.
            let almost = truth.values().iter().map(|value| value * 0.9).collect();
            let almost = Visibility::from_values(&samples, lamp.light(), almost, Claim::Approximate);
            let mut picture = Picture { size, pixels: vec![[0; 4]; size.pixels()] };
            difference(&mut picture, &samples, &casters, lamp.light(), [&almost, &truth], false);
            let [r, _, b, _] = picture.pixels[middle];
            assert!(b > r && picture.pixels[middle][..3] != TOO_DARK);
        }
    }

    #[test]
    fn caps_of_a_cube_are_tinted_by_the_side_of_the_light() {
        let caster = Caster::new(shapes::cube());
        let casters = CasterGroup::new(vec![&caster]);
        let size = Size::new(16, 12).unwrap();
        let camera = Camera::look_at([0.0, 0.0, 6.0], [0.0; 3], 0.9, Up::Y).unwrap();
        let samples = Samples::of_view(&casters, &camera.projection(size, 0.1), size, 2).unwrap();
        let tinted = |light: &str| {
            let mut picture = Picture { size, pixels: vec![[100, 100, 100, 255]; size.pixels()] };
            tint_caps(&mut picture, &samples, &caster.facing(&light.parse().unwrap()));
            (picture.pixels[6 * 16 + 8], picture.pixels[0])
        };
        let (before, beside) = tinted("directional:0,0,-1");
        assert!(before[0] > before[2] && beside == [100, 100, 100, 255]);
        let (behind, _) = tinted("directional:0,0,1");
        assert!(behind[2] > behind[0]);
    }
}
