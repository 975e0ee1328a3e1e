//! Defects of what casts, as rows of a list and as lines over a picture.

use umbrage::caster::Caster;
use umbrage::check::{Defect, DefectKind, Severity};

use crate::cli::check::{Drawn, around, defect_color, mean_normal};

/// The defects of a caster.
#[derive(Debug, Default)]
pub(super) struct Defects {
    /// Kinds with their numbers, worst effect first.
    pub(super) kinds: Vec<(DefectKind, usize)>,
    pub(super) rows: Vec<Row>,
    pub(super) lines: Vec<([[f32; 3]; 2], [u8; 3])>,
    pub(super) spots: Vec<([f32; 3], [u8; 3])>,
    /// Whether every shell is watertight and none is inside out.
    pub(super) is_sound: bool,
}

/// A defect to fly to.
#[derive(Clone, Copy, Debug)]
pub(super) struct Row {
    pub(super) kind: DefectKind,
    pub(super) position: [f32; 3],
    /// The middle of what is drawn of it, how far it reaches around that, and the mean normal of its faces.
    pub(super) target: [f64; 3],
    pub(super) reach: f64,
    pub(super) normal: [f64; 3],
}

/// Rows of each kind, and lines and spots in all, that are kept: more could neither be read nor told apart.
const ROWS: usize = 500;
const MARKS: usize = 20_000;

impl Defects {
    /// All defects of the first `faces` but self-intersections, which would take long to look for. What comes
    /// after these faces is a ground that was added.
    pub(super) fn of(caster: &Caster, faces: usize) -> Self {
        let (mesh, topology, report) = (caster.mesh(), caster.topology(), caster.report());
        let mut all = Self::default();
        let is_of_ground = |defect: &Defect| defect.faces.first().is_some_and(|face| face.index() >= faces);
        let mut kinds = DefectKind::ALL;
        kinds.sort_by_key(|kind| std::cmp::Reverse(kind.severity()));
        for kind in kinds {
            if report.count(kind).unwrap_or(0) == 0 {
                continue;
            }
            let mut items = report.items(kind, mesh, topology, MARKS);
            let before = items.len();
            items.retain(|defect| !is_of_ground(defect));
            let count = report.count(kind).unwrap_or(0) - (before - items.len());
            if count > 0 {
                all.kinds.push((kind, count));
            }
            for (index, defect) in items.into_iter().enumerate() {
                let drawn = Drawn::of(kind, &defect, mesh);
                let color = defect_color(kind).1;
                let room = MARKS.saturating_sub(all.lines.len());
                all.lines.extend(drawn.lines.iter().take(room).map(|&ends| (ends, color)));
                // Colored faces would hide what is seen: their position is marked.
                if (drawn.spot || drawn.faces) && all.spots.len() < MARKS {
                    all.spots.push((defect.position, color));
                }
                if index < ROWS {
                    let (target, reach) = around(kind, &defect, &drawn, mesh);
                    let normal = mean_normal(&defect, mesh);
                    all.rows.push(Row { kind, position: defect.position, target, reach, normal });
                }
            }
        }
        let is_error = |(kind, _): &(DefectKind, usize)| kind.severity() == Severity::Error;
        all.is_sound = report.counts.sound() || !all.kinds.iter().any(is_error);
        all
    }

    pub(super) fn count(&self) -> usize {
        self.kinds.iter().map(|(_, count)| count).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use umbrage::mesh::Mesh;
    use umbrage::testing::shapes;

    #[test]
    fn defects_of_an_open_cube_are_its_hole() {
        let of = |mesh: Mesh| {
            let faces = mesh.face_count();
            Defects::of(&Caster::new(mesh), faces)
        };
        let open = of(shapes::open_cube());
        assert_eq!(open.kinds, [(DefectKind::BoundaryLoop, 1)]);
        assert_eq!((open.rows.len(), open.lines.len(), open.is_sound), (1, 4, false));
        assert!(open.rows[0].reach > 1.0);
        let closed = of(shapes::cube());
        assert_eq!((closed.count(), closed.is_sound), (0, true));
        // The border of a ground is none, unless it is taken for a part of the mesh.
        let above = Mesh::concat(&[shapes::cube(), shapes::sheet(1)]).unwrap();
        assert_eq!(Defects::of(&Caster::new(above.clone()), 12).kinds, []);
        assert_eq!(of(above).kinds, [(DefectKind::BoundaryLoop, 1)]);
    }
}
