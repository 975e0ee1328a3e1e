//! A translucent surface over a picture.

use super::Picture;
use crate::geom::Light;
use crate::oracle::Oracle;
use crate::parallel;
use crate::view::Camera;

/// How much of what is behind it one layer hides.
const OPACITY: f32 = 0.12;
/// How far before a visible point its segment to the eye starts, as a part of the diagonal: a surface that
/// touches what is seen, as a light cap does, is then behind all of it.
const LIFT: f64 = 1e-3;

/// Tints each pixel of a picture that `camera` made of `seen`: once for each face of `glass` in front of what
/// the pixel shows.
///
/// `progress` is called with the number of rows done, from any thread. Cost: two rays per pixel.
///
/// ```
/// use umbrage::oracle::Oracle;
/// use umbrage::render::{Overlay, veil};
/// use umbrage::testing::shapes;
/// use umbrage::view::{Camera, Size, Up};
///
/// let seen = Oracle::build(&shapes::octahedron());
/// let glass = Oracle::build(&shapes::cube());
/// let size = Size::new(48, 36).unwrap();
/// let camera = Camera::fit(&glass.bounds(), Up::Y, size.aspect());
/// let plain = Overlay::default().render_from(camera, &seen, Up::Y, size, &|_| {})?;
/// let mut tinted = plain.clone();
/// veil(&mut tinted, &camera, &seen, &glass, [40, 70, 200], &|_| {});
/// assert!(tinted != plain && tinted.pixels[0] == plain.pixels[0]);
/// # Ok::<(), umbrage::render::MemoryError>(())
/// ```
pub fn veil(
    picture: &mut Picture,
    camera: &Camera,
    seen: &Oracle,
    glass: &Oracle,
    color: [u8; 3],
    progress: &(dyn Fn(u64) + Sync),
) {
    let rays = camera.rays(picture.size);
    let bounds = seen.bounds().join(&glass.bounds());
    let lift = LIFT * seen.bounds().diagonal();
    parallel::rows(&mut picture.pixels, picture.size.width() as usize, |y, row| {
        for (x, pixel) in row.iter_mut().enumerate() {
            let ray = rays.ray(x as f64 + 0.5, y as f64 + 0.5);
            let along = ray.direction.map(f64::from);
            let length = along.iter().map(|d| d * d).sum::<f64>().sqrt();
            // Beyond everything, where nothing is seen.
            let corners = [bounds.low, bounds.high];
            let reach = corners.iter().map(|corner| distance(*corner, ray.origin)).sum::<f64>();
            let hit = seen.first_hit(ray.origin, ray.direction);
            let t = hit.map_or(2.0 * reach / length, |hit| hit.t - lift / length);
            let point = [0, 1, 2].map(|i| (f64::from(ray.origin[i]) + t * along[i]) as f32);
            // An eye out of range sees no glass.
            let Ok(eye) = Light::point(ray.origin) else { continue };
            let between = if point.iter().all(|x| x.is_finite()) && t > 0.0 {
                let crossed = glass.crossings(point, &eye);
                crossed.front + crossed.back
            } else {
                0
            };
            let clear = (1.0 - OPACITY).powi(between.min(64) as i32);
            for (under, over) in pixel.iter_mut().zip(color) {
                *under = (clear * f32::from(*under) + (1.0 - clear) * f32::from(over) + 0.5) as u8;
            }
        }
        progress(1);
    });
}

fn distance(p: [f32; 3], q: [f32; 3]) -> f64 {
    (0..3).map(|i| (f64::from(p[i]) - f64::from(q[i])).powi(2)).sum::<f64>().sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::Mesh;
    use crate::render::Overlay;
    use crate::testing::shapes;
    use crate::view::{Size, Up};

    #[test]
    fn veil_counts_the_layers_in_front_and_none_behind() {
        let seen = Oracle::build(&shapes::cuboid([-1.0, -1.0, -1.0], [1.0, 1.0, 1.0]));
        let size = Size::new(33, 33).unwrap();
        let camera = Camera::look_at([0.0, 0.0, 9.0], [0.0, 0.0, 0.0], 0.5, Up::Y).unwrap();
        let middle = 16 * 33 + 16;
        let plain = Overlay::default().render_from(camera, &seen, Up::Y, size, &|_| {}).unwrap();
        // Sheets at these heights, too small to be seen beside the cube.
        let blue = |heights: &[f32]| {
            let sheet = |&z: &f32| {
                let corners = vec![[-0.5, -0.5, z], [0.5, -0.5, z], [0.6, 0.7, z], [-0.5, 0.5, z]];
                Mesh::new(corners, vec![[0, 1, 2], [0, 2, 3]]).unwrap()
            };
            let sheets: Vec<Mesh> = heights.iter().map(sheet).collect();
            let glass = Oracle::build(&Mesh::concat(&sheets).unwrap());
            let mut picture = plain.clone();
            veil(&mut picture, &camera, &seen, &glass, [0, 0, 255], &|_| {});
            assert_eq!(picture.pixels[0], plain.pixels[0]);
            picture.pixels[middle]
        };
        let under = plain.pixels[middle];
        let tinted = |layers: i32| {
            let clear = (1.0 - OPACITY).powi(layers);
            (clear * f32::from(under[0]) + 0.5) as u8
        };
        assert_eq!(blue(&[2.0])[0], tinted(1));
        assert_eq!(blue(&[2.0, 3.0, 4.0])[0], tinted(3));
        // Behind the front of the cube, on it, and behind the eye.
        assert_eq!(blue(&[0.0, -2.0, 1.0, 10.0]), under);
        // Fault injected: a layer that is not counted is missed.
        assert_ne!(blue(&[2.0, 3.0])[0], tinted(3));
    }
}
