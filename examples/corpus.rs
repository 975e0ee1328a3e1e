//! Writes small files with known defects into a folder, and what was put into each:
//! `cargo run --example corpus -- FOLDER [COUNT]`. `benches/corpus.py` checks them all.

use std::error::Error;
use std::fmt::Write as _;
use std::{env, fs, path::PathBuf};

use umbrage::testing::corpus::specimen;

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = env::args().skip(1);
    let folder = PathBuf::from(arguments.next().ok_or("name a folder, then how many files")?);
    let count: u32 = arguments.next().map_or(Ok(1000), |count| count.parse())?;
    fs::create_dir_all(folder.join("files"))?;
    let mut list = String::new();
    for index in 0..count {
        let file = specimen(index);
        fs::write(folder.join("files").join(&file.name), &file.bytes)?;
        write!(list, "{{\"file\":\"{}\"", file.name)?;
        for (name, number) in file.numbers.entries() {
            write!(list, ",\"{name}\":{number}")?;
        }
        list.push_str("}\n");
    }
    fs::write(folder.join("injected.jsonl"), list)?;
    Ok(())
}
