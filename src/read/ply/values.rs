//! The numbers after the header, in sequence, for every encoding.

use std::io::{BufRead, ErrorKind};

use super::header::Number;
use crate::read::slips::Slips;
use crate::read::text::{Lines, loose, quote, unreadable};
use crate::read::{Format, Place, ReadError};

/// A stream of numbers. `f64` holds every PLY type exactly, except for integers beyond 2⁵³, which are
/// rounded.
pub(super) trait Values {
    /// Goes to item `index` of an element.
    fn begin(&mut self, element: &str, index: u64) -> Result<(), ReadError>;
    /// The next number.
    fn number(&mut self, number: Number) -> Result<f64, ReadError>;
    /// Reads past a number, whatever is there.
    fn skip(&mut self, number: Number) -> Result<(), ReadError>;
    /// Ends an item.
    fn end(&mut self);
    /// The current item for a note.
    fn at(&self) -> String;
    /// An error at the current item.
    fn error(&self, problem: String) -> ReadError;
    /// What was wrong around the numbers.
    fn slips(&mut self) -> &mut Slips;

    /// The line of the current item, in text.
    fn line(&self) -> Option<u64> {
        None
    }

    /// The buffered bytes that come next, if numbers are stored lowest byte first; otherwise none.
    fn at_hand(&mut self) -> &[u8] {
        &[]
    }

    /// Skips this many of the buffered bytes.
    fn pass(&mut self, _bytes: usize) {}

    /// The next number, as the length of a list.
    fn length(&mut self, number: Number) -> Result<u64, ReadError> {
        let value = self.number(number)?;
        if value < 0.0 {
            return Err(self.error(format!("{value} is not the length of a list")));
        }
        Ok(value as u64)
    }
}

/// Text: an item a line.
pub(super) struct Text<R> {
    lines: Lines<R>,
    /// How many bytes at the end of the current line are not yet read.
    left: usize,
    slips: Slips,
}

impl<R: BufRead> Text<R> {
    pub(super) fn new(lines: Lines<R>) -> Self {
        Self { lines, left: 0, slips: Slips::default() }
    }

    fn word(&mut self) -> Option<&[u8]> {
        let mut line = self.lines.current();
        line.rest = &line.rest[line.rest.len() - self.left..];
        let word = line.word();
        self.left = word.map_or(0, |_| line.rest.len());
        word
    }
}

impl<R: BufRead> Text<R> {
    #[cold]
    fn slip(&mut self, noun: &'static str, what: &'static str, word: &str) {
        let line = self.lines.current();
        self.slips.add(noun, what, || format!("{} ({word})", line.at()));
    }

    #[cold]
    fn too_few(&self) -> ReadError {
        self.lines.current().error("the line holds fewer numbers than the header declares")
    }
}

impl<R: BufRead> Values for Text<R> {
    fn begin(&mut self, element: &str, index: u64) -> Result<(), ReadError> {
        while let Some(line) = self.lines.next_line()? {
            if !line.rest.trim_ascii().is_empty() {
                self.left = line.rest.len();
                return Ok(());
            }
        }
        Err(self.lines.error_at_end(format!("the file ends before element {element}, item {index}")))
    }

    #[inline]
    fn number(&mut self, number: Number) -> Result<f64, ReadError> {
        let Some(word) = self.word() else { return Err(self.too_few()) };
        let loose = || loose(word).filter(|_| !number.is_whole()).map(|(wide, _)| wide);
        let Some(value) = number.parse(word).or_else(loose) else {
            let kind = if number.is_whole() { "an integer" } else { "a number" };
            let problem = format!("{} is not {kind}", quote(word));
            return Err(self.error(problem));
        };
        Ok(value)
    }

    #[inline]
    fn skip(&mut self, number: Number) -> Result<(), ReadError> {
        match self.word() {
            None => Err(self.too_few()),
            Some(word) if number.parse(word).is_some() => Ok(()),
            Some(word) => {
                let word = quote(word);
                self.slip("unread value", "of another type than declared", &word);
                Ok(())
            }
        }
    }

    fn end(&mut self) {
        if let Some(word) = self.word() {
            let word = quote(word);
            self.slip("line", "with more than the header declares", &word);
        }
    }

    fn at(&self) -> String {
        self.lines.current().at()
    }

    fn line(&self) -> Option<u64> {
        Some(self.lines.current().number)
    }

    fn slips(&mut self) -> &mut Slips {
        &mut self.slips
    }

    #[cold]
    fn error(&self, problem: String) -> ReadError {
        self.lines.current().error(problem)
    }
}

/// Binary, in either byte order.
pub(super) struct Binary<R, const BIG_ENDIAN: bool> {
    reader: R,
    position: u64,
    element: String,
    index: u64,
    slips: Slips,
}

impl<R: BufRead, const BIG_ENDIAN: bool> Binary<R, BIG_ENDIAN> {
    /// The numbers from the current position of `reader`, which is byte `position` of the file.
    pub(super) fn new(reader: R, position: u64) -> Self {
        Self { reader, position, element: String::new(), index: 0, slips: Slips::default() }
    }

    /// The bytes of the next number, lowest first.
    #[inline]
    fn bytes<const N: usize>(&mut self) -> Result<[u8; N], ReadError> {
        let mut bytes = [0; N];
        let place = || Place::Byte(self.position);
        match self.reader.fill_buf() {
            Ok(buffer) if buffer.len() >= N => {
                bytes.copy_from_slice(&buffer[..N]);
                self.reader.consume(N);
            }
            // At the end of the buffer, or on an error, which comes again here.
            _ => self.reader.read_exact(&mut bytes).map_err(|error| match error.kind() {
                ErrorKind::UnexpectedEof => {
                    let problem =
                        format!("the file ends inside element {}, item {}", self.element, self.index);
                    ReadError::new(Format::Ply, place(), problem)
                }
                _ => unreadable(Format::Ply, place(), &error),
            })?,
        }
        self.position += N as u64;
        if BIG_ENDIAN {
            bytes.reverse();
        }
        Ok(bytes)
    }
}

impl<R: BufRead, const BIG_ENDIAN: bool> Values for Binary<R, BIG_ENDIAN> {
    fn begin(&mut self, element: &str, index: u64) -> Result<(), ReadError> {
        if self.element != element {
            element.clone_into(&mut self.element);
        }
        self.index = index;
        Ok(())
    }

    #[inline]
    fn number(&mut self, number: Number) -> Result<f64, ReadError> {
        Ok(match number {
            Number::I8 => f64::from(i8::from_le_bytes(self.bytes()?)),
            Number::U8 => f64::from(u8::from_le_bytes(self.bytes()?)),
            Number::I16 => f64::from(i16::from_le_bytes(self.bytes()?)),
            Number::U16 => f64::from(u16::from_le_bytes(self.bytes()?)),
            Number::I32 => f64::from(i32::from_le_bytes(self.bytes()?)),
            Number::U32 => f64::from(u32::from_le_bytes(self.bytes()?)),
            Number::F32 => f64::from(f32::from_le_bytes(self.bytes()?)),
            Number::I64 => i64::from_le_bytes(self.bytes()?) as f64,
            Number::U64 => u64::from_le_bytes(self.bytes()?) as f64,
            Number::F64 => f64::from_le_bytes(self.bytes()?),
        })
    }

    #[inline]
    fn skip(&mut self, number: Number) -> Result<(), ReadError> {
        self.number(number).map(drop)
    }

    fn end(&mut self) {}

    fn at(&self) -> String {
        format!("at element {}, item {}", self.element, self.index)
    }

    fn slips(&mut self) -> &mut Slips {
        &mut self.slips
    }

    fn at_hand(&mut self) -> &[u8] {
        // What is wrong with the file comes again when a number is read.
        if BIG_ENDIAN { &[] } else { self.reader.fill_buf().unwrap_or(&[]) }
    }

    fn pass(&mut self, bytes: usize) {
        self.reader.consume(bytes);
        self.position += bytes as u64;
    }

    #[cold]
    fn error(&self, problem: String) -> ReadError {
        ReadError::new(
            Format::Ply,
            Place::Item(format!("element {}, item {}", self.element, self.index)),
            problem,
        )
    }
}
