//! Reports as JSON, or in any other format of serde: keys and their order are a contract.
//!
//! They are all on this page, rather than derived beside the types, because most reports have a key that is
//! no field (a bound, a median, a total) or a field that is null depending on another. What was not computed
//! is null. So are NaN and infinity, which JSON does not have. Single-precision numbers have no more digits
//! than they need.

use serde::ser::{Serialize, SerializeMap, Serializer};

use crate::check::{Counts, CrackReport, Defect, DefectKind, NearMiss, SelfIntersections, ShellReport};
use crate::choice::{Choice, Reason};
use crate::facing::CasterFaces;
use crate::geom::{Aabb, Light};
use crate::mesh::{EdgeId, FaceId, VertexId};
use crate::oracle::Verdict;
use crate::repair::{Change, ChangeKind, Left, Patch, Step};
use crate::shadow::stencil::StencilMethod;
use crate::silhouette::SilhouetteMethod;
use crate::verify::pixels::{Comparison, Mismatch, PixelCounts, PixelVerdict};

/// Adds entries to a map: `key` for the field of that name, `key: value` for anything else.
macro_rules! entries {
    ($out:expr, $of:expr, { $($key:ident $(: $value:expr)?),* $(,)? }) => {
        $( entries!(@ $out, $of, $key $(, $value)?); )*
    };
    (@ $out:expr, $of:expr, $key:ident) => { $out.serialize_entry(stringify!($key), &$of.$key)? };
    (@ $out:expr, $of:expr, $key:ident, $value:expr) => { $out.serialize_entry(stringify!($key), &$value)? };
}

/// Serializes a type as a map with these entries.
macro_rules! map {
    ($type:ty, $this:ident => $entries:tt) => {
        impl Serialize for $type {
            fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
                let $this = self;
                let mut out = serializer.serialize_map(None)?;
                entries!(out, $this, $entries);
                out.end()
            }
        }
    };
}

/// Serializes a type as the text or number that an expression gives.
macro_rules! value {
    ($type:ty, $this:ident => $value:expr) => {
        impl Serialize for $type {
            fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
                let $this = self;
                $value.serialize(serializer)
            }
        }
    };
}

// Names, ids and numbers.

value!(DefectKind, kind => kind.name());
value!(CasterFaces, faces => faces.name());
value!(StencilMethod, method => method.name());
value!(SilhouetteMethod, method => method.to_string());
value!(PixelVerdict, verdict => verdict.name());
value!(ChangeKind, kind => kind.name());
value!(Left, left => left.name());
value!(Reason, reason => reason.to_string());
value!(Light, light => light.to_string());
value!(VertexId, id => id.0);
value!(EdgeId, id => id.0);
value!(FaceId, id => id.0);
value!(Aabb, aabb => [short(aabb.low), short(aabb.high)]);
value!(Verdict, verdict => match verdict {
    Verdict::Lit => "lit",
    Verdict::Shadowed => "shadowed",
    Verdict::Grazing => "grazing",
});

/// Coordinates in double precision, with the digits that they have in single precision.
fn short(point: [f32; 3]) -> [f64; 3] {
    // The shortest decimal that reads back as the f32; "NaN" and "inf" are numbers for the parser, too.
    point.map(|x| x.to_string().parse().unwrap_or(f64::NAN))
}

// Choices.

impl<T: Serialize> Serialize for Choice<T> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut out = serializer.serialize_map(None)?;
        entries!(out, self, { what, why });
        out.end()
    }
}

// Steps of repair.

map!(Step, step => { name, count, left, changes, largest_move });
map!(Change, change => { kind, old, new, at: short(change.at), patch });
map!(Patch, patch => { edges, length, area, off_plane, meets, left });

// The crack report.

/// The numbers of a report. Those that are less than there may be are null.
fn numbers<M: SerializeMap>(
    out: &mut M,
    counts: &Counts,
    t_junctions_complete: bool,
) -> Result<(), M::Error> {
    entries!(out, counts, {
        faces, edges, shells, closed_shells, euler_characteristic,
        boundary_edges, boundary_loops, non_manifold_edges, max_faces_per_edge,
        misoriented_edges, non_manifold_vertices, collapsed_faces, zero_area_faces, duplicate_faces, near_miss_edges,
        t_junctions: t_junctions_complete.then_some(counts.t_junctions),
        inside_out_shells: (counts.undecided_shells == 0).then_some(counts.inside_out_shells),
        self_intersections: counts.self_intersections.filter(|_| counts.self_intersections_complete),
        signed_volume: counts.balanced.then_some(counts.signed_volume),
        watertight, balanced, even,
    });
    Ok(())
}

impl Serialize for Counts {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut out = serializer.serialize_map(None)?;
        numbers(&mut out, self, self.t_junctions_complete)?;
        out.end()
    }
}

impl Serialize for CrackReport {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut out = serializer.serialize_map(None)?;
        numbers(&mut out, &self.counts, self.t_junctions_complete)?;
        entries!(out, self, { shell_list, nesting_complete, t_junctions_complete });
        out.end()
    }
}

map!(ShellReport, shell => {
    first_face, faces, edges, vertices, euler_characteristic, genus,
    signed_volume: shell.balanced.then_some(shell.signed_volume),
    watertight, balanced, state: shell.state(),
    inside_out: (!shell.undecided()).then_some(shell.inside_out),
    depth: shell.depth_known.then_some(shell.depth),
    parent, bounds,
});

map!(NearMiss, near => { relative, distance, edges });
map!(SelfIntersections, found => { pairs, faces, first, complete });
map!(Defect, defect => {
    position: short(defect.position),
    length, faces,
    segments: defect.segments.iter().map(|ends| ends.map(short)).collect::<Vec<_>>(),
});

// Verification of pixels.

fn pixels<M: SerializeMap>(out: &mut M, counts: &PixelCounts) -> Result<(), M::Error> {
    PixelVerdict::ALL
        .into_iter()
        .try_for_each(|verdict| out.serialize_entry(verdict.name(), &counts.of(verdict)))
}

impl Serialize for PixelCounts {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut out = serializer.serialize_map(None)?;
        pixels(&mut out, self)?;
        out.end()
    }
}

map!(Mismatch, found => { pixel: [found.x, found.y], point: found.point.map(short), exact, counted, cut });

impl Serialize for Comparison {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut out = serializer.serialize_map(None)?;
        pixels(&mut out, &self.counts())?;
        entries!(out, self, { mismatches });
        out.end()
    }
}

#[cfg(feature = "verify")]
mod verified {
    //! The reports of the feature `verify`.

    use super::{Serialize, SerializeMap, Serializer, short};
    use crate::accuracy::{Accuracy, AmbientAccuracy, AmbientMethod, AmbientRow, AmbientTruth};
    use crate::accuracy::{Method, Question, Row};
    use crate::testing::torture::{self, Torture};
    use crate::verify::points::{Disagreement, Judge, Stratum, Verification};

    // Verification of points.

    map!(Stratum, row => { name, points, agree, grazing, disagree, bound_95: row.bound_95() });
    map!(Judge, judge => { name, points, abstain, disagree });
    map!(Disagreement, found => { stratum, point: short(found.point), verdict, what });

    impl Serialize for Verification {
        fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
            let (mut out, total) = (serializer.serialize_map(None)?, self.total());
            entries!(out, total, { points, agree, grazing, disagree, bound_95: total.bound_95() });
            entries!(out, self, { strata, judges, disagreements });
            out.end()
        }
    }

    // Torture.

    map!(torture::Outcomes, row => {
        name, queries, wrong, plain_f32_wrong, ties, faces, faces_wrong, plain_f32_faces_wrong, volumes, open_volumes,
        judged_by_whole_numbers, grazing, abstained, rounds,
    });

    /// A disagreement under the name of its stratum.
    struct Named<'a>(&'a str, &'a torture::Contradiction);

    map!(Named<'_>, this => {
        stratum: this.0,
        round: this.1.round,
        query: this.1.query,
        light: this.1.case.light,
        point: short(this.1.case.point),
        said: this.1.said,
    });

    impl Serialize for Torture {
        fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
            let (mut out, total) = (serializer.serialize_map(None)?, self.total());
            let named = self.disagreements.iter().map(|found| Named(self.strata[found.stratum].name, found));
            entries!(out, total, {
                queries,
                disagree: total.wrong,
                ties,
                bound_95: self.bound_95(),
                strata: self.strata,
                rounds,
                bound_95_rounds: self.bound_95_rounds(),
                plain_f32_wrong, faces, faces_wrong, plain_f32_faces_wrong, volumes, open_volumes,
                judged_by_whole_numbers, grazing, abstained,
                disagreements: named.collect::<Vec<_>>(),
            });
            out.end()
        }
    }

    // Accuracy.

    value!(Question, question => question.name());

    map!(Row, row => {
        name, queries, ties, judged, wrong,
        bound_95: row.bound_95(),
        ns_per_query: row.time.median,
        min_ns: row.time.min,
        max_ns: row.time.max,
    });

    map!(Method, method => {
        name, exact,
        ns_per_query: method.total.time.median,
        min_ns: method.total.time.min,
        max_ns: method.total.time.max,
        ratio,
        prepare_ns_per_face: method.prepare_ns,
        wrong: method.total.wrong,
        queries: method.total.queries,
        ties: method.total.ties,
        judged: method.total.judged,
        bound_95: method.total.bound_95(),
        dominated, strata,
    });

    map!(Accuracy, found => { exact_is_right: found.exact_is_right(), judged_by_all_faces, methods });

    /// The options of a method: numbers as numbers.
    struct Parameters(AmbientMethod);

    impl Serialize for Parameters {
        fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
            let mut out = serializer.serialize_map(None)?;
            for (key, text) in self.0.parameters() {
                match (text.parse::<u32>(), text.parse::<f64>()) {
                    (Ok(number), _) => out.serialize_entry(key, &number)?,
                    (_, Ok(number)) => out.serialize_entry(key, &number)?,
                    _ => out.serialize_entry(key, &text)?,
                }
            }
            out.end()
        }
    }

    map!(AmbientTruth, truth => { method: "analytic", bound });

    map!(AmbientRow, row => {
        method: row.method.name(),
        parameters: (!row.method.parameters().is_empty()).then_some(Parameters(row.method)),
        mean_error, rms_error, p99_error, prepare_ms,
        ns_per_receiver: row.ns_per_receiver.median,
        dominated_by: row.dominated_by.map(|by| by.to_string()),
    });

    map!(AmbientAccuracy, found => { receivers, judged, truth, rows });
}

#[cfg(test)]
mod tests {
    use serde_json::{Value, json};

    use super::*;
    use crate::testing::shapes;
    use crate::topology::Topology;

    fn report() -> CrackReport {
        let mesh = shapes::nested_cubes(2);
        CrackReport::of(&mesh, &Topology::of(&mesh))
    }

    fn document(of: &impl Serialize) -> Value {
        serde_json::to_value(of).unwrap()
    }

    #[test]
    fn json_of_what_was_not_decided_is_null() {
        let mut report = report();
        let decided = document(&report);
        assert_eq!((&decided["inside_out_shells"], &decided["t_junctions"]), (&json!(1), &json!(0)));
        let cavity = &decided["shell_list"][1];
        assert_eq!((&cavity["depth"], &cavity["inside_out"]), (&json!(1), &json!(true)));

        // As the report is where both searches gave up.
        (report.nesting_complete, report.t_junctions_complete) = (false, false);
        report.counts.undecided_shells = 1;
        (report.shell_list[1].depth, report.shell_list[1].depth_known) = (0, false);
        let document = document(&report);
        for value in ["/inside_out_shells", "/t_junctions", "/shell_list/1/depth", "/shell_list/1/inside_out"]
        {
            assert_eq!(document.pointer(value), Some(&Value::Null), "{value}");
        }
        assert_eq!(document["shell_list"][0], decided["shell_list"][0]);
    }

    #[test]
    fn json_numbers_are_finite_and_short_as_value_and_as_text() {
        let mut report = report();
        report.counts.signed_volume = f64::NAN;
        report.shell_list[0].signed_volume = f64::INFINITY;
        report.shell_list[0].bounds.low = [0.1, f32::MAX, f32::NAN];
        let value = document(&report);
        assert_eq!(
            (&value["signed_volume"], &value["shell_list"][0]["signed_volume"]),
            (&Value::Null, &Value::Null)
        );
        assert_eq!(value["shell_list"][0]["bounds"][0].to_string(), "[0.1,3.4028235e+38,null]");
        // Keys come in the same order either way.
        assert_eq!(serde_json::to_string(&report).unwrap(), value.to_string());
        for x in [f32::MIN_POSITIVE, 1e-45, 16_777_216.0, -0.3, 1.0 / 3.0] {
            let [text, ..] = short([x; 3]).map(|x| document(&x).to_string());
            assert_eq!(text.parse::<f32>().unwrap().to_bits(), x.to_bits());
            assert!(text.len() <= 13, "{text}");
        }
    }

    #[test]
    fn json_of_a_choice_says_why() {
        let choice = SilhouetteMethod::choose(12, usize::MAX);
        let why = "12 faces: a scan is done before a search has begun";
        assert_eq!(document(&choice), json!({ "what": "scan", "why": why }));
    }
}
