//! The commands that a user would type, one after the other, in the folder of the demo.

use std::ffi::OsString;
use std::path::Path;
use std::process::Command;

use crate::cli::output::Output;
use crate::cli::{Failure, child};

/// A lamp as large as a lampshade, and a sun somewhat larger than ours.
const LAMPS: &str = "--light point:-3.5,6,5,radius=0.5 --light directional:-0.9,-1,-0.75,angle=1";
const VIEW: &str = "--eye 2.2,3.9,9.6 --target 0.1,1.15,0 --fov 34";

/// Some of each kind: all of them take a minute.
const TECHNIQUES: &str = "--shadow area --shadow rays --shadow samples:n=16 --shadow map --shadow pcf --shadow pcss \
                          --shadow single-sample --shadow vsm";

/// A command, and what to open afterwards.
struct Stop {
    says: &'static str,
    command: String,
    opens: &'static str,
}

fn stops() -> Vec<Stop> {
    let stop = |says, command: &str, opens| Stop { says, command: command.to_owned(), opens };
    vec![
        stop("A caster mesh, with every change listed.", "prepare scene.glb -o caster.glb", "caster.glb"),
        stop(
            "The silhouette, as a picture.",
            &format!(
                "silhouette scene.glb --light point:-3.5,6,5 {VIEW} --size 640x360 --picture silhouette.png"
            ),
            "silhouette.png",
        ),
        stop(
            "The shadow volume of the knot.",
            "volume scene.glb --only torus* --light point:-3.5,6,5 --size 640x360 --picture volume.png",
            "volume.png",
        ),
        stop(
            "Which shadows this scene calls for, and why.",
            &format!("plan scene.glb {LAMPS} {VIEW} --size 320x180"),
            "",
        ),
        stop(
            "Soft shadows and ambient occlusion.",
            &format!("render scene.glb {LAMPS} {VIEW} --shadow area --ambient --size 400x225 -o title.png"),
            "title.png",
        ),
        stop(
            "Techniques: the error of each beside its time.",
            &format!(
                "accuracy shadow scene.glb {LAMPS} {VIEW} {TECHNIQUES} --size 80x45 --rounds 1 --html accuracy.html"
            ),
            "accuracy.html",
        ),
        stop(
            "Things that move.",
            &format!(
                "render moving.glb {VIEW} --light point:-3.5,6,5 --shadow rays --size 240x135 --fps 8 --animate moving.png"
            ),
            "moving.png",
        ),
    ]
}

/// Runs them, each printed before; the files to open.
pub(super) fn run(folder: &Path, out: &mut Output) -> Result<Vec<&'static str>, Failure> {
    let mut opens = Vec::new();
    for stop in stops() {
        // A shell would take the star for names of files.
        let typed = stop.command.replace("torus*", "'torus*'");
        out.text(format_args!("\n{}\n$ umbrage {typed}\n", stop.says))?;
        out.flush()?;
        let is_file = |word: &str| [".glb", ".png", ".html"].iter().any(|end| word.ends_with(end));
        let words = stop.command.split(' ').map(|word| match is_file(word) {
            true => folder.join(word).into_os_string(),
            false => OsString::from(word),
        });
        // A process of its own, as for a user.
        let started = std::env::current_exe()
            .and_then(|program| child::start(Command::new(program).args(words)).map(|_| child::wait(None)));
        let failed = |problem: String| {
            let problem = format!("umbrage {}: {problem}", stop.command);
            Failure::new(problem, "see the message above, or leave the tour out with --short")
        };
        // What a command finds is no failure of the demo: two of the meshes are open.
        match started.map_err(|error| failed(error.to_string()))? {
            Some(status) if matches!(status.code(), Some(0 | 1)) => {}
            Some(status) => return Err(failed(format!("ended with {status}"))),
            None => return Err(failed("its end was not seen".to_owned())),
        }
        opens.extend((!stop.opens.is_empty()).then_some(stop.opens));
    }
    Ok(opens)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::parse;

    #[test]
    fn every_command_of_the_tour_is_one() {
        for stop in stops() {
            let words = ["umbrage"].into_iter().chain(stop.command.split(' ')).map(OsString::from);
            assert!(parse(words).is_ok(), "{}", stop.command);
        }
        // Fault injected: a command that there is not.
        assert!(parse(["umbrage", "prepared"].map(OsString::from)).is_err());
    }
}
