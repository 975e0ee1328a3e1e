//! The up axis of a file.

/// The axis that points up.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Up {
    /// +y: glTF by definition; OBJ and PLY mostly; what this crate generates.
    #[default]
    Y,
    /// +z: MD2 by its game, STL by the custom of machining and printing.
    Z,
}

impl Up {
    /// 1 for y, 2 for z.
    #[must_use]
    pub fn axis(self) -> usize {
        match self {
            Self::Y => 1,
            Self::Z => 2,
        }
    }

    /// `[right, up, back]` of a y-up model, in the axes of the file; both systems are right-handed.
    #[must_use]
    pub fn turn(self, [right, up, back]: [f64; 3]) -> [f64; 3] {
        match self {
            Self::Y => [right, up, back],
            Self::Z => [right, -back, up],
        }
    }
}
