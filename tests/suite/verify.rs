//! Every method against every other on the real meshes, with the hardest lights.
//!
//! Long form: `UMBRAGE_VERIFY_POINTS=100000 cargo test --release --test suite verify_all -- --nocapture`.

use umbrage::caster::Caster;
use umbrage::geom::{Aabb, Light};
use umbrage::mesh::{Mesh, Weld, weld};
use umbrage::scene::Scope;
use umbrage::verify::points::{Options, Stratum, Verifier};

use crate::support::real_meshes;

/// Lights: outside, inside the bounding box, on a vertex, and directional along an axis.
fn lights(mesh: &Mesh) -> [Light; 4] {
    let [low, high] = mesh.bounds().expect("a real mesh has faces");
    let bounds = Aabb { low, high };
    let center = bounds.center();
    let size = bounds.diagonal() as f32;
    let vertex = mesh.positions()[mesh.vertex_count() / 2];
    [
        Light::point([center[0] + 0.7 * size, center[1] + 1.1 * size, center[2] + 0.4 * size]),
        Light::point([0, 1, 2].map(|i| center[i] + 0.21 * (high[i] - low[i]))),
        Light::point(vertex),
        Light::directional([0.0, -1.0, 0.0]),
    ]
    .map(|light| light.expect("finite and not zero"))
}

#[test]
fn verify_all_judges_agree_on_every_real_mesh() {
    let Some(folder) = real_meshes() else { return };
    let mut files: Vec<_> = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.sort();
    let points =
        std::env::var("UMBRAGE_VERIFY_POINTS").map_or(500, |n| n.parse().expect("a number of points"));
    let (mut judged, mut sum) = (0, Stratum::default());
    for file in files {
        let Ok(scene) = umbrage::read::read(&file) else { continue }; // notes and facts, a buffer
        let name = file.file_name().expect("a file").to_string_lossy().into_owned();
        let meshes: Vec<Mesh> =
            scene.bake(Scope::Mesh).unwrap().iter().map(|mesh| weld(mesh, Weld::Exact).mesh).collect();
        let mesh = Mesh::concat(&meshes).unwrap();
        let caster = Caster::new(mesh.clone());
        let verifier = Verifier::new(&caster);
        for light in lights(&mesh) {
            let options = Options { points, ..Options::default() };
            let result = verifier.verify(&light, &options, &|_| {});
            let total = result.total();
            eprintln!(
                "{name} {light}: {} agree, {} grazing, {} disagree",
                total.agree, total.grazing, total.disagree
            );
            assert!(result.agrees(), "{name} {light}: {:?} {:?}", result.judges, result.disagreements);
            assert_eq!(total.points, points as u64);
            sum = sum.plus(&total);
        }
        judged += 1;
    }
    eprintln!("{judged} meshes: {sum:?}, rate of disagreement below {:?}", sum.bound_95());
    assert_eq!(judged, 29);
}
