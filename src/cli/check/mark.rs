//! The crack report as colored geometry.

use umbrage::check::{CrackReport, Defect, DefectKind};
use umbrage::geom::Aabb;
use umbrage::mesh::Mesh;
use umbrage::topology::Topology;
use umbrage::write::{Elements, Layer, Model};

use super::drawn::{Drawn, has_colored_faces};
use crate::cli::error::Failure;

/// How many pairs of intersecting faces are marked at most: there may be more than memory holds.
pub(super) const PAIRS_MARKED: usize = 100_000;

/// Radius of an octahedron over the diagonal of the mesh: small, but visible with the whole mesh in view.
const OCTAHEDRON: f64 = 0.005;

/// Colored layers that grow mesh by mesh.
#[derive(Default)]
pub(super) struct Marks {
    surface: Triangles,
    /// Each kind's lines, octahedra and faces; the order is that of [`DefectKind::ALL`].
    kinds: [Kind; DefectKind::ALL.len()],
}

#[derive(Default)]
struct Kind {
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
            let mut faces = Vec::new();
            for defect in report.items(kind, mesh, topology, usize::MAX) {
                marks.add(kind, &defect, mesh, radius)?;
                faces.extend(defect.faces);
            }
            if has_colored_faces(kind) {
                // A face may take part in many.
                faces.sort_unstable();
                faces.dedup();
                faces.iter().try_for_each(|&face| marks.solids.add(&mesh.corners(face), &[[0, 1, 2]]))?;
            }
        }
        Ok(())
    }

    /// The mesh in translucent gray, then a layer or two for each kind of defect found.
    pub(super) fn into_model(self) -> Model {
        let surface = layer("mesh", [0.5, 0.5, 0.5, 0.35], self.surface);
        let marks = DefectKind::ALL.into_iter().zip(self.kinds).flat_map(|(kind, marks)| {
            let color = Some(color(kind));
            let count = marks.lines.len() as u32; // each has two vertices below, in 24 bytes
            let lines = Layer {
                name: kind.name().to_owned(),
                color,
                positions: marks.lines.into_flattened(),
                elements: Elements::Lines((0..count).map(|line| [2 * line, 2 * line + 1]).collect()),
                ..Layer::default()
            };
            let name =
                if lines.elements.is_empty() { kind.name().to_owned() } else { format!("{kind} places") };
            let solids = layer(&name, self::color(kind), marks.solids);
            [lines, solids].into_iter().filter(|layer| !layer.elements.is_empty())
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

impl Kind {
    /// Lines and octahedra of one defect; faces are drawn once they are all known.
    fn add(&mut self, kind: DefectKind, defect: &Defect, mesh: &Mesh, radius: f64) -> Result<(), Failure> {
        let drawn = Drawn::of(kind, defect, mesh);
        self.lines.extend(drawn.lines);
        if drawn.spot { self.octahedron(defect.position, radius) } else { Ok(()) }
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

    fn marks_of(mesh: &Mesh) -> Model {
        let topology = Topology::of(mesh);
        let mut report = CrackReport::of(mesh, &topology);
        report.add_self_intersections(mesh, &topology, PAIRS_MARKED);
        let mut marks = Marks::default();
        marks.add(&report, mesh, &topology).unwrap();
        marks.into_model()
    }

    #[test]
    fn marks_of_a_sound_mesh_are_the_mesh_alone() {
        let model = marks_of(&shapes::cube());
        assert_eq!(model.layers.len(), 1);
        assert_eq!(model.layers[0].elements.len(), 12);
    }

    #[test]
    fn marks_of_an_open_cube_are_the_red_edges_of_its_hole() {
        let model = marks_of(&shapes::open_cube());
        let hole = &model.layers[1];
        assert_eq!((hole.name.as_str(), hole.color), ("boundary_loop", Some([1.0, 0.0, 0.0, 1.0])));
        assert!(matches!(&hole.elements, Elements::Lines(lines) if lines.len() == 4), "{:?}", hole.elements);
    }

    #[test]
    fn marks_of_a_bow_tie_are_an_outward_octahedron() {
        let model = marks_of(&shapes::cubes_sharing_vertex());
        let place = model.layers.iter().find(|layer| layer.name == "non_manifold_vertex").unwrap();
        let Elements::Triangles(triangles) = &place.elements else { panic!("no triangles") };
        let octahedron = Mesh::new(place.positions.clone(), triangles.clone()).unwrap();
        let topology = Topology::build(octahedron.vertex_count(), triangles.clone());
        assert!(CrackReport::of(&octahedron, &topology).counts.sound());
    }
}
