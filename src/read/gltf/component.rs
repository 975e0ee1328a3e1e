//! Components: the numbers that elements are made of.

use gltf::json::accessor as code;

use super::object::Object;
use crate::read::ReadError;

/// What one component of an element is stored as.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Component {
    I8,
    U8,
    I16,
    U16,
    U32,
    F32,
}

impl Component {
    pub(super) fn of(object: &Object) -> Result<Self, ReadError> {
        let stated = object.required("componentType", object.whole("componentType")?)?;
        Ok(match u32::try_from(stated) {
            Ok(code::BYTE) => Self::I8,
            Ok(code::UNSIGNED_BYTE) => Self::U8,
            Ok(code::SHORT) => Self::I16,
            Ok(code::UNSIGNED_SHORT) => Self::U16,
            Ok(code::UNSIGNED_INT) => Self::U32,
            Ok(code::FLOAT) => Self::F32,
            _ => {
                return Err(
                    object.error(format!("has the component type {stated}, which glTF does not know"))
                );
            }
        })
    }

    pub(super) fn bytes(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::U32 | Self::F32 => 4,
        }
    }

    /// The first component in `bytes`, which hold one at least.
    pub(super) fn float(self, bytes: &[u8], normalized: bool) -> f32 {
        let value = match self {
            Self::I8 => f32::from(bytes[0] as i8),
            Self::U8 => f32::from(bytes[0]),
            Self::I16 => f32::from(i16::from_le_bytes([bytes[0], bytes[1]])),
            Self::U16 => f32::from(u16::from_le_bytes([bytes[0], bytes[1]])),
            Self::U32 => self.whole(bytes) as f32,
            Self::F32 => f32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]),
        };
        if normalized { self.normalize(value) } else { value }
    }

    /// A stored integer as a fraction of the largest one (§3.11 of the specification); floats as they are.
    pub(super) fn normalize(self, value: f32) -> f32 {
        let largest = match self {
            Self::I8 => 127.0,
            Self::U8 => 255.0,
            Self::I16 => 32767.0,
            Self::U16 => 65535.0,
            Self::U32 | Self::F32 => return value,
        };
        (value / largest).max(-1.0)
    }

    /// The first component in `bytes` as an index; only unsigned types are indices.
    pub(super) fn whole(self, bytes: &[u8]) -> u32 {
        match self {
            Self::U8 => u32::from(bytes[0]),
            Self::U16 => u32::from(u16::from_le_bytes([bytes[0], bytes[1]])),
            _ => u32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]),
        }
    }
}
