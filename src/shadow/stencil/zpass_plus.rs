//! z-pass that starts with the count at the near rectangle: the technique `zpass-plus`.
//!
//! z-pass counts what lies between the near plane and the visible point, and so lacks the volumes that the
//! near plane is already in. Their number is that of the casting faces between the near plane and the light.
//! (Samuel Hornus, Jared Hoberock, Sylvain Lefebvre, John C. Hart, *ZP+: Correct Z-pass Stencil Shadows*, I3D
//! 2005.)
//!
//! A device counts the faces by drawing them from the light onto the near rectangle, and the sides from the
//! eye. The two projections round the same line differently, so a band one pixel wide is wrong where sides
//! cut the rectangle. (Baran Usta, Leonardo Scandolo, Markus Billeter, Ricardo Marroquim, Elmar Eisemann, *A
//! Practical and Efficient Approach for Correct Z-Pass Stencil Shadow Volumes*, HPG 2019.) Here both counts
//! are exact and about the same rounded point, and there is no band.

use super::{StencilCounting, StencilMethod};
use crate::caster::CasterGroup;
use crate::geom::Light;
use crate::oracle::Intersection;
use crate::shadow::{Claim, LampShadow, Samples, Visibility};

/// z-pass counting, and the exact ray cast for the counts at the near plane.
#[derive(Debug)]
pub(in crate::shadow) struct ZPassPlus<'a> {
    casters: &'a CasterGroup<'a>,
    light: Light,
    counting: StencilCounting<'a>,
    /// Whether each face casts, numbered as in the ray cast.
    casts: Vec<bool>,
}

impl<'a> ZPassPlus<'a> {
    pub(in crate::shadow) fn prepare(casters: &'a CasterGroup<'a>, light: &Light) -> Self {
        let counting = StencilCounting::prepare(casters, light, Some(StencilMethod::ZPass));
        let casts = counting.signs().flatten().map(|&sign| sign != 0).collect();
        Self { casters, light: *light, counting, casts }
    }

    /// Number of casting faces between a point and the light; `None` if the segment touches one of them.
    fn start(&self, near: [f32; 3]) -> Option<i32> {
        let mut count = Some(0);
        self.casters.oracle().for_each_meeting(near, &self.light, |face, meeting| {
            if self.casts[face.index()] {
                let is_crossing = matches!(meeting, Intersection::Crossing(_));
                count = count.filter(|_| is_crossing).map(|count| count + 1);
            }
        });
        count
    }
}

impl LampShadow for ZPassPlus<'_> {
    fn shade(&self, samples: &Samples) -> Visibility {
        self.counting.shade_from(samples, Claim::Exact, |near| self.start(near))
    }

    fn bytes(&self) -> usize {
        self.counting.bytes() + self.casts.len()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::caster::Caster;
    use crate::scene::Lamp;
    use crate::shadow::{Request, Technique};
    use crate::testing::shapes;
    use crate::view::{Camera, Size, Up};

    /// Scenes with the eye in one shadow, in two, and with the near rectangle cut by the sides of a volume.
    /// Half of the faces of the closed casters cast, and all of the open one.
    #[test]
    fn zpass_plus_equals_zfail_with_the_eye_in_a_shadow() {
        let floor = |y: f32| shapes::cuboid([-9.0, y - 1.0, -9.0], [9.0, y, 9.0]);
        let sheet = shapes::translated(&shapes::scaled(&shapes::sheet(3), 1.5), [-0.7, 3.1, 0.4]);
        let scenes = [
            vec![floor(-2.0), shapes::torus(16, 9, 2.0, 0.7)],
            vec![floor(-3.0), shapes::figure_eight_prism(), sheet],
            vec![floor(-2.5), shapes::nested_cubes(2)],
        ];
        let size = Size::new(40, 30).unwrap();
        let (mut different, mut started) = ([0; 2], 0);
        for meshes in scenes {
            let all: Vec<Caster> = meshes.into_iter().map(Caster::new).collect();
            let casters = CasterGroup::new(all.iter().collect());
            for (eye, near) in [([1.9, -1.4, 0.3], 0.02), ([0.4, -1.3, 0.2], 0.3), ([-2.1, -1.2, 0.1], 1.5)] {
                let camera = Camera::look_at(eye, [0.3, -3.0, -4.0], 1.1, Up::Y).unwrap();
                let samples = Samples::of_view(&casters, &camera.projection(size, near), size, 1).unwrap();
                for lamp in ["point:0.5,9,0.3", "directional:-0.1,-1,0.05"] {
                    let lamp: Lamp = lamp.parse().unwrap();
                    let request = Request { casters: &casters, lamp: &lamp, samples: &samples };
                    let zfail = Technique::ZFail.shade(&request).unwrap();
                    let shadow = ZPassPlus::prepare(&casters, lamp.light());
                    let differ = |other: &Visibility| {
                        let pairs = zfail.values().iter().zip(other.values());
                        pairs.filter(|(a, b)| a != b).count()
                    };
                    different[0] += differ(&shadow.shade(&samples));
                    // Fault injected: every count starts at 0.
                    different[1] += differ(&shadow.counting.shade_from(&samples, Claim::Exact, |_| Some(0)));
                    started += usize::from(shadow.start(eye).is_some_and(|count| count > 0));
                }
            }
        }
        assert!(different[0] == 0 && different[1] > 2000 && started > 6, "{different:?} {started}");
    }
}
