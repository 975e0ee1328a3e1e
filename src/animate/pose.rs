//! Which moment of which clip.

use crate::mesh::MeshError;

/// A moment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Moment {
    /// Seconds from time 0 of the clip.
    Seconds(f64),
    /// A frame of a file that stores frames (MD2), from 0; of a clip, frame N is N frame lengths after 0.
    Frame(u32),
}

/// Which moment of which clip.
///
/// ```
/// use umbrage::animate::Pose;
/// assert_eq!(Pose::frame(12).seconds(), 0.5); // 24 frames a second
/// assert_eq!(Pose::at(0.5).fps(10.0).frames(), 5.0);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// Index into [`Rig::clips`](super::Rig::clips); `None` for the first, or, without clips, the node tree
    /// as it stands.
    pub clip: Option<usize>,
    /// The moment.
    pub moment: Moment,
    /// Frames a second: how long a frame is.
    pub fps: f64,
}

impl Pose {
    /// Frames a second where nothing else is said.
    pub const FPS: f64 = 24.0;

    /// The first clip at this many seconds.
    #[must_use]
    pub fn at(seconds: f64) -> Self {
        Self { clip: None, moment: Moment::Seconds(seconds), fps: Self::FPS }
    }

    /// This frame.
    #[must_use]
    pub fn frame(frame: u32) -> Self {
        Self { moment: Moment::Frame(frame), ..Self::at(0.0) }
    }

    /// The same moment of another clip.
    #[must_use]
    pub fn of(self, clip: usize) -> Self {
        Self { clip: Some(clip), ..self }
    }

    /// The same with this many frames a second.
    #[must_use]
    pub fn fps(self, fps: f64) -> Self {
        Self { fps, ..self }
    }

    /// The time in seconds.
    #[must_use]
    pub fn seconds(&self) -> f64 {
        match self.moment {
            Moment::Seconds(seconds) => seconds,
            Moment::Frame(frame) => f64::from(frame) / self.fps,
        }
    }

    /// The time in frames.
    #[must_use]
    pub fn frames(&self) -> f64 {
        match self.moment {
            Moment::Seconds(seconds) => seconds * self.fps,
            Moment::Frame(frame) => f64::from(frame),
        }
    }
}

/// Why a scene cannot be posed. Prints as place and problem; [`PoseError::remedy`] says what to do.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PoseError {
    /// A time or a number of frames a second that is none.
    #[error("{what} is {value}, which is no {what}")]
    NoTime {
        /// "time" or "frame rate".
        what: &'static str,
        /// What it is.
        value: f64,
    },
    /// There is no such clip.
    #[error("there is no clip {clip}: there are {count}, from 0")]
    NoClip {
        /// The number that was asked for.
        clip: usize,
        /// How many there are.
        count: usize,
    },
    /// A frame beyond the last one of a file that stores frames.
    #[error("there is no frame {frame}: the last one is {last}")]
    NoFrame {
        /// The number that was asked for.
        frame: u32,
        /// The number of the last frame.
        last: usize,
    },
    /// A part of the file that moves the scene cannot be used.
    #[error("{0}")]
    Unusable(String),
    /// The scene has other instances than those that were read.
    #[error("the scene has {count} instances, but {posed} of them were read with what moves them")]
    Instances {
        /// Instances of the scene.
        count: usize,
        /// Instances that the rig knows.
        posed: usize,
    },
    /// The pose carries a vertex beyond `f32`, or all posed meshes together are too large.
    #[error("{0}")]
    Mesh(#[from] MeshError),
}

impl PoseError {
    /// What to do about it.
    #[must_use]
    pub fn remedy(&self) -> &'static str {
        match self {
            Self::NoTime { .. } => "write a finite number; a frame rate is above 0",
            Self::NoClip { .. } => "choose one of the clips",
            Self::NoFrame { .. } => "choose a frame of the file",
            Self::Unusable(_) => "export the file again",
            Self::Instances { .. } => "pose the scene as it was read, and change it afterwards",
            Self::Mesh(_) => "choose another time or clip",
        }
    }
}
