//! Lamps as things to take hold of: where their handles are, and how a lamp follows its handle.

use umbrage::geom::Light;
use umbrage::glam::{DQuat, DVec3};
use umbrage::scene::{Lamp, LampShape, Rectangle};

/// Where the handle of a lamp is, in world space: at the lamp, or in its direction at `reach` from the center
/// of the scene, for a lamp that is farther away.
pub(super) fn place(lamp: &Lamp, center: DVec3, reach: f64) -> DVec3 {
    let at = DVec3::from(lamp.light().xyz().map(f64::from));
    if lamp.light().is_directional() {
        return center + reach * at.normalize_or(DVec3::Y);
    }
    let away = at - center;
    match away.try_normalize() {
        Some(direction) if away.length() > reach => center + reach * direction,
        _ => at,
    }
}

/// The turn around the center of the scene that a handle follows a drag by.
///
/// `drag` is in pixels to the right and up, `radius_px` the distance of the handle from the center in the
/// picture if it were seen from the side. `axes` are right and up in the picture; `is_behind` says that the
/// handle is farther away than the center.
pub(super) fn turn(drag: [f64; 2], radius_px: f64, axes: [DVec3; 2], is_behind: bool) -> DQuat {
    let [right, up] = axes;
    let sign = if is_behind { -1.0 } else { 1.0 };
    let axis = sign * (drag[0] * up - drag[1] * right);
    match axis.try_normalize() {
        Some(unit) => DQuat::from_axis_angle(unit, axis.length() / radius_px.max(1.0)),
        None => DQuat::IDENTITY,
    }
}

/// The lamp turned around a point, with where it shines to; unchanged where it would be no lamp.
pub(super) fn turned(lamp: &Lamp, center: DVec3, turn: DQuat) -> Lamp {
    let point = |p: [f32; 3]| narrow(center + turn * (wide(p) - center));
    let direction = |d: [f32; 3]| narrow(turn * wide(d));
    let light = |light: &Light| match light.is_directional() {
        // A light is stored by where it comes from, and made by where it goes.
        true => Light::directional(direction(light.xyz()).map(|x| -x)),
        false => Light::point(point(light.xyz())),
    };
    let shape = move_shape(&lamp.shape, light, |rectangle| {
        Rectangle::new(point(rectangle.corner()), rectangle.edges().map(direction))
    });
    let cone = lamp.cone.map(|mut cone| {
        cone.direction = narrow((turn * wide(cone.direction)).normalize_or(DVec3::NEG_Y));
        cone
    });
    shape.map_or_else(|| lamp.clone(), |shape| Lamp { shape, cone, ..lamp.clone() })
}

/// The lamp moved along the line from a point, to `factor` times its distance. A directional lamp stays. A
/// lamp that would leave the range of `f32` stays.
pub(super) fn at_distance(lamp: &Lamp, center: DVec3, factor: f64) -> Lamp {
    let point = |p: [f32; 3]| narrow(center + factor * (wide(p) - center));
    let light = |light: &Light| match light.is_directional() {
        true => Ok(*light),
        false => Light::point(point(light.xyz())),
    };
    let shape = move_shape(&lamp.shape, light, |rectangle| {
        let shift = wide(point(rectangle.center().xyz())) - wide(rectangle.center().xyz());
        Rectangle::new(narrow(wide(rectangle.corner()) + shift), rectangle.edges())
    });
    shape.map_or_else(|| lamp.clone(), |shape| Lamp { shape, ..lamp.clone() })
}

/// The lamp with its light elsewhere: a position, or the direction in which it travels.
pub(super) fn with_light(lamp: &Lamp, xyz: [f32; 3]) -> Lamp {
    let light = |light: &Light| match light.is_directional() {
        true => Light::directional(xyz),
        false => Light::point(xyz),
    };
    let shape = move_shape(&lamp.shape, light, |rectangle| {
        let shift = wide(xyz) - wide(rectangle.center().xyz());
        Rectangle::new(narrow(wide(rectangle.corner()) + shift), rectangle.edges())
    });
    shape.map_or_else(|| lamp.clone(), |shape| Lamp { shape, ..lamp.clone() })
}

/// The position of a lamp, or the direction in which its light travels.
pub(super) fn numbers(lamp: &Lamp) -> [f32; 3] {
    match lamp.light().is_directional() {
        // Not −0.
        true => lamp.light().xyz().map(|x| 0.0 - x),
        false => lamp.light().xyz(),
    }
}

/// The extent of a lamp: its radius in mesh units, or half the angle it takes up in degrees; `None` for a
/// lamp whose extent is of another kind.
pub(super) fn extent(lamp: &Lamp) -> Option<f32> {
    match lamp.shape {
        LampShape::Hard(_) => Some(0.0),
        LampShape::Disk { radius, .. } => Some(radius),
        LampShape::Sun { half_angle_rad, .. } => Some(half_angle_rad.to_degrees()),
        _ => None,
    }
}

/// The lamp with another extent; 0 for none.
pub(super) fn with_extent(lamp: &Lamp, extent: f32) -> Lamp {
    let center = *lamp.light();
    let shape = match (&lamp.shape, center.is_directional()) {
        (LampShape::Rectangle(_), _) => lamp.shape,
        _ if !(extent > 0.0 && extent.is_finite()) => LampShape::Hard(center),
        (_, true) => LampShape::Sun { center, half_angle_rad: extent.min(90.0).to_radians() },
        (_, false) => LampShape::Disk { center, radius: extent },
    };
    Lamp { shape, ..lamp.clone() }
}

/// The shape with its light moved; `None` where that would be no light.
fn move_shape<E, F>(
    shape: &LampShape,
    light: impl Fn(&Light) -> Result<Light, E>,
    rectangle: impl Fn(&Rectangle) -> Result<Rectangle, F>,
) -> Option<LampShape> {
    Some(match *shape {
        LampShape::Hard(center) => LampShape::Hard(light(&center).ok()?),
        LampShape::Disk { center, radius } => LampShape::Disk { center: light(&center).ok()?, radius },
        LampShape::Sun { center, half_angle_rad } => {
            LampShape::Sun { center: light(&center).ok()?, half_angle_rad }
        }
        LampShape::Rectangle(ref it) => LampShape::Rectangle(rectangle(it).ok()?),
        _ => return None,
    })
}

fn wide(p: [f32; 3]) -> DVec3 {
    DVec3::from(p.map(f64::from))
}

fn narrow(p: DVec3) -> [f32; 3] {
    p.as_vec3().into()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lamp(text: &str) -> Lamp {
        text.parse().unwrap()
    }

    const CENTER: DVec3 = DVec3::new(1.0, 0.0, 0.0);

    #[test]
    fn handle_of_a_far_lamp_lies_within_reach_and_in_its_direction() {
        assert_eq!(place(&lamp("point:1,9,0"), CENTER, 3.0), DVec3::new(1.0, 3.0, 0.0));
        assert_eq!(place(&lamp("point:1,2,0"), CENTER, 3.0), DVec3::new(1.0, 2.0, 0.0));
        assert_eq!(place(&lamp("point:1,0,0"), CENTER, 3.0), CENTER);
        // The light travels down, so it comes from above.
        assert_eq!(place(&lamp("directional:0,-2,0"), CENTER, 3.0), DVec3::new(1.0, 3.0, 0.0));
    }

    #[test]
    fn lamp_follows_its_handle_across_the_picture() {
        let axes = [DVec3::X, DVec3::Y];
        for (text, is_behind) in
            [("point:1,0,5", false), ("directional:0,0,-1", false), ("point:1,0,-5", true)]
        {
            let before = lamp(text);
            let moved = turned(&before, CENTER, turn([20.0, 10.0], 100.0, axes, is_behind));
            let [from, to] = [&before, &moved].map(|lamp| place(lamp, CENTER, 5.0));
            let step = to - from;
            // Right and up, twice as far to the right; as far from the center as before.
            assert!(step.x > 0.0 && step.y > 0.0 && (step.x - 2.0 * step.y).abs() < 1e-5, "{text}: {step}");
            assert!(((to - CENTER).length() - 5.0).abs() < 1e-5);
        }
        assert_eq!(turn([0.0; 2], 100.0, axes, false), DQuat::IDENTITY);
    }

    #[test]
    fn lamp_that_is_turned_keeps_its_kind_and_aims_at_the_same_place() {
        let quarter = DQuat::from_rotation_z(std::f64::consts::FRAC_PI_2);
        let spot = turned(&lamp("spot:1,4,0:0,-1,0:30,radius=0.5,range=9"), CENTER, quarter);
        assert_eq!(numbers(&spot).map(f32::round), [-3.0, 0.0, 0.0]);
        assert_eq!(spot.cone.unwrap().direction.map(f32::round), [1.0, 0.0, 0.0]);
        assert_eq!((extent(&spot), spot.range), (Some(0.5), Some(9.0)));
        let rect = turned(&lamp("rect:1,4,0:1,0,0:0,0,1"), CENTER, quarter);
        let LampShape::Rectangle(rect) = rect.shape else { panic!("{rect:?}") };
        assert_eq!(rect.edges().map(|edge| edge.map(f32::round)), [[0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);
    }

    #[test]
    fn lamp_comes_nearer_and_never_leaves_the_range_of_numbers() {
        assert_eq!(numbers(&at_distance(&lamp("point:1,4,0"), CENTER, 0.5)), [1.0, 2.0, 0.0]);
        let sun = lamp("directional:0,-1,0");
        assert_eq!(at_distance(&sun, CENTER, 0.5), sun);
        let far = lamp("point:0,3e38,0");
        assert_eq!(at_distance(&far, CENTER, 1e9), far, "no lamp there");
        let rect = at_distance(&lamp("rect:1,4,0:1,0,0:0,0,1"), DVec3::ZERO, 2.0);
        assert_eq!(numbers(&rect), [3.0, 8.0, 1.0]);
        assert_eq!(with_light(&sun, [f32::NAN; 3]), sun);
        assert_eq!(numbers(&with_light(&sun, [1.0, -1.0, 0.0])), [1.0, -1.0, 0.0]);
        assert_eq!(numbers(&with_light(&lamp("rect:0,0,0:2,0,0:0,2,0"), [5.0; 3])), [5.0; 3]);
    }

    #[test]
    fn extent_makes_a_lamp_soft_and_zero_makes_it_hard_again() {
        for (text, wanted) in
            [("point:1,2,3", "point:1,2,3,radius=2"), ("directional:0,-1,0", "directional:0,-1,0,angle=2")]
        {
            let soft = with_extent(&lamp(text), 2.0);
            assert_eq!(soft.to_string(), wanted);
            assert_eq!(with_extent(&soft, 0.0), lamp(text));
        }
        let rect = lamp("rect:0,0,0:2,0,0:0,2,0");
        assert_eq!((extent(&rect), with_extent(&rect, 3.0)), (None, rect.clone()));
    }
}
