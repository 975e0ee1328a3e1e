//! How fine a picture there is time for.

use umbrage::view::Size;

/// How fine a picture is.
///
/// By default the coarsest.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Quality(usize);

/// Pixels of the window along each side of a pixel of the picture, and samples along each side of that.
const QUALITIES: [(u32, u32); 5] = [(6, 1), (3, 1), (2, 1), (1, 1), (1, 2)];

impl Quality {
    const COARSEST: Self = Self(0);

    /// The size of the picture for a window of this size.
    pub(super) fn size(self, window: Size) -> Size {
        let side = |side: u32| side.div_ceil(QUALITIES[self.0].0);
        Size::new(side(window.width()), side(window.height())).unwrap_or(window)
    }

    /// Samples along each side of a pixel of the picture.
    pub(super) fn per_side(self) -> u32 {
        QUALITIES[self.0].1
    }

    /// Whether it has a sample at least for each pixel of the window.
    pub(super) fn is_fine(self) -> bool {
        self.density() >= 1.0
    }

    /// Samples for each pixel of the window.
    fn density(self) -> f64 {
        let (pixels, samples) = QUALITIES[self.0];
        (f64::from(samples) / f64::from(pixels)).powi(2)
    }
}

/// What pictures took.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Pace {
    /// Samples and seconds of the last picture, and of the last one of another number of samples.
    last: Option<[f64; 2]>,
    other: Option<[f64; 2]>,
}

/// How long a picture may take that answers a change, and one that refines it, in seconds.
const PROMPT: f64 = 0.08;
const PATIENT: f64 = 10.0;

impl Pace {
    /// Notes how long a picture took, in seconds.
    pub(super) fn took(&mut self, quality: Quality, size: Size, seconds: f64) {
        let samples = size.pixels() as f64 * f64::from(quality.per_side()).powi(2);
        self.other = self.last.filter(|last| last[0] != samples).or(self.other);
        self.last = Some([samples, seconds]);
    }

    /// The seconds of a picture: some for each sample, and some for whatever is done once, if two pictures
    /// tell them apart.
    fn predicted(&self, quality: Quality, window: Size) -> Option<f64> {
        let [samples, seconds] = self.last?;
        let wanted = window.pixels() as f64 * quality.density();
        let slope = self.other.map(|other| (seconds - other[1]) / (samples - other[0]));
        Some(match slope.filter(|slope| *slope > 0.0 && slope * samples <= seconds) {
            Some(slope) => seconds + slope * (wanted - samples),
            None => seconds / samples * wanted,
        })
    }

    /// The quality that answers a change: the finest that is prompt, the coarsest at first.
    pub(super) fn first(&self, window: Size) -> Quality {
        let is_prompt = |&quality: &Quality| {
            // Smooth edges are for what rests.
            quality.per_side() == 1 && self.predicted(quality, window).is_some_and(|time| time <= PROMPT)
        };
        (0..QUALITIES.len()).rev().map(Quality).find(is_prompt).unwrap_or(Quality::COARSEST)
    }

    /// The finest quality that there is patience for, if it is finer than this one, of which a picture has
    /// this size.
    pub(super) fn finer(&self, quality: Quality, size: Size) -> Option<Quality> {
        let (pixels, _) = QUALITIES[quality.0];
        let side = |side: u32| side.saturating_mul(pixels).min(Size::MOST);
        let window = Size::new(side(size.width()), side(size.height())).ok()?;
        let is_bearable =
            |&finer: &Quality| self.predicted(finer, window).is_some_and(|time| time <= PATIENT);
        let finer = (quality.0 + 1..QUALITIES.len()).rev().map(Quality);
        // First the picture without, then with smooth edges: the second takes four times as long.
        let one_step = |finer: &Quality| finer.per_side() == 1 || QUALITIES[quality.0].0 == 1;
        // One picture does not tell what is done once from what each sample takes: a second one does.
        let is_unclear = self.other.is_none() && self.last.is_some_and(|last| last[1] <= 0.5 * PATIENT);
        let next = Quality(quality.0 + 1);
        let second = (is_unclear && quality.0 + 1 < QUALITIES.len()).then_some(next);
        finer.filter(one_step).find(is_bearable).or(second)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FINEST: Quality = Quality(QUALITIES.len() - 1);

    fn window() -> Size {
        Size::new(960, 540).unwrap()
    }

    #[test]
    fn pace_begins_coarse_and_is_as_fine_as_is_prompt() {
        let mut pace = Pace::default();
        assert_eq!(pace.first(window()), Quality::COARSEST);
        let all = 960.0 * 540.0;
        for (seconds, wanted) in [(0.05, 3), (0.2, 2), (0.5, 1), (60.0, 0)] {
            // A picture of every pixel took so long.
            pace.took(Quality(3), window(), seconds);
            assert_eq!(pace.first(window()), Quality(wanted), "{seconds} s for {all} samples");
        }
    }

    #[test]
    fn pace_refines_what_can_be_waited_for_and_smooths_edges_last() {
        let mut pace = Pace::default();
        assert_eq!(pace.finer(Quality(0), Quality(0).size(window())), None, "nothing is known yet");
        pace.took(Quality(3), window(), 0.5);
        assert_eq!(pace.finer(Quality(0), Quality(0).size(window())), Some(Quality(3)));
        assert_eq!(pace.finer(Quality(3), window()), Some(FINEST));
        assert_eq!(pace.finer(FINEST, window()), None);
        pace.took(Quality(3), window(), 30.0);
        assert_eq!(pace.finer(Quality(0), Quality(0).size(window())), Some(Quality(2)));
        assert_eq!(pace.finer(Quality(3), window()), None, "two minutes are too long");
    }

    /// A light grid, for example, takes as long for few samples as for many.
    #[test]
    fn pace_tells_what_is_done_once_from_what_each_sample_takes() {
        let mut pace = Pace::default();
        let coarse = Quality(0).size(window());
        let seconds = |size: Size| 3.0 + 2e-6 * size.pixels() as f64;
        pace.took(Quality(0), coarse, seconds(coarse));
        let next = pace.finer(Quality(0), coarse);
        assert_eq!(next, Some(Quality(1)), "to see what that takes");
        let half = Quality(2).size(window());
        pace.took(Quality(2), half, seconds(half));
        let predicted = pace.predicted(Quality(3), window()).unwrap();
        assert!((predicted - seconds(window())).abs() < 0.01, "{predicted}");
        assert_eq!(pace.finer(Quality(2), half), Some(Quality(3)));
        // What contradicts itself is not believed: fewer samples took longer.
        pace.took(Quality(0), coarse, 9.0);
        assert!(pace.predicted(Quality(3), window()).unwrap() > 100.0);
    }

    #[test]
    fn picture_of_every_quality_has_a_pixel_at_least() {
        let tiny = Size::new(1, 1).unwrap();
        assert!((0..QUALITIES.len()).all(|at| Quality(at).size(tiny) == tiny));
        assert_eq!(Quality(1).size(window()), Size::new(320, 180).unwrap());
    }
}
