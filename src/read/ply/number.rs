//! Numeric types.

use crate::read::text::{decimal, parse};

/// A numeric type.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Number {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    I64,
    U64,
    F32,
    F64,
}

impl Number {
    pub(super) fn named(name: &[u8]) -> Option<Self> {
        Some(match name {
            b"char" | b"int8" => Self::I8,
            b"uchar" | b"uint8" => Self::U8,
            b"short" | b"int16" => Self::I16,
            b"ushort" | b"uint16" => Self::U16,
            b"int" | b"int32" => Self::I32,
            b"uint" | b"uint32" => Self::U32,
            b"long" | b"int64" => Self::I64,
            b"ulong" | b"uint64" => Self::U64,
            b"float" | b"float32" => Self::F32,
            b"double" | b"float64" => Self::F64,
            _ => return None,
        })
    }

    pub(super) fn is_whole(self) -> bool {
        !matches!(self, Self::F32 | Self::F64)
    }

    /// `word` as a number of this type; integers may be larger than their type.
    #[inline]
    pub(super) fn parse(self, word: &[u8]) -> Option<f64> {
        match self {
            // With all its digits, as long as these round to the same number.
            Self::F32 => {
                decimal(word).map(|(wide, near)| if wide as f32 == near { wide } else { f64::from(near) })
            }
            Self::F64 => parse(word),
            Self::U64 => parse::<i128>(word).map(|value| value as f64),
            _ => parse::<i64>(word).map(|value| value as f64),
        }
    }

    pub(super) fn bytes(self) -> u64 {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 | Self::I64 | Self::U64 => 8,
        }
    }
}
