//! Kinds of defects, their effects on a shadow, and their positions.

use std::fmt;

use super::CrackReport;
use crate::mesh::{EdgeId, FaceId, Mesh, VertexId};
use crate::topology::Topology;

/// Kinds of defects of a mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[non_exhaustive]
pub enum DefectKind {
    /// A connected run of edges that have only one face.
    BoundaryLoop,
    /// An edge with three faces or more.
    NonManifoldEdge,
    /// An edge whose two faces run along it in the same direction.
    MisorientedEdge,
    /// A vertex whose faces form more than one fan.
    NonManifoldVertex,
    /// A face with two equal corners.
    CollapsedFace,
    /// A face with three different corners on one line.
    ZeroAreaFace,
    /// A face with the same three vertices as an earlier one.
    DuplicateFace,
    /// A boundary edge that would find its partner within a small distance.
    NearMissSeam,
    /// A boundary vertex inside another boundary edge.
    TJunction,
    /// A watertight shell whose faces point the wrong way.
    InsideOutShell,
    /// Two faces that meet where they should not.
    SelfIntersection,
}

impl DefectKind {
    /// Every kind, in the order of a report.
    pub const ALL: [Self; 11] = [
        Self::BoundaryLoop,
        Self::NonManifoldEdge,
        Self::MisorientedEdge,
        Self::NonManifoldVertex,
        Self::CollapsedFace,
        Self::ZeroAreaFace,
        Self::DuplicateFace,
        Self::NearMissSeam,
        Self::TJunction,
        Self::InsideOutShell,
        Self::SelfIntersection,
    ];

    /// The stable name, in snake case.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::BoundaryLoop => "boundary_loop",
            Self::NonManifoldEdge => "non_manifold_edge",
            Self::MisorientedEdge => "misoriented_edge",
            Self::NonManifoldVertex => "non_manifold_vertex",
            Self::CollapsedFace => "collapsed_face",
            Self::ZeroAreaFace => "zero_area_face",
            Self::DuplicateFace => "duplicate_face",
            Self::NearMissSeam => "near_miss_seam",
            Self::TJunction => "t_junction",
            Self::InsideOutShell => "inside_out_shell",
            Self::SelfIntersection => "self_intersection",
        }
    }

    /// The stable code of reports for machines: the name in upper case.
    #[must_use]
    pub fn code(self) -> &'static str {
        match self {
            Self::BoundaryLoop => "BOUNDARY_LOOP",
            Self::NonManifoldEdge => "NON_MANIFOLD_EDGE",
            Self::MisorientedEdge => "MISORIENTED_EDGE",
            Self::NonManifoldVertex => "NON_MANIFOLD_VERTEX",
            Self::CollapsedFace => "COLLAPSED_FACE",
            Self::ZeroAreaFace => "ZERO_AREA_FACE",
            Self::DuplicateFace => "DUPLICATE_FACE",
            Self::NearMissSeam => "NEAR_MISS_SEAM",
            Self::TJunction => "T_JUNCTION",
            Self::InsideOutShell => "INSIDE_OUT_SHELL",
            Self::SelfIntersection => "SELF_INTERSECTION",
        }
    }

    /// How much it matters: an error makes some shadow wrong, a warning makes one technique or one picture
    /// wrong, and an information is without effect.
    ///
    /// ```
    /// use umbrage::check::{DefectKind, Severity};
    /// assert_eq!(DefectKind::BoundaryLoop.severity(), Severity::Error);
    /// assert_eq!(DefectKind::CollapsedFace.severity(), Severity::Information);
    /// ```
    #[must_use]
    pub fn severity(self) -> Severity {
        match self {
            Self::BoundaryLoop | Self::NonManifoldEdge | Self::MisorientedEdge | Self::InsideOutShell => {
                Severity::Error
            }
            Self::DuplicateFace | Self::NearMissSeam | Self::TJunction | Self::SelfIntersection => {
                Severity::Warning
            }
            Self::NonManifoldVertex | Self::CollapsedFace | Self::ZeroAreaFace => Severity::Information,
        }
    }

    /// Its effect on a shadow, in one sentence.
    #[must_use]
    pub fn effect(self) -> &'static str {
        match self {
            Self::BoundaryLoop => {
                "light enters through the hole: front-only volumes and parity counts leak there, \
                 the general volume stays closed and casts what faces there are"
            }
            Self::NonManifoldEdge => {
                "tables with two faces an edge lose the others; the general volume stays closed with one side \
                 for each surplus face, front-only holds if the directions balance"
            }
            Self::MisorientedEdge => {
                "neighbors disagree about front and back: pairing by direction sees a false border and \
                 front-only counts are wrong; the general volume stays closed"
            }
            Self::NonManifoldVertex => {
                "none on a volume, which is closed edge by edge; walks around the vertex miss a fan"
            }
            Self::CollapsedFace => "none, since the face has no area and no edges left; it is skipped",
            Self::ZeroAreaFace => {
                "none by itself: it is edge-on to every light and only passes its edges on; \
                 dropping it would open a crack between its neighbors"
            }
            Self::DuplicateFace => {
                "counted once for each copy: parity counts cancel where the surface should cast, \
                 and stencil counts grow; the general volume still shadows the right points"
            }
            Self::NearMissSeam => {
                "two borders that look like one edge: front-only volumes and parity counts leak a hairline \
                 of light; weld within the stated distance to close it"
            }
            Self::TJunction => {
                "edges that cover each other without sharing vertices: the sides of the volume may part by a \
                 pixel when drawn, front-only volumes stay open; the general volume is closed all the same"
            }
            Self::InsideOutShell => {
                "its faces look the wrong way for where it lies: culling hides the wrong ones, and where they look \
                 inwards a front-only volume counts negative; the general volume is unchanged"
            }
            Self::SelfIntersection => {
                "regions are counted twice or negatively: front-only volumes can light what is in shadow, so \
                 only the general form is certain; its answer is right"
            }
        }
    }
}

/// How much a defect matters, ascending.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Severity {
    /// Without effect on a shadow.
    Information,
    /// Some technique, or some picture, is wrong.
    Warning,
    /// A shadow is wrong unless the general volume is used.
    Error,
}

impl Severity {
    /// `"information"`, `"warning"` or `"error"`.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Information => "information",
            Self::Warning => "warning",
            Self::Error => "error",
        }
    }
}

impl fmt::Display for DefectKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// One defect: its position, its faces, its edges.
///
/// ```
/// use umbrage::check::{CrackReport, DefectKind};
/// use umbrage::testing::shapes;
/// use umbrage::topology::Topology;
/// let mesh = shapes::open_cube();
/// let topology = Topology::of(&mesh);
/// let report = CrackReport::of(&mesh, &topology);
/// let holes = report.items(DefectKind::BoundaryLoop, &mesh, &topology, 10);
/// assert_eq!((holes.len(), holes[0].segments.len()), (1, 4));
/// assert_eq!(holes[0].length, Some(8.0)); // the cube is [−1, 1]³
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Defect {
    /// A point to look at, in mesh units.
    pub position: [f32; 3],
    /// Length of the edge, the loop or the seam, in mesh units; `None` for defects without a length.
    pub length: Option<f64>,
    /// Its faces; [`Mesh::part_name`] and [`Mesh::corners`] give their names and corners.
    pub faces: Vec<FaceId>,
    /// The end points of its edges.
    pub segments: Vec<[[f32; 3]; 2]>,
}

impl CrackReport {
    /// The number of defects of a kind; `None` if they were not searched for.
    #[must_use]
    pub fn count(&self, kind: DefectKind) -> Option<usize> {
        let counts = &self.counts;
        Some(match kind {
            DefectKind::BoundaryLoop => counts.boundary_loops,
            DefectKind::NonManifoldEdge => counts.non_manifold_edges,
            DefectKind::MisorientedEdge => counts.misoriented_edges,
            DefectKind::NonManifoldVertex => counts.non_manifold_vertices,
            DefectKind::CollapsedFace => counts.collapsed_faces,
            DefectKind::ZeroAreaFace => counts.zero_area_faces,
            DefectKind::DuplicateFace => counts.duplicate_faces,
            DefectKind::NearMissSeam => counts.near_miss_edges,
            DefectKind::TJunction => counts.t_junctions,
            DefectKind::InsideOutShell => counts.inside_out_shells,
            DefectKind::SelfIntersection => return counts.self_intersections,
        })
    }

    /// The first `limit` defects of a kind, in the order of their ids. Linear in the mesh and in the result.
    ///
    /// `mesh` and `topology` are those the report was made of.
    ///
    /// # Panics
    ///
    /// Panics if an id is out of range, which can happen if `mesh` or `topology` is another one.
    #[must_use]
    pub fn items(&self, kind: DefectKind, mesh: &Mesh, topology: &Topology, limit: usize) -> Vec<Defect> {
        let at = Locator { mesh, topology };
        let places = &self.places;
        match kind {
            DefectKind::BoundaryLoop => {
                let starts = std::iter::once(0).chain(places.loop_ends.iter().copied());
                let loops = starts.zip(&places.loop_ends);
                loops
                    .take(limit)
                    .map(|(start, &end)| at.edges(&places.loop_edges[start as usize..end as usize]))
                    .collect()
            }
            DefectKind::NonManifoldEdge => {
                let bad = topology.edges().filter(|&edge| topology.valence(edge) > 2);
                bad.take(limit).map(|edge| at.edges(&[edge])).collect()
            }
            DefectKind::MisorientedEdge => {
                let bad = topology.edges().filter(|&edge| topology.is_misoriented(edge));
                bad.take(limit).map(|edge| at.edges(&[edge])).collect()
            }
            DefectKind::NonManifoldVertex => {
                let fans = topology.survey().fans.chunk_by(|a, b| a.0 == b.0);
                fans.take(limit)
                    .map(|fans| at.vertex(fans[0].0, fans.iter().map(|fan| fan.1).collect()))
                    .collect()
            }
            DefectKind::CollapsedFace => {
                let bad = topology.faces().filter(|&face| topology.is_collapsed(face));
                bad.take(limit).map(|face| at.faces(vec![face])).collect()
            }
            DefectKind::ZeroAreaFace => {
                places.zero_area.iter().take(limit).map(|&face| at.faces(vec![face])).collect()
            }
            DefectKind::DuplicateFace => places
                .duplicates
                .iter()
                .take(limit)
                .map(|pair| at.faces(vec![pair.extra, pair.original]))
                .collect(),
            DefectKind::NearMissSeam => {
                places.near_miss_edges.iter().take(limit).map(|&edge| at.edges(&[edge])).collect()
            }
            DefectKind::TJunction => places
                .t_junctions
                .iter()
                .take(limit)
                .map(|found| Defect { position: at.position(found.vertex), ..at.edges(&[found.edge]) })
                .collect(),
            DefectKind::InsideOutShell => {
                let bad: Vec<u32> =
                    (0..).zip(&self.shell_list).filter(|s| s.1.inside_out).map(|s| s.0).collect();
                at.shells(&bad[..bad.len().min(limit)])
            }
            DefectKind::SelfIntersection => {
                let pairs = self.self_intersections.iter().flat_map(|found| &found.first);
                pairs.take(limit).map(|pair| at.faces(pair.to_vec())).collect()
            }
        }
    }
}

/// Turns ids into positions.
struct Locator<'a> {
    mesh: &'a Mesh,
    topology: &'a Topology,
}

impl Locator<'_> {
    fn position(&self, vertex: VertexId) -> [f32; 3] {
        self.mesh.positions()[vertex.index()]
    }

    fn vertex(&self, vertex: VertexId, faces: Vec<FaceId>) -> Defect {
        Defect { position: self.position(vertex), faces, ..Defect::default() }
    }

    /// A defect of edges, positioned at the middle of the first one.
    fn edges(&self, edges: &[EdgeId]) -> Defect {
        let segments: Vec<[[f32; 3]; 2]> = edges
            .iter()
            .map(|&edge| self.topology.vertices(edge).map(|vertex| self.position(vertex)))
            .collect();
        let mut faces: Vec<FaceId> = edges
            .iter()
            .flat_map(|&edge| self.topology.half_edges(edge))
            .map(|half_edge| self.topology.face(half_edge))
            .collect();
        faces.sort_unstable();
        faces.dedup();
        let position = segments.first().map_or([0.0; 3], |&[a, b]| mean(&[a, b]));
        Defect { position, length: Some(segments.iter().map(length).sum()), faces, segments }
    }

    /// A defect of faces, positioned at the centroid of the first one.
    fn faces(&self, faces: Vec<FaceId>) -> Defect {
        let position = faces.first().map_or([0.0; 3], |&face| mean(&self.mesh.corners(face)));
        Defect { position, faces, ..Defect::default() }
    }

    fn shells(&self, wanted: &[u32]) -> Vec<Defect> {
        if wanted.is_empty() {
            return Vec::new();
        }
        let mut faces = vec![Vec::new(); wanted.len()];
        for (face, shell) in (0..).map(FaceId).zip(self.topology.shells().of_face) {
            if let Some(index) = shell.and_then(|shell| wanted.binary_search(&shell).ok()) {
                faces[index].push(face);
            }
        }
        faces.into_iter().map(|faces| self.faces(faces)).collect()
    }
}

fn mean(points: &[[f32; 3]]) -> [f32; 3] {
    // In f64, in which no sum of three f32 overflows.
    std::array::from_fn(|i| {
        (points.iter().map(|p| f64::from(p[i])).sum::<f64>() / points.len() as f64) as f32
    })
}

fn length([a, b]: &[[f32; 3]; 2]) -> f64 {
    (0..3).map(|i| (f64::from(b[i]) - f64::from(a[i])).powi(2)).sum::<f64>().sqrt()
}
