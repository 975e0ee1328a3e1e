//! The screen for balance, which builds no structure.

use umbrage::check::Screen;
use umbrage::mesh::Mesh;
use umbrage::testing::shapes;

use crate::measure::{Bench, Contender, Group, Target, timed};

pub(crate) fn run(bench: &mut Bench<'_>) {
    if !bench.wants("screen") {
        return;
    }
    for mesh in [crate::ordered(bench.quick), crate::scattered(bench.quick)] {
        screen(bench, &mesh);
    }
}

fn screen(bench: &mut Bench<'_>, mesh: &Mesh) {
    let soup = shapes::soup(mesh);
    let sum = || mesh.triangles().as_flattened().iter().fold(0_u32, |sum, &index| sum.wrapping_add(index));
    let contenders = vec![
        Contender::new("sum of the indices", || timed(sum, |sum| format!("sum={sum}"))).moves(12.0),
        Contender::new("Screen::indices", || {
            timed(|| Screen::default().indices(mesh.triangles()), |balanced| format!("balanced={balanced}"))
        })
        .expects("balanced=true")
        .moves(12.0)
        .aims_at(Target::Time(0.8)),
        Contender::new("Screen::positions of a soup", || {
            timed(|| Screen::default().positions(&soup), |balanced| format!("balanced={balanced}"))
        })
        .expects("balanced=true")
        .moves(12.0 + 36.0)
        .aims_at(Target::Time(5.0)),
    ];
    let (mesh, units) = (mesh.name.clone(), mesh.face_count());
    bench.run(Group { stage: "screen", mesh, units, unit: "triangle", contenders });
}
