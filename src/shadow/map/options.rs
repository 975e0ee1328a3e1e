//! Options of the map techniques, as the command line writes them: `key=value`.

use std::fmt;

use super::{Bias, DepthSource, Filter, MAX_SIZE, MapError};

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

/// Options of the technique `map`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct MapOptions {
    /// Side of the map in texels, 1 to [`MAX_SIZE`].
    pub size: u32,
    /// What the map covers.
    pub fit: Fit,
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

/// Side of a map by default.
const SIZE: u32 = 1024;
/// Largest reach.
const MAX_REACH: u32 = 16;

impl Default for MapOptions {
    fn default() -> Self {
        Self {
            size: SIZE,
            fit: Fit::Scene,
            bias: Bias::Receiver,
            depth: DepthSource::Plane,
            filter: Filter::Bilinear,
        }
    }
}

impl Default for PcfOptions {
    fn default() -> Self {
        Self(MapOptions { filter: Filter::Box3, ..MapOptions::default() })
    }
}

impl Default for ExactOptions {
    fn default() -> Self {
        Self { size: SIZE, reach: 1 }
    }
}

/// Why a key and a value are no option.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum OptionError {
    /// There is no such key.
    #[error("no option `{key}`; there are {keys}")]
    UnknownKey {
        /// The key.
        key: String,
        /// All keys.
        keys: &'static str,
    },
    /// The key has no such value.
    #[error("`{key}={value}`: write {key}={values}")]
    Value {
        /// The key.
        key: &'static str,
        /// The value.
        value: String,
        /// All values.
        values: &'static str,
    },
}

const SIZES: &str = "1 to 16384";
const BIASES: &str = "receiver, texel, constant, offset, range, normal or second";
const FILTERS: [Filter; 2] = [Filter::Nearest, Filter::Bilinear];
const KERNELS: [Filter; 6] =
    [Filter::Box3, Filter::Box5, Filter::Tent3, Filter::Tent5, Filter::Poisson16, Filter::Poisson64];

impl MapOptions {
    /// The keys.
    pub const KEYS: &'static str = "size, fit, bias, depth, filter";

    /// Sets the value of a key. `bias=offset` also sets `depth=interpolated`, which it needs.
    ///
    /// ```
    /// use umbrage::shadow::map::{Bias, MapOptions};
    /// let mut options = MapOptions::default();
    /// options.set("bias", "texel")?;
    /// assert_eq!(options.bias, Bias::Texel);
    /// assert_eq!(options.to_string(), "size=1024,fit=scene,bias=texel,depth=plane,filter=bilinear");
    /// let error = options.set("size", "0").unwrap_err().to_string();
    /// assert_eq!(error, "`size=0`: write size=1 to 16384");
    /// # Ok::<(), umbrage::shadow::map::OptionError>(())
    /// ```
    ///
    /// # Errors
    ///
    /// [`OptionError`] if there is no such key, or the key has no such value.
    pub fn set(&mut self, key: &str, value: &str) -> Result<(), OptionError> {
        match key {
            "filter" => self.filter = filter("filter", value, &FILTERS, "nearest or bilinear")?,
            _ => self.set_shared(key, value, Self::KEYS)?,
        }
        Ok(())
    }

    fn set_shared(&mut self, key: &str, value: &str, keys: &'static str) -> Result<(), OptionError> {
        let error = |key, values| OptionError::Value { key, value: value.to_owned(), values };
        match key {
            "size" => self.size = number("size", value, MAX_SIZE, SIZES)?,
            "fit" => {
                self.fit = match value {
                    "scene" => Fit::Scene,
                    "view" => Fit::View,
                    _ => return Err(error("fit", "scene or view")),
                }
            }
            "bias" => {
                let found = Bias::ALL.into_iter().find(|bias| bias.name() == value);
                self.bias = found.ok_or_else(|| error("bias", BIASES))?;
                if self.bias == Bias::Offset {
                    self.depth = DepthSource::Interpolated;
                }
            }
            "depth" => {
                self.depth = match value {
                    "interpolated" => DepthSource::Interpolated,
                    "plane" if self.bias != Bias::Offset => DepthSource::Plane,
                    "plane" => return Err(error("depth", "interpolated, which bias=offset needs")),
                    _ => return Err(error("depth", "plane or interpolated")),
                }
            }
            _ => return Err(OptionError::UnknownKey { key: key.to_owned(), keys }),
        }
        Ok(())
    }

    fn shared(&self) -> String {
        let fit = match self.fit {
            Fit::Scene => "scene",
            Fit::View => "view",
        };
        let depth = match self.depth {
            DepthSource::Plane => "plane",
            DepthSource::Interpolated => "interpolated",
        };
        format!("size={},fit={fit},bias={},depth={depth}", self.size, self.bias)
    }
}

impl PcfOptions {
    /// The keys.
    pub const KEYS: &'static str = "size, fit, bias, depth, kernel";

    /// Sets the value of a key, as [`MapOptions::set`].
    ///
    /// # Errors
    ///
    /// [`OptionError`] if there is no such key, or the key has no such value.
    pub fn set(&mut self, key: &str, value: &str) -> Result<(), OptionError> {
        const VALUES: &str = "box3, box5, tent3, tent5, poisson16 or poisson64";
        match key {
            "kernel" => self.0.filter = filter("kernel", value, &KERNELS, VALUES)?,
            _ => self.0.set_shared(key, value, Self::KEYS)?,
        }
        Ok(())
    }
}

impl ExactOptions {
    pub(super) fn checked_reach(&self) -> Result<i64, MapError> {
        let Self { reach, .. } = *self;
        (1..=MAX_REACH).contains(&reach).then_some(i64::from(reach)).ok_or(MapError::Reach { reach })
    }

    /// The keys.
    pub const KEYS: &'static str = "size, reach";

    /// Sets the value of a key.
    ///
    /// # Errors
    ///
    /// [`OptionError`] if there is no such key, or the key has no such value.
    pub fn set(&mut self, key: &str, value: &str) -> Result<(), OptionError> {
        match key {
            "size" => self.size = number("size", value, MAX_SIZE, SIZES)?,
            "reach" => self.reach = number("reach", value, MAX_REACH, "1 to 16")?,
            _ => return Err(OptionError::UnknownKey { key: key.to_owned(), keys: Self::KEYS }),
        }
        Ok(())
    }
}

fn number(key: &'static str, value: &str, most: u32, values: &'static str) -> Result<u32, OptionError> {
    let number = value.parse().ok().filter(|number| (1..=most).contains(number));
    number.ok_or_else(|| OptionError::Value { key, value: value.to_owned(), values })
}

fn filter(
    key: &'static str,
    value: &str,
    among: &[Filter],
    values: &'static str,
) -> Result<Filter, OptionError> {
    let found = among.iter().find(|filter| filter.name() == value);
    found.copied().ok_or_else(|| OptionError::Value { key, value: value.to_owned(), values })
}

impl fmt::Display for MapOptions {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{},filter={}", self.shared(), self.filter)
    }
}

impl fmt::Display for PcfOptions {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{},kernel={}", self.0.shared(), self.0.filter)
    }
}

impl fmt::Display for ExactOptions {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "size={},reach={}", self.size, self.reach)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Sets all of `key=value,…`.
    fn set_all(text: &str, mut set: impl FnMut(&str, &str) -> Result<(), OptionError>) -> Result<(), String> {
        let pairs = text.split(',').map(|pair| pair.split_once('=').unwrap());
        pairs
            .map(|(key, value)| set(key, value))
            .collect::<Result<(), _>>()
            .map_err(|error| error.to_string())
    }

    #[test]
    fn options_print_as_they_are_set() {
        for bias in Bias::ALL {
            let depth = if bias == Bias::Offset { "interpolated" } else { "plane" };
            for (fit, filter) in [("scene", "nearest"), ("view", "bilinear")] {
                let text = format!("size=77,fit={fit},bias={bias},depth={depth},filter={filter}");
                let mut options = MapOptions::default();
                set_all(&text, |key, value| options.set(key, value)).unwrap();
                assert_eq!(options.to_string(), text);
            }
        }
        for kernel in KERNELS {
            let text = format!("size=1,fit=scene,bias=texel,depth=interpolated,kernel={kernel}");
            let mut options = PcfOptions::default();
            set_all(&text, |key, value| options.set(key, value)).unwrap();
            assert_eq!(options.to_string(), text);
        }
        let mut options = ExactOptions::default();
        set_all("size=16384,reach=16", |key, value| options.set(key, value)).unwrap();
        assert_eq!(options, ExactOptions { size: 16_384, reach: 16 });
        assert_eq!(options.to_string(), "size=16384,reach=16");
    }

    #[test]
    fn options_that_are_wrong_are_named_with_what_there_is() {
        let of_map = |text: &str| {
            let mut options = MapOptions::default();
            set_all(text, |key, value| options.set(key, value)).unwrap_err()
        };
        assert_eq!(of_map("kernel=box3"), "no option `kernel`; there are size, fit, bias, depth, filter");
        for text in ["size=0", "size=16385", "size=-3", "size=1e3", "size=", "size=99999999999999"] {
            assert_eq!(of_map(text), format!("`{text}`: write size=1 to 16384"));
        }
        assert_eq!(of_map("fit=scenes"), "`fit=scenes`: write fit=scene or view");
        assert_eq!(of_map("filter=box3"), "`filter=box3`: write filter=nearest or bilinear");
        assert!(of_map("bias=0.01").starts_with("`bias=0.01`: write bias=receiver, texel"));
        assert_eq!(
            of_map("bias=offset,depth=plane"),
            "`depth=plane`: write depth=interpolated, which bias=offset needs"
        );
        let mut options = PcfOptions::default();
        let error = options.set("kernel", "gauss").unwrap_err().to_string();
        assert_eq!(error, "`kernel=gauss`: write kernel=box3, box5, tent3, tent5, poisson16 or poisson64");
        let mut options = ExactOptions::default();
        for text in ["0", "17", "x"] {
            assert!(options.set("reach", text).unwrap_err().to_string().ends_with("write reach=1 to 16"));
        }
        assert_eq!(
            options.set("bias", "x").unwrap_err().to_string(),
            "no option `bias`; there are size, reach"
        );
    }
}
