//! Options of the soft techniques that read a map.

use crate::shadow::map::MAX_SIZE;
use crate::shadow::options::{Key, Options, set_number};

/// Side of a map by default.
pub(super) const SIZE: u32 = 1024;
pub(super) const SIZE_KEY: Key = Key { name: "size", takes: "a number from 1 to 16384" };
/// Most taps of one lookup.
const MOST_TAPS: u32 = 1024;
const TAPS: &str = "a number from 1 to 1024, or `all`";

/// How many texels of a window are read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Taps {
    /// All, with their areas as weights; of a window wider than 128 texels, 128 along each side.
    All,
    /// As many points, spread evenly.
    Some(u32),
}

impl Taps {
    fn get(self) -> String {
        match self {
            Self::All => "all".to_owned(),
            Self::Some(count) => count.to_string(),
        }
    }

    fn set(&mut self, value: &str) -> bool {
        let mut count = 1;
        let taps = match value {
            "all" => Some(Self::All),
            _ => set_number(&mut count, value, 1..=MOST_TAPS).then_some(Self::Some(count)),
        };
        taps.map(|taps| *self = taps).is_some()
    }
}

pub(super) fn set_size(size: &mut u32, value: &str) -> bool {
    set_number(size, value, 1..=MAX_SIZE)
}

/// Options of `pcss`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct PcssOptions {
    /// Side of the map in texels, 1 to [`MAX_SIZE`].
    pub size: u32,
    /// Texels in which blockers are searched.
    pub blockers: Taps,
    /// Texels of the filter.
    pub taps: Taps,
}

impl PcssOptions {
    /// 1024², 16 and 16 taps.
    pub const DEFAULT: Self = Self { size: SIZE, blockers: Taps::Some(16), taps: Taps::Some(16) };
}

impl Default for PcssOptions {
    fn default() -> Self {
        Self::DEFAULT
    }
}

impl Options for PcssOptions {
    const KEYS: &'static [Key] =
        &[SIZE_KEY, Key { name: "blockers", takes: TAPS }, Key { name: "taps", takes: TAPS }];

    fn get(&self, key: &str) -> String {
        match key {
            "size" => self.size.to_string(),
            "blockers" => self.blockers.get(),
            _ => self.taps.get(),
        }
    }

    fn set(&mut self, key: &str, value: &str) -> bool {
        match key {
            "size" => set_size(&mut self.size, value),
            "blockers" => self.blockers.set(value),
            _ => self.taps.set(value),
        }
    }
}

/// Where the search of `single-sample` runs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Search {
    /// On the CPU.
    #[default]
    Cpu,
    /// On a graphics adapter: `soft::gpu::SearchPass`, with the feature `gpu`. The technique as the CPU
    /// prepares it refuses this.
    Device,
}

/// Options of `single-sample`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct SingleSampleOptions {
    /// Side of the map in texels, 1 to [`MAX_SIZE`].
    pub size: u32,
    /// Side of the blocks of samples that are interpolated where they agree; 0 for none.
    pub adaptive: u32,
    /// Whether the pseudo-code of 2009 is taken word for word.
    pub literal: bool,
    /// Where the search runs.
    pub search: Search,
}

impl SingleSampleOptions {
    /// 1024², every sample on its own.
    pub const DEFAULT: Self = Self { size: SIZE, adaptive: 0, literal: false, search: Search::Cpu };
}

impl Default for SingleSampleOptions {
    fn default() -> Self {
        Self::DEFAULT
    }
}

impl Options for SingleSampleOptions {
    const KEYS: &'static [Key] = &[
        SIZE_KEY,
        Key { name: "adaptive", takes: "0, 2, 4 or 8" },
        Key { name: "literal", takes: "`no` or `yes`" },
        Key { name: "search", takes: "`cpu` or `device`" },
    ];

    fn get(&self, key: &str) -> String {
        match key {
            "size" => self.size.to_string(),
            "adaptive" => self.adaptive.to_string(),
            "literal" => if self.literal { "yes" } else { "no" }.to_owned(),
            _ => if self.search == Search::Device { "device" } else { "cpu" }.to_owned(),
        }
    }

    fn set(&mut self, key: &str, value: &str) -> bool {
        match key {
            "size" => set_size(&mut self.size, value),
            "adaptive" => {
                let side = [0, 2, 4, 8].into_iter().find(|side| side.to_string() == value);
                side.map(|side| self.adaptive = side).is_some()
            }
            "literal" => {
                self.literal = value == "yes";
                value == "yes" || value == "no"
            }
            _ => {
                self.search = if value == "device" { Search::Device } else { Search::Cpu };
                value == "cpu" || value == "device"
            }
        }
    }
}

/// What `soft-hybrid` takes to be sure.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Certain {
    /// All texels that may hide a part of the lamp agree.
    #[default]
    Texels,
    /// Percentage-closer soft shadows of all texels are 0 or 1.
    Pcss,
    /// The first nine rays agree; no map is read.
    Rays,
}

impl Certain {
    const ALL: [(Self, &'static str); 3] =
        [(Self::Texels, "texels"), (Self::Pcss, "pcss"), (Self::Rays, "rays")];
}

/// Options of `soft-hybrid`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct SoftHybridOptions {
    /// Side of the map in texels, 1 to [`MAX_SIZE`].
    pub size: u32,
    /// Number of light points, 1 to 65536.
    pub rays: u32,
    /// What is sure without rays.
    pub certain: Certain,
}

impl SoftHybridOptions {
    /// 1024², 64 rays, all texels.
    pub const DEFAULT: Self = Self { size: SIZE, rays: 64, certain: Certain::Texels };
}

impl Default for SoftHybridOptions {
    fn default() -> Self {
        Self::DEFAULT
    }
}

impl Options for SoftHybridOptions {
    const KEYS: &'static [Key] = &[
        SIZE_KEY,
        Key { name: "rays", takes: "a number from 1 to 65536" },
        Key { name: "certain", takes: "`texels`, `pcss` or `rays`" },
    ];

    fn get(&self, key: &str) -> String {
        match key {
            "size" => self.size.to_string(),
            "rays" => self.rays.to_string(),
            _ => {
                let named = Certain::ALL.iter().find(|(certain, _)| *certain == self.certain);
                named.map_or("", |(_, name)| name).to_owned()
            }
        }
    }

    fn set(&mut self, key: &str, value: &str) -> bool {
        match key {
            "size" => set_size(&mut self.size, value),
            "rays" => set_number(&mut self.rays, value, 1..=1 << 16),
            _ => {
                let named = Certain::ALL.iter().find(|(_, name)| *name == value);
                named.map(|(certain, _)| self.certain = *certain).is_some()
            }
        }
    }
}

/// Options of the techniques that have no more than a map: `vsm`, `msm` and `contact-blur`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct SoftMapOptions {
    /// Side of the map in texels, 1 to [`MAX_SIZE`].
    pub size: u32,
}

impl SoftMapOptions {
    /// 512²: a larger map hardly changes a penumbra, and moments take 16 or 32 bytes per texel.
    pub const DEFAULT: Self = Self { size: 512 };
}

impl Default for SoftMapOptions {
    fn default() -> Self {
        Self::DEFAULT
    }
}

impl Options for SoftMapOptions {
    const KEYS: &'static [Key] = &[SIZE_KEY];

    fn get(&self, _: &str) -> String {
        self.size.to_string()
    }

    fn set(&mut self, _: &str, value: &str) -> bool {
        set_size(&mut self.size, value)
    }
}

/// How light grows from the hard edge outwards.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Profile {
    /// From one half; the other half lies inside the hard shadow.
    #[default]
    Half,
    /// From 0, as published.
    Full,
}

/// Options of `penumbra-map` and `smoothies`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct SilhouetteOptions {
    /// Side of the map in texels, 1 to [`MAX_SIZE`]. The map gives the inner half of penumbrae.
    pub size: u32,
    /// How light grows.
    pub profile: Profile,
}

impl SilhouetteOptions {
    /// 1024², from one half.
    pub const DEFAULT: Self = Self { size: SIZE, profile: Profile::Half };
}

impl Default for SilhouetteOptions {
    fn default() -> Self {
        Self::DEFAULT
    }
}

impl Options for SilhouetteOptions {
    const KEYS: &'static [Key] = &[SIZE_KEY, Key { name: "profile", takes: "`half` or `full`" }];

    fn get(&self, key: &str) -> String {
        match (key, self.profile) {
            ("size", _) => self.size.to_string(),
            (_, Profile::Half) => "half".to_owned(),
            (_, Profile::Full) => "full".to_owned(),
        }
    }

    fn set(&mut self, key: &str, value: &str) -> bool {
        match (key, value) {
            ("size", _) => return set_size(&mut self.size, value),
            (_, "half") => self.profile = Profile::Half,
            (_, "full") => self.profile = Profile::Full,
            _ => return false,
        }
        true
    }
}
