//! Everything that is asked of a case.

use std::collections::BTreeMap;

use umbrage::geom::{Aabb, Light};
use umbrage::mesh::Mesh;
use umbrage::oracle::{Crossings, Oracle, Verdict};
use umbrage::silhouette::{Casters, FacePlanes, Facing, Silhouette, classify};
use umbrage::strategy::Case;
use umbrage::topology::Topology;
use umbrage::volume::{Caps, ShadowVolume, WindingIndex, winding_number};

/// The silhouette by its vertices, smaller first.
pub(super) type Outline = BTreeMap<[u32; 2], i32>;

#[derive(Clone, Debug, PartialEq)]
pub(super) struct Answers {
    pub(super) facing: Vec<Facing>,
    /// Of all faces, and of front faces.
    pub(super) outlines: [Outline; 2],
    pub(super) points: Vec<PointAnswer>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct PointAnswer {
    pub(super) verdict: Verdict,
    pub(super) crossings: Crossings,
    /// Of the volume of all faces; `None` on the volume itself.
    pub(super) winding: Option<i32>,
}

impl Answers {
    /// Asks. What has two implementations is asked twice.
    ///
    /// # Errors
    ///
    /// If a volume is open, or two answers that must be one are two.
    pub(super) fn of(case: &Case) -> Result<Self, String> {
        let Case { mesh, light, points } = case;
        let topology = Topology::build(mesh.vertex_count(), mesh.triangles().to_vec());
        let facing = classify(mesh, light);
        equal("facing by planes", &FacePlanes::new(mesh).classify(mesh, light), &facing)?;
        let mut outlines = [Outline::new(), Outline::new()];
        let mut all = None;
        for (casters, outline) in [Casters::All, Casters::Front].into_iter().zip(&mut outlines) {
            let signs = casters.signs(&facing);
            let silhouette = Silhouette::extract(&topology, &signs);
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
            let verdict = oracle.verdict(p, light);
            equal("the verdict of the crossings", &crossings.verdict(), &verdict)?;
            let winding = winding_number(&volume, p);
            equal("the winding number by the index", &index.number(p), &winding)?;
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

/// What the cases of a run have seen.
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

/// Both are the same, or a line that says which are not.
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

/// Sets it; 0 takes the edge out.
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

/// The case on multiples of 2⁻¹², so that exact sums and middles are common; what is larger than 2¹¹ is one already.
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
