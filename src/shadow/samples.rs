//! The visible points that techniques are asked about.

use crate::caster::CasterGroup;
use crate::oracle::PrimaryHit;
use crate::view::{Projection, Size};

/// The visible points of a view: an exact primary hit per sample, `samples²` of them per pixel.
///
/// Samples come in rows from the top, each from the left, as pixels of a picture that is `samples` times as wide and as
/// high.
#[derive(Clone, Debug)]
pub struct Samples {
    projection: Projection,
    size: Size,
    per_side: u32,
    hits: Vec<Option<PrimaryHit>>,
}

/// Why there are no [`Samples`]: they do not fit the memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0} visible points do not fit the memory; choose a smaller size, or fewer samples per pixel")]
pub struct TooManySamples(pub usize);

impl Samples {
    /// Casts a ray through the middle of each sample. What is nearer than the near plane is not seen.
    ///
    /// About 1 µs per sample and thread for a mesh of 10⁵ faces; 72 bytes per sample. On several threads with the
    /// feature `parallel`.
    ///
    /// # Errors
    ///
    /// [`TooManySamples`] if those bytes are not to be had.
    pub fn of_view(
        casters: &CasterGroup<'_>,
        projection: &Projection,
        size: Size,
        per_side: u32,
    ) -> Result<Self, TooManySamples> {
        let per_side = per_side.max(1);
        let count = size.pixels().saturating_mul((per_side as usize).saturating_pow(2));
        let mut hits = Vec::new();
        hits.try_reserve_exact(count).map_err(|_| TooManySamples(count))?;
        hits.resize(count, None);
        let [width, height] = [size.width(), size.height()].map(|side| side as usize * per_side as usize);
        let oracle = casters.oracle();
        crate::parallel::rows(&mut hits, width, |y, row| {
            for (x, hit) in row.iter_mut().enumerate() {
                let [x, y] = [(x, width), (y, height)].map(|(i, n)| 2.0 * (i as f64 + 0.5) / n as f64 - 1.0);
                let direction = projection.ray([x, -y].into()).as_vec3().into();
                *hit = oracle.first_visible_beyond(projection.eye, direction, projection.near.into());
            }
        });
        Ok(Self { projection: *projection, size, per_side, hits })
    }

    /// The camera.
    #[must_use]
    pub fn projection(&self) -> &Projection {
        &self.projection
    }

    /// How many pixels the view has.
    #[must_use]
    pub fn size(&self) -> Size {
        self.size
    }

    /// Samples along each side of a pixel.
    #[must_use]
    pub fn per_side(&self) -> u32 {
        self.per_side
    }

    /// One entry per sample; `None` where nothing is seen.
    #[must_use]
    pub fn hits(&self) -> &[Option<PrimaryHit>] {
        &self.hits
    }

    /// How many samples there are.
    #[must_use]
    pub fn len(&self) -> usize {
        self.hits.len()
    }

    /// Never, since a picture has a pixel.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.hits.is_empty()
    }

    /// Samples in a row.
    pub(crate) fn row_len(&self) -> usize {
        self.size.width() as usize * self.per_side as usize
    }

    /// The samples of one row.
    pub(crate) fn row(&self, row: usize) -> &[Option<PrimaryHit>] {
        &self.hits[row * self.row_len()..][..self.row_len()]
    }
}
