//! Methods that decide whether a point is in shadow.

use super::compare::{Contender, Stratum, compare, prepared};
use super::plain::PlainTree;
use super::points::STRATA;
use super::{Accuracy, Options, lights, points};
use crate::geom::Light;
use crate::mesh::Mesh;
use crate::oracle::{Oracle, Verdict};
use crate::verify::reference;

/// Approximate number of queries per stratum on which the big-integer method is timed.
const SAMPLE: u64 = 500;

/// Number of faces tested in total when big integers test all faces of the mesh: about a second of work.
const ALL_FACES: usize = 400_000;
/// Maximum number of queries for which big integers test all faces of the mesh.
const MOST_BY_ALL_FACES: usize = 400;

pub(super) fn measure(mesh: &Mesh, given: &[Light], options: &Options, progress: &dyn Fn(u64)) -> Accuracy {
    let lights = lights::spread(given);
    let points = points::draw(mesh, &lights, options);
    let (oracle, prepare_ns) = prepared(mesh.face_count(), || Oracle::build(mesh));
    let (strata, judged_by_all_faces) = truth(mesh, &oracle, &lights, &points, progress);
    let (plain, prepare_plain_ns) = prepared(mesh.face_count(), || PlainTree::build(mesh));
    let every = options.queries.div_ceil(SAMPLE).max(1) as usize;
    let mut contenders = contenders(&plain, &oracle, &lights, &points, every);
    contenders[0].prepare_ns = Some(prepare_plain_ns);
    contenders[1].prepare_ns = Some(prepare_ns);
    let methods = compare(&strata, &mut contenders, options.rounds, progress);
    Accuracy { methods, judged_by_all_faces: Some(judged_by_all_faces) }
}

/// All methods, plain `f32` first. The big-integer method answers one query in `every`.
pub(super) fn contenders<'a>(
    plain: &'a PlainTree,
    oracle: &'a Oracle,
    lights: &'a [Light],
    points: &'a [Vec<Vec<[f32; 3]>>],
    every: usize,
) -> Vec<Contender<'a, Verdict>> {
    vec![
        contender("plain f32", false, 1, lights, points, |p, light| {
            if plain.shadowed(p, light) { Verdict::Shadowed } else { Verdict::Lit }
        }),
        contender("exact ray cast", true, 1, lights, points, |p, light| oracle.verdict(p, light)),
        contender("whole numbers", true, every, lights, points, |p, light| {
            oracle.verdict_in_whole_numbers(p, light)
        }),
    ]
}

/// A method that answers each point independently.
pub(super) fn contender<'a>(
    name: &'static str,
    exact: bool,
    every: usize,
    lights: &'a [Light],
    points: &'a [Vec<Vec<[f32; 3]>>],
    verdict: impl Fn([f32; 3], &Light) -> Verdict + 'a,
) -> Contender<'a, Verdict> {
    let ask = move |stratum: usize, batch: usize, out: &mut Vec<Verdict>| {
        let (light, points) = (&lights[batch], &points[stratum][batch]);
        out.clear();
        out.extend(points.iter().step_by(every).map(|&p| verdict(p, light)));
    };
    Contender { name, exact, prepare_ns: None, every, ask: Box::new(ask) }
}

/// The true verdict of every query, with big integers over the faces that the oracle's tree does not cull. A
/// sample of the queries is decided over all faces instead. Returns the number of sampled queries too.
pub(super) fn truth(
    mesh: &Mesh,
    oracle: &Oracle,
    lights: &[Light],
    points: &[Vec<Vec<[f32; 3]>>],
    progress: &dyn Fn(u64),
) -> (Vec<Stratum<Verdict>>, u64) {
    let queries: usize = points.iter().flatten().map(Vec::len).sum();
    let samples = (ALL_FACES / mesh.face_count().max(1)).clamp(STRATA.len(), MOST_BY_ALL_FACES);
    let every = queries.div_ceil(samples);
    let (mut asked, mut sampled) = (0, 0);
    let mut verdict = |p, light| {
        asked += 1;
        if asked % every != 0 {
            return oracle.verdict_in_whole_numbers(p, light);
        }
        sampled += 1;
        reference(mesh, p, light).crossings.verdict()
    };
    let mut strata = Vec::with_capacity(STRATA.len());
    for (name, points) in STRATA.into_iter().zip(points) {
        let truth = lights
            .iter()
            .zip(points)
            .map(|(light, points)| points.iter().map(|&p| verdict(p, light)).collect())
            .collect();
        strata.push(Stratum { name, truth });
        progress(1);
    }
    (strata, sampled)
}
