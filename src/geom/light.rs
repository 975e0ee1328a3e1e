//! Point lights and directional lights as one homogeneous type.

use std::fmt;
use std::str::FromStr;

/// A point light or a directional light, in homogeneous coordinates `(x, y, z, w)`.
///
/// With `w = 1`, a point light at (x, y, z). With `w = 0`, a directional light: (x, y, z) points *towards*
/// the light. Coordinates are finite, and a direction is not zero.
///
/// ```
/// use umbrage::geom::Light;
/// assert_eq!(Light::point([4.0, 5.0, 6.0])?.homogeneous(), [4.0, 5.0, 6.0, 1.0]);
/// // The light travels down, so the light is up.
/// assert_eq!(Light::directional([0.0, -1.0, 0.0])?.homogeneous(), [0.0, 1.0, 0.0, 0.0]);
/// assert_eq!("directional:0,-1,0".parse::<Light>()?, Light::directional([0.0, -1.0, 0.0])?);
/// # Ok::<(), umbrage::geom::LightError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Light {
    xyz: [f32; 3],
    at_infinity: bool,
}

/// Reason why coordinates or a text do not make a [`Light`].
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LightError {
    /// A coordinate is NaN or infinite.
    #[error("a light needs finite coordinates, not {0}")]
    NotFinite(f32),
    /// The direction has length zero.
    #[error("a directional light needs a direction that is not 0,0,0")]
    ZeroDirection,
    /// The text is not `point:X,Y,Z` or `directional:X,Y,Z`.
    #[error("`{0}` is not a light; write point:X,Y,Z or directional:X,Y,Z (the way the light travels)")]
    Syntax(String),
}

impl Light {
    /// A point light at `position`.
    ///
    /// # Errors
    ///
    /// [`LightError::NotFinite`] if a coordinate is NaN or infinite.
    pub fn point(position: [f32; 3]) -> Result<Self, LightError> {
        Ok(Self { xyz: finite(position)?, at_infinity: false })
    }

    /// A directional light whose rays travel along `travel`, of any length but zero. Only this function
    /// negates the direction, so that the stored one points *towards* the light.
    ///
    /// # Errors
    ///
    /// [`LightError::NotFinite`] if a coordinate is NaN or infinite, [`LightError::ZeroDirection`] if all are
    /// zero.
    pub fn directional(travel: [f32; 3]) -> Result<Self, LightError> {
        let travel = finite(travel)?;
        if travel == [0.0; 3] {
            return Err(LightError::ZeroDirection);
        }
        Ok(Self { xyz: travel.map(|x| 0.0 - x), at_infinity: true })
    }

    /// Position of a point light, or direction towards a directional light.
    #[inline]
    #[must_use]
    pub fn xyz(&self) -> [f32; 3] {
        self.xyz
    }

    /// Whether the light is directional, `w = 0`.
    #[inline]
    #[must_use]
    pub fn is_directional(&self) -> bool {
        self.at_infinity
    }

    /// The homogeneous coordinates `(x, y, z, w)`.
    #[must_use]
    pub fn homogeneous(&self) -> [f32; 4] {
        let [x, y, z] = self.xyz;
        [x, y, z, if self.at_infinity { 0.0 } else { 1.0 }]
    }
}

fn finite(xyz: [f32; 3]) -> Result<[f32; 3], LightError> {
    match xyz.iter().find(|x| !x.is_finite()) {
        Some(&x) => Err(LightError::NotFinite(x)),
        None => Ok(xyz.map(|x| x + 0.0)),
    }
}

/// The notation of the command line: `point:X,Y,Z`, or `directional:X,Y,Z` with the direction in which the
/// light travels.
impl fmt::Display for Light {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [x, y, z] = if self.at_infinity { self.xyz.map(|x| 0.0 - x) } else { self.xyz };
        write!(f, "{}:{x},{y},{z}", if self.at_infinity { "directional" } else { "point" })
    }
}

impl FromStr for Light {
    type Err = LightError;

    fn from_str(text: &str) -> Result<Self, LightError> {
        let syntax = || LightError::Syntax(text.to_owned());
        let (kind, coordinates) = text.split_once(':').ok_or_else(syntax)?;
        let numbers: Vec<f32> = coordinates
            .split(',')
            .map(|x| x.trim().parse().map_err(|_| syntax()))
            .collect::<Result<_, _>>()?;
        let xyz = numbers.try_into().map_err(|_| syntax())?;
        match kind.trim() {
            "point" => Self::point(xyz),
            "directional" => Self::directional(xyz),
            _ => Err(syntax()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn light_prints_as_it_is_parsed() {
        for text in ["point:1,2,3", "directional:0,-1,0.5", "point:1e30,-0.25,0"] {
            let light: Light = text.parse().unwrap();
            assert_eq!(light.to_string().parse::<Light>().unwrap(), light);
        }
        assert_eq!("directional:0,-1,0".parse::<Light>().unwrap().homogeneous(), [0.0, 1.0, 0.0, 0.0]);
        assert_eq!("point:4,5,6".parse::<Light>().unwrap().homogeneous(), [4.0, 5.0, 6.0, 1.0]);
    }

    #[test]
    fn light_refuses_what_is_none() {
        assert_eq!("directional:0,-0,0".parse::<Light>(), Err(LightError::ZeroDirection));
        assert!(matches!("point:1,nan,2".parse::<Light>(), Err(LightError::NotFinite(_))));
        for text in ["", "point", "point:1,2", "point:1,2,3,4", "spot:1,2,3", "point:a,b,c"] {
            assert!(matches!(text.parse::<Light>(), Err(LightError::Syntax(_))), "{text}");
        }
    }
}
