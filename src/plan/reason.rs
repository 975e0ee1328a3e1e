//! Reasons in words, made from the comparison that decided.

use super::candidates::Candidate;
use super::choose::Offer;
use super::probe::Share;

/// A time: two digits or three, in ms.
pub(super) fn time(nanoseconds: f64) -> String {
    let ms = nanoseconds / 1e6;
    match ms {
        _ if ms < 0.1 => "< 0.1 ms".to_owned(),
        _ if ms < 10.0 => format!("{ms:.1} ms"),
        _ => format!("{ms:.0} ms"),
    }
}

/// A fraction in percent, rounded up to two digits: a bound stays one.
pub(super) fn percent(fraction: f64) -> String {
    let percent = fraction * 100.0;
    if percent == 0.0 {
        return "0 %".to_owned();
    }
    let digits = (1.0 - percent.log10().floor()).clamp(0.0, 12.0);
    let scale = 10_f64.powi(digits as i32);
    // What is a round number in decimals is not quite one in binary.
    format!("{} %", (percent * scale * (1.0 - 4.0 * f64::EPSILON)).ceil() / scale)
}

/// A candidate that could have been chosen, with its time if it stood for the chosen one.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rival<'a> {
    pub(super) candidate: &'a Candidate,
    pub(super) time: f64,
}

/// Why this candidate.
///
/// `allowed` is the error that the budget allows; `None` if there is no wall. `rivals` could have stood for
/// it within the error, and are in the order of their times.
pub(super) fn chosen(
    chosen: Rival<'_>,
    penumbra: Option<Share>,
    allowed: Option<f64>,
    rivals: &[Rival<'_>],
) -> String {
    let candidate = chosen.candidate;
    let name = named(candidate);
    let mut text = String::new();
    let allows = allowed.map_or_else(String::new, |allowed| format!(", {} allowed", percent(allowed)));
    let bound = candidate.error.map_or(1.0, |(share, _)| share.bound);
    if let Some(penumbra) = penumbra
        && !candidate.technique.is_soft()
    {
        text += &match bound < penumbra.bound {
            true => format!("hard: at most {} of samples are wrong, as tried{allows}; ", percent(bound)),
            false => {
                format!("hard: at most {} of samples can be in penumbra{allows}; ", percent(penumbra.bound))
            }
        };
    } else if bound > 0.0 {
        text += &format!("at most {} of samples wrong{allows}; ", percent(bound));
    }
    text += &format!("{name}: {}", time(chosen.time));
    let mut others: Vec<String> = Vec::new();
    for rival in rivals {
        let name = named(rival.candidate);
        // One figure for each technique: its fastest form.
        if rival.candidate.technique.name() != candidate.technique.name()
            && !others.iter().any(|other| other.starts_with(&format!("{name} ")))
            && others.len() < 2
        {
            others.push(format!("{name} {}", time(rival.time)));
        }
    }
    match others.is_empty() {
        true => text + "; nothing else is within the error",
        false => format!("{text}; {}", others.join(", ")),
    }
}

/// Why not this one.
pub(super) fn rejected(
    candidate: &Candidate,
    prove: bool,
    allowed: Option<f64>,
    own: f64,
    chosen: (f64, f64),
) -> String {
    let (chosen_time, chosen_error) = chosen;
    if let Some(why) = candidate.not_applicable {
        return why.to_owned();
    }
    let Some((share, evidence)) = candidate.error else { return candidate.no_bound.to_owned() };
    let bound = percent(share.bound);
    if prove && !evidence.proves() {
        return format!("at most {bound} of samples wrong, which is {evidence}, and a proof is asked for");
    }
    match allowed {
        Some(allowed) if share.bound > allowed => {
            format!("at most {bound} of samples wrong, {} allowed", percent(allowed))
        }
        Some(_) if own < chosen_time => {
            format!("at most {bound} of samples wrong: this error is spent on other lamps")
        }
        None if share.bound > chosen_error => {
            format!("at most {bound} of samples wrong, against {}", percent(chosen_error))
        }
        None if own < chosen_time => {
            format!("at most {bound} of samples wrong, and the time is enough for less")
        }
        _ => format!("{}, against {}", time(own), time(chosen_time)),
    }
}

fn named(candidate: &Candidate) -> String {
    let name = candidate.technique.name();
    if candidate.on_device { format!("{name} on the device") } else { name.to_owned() }
}

/// What a candidate is to the choice.
pub(super) fn offer(candidate: &Candidate) -> Offer {
    let error = candidate.error.map_or(1.0, |(share, _)| share.bound);
    Offer { error, time: candidate.time, shared: candidate.shared }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reason_rounds_times_and_rounds_bounds_up() {
        assert_eq!([2.6e7, 4.14e6, 1e5, 9e4].map(time), ["26 ms", "4.1 ms", "0.1 ms", "< 0.1 ms"]);
        let fractions = [0.004, 0.0041001, 0.01, 0.000_123_4, 0.5, 1.0, 0.0, 0.332_1];
        let texts = ["0.4 %", "0.42 %", "1 %", "0.013 %", "50 %", "100 %", "0 %", "34 %"];
        assert_eq!(fractions.map(percent), texts);
    }

    /// Where a trial shows that hard shadows will do, the reason has the bound of the trial: the larger share
    /// of what may be in penumbra would contradict the choice.
    #[test]
    fn reason_of_hard_shadows_has_the_bound_that_decided() {
        use crate::plan::costs::{Costs, Work};
        use crate::plan::{Evidence, binomial};
        use crate::shadow::Technique;
        let share = |wrong: u64| {
            let bound = binomial::upper(wrong, 300, 0.05);
            Share { of_probe: wrong as f64 / 300.0, bound, is_all: false }
        };
        let said = |error: Share| {
            let costs = Costs::default();
            let mut candidate = Candidate::plain(Technique::Rays, Work::default(), &costs, Evidence::Sampled);
            candidate.error = Some((error, Evidence::Sampled));
            chosen(Rival { candidate: &candidate, time: 2e6 }, Some(share(40)), Some(0.02), &[])
        };
        let (tried, not_tried) = (said(share(0)), said(share(40)));
        assert!(
            tried.starts_with("hard: at most 1 % of samples are wrong, as tried, 2 % allowed; "),
            "{tried}"
        );
        assert!(not_tried.starts_with("hard: at most 18 % of samples can be in penumbra, "), "{not_tried}");
    }
}
