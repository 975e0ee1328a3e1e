//! Options of the map techniques.

use super::{Bias, DepthSource, Filter, MAX_SIZE, MapError};
use crate::shadow::options::{Key, Options, set_number};

/// What a map covers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Fit {
    /// All that casts or is seen.
    #[default]
    Scene,
    /// What the camera sees, for a directional light; drawn for every view. The map of a lamp at a position
    /// is that of the scene.
    View,
}

impl Fit {
    /// Name on the command line.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Scene => "scene",
            Self::View => "view",
        }
    }
}

/// Options of the technique `map`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct MapOptions {
    /// Side of the map in texels, 1 to [`MAX_SIZE`].
    pub size: u32,
    /// What the map covers.
    pub fit: Fit,
    /// Number of slices of the view that have maps of their own with [`Fit::View`], 1 to 4.
    pub cascades: u32,
    /// The bias.
    pub bias: Bias,
    /// Where the depth of a texel comes from. [`Bias::Offset`] needs [`DepthSource::Interpolated`].
    pub depth: DepthSource,
    /// The filter.
    pub filter: Filter,
}

/// Options of the technique `pcf`: those of `map`, with a wider filter.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct PcfOptions(
    /// The options; the filter is the kernel.
    pub MapOptions,
);

/// Options of the techniques `map-ids` and `hybrid-3x3`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct ExactOptions {
    /// Side of the map in texels, 1 to [`MAX_SIZE`].
    pub size: u32,
    /// Texels on each side of the lookup's: 1 reads 3 × 3.
    pub reach: u32,
}

/// Options of the technique `hybrid-2x2`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct NearestOptions {
    /// Side of the map in texels, 1 to [`MAX_SIZE`].
    pub size: u32,
}

/// Side of a map by default.
const SIZE: u32 = 1024;
/// Largest reach in texels.
const MAX_REACH: u32 = 16;

impl MapOptions {
    /// 1024², fitted to the scene, texel bias (on scanned and built meshes it errs least), bilinear.
    pub const DEFAULT: Self = Self {
        size: SIZE,
        fit: Fit::Scene,
        cascades: 1,
        bias: Bias::Texel,
        depth: DepthSource::Plane,
        filter: Filter::Bilinear,
    };
}

impl PcfOptions {
    /// Those of [`MapOptions::DEFAULT`], with a box of 3 × 3.
    pub const DEFAULT: Self = Self(MapOptions { filter: Filter::Box3, ..MapOptions::DEFAULT });
}

impl ExactOptions {
    /// 1024², 3 × 3 texels.
    pub const DEFAULT: Self = Self { size: SIZE, reach: 1 };

    pub(super) fn checked_reach(&self) -> Result<i64, MapError> {
        let Self { reach, .. } = *self;
        (1..=MAX_REACH).contains(&reach).then_some(i64::from(reach)).ok_or(MapError::Reach { reach })
    }
}

impl NearestOptions {
    /// 1024².
    pub const DEFAULT: Self = Self { size: SIZE };
}

impl Default for NearestOptions {
    fn default() -> Self {
        Self::DEFAULT
    }
}

impl Options for NearestOptions {
    const KEYS: &'static [Key] = &[SIZE_KEY];

    fn get(&self, _: &str) -> String {
        self.size.to_string()
    }

    fn set(&mut self, _: &str, value: &str) -> bool {
        set_number(&mut self.size, value, 1..=MAX_SIZE)
    }
}

impl Default for MapOptions {
    fn default() -> Self {
        Self::DEFAULT
    }
}

impl Default for PcfOptions {
    fn default() -> Self {
        Self::DEFAULT
    }
}

impl Default for ExactOptions {
    fn default() -> Self {
        Self::DEFAULT
    }
}

const SIZE_KEY: Key = Key { name: "size", takes: "a number from 1 to 16384" };
const FIT_KEY: Key = Key { name: "fit", takes: "scene or view" };
const CASCADES_KEY: Key = Key { name: "cascades", takes: "a number from 1 to 4" };
const BIAS_KEY: Key =
    Key { name: "bias", takes: "receiver, texel, constant, offset, range, normal or second" };
const DEPTH_KEY: Key = Key { name: "depth", takes: "plane or interpolated (with bias=offset: interpolated)" };

impl Options for MapOptions {
    const KEYS: &'static [Key] = &[
        SIZE_KEY,
        FIT_KEY,
        CASCADES_KEY,
        BIAS_KEY,
        DEPTH_KEY,
        Key { name: "filter", takes: "nearest or bilinear" },
    ];

    fn get(&self, key: &str) -> String {
        match key {
            "size" => self.size.to_string(),
            "fit" => self.fit.name().to_owned(),
            "cascades" => self.cascades.to_string(),
            "bias" => self.bias.to_string(),
            "depth" => self.depth.name().to_owned(),
            _ => self.filter.to_string(),
        }
    }

    /// `bias=offset` also sets `depth=interpolated`, which it needs.
    fn set(&mut self, key: &str, value: &str) -> bool {
        match key {
            "size" => set_number(&mut self.size, value, 1..=MAX_SIZE),
            "fit" => choose(&mut self.fit, value, &[Fit::Scene, Fit::View], Fit::name),
            "cascades" => set_number(&mut self.cascades, value, 1..=4),
            "bias" => {
                let is_set = choose(&mut self.bias, value, &Bias::ALL, Bias::name);
                if self.bias == Bias::Offset {
                    self.depth = DepthSource::Interpolated;
                }
                is_set
            }
            "depth" if self.bias == Bias::Offset => value == DepthSource::Interpolated.name(),
            "depth" => {
                let sources = [DepthSource::Plane, DepthSource::Interpolated];
                choose(&mut self.depth, value, &sources, DepthSource::name)
            }
            _ => choose(&mut self.filter, value, &[Filter::Nearest, Filter::Bilinear], Filter::name),
        }
    }
}

impl Options for PcfOptions {
    const KEYS: &'static [Key] = &[
        SIZE_KEY,
        FIT_KEY,
        CASCADES_KEY,
        BIAS_KEY,
        DEPTH_KEY,
        Key { name: "kernel", takes: "box3, box5, tent3, tent5, poisson16 or poisson64" },
    ];

    fn get(&self, key: &str) -> String {
        self.0.get(key)
    }

    fn set(&mut self, key: &str, value: &str) -> bool {
        match key {
            "kernel" => choose(&mut self.0.filter, value, &Filter::ALL[2..], Filter::name),
            _ => self.0.set(key, value),
        }
    }
}

impl Options for ExactOptions {
    const KEYS: &'static [Key] = &[SIZE_KEY, Key { name: "reach", takes: "a number from 1 to 16" }];

    fn get(&self, key: &str) -> String {
        let value = if key == "size" { self.size } else { self.reach };
        value.to_string()
    }

    fn set(&mut self, key: &str, value: &str) -> bool {
        match key {
            "size" => set_number(&mut self.size, value, 1..=MAX_SIZE),
            _ => set_number(&mut self.reach, value, 1..=MAX_REACH),
        }
    }
}

/// Sets `choice` to the one of `among` with this name; whether there is one.
fn choose<T: Copy>(choice: &mut T, name: &str, among: &[T], name_of: fn(T) -> &'static str) -> bool {
    let found = among.iter().copied().find(|&one| name_of(one) == name);
    found.map(|found| *choice = found).is_some()
}

#[cfg(test)]
mod tests {
    use crate::shadow::Technique;

    #[test]
    fn options_of_maps_parse_and_print() {
        for (text, printed) in [
            ("map:size=77,fit=view,filter=nearest", "map:size=77,fit=view,filter=nearest"),
            ("pcf:fit=view,cascades=3", "pcf:fit=view,cascades=3"),
            ("map:bias=receiver,depth=interpolated", "map:bias=receiver,depth=interpolated"),
            ("map:bias=offset", "map:bias=offset,depth=interpolated"), // what it needs
            ("map:size=1024,bias=texel", "map"),
            ("pcf:kernel=box3", "pcf"),
            ("pcf:kernel=poisson16,bias=second", "pcf:bias=second,kernel=poisson16"),
            ("map-ids:size=16384,reach=16", "map-ids:size=16384,reach=16"),
            ("hybrid-3x3:reach=2", "hybrid-3x3:reach=2"),
        ] {
            let technique: Technique = text.parse().unwrap();
            assert_eq!(technique.to_string(), printed);
            assert_eq!(printed.parse(), Ok(technique));
        }
    }

    #[test]
    fn options_of_maps_that_are_wrong_are_named_with_what_there_is() {
        let error = |text: &str| text.parse::<Technique>().unwrap_err().to_string();
        assert_eq!(
            error("map:kernel=box3"),
            "`map` has no option `kernel`; it has size, fit, cascades, bias, depth, filter"
        );
        for size in ["0", "16385", "-3", "1e3", "", "99999999999999"] {
            let expected = format!("map-ids:size={size}: `{size}` is not a number from 1 to 16384");
            assert_eq!(error(&format!("map-ids:size={size}")), expected);
        }
        assert_eq!(error("map:filter=box3"), "map:filter=box3: `box3` is not nearest or bilinear");
        assert_eq!(
            error("map:bias=0.01"),
            "map:bias=0.01: `0.01` is not receiver, texel, constant, offset, range, normal or second"
        );
        assert_eq!(
            error("pcf:bias=offset,depth=plane"),
            "pcf:depth=plane: `plane` is not plane or interpolated (with bias=offset: interpolated)"
        );
        assert_eq!(
            error("pcf:kernel=bilinear"),
            "pcf:kernel=bilinear: `bilinear` is not box3, box5, tent3, tent5, poisson16 or poisson64"
        );
        assert_eq!(error("hybrid-3x3:reach=17"), "hybrid-3x3:reach=17: `17` is not a number from 1 to 16");
    }
}
