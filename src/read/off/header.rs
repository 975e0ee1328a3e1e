//! The first word of a file: what a vertex has beside its position, and the encoding.

use std::io::BufRead;

use crate::read::ReadError;
use crate::read::slips::Slips;
use crate::read::text::parse;
use crate::read::words::Words;

pub(super) struct Header {
    /// How many numbers a vertex has beside its position.
    pub(super) extras: u64,
    pub(super) binary: bool,
    /// The number of vertices, if it was the first word or followed the keyword without a blank.
    pub(super) vertices: Option<u64>,
    /// Whether the number of vertices, if `None` here, is the last word that was read.
    pub(super) ahead: bool,
}

/// The keyword: letters for what a vertex has, then `OFF`; a number may follow without a blank.
struct Keyword<'a> {
    extras: u64,
    /// Four coordinates, or any number of them.
    other_dimension: bool,
    rest: &'a [u8],
}

impl<'a> Keyword<'a> {
    fn of(word: &'a [u8]) -> Option<Self> {
        if word.eq_ignore_ascii_case(b"off") {
            return Some(Self { extras: 0, other_dimension: false, rest: &[] });
        }
        let end = word.windows(3).position(|letters| letters == b"OFF")?;
        let (mut letters, rest) = (&word[..end], &word[end + 3..]);
        let mut extras = 0;
        // Texture coordinates, a color, a normal, in this sequence.
        for (name, numbers) in [(&b"ST"[..], 2), (b"C", 4), (b"N", 3)] {
            if let Some(after) = letters.strip_prefix(name) {
                (letters, extras) = (after, extras + numbers);
            }
        }
        let other_dimension = matches!(letters, b"4" | b"n" | b"4n");
        let known = letters.is_empty() || other_dimension;
        (known && rest.iter().all(u8::is_ascii_digit)).then_some(Self { extras, other_dimension, rest })
    }
}

/// Whether a line begins with the keyword of OFF.
pub(in crate::read) fn is_keyword(line: &[u8]) -> bool {
    line.split(u8::is_ascii_whitespace).next().is_some_and(|word| Keyword::of(word).is_some())
}

impl Header {
    /// Reads the keyword and what follows it on its line.
    pub(super) fn read<R: BufRead>(words: &mut Words<R>, slips: &mut Slips) -> Result<Self, ReadError> {
        if words.uncommented()?.is_none() {
            return Err(words.error("the file holds nothing but comments"));
        }
        let word = words.last();
        let Some(keyword) = Keyword::of(word) else {
            let Some(vertices) = parse(word) else {
                let problem = format!("an OFF file begins with the word `OFF`, not {}", words.quoted());
                return Err(words.error(problem));
            };
            slips.add("keyword", "`OFF` missing", || format!("on line {}", words.line()));
            return Ok(Self { extras: 0, binary: false, vertices: Some(vertices), ahead: false });
        };
        if keyword.other_dimension {
            let problem = format!("the vertices of a file in {} are not points of space", words.quoted());
            return Err(words.error(problem).remedy("export it with three coordinates a vertex"));
        }
        let (extras, glued) = (keyword.extras, parse(keyword.rest));
        if !keyword.rest.is_empty() {
            if glued.is_none() {
                return Err(words.error(format!("{} does not end in a count", words.quoted())));
            }
            slips.add("keyword", "run together with a count", || {
                format!("on line {} ({})", words.line(), words.quoted())
            });
            return Ok(Self { extras, binary: false, vertices: glued, ahead: false });
        }
        let next = words.uncommented()?;
        let binary = next.is_some_and(|word| word.eq_ignore_ascii_case(b"BINARY")) && !words.starts_line();
        Ok(Self { extras, binary, vertices: None, ahead: true })
    }
}
