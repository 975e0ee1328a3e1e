//! Bytes as small decisions. What is missing at the end reads as zero, so that every input means something.

pub(crate) struct Bytes<'a>(&'a [u8]);

impl<'a> Bytes<'a> {
    pub(crate) fn new(data: &'a [u8]) -> Self {
        Self(data)
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    pub(crate) fn byte(&mut self) -> u8 {
        match self.0.split_first() {
            Some((&first, rest)) => {
                self.0 = rest;
                first
            }
            None => 0,
        }
    }

    /// Up to `most` bytes.
    pub(crate) fn take(&mut self, most: usize) -> &'a [u8] {
        let (taken, rest) = self.0.split_at(most.min(self.0.len()));
        self.0 = rest;
        taken
    }

    /// A number below `bound`, which is 1 to 256.
    pub(crate) fn below(&mut self, bound: usize) -> usize {
        usize::from(self.byte()) % bound
    }

    /// A finite coordinate: mostly on a small grid, so that ties are common; else next to it, far from it in
    /// magnitude, or any number at all.
    pub(crate) fn coordinate(&mut self) -> f32 {
        let byte = self.byte();
        let grid = f32::from(byte % 9) - 4.0;
        match byte / 9 {
            0..=20 => grid,
            21 => grid.next_up(),
            22 => grid.next_down(),
            23 => grid * 1e-40,
            24 => grid * 8e37,
            25 => f32::from(self.byte()) / 16.0 - 8.0,
            _ => {
                let bits = u32::from_le_bytes([self.byte(), self.byte(), self.byte(), self.byte()]);
                let any = f32::from_bits(bits);
                if any.is_finite() { any } else { f32::from_bits(bits & !(1 << 30)) }
            }
        }
    }

    /// A place in space.
    pub(crate) fn place(&mut self) -> [f32; 3] {
        [self.coordinate(), self.coordinate(), self.coordinate()]
    }
}
