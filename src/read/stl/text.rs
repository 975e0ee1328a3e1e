//! Text STL, word by word: what a line holds does not matter, except for the end of a solid's name.

use std::io::BufRead;

use super::soup;
use crate::mesh::Part;
use crate::read::slips::Slips;
use crate::read::text::{decimal, name};
use crate::read::words::Words;
use crate::read::{Format, ReadError};
use crate::scene::Scene;

/// A word of the grammar, in upper or lower case.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Key {
    /// Also with the name run together, as `endsolid`.
    Solid,
    Facet,
    Normal,
    Outer,
    Loop,
    Vertex,
    /// The first half of one of the next three.
    End,
    EndLoop,
    EndFacet,
    EndSolid,
    Other,
}

impl Key {
    fn of(word: &[u8]) -> Self {
        let is = |key: &str| word.eq_ignore_ascii_case(key.as_bytes());
        let begins =
            |key: &str| word.get(..key.len()).is_some_and(|start| start.eq_ignore_ascii_case(key.as_bytes()));
        match word.first().map_or(0, u8::to_ascii_lowercase) {
            b'v' if is("vertex") => Self::Vertex,
            b'f' if is("facet") => Self::Facet,
            b'n' if is("normal") => Self::Normal,
            b'o' if is("outer") => Self::Outer,
            b'l' if is("loop") => Self::Loop,
            b'o' if is("outerloop") => Self::Loop,
            b'e' if is("endloop") => Self::EndLoop,
            b'e' if is("endfacet") => Self::EndFacet,
            b'e' if begins("endsolid") => Self::EndSolid,
            b'e' if is("end") => Self::End,
            b's' if begins("solid") => Self::Solid,
            _ => Self::Other,
        }
    }

    /// `end` and this key as one.
    fn ended(self) -> Self {
        match self {
            Self::Solid => Self::EndSolid,
            Self::Facet => Self::EndFacet,
            Self::Loop => Self::EndLoop,
            _ => Self::Other,
        }
    }
}

/// What a text file may hold next.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Inside {
    File,
    /// The name of a solid, which ends with its line or before `facet normal`; whether `facet` came.
    Name(bool),
    Solid,
    /// A facet, before its loop. Its normal follows from the vertices.
    Facet,
    /// How many vertices of the loop came.
    Loop(u8),
    /// A facet whose loop is closed.
    Done,
    /// The name of a solid again, at its end: how many words of it came.
    EndName(usize),
}

#[derive(Default)]
struct Text {
    positions: Vec<[f32; 3]>,
    solids: Vec<Part>,
    /// The name of the last solid that has begun.
    name: Vec<u8>,
    slips: Slips,
    /// How far a coordinate moved at most when it was rounded.
    rounding: f64,
}

pub(super) fn read<R: BufRead>(reader: R) -> Result<Scene, ReadError> {
    let mut words = Words::new(reader, Format::Stl)?;
    let (mut stl, mut inside) = (Text::default(), Inside::File);
    while let Some(word) = words.word()? {
        let key = Key::of(word);
        inside = match inside {
            Inside::Loop(count @ 0..3) if key == Key::Vertex => {
                stl.positions.push(point(&mut words, &mut stl.rounding)?);
                Inside::Loop(count + 1)
            }
            Inside::Name(facet) => stl.name_word(key, facet, &mut words)?,
            Inside::EndName(count) => stl.end_name_word(key, count, &mut words)?,
            _ => stl.step(inside, key, &mut words)?,
        };
    }
    stl.finish(inside, &words)
}

impl Text {
    fn step<R: BufRead>(
        &mut self,
        inside: Inside,
        key: Key,
        words: &mut Words<R>,
    ) -> Result<Inside, ReadError> {
        let key = match key {
            Key::End => {
                let line = words.line();
                let key = words.word()?.map_or(Key::Other, |word| Key::of(word).ended());
                self.slips.add("keyword", "read in two words", || format!("on line {line}"));
                key
            }
            key => key,
        };
        Ok(match (inside, key) {
            (Inside::File | Inside::Solid, Key::Facet) => {
                if inside == Inside::File {
                    self.slips.add("solid", "without its beginning", || format!("on line {}", words.line()));
                    self.begin();
                }
                self.facet(words)
            }
            (Inside::Facet, Key::Outer) => Inside::Facet,
            (Inside::Facet, Key::Loop) => Inside::Loop(0),
            (Inside::Facet, Key::Normal | Key::Other) => Inside::Facet,
            (Inside::Loop(3), Key::EndLoop) => Inside::Done,
            (Inside::Done, Key::EndFacet) => Inside::Solid,
            (Inside::File | Inside::Solid, Key::EndSolid) => {
                if inside == Inside::File {
                    self.slips.add("solid", "ended twice", || format!("on line {}", words.line()));
                }
                self.run_together("endsolid", words);
                self.end();
                Inside::EndName(usize::from(words.last().len() > "endsolid".len()))
            }
            (Inside::File | Inside::Solid, Key::Solid) => {
                if inside == Inside::Solid {
                    let what = if self.is_empty() { "begun twice" } else { "without its end" };
                    self.slips.add("solid", what, || format!("on line {}", words.line()));
                    self.end();
                }
                self.begin();
                self.run_together("solid", words);
                self.name.extend_from_slice(&words.last()["solid".len()..]);
                Inside::Name(false)
            }
            _ => return Err(words.error(format!("{} is wanted, not {}", wanted(inside), words.quoted()))),
        })
    }

    fn facet<R: BufRead>(&mut self, words: &Words<R>) -> Inside {
        if !words.starts_line() {
            self.slips.add("facet", "not at the beginning of a line", || format!("on line {}", words.line()));
        }
        Inside::Facet
    }

    /// Notes a keyword that goes on as a name.
    fn run_together<R: BufRead>(&mut self, key: &str, words: &Words<R>) {
        if words.last().len() > key.len() {
            let first = || format!("on line {} ({})", words.line(), words.quoted());
            self.slips.add("keyword", "run together with a name", first);
        }
    }

    /// A word after `solid`.
    fn name_word<R: BufRead>(
        &mut self,
        key: Key,
        facet: bool,
        words: &mut Words<R>,
    ) -> Result<Inside, ReadError> {
        if facet && key == Key::Normal {
            self.named();
            return Ok(self.facet(words));
        }
        if facet {
            self.add_to_name(b"facet");
        }
        if words.starts_line() || key == Key::EndSolid {
            self.named();
            return self.step(Inside::Solid, key, words);
        }
        if key == Key::Facet {
            return Ok(Inside::Name(true));
        }
        self.add_to_name(words.last());
        Ok(Inside::Name(false))
    }

    /// A word after `endsolid`.
    fn end_name_word<R: BufRead>(
        &mut self,
        key: Key,
        count: usize,
        words: &mut Words<R>,
    ) -> Result<Inside, ReadError> {
        let repeated = self.name.split(|&byte| byte == b' ').nth(count) == Some(words.last());
        if words.starts_line() || !repeated && matches!(key, Key::Solid | Key::Facet) {
            return self.step(Inside::File, key, words);
        }
        Ok(Inside::EndName(if repeated { count + 1 } else { count }))
    }

    fn add_to_name(&mut self, word: &[u8]) {
        // No more is kept of it in the end, and this much only for a while.
        if self.name.len() < 1 << 10 {
            if !self.name.is_empty() {
                self.name.push(b' ');
            }
            self.name.extend_from_slice(word);
        }
    }

    fn begin(&mut self) {
        let start = self.faces();
        self.name.clear();
        self.solids.push(Part::new(String::new(), start..start));
    }

    fn named(&mut self) {
        self.solids.last_mut().expect("one has begun").name = name(&self.name);
    }

    fn end(&mut self) {
        let end = self.faces();
        if let Some(solid) = self.solids.last_mut() {
            solid.faces.end = end;
        }
        // Names of solids without faces would take more memory than the file.
        let _ = self.solids.pop_if(|solid| solid.faces.is_empty());
    }

    fn is_empty(&self) -> bool {
        self.solids.last().is_none_or(|solid| solid.faces.start == self.faces())
    }

    /// A count that does not fit 32 bits is refused by `Mesh::new` before the parts are used.
    fn faces(&self) -> u32 {
        (self.positions.len() / 3) as u32
    }

    fn finish<R: BufRead>(mut self, inside: Inside, words: &Words<R>) -> Result<Scene, ReadError> {
        match inside {
            Inside::File | Inside::EndName(_) => {}
            Inside::Solid | Inside::Name(_) => {
                if let Inside::Name(facet) = inside {
                    if facet {
                        self.add_to_name(b"facet");
                    }
                    self.named();
                }
                self.slips.add("solid", "without its end", || format!("on line {}", words.line()));
                self.end();
            }
            _ => return Err(words.error(format!("the file ends where {} is wanted", wanted(inside)))),
        }
        let mesh = soup(self.positions)?;
        let mut scene = Scene::of(match self.solids.as_mut_slice() {
            [only] => mesh.with_name(std::mem::take(&mut only.name)),
            _ => mesh.with_parts(self.solids),
        });
        scene.rounding = self.rounding;
        scene.notes.extend(self.slips.notes());
        let (controls, line) = words.controls();
        if controls > 0 {
            let bytes = crate::read::text::counted(controls, "control byte");
            scene.notes.push(format!("{bytes} taken as blank, from line {line} on"));
        }
        Ok(scene)
    }
}

/// Three finite numbers after `vertex`.
#[inline]
fn point<R: BufRead>(words: &mut Words<R>, rounding: &mut f64) -> Result<[f32; 3], ReadError> {
    let line = words.line();
    let mut point = [0.0; 3];
    for value in &mut point {
        match words.word()?.map(decimal) {
            Some(Some((wide, number))) if number.is_finite() => {
                *rounding = rounding.max((wide - f64::from(number)).abs());
                *value = number;
            }
            Some(Some(_)) => {
                return Err(words.error(format!("the coordinate {} is not a finite number", words.quoted())));
            }
            Some(None) if Key::of(words.last()) == Key::Other => {
                return Err(words.error(format!("{} is not a number", words.quoted())));
            }
            _ => return Err(words.error_on(line, "a position needs three numbers")),
        }
    }
    Ok(point)
}

/// What should come next, for a message.
fn wanted(inside: Inside) -> &'static str {
    match inside {
        Inside::File | Inside::EndName(_) => "`solid`",
        Inside::Solid | Inside::Name(_) => "`facet` or `endsolid`",
        Inside::Facet => "`outer loop`",
        Inside::Loop(0..3) => "`vertex`",
        Inside::Loop(_) => "`endloop`",
        Inside::Done => "`endfacet`",
    }
}
