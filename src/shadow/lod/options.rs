//! Options of the technique `lod`.

use crate::shadow::options::{Key, Options};

/// Options of the technique `lod`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct LodOptions {
    /// How far vertices may move.
    pub moves: Tolerance,
    /// What decides about the simplified casters.
    pub on: LodOn,
}

/// The largest move of a vertex, as a fraction of the diagonal of its shell's bounding box: from 10⁻⁶ to 1.
///
/// ```
/// use umbrage::shadow::lod::Tolerance;
/// assert_eq!(Tolerance::new(0.02).map(Tolerance::fraction), Some(0.02));
/// assert_eq!(Tolerance::new(0.0), None);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Tolerance(u64);

impl Tolerance {
    /// `None` if the fraction is out of range.
    #[must_use]
    pub fn new(fraction: f64) -> Option<Self> {
        (1e-6..=1.0).contains(&fraction).then_some(Self(fraction.to_bits()))
    }

    /// The fraction.
    #[must_use]
    pub fn fraction(self) -> f64 {
        f64::from_bits(self.0)
    }
}

/// What decides about the simplified casters.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum LodOn {
    /// The exact ray cast.
    Rays,
    /// Shadow volumes, counted by depth fail.
    ZFail,
}

impl LodOn {
    const ALL: [Self; 2] = [Self::Rays, Self::ZFail];

    /// Name on the command line.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Rays => "rays",
            Self::ZFail => "zfail",
        }
    }
}

impl LodOptions {
    /// A hundredth of the diagonal, by rays.
    pub const DEFAULT: Self = Self { moves: Tolerance(0.01_f64.to_bits()), on: LodOn::Rays };
}

impl Default for LodOptions {
    fn default() -> Self {
        Self::DEFAULT
    }
}

impl Options for LodOptions {
    const KEYS: &'static [Key] = &[
        Key { name: "move", takes: "a number from 0.000001 to 1" },
        Key { name: "on", takes: "rays or zfail" },
    ];

    fn get(&self, key: &str) -> String {
        match key {
            "move" => self.moves.fraction().to_string(),
            _ => self.on.name().to_owned(),
        }
    }

    fn set(&mut self, key: &str, value: &str) -> bool {
        match key {
            "move" => {
                let moves = value.parse().ok().and_then(Tolerance::new);
                moves.map(|moves| self.moves = moves).is_some()
            }
            _ => LodOn::ALL.into_iter().find(|on| on.name() == value).map(|on| self.on = on).is_some(),
        }
    }
}
