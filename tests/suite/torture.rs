//! Adversarial queries, every method against every other.
//!
//! Long form:
//! `UMBRAGE_TORTURE_QUERIES=1000000000 cargo test --release --test suite torture_all -- --nocapture`.

use umbrage::testing::torture::{Effort, run};

#[test]
fn torture_all_judges_agree_and_plain_f32_does_not() {
    let queries = std::env::var("UMBRAGE_TORTURE_QUERIES")
        .map_or(10_000_000, |n| n.parse().expect("a number of queries"));
    let found = run(&Effort { queries, ..Effort::default() }, &|_| {});
    let total = found.total();
    eprintln!("{total:?}, rate of disagreement below {:?}", found.bound_95());
    assert!(found.agrees(), "{:?} {:?}", found.strata, found.disagreements);
    assert_eq!(total.queries, queries);
    let tries = |row: &umbrage::testing::torture::Outcomes| (row.queries - row.ties) as f64;
    let [generic, adversarial @ ..] = found.strata.as_slice() else { panic!("no strata") };
    assert_eq!(generic.name, "generic");
    for row in adversarial {
        // Ties occur mostly in aligned strata; of the other queries plain f32 gets one percent wrong, or
        // more.
        let most = match row.name {
            "cad_ties" => 0.5,
            "points_on_surface" => 0.6,
            _ => 0.25,
        };
        assert!((row.ties as f64) < most * row.queries as f64, "{row:?}");
        assert!(row.ties >= row.grazing.max(row.abstained) && row.ties <= row.grazing + row.abstained);
        assert!(row.plain_f32_wrong as f64 > 0.01 * tries(row), "{row:?}");
        assert!(row.plain_f32_faces_wrong > 0 && row.judged_by_whole_numbers > 0, "{row:?}");
        assert!(row.abstained > 0, "no point stands on a volume: {row:?}");
    }
    // Uniform sampling aims at nothing and hits nothing: it shows next to no errors.
    assert!((generic.plain_f32_wrong as f64) < 0.001 * tries(generic), "{generic:?}");
}
