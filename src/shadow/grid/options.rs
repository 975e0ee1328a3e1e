//! Options of the techniques of the light grid.

use crate::shadow::options::{Key, Options, set_number};

/// Options of `hybrid` and `alias-free`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct GridOptions {
    /// Number of cells along each side of a view, from 16 to 4096.
    pub grid: u32,
}

impl GridOptions {
    /// 256 cells along each side.
    pub const DEFAULT: Self = Self { grid: 256 };
}

impl Default for GridOptions {
    fn default() -> Self {
        Self::DEFAULT
    }
}

impl Options for GridOptions {
    const KEYS: &'static [Key] = &[Key { name: "grid", takes: "a number from 16 to 4096" }];

    fn get(&self, _: &str) -> String {
        self.grid.to_string()
    }

    fn set(&mut self, _: &str, value: &str) -> bool {
        set_number(&mut self.grid, value, 16..=4096)
    }
}
