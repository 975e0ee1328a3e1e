//! Options of the planar techniques.

use super::Plane;
use crate::shadow::options::{Key, Options, set_number};

const PLANE_KEY: Key =
    Key { name: "plane", takes: "`most`, or a plane A/B/C/D: the numbers of A·x + B·y + C·z + D = 0" };

/// The plane that receives the shadow.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Ground {
    /// The plane with most samples that are seen and face the lamp.
    #[default]
    Most,
    /// A given plane.
    Given(Coefficients),
}

/// The numbers A, B, C, D of a plane A·x + B·y + C·z + D = 0, of which A, B and C are not all zero.
///
/// ```
/// use umbrage::shadow::planar::Coefficients;
/// let ground = Coefficients::new([0.0, 0.0, 1.0, -2.0]).unwrap();
/// assert_eq!(ground.plane().height([5.0, 6.0, 3.0]), 1.0);
/// assert_eq!(Coefficients::new([0.0, 0.0, 0.0, 1.0]), None);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Coefficients([u64; 4]);

impl Coefficients {
    /// The coefficients of a plane; `None` if the numbers are those of none.
    #[must_use]
    pub fn new(numbers: [f64; 4]) -> Option<Self> {
        // −0 becomes 0, so that equal planes have equal bits.
        Plane::new(numbers).map(|_| Self(numbers.map(|number| (number + 0.0).to_bits())))
    }

    /// The four numbers.
    #[must_use]
    pub fn numbers(self) -> [f64; 4] {
        self.0.map(f64::from_bits)
    }

    /// The plane.
    ///
    /// # Panics
    ///
    /// Never: only the numbers of a plane are kept.
    #[must_use]
    pub fn plane(self) -> Plane {
        Plane::new(self.numbers()).expect("the numbers of a plane")
    }
}

impl Ground {
    fn get(self) -> String {
        match self {
            Self::Most => "most".to_owned(),
            Self::Given(given) => given.numbers().map(|number| number.to_string()).join("/"),
        }
    }

    fn set(&mut self, value: &str) -> bool {
        let numbers =
            || value.split('/').map(|number| number.trim().parse().ok()).collect::<Option<Vec<_>>>();
        let given = || Coefficients::new(numbers()?.try_into().ok()?).map(Self::Given);
        let ground = if value == "most" { Some(Self::Most) } else { given() };
        ground.map(|ground| *self = ground).is_some()
    }
}

/// Options of `planar`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct PlanarOptions {
    /// The plane that receives the shadow.
    pub plane: Ground,
}

impl PlanarOptions {
    /// The plane with most samples.
    pub const DEFAULT: Self = Self { plane: Ground::Most };
}

impl Options for PlanarOptions {
    const KEYS: &'static [Key] = &[PLANE_KEY];

    fn get(&self, _: &str) -> String {
        self.plane.get()
    }

    fn set(&mut self, _: &str, value: &str) -> bool {
        self.plane.set(value)
    }
}

/// Options of `planar-layers`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct LayersOptions {
    /// Number of light points, 1 to 1024: planar shadows of which the mean is taken.
    pub n: u32,
    /// The plane that receives the shadow.
    pub plane: Ground,
}

impl LayersOptions {
    /// 16 light points, and the plane with most samples.
    pub const DEFAULT: Self = Self { n: 16, plane: Ground::Most };
}

impl Default for LayersOptions {
    fn default() -> Self {
        Self::DEFAULT
    }
}

impl Options for LayersOptions {
    const KEYS: &'static [Key] = &[Key { name: "n", takes: "a number from 1 to 1024" }, PLANE_KEY];

    fn get(&self, key: &str) -> String {
        if key == "n" { self.n.to_string() } else { self.plane.get() }
    }

    fn set(&mut self, key: &str, value: &str) -> bool {
        if key == "n" { set_number(&mut self.n, value, 1..=1024) } else { self.plane.set(value) }
    }
}

/// Options of the techniques with a texture: `planar-blur`, `planar-contact` and `projective`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct TextureOptions {
    /// Side of the texture in texels, 1 to [`MOST_TEXELS`].
    pub size: u32,
    /// The plane that receives the shadow.
    pub plane: Ground,
}

/// Largest side of a texture: its sums take 270 MB.
pub const MOST_TEXELS: u32 = 4096;

impl TextureOptions {
    /// 1024², and the plane with most samples.
    pub const DEFAULT: Self = Self { size: 1024, plane: Ground::Most };
}

impl Default for TextureOptions {
    fn default() -> Self {
        Self::DEFAULT
    }
}

impl Options for TextureOptions {
    const KEYS: &'static [Key] = &[Key { name: "size", takes: "a number from 1 to 4096" }, PLANE_KEY];

    fn get(&self, key: &str) -> String {
        if key == "size" { self.size.to_string() } else { self.plane.get() }
    }

    fn set(&mut self, key: &str, value: &str) -> bool {
        if key == "size" { set_number(&mut self.size, value, 1..=MOST_TEXELS) } else { self.plane.set(value) }
    }
}
