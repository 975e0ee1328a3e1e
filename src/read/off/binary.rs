//! Binary OFF: integers and floats of 32 bits, highest byte first, after the line with the keyword.

use std::io::{self, BufRead, ErrorKind, Read};

use super::{Off, check_size};
use crate::read::text::unreadable;
use crate::read::{Format, Place, ReadError};

/// The numbers, and the byte of the next one.
struct Numbers<R> {
    reader: R,
    at: u64,
}

pub(super) fn read<R: BufRead>(
    off: &mut Off,
    reader: R,
    start: u64,
    len: u64,
    extras: u64,
) -> Result<(), ReadError> {
    let mut numbers = Numbers { reader, at: start };
    let (vertices, faces, _edges) = (numbers.count()?, numbers.count()?, numbers.bytes()?);
    // A face has at least the counts of its corners and of its colors.
    check_size(vertices, faces, [4 * (3 + extras), 8], len.saturating_sub(numbers.at), Place::Byte(start))?;
    off.reserve(vertices)?;
    for _ in 0..vertices {
        let position = [numbers.bytes()?, numbers.bytes()?, numbers.bytes()?].map(f32::from_be_bytes);
        off.vertex(position.map(|value| (value.into(), value)), None);
        numbers.skip(extras)?;
    }
    for index in 0..faces {
        for _ in 0..numbers.count()? {
            let vertex = i32::from_be_bytes(numbers.bytes()?);
            off.corner(vertex.into()).map_err(|problem| numbers.error(problem))?;
        }
        off.end_face(None, || format!("at face {index}"));
        let colors = numbers.count()?;
        numbers.skip(colors)?;
    }
    Ok(())
}

impl<R: BufRead> Numbers<R> {
    #[inline]
    fn bytes(&mut self) -> Result<[u8; 4], ReadError> {
        let mut bytes = [0; 4];
        self.reader.read_exact(&mut bytes).map_err(|error| self.failed(&error))?;
        self.at += 4;
        Ok(bytes)
    }

    fn count(&mut self) -> Result<u64, ReadError> {
        let count = i32::from_be_bytes(self.bytes()?);
        u64::try_from(count).map_err(|_| self.error(format!("{count} is not a count")))
    }

    /// Skips `count` numbers.
    fn skip(&mut self, count: u64) -> Result<(), ReadError> {
        let skipped = io::copy(&mut Read::take(&mut self.reader, 4 * count), &mut io::sink());
        let skipped = skipped.map_err(|error| self.failed(&error))?;
        self.at += skipped;
        if skipped < 4 * count { Err(self.failed(&ErrorKind::UnexpectedEof.into())) } else { Ok(()) }
    }

    #[cold]
    fn failed(&self, error: &io::Error) -> ReadError {
        match error.kind() {
            ErrorKind::UnexpectedEof => {
                ReadError::new(Format::Off, Place::Byte(self.at), "the file ends early")
            }
            _ => unreadable(Format::Off, Place::Byte(self.at), error),
        }
    }

    /// An error at the last number.
    #[cold]
    fn error(&self, problem: String) -> ReadError {
        ReadError::new(Format::Off, Place::Byte(self.at - 4), problem)
    }
}
