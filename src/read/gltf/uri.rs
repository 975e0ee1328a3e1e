//! Where a buffer's bytes are: in the URI itself, or in a file that must not lie outside the document's
//! folder.

use std::borrow::Cow;
use std::path::{Component, Path, PathBuf};

use base64::Engine;
use base64::alphabet::STANDARD;
use base64::engine::{DecodePaddingMode, GeneralPurpose, GeneralPurposeConfig};

/// A URI that may be followed.
#[derive(Debug, PartialEq, Eq)]
pub(super) enum Uri {
    /// The bytes themselves.
    Data(Vec<u8>),
    /// Paths without a root that stay in the folder they are taken from, as far as their text shows.
    Relative {
        /// What the URI means; `None` if it is not well-formed.
        decoded: Option<PathBuf>,
        /// What its writer may have meant.
        as_written: Vec<PathBuf>,
    },
}

/// Why a URI is not followed, and the remedy.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Refused {
    pub(super) problem: String,
    pub(super) remedy: &'static str,
}

/// Padding at the end is optional in the wild.
const BASE64: GeneralPurpose = GeneralPurpose::new(
    &STANDARD,
    GeneralPurposeConfig::new().with_decode_padding_mode(DecodePaddingMode::Indifferent),
);

const BESIDE: &str = "put the buffer into the folder of the file and name it by a relative path";
const AGAIN: &str = "export the file again, or with its buffer in a file of its own";

/// Takes a URI apart.
pub(super) fn parse(uri: &str) -> Result<Uri, Refused> {
    let uri = uri.trim_ascii();
    match scheme(uri) {
        Some(scheme) if scheme.eq_ignore_ascii_case("data") => data(&uri[scheme.len() + 1..])
            .map(Uri::Data)
            .map_err(|problem| Refused { problem, remedy: AGAIN }),
        Some(scheme) => {
            let problem = format!("{} leaves the folder of the file: {scheme}: is not followed", shown(uri));
            Err(Refused { problem, remedy: BESIDE })
        }
        None => relative(uri).map_err(|problem| Refused { problem, remedy: BESIDE }),
    }
}

/// A URI in a message, cut where it is long: it may hold a whole buffer.
pub(super) fn shown(uri: &str) -> String {
    match uri.char_indices().nth(60) {
        Some((end, _)) => format!("`{}…`", &uri[..end]),
        None => format!("`{uri}`"),
    }
}

/// The bytes of a data URI (RFC 2397) behind its scheme.
fn data(uri: &str) -> Result<Vec<u8>, String> {
    let (kind, text) = uri.split_once(',').ok_or("the data URI has no comma before its data")?;
    let plain = !text.bytes().any(|byte| byte == b'%' || byte.is_ascii_whitespace());
    let text = match plain {
        true => Cow::Borrowed(text.as_bytes()),
        false => {
            let lone = "the data URI has a % without two hexadecimal digits";
            let mut bytes = percent_decode(text).ok_or(lone)?;
            bytes.retain(|byte| !byte.is_ascii_whitespace());
            Cow::Owned(bytes)
        }
    };
    if !kind.to_ascii_lowercase().ends_with(";base64") {
        return Err("the data URI is not base64".to_owned());
    }
    BASE64.decode(text).map_err(|error| format!("the data URI is not base64: {error}"))
}

/// The paths that a relative reference may mean. A name that was not percent-encoded, or has the separators
/// of another system, is meant as it stands.
fn relative(uri: &str) -> Result<Uri, String> {
    // None of them may leave the folder, so that it does not matter which of them exist.
    let path = |text: &str| inside(text).map_err(|problem| format!("{} {problem}", shown(uri)));
    let decoded = percent_decode(uri).and_then(|bytes| String::from_utf8(bytes).ok());
    let mut as_written = Vec::new();
    for text in [uri.to_owned(), uri.replace('\\', "/")] {
        let path = path(&text)?;
        if decoded.as_ref() != Some(&text) && !as_written.contains(&path) {
            as_written.push(path);
        }
    }
    Ok(Uri::Relative { decoded: decoded.as_deref().map(path).transpose()?, as_written })
}

/// A path that stays in its folder, as far as its text shows.
fn inside(text: &str) -> Result<PathBuf, &'static str> {
    let path = Path::new(text);
    let mut depth = 0_usize;
    for component in path.components() {
        match component {
            Component::Normal(_) => depth += 1,
            Component::CurDir => {}
            Component::ParentDir if depth > 0 => depth -= 1,
            Component::ParentDir => return Err("leaves the folder of the file"),
            Component::RootDir | Component::Prefix(_) => {
                return Err("leaves the folder of the file: it is an absolute path");
            }
        }
    }
    if depth == 0 { Err("names no file") } else { Ok(path.to_owned()) }
}

/// The text before the colon, if it has the form of a scheme (RFC 3986 §3.1): `http`, and `C` of a drive.
fn scheme(uri: &str) -> Option<&str> {
    let (scheme, _) = uri.split_once(':')?;
    let mut characters = scheme.chars();
    let formed = characters.next()?.is_ascii_alphabetic()
        && characters.all(|c| c.is_ascii_alphanumeric() || matches!(c, '+' | '-' | '.'));
    formed.then_some(scheme)
}

/// Decodes each `%XX` to its byte; `None` if one is malformed.
fn percent_decode(uri: &str) -> Option<Vec<u8>> {
    let mut parts = uri.split('%');
    let mut bytes = parts.next()?.as_bytes().to_vec();
    for part in parts {
        let hex = part.get(..2).filter(|hex| hex.bytes().all(|byte| byte.is_ascii_hexdigit()))?;
        bytes.push(u8::from_str_radix(hex, 16).ok()?);
        bytes.extend_from_slice(&part.as_bytes()[2..]);
    }
    Some(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn problem(uri: &str) -> String {
        parse(uri).unwrap_err().problem
    }

    #[test]
    fn uri_relative_path_is_percent_decoded_else_taken_as_it_stands() {
        let files = |decoded: Option<&str>, as_written: &[&str]| {
            let as_written = as_written.iter().map(PathBuf::from).collect();
            Ok(Uri::Relative { decoded: decoded.map(PathBuf::from), as_written })
        };
        assert_eq!(parse("a%20b/%c3%a4.bin"), files(Some("a b/ä.bin"), &["a%20b/%c3%a4.bin"]));
        assert_eq!(parse("./a/../b.bin"), files(Some("./a/../b.bin"), &[]));
        assert_eq!(parse("a%25.bin"), files(Some("a%.bin"), &["a%25.bin"]));
        assert_eq!(parse(r"a\b.bin"), files(Some(r"a\b.bin"), &["a/b.bin"]));
        for bare in ["%", "%2", "%zz", "%+1", "%ff", "a%é", "100% b.bin"] {
            assert_eq!(parse(bare), files(None, &[bare]), "{bare}");
        }
    }

    #[test]
    fn uri_that_leaves_the_folder_is_refused() {
        let leaving = [
            "../a.bin",
            "a/../../b.bin",
            "%2e%2e/a.bin",
            "..%2Fa.bin",
            r"..\a.bin",
            r"a%\..\..\b.bin",
            "/etc/passwd",
            "%2Fetc/passwd",
            "http://a/b.bin",
            "file:///a.bin",
            "C:/a.bin",
            "//host/a.bin",
        ];
        for uri in leaving {
            assert!(problem(uri).contains("leaves the folder"), "{uri}");
        }
        for nowhere in ["", ".", "a/..", " "] {
            assert!(problem(nowhere).contains("names no file"), "{nowhere}");
        }
    }

    #[test]
    fn uri_data_is_base64_with_or_without_padding() {
        let bytes = |bytes: &[u8]| Ok(Uri::Data(bytes.to_vec()));
        assert_eq!(parse("data:application/octet-stream;base64,AQI="), bytes(&[1, 2]));
        for written in
            ["data:;base64,AQI", "DATA:;BASE64,AQI", " data:;base64,A Q\nI\n", "data:;base64,AQI%3D"]
        {
            assert_eq!(parse(written), bytes(&[1, 2]), "{written}");
        }
        assert_eq!(parse("data:;base64,"), bytes(&[]));
        for malformed in ["data:", "data:text/plain,abc", "data:;base64,*", "data:;base64,%"] {
            assert!(problem(malformed).contains("data URI"), "{malformed}");
        }
    }

    #[test]
    fn uri_is_cut_in_messages() {
        let long = "ä/".repeat(5000);
        for uri in [format!("../{long}"), format!("ftp://{long}"), format!("/{long}"), format!("{long}..")] {
            if let Err(refused) = parse(&uri) {
                assert!(refused.problem.len() < 250, "{}", refused.problem);
            }
        }
        assert!(shown(&long).len() < 130 && shown(&long).ends_with("…`"));
        assert_eq!(shown("b.bin"), "`b.bin`");
    }
}
