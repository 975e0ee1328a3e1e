//! Header lines that no PLY has.

use super::number::Number;
use crate::read::text::{Line, parse};

/// What a header line with an unknown keyword looks like.
pub(super) enum Junk {
    /// What follows a header.
    Data,
    /// `property` misspelt: a type is the second word.
    Property,
    /// `element` misspelt: a count is the third and last word.
    Element,
    /// Nothing that matters.
    Words,
}

impl Junk {
    pub(super) fn of(line: Line<'_>) -> Self {
        let mut rest = line;
        let words = [(); 4].map(|()| rest.word());
        let is_text =
            str::from_utf8(line.rest).is_ok_and(|text| !text.contains(|c: char| c < ' ' && c != '\t'));
        match words {
            _ if !is_text => Self::Data,
            [Some(first), ..] if parse::<f64>(first).is_some() => Self::Data,
            [_, Some(kind), Some(_), _] if kind == b"list" || Number::named(kind).is_some() => Self::Property,
            [_, Some(_), Some(count), None] if parse::<u64>(count).is_some() => Self::Element,
            _ => Self::Words,
        }
    }
}
