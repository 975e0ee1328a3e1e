use super::round::Seam;
use super::*;
use crate::geom::{Facing, Light};
use crate::mesh::Mesh;
use crate::oracle::Oracle;
use crate::shadow::volume::ShadowVolume;
use crate::verify::points::judge::Cast;

/// Queries of a small run: two rounds per stratum.
const FEW: u64 = 17 * 2 * POINTS;

fn few(seam: Seam) -> Torture {
    run_with(&Effort { queries: FEW, seed: 7, keep: 10 }, &|_| {}, seam)
}

fn flipped(signs: &mut [i8]) {
    if let Some(sign) = signs.iter_mut().find(|sign| **sign != 0) {
        *sign = -*sign;
    }
}

fn taken_as_front(facing: &mut [Facing]) {
    if let Some(facing) = facing.iter_mut().find(|facing| **facing == Facing::Back) {
        *facing = Facing::Front;
    }
}

fn without_the_last_face(mesh: &Mesh) -> Oracle {
    let (positions, mut triangles, ..) = mesh.clone().into_parts();
    triangles.pop();
    Oracle::build(&Mesh::new(positions, triangles).unwrap())
}

const BOX: Aabb = Aabb { low: [-4.0; 3], high: [4.0; 3] };

/// Crossings are called touches.
const TOUCHES: Seam = Seam { cast: Cast::touch_all, ..Seam::SOUND };

/// Winding numbers abstain in all shadows.
const SHY: Seam = Seam { winding: |winding| winding.filter(|&winding| winding == 0), ..Seam::SOUND };

const LOST_FACE: Seam = Seam { oracle: without_the_last_face, ..Seam::SOUND };

#[test]
fn torture_finds_every_injected_fault() {
    let sound = few(Seam::SOUND);
    assert!(sound.agrees() && sound.case.is_none(), "{:?}", sound.disagreements);
    for (name, seam, [sides, open]) in [
        ("a flipped sign in one face's cast", Seam { signs: flipped, ..Seam::SOUND }, [false, false]),
        (
            "a dropped side triangle",
            Seam { volume: ShadowVolume::forget_a_side, ..Seam::SOUND },
            [false, true],
        ),
        ("a back face taken as front", Seam { facing: taken_as_front, ..Seam::SOUND }, [true, false]),
        ("a face lost by the ray cast", LOST_FACE, [false, false]),
        ("crossings called touches", TOUCHES, [false, false]),
        ("a winding number that abstains without a reason", SHY, [false, false]),
    ] {
        let found = few(seam);
        let total = found.total();
        assert!(total.wrong > 0 && !found.agrees() && found.bound_95().is_none(), "{name}: {total:?}");
        assert_eq!([total.faces_wrong > 0, total.open_volumes > 0], [sides, open], "{name}: {total:?}");
        // In nearly every stratum; where every second face is a sliver, the shadow of one is soon missed.
        let seen = found.strata.iter().filter(|row| row.wrong > 0).count();
        assert!(seen + 4 > found.strata.len(), "{name}: {:?}", found.strata);
        for kept in &found.disagreements {
            assert!(!kept.case.judge_with(seam).agrees, "{name} does not replay: {kept:?}");
        }
        let first = &found.disagreements[0];
        assert!(!first.case.judge_with(seam).agrees && first.case.judge().agrees, "{name}: {first:?}");
        let case = found.case.expect("there is a first disagreement");
        assert!(!case.judge_with(seam).agrees && case.judge().agrees, "{name}");
        assert!(case.mesh.face_count() <= first.case.mesh.face_count().min(4), "{name}: {case:?}");
    }
}

#[test]
fn torture_big_integers_find_a_lost_face_on_their_own() {
    let (mesh, light) = (crate::testing::shapes::cube(), Light::point([0.1, 0.2, 5.0]).unwrap());
    let seam = Seam { audits: 0, ..LOST_FACE };
    let prepared = Prepared::new(&mesh, &light, 1, false, seam);
    let said = |whole| {
        let point = [0.1, -0.3, -4.0]; // below the last face, which is half of the top
        let mut bench = prepared.bench(BOX);
        let points = [point, [-0.3, 0.1, -4.0]];
        points.map(|point| bench.judge(point, whole).say().iter().any(|line| line.starts_with("whole")))
    };
    assert_eq!(said(false), [false; 2]);
    assert!(said(true).contains(&true));
}

#[test]
fn torture_repro_is_minimal_and_reads_back_from_its_file() {
    let found = few(LOST_FACE);
    let case = found.case.as_ref().unwrap();
    // One face, which the ray cast loses, with small numbers for corners.
    assert_eq!((case.mesh.face_count(), case.mesh.vertex_count()), (1, 3), "{case:?}");
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("case.obj");
    found.write_case(7, &path).unwrap();
    let read = Repro::read(&path).unwrap();
    assert_eq!(
        (read.mesh.positions(), read.mesh.triangles(), read.light, read.point, read.signs, read.within),
        (case.mesh.positions(), case.mesh.triangles(), case.light, case.point, case.signs, case.within)
    );
    assert!(read.judge().agrees && !read.judge_with(LOST_FACE).agrees);
    let text = std::fs::read_to_string(&path).unwrap();
    assert!(text.contains("\n# seed 7, stratum ") && text.contains("\n# said"), "{text}");
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
}

#[test]
fn torture_repro_on_which_all_agree_is_not_minimized() {
    let mesh = crate::testing::shapes::cube();
    let case =
        Repro { mesh, light: Light::point([0.1, 0.2, 5.0]).unwrap(), point: [0.3; 3], signs: 1, within: BOX };
    assert_eq!(minimize::minimize(&case, Seam::SOUND), case);
}

#[test]
fn torture_disagreements_come_first_by_stratum_round_and_query() {
    let effort = Effort { queries: FEW, seed: 7, keep: 3 };
    let found = run_with(&effort, &|_| {}, LOST_FACE);
    let all = run_with(&Effort { keep: 100_000, ..effort }, &|_| {}, LOST_FACE);
    let key = |found: &Contradiction| (found.stratum, found.round, found.query);
    assert!(all.disagreements.is_sorted_by_key(key) && all.disagreements.len() > 100);
    assert_eq!(found.disagreements, all.disagreements[..3]);
    assert_eq!(all.disagreements.len() as u64, all.total().wrong);
}

#[test]
fn torture_draws_every_kind_of_mesh_within_its_size() {
    let mut most = 0;
    for stratum in 0..RECIPES.len() {
        for round in 0..300 {
            let (mesh, _) = RECIPES[stratum].draw(&mut source(1, stratum, round));
            assert!(mesh.face_count() > 0);
            most = most.max(mesh.face_count());
        }
    }
    assert!((40..=80).contains(&most), "{most}");
}

#[test]
fn torture_spreads_queries_evenly_and_keeps_to_their_number() {
    for queries in [1, 16, 17, 18, 5000] {
        let mut done = std::sync::atomic::AtomicU64::new(0);
        let add = |queries| _ = done.fetch_add(queries, std::sync::atomic::Ordering::Relaxed);
        let found = run(&Effort { queries, ..Effort::default() }, &add);
        assert_eq!((found.total().queries, *done.get_mut()), (queries, queries));
        let each: Vec<u64> = found.strata.iter().map(|row| row.queries).collect();
        assert!(each.iter().max().unwrap() - each.iter().min().unwrap() <= 1, "{each:?}");
    }
}

#[test]
fn torture_audit_of_ties_sees_an_oracle_that_only_touches_far_more_often_than_the_sample() {
    let wrong = |audits| few(Seam { audits, ..TOUCHES }).total().wrong;
    let (sampled, audited) = (wrong(0), wrong(8));
    assert!(sampled > 0 && audited > 4 * sampled, "{sampled} by the sample, {audited} with the audit");
}

#[test]
fn torture_counts_ties_as_the_union_of_grazing_and_abstained() {
    for row in few(Seam::SOUND).strata {
        assert!(
            row.ties <= row.grazing + row.abstained && row.ties >= row.grazing.max(row.abstained),
            "{row:?}"
        );
        assert!(row.rounds <= 2, "{row:?}");
    }
}

#[test]
fn torture_bound_by_rounds_is_that_of_independent_draws() {
    let found = few(Seam::SOUND);
    let (queries, rounds) = (found.bound_95().unwrap(), found.bound_95_rounds().unwrap());
    assert!(rounds >= 3.0 / 34.0 && rounds > 50.0 * queries, "{rounds} {queries}");
    assert_eq!(few(LOST_FACE).bound_95_rounds(), None);
}

#[test]
fn torture_points_on_surface_are_there() {
    let recipe = RECIPES.iter().find(|recipe| recipe.name == "points_on_surface").unwrap();
    let there = recipe.points.iter().filter(|&&kind| kind == stratum::ON_SURFACE).count();
    assert!(3 * there >= 2 * recipe.points.len());
    let mesh = crate::testing::shapes::cube();
    let light = Light::point([0.1, 0.2, 5.0]).unwrap();
    let prepared = Prepared::new(&mesh, &light, 1, false, Seam::SOUND);
    let sampler = prepared.sampler();
    let mut random = SplitMix64(1);
    for _ in 0..500 {
        let p = sampler.draw(stratum::ON_SURFACE, &mut random);
        // A cube's faces are axis-aligned: no rounding leads off them.
        assert!(
            sampler.bounds.contains(p)
                && (0..3).any(|i| p[i] == sampler.bounds.low[i] || p[i] == sampler.bounds.high[i]),
            "{p:?}"
        );
    }
}
