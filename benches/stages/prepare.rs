//! A mesh made ready to cast: the default steps, and holes closed.

use umbrage::mesh::{Mesh, Weld, weld_in_place};
use umbrage::repair::{self, Fill, Options};
use umbrage::testing::shapes;
use umbrage::topology::Topology;

use crate::measure::{Bench, Contender, Group, Target, timed};

const STAGE: &str = "prepare";

pub(crate) fn run(bench: &mut Bench<'_>) {
    if !bench.wants(STAGE) {
        return;
    }
    let mesh = crate::ordered(bench.quick);
    let soup = shapes::soup(&mesh);
    let expected = answer(mesh.vertex_count(), mesh.face_count(), 0);
    for (name, mesh, target) in
        [(mesh.name.clone(), mesh, 40.0), (format!("soup of {}", soup.name), soup, 71.0)]
    {
        let units = mesh.face_count();
        let default = Contender::new("prepare, default steps", || {
            // The mesh is taken whole, as the command takes it.
            let mesh = mesh.clone();
            timed(
                || repair::prepare(mesh, &Options::default()).expect("as many faces").mesh,
                |mesh| answer(mesh.vertex_count(), mesh.face_count(), 0),
            )
        });
        let welded = Contender::new("weld alone", || {
            let mesh = mesh.clone();
            timed(
                || weld_in_place(mesh, Weld::Exact).mesh,
                |mesh| answer(mesh.vertex_count(), mesh.face_count(), 0),
            )
        });
        let contenders =
            vec![welded.expects(&*expected), default.expects(&*expected).aims_at(Target::Time(target))];
        bench.run(Group { stage: STAGE, mesh: name, units, unit: "triangle", contenders });
    }
    let (holed, boundary) = holed(if bench.quick { 4 } else { 6 });
    let closed = Contender::new("fill, least area", || {
        let mesh = holed.clone();
        timed(
            || repair::fill(mesh, Fill::default()).expect("as many faces"),
            |(mesh, step)| answer(step.count, step.left, Topology::of(mesh).edge_counts().boundary),
        )
    });
    let contenders = vec![closed.expects(answer(5, 0, 0))];
    let mesh = format!("{} faces, 5 holes of {boundary} edges", holed.face_count());
    bench.run(Group { stage: STAGE, mesh, units: 1, unit: "mesh", contenders });
}

fn answer(vertices: usize, faces: usize, boundary: usize) -> String {
    format!("{vertices} {faces} {boundary}")
}

/// A bumpy sphere with five holes, and the number of edges around them.
fn holed(subdivisions: u32) -> (Mesh, usize) {
    let sphere = shapes::icosphere(subdivisions);
    let around = |radius: f32, center: [f32; 3]| {
        let length = center.iter().map(|x| x * x).sum::<f32>().sqrt();
        (radius, center.map(|x| x / length))
    };
    let holes = [
        around(0.05, [1.0, 0.2, 0.1]),
        around(0.10, [-1.0, 0.3, 0.2]),
        around(0.10, [0.1, 1.0, -0.3]),
        around(0.10, [0.2, -1.0, 0.4]),
        around(0.20, [0.3, 0.2, 1.0]),
    ];
    let is_cut = |corners: [[f32; 3]; 3]| {
        holes.iter().any(|(radius, center)| {
            let distance = |axis: usize| corners.iter().map(|p| p[axis]).sum::<f32>() / 3.0 - center[axis];
            [0, 1, 2].map(distance).iter().map(|x| x * x).sum::<f32>() < radius * radius
        })
    };
    let positions = sphere.positions().iter();
    let bumpy =
        positions.map(|p| p.map(|x| x * (1.0 + 0.01 * (40.0 * (p[0] + p[1] * p[2])).sin()))).collect();
    let faces =
        (0..sphere.face_count() as u32).filter(|&face| !is_cut(sphere.corners(umbrage::mesh::FaceId(face))));
    let triangles = faces.map(|face| sphere.triangles()[face as usize]).collect();
    let mesh = Mesh::new(bumpy, triangles).expect("corners of the sphere");
    let boundary = Topology::of(&mesh).edge_counts().boundary;
    (mesh, boundary)
}
