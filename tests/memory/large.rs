//! From a large file to its crack report, as `umbrage check` goes.
//!
//! `UMBRAGE_LARGE_FACES=100000000` takes some minutes, 5 GB of disk for a while, and 9 GB of memory.

use umbrage::check::CrackReport;
use umbrage::mesh::{Weld, weld_in_place};
use umbrage::read::read;
use umbrage::scene::Scope;
use umbrage::topology::Topology;

use super::{alone, peak};

#[path = "../../examples/large_torus/torus.rs"]
mod torus;

#[test]
fn memory_of_a_check_is_a_few_bytes_a_face_from_file_to_report() {
    let _alone = alone();
    let faces = std::env::var("UMBRAGE_LARGE_FACES").map_or(300_000, |faces| faces.parse().unwrap());
    let folder = tempfile::tempdir().unwrap();
    for (extension, bound) in [("ply", 80), ("stl", 96)] {
        let path = folder.path().join(format!("torus.{extension}"));
        let faces = torus::write(&path, faces).unwrap() as usize;
        let check = || {
            let mesh = read(&path).unwrap().bake(Scope::Mesh).unwrap().remove(0);
            let mesh = weld_in_place(mesh, Weld::Exact).mesh;
            let topology = Topology::of(&mesh);
            CrackReport::of(&mesh, &topology).counts
        };
        let (counts, bytes) = peak(check);
        std::fs::remove_file(&path).unwrap();
        assert!(counts.sound() && counts.faces == faces && counts.euler_characteristic == 0, "{counts:?}");
        eprintln!("{extension}, {faces} faces: {:.1} bytes a face", bytes as f64 / faces as f64);
        assert!(bytes < (1 << 20) + bound * faces, "{extension}: {} bytes a face", bytes / faces);
    }
}
