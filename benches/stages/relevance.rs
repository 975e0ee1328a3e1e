//! Relevance: which casters of a city matter for a view, and the time to find them.

use umbrage::caster::{Caster, CasterGroup};
use umbrage::geom::predicate::side_of_light;
use umbrage::oracle::{Intersection, PrimaryHit};
use umbrage::plan::relevance::{Pieces, Question, Relevance, RelevanceTest, TestSet, Triple, relevant};
use umbrage::scene::Lamp;
use umbrage::shadow::Samples;
use umbrage::testing::scenes::{City, Place, city};
use umbrage::view::Size;

use crate::measure::{Bench, Contender, Group, timed};

const STAGE: &str = "relevance";

pub(crate) fn run(bench: &mut Bench<'_>) {
    if !bench.wants(STAGE) {
        return;
    }
    let city = city(7, 565);
    let caster = Caster::new(city.scene());
    let casters = CasterGroup::new(vec![&caster]);
    let pieces = Pieces::of(&casters);
    for place in Place::ALL {
        for (number, name) in ["high sun", "low sun", "street lamp"].into_iter().enumerate() {
            view(bench, &city, (&casters, &pieces), place, (number, name));
        }
    }
}

fn view(
    bench: &mut Bench<'_>,
    city: &City,
    (casters, pieces): (&CasterGroup<'_>, &Pieces),
    place: Place,
    (number, name): (usize, &str),
) {
    let size = if bench.quick { Size::new(80, 45) } else { Size::new(160, 90) }.expect("in range");
    let camera = city.camera(place);
    let projection = camera.projection(size, camera.near([casters.casters()[0].mesh()], size));
    let samples = Samples::of_view(casters, &projection, size, 1).expect("they fit");
    let lamp = &city.lamps()[number];
    let question = |tests: TestSet| Question {
        casters,
        pieces,
        lamp,
        number,
        samples: &samples,
        physical_falloff: true,
        level: 0.0,
        tests,
    };
    let between = between(&question(TestSet::NONE));
    let [needed, decisive] = [|crossed: &[u32]| !crossed.is_empty(), |crossed: &[u32]| crossed.len() == 1]
        .map(|counts| distinct(between.iter().filter(|crossed| counts(crossed))));
    let boxes = TestSet::only(RelevanceTest::Parted).with(RelevanceTest::OutOfReach);
    let sets = [
        ("boxes against the view", boxes),
        ("and against tiles", boxes.with(RelevanceTest::Tiles)),
        ("all but what is known", TestSet::ALL.without(RelevanceTest::Known)),
        ("all tests", TestSet::ALL),
    ];
    let mut contenders = Vec::new();
    let mut kept = 0;
    for (name, tests) in sets {
        let found = relevant(&question(tests));
        assert_eq!(wrong(&between, pieces, &found), 0, "{} {name}", place.name());
        kept = found.kept.len();
        let answer = |found: &Relevance| format!("{} kept", found.kept.len());
        let expected = answer(&found);
        let run = move || timed(|| relevant(&question(tests)), answer);
        contenders.push(Contender::new(name, run).expects(expected));
    }
    // A test that keeps everything is never wrong. Of a few casters some more are kept.
    assert!(place != Place::Street || 2 * kept <= 5 * needed + 16, "{kept} kept, {needed} needed");
    let mesh = format!("{}, {name} · {needed} needed, {decisive} decisive", place.name());
    bench.run(Group { stage: STAGE, mesh, units: pieces.len(), unit: "piece", contenders });
}

/// The pieces between each sample that gets light and the lamp, ascending.
fn between(question: &Question<'_>) -> Vec<Vec<u32>> {
    let Question { casters, pieces, lamp, samples, .. } = *question;
    let lit = |hit: &&PrimaryHit| side_of_light(hit.corners, lamp.light()) == hit.side && in_range(lamp, hit);
    let crossed = |hit: &PrimaryHit| {
        let mut crossed = Vec::new();
        casters.oracle().for_each_meeting(hit.point, lamp.light(), |face, meeting| {
            if matches!(meeting, Intersection::Crossing(_)) {
                crossed.extend(pieces.of_face(face));
            }
        });
        crossed.sort_unstable();
        crossed.dedup();
        crossed
    };
    samples.hits().iter().flatten().filter(lit).map(crossed).collect()
}

fn in_range(lamp: &Lamp, hit: &PrimaryHit) -> bool {
    let away = [0, 1, 2].map(|i| f64::from(hit.point[i]) - f64::from(lamp.light().xyz()[i]));
    let squared = away.iter().map(|x| x * x).sum::<f64>();
    lamp.range.is_none_or(|range| squared < f64::from(range).powi(2))
}

fn distinct<'a>(lists: impl Iterator<Item = &'a Vec<u32>>) -> usize {
    let mut all: Vec<u32> = lists.flatten().copied().collect();
    all.sort_unstable();
    all.dedup();
    all.len()
}

/// Samples that are dark and would be lit, or whose rays a piece crosses that was said not to.
fn wrong(between: &[Vec<u32>], pieces: &Pieces, found: &Relevance) -> usize {
    let mut by = vec![None; pieces.len()];
    for dropped in &found.dropped {
        if let Triple::Piece(piece) = dropped.what {
            by[piece as usize] = Some(dropped.test);
        }
    }
    let boxes = [RelevanceTest::Parted, RelevanceTest::Tiles, RelevanceTest::OutOfReach];
    let is_wrong = |crossed: &&Vec<u32>| {
        let test_of = |piece: &u32| by[*piece as usize];
        let is_lost = !crossed.is_empty() && crossed.iter().all(|piece| test_of(piece).is_some());
        is_lost || crossed.iter().any(|piece| test_of(piece).is_some_and(|test| boxes.contains(&test)))
    };
    between.iter().filter(is_wrong).count()
}
