//! Writes a torus of as many triangles as asked for, to see how the command takes a large file:
//!
//! ```text
//! cargo run --release --example large_torus -- torus.ply 100000000
//! /usr/bin/time -v umbrage check torus.ply
//! ```
//!
//! The extension tells the format: `ply` and `stl` are binary, the one with vertices that faces share (19 bytes a
//! triangle), the other a soup (50). The file is written as it is computed; nothing of the mesh is held.

mod torus;

use std::path::Path;
use std::process::ExitCode;

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let result = match arguments.as_slice() {
        [path, faces] => match faces.parse() {
            Ok(faces) => torus::write(Path::new(path), faces).map_err(|error| format!("{path}: {error}")),
            Err(error) => Err(format!("{faces}: {error}; write the number of triangles in digits")),
        },
        _ => Err("usage: large_torus OUT.ply|OUT.stl TRIANGLES".to_owned()),
    };
    match result {
        Ok(faces) => {
            eprintln!("{faces} triangles");
            ExitCode::SUCCESS
        }
        Err(problem) => {
            eprintln!("{problem}");
            ExitCode::from(2)
        }
    }
}
