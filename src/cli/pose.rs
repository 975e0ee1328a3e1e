//! `--time`, `--frame`, `--clip`, `--fps`: the moment at which a scene is looked at.

use std::path::Path;

use umbrage::animate::{Clip, Moment, Pose};
use umbrage::scene::Scene;

use super::{Failure, output};

/// The moment of a scene that moves.
#[derive(Clone, Debug, Default, clap::Args)]
pub(crate) struct PoseArgs {
    /// Pose the scene at this time, in seconds from time 0 of the clip; beyond the ends of the clip they are
    /// held [default: not posed: a skinned mesh in its bind pose, the first frame of md2]
    ///
    /// Skins, morph targets, and nodes with their lights and cameras move. Which vertices are one does not
    /// depend on the time: those that coincide at rest and that the clip moves alike.
    #[arg(long, value_name = "T", value_parser = seconds, allow_negative_numbers = true, conflicts_with = "frame")]
    time: Option<f64>,

    /// Pose the scene at this frame, from 0: of md2 a frame of the file, of glTF frame N at --fps
    /// [default: not posed]
    #[arg(long, value_name = "N", value_parser = frame, allow_negative_numbers = true)]
    frame: Option<u32>,

    /// The clip, by its name or by its number from 1; without --time and --frame at its beginning
    /// [default: the first]
    #[arg(long, value_name = "NAME|N")]
    clip: Option<String>,

    /// Frames a second: how long a frame is, for --frame of glTF and --time of md2 [default: 24]
    #[arg(long, value_name = "N", value_parser = rate, allow_negative_numbers = true)]
    fps: Option<f64>,
}

pub(crate) fn seconds(text: &str) -> Result<f64, String> {
    let seconds = text.parse().ok().filter(|seconds: &f64| seconds.is_finite());
    seconds.ok_or_else(|| "write a finite number of seconds".to_owned())
}

fn frame(text: &str) -> Result<u32, String> {
    text.parse().map_err(|_| format!("write a whole number from 0 to {}", u32::MAX))
}

/// The largest rate: beyond it, frames fall together in the times of a file, which are of 32 bits.
const MOST_RATE: f64 = 1e6;

fn rate(text: &str) -> Result<f64, String> {
    let rate = text.parse().ok().filter(|&rate: &f64| rate > 0.0 && rate <= MOST_RATE);
    rate.ok_or_else(|| "write a number of frames above 0, at most 1e6".to_owned())
}

impl PoseArgs {
    /// The first option that is asked for.
    pub(crate) fn asked(&self) -> Option<&'static str> {
        let asked = [
            ("--time", self.time.is_some()),
            ("--frame", self.frame.is_some()),
            ("--clip", self.clip.is_some()),
            ("--fps", self.fps.is_some()),
        ];
        asked.into_iter().find(|(_, is_asked)| *is_asked).map(|(option, _)| option)
    }

    /// The scene at the moment that is asked for; as it is if none is.
    pub(crate) fn apply(&self, scene: Scene, file: &Path) -> Result<Scene, Failure> {
        if self.time.is_none() && self.frame.is_none() && self.clip.is_none() {
            return match self.fps {
                None => Ok(scene),
                Some(_) => {
                    Err(Failure::new("--fps without a moment", "add --time or --frame, or leave out --fps"))
                }
            };
        }
        let clip = self.clip(&scene, file)?;
        let moment = match (self.time, self.frame) {
            (Some(time), _) => Moment::Seconds(time),
            (None, Some(frame)) => Moment::Frame(frame),
            (None, None) => {
                let clip = clip.and_then(|clip| scene.rig.clips().get(clip));
                Moment::Seconds(clip.map_or(0.0, |clip| clip.span()[0]))
            }
        };
        posed(&scene, &Pose { clip, moment, fps: self.fps() }, file)
    }

    /// Frames a second.
    pub(crate) fn fps(&self) -> f64 {
        self.fps.unwrap_or(Pose::FPS)
    }

    /// The clip that is asked for.
    pub(crate) fn clip(&self, scene: &Scene, file: &Path) -> Result<Option<usize>, Failure> {
        let Some(wanted) = &self.clip else { return Ok(None) };
        let clips = scene.rig.clips();
        let named = clips.iter().position(|clip| clip.name() == wanted && !wanted.is_empty());
        let numbered = || wanted.parse::<usize>().ok()?.checked_sub(1).filter(|&index| index < clips.len());
        match named.or_else(numbered) {
            Some(index) => Ok(Some(index)),
            None => Err(no_such(wanted, clips).in_file(file)),
        }
    }
}

/// The most frames that are drawn or checked: ten minutes at 16 a second.
pub(crate) const MOST_FRAMES: usize = 10_000;

impl PoseArgs {
    /// All moments from one time to another, one each frame length; by default those of the whole clip, or
    /// all frames of the file. `option` is what asks for them.
    pub(crate) fn frames(
        &self,
        scene: &Scene,
        file: &Path,
        option: &str,
        from: Option<f64>,
        to: Option<f64>,
    ) -> Result<Vec<Pose>, Failure> {
        let (clip, fps) = (self.clip(scene, file)?, self.fps());
        let (last, chosen) = (scene.last_frame(), scene.rig.clips().get(clip.unwrap_or(0)));
        let span = match chosen {
            Some(clip) => clip.span(),
            None if last > 0 => [0.0, last as f64 / fps],
            None => {
                let problem = format!("{option}: nothing in the file moves over time: no clip, no frames");
                return Err(Failure::new(problem, format!("leave out {option}")).in_file(file));
            }
        };
        let (from, to) = (from.unwrap_or(span[0]), to.unwrap_or(span[1]));
        if to < from {
            let problem = format!("--to {to} is before --from {from}");
            return Err(Failure::new(problem, "exchange them").in_file(file));
        }
        if from < span[0] || to > span[1] {
            output::say(format_args!(
                "note: {}: the clip lasts from {} to {} s; outside, its ends are held",
                file.display(),
                span[0],
                span[1]
            ));
        }
        // A time of a file is rounded to 32 bits: that part of it may be missing at the last frame.
        let frames = (to - from) * fps * (1.0 + f64::from(f32::EPSILON));
        if frames >= MOST_FRAMES as f64 {
            return Err(too_many((frames as usize).saturating_add(1), option).in_file(file));
        }
        let first = from * fps;
        let moment = |frame: u32| match first.fract() == 0.0 && first >= 0.0 && last > 0 {
            true => Moment::Frame((first as u32).saturating_add(frame).min(last as u32)),
            false => Moment::Seconds((from + f64::from(frame) / fps).min(to)),
        };
        Ok((0..=frames as u32).map(|frame| Pose { clip, moment: moment(frame), fps }).collect())
    }

    /// The moments of all keys of the clip; all frames of the file; or, where --fps is given, one each frame
    /// length.
    pub(crate) fn keys(&self, scene: &Scene, file: &Path, option: &str) -> Result<Vec<Pose>, Failure> {
        let clip = self.clip(scene, file)?;
        let keys = scene.rig.clips().get(clip.unwrap_or(0)).map(Clip::key_times).unwrap_or_default();
        if self.fps.is_some() || keys.is_empty() {
            return self.frames(scene, file, option, None, None);
        }
        if keys.len() > MOST_FRAMES {
            return Err(too_many(keys.len(), option).in_file(file));
        }
        let pose = |time: f64| Pose { clip, ..Pose::at(time) };
        Ok(keys.into_iter().map(pose).collect())
    }
}

fn too_many(frames: usize, option: &str) -> Failure {
    let problem = format!("{option}: {frames} frames are too many (at most {MOST_FRAMES})");
    let remedy =
        if option == "--animate" { "choose a smaller --fps, or --from and --to" } else { "choose --fps" };
    Failure::new(problem, remedy)
}

/// A scene at a moment.
pub(crate) fn posed(scene: &Scene, pose: &Pose, file: &Path) -> Result<Scene, Failure> {
    scene.pose(pose).map_err(|error| {
        let line = error.to_string();
        // Problems of the file have a remedy of their own.
        let failure = match line.split_once("; ") {
            Some((problem, remedy)) => Failure::new(problem, remedy),
            None => Failure::new(line, error.remedy()),
        };
        failure.in_file(file)
    })
}

/// How many names a message lists.
const NAMES: usize = 8;

fn no_such(wanted: &str, clips: &[Clip]) -> Failure {
    let problem = format!("--clip {wanted}: the file has no such clip");
    let mut names: Vec<String> = clips.iter().take(NAMES).map(|clip| output::short(clip.name())).collect();
    if clips.len() > NAMES {
        names.push(format!("{} more", clips.len() - NAMES));
    }
    match clips.len() {
        0 => Failure::new(format!("{problem}, nor any other"), "leave out --clip"),
        count => {
            let names = names.join(", ");
            Failure::new(problem, format!("use a number from 1 to {count}, or a name: {names}"))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use umbrage::testing::shapes;

    #[test]
    fn moments_that_are_none_are_told_what_to_write() {
        assert_eq!((seconds("-1.5"), frame("7"), rate("23.976")), (Ok(-1.5), Ok(7), Ok(23.976)));
        let errors = [seconds("nan").err(), seconds("inf").err(), frame("-1").err(), frame("1.5").err()];
        for error in errors.into_iter().chain([rate("0").err(), rate("1e7").err(), rate("nan").err()]) {
            assert!(error.is_some_and(|text| text.starts_with("write ")));
        }
    }

    #[test]
    fn clip_that_is_none_and_a_frame_beyond_the_end_name_the_remedy() {
        let cube = shapes::cube();
        let frames = vec![cube.positions().to_vec()];
        let scene = Scene::of(cube.with_frames(frames).unwrap());
        let args = |clip: Option<&str>, frame| PoseArgs {
            clip: clip.map(str::to_owned),
            frame,
            ..PoseArgs::default()
        };
        let error = |args: PoseArgs| args.apply(scene.clone(), Path::new("a")).unwrap_err().to_string();
        assert_eq!(
            error(args(Some("walk"), None)),
            "a: --clip walk: the file has no such clip, nor any other; leave out --clip"
        );
        assert_eq!(
            error(args(None, Some(2))),
            "a: there is no frame 2: the last one is 1; choose a frame of the file"
        );
        assert!(args(None, Some(1)).apply(scene.clone(), Path::new("a")).is_ok());
        assert!(error(PoseArgs { fps: Some(3.0), ..PoseArgs::default() }).contains("without a moment"));
    }
}
