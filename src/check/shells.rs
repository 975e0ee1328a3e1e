//! Shells as solids: counts, volumes, and which are inside out.

use super::nesting::{Allowance, nest};
use crate::geom::Aabb;
use crate::geom::predicate::Sign;
use crate::geom::signed_volume::{ExactVolume, VolumeSum};
use crate::mesh::{FaceId, Mesh, VertexId};
use crate::topology::{EdgeCounts, Shells, Topology};

/// One shell: faces connected through edges.
///
/// ```
/// use umbrage::check::CrackReport;
/// use umbrage::testing::shapes;
/// use umbrage::topology::Topology;
/// let mesh = shapes::hollow_cube();
/// let report = CrackReport::of(&mesh, &Topology::of(&mesh));
/// let [outer, cavity] = &report.shell_list[..] else { panic!("two shells") };
/// assert_eq!((outer.depth, cavity.depth, cavity.parent), (0, 1, Some(0)));
/// assert!(cavity.signed_volume < 0.0 && !cavity.inside_out);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct ShellReport {
    /// The lowest-numbered face of the shell.
    pub first_face: FaceId,
    /// The number of its faces.
    pub faces: usize,
    /// The number of its edges.
    pub edges: usize,
    /// The number of its vertices; a vertex shared by two shells counts for both.
    pub vertices: usize,
    /// V − E + F.
    pub euler_characteristic: i64,
    /// (2 − χ) / 2 of a watertight shell with one fan at each vertex; otherwise `None`.
    pub genus: Option<u64>,
    /// Volume in cubic mesh units, positive with faces outwards. For a shell that is not balanced: the volume
    /// of the cones over its faces from one point for the whole mesh, the mean of all corners.
    pub signed_volume: f64,
    /// The exact sign of the volume of a watertight shell; zero for one that is not.
    pub volume_sign: Sign,
    /// Every edge has exactly two faces, in opposite directions.
    pub watertight: bool,
    /// At every edge the two directions are used equally often.
    pub balanced: bool,
    /// Edges with exactly one face.
    pub boundary_edges: usize,
    /// Edges with exactly two faces that run along it in the same direction.
    pub misoriented_edges: usize,
    /// Watertight, and the sign of the volume contradicts the depth: negative at an even one, positive at an
    /// odd one. (A cavity inside a solid is sound.) `false` if the depth is unknown.
    pub inside_out: bool,
    /// The number of other watertight shells that contain this one; 0 if it is not watertight, or if that is
    /// unknown.
    pub depth: usize,
    /// Whether the depth was determined: see
    /// [`CrackReport::nesting_complete`](super::CrackReport::nesting_complete).
    pub depth_known: bool,
    /// The innermost shell that contains this one, as an index into the list.
    pub parent: Option<usize>,
    /// Its bounding box.
    pub bounds: Aabb,
}

impl ShellReport {
    /// The state in a word: "watertight", "inside out", "not decided", or what keeps it from being
    /// watertight.
    #[must_use]
    pub fn state(&self) -> &'static str {
        match self {
            _ if self.undecided() => "not decided",
            Self { inside_out: true, .. } => "inside out",
            Self { watertight: true, .. } => "watertight",
            Self { boundary_edges: 1.., .. } => "open",
            Self { misoriented_edges: 1.., .. } => "misoriented",
            Self { balanced: true, .. } => "balanced",
            _ => "non-manifold",
        }
    }

    /// Whether the orientation of this shell is undecided: it encloses volume, but the nesting search gave up
    /// before its depth was known.
    #[must_use]
    pub fn undecided(&self) -> bool {
        !self.depth_known && !self.volume_sign.is_zero()
    }
}

impl ShellReport {
    /// A shell without faces.
    const BLANK: Self = Self {
        first_face: FaceId(u32::MAX),
        faces: 0,
        edges: 0,
        vertices: 0,
        euler_characteristic: 0,
        genus: None,
        signed_volume: 0.0,
        volume_sign: Sign::Zero,
        watertight: true,
        balanced: true,
        boundary_edges: 0,
        misoriented_edges: 0,
        inside_out: false,
        depth: 0,
        depth_known: true,
        parent: None,
        bounds: Aabb::EMPTY,
    };
}

/// The report of every shell. `fans` has one face of each fan at the vertices with several fans, ascending;
/// `vertices` is the number of vertices that have a face, `uses` the counts of all edges, and `tests` the
/// budget of the nesting search.
pub(super) fn shells(
    mesh: &Mesh,
    topology: &Topology,
    shells: &Shells,
    fans: &[(VertexId, FaceId)],
    vertices: usize,
    uses: &EdgeCounts,
    tests: u64,
) -> Vec<ShellReport> {
    let mut list = vec![ShellReport::BLANK; shells.count];
    match &mut list[..] {
        // The counts of the whole mesh are those of its only shell.
        [only] => {
            let first = shells.of_face.iter().position(Option::is_some);
            only.first_face = FaceId::new(first.expect("a shell has faces"));
            only.faces = topology.face_count() - topology.collapsed_face_count();
            only.edges = topology.edge_count();
            only.vertices = vertices;
            only.watertight = uses.watertight();
            only.balanced = uses.balanced;
            only.boundary_edges = uses.boundary;
            only.misoriented_edges = uses.misoriented;
        }
        several => count(topology, shells, fans, several),
    }
    characterise(shells, fans, &mut list);
    let signs = measure(mesh, topology, shells, &mut list);
    nest(mesh, shells, &signs, &mut list, Allowance { tests });
    for (shell, sign) in list.iter_mut().zip(signs) {
        shell.volume_sign = sign;
        if shell.watertight && Sign::of(shell.signed_volume) != sign {
            shell.signed_volume = 0.0; // all of it is rounding
        }
        let expected = if shell.depth % 2 == 0 { Sign::Positive } else { Sign::Negative };
        shell.inside_out = shell.watertight && shell.depth_known && sign == -expected;
    }
    list
}

/// Fills in the counts of each shell.
fn count(topology: &Topology, shells: &Shells, fans: &[(VertexId, FaceId)], list: &mut [ShellReport]) {
    let shell_of =
        |face: FaceId| shells.of_face[face.index()].expect("a face with edges has a shell") as usize;
    for edge in topology.edges() {
        let mut uses = topology.uses(edge);
        let Some((face, direction)) = uses.next() else { continue };
        let sum = direction + uses.map(|(_, direction)| direction).sum::<i32>();
        let shell = &mut list[shell_of(face)];
        shell.edges += 1;
        shell.balanced &= sum == 0;
        shell.watertight &= sum == 0 && topology.valence(edge) == 2;
        shell.boundary_edges += usize::from(topology.valence(edge) == 1);
        shell.misoriented_edges += usize::from(topology.is_misoriented(edge));
    }

    // A vertex with one fan belongs to one shell, that of any of its faces; a vertex with several belongs to
    // the shells of its fans.
    let mut seen = vec![0_u64; topology.vertex_count().div_ceil(64)];
    let mut first_time = |vertex: u32| {
        let (word, bit) = (&mut seen[vertex as usize / 64], 1 << (vertex % 64));
        let first = *word & bit == 0;
        *word |= bit;
        first
    };
    for fans in fans.chunk_by(|a, b| a.0 == b.0) {
        first_time(fans[0].0.0);
        let mut at: Vec<usize> = fans.iter().map(|&(_, face)| shell_of(face)).collect();
        at.sort_unstable();
        at.dedup();
        at.into_iter().for_each(|shell| list[shell].vertices += 1);
    }
    for (face, corners) in topology.triangles().iter().enumerate() {
        let Some(shell) = shells.of_face[face] else { continue };
        let shell = &mut list[shell as usize];
        if shell.faces == 0 {
            shell.first_face = FaceId::new(face);
        }
        shell.faces += 1;
        shell.vertices += corners.iter().filter(|&&vertex| first_time(vertex)).count();
    }
}

/// Fills in what follows from the counts. A shell with two fans at one vertex is no surface there, and has no
/// genus; two shells may share a vertex.
fn characterise(shells: &Shells, fans: &[(VertexId, FaceId)], list: &mut [ShellReport]) {
    for shell in list.iter_mut() {
        let [v, e, f] = [shell.vertices, shell.edges, shell.faces].map(|n| n as i64); // below 2^32
        shell.euler_characteristic = v - e + f;
        if shell.watertight {
            shell.genus = u64::try_from((2 - shell.euler_characteristic) / 2).ok();
        }
    }
    for fans in fans.chunk_by(|a, b| a.0 == b.0) {
        let mut at: Vec<Option<u32>> = fans.iter().map(|&(_, face)| shells.of_face[face.index()]).collect();
        at.sort_unstable();
        for twice in at.windows(2).filter(|pair| pair[0] == pair[1]) {
            if let Some(shell) = twice[0] {
                list[shell as usize].genus = None;
            }
        }
    }
}

/// Fills in boxes and volumes. Gives the exact signs of the watertight shells' volumes, and zero for all
/// other shells.
fn measure(mesh: &Mesh, topology: &Topology, shells: &Shells, list: &mut [ShellReport]) -> Vec<Sign> {
    // A closed surface has the same volume about any point, and the smallest terms about a point of its own.
    // The volume of an open surface includes the cone over its border; one apex for all shells, which moves
    // with the mesh, lets the patches of a solid add up.
    let apex = if list.iter().all(|shell| shell.balanced) { [0.0; 3] } else { mean_corner(mesh, topology) };
    let about = |shell: &ShellReport| match shell.balanced {
        true => mesh.corners(shell.first_face)[0].map(f64::from),
        false => apex,
    };
    let mut sums: Vec<VolumeSum> = list.iter().map(|shell| VolumeSum::new(about(shell))).collect();
    // Faces of a shell come in runs; within a run the sums stay in registers.
    let mut next = 0;
    for run in shells.of_face.chunk_by(|a, b| a == b) {
        let faces = next..next + run.len() as u32;
        next = faces.end;
        let Some(shell) = run[0].map(|shell| shell as usize) else { continue };
        let (mut sum, mut bounds) = (sums[shell], list[shell].bounds);
        for face in faces.map(FaceId) {
            let corners = mesh.corners(face);
            sum.add(corners);
            bounds = bounds.join(&Aabb::around(corners));
        }
        (sums[shell], list[shell].bounds) = (sum, bounds);
    }
    let mut unsure = vec![None; list.len()];
    for ((shell, sum), unsure) in list.iter_mut().zip(&sums).zip(&mut unsure) {
        shell.signed_volume = sum.value();
        if shell.watertight && sum.sign().is_none() {
            *unsure = Some(Box::new(ExactVolume::new()));
        }
    }
    if unsure.iter().any(Option::is_some) {
        for (face, shell) in topology.faces().zip(&shells.of_face) {
            if let Some(exact) = shell.and_then(|shell| unsure[shell as usize].as_mut()) {
                exact.add(mesh.corners(face));
            }
        }
    }
    let sign = |((shell, sum), exact): ((&ShellReport, &VolumeSum), Option<Box<ExactVolume>>)| match exact {
        _ if !shell.watertight => Sign::Zero,
        Some(exact) => exact.sign(),
        None => sum.sign().expect("what is unsure was added exactly"),
    };
    list.iter().zip(&sums).zip(unsure).map(sign).collect()
}

/// The mean over the corners of all faces that have not collapsed.
fn mean_corner(mesh: &Mesh, topology: &Topology) -> [f64; 3] {
    let mut sum = [0.0; 3];
    for face in topology.faces().filter(|&face| !topology.is_collapsed(face)) {
        for corner in mesh.corners(face) {
            for axis in 0..3 {
                sum[axis] += f64::from(corner[axis]);
            }
        }
    }
    let corners = 3 * (topology.face_count() - topology.collapsed_face_count());
    sum.map(|sum| sum / corners as f64)
}
