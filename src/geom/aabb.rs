//! Axis-aligned boxes with exact `f32` bounds.

/// A closed axis-aligned bounding box.
///
/// ```
/// use umbrage::geom::Aabb;
/// let aabb = Aabb::around([[0.0, 0.0, 0.0], [2.0, 3.0, 6.0], [1.0, 1.0, 1.0]]);
/// assert_eq!((aabb.low, aabb.high), ([0.0; 3], [2.0, 3.0, 6.0]));
/// assert_eq!((aabb.center(), aabb.diagonal()), ([1.0, 1.5, 3.0], 7.0));
/// assert!(aabb.contains([2.0, 0.0, 5.0]) && !aabb.contains([2.5, 0.0, 5.0]));
/// assert!(Aabb::EMPTY.is_empty() && Aabb::EMPTY.join(&aabb) == aabb);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aabb {
    /// Corner with the smallest coordinates.
    pub low: [f32; 3],
    /// Corner with the largest coordinates.
    pub high: [f32; 3],
}

impl Aabb {
    /// The empty box, the identity of [`Aabb::join`].
    pub const EMPTY: Self = Self { low: [f32::INFINITY; 3], high: [f32::NEG_INFINITY; 3] };

    /// Smallest box around points; [`Aabb::EMPTY`] for no points.
    #[must_use]
    pub fn around(points: impl IntoIterator<Item = [f32; 3]>) -> Self {
        points.into_iter().fold(Self::EMPTY, |aabb, p| aabb.join(&Self { low: p, high: p }))
    }

    /// Smallest box around both boxes.
    #[inline]
    #[must_use]
    pub fn join(&self, other: &Self) -> Self {
        // A loop, since closures on arrays are not always inlined.
        let mut all = *self;
        for i in 0..3 {
            all.low[i] = all.low[i].min(other.low[i]);
            all.high[i] = all.high[i].max(other.high[i]);
        }
        all
    }

    /// Whether two closed boxes have a point in common.
    #[inline]
    #[must_use]
    pub fn overlaps(&self, other: &Self) -> bool {
        (0..3).all(|i| self.low[i] <= other.high[i] && other.low[i] <= self.high[i])
    }

    /// Whether `point` lies in the closed box.
    #[inline]
    #[must_use]
    pub fn contains(&self, point: [f32; 3]) -> bool {
        (0..3).all(|i| self.low[i] <= point[i] && point[i] <= self.high[i])
    }

    /// Whether `other` lies in this closed box.
    #[must_use]
    pub fn contains_box(&self, other: &Self) -> bool {
        (0..3).all(|i| self.low[i] <= other.low[i] && other.high[i] <= self.high[i])
    }

    /// Whether the box contains no point.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        (0..3).any(|i| self.low[i] > self.high[i])
    }

    /// Length of the diagonal, in `f64`, where it cannot overflow; 0 for an empty box.
    #[must_use]
    pub fn diagonal(&self) -> f64 {
        if self.is_empty() {
            return 0.0;
        }
        (0..3).map(|i| (f64::from(self.high[i]) - f64::from(self.low[i])).powi(2)).sum::<f64>().sqrt()
    }

    /// Center, rounded to `f32`; the origin for an empty box.
    #[must_use]
    pub fn center(&self) -> [f32; 3] {
        if self.is_empty() {
            return [0.0; 3];
        }
        std::array::from_fn(|i| (0.5 * (f64::from(self.low[i]) + f64::from(self.high[i]))) as f32)
    }
}
