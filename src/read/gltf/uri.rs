//! Where a buffer's bytes are: in the URI itself, or in a file that must not lie outside the document's
//! folder.

use std::path::{Component, Path, PathBuf};

use base64::Engine;
use base64::alphabet::STANDARD;
use base64::engine::{DecodePaddingMode, GeneralPurpose, GeneralPurposeConfig};

/// A URI that may be followed.
#[derive(Debug, PartialEq, Eq)]
pub(super) enum Uri {
    /// The bytes themselves.
    Data(Vec<u8>),
    /// A path without a root that stays in the folder it is taken from, as far as its text shows.
    Relative(PathBuf),
}

/// Padding at the end is optional in the wild.
const BASE64: GeneralPurpose = GeneralPurpose::new(
    &STANDARD,
    GeneralPurposeConfig::new().with_decode_padding_mode(DecodePaddingMode::Indifferent),
);

/// Takes a URI apart, or says why it is not followed.
pub(super) fn parse(uri: &str) -> Result<Uri, String> {
    if let Some(data) = uri.strip_prefix("data:") {
        let (kind, text) = data.split_once(',').ok_or("the data URI has no comma before its data")?;
        if !kind.ends_with(";base64") {
            return Err("the data URI is not base64".to_owned());
        }
        let bytes = BASE64.decode(text).map_err(|error| format!("the data URI is not base64: {error}"))?;
        return Ok(Uri::Data(bytes));
    }
    let shown = if uri.chars().count() > 80 { "the URI" } else { uri };
    if let Some(scheme) = scheme(uri) {
        return Err(format!("`{shown}` leaves the folder of the file: {scheme}: is not followed"));
    }
    let decoded = percent_decode(uri).ok_or_else(|| format!("`{shown}` is not a well-formed URI"))?;
    let path = Path::new(&decoded);
    let mut depth = 0_usize;
    for component in path.components() {
        match component {
            Component::Normal(_) => depth += 1,
            Component::CurDir => {}
            Component::ParentDir if depth > 0 => depth -= 1,
            Component::ParentDir => return Err(format!("`{shown}` leaves the folder of the file")),
            Component::RootDir | Component::Prefix(_) => {
                return Err(format!("`{shown}` leaves the folder of the file: it is an absolute path"));
            }
        }
    }
    if depth == 0 { Err(format!("`{shown}` names no file")) } else { Ok(Uri::Relative(path.to_owned())) }
}

/// The text before the colon, if it has the form of a scheme (RFC 3986 §3.1): `http`, and `C` of a drive.
fn scheme(uri: &str) -> Option<&str> {
    let (scheme, _) = uri.split_once(':')?;
    let mut characters = scheme.chars();
    let formed = characters.next()?.is_ascii_alphabetic()
        && characters.all(|c| c.is_ascii_alphanumeric() || matches!(c, '+' | '-' | '.'));
    formed.then_some(scheme)
}

/// Decodes each `%XX` to its byte; `None` if one is malformed or the whole is not UTF-8.
fn percent_decode(uri: &str) -> Option<String> {
    let mut parts = uri.split('%');
    let mut bytes = parts.next()?.as_bytes().to_vec();
    for part in parts {
        let hex = part.get(..2).filter(|hex| hex.bytes().all(|byte| byte.is_ascii_hexdigit()))?;
        bytes.push(u8::from_str_radix(hex, 16).ok()?);
        bytes.extend_from_slice(&part.as_bytes()[2..]);
    }
    String::from_utf8(bytes).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn uri_relative_path_is_percent_decoded() {
        let file = |path: &str| Ok(Uri::Relative(path.into()));
        assert_eq!(parse("a%20b/%c3%a4.bin"), file("a b/ä.bin"));
        assert_eq!(parse("./a/../b.bin"), file("./a/../b.bin"));
        assert_eq!(parse("a%25.bin"), file("a%.bin"));
        for malformed in ["%", "%2", "%zz", "%+1", "%ff", "a%é"] {
            assert!(parse(malformed).unwrap_err().contains("well-formed"), "{malformed}");
        }
    }

    #[test]
    fn uri_that_leaves_the_folder_is_refused() {
        let leaving = [
            "../a.bin",
            "a/../../b.bin",
            "%2e%2e/a.bin",
            "..%2Fa.bin",
            "/etc/passwd",
            "%2Fetc/passwd",
            "http://a/b.bin",
            "file:///a.bin",
            "C:/a.bin",
            "//host/a.bin",
        ];
        for uri in leaving {
            assert!(parse(uri).unwrap_err().contains("leaves the folder"), "{uri}");
        }
        for nowhere in ["", ".", "a/.."] {
            assert!(parse(nowhere).unwrap_err().contains("names no file"), "{nowhere}");
        }
    }

    #[test]
    fn uri_data_is_base64_with_or_without_padding() {
        let bytes = |bytes: &[u8]| Ok(Uri::Data(bytes.to_vec()));
        assert_eq!(parse("data:application/octet-stream;base64,AQI="), bytes(&[1, 2]));
        assert_eq!(parse("data:;base64,AQI"), bytes(&[1, 2]));
        assert_eq!(parse("data:;base64,"), bytes(&[]));
        for malformed in ["data:", "data:text/plain,abc", "data:;base64,*"] {
            assert!(parse(malformed).unwrap_err().contains("data URI"), "{malformed}");
        }
    }
}
