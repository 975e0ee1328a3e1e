//! `--all-frames`: what poses have that others do not.

use std::fmt;
use std::path::Path;

use serde_json::{Map, Value, json};
use umbrage::animate::{Clip, Moment, Pose};
use umbrage::check::{CrackReport, DefectKind, Requirement, Verdict};
use umbrage::scene::Scene;
use umbrage::topology::Topology;

use super::Args;
use super::report::verdict;
use crate::cli::color::Painter;
use crate::cli::output::{self, Table, counted, number, significant};
use crate::cli::progress::Progress;
use crate::cli::{Failure, pose};

/// All poses of a file.
pub(super) struct Frames {
    /// The name of the clip; `None` where the file stores frames.
    clip: Option<String>,
    all: Vec<Frame>,
}

/// A pose.
struct Frame {
    pose: Pose,
    verdict: Verdict,
    /// Of all meshes, in the order of [`DefectKind::ALL`]; `None` where it was not looked for.
    counts: [Option<usize>; KINDS],
}

const KINDS: usize = DefectKind::ALL.len();

/// A kind of defect over all poses.
struct Kind {
    kind: DefectKind,
    /// How many poses have it.
    frames: usize,
    /// Indices of the first such pose, and of the first of those with most of it.
    first: usize,
    worst: usize,
    most: usize,
}

impl Frames {
    /// Checks all poses of a scene; the scene at the first one.
    pub(super) fn check(
        scene: &Scene,
        args: &Args,
        file: &Path,
        requirements: &[Requirement],
    ) -> Result<(Scene, Self), Failure> {
        let poses = args.pose.keys(scene, file, "--all-frames")?;
        let clip = args.pose.clip(scene, file)?.unwrap_or(0);
        let clip = scene.rig.clips().get(clip).map(|clip: &Clip| clip.name().to_owned());
        let first = pose::posed(scene, &poses[0], file)?;
        let progress = Progress::bar(format!("checking {}", file.display()), poses.len() as u64).alone();
        output::noted(true); // the report on the first pose says all of it
        let mut topologies = Vec::new();
        let mut all = Vec::with_capacity(poses.len());
        let mut check = || -> Result<(), Failure> {
            for &pose in &poses {
                let posed = pose::posed(scene, &pose, file)?;
                all.push(frame(posed, pose, args, file, requirements, &mut topologies)?);
                progress.done(1);
            }
            Ok(())
        };
        let checked = check();
        output::noted(false);
        checked.map(|()| (first, Self { clip, all }))
    }

    /// The worst of any pose.
    pub(super) fn verdict(&self) -> Verdict {
        self.all.iter().map(|frame| frame.verdict).max().unwrap_or(Verdict::Sound)
    }

    /// The kinds of defects that a pose has.
    fn kinds(&self) -> Vec<Kind> {
        let of = |(index, kind): (usize, DefectKind)| {
            let count = |frame: &Frame| frame.counts[index].unwrap_or(0);
            let first = self.all.iter().position(|frame| count(frame) > 0)?;
            let most = self.all.iter().map(count).max()?;
            let worst = self.all.iter().position(|frame| count(frame) == most)?;
            let frames = self.all.iter().filter(|frame| count(frame) > 0).count();
            Some(Kind { kind, frames, first, worst, most })
        };
        DefectKind::ALL.into_iter().enumerate().filter_map(of).collect()
    }

    pub(super) fn to_json(&self) -> Value {
        let moment = |frame: &Frame| match (frame.pose.moment, &self.clip) {
            (Moment::Frame(frame), None) => (Value::from(frame), Value::Null),
            _ => (Value::Null, number(frame.pose.seconds())),
        };
        let list = self.all.iter().map(|one| {
            let (frame, time) = moment(one);
            let counts = DefectKind::ALL.into_iter().zip(one.counts);
            let counts: Map<String, Value> =
                counts.map(|(kind, count)| (kind.name().to_owned(), count.into())).collect();
            json!({ "frame": frame, "time": time, "verdict": one.verdict.name(), "defects": counts })
        });
        let kinds = self.kinds();
        let kinds = kinds.iter().map(|found| {
            let Kind { kind, frames, first, worst, most } = found;
            json!({ "kind": kind, "frames": frames, "first": first, "worst": worst, "most": most })
        });
        json!({
            "clip": self.clip,
            "count": self.all.len(),
            "verdict": self.verdict().name(),
            "kinds": kinds.collect::<Vec<_>>(),
            "list": list.collect::<Vec<_>>(),
        })
    }

    /// A pose for a person.
    fn label(&self, index: usize) -> String {
        let pose = self.all[index].pose;
        match (pose.moment, &self.clip) {
            (Moment::Frame(frame), None) => format!("frame {frame}"),
            _ => format!("{} s", significant(pose.seconds())),
        }
    }

    pub(super) fn print(&self, f: &mut fmt::Formatter<'_>, painter: Painter) -> fmt::Result {
        let count = self.all.len();
        let clip = self.clip.as_ref().map(|clip| format!(" of clip {}", output::short(clip)));
        let poses = format!("{}{}", counted(count, "pose", "poses"), clip.unwrap_or_default());
        let bad = self.all.iter().filter(|frame| frame.verdict != Verdict::Sound).count();
        let word = match self.verdict() {
            Verdict::Sound => painter.verdict(Verdict::Sound, "sound"),
            worst => painter.verdict(worst, worst.name()),
        };
        let kinds = self.kinds();
        match (bad, kinds.is_empty()) {
            (0, true) => return writeln!(f, "  {word}: {poses}, none with a defect"),
            (0, false) => writeln!(f, "  {word}: {poses}, with defects that are not asked about")?,
            _ => writeln!(f, "  {word}: {bad} of {poses}")?,
        }
        let mut table = Table::new(&["over all poses", "poses", "first at", "most", "at"]);
        for found in &kinds {
            let some = if found.frames < count { " (only some)" } else { "" };
            table.row(vec![
                format!("{}{some}", found.kind.name()),
                found.frames.to_string(),
                self.label(found.first),
                found.most.to_string(),
                self.label(found.worst),
            ]);
        }
        writeln!(f, "{table}")
    }
}

/// Checks a pose. Faces are the same in all of them, so that each mesh has one edge table; it is built anew
/// only if they are not.
fn frame(
    posed: Scene,
    pose: Pose,
    args: &Args,
    file: &Path,
    requirements: &[Requirement],
    topologies: &mut Vec<Topology>,
) -> Result<Frame, Failure> {
    let scene = args.mesh.chosen(posed, file)?;
    let spaces = args.mesh.own_spaces(scene, file)?;
    let searches = requirements.contains(&Requirement::NoSelfIntersections);
    let nothing = if requirements.contains(&Requirement::NotEmpty) { Verdict::Empty } else { Verdict::Sound };
    let mut worst = None;
    let mut counts = [None; KINDS];
    for (index, space) in spaces.into_iter().enumerate() {
        let mesh = args.mesh.weld(space.mesh).mesh;
        let same = |topology: &Topology| topology.triangles() == mesh.triangles();
        match topologies.get_mut(index) {
            Some(topology) if same(topology) => {}
            Some(topology) => *topology = Topology::of(&mesh),
            None => topologies.push(Topology::of(&mesh)),
        }
        let topology = &topologies[index];
        let mut report = CrackReport::of(&mesh, topology);
        if searches {
            report.add_self_intersections(&mesh, topology, 0);
        }
        let verdict = verdict(requirements, &report.counts);
        worst = Some(worst.map_or(verdict, |worst: Verdict| worst.max(verdict)));
        for (sum, kind) in counts.iter_mut().zip(DefectKind::ALL) {
            if let Some(count) = report.count(kind) {
                *sum = Some(sum.unwrap_or(0) + count);
            }
        }
    }
    Ok(Frame { pose, verdict: worst.unwrap_or(nothing), counts })
}
