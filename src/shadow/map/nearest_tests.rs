//! Tests of the rule of four texels.

use crate::caster::{Caster, CasterGroup};
use crate::mesh::Mesh;
use crate::scene::Lamp;
use crate::shadow::{Request, Samples, Technique};
use crate::testing::shapes;
use crate::verify::errors::{Errors, Made, Truth};
use crate::view::{Camera, Size, Up};

/// Thin casters over a floor: their shadows fall between the centers of the texels.
fn scenes() -> [Mesh; 2] {
    let floor = shapes::cuboid([-6.0, -1.0, -6.0], [6.0, 0.0, 6.0]);
    let blade = |x: f32| shapes::cuboid([x, 1.5, -4.0], [x + 0.04, 1.54, 4.0]);
    let wire = shapes::translated(&shapes::torus(40, 5, 2.5, 0.02), [0.3, 2.0, 0.2]);
    [
        Mesh::concat(&[floor.clone(), blade(-2.07), blade(0.11), blade(1.93)]).unwrap(),
        Mesh::concat(&[floor, wire]).unwrap(),
    ]
}

/// The exact form of the same idea is right wherever this one errs, and most errors are shadows that are
/// lost. Most samples need no ray.
#[test]
fn hybrid_2x2_misses_thin_casters_where_the_light_grid_is_right() {
    let size = Size::new(80, 60).unwrap();
    for mesh in scenes() {
        let caster = Caster::new(mesh);
        let casters = CasterGroup::new(vec![&caster]);
        let mut lost = 0;
        let camera = Camera::look_at([3.0, 9.0, 10.0], [0.0; 3], 0.8, Up::Y).unwrap();
        let samples = Samples::of_view(&casters, &camera.projection(size, 0.5), size, 1).unwrap();
        for lamp in ["point:1,9,2", "directional:0.2,-1,0.3"] {
            let lamp: Lamp = lamp.parse().unwrap();
            let request = Request { casters: &casters, lamp: &lamp, samples: &samples };
            let truth = Truth::of(&request);
            let found = |text: &str| {
                let visibility = text.parse::<Technique>().unwrap().shade(&request).unwrap();
                let errors = Errors::of(&request, &visibility, &truth, &Made::default());
                (errors, visibility.asked_exactly())
            };
            let [(coarse, _), (fine, rays)] = ["hybrid-2x2:size=32", "hybrid-2x2:size=1024"].map(found);
            assert!(coarse.leak > 3 * coarse.acne, "{lamp}: {coarse:?}");
            lost += coarse.leak;
            assert!(0 < rays && rays * 2 < fine.judged, "{lamp}: {rays} rays");
            assert!(fine.wrong * 2 < coarse.wrong, "{lamp}: {fine:?}");
            for exact in ["hybrid", "hybrid:grid=32"] {
                assert_eq!(found(exact).0.wrong, 0, "{exact} {lamp}");
            }
        }
        assert!(lost > 10, "{lost}");
    }
}
