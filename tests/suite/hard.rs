//! Hard cases of shadow volumes, each with expected numbers on a generated mesh.
//!
//! A test is named `hard_`, the number of its case, and the expected result. The comment above a test names
//! the failure that the test guards against. Most tests inject a fault, often this very failure, and check
//! that the same comparison rejects it. The other tests compare numbers that differ from row to row, so that
//! no single answer fits all rows. Expected numbers are closed forms: counts of the generators, crossings
//! determined by hand, pixels of a picture whose centers are half-integers (`screen.rs`).
//!
//!  1. One sheet, lit from its front and from its back (`sheet.rs`, `camera.rs`).
//!  2. A light inside a closed shell (`inside.rs`, `camera.rs`).
//!  3. Three, five, nine and eighteen faces on one edge; solids that share an edge or a vertex (`fan.rs`).
//!  4. A face twice, with the same or the opposite winding (`sheet.rs`).
//!  5. A Möbius strip, mixed windings, all windings inside out (`winding.rs`).
//!  6. Collinear faces, zero-area faces, slivers, collapsed poles (`degenerate.rs`).
//!  7. Seams of a signed zero, of rounding noise, of one ulp; NaN and infinity in a file (`seam.rs`).
//!  8. T-junctions (`seam.rs`, `layers.rs`).
//!  9. A light in a plane, on an edge, on a vertex, where all planes meet, and one ulp off each (`tie.rs`).
//! 10. A light at the eye, behind it, in the near plane, very far away, along a part's axis (`camera.rs`).
//! 11. An eye in the volume; a near plane that cuts a side, a cap, the caster; a wide view (`camera.rs`).
//! 12. Volumes through w = 0, and geometry behind the eye (`camera.rs`).
//! 13. More nested shells than eight bits count (`layers.rs`).
//! 14. Coincident edges of two meshes (`layers.rs`); sides seen edge-on that meet, or end (`fins.rs`).
//! 15. Transforms that mirror, scale unevenly, flatten (`winding.rs`).
//! 16. More vertices than 16 bits number, more than f32 counts exactly (`large.rs`).
//! 17. Coordinates at both ends of f32, and far from the origin (`extreme.rs`).
//! 18. Sky behind an infinite volume (`camera.rs`).
//! 19. The dark cap of a directional light, which is one point (`camera.rs`).
//! 20. An empty mesh, a nearly empty mesh, no light, an invalid light (`sheet.rs`, `camera.rs`).
//! 21. Self-intersecting shells, lobes of negative winding, overlapping parts (`inside.rs`, `layers.rs`).
//! 22. Shells in shells, and cavities (`inside.rs`).
//! 23. Animation frames in which vertices meet and part (`frame.rs`).
//! 24. The terminator of a faceted ball (`layers.rs`).
//! 26. A crate before the eye on a large plain; an eye right before a wall (`near.rs`).
//! 27. Pixels far from the origin, and of boxes of the largest numbers (`far.rs`).
//! 28. Poles and caps of thousands of faces, stacked faces (`valence.rs`).
//! 29. Written volumes, read back (`written.rs`).

#[cfg(feature = "gpu")]
mod camera;
mod degenerate;
mod extreme;
#[cfg(feature = "gpu")]
mod far;
mod fan;
mod figures;
#[cfg(feature = "gpu")]
mod fins;
mod frame;
mod inside;
mod large;
#[cfg(feature = "gpu")]
mod layers;
#[cfg(feature = "gpu")]
mod screen;
#[cfg(feature = "gpu")]
mod near;
mod seam;
mod sheet;
mod tie;
mod valence;
mod winding;
#[cfg(feature = "files")]
mod written;

use std::collections::BTreeSet;
use std::fs;
use std::path::PathBuf;

fn folder() -> PathBuf {
    PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/suite/hard"))
}

/// Case and file of every entry in the list above.
fn listed() -> BTreeSet<(u32, String)> {
    let text = fs::read_to_string(folder().with_extension("rs")).unwrap();
    let items = text.lines().filter_map(|line| line.strip_prefix("//! ")?.split_once(". "));
    let items = items.filter_map(|(number, rest)| Some((number.trim().parse().ok()?, rest)));
    items
        .flat_map(|(number, rest): (u32, &str)| {
            let files = rest.split('`').skip(1).step_by(2).filter(|name| name.ends_with(".rs"));
            files.map(|file| (number, file.to_owned())).collect::<Vec<_>>()
        })
        .collect()
}

/// Case and file of every test in the folder.
fn tested() -> BTreeSet<(u32, String)> {
    let mut found = BTreeSet::new();
    for entry in fs::read_dir(folder()).unwrap() {
        let path = entry.unwrap().path();
        let file = path.file_name().unwrap().to_string_lossy().into_owned();
        for line in fs::read_to_string(&path).unwrap().lines() {
            if let Some(rest) = line.strip_prefix("fn hard_") {
                found.insert((rest[..2].parse().expect("two digits"), file.clone()));
            }
        }
    }
    found
}

#[test]
fn hard_cases_are_all_listed_and_all_tested() {
    let listed = listed();
    assert_eq!(tested(), listed);
    let numbers: BTreeSet<u32> = listed.iter().map(|(number, _)| *number).collect();
    assert!((1..=24).chain([26, 27, 29]).all(|number| numbers.contains(&number)), "{numbers:?}");
}
