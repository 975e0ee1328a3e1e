//! Errors of graphics adapters.

/// Why something could not be done on a graphics adapter.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum GpuError {
    /// There is no adapter.
    #[error(
        "no graphics adapter with Vulkan, Metal or Direct3D 12; install a driver, or a software one (Debian and \
         Ubuntu: apt-get install mesa-vulkan-drivers)"
    )]
    NoAdapter,
    /// No adapter has a name like the one asked for.
    #[error(
        "no graphics adapter is named like `{wanted}` (--adapter or UMBRAGE_ADAPTER); choose one of: {}",
        .available.join("; ")
    )]
    NoSuchAdapter {
        /// The part of the name.
        wanted: String,
        /// The names of the available adapters.
        available: Vec<String>,
    },
    /// The adapter has no device with the required features and limits.
    #[error("the graphics adapter cannot be used: {0}")]
    Device(String),
    /// A buffer exceeds the limits of the device.
    #[error(
        "{what} of {bytes} bytes do not fit this graphics adapter, which takes {limit} at most; {remedy}"
    )]
    TooLarge {
        /// What the buffer holds.
        what: &'static str,
        /// Its size.
        bytes: u64,
        /// The largest size.
        limit: u64,
        /// The remedy.
        remedy: &'static str,
    },
    /// Something that no shader does yet.
    #[error("not built yet: {0} on a graphics adapter; do it on the CPU (render --shadow rays, for example)")]
    NotBuilt(&'static str),
    /// A mesh is so small that a device may flush its coordinates to zero.
    #[error(
        "the mesh is {0:e} large, which a graphics adapter may take for zero; scale it up, or leave the graphics out"
    )]
    Subnormal(f32),
    /// A picture has more pixels in a row or column than the device can draw.
    #[error(
        "a picture of {side} pixels a side does not fit this graphics adapter, which takes {limit}; use a smaller --size or fewer --samples"
    )]
    Picture {
        /// The longer side.
        side: u32,
        /// The largest side.
        limit: u32,
    },
    /// A buffer of the caller is smaller than its contents are said to be.
    #[error(
        "{what} of {needed} bytes are said to lie in a buffer of {bytes}; give the right count, or all of them"
    )]
    TooSmall {
        /// Its contents.
        what: &'static str,
        /// The size of the buffer.
        bytes: u64,
        /// The size of the contents.
        needed: u64,
    },
    /// A triangle list on the device has an index that is no vertex.
    #[error(
        "face {face} has a corner that is none of the {vertex_count} vertices; give the right vertex count, or \
         leave the face out"
    )]
    BadIndex {
        /// The first such face.
        face: u32,
        /// The number of vertices.
        vertex_count: u32,
    },
    /// The device is out of memory.
    #[error("the graphics adapter is out of memory; use a smaller picture or mesh, or another --adapter")]
    OutOfMemory,
    /// The device was lost: unplugged, reset, or destroyed.
    #[error("the graphics device was lost ({0}); try again, or use another --adapter")]
    Lost(String),
    /// A call of wgpu was not valid: a defect of umbrage.
    #[error("the graphics interface refused a call, which is a defect of umbrage: {0}")]
    Wgpu(String),
}

impl GpuError {
    /// With the remedy for a buffer whose size is that of a picture.
    pub(crate) fn for_a_picture(self) -> Self {
        match self {
            Self::TooLarge { what, bytes, limit, .. } => {
                Self::TooLarge { what, bytes, limit, remedy: "use a smaller --size" }
            }
            other => other,
        }
    }
}

/// A message in one line.
pub(super) fn line(message: &str) -> String {
    message.split_whitespace().collect::<Vec<_>>().join(" ")
}
