//! A plan in a file, and the scene, lamps and view that it is for.

use std::fs;
use std::path::Path;

use serde_json::{Value, json};
use umbrage::mesh::Mesh;
use umbrage::plan::{Budget, Receivers, ShadowPlan, Task};
use umbrage::view::{Camera, Size};

use super::FalloffArg;
use super::document::receivers;
use crate::cli::Failure;
use crate::cli::input::Source;
use crate::cli::output::number;

/// What a plan is for. Each part is named if it differs.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Identity {
    parts: [(&'static str, String); 4],
}

/// A plan as it was saved.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Saved {
    pub(crate) tasks: Vec<Task>,
    pub(crate) budget: Budget,
    identity: Vec<(String, String)>,
}

impl Identity {
    pub(crate) fn of(source: &Source, camera: &Camera, size: Size, falloff: FalloffArg) -> Self {
        let [seen, casting] = [source.seen(), &source.caster].map(|caster| fingerprint(caster.mesh()));
        let lamps = source
            .lights
            .iter()
            .map(|lamp| format!("{lamp} {:?} {} {:?}", lamp.color, lamp.intensity, lamp.name));
        let falloff = if falloff == FalloffArg::Physical { "physical" } else { "plain" };
        Self {
            parts: [
                ("scene", format!("{seen} {casting}")),
                ("lamps", lamps.collect::<Vec<_>>().join("; ")),
                ("view", format!("{camera:?} {size}")),
                ("falloff", falloff.to_owned()),
            ],
        }
    }
}

/// Faces, and a number that depends on every index and every bit of a coordinate: the hash of Fowler, Noll
/// and Vo. Two scenes that were not made to collide share one with a probability of 2⁻⁶⁴.
fn fingerprint(mesh: &Mesh) -> String {
    let indices = mesh.triangles().iter().flatten().copied();
    let coordinates = mesh.positions().iter().flatten().map(|x| x.to_bits());
    let hash = indices
        .chain(coordinates)
        .flat_map(u32::to_le_bytes)
        .fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3));
    format!("{} faces {hash:016x}", mesh.face_count())
}

/// The document of a plan with what running it needs.
pub(super) fn document(mut document: Value, plan: &ShadowPlan, identity: &Identity) -> Value {
    let lamp = |task: Task| {
        let groups = task.groups.iter().map(|&(group, technique)| {
            json!({ "receivers": receivers(group), "technique": technique.to_string() })
        });
        json!({
            "kept": task.kept,
            "groups": groups.collect::<Vec<_>>(),
            "bound": number(task.bound),
            "void": task.is_void,
        })
    };
    let lamps: Vec<Value> = Task::of(plan).into_iter().map(lamp).collect();
    let mut saved = json!({ "budget": plan.budget.to_string(), "lights": lamps });
    for (name, value) in &identity.parts {
        saved[*name] = value.as_str().into();
    }
    document["saved"] = saved;
    document
}

const REMEDY: &str = "write it anew with `umbrage plan SCENE -o plan.json`";

impl Saved {
    pub(crate) fn read(path: &Path) -> Result<Self, Failure> {
        let text = fs::read_to_string(path).map_err(|error| {
            Failure::new(
                format_args!("the plan cannot be read: {error}"),
                "name a file that `umbrage plan -o` wrote",
            )
            .in_file(path)
        })?;
        Self::parse(&text).map_err(|problem| Failure::new(problem, REMEDY).in_file(path))
    }

    fn parse(text: &str) -> Result<Self, String> {
        let document: Value = serde_json::from_str(text).map_err(|error| format!("no JSON: {error}"))?;
        let saved = &document["saved"];
        let word = |value: &Value, name: &str| {
            value[name]
                .as_str()
                .map(str::to_owned)
                .ok_or_else(|| format!("no saved plan: it has no `{name}`"))
        };
        let identity = ["scene", "lamps", "view", "falloff"]
            .map(|name| word(saved, name).map(|value| (name.to_owned(), value)))
            .into_iter()
            .collect::<Result<Vec<_>, String>>()?;
        let budget = word(saved, "budget")?.parse().map_err(|error| format!("{error}"))?;
        let lamps = saved["lights"].as_array().ok_or("no saved plan: it has no `lights`")?;
        let task = |lamp: &Value| {
            let groups = lamp["groups"].as_array().filter(|groups| !groups.is_empty());
            let groups = groups.ok_or("no saved plan: a light has no `groups`")?.iter().map(|group| {
                let name = word(group, "receivers")?;
                let all = [Receivers::All, Receivers::Plane, Receivers::Others];
                let found = all.into_iter().find(|&one| receivers(one) == name);
                let found = found.ok_or_else(|| format!("there are no receivers `{name}`"))?;
                let technique = word(group, "technique")?.parse().map_err(|error| format!("{error}"))?;
                Ok((found, technique))
            });
            let groups: Vec<_> = groups.collect::<Result<_, String>>()?;
            let mut task = Task::new(groups[0].1);
            task.groups = groups;
            task.bound = lamp["bound"].as_f64().filter(|bound| (0.0..=1.0).contains(bound)).unwrap_or(0.0);
            task.is_void = lamp["void"].as_bool().unwrap_or(false);
            task.kept = match &lamp["kept"] {
                Value::Array(pieces) => {
                    let number = |piece: &Value| piece.as_u64().and_then(|piece| u32::try_from(piece).ok());
                    let pieces: Option<Vec<u32>> = pieces.iter().map(number).collect();
                    let pieces = pieces.filter(|pieces| pieces.is_sorted_by(|a, b| a < b));
                    Some(pieces.ok_or("`kept` is no list of ascending numbers")?)
                }
                _ => None,
            };
            Ok(task)
        };
        let tasks = lamps.iter().map(task).collect::<Result<_, String>>()?;
        Ok(Self { tasks, budget, identity })
    }

    /// Refuses the plan if it is for another scene, other lamps, or another view.
    pub(crate) fn require(&self, identity: &Identity, path: &Path) -> Result<(), Failure> {
        let pairs = identity.parts.iter().zip(&self.identity);
        let differing: Vec<&str> =
            pairs.filter(|((_, own), (_, other))| own != other).map(|((name, _), _)| *name).collect();
        if differing.is_empty() {
            return Ok(());
        }
        let problem = format!("the plan is for another {}", differing.join(", another "));
        let problem = problem.replace("another lamps", "other lamps");
        Err(Failure::new(problem, REMEDY).in_file(path))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn saved_plan_that_is_none_is_refused_with_the_part() {
        let error = |text: &str| Saved::parse(text).unwrap_err();
        assert!(error("{").starts_with("no JSON: "));
        assert_eq!(error("{}"), "no saved plan: it has no `scene`");
        let with = |groups: &str, kept: &str| {
            format!(
                r#"{{"saved":{{"scene":"a","lamps":"b","view":"c","falloff":"plain","budget":"error=0",
                "lights":[{{"groups":{groups},"kept":{kept},"bound":0.5,"void":false}}]}}}}"#
            )
        };
        let rays = r#"[{"receivers":"all","technique":"rays"}]"#;
        let saved = Saved::parse(&with(rays, "[1,4]")).unwrap();
        assert_eq!((saved.tasks[0].kept.as_deref(), saved.tasks[0].bound), (Some(&[1, 4][..]), 0.5));
        assert_eq!(error(&with("[]", "null")), "no saved plan: a light has no `groups`");
        assert_eq!(error(&with(rays, "[4,1]")), "`kept` is no list of ascending numbers");
        assert!(error(&with(&rays.replace("rays", "ray"), "null")).starts_with("`ray` is not a technique"));
        assert_eq!(error(&with(&rays.replace("all", "some"), "null")), "there are no receivers `some`");
        let identity = |scene: &str, lamps: &str| Identity {
            parts: [("scene", scene), ("lamps", lamps), ("view", "c"), ("falloff", "plain")]
                .map(|(name, value)| (name, value.to_owned())),
        };
        assert!(saved.require(&identity("a", "b"), Path::new("p")).is_ok());
        let line = saved.require(&identity("x", "y"), Path::new("p")).unwrap_err().to_string();
        assert!(line.starts_with("p: the plan is for another scene, other lamps; write it anew"), "{line}");
    }
}
