//! Bytes to the arguments of a command line, and the values that it takes.
//!
//! Arguments are put together from words that the command knows and from free text. No argument holds a
//! separator of folders, and none is `..`, so that whatever runs with them in a scratch folder stays there.

use std::fmt::{Debug, Display};
use std::str::FromStr;

use umbrage::geom::Light;
use umbrage::testing::generate::{Bytes, Draw};
use umbrage::view::Size;

#[rustfmt::skip]
const WORDS: [&str; 64] = [
    "check", "silhouette", "volume", "verify", "render", "torture", "demo", "help", "--help", "--version",
    "--json", "--light", "point:1,2,3", "directional:0,-1,0", "--weld", "exact", "none", "0.001", "--scope", "mesh",
    "primitive", "scene", "--require", "--fast", "--self-intersections", "--limit", "--picture", "--mark", "--method",
    "auto", "--adapter", "-o", "--output", "out.glb", "out.png", "--faces", "all", "front", "--caps", "both", "--far",
    "100", "--gpu", "--points", "10", "--seed", "7", "--threads", "2", "--size", "64x48", "--eye", "1,2,3",
    "--target", "0,0,0", "--fov", "45", "--samples", "--ground", "--out", "--", "a.obj", "-1", "1e999",
];

/// At most 24 arguments.
pub(crate) fn arguments(data: &[u8]) -> Vec<String> {
    let bytes = &mut Bytes::new(data);
    let mut arguments = Vec::new();
    while !bytes.is_empty() && arguments.len() < 24 {
        arguments.push(match bytes.byte() {
            word @ 0..64 => WORDS[usize::from(word)].to_owned(),
            // A word that is joined to the value after it.
            word @ 64..128 => format!("{}={}", WORDS[usize::from(word) - 64], text(bytes)),
            _ => text(bytes),
        });
    }
    arguments
}

fn text(bytes: &mut Bytes) -> String {
    let length = bytes.below(32) as usize;
    let text = String::from_utf8_lossy(bytes.take(length)).replace(['/', '\\', ':', '\0'], ":");
    if text == ".." { ".".to_owned() } else { text }
}

pub(crate) fn run(data: &[u8]) {
    for argument in arguments(data) {
        reads_back::<Light>(&argument);
        reads_back::<Size>(&argument);
    }
}

/// Panics unless a value that can be read is printed so that it reads back.
fn reads_back<T: FromStr<Err: Display> + Display + PartialEq + Debug>(text: &str) {
    match text.parse::<T>() {
        Ok(value) => assert_eq!(value.to_string().parse().ok(), Some(value), "{text:?}"),
        Err(error) => assert!(!error.to_string().is_empty()),
    }
}

/// Panics unless what the command says of arguments is one line.
pub(crate) fn is_one_line(refusal: &str) {
    assert!(!refusal.is_empty() && !refusal.contains(char::is_control), "{refusal:?}");
}
