//! A case as text: to look at, to replay, to paste.

use std::fmt::Write as _;

use super::Case;

impl Case {
    /// The case as a plain OBJ whose comments hold the light and the point `at`: any viewer shows it, and
    /// `umbrage torture --replay FILE` asks every method about it. All numbers read back bit for bit.
    #[must_use]
    pub fn to_obj(&self, at: [f32; 3]) -> String {
        let [x, y, z] = at;
        let mut text = format!("# light {}\n# point {x},{y},{z}\n", self.light);
        for [x, y, z] in self.mesh.positions() {
            let _ = writeln!(text, "v {x} {y} {z}");
        }
        for corners in self.mesh.triangles() {
            let [a, b, c] = corners.map(|vertex| u64::from(vertex) + 1);
            let _ = writeln!(text, "f {a} {b} {c}");
        }
        text
    }

    /// The case as Rust, for a test of its own: `mesh`, `light` and `point`.
    #[must_use]
    pub fn to_rust(&self, at: [f32; 3]) -> String {
        format!(
            "let mesh = Mesh::new(vec!{:?}, vec!{:?}).unwrap();\nlet light: Light = \"{}\".parse().unwrap();\nlet \
             point: [f32; 3] = {at:?};\n",
            self.mesh.positions(),
            self.mesh.triangles(),
            self.light
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::Light;
    use crate::mesh::Mesh;

    fn case() -> Case {
        let positions = vec![[0.1, -1.0 / 3.0, 1e-20], [1.0, 0.0, 3e20], [0.0, 1.0, 0.5]];
        let mesh = Mesh::new(positions, vec![[0, 1, 2]]).unwrap();
        Case { mesh, light: Light::directional([0.0, -1.0, 0.3]).unwrap(), points: vec![[0.7, 2.0, -4.0]] }
    }

    #[cfg(feature = "files")]
    #[test]
    fn printed_case_reads_back_bit_for_bit() {
        use crate::testing::torture::Repro;
        let (case, folder) = (case(), tempfile::tempdir().unwrap());
        let read = |text: &str| {
            let path = folder.path().join("case.obj");
            std::fs::write(&path, text).unwrap();
            Repro::read(path).unwrap()
        };
        let text = case.to_obj(case.points[0]);
        let found = read(&text);
        assert_eq!((found.light, found.point), (case.light, case.points[0]));
        let same = |found: &Repro| found.mesh.positions() == case.mesh.positions();
        assert!(same(&found) && found.mesh.triangles() == case.mesh.triangles());
        // Fault injected: fewer digits.
        assert!(!same(&read(&text.replace("333334", "333"))));
    }

    #[test]
    fn printed_case_can_be_pasted() {
        let case = case();
        let text = case.to_rust(case.points[0]);
        let expected = "let mesh = Mesh::new(vec![[0.1, -0.33333334, 1e-20], [1.0, 0.0, 3e20], [0.0, 1.0, 0.5]], \
                        vec![[0, 1, 2]]).unwrap();\nlet light: Light = \"directional:0,-1,0.3\".parse().unwrap();\n\
                        let point: [f32; 3] = [0.7, 2.0, -4.0];\n";
        assert_eq!(text, expected);
    }
}
