//! The plan that follows from a choice, with the reason of each lamp's technique.

use std::time::Duration;

use super::candidates::Candidate;
use super::choose::{Chosen, SHARED};
use super::costs::duration;
use super::look::Looked;
use super::planner::Planner;
use super::{Evidence, GroupPlan, LampPlan, Prediction, Receivers, Rejected, ShadowPlan};
use super::{effects, reason};

impl Planner<'_> {
    pub(super) fn report(
        &self,
        looked: Vec<Looked>,
        chosen: &Chosen,
        wall: Option<f64>,
        is_within: bool,
        over_time: Option<String>,
    ) -> ShadowPlan {
        let Self { scenery, budget, costs, .. } = *self;
        let evidence = |pick: &Candidate| pick.error.map_or(Evidence::Assumed, |(_, evidence)| evidence);
        let picks: Vec<&Candidate> =
            looked.iter().zip(&chosen.picks).map(|(looked, &pick)| &looked.candidates[pick]).collect();
        let weakest = picks.iter().map(|pick| evidence(pick)).fold(Evidence::Exact, Evidence::weaker);
        let estimate: f64 = picks.iter().filter_map(|pick| Some(pick.error?.0.of_probe)).sum();
        let total = Prediction {
            error: estimate.min(1.0),
            evidence: weakest,
            bound: chosen.error.min(1.0),
            time: duration(chosen.time),
            time_evidence: costs.evidence,
        };
        // How many lamps need each shared part: a rival pays for what no other lamp has paid for.
        let mut users = [0_usize; SHARED];
        for pick in &picks {
            for (bit, users) in users.iter_mut().enumerate() {
                *users += usize::from(pick.shared >> bit & 1);
            }
        }
        let effects = effects::effects(scenery, budget, &self.pieces, &looked, &picks);
        let not_computed = effects::not_computed(scenery, &looked, &effects);
        let shared = self.shared();
        let lamps = (looked.iter().zip(&chosen.picks).enumerate())
            .map(|(number, (looked, &pick))| {
                let own_users = looked.candidates[pick].shared;
                let with_shared = |candidate: &Candidate| {
                    let is_extra = |bit: usize| users[bit] == usize::from(own_users >> bit & 1);
                    let extra = (0..SHARED).filter(|&bit| candidate.shared >> bit & 1 == 1 && is_extra(bit));
                    candidate.time + extra.map(|bit| shared[bit]).sum::<f64>()
                };
                // Of the error, what the other lamps leave.
                let left =
                    wall.map(|wall| wall - (chosen.error - reason::offer(&looked.candidates[pick]).error));
                self.lamp_plan(number, looked, pick, wall, left, with_shared)
            })
            .collect();
        ShadowPlan {
            budget: *budget,
            samples: self.probe.seen,
            probed: self.probe.hits.len(),
            lamps,
            dropped: looked.into_iter().flat_map(|looked| looked.relevance.dropped).collect(),
            effects,
            total,
            not_computed,
            over_time,
            meets_budget: is_within && wall.is_none_or(|wall| chosen.error <= wall),
            planning: Duration::ZERO,
        }
    }

    fn lamp_plan(
        &self,
        number: usize,
        looked: &Looked,
        pick: usize,
        wall: Option<f64>,
        left: Option<f64>,
        with_shared: impl Fn(&Candidate) -> f64,
    ) -> LampPlan {
        let Self { scenery, costs, .. } = *self;
        let candidate = &looked.candidates[pick];
        let lamp = &scenery.lamps[number];
        let own = reason::Rival { candidate, time: with_shared(candidate) };
        let prediction = |candidate: &Candidate| {
            candidate.error.map(|(share, evidence)| Prediction {
                error: share.of_probe,
                evidence,
                bound: share.bound,
                time: duration(with_shared(candidate)),
                time_evidence: costs.evidence,
            })
        };
        let mut rivals: Vec<reason::Rival<'_>> = (looked.candidates.iter().enumerate())
            .filter(|&(index, rival)| {
                index != pick && rival.is_admissible(scenery.prove, left.unwrap_or(1.0).max(0.0))
            })
            .map(|(_, candidate)| reason::Rival { candidate, time: with_shared(candidate) })
            .collect();
        rivals.sort_by(|a, b| a.time.total_cmp(&b.time));
        let penumbra = looked.penumbra.filter(|_| lamp.has_extent());
        let why = looked.settled.clone();
        let own_error = reason::offer(candidate).error;
        let rejected =
            (looked.candidates.iter().enumerate()).filter(|(index, _)| *index != pick).map(|(_, other)| {
                let time = with_shared(other);
                Rejected {
                    technique: other.technique,
                    on_device: other.on_device,
                    prediction: prediction(other).filter(|_| other.not_applicable.is_none()),
                    why: reason::rejected(other, scenery.prove, wall, time, (own.time, own_error)),
                }
            });
        LampPlan {
            lamp: number,
            name: effects::lamp_name(lamp, number),
            facing: looked.facing.of_probe,
            shadowed: looked.shadowed,
            pieces: self.pieces.len(),
            kept: looked.relevance.kept.clone(),
            is_reduced: looked.is_reduced,
            groups: vec![GroupPlan {
                receivers: Receivers::All,
                samples: (looked.facing.of_probe * self.probe.seen as f64).round() as usize,
                technique: candidate.technique,
                on_device: candidate.on_device,
                prediction: prediction(candidate).unwrap_or(Prediction {
                    error: 1.0,
                    evidence: Evidence::Assumed,
                    bound: 1.0,
                    time: duration(own.time),
                    time_evidence: costs.evidence,
                }),
                reason: why.unwrap_or_else(|| reason::chosen(own, penumbra, wall, &rivals)),
                rejected: rejected.collect(),
            }],
            grid: looked.grid,
        }
    }
}
