//! Scenes whose visible fraction is known in closed form, and the faults that each of them catches.

use std::f64::consts::PI;

use super::fault::{Fault, Faults};
use super::*;

/// A mesh of quads, each cut into two faces.
pub(super) fn quads(corners: &[[[f32; 3]; 4]]) -> Mesh {
    let positions = corners.as_flattened().to_vec();
    let faces = (0..corners.len() as u32)
        .flat_map(|i| [[4 * i, 4 * i + 1, 4 * i + 2], [4 * i, 4 * i + 2, 4 * i + 3]]);
    Mesh::new(positions, faces.collect()).unwrap()
}

pub(super) fn triangles(corners: &[[[f32; 3]; 3]]) -> Mesh {
    let faces = (0..corners.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    Mesh::new(corners.as_flattened().to_vec(), faces).unwrap()
}

/// The square −1 ..= 1 at height 4.
pub(super) fn square() -> AreaLight {
    AreaLight::parallelogram([-1.0, -1.0, 4.0], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0]).unwrap()
}

const UP: [f32; 3] = [0.0, 0.0, 1.0];

fn seen(mesh: &Mesh, light: &AreaLight, fault: Option<Fault>) -> Visible {
    let mut soft = SoftOracle::build(mesh);
    soft.faults = Faults(fault);
    soft.visible(Receiver::facing([0.0; 3], UP), light).unwrap()
}

/// The answer is right to 1e-13 and within its bound, and with the fault it is wrong by far.
fn holds(mesh: &Mesh, light: &AreaLight, fraction: f64, fault: Option<Fault>) {
    let found = seen(mesh, light, None);
    let off = (found.fraction - fraction).abs();
    assert!(off <= 1e-13 && off <= found.bound && found.bound < 1e-10, "{found:?} is not {fraction}");
    if fault.is_some() {
        let wrong = seen(mesh, light, fault);
        assert!((wrong.fraction - fraction).abs() > 0.04, "{fault:?} is not caught: {wrong:?}");
    }
}

/// The form factor of a rectangle x by y, over its height, with one corner above the receiver.
fn corner(x: f64, y: f64) -> f64 {
    let part = |x: f64, y: f64| x / (1.0 + x * x).sqrt() * (y / (1.0 + x * x).sqrt()).atan();
    (part(x, y) + part(y, x)) / (2.0 * PI)
}

#[test]
fn half_planes_hide_what_lies_on_their_side_and_form_is_the_corner_formula() {
    for t in [-0.375_f32, -0.25, 0.0, 0.125, 0.3, 0.4375] {
        let far = 64.0;
        let left = quads(&[[[-far, -far, 2.0], [t, -far, 2.0], [t, far, 2.0], [-far, far, 2.0]]]);
        let right = quads(&[[[t, -far, 2.0], [far, -far, 2.0], [far, far, 2.0], [t, far, 2.0]]]);
        let t = f64::from(t);
        holds(&left, &square(), 0.5 - t, (t != 0.0).then_some(Fault::NoLeft));
        holds(&right, &square(), 0.5 + t, Some(Fault::NoClosing));
        let form = 2.0 * (corner(0.25, 0.25) - corner(t / 2.0, 0.25));
        let found = seen(&left, &square(), None).form.unwrap();
        assert!((found - form).abs() < 1e-15, "{found} is not {form}");
        // A light that is turned over, or shears, is seen alike.
        for light in [
            AreaLight::parallelogram([1.0, -1.0, 4.0], [-2.0, 0.0, 0.0], [0.0, 2.0, 0.0]).unwrap(),
            AreaLight::parallelogram([1.0, 1.0, 4.0], [0.0, -2.0, 0.0], [-2.0, 0.0, 0.0]).unwrap(),
            AreaLight::polygon(&[[-1.0, -1.0, 4.0], [1.0, -1.0, 4.0], [1.0, 1.0, 4.0], [-1.0, 1.0, 4.0]])
                .unwrap(),
        ] {
            holds(&left, &light, 0.5 - t, None);
            let found = seen(&left, &light, None).form.unwrap();
            assert!((found - form).abs() < 1e-15, "{found} is not {form}");
        }
    }
}

#[test]
fn triangles_are_united_not_added() {
    let middle = [[-0.25, -0.25, 2.0], [0.25, -0.25, 2.0], [-0.25, 0.25, 2.0]];
    let back = [middle[0], middle[2], middle[1]];
    let other = [[0.25, -0.25, 2.0], [0.25, 0.25, 2.0], [-0.25, 0.25, 2.0]];
    let near = middle.map(|x| [x[0], x[1], 1.0]);
    holds(&triangles(&[middle]), &square(), 0.875, None);
    holds(&triangles(&[middle, back]), &square(), 0.875, Some(Fault::Sum));
    holds(&triangles(&[middle, middle]), &square(), 0.875, Some(Fault::Sum));
    holds(&triangles(&[middle, other]), &square(), 0.75, None);
    holds(&triangles(&[middle, other, back]), &square(), 0.75, None);
    holds(&triangles(&[middle, back]), &square(), 0.875, Some(Fault::NoMultiplicity));
    holds(&triangles(&[middle, near]), &square(), 0.5, Some(Fault::Sum));
}

#[test]
fn what_is_beyond_the_light_behind_the_receiver_or_edge_on_hides_nothing() {
    let far = 64.0;
    let wall = |from: f32, to: f32| {
        quads(&[[[-far, 0.25, from], [far, 0.25, from], [far, 0.25, to], [-far, 0.25, to]]])
    };
    holds(&wall(2.0, 9.0), &square(), 0.875, Some(Fault::NoFarPlane));
    holds(&wall(-3.0, 9.0), &square(), 0.625, Some(Fault::NoFarPlane));
    holds(&wall(4.0, 9.0), &square(), 1.0, None);
    holds(&wall(-9.0, -1.0), &square(), 1.0, None);
    // Around the receiver: the floor it lies on, a wall through it, a fan with a corner at it.
    let floor = [[-far, -far, 0.0], [far, -far, 0.0], [far, far, 0.0], [-far, far, 0.0]];
    let through = [[0.0, -far, -far], [0.0, far, -far], [0.0, far, far], [0.0, -far, far]];
    let corner = [[0.0; 3], [1.0, 0.0, 2.0], [0.0, 1.0, 2.0], [-1.0, -1.0, 5.0]];
    for mesh in [quads(&[floor]), quads(&[through]), quads(&[corner]), quads(&[floor, through, corner])] {
        assert_eq!(seen(&mesh, &square(), None).fraction, 1.0);
    }
    assert!(seen(&quads(&[through]), &square(), Some(Fault::ZeroIsFront)).fraction < 0.9);
    // A floor just below and a ceiling just above the receiver, as far as single units in the last place.
    for height in [1e-30_f32, 1e-7, 1e-3] {
        let at = |height: f32| quads(&[floor.map(|[x, y, _]| [x, y, height])]);
        holds(&at(-height), &square(), 1.0, None);
        assert!(seen(&at(height), &square(), None).fraction < 1e-13);
        // The bound grows as the edge comes near: rounding turns it about the receiver.
        let half = |height: f32| quads(&[floor.map(|[x, y, _]| [x.max(0.0), y, height])]);
        let found = seen(&half(height), &square(), None);
        assert!((found.fraction - 0.5).abs() < 1e-13 && found.bound >= 1e-13, "{found:?}");
        holds(&half(-height), &square(), 1.0, None);
    }
    // The light's own faces, in a plane in which rounding tells nothing.
    let corners = [[-1.7, -1.1, 4.3], [1.3, -0.9, 3.7], [1.0, 1.1, 4.1]];
    let edge = |i: usize| [0, 1, 2].map(|k| corners[i][k] - corners[0][k]);
    let exact = [
        corners[0],
        [0, 1, 2].map(|k| corners[0][k] + edge(1)[k]),
        [0, 1, 2].map(|k| corners[0][k] + edge(2)[k]),
    ];
    let light = AreaLight::polygon(&exact).unwrap();
    assert_eq!(seen(&triangles(&[exact]), &light, None).fraction, 1.0);
}

#[test]
fn disks_are_cut_by_chords_and_hidden_by_disks() {
    let disk = AreaLight::disk([0.0, 0.0, 4.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]).unwrap();
    let facing = AreaLight::facing_disk([0.0, 0.0, 4.0], 1.0).unwrap();
    let sun = AreaLight::sun([0.0, 0.0, 3.0], 0.25_f32.atan()).unwrap();
    let whole = 1.0 / 17.0; // R²/(R² + h²)
    for c in [-0.96875_f64, -0.5, 0.0, 0.25, 0.875, 0.998046875] {
        let x = (c / 2.0) as f32;
        let far = 64.0;
        for turned in [false, true] {
            let place = |x: f32, y: f32| if turned { [y, x, 2.0] } else { [x, y, 2.0] };
            let mesh = quads(&[[place(-far, -far), place(x, -far), place(x, far), place(-far, far)]]);
            let expected = (c.acos() - c * (1.0 - c * c).sqrt()) / PI;
            holds(&mesh, &disk, expected, None);
            holds(&mesh, &facing, expected, None);
            let ratio = f64::from(0.25_f32.atan()).tan() * 4.0;
            let c = c / ratio;
            let found = seen(&mesh, &sun, None);
            if c.abs() < 1.0 {
                let expected = (c.acos() - c * (1.0 - c * c).sqrt()) / PI;
                assert!((found.fraction - expected).abs() < 1e-13, "{found:?} is not {expected}");
            }
            if c == 0.0 {
                for light in [&disk, &facing] {
                    let form = seen(&mesh, light, None).form.unwrap();
                    assert!((form - whole / 2.0).abs() < 1e-15, "{form}");
                }
            }
        }
    }
    let away = triangles(&[[[50.0, 0.0, 1.0], [51.0, 0.0, 1.0], [50.0, 1.0, 1.0]]]);
    for light in [&disk, &facing, &sun] {
        let form = seen(&away, light, None).form.unwrap();
        assert!((form - whole).abs() < 1e-8, "{form}"); // the angle of the sun is rounded
    }
    assert!((seen(&away, &disk, None).form.unwrap() - whole).abs() < 1e-15);
    // Under a disk of 720 sides: 1 − (aH/(hR))², times what the polygon lacks of a disk.
    let (a, sides) = (0.375_f64, 720_u32);
    let rim = |i: u32| {
        let turn = 2.0 * PI * f64::from(i % sides) / f64::from(sides);
        [(a * turn.cos()) as f32, (a * turn.sin()) as f32, 2.0]
    };
    let fan: Vec<_> = (0..sides).map(|i| [[0.0, 0.0, 2.0], rim(i), rim(i + 1)]).collect();
    let area = f64::from(sides) * 0.5 * (2.0 * PI / f64::from(sides)).sin() * a * a / PI;
    let found = seen(&triangles(&fan), &disk, None);
    assert!((found.fraction - (1.0 - 4.0 * area)).abs() < 1e-7 && found.edges == sides, "{found:?}");
}

/// What a half-plane leaves and what the other one leaves add up to the whole light, as area and as form.
#[test]
fn two_half_planes_share_the_form_of_any_light_between_them() {
    let far = 64.0;
    let lights = [
        AreaLight::disk([0.5, -0.25, 4.0], [1.0, 0.25, 0.5], [-0.25, 1.5, 0.0]).unwrap(),
        AreaLight::facing_disk([0.5, -0.25, 4.0], 1.25).unwrap(),
        AreaLight::sun([0.25, -0.125, 1.0], 0.375).unwrap(),
        AreaLight::polygon(&[[-1.0, -1.0, 4.0], [1.5, -1.0, 4.0], [0.0, 0.0, 4.0], [-1.0, 1.5, 4.0]])
            .unwrap(),
    ];
    let away = triangles(&[[[50.0, 0.0, 1.0], [51.0, 0.0, 1.0], [50.0, 1.0, 1.0]]]);
    for light in &lights {
        // The last normal has its horizon across the light.
        for normal in [UP, [0.25, 0.5, 1.0], [8.0, -3.0, -0.75]] {
            let seen = |mesh: &Mesh| {
                SoftOracle::build(mesh).visible(Receiver::facing([0.0; 3], normal), light).unwrap()
            };
            let whole = seen(&away).form.unwrap();
            assert!(whole > 1e-4, "{whole}");
            for t in [-0.125_f32, 0.1, 0.25] {
                let left = quads(&[[[-far, -far, 2.0], [t, -far, 2.0], [t, far, 2.0], [-far, far, 2.0]]]);
                let right = quads(&[[[t, -far, 2.0], [far, -far, 2.0], [far, far, 2.0], [t, far, 2.0]]]);
                let [left, right] = [seen(&left), seen(&right)];
                assert!((left.fraction + right.fraction - 1.0).abs() < 1e-13, "{left:?} {right:?}");
                let [a, b] = [left.form.unwrap(), right.form.unwrap()];
                assert!((a + b - whole).abs() < 1e-15, "{a} {b} {whole}");
            }
        }
    }
}

#[test]
fn half_a_horizon_halves_the_form() {
    let nothing = triangles(&[[[50.0, 0.0, 1.0], [51.0, 0.0, 1.0], [50.0, 1.0, 1.0]]]);
    let soft = SoftOracle::build(&nothing);
    let disk = AreaLight::disk([0.0, 0.0, 4.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]).unwrap();
    for light in [square(), disk, AreaLight::facing_disk([0.0, 0.0, 4.0], 1.0).unwrap()] {
        let form = |normal: [f32; 3]| {
            soft.visible(Receiver::facing([0.0; 3], normal), &light).unwrap().form.unwrap()
        };
        // A normal to the side sees half; two opposite ones see the same; from behind there is nothing.
        let [right, left, front, behind] =
            [[2.0, 0.0, 0.0], [-2.0, 0.0, 0.0], UP, [0.0, 0.0, -1.0]].map(form);
        assert!((right - left).abs() < 1e-16 && right > 0.001 && right < front, "{right} {left} {front}");
        assert_eq!(behind, 0.0);
        // Irradiance is linear in the normal as long as all is above the horizon.
        let tilted = form([0.5, 0.0, 4.0]) * f64::from(16.25_f32).sqrt();
        assert!((tilted - 4.0 * front).abs() < 1e-15, "{tilted} {front}");
    }
}

#[test]
fn lights_without_area_and_lamps_without_extent() {
    let flat = AreaLight::parallelogram([0.0; 3], [1.0, 2.0, 3.0], [2.0, 4.0, 6.0]).unwrap_err();
    assert_eq!(
        flat.to_string(),
        "the light has no area: its edges are parallel or null; use a point light or a directional light"
    );
    assert!(AreaLight::disk([0.0; 3], [0.0; 3], [1.0, 0.0, 0.0]).is_err());
    assert!(AreaLight::facing_disk([0.0; 3], 0.0).is_err());
    assert!(AreaLight::polygon(&[]).is_err());
    assert!(AreaLight::polygon(&[[0.0; 3], [1.0; 3], [2.0; 3]]).is_err());
    assert!(AreaLight::polygon(&[[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.01]]).is_err());
    for angle in [0.0, -1.0, 1.570_796_4, f32::MAX] {
        assert!(matches!(AreaLight::sun([0.0, 1.0, 0.0], angle), Err(AreaLightError::Angle(_))), "{angle}");
    }
    assert!(AreaLight::sun([0.0; 3], 0.1).is_err());
    assert!(matches!(AreaLight::sun([f32::NAN; 3], 0.1), Err(AreaLightError::NotFinite(_))));
    assert!(AreaLight::sky_parallelogram([1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0]).is_err());
    let of = |text: &str| AreaLight::of_lamp(&text.parse().unwrap()).unwrap();
    assert_eq!(of("point:1,2,3"), None);
    assert_eq!(of("point:1,2,3,radius=0.5"), Some(AreaLight::facing_disk([1.0, 2.0, 3.0], 0.5).unwrap()));
    assert_eq!(
        of("rect:0,4,0:1,0,0:0,0,2"),
        Some(AreaLight::parallelogram([0.0, 4.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 2.0]).unwrap())
    );
    assert!(of("directional:0,-1,0,angle=0.266").is_some());
}

#[test]
fn receivers_in_the_plane_of_the_light_have_no_answer() {
    let soft =
        SoftOracle::build(&quads(&[[[0.0, 0.0, 1.0], [1.0, 0.0, 1.0], [1.0, 1.0, 1.0], [0.0, 1.0, 1.0]]]));
    assert_eq!(soft.visible([7.0, 3.0, 4.0], &square()), None);
    assert_eq!(soft.visible([f32::NAN; 3], &square()), None);
    let facing = AreaLight::facing_disk([1.0, 2.0, 3.0], 1.0).unwrap();
    assert_eq!(soft.visible([1.0, 2.0, 3.0], &facing), None);
    // An ulp beside the plane there is an answer, and a bound that says what it is worth.
    let near = soft.visible([7.0, 3.0, 4.0_f32.next_up()], &square()).unwrap();
    assert!(near.bound > 1e-13 && near.bound <= 1.0, "{near:?}");
}
