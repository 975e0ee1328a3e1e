//! What is drawn of a defect, and in which color: the same in pictures, marked meshes and pages.

use umbrage::check::{Defect, DefectKind};
use umbrage::mesh::Mesh;

/// The form in which a defect is drawn. Its position and faces are in the [`Defect`].
pub(crate) struct Drawn {
    /// Line segments, in the units of the mesh.
    pub(crate) lines: Vec<[[f32; 3]; 2]>,
    /// Whether its position is marked: lines and faces would not show it.
    pub(crate) spot: bool,
    /// Whether its faces have the color of its kind.
    pub(crate) faces: bool,
}

impl Drawn {
    /// `mesh` is the one that the defect was found in.
    pub(crate) fn of(kind: DefectKind, defect: &Defect, mesh: &Mesh) -> Self {
        let mut lines = defect.segments.clone();
        // A face without area is invisible: two of its sides cover it.
        let thin = matches!(kind, DefectKind::CollapsedFace | DefectKind::ZeroAreaFace);
        if thin {
            for &face in &defect.faces {
                let [a, b, c] = mesh.corners(face);
                lines.extend([[a, b], [b, c]]);
            }
        }
        Self {
            lines,
            spot: thin || matches!(kind, DefectKind::NonManifoldVertex | DefectKind::TJunction),
            faces: has_colored_faces(kind),
        }
    }
}

/// Whether the faces of such defects are colored.
pub(super) fn has_colored_faces(kind: DefectKind) -> bool {
    matches!(kind, DefectKind::DuplicateFace | DefectKind::InsideOutShell | DefectKind::SelfIntersection)
}

/// A color's name and its sRGB bytes.
pub(crate) fn color(kind: DefectKind) -> (&'static str, [u8; 3]) {
    match kind {
        DefectKind::BoundaryLoop => ("red", [230, 25, 25]),
        DefectKind::NonManifoldEdge => ("magenta", [225, 20, 225]),
        DefectKind::MisorientedEdge => ("yellow", [245, 215, 20]),
        DefectKind::NonManifoldVertex => ("cyan", [20, 200, 225]),
        DefectKind::CollapsedFace => ("white", [255, 255, 255]),
        DefectKind::ZeroAreaFace => ("orange", [250, 140, 20]),
        DefectKind::DuplicateFace => ("blue", [40, 90, 240]),
        DefectKind::NearMissSeam => ("green", [30, 190, 60]),
        DefectKind::TJunction => ("dark green", [10, 110, 60]),
        DefectKind::InsideOutShell => ("violet", [150, 90, 235]),
        DefectKind::SelfIntersection => ("pink", [250, 120, 150]),
        // The list of kinds may grow.
        _ => ("black", [0, 0, 0]),
    }
}
