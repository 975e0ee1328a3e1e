//! The crack report as text, in the words of `umbrage check`.

use std::fmt;

use super::{Counts, CrackReport, DefectKind, NearMiss, Verdict};

/// The verdict, every kind of defect with its number and its effect on a shadow, and what a weld would close:
/// the lines that `umbrage check` prints for a mesh, without positions, which need the mesh.
impl fmt::Display for CrackReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for line in self.counts.remarks() {
            writeln!(f, "  {line}")?;
        }
        writeln!(f, "  {}", self.counts.summary())?;
        for kind in DefectKind::ALL {
            if let Some(count @ 1..) = self.count(kind) {
                let least = if self.counts.is_complete(kind) { "" } else { "at least " };
                writeln!(f, "\n  {kind}: {least}{count}\n    effect on the shadow: {}", kind.effect())?;
            }
        }
        for near in NearMiss::steps(&self.near_miss) {
            writeln!(f, "\n  {}", near.hint(self.counts.boundary_edges))?;
        }
        Ok(())
    }
}

impl Counts {
    /// The verdict in one sentence, with what keeps the mesh from being sound.
    ///
    /// ```
    /// use umbrage::check::CrackReport;
    /// use umbrage::testing::shapes;
    /// use umbrage::topology::Topology;
    /// let cube = shapes::open_cube();
    /// let counts = CrackReport::of(&cube, &Topology::of(&cube)).counts;
    /// assert_eq!(counts.summary(), "cracked: the mesh is not sound: 4 boundary edges");
    /// ```
    #[must_use]
    pub fn summary(&self) -> String {
        match self.verdict() {
            Verdict::Empty => {
                let why = match self.faces {
                    0 => String::new(),
                    1 => ": the only face collapses when welded".to_owned(),
                    faces => format!(": all {faces} faces collapse when welded"),
                };
                format!("empty: there are no faces to check{why}")
            }
            Verdict::Sound => "sound: the mesh is watertight, and no shell is inside out".to_owned(),
            Verdict::NotProven => {
                let shells = counted(self.undecided_shells, "shell", "shells");
                format!(
                    "not proven sound: the mesh is watertight, but nesting not decided within the limit: \
                     {shells} may be inside out"
                )
            }
            Verdict::Cracked => {
                let reasons = self.reasons();
                let colon = if reasons.is_empty() { "" } else { ": " };
                format!("cracked: the mesh is not sound{colon}{reasons}")
            }
        }
    }

    /// What keeps a mesh from being sound, with numbers: "4 boundary edges, 1 shell inside out". Empty if
    /// nothing does.
    #[must_use]
    pub fn reasons(&self) -> String {
        let reasons = [
            (self.boundary_edges, "boundary edge", "boundary edges"),
            (self.non_manifold_edges, "non-manifold edge", "non-manifold edges"),
            (self.misoriented_edges, "misoriented edge", "misoriented edges"),
            (self.inside_out_shells, "shell inside out", "shells inside out"),
            (
                self.undecided_shells,
                "shell whose nesting was not decided within the limit",
                "shells whose nesting was not decided within the limit",
            ),
        ];
        list(&reasons)
    }

    /// Facts to print next to the verdict, one per line.
    #[must_use]
    pub fn remarks(&self) -> Vec<String> {
        let mut remarks = Vec::new();
        if self.max_faces_per_edge > 2 {
            remarks.push(format!("up to {} faces meet at an edge", self.max_faces_per_edge));
        }
        match self.self_intersections {
            Some(0) if self.self_intersections_complete => {
                remarks.push("no faces meet where they should not".to_owned());
            }
            Some(found) if !self.self_intersections_complete => {
                let found = if found == 0 { "none".to_owned() } else { format!("at least {found}") };
                remarks.push(format!(
                    "the search for self-intersections was not finished: {found} found so far"
                ));
            }
            _ => {}
        }
        if !self.t_junctions_complete {
            let found = self.t_junctions;
            remarks.push(format!("the search for T-junctions was not finished: {found} found so far"));
        }
        remarks
    }
}

impl NearMiss {
    /// The distance to weld within: [`NearMiss::distance`] with three digits, rounded up so that an `f32` of
    /// it reaches as far.
    #[must_use]
    pub fn weld_distance(&self) -> f64 {
        // A weld takes an `f32` above 0. A small part of a diagonal is always below the largest one.
        let distance = self.distance.max(f64::from(f32::from_bits(1)));
        let exponent = distance.log10().floor() as i32 - 2;
        let start = (distance / 10_f64.powi(exponent)).ceil() as i64;
        let typed = (start..start + 10).map(|digits| format!("{digits}e{exponent}"));
        let reaches = |text: &String| text.parse::<f32>().is_ok_and(|reached| f64::from(reached) >= distance);
        typed.into_iter().find(reaches).and_then(|text| text.parse().ok()).unwrap_or(distance)
    }

    /// The tolerances at which another number of edges closes than at the one before, ascending.
    pub fn steps(list: &[Self]) -> impl Iterator<Item = &Self> {
        let mut before = 0;
        list.iter()
            .filter(move |near| near.edges > 0 && std::mem::replace(&mut before, near.edges) != near.edges)
    }

    /// The remedy in one line, for a mesh with `boundary_edges` boundary edges.
    #[must_use]
    pub fn hint(&self, boundary_edges: usize) -> String {
        let distance = match self.weld_distance() {
            size if (1e-4..1e7).contains(&size) => size.to_string(),
            size => format!("{size:e}"),
        };
        format!("--weld {distance} would close {} of {boundary_edges} boundary edges", self.edges)
    }
}

impl CrackReport {
    /// The distance to weld within: the smallest tried that closes as many boundary edges as any does, as
    /// [`NearMiss::weld_distance`] rounds it. `None` if none closes any.
    ///
    /// ```
    /// use umbrage::check::CrackReport;
    /// use umbrage::mesh::{Weld, weld};
    /// use umbrage::testing::shapes;
    /// use umbrage::topology::Topology;
    /// let seam = shapes::seam(2);
    /// let report = CrackReport::of(&seam, &Topology::of(&seam));
    /// let distance = report.weld_distance().expect("the seam is narrow");
    /// let closed = weld(&seam, Weld::Within(distance as f32)).mesh;
    /// assert!(CrackReport::of(&closed, &Topology::of(&closed)).counts.watertight);
    /// ```
    #[must_use]
    pub fn weld_distance(&self) -> Option<f64> {
        let most = self.near_miss.iter().map(|near| near.edges).max().filter(|&most| most > 0)?;
        self.near_miss.iter().find(|near| near.edges == most).map(NearMiss::weld_distance)
    }
}

/// "4 boundary edges, 1 shell inside out": what there is any of.
pub(super) fn list(reasons: &[(usize, &str, &str)]) -> String {
    let found = reasons.iter().filter(|reason| reason.0 > 0);
    found.map(|&(count, one, many)| counted(count, one, many)).collect::<Vec<_>>().join(", ")
}

/// "1 shell", "2 shells".
fn counted(count: usize, one: &str, many: &str) -> String {
    format!("{count} {}", if count == 1 { one } else { many })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::shapes;
    use crate::topology::Topology;

    fn near(distance: f64, edges: usize) -> NearMiss {
        NearMiss { relative: 1e-7, distance, edges }
    }

    #[test]
    fn weld_distance_reaches_as_far_as_it_says() {
        for distance in [1e-7, 5.7567912e-7, 9.999e-4, 1.0, 123_456.0, 2.7e-16, 1e-30, 1.2e35] {
            let hint = near(distance, 1).hint(2);
            let typed = f64::from(hint.split(' ').nth(1).unwrap().parse::<f32>().unwrap());
            assert!(typed >= distance && typed <= 1.02 * distance, "{distance} {hint}");
            assert_eq!(f64::from(near(distance, 1).weld_distance() as f32), typed);
        }
        for distance in [0.0, 1e-52] {
            let text = near(distance, 1).hint(2);
            assert!(text.split(' ').nth(1).unwrap().parse::<f32>().unwrap() > 0.0, "{distance} {text}");
        }
    }

    #[test]
    fn weld_distance_is_the_smallest_that_closes_the_most() {
        let cube = shapes::open_cube();
        let mut report = CrackReport::of(&cube, &Topology::of(&cube));
        assert_eq!(report.weld_distance(), None);
        report.near_miss = vec![near(1e-3, 0), near(2e-3, 4), near(3e-3, 6), near(4e-3, 6), near(5e-3, 2)];
        assert_eq!(report.weld_distance(), Some(3e-3));
        let steps: Vec<usize> = NearMiss::steps(&report.near_miss).map(|near| near.edges).collect();
        assert_eq!(steps, [4, 6, 2]);
        let text = report.to_string();
        assert!(text.contains("\n\n  --weld 0.002 would close 4 of 4 boundary edges\n"), "{text}");
    }

    #[test]
    fn report_as_text_names_what_is_wrong_and_nothing_else() {
        let cube = shapes::cube();
        let sound = CrackReport::of(&cube, &Topology::of(&cube));
        assert_eq!(sound.to_string(), "  sound: the mesh is watertight, and no shell is inside out\n");
        let open = shapes::open_cube();
        let report = CrackReport::of(&open, &Topology::of(&open));
        let effect = DefectKind::BoundaryLoop.effect();
        let expected = format!(
            "  cracked: the mesh is not sound: 4 boundary edges\n\n  boundary_loop: 1\n    effect on the \
             shadow: {effect}\n"
        );
        assert_eq!(report.to_string(), expected);
        // Fault injected: a defect that is not there.
        let mut other = sound.clone();
        other.counts.inside_out_shells = 1;
        assert!(other.to_string().starts_with("  cracked: the mesh is not sound: 1 shell inside out\n"));
    }
}
