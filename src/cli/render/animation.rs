//! `--animate`: a picture for each frame.

use std::path::{Path, PathBuf};

use umbrage::animate::Pose;
use umbrage::geom::Aabb;
use umbrage::render::{AnimatedPng, Picture};
use umbrage::scene::Scene;
use umbrage::write::{WriteError, write_atomic};

use super::{Args, draw};
use crate::cli::parsers::{refuse_overwriting, require_folder};
use crate::cli::progress::Progress;
use crate::cli::{Failure, Outcome, load, output, pose};

/// Where the pictures go.
enum Names {
    /// One file each: what stands before and behind the number, and its digits.
    Numbered { before: String, digits: usize, behind: String },
    /// One file.
    Animated(PathBuf),
}

impl Names {
    fn parse(pattern: &Path) -> Result<Self, Failure> {
        let refused = |problem: &str, remedy: &str| {
            Err(Failure::new(format!("--animate: {problem}"), remedy).in_file(pattern))
        };
        let extension = pattern.extension().and_then(|extension| extension.to_str()).unwrap_or_default();
        let (png, apng) = (extension.eq_ignore_ascii_case("png"), extension.eq_ignore_ascii_case("apng"));
        let name = pattern.file_name().and_then(|name| name.to_str()).unwrap_or_default();
        let Some((before, rest)) = name.split_once('%') else {
            return match png || apng {
                true => Ok(Self::Animated(pattern.to_owned())),
                false => {
                    refused("pictures are written as PNG only", "name a file that ends in .png or .apng")
                }
            };
        };
        let number = rest.split_once('d').and_then(|(width, behind)| {
            let digits = if width.is_empty() { Some(1) } else { width.strip_prefix('0')?.parse().ok() };
            digits.filter(|digits| (1..=9).contains(digits)).map(|digits| (digits, behind))
        });
        match number {
            Some((digits, behind)) if png && !behind.contains('%') => Ok(Self::Numbered {
                before: pattern.with_file_name(before).to_string_lossy().into_owned(),
                digits,
                behind: behind.to_owned(),
            }),
            Some((_, behind)) if !behind.contains('%') => refused(
                "numbered pictures are PNG files",
                "name files that end in .png, such as OUT_%04d.png",
            ),
            _ => refused("% in the name is no number of a frame", "write one number, as in OUT_%04d.png"),
        }
    }

    fn of(&self, frame: usize) -> PathBuf {
        match self {
            Self::Numbered { before, digits, behind } => format!("{before}{frame:0digits$}{behind}").into(),
            Self::Animated(path) => path.clone(),
        }
    }
}

pub(super) fn run(args: &Args, pattern: &Path) -> Result<Outcome, Failure> {
    let names = Names::parse(pattern)?;
    let file = &args.source.file;
    require_folder(&names.of(0))?;
    args.view.refuse()?; // before the file is read
    if let Some(path) = args.shadow.plan()? {
        let problem = format!("--shadow {}: a saved plan is for one picture", path.display());
        return Err(Failure::new(problem, "leave out --animate, or use --shadow auto"));
    }
    let renderer = args.shadow.settle(&args.adapter, args.ambient)?;
    args.threads.apply()?;
    let scene = load::read_whole(file)?;
    let poses = args.source.pose.frames(&scene, file, "--animate", args.from, args.to)?;
    for frame in 0..poses.len() {
        refuse_overwriting("--animate", Some(&names.of(frame)), file)?;
    }

    let result = pictures(args, &scene, &poses, &names, |source| draw(args, &renderer, None, source));
    output::noted(false);
    let outcome = result?;
    let (first, last) = (names.of(0), names.of(poses.len() - 1));
    match first == last {
        true => output::wrote(&first),
        false => output::say(format_args!(
            "wrote {} pictures, {} to {}",
            poses.len(),
            output::plain(&first.to_string_lossy()),
            output::plain(&last.to_string_lossy())
        )),
    }
    Ok(outcome)
}

/// Draws and writes all pictures. The worst outcome of any.
fn pictures(
    args: &Args,
    scene: &Scene,
    poses: &[Pose],
    names: &Names,
    draw: impl Fn(crate::cli::input::Source) -> Result<(Picture, Outcome), Failure>,
) -> Result<Outcome, Failure> {
    let file = &args.source.file;
    let progress = Progress::bar("rendering", 2 * poses.len() as u64).alone();
    // What all frames show together: one camera and one light for all of them.
    let mut bounds = Aabb::EMPTY;
    output::noted(true); // until the first picture
    for pose in poses {
        let posed = pose::posed(scene, pose, file)?;
        let (baked, receivers) = args.source.mesh.visible(posed, file, args.source.cast.no_cast())?;
        for mesh in baked.meshes.iter().chain(&receivers) {
            bounds = bounds.join(&load::bounds(mesh));
        }
        progress.done(1);
    }
    let mut outcome = Outcome::Sound;
    let mut picture = |index: usize| -> Result<Picture, Failure> {
        output::noted(index > 0);
        let source = args.source.of(pose::posed(scene, &poses[index], file)?, Some(bounds))?;
        let (picture, one) = draw(source)?;
        output::noted(true);
        outcome = outcome.max(one);
        progress.done(1);
        Ok(picture)
    };
    match names {
        Names::Numbered { .. } => {
            for index in 0..poses.len() {
                picture(index)?.write_png(names.of(index))?;
            }
        }
        Names::Animated(path) => {
            let mut failed = None;
            let written = write_atomic(path, |out| -> Result<(), WriteError> {
                let fps = args.source.pose.fps();
                let mut animated = AnimatedPng::new(out, args.size, poses.len() as u32, fps)?;
                for index in 0..poses.len() {
                    match picture(index) {
                        Ok(picture) => animated.add(&picture)?,
                        Err(failure) => {
                            failed = Some(failure);
                            return Err(std::io::Error::other("a picture cannot be drawn").into());
                        }
                    }
                }
                Ok(animated.finish()?)
            });
            match failed {
                Some(failure) => return Err(failure),
                None => written?,
            }
        }
    }
    Ok(outcome)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_have_one_number_or_are_one_file() {
        let of = |text: &str, frame| Names::parse(Path::new(text)).map(|names| names.of(frame));
        assert_eq!(of("a/b_%04d.png", 12), Ok("a/b_0012.png".into()));
        assert_eq!(of("%d.PNG", 7), Ok("7.PNG".into()));
        assert_eq!(of("50%/walk.png", 7), Ok("50%/walk.png".into()));
        assert_eq!(of("walk.apng", 7), Ok("walk.apng".into()));
        for (text, remedy) in [
            ("a.gif", "name a file that ends in .png or .apng"),
            ("a_%04d.apng", "such as OUT_%04d.png"),
            ("a_%4d.png", "write one number"),
            ("a_%s.png", "write one number"),
            ("a_%d_%d.png", "write one number"),
            ("50%.png", "write one number"),
            ("a_%099d.png", "write one number"),
        ] {
            let line = of(text, 0).unwrap_err().to_string();
            assert!(line.contains(remedy), "{text}: {line}");
        }
    }
}
