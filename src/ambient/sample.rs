//! Some receivers out of many.

use super::Receivers;
use crate::mesh::FaceId;

#[cfg(any(test, feature = "verify"))]
impl Receivers {
    /// `count` of the receivers, evenly spaced in their order; all if there are fewer.
    pub(crate) fn spread(&self, count: usize) -> Vec<u32> {
        let (all, count) = (self.list.len(), count.min(self.list.len()));
        (0..count).map(|i| (i as u64 * all as u64 / count as u64) as u32).collect()
    }

    /// The chosen receivers, ascending. Faces keep their numbers; a corner of another receiver takes one of
    /// the same face.
    pub(crate) fn only(&self, chosen: &[u32]) -> Self {
        let mut number = vec![UNUSED; self.list.len()];
        for (new, &old) in (0..).zip(chosen) {
            number[old as usize] = new;
        }
        let renamed = |face: &[u32; 3]| {
            let new = face.map(|corner| number[corner as usize]);
            let some = new.into_iter().find(|&corner| corner != UNUSED).unwrap_or(UNUSED);
            new.map(|corner| if corner == UNUSED { some } else { corner })
        };
        let at = |&index: &u32| index as usize;
        Self {
            list: chosen.iter().map(|index| self.list[at(index)]).collect(),
            corners: self.corners.iter().map(renamed).collect(),
            inward: chosen.iter().filter_map(|index| self.inward.get(at(index)).copied()).collect(),
            solids: self.solids.clone(),
        }
    }

    /// The chosen receivers, ascending, with all that share a face with one of them; and the numbers that the
    /// chosen ones have among those.
    pub(crate) fn around(&self, chosen: &[u32]) -> (Self, Vec<u32>) {
        let mut wanted = vec![false; self.list.len()];
        for &index in chosen {
            wanted[index as usize] = true;
        }
        let touches = |face: &&[u32; 3]| face.iter().any(|&corner| wanted[corner as usize]);
        let mut used: Vec<u32> =
            self.corners.iter().filter(touches).flatten().chain(chosen).copied().collect();
        used.sort_unstable();
        used.dedup();
        let places = chosen.iter().filter_map(|index| used.binary_search(index).ok());
        let places = places.map(|place| place as u32).collect(); // no more than receivers
        (self.only(&used), places)
    }
}

impl Receivers {
    /// For each receiver the faces that have it at a corner.
    pub(super) fn faces(&self) -> FacesAt {
        let mut pairs: Vec<(u32, FaceId)> = Vec::with_capacity(3 * self.corners.len());
        for (face, corners) in self.corners.iter().enumerate() {
            pairs.extend(corners.iter().filter(|&&at| at != UNUSED).map(|&at| (at, FaceId::new(face))));
        }
        pairs.sort_unstable();
        pairs.dedup();
        let mut first = vec![0; self.list.len() + 1];
        for &(at, _) in &pairs {
            first[at as usize + 1] += 1;
        }
        for at in 0..self.list.len() {
            first[at + 1] += first[at];
        }
        FacesAt { first, faces: pairs.into_iter().map(|(_, face)| face).collect() }
    }
}

/// Marks a corner without a receiver.
const UNUSED: u32 = u32::MAX;

/// Lists of faces.
pub(super) struct FacesAt {
    first: Vec<usize>,
    faces: Vec<FaceId>,
}

impl FacesAt {
    /// Those of a receiver, ascending.
    pub(super) fn of(&self, receiver: usize) -> &[FaceId] {
        &self.faces[self.first[receiver]..self.first[receiver + 1]]
    }
}

#[cfg(test)]
mod tests {
    use crate::ambient::{Ambient, Effort, Per, RayOptions, Receivers, Ring};
    use crate::oracle::Oracle;
    use crate::testing::shapes;

    #[test]
    fn part_around_some_receivers_gives_them_the_values_of_all() {
        for mesh in [shapes::torus(30, 16, 2.0, 0.9), shapes::menger_sponge(1)] {
            let all = Receivers::of(&[&mesh], Per::Corner);
            let chosen = all.spread(40);
            assert!(chosen.len() == 40 && chosen.windows(2).all(|pair| pair[0] < pair[1]));
            let (part, at) = all.around(&chosen);
            assert!(part.list().len() < all.list().len());
            let oracle = Oracle::build(&mesh);
            let options = RayOptions { effort: Effort::Rays(4), ring: Ring::On, ..RayOptions::default() };
            let openness = |part: &Receivers| Ambient::by_rays(&oracle, part, &options, &|_| {}).0.openness;
            let (known, found) = (openness(&all), openness(&part));
            let values = |list: &[u32], of: &[f32]| list.iter().map(|&i| of[i as usize]).collect::<Vec<_>>();
            assert_eq!(values(&chosen, &known), values(&at, &found));
            // The sabotage: without the neighbors the ring is another one.
            assert_ne!(values(&chosen, &known), openness(&all.only(&chosen)));
        }
    }
}
