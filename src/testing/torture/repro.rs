//! One query on its own, and a file that holds it: a plain OBJ whose comments hold light and point.

#[cfg(feature = "files")]
use std::io::Write;
#[cfg(feature = "files")]
use std::path::Path;

use super::round::{Found, Prepared, Seam};
#[cfg(feature = "files")]
use super::stratum::RECIPES;
#[cfg(feature = "files")]
use super::{Contradiction, Torture};
#[cfg(feature = "files")]
use crate::geom::LightError;
use crate::geom::{Aabb, Light};
use crate::mesh::Mesh;
#[cfg(feature = "files")]
use crate::read::{self, Format, ReadError};
#[cfg(feature = "files")]
use crate::write::{Layer, Model, Target, WriteError, write_atomic, write_to};

/// One query, complete: enough to repeat it.
///
/// ```
/// use umbrage::geom::{Aabb, Light};
/// use umbrage::testing::{shapes, torture::Repro};
///
/// let (mesh, light, point) = (shapes::cube(), Light::point([3.0, 4.0, 5.0])?, [-2.0, -3.0, -4.0]);
/// let within = Aabb::around([point]);
/// let ruling = Repro { mesh, light, point, signs: 1, within }.judge();
/// assert!(ruling.agrees, "{:?}", ruling.said);
/// # Ok::<(), umbrage::geom::LightError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Repro {
    /// The mesh, as it is: nothing is welded.
    pub mesh: Mesh,
    /// The light.
    pub light: Light,
    /// The point.
    pub point: [f32; 3],
    /// The seed of random signs, whose volume has to be closed as well.
    pub signs: u64,
    /// The box of the points that were asked about together, which contains the point: the segments that
    /// winding numbers are counted along lie in it.
    pub within: Aabb,
}

/// What all methods answered for a query.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Ruling {
    /// Whether no method contradicts another.
    pub agrees: bool,
    /// One line per method.
    pub said: Vec<String>,
}

/// Why a file holds no query.
#[cfg(feature = "files")]
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ReproError {
    /// It is no mesh that can be read.
    #[error(transparent)]
    Mesh(#[from] ReadError),
    /// It is a mesh in another format.
    #[error("{0}: is no Wavefront OBJ file; name a file that `umbrage torture` has written")]
    Format(String),
    /// A comment is missing.
    #[error("{file}: no comment line starts with `# {word} `; add one: {example}")]
    Missing {
        /// Which file.
        file: String,
        /// Its first word.
        word: &'static str,
        /// What it may look like.
        example: &'static str,
    },
    /// A comment does not say what it should.
    #[error("{file}, line {line}: {problem}")]
    Comment {
        /// Which file.
        file: String,
        /// Counted from 1.
        line: usize,
        /// What is wrong, and what to write.
        problem: String,
    },
}

impl Found {
    /// The results for the faces and volumes, one line each.
    pub(super) fn say(&self) -> Vec<String> {
        let mark = |wrong: u64| if wrong > 0 { " (contradicts)" } else { "" };
        vec![
            format!(
                "sides of all faces, one by one: {} of {} differ{}",
                self.faces_wrong,
                self.faces,
                mark(self.faces_wrong)
            ),
            format!(
                "certificates: {} of {} volumes are open{}",
                self.open_volumes,
                self.volumes,
                mark(self.open_volumes)
            ),
        ]
    }
}

impl Repro {
    /// Asks every method.
    #[must_use]
    pub fn judge(&self) -> Ruling {
        self.judge_with(Seam::SOUND)
    }

    pub(super) fn judge_with(&self, seam: Seam) -> Ruling {
        let prepared = Prepared::new(&self.mesh, &self.light, self.signs, true, seam);
        let judged = prepared.bench(self.within).judge(self.point, true);
        let found = prepared.found;
        let agrees = !judged.is_wrong() && found.faces_wrong == 0 && found.open_volumes == 0;
        Ruling { agrees, said: [found.say(), judged.say()].concat() }
    }

    /// Reads a file that [`Torture::write_case`] wrote, or one by hand.
    ///
    /// Two comments are required: `# light point:X,Y,Z` (or `directional:` and the direction in which the
    /// light travels) and `# point X,Y,Z`. Two are optional: `# signs N`, and `# within X,Y,Z X,Y,Z` (low and
    /// high corner; without it, the box of mesh and point).
    ///
    /// # Errors
    ///
    /// [`ReproError`], in one line that names the file.
    #[cfg(feature = "files")]
    pub fn read(path: impl AsRef<Path>) -> Result<Self, ReproError> {
        let path = path.as_ref();
        let file = path.to_string_lossy().replace(char::is_control, "\u{fffd}");
        let mut scene = read::read(path)?;
        if scene.format != Some(Format::Obj) || scene.meshes.is_empty() {
            return Err(ReproError::Format(file));
        }
        let mesh = scene.meshes.swap_remove(0);
        let bytes = std::fs::read(path).map_err(|error| {
            ReadError::new(Format::Obj, read::Place::File, format!("cannot be read: {error}")).in_file(path)
        })?;
        let text = String::from_utf8_lossy(&bytes);
        let comments = Comments { file, text: &text };
        let light = comments.of("light", "# light point:1,2,3", |text| {
            text.parse().map_err(|error: LightError| error.to_string())
        })?;
        let asked = comments.of("point", "# point 1,2,3", point)?;
        let within = match comments.line("within") {
            None => Aabb::around(mesh.bounds().into_iter().flatten().chain([asked])),
            Some(_) => comments.of("within", "# within 0,0,0 1,2,3", |text| {
                let corners: Vec<&str> = text.split_whitespace().collect();
                let [low, high] = corners[..] else { return Err(format!("`{text}` is no box")) };
                Ok(Aabb::around([point(low)?, point(high)?]))
            })?,
        };
        Ok(Self {
            mesh,
            within,
            light,
            point: asked,
            signs: match comments.line("signs") {
                None => 0,
                Some(_) => comments.of("signs", "# signs 1", |text| {
                    text.parse().map_err(|_| format!("`{text}` is no whole number"))
                })?,
            },
        })
    }
}

#[cfg(feature = "files")]
/// The comments of a file.
struct Comments<'a> {
    file: String,
    text: &'a str,
}

#[cfg(feature = "files")]
impl Comments<'_> {
    /// The number of the first line that starts with `# word `, and what follows there.
    fn line(&self, word: &str) -> Option<(usize, &str)> {
        let rest = |line: &'_ str| -> Option<usize> {
            let after = line.strip_prefix("# ")?.strip_prefix(word)?.strip_prefix(' ')?;
            Some(line.len() - after.len())
        };
        let mut lines = self.text.lines().enumerate();
        lines.find_map(|(number, line)| rest(line).map(|start| (number + 1, line[start..].trim())))
    }

    fn of<T>(
        &self,
        word: &'static str,
        example: &'static str,
        parse: impl Fn(&str) -> Result<T, String>,
    ) -> Result<T, ReproError> {
        let file = self.file.clone();
        let Some((line, text)) = self.line(word) else {
            return Err(ReproError::Missing { file, word, example });
        };
        parse(text).map_err(|problem| {
            let problem = problem.replace(char::is_control, "\u{fffd}");
            ReproError::Comment { file, line, problem: format!("{problem}; write `{example}`") }
        })
    }
}

#[cfg(feature = "files")]
fn point(text: &str) -> Result<[f32; 3], String> {
    let numbers: Option<Vec<f32>> = text.split(',').map(|x| x.trim().parse().ok()).collect();
    let point = numbers.and_then(|numbers| <[f32; 3]>::try_from(numbers).ok());
    let point = point.filter(|point| point.iter().all(|x| x.is_finite()));
    point.map(|point| point.map(|x| x + 0.0)).ok_or_else(|| format!("`{text}` is no point"))
}

#[cfg(feature = "files")]
impl Torture {
    /// Writes the minimized first contradiction, if there is one, to a plain OBJ. Its comments hold where it
    /// was found, light and point as decimals that read back bit for bit, and what each method answered. The
    /// file is complete or not there.
    ///
    /// # Errors
    ///
    /// [`WriteError`], naming `path`.
    pub fn write_case(&self, seed: u64, path: impl AsRef<Path>) -> Result<(), WriteError> {
        let (Some(case), Some(first)) = (&self.case, self.disagreements.first()) else { return Ok(()) };
        write_atomic(path, |writer| write_case(case, first, seed, writer))
    }
}

#[cfg(feature = "files")]
fn write_case(
    case: &Repro,
    Contradiction { stratum, round, query, said, .. }: &Contradiction,
    seed: u64,
    writer: &mut dyn Write,
) -> Result<(), WriteError> {
    let Repro { mesh, light, point: [x, y, z], signs, within } = case;
    let name = RECIPES[*stratum].name;
    writeln!(
        writer,
        "# A query where judges contradict each other; `umbrage torture --replay` judges it again."
    )?;
    writeln!(writer, "# seed {seed}, stratum {name}, round {round}, query {query}")?;
    writeln!(writer, "# light {light}")?;
    writeln!(writer, "# point {x},{y},{z}")?;
    writeln!(writer, "# signs {signs}")?;
    let [low, high] = [within.low, within.high].map(|[x, y, z]| format!("{x},{y},{z}"));
    writeln!(writer, "# within {low} {high}")?;
    for line in case.judge().said {
        writeln!(writer, "# said: {line}")?;
    }
    for line in said {
        writeln!(writer, "# said before faces were left out: {line}")?;
    }
    write_to(&Model { layers: vec![Layer::from(mesh)] }, Target::Obj, writer)
}
