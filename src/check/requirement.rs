//! Properties that a gate asks for, and whether a report has them.

use std::fmt;
use std::str::FromStr;

use super::Counts;

/// A property that may be required of a mesh.
///
/// ```
/// use umbrage::check::{CrackReport, Requirement, Standing};
/// use umbrage::testing::shapes;
/// use umbrage::topology::Topology;
/// let mesh = shapes::open_cube();
/// let report = CrackReport::of(&mesh, &Topology::of(&mesh));
/// assert_eq!(report.standing(Requirement::Watertight), Standing::Fails);
/// assert_eq!(report.standing(Requirement::NoTJunctions), Standing::Holds);
/// assert_eq!("no-self-intersections".parse(), Ok(Requirement::NoSelfIntersections));
/// assert_eq!(report.standing(Requirement::NoSelfIntersections), Standing::Undecided); // nobody looked
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[non_exhaustive]
pub enum Requirement {
    /// There is a face that does not collapse.
    NotEmpty,
    /// Watertight, and no shell is inside out.
    Sound,
    /// Every edge has exactly two faces, in opposite directions.
    Watertight,
    /// At every edge the two directions are used equally often; enough for stencil counting.
    Balanced,
    /// Every edge is used an even number of times; enough for parity counting.
    Even,
    /// No edge has more than two faces, and the faces of every vertex form one fan.
    Manifold,
    /// No two faces meet where they should not.
    NoSelfIntersections,
    /// No boundary vertex lies inside another boundary edge.
    NoTJunctions,
    /// No two faces have the same three vertices.
    NoDuplicates,
    /// Every face has area: none has collapsed, and none has its corners on a line.
    NoZeroArea,
}

/// Whether a mesh has a property.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Standing {
    /// It has the property.
    Holds,
    /// Nothing was found against it, but a search for that did not finish, or was not made.
    Undecided,
    /// It does not have the property.
    Fails,
}

impl Requirement {
    /// Every requirement.
    pub const ALL: [Self; 10] = [
        Self::NotEmpty,
        Self::Sound,
        Self::Watertight,
        Self::Balanced,
        Self::Even,
        Self::Manifold,
        Self::NoSelfIntersections,
        Self::NoTJunctions,
        Self::NoDuplicates,
        Self::NoZeroArea,
    ];

    /// The name that `umbrage check --require` takes.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::NotEmpty => "not-empty",
            Self::Sound => "sound",
            Self::Watertight => "watertight",
            Self::Balanced => "balanced",
            Self::Even => "even",
            Self::Manifold => "manifold",
            Self::NoSelfIntersections => "no-self-intersections",
            Self::NoTJunctions => "no-t-junctions",
            Self::NoDuplicates => "no-duplicates",
            Self::NoZeroArea => "no-zero-area",
        }
    }

    /// The property in words that follow "is" or "is not".
    #[must_use]
    pub fn property(self) -> &'static str {
        match self {
            Self::NotEmpty => "left with faces",
            Self::NoSelfIntersections => "free of self-intersections",
            Self::NoTJunctions => "free of T-junctions",
            Self::NoDuplicates => "free of duplicate faces",
            Self::NoZeroArea => "free of faces without area",
            Self::Sound | Self::Watertight | Self::Balanced | Self::Even | Self::Manifold => self.name(),
        }
    }

    /// Whether a mesh with these counts has the property.
    #[must_use]
    pub fn standing(self, counts: &Counts) -> Standing {
        let holds = |holds| if holds { Standing::Holds } else { Standing::Fails };
        let none = |found: Option<usize>, complete: bool| match found {
            Some(1..) => Standing::Fails,
            Some(0) if complete => Standing::Holds,
            _ => Standing::Undecided,
        };
        match self {
            Self::NotEmpty => holds(!counts.is_empty()),
            Self::Sound if counts.may_be_sound() && !counts.sound() => Standing::Undecided,
            Self::Sound => holds(counts.sound()),
            Self::Watertight => holds(counts.watertight),
            Self::Balanced => holds(counts.balanced),
            Self::Even => holds(counts.even),
            Self::Manifold => holds(counts.non_manifold_edges == 0 && counts.non_manifold_vertices == 0),
            Self::NoSelfIntersections => none(counts.self_intersections, counts.self_intersections_complete),
            Self::NoTJunctions => none(Some(counts.t_junctions), counts.t_junctions_complete),
            Self::NoDuplicates => holds(counts.duplicate_faces == 0),
            Self::NoZeroArea => holds(counts.zero_area_faces + counts.collapsed_faces == 0),
        }
    }

    /// What keeps a mesh with these counts from having the property, with numbers; empty if nothing does.
    #[must_use]
    pub fn reasons(self, counts: &Counts) -> String {
        let edges = |boundary, misoriented| {
            let mut edges = [
                (counts.boundary_edges, "boundary edge", "boundary edges"),
                (counts.non_manifold_edges, "non-manifold edge", "non-manifold edges"),
                (counts.misoriented_edges, "misoriented edge", "misoriented edges"),
            ];
            edges[0].0 *= usize::from(boundary);
            edges[2].0 *= usize::from(misoriented);
            edges
        };
        let list: Vec<(usize, &str, &str)> = match self {
            Self::NotEmpty => vec![(counts.collapsed_faces, "face collapses", "faces collapse")],
            Self::Sound => return counts.reasons(),
            Self::Watertight | Self::Balanced => edges(true, true).to_vec(),
            // An edge used twice in one direction is used an even number of times.
            Self::Even => edges(true, false).to_vec(),
            Self::Manifold => vec![
                (counts.non_manifold_edges, "non-manifold edge", "non-manifold edges"),
                (counts.non_manifold_vertices, "non-manifold vertex", "non-manifold vertices"),
            ],
            Self::NoSelfIntersections => {
                let found = counts.self_intersections.unwrap_or(0);
                return at_least(
                    found,
                    counts.self_intersections_complete,
                    "pair of faces",
                    "pairs of faces",
                );
            }
            Self::NoTJunctions => {
                return at_least(
                    counts.t_junctions,
                    counts.t_junctions_complete,
                    "T-junction",
                    "T-junctions",
                );
            }
            Self::NoDuplicates => vec![(counts.duplicate_faces, "duplicate face", "duplicate faces")],
            Self::NoZeroArea => vec![
                (counts.collapsed_faces, "collapsed face", "collapsed faces"),
                (counts.zero_area_faces, "face of zero area", "faces of zero area"),
            ],
        };
        super::text::list(&list)
    }
}

fn at_least(count: usize, complete: bool, one: &str, many: &str) -> String {
    let least = if complete || count == 0 { "" } else { "at least " };
    format!("{least}{}", super::text::list(&[(count, one, many)]))
}

impl fmt::Display for Requirement {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

/// Reason why a text is no [`Requirement`].
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("there is no requirement `{0}`")]
pub struct UnknownRequirement(pub String);

impl FromStr for Requirement {
    type Err = UnknownRequirement;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let named = Self::ALL.into_iter().find(|requirement| requirement.name() == text);
        named.ok_or_else(|| UnknownRequirement(text.to_owned()))
    }
}

impl super::CrackReport {
    /// Whether the mesh has a property.
    #[must_use]
    pub fn standing(&self, requirement: Requirement) -> Standing {
        requirement.standing(&self.counts)
    }

    /// The requirements that the mesh does not meet, in their order. What is undecided is not met.
    ///
    /// ```
    /// use umbrage::check::{CrackReport, Requirement::*};
    /// use umbrage::testing::shapes;
    /// use umbrage::topology::Topology;
    /// let mesh = shapes::figure_eight_prism();
    /// let topology = Topology::of(&mesh);
    /// let mut report = CrackReport::of(&mesh, &topology);
    /// report.add_self_intersections(&mesh, &topology, 1);
    /// assert_eq!(report.unmet(&[Watertight, NoSelfIntersections, Manifold]), [NoSelfIntersections]);
    /// ```
    #[must_use]
    pub fn unmet(&self, requirements: &[Requirement]) -> Vec<Requirement> {
        let unmet = |&requirement: &Requirement| self.standing(requirement) != Standing::Holds;
        requirements.iter().copied().filter(unmet).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::super::CrackReport;
    use super::*;
    use crate::testing::shapes;
    use crate::topology::Topology;

    fn searched(mesh: &crate::mesh::Mesh) -> CrackReport {
        let topology = Topology::of(mesh);
        let mut report = CrackReport::of(mesh, &topology);
        report.add_self_intersections(mesh, &topology, 1);
        report
    }

    #[test]
    fn requirement_is_failed_by_the_mesh_that_lacks_it_and_its_name_parses() {
        let unmet = |mesh| searched(&mesh).unmet(&Requirement::ALL);
        use Requirement::*;
        assert!(unmet(shapes::cube()).is_empty());
        assert_eq!(unmet(crate::mesh::Mesh::default()), [NotEmpty]);
        assert_eq!(unmet(shapes::inside_out(&shapes::cube())), [Sound]);
        assert_eq!(unmet(shapes::open_cube()), [Sound, Watertight, Balanced, Even]);
        assert_eq!(unmet(shapes::misoriented_cube()), [Sound, Watertight, Balanced]);
        assert_eq!(unmet(shapes::cubes_sharing_edge()), [Sound, Watertight, Manifold]);
        assert!(unmet(shapes::t_junction()).contains(&NoTJunctions));
        assert!(unmet(shapes::duplicated_face()).contains(&NoDuplicates));
        assert!(unmet(shapes::collinear_face()).contains(&NoZeroArea));
        assert_eq!(unmet(shapes::figure_eight_prism()).last(), Some(&NoSelfIntersections));
        for requirement in Requirement::ALL {
            assert_eq!(requirement.to_string().parse(), Ok(requirement));
        }
        assert!("Sound".parse::<Requirement>().is_err());
    }

    #[test]
    fn requirement_of_a_search_that_did_not_finish_is_not_met() {
        let mut counts = searched(&shapes::cube()).counts;
        assert_eq!(Requirement::NoSelfIntersections.standing(&counts), Standing::Holds);
        counts.self_intersections_complete = false;
        assert_eq!(Requirement::NoSelfIntersections.standing(&counts), Standing::Undecided);
        assert_eq!(Requirement::NoSelfIntersections.reasons(&counts), "");
        counts.self_intersections = Some(7);
        assert_eq!(Requirement::NoSelfIntersections.standing(&counts), Standing::Fails);
        assert_eq!(Requirement::NoSelfIntersections.reasons(&counts), "at least 7 pairs of faces");
        counts.t_junctions_complete = false;
        assert_eq!(Requirement::NoTJunctions.standing(&counts), Standing::Undecided);
        counts.undecided_shells = 1;
        assert_eq!(Requirement::Sound.standing(&counts), Standing::Undecided);
    }
}
