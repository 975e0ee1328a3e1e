//! Vertices without a finite position. A mesh holds none; what no face uses does not matter.

use super::text::counted;
use super::{Format, Place, ReadError};

/// The vertices whose position is not finite in 32 bits.
#[derive(Default)]
pub(super) struct Lost(Vec<Vertex>);

struct Vertex {
    index: u64,
    /// The line, in a text file.
    line: Option<u64>,
    /// The coordinate.
    value: f64,
}

impl Lost {
    /// The position of vertex `index`, rounded; for now the origin, if a coordinate is not finite.
    #[inline]
    pub(super) fn position(&mut self, index: u64, position: [f64; 3], line: Option<u64>) -> [f32; 3] {
        self.rounded(index, position.map(|value| (value, value as f32)), line)
    }

    /// The same of coordinates that are rounded already.
    #[inline]
    pub(super) fn rounded(&mut self, index: u64, position: [(f64, f32); 3], line: Option<u64>) -> [f32; 3] {
        if let Some(&(value, _)) = position.iter().find(|(_, near)| !near.is_finite()) {
            self.0.push(Vertex { index, line, value });
            return [0.0; 3];
        }
        position.map(|(_, near)| near)
    }

    /// Puts the lost vertices where the first other one lies, so that the extent of the mesh stays, and gives
    /// the note.
    ///
    /// # Errors
    ///
    /// If a triangle has such a vertex.
    pub(super) fn settle(
        &self,
        format: Format,
        positions: &mut [[f32; 3]],
        triangles: &[[u32; 3]],
    ) -> Result<Option<String>, ReadError> {
        let Some(first) = self.0.first() else { return Ok(None) };
        // As the file counts.
        let from = u64::from(format == Format::Obj);
        let mut used = vec![false; positions.len()];
        triangles.as_flattened().iter().for_each(|&vertex| used[vertex as usize] = true);
        if let Some(vertex) = self.0.iter().find(|vertex| used[vertex.index as usize]) {
            let Vertex { index, line, value } = vertex;
            let place = line.map_or_else(|| Place::Item(format!("vertex {index}")), Place::Line);
            let number = index + from;
            let problem = format!(
                "a face has vertex {number}, whose coordinate {value:e} is not a finite number of 32 bits"
            );
            return Err(ReadError::new(format, place, problem));
        }
        // They came in the order of the file.
        let gap = self.0.iter().zip(0..).find(|(vertex, index)| vertex.index != *index);
        let sound = gap.map_or(self.0.len(), |(_, index)| index as usize);
        let position = positions.get(sound).copied().unwrap_or_default();
        self.0.iter().for_each(|vertex| positions[vertex.index as usize] = position);
        let on = first.line.map_or_else(String::new, |line| format!(" on line {line}"));
        let vertices = counted(self.0.len() as u64, "vertex");
        let put = "of no face without a finite position put where another one lies";
        Ok(Some(format!("{vertices} {put}, the first is vertex {}{on}", first.index + from)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lost_vertices_go_where_a_sound_one_lies_unless_a_face_has_them() {
        let mut lost = Lost::default();
        let file = [[f64::NAN, 0.0, 0.0], [1.0, 2.0, 3.0], [0.0, 1e39, 0.0], [4.0; 3], [5.0; 3]];
        let mut positions: Vec<_> = (0..).zip(file).map(|(i, p)| lost.position(i, p, Some(10 + i))).collect();
        let read = positions.clone();
        let error = lost.settle(Format::Ply, &mut positions, &[[3, 4, 2]]).unwrap_err();
        assert_eq!((error.place, positions.clone()), (Place::Line(12), read));
        assert!(error.problem.contains("vertex 2, whose coordinate 1e39 is not"), "{}", error.problem);
        let note = lost.settle(Format::Ply, &mut positions, &[[1, 3, 4]]).unwrap().unwrap();
        assert_eq!(positions, [[1.0, 2.0, 3.0], [1.0, 2.0, 3.0], [1.0, 2.0, 3.0], [4.0; 3], [5.0; 3]]);
        let of_obj = lost.settle(Format::Obj, &mut positions, &[[1, 3, 4]]).unwrap().unwrap();
        assert!(of_obj.ends_with("vertex 1 on line 10"), "{of_obj}");
        assert!(note.starts_with("2 vertices of no face") && note.ends_with("vertex 0 on line 10"), "{note}");
    }

    #[test]
    fn lost_vertices_alone_stay_at_the_origin() {
        let mut lost = Lost::default();
        let mut positions = vec![lost.position(0, [f64::INFINITY; 3], None)];
        assert!(lost.settle(Format::Off, &mut positions, &[]).unwrap().is_some());
        assert_eq!(positions, [[0.0; 3]]);
        assert_eq!(Lost::default().settle(Format::Off, &mut positions, &[]).unwrap(), None);
    }
}
