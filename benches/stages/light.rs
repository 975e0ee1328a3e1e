//! Silhouettes of many lights on one mesh: arbitrary lights, and a moving light.

use umbrage::caster::Caster;
use umbrage::facing::{CasterFaces, FacePlanes, classify};
use umbrage::geom::{Aabb, Facing, Light};
use umbrage::mesh::Mesh;
use umbrage::silhouette::{KineticSilhouette, Silhouette, SilhouetteFinder, SilhouetteTree};
use umbrage::testing::shapes;
use umbrage::topology::Topology;

use crate::measure::{Bench, Contender, Group, Scatter, Target, timed};

pub(crate) fn run(bench: &mut Bench<'_>) {
    if bench.wants("silhouette of any light") {
        any_light(bench, &crate::head(bench.quick), 1.0 / 3.0);
        any_light(bench, &crate::ordered(bench.quick), 0.1);
        any_light(bench, &crate::tied(bench.quick), 1.05);
    }
    if bench.wants("silhouette of a moving light") {
        let n = if bench.quick { 40 } else { 224 };
        moving_light(bench, &shapes::torus(n, n, 2.0, 0.75).with_name(format!("torus {n}")), 5_000.0);
        moving_light(bench, &crate::head(bench.quick), 15_000.0);
    }
    if bench.wants("silhouette finder") {
        let sizes: &[u32] = if bench.quick { &[10] } else { &[22, 70, 224, 707] };
        for &n in sizes {
            choice(bench, &shapes::torus(n, n, 2.0, 0.75).with_name(format!("torus {n}")));
        }
        for level in if bench.quick { 2..3 } else { 4..7 } {
            choice(bench, &shapes::icosphere(level).with_name(format!("icosphere {level}")));
        }
        choice(bench, &crate::head(bench.quick));
        choice(bench, &crate::tied(bench.quick));
    }
}

/// The linear scan: facing and edges, both buffers kept.
struct Scan {
    planes: FacePlanes,
    facing: Vec<Facing>,
    signs: Vec<i8>,
}

impl Scan {
    fn new(mesh: &Mesh) -> Self {
        Self { planes: FacePlanes::new(mesh), facing: Vec::new(), signs: Vec::new() }
    }

    fn silhouette(&mut self, mesh: &Mesh, topology: &Topology, light: &Light) -> Silhouette {
        self.planes.classify_into(mesh, light, &mut self.facing);
        CasterFaces::All.signs_into(&self.facing, &mut self.signs);
        Silhouette::extract(topology, &self.signs)
    }
}

/// A point light at a position given in units of the diagonal, relative to the mesh's center.
fn place(mesh: &Mesh, at: [f32; 3]) -> Light {
    let [low, high] = mesh.bounds().expect("it has faces");
    let bounds = Aabb { low, high };
    let (center, diagonal) = (bounds.center(), bounds.diagonal() as f32);
    Light::point([0, 1, 2].map(|i| center[i] + diagonal * at[i])).expect("finite")
}

/// Point lights near, far and inside, and directional lights, two of them along axes.
fn lights(mesh: &Mesh) -> [Light; 8] {
    let directional = |travel| Light::directional(travel).expect("not zero");
    [
        place(mesh, [0.5, 0.8, 0.3]),
        place(mesh, [-0.7, 0.4, 0.6]),
        place(mesh, [0.2, -2.0, 1.0]),
        place(mesh, [30.0, 20.0, -10.0]),
        place(mesh, [0.02, 0.05, -0.03]),
        directional([1.0, 0.3, -0.2]),
        directional([0.0, -1.0, 0.0]),
        directional([0.0, 0.0, -1.0]),
    ]
}

fn any_light(bench: &mut Bench<'_>, mesh: &Mesh, target: f64) {
    let topology = Topology::of(mesh);
    let lights = lights(mesh);
    let expected: Vec<Silhouette> = lights
        .iter()
        .map(|light| Silhouette::extract(&topology, &CasterFaces::All.signs(&classify(mesh, light))))
        .collect();
    let right = |found: &Vec<Silhouette>| {
        assert!(*found == expected, "another silhouette");
        format!("edges={}", found.iter().map(|silhouette| silhouette.edges.len()).sum::<usize>())
    };
    let mut scan = Scan::new(mesh);
    let mut tree = SilhouetteTree::new(mesh, &topology);
    let contenders = vec![
        Contender::new("facing and scan", || {
            timed(|| lights.iter().map(|light| scan.silhouette(mesh, &topology, light)).collect(), right)
        }),
        Contender::new("SilhouetteTree::silhouette", || {
            let mut find = |light: &Light| tree.silhouette(mesh, &topology, light, CasterFaces::All);
            timed(|| lights.iter().map(&mut find).collect(), right)
        })
        .aims_at(Target::Ratio(target)),
    ];
    let (stage, name) = ("silhouette of any light", mesh.name.clone());
    let units = mesh.face_count() * lights.len();
    bench.run(Group { stage, mesh: name.clone(), units, unit: "triangle and light", contenders });
    let contenders = vec![
        Contender::new("FacePlanes::new", || timed(|| FacePlanes::new(mesh), |_| String::new())),
        Contender::new("SilhouetteTree::new", || {
            timed(|| SilhouetteTree::new(mesh, &topology), |tree| format!("idle={}", tree.is_idle()))
        }),
    ];
    bench.run(Group { stage, mesh: name, units: mesh.face_count(), unit: "triangle", contenders });
}

/// A light that moves forth and back in steps of a ten-thousandth of the diagonal.
fn moving_light(bench: &mut Bench<'_>, mesh: &Mesh, target: f64) {
    const STEPS: usize = 32;
    let topology = Topology::of(mesh);
    let at = |i: usize| {
        let way = 1e-4 * i as f32;
        place(mesh, [0.5 + 0.6 * way, 0.8 - 0.64 * way, 0.3 + 0.48 * way])
    };
    let walk: Vec<Light> = (1..=STEPS).chain((0..STEPS).rev()).map(at).collect();
    let last = Silhouette::extract(&topology, &CasterFaces::All.signs(&classify(mesh, &at(0))));
    let right = |(count, found): &(usize, Silhouette)| {
        assert!(*found == last, "another silhouette");
        format!("edges={count}")
    };
    let mut scan = Scan::new(mesh);
    let mut searched = SilhouetteTree::new(mesh, &topology);
    let mut tree = searched.clone();
    let mut moving = KineticSilhouette::new(mesh, &topology, &mut tree, &at(0), CasterFaces::All);
    let caster = Caster::new(mesh.clone());
    let mut finder = SilhouetteFinder::new(&caster, usize::MAX);
    let count = |silhouette: Silhouette, (sum, _)| (sum + silhouette.edges.len(), silhouette);
    let start = || (0, Silhouette::default());
    let contenders = vec![
        Contender::new("facing and scan", || {
            let mut find = |sum, light| count(scan.silhouette(mesh, &topology, light), sum);
            timed(|| walk.iter().fold(start(), &mut find), right)
        }),
        Contender::new("SilhouetteTree::silhouette", || {
            let mut find =
                |sum, light| count(searched.silhouette(mesh, &topology, light, CasterFaces::All), sum);
            timed(|| walk.iter().fold(start(), &mut find), right)
        }),
        Contender::new("KineticSilhouette::step", || {
            let mut sum = 0;
            let work = || {
                for light in &walk {
                    moving.step(mesh, &topology, &mut tree, light, CasterFaces::All);
                    sum += moving.len();
                }
                sum
            };
            let sample = timed(work, |sum| format!("edges={sum}"));
            assert!(moving.silhouette() == last, "another silhouette");
            sample
        })
        .aims_at(Target::Time(target)),
        Contender::new("SilhouetteFinder::find", || {
            let work = || {
                for light in &walk {
                    finder.find(&caster, light, CasterFaces::All);
                }
            };
            let sample = timed(work, |()| String::new());
            assert!(finder.edges().eq(last.edges.iter().copied()), "another silhouette");
            sample
        }),
    ];
    let (stage, mesh) = ("silhouette of a moving light", mesh.name.clone());
    bench.run(Group { stage, mesh, units: walk.len(), unit: "step", contenders });
}

/// The finder's choice for lights that rest, move slowly, move fast or jump, compared with the best of the
/// three methods. Trees and certificates run twice, each time with their own copies: the difference between
/// the two runs is due to memory layout, not to the method.
fn choice(bench: &mut Bench<'_>, mesh: &Mesh) {
    const STEPS: u8 = 16;
    let topology = Topology::of(mesh);
    let tree = SilhouetteTree::new(mesh, &topology);
    let caster = Caster::new(mesh.clone());
    let mut scatter = Scatter(1);
    for (how, step) in [("rests", 0.0), ("1e-4", 1e-4), ("1e-2", 1e-2), ("anywhere", f32::INFINITY)] {
        let mut at = |i: u8| {
            let way = step * f32::from(i);
            let to = [0.5 + 0.6 * way, 0.8 - 0.64 * way, 0.3 + 0.48 * way];
            place(mesh, if step.is_finite() { to } else { scatter.point(2.0) })
        };
        let there: Vec<Light> = (0..=STEPS).map(&mut at).collect();
        let walk: Vec<Light> =
            there[1..].iter().chain(there[..usize::from(STEPS)].iter().rev()).copied().collect();
        let expected: Vec<usize> = walk
            .iter()
            .map(|light| {
                Silhouette::extract(&topology, &CasterFaces::All.signs(&classify(mesh, light))).edges.len()
            })
            .collect();
        let right = |found: &Vec<usize>| {
            assert!(*found == expected, "another silhouette");
            format!("edges={}", found.iter().sum::<usize>())
        };
        let mut scan = Scan::new(mesh);
        let [mut searched, mut searched_too] = [(); 2].map(|()| tree.clone());
        let [mut followed, mut followed_too] = [(); 2].map(|()| {
            let mut tree = tree.clone();
            let moving = KineticSilhouette::new(mesh, &topology, &mut tree, &there[0], CasterFaces::All);
            (tree, moving)
        });
        let mut finder = SilhouetteFinder::new(&caster, usize::MAX);
        // The structures for a moving light are built here, before timing, as those of the other methods are.
        for light in &there[..2] {
            finder.find(&caster, light, CasterFaces::All);
        }
        let search = |tree: &mut SilhouetteTree| {
            let mut find = |light| tree.silhouette(mesh, &topology, light, CasterFaces::All).edges.len();
            timed(|| walk.iter().map(&mut find).collect(), right)
        };
        let follow = |(tree, moving): &mut (SilhouetteTree, KineticSilhouette)| {
            let mut find = |light| {
                moving.step(mesh, &topology, tree, light, CasterFaces::All);
                moving.len()
            };
            timed(|| walk.iter().map(&mut find).collect(), right)
        };
        let contenders = vec![
            Contender::new("facing and scan", || {
                let mut find = |light| scan.silhouette(mesh, &topology, light).edges.len();
                timed(|| walk.iter().map(&mut find).collect(), right)
            }),
            Contender::new("SilhouetteTree::silhouette", || search(&mut searched)),
            Contender::new("SilhouetteTree::silhouette, again", || search(&mut searched_too))
                .repeats("SilhouetteTree::silhouette"),
            Contender::new("KineticSilhouette::step", || follow(&mut followed)),
            Contender::new("KineticSilhouette::step, again", || follow(&mut followed_too))
                .repeats("KineticSilhouette::step"),
            Contender::new("SilhouetteFinder::find", || {
                let mut find = |light| {
                    finder.find(&caster, light, CasterFaces::All);
                    finder.edge_count()
                };
                timed(|| walk.iter().map(&mut find).collect(), right)
            })
            .aims_at(Target::Best(1.1)),
        ];
        let (stage, mesh) = ("silhouette finder", format!("{} · {how}", mesh.name));
        bench.run(Group { stage, mesh, units: walk.len(), unit: "light", contenders });
    }
}
