//! The exact weld of a triangle soup.

use std::collections::HashMap;

use umbrage::mesh::{Mesh, Weld, weld, weld_in_place};
use umbrage::testing::shapes;

use crate::measure::{Bench, Contender, Group, Target, timed};

pub(crate) fn run(bench: &mut Bench<'_>) {
    if !bench.wants("weld") {
        return;
    }
    for (mesh, target) in [(crate::ordered(bench.quick), 18.0), (crate::scattered(bench.quick), 60.0)] {
        let (vertices, soup) = (mesh.vertex_count(), shapes::soup(&mesh));
        let name = format!("soup of {}", mesh.name);
        drop(mesh);
        let expected = answer(&hash_map(&soup).1, vertices);
        let contenders = vec![
            Contender::new("std hash map of positions", || {
                timed(|| hash_map(&soup), |(positions, triangles)| answer(triangles, positions.len()))
            })
            .expects(&*expected),
            Contender::new("weld(Exact)", || {
                timed(|| weld(&soup, Weld::Exact), |w| answer(w.mesh.triangles(), w.mesh.vertex_count()))
            })
            .expects(&*expected)
            // Reads three positions of 12 and three indices of 4. Writes three indices, which also map old to
            // new vertices, and half a position.
            .moves(36.0 + 12.0 + 12.0 + 6.0)
            .aims_at(Target::Time(target)),
            Contender::new("weld_in_place(Exact)", || {
                let soup = soup.clone();
                timed(
                    || weld_in_place(soup, Weld::Exact),
                    |w| answer(w.mesh.triangles(), w.mesh.vertex_count()),
                )
            })
            .expects(&*expected)
            .moves(36.0 + 12.0 + 12.0 + 6.0)
            .aims_at(Target::Time(target)),
        ];
        let units = soup.face_count();
        bench.run(Group { stage: "weld", mesh: name, units, unit: "triangle", contenders });
    }
}

/// The same order of vertices as the crate's weld, by a hash map.
fn hash_map(soup: &Mesh) -> (Vec<[f32; 3]>, Vec<[u32; 3]>) {
    let mut ids: HashMap<[u32; 3], u32> = HashMap::new();
    let mut positions = Vec::new();
    let mut id = |vertex: u32| {
        let position = soup.positions()[vertex as usize];
        *ids.entry(position.map(f32::to_bits)).or_insert_with(|| {
            positions.push(position);
            positions.len() as u32 - 1
        })
    };
    let triangles = soup.triangles().iter().map(|corners| corners.map(&mut id)).collect();
    (positions, triangles)
}

/// Number of vertices, and a hash of all indices in order (FNV-1a by words).
fn answer(triangles: &[[u32; 3]], vertices: usize) -> String {
    let mix = |hash: u64, &index: &u32| (hash ^ u64::from(index)).wrapping_mul(0x0100_0000_01b3);
    let sum = triangles.as_flattened().iter().fold(0xcbf2_9ce4_8422_2325, mix);
    format!("vertices={vertices} indices={sum:016x}")
}
