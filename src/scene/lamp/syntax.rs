//! A lamp as text, the form of the command line: a shape, then `,key=value` options.

use std::fmt;
use std::str::FromStr;

use super::{Lamp, LampError, LampShape, Rectangle, SpotCone, unit};
use crate::geom::Light;

const POINT: &str = "point:X,Y,Z[,radius=R][,range=D]";
const DIRECTIONAL: &str = "directional:X,Y,Z[,angle=DEG] (the way the light travels)";
const SPOT: &str = "spot:X,Y,Z:DX,DY,DZ:OUTER[,INNER][,radius=R][,range=D] (angles in degrees)";
const RECTANGLE: &str = "rect:X,Y,Z:X,Y,Z:X,Y,Z[,range=D] (a corner and two edges)";
pub(super) const ANY: &str = "point:X,Y,Z, directional:X,Y,Z (the way the light travels), \
                   spot:X,Y,Z:DX,DY,DZ:OUTER[,INNER] or rect:X,Y,Z:X,Y,Z:X,Y,Z";

impl FromStr for Lamp {
    type Err = LampError;

    fn from_str(text: &str) -> Result<Self, LampError> {
        let (kind, rest) = text.split_once(':').unwrap_or((text, ""));
        match kind.trim() {
            "point" => point(&Parts::new(text, rest, POINT)),
            "directional" => directional(&Parts::new(text, rest, DIRECTIONAL)),
            "spot" => spot(&Parts::new(text, rest, SPOT)),
            "rect" => rectangle(&Parts::new(text, rest, RECTANGLE)),
            _ => Err(LampError::Kind(text.to_owned())),
        }
    }
}

fn point(parts: &Parts<'_>) -> Result<Lamp, LampError> {
    let [position] = parts.groups(["the position"])?;
    parts.allow(&["radius", "range"])?;
    let center = Light::point(parts.three("the position", &position)?)?;
    parts.finish(parts.disk(center)?)
}

fn directional(parts: &Parts<'_>) -> Result<Lamp, LampError> {
    let [travel] = parts.groups(["the direction"])?;
    parts.allow(&["angle"])?;
    let center = Light::directional(parts.three("the direction", &travel)?)?;
    let shape = match parts.option("angle", |angle| (0.0..=90.0).contains(&angle), "from 0 to 90 degrees")? {
        None | Some(0.0) => LampShape::Hard(center),
        Some(angle) => LampShape::Sun { center, half_angle_rad: radians(angle) },
    };
    parts.finish(shape)
}

fn spot(parts: &Parts<'_>) -> Result<Lamp, LampError> {
    let [position, direction, angles] = parts.groups(["the position", "the direction", "the cone"])?;
    parts.allow(&["radius", "range"])?;
    let center = Light::point(parts.three("the position", &position)?)?;
    let direction = parts.three("the direction", &direction)?;
    let direction = unit(direction).ok_or_else(|| parts.wrong("the direction is 0,0,0".to_owned()))?;
    let angles: Vec<f64> = parts.numbers("the cone", &angles)?;
    let (outer, inner) = match angles[..] {
        [outer] => (outer, 0.0),
        [outer, inner] => (outer, inner),
        _ => return Err(parts.wrong(format!("the cone is {} numbers, not 1 or 2", angles.len()))),
    };
    if !(outer > 0.0 && outer <= 90.0) {
        return Err(parts.wrong(format!("the outer angle {outer} is not above 0 and at most 90 degrees")));
    }
    if !(0.0..=outer).contains(&inner) {
        return Err(parts.wrong(format!("the inner angle {inner} is not from 0 to the outer angle {outer}")));
    }
    let cone = SpotCone { direction, inner_rad: radians(inner), outer_rad: radians(outer) };
    Ok(Lamp { cone: Some(cone), ..parts.finish(parts.disk(center)?)? })
}

fn rectangle(parts: &Parts<'_>) -> Result<Lamp, LampError> {
    let names = ["the corner", "the first edge", "the second edge"];
    let groups = parts.groups(names)?;
    parts.allow(&["range"])?;
    let [corner, a, b] = [0, 1, 2].map(|i| parts.three(names[i], &groups[i]));
    parts.finish(LampShape::Rectangle(Rectangle::new(corner?, [a?, b?])?))
}

/// The text after the kind, taken apart at colons, and its options.
struct Parts<'a> {
    text: &'a str,
    remedy: &'static str,
    groups: Vec<Vec<&'a str>>,
    options: Vec<(&'a str, &'a str)>,
}

impl<'a> Parts<'a> {
    fn new(text: &'a str, rest: &'a str, remedy: &'static str) -> Self {
        let mut groups: Vec<Vec<&str>> =
            rest.split(':').map(|group| group.split(',').map(str::trim).collect()).collect();
        let last = groups.last_mut().expect("a split has a first part");
        let numbers = last.iter().position(|item| item.contains('=')).unwrap_or(last.len());
        let options = last.split_off(numbers);
        let options = options.into_iter().map(|item| item.split_once('=').unwrap_or((item, "")));
        Self {
            text,
            remedy,
            groups,
            options: options.map(|(key, value)| (key.trim(), value.trim())).collect(),
        }
    }

    fn wrong(&self, problem: String) -> LampError {
        LampError::Syntax { text: self.text.to_owned(), problem, remedy: self.remedy }
    }

    /// The groups of numbers between colons, as many as there are names.
    fn groups<const N: usize>(&self, names: [&str; N]) -> Result<[Vec<&'a str>; N], LampError> {
        self.groups.clone().try_into().map_err(|groups: Vec<Vec<&str>>| match names.get(groups.len()) {
            Some(missing) => self.wrong(format!("{missing} is missing")),
            None => self.wrong(format!("`{}` is one part too many", groups[N].join(","))),
        })
    }

    fn numbers<T: FromStr>(&self, name: &str, group: &[&str]) -> Result<Vec<T>, LampError> {
        let number =
            |word: &&str| word.parse().map_err(|_| self.wrong(format!("{name}: `{word}` is not a number")));
        group.iter().map(number).collect()
    }

    fn three(&self, name: &str, group: &[&str]) -> Result<[f32; 3], LampError> {
        let numbers: Vec<f32> = self.numbers(name, group)?;
        let count = numbers.len();
        numbers.try_into().map_err(|_| self.wrong(format!("{name} is {count} numbers, not 3")))
    }

    /// Refuses options that this kind of lamp does not have, and an option given twice.
    fn allow(&self, keys: &[&str]) -> Result<(), LampError> {
        for (index, (key, _)) in self.options.iter().enumerate() {
            if !keys.contains(key) {
                return Err(self.wrong(format!("`{key}` is not an option here")));
            }
            if self.options[..index].iter().any(|(other, _)| other == key) {
                return Err(self.wrong(format!("`{key}` is given twice")));
            }
        }
        Ok(())
    }

    /// The value of an option, if it is given and `holds`.
    fn option(&self, key: &str, holds: impl Fn(f64) -> bool, what: &str) -> Result<Option<f64>, LampError> {
        let Some((_, text)) = self.options.iter().find(|(name, _)| *name == key) else { return Ok(None) };
        match text.parse::<f64>() {
            Ok(value) if holds(value) => Ok(Some(value)),
            _ => Err(self.wrong(format!("{key} `{text}` is not a number {what}"))),
        }
    }

    /// The value of an option that is a length.
    fn length(&self, key: &str, zero: bool) -> Result<Option<f32>, LampError> {
        let holds = |x: f64| (x as f32).is_finite() && (x as f32 > 0.0 || zero && x == 0.0);
        let what = if zero { "of mesh units, 0 or more" } else { "of mesh units above 0" };
        // Rounding twice would not give the nearest f32.
        let value = self.option(key, holds, what)?;
        Ok(value.and_then(|_| self.options.iter().find(|(name, _)| *name == key)?.1.parse().ok()))
    }

    fn disk(&self, center: Light) -> Result<LampShape, LampError> {
        Ok(match self.length("radius", true)? {
            None | Some(0.0) => LampShape::Hard(center),
            Some(radius) => LampShape::Disk { center, radius },
        })
    }

    fn finish(&self, shape: LampShape) -> Result<Lamp, LampError> {
        Ok(Lamp { range: self.length("range", false)?, ..Lamp::new(shape) })
    }
}

fn radians(degrees: f64) -> f32 {
    degrees.to_radians() as f32
}

/// An angle in degrees with as few digits as read back to the same radians.
struct Degrees(f32);

impl fmt::Display for Degrees {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let degrees = f64::from(self.0).to_degrees();
        let short = (degrees as f32).to_string();
        match short.parse().map(radians) == Ok(self.0) {
            true => f.write_str(&short),
            // An f64 is off by 2⁻⁵¹ of itself at most, there and back: the nearest f32 is the one it came
            // from.
            false => degrees.fmt(f),
        }
    }
}

/// The shape as on the command line, without name, color and intensity: a white lamp reads back as it was.
impl fmt::Display for Lamp {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let three = |[x, y, z]: [f32; 3]| format!("{x},{y},{z}");
        match (&self.shape, self.cone) {
            (LampShape::Rectangle(rectangle), _) => {
                let [a, b] = rectangle.edges.map(three);
                write!(f, "rect:{}:{a}:{b}", three(rectangle.corner))?;
            }
            (_, Some(cone)) if !self.light().is_directional() => {
                let [position, direction] = [self.light().xyz(), cone.direction].map(three);
                write!(f, "spot:{position}:{direction}:{}", Degrees(cone.outer_rad))?;
                if cone.inner_rad != 0.0 {
                    write!(f, ",{}", Degrees(cone.inner_rad))?;
                }
            }
            _ => self.light().fmt(f)?,
        }
        match self.shape {
            LampShape::Disk { radius, .. } => write!(f, ",radius={radius}")?,
            LampShape::Sun { half_angle_rad, .. } => write!(f, ",angle={}", Degrees(half_angle_rad))?,
            LampShape::Hard(_) | LampShape::Rectangle(_) => {}
        }
        match self.range {
            Some(range) => write!(f, ",range={range}"),
            None => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn lamp(text: &str) -> Lamp {
        text.parse().unwrap_or_else(|error| panic!("{error}"))
    }

    #[test]
    fn lamp_prints_as_it_is_parsed() {
        for text in [
            "point:1,2,3",
            "point:1,2,3,range=4",
            "point:1,2,3,radius=0.5,range=4",
            "directional:0,-1,0",
            "directional:0,-1,0.5,angle=0.266",
            "spot:1,2,3:0,-1,0:30",
            "spot:1,2,3:0,-1,0:30,20,radius=0.25",
            "rect:0,1,0:2,0,0:0,0,2",
            "rect:0,1,0:2,0,0:0,0,2,range=9",
        ] {
            assert_eq!(lamp(text).to_string(), text);
        }
        assert_eq!(lamp(" point : 1, 2 ,3 , radius = 0").to_string(), "point:1,2,3", "radius 0 is hard");
        assert_eq!(lamp("directional:0,-2,0").light().homogeneous(), [0.0, 2.0, 0.0, 0.0]);
        assert_eq!(lamp("spot:0,0,0:0,-2,0:30").cone.unwrap().direction, [0.0, -1.0, 0.0]);
    }

    #[test]
    fn lamp_error_names_the_part_and_the_remedy() {
        for (text, part) in [
            ("", "is not a light"),
            ("-1,2,3", "is not a light"),
            ("lamp:1,2,3", "is not a light"),
            ("point", "the position: `` is not a number"),
            ("point:1,2", "the position is 2 numbers, not 3"),
            ("point:1,2,x", "the position: `x` is not a number"),
            ("point:1,2,3:4,5,6", "`4,5,6` is one part too many"),
            ("point:1,2,3,angle=3", "`angle` is not an option here"),
            ("point:1,2,3,range=1,range=2", "`range` is given twice"),
            ("point:1,2,3,range=0", "range `0` is not a number of mesh units above 0"),
            ("point:1,2,3,range=1e-99", "range `1e-99`"),
            ("point:1,2,3,radius=-1", "radius `-1` is not a number of mesh units, 0 or more"),
            ("point:1,2,3,radius=nan", "radius `nan`"),
            ("point:1,2,3,radius=1e39", "radius `1e39`"),
            ("point:1,2,3,range=4,5", "`5` is not an option here"),
            ("directional:0,1,0,range=4", "`range` is not an option here"),
            ("directional:0,1,0,angle=91", "angle `91` is not a number from 0 to 90 degrees"),
            ("spot:1,2,3", "the direction is missing"),
            ("spot:1,2,3:0,-1,0", "the cone is missing"),
            ("spot:1,2,3:0,0,0:30", "the direction is 0,0,0"),
            ("spot:1,2,3:0,-1,0:0", "the outer angle 0"),
            ("spot:1,2,3:0,-1,0:91", "the outer angle 91"),
            ("spot:1,2,3:0,-1,0:30,31", "the inner angle 31"),
            ("spot:1,2,3:0,-1,0:30,20,10", "the cone is 3 numbers, not 1 or 2"),
            ("rect:0,0,0:1,0,0", "the second edge is missing"),
            ("rect:0,0,0:1,0,0:0,1", "the second edge is 2 numbers, not 3"),
        ] {
            let error = text.parse::<Lamp>().expect_err(text).to_string();
            assert!(error.contains(part) && error.contains("; write "), "{text}: {error}");
        }
        for text in
            ["point:nan,0,0", "directional:0,0,0", "rect:0,0,0:1,0,0:2,0,0", "rect:inf,0,0:1,0,0:0,1,0"]
        {
            assert!(text.parse::<Lamp>().is_err(), "{text}");
        }
    }

    /// Any finite number, small integers among them.
    fn number() -> impl Strategy<Value = f32> {
        prop_oneof![any::<f32>().prop_filter("finite", |x| x.is_finite()), (-9_i8..9).prop_map(f32::from)]
    }

    fn three() -> impl Strategy<Value = [f32; 3]> {
        [number(), number(), number()]
    }

    proptest! {
        #[test]
        fn lamp_of_any_numbers_reads_back_as_it_was(
            kind in 0..4, at in three(), a in three(), b in three(), outer_rad in 1e-30_f32..1.5, part in 0.0_f32..=1.0,
            extent in proptest::option::of(1e-38_f32..1.0), range in proptest::option::of(1e-38_f32..3e38),
        ) {
            let point = Light::point(at).unwrap();
            let disk = extent.map_or(LampShape::Hard(point), |radius| LampShape::Disk { center: point, radius });
            let Some(lamp) = (match kind {
                0 => Some(Lamp { range, ..Lamp::new(disk) }),
                1 => Light::directional(at).ok().map(|center| {
                    let sun = |half_angle_rad| LampShape::Sun { center, half_angle_rad };
                    Lamp::new(extent.map_or(LampShape::Hard(center), sun))
                }),
                2 => unit(a).map(|direction| {
                    let cone = SpotCone { direction, inner_rad: part * outer_rad, outer_rad };
                    Lamp { range, cone: Some(cone), ..Lamp::new(disk) }
                }),
                _ => Rectangle::new(at, [a, b]).ok().map(|rectangle| {
                    Lamp { range, ..Lamp::new(LampShape::Rectangle(rectangle)) }
                }),
            }) else { return Ok(()) };
            let text = lamp.to_string();
            prop_assert_eq!(text.parse::<Lamp>(), Ok(lamp), "{}", text);
        }
    }
}
