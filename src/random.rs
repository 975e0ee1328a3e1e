//! Pseudo-random numbers, the same on every platform, and other sources of choices.

/// SplitMix64 generator: a counter passed through a mixing function. Not for cryptography.
///
/// Steele, Lea & Flood, "Fast splittable pseudorandom number generators", OOPSLA 2014.
#[derive(Clone, Debug)]
pub(crate) struct SplitMix64(
    /// State of the generator. Any value is a good seed.
    pub(crate) u64,
);

impl SplitMix64 {
    /// The next 64 bits.
    pub(crate) fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// A uniform number in [0, 1), a multiple of 2⁻⁵³.
    pub(crate) fn unit(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// A uniform integer below `bound`, which must not be zero. The bias is less than `bound` / 2⁶⁴.
    pub(crate) fn below(&mut self, bound: usize) -> usize {
        ((u128::from(self.next()) * bound as u128) >> 64) as usize
    }

    /// A random permutation of 0 … `count` − 1 (Fisher–Yates shuffle).
    pub(crate) fn permutation(&mut self, count: usize) -> Vec<u32> {
        let mut order: Vec<u32> = (0..count).map(|i| u32::try_from(i).expect("ids have 32 bits")).collect();
        for last in (1..count).rev() {
            order.swap(last, self.below(last + 1));
        }
        order
    }
}

/// The element `index` of a sequence that fills the unit square evenly: the additive recurrence of the
/// plastic number, beginning at the center (Martin Roberts, *The Unreasonable Effectiveness of Quasirandom
/// Sequences*, 2018). Error of a mean over `n` elements: about `n^(−3/4)` for the area of a shape.
pub(crate) fn r2(index: u32) -> [f64; 2] {
    const PLASTIC: f64 = 1.324_717_957_244_746;
    [PLASTIC, PLASTIC * PLASTIC].map(|base| (0.5 + f64::from(index) / base).fract())
}

/// A source of choices.
#[cfg(feature = "verify")]
pub trait Draw {
    /// An integer below `n`, which is not 0. The generators order every choice so that 0 is the simplest.
    fn below(&mut self, n: u32) -> u32;

    /// A number in [0, 1).
    fn unit(&mut self) -> f64;
}

#[cfg(feature = "verify")]
impl Draw for SplitMix64 {
    fn below(&mut self, n: u32) -> u32 {
        Self::below(self, n as usize) as u32 // below `n`
    }

    fn unit(&mut self) -> f64 {
        Self::unit(self)
    }
}

#[cfg(feature = "verify")]
impl dyn Draw + '_ {
    /// An index below `len`, which is 1 to 2³² − 1.
    pub(crate) fn index(&mut self, len: usize) -> usize {
        self.below(len as u32) as usize
    }

    /// One element of a list that is not empty; the first one is the simplest.
    pub(crate) fn pick<T: Copy>(&mut self, list: &[T]) -> T {
        list[self.index(list.len())]
    }

    /// True for one of two choices; false is the simpler one.
    pub(crate) fn flag(&mut self) -> bool {
        self.below(2) == 1
    }

    /// An integer from `low`, at most 0, to `high`, at least 0, in the order 0, 1 … `high`, −1 … `low`.
    pub(crate) fn between(&mut self, low: i32, high: i32) -> i32 {
        let n = self.below((high - low + 1) as u32) as i32;
        if n <= high { n } else { high - n }
    }

    /// A number in (−1, 1); 0 is the simplest.
    pub(crate) fn signed(&mut self) -> f64 {
        let u = self.unit();
        if u < 0.5 { 2.0 * u } else { 1.0 - 2.0 * u }
    }

    /// Any finite `f32`, all exponents alike.
    pub(crate) fn bits(&mut self) -> f32 {
        let bits = self.below(1 << 16) << 16 | self.below(1 << 16);
        let any = f32::from_bits(bits);
        // Without the highest bit of its exponent a number is finite.
        if any.is_finite() { any } else { f32::from_bits(bits & !(1 << 30)) }
    }

    /// A coordinate from −3 to 3: four in five are integers, where exact ties are common.
    pub(crate) fn coordinate(&mut self) -> f32 {
        if self.below(5) < 4 { self.between(-3, 3) as f32 } else { (3.0 * self.signed()) as f32 }
    }

    /// A position: three times `coordinate`.
    pub(crate) fn position(&mut self) -> [f32; 3] {
        [(); 3].map(|()| self.coordinate())
    }

    /// What `item` draws, up to `slots` times and at least `least` times: about one in eight is left out.
    ///
    /// All are drawn, so that to leave one out does not change what the others are drawn from.
    pub(crate) fn list<T>(
        &mut self,
        least: usize,
        slots: usize,
        mut item: impl FnMut(&mut dyn Draw) -> T,
    ) -> Vec<T> {
        let mut items = Vec::with_capacity(slots);
        for left in (1..=slots).rev() {
            let is_kept = self.below(8) > 0 || items.len() + left <= least;
            let item = item(self);
            if is_kept {
                items.push(item);
            }
        }
        items
    }
}

#[cfg(test)]
mod tests {
    use super::SplitMix64;

    #[test]
    fn splitmix64_equals_the_published_sequence() {
        let mut random = SplitMix64(1_234_567);
        let published = [
            6_457_827_717_110_365_317,
            3_203_168_211_198_807_973,
            9_817_491_932_198_370_423,
            4_593_380_528_125_082_431,
            16_408_922_859_458_223_821,
        ];
        assert_eq!([(); 5].map(|()| random.next()), published);
    }

    #[test]
    fn permutation_holds_every_number_once() {
        let mut order = SplitMix64(7).permutation(1000);
        assert_ne!(order, (0..1000).collect::<Vec<_>>());
        order.sort_unstable();
        assert_eq!(order, (0..1000).collect::<Vec<_>>());
    }
}
