use super::magnitude::percentile_and_max;
use super::*;
use crate::caster::{Caster, CasterGroup};
use crate::geom::Light;
use crate::mesh::Mesh;
use crate::scene::Lamp;
use crate::shadow::{Samples, Technique};
use crate::testing::shapes;
use crate::view::{Camera, Size, Up};

/// Scene: a plate over a floor, seen from above at an angle.
fn scene() -> Caster {
    let floor = shapes::scaled(&shapes::sheet(1), 8.0);
    let plate = shapes::translated(&shapes::scaled(&shapes::sheet(1), 2.0), [3.0, 3.0, 2.0]);
    Caster::new(Mesh::concat(&[floor, plate]).unwrap())
}

fn with_request<T>(caster: &Caster, light: &Light, work: impl FnOnce(&Request<'_>) -> T) -> T {
    let casters = CasterGroup::new(vec![caster]);
    let size = Size::new(96, 72).unwrap();
    let camera = Camera::look_at([4.0, -6.0, 9.0], [4.0, 4.0, 0.0], 0.9, Up::Z).unwrap();
    let projection = camera.projection(size, 0.125);
    let samples = Samples::of_view(&casters, &projection, size, 1).unwrap();
    let lamp = (*light).into();
    work(&Request { casters: &casters, lamp: &lamp, samples: &samples })
}

#[test]
fn errors_of_exact_rays_are_none_and_one_flipped_sample_breaks_the_claim() {
    let light = Light::directional([0.2, 0.1, -1.0]).unwrap();
    with_request(&scene(), &light, |request| {
        let truth = Truth::of(request);
        let rays = Technique::Rays.shade(request).unwrap();
        let errors = Errors::of(request, &rays, &truth, &Made::default());
        assert!(errors.hold(Claim::Exact) && errors.judged > 1000, "{errors:?}");
        let lit = rays.values().iter().position(|&value| value == 1.0).unwrap();
        let dark = (0..rays.values().len()).find(|&i| rays.asked()[i] && rays.values()[i] == 0.0).unwrap();
        for (at, value, kind) in [(lit, 0.0, [1, 0]), (dark, 1.0, [0, 1])] {
            let mut values = rays.values().to_vec();
            values[at] = value;
            let spoiled = Visibility::from_values(request.samples, &light, values, Claim::Exact);
            let errors = Errors::of(request, &spoiled, &truth, &Made::default());
            assert!(!errors.hold(Claim::Exact) && !errors.hold(Claim::WithinFootprint));
            assert_eq!([errors.acne, errors.leak], kind);
            assert!(errors.hold(Claim::Bounded(0.01)) && !errors.hold(Claim::Bounded(1e-7)));
            // A sample within the footprint is not judged.
            let mut footprint = vec![false; request.samples.len()];
            footprint[at] = true;
            let made = Made { footprint: &footprint, ..Made::default() };
            assert!(Errors::of(request, &spoiled, &truth, &made).hold(Claim::WithinFootprint));
        }
        // Negative test: a sample that turns from the light must have the value 0.
        let away = Light::directional([0.0, 0.0, 1.0]).unwrap().into();
        let turned = Request { lamp: &away, ..*request };
        let truth = Truth::of(&turned);
        assert!(!Errors::of(&turned, &rays, &truth, &Made::default()).hold(Claim::Approximate));
    });
}

/// A lamp above the plate, so large that the whole floor lies in its penumbra; the fractions are made up.
#[test]
fn errors_of_soft_shadows_are_magnitudes_and_those_of_hard_ones_are_both() {
    let caster = scene();
    let casters = CasterGroup::new(vec![&caster]);
    let size = Size::new(96, 72).unwrap();
    let camera = Camera::look_at([4.0, -6.0, 9.0], [4.0, 4.0, 0.0], 0.9, Up::Z).unwrap();
    let samples = Samples::of_view(&casters, &camera.projection(size, 0.125), size, 1).unwrap();
    let lamp: Lamp = "rect:3,3,9:2,0,0:0,2,0".parse().unwrap();
    let request = Request { casters: &casters, lamp: &lamp, samples: &samples };
    let fraction = |i: usize| [0.0, 0.25, 1.0, 0.75][i % 4];
    let bound = 1e-12;
    let fractions = (0..samples.len()).map(|i| Fraction { visible: fraction(i), bound }).collect();
    let truth = Truth::of(&request).with_fractions(fractions);
    let soft = Made { is_soft: true, ..Made::default() };
    let visibility = |off: f32| {
        let values = (0..samples.len()).map(|i| (fraction(i) as f32 + off).clamp(0.0, 1.0)).collect();
        Visibility::from_values(&samples, lamp.light(), values, Claim::Exact)
    };
    let errors = Errors::of(&request, &visibility(0.0), &truth, &soft);
    assert!(errors.hold(Claim::Exact) && errors.mean == 0.0 && errors.judged > 1000, "{errors:?}");
    assert_eq!((errors.penumbra_mean, errors.wrong), (Some(0.0), 0));

    // Fault injected: 1/8 too much light, cut at 1: none of it where all of the lamp is seen.
    let errors = Errors::of(&request, &visibility(0.125), &truth, &soft);
    assert!(!errors.hold(Claim::Exact) && errors.wrong == 0, "{errors:?}");
    assert!(errors.hold(Claim::Bounded(0.1)) && !errors.hold(Claim::Bounded(0.09)), "{errors:?}");
    assert!((errors.mean - 0.09375).abs() < 1e-3 && errors.mean == errors.mean_signed, "{errors:?}");
    assert_eq!((errors.penumbra_mean, errors.max), (Some(0.125), 0.125));
    // A value off by a single unit in the last place, where the truth is ¾.
    let errors = Errors::of(&request, &visibility(0.75_f32.next_up() - 0.75), &truth, &soft);
    assert!(!errors.hold(Claim::Exact) && errors.off > 200, "{errors:?}");

    // Hard shadows: right by the center, and off by what softness they lack.
    let rays = Technique::Rays.shade(&request).unwrap();
    let errors = Errors::of(&request, &rays, &truth, &Made::default());
    assert!(errors.hold(Claim::Exact) && errors.wrong == 0 && errors.mean > 0.2, "{errors:?}");
}

#[test]
fn errors_at_the_boundary_are_aliasing_and_those_away_from_it_are_not() {
    let (light, moved) = ([0.2, 0.1, -1.0], [0.35, 0.1, -1.0]);
    let [light, moved] = [light, moved].map(|travel| Light::directional(travel).unwrap());
    with_request(&scene(), &light, |request| {
        let truth = Truth::of(request);
        // The shadow of a slightly displaced light is wrong in stripes 0.3 wide along the shadow's
        // boundary.
        let off = Technique::Rays.shade(&Request { lamp: &moved.into(), ..*request }).unwrap();
        let errors =
            |texel| Errors::of(request, &off, &truth, &Made { texel: Some(texel), ..Made::default() });
        let found = errors(0.3);
        assert!(found.alias_dark > 5 && found.alias_lit > 5, "{found:?}");
        assert_eq!([found.acne, found.leak], [0, 0], "{found:?}");
        assert_eq!(found.wrong, found.alias_dark + found.alias_lit);
        // Texels far smaller than the stripes explain few of the errors.
        let fine = errors(0.003);
        assert!(fine.acne + fine.leak > found.wrong / 2, "{fine:?}");
        // With values 0 and 1 the mean error is the fraction of wrong samples. The signed mean is
        // positive if shadow is missing, negative if light is missing.
        assert!((found.mean - found.wrong as f64 / found.judged as f64).abs() < f64::EPSILON);
        let lit = Errors::of(request, &Technique::None.shade(request).unwrap(), &truth, &Made::default());
        let dark = Errors::of(request, &Technique::Dark.shade(request).unwrap(), &truth, &Made::default());
        assert!(lit.mean_signed > 0.0 && dark.mean_signed < 0.0);
        assert_eq!(lit.wrong + dark.wrong, lit.judged);
    });
}

#[test]
fn percentile_of_a_hundred_leaves_one_out() {
    let mut values: Vec<f32> = (0..100).map(|i| i as f32).rev().collect();
    assert_eq!(percentile_and_max(&mut values), (98.0, 99.0));
    assert_eq!(percentile_and_max(&mut [3.0]), (3.0, 3.0));
    assert_eq!(percentile_and_max(&mut []), (0.0, 0.0));
}
