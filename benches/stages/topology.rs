//! The edge table, the counts derived from it, and the crack report.

use std::collections::HashMap;
use std::time::Instant;

use umbrage::check::CrackReport;
use umbrage::mesh::Mesh;
use umbrage::topology::{Topology, TopologyBuilder};

use crate::measure::{Bench, Contender, Group, Sample, Target, timed};

pub(crate) fn run(bench: &mut Bench<'_>) {
    if !bench.wants("edge table") {
        return;
    }
    for (mesh, euler, targets) in
        [(crate::ordered(bench.quick), 2, [12.0, 22.0]), (crate::scattered(bench.quick), 0, [30.0, 45.0])]
    {
        edge_table(bench, &mesh, euler, targets);
    }
}

/// Benches of the edge table. `targets` are those of the table alone, and of the table with all counts.
fn edge_table(bench: &mut Bench<'_>, mesh: &Mesh, euler: i64, targets: [f64; 2]) {
    let faces = mesh.face_count();
    let table = format!("edges={} boundary=0", 3 * faces / 2);
    let counted = format!("{table} shells=1 loops=0 non_manifold_vertices=0");
    let build = |triangles| Topology::build(mesh.vertex_count(), triangles);
    let topology = Topology::of(mesh);
    let _ = topology.shells(); // surveys the vertices
    let mut builder = TopologyBuilder::new();
    let of_map = |edges: &mut dyn Iterator<Item = u32>| {
        let (all, boundary) = edges.fold((0, 0), |(all, once), n| (all + 1, once + usize::from(n == 1)));
        format!("edges={all} boundary={boundary}")
    };
    let contenders = vec![
        Contender::new("std hash map of vertex pairs", || {
            let work = || {
                let mut faces_of: HashMap<[u32; 2], u32> = HashMap::new();
                for_each_edge(mesh, |edge| *faces_of.entry(edge).or_default() += 1);
                faces_of
            };
            timed(work, |map| of_map(&mut map.values().copied()))
        })
        .expects(&*table),
        Contender::new("hashbrown map with room reserved", || {
            let work = || {
                let mut faces_of: hashbrown::HashMap<[u32; 2], u32> =
                    hashbrown::HashMap::with_capacity(3 * faces / 2);
                for_each_edge(mesh, |edge| *faces_of.entry(edge).or_default() += 1);
                faces_of
            };
            timed(work, |map| of_map(&mut map.values().copied()))
        })
        .expects(&*table),
        Contender::new("counting sort alone", || {
            timed(|| counting_sort(mesh), |sorted| format!("half_edges={}", sorted.len()))
        })
        .expects(format!("half_edges={}", 3 * faces)),
        Contender::new("Topology::build", || {
            let triangles = mesh.triangles().to_vec();
            timed(
                || build(triangles),
                |t| format!("edges={} boundary={}", t.edge_count(), t.edge_counts().boundary),
            )
        })
        .expects(&*table)
        // Reads the corners, 12; writes 1.5 offsets and 3 entries of 4.
        .moves(12.0 + 6.0 + 12.0)
        .aims_at(Target::Time(targets[0])),
        Contender::new("TopologyBuilder::build, memory used again", || {
            let triangles = mesh.triangles().to_vec();
            let start = Instant::now();
            let t = builder.build(mesh.vertex_count(), triangles);
            let elapsed = start.elapsed();
            let answer = format!("edges={} boundary={}", t.edge_count(), t.edge_counts().boundary);
            builder.recycle(t);
            Sample::new(elapsed, answer)
        })
        .expects(&*table)
        .moves(30.0),
        Contender::new("Topology::build + counts", || {
            let triangles = mesh.triangles().to_vec();
            let work = || {
                let t = Topology::build(mesh.vertex_count(), triangles);
                let found =
                    (t.edge_counts(), t.shells().count, t.boundary_loops().len(), t.non_manifold_vertices());
                (t.edge_count(), found)
            };
            timed(work, |(edges, (counts, shells, loops, fans))| {
                let (boundary, fans) = (counts.boundary, fans.len());
                format!("edges={edges} boundary={boundary} shells={shells} loops={loops} non_manifold_vertices={fans}")
            })
        })
        .expects(counted)
        .moves(30.0)
        .aims_at(Target::Time(targets[1])),
        Contender::new("CrackReport::of (table built)", || {
            timed(
                || CrackReport::of(mesh, &topology).counts,
                |counts| format!("euler={} sound={}", counts.euler_characteristic, counts.sound()),
            )
        })
        .expects(format!("euler={euler} sound=true")),
    ];
    let mesh_name = mesh.name.clone();
    bench.run(Group { stage: "edge table", mesh: mesh_name, units: faces, unit: "triangle", contenders });
}

#[inline]
fn for_each_edge(mesh: &Mesh, mut visit: impl FnMut([u32; 2])) {
    for &[a, b, c] in mesh.triangles() {
        for (tail, head) in [(a, b), (b, c), (c, a)] {
            visit([tail.min(head), tail.max(head)]);
        }
    }
}

/// Half-edges sorted by their smaller vertex, without separating edges: the minimum cost of an edge table.
fn counting_sort(mesh: &Mesh) -> Vec<u64> {
    let mut places = vec![0_u32; mesh.vertex_count()];
    for_each_edge(mesh, |[low, _]| places[low as usize] += 1);
    let mut sum = 0;
    for place in &mut places {
        (sum, *place) = (sum + *place, sum);
    }
    let mut sorted = vec![0; sum as usize];
    let mut half_edge = 0;
    for_each_edge(mesh, |[low, high]| {
        let place = &mut places[low as usize];
        sorted[*place as usize] = u64::from(high) << 32 | half_edge;
        *place += 1;
        half_edge += 1;
    });
    sorted
}
