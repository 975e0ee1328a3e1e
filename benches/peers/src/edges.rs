//! Which faces meet at an edge.

use std::collections::HashMap;

use meshopt::VertexDataAdapter;
use parry3d::math::Vector;
use parry3d::shape::{TriMesh, TriMeshFlags};
use umbrage::mesh::{HalfEdgeId, Mesh, Weld, weld};
use umbrage::testing::shapes;
use umbrage::topology::Topology;

use crate::Subject;
use crate::measure::{Bench, Contender, Group, timed};

/// No twin, as parry marks it.
const NONE: u32 = u32::MAX;

pub(crate) fn run(bench: &mut Bench<'_>, subject: &Subject) {
    if bench.wants("edge table") {
        edge_table(bench, subject);
    }
    if bench.wants("edges of a soup") {
        soup(bench, &subject.mesh);
    }
    if bench.wants("shells") {
        shells(bench, &subject.mesh);
    }
}

fn edge_table(bench: &mut Bench<'_>, subject: &Subject) {
    let mesh = &subject.mesh;
    let (indices, built) = (mesh.triangles().as_flattened(), build(mesh));
    let (right_twins, right_patches) = (twins(&built), patches(&built));
    let manifold = is_manifold(&built);
    drop(built);
    // Where an edge has more than two faces, or two that run the same way, each crate chooses in its own manner.
    let of_twins = |found: &[u32]| {
        assert!(!manifold || found == right_twins, "other twins");
        paired(found.iter().filter(|&&twin| twin != NONE).count())
    };
    let of_patches = |found: &[u32]| {
        assert!(!manifold || found == right_patches, "other neighbors");
        paired(found.chunks_exact(2).filter(|pair| pair[0] != pair[1]).count())
    };
    let expected = of_twins(&right_twins);
    let theirs = parry(mesh);
    let mut contenders = vec![
        Contender::new("meshopt adjacency", || {
            let vertices = vertices(mesh);
            timed(|| meshopt::generate_adjacency_indices(indices, &vertices), |found| of_patches(found))
        }),
        Contender::new("parry3d half-edges", || {
            let mut mesh = theirs.clone();
            let work = || {
                let done = mesh.set_flags(TriMeshFlags::HALF_EDGE_TOPOLOGY);
                (done, mesh)
            };
            timed(work, |(done, mesh)| match (done, mesh.topology()) {
                (Ok(()), Some(topology)) => {
                    of_twins(&topology.half_edges.iter().map(|half_edge| half_edge.twin).collect::<Vec<_>>())
                }
                _ => "refused".to_owned(),
            })
        }),
        Contender::new("std hash map, twins", || {
            let work = || {
                let map: HashMap<[u32; 2], u32> = half_edges(mesh).collect();
                twins_by(mesh, |edge| map.get(&edge))
            };
            timed(work, |found| of_twins(found))
        }),
        Contender::new("hashbrown map, twins", || {
            let work = || {
                let map: hashbrown::HashMap<[u32; 2], u32> = half_edges(mesh).collect();
                twins_by(mesh, |edge| map.get(&edge))
            };
            timed(work, |found| of_twins(found))
        }),
        Contender::new("Topology::build", || {
            let triangles = mesh.triangles().to_vec();
            let work = || Topology::build(mesh.vertex_count(), triangles);
            timed(work, |t| paired(3 * t.face_count() - unpaired(t)))
        })
        .aims_at(subject.edges),
        Contender::new("Topology::build, twins", || {
            let triangles = mesh.triangles().to_vec();
            timed(|| twins(&Topology::build(mesh.vertex_count(), triangles)), |found| of_twins(found))
        }),
        Contender::new("Topology::build, adjacency", || {
            let triangles = mesh.triangles().to_vec();
            timed(|| patches(&Topology::build(mesh.vertex_count(), triangles)), |found| of_patches(found))
        }),
    ];
    if manifold {
        contenders = contenders.into_iter().map(|contender| contender.expects(&*expected)).collect();
    }
    let (name, units) = (mesh.name.clone(), mesh.face_count());
    bench.run(Group { stage: "edge table", mesh: name, units, unit: "triangle", contenders });
}

/// The same from triangles that share no vertex: positions are to be compared first.
fn soup(bench: &mut Bench<'_>, mesh: &Mesh) {
    let topology = build(mesh);
    let expected = paired(3 * topology.face_count() - unpaired(&topology));
    let manifold = is_manifold(&topology);
    drop(topology);
    let soup = shapes::soup(mesh);
    let theirs = parry(&soup);
    let mut contenders = vec![
        Contender::new("meshopt adjacency", || {
            let (indices, vertices) = (soup.triangles().as_flattened(), vertices(&soup));
            let work = || meshopt::generate_adjacency_indices(indices, &vertices);
            timed(work, |found| paired(found.chunks_exact(2).filter(|pair| pair[0] != pair[1]).count()))
        }),
        Contender::new("parry3d merged, half-edges", || {
            let mut mesh = theirs.clone();
            let flags = TriMeshFlags::MERGE_DUPLICATE_VERTICES | TriMeshFlags::HALF_EDGE_TOPOLOGY;
            let work = || {
                let done = mesh.set_flags(flags);
                (done, mesh)
            };
            timed(work, |(done, mesh)| match (done, mesh.topology()) {
                (Ok(()), Some(topology)) => {
                    paired(topology.half_edges.iter().filter(|half_edge| half_edge.twin != NONE).count())
                }
                _ => "refused".to_owned(),
            })
        }),
        Contender::new("weld(Exact), Topology::build", || {
            let work = || {
                let (_, triangles, ..) = weld(&soup, Weld::Exact).mesh.into_parts();
                Topology::build(mesh.vertex_count(), triangles)
            };
            timed(work, |t| paired(3 * t.face_count() - unpaired(t)))
        }),
    ];
    if manifold {
        contenders = contenders.into_iter().map(|contender| contender.expects(&*expected)).collect();
    }
    let (name, units) = (format!("soup of {}", mesh.name), mesh.face_count());
    bench.run(Group { stage: "edges of a soup", mesh: name, units, unit: "triangle", contenders });
}

/// Connected pieces. parry joins faces at a vertex, umbrage across an edge: the same of a manifold.
fn shells(bench: &mut Bench<'_>, mesh: &Mesh) {
    let topology = build(mesh);
    let expected = format!("shells={}", topology.shells().count);
    let manifold = is_manifold(&topology);
    let theirs = parry(mesh);
    let mut contenders = vec![
        Contender::new("parry3d connected components", || {
            let mut mesh = theirs.clone();
            let work = || {
                let _ = mesh.set_flags(TriMeshFlags::CONNECTED_COMPONENTS); // only of half-edges it fails
                mesh
            };
            timed(work, |mesh| {
                let components = mesh.connected_components().expect("they were asked for");
                format!("shells={}", components.num_connected_components())
            })
        }),
        Contender::new("Topology::build, shells", || {
            let triangles = mesh.triangles().to_vec();
            let work = || Topology::build(mesh.vertex_count(), triangles).shells();
            timed(work, |shells| format!("shells={}", shells.count))
        }),
        Contender::new("shells (table built)", || {
            timed(|| topology.shells(), |shells| format!("shells={}", shells.count))
        }),
    ];
    if manifold {
        contenders = contenders.into_iter().map(|contender| contender.expects(&*expected)).collect();
    }
    let (name, units) = (mesh.name.clone(), mesh.face_count());
    bench.run(Group { stage: "shells", mesh: name, units, unit: "triangle", contenders });
}

fn build(mesh: &Mesh) -> Topology {
    Topology::of(&mesh)
}

/// Where "the face on the other side" has one meaning: at most two faces an edge, in opposite directions.
fn is_manifold(topology: &Topology) -> bool {
    let counts = topology.edge_counts();
    counts.non_manifold == 0 && counts.misoriented == 0 && topology.collapsed_face_count() == 0
}

fn paired(count: usize) -> String {
    format!("paired={count}")
}

/// Half-edges with no face on the other side, or more than one.
fn unpaired(topology: &Topology) -> usize {
    let valences = topology.edges().map(|edge| topology.valence(edge));
    valences.filter(|&valence| valence != 2).sum()
}

/// Both half-edges of each edge with two opposite faces.
fn pairs(topology: &Topology) -> impl Iterator<Item = [HalfEdgeId; 2]> + '_ {
    topology.edges().filter_map(|edge| {
        let mut half_edges = topology.half_edges(edge);
        let two = half_edges.len() == 2 && !topology.is_misoriented(edge);
        let pair = [half_edges.next()?, half_edges.next()?];
        two.then_some(pair)
    })
}

/// For each half-edge the one that runs the other way, read off the table.
fn twins(topology: &Topology) -> Vec<u32> {
    let mut twins = vec![NONE; 3 * topology.face_count()];
    for [a, b] in pairs(topology) {
        twins[a.0 as usize] = b.0;
        twins[b.0 as usize] = a.0;
    }
    twins
}

/// meshopt's adjacency buffer, read off the table: each corner, and the vertex across the edge that begins there.
fn patches(topology: &Topology) -> Vec<u32> {
    let corners = topology.triangles().as_flattened();
    let mut patches: Vec<u32> = corners.iter().flat_map(|&corner| [corner, corner]).collect();
    let across = |half_edge: HalfEdgeId| corners[topology.prev(half_edge).0 as usize];
    for [a, b] in pairs(topology) {
        patches[2 * a.0 as usize + 1] = across(b);
        patches[2 * b.0 as usize + 1] = across(a);
    }
    patches
}

/// Tail, head and number of each half-edge.
fn half_edges(mesh: &Mesh) -> impl Iterator<Item = ([u32; 2], u32)> + '_ {
    mesh.triangles().iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]).zip(0..)
}

fn twins_by<'map>(mesh: &Mesh, find: impl Fn([u32; 2]) -> Option<&'map u32>) -> Vec<u32> {
    half_edges(mesh).map(|([tail, head], _)| find([head, tail]).copied().unwrap_or(NONE)).collect()
}

pub(crate) fn vertices(mesh: &Mesh) -> VertexDataAdapter<'_> {
    let bytes = meshopt::typed_to_bytes(mesh.positions());
    VertexDataAdapter::new(bytes, size_of::<[f32; 3]>(), 0).expect("whole vertices")
}

pub(crate) fn parry(mesh: &Mesh) -> TriMesh {
    let vertices = mesh.positions().iter().map(|&position| Vector::from(position)).collect();
    TriMesh::new(vertices, mesh.triangles().to_vec()).expect("there are faces")
}
