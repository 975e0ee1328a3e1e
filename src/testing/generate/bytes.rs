//! Choices out of bytes, for fuzz targets.

use super::Draw;

/// Bytes as small choices. What is missing at the end reads as 0, so that every input means something.
#[derive(Clone, Debug)]
pub struct Bytes<'a>(&'a [u8]);

impl<'a> Bytes<'a> {
    /// All of `data`, from its start.
    #[must_use]
    pub fn new(data: &'a [u8]) -> Self {
        Self(data)
    }

    /// Whether no byte is left.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// The next byte.
    pub fn byte(&mut self) -> u8 {
        self.take(1).first().copied().unwrap_or(0)
    }

    /// Up to `most` bytes.
    pub fn take(&mut self, most: usize) -> &'a [u8] {
        let (taken, rest) = self.0.split_at(most.min(self.0.len()));
        self.0 = rest;
        taken
    }

    /// Bytes as an integer, the lowest first.
    fn integer(&mut self, bytes: u32) -> u32 {
        (0..bytes).map(|i| u32::from(self.byte()) << (8 * i)).sum()
    }
}

impl Draw for Bytes<'_> {
    /// One byte, where that is enough, modulo `n`; else two or four. The first choices are the likelier ones.
    fn below(&mut self, n: u32) -> u32 {
        let bytes = match n {
            0..=0x100 => 1,
            0x101..=0x1_0000 => 2,
            _ => 4,
        };
        self.integer(bytes) % n
    }

    /// A multiple of 2⁻³², of four bytes.
    fn unit(&mut self) -> f64 {
        f64::from(self.integer(4)) * 0.5_f64.powi(32)
    }
}
