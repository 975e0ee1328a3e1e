//! Standard output and standard error: text, tables and JSON that survive a closed pipe.

use std::fmt::{self, Display};
use std::io::{self, BufWriter, StdoutLock, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};

use serde_json::Value;

use super::error::Failure;

/// Prints one line on standard error. A closed standard error is ignored.
pub(crate) fn say(text: impl Display) {
    let line = text.to_string();
    if !(line.starts_with("note: ") && NOTED.load(Ordering::Relaxed)) {
        let _ = writeln!(io::stderr().lock(), "umbrage: {line}");
    }
}

/// Whether all notes have been said, and are not to be said again.
static NOTED: AtomicBool = AtomicBool::new(false);

/// Says no note from here on, or says them again: what is done many times is noted once.
pub(crate) fn noted(noted: bool) {
    NOTED.store(noted, Ordering::Relaxed);
}

/// Reports that a file was written.
pub(crate) fn wrote(path: &Path) {
    say(format_args!("wrote {}", plain(&path.to_string_lossy())));
}

/// Standard output. Once the reader has closed the pipe, further output is dropped, and the command runs on
/// to its exit code.
pub(crate) struct Output {
    writer: BufWriter<UntilClosed<StdoutLock<'static>>>,
}

impl Output {
    pub(crate) fn new() -> Self {
        Self { writer: BufWriter::new(UntilClosed(io::stdout().lock())) }
    }

    /// Writes text as it is.
    pub(crate) fn text(&mut self, text: impl Display) -> Result<(), Failure> {
        write!(self.writer, "{text}").map_err(unwritable)
    }

    /// Writes text as it is, and a line break.
    pub(crate) fn line(&mut self, text: impl Display) -> Result<(), Failure> {
        self.text(format_args!("{text}\n"))
    }

    /// Writes a document, indented.
    pub(crate) fn json(&mut self, value: &Value) -> Result<(), Failure> {
        self.line(format_args!("{value:#}"))
    }

    /// Flushes everything to the reader.
    pub(crate) fn flush(&mut self) -> Result<(), Failure> {
        self.writer.flush().map_err(unwritable)
    }
}

/// The error of a result that could not be printed.
pub(super) fn unwritable(error: io::Error) -> Failure {
    Failure::new(format_args!("standard output cannot be written: {error}"), "write to another file")
}

/// Whether anything was written to standard output, and may have reached its reader.
pub(crate) fn has_begun() -> bool {
    BEGUN.load(Ordering::Relaxed)
}

static BEGUN: AtomicBool = AtomicBool::new(false);

/// A writer that ignores a closed pipe: the reader has seen enough.
struct UntilClosed<W>(W);

impl<W: Write> Write for UntilClosed<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        // Before the write: a full pipe blocks here with half of the bytes read.
        BEGUN.store(true, Ordering::Relaxed);
        match self.0.write(bytes) {
            Err(error) if error.kind() == io::ErrorKind::BrokenPipe => Ok(bytes.len()),
            result => result,
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        match self.0.flush() {
            Err(error) if error.kind() == io::ErrorKind::BrokenPipe => Ok(()),
            result => result,
        }
    }
}

/// A number for JSON, which has neither NaN nor infinity: those become null.
pub(crate) fn number(value: f64) -> Value {
    Value::from(value)
}

/// A single-precision number for JSON with no more digits than it needs to be read back exactly.
pub(crate) fn number32(value: f32) -> Value {
    // The shortest decimal of the f32, which as an f64 prints the same digits.
    value.to_string().parse().map_or(Value::Null, number)
}

/// A number in text output: six significant digits.
pub(crate) fn significant(value: f64) -> String {
    let rounded: f64 = format!("{value:.5e}").parse().unwrap_or(value);
    match rounded.abs() {
        size if size == 0.0 || (1e-4..1e7).contains(&size) => (rounded + 0.0).to_string(),
        _ => format!("{rounded:e}"),
    }
}

/// "1 shell", "2 shells".
pub(crate) fn counted(count: usize, one: &str, many: &str) -> String {
    format!("{count} {}", if count == 1 { one } else { many })
}

/// Text of a file, safe for a terminal: without control characters, so one line and no escape sequences.
pub(crate) fn plain(text: &str) -> String {
    text.replace(char::is_control, "\u{fffd}")
}

/// A name from a file, fit for a table: at most 60 characters.
pub(crate) fn short(name: &str) -> String {
    const MOST: usize = 60;
    let plain = plain(name);
    match plain.char_indices().nth(MOST) {
        None => plain,
        Some(_) => plain.chars().take(MOST - 1).chain(['…']).collect(),
    }
}

/// A name without its middle, fit for a table with many columns: at most 24 characters.
pub(crate) fn brief(name: &str) -> String {
    const BEFORE: usize = 11;
    const AFTER: usize = 12;
    let plain = plain(name);
    let count = plain.chars().count();
    match count > BEFORE + 1 + AFTER {
        false => plain,
        true => plain.chars().take(BEFORE).chain(['…']).chain(plain.chars().skip(count - AFTER)).collect(),
    }
}

/// Rows with aligned columns: the first one to the left, the rest to the right.
pub(crate) struct Table {
    rows: Vec<Vec<String>>,
    width: usize,
    name_last: bool,
}

impl Table {
    /// A line break in a title continues it on a further line of the header.
    pub(crate) fn new(header: &[&str]) -> Self {
        let lines = header.iter().map(|title| title.lines().count()).max().unwrap_or(0).max(1);
        // The last line is complete, those above it hold what comes before.
        let line = |index: usize| {
            let cell = |title: &&str| {
                let parts: Vec<&str> = title.lines().collect();
                (index + parts.len()).checked_sub(lines).map_or(String::new(), |at| parts[at].to_owned())
            };
            header.iter().map(cell).collect()
        };
        let rows = (0..lines).map(line).collect();
        Self { rows, width: usize::MAX, name_last: false }
    }

    /// Columns that do not fit into this width form a further block, which begins with the first column
    /// again.
    pub(crate) fn within(self, width: usize) -> Self {
        Self { width, ..self }
    }

    /// The last column has names: aligned to the left, it may be of any length.
    pub(crate) fn name_last(self) -> Self {
        Self { name_last: true, ..self }
    }

    pub(crate) fn row(&mut self, cells: Vec<String>) {
        self.rows.push(cells);
    }

    /// The columns of each block.
    fn blocks(&self, widths: &[usize]) -> Vec<Vec<usize>> {
        let mut blocks: Vec<Vec<usize>> = vec![Vec::new()];
        let first = widths.first().copied().unwrap_or(0);
        let mut used = 0;
        for (column, &width) in widths.iter().enumerate() {
            if used + 2 + width > self.width && blocks.last().is_some_and(|block| block.len() > 1) {
                blocks.push(vec![0]);
                used = 2 + first;
            }
            used += 2 + width;
            blocks.last_mut().expect("there is always one").push(column);
        }
        blocks
    }
}

/// Characters that are seen: all but what changes the color.
fn seen(cell: &str) -> usize {
    let mut parts = cell.split('\x1b');
    let first = parts.next().map_or(0, |part| part.chars().count());
    first + parts.map(|part| part.split_once('m').map_or(0, |(_, text)| text.chars().count())).sum::<usize>()
}

impl Display for Table {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let columns = self.rows.iter().map(Vec::len).max().unwrap_or(0);
        let width = |column: usize| {
            self.rows.iter().filter_map(|row| row.get(column)).map(|c| seen(c)).max().unwrap_or(0)
        };
        let widths: Vec<usize> = (0..columns).map(width).collect();
        for (block, of_block) in self.blocks(&widths).into_iter().enumerate() {
            if block > 0 {
                f.write_str("\n\n")?;
            }
            let mut has_begun = false;
            for row in &self.rows {
                let cells = of_block.iter().filter_map(|&column| {
                    let (cell, width) = (row.get(column)?, widths[column]);
                    let space = " ".repeat(width - seen(cell));
                    let is_left = if self.name_last { column + 1 == columns } else { column == 0 };
                    Some(if is_left { format!("{cell}{space}") } else { format!("{space}{cell}") })
                });
                let line: Vec<String> = cells.collect();
                let line = line.join("  ");
                // A line of the header that no title in this block reaches.
                if line.trim().is_empty() {
                    continue;
                }
                if has_begun {
                    f.write_str("\n")?;
                }
                has_begun = true;
                write!(f, "  {}", line.trim_end())?;
            }
        }
        Ok(())
    }
}

/// `a.png`, `a-2.png`, `a-3.png`.
pub(crate) fn numbered(path: &Path, number: usize) -> PathBuf {
    if number == 1 {
        return path.to_owned();
    }
    let mut name = path.file_stem().unwrap_or_default().to_owned();
    name.push(format!("-{number}.png"));
    path.with_file_name(name)
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Closed(io::ErrorKind);

    impl Write for Closed {
        fn write(&mut self, _: &[u8]) -> io::Result<usize> {
            Err(self.0.into())
        }

        fn flush(&mut self) -> io::Result<()> {
            Err(self.0.into())
        }
    }

    #[test]
    fn output_is_quiet_about_a_closed_pipe_and_nothing_else() {
        let mut closed = UntilClosed(Closed(io::ErrorKind::BrokenPipe));
        assert!(closed.write_all(b"x").is_ok() && closed.flush().is_ok());
        let mut full = UntilClosed(Closed(io::ErrorKind::StorageFull));
        assert!(full.write_all(b"x").is_err() && full.flush().is_err());
    }

    #[test]
    fn json_numbers_are_finite_and_short() {
        assert_eq!(
            [number(f64::NAN), number(f64::INFINITY), number32(f32::NAN)],
            [(); 3].map(|()| Value::Null)
        );
        assert_eq!(number32(0.1).to_string(), "0.1");
        for value in [f32::MAX, f32::MIN_POSITIVE, 1e-45, 16_777_216.0, -0.3] {
            assert_eq!(number32(value).to_string().parse::<f32>().unwrap(), value);
        }
    }

    #[test]
    fn significant_digits_are_six() {
        let of = [0.0, -0.0, 0.1, -1.234567, 6_543_210.9, 1e7, 2.7e-16, f64::NAN].map(significant);
        assert_eq!(of, ["0", "0", "0.1", "-1.23457", "6543210", "1e7", "2.7e-16", "NaN"]);
    }

    #[test]
    fn table_aligns_numbers_to_the_right() {
        let mut table = Table::new(&["mesh", "faces"]);
        table.row(vec!["wädchen".into(), "7".into()]);
        assert_eq!(table.to_string(), "  mesh     faces\n  wädchen      7");
    }

    #[test]
    fn table_wraps_columns_that_do_not_fit_and_counts_no_color() {
        let mut table = Table::new(&["mesh", "faces", "non-\nmanifold"]).within(16);
        table.row(vec!["a".into(), "\x1b[31m7\x1b[0m".into(), "12".into()]);
        assert_eq!(
            table.to_string(),
            "  mesh  faces\n  a         \x1b[31m7\x1b[0m\n\n            non-\n  mesh  manifold\n  a           12"
        );
        let wide = Table { width: 80, ..table };
        assert_eq!(wide.to_string().lines().count(), 3, "fault injected: one block where there is room");
        let mut table = Table::new(&["n", "file"]).name_last();
        table.row(vec!["100".into(), "b".into()]);
        assert_eq!(table.to_string(), "    n  file\n  100  b");
    }

    #[test]
    fn pictures_of_further_lights_are_numbered() {
        let names = [1, 2, 10].map(|light| numbered(Path::new("a/b.c.png"), light));
        assert_eq!(names, ["a/b.c.png", "a/b.c-2.png", "a/b.c-10.png"].map(PathBuf::from));
    }

    #[test]
    fn brief_names_keep_both_ends() {
        assert_eq!(brief("abcdefghijklmnopqrstuvwx"), "abcdefghijklmnopqrstuvwx");
        assert_eq!(brief("abcdefghijklmnopqrstuvwxy"), "abcdefghijk…nopqrstuvwxy");
    }

    #[test]
    fn names_have_no_control_characters_and_an_end() {
        assert_eq!(short("a\x1b[31m\nb"), "a\u{fffd}[31m\u{fffd}b");
        assert_eq!(short(&"ä".repeat(60)), "ä".repeat(60));
        assert_eq!(short(&"ä".repeat(61)), format!("{}…", "ä".repeat(59)));
    }
}
