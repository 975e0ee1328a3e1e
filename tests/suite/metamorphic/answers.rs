//! All results that are compared for a case.

use std::collections::BTreeMap;

use umbrage::facing::{CasterFaces, FacePlanes, classify};
use umbrage::geom::{Aabb, Facing, Light};
use umbrage::mesh::Mesh;
use umbrage::oracle::{Crossings, Oracle, Verdict};
use umbrage::shadow::volume::{Caps, ShadowVolume, WindingIndex, winding_number};
use umbrage::silhouette::Silhouette;
use umbrage::testing::strategy::Case;
use umbrage::topology::Topology;

/// The silhouette by its vertices, the smaller one first.
pub(super) type Outline = BTreeMap<[u32; 2], i32>;

#[derive(Clone, Debug, PartialEq)]
pub(super) struct Answers {
    pub(super) facing: Vec<Facing>,
    /// The silhouettes of all faces, and of front faces.
    pub(super) outlines: [Outline; 2],
    pub(super) points: Vec<PointAnswer>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct PointAnswer {
    pub(super) verdict: Verdict,
    pub(super) crossings: Crossings,
    /// The winding number in the volume of all faces; `None` on the volume itself.
    pub(super) winding: Option<i32>,
}

/// The fault to inject, if any.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Fault {
    None,
    /// The relation's own fault: it spoils the image of the case.
    Image,
    /// A wrong answer about the image, so that only one comparison can find it.
    Answer(Slip),
}

/// A kind of wrong answer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Slip {
    /// The last face is missing.
    Faces,
    Facing,
    /// One edge more or less in the silhouette of all faces, or of front faces.
    Outline(usize),
    /// The last point is missing.
    Points,
    /// A lit point is reported in shadow.
    Darker,
    /// A point in shadow is reported lit.
    Lighter,
    Crossings,
    Winding,
}

impl Fault {
    pub(super) fn in_image(self) -> bool {
        self == Self::Image
    }

    /// Makes one answer of this kind wrong, if there is one.
    pub(super) fn spoil(self, answers: &mut Answers) {
        let Self::Answer(slip) = self else { return };
        let Answers { facing, outlines, points } = answers;
        let mut say = |from, to| {
            if let Some(point) = points.iter_mut().find(|point| point.verdict == from) {
                point.verdict = to;
            }
        };
        match slip {
            Slip::Faces => drop(facing.pop()),
            Slip::Facing => {
                if let Some(last) = facing.last_mut() {
                    *last = if *last == Facing::Front { Facing::Back } else { Facing::Front };
                }
            }
            Slip::Outline(which) => {
                let m = directed(&outlines[which], 0, 1);
                set_directed(&mut outlines[which], 0, 1, m + 1);
            }
            Slip::Points => drop(points.pop()),
            Slip::Darker => say(Verdict::Lit, Verdict::Shadowed),
            Slip::Lighter => say(Verdict::Shadowed, Verdict::Lit),
            Slip::Crossings => points.iter_mut().for_each(|point| point.crossings.front += 1),
            Slip::Winding => {
                points.iter_mut().for_each(|point| point.winding = point.winding.map(|winding| winding + 1));
            }
        }
    }
}

/// Which of two implementations of the same result goes wrong.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Way {
    Planes,
    Certificate,
    Verdict,
    Index,
    Volume,
}

impl Answers {
    /// Computes all results. Results with two implementations are computed by both.
    ///
    /// # Errors
    ///
    /// If a volume is open, or if the two implementations disagree.
    pub(super) fn of(case: &Case) -> Result<Self, String> {
        Self::with(case, None)
    }

    fn with(case: &Case, wrong: Option<Way>) -> Result<Self, String> {
        let wrong = |way| wrong == Some(way);
        let Case { mesh, light, points } = case;
        let topology = Topology::of(mesh);
        let facing = classify(mesh, light);
        let mut by_planes = FacePlanes::new(mesh).classify(mesh, light);
        if wrong(Way::Planes) {
            by_planes.reverse();
        }
        equal("facing by planes", &by_planes, &facing)?;
        let mut outlines = [Outline::new(), Outline::new()];
        let mut all = None;
        for (casters, outline) in [CasterFaces::All, CasterFaces::Front].into_iter().zip(&mut outlines) {
            let signs = casters.signs(&facing);
            let mut silhouette = Silhouette::extract(&topology, &signs);
            if wrong(Way::Certificate) {
                silhouette.edges.pop();
            }
            let volume = ShadowVolume::extrude(mesh, &topology, light, &signs, &silhouette, Caps::Both);
            equal("the certificate", &volume.boundary_sum().is_closed(), &true)?;
            let ends = |edge| topology.vertices(edge).map(|vertex| vertex.0);
            *outline = silhouette.edges.iter().map(|edge| (ends(edge.edge), edge.multiplicity)).collect();
            all.get_or_insert(volume);
        }
        let volume = all.expect("two volumes");
        let around = Aabb::around(points.iter().copied()).join(&volume.finite_bounds());
        let (oracle, index) = (Oracle::build(mesh), WindingIndex::build(&volume, around));
        let ask = |&p| {
            let crossings = oracle.crossings(p, light);
            let verdict = if wrong(Way::Verdict) { Verdict::Grazing } else { oracle.verdict(p, light) };
            equal("the verdict of the crossings", &crossings.verdict(), &verdict)?;
            let off = |way| move |winding: i32| winding + i32::from(wrong(way));
            let winding = winding_number(&volume, p).map(off(Way::Volume));
            let by_index = index.number(p).map(off(Way::Index)).map(off(Way::Volume));
            equal("the winding number by the index", &by_index, &winding)?;
            let crossed = (crossings.front + crossings.back) as i32;
            if winding.is_some_and(|w| !(crossed..=crossed + crossings.touching as i32).contains(&w)) {
                return Err(format!("{crossings:?}, but the winding number is {winding:?}"));
            }
            Ok(PointAnswer { verdict, crossings, winding })
        };
        let points = points.iter().map(ask).collect::<Result<_, _>>()?;
        Ok(Self { facing, outlines, points })
    }

    pub(super) fn tally(&self) -> Tally {
        let verdicts = |verdict| self.points.iter().filter(|point| point.verdict == verdict).count();
        Tally {
            edge_on: self.facing.iter().filter(|&&facing| facing == Facing::EdgeOn).count(),
            front: self.facing.iter().filter(|&&facing| facing == Facing::Front).count(),
            back: self.facing.iter().filter(|&&facing| facing == Facing::Back).count(),
            outline: self.outlines[0].len(),
            lit: verdicts(Verdict::Lit),
            shadowed: verdicts(Verdict::Shadowed),
            grazing: verdicts(Verdict::Grazing),
            on_volume: self.points.iter().filter(|point| point.winding.is_none()).count(),
        }
    }
}

/// Number of cases per outcome in a run.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Tally {
    edge_on: usize,
    front: usize,
    back: usize,
    outline: usize,
    lit: usize,
    shadowed: usize,
    grazing: usize,
    on_volume: usize,
}

impl Tally {
    fn numbers(&mut self) -> [&mut usize; 8] {
        let Self { edge_on, front, back, outline, lit, shadowed, grazing, on_volume } = self;
        [edge_on, front, back, outline, lit, shadowed, grazing, on_volume]
    }

    pub(super) fn add(&mut self, other: &Self) {
        let mut other = *other;
        self.numbers().into_iter().zip(other.numbers()).for_each(|(sum, more)| *sum += *more);
    }

    pub(super) fn has_seen_all(mut self) -> bool {
        self.numbers().iter().all(|number| **number > 0)
    }
}

/// Checks that both values are equal; the error names what differs.
pub(super) fn equal<T: PartialEq + std::fmt::Debug>(
    what: &str,
    found: &T,
    expected: &T,
) -> Result<(), String> {
    if found == expected { Ok(()) } else { Err(format!("{what}: found {found:?}, expected {expected:?}")) }
}

/// The multiplicity of an edge in the direction from `a` to `b`.
pub(super) fn directed(outline: &Outline, a: u32, b: u32) -> i32 {
    let m = outline.get(&[a.min(b), a.max(b)]).copied().unwrap_or(0);
    if a < b { m } else { -m }
}

/// Sets the multiplicity of an edge in the direction from `a` to `b`; 0 removes the edge.
pub(super) fn set_directed(outline: &mut Outline, a: u32, b: u32, m: i32) {
    let key = [a.min(b), a.max(b)];
    match m {
        0 => outline.remove(&key),
        m => outline.insert(key, if a < b { m } else { -m }),
    };
}

/// `mesh` with other positions and faces.
pub(super) fn rebuilt(positions: Vec<[f32; 3]>, triangles: Vec<[u32; 3]>) -> Mesh {
    Mesh::new(positions, triangles).expect("a relation keeps to the domain")
}

/// The case with coordinates rounded to multiples of 2⁻¹², so that exact sums and midpoints are common.
/// Coordinates beyond 2¹¹ are multiples already.
pub(super) fn on_grid(case: &Case) -> Case {
    let round = |p: [f32; 3]| p.map(|x| if x.abs() < 2048.0 { (x * 4096.0).round() / 4096.0 } else { x });
    let (positions, triangles, ..) = case.mesh.clone().into_parts();
    let light = match case.light.is_directional() {
        true => case.light,
        false => Light::point(round(case.light.xyz())).expect("finite"),
    };
    let mesh = rebuilt(positions.into_iter().map(round).collect(), triangles);
    Case { mesh, light, points: case.points.iter().map(|&p| round(p)).collect() }
}

/// Each comparison of two implementations can fail.
#[test]
fn metamorphic_answers_that_differ_by_the_way_are_found() {
    use proptest::strategy::{Strategy, ValueTree};
    let cases = umbrage::testing::strategy::case(umbrage::testing::strategy::soup(24), 6);
    for (way, said) in [
        (Way::Planes, "facing by planes: "),
        (Way::Certificate, "the certificate: "),
        (Way::Verdict, "the verdict of the crossings: "),
        (Way::Index, "the winding number by the index: "),
        (Way::Volume, "Crossings {"),
    ] {
        let mut runner = proptest::test_runner::TestRunner::deterministic();
        let found = (0..400).any(|_| {
            let case = cases.new_tree(&mut runner).expect("nothing is rejected").current();
            Answers::of(&case).expect("nothing is wrong");
            Answers::with(&case, Some(way)).is_err_and(|error| error.starts_with(said))
        });
        assert!(found, "{way:?}");
    }
}
