//! Samples: the visible points at which techniques compute visibility.

use crate::caster::CasterGroup;
use crate::mesh::FaceId;
use crate::oracle::{ExpectedHits, PrimaryHit};
use crate::view::{Projection, Ray, Rays, Size};

/// The visible points of a view: one exact primary hit per sample, `per_side`² samples per pixel.
///
/// Samples are stored in rows from the top, each row from the left, like the pixels of a picture that is
/// `per_side` times as wide and as high.
#[derive(Clone, Debug)]
pub struct Samples {
    projection: Projection,
    size: Size,
    per_side: u32,
    hits: Vec<Option<PrimaryHit>>,
}

/// Error of [`Samples`] that do not fit the memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0} visible points do not fit the memory; choose a smaller size, or fewer samples per pixel")]
pub struct TooManySamples(pub usize);

impl Samples {
    /// Casts a ray through the center of each sample. Surfaces nearer than the near plane are not seen.
    ///
    /// Cost: about 1 µs per sample and thread for a mesh of 10⁵ faces. Memory: 72 bytes per sample. With the
    /// feature `parallel`, rows are shared among threads.
    ///
    /// # Errors
    ///
    /// [`TooManySamples`] if this memory cannot be allocated.
    pub fn of_view(
        casters: &CasterGroup<'_>,
        projection: &Projection,
        size: Size,
        per_side: u32,
    ) -> Result<Self, TooManySamples> {
        let oracle = casters.seen();
        Self::of_rays(projection, size, per_side, |_, ray, near| {
            oracle.first_visible_beyond(ray.origin, ray.direction, near)
        })
    }

    /// The same samples, faster where it is known which face a sample probably sees, by its number among
    /// those of [`CasterGroup::seen`]: from a rasterizer, or from the frame before. `expected` has an entry
    /// per sample, in their order; missing and wrong ones cost time and change nothing.
    ///
    /// # Errors
    ///
    /// As [`Samples::of_view`].
    pub fn of_view_expecting(
        casters: &CasterGroup<'_>,
        projection: &Projection,
        size: Size,
        per_side: u32,
        expected: &[Option<FaceId>],
    ) -> Result<Self, TooManySamples> {
        let (oracle, hits) = (casters.seen(), ExpectedHits::of(casters.seen()));
        Self::of_rays(projection, size, per_side, |index, ray, near| match expected.get(index) {
            Some(&Some(face)) => hits.first_visible_beyond(face, ray.origin, ray.direction, near),
            _ => oracle.first_visible_beyond(ray.origin, ray.direction, near),
        })
    }

    /// `hit` is given the number of a sample, its ray, and the near plane.
    fn of_rays(
        projection: &Projection,
        size: Size,
        per_side: u32,
        hit_of: impl Fn(usize, Ray, f64) -> Option<PrimaryHit> + Sync,
    ) -> Result<Self, TooManySamples> {
        let per_side = per_side.max(1);
        let count = size.pixels().saturating_mul((per_side as usize).saturating_pow(2));
        let mut hits = Vec::new();
        hits.try_reserve_exact(count).map_err(|_| TooManySamples(count))?;
        hits.resize(count, None);
        let width = size.width() as usize * per_side as usize;
        let rays = Rays::new(projection, size);
        crate::parallel::rows(&mut hits, width, |y, row| {
            for (x, hit) in row.iter_mut().enumerate() {
                let index = y * width + x;
                let [x, y] = [x, y].map(|i| (i as f64 + 0.5) / f64::from(per_side));
                *hit = hit_of(index, rays.ray(x, y), projection.near.into());
            }
        });
        Ok(Self { projection: *projection, size, per_side, hits })
    }

    /// Some visible points, as samples of the same camera: in rows of 256, the last one filled up with
    /// nothing.
    ///
    /// What looks at neighbors in the picture finds others.
    pub(crate) fn of_points(&self, points: &[PrimaryHit]) -> Self {
        const ROW: usize = 256;
        let width = points.len().clamp(1, ROW);
        let height = points.len().div_ceil(width).clamp(1, Size::MOST as usize);
        let mut hits: Vec<Option<PrimaryHit>> =
            points.iter().take(width * height).copied().map(Some).collect();
        hits.resize(width * height, None);
        let size = Size::new(width as u32, height as u32).expect("within the bounds of a size");
        Self { projection: self.projection, size, per_side: 1, hits }
    }

    /// The projection of the view.
    #[must_use]
    pub fn projection(&self) -> &Projection {
        &self.projection
    }

    /// Size of the view in pixels.
    #[must_use]
    pub fn size(&self) -> Size {
        self.size
    }

    /// Samples along each side of a pixel.
    #[must_use]
    pub fn per_side(&self) -> u32 {
        self.per_side
    }

    /// Primary hits, one entry per sample; `None` where nothing is seen.
    #[must_use]
    pub fn hits(&self) -> &[Option<PrimaryHit>] {
        &self.hits
    }

    /// Number of samples.
    #[must_use]
    pub fn len(&self) -> usize {
        self.hits.len()
    }

    /// Always false, since a view has at least one pixel.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.hits.is_empty()
    }

    /// The same samples, but nothing is seen where `keep` does not hold.
    pub(crate) fn only(&self, keep: impl Fn(&PrimaryHit) -> bool) -> Self {
        let hits = self.hits.iter().map(|hit| hit.filter(&keep)).collect();
        Self { hits, ..*self }
    }

    /// Number of samples per row.
    pub(crate) fn row_len(&self) -> usize {
        self.size.width() as usize * self.per_side as usize
    }

    /// The samples of one row.
    pub(crate) fn row(&self, row: usize) -> &[Option<PrimaryHit>] {
        &self.hits[row * self.row_len()..][..self.row_len()]
    }
}
