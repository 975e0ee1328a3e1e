//! The camera of a picture.

use umbrage::view::{Camera, Up};

use super::Failure;
use super::parsers::degrees;

/// The camera that is asked for, if one is.
#[derive(Clone, Copy, Debug, clap::Args)]
pub(crate) struct ViewArgs {
    /// Position of the eye, in mesh units
    ///
    /// [default: the file's own camera; without one, a three-quarter view from the front, the right and above
    /// that shows everything]
    #[arg(long, value_name = "X,Y,Z", value_parser = parse_point, requires = "target", allow_hyphen_values = true)]
    eye: Option<[f32; 3]>,

    /// The point that the eye looks at, in mesh units, together with --eye [default: as for --eye]
    #[arg(long, value_name = "X,Y,Z", value_parser = parse_point, requires = "eye", allow_hyphen_values = true)]
    target: Option<[f32; 3]>,

    /// Vertical field of view in degrees, together with --eye [default: 35]
    #[arg(long, value_name = "DEG", requires = "eye", value_parser = degrees, allow_negative_numbers = true)]
    fov: Option<f32>,
}

impl ViewArgs {
    /// Whether the command line names any of it.
    pub(crate) fn was_asked_for(&self) -> bool {
        self.eye.is_some() || self.target.is_some() || self.fov.is_some()
    }

    /// The camera that was asked for.
    pub(crate) fn camera(&self, up: Up) -> Result<Option<Camera>, Failure> {
        let (Some(eye), Some(target)) = (self.eye, self.target) else { return Ok(None) };
        let fov = self.fov.map_or(Camera::DEFAULT_FOV_Y_RAD, f32::to_radians);
        Camera::look_at(eye, target, fov, up)
            .map(Some)
            .map_err(|error| Failure::new(error, "change --eye, --target or --fov"))
    }
}

fn parse_point(text: &str) -> Result<[f32; 3], String> {
    let numbers: Option<Vec<f32>> = text.split(',').map(|x| x.trim().parse().ok()).collect();
    let point: Option<[f32; 3]> = numbers.and_then(|numbers| numbers.try_into().ok());
    point
        .filter(|point| point.iter().all(|x| x.is_finite()))
        .ok_or_else(|| "write three finite numbers X,Y,Z in mesh units".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_are_three_finite_numbers() {
        assert_eq!(parse_point("1, -2.5,3e2"), Ok([1.0, -2.5, 300.0]));
        for text in ["", "1,2", "1,2,3,4", "1,2,nan", "1,2,inf", "a,b,c"] {
            assert!(parse_point(text).is_err(), "{text}");
        }
    }
}
