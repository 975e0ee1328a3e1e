//! Some receivers out of many.

use super::Receivers;

impl Receivers {
    /// `count` of the receivers, evenly spaced in their order; all if there are fewer.
    pub(crate) fn spread(&self, count: usize) -> Vec<u32> {
        let (all, count) = (self.list.len(), count.min(self.list.len()));
        (0..count).map(|i| (i as u64 * all as u64 / count as u64) as u32).collect()
    }

    /// The chosen receivers, ascending, without faces.
    pub(crate) fn only(&self, chosen: &[u32]) -> Self {
        let list = chosen.iter().map(|&index| self.list[index as usize]).collect();
        Self { list, corners: Vec::new(), sides: self.sides.only(chosen), solids: self.solids.clone() }
    }

    /// The chosen receivers, ascending, with all faces at them and the receivers of these; and the numbers
    /// that the chosen ones have among those.
    pub(crate) fn around(&self, chosen: &[u32]) -> (Self, Vec<u32>) {
        const UNUSED: u32 = u32::MAX;
        let mut wanted = vec![false; self.list.len()];
        for &index in chosen {
            wanted[index as usize] = true;
        }
        let touches = |face: &&[u32; 3]| face.iter().any(|&corner| wanted[corner as usize]);
        let faces: Vec<[u32; 3]> = self.corners.iter().filter(touches).copied().collect();
        let mut used: Vec<u32> = faces.as_flattened().iter().chain(chosen).copied().collect();
        used.sort_unstable();
        used.dedup();
        let mut number = vec![UNUSED; self.list.len()];
        for (new, &old) in (0..).zip(&used) {
            number[old as usize] = new;
        }
        let renamed = |index: u32| number[index as usize];
        let part =
            Self { corners: faces.into_iter().map(|face| face.map(renamed)).collect(), ..self.only(&used) };
        (part, chosen.iter().map(|&index| renamed(index)).collect())
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
