//! Exact shadow rays to points of the lamp, where something cheaper is not sure: the technique `soft-hybrid`.
//!
//! What is sure is fully lit or fully dark. What errs beyond the rays themselves are occluders that fall
//! between the texels of the map, and with `certain=rays` penumbrae that the first rays miss.

use super::light_map::{LightMap, Receiver};
use super::window::Window;
use super::{Certain, SoftHybridOptions, Taps};
use crate::caster::CasterGroup;
use crate::geom::Light;
use crate::oracle::{Oracle, PrimaryHit, Verdict};
use crate::random::r2;
use crate::scene::Lamp;
use crate::shadow::LampShadow;
use crate::shadow::map::{MapError, unit_normal, wide};
use crate::shadow::{Answer, Claim, Samples, Visibility};

/// Rays that have to agree with `certain=rays`.
const FIRST: usize = 9;

#[derive(Debug)]
struct SoftHybrid<'a> {
    map: LightMap<'a>,
    oracle: &'a Oracle,
    certain: Certain,
    /// The light points, in the unit square.
    points: Vec<[f64; 2]>,
}

pub(in crate::shadow) fn soft_hybrid<'a>(
    casters: &'a CasterGroup<'a>,
    lamp: &Lamp,
    options: SoftHybridOptions,
) -> Result<Box<dyn LampShadow + 'a>, MapError> {
    // Without a map to ask, one texel does.
    let size = if options.certain == Certain::Rays { 1 } else { options.size };
    let map = LightMap::prepare(casters, lamp, size)?;
    let n = if lamp.has_extent() { options.rays.max(1) } else { 1 };
    let points = (0..n).map(r2).collect();
    Ok(Box::new(SoftHybrid { map, oracle: casters.oracle(), certain: options.certain, points }))
}

impl SoftHybrid<'_> {
    fn answer(&self, hit: &PrimaryHit) -> Answer {
        if self.certain == Certain::Rays {
            return self.after_first_rays(hit);
        }
        let receiver = self.map.receiver_beside(hit).filter(|receiver| receiver.is_sound());
        let is_split = is_split(&self.map.lamp, hit);
        let Some(mut receiver) = receiver.filter(|_| !is_split) else {
            return Answer { is_exact: true, ..self.by_rays(hit, 0, 0) };
        };
        let sure = match self.certain {
            Certain::Pcss => {
                Some(receiver.filtered(Taps::All, Taps::All)).filter(|&lit| lit == 0.0 || lit == 1.0)
            }
            _ => receiver.agreed(),
        };
        let reads = receiver.reads;
        match sure {
            Some(lit) => Answer { reads, ..Answer::of(lit as f32) },
            None => Answer { reads, is_exact: true, ..self.by_rays(hit, 0, 0) },
        }
    }

    fn after_first_rays(&self, hit: &PrimaryHit) -> Answer {
        let first = FIRST.min(self.points.len());
        let lit = self.lit(hit, 0, first);
        match lit {
            _ if first == self.points.len() => self.by_rays(hit, lit, first),
            0 => Answer::of(0.0),
            _ if lit == first => Answer::of(1.0),
            _ => Answer { is_exact: true, ..self.by_rays(hit, lit, first) },
        }
    }

    /// The mean of all rays, of which some are known.
    fn by_rays(&self, hit: &PrimaryHit, lit: usize, known: usize) -> Answer {
        let all = self.points.len();
        Answer::of((lit + self.lit(hit, known, all)) as f32 / all as f32)
    }

    /// How many of some rays reach the lamp. A grazing one does.
    fn lit(&self, hit: &PrimaryHit, from: usize, to: usize) -> usize {
        let reaches = |light: &Light| self.oracle.verdict(hit.point, light) != Verdict::Shadowed;
        match self.map.lamp.patch(hit.point) {
            None => {
                if from < to && reaches(self.map.lamp.light()) {
                    to - from
                } else {
                    0
                }
            }
            Some(patch) => self.points[from..to].iter().filter(|&&uv| reaches(&patch.light(uv))).count(),
        }
    }
}

/// Whether the plane of a face may pass through the lamp, so that a part of it lies below the horizon.
fn is_split(lamp: &Lamp, hit: &PrimaryHit) -> bool {
    let (Some(patch), Some(normal)) = (lamp.patch(hit.point), unit_normal(hit.corners)) else { return false };
    let toward = if patch.is_directional { patch.center } else { patch.center - wide(hit.point) };
    normal.dot(toward).abs() <= normal.dot(patch.across).abs() + normal.dot(patch.along).abs()
}

impl Receiver<'_> {
    /// 0 or 1 where all texels that may hide the lamp agree. A window that is not read as a whole decides
    /// nothing.
    fn agreed(&mut self) -> Option<f64> {
        let half = self.search(self.k_box);
        let window = Window { at: self.at, half, is_round: false };
        let is_beyond = window.is_beyond(self.limits());
        if is_beyond && !self.map.shows_all_casters() || !window.is_whole() {
            return None;
        }
        // Beside a map that shows all casters nothing blocks.
        let (mut blocked, mut open) = (false, is_beyond);
        window.for_each_texel(self.limits(), |i, j, _| {
            // Two that differ are enough.
            if !(blocked && open) {
                match self.blocker(i, j) {
                    Some(_) => blocked = true,
                    None => open = true,
                }
            }
        });
        match (blocked, open) {
            (true, false) => Some(0.0),
            (false, true) => Some(1.0),
            _ => None,
        }
    }
}

impl LampShadow for SoftHybrid<'_> {
    fn shade(&self, samples: &Samples) -> Visibility {
        Visibility::of(samples, self.map.lamp.light(), Claim::Approximate, |hit| self.answer(hit))
    }

    fn bytes(&self) -> usize {
        self.map.bytes() + size_of_val(&*self.points)
    }

    fn texel_world(&self) -> Option<f64> {
        Some(self.map.texel_world())
    }

    fn bias_world(&self) -> Option<f64> {
        Some(self.map.bias_world())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::caster::Caster;
    use crate::mesh::Mesh;
    use crate::shadow::{Request, Technique};
    use crate::testing::shapes;
    use crate::view::{Camera, Size, Up};

    #[test]
    fn soft_hybrid_equals_its_rays_but_between_texels_and_asks_few() {
        let sheet = shapes::translated(&shapes::scaled(&shapes::sheet(3), 2.0), [-3.0, -3.0, -1.5]);
        let knot = Mesh::concat(&[shapes::torus_knot(2, 3, 60, 9, 0.4), sheet.clone()]).unwrap();
        let sponge = Mesh::concat(&[shapes::menger_sponge(1), sheet]).unwrap();
        for mesh in [knot, sponge] {
            let caster = Caster::new(mesh);
            let casters = CasterGroup::new(vec![&caster]);
            let size = Size::new(32, 24).unwrap();
            let camera = Camera::fit(&casters.bounds(), Up::Z, size.aspect());
            let samples = Samples::of_view(&casters, &camera.projection(size, 0.125), size, 1).unwrap();
            for lamp in
                ["directional:0.3,0.2,-1,angle=12", "rect:-1,-1,6:2,0,0:0,2,0", "point:3,4,6,radius=1"]
            {
                let lamp: Lamp = lamp.parse().unwrap();
                let request = Request { casters: &casters, lamp: &lamp, samples: &samples };
                let of = |technique: &str| technique.parse::<Technique>().unwrap().shade(&request).unwrap();
                let rays = of("samples:n=16");
                let asked = rays.asked().iter().filter(|asked| **asked).count() as u64;
                for (certain, least, most) in [("texels", 0, 3), ("pcss", 0, 12), ("rays", 0, 8)] {
                    let found = of(&format!("soft-hybrid:size=512,rays=16,certain={certain}"));
                    let pairs = rays.values().iter().zip(found.values());
                    let off = pairs.filter(|(a, b)| a != b).count() as u64;
                    assert!(off * 100 <= asked * most, "{lamp} {certain}: {off} of {asked}");
                    let share = found.asked_exactly() as f64 / asked as f64;
                    assert!(share > f64::from(least) && share < 0.96, "{lamp} {certain}: {share}");
                    assert_eq!(found.reads() == 0, certain == "rays");
                }
                // The sabotage: a certainty of one texel.
                let careless = of("pcss:size=512,blockers=1,taps=1");
                let off = careless.values().iter().zip(rays.values()).filter(|(a, b)| a != b).count() as u64;
                assert!(off * 100 > asked * 4, "{lamp} {off} of {asked}");
            }
        }
    }

    /// A wide floor casts nothing: the map of the knot ends on it. Beside that of a sun nothing casts a
    /// shadow; beside that of a spot something may.
    #[test]
    fn soft_hybrid_asks_little_beside_the_map_of_a_sun() {
        let floor = shapes::translated(&shapes::scaled(&shapes::sheet(1), 24.0), [-12.0, -12.0, -3.0]);
        for mesh in [shapes::torus_knot(2, 3, 60, 9, 0.4), shapes::torus(24, 12, 2.0, 0.7)] {
            let all = Caster::new(Mesh::concat(&[mesh.clone(), floor.clone()]).unwrap());
            let caster = Caster::new(mesh);
            let casters = CasterGroup::new(vec![&caster]).seen_with(&all);
            let size = Size::new(48, 36).unwrap();
            let camera = Camera::fit(&casters.bounds(), Up::Z, size.aspect());
            let samples = Samples::of_view(&casters, &camera.projection(size, 0.125), size, 1).unwrap();
            let share = |lamp: &str| {
                let lamp: Lamp = lamp.parse().unwrap();
                let request = Request { casters: &casters, lamp: &lamp, samples: &samples };
                let of = |technique: &str| technique.parse::<Technique>().unwrap().shade(&request).unwrap();
                let (rays, found) = (of("samples:n=16"), of("soft-hybrid:size=512,rays=16"));
                let asked = rays.asked().iter().filter(|asked| **asked).count() as u64;
                let off = rays.values().iter().zip(found.values()).filter(|(a, b)| a != b).count() as u64;
                assert!(off * 100 <= asked * 3 && asked > 250, "{lamp:?} {off} of {asked}");
                found.asked_exactly() as f64 / asked as f64
            };
            // A low sun, whose shadow lies on the floor beside the caster, and a spot that is as wide.
            let [sun, spot] = ["directional:1,0.3,-1,angle=3", "spot:0,0,9:0,0,-1:20,radius=0.5"].map(share);
            assert!(sun > 0.0 && sun < 0.5 && spot > sun, "{sun} {spot}");
        }
    }
}
