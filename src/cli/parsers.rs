//! Parsers of option values that several commands share, and their error messages.

use std::path::Path;

use super::Failure;

/// A count; may be 0.
pub(crate) fn whole(text: &str) -> Result<usize, String> {
    text.parse().map_err(|_| "write a whole number, 0 or more".to_owned())
}

/// A count that may be large: `1000000`, `1_000_000` or `1e6`.
pub(crate) fn large(text: &str) -> Result<u64, String> {
    let digits = text.replace('_', "");
    let (mantissa, exponent) = digits.split_once(['e', 'E']).unwrap_or((&digits, "0"));
    let number = mantissa.parse::<u64>().ok().zip(exponent.parse().ok()).and_then(|(mantissa, exponent)| {
        10_u64.checked_pow(exponent).and_then(|power| mantissa.checked_mul(power))
    });
    number.ok_or_else(|| "write a whole number, as 1000000 or 1e6".to_owned())
}

/// A seed.
pub(crate) fn seed(text: &str) -> Result<u64, String> {
    text.parse().map_err(|_| format!("write a whole number from 0 to {}", u64::MAX))
}

/// An angle.
pub(crate) fn degrees(text: &str) -> Result<f32, String> {
    text.parse().map_err(|_| "write a number of degrees".to_owned())
}

/// A positive distance.
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

/// Refuses an output whose folder does not exist, before any work is done.
pub(crate) fn require_folder(output: &Path) -> Result<(), Failure> {
    match output.parent() {
        Some(folder) if !folder.as_os_str().is_empty() && !folder.is_dir() => {
            let problem = format!("cannot be written: there is no folder {}", folder.display());
            Err(Failure::new(problem, "create it, or choose another folder").in_file(output))
        }
        _ => Ok(()),
    }
}

/// Whether two names are the same existing file, also through links.
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
    fn large_counts_may_have_an_exponent_or_underscores() {
        for text in ["1000000", "1_000_000", "1e6", "10E5"] {
            assert_eq!(large(text), Ok(1_000_000), "{text}");
        }
        for text in ["", "-1", "1.5e3", "1e", "e6", "1e20", "1e-3", "1e99999999999", "99999999999999999999"] {
            assert!(large(text).is_err(), "{text}");
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
