//! Axis-aligned boxes of exact `f32` bounds.

/// A closed axis-aligned box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aabb {
    /// The lowest corner.
    pub low: [f32; 3],
    /// The highest corner.
    pub high: [f32; 3],
}

impl Aabb {
    /// The box that holds nothing; joining it changes nothing.
    pub const EMPTY: Self = Self { low: [f32::INFINITY; 3], high: [f32::NEG_INFINITY; 3] };

    /// The smallest box around points; [`Aabb::EMPTY`] for none.
    #[must_use]
    pub fn around(points: impl IntoIterator<Item = [f32; 3]>) -> Self {
        points.into_iter().fold(Self::EMPTY, |aabb, p| aabb.join(&Self { low: p, high: p }))
    }

    /// The smallest box around both.
    #[inline]
    #[must_use]
    pub fn join(&self, other: &Self) -> Self {
        // (A loop: `from_fn` is not always inlined.)
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

    /// Whether it holds nothing.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        (0..3).any(|i| self.low[i] > self.high[i])
    }

    /// The length of the diagonal, in `f64` so that it cannot overflow; 0 for an empty box.
    #[must_use]
    pub fn diagonal(&self) -> f64 {
        if self.is_empty() {
            return 0.0;
        }
        (0..3).map(|i| (f64::from(self.high[i]) - f64::from(self.low[i])).powi(2)).sum::<f64>().sqrt()
    }

    /// The middle, rounded to `f32`; the origin for an empty box.
    #[must_use]
    pub fn center(&self) -> [f32; 3] {
        if self.is_empty() {
            return [0.0; 3];
        }
        std::array::from_fn(|i| (0.5 * (f64::from(self.low[i]) + f64::from(self.high[i]))) as f32)
    }
}
