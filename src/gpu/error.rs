//! What can go wrong with a graphics adapter.

/// Why something could not be done on a graphics adapter.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum GpuError {
    /// There is no adapter at all.
    #[error(
        "no graphics adapter with Vulkan, Metal or Direct3D 12; install a driver, or a software one (Debian and \
         Ubuntu: apt-get install mesa-vulkan-drivers)"
    )]
    NoAdapter,
    /// No adapter has such a name.
    #[error(
        "no graphics adapter is named like `{wanted}` (--adapter or UMBRAGE_ADAPTER); choose one of: {}",
        .available.join("; ")
    )]
    NoSuchAdapter {
        /// The part of a name that was asked for.
        wanted: String,
        /// The names of those that are there.
        available: Vec<String>,
    },
    /// The adapter does not give a device that is able enough.
    #[error("the graphics adapter cannot be used: {0}")]
    Device(String),
    /// Something does not fit the device's limits.
    #[error(
        "{what} of {bytes} bytes do not fit this graphics adapter, which takes {limit} at most; {remedy}"
    )]
    TooLarge {
        /// What it is.
        what: &'static str,
        /// How large.
        bytes: u64,
        /// How large it may be.
        limit: u64,
        /// What to do instead.
        remedy: &'static str,
    },
    /// A kind of view that no shader draws yet.
    #[error(
        "not built yet: {0} on a graphics adapter; use a perspective camera, or rays (render --method rays)"
    )]
    NotBuilt(&'static str),
    /// A mesh is so small that a device may take its coordinates for zero.
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
        /// How long it may be.
        limit: u32,
    },
    /// A buffer of the caller's holds less than it is said to hold.
    #[error(
        "{what} of {needed} bytes are said to lie in a buffer of {bytes}; give the right count, or all of them"
    )]
    TooSmall {
        /// What it should hold.
        what: &'static str,
        /// The size of the buffer.
        bytes: u64,
        /// The size that its contents have.
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
        /// How many vertices there are.
        vertex_count: u32,
    },
    /// The device has no memory left.
    #[error("the graphics adapter is out of memory; use a smaller picture or mesh, or another --adapter")]
    OutOfMemory,
    /// The device is gone: unplugged, reset, or destroyed.
    #[error("the graphics device was lost ({0}); try again, or use another --adapter")]
    Lost(String),
    /// What we asked of wgpu was not valid: a defect of umbrage.
    #[error("the graphics interface refused a call, which is a defect of umbrage: {0}")]
    Wgpu(String),
}

impl GpuError {
    /// With the remedy for what is too large because a picture is.
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
