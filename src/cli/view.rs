//! The camera of a picture.

use std::path::Path;

use umbrage::geom::Aabb;
use umbrage::scene::{LeftOutCamera, NamedCamera, Scene};
use umbrage::view::{Camera, Size, Up};

use super::parsers::{degrees, distance};
use super::{Failure, output};

/// The camera that is asked for, if one is.
#[derive(Clone, Debug, clap::Args)]
pub(crate) struct ViewArgs {
    /// Position of the eye, in mesh units
    ///
    /// For example: --eye 3,2,8 --target 0,1,0. [default: the file's own camera; without one, a three-quarter
    /// view from the front, the right and above that shows everything]
    #[arg(long, value_name = "X,Y,Z", value_parser = parse_point, requires = "target", allow_hyphen_values = true)]
    eye: Option<[f32; 3]>,

    /// The point that the eye looks at, in mesh units, together with --eye [default: as for --eye]
    #[arg(long, value_name = "X,Y,Z", value_parser = parse_point, requires = "eye", allow_hyphen_values = true)]
    target: Option<[f32; 3]>,

    /// Vertical field of view in degrees, together with --eye [default: 35]
    #[arg(long, value_name = "DEG", requires = "eye", value_parser = degrees, allow_negative_numbers = true)]
    fov: Option<f32>,

    /// Parallel rays instead of perspective, and the height of what they see in mesh units; together with
    /// --eye
    ///
    /// For example, a plan: --eye 0,10,0 --target 0,0,0 --ortho 6. A stencil pass cannot draw it yet: rays
    /// do. [default: perspective]
    #[arg(long, value_name = "HEIGHT", requires = "eye", conflicts_with = "fov", value_parser = distance, allow_negative_numbers = true)]
    ortho: Option<f32>,

    /// A camera of the file, by its name or by its number from 1 [default: the first]
    #[arg(long, value_name = "NAME|N", conflicts_with = "eye")]
    camera: Option<String>,

    /// Nothing nearer to the eye than this, in mesh units, is seen
    ///
    /// [default: that of the file's camera; without one, so near that nothing that is seen is cut away]
    #[arg(long, value_name = "D", value_parser = distance, allow_negative_numbers = true)]
    near: Option<f32>,
}

/// The cameras of a file.
#[derive(Clone, Debug, Default)]
pub(crate) struct Cameras {
    usable: Vec<NamedCamera>,
    left_out: Vec<LeftOutCamera>,
}

impl Cameras {
    /// Those of a scene, which keeps none.
    pub(crate) fn take(scene: &mut Scene) -> Self {
        let take = std::mem::take::<Vec<NamedCamera>>;
        Self { usable: take(&mut scene.cameras), left_out: std::mem::take(&mut scene.left_out_cameras) }
    }

    fn count(&self) -> usize {
        self.usable.len() + self.left_out.len()
    }

    /// The camera of this name, or else of this number, counted from 1 over all that the file has.
    fn named(&self, wanted: &str) -> Result<Camera, Failure> {
        let number = wanted.parse::<usize>().unwrap_or(0);
        let usable = self.usable.iter().find(|camera| camera.name == wanted);
        let left_out = self.left_out.iter().find(|camera| camera.name == wanted);
        let before = self.left_out.iter().filter(|camera| camera.number < number).count();
        match (usable, left_out.or(self.left_out.iter().find(|camera| camera.number == number))) {
            (Some(found), _) => Ok(found.camera),
            (None, Some(left_out)) => {
                let problem = format!("--camera {wanted}: the camera cannot be used: {}", left_out.problem);
                Err(Failure::new(problem, "choose another camera, or use --eye and --target"))
            }
            (None, None) => match number.checked_sub(1 + before).and_then(|index| self.usable.get(index)) {
                Some(found) => Ok(found.camera),
                None => Err(self.no_such(wanted)),
            },
        }
    }

    fn no_such(&self, wanted: &str) -> Failure {
        let problem = format!("--camera {wanted}: the file has no such camera");
        let mut names: Vec<_> =
            self.usable.iter().take(NAMES).map(|camera| output::short(&camera.name)).collect();
        if self.usable.len() > NAMES {
            names.push(format!("{} more", self.usable.len() - NAMES));
        }
        match (self.count(), names.is_empty()) {
            (0, _) => Failure::new(
                format!("{problem}, nor any other"),
                "leave out --camera, or use --eye and --target",
            ),
            (_, true) => Failure::new(
                format!("{problem}, nor any that can be used"),
                "leave out --camera, or use --eye and --target",
            ),
            (count, false) => {
                let names = names.join(", ");
                Failure::new(problem, format!("use a number from 1 to {count}, or a name: {names}"))
            }
        }
    }
}

impl ViewArgs {
    /// Whether the command line names any of it.
    pub(crate) fn was_asked_for(&self) -> bool {
        self.eye.is_some() || self.camera.is_some() || self.near.is_some()
    }

    /// Refuses what is no camera, before any file is read.
    pub(crate) fn refuse(&self) -> Result<(), Failure> {
        self.described(Up::Y).map(|_| ())
    }

    /// The camera that was asked for, else the file's first, else one that shows all of `bounds`.
    pub(crate) fn choose(
        &self,
        of_file: &Cameras,
        file: &Path,
        bounds: &Aabb,
        up: Up,
        size: Size,
    ) -> Result<Camera, Failure> {
        let camera = match (self.described(up)?, &self.camera, &of_file.usable[..]) {
            (Some(camera), ..) => camera,
            (None, Some(wanted), _) => of_file.named(wanted).map_err(|failure| failure.in_file(file))?,
            (None, None, [first, ..]) => {
                output::say("note: no --eye: using the camera of the file");
                first.camera
            }
            (None, None, []) => Camera::fit(bounds, up, size.aspect()),
        };
        match self.near {
            None => Ok(camera),
            Some(near) => camera.with_near(near).map_err(|error| Failure::new(error, "change --near")),
        }
    }

    /// The camera that --eye and what goes with it describe.
    fn described(&self, up: Up) -> Result<Option<Camera>, Failure> {
        let (Some(eye), Some(target)) = (self.eye, self.target) else { return Ok(None) };
        let fov = self.fov.map_or(Camera::DEFAULT_FOV_Y_RAD, f32::to_radians);
        let camera = Camera::look_at(eye, target, fov, up).and_then(|camera| match self.ortho {
            Some(height) => camera.orthographic(height),
            None => Ok(camera),
        });
        camera.map(Some).map_err(|error| Failure::new(error, "change --eye, --target or --fov"))
    }
}

/// How many names a message lists.
const NAMES: usize = 8;

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

    #[test]
    fn camera_of_a_file_is_found_by_name_then_by_number() {
        let camera = |x: f32| Camera::look_at([x, 0.0, 5.0], [0.0; 3], 1.0, Up::Y).unwrap();
        let cameras = [("front", 1.0), ("2", 2.0), ("", 3.0)];
        let cameras = cameras.map(|(name, x)| NamedCamera { name: name.to_owned(), camera: camera(x) });
        let all = Cameras { usable: cameras.to_vec(), left_out: Vec::new() };
        for (wanted, x) in [("front", 1.0), ("1", 1.0), ("2", 2.0), ("3", 3.0), ("", 3.0)] {
            assert_eq!(all.named(wanted), Ok(camera(x)), "{wanted}");
        }
        for wanted in ["0", "4", "back", "-1"] {
            let line = all.named(wanted).unwrap_err().to_string();
            assert!(line.contains("; use a number from 1 to 3, or a name: front, 2"), "{line}");
        }
        let line = Cameras::default().named("1").unwrap_err().to_string();
        assert!(line.contains("nor any other; leave out --camera"), "{line}");
        let many = Cameras { usable: vec![cameras[0].clone(); 20], left_out: Vec::new() };
        assert!(many.named("x").unwrap_err().to_string().ends_with("front, 12 more"));
    }

    #[test]
    fn camera_that_was_left_out_keeps_its_number_and_says_why() {
        let camera = |x: f32| Camera::look_at([x, 0.0, 5.0], [0.0; 3], 1.0, Up::Y).unwrap();
        let named = |name: &str, x: f32| NamedCamera { name: name.to_owned(), camera: camera(x) };
        let left_out = |name: &str, number: usize| LeftOutCamera {
            name: name.to_owned(),
            number,
            problem: format!("its yfov is {number}"),
        };
        let cameras = Cameras {
            usable: vec![named("b", 2.0), named("d", 4.0)],
            left_out: vec![left_out("a", 1), left_out("c", 3)],
        };
        for (wanted, x) in [("b", 2.0), ("2", 2.0), ("d", 4.0), ("4", 4.0)] {
            assert_eq!(cameras.named(wanted), Ok(camera(x)), "{wanted}");
        }
        for (wanted, number) in [("a", 1), ("1", 1), ("c", 3), ("3", 3)] {
            let line = cameras.named(wanted).unwrap_err().to_string();
            assert!(line.contains(&format!("the camera cannot be used: its yfov is {number}; ")), "{line}");
        }
        assert!(cameras.named("5").unwrap_err().to_string().contains("from 1 to 4, or a name: b, d"));
        let none = Cameras { usable: Vec::new(), ..cameras };
        assert!(none.named("x").unwrap_err().to_string().contains("nor any that can be used; leave out"));
    }
}
