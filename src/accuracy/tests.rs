use super::compare::{Contender, Stratum, compare, mark_dominated};
use super::plain::PlainTree;
use super::*;
use crate::facing::{FacePlanes, classify};
use crate::geom::Facing;
use crate::geom::predicate::collinear;
use crate::oracle::{Oracle, Verdict};
use crate::testing::shapes;
use crate::verify::reference;

const FEW: Options = Options { queries: 2000, seed: 7, rounds: 1 };

fn lights() -> Vec<Light> {
    ["point:2,3,5", "point:0.5,0.25,-8", "directional:1,-2,0.5"].map(|text| text.parse().unwrap()).to_vec()
}

fn solids() -> Vec<Mesh> {
    vec![
        shapes::cube(),
        shapes::torus(24, 12, 2.0, 0.7),
        shapes::scaled(&shapes::icosphere(2), 1e-30),
        shapes::scaled(&shapes::torus_knot(2, 3, 30, 6, 0.3), 1e30),
        shapes::menger_sponge(1),
        shapes::double_sheet(),
    ]
}

/// A result without its times, which differ between runs.
fn timeless(mut found: Accuracy) -> Accuracy {
    for method in &mut found.methods {
        let rows = method.strata.iter_mut().chain([&mut method.total]);
        rows.for_each(|row| row.time = Spread::default());
        (method.prepare_ns, method.ratio, method.dominated) = (None, 0.0, false);
    }
    found
}

fn measured(question: Question, mesh: &Mesh, options: &Options) -> Accuracy {
    question.measure(mesh, &lights(), options, &|_| {}).unwrap()
}

#[test]
fn accuracy_is_the_same_for_a_seed_and_another_for_another() {
    let mesh = shapes::torus(24, 12, 2.0, 0.7);
    for question in [Question::Facing, Question::Visibility] {
        let run = |seed, rounds| timeless(measured(question, &mesh, &Options { seed, rounds, ..FEW }));
        assert_eq!(run(1, 1), run(1, 3));
        assert_ne!(run(1, 1), run(2, 1));
    }
}

#[test]
fn accuracy_exact_methods_are_right_and_plain_f32_is_not() {
    for question in [Question::Facing, Question::Visibility] {
        let mut wrong = 0;
        for mesh in solids() {
            let found = measured(question, &mesh, &FEW);
            assert!(found.exact_is_right(), "{question:?} {}: {found:?}", mesh.name);
            let [first, ..] = &found.methods[..] else { panic!("no methods") };
            assert!(!first.exact && first.ratio == 1.0 && first.total.judged <= first.total.queries);
            wrong += first.total.wrong;
        }
        assert!(wrong > 50, "{question:?}: {wrong}");
    }
}

#[test]
fn accuracy_rows_add_up_and_times_are_there() {
    let steps = std::cell::Cell::new(0);
    let count = |done| steps.set(steps.get() + done);
    for question in [Question::Facing, Question::Visibility] {
        steps.set(0);
        let found = question.measure(&shapes::cube(), &lights(), &FEW, &count).unwrap();
        assert_eq!(steps.get(), question.steps(&FEW));
        for method in &found.methods {
            assert_eq!(method.strata.iter().map(|row| row.name).collect::<Vec<_>>(), question.strata());
            let sum = |of: fn(&Row) -> u64| method.strata.iter().map(of).sum::<u64>();
            let total = method.total;
            assert_eq!(
                [total.queries, total.ties, total.judged, total.wrong],
                [sum(|row| row.queries), sum(|row| row.ties), sum(|row| row.judged), sum(|row| row.wrong)]
            );
            let untied = if method.exact { total.queries } else { total.queries - total.ties };
            assert_eq!(total.judged, untied, "{}", method.name);
            for row in method.strata.iter().chain([&total]) {
                let Spread { median, min, max } = row.time;
                assert!(0.0 < min && min <= median && median <= max && row.queries > 0, "{row:?}");
            }
        }
    }
}

#[test]
fn accuracy_asks_nothing_of_an_empty_mesh_or_in_the_dark() {
    let empty = Mesh::new(vec![[0.0; 3]], vec![]).unwrap();
    for question in [Question::Facing, Question::Visibility] {
        assert_eq!(question.measure(&empty, &lights(), &FEW, &|_| {}), None);
        assert_eq!(question.measure(&shapes::cube(), &[], &FEW, &|_| {}), None);
    }
}

/// Fault injected: the method answers as another one, but gets the first query of each batch wrong.
fn spoiled<A: Copy + 'static>(mut of: Contender<'_, A>, turn: fn(A) -> A) -> Contender<'_, A> {
    let ask = move |stratum: usize, batch: usize, out: &mut Vec<A>| {
        (of.ask)(stratum, batch, out);
        out[0] = turn(out[0]);
    };
    Contender { ask: Box::new(ask), ..of }
}

#[test]
fn accuracy_counts_a_fault_of_facing_in_every_batch() {
    let mesh = shapes::torus(24, 12, 2.0, 0.7);
    let lights = lights::draw(&mesh, &lights(), &FEW);
    let (planes, truth) = (FacePlanes::new(&mesh), facing::truth(&mesh, &lights));
    let turn = |side| if side == Facing::Front { Facing::Back } else { Facing::Front };
    let all = facing::contenders(&mesh, &lights, &planes, 0.0);
    let mut all: Vec<_> = all.into_iter().map(|contender| spoiled(contender, turn)).collect();
    for method in compare(&truth, &mut all, 1, &|_| {}).iter().filter(|method| method.exact) {
        for (row, lights) in method.strata.iter().zip(&lights) {
            assert_eq!(row.wrong, lights.len() as u64, "{}, {}", method.name, row.name);
        }
    }
}

#[test]
fn accuracy_counts_a_fault_of_visibility_in_every_batch() {
    let mesh = shapes::torus(24, 12, 2.0, 0.7);
    let (lights, oracle) = (lights(), Oracle::build(&mesh));
    let points = points::draw(&mesh, &lights, &FEW);
    let (truth, all_faces) = visibility::truth(&mesh, &oracle, &lights, &points, &|_| {});
    assert!(all_faces > 100, "{all_faces}");
    let turn = |verdict| if verdict == Verdict::Lit { Verdict::Shadowed } else { Verdict::Lit };
    let plain = PlainTree::build(&mesh);
    let all = visibility::contenders(&plain, &oracle, &lights, &points, 5);
    let mut all: Vec<_> = all.into_iter().map(|contender| spoiled(contender, turn)).collect();
    let methods = compare(&truth, &mut all, 1, &|_| {});
    for method in methods.iter().filter(|method| method.exact) {
        assert!(method.strata.iter().all(|row| row.wrong == lights.len() as u64), "{method:?}");
    }
    let each = 2000_u64.div_ceil(3);
    assert_eq!([1, 2].map(|who| methods[who].strata[0].queries), [3 * each, 3 * each.div_ceil(5)]);
}

#[test]
fn accuracy_takes_either_answer_to_a_tie_except_from_exact_methods() {
    let tied = [Stratum { name: "tied", truth: vec![vec![Facing::EdgeOn; 3]] }];
    let of = |exact, answer| Contender {
        name: "",
        exact,
        prepare_ns: None,
        every: 1,
        ask: Box::new(move |_, _, out: &mut Vec<Facing>| {
            out.clear();
            out.extend([answer; 3]);
        }),
    };
    let mut all = [of(false, Facing::Back), of(true, Facing::Front), of(true, Facing::EdgeOn)];
    let methods = compare(&tied, &mut all, 1, &|_| {});
    let counts = |row: &Row| [row.ties, row.judged, row.wrong];
    assert_eq!([0, 1, 2].map(|who| counts(&methods[who].total)), [[3, 0, 0], [3, 3, 3], [3, 3, 0]]);
    assert_eq!([0, 1, 2].map(|who| methods[who].total.bound_95()), [None, None, Some(1.0)]);
}

#[test]
fn accuracy_whole_numbers_on_the_tree_say_what_they_say_of_all_faces() {
    let (lights, mut differ) = (lights(), 0);
    for mesh in solids() {
        let points = points::draw(&mesh, &lights, &Options { queries: 60, ..FEW });
        let (positions, mut triangles) = (mesh.positions().to_vec(), mesh.triangles().to_vec());
        triangles.truncate(triangles.len() / 2);
        // Fault injected: half of the faces are missing.
        let half = Oracle::build(&Mesh::new(positions, triangles).unwrap());
        let oracle = Oracle::build(&mesh);
        for points in &points {
            for (light, p) in
                lights.iter().zip(points).flat_map(|(light, points)| points.iter().map(move |&p| (light, p)))
            {
                let all = reference(&mesh, p, light).crossings.verdict();
                assert_eq!(oracle.verdict_in_whole_numbers(p, light), all, "{} {p:?} {light}", mesh.name);
                differ += usize::from(half.verdict_in_whole_numbers(p, light) != all);
            }
        }
    }
    assert!(differ > 200, "half of the faces are missed {differ} times");
}

#[test]
fn accuracy_plain_tree_finds_what_the_exact_one_finds_where_nothing_is_aimed_at() {
    // Equal boxes: no plane splits this tree.
    let many = Mesh::concat(&vec![shapes::tetrahedron(); 50]).unwrap();
    for mesh in [shapes::torus_knot(2, 3, 60, 8, 0.3), shapes::tetrahedron(), many] {
        let (lights, oracle) = (lights(), Oracle::build(&mesh));
        let plain = PlainTree::build(&mesh);
        let points = points::draw(&mesh, &lights, &FEW);
        let mut shadowed = 0;
        for (light, points) in lights.iter().zip(&points[0]) {
            for &p in points {
                let dark = plain.shadowed(p, light);
                assert_eq!(dark, oracle.verdict(p, light) == Verdict::Shadowed, "{} {p:?}", mesh.name);
                shadowed += usize::from(dark);
            }
        }
        assert!(shadowed > 20, "{}: {shadowed}", mesh.name);
    }
}

#[test]
fn accuracy_lights_are_where_their_strata_say() {
    let mesh = shapes::cube();
    let drawn = lights::draw(&mesh, &lights(), &FEW);
    let of = |name: &str| &drawn[lights::STRATA.iter().position(|(other, _)| *other == name).unwrap()];
    assert_eq!(*of("given"), lights());
    assert_eq!(of("general").len(), 2000_usize.div_ceil(12));
    let edge_on = |light: &Light| classify(&mesh, light).contains(&Facing::EdgeOn);
    for light in of("vertex") {
        assert!(mesh.positions().contains(&light.xyz()));
    }
    for light in of("face_plane") {
        assert!(!light.is_directional() && edge_on(light));
    }
    for light in of("along_face") {
        assert!(light.is_directional() && edge_on(light));
    }
    for light in of("axis") {
        assert!(light.is_directional() && light.xyz().iter().filter(|&&x| x != 0.0).count() == 1);
    }
    for light in of("far") {
        let away = light.xyz().iter().map(|&x| f64::from(x).powi(2)).sum::<f64>().sqrt();
        assert!(away > 2_f64.powi(29), "{light}");
    }
    // One ulp off moves a light out of every plane, except in one of three coordinates that were not changed.
    let off = of("one_ulp_off").iter().filter(|light| !edge_on(light)).count();
    assert!(off > 20, "{off}");
}

#[test]
fn accuracy_points_are_where_their_strata_say() {
    // Coordinates of few bits, so that nothing is rounded.
    let (mesh, lights) = (shapes::cube(), lights());
    let points = points::draw(&mesh, &lights, &FEW);
    let vertices = mesh.positions();
    let passes = |p: [f32; 3], light: &Light| {
        let l = light.xyz();
        let towards = |v: &[f32; 3]| if light.is_directional() { [0, 1, 2].map(|i| v[i] + l[i]) } else { l };
        vertices.iter().any(|v| collinear(p, *v, towards(v)))
    };
    let of = |name: &str| &points[points::STRATA.iter().position(|other| *other == name).unwrap()];
    for (light, points) in lights.iter().zip(of("behind_vertex")) {
        assert!(points.iter().all(|&p| passes(p, light)), "{light}");
    }
    for (light, points) in lights.iter().zip(of("box")) {
        assert!(points.iter().filter(|&&p| passes(p, light)).count() < 3, "{light}");
    }
    // Behind an edge of a cube most segments are shadowed or touch the cube; without rounding all of them
    // would.
    let oracle = Oracle::build(&mesh);
    for (light, points) in lights.iter().zip(of("behind_edge")) {
        let lit = points.iter().filter(|&&p| oracle.verdict(p, light) == Verdict::Lit).count();
        assert!(4 * lit < points.len(), "{light}: {lit} of {}", points.len());
    }
    let [low, high] = mesh.bounds().unwrap();
    for p in of("near_face").iter().flatten() {
        let near = |x: f32, plane: f32| (x - plane).abs() <= 2.0 * f32::EPSILON;
        assert!((0..3).any(|i| near(p[i], low[i]) || near(p[i], high[i])), "{p:?}");
    }
}

#[test]
fn accuracy_given_lights_are_at_most_sixteen_from_all_over_the_list() {
    let many: Vec<Light> = (0..1000_u16).map(|i| Light::point([f32::from(i), 0.0, 0.0]).unwrap()).collect();
    let few = lights::spread(&many);
    assert_eq!((few.len(), few[0], few[8]), (16, many[0], many[500]));
    assert_eq!(lights::spread(&many[..3]), many[..3]);
}

#[test]
fn accuracy_dominated_is_what_another_beats_in_one_way_and_ties_in_the_other() {
    let row = |median, wrong| Row {
        name: "",
        queries: 100,
        ties: 0,
        judged: 100,
        wrong,
        time: Spread { median, ..Spread::default() },
    };
    let method = |(median, wrong)| Method {
        name: "",
        exact: false,
        prepare_ns: None,
        every: 1,
        ratio: 1.0,
        dominated: false,
        strata: vec![],
        total: row(median, wrong),
    };
    let mut methods = [(1.0, 5), (2.0, 0), (2.0, 0), (3.0, 0), (1.0, 6), (0.5, 9)].map(method);
    mark_dominated(&mut methods);
    assert_eq!(methods.map(|method| method.dominated), [false, false, false, true, true, false]);
}

#[test]
fn accuracy_spread_is_of_the_rounds() {
    let spread = |values: &[f64]| Spread::of(values.to_vec());
    assert_eq!(spread(&[3.0, 1.0, 9.0]), Spread { median: 3.0, min: 1.0, max: 9.0 });
    assert_eq!(spread(&[4.0, 2.0]).median, 3.0);
}
