//! Every technique against the truth: a false claim fails here.

use umbrage::caster::{Caster, CasterGroup};
use umbrage::geom::{Facing, Light};
use umbrage::mesh::Mesh;
use umbrage::oracle::Verdict;
use umbrage::scene::Lamp;
use umbrage::shadow::{Claim, Request, Samples, Technique, Visibility};
use umbrage::testing::shapes;
use umbrage::verify::errors::{Errors, Fraction, Made, Truth};
use umbrage::view::{Camera, Size, Up};

/// Named casters: sound, inside out, open, not orientable, nested, self-intersecting, and several at once.
fn scenes() -> Vec<(&'static str, Vec<Caster>)> {
    let one = |name, mesh: Mesh| (name, vec![Caster::new(mesh)]);
    let ground = shapes::translated(&shapes::scaled(&shapes::cube(), 9.0), [0.0, -6.5, 0.0]);
    let lifted = |mesh: &Mesh| shapes::translated(mesh, [0.4, 1.2, -0.3]);
    vec![
        one("torus", shapes::torus(24, 12, 2.0, 0.7)),
        one("inside out", shapes::inside_out(&shapes::icosphere(2))),
        one("open cube", shapes::open_cube()),
        one("Möbius strip", shapes::mobius(24)),
        one("nested cubes", shapes::nested_cubes(3)),
        one("figure eight", shapes::figure_eight_prism()),
        (
            "several",
            vec![
                Caster::new(ground),
                Caster::new(lifted(&shapes::torus_knot(2, 3, 60, 8, 0.4))),
                Caster::new(lifted(&shapes::sheet(3))),
            ],
        ),
    ]
}

fn lamps() -> [Lamp; 3] {
    ["point:3,9,5", "directional:0.3,-1,0.2", "point:0.1,0.2,0.05"].map(|lamp| lamp.parse().unwrap())
}

/// Every technique with its default options, but for small maps.
fn small() -> impl Iterator<Item = Technique> {
    Technique::ALL.into_iter().map(|technique| {
        let has_size = technique.parameters().iter().any(|(key, _)| *key == "size");
        // The volume of a map's surface has two faces for each texel.
        let size = if matches!(technique, Technique::Reconstruct(_)) { 16 } else { 64 };
        if has_size { format!("{}:size={size}", technique.name()).parse().unwrap() } else { technique }
    })
}

/// Runs `work` on every scene, light and view: from afar, and from within, where z-pass is wrong.
fn for_each_request(mut work: impl FnMut(&str, &Request<'_>)) {
    let size = Size::new(40, 30).unwrap();
    for (name, scene) in scenes() {
        let casters = CasterGroup::new(scene.iter().collect());
        let bounds = casters.bounds();
        let within = Camera::look_at([0.3, -0.4, 0.2], [1.0, 0.1, 0.4], 1.2, Up::Y).unwrap();
        for camera in [Camera::fit(&bounds, Up::Y, size.aspect()), within] {
            let projection = camera.projection(size, camera.near(scene.iter().map(Caster::mesh), size));
            let samples = Samples::of_view(&casters, &projection, size, 1).unwrap();
            for lamp in &lamps() {
                work(name, &Request { casters: &casters, lamp, samples: &samples });
            }
        }
    }
}

#[test]
fn technique_claims_hold_on_every_scene() {
    let (mut judged, mut zpass_wrong) = (0, 0);
    for_each_request(|name, request| {
        let truth = Truth::of(request);
        for technique in small() {
            let visibility = technique.shade(request).unwrap();
            let errors = Errors::of(request, &visibility, &truth, &Made::default());
            assert!(errors.hold(visibility.claim()), "{name} {technique} {}: {errors:?}", request.light());
            judged += errors.judged;
            if technique == Technique::ZPass {
                zpass_wrong += errors.wrong;
            }
        }
    });
    assert!(judged > 50_000, "{judged}");
    // The views include those where z-pass, which claims nothing, is wrong.
    assert!(zpass_wrong > 100, "{zpass_wrong}");
}

/// The analytic fraction and the mean of exact rays share nothing but predicates: near to each other, and the
/// nearer the more rays there are. Sabotage: a truth about the lamp's center alone is far from both.
#[test]
fn technique_of_many_rays_comes_near_to_the_analytic_fraction() {
    let size = Size::new(24, 18).unwrap();
    for (name, scene) in scenes() {
        let casters = CasterGroup::new(scene.iter().collect());
        let camera = Camera::fit(&casters.bounds(), Up::Y, size.aspect());
        let projection = camera.projection(size, camera.near(scene.iter().map(Caster::mesh), size));
        let samples = Samples::of_view(&casters, &projection, size, 1).unwrap();
        for lamp in ["point:3,9,5,radius=2", "directional:0.3,-1,0.2,angle=12", "rect:-2,9,2:3,0,0:0,1,3"] {
            let lamp: Lamp = lamp.parse().unwrap();
            let request = Request { casters: &casters, lamp: &lamp, samples: &samples };
            let truth = Truth::of(&request);
            assert!(truth.bound().unwrap() < 1e-9, "{name} {lamp}: {:?}", truth.bound());
            let mean = |technique: &str, truth: &Truth| {
                let technique: Technique = technique.parse().unwrap();
                let visibility = technique.shade(&request).unwrap();
                let made = Made { is_soft: technique.is_soft(), ..Made::default() };
                Errors::of(&request, &visibility, truth, &made).mean
            };
            let [few, many] = ["samples:n=16", "samples:n=512"].map(|technique| mean(technique, &truth));
            assert!(many <= 0.003 && (many < 0.5 * few || few < 1e-6), "{name} {lamp}: {few} {many}");
            // Fault injected: the truth about the lamp's center alone.
            let center = (*lamp.light()).into();
            let hard = Truth::of(&Request { lamp: &center, ..request });
            let off = hard.verdicts().iter().map(|verdict| Fraction {
                visible: f64::from(u8::from(*verdict == Some(Verdict::Lit))),
                bound: 0.0,
            });
            let hard = truth.with_fractions(off.collect());
            let soft = mean("samples:n=512", &hard);
            assert!(soft > 3.0 * many || soft < 1e-6, "{name} {lamp}: {soft} {many}");
        }
    }
}

#[test]
fn technique_claims_that_are_false_are_seen() {
    let mut seen = [0; 3];
    for_each_request(|_, request| {
        let truth = Truth::of(request);
        let holds = |visibility: &Visibility, claim| {
            Errors::of(request, visibility, &truth, &Made::default()).hold(claim)
        };
        // False claim: z-pass everywhere, claimed exact.
        let zpass = Technique::ZPass.shade(request).unwrap();
        seen[0] += usize::from(!holds(&zpass, Claim::Exact));
        // False claim: no shadows, claimed to be wrong at one sample in a thousand at most.
        let none = Technique::None.shade(request).unwrap();
        seen[1] += usize::from(!holds(&none, Claim::Bounded(0.001)));
        // Fault injected: one sample of the rays is flipped.
        let rays = Technique::Rays.shade(request).unwrap();
        let judged = truth.verdicts().iter().position(|verdict| *verdict == Some(Verdict::Lit));
        if let Some(at) = judged {
            let mut values = rays.values().to_vec();
            values[at] = 0.0;
            let turned = Visibility::from_values(request.samples, request.light(), values, Claim::Exact);
            assert!(!holds(&turned, Claim::Exact) && !holds(&turned, Claim::WithinFootprint));
            seen[2] += 1;
        }
    });
    assert!(seen.iter().all(|&count| count > 5), "{seen:?}");
}

/// Reference: every sample separately, against all faces one by one.
#[test]
fn technique_rays_equal_the_loop_over_all_faces() {
    for_each_request(|name, request| {
        let rays = Technique::Rays.shade(request).unwrap();
        for (index, hit) in request.samples.hits().iter().enumerate() {
            let Some(hit) = hit else {
                assert_eq!((rays.values()[index], rays.asked()[index]), (0.0, false));
                continue;
            };
            let side = umbrage::geom::predicate::side_of_light(hit.corners, request.light());
            let front_lit = side == hit.side;
            let crossed = || {
                request.casters.casters().iter().any(|caster| {
                    let mut faces = caster.topology().faces();
                    faces.any(|face| {
                        let corners = caster.mesh().corners(face);
                        let met = umbrage::oracle::intersect(hit.point, request.light(), corners);
                        matches!(met, umbrage::oracle::Intersection::Crossing(Facing::Front | Facing::Back))
                    })
                })
            };
            // Every seventh sample: the loop is slow.
            if index % 7 == 0 {
                let lit = front_lit && !crossed();
                assert_eq!(rays.values()[index], f32::from(u8::from(lit)), "{name} {index}");
            }
            assert_eq!(rays.asked()[index], front_lit);
        }
    });
}

#[test]
fn oracle_over_several_meshes_equals_that_of_all_in_one() {
    let meshes = [shapes::cube(), Mesh::default(), shapes::torus(12, 9, 2.0, 0.75), shapes::sheet(2)];
    let over = umbrage::oracle::Oracle::over(&meshes.each_ref());
    let one = umbrage::oracle::Oracle::build(&Mesh::concat(&meshes).unwrap());
    let light = Light::point([3.0, 5.0, 4.0]).unwrap();
    for i in 0..400_u16 {
        let p = [7, 11, 13].map(|k| f32::from(i * k % 97) / 16.0 - 3.0);
        assert_eq!(over.crossings(p, &light), one.crossings(p, &light), "{p:?}");
        let hit = over.first_hit(p, [0.3, -0.2, -1.0]);
        assert_eq!(hit, one.first_hit(p, [0.3, -0.2, -1.0]));
        if let Some(hit) = hit {
            let (mesh, face) = over.mesh_face(hit.face);
            let offset: usize = meshes[..mesh].iter().map(Mesh::face_count).sum();
            assert_eq!(offset + face.index(), hit.face.index());
            assert!(face.index() < meshes[mesh].face_count());
        }
    }
}

/// Soft techniques under lamps with extent, against the analytic fraction.
#[test]
fn technique_area_is_the_fraction_within_its_bound_and_many_rays_come_close() {
    let lamps: [Lamp; 3] =
        ["point:3,9,5,radius=1.5", "directional:0.3,-1,0.2,angle=8", "rect:2,9,4:3,0,0:0,1,3"]
            .map(|lamp| lamp.parse().unwrap());
    let size = Size::new(40, 30).unwrap();
    let (mut off, mut in_penumbra) = ([0; 2], 0);
    for (name, scene) in scenes() {
        let casters = CasterGroup::new(scene.iter().collect());
        let camera = Camera::fit(&casters.bounds(), Up::Y, size.aspect());
        let projection = camera.projection(size, camera.near(scene.iter().map(Caster::mesh), size));
        let samples = Samples::of_view(&casters, &projection, size, 1).unwrap();
        for lamp in &lamps {
            let request = Request { casters: &casters, lamp, samples: &samples };
            let truth = Truth::of(&request);
            let made = Made { is_soft: true, ..Made::default() };
            let errors = |technique: &str| {
                let visibility = technique.parse::<Technique>().unwrap().shade(&request).unwrap();
                (Errors::of(&request, &visibility, &truth, &made), visibility.claim())
            };
            let (area, claim) = errors("area");
            assert!(claim == Claim::Exact && area.hold(claim), "{name} {lamp}: {area:?}");
            // Rays share no code with the fraction.
            let (many, _) = errors("samples:n=256");
            assert!(many.mean < 0.004 && many.max < 0.06, "{name} {lamp}: {many:?}");
            in_penumbra += usize::from(many.penumbra_mean.is_some());
            // False claims: the center alone, and few rays.
            for (count, technique) in off.iter_mut().zip(["rays", "samples:n=4"]) {
                *count += usize::from(!errors(technique).0.hold(Claim::Exact));
            }
        }
    }
    assert!(in_penumbra > 12 && off.iter().all(|&count| count > 12), "{in_penumbra} {off:?}");
}
