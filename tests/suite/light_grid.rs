//! Techniques of the light grid against exact rays.

use umbrage::caster::{Caster, CasterGroup};
use umbrage::mesh::Mesh;
use umbrage::oracle::Verdict;
use umbrage::scene::Lamp;
use umbrage::shadow::{Claim, Request, Samples, Technique};
use umbrage::testing::shapes;
use umbrage::view::{Camera, Size, Up};

/// Casters on a floor, which casts or only receives.
fn on_floor(solid: Mesh, floor_casts: bool, work: impl Fn(&CasterGroup<'_>)) {
    let floor = shapes::translated(&shapes::scaled(&shapes::sheet(7), 9.0), [-4.5, -4.5, -2.2]);
    if floor_casts {
        let casters = [Caster::new(solid), Caster::new(floor)];
        return work(&CasterGroup::new(casters.iter().collect()));
    }
    // The floor's faces come first where all is seen, and are no casters.
    let seen = Caster::new(Mesh::concat(&[floor, solid.clone()]).unwrap());
    let caster = Caster::new(solid);
    work(&CasterGroup::new(vec![&caster]).seen_with(&seen));
}

fn samples(casters: &CasterGroup<'_>) -> Samples {
    let size = Size::new(80, 60).unwrap();
    let camera = Camera::look_at([5.0, -7.0, 5.0], [0.0, 0.0, -1.0], 0.8, Up::Z).unwrap();
    Samples::of_view(casters, &camera.projection(size, 0.1), size, 1).unwrap()
}

/// Solids, sheets and what is neither.
fn solids() -> [Mesh; 6] {
    [
        shapes::torus(24, 12, 1.5, 0.6),
        shapes::menger_sponge(2),
        shapes::mobius(30),
        shapes::book(5),
        shapes::duplicated_face(),
        Mesh::concat(&[shapes::icosphere(2), shapes::open_cube()]).unwrap(),
    ]
}

/// Suns, a lamp beside the solids, one between them and the floor, and a spot.
const LAMPS: [&str; 5] = [
    "directional:0.4,0.3,-1",
    "directional:-2,0.5,-0.6",
    "point:3,-2,4",
    "point:0.6,0.4,-1.9",
    "spot:2,2,5:-1,-1,-3:40",
];

/// Runs a technique over all scenes: what it says at each judged sample is true. Numbers of front-lit
/// samples, and of those that asked for an exact ray.
fn over_scenes(technique: &str) -> [u64; 2] {
    let technique: Technique = technique.parse().unwrap();
    let counts = std::cell::Cell::new([0; 2]);
    for (solid, floor_casts) in solids().into_iter().flat_map(|solid| [(solid.clone(), true), (solid, false)])
    {
        on_floor(solid, floor_casts, |casters| {
            let samples = samples(casters);
            for lamp in LAMPS {
                let lamp: Lamp = lamp.parse().unwrap();
                let visibility =
                    technique.shade(&Request { casters, lamp: &lamp, samples: &samples }).unwrap();
                assert_eq!(visibility.claim(), Claim::Exact);
                for (index, hit) in samples.hits().iter().enumerate() {
                    let Some(hit) = hit.as_ref().filter(|_| visibility.asked()[index]) else { continue };
                    let expected = match casters.oracle().verdict(hit.point, lamp.light()) {
                        Verdict::Grazing => continue,
                        Verdict::Lit => 1.0,
                        Verdict::Shadowed => 0.0,
                    };
                    assert_eq!(visibility.values()[index], expected, "{technique} {lamp} {hit:?}");
                }
                let [asked, exactly] = counts.get();
                let more = visibility.asked().iter().filter(|asked| **asked).count() as u64;
                counts.set([asked + more, exactly + visibility.asked_exactly()]);
            }
        });
    }
    counts.get()
}

#[test]
fn hybrid_is_exact_and_asks_for_the_fewer_rays_the_smaller_its_cells_are() {
    let [[all, coarse], [_, fine]] = ["hybrid:grid=32", "hybrid"].map(over_scenes);
    assert!(all > 50_000 && coarse * 2 < all && fine * 3 < coarse, "{all} {coarse} {fine}");
}

#[test]
fn alias_free_is_exact_and_needs_no_rays() {
    for technique in ["alias-free:grid=16", "alias-free"] {
        let [all, exactly] = over_scenes(technique);
        assert!(all > 50_000 && exactly == 0, "{all} {exactly}");
    }
}
