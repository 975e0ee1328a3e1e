//! Atomic writes: a file is written under a temporary name in the same folder, then renamed over the target;
//! also where a signal ends the program.

use std::fs::{self, File, OpenOptions};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::process;
use std::sync::{Mutex, MutexGuard, PoisonError};

use super::WriteError;

/// Writes the file `path` with `body`, completely or not at all.
///
/// The bytes go to a temporary file in the same folder, are flushed to the disk, and the file is then renamed
/// to `path` in one step. If anything fails, the temporary file is removed and an existing target is
/// untouched. An existing file keeps its permissions; of a symbolic link, its target is replaced. For any
/// file, not only meshes.
///
/// # Errors
///
/// [`WriteError`], naming `path`, if the folder does not exist, the target is a directory, read-only or no
/// regular file, `body` fails, or the disk does.
///
/// ```
/// use std::io::{self, Write};
/// let path = std::env::temp_dir().join("umbrage-example.csv");
/// umbrage::write::write_atomic(&path, |out| writeln!(out, "edges,seconds"))?;
/// assert_eq!(std::fs::read(&path)?, b"edges,seconds\n");
/// # std::fs::remove_file(&path)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn write_atomic<E: Into<WriteError>>(
    path: impl AsRef<Path>,
    body: impl FnOnce(&mut dyn Write) -> Result<(), E>,
) -> Result<(), WriteError> {
    let path = path.as_ref();
    replace(path, body).map_err(|error| error.in_file(path))
}

fn replace<E: Into<WriteError>>(
    path: &Path,
    body: impl FnOnce(&mut dyn Write) -> Result<(), E>,
) -> Result<(), WriteError> {
    let existing = fs::metadata(path).ok();
    match &existing {
        Some(found) if found.is_dir() => return Err(WriteError::new("is a directory", "name a file in it")),
        Some(found) if !found.is_file() => {
            return Err(WriteError::new("is not a regular file", "name another file"));
        }
        Some(found) if found.permissions().readonly() => {
            return Err(WriteError::new("is read-only", "name another file, or make it writable"));
        }
        _ => {}
    }
    // Links are resolved first: a rename would replace the link itself.
    let target = if existing.is_some() { fs::canonicalize(path)? } else { path.to_owned() };
    if target.file_name().is_none() {
        return Err(WriteError::new("is not the name of a file", "name a file"));
    }
    let folder = match target.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    if !folder.is_dir() {
        let problem = format!("cannot be written: there is no folder {}", folder.display());
        return Err(WriteError::new(problem, "create the folder first"));
    }

    let (temporary, file) = Temporary::create(folder)?;
    let mut writer = BufWriter::with_capacity(1 << 18, file);
    body(&mut writer).map_err(Into::into)?;
    let file = writer.into_inner().map_err(io::IntoInnerError::into_error)?;
    if let Some(existing) = existing {
        file.set_permissions(existing.permissions())?;
    }
    file.sync_all()?;
    drop(file); // some systems rename closed files only
    temporary.rename(&target)?;
    Ok(())
}

/// Cleanup for a program that is about to exit while [`write_atomic`] may be running on other threads:
/// removes every temporary file, then calls `last` with the number of files that were completely written
/// since the program began. Until `last` returns, no write starts or finishes. `last` may exit the program;
/// if it returns, the interrupted writes fail.
pub fn abandon<T>(last: impl FnOnce(usize) -> T) -> T {
    let mut writes = writes();
    for path in writes.under_way.drain(..) {
        let _ = fs::remove_file(path); // nothing better can be done if it fails
    }
    last(writes.finished)
}

/// The state of all writes of this program.
struct Writes {
    /// Temporary files that exist.
    under_way: Vec<PathBuf>,
    finished: usize,
    /// How many writes were ever started: numbers the temporary files.
    begun: u32,
}

fn writes() -> MutexGuard<'static, Writes> {
    static WRITES: Mutex<Writes> = Mutex::new(Writes { under_way: Vec::new(), finished: 0, begun: 0 });
    // Every change of it is complete, whichever thread panicked.
    WRITES.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A file that is removed unless it is renamed, even if writing it panics.
struct Temporary(Option<PathBuf>);

impl Temporary {
    /// Creates a new file in `folder`, under an unused name.
    fn create(folder: &Path) -> io::Result<(Self, File)> {
        let mut writes = writes();
        loop {
            writes.begun = writes.begun.wrapping_add(1);
            let path = folder.join(format!(".umbrage-{}-{}.tmp", process::id(), writes.begun));
            match OpenOptions::new().write(true).create_new(true).open(&path) {
                Ok(file) => {
                    writes.under_way.push(path.clone());
                    return Ok((Self(Some(path)), file));
                }
                Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {}
                Err(error) => return Err(error),
            }
        }
    }

    fn rename(mut self, target: &Path) -> io::Result<()> {
        if let Some(path) = &self.0 {
            // Locals are dropped before `self`, which takes the lock again if this fails.
            let mut writes = writes();
            fs::rename(path, target)?;
            writes.under_way.retain(|other| other != path);
            writes.finished += 1;
        }
        self.0 = None;
        Ok(())
    }
}

impl Drop for Temporary {
    fn drop(&mut self) {
        if let Some(path) = &self.0 {
            // Nothing better can be done if this fails, and the first error is already being returned.
            let _ = fs::remove_file(path);
            writes().under_way.retain(|other| other != path);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        let entries = fs::read_dir(folder).unwrap();
        entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect()
    }

    #[test]
    fn atomic_write_replaces_the_whole_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.txt");
        fs::write(&path, "something longer").unwrap();
        write_atomic(&path, |out| out.write_all(b"new")).unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"new");
        assert_eq!(names(folder.path()), ["a.txt"]);
    }

    #[test]
    fn atomic_write_that_fails_leaves_the_old_file_and_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.txt");
        fs::write(&path, "old").unwrap();
        let error = write_atomic(&path, |out| {
            out.write_all(&[7; 1 << 20])?;
            out.flush()?;
            Err(io::Error::new(io::ErrorKind::StorageFull, "no\nspace"))
        })
        .unwrap_err();
        let line = error.to_string();
        assert!(line.starts_with(&*path.to_string_lossy()) && line.ends_with("; free some space"), "{line}");
        assert_eq!(line.lines().count(), 1);
        assert_eq!(fs::read(&path).unwrap(), b"old");
        assert_eq!(names(folder.path()), ["a.txt"]);
    }

    #[test]
    fn atomic_write_that_panics_leaves_no_temporary_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.txt");
        let caught = std::panic::catch_unwind(|| {
            write_atomic(&path, |_| -> io::Result<()> { panic!("while writing") })
        });
        assert!(caught.is_err());
        assert!(names(folder.path()).is_empty());
    }

    #[test]
    fn atomic_write_refuses_a_directory_and_a_missing_folder() {
        let folder = tempfile::tempdir().unwrap();
        let body = |_: &mut dyn Write| -> io::Result<()> { panic!("the path is checked first") };
        let error = write_atomic(folder.path(), body).unwrap_err();
        assert_eq!((error.problem.as_str(), error.remedy.as_str()), ("is a directory", "name a file in it"));
        let error = write_atomic(folder.path().join("no/a.txt"), body).unwrap_err();
        assert!(error.problem.contains("there is no folder"), "{error}");
        assert_eq!(write_atomic("", body).unwrap_err().problem, "is not the name of a file");
        assert!(names(folder.path()).is_empty());
    }

    #[test]
    fn atomic_write_refuses_a_read_only_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.txt");
        fs::write(&path, "old").unwrap();
        let mut permissions = fs::metadata(&path).unwrap().permissions();
        permissions.set_readonly(true);
        fs::set_permissions(&path, permissions).unwrap();
        assert_eq!(write_atomic(&path, |out| out.write_all(b"new")).unwrap_err().problem, "is read-only");
        assert_eq!(fs::read(&path).unwrap(), b"old");
    }

    #[cfg(unix)]
    #[test]
    fn atomic_write_follows_links_and_keeps_permissions() {
        use std::os::unix::fs::{PermissionsExt, symlink};
        let folder = tempfile::tempdir().unwrap();
        let [real, link] = ["real.txt", "link.txt"].map(|name| folder.path().join(name));
        fs::write(&real, "old").unwrap();
        fs::set_permissions(&real, fs::Permissions::from_mode(0o640)).unwrap();
        symlink(&real, &link).unwrap();
        write_atomic(&link, |out| out.write_all(b"new")).unwrap();
        assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
        assert_eq!(fs::read(&real).unwrap(), b"new");
        assert_eq!(fs::metadata(&real).unwrap().permissions().mode() & 0o777, 0o640);
    }

    #[cfg(unix)]
    #[test]
    fn atomic_write_refuses_a_device() {
        let error = write_atomic("/dev/null", |out| out.write_all(b"new")).unwrap_err();
        assert_eq!(error.problem, "is not a regular file");
    }
}
