//! The truth of every sample: the pieces between it and the lamp; and what a relevance claims about it.

use super::super::{Equality, Outcome, Pieces, Question, Relevance, RelevanceTest, Triple};
use crate::geom::Light;
use crate::geom::predicate::side_of_light;
use crate::oracle::{Intersection, PrimaryHit};
use crate::scene::{Lamp, LampShape};

/// The pieces between one sample and the lamp.
#[derive(Clone, Debug, Default)]
struct Between {
    crossed: Vec<u32>,
    touched: Vec<u32>,
}

/// What lies between each sample that gets light and the lamp: its center, and some points at its border.
pub(super) struct Truth {
    samples: Vec<Between>,
}

/// Pieces that lie between a sample and the lamp, and pieces that alone make a sample dark.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Figures {
    pub(super) kept: usize,
    pub(super) needed: usize,
    pub(super) decisive: usize,
}

impl Truth {
    pub(super) fn of(question: &Question<'_>) -> Self {
        let Question { casters, pieces, lamp, samples, physical_falloff, .. } = *question;
        let mut all = Vec::new();
        for light in lights(lamp) {
            let lit = |hit: &&PrimaryHit| {
                side_of_light(hit.corners, &light) == hit.side && gets_light(lamp, hit, physical_falloff)
            };
            for hit in samples.hits().iter().flatten().filter(lit) {
                let mut between = Between::default();
                casters.oracle().for_each_meeting(hit.point, &light, |face, meeting| {
                    let list = match meeting {
                        Intersection::Crossing(_) => &mut between.crossed,
                        _ => &mut between.touched,
                    };
                    list.extend(pieces.of_face(face));
                });
                between.crossed.sort_unstable();
                between.crossed.dedup();
                all.push(between);
            }
        }
        Self { samples: all }
    }

    /// How many samples contradict what was dropped.
    pub(super) fn violations(&self, pieces: &Pieces, found: &Relevance) -> usize {
        let mut by: Vec<Option<RelevanceTest>> = vec![None; pieces.len()];
        let mut of_lamp = None;
        for dropped in &found.dropped {
            match dropped.what {
                Triple::Piece(piece) => by[piece as usize] = Some(dropped.test),
                Triple::Lamp => of_lamp = Some(dropped.test),
                Triple::Samples(_) => {}
            }
        }
        match (found.outcome, of_lamp) {
            (Outcome::Dark, Some(RelevanceTest::Zero)) => return 0,
            (Outcome::Dark, Some(RelevanceTest::NoReceiver)) => return self.samples.len(),
            (Outcome::Dark, _) => {
                return self.samples.iter().filter(|between| between.is_lit(|_| true)).count();
            }
            _ => {}
        }
        let kept: Vec<u32> = (0..pieces.len() as u32).filter(|&piece| by[piece as usize].is_none()).collect();
        assert_eq!(found.kept, kept, "what is not dropped is kept");
        let is_wrong = |between: &&Between| {
            let is_counted =
                |piece: &u32| by[*piece as usize].is_some_and(|test| test.equality() == Equality::Count);
            let is_kept = |piece: u32| by[piece as usize].is_none();
            between.crossed.iter().any(is_counted) || !between.crossed.is_empty() && between.is_lit(is_kept)
        };
        self.samples.iter().filter(is_wrong).count()
    }

    pub(super) fn figures(&self, pieces: &Pieces, found: &Relevance) -> Figures {
        let (mut needed, mut decisive) = (vec![false; pieces.len()], vec![false; pieces.len()]);
        for between in &self.samples {
            between.crossed.iter().for_each(|&piece| needed[piece as usize] = true);
            if let [only] = between.crossed[..] {
                decisive[only as usize] = true;
            }
        }
        let count = |list: Vec<bool>| list.into_iter().filter(|&is| is).count();
        Figures { kept: found.kept.len(), needed: count(needed), decisive: count(decisive) }
    }

    pub(super) fn len(&self) -> usize {
        self.samples.len()
    }
}

impl Between {
    /// Whether the shadow ray touches none of these pieces.
    fn is_lit(&self, of: impl Fn(u32) -> bool) -> bool {
        !self.crossed.iter().chain(&self.touched).any(|&piece| of(piece))
    }
}

/// The center of a lamp, and points at its border.
fn lights(lamp: &Lamp) -> Vec<Light> {
    let center = lamp.light().xyz();
    let mut lights = vec![*lamp.light()];
    let moved = |by: f32, axis: usize| {
        let mut place = center;
        place[axis] += by;
        place
    };
    match &lamp.shape {
        LampShape::Disk { radius, .. } => {
            let places = (0..3).flat_map(|axis| [moved(0.999 * radius, axis), moved(-0.999 * radius, axis)]);
            lights.extend(places.map(|place| Light::point(place).unwrap()));
        }
        LampShape::Sun { half_angle_rad, .. } => {
            // Across a direction that is an axis, but for a little.
            let length = center.iter().map(|x| x * x).sum::<f32>().sqrt();
            let by = 0.999 * length * half_angle_rad.tan();
            let longest = (0..3).max_by(|&a, &b| center[a].abs().total_cmp(&center[b].abs())).unwrap();
            for axis in (0..3).filter(|&axis| axis != longest) {
                for sign in [1.0, -1.0] {
                    let travel = moved(sign * by, axis).map(|x| -x);
                    lights.push(Light::directional(travel).unwrap());
                }
            }
        }
        LampShape::Rectangle(rectangle) => {
            let (corner, [u, v]) = (rectangle.corner(), rectangle.edges());
            for (s, t) in [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)] {
                let place = [0, 1, 2].map(|i| corner[i] + s * u[i] + t * v[i]);
                lights.push(Light::point(place).unwrap());
            }
        }
        _ => {}
    }
    lights
}

/// Whether the lamp's light reaches a point, by its range and cone alone.
fn gets_light(lamp: &Lamp, hit: &PrimaryHit, physical_falloff: bool) -> bool {
    if lamp.light().is_directional() {
        return true;
    }
    let away = [0, 1, 2].map(|i| f64::from(hit.point[i]) - f64::from(lamp.light().xyz()[i]));
    let distance = away.iter().map(|x| x * x).sum::<f64>().sqrt();
    let in_range = !physical_falloff || lamp.range.is_none_or(|range| distance < f64::from(range));
    in_range
        && lamp.cone.is_none_or(|cone| {
            let along: f64 = (0..3).map(|i| away[i] * f64::from(cone.direction[i])).sum();
            (along / distance).acos() < f64::from(cone.outer_rad)
        })
}
