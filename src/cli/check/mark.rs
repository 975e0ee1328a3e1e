//! The crack report as colored geometry.

use umbrage::check::{CrackReport, Defect, DefectKind};
use umbrage::geom::Aabb;
use umbrage::mesh::{FaceId, Mesh};
use umbrage::topology::Topology;
use umbrage::write::{Elements, Layer, Model};

use super::drawn::{Drawn, has_colored_faces};
use super::report::Place;
use super::text::Title;
use crate::cli::error::Failure;

/// How many pairs of intersecting faces are marked at most: there may be more than memory holds.
pub(super) const PAIRS_MARKED: usize = 100_000;

/// Radius of an octahedron over the diagonal of the mesh: small, but visible with the whole mesh in view.
const OCTAHEDRON: f64 = 0.005;

/// Colored layers that grow mesh by mesh.
pub(super) struct Marks {
    /// How many defects of each kind have layers of their own: those that the text lists, too.
    limit: usize,
    surface: Triangles,
    /// The order is that of [`DefectKind::ALL`].
    kinds: [Kind; DefectKind::ALL.len()],
}

/// The marks of one kind of defect.
#[derive(Default)]
struct Kind {
    /// The first defects, by the names that the text has for them.
    named: Vec<(String, Mark)>,
    /// All others.
    rest: Mark,
}

/// The lines, octahedra and faces that mark one defect, or several.
#[derive(Default)]
struct Mark {
    lines: Vec<[[f32; 3]; 2]>,
    solids: Triangles,
}

#[derive(Default)]
struct Triangles {
    positions: Vec<[f32; 3]>,
    triangles: Vec<[u32; 3]>,
}

impl Triangles {
    fn add(&mut self, positions: &[[f32; 3]], triangles: &[[u32; 3]]) -> Result<(), Failure> {
        let total = self.positions.len() + positions.len();
        if u32::try_from(total).is_err() {
            let problem =
                format!("{total} vertices of marked geometry are more than 32-bit indices can name");
            return Err(Failure::new(problem, "leave out --mark"));
        }
        let base = self.positions.len() as u32; // below the total, which fits
        self.positions.extend_from_slice(positions);
        self.triangles.extend(triangles.iter().map(|corners| corners.map(|corner| base + corner)));
        Ok(())
    }
}

impl Marks {
    /// No marks yet. The first `limit` defects of each kind will have layers of their own.
    pub(super) fn naming(limit: usize) -> Self {
        Self { limit, surface: Triangles::default(), kinds: Default::default() }
    }

    /// Marks all defects of a mesh.
    pub(super) fn add(
        &mut self,
        report: &CrackReport,
        mesh: &Mesh,
        topology: &Topology,
    ) -> Result<(), Failure> {
        self.surface.add(mesh.positions(), mesh.triangles())?;
        let bounds = report.shell_list.iter().fold(Aabb::EMPTY, |all, shell| all.join(&shell.bounds));
        let radius = OCTAHEDRON * bounds.diagonal();
        for (kind, marks) in DefectKind::ALL.into_iter().zip(&mut self.kinds) {
            if report.count(kind).unwrap_or(0) == 0 {
                continue;
            }
            let fills = has_colored_faces(kind);
            // A face may take part in many.
            let mut faces: Vec<FaceId> = Vec::new();
            for defect in report.items(kind, mesh, topology, usize::MAX) {
                if marks.named.len() == self.limit {
                    marks.rest.add(kind, &defect, mesh, radius)?;
                    faces.extend(defect.faces.iter().filter(|_| fills));
                    continue;
                }
                let mut mark = Mark::default();
                mark.add(kind, &defect, mesh, radius)?;
                if fills {
                    mark.fill(&defect.faces, mesh)?;
                }
                let title = Title { kind, place: &Place::of(defect, mesh) }.to_string();
                marks.named.push((title, mark));
            }
            faces.sort_unstable();
            faces.dedup();
            marks.rest.fill(&faces, mesh)?;
        }
        Ok(())
    }

    /// The mesh in translucent gray, then a layer or two for each defect that the text lists, and for all
    /// others of a kind.
    pub(super) fn into_model(self) -> Model {
        let surface = layer("mesh", [0.5, 0.5, 0.5, 0.35], self.surface);
        let marks = DefectKind::ALL.into_iter().zip(self.kinds).flat_map(|(kind, Kind { named, rest })| {
            let rest_name = match named.len() {
                0 => kind.name().to_owned(),
                _ => format!("{kind}, not listed"),
            };
            let all = named.into_iter().chain([(rest_name, rest)]);
            all.flat_map(move |(name, mark)| mark.into_layers(&name, color(kind)))
        });
        Model { layers: std::iter::once(surface).chain(marks).collect() }
    }
}

fn layer(name: &str, color: [f32; 4], from: Triangles) -> Layer {
    Layer {
        name: name.to_owned(),
        color: Some(color),
        positions: from.positions,
        elements: Elements::Triangles(from.triangles),
        ..Layer::default()
    }
}

impl Mark {
    /// Its lines, then its octahedra and faces, as far as there are any.
    fn into_layers(self, name: &str, color: [f32; 4]) -> impl Iterator<Item = Layer> + use<> {
        let count = self.lines.len() as u32; // each has two vertices below, in 24 bytes
        let lines = Layer {
            name: name.to_owned(),
            color: Some(color),
            positions: self.lines.into_flattened(),
            elements: Elements::Lines((0..count).map(|line| [2 * line, 2 * line + 1]).collect()),
            ..Layer::default()
        };
        let of_solids = if count == 0 { name.to_owned() } else { format!("{name}, places") };
        let solids = layer(&of_solids, color, self.solids);
        [lines, solids].into_iter().filter(|layer| !layer.elements.is_empty())
    }

    /// Lines and octahedra of one defect.
    fn add(&mut self, kind: DefectKind, defect: &Defect, mesh: &Mesh, radius: f64) -> Result<(), Failure> {
        let drawn = Drawn::of(kind, defect, mesh);
        self.lines.extend(drawn.lines);
        if drawn.spot { self.octahedron(defect.position, radius) } else { Ok(()) }
    }

    /// Faces of the mesh in the color of the defect.
    fn fill(&mut self, faces: &[FaceId], mesh: &Mesh) -> Result<(), Failure> {
        faces.iter().try_for_each(|&face| self.solids.add(&mesh.corners(face), &[[0, 1, 2]]))
    }

    fn octahedron(&mut self, at: [f32; 3], radius: f64) -> Result<(), Failure> {
        let largest = f64::from(f32::MAX);
        let corner = |axis: usize, sign: f64| {
            let mut corner = at;
            corner[axis] = (f64::from(at[axis]) + sign * radius).clamp(-largest, largest) as f32;
            corner
        };
        let corners = [
            corner(0, 1.0),
            corner(0, -1.0),
            corner(1, 1.0),
            corner(1, -1.0),
            corner(2, 1.0),
            corner(2, -1.0),
        ];
        const FACES: [[u32; 3]; 8] =
            [[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]];
        self.solids.add(&corners, &FACES)
    }
}

/// Linear red, green, blue and opacity.
fn color(kind: DefectKind) -> [f32; 4] {
    match kind {
        DefectKind::BoundaryLoop => [1.0, 0.0, 0.0, 1.0],
        DefectKind::NonManifoldEdge => [1.0, 0.0, 1.0, 1.0],
        DefectKind::MisorientedEdge => [1.0, 1.0, 0.0, 1.0],
        DefectKind::NonManifoldVertex => [0.0, 1.0, 1.0, 1.0],
        DefectKind::CollapsedFace => [1.0, 1.0, 1.0, 1.0],
        DefectKind::ZeroAreaFace => [1.0, 0.5, 0.0, 1.0],
        DefectKind::DuplicateFace => [0.0, 0.2, 1.0, 1.0],
        DefectKind::NearMissSeam => [0.0, 1.0, 0.0, 1.0],
        DefectKind::TJunction => [0.0, 0.5, 0.25, 1.0],
        DefectKind::InsideOutShell => [0.4, 0.0, 1.0, 0.5],
        DefectKind::SelfIntersection => [1.0, 0.1, 0.3, 0.7],
        // The list of kinds may grow.
        _ => [1.0, 1.0, 1.0, 1.0],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use umbrage::testing::shapes;

    fn marks_of(mesh: &Mesh, limit: usize) -> Model {
        let topology = Topology::of(mesh);
        let mut report = CrackReport::of(mesh, &topology);
        report.add_self_intersections(mesh, &topology, PAIRS_MARKED);
        let mut marks = Marks::naming(limit);
        marks.add(&report, mesh, &topology).unwrap();
        marks.into_model()
    }

    #[test]
    fn marks_of_a_sound_mesh_are_the_mesh_alone() {
        let model = marks_of(&shapes::cube(), 5);
        assert_eq!(model.layers.len(), 1);
        assert_eq!(model.layers[0].elements.len(), 12);
    }

    #[test]
    fn marks_of_an_open_cube_are_the_red_edges_of_its_hole() {
        let model = marks_of(&shapes::open_cube(), 0);
        let hole = &model.layers[1];
        assert_eq!((hole.name.as_str(), hole.color), ("boundary_loop", Some([1.0, 0.0, 0.0, 1.0])));
        assert!(matches!(&hole.elements, Elements::Lines(lines) if lines.len() == 4), "{:?}", hole.elements);
    }

    #[test]
    fn marks_of_a_bow_tie_are_an_outward_octahedron() {
        let model = marks_of(&shapes::cubes_sharing_vertex(), 0);
        let place = model.layers.iter().find(|layer| layer.name == "non_manifold_vertex").unwrap();
        let Elements::Triangles(triangles) = &place.elements else { panic!("no triangles") };
        let octahedron = Mesh::new(place.positions.clone(), triangles.clone()).unwrap();
        let topology = Topology::build(octahedron.vertex_count(), triangles.clone());
        assert!(CrackReport::of(&octahedron, &topology).counts.sound());
    }

    /// The names of the layers, and their numbers of elements, without those of the surface.
    fn named(model: &Model) -> Vec<(&str, usize)> {
        model.layers[1..].iter().map(|layer| (layer.name.as_str(), layer.elements.len())).collect()
    }

    #[test]
    fn marks_are_named_by_the_faces_and_the_polygons_that_the_text_lists() {
        // Three quads in a row, each apart from the next: three loops of four edges.
        let text: String = (0..3)
            .flat_map(|x| [[0, 0], [1, 0], [1, 1], [0, 1]].map(|[i, j]| format!("v {} {} 0\n", 2 * x + i, j)))
            .chain((0..3).map(|k| format!("f {} {} {} {}\n", 4 * k + 1, 4 * k + 2, 4 * k + 3, 4 * k + 4)))
            .collect();
        let scene = umbrage::read::read_bytes(text.as_bytes(), "quads.obj").unwrap();
        let quads = scene.bake(umbrage::scene::Scope::Mesh).unwrap().remove(0);
        let all = marks_of(&quads, 5);
        assert_eq!(
            named(&all),
            [
                ("boundary_loop: faces 0 1 (polygon 0, line 13)", 4),
                ("boundary_loop: faces 2 3 (polygon 1, line 14)", 4),
                ("boundary_loop: faces 4 5 (polygon 2, line 15)", 4),
            ]
        );
        // What the limit leaves out keeps its marks, and loses its name.
        assert_eq!(
            named(&marks_of(&quads, 1)),
            [("boundary_loop: faces 0 1 (polygon 0, line 13)", 4), ("boundary_loop, not listed", 8)]
        );
        assert_eq!(named(&marks_of(&quads, 0)), [("boundary_loop", 12)]);
        // Fault injected: without its origins the mesh has triangles only.
        let bare = Mesh::new(quads.positions().to_vec(), quads.triangles().to_vec()).unwrap();
        assert_ne!(named(&marks_of(&bare, 5)), named(&all));
    }

    #[test]
    fn marks_of_faces_in_several_pairs_are_drawn_once_among_the_rest() {
        // Six triangles on each other, without a common vertex: fifteen pairs.
        let one = Mesh::new(vec![[0.0; 3], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0]], vec![[0, 1, 2]]).unwrap();
        let heap = shapes::soup(&Mesh::concat(&vec![one; 6]).unwrap());
        let pairs = |limit: usize| -> Vec<usize> {
            let model = marks_of(&heap, limit);
            let of_pairs = |layer: &&Layer| layer.name.starts_with("self_intersection");
            model.layers.iter().filter(of_pairs).map(|layer| layer.elements.len()).collect()
        };
        assert_eq!((pairs(0), pairs(1), pairs(99)), (vec![6], vec![2, 6], vec![2; 15]));
    }
}
