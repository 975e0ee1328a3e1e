//! Pictures with the visibility that any technique computed on the CPU.

use glam::Vec3;

use super::{MemoryError, Picture, View, buffer, color, color_at};
use crate::parallel;
use crate::shadow::{Samples, Visibility};
use crate::view::Rays;

/// The picture of `samples`, with the visibility of each lamp that a technique computed. Twin of
/// `render_visibility`, which does the same on a device.
///
/// Shading is that of [`render`](super::render), but every pixel is the mean of its samples. `visibility` has
/// one entry per lamp of `view`, in their order. [`View::casters`] and [`View::edge_samples`] are not used:
/// the samples have been chosen already. With the feature `parallel`, rows are shared among threads; the
/// bytes do not depend on the number of threads.
///
/// # Errors
///
/// [`MemoryError`] if four bytes per pixel cannot be allocated.
///
/// # Panics
///
/// Panics if `samples` are of another size than `view`, or if there is not one visibility of these samples
/// per lamp.
///
/// ```
/// use umbrage::caster::{Caster, CasterGroup};
/// use umbrage::scene::Lamp;
/// use umbrage::render::{CLAY, ShadedLight, View, render_samples};
/// use umbrage::shadow::{Request, Samples, Technique};
/// use umbrage::testing::shapes;
/// use umbrage::view::{Camera, Size, Up};
///
/// let caster = Caster::new(shapes::cube());
/// let casters = CasterGroup::new(vec![&caster]);
/// let (lamp, size) = ("point:3,5,4".parse::<Lamp>()?, Size::new(32, 24)?);
/// let camera = Camera::fit(&casters.bounds(), Up::Y, size.aspect());
/// let projection = camera.projection(size, camera.near([caster.mesh()], size));
/// let samples = Samples::of_view(&casters, &projection, size, 2)?;
/// let dark = Technique::Dark.shade(&Request { casters: &casters, lamp: &lamp, samples: &samples })?;
/// let lamps = ShadedLight::equal(&[*lamp.light()]);
/// let view = View {
///     camera,
///     size,
///     lamps: &lamps,
///     casters: None,
///     up: Up::Y,
///     ground: None,
///     paint: &|_| CLAY,
///     edge_samples: 1,
///     ambient: None,
/// };
/// let picture = render_samples(&samples, &view, &[dark])?;
/// assert_eq!(picture.pixels.len(), 32 * 24);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn render_samples(
    samples: &Samples,
    view: &View<'_>,
    visibility: &[Visibility],
) -> Result<Picture, MemoryError> {
    assert_eq!(samples.size(), view.size, "samples of another view");
    assert_eq!(visibility.len(), view.lamps.len(), "one visibility per lamp");
    assert!(visibility.iter().all(|lamp| lamp.values().len() == samples.len()), "of other samples");
    let rays = Rays::new(samples.projection(), view.size);
    let (width, n) = (view.size.width() as usize, samples.per_side() as usize);
    let mut pixels = buffer(view.size, [0; 4])?;
    parallel::rows(&mut pixels, width, |y, row| {
        for (x, pixel) in row.iter_mut().enumerate() {
            let mut sum = Vec3::ZERO;
            for (i, j) in (0..n * n).map(|k| (x * n + k % n, y * n + k / n)) {
                let at = [i, j].map(|i| (i as f64 + 0.5) / n as f64);
                let index = j * samples.row_len() + i;
                let seen = samples.hits()[index].as_ref();
                let light = color_at(view, &rays, at, seen, |lamp, _| visibility[lamp].values()[index]);
                sum += light.min(Vec3::ONE); // cut at white first, lest one highlight outweigh the others
            }
            *pixel = color::encode(sum / (n * n) as f32);
        }
    });
    Ok(Picture { size: view.size, pixels })
}

#[cfg(test)]
mod tests {
    use crate::caster::{Caster, CasterGroup};
    use crate::geom::Light;
    use crate::mesh::Mesh;
    use crate::render::{CLAY, Picture, ShadedLight, View, render, render_samples};
    use crate::shadow::{Request, Samples, Technique};
    use crate::testing::shapes;
    use crate::view::{Camera, Size, Up};

    /// The same view by rays and from samples whose visibility a technique computed.
    fn both(technique: Technique, shadow: bool) -> [Picture; 2] {
        let floor = shapes::translated(&shapes::scaled(&shapes::sheet(1), 8.0), [-4.0, -4.0, -1.5]);
        let seen = Caster::new(Mesh::concat(&[shapes::cube(), floor]).unwrap());
        let caster = Caster::new(shapes::cube());
        let casters = CasterGroup::new(vec![&caster]).seen_with(&seen);
        let size = Size::new(48, 36).unwrap();
        let camera = Camera::look_at([4.0, -6.0, 5.0], [0.0; 3], 0.9, Up::Z).unwrap();
        let samples = Samples::of_view(&casters, &camera.projection(size, 0.1), size, 1).unwrap();
        let light = Light::point([2.0, -3.0, 5.0]).unwrap();
        let request = Request { casters: &casters, lamp: &light.into(), samples: &samples };
        let visibility = technique.shade(&request).unwrap();
        let mut lamps = ShadedLight::equal(&[light]);
        lamps[0].shadow = shadow;
        let view = View {
            camera,
            size,
            lamps: &lamps,
            casters: Some(casters.oracle()),
            up: Up::Z,
            ground: None,
            paint: &|_| CLAY,
            edge_samples: 1,
            ambient: None,
        };
        let exact = render(casters.seen(), &view, &|_| {}).unwrap();
        [exact, render_samples(&samples, &view, &[visibility]).unwrap()]
    }

    #[test]
    fn picture_of_samples_is_that_of_rays_if_the_visibility_is_exact() {
        for technique in [Technique::Rays, Technique::Stencil, Technique::ZFail] {
            let [exact, samples] = both(technique, true);
            assert_eq!(exact, samples, "{technique}");
        }
        let [unshadowed, none] = both(Technique::None, false);
        assert_eq!(unshadowed, none);
        // Each can fail: no shadow is not the shadow, and dark is darker.
        let [exact, dark] = both(Technique::Dark, true);
        assert!(exact != none && exact != dark && none != dark);
    }

    #[test]
    fn picture_of_receivers_has_no_shadow_of_theirs() {
        // Light from below the floor: it lies between the lamp and the cube, and lets the light through.
        let floor = shapes::translated(&shapes::scaled(&shapes::sheet(1), 8.0), [-4.0, -4.0, -1.5]);
        let (cube, seen) = (shapes::cube(), Mesh::concat(&[shapes::cube(), floor]).unwrap());
        let [cube, seen] = [cube, seen].map(Caster::new);
        let light = Light::point([2.0, -3.0, -5.0]).unwrap();
        let size = Size::new(24, 18).unwrap();
        let projection =
            Camera::look_at([4.0, -6.0, 0.0], [0.0; 3], 0.5, Up::Z).unwrap().projection(size, 0.1);
        let lit = |casters: &CasterGroup<'_>| {
            let samples = Samples::of_view(casters, &projection, size, 1).unwrap();
            let request = Request { casters, lamp: &light.into(), samples: &samples };
            let visibility = Technique::Rays.shade(&request).unwrap();
            visibility.values().iter().filter(|&&value| value == 1.0).count()
        };
        assert_eq!(lit(&CasterGroup::new(vec![&seen])), 0);
        assert!(lit(&CasterGroup::new(vec![&cube]).seen_with(&seen)) > 50);
    }
}
