//! File formats.

use std::fmt;
use std::path::Path;

use crate::view::Up;

/// A file format that can be read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Format {
    /// Wavefront OBJ.
    Obj,
    /// glTF 2.0, JSON with external or embedded buffers.
    Gltf,
    /// glTF 2.0, binary container.
    Glb,
    /// Stereolithography, text or binary.
    Stl,
    /// Polygon file format, text or binary.
    Ply,
    /// Quake II model.
    Md2,
    /// 3D Manufacturing Format.
    ThreeMf,
}

impl Format {
    /// Lower-case name, as in reports and as a file extension.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Obj => "obj",
            Self::Gltf => "gltf",
            Self::Glb => "glb",
            Self::Stl => "stl",
            Self::Ply => "ply",
            Self::Md2 => "md2",
            Self::ThreeMf => "3mf",
        }
    }

    /// The axis that points up by the custom of the format.
    #[must_use]
    pub fn up(self) -> Up {
        match self {
            Self::Md2 | Self::Stl | Self::ThreeMf => Up::Z,
            Self::Obj | Self::Gltf | Self::Glb | Self::Ply => Up::Y,
        }
    }

    /// The format of a file name's extension.
    #[must_use]
    pub fn from_extension(path: &Path) -> Option<Self> {
        let extension = path.extension()?.to_str()?.to_ascii_lowercase();
        [Self::Obj, Self::Gltf, Self::Glb, Self::Stl, Self::Ply, Self::Md2, Self::ThreeMf]
            .into_iter()
            .find(|format| format.name() == extension)
    }
}

impl fmt::Display for Format {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}
