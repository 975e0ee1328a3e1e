//! Options of the technique `counter`.

use crate::shadow::options::{Key, Options, set_number};

/// Options of the technique `counter`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct CounterOptions {
    /// Samples along each side of a tile, 1 to 64.
    pub tile: u32,
}

impl CounterOptions {
    /// Tiles of 8 × 8 samples.
    pub const DEFAULT: Self = Self { tile: 8 };
}

impl Default for CounterOptions {
    fn default() -> Self {
        Self::DEFAULT
    }
}

impl Options for CounterOptions {
    const KEYS: &'static [Key] = &[Key { name: "tile", takes: "a number from 1 to 64" }];

    fn get(&self, _: &str) -> String {
        self.tile.to_string()
    }

    fn set(&mut self, _: &str, value: &str) -> bool {
        set_number(&mut self.tile, value, 1..=64)
    }
}
