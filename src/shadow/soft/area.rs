//! The analytic fraction of the lamp that each sample sees.

use crate::caster::CasterGroup;
use crate::geom::Light;
use crate::oracle::area::{AreaLight, Receiver, SoftOracle, Visible};
use crate::oracle::{Oracle, Verdict};
use crate::scene::Lamp;
use crate::shadow::{Claim, LampShadow, Samples, Visibility, is_front_lit};

/// The lamp's surface and the ray cast over all casters, with their welded corners.
#[derive(Debug)]
pub(in crate::shadow) struct LampArea<'a> {
    oracle: &'a Oracle,
    light: Light,
    soft: Option<(SoftOracle<'a>, AreaLight)>,
}

impl<'a> LampArea<'a> {
    pub(in crate::shadow) fn prepare(casters: &'a CasterGroup<'a>, lamp: &Lamp) -> Self {
        let oracle = casters.oracle();
        // A lamp whose numbers span no area is its center.
        let area = AreaLight::of_lamp(lamp).ok().flatten();
        let soft = area.map(|area| (SoftOracle::new(oracle), area));
        Self { oracle, light: *lamp.light(), soft }
    }

    fn fractions(&self, points: &[(usize, [f32; 3])]) -> Vec<Option<Visible>> {
        let mut found = vec![None; points.len()];
        if let Some((soft, area)) = &self.soft {
            let receivers: Vec<Receiver> = points.iter().map(|&(_, p)| p.into()).collect();
            soft.visible_into(&receivers, area, &mut found);
        }
        found
    }
}

impl LampShadow for LampArea<'_> {
    /// The fraction at every front-lit sample, exact within [`Visible::bound`] and the rounding to `f32`. A
    /// lamp without extent, or of which nothing can be told, is its center; a grazing ray counts as lit.
    fn shade(&self, samples: &Samples) -> Visibility {
        let points = front_lit(samples, &self.light);
        let found = self.fractions(&points);
        let center = |p| f32::from(u8::from(self.oracle.verdict(p, &self.light) != Verdict::Shadowed));
        let mut values = vec![0.0; samples.len()];
        for (&(index, p), found) in points.iter().zip(found) {
            values[index] = found.map_or_else(|| center(p), |seen| seen.fraction as f32);
        }
        Visibility::from_values(samples, &self.light, values, Claim::Exact)
    }

    fn bytes(&self) -> usize {
        self.soft.as_ref().map_or(0, |(soft, _)| soft.bytes())
    }
}

/// The samples that face the lamp's center: index and point.
fn front_lit(samples: &Samples, light: &Light) -> Vec<(usize, [f32; 3])> {
    let hits = samples.hits().iter().enumerate();
    hits.filter_map(|(index, hit)| {
        hit.as_ref().filter(|hit| is_front_lit(hit, light)).map(|hit| (index, hit.point))
    })
    .collect()
}

#[cfg(test)]
mod tests {
    use crate::caster::{Caster, CasterGroup};
    use crate::mesh::Mesh;
    use crate::scene::Lamp;
    use crate::shadow::{Request, Samples, Technique};
    use crate::testing::shapes;
    use crate::view::{Camera, Size, Up};

    /// A floor z = 0 under the half-plane x ≤ 0 at height 2, below a square lamp of half-size 1 at height 4:
    /// the visible fraction at (x, y, 0) is ½ + x/2 for |x| ≤ 1.
    #[test]
    fn area_of_a_half_plane_is_linear_in_the_penumbra() {
        let floor = shapes::translated(&shapes::scaled(&shapes::sheet(1), 4.0), [-2.0, -2.0, 0.0]);
        let plate = shapes::translated(&shapes::scaled(&shapes::sheet(1), 64.0), [-64.0, -32.0, 2.0]);
        let casters = [Caster::new(Mesh::concat(&[floor, plate]).unwrap())];
        let casters = CasterGroup::new(casters.iter().collect());
        let size = Size::new(64, 48).unwrap();
        let camera = Camera::look_at([0.2, -1.0, 1.5], [0.2, 0.0, 0.0], 0.9, Up::Z).unwrap();
        let samples = Samples::of_view(&casters, &camera.projection(size, 0.125), size, 1).unwrap();
        let lamp: Lamp = "rect:-1,-1,4:2,0,0:0,2,0".parse().unwrap();
        let request = Request { casters: &casters, lamp: &lamp, samples: &samples };
        let found = Technique::Area.shade(&request).unwrap();
        let mut within = 0;
        for (hit, &value) in samples.hits().iter().zip(found.values()) {
            let Some(hit) = hit else { continue };
            let [x, _, z] = hit.point.map(f64::from);
            assert!(hit.corners.iter().all(|corner| corner[2] == 0.0), "only the floor is seen");
            // The visible point lies above the floor, not on it: the plate is nearer by as much.
            let expected = (0.5 + x / (2.0 - z)).clamp(0.0, 1.0);
            assert!((f64::from(value) - expected).abs() < f64::from(f32::EPSILON), "{value} at {x}");
            within += usize::from(value > 0.0 && value < 1.0);
        }
        assert!(within > 1000, "{within}");
    }
}
