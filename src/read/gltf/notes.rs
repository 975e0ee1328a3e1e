//! Notes for people, one line per kind, however often it occurs.

use std::cell::RefCell;
use std::collections::HashSet;

/// What was mended or left out. Everything that reads a part of the file shares one of these.
#[derive(Default)]
pub(super) struct Notes {
    /// In order of first occurrence.
    kinds: RefCell<Vec<Note>>,
    /// What was noted of items that are read more than once.
    once: RefCell<HashSet<(&'static str, String)>>,
}

struct Note {
    what: &'static str,
    /// Of the first occurrence.
    place: String,
    /// Of the first occurrence; may be empty.
    why: String,
    times: usize,
}

impl Notes {
    pub(super) fn add(&self, what: &'static str, place: &str) {
        self.add_many(what, place, 1);
    }

    pub(super) fn add_many(&self, what: &'static str, place: &str, times: usize) {
        self.count(what, place, times, String::new);
    }

    /// A note with its reason, which may differ from one occurrence to the next: the first one's is shown.
    pub(super) fn because(&self, what: &'static str, place: &str, why: impl FnOnce() -> String) {
        self.count(what, place, 1, why);
    }

    /// The same for what may be read more than once, such as a shared accessor: it counts once.
    pub(super) fn once(&self, what: &'static str, place: &str, why: impl FnOnce() -> String) {
        if self.once.borrow_mut().insert((what, place.to_owned())) {
            self.because(what, place, why);
        }
    }

    fn count(&self, what: &'static str, place: &str, times: usize, why: impl FnOnce() -> String) {
        let mut kinds = self.kinds.borrow_mut();
        match kinds.iter_mut().find(|note| note.what == what) {
            _ if times == 0 => {}
            Some(note) => note.times += times,
            None => kinds.push(Note { what, place: place.to_owned(), why: why(), times }),
        }
    }

    /// The lines so far; what is noted from here on is told apart.
    pub(super) fn take_lines(&self) -> Vec<String> {
        let lines = self.lines();
        self.kinds.borrow_mut().clear();
        lines
    }

    fn lines(&self) -> Vec<String> {
        let line = |Note { what, place, why, times }: &Note| {
            let place = match times {
                1 => place.clone(),
                _ => format!("{place} and {} more", times - 1),
            };
            match (why.is_empty(), times) {
                (true, _) => format!("{place}: {what}"),
                (false, 1) => format!("{place}: {what}: {why}"),
                (false, _) => format!("{place}: {what}: of the first, {why}"),
            }
        };
        self.kinds.borrow().iter().map(line).collect()
    }
}
