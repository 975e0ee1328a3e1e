//! Which faces of a mesh cast, face by face: what silhouettes and volumes ask.

use super::ShellBoxes;
use crate::choice::Choice;
use crate::facing::CasterFaces;
use crate::geom::Facing;
use crate::mesh::FaceId;
use crate::topology::Shells;

/// Which faces of a mesh cast: the same [`CasterFaces`] for every face, or one per shell.
///
/// Made from a [`CasterFaces`], or by [`Caster::rule`](super::Caster::rule) from what was chosen per shell.
///
/// ```
/// use umbrage::caster::Caster;
/// use umbrage::facing::CasterFaces;
/// use umbrage::mesh::{FaceId, Mesh};
/// use umbrage::testing::shapes;
/// // A closed cube, and an open one beside it.
/// let open = shapes::translated(&shapes::open_cube(), [5.0, 0.0, 0.0]);
/// let caster = Caster::new(Mesh::concat(&[shapes::cube(), open])?);
/// let faces = caster.shell_faces(&"point:2,9,3".parse()?, None);
/// let rule = caster.rule(&faces);
/// assert_eq!(rule.of(FaceId::new(0)), CasterFaces::Front);
/// assert_eq!(rule.of(FaceId::new(12)), CasterFaces::All);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct CasterRule<'a> {
    /// What holds for all faces, if it is the same for all.
    same: Option<CasterFaces>,
    by_shell: Option<ByShell<'a>>,
}

/// One choice per shell.
#[derive(Clone, Copy, Debug)]
struct ByShell<'a> {
    choices: &'a [Choice<CasterFaces>],
    shells: &'a Shells,
    boxes: &'a ShellBoxes,
}

impl From<CasterFaces> for CasterRule<'_> {
    fn from(faces: CasterFaces) -> Self {
        Self { same: Some(faces), by_shell: None }
    }
}

impl<'a> CasterRule<'a> {
    /// One choice per shell.
    pub(crate) fn by_shell(
        choices: &'a [Choice<CasterFaces>],
        shells: &'a Shells,
        boxes: &'a ShellBoxes,
    ) -> Self {
        assert_eq!(choices.len(), shells.count, "one choice per shell");
        let first = choices.first().map_or(CasterFaces::All, |choice| choice.what);
        let same = choices.iter().all(|choice| choice.what == first).then_some(first);
        Self { same, by_shell: Some(ByShell { choices, shells, boxes }) }
    }

    /// What holds for all faces, if it is the same for all.
    #[inline]
    pub(crate) fn same(&self) -> Option<CasterFaces> {
        self.same
    }

    /// What holds for one face. Constant time.
    ///
    /// # Panics
    ///
    /// Panics if choices differ and there is no such face.
    #[inline]
    #[must_use]
    pub fn of(&self, face: FaceId) -> CasterFaces {
        match (self.same, self.by_shell) {
            (Some(same), _) => same,
            // A collapsed face is of no shell, and edge-on for every light.
            (None, Some(ByShell { choices, shells, .. })) => {
                shells.of_face[face.index()].map_or(CasterFaces::All, |shell| choices[shell as usize].what)
            }
            (None, None) => CasterFaces::All,
        }
    }

    /// The sign that each face casts with, into a buffer that keeps its memory: one entry per face.
    ///
    /// # Panics
    ///
    /// Panics if the choices are of a mesh with another number of faces.
    pub fn signs_into(&self, facing: &[Facing], signs: &mut Vec<i8>) {
        if let Some(ByShell { shells, .. }) = self.by_shell {
            assert_eq!(shells.of_face.len(), facing.len(), "one facing per face");
        }
        match (self.same, self.by_shell) {
            (None, Some(ByShell { choices, shells, .. })) => {
                signs.clear();
                signs.extend(shells.of_face.iter().zip(facing).map(|(shell, &facing)| {
                    shell.map_or(0, |shell| choices[shell as usize].what.sign(facing))
                }));
            }
            (same, _) => same.unwrap_or_default().signs_into(facing, signs),
        }
    }
}

/// The rule of the light before, to see what has changed; its memory is kept.
#[derive(Clone, Debug, Default)]
pub(crate) struct KeptRule {
    same: Option<CasterFaces>,
    /// One per shell; empty for a rule without shells.
    choices: Vec<CasterFaces>,
}

impl KeptRule {
    /// Replaces what was kept.
    pub(crate) fn keep(&mut self, rule: &CasterRule<'_>) {
        self.same = rule.same;
        self.choices.clear();
        let choices = rule.by_shell.map_or(&[][..], |by_shell| by_shell.choices);
        self.choices.extend(choices.iter().map(|choice| choice.what));
    }

    /// Whether both rules are about the same shells, or both about none.
    pub(crate) fn is_comparable(&self, rule: &CasterRule<'_>) -> bool {
        self.choices.len() == rule.by_shell.map_or(0, |by_shell| by_shell.choices.len())
    }

    /// Whether both rules say the same of every face.
    pub(crate) fn equals(&self, rule: &CasterRule<'_>) -> bool {
        match (self.same, rule.same, rule.by_shell) {
            (Some(before), Some(now), _) => before == now && self.is_comparable(rule),
            (None, None, Some(ByShell { choices, .. })) => {
                self.choices.iter().copied().eq(choices.iter().map(|choice| choice.what))
            }
            _ => false,
        }
    }

    /// What held for a face, of a comparable rule.
    #[inline]
    pub(crate) fn of(&self, rule: &CasterRule<'_>, face: FaceId) -> CasterFaces {
        match (self.same, rule.by_shell) {
            (Some(same), _) => same,
            (None, Some(ByShell { shells, .. })) => {
                shells.of_face[face.index()].map_or(CasterFaces::All, |shell| self.choices[shell as usize])
            }
            (None, None) => CasterFaces::All,
        }
    }

    /// Calls `visit` with every face of which a comparable rule says something else, with what held before
    /// and what holds now. Takes time for the shells, and for the faces that are visited.
    pub(crate) fn for_each_change(
        &self,
        rule: &CasterRule<'_>,
        faces: usize,
        mut visit: impl FnMut(FaceId, CasterFaces, CasterFaces),
    ) {
        match (rule.by_shell, self.same, rule.same) {
            (_, Some(before), Some(now)) if before == now => {}
            (Some(ByShell { choices, boxes, .. }), _, _) => {
                for (shell, (&before, now)) in self.choices.iter().zip(choices).enumerate() {
                    if before != now.what {
                        boxes.faces_of(shell).iter().for_each(|&face| visit(face, before, now.what));
                    }
                }
            }
            (None, before, now) => {
                let (before, now) = (before.unwrap_or_default(), now.unwrap_or_default());
                (0..faces).for_each(|face| visit(FaceId::new(face), before, now));
            }
        }
    }
}
