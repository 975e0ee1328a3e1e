//! Words of a text file whose lines mean little: blanks of any kind between them, no line held in memory.

use std::io::{BufRead, ErrorKind};
use std::ops::Range;

use super::text::{quote, unreadable};
use super::{Format, Place, ReadError};

/// The longest word. One byte more is held at a time, to see where it ends.
const ROOM: usize = 1 << 16;

/// The words of a text file. Blank is every byte up to the space, so NUL and control-Z too, which some
/// programs pad with. A line ends in LF, CR LF or CR.
pub(super) struct Words<R> {
    reader: R,
    format: Format,
    buffer: Vec<u8>,
    /// The bytes of the buffer that are not yet read.
    left: Range<usize>,
    /// The last word, in the buffer.
    word: Range<usize>,
    /// Whether the last word is the first of its line.
    starts_line: bool,
    /// The line at `left.start`, and that of the last word, 0 before it.
    line_here: u64,
    word_line: u64,
    /// The byte before `left`, if it was blank.
    previous: u8,
    /// How many blanks were control bytes without a meaning in text, and the line of the first.
    controls: (u64, u64),
    /// Bytes of the file up to the end of `left`.
    position: u64,
}

impl<R: BufRead> Words<R> {
    pub(super) fn new(reader: R, format: Format) -> Result<Self, ReadError> {
        let mut words = Self {
            reader,
            format,
            buffer: vec![0; ROOM + 1],
            left: 0..0,
            word: 0..0,
            starts_line: true,
            line_here: 1,
            word_line: 0,
            previous: 0,
            controls: (0, 0),
            position: 0,
        };
        // A read may give less than it could.
        while words.left.len() < 3 && words.refill()? {}
        if words.unread().starts_with(b"\xef\xbb\xbf") {
            words.left.start = 3;
        }
        Ok(words)
    }

    fn unread(&self) -> &[u8] {
        &self.buffer[self.left.clone()]
    }

    /// Holds more of the file behind what is left; `false` at its end.
    #[cold]
    fn refill(&mut self) -> Result<bool, ReadError> {
        self.buffer.copy_within(self.left.clone(), 0);
        self.left = 0..self.left.len();
        loop {
            match self.reader.read(&mut self.buffer[self.left.end..]) {
                Ok(read) => {
                    self.left.end += read;
                    self.position += read as u64;
                    return Ok(read > 0);
                }
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(error) => return Err(unreadable(self.format, Place::Line(self.line_here), &error)),
            }
        }
    }

    /// The next word; `None` at the end of the file.
    #[inline]
    pub(super) fn word(&mut self) -> Result<Option<&[u8]>, ReadError> {
        loop {
            while self.left.start < self.left.end {
                let byte = self.buffer[self.left.start];
                if byte > b' ' {
                    return self.rest_of_word().map(Some);
                }
                self.blank(byte);
            }
            if !self.refill()? {
                self.word = 0..0;
                return Ok(None);
            }
        }
    }

    /// Goes past a blank.
    #[inline]
    fn blank(&mut self, byte: u8) {
        self.left.start += 1;
        match byte {
            b' ' => {}
            b'\n' => self.line_here += u64::from(self.previous != b'\r'),
            b'\r' => self.line_here += 1,
            b'\t' | 0x0b | 0x0c => {}
            _ => {
                if self.controls.0 == 0 {
                    self.controls.1 = self.line_here;
                }
                self.controls.0 += 1;
            }
        }
        self.previous = byte;
    }

    /// The word that begins here.
    #[inline]
    fn rest_of_word(&mut self) -> Result<&[u8], ReadError> {
        self.starts_line = self.line_here > self.word_line;
        self.word_line = self.line_here;
        self.previous = 0;
        let mut seen = 0;
        let length = loop {
            match self.unread()[seen..].iter().position(|&byte| byte <= b' ') {
                Some(more) => break seen + more,
                None => seen = self.left.len(),
            }
            if seen > ROOM {
                self.word = 0..0;
                return Err(self.error(format!("a word is longer than {ROOM} bytes")));
            }
            if !self.refill()? {
                break seen;
            }
        };
        self.word = self.left.start..self.left.start + length;
        self.left.start += length;
        Ok(self.last())
    }

    /// The word that [`Words::word`] gave last.
    #[inline]
    pub(super) fn last(&self) -> &[u8] {
        &self.buffer[self.word.clone()]
    }

    /// The last word for a message.
    pub(super) fn quoted(&self) -> String {
        quote(self.last())
    }

    /// Whether the last word is the first of its line.
    #[inline]
    pub(super) fn starts_line(&self) -> bool {
        self.starts_line
    }

    /// The line of the last word, counted from 1.
    #[inline]
    pub(super) fn line(&self) -> u64 {
        self.word_line
    }

    /// How many blanks were control bytes without a meaning in text, and the line of the first.
    pub(super) fn controls(&self) -> (u64, u64) {
        self.controls
    }

    /// The next word outside of comments, which begin with `#` and end with their line.
    #[inline]
    pub(super) fn uncommented(&mut self) -> Result<Option<&[u8]>, ReadError> {
        while self.word()?.is_some_and(|word| word.starts_with(b"#")) {
            self.skip_line()?;
        }
        Ok(if self.word.is_empty() { None } else { Some(self.last()) })
    }

    /// Goes to the end of the line that the last word lies on; whether more than blanks and a comment, which
    /// begins with `#`, was left of it.
    pub(super) fn skip_line(&mut self) -> Result<bool, ReadError> {
        let mut seen = None;
        loop {
            while self.left.start < self.left.end {
                let byte = self.buffer[self.left.start];
                if matches!(byte, b'\n' | b'\r') {
                    return Ok(seen.is_some_and(|first| first != b'#'));
                }
                if byte > b' ' {
                    seen = seen.or(Some(byte));
                }
                self.left.start += 1;
                self.previous = 0;
            }
            if !self.refill()? {
                return Ok(seen.is_some_and(|first| first != b'#'));
            }
        }
    }

    /// Goes to the next line; how many bytes lie before it.
    pub(super) fn next_line(&mut self) -> Result<u64, ReadError> {
        self.skip_line()?;
        while self.left.len() < 2 && self.refill()? {}
        let end = match self.unread() {
            [b'\r', b'\n', ..] => 2,
            [_, ..] => 1,
            [] => 0,
        };
        Ok(self.position() + end)
    }

    /// How many bytes lie before what is not yet read.
    pub(super) fn position(&self) -> u64 {
        self.position - self.left.len() as u64
    }

    /// The reader, wherever it is by now.
    pub(super) fn into_inner(self) -> R {
        self.reader
    }

    /// An error on the line of the last word.
    #[cold]
    pub(super) fn error(&self, problem: impl Into<String>) -> ReadError {
        self.error_on(self.word_line, problem)
    }

    #[cold]
    pub(super) fn error_on(&self, line: u64, problem: impl Into<String>) -> ReadError {
        ReadError::new(self.format, Place::Line(line.max(1)), problem)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::BufReader;

    /// Every word with its line, and whether it is the line's first; read by `step` bytes at a time.
    fn words(text: &[u8], step: usize) -> Vec<(String, u64, bool)> {
        let mut words = Words::new(BufReader::with_capacity(step, text), Format::Stl).unwrap();
        let mut all = Vec::new();
        while words.word().unwrap().is_some() {
            let word = String::from_utf8_lossy(words.last()).into_owned();
            all.push((word, words.line(), words.starts_line()));
        }
        assert_eq!(words.position(), text.len() as u64);
        all
    }

    #[test]
    fn words_know_their_line_whatever_ends_it() {
        for text in ["a bc\n\nd\ne", "\u{feff}a\x0b bc\r\n\r\nd\r\ne\r\n", "a\tbc\r\rd\r\0e\x1a"] {
            for step in 1..8 {
                let wanted = [("a", 1, true), ("bc", 1, false), ("d", 3, true), ("e", 4, true)];
                assert_eq!(
                    words(text.as_bytes(), step),
                    wanted.map(|(word, line, first)| (word.to_owned(), line, first))
                );
            }
        }
    }

    #[test]
    fn words_and_blanks_may_be_longer_than_the_buffer_but_a_word_not() {
        let text = format!("{}\n{}b {}", " ".repeat(3 * ROOM), "a".repeat(ROOM - 1), "c".repeat(100));
        let found: Vec<_> =
            words(text.as_bytes(), 999).into_iter().map(|(word, line, _)| (word.len(), line)).collect();
        assert_eq!(found, [(ROOM, 2), (100, 2)]);
        let text = [b'x'; ROOM + 1];
        let error = Words::new(&text[..], Format::Stl).unwrap().word().unwrap_err();
        assert_eq!(error.place, Place::Line(1));
    }

    #[test]
    fn words_of_a_line_can_be_skipped_and_its_comment_is_told_from_them() {
        for (text, left) in [("a b c\r\nd", true), ("a # c\nd", false), ("a  \nd", false), ("a", false)] {
            let mut words = Words::new(text.as_bytes(), Format::Off).unwrap();
            assert!(words.word().unwrap().is_some());
            assert_eq!(words.skip_line().unwrap(), left, "{text:?}");
            let next = words.word().unwrap().map(<[u8]>::to_vec);
            assert_eq!(next, text.ends_with('d').then(|| b"d".to_vec()));
            assert!(words.line() == 1 + u64::from(next.is_some()));
        }
    }

    #[test]
    fn words_count_control_bytes_between_them() {
        let mut words = Words::new(&b"a\n\0\0b\x1a"[..], Format::Stl).unwrap();
        while words.word().unwrap().is_some() {}
        assert_eq!(words.controls(), (3, 2));
    }
}
