//! The split of a range of boxes in two, by the surface area heuristic.

use super::super::Aabb;

/// Largest number of primitives per leaf.
pub(super) const LEAF: usize = 4;
/// Cost of a box test, in units of the cost of a primitive.
const BOX_COST: f64 = 1.0;
/// Number of levels that the surface area heuristic may split: more than scattered boxes need.
const DEEPEST_BY_AREA: u32 = 64;

/// A box as two vectors of four; the last elements do not belong to the box.
#[derive(Clone, Copy)]
#[repr(align(16))]
pub(super) struct Bounds {
    low: [f32; 4],
    high: [f32; 4],
}

impl Bounds {
    const EMPTY: Self = Self { low: [f32::INFINITY; 4], high: [f32::NEG_INFINITY; 4] };

    #[inline(always)]
    fn add(&mut self, other: &Self) {
        // Without `min` and `max`, which also test for NaN.
        for i in 0..4 {
            self.low[i] = if other.low[i] < self.low[i] { other.low[i] } else { self.low[i] };
            self.high[i] = if other.high[i] > self.high[i] { other.high[i] } else { self.high[i] };
        }
    }

    pub(super) fn aabb(&self) -> Aabb {
        let three = |[x, y, z, _]: [f32; 4]| [x, y, z];
        Aabb { low: three(self.low), high: three(self.high) }
    }

    /// Half the surface area, in `f64`, where it cannot overflow.
    #[inline(always)]
    fn half_area(&self) -> f64 {
        let x = f64::from(self.high[0]) - f64::from(self.low[0]);
        let y = f64::from(self.high[1]) - f64::from(self.low[1]);
        let z = f64::from(self.high[2]) - f64::from(self.low[2]);
        x * y + y * z + z * x
    }
}

/// Half the surface area of a box that is not empty.
pub(super) fn half_area(aabb: &Aabb) -> f64 {
    Item::new(aabb, 0).0.half_area()
}

/// A box while the tree is built. Its index is stored in the last element of `low`, with one bit inverted so
/// that the element is never a subnormal number, which some processors handle slowly.
#[derive(Clone, Copy)]
pub(super) struct Item(Bounds);

const TURNED: u32 = 1 << 30;

impl Item {
    #[inline(always)]
    pub(super) fn new(&Aabb { low, high }: &Aabb, index: u32) -> Self {
        Self(Bounds {
            low: [low[0], low[1], low[2], f32::from_bits(index ^ TURNED)],
            high: [high[0], high[1], high[2], 0.0],
        })
    }

    pub(super) fn index(&self) -> u32 {
        self.0.low[3].to_bits() ^ TURNED
    }

    /// Half the center of the box, rounded: the difference of two keys cannot overflow. Rounding affects only
    /// the quality of the tree.
    #[inline(always)]
    fn key(&self, axis: usize) -> f32 {
        0.25 * self.0.low[axis] + 0.25 * self.0.high[axis]
    }

    #[inline(always)]
    fn keys(&self) -> [f32; 4] {
        let mut keys = [0.0; 4];
        for i in 0..4 {
            keys[i] = 0.25 * self.0.low[i] + 0.25 * self.0.high[i];
        }
        keys
    }
}

/// Bounds of a range of items: of their boxes, and of their keys.
#[derive(Clone, Copy)]
pub(super) struct Hull {
    pub(super) boxes: Bounds,
    keys: Bounds,
}

impl Hull {
    const EMPTY: Self = Self { boxes: Bounds::EMPTY, keys: Bounds::EMPTY };

    pub(super) fn of(items: &[Item]) -> Self {
        let mut hull = Self::EMPTY;
        items.iter().for_each(|item| hull.add(item));
        hull
    }

    #[inline(always)]
    fn add(&mut self, item: &Item) {
        self.boxes.add(&item.0);
        let keys = item.keys();
        self.keys.add(&Bounds { low: keys, high: keys });
    }
}

/// Partitions the items of a node, and returns the number of items on the left and the bounds of both sides.
/// `None` for a leaf.
pub(super) fn split(items: &mut [Item], hull: &Hull, depth: u32) -> Option<(usize, [Hull; 2])> {
    if items.len() == 1 {
        return None;
    }
    let extent = |axis: usize| hull.keys.high[axis] - hull.keys.low[axis];
    let axis = (1..3).fold(0, |best, axis| if extent(axis) > extent(best) { axis } else { best });
    // A normal number: neither 0 nor so small that its inverse is infinite.
    let apart = extent(axis) > 16.0 * f32::MIN_POSITIVE;
    if apart && depth < DEEPEST_BY_AREA {
        return if items.len() <= FEW { by_order(items, hull, axis) } else { by_area(items, hull, axis) };
    }
    if items.len() <= LEAF {
        return None;
    }
    let half = items.len() / 2;
    if apart {
        items.select_nth_unstable_by(half, |a, b| {
            a.key(axis).total_cmp(&b.key(axis)).then(a.index().cmp(&b.index()))
        });
    }
    let (left, right) = items.split_at(half);
    Some((half, [Hull::of(left), Hull::of(right)]))
}

/// Largest number of items that are sorted instead of binned.
const FEW: usize = 8;

/// The best of all splits between two neighbors along `axis`.
fn by_order(items: &mut [Item], hull: &Hull, axis: usize) -> Option<(usize, [Hull; 2])> {
    for at in 1..items.len() {
        let item = items[at];
        let key = item.key(axis);
        let mut place = at;
        while place > 0 && items[place - 1].key(axis) > key {
            items[place] = items[place - 1];
            place -= 1;
        }
        items[place] = item;
    }
    let mut right = [0.0; FEW];
    let mut bounds = Bounds::EMPTY;
    for at in (1..items.len()).rev() {
        bounds.add(&items[at].0);
        right[at] = bounds.half_area() * (items.len() - at) as f64;
    }
    let mut bounds = Bounds::EMPTY;
    let mut best = (f64::INFINITY, 1);
    for at in 1..items.len() {
        bounds.add(&items[at - 1].0);
        let total = bounds.half_area() * at as f64 + right[at];
        if total < best.0 {
            best = (total, at);
        }
    }
    let (total, left) = best;
    if items.len() <= LEAF && hull.boxes.half_area() * (items.len() as f64 - BOX_COST) <= total {
        return None;
    }
    Some((left, [Hull::of(&items[..left]), Hull::of(&items[left..])]))
}

/// The best of 15 bin boundaries along `axis`.
fn by_area(items: &mut [Item], hull: &Hull, axis: usize) -> Option<(usize, [Hull; 2])> {
    const BINS: usize = 16;
    let low = hull.keys.low[axis];
    // Slightly less than the scale that would put the highest key into bin `BINS`.
    let scale = BINS as f32 * (1.0 - 4.0 * f32::EPSILON) / (hull.keys.high[axis] - low);
    let bin = |item: &Item| ((item.key(axis) - low) * scale) as usize & (BINS - 1);
    let mut bins = [(Bounds::EMPTY, 0_usize); BINS];
    for item in items.iter() {
        let (bounds, count) = &mut bins[bin(item)];
        bounds.add(&item.0);
        *count += 1;
    }
    // Cost of the items on the right of each plane, from the right; then of those on the left, from the left.
    let mut right = [(f64::INFINITY, 0); BINS];
    let (mut bounds, mut count) = (Bounds::EMPTY, 0);
    for plane in (1..BINS).rev() {
        bounds.add(&bins[plane].0);
        count += bins[plane].1;
        right[plane] = (bounds.half_area() * count as f64, count);
    }
    let (mut bounds, mut count) = (Bounds::EMPTY, 0);
    let mut best = (f64::INFINITY, 0);
    for plane in 1..BINS {
        bounds.add(&bins[plane - 1].0);
        count += bins[plane - 1].1;
        let total = bounds.half_area() * count as f64 + right[plane].0;
        if count > 0 && right[plane].1 > 0 && total < best.0 {
            best = (total, plane);
        }
    }
    let plane = best.1;
    let mut hulls = [Hull::EMPTY; 2];
    let (mut left, mut end) = (0, items.len());
    while left < end {
        let item = items[left];
        let keys = item.keys();
        let keys = Bounds { low: keys, high: keys };
        if bin(&item) < plane {
            hulls[0].keys.add(&keys);
            left += 1;
        } else {
            hulls[1].keys.add(&keys);
            end -= 1;
            items.swap(left, end);
        }
    }
    bins[..plane].iter().for_each(|(bounds, _)| hulls[0].boxes.add(bounds));
    bins[plane..].iter().for_each(|(bounds, _)| hulls[1].boxes.add(bounds));
    Some((left, hulls))
}
