//! The choice: one offer for each lamp, so that errors and times add up best.
//!
//! A multiple-choice knapsack, solved by merging one lamp at a time into the states that no other dominates.
//! (Funkhouser and Séquin, *Adaptive Display Algorithm*, SIGGRAPH 1993, solve theirs greedily.) What several
//! lamps share, such as the ray tree, is counted once.

/// Number of kinds of shared costs.
pub(super) const SHARED: usize = 4;
/// Most states that are kept; fewer where many lamps would make the work exceed [`MOST_WORK`].
const MOST_STATES: usize = 4096;
const FEWEST_STATES: usize = 64;
const MOST_WORK: usize = 1 << 18;

/// A technique for one lamp, by numbers alone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Offer {
    /// Upper bound of the fraction of wrong samples.
    pub(super) error: f64,
    /// Own time, in nanoseconds.
    pub(super) time: f64,
    /// One bit for each kind of shared cost.
    pub(super) shared: u8,
}

/// What is wanted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Wanted {
    /// The least time with an error up to this.
    LeastTime { error: f64 },
    /// The least error within this time; if there is none, the least time.
    LeastError { time: f64 },
}

/// The chosen offers.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Chosen {
    /// Index of the offer for each lamp.
    pub(super) picks: Vec<usize>,
    /// Sum of the errors.
    pub(super) error: f64,
    /// Sum of the times, with each shared cost once.
    pub(super) time: f64,
}

#[derive(Clone, Copy, Debug)]
struct State {
    error: f64,
    time: f64,
    shared: u8,
    /// Index of the state before, and of the offer.
    from: (u32, u32),
}

/// Time of the shared parts of a set.
pub(super) fn shared_time(shared: u8, times: &[f64; SHARED]) -> f64 {
    times.iter().enumerate().filter(|(bit, _)| shared >> bit & 1 == 1).map(|(_, time)| time).sum()
}

/// Chooses one offer for each lamp; `None` if some lamp has none, or none within the error.
///
/// Ties go to the offer that comes first.
pub(super) fn choose(offers: &[Vec<Offer>], times: &[f64; SHARED], wanted: Wanted) -> Option<Chosen> {
    let most = (MOST_WORK / offers.len().max(1)).clamp(FEWEST_STATES, MOST_STATES);
    let limit = match wanted {
        Wanted::LeastTime { error } => error,
        Wanted::LeastError { .. } => f64::INFINITY,
    };
    let mut layers: Vec<Vec<State>> = Vec::with_capacity(offers.len() + 1);
    layers.push(vec![State { error: 0.0, time: 0.0, shared: 0, from: (0, 0) }]);
    for offers in offers {
        let before = &layers[layers.len() - 1];
        let merged = merged(before, offers, times, limit);
        let merged = if merged.len() > most { rounded(merged, times, limit, most) } else { merged };
        layers.push(merged);
    }
    let last = layers[offers.len()].iter().enumerate();
    let by_time = |a: &(usize, &State), b: &(usize, &State)| {
        a.1.time.total_cmp(&b.1.time).then(a.1.error.total_cmp(&b.1.error))
    };
    let best = match wanted {
        Wanted::LeastTime { .. } => last.min_by(by_time),
        Wanted::LeastError { time } => {
            let within = last.clone().filter(|(_, state)| state.time <= time);
            let by_error = |a: &(usize, &State), b: &(usize, &State)| {
                a.1.error.total_cmp(&b.1.error).then(a.1.time.total_cmp(&b.1.time))
            };
            within.min_by(by_error).or_else(|| last.min_by(by_time))
        }
    };
    let mut at = best?.0;
    let mut picks = vec![0; offers.len()];
    for lamp in (0..offers.len()).rev() {
        let (state, pick) = layers[lamp + 1][at].from;
        (at, picks[lamp]) = (state as usize, pick as usize);
    }
    Some(total(offers, times, picks))
}

/// The sums of chosen offers.
pub(super) fn total(offers: &[Vec<Offer>], times: &[f64; SHARED], picks: Vec<usize>) -> Chosen {
    let picked = || offers.iter().zip(&picks).map(|(offers, &pick)| offers[pick]);
    let shared = picked().fold(0, |shared, offer| shared | offer.shared);
    let error = picked().map(|offer| offer.error).sum();
    let time = picked().map(|offer| offer.time).sum::<f64>() + shared_time(shared, times);
    Chosen { picks, error, time }
}

/// All states with one more lamp that no other dominates.
fn merged(before: &[State], offers: &[Offer], times: &[f64; SHARED], limit: f64) -> Vec<State> {
    let mut all = Vec::with_capacity(before.len() * offers.len());
    for (at, state) in before.iter().enumerate() {
        for (pick, offer) in offers.iter().enumerate() {
            let error = state.error + offer.error;
            if error <= limit {
                let more = shared_time(offer.shared & !state.shared, times);
                let time = state.time + offer.time + more;
                let from = (at as u32, pick as u32); // far fewer than 2³²
                all.push(State { error, time, shared: state.shared | offer.shared, from });
            }
        }
    }
    undominated(all, times)
}

/// The states that no other dominates. A state dominates another one if its error is no larger, and its time
/// neither, with all that the other one has paid for and it has not.
fn undominated(mut all: Vec<State>, times: &[f64; SHARED]) -> Vec<State> {
    all.sort_by(|a, b| a.error.total_cmp(&b.error).then(a.time.total_cmp(&b.time)));
    // The least time of the states with each set of shared parts: of those that are kept, and so have no
    // larger error.
    let mut least: Vec<(u8, f64)> = Vec::with_capacity(1 << SHARED);
    all.retain(|state| {
        let dominates = |&(shared, time): &(u8, f64)| {
            time <= state.time && time + shared_time(state.shared & !shared, times) <= state.time
        };
        if least.iter().any(dominates) {
            return false;
        }
        match least.iter_mut().find(|(shared, _)| *shared == state.shared) {
            Some((_, time)) => *time = time.min(state.time),
            None => least.push((state.shared, state.time)),
        }
        true
    });
    all
}

/// The states with their errors rounded up, so that at most `most` differ for each set of shared parts.
fn rounded(mut states: Vec<State>, times: &[f64; SHARED], limit: f64, most: usize) -> Vec<State> {
    let largest = states.iter().map(|state| state.error).fold(0.0, f64::max).min(limit);
    let step = largest / most as f64;
    for state in &mut states {
        let up = (state.error / step).ceil() * step;
        // Rounding must not push a state over the limit, below which it is.
        state.error = if up.is_nan() { state.error } else { up.max(state.error).min(limit.max(state.error)) };
    }
    undominated(states, times)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::SplitMix64;

    const TIMES: [f64; SHARED] = [7.0, 5.0, 11.0, 2.0];

    fn tables(random: &mut SplitMix64, lamps: usize, most: usize) -> Vec<Vec<Offer>> {
        let mut offer = || Offer {
            // Sums of eighths are exact.
            error: random.below(9) as f64 / 8.0,
            time: random.below(30) as f64,
            shared: random.below(1 << SHARED) as u8,
        };
        (0..lamps).map(|lamp| (0..1 + lamp % most).map(|_| offer()).collect()).collect()
    }

    /// All combinations.
    fn all(offers: &[Vec<Offer>]) -> Vec<Chosen> {
        let count: usize = offers.iter().map(Vec::len).product();
        let picks = |mut number: usize| {
            let pick = |offers: &Vec<Offer>| {
                let pick = number % offers.len();
                number /= offers.len();
                pick
            };
            offers.iter().map(pick).collect()
        };
        (0..count).map(|number| total(offers, &TIMES, picks(number))).collect()
    }

    #[test]
    fn choice_is_the_best_of_all_combinations() {
        let mut random = SplitMix64(1);
        let mut narrow = 0;
        for case in 0..300 {
            let offers = tables(&mut random, 1 + case % 5, 5);
            let all = all(&offers);
            let error = random.below(17) as f64 / 8.0;
            let within = all.iter().filter(|chosen| chosen.error <= error).map(|chosen| chosen.time);
            let least = within.min_by(f64::total_cmp);
            let found = choose(&offers, &TIMES, Wanted::LeastTime { error });
            assert_eq!(found.as_ref().map(|found| found.time), least, "case {case}");
            assert!(found.is_none_or(|found| found.error <= error));

            let time = 10.0 + random.below(60) as f64;
            let least = all.iter().filter(|chosen| chosen.time <= time).map(|chosen| chosen.error);
            let found = choose(&offers, &TIMES, Wanted::LeastError { time }).unwrap();
            match least.min_by(f64::total_cmp) {
                Some(least) => assert_eq!(found.error, least, "case {case}"),
                None => {
                    narrow += 1;
                    assert!(all.iter().all(|chosen| chosen.time >= found.time), "case {case}");
                }
            }
        }
        assert!(narrow > 20, "{narrow} with too little time for any");
    }

    #[test]
    fn choice_counts_what_is_shared_once() {
        // Two lamps: rays at 4 each and a tree of 7, or a grid at 9 each without one.
        let offers =
            |error| vec![Offer { error: 0.0, time: 4.0, shared: 1 }, Offer { error, time: 9.0, shared: 0 }];
        let one = choose(&[offers(0.0)], &TIMES, Wanted::LeastTime { error: 0.0 }).unwrap();
        let two = choose(&[offers(0.0), offers(0.0)], &TIMES, Wanted::LeastTime { error: 0.0 }).unwrap();
        assert_eq!((one.picks, one.time, two.picks, two.time), (vec![1], 9.0, vec![0, 0], 15.0));
    }

    #[test]
    fn choice_among_equals_is_the_first_and_without_any_there_is_none() {
        let same = Offer { error: 0.0, time: 3.0, shared: 0 };
        let found = choose(&[vec![same; 3], vec![same; 2]], &TIMES, Wanted::LeastTime { error: 0.0 });
        assert_eq!(found.unwrap().picks, [0, 0]);
        assert_eq!(choose(&[vec![same], vec![]], &TIMES, Wanted::LeastTime { error: 1.0 }), None);
        let nothing = choose(&[], &TIMES, Wanted::LeastTime { error: 0.0 }).unwrap();
        assert_eq!((nothing.picks.len(), nothing.time), (0, 0.0));
    }

    #[test]
    fn choice_for_many_lamps_stays_within_its_error_and_its_states() {
        let mut random = SplitMix64(2);
        let mut offer = || Offer { error: random.unit(), time: 1.0 - random.unit(), shared: 0 };
        let offers: Vec<Vec<Offer>> = (0..80)
            .map(|_| (0..3).map(|_| offer()).chain([Offer { error: 0.0, time: 2.0, shared: 0 }]).collect())
            .collect();
        let mut before = f64::INFINITY;
        for error in [0.0, 0.5, 10.0, 1000.0] {
            let found = choose(&offers, &TIMES, Wanted::LeastTime { error }).unwrap();
            assert!(found.error <= error && found.time <= before, "{error}: {}", found.time);
            before = found.time;
        }
        assert!(before < 80.0);
    }
}
