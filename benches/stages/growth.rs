//! Growth of each stage's time with the mesh: tori of a thousand to ten million triangles.

use std::cell::OnceCell;

use crate::svg::escaped;
use umbrage::check::CrackReport;
use umbrage::facing::{CasterFaces, FacePlanes, classify};
use umbrage::geom::Light;
use umbrage::mesh::{Mesh, Weld, weld};
use umbrage::oracle::{Oracle, Verdict};
use umbrage::read::read_bytes;
use umbrage::scene::Scope;
use umbrage::shadow::volume::{Caps, ShadowVolume};
use umbrage::silhouette::Silhouette;
use umbrage::testing::shapes;
use umbrage::topology::Topology;

use crate::files::{self, File};
use crate::measure::{Bench, Contender, Group, Scatter, timed};
use crate::plot::{Curve, Panel, begin};
use crate::report;

/// Segments of the tori in each direction: two triangles per quad, a factor of about the square root of ten
/// from one size to the next.
const SEGMENTS: [u32; 9] = [22, 40, 71, 126, 224, 397, 707, 1257, 2236];

/// Name of the baseline that only copies the triangles; not drawn.
const COPY: &str = "copy of the triangles";
/// Name of the row whose unit is a query, not a triangle; not drawn.
const VERDICT: &str = "Oracle::verdict (a query)";

/// The times of one stage on meshes of one order.
struct Line {
    name: &'static str,
    /// Points of the curve: triangles of the mesh, and nanoseconds per unit.
    points: Vec<[f64; 2]>,
}

/// The curves of all stages, on ordered and on shuffled meshes.
pub(crate) struct Growth {
    lines: [Vec<Line>; 2],
}

const ORDERS: [&str; 2] = ["in mesh order", "shuffled"];

pub(crate) fn run(bench: &mut Bench<'_>) -> Option<Growth> {
    if !bench.wants("growth") {
        return None;
    }
    let mut growth = Growth { lines: [Vec::new(), Vec::new()] };
    let sizes = if bench.quick { &SEGMENTS[..3] } else { &SEGMENTS };
    for &n in sizes {
        let mut mesh = shapes::torus(n, n, 2.0, 0.75);
        let right = Right::of(&mesh, if bench.quick { 200 } else { 20_000 });
        for (lines, order) in growth.lines.iter_mut().zip(ORDERS) {
            if order == ORDERS[1] {
                mesh = shapes::shuffled(&mesh, 1);
            }
            let name = format!("torus {n} {order}");
            Case { bench: &mut *bench, lines, mesh: &mesh, name, right: &right }.run();
        }
    }
    let _ = report::print(&growth.table()); // a closed pipe is no error, as for every table
    Some(growth)
}

/// Expected answers that do not depend on the order of the faces, from the predicate and from closed forms.
struct Right {
    table: String,
    front: String,
    silhouette: String,
    volume: String,
    verdicts: OnceCell<String>,
    points: Vec<[f32; 3]>,
}

fn light() -> Light {
    Light::point([3.0, 4.0, 5.0]).expect("finite")
}

impl Right {
    fn of(mesh: &Mesh, queries: usize) -> Self {
        let light = light();
        let topology = Topology::of(mesh);
        let facing = classify(mesh, &light);
        let signs = CasterFaces::All.signs(&facing);
        let silhouette = Silhouette::extract(&topology, &signs);
        // Each casting face appears in both caps. Each silhouette edge sweeps its quad as often as its
        // multiplicity says.
        let cast = signs.iter().filter(|&&sign| sign != 0).count();
        let swept: u32 = silhouette.edges.iter().map(|edge| edge.multiplicity.unsigned_abs()).sum();
        let mut scatter = Scatter(3);
        let points: Vec<[f32; 3]> = (0..queries).map(|_| scatter.point(3.0)).collect();
        Self {
            table: format!("edges={} boundary=0", 3 * mesh.face_count() / 2),
            front: front(&signs),
            silhouette: format!("edges={}", silhouette.edges.len()),
            volume: format!("triangles={}", 2 * cast + 2 * swept as usize),
            verdicts: OnceCell::new(),
            points,
        }
    }
}

fn front(signs: &[i8]) -> String {
    format!("front={}", signs.iter().filter(|&&sign| sign > 0).count())
}

fn shadowed(verdicts: &[Verdict]) -> String {
    let count = |wanted| verdicts.iter().filter(|&&verdict| verdict == wanted).count();
    format!("shadowed={} grazing={}", count(Verdict::Shadowed), count(Verdict::Grazing))
}

/// A mesh under measurement, and the destination of its rows.
struct Case<'a, 'bench> {
    bench: &'a mut Bench<'bench>,
    lines: &'a mut Vec<Line>,
    mesh: &'a Mesh,
    name: String,
    right: &'a Right,
}

impl Case<'_, '_> {
    /// Runs all stages, in groups, so that not all inputs are in memory at once.
    fn run(&mut self) {
        self.shadow();
        self.input();
        self.oracle();
    }

    fn rounds(&self) -> usize {
        match self.mesh.face_count() {
            _ if self.bench.quick => 1,
            ..300_000 => 9,
            300_000..2_000_000 => 5,
            _ => 3,
        }
    }

    fn measure(
        &mut self,
        rounds: usize,
        (units, unit): (usize, &'static str),
        contenders: Vec<Contender<'_>>,
    ) {
        let faces = self.mesh.face_count();
        let group = Group { stage: "growth", mesh: self.name.clone(), units, unit, contenders };
        for row in self.bench.measure(group, rounds) {
            let point = [faces as f64, row.median];
            match self.lines.iter_mut().find(|line| line.name == row.name) {
                // Each group repeats the copy: its first time is kept.
                Some(line) if line.points.last().is_some_and(|last| last[0] == point[0]) => {}
                Some(line) => line.points.push(point),
                None => self.lines.push(Line { name: row.name, points: vec![point] }),
            }
        }
    }

    /// Stages from the triangles to the volume.
    fn shadow(&mut self) {
        let (mesh, right, light) = (self.mesh, self.right, light());
        let vertex_count = mesh.vertex_count();
        let topology = Topology::build(vertex_count, mesh.triangles().to_vec());
        let _ = topology.shells(); // surveys the vertices
        let planes = FacePlanes::new(mesh);
        let signs = CasterFaces::All.signs(&planes.classify(mesh, &light));
        let silhouette = Silhouette::extract(&topology, &signs);
        let mut facing = Vec::new();
        let sound = |report: &CrackReport| {
            assert!(report.counts.sound(), "a torus is sound");
            format!("euler={}", report.counts.euler_characteristic)
        };
        let table = |t: &Topology| format!("edges={} boundary={}", t.edge_count(), t.edge_counts().boundary);
        let contenders = vec![
            copy(mesh),
            Contender::new("Topology::build", || {
                let triangles = mesh.triangles().to_vec();
                timed(|| Topology::build(vertex_count, triangles), table)
            })
            .expects(&*right.table),
            Contender::new("Topology::build, shells, fans", || {
                let triangles = mesh.triangles().to_vec();
                let work = || {
                    let t = Topology::build(vertex_count, triangles);
                    let found = (t.shells().count, t.boundary_loops().len(), t.non_manifold_vertices().len());
                    (t, found)
                };
                timed(work, |(t, found)| {
                    assert!(*found == (1, 0, 0), "shells, loops and forked vertices are {found:?}");
                    table(t)
                })
            })
            .expects(&*right.table),
            Contender::new("CrackReport::of (table built)", || {
                timed(|| CrackReport::of(mesh, &topology), sound)
            })
            .expects("euler=0"),
            Contender::new("FacePlanes::new", || timed(|| FacePlanes::new(mesh), |_| String::new())),
            Contender::new("classify_into (planes made)", || {
                timed(
                    || {
                        planes.classify_into(mesh, &light, &mut facing);
                        &facing
                    },
                    |facing| front(&CasterFaces::All.signs(facing)),
                )
            })
            .expects(&*right.front),
            Contender::new("Silhouette::extract", || {
                timed(
                    || Silhouette::extract(&topology, &signs),
                    |found| format!("edges={}", found.edges.len()),
                )
            })
            .expects(&*right.silhouette),
            Contender::new("ShadowVolume::extrude", || {
                let work = || ShadowVolume::extrude(mesh, &topology, &light, &signs, &silhouette, Caps::Both);
                timed(work, |volume| format!("triangles={}", volume.triangles().len()))
            })
            .expects(&*right.volume),
        ];
        self.measure(self.rounds(), (mesh.face_count(), "triangle"), contenders);
    }

    /// Stages from a file to a welded mesh and to the report.
    fn input(&mut self) {
        let mesh = self.mesh;
        let (obj, glb) = (files::obj(mesh), files::glb(mesh));
        let soup = shapes::soup(mesh);
        let faces = |mesh: &Mesh| format!("vertices={} faces={}", mesh.vertex_count(), mesh.face_count());
        let read = |file: &File| {
            let scene = read_bytes(&file.bytes, file.name).expect("it is well formed");
            scene.bake(Scope::Mesh).expect("it fits").remove(0)
        };
        let contenders = vec![
            copy(mesh),
            Contender::new("read_bytes, OBJ", || timed(|| read(&obj), faces)).expects(faces(mesh)),
            Contender::new("read_bytes, GLB", || timed(|| read(&glb), faces)).expects(faces(mesh)),
            Contender::new("weld(Exact) of a soup", || timed(|| weld(&soup, Weld::Exact).mesh, faces))
                .expects(faces(mesh)),
            Contender::new("check of a GLB, all of it", || {
                let work = || {
                    let mesh = weld(&read(&glb), Weld::Exact).mesh;
                    let topology = Topology::of(&mesh);
                    CrackReport::of(&mesh, &topology).counts
                };
                timed(work, |counts| format!("faces={} sound={}", counts.faces, counts.sound()))
            })
            .expects(format!("faces={} sound=true", mesh.face_count())),
        ];
        self.measure(self.rounds(), (mesh.face_count(), "triangle"), contenders);
    }

    /// Building the tree and querying it. Building takes by far the longest, so it runs a third of the
    /// rounds.
    fn oracle(&mut self) {
        let (mesh, light, right) = (self.mesh, light(), self.right);
        let mut built = None;
        let build = Contender::new("Oracle::build", || {
            built = None;
            timed(|| built = Some(Oracle::build(mesh)), |()| String::new())
        });
        self.measure(self.rounds().div_ceil(3), (mesh.face_count(), "triangle"), vec![build]);
        let oracle = built.expect("it was built");
        // Expected verdicts count every face on the segment, not only the first.
        let expected = right.points.iter().map(|&p| oracle.crossings(p, &light).verdict());
        let expected = shadowed(&expected.collect::<Vec<_>>());
        assert_eq!(
            *right.verdicts.get_or_init(|| expected.clone()),
            expected,
            "another order, other verdicts"
        );
        let verdict = Contender::new(VERDICT, || {
            let work = || right.points.iter().map(|&p| oracle.verdict(p, &light)).collect::<Vec<_>>();
            timed(work, |found| shadowed(found))
        });
        self.measure(self.rounds(), (right.points.len(), "query"), vec![verdict.expects(expected)]);
    }
}

fn copy(mesh: &Mesh) -> Contender<'_> {
    Contender::new(COPY, || timed(|| mesh.triangles().to_vec(), |copy| format!("triangles={}", copy.len())))
}

impl Line {
    /// Exponent of the growth of a stage's total time with the mesh size, by least squares of the logarithms,
    /// over sizes from `least`. For a query: the exponent of the time of one query.
    fn exponent(&self, least: f64) -> f64 {
        let of_units = if self.name == VERDICT { 0.0 } else { 1.0 };
        let kept = self.points.iter().filter(|point| point[0] >= least).map(|point| point.map(f64::ln));
        let count = kept.clone().count() as f64;
        let mean = [0, 1].map(|axis| kept.clone().map(|point| point[axis]).sum::<f64>() / count);
        let product =
            |axis: usize| kept.clone().map(|p| (p[0] - mean[0]) * (p[axis] - mean[axis])).sum::<f64>();
        product(1) / product(0) + of_units
    }
}

impl Growth {
    /// Table of nanoseconds per unit at each size, with the exponents over all sizes and over the last
    /// decade.
    fn table(&self) -> String {
        let mut text = String::new();
        for (lines, order) in self.lines.iter().zip(ORDERS) {
            let sizes: Vec<f64> = lines[0].points.iter().map(|point| point[0]).collect();
            // Consecutive sizes differ by slightly more or less than half a decade.
            let decade = 0.09 * sizes[sizes.len() - 1];
            text += &format!(
                "\ngrowth · torus {order} · ns/triangle; grows as n^(all sizes) n^(last decade)\n  {:<30}",
                ""
            );
            text += &sizes.iter().map(|size| format!(" {size:>8.0}")).collect::<String>();
            text += "     all    last\n";
            for line in lines {
                text += &format!("  {:<30}", line.name);
                text += &line.points.iter().map(|point| format!(" {:>8.2}", point[1])).collect::<String>();
                text += &format!("  n^{:.2}  n^{:.2}\n", line.exponent(0.0), line.exponent(decade));
            }
        }
        text
    }

    /// Chart of nanoseconds per triangle over mesh size, one panel per order.
    pub(crate) fn svg(&self, processor: &str) -> String {
        const LEFT: f64 = 70.0;
        const RIGHT: f64 = 536.0;
        const HEIGHT: f64 = 320.0;
        let mut out = begin([760.0, 960.0], LEFT, "Nanoseconds a triangle against triangles");
        let below = format!("{} · one thread · a flat line grows as the mesh does", escaped(processor));
        out.add(format_args!("<text x=\"{LEFT}\" y=\"48\">{below}</text>"));
        let curves = self.lines.each_ref().map(|lines| {
            let drawn = lines.iter().filter(|line| ![COPY, VERDICT].contains(&line.name));
            let curve = |line: &Line| Curve { name: line.name.to_owned(), points: line.points.clone() };
            drawn.map(curve).collect::<Vec<Curve>>()
        });
        let reach: Vec<f64> = curves.iter().flatten().flat_map(|curve| &curve.points).map(|p| p[1]).collect();
        for ((curves, order), top) in curves.iter().zip(ORDERS).zip([100.0, 540.0]) {
            let title = top - 16.0;
            out.add(format_args!("<text x=\"{LEFT}\" y=\"{title}\" font-weight=\"bold\">{order}</text>"));
            let titles = ["triangles", "nanoseconds a triangle"];
            let frame = [LEFT, RIGHT, top, top + HEIGHT];
            Panel { curves, frame, titles, unit: "ns", reach: &reach }.draw(&mut out);
        }
        out.finish()
    }
}
