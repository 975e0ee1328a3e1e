//! Openness of single points, for pictures.

use super::lattice::Lattice;
use super::rays::sample;
use super::start::Start;
use super::{MOST_RAYS, Reach, Receiver, Receivers};
use crate::oracle::Oracle;

/// Rays from points that are not known before they are asked about: those that a picture shows.
///
/// ```
/// use umbrage::ambient::PointRays;
/// use umbrage::oracle::Oracle;
/// use umbrage::testing::shapes;
/// let (rays, oracle) = (PointRays::new(64), Oracle::build(&shapes::cube()));
/// // Nothing stands above the top of a cube; beside its foot it hides half of the sky, or nearly.
/// assert_eq!(rays.openness(&oracle, [0.2, 1.0, 0.1], [0.0, 1.0, 0.0]), 1.0);
/// assert!(rays.openness(&oracle, [1.001, -1.0, 0.0], [0.0, 1.0, 0.0]) < 0.7);
/// ```
#[derive(Clone, Debug)]
pub struct PointRays {
    lattice: Lattice,
}

/// The one seed: the same point has the same rays in every picture.
const SEED: u64 = 1;

impl PointRays {
    /// This number of rays from each point, from 1 to [`MOST_RAYS`].
    #[must_use]
    pub fn new(rays: u32) -> Self {
        Self { lattice: Lattice::new(rays.clamp(1, MOST_RAYS)) }
    }

    /// The share of an even sky that no face of `oracle` hides from a point, weighted by the cosine to
    /// `normal`, which has length 1.
    #[must_use]
    pub fn openness(&self, oracle: &Oracle, point: [f32; 3], normal: [f32; 3]) -> f32 {
        let receiver = Receiver { point, normal: Some(normal), face: None };
        let start = Start::at(oracle, &Receivers { list: vec![receiver], ..Receivers::default() }, 0);
        sample(oracle, &receiver, &start, &self.lattice, SEED, Reach::Unlimited).openness
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::Mesh;
    use crate::testing::shapes;

    /// A pit 2 × 2 and 2 deep, without a lid, its floor at y = 0.
    fn pit() -> Mesh {
        let [low, high] = [0.0, 2.0];
        let corner = |x: f32, y: f32, z: f32| [x - 1.0, y, z - 1.0];
        let positions = [low, high]
            .into_iter()
            .flat_map(|y| {
                [corner(low, y, low), corner(high, y, low), corner(high, y, high), corner(low, y, high)]
            })
            .collect();
        let wall = |a: u32| [[a, (a + 1) % 4, a + 4], [(a + 1) % 4, (a + 1) % 4 + 4, a + 4]];
        let walls = (0..4).flat_map(wall);
        Mesh::new(positions, [[0, 2, 1], [0, 3, 2]].into_iter().chain(walls).collect()).unwrap()
    }

    #[test]
    fn point_in_the_middle_of_a_pit_sees_what_the_closed_form_says() {
        let oracle = Oracle::build(&pit());
        let (middle, up) = ([0.0; 3], [0.0, 1.0, 0.0]);
        let truth = 0.239_456_470_461;
        for rays in [64, 1024, 16384] {
            let error = f64::from(PointRays::new(rays).openness(&oracle, middle, up)) - truth;
            assert!(error.abs() < 3.0 * 0.4 * f64::from(rays).powf(-0.75), "{rays}: {error}");
        }
        // Beside the middle less is open, and the pit is no box without walls.
        assert!(PointRays::new(1024).openness(&oracle, [0.9, 0.0, 0.9], up) < 0.2);
        let open = Oracle::build(&shapes::sheet(1));
        assert_eq!(PointRays::new(64).openness(&open, [0.0, 5.0, 0.0], up), 1.0);
    }
}
