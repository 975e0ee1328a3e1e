//! The size of a picture.

use std::fmt;
use std::str::FromStr;

/// Width and height of a picture, each from 1 to [`Size::MOST`] pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Size {
    width: u32,
    height: u32,
}

/// The error for numbers that make no [`Size`].
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("`{0}` is not a size; write WIDTHxHEIGHT, each from 1 to {most} pixels", most = Size::MOST)]
pub struct SizeError(String);

impl Size {
    /// The largest width and height: at 16384 × 16384 the pixels alone take 1 GiB.
    pub const MOST: u32 = 16_384;

    /// A size in pixels. Nothing is allocated.
    ///
    /// # Errors
    ///
    /// [`SizeError`] if a side is 0 or more than [`Size::MOST`].
    pub fn new(width: u32, height: u32) -> Result<Self, SizeError> {
        let sides = 1..=Self::MOST;
        if sides.contains(&width) && sides.contains(&height) {
            Ok(Self { width, height })
        } else {
            Err(SizeError(format!("{width}x{height}")))
        }
    }

    /// Pixels in a row.
    #[must_use]
    pub fn width(self) -> u32 {
        self.width
    }

    /// Rows.
    #[must_use]
    pub fn height(self) -> u32 {
        self.height
    }

    /// Pixels in all.
    #[must_use]
    pub fn pixels(self) -> usize {
        self.width as usize * self.height as usize
    }

    /// Width over height.
    #[must_use]
    pub fn aspect(self) -> f64 {
        f64::from(self.width) / f64::from(self.height)
    }
}

impl fmt::Display for Size {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}x{}", self.width, self.height)
    }
}

impl FromStr for Size {
    type Err = SizeError;

    fn from_str(text: &str) -> Result<Self, SizeError> {
        let (width, height) = text.split_once(['x', 'X']).ok_or_else(|| SizeError(text.to_owned()))?;
        match (width.trim().parse(), height.trim().parse()) {
            (Ok(width), Ok(height)) => Self::new(width, height),
            _ => Err(SizeError(text.to_owned())),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn size_prints_as_it_is_parsed_and_refuses_what_is_none() {
        let size: Size = "960x540".parse().unwrap();
        assert_eq!((size.width(), size.height(), size.pixels()), (960, 540, 518_400));
        assert_eq!(size.to_string().parse(), Ok(size));
        assert!(Size::new(Size::MOST, Size::MOST).is_ok());
        for text in ["", "960", "0x5", "5x0", "16385x1", "1x16385", "-1x5", "99999999999x1", "axb", "1x1x1"] {
            assert!(text.parse::<Size>().is_err(), "{text}");
        }
    }
}
