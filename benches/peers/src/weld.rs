//! Vertices in the same place joined.

use std::collections::HashMap;

use parry3d::shape::TriMeshFlags;
use umbrage::mesh::{Mesh, Weld, weld};
use umbrage::testing::shapes;

use crate::edges::{parry, vertices};
use crate::measure::{Bench, Contender, Group, timed};

pub(crate) fn run(bench: &mut Bench<'_>, mesh: &Mesh) {
    if !bench.wants("weld") {
        return;
    }
    let soup = shapes::soup(mesh);
    let (right_positions, right_triangles, ..) = weld(&soup, Weld::Exact).mesh.into_parts();
    let right = |positions: &[[f32; 3]], corners: &[u32]| {
        assert!(positions == right_positions && corners == right_triangles.as_flattened(), "another mesh");
        format!("vertices={}", positions.len())
    };
    let theirs = parry(&soup);
    let indices = soup.triangles().as_flattened();
    let contenders = vec![
        Contender::new("meshopt remap, both buffers", || {
            let work = || {
                let (count, remap) = meshopt::generate_vertex_remap(soup.positions(), Some(indices));
                let corners = meshopt::remap_index_buffer(Some(indices), soup.vertex_count(), &remap);
                (meshopt::remap_vertex_buffer(soup.positions(), count, &remap), corners)
            };
            timed(work, |(positions, corners)| right(positions, corners))
        }),
        Contender::new("meshopt position remap alone", || {
            let vertices = vertices(&soup);
            timed(
                || meshopt::generate_position_remap(&vertices),
                |remap| {
                    let own = remap.iter().zip(0..).filter(|&(&first, vertex)| first == vertex).count();
                    format!("vertices={own}")
                },
            )
        }),
        Contender::new("parry3d merge", || {
            let mut mesh = theirs.clone();
            let work = || {
                let _ = mesh.set_flags(TriMeshFlags::MERGE_DUPLICATE_VERTICES); // only of half-edges it fails
                mesh
            };
            timed(work, |mesh| {
                let positions: Vec<[f32; 3]> =
                    mesh.vertices().iter().map(|vertex| vertex.to_array()).collect();
                right(&positions, mesh.indices().as_flattened())
            })
        }),
        Contender::new("std hash map of positions", || {
            let work = || {
                let mut ids: HashMap<[u32; 3], u32> = HashMap::new();
                hash_map(&soup, |key, next| *ids.entry(key).or_insert(next))
            };
            timed(work, |(positions, corners)| right(positions, corners))
        }),
        Contender::new("hashbrown map of positions", || {
            let work = || {
                let mut ids: hashbrown::HashMap<[u32; 3], u32> = hashbrown::HashMap::new();
                hash_map(&soup, |key, next| *ids.entry(key).or_insert(next))
            };
            timed(work, |(positions, corners)| right(positions, corners))
        }),
        Contender::new("weld(Exact)", || {
            timed(
                || weld(&soup, Weld::Exact),
                |welded| right(welded.mesh.positions(), welded.mesh.triangles().as_flattened()),
            )
        }),
    ];
    let expected = format!("vertices={}", right_positions.len());
    let contenders = contenders.into_iter().map(|contender| contender.expects(&*expected)).collect();
    let (name, units) = (format!("soup of {}", mesh.name), soup.face_count());
    bench.run(Group { stage: "weld", mesh: name, units, unit: "triangle", contenders });
}

/// `id` gives the number of a position, which is `next` where it is new.
fn hash_map(soup: &Mesh, mut id: impl FnMut([u32; 3], u32) -> u32) -> (Vec<[f32; 3]>, Vec<u32>) {
    let mut positions = Vec::new();
    let mut corners = Vec::with_capacity(3 * soup.face_count());
    for &vertex in soup.triangles().as_flattened() {
        let position = soup.positions()[vertex as usize];
        let id = id(position.map(f32::to_bits), positions.len() as u32);
        if id as usize == positions.len() {
            positions.push(position);
        }
        corners.push(id);
    }
    (positions, corners)
}
