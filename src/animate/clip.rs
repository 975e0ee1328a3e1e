//! Clips: named animations of nodes.

use std::sync::Arc;

use hashbrown::HashSet;

use super::track::Track;

/// What of a node a clip moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Property {
    /// Its translation.
    Translation,
    /// Its rotation.
    Rotation,
    /// Its scale.
    Scale,
    /// The weights of the morph targets of its mesh.
    Weights,
}

/// A value of a node over time.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Channel {
    /// Index into the nodes of the rig.
    pub(crate) node: usize,
    pub(crate) property: Property,
    pub(crate) track: Arc<Track>,
}

/// A named animation.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Clip {
    pub(crate) name: String,
    pub(crate) channels: Vec<Channel>,
    /// Why it cannot be posed: place, problem and remedy.
    pub(crate) problem: Option<String>,
}

impl Clip {
    /// The name in the file, or else "animation" and its number; may be that of another clip too.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// First and last key in seconds; both 0 if it moves nothing. Times are those of the file: a clip may
    /// begin after 0.
    #[must_use]
    pub fn span(&self) -> [f64; 2] {
        let spans = self.channels.iter().map(|channel| channel.track.span());
        spans.reduce(|[a, b], [c, d]| [a.min(c), b.max(d)]).unwrap_or_default()
    }

    /// The times of all its keys in seconds, ascending, each once.
    #[must_use]
    pub fn key_times(&self) -> Vec<f64> {
        // A track may move many nodes.
        let mut seen: HashSet<*const Track> = HashSet::new();
        let mut times: Vec<f32> = Vec::new();
        for channel in &self.channels {
            if seen.insert(Arc::as_ptr(&channel.track)) {
                times.extend(&channel.track.times);
            }
        }
        times.sort_unstable_by(f32::total_cmp);
        times.dedup();
        times.into_iter().map(f64::from).collect()
    }

    /// Why the clip cannot be posed, with the place in the file; `None` if it can.
    #[must_use]
    pub fn problem(&self) -> Option<&str> {
        self.problem.as_deref()
    }
}
