//! Lines and words of a text file, as bytes: no allocation per line, and every error names its line.

use std::cell::Cell;
use std::io::{self, BufRead, Read};

use super::{Format, Place, ReadError};

/// The longest line that is read, in bytes. A line is held in memory, so an endless one is refused; a
/// polygon or strip of ten million corners still fits.
const LONGEST_LINE: usize = 1 << 26;

/// The longest name that is kept, in bytes. Each run of faces holds its own copy, so that a long name used
/// by many short runs would otherwise grow far beyond the file.
const LONGEST_NAME: usize = 100;

/// The lines of a text file. A line ends in LF, CR LF, or, if the first one does, in CR alone.
pub(super) struct Lines<R> {
    reader: R,
    format: Format,
    end: u8,
    joins: bool,
    line: Vec<u8>,
    number: u64,
    breaks: u64,
    position: u64,
    rounding: Cell<f64>,
}

impl<R: BufRead> Lines<R> {
    /// The lines from the current position of `reader`. With `joins`, a backslash at the end of a line
    /// continues it.
    pub(super) fn new(mut reader: R, format: Format, joins: bool) -> Result<Self, ReadError> {
        let head = reader.fill_buf().map_err(|error| unreadable(format, Place::File, &error))?;
        let first_break = head.iter().position(|byte| matches!(byte, b'\n' | b'\r'));
        let end = match first_break.map(|at| (head[at], head.get(at + 1))) {
            Some((b'\r', Some(&next))) if next != b'\n' => b'\r',
            _ => b'\n',
        };
        Ok(Self {
            reader,
            format,
            end,
            joins,
            line: Vec::new(),
            number: 0,
            breaks: 0,
            position: 0,
            rounding: Cell::new(0.0),
        })
    }

    /// The next line, without its end and without a byte order mark; `None` at the end of the file.
    pub(super) fn next_line(&mut self) -> Result<Option<Line<'_>>, ReadError> {
        self.line.clear();
        self.number = self.breaks + 1;
        loop {
            let room = (LONGEST_LINE + 1 - self.line.len()) as u64;
            let read = self.reader.by_ref().take(room).read_until(self.end, &mut self.line);
            let read = read.map_err(|error| unreadable(self.format, Place::Line(self.number), &error))?;
            if read == 0 && self.line.is_empty() {
                return Ok(None);
            }
            if self.line.len() > LONGEST_LINE {
                return Err(self.current().error(format!("the line is longer than {LONGEST_LINE} bytes")));
            }
            if self.position == 0 && self.line.starts_with(b"\xef\xbb\xbf") {
                self.line.drain(..3);
            }
            self.position += read as u64;
            if read == 0 {
                return Ok(Some(self.current()));
            }
            self.breaks += 1;
            let _ = self.line.pop_if(|last| *last == self.end);
            let _ = self.line.pop_if(|last| *last == b'\r');
            // A comment that ends in a backslash (a Windows folder, say) must not swallow the next line.
            let comment = || self.line.trim_ascii_start().starts_with(b"#");
            if !self.joins || self.line.last() != Some(&b'\\') || comment() {
                return Ok(Some(self.current()));
            }
            *self.line.last_mut().expect("it ends in a backslash") = b' ';
        }
    }

    /// The line that [`Lines::next_line`] gave last, from its beginning.
    pub(super) fn current(&self) -> Line<'_> {
        Line { rest: &self.line, number: self.number, format: self.format, rounding: &self.rounding }
    }

    /// An error at the end of the file.
    pub(super) fn error_at_end(&self, problem: impl Into<String>) -> ReadError {
        ReadError::new(self.format, Place::Line(self.breaks.max(1)), problem)
    }

    /// How many bytes the lines so far took.
    pub(super) fn position(&self) -> u64 {
        self.position
    }

    /// How far the coordinates so far moved at most when they were rounded to `f32`.
    pub(super) fn rounding(&self) -> f64 {
        self.rounding.get()
    }

    /// The reader, positioned after the last line.
    pub(super) fn into_inner(self) -> R {
        self.reader
    }
}

/// What is left of a line.
#[derive(Clone, Copy)]
pub(super) struct Line<'a> {
    pub(super) rest: &'a [u8],
    pub(super) number: u64,
    format: Format,
    rounding: &'a Cell<f64>,
}

impl<'a> Line<'a> {
    /// The next run of bytes between blanks.
    #[inline]
    pub(super) fn word(&mut self) -> Option<&'a [u8]> {
        let start = self.rest.iter().position(|byte| !byte.is_ascii_whitespace())?;
        let rest = &self.rest[start..];
        let end = rest.iter().position(u8::is_ascii_whitespace).unwrap_or(rest.len());
        let (word, rest) = rest.split_at(end);
        self.rest = rest;
        Some(word)
    }

    /// The rest of the line as a name: trimmed, and cut where it is very long.
    pub(super) fn name(&self) -> String {
        name(self.rest.trim_ascii())
    }

    /// The next word as a number, as it is and correctly rounded. Either may not be finite.
    #[inline]
    fn coordinate(&mut self) -> Result<(f64, f32), ReadError> {
        let blanks = self.rest.iter().take_while(|byte| byte.is_ascii_whitespace()).count();
        self.rest = &self.rest[blanks..];
        let short = short_decimal(self.rest)
            .and_then(|(wide, length)| Some((narrow(wide, || parse(&self.rest[..length]))?, length)));
        let (wide, value) = match short {
            Some((both, length)) => {
                self.rest = &self.rest[length..];
                both
            }
            None => self.rare_coordinate()?,
        };
        if value.is_finite() {
            self.rounding.set(self.rounding.get().max((wide - f64::from(value)).abs()));
        }
        Ok((wide, value))
    }

    /// [`Line::coordinate`] for what is long, has an exponent, or is no number at all.
    fn rare_coordinate(&mut self) -> Result<(f64, f32), ReadError> {
        let Some(word) = self.word() else { return Err(self.error("a position needs three numbers")) };
        loose(word).ok_or_else(|| self.error(format!("{} is not a number", quote(word))))
    }

    /// The next three words as a position.
    #[inline]
    pub(super) fn point(&mut self) -> Result<[(f64, f32); 3], ReadError> {
        Ok([self.coordinate()?, self.coordinate()?, self.coordinate()?])
    }

    /// The line for a note.
    #[cold]
    pub(super) fn at(&self) -> String {
        format!("on line {}", self.number)
    }

    /// An error on this line.
    #[cold]
    pub(super) fn error(&self, problem: impl Into<String>) -> ReadError {
        ReadError::new(self.format, Place::Line(self.number), problem)
    }
}

/// `word` as a number of type `T`.
#[inline]
pub(super) fn parse<T: std::str::FromStr>(word: &[u8]) -> Option<T> {
    str::from_utf8(word).ok()?.parse().ok()
}

/// `word` as the nearest `f64`, and as the nearest `f32`.
///
/// Rounding twice nearly always gives that, too: between rounding to `f64` and to `f32`, a decimal can only
/// change sides of a value halfway between two `f32` by falling on it. Below the normal range of `f32` such
/// values have other low bits.
#[inline]
pub(super) fn decimal(word: &[u8]) -> Option<(f64, f32)> {
    let short = short_decimal(word).filter(|&(_, length)| length == word.len());
    let wide = short.map(|(wide, _)| wide).or_else(|| parse::<f64>(word))?;
    narrow(wide, || parse::<f32>(word))
}

/// A number that was rounded to `wide`, and the nearest `f32`, which `again` reads where `wide` does not
/// tell.
#[inline]
fn narrow(wide: f64, again: impl FnOnce() -> Option<f32>) -> Option<(f64, f32)> {
    const LOW: u64 = (1 << 29) - 1;
    const HALFWAY: u64 = 1 << 28;
    let plain = wide.to_bits() & LOW != HALFWAY && wide.abs() >= f64::from(f32::MIN_POSITIVE);
    let near = if plain || wide == 0.0 { wide as f32 } else { again()? };
    Some((wide, near))
}

/// The number at the beginning of `text`, as the nearest `f64`, and how many bytes it takes, if it has at
/// most 15 digits and no exponent, and a blank or nothing follows.
///
/// Its digits as an integer and the power of ten that divides it are both exact in `f64`, so that the one
/// division rounds correctly (Clinger, How to read floating point numbers accurately, 1990, section 5).
#[inline]
fn short_decimal(text: &[u8]) -> Option<(f64, usize)> {
    const POWERS: [f64; 16] =
        [1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15];
    let signed = usize::from(matches!(text, [b'+' | b'-', ..]));
    let (mut at, mut mantissa) = (signed, 0_u64);
    let mut digits = |at: &mut usize| {
        let start = *at;
        while let Some(digit) = text.get(*at).map(|byte| byte.wrapping_sub(b'0')).filter(|&digit| digit <= 9)
        {
            mantissa = mantissa.wrapping_mul(10).wrapping_add(u64::from(digit));
            *at += 1;
        }
        *at - start
    };
    let whole = digits(&mut at);
    let mut fraction = 0;
    if text.get(at) == Some(&b'.') {
        at += 1;
        fraction = digits(&mut at);
    }
    let known = (1..=15).contains(&(whole + fraction)) && text.get(at).is_none_or(u8::is_ascii_whitespace);
    known.then(|| {
        let size = mantissa as f64 / POWERS[fraction];
        (if text[0] == b'-' { -size } else { size }, at)
    })
}

/// As [`decimal`], also for NaN and infinity as the C libraries of Windows and Linux write them: `-nan(ind)`,
/// `nan(0x7)`, `1.#INF`, `-1.#IND`.
#[inline]
pub(super) fn loose(word: &[u8]) -> Option<(f64, f32)> {
    decimal(word).or_else(|| is_no_number(word).then_some((f64::NAN, f32::NAN)))
}

#[cold]
fn is_no_number(word: &[u8]) -> bool {
    let word = word.to_ascii_lowercase();
    let digits = word.strip_prefix(b"-").or(word.strip_prefix(b"+")).unwrap_or(&word);
    digits.starts_with(b"nan(")
        || ["1.#inf", "1.#ind", "1.#qnan", "1.#snan"].iter().any(|name| digits.starts_with(name.as_bytes()))
}

/// `word` as a name, cut where it is very long.
pub(super) fn name(word: &[u8]) -> String {
    String::from_utf8_lossy(&word[..word.len().min(LONGEST_NAME)]).into_owned()
}

/// `word` in backquotes for a message, cut where it is very long.
pub(super) fn quote(word: &[u8]) -> String {
    const LONGEST: usize = 40;
    match word.get(..LONGEST) {
        Some(head) if word.len() > LONGEST => format!("`{}…`", String::from_utf8_lossy(head)),
        _ => format!("`{}`", String::from_utf8_lossy(word)),
    }
}

/// "1 n-gon", "12 n-gons", "3 vertices".
pub(super) fn counted(count: u64, noun: &str) -> String {
    match (count, noun.strip_suffix("ex")) {
        (1, _) => format!("1 {noun}"),
        (_, Some(stem)) => format!("{count} {stem}ices"),
        _ => format!("{count} {noun}s"),
    }
}

/// An input/output error in the middle of a file.
pub(super) fn unreadable(format: Format, place: Place, error: &io::Error) -> ReadError {
    ReadError::new(format, place, format!("cannot be read: {error}"))
        .remedy("check that the file can be read")
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn lines(text: &[u8], joins: bool) -> Vec<(u64, String)> {
        let mut lines = Lines::new(text, Format::Obj, joins).unwrap();
        let mut all = Vec::new();
        while let Some(line) = lines.next_line().unwrap() {
            all.push((line.number, String::from_utf8_lossy(line.rest).into_owned()));
        }
        assert_eq!(lines.position(), text.len() as u64);
        all
    }

    fn expect(text: &[u8], wanted: &[(u64, &str)]) {
        let wanted: Vec<_> = wanted.iter().map(|&(number, line)| (number, line.to_owned())).collect();
        assert_eq!(lines(text, true), wanted, "{:?}", String::from_utf8_lossy(text));
    }

    #[test]
    fn lines_end_in_lf_crlf_or_cr() {
        for text in ["a b\n\nc", "a b\r\n\r\nc\r\n", "a b\r\rc\r"] {
            expect(text.as_bytes(), &[(1, "a b"), (2, ""), (3, "c")]);
        }
    }

    #[test]
    fn lines_lose_a_byte_order_mark() {
        expect(b"\xef\xbb\xbfv 1\nv 2", &[(1, "v 1"), (2, "v 2")]);
    }

    #[test]
    fn lines_join_at_a_backslash_but_not_in_comments() {
        expect(b"f 1 \\\n2 \\\r\n3\nv", &[(1, "f 1  2  3"), (4, "v")]);
        expect(b"# C:\\\nv 1\n", &[(1, "# C:\\"), (2, "v 1")]);
        expect(b"f 1\\", &[(1, "f 1 ")]);
        assert_eq!(lines(b"a\\\nb", false), [(1, "a\\".to_owned()), (2, "b".to_owned())]);
    }

    #[test]
    fn lines_longer_than_the_limit_are_refused() {
        let endless = BufReaderOfBlanks;
        let mut lines = Lines::new(endless, Format::Obj, true).unwrap();
        let error = lines.next_line().err().expect("an endless line is refused");
        assert_eq!(error.place, Place::Line(1));
    }

    struct BufReaderOfBlanks;
    impl Read for BufReaderOfBlanks {
        fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
            into.fill(b' ');
            Ok(into.len())
        }
    }
    impl BufRead for BufReaderOfBlanks {
        fn fill_buf(&mut self) -> io::Result<&[u8]> {
            Ok(&[b' '; 4096])
        }
        fn consume(&mut self, _: usize) {}
    }

    #[test]
    fn decimals_round_once_and_their_rounding_is_known() {
        // On, above and below halfway between 1 and the next f32; half of the smallest f32; all digits.
        let words = [
            "1.000000059604644775390625",
            "1.00000005960464477539062500000001",
            "1.0000000596046447753906249999999",
            "16777217",
            "16777217.0000000001",
            "0.1",
            "-412345.670",
            "3.4028235677973366e38",
            "7.006492321624085e-46",
            "7.0064923216240853e-46",
            "1e-39",
            "0",
            "-0.0",
            "1e-400",
            "9007199254740993",
        ];
        for word in words {
            let once = word.parse::<f32>().unwrap();
            assert_eq!(decimal(word.as_bytes()).unwrap().1.to_bits(), once.to_bits(), "{word}");
        }
        // Fault injected: rounded twice.
        assert!(words.iter().any(|word| word.parse::<f64>().unwrap() as f32 != word.parse::<f32>().unwrap()));
        let mut lines = Lines::new(&b"412345.670 0.5 16777217"[..], Format::Obj, false).unwrap();
        let mut line = lines.next_line().unwrap().unwrap();
        assert_eq!(line.point().unwrap().map(|(_, near)| near), [412_345.66, 0.5, 16_777_216.0]);
        assert_eq!(lines.rounding(), 1.0);
    }

    proptest! {
        /// Short numbers are those of the standard library, to the last bit, and nothing else is one.
        #[test]
        fn decimals_of_few_digits_are_those_of_the_standard_library(
            word in "[+-]?[0-9]{0,16}[.]?[0-9]{0,16}|[+-]?[0-9]{0,8}[.]?[0-9]{0,8}[.eE_ -]?[0-9]{0,2}",
        ) {
            let standard = word.parse::<f64>().ok();
            match short_decimal(word.as_bytes()).filter(|&(_, length)| length == word.len()) {
                Some((short, _)) => prop_assert_eq!(Some(short.to_bits()), standard.map(f64::to_bits)),
                None => {
                    let digits = word.bytes().filter(u8::is_ascii_digit).count();
                    prop_assert!(standard.is_none() || digits > 15 || word.contains(['e', 'E']), "{} is short", word);
                }
            }
        }
    }

    #[test]
    fn numbers_that_are_none_are_read_as_every_c_library_writes_them() {
        for word in
            ["nan", "-nan", "-nan(ind)", "NAN(0x7ff)", "1.#IND", "-1.#QNAN0", "+1.#INF00", "inf", "-INF"]
        {
            assert!(loose(word.as_bytes()).is_some_and(|(_, value)| !value.is_finite()), "{word}");
        }
        assert_eq!(
            ["1.5", "1,5", "nanx", "#", "2.#INF"].map(|word| loose(word.as_bytes())),
            [Some((1.5, 1.5)), None, None, None, None]
        );
    }

    #[test]
    fn words_are_quoted_short_and_counts_have_a_plural() {
        assert_eq!(quote(b"abc"), "`abc`");
        assert_eq!(quote(&[b'x'; 50]), format!("`{}…`", "x".repeat(40)));
        assert_eq!([counted(1, "n-gon"), counted(12, "n-gon")], ["1 n-gon", "12 n-gons"]);
        assert_eq!([counted(1, "vertex"), counted(0, "vertex")], ["1 vertex", "0 vertices"]);
    }
}
