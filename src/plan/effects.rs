//! Effects beside hard shadows, and what is not worked out, in words.

use std::collections::BTreeMap;

use super::candidates::Candidate;
use super::look::Looked;
use super::reason::{percent, time};
use super::relevance::{Outcome, Pieces, RelevanceTest, Triple};
use super::{Budget, Effect, Evidence, Scenery};
use crate::scene::Lamp;

/// The name of a lamp, or its number, from 1 as on the command line.
pub(super) fn lamp_name(lamp: &Lamp, number: usize) -> String {
    if lamp.name.is_empty() { format!("light {}", number + 1) } else { lamp.name.clone() }
}

/// Why something is left out, by the test that says so.
pub(super) fn because(test: RelevanceTest) -> &'static str {
    match test {
        RelevanceTest::Zero => "the lamp gives no light",
        RelevanceTest::NoReceiver => "nothing seen faces the lamp within its range and cone",
        RelevanceTest::Faint => "its strongest contribution is below the level of the budget",
        RelevanceTest::Enclosed => "a watertight shell encloses the lamp, and nothing seen",
        RelevanceTest::Unblocked => "no caster's shadow reaches anything seen",
        RelevanceTest::Parted => "casting on nothing seen (planes)",
        RelevanceTest::Tiles => "casting on nothing seen (tiles)",
        RelevanceTest::OutOfReach => "beyond the range or outside the cone of the lamp",
        RelevanceTest::Nested => "within other casters",
        RelevanceTest::Shadowed => "in the shadow of other casters",
        RelevanceTest::NothingBehind => "casting on nothing seen (light grid)",
        RelevanceTest::Copy => "copies of other casters",
        RelevanceTest::TurnedAway => "turned away from the lamp, or out of its reach",
        RelevanceTest::Sky => "nothing is seen there",
        RelevanceTest::Known => "lit or dark for sure (light grid)",
    }
}

/// Penumbrae and ambient occlusion: called for, or not.
pub(super) fn effects(
    scenery: &Scenery<'_>,
    budget: &Budget,
    pieces: &Pieces,
    looked: &[Looked],
    picks: &[&Candidate],
) -> Vec<Effect> {
    let mut effects = Vec::new();
    for (number, (looked, pick)) in looked.iter().zip(picks).enumerate() {
        let lamp = &scenery.lamps[number];
        if lamp.has_extent() {
            effects.push(penumbra(format!("penumbra of {}", lamp_name(lamp, number)), looked, pick, budget));
        }
    }
    effects.push(ambient(scenery, pieces));
    effects
}

fn penumbra(name: String, looked: &Looked, pick: &Candidate, budget: &Budget) -> Effect {
    if looked.relevance.outcome != Outcome::Shadows {
        let reason = "the lamp casts no shadow that is seen".to_owned();
        return Effect { name, called: false, bound: 0.0, evidence: Evidence::Exact, reason };
    }
    let allowed =
        if budget.least_error { String::new() } else { format!(", {} allowed", percent(budget.error)) };
    let called = pick.technique.is_soft();
    let tried =
        pick.error.filter(|(error, _)| !called && looked.penumbra.is_some_and(|it| error.bound < it.bound));
    if let Some((share, evidence)) = tried {
        let reason =
            format!("at most {} of samples are wrong without it, as tried{allowed}", percent(share.bound));
        return Effect { name, called, bound: share.bound, evidence, reason };
    }
    match looked.penumbra {
        Some(share) if share.bound == 0.0 => {
            let reason = "every sample sees all of the lamp, or nothing of it".to_owned();
            Effect { name, called, bound: 0.0, evidence: share.evidence(), reason }
        }
        Some(share) => {
            let reason = format!("at most {} of samples can be in it{allowed}", percent(share.bound));
            Effect { name, called, bound: share.bound, evidence: share.evidence(), reason }
        }
        None => {
            let reason =
                "how many samples may be in it was not looked for: it would take too long".to_owned();
            Effect { name, called, bound: looked.facing.bound, evidence: looked.facing.evidence(), reason }
        }
    }
}

/// Ambient occlusion changes nothing where all that is seen is one convex piece, and no other is there.
fn ambient(scenery: &Scenery<'_>, pieces: &Pieces) -> Effect {
    let name = "ambient occlusion".to_owned();
    let exact = |reason: &str| Effect {
        name: name.clone(),
        called: false,
        bound: 0.0,
        evidence: Evidence::Exact,
        reason: reason.to_owned(),
    };
    if !scenery.ambient {
        return exact("the picture has no ambient term");
    }
    let mut hits = scenery.samples.hits().iter().flatten();
    if hits.next().is_none() {
        return exact("nothing is seen");
    }
    let is_alone = scenery.casters.seen_caster().is_none() && pieces.len() == 1;
    if is_alone && pieces.iter().all(|piece| piece.watertight && piece.nothing_in_front) {
        return exact("all that is seen is convex and alone");
    }
    let reason = "what is seen is not one convex piece alone; no smaller bound was looked for".to_owned();
    Effect { name, called: true, bound: 1.0, evidence: Evidence::Exact, reason }
}

const UNSEARCHED: &str = "not looked for, which would take longer than it may save";

/// What is left out, grouped by lamp and reason, and the penumbrae that are not worked out.
pub(super) fn not_computed(scenery: &Scenery<'_>, looked: &[Looked], effects: &[Effect]) -> Vec<String> {
    let mut lines = Vec::new();
    // The same casters are mostly left out for the same reason by many lamps: the reasons are in order, and
    // each has a line of its own for each lamp, or one for all lamps where they are many.
    let few = looked.len() <= 16;
    let mut counts: BTreeMap<(usize, RelevanceTest), usize> = BTreeMap::new();
    let mut lamps: BTreeMap<RelevanceTest, usize> = BTreeMap::new();
    for (number, looked) in looked.iter().enumerate() {
        for dropped in &looked.relevance.dropped {
            match dropped.what {
                Triple::Piece(_) => {
                    *counts.entry((if few { number } else { 0 }, dropped.test)).or_default() += 1;
                }
                Triple::Lamp if few => {
                    let name = lamp_name(&scenery.lamps[number], number);
                    lines.push(format!("shadows of {name}: {}", because(dropped.test)));
                }
                Triple::Lamp => *lamps.entry(dropped.test).or_default() += 1,
                Triple::Samples(_) => {}
            }
        }
    }
    for ((number, test), count) in counts {
        let casters = if count == 1 { "caster" } else { "casters" };
        lines.push(match few {
            true if looked.len() > 1 => {
                let name = lamp_name(&scenery.lamps[number], number);
                format!("{name}: {count} {casters}: {}", because(test))
            }
            true => format!("{count} {casters}: {}", because(test)),
            false => format!("{count} pairs of a caster and a lamp: {}", because(test)),
        });
    }
    for (test, count) in lamps {
        lines.push(format!("shadows of {count} lamps: {}", because(test)));
    }
    let unsearched = looked.iter().filter(|looked| !looked.is_searched && !looked.relevance.kept.is_empty());
    match (unsearched.count(), looked.len()) {
        (0, _) => {}
        (1, 1) => lines.push(format!("which casters matter: {UNSEARCHED}")),
        (count, _) => lines.push(format!("which casters matter to {count} of the lights: {UNSEARCHED}")),
    }
    let left_out = effects.iter().filter(|effect| !effect.called);
    lines.extend(left_out.map(|effect| format!("{}: {}", effect.name, effect.reason)));
    lines
}

/// The best plan within the time, where the least time within the error is more.
pub(super) fn best_within(
    scenery: &Scenery<'_>,
    looked: &[Looked],
    picks: &[usize],
    error: f64,
    found: f64,
    within: f64,
) -> String {
    let named = looked.iter().zip(picks).enumerate().map(|(number, (looked, &pick))| {
        let technique = looked.candidates[pick].technique;
        format!("{}: {technique}", lamp_name(&scenery.lamps[number], number))
    });
    let mut named: Vec<String> = named.take(5).collect();
    if looked.len() > 4 {
        named.truncate(4);
        named.push("…".to_owned());
    }
    let wrong = percent(error.min(1.0));
    match found <= within {
        true => format!(
            "within {} the best is {} with at most {wrong} of samples wrong ({})",
            time(within),
            time(found),
            named.join(", ")
        ),
        false => format!("nothing takes {} or less; the fastest takes {}", time(within), time(found)),
    }
}
