//! Values of options that several commands take, and what is said of one that is none.

use std::path::Path;

use super::Failure;

/// A count; may be 0.
pub(crate) fn whole(text: &str) -> Result<usize, String> {
    text.parse().map_err(|_| "write a whole number, 0 or more".to_owned())
}

/// A seed.
pub(crate) fn seed(text: &str) -> Result<u64, String> {
    text.parse().map_err(|_| format!("write a whole number from 0 to {}", u64::MAX))
}

/// An angle.
pub(crate) fn degrees(text: &str) -> Result<f32, String> {
    text.parse().map_err(|_| "write a number of degrees".to_owned())
}

/// A distance that is some.
pub(crate) fn distance(text: &str) -> Result<f32, String> {
    match text.parse::<f32>() {
        Ok(distance) if distance > 0.0 && distance.is_finite() => Ok(distance),
        _ => Err("write a distance above 0 in mesh units".to_owned()),
    }
}

/// Refuses to write over the file that is read.
pub(crate) fn refuse_overwriting(option: &str, output: Option<&Path>, input: &Path) -> Result<(), Failure> {
    match output {
        Some(output) if is_same_file(output, input) => {
            let problem = format!("{option} names the input file, which would be overwritten");
            Err(Failure::new(problem, "name another file").in_file(output))
        }
        _ => Ok(()),
    }
}

/// Refuses an output whose folder is not there, before the work and not after it.
pub(crate) fn require_folder(output: &Path) -> Result<(), Failure> {
    match output.parent() {
        Some(folder) if !folder.as_os_str().is_empty() && !folder.is_dir() => {
            let problem = format!("cannot be written: there is no folder {}", folder.display());
            Err(Failure::new(problem, "make it, or choose another place").in_file(output))
        }
        _ => Ok(()),
    }
}

/// Whether two names lead to one file that exists, through links too.
fn is_same_file(a: &Path, b: &Path) -> bool {
    #[cfg(unix)]
    {
        use std::os::unix::fs::MetadataExt;
        let identity = |path: &Path| std::fs::metadata(path).map(|found| (found.dev(), found.ino())).ok();
        identity(a).is_some() && identity(a) == identity(b)
    }
    #[cfg(not(unix))]
    {
        let real = |path: &Path| std::fs::canonicalize(path).ok();
        real(a).is_some() && real(a) == real(b)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_that_are_none_are_told_what_to_write() {
        assert_eq!(
            (whole("0"), seed("7"), degrees("-3.5"), distance("1e-3")),
            (Ok(0), Ok(7), Ok(-3.5), Ok(1e-3))
        );
        for error in [whole("-1").err(), seed("x").err(), degrees("°").err(), distance("0").err()] {
            assert!(error.is_some_and(|text| text.starts_with("write ")));
        }
    }

    #[test]
    fn same_file_is_told_through_other_names() {
        let folder = tempfile::tempdir().unwrap();
        let [a, b] = ["a", "b"].map(|name| folder.path().join(name));
        std::fs::write(&a, "a").unwrap();
        assert!(!is_same_file(&a, &b) && !is_same_file(&b, &b), "what does not exist cannot be lost");
        std::fs::write(&b, "a").unwrap();
        assert!(!is_same_file(&a, &b));
        assert!(is_same_file(&a, &folder.path().join(".").join("a")));
    }
}
