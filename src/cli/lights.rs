//! The lights of a command.

use serde_json::Value;
use umbrage::geom::{Aabb, Light};
use umbrage::scene::{Lamp, LampShape};
use umbrage::view::Up;

use super::output;

/// The lights that were asked for.
#[derive(Clone, Debug, clap::Args)]
pub(crate) struct LightArgs {
    /// A light in mesh units: `point:X,Y,Z`, `directional:X,Y,Z` (the way the light travels) or
    /// `spot:X,Y,Z:DX,DY,DZ:OUTER[,INNER]` (angles in degrees); may be repeated
    ///
    /// `,range=D` behind a point or spot light ends it at that distance, in pictures with physical falloff.
    /// For example: --light spot:0,5,0:0,-1,0:30,20,range=12. Casting a shadow, a spot light is the point it
    /// shines from.
    ///
    /// A light with an extent has penumbrae: `,radius=R` behind a point or spot light (a sphere, taken as the
    /// disk that faces the point it lights), `,angle=DEG` behind a directional one (half the angle that it
    /// takes up in the sky; the sun: 0.266), or `rect:X,Y,Z:X,Y,Z:X,Y,Z` (a corner and two edges). Hard
    /// shadows are those of its center.
    ///
    /// [default: the file's own lights; without those, a point light 1.5 diagonals of the bounding box away
    /// from its center, above and to the side, towards (1,2,1), or (1,-1,2) for stl, md2 and 3mf, where z is
    /// up]
    #[arg(long = "light", value_name = "LIGHT", allow_hyphen_values = true)]
    lights: Vec<Lamp>,
}

impl LightArgs {
    /// Whether the command line names any, so that [`LightArgs::resolve`] gives those.
    pub(crate) fn were_asked_for(&self) -> bool {
        !self.lights.is_empty()
    }

    /// The lights asked for; else those of the file; else one that is computed from `bounds` and announced.
    pub(crate) fn resolve(&self, of_file: Vec<Lamp>, bounds: Aabb, up: Up) -> Vec<Lamp> {
        if !self.lights.is_empty() {
            return self.lights.clone();
        }
        if !of_file.is_empty() {
            return of_file;
        }
        let light = default_light(bounds, up);
        output::say(format_args!("note: no --light, and none in the file: using {}", label(&light, "")));
        vec![light.into()]
    }
}

/// Says which lights have an extent that hard shadows do not know of.
pub(crate) fn note_centers<'a>(lamps: impl IntoIterator<Item = &'a Lamp>) {
    for lamp in lamps.into_iter().filter(|lamp| lamp.has_extent()) {
        let center = label(lamp.light(), "");
        output::say(format_args!("note: {}: hard shadows, of its center: {center}", lamp_label(lamp)));
    }
}

/// A lamp for a person: its light, as [`label`] gives it, but a spot light is called one.
pub(crate) fn lamp_label(lamp: &Lamp) -> String {
    let light = spot_label(lamp.light(), lamp.cone.is_some(), "");
    let light = match &lamp.shape {
        LampShape::Disk { radius, .. } => format!("{light},radius={radius}"),
        LampShape::Sun { half_angle_rad, .. } => {
            format!("{light},angle={}", f64::from(*half_angle_rad).to_degrees() as f32)
        }
        LampShape::Rectangle(_) => lamp.to_string(),
        _ => light,
    };
    named(light, &lamp.name)
}

/// A light for a person: coordinates far from 1 with an exponent, then its name, if it has one. Without the
/// name it can be given back as `--light`.
pub(crate) fn label(light: &Light, name: &str) -> String {
    spot_label(light, false, name)
}

/// As [`label`], for a light that may have a cone. The cone is left out: it casts no shadow.
pub(crate) fn spot_label(light: &Light, spot: bool, name: &str) -> String {
    let exact = light.to_string();
    let (kind, coordinates) = exact.split_once(':').unwrap_or(("", &exact));
    let kind = if spot { "spot" } else { kind };
    let brief = |text: &str| match text.parse::<f32>() {
        Ok(x) if x != 0.0 && !(1e-5..1e7).contains(&x.abs()) => format!("{x:e}"),
        _ => text.to_owned(),
    };
    let coordinates: Vec<String> = coordinates.split(',').map(brief).collect();
    named(format!("{kind}:{}", coordinates.join(",")), name)
}

fn named(light: String, name: &str) -> String {
    if name.is_empty() { light } else { format!("{light} ({})", output::short(name)) }
}

/// The name of a light for JSON: null where it has none.
pub(crate) fn name(name: &str) -> Value {
    if name.is_empty() { Value::Null } else { name.into() }
}

/// 1.5 diagonals from the center towards (1, 2, 1) of a y-up model: above, in front and to the side of
/// everything.
fn default_light(bounds: Aabb, up: Up) -> Light {
    let (center, diagonal) = (bounds.center(), bounds.diagonal());
    let reach = if diagonal > 0.0 { 1.5 * diagonal } else { 1.0 };
    let step = reach / 6_f64.sqrt(); // the length of (1, 2, 1)
    let largest = f64::from(f32::MAX);
    let towards = up.turn([1.0, 2.0, 1.0]);
    let at = [0, 1, 2].map(|i| (f64::from(center[i]) + towards[i] * step).clamp(-largest, largest) as f32);
    Light::point(at).expect("clamped to finite coordinates")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lights_asked_for_come_before_those_of_the_file() {
        let own: Lamp = "point:1,1,1".parse().unwrap();
        let asked = LightArgs { lights: vec!["directional:0,-1,0".parse().unwrap()] };
        assert_eq!(asked.resolve(vec![own.clone()], Aabb::EMPTY, Up::Y), asked.lights);
        assert_eq!(LightArgs { lights: vec![] }.resolve(vec![own.clone()], Aabb::EMPTY, Up::Y), [own]);
    }

    #[test]
    fn label_of_a_light_is_short_and_reads_back() {
        for (text, wanted) in [
            ("point:1,2.5,-3", "point:1,2.5,-3"),
            ("point:1e-30,-3e38,0", "point:1e-30,-3e38,0"),
            ("directional:0.00001,9999999,1e7", "directional:0.00001,9999999,1e7"),
        ] {
            let light: Light = text.parse().unwrap();
            assert_eq!(label(&light, ""), wanted);
            assert_eq!(wanted.parse(), Ok(light));
        }
        assert_eq!(label(&"point:1,2,3".parse().unwrap(), "Sun\n"), "point:1,2,3 (Sun\u{fffd})");
        let lamp = |text: &str| lamp_label(&text.parse().unwrap());
        assert_eq!(lamp("spot:1,2e8,3:0,-1,0:30"), "spot:1,2e8,3");
        assert_eq!(lamp("point:1,2,3,range=9"), "point:1,2,3");
        for text in ["point:1,2,3,radius=0.25", "directional:0,-1,0,angle=0.266", "rect:0,0,0:1,0,0:0,1,0"] {
            assert_eq!(lamp(text), text);
        }
    }

    #[test]
    fn default_light_lies_one_and_a_half_diagonals_away() {
        let bounds = Aabb { low: [-1.0; 3], high: [1.0; 3] };
        let [x, y, z] = default_light(bounds, Up::Y).xyz().map(f64::from);
        assert!(((x * x + y * y + z * z).sqrt() - 1.5 * 12_f64.sqrt()).abs() < 1e-5, "{x} {y} {z}");
        assert!(y > 1.0 && x > 1.0 && z > 1.0);
        assert_eq!(default_light(bounds, Up::Z).xyz().map(f64::from), [x, -z, y]);
        for extreme in [Aabb::EMPTY, Aabb { low: [f32::MIN; 3], high: [f32::MAX; 3] }] {
            assert!(default_light(extreme, Up::Y).xyz().iter().all(|x| x.is_finite()));
        }
    }
}
