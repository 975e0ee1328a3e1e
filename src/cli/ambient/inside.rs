//! The worst error inside faces, and the face that has it, as the file counts it.

use serde_json::{Value, json};
use umbrage::ambient::InsideError;
use umbrage::mesh::{FaceId, Origin};

use super::input::Input;
use crate::cli::output::{counted, number, plain, significant};

/// Where values that are drawn linearly over faces are farthest off.
pub(super) struct Worst {
    mesh: String,
    /// In its mesh.
    face: FaceId,
    origin: Origin,
    error: InsideError,
}

impl Worst {
    /// `None` for a face that the file does not have.
    pub(super) fn of(input: &Input, error: InsideError) -> Option<Self> {
        let mut own = *input.order.get(error.face.index())? as usize;
        for mesh in &input.meshes {
            if own < mesh.face_count() {
                let face = FaceId::new(own);
                return Some(Self { mesh: mesh.name.clone(), face, origin: mesh.origin(face), error });
            }
            own -= mesh.face_count();
        }
        None
    }

    pub(super) fn document(&self) -> Value {
        json!({
            "face": self.face.0,
            "error": number(self.error.error),
            "samples": self.error.samples,
            "mean_error": number(self.error.mean),
            "mesh": self.mesh,
            "polygon": self.origin.polygon,
            "line": self.origin.line,
        })
    }

    pub(super) fn text(&self) -> String {
        let Self { mesh, face, origin, error } = self;
        let short = |error: f64| significant((error * 1e4).round() / 1e4);
        let mut named = Vec::new();
        if origin.polygon != face.0 {
            named.push(format!("polygon {}", origin.polygon));
        }
        named.extend(origin.line.map(|line| format!("line {line}")));
        if !mesh.is_empty() {
            named.push(format!("mesh {}", plain(mesh)));
        }
        let named = if named.is_empty() { String::new() } else { format!(" ({})", named.join(", ")) };
        format!(
            "mean {}, worst {} in face {}{named}, from {}",
            short(error.mean),
            short(error.error),
            face.0,
            counted(error.samples as usize, "sample", "samples"),
        )
    }
}
