//! Topology and crack report of small meshes against all pairs and big integers.

use umbrage::check::{CrackReport, DefectKind};
use umbrage::mesh::{EdgeId, FaceId, HalfEdgeId, Mesh, VertexId, Weld, Welded, weld};
use umbrage::testing::generate::{Bytes, mesh, position};
use umbrage::topology::Topology;

use super::{naive, whole};

pub(crate) fn run(data: &[u8]) {
    let bytes = &mut Bytes::new(data);
    let mesh = mesh(bytes);
    judge_exact_weld(&mesh, &weld(&mesh, Weld::Exact));
    let reach = position(bytes)[0].abs();
    judge_weld_within(&mesh, reach, &weld(&mesh, Weld::Within(reach)));
    let welded = weld(&mesh, Weld::Exact).mesh;
    let unwelded = (welded != mesh).then_some(mesh);
    for mesh in unwelded.into_iter().chain([welded]) {
        let topology = Topology::of(&mesh);
        topology.validate();
        judge(&mesh, &topology);
    }
}

/// Panics unless `topology` and its report are those of `mesh`.
pub(crate) fn judge(mesh: &Mesh, topology: &Topology) {
    edges_are_all_pairs(mesh.triangles(), topology);
    let mut report = CrackReport::of(mesh, topology);
    report.add_self_intersections(mesh, topology, usize::MAX);
    judge_report(mesh, topology, &report);
}

/// Panics unless `report`, with self-intersections, is that of `mesh`.
pub(crate) fn judge_report(mesh: &Mesh, topology: &Topology, report: &CrackReport) {
    counts_are_naive(mesh, report);
    report_is_consistent(mesh, topology, report);
    volumes_are_those_of_big_integers(mesh, topology, report);
    self_intersections_are_all_pairs(mesh, report);
}

fn volumes_are_those_of_big_integers(mesh: &Mesh, topology: &Topology, report: &CrackReport) {
    let of_face = topology.shells().of_face;
    for (number, shell) in report.shell_list.iter().enumerate() {
        let faces = topology.faces().filter(|face| of_face[face.index()] == Some(number as u32));
        let sign = whole::volume_sign(faces.map(|face| mesh.corners(face)));
        let expected = if shell.watertight { sign } else { 0 };
        assert_eq!(shell.volume_sign.value(), i32::from(expected), "shell {number}");
    }
}

/// Only pairs without a common vertex, which is where to touch is to intersect; and few faces, for time's
/// sake.
fn self_intersections_are_all_pairs(mesh: &Mesh, report: &CrackReport) {
    let faces = mesh.triangles();
    if faces.len() > 14 {
        return;
    }
    let apart = |f: usize, g: usize| faces[f].iter().all(|vertex| !faces[g].contains(vertex));
    let corners = |face: usize| mesh.corners(FaceId::new(face));
    let with_area: Vec<usize> = (0..faces.len()).filter(|&face| !whole::collinear(corners(face))).collect();
    let pairs = with_area.iter().flat_map(|&f| with_area.iter().map(move |&g| (f, g)));
    let naive = pairs.filter(|&(f, g)| f < g && apart(f, g) && whole::intersect(corners(f), corners(g)));
    let found = report.self_intersections.as_ref().expect("they were looked for");
    let found = found.first.iter().map(|[f, g]| (f.index(), g.index())).filter(|&(f, g)| apart(f, g));
    assert_eq!(found.collect::<Vec<_>>(), naive.collect::<Vec<_>>());
}

/// Panics unless `welded` is `mesh` with what is bit-equal joined, and nothing else.
pub(crate) fn judge_exact_weld(mesh: &Mesh, welded: &Welded) {
    let used = |vertex: usize| mesh.triangles().iter().flatten().any(|&v| v as usize == vertex);
    let joined: Vec<Option<VertexId>> =
        (0..mesh.vertex_count()).map(|vertex| welded.vertex_of(VertexId::new(vertex))).collect();
    for (v, vertex) in joined.iter().enumerate() {
        assert_eq!(vertex.is_some(), used(v), "vertex {v} is kept iff a face has it");
        let Some(vertex) = vertex else { continue };
        assert_eq!(welded.mesh.positions()[vertex.index()], mesh.positions()[v]);
        for (w, other) in joined.iter().enumerate().filter(|(_, other)| other.is_some()) {
            assert_eq!(
                Some(vertex) == other.as_ref(),
                mesh.positions()[v] == mesh.positions()[w],
                "{v}, {w}"
            );
        }
    }
}

/// Panics unless in `welded` each vertex of `mesh` has joined the first kept one within reach. Nothing is
/// claimed where a distance is so nearly `reach` that rounding decides.
pub(crate) fn judge_weld_within(mesh: &Mesh, reach: f32, welded: &Welded) {
    let positions = mesh.positions();
    let mut kept: Vec<usize> = Vec::new();
    let used = |vertex: &usize| welded.vertex_of(VertexId::new(*vertex)).is_some();
    for vertex in (0..mesh.vertex_count()).filter(used) {
        let mut joined = None;
        for (number, &other) in kept.iter().enumerate() {
            match whole::is_within(positions[vertex], positions[other], reach) {
                Some(true) => joined = joined.or(Some(number)),
                Some(false) => {}
                None => return,
            }
        }
        let number = joined.unwrap_or_else(|| {
            kept.push(vertex);
            kept.len() - 1
        });
        assert_eq!(
            welded.vertex_of(VertexId::new(vertex)),
            Some(VertexId::new(number)),
            "{vertex} within {reach}"
        );
    }
}

fn edges_are_all_pairs(triangles: &[[u32; 3]], topology: &Topology) {
    let naive = naive::edges(triangles);
    assert_eq!(topology.edge_count(), naive.len());
    for (edge, (ends, uses)) in topology.edges().zip(&naive) {
        assert_eq!(topology.vertices(edge).map(|vertex| vertex.0), *ends);
        let found: Vec<(usize, i32)> = topology.uses(edge).map(|(face, way)| (face.index(), way)).collect();
        assert_eq!(found, *uses, "{edge:?}");
        let twins = match uses[..] {
            [(_, a), (_, b)] => a != b,
            _ => false,
        };
        let half_edges: Vec<HalfEdgeId> = topology.half_edges(edge).collect();
        for (i, &half_edge) in half_edges.iter().enumerate() {
            assert_eq!(topology.edge(half_edge), Some(edge));
            assert_eq!(topology.twin(half_edge), twins.then(|| half_edges[1 - i]));
            assert_eq!(topology.prev(topology.next(half_edge)), half_edge);
        }
    }
    for a in 0..topology.vertex_count() as u32 {
        for b in 0..=a {
            let place = naive.iter().position(|(ends, _)| *ends == [b, a]);
            assert_eq!(topology.edge_between(VertexId(a), VertexId(b)), place.map(EdgeId::new));
        }
    }
}

fn counts_are_naive(mesh: &Mesh, report: &CrackReport) {
    let c = &report.counts;
    let found = naive::Counts {
        edges: c.edges,
        boundary: c.boundary_edges,
        non_manifold: c.non_manifold_edges,
        misoriented: c.misoriented_edges,
        max_faces: c.max_faces_per_edge,
        balanced: c.balanced,
        even: c.even,
        shells: c.shells,
        loops: c.boundary_loops,
        pinched: c.non_manifold_vertices,
        collapsed: c.collapsed_faces,
        duplicates: [c.duplicate_same_winding, c.duplicate_opposite_winding],
        euler: c.euler_characteristic,
    };
    assert_eq!(found, naive::counts(mesh.triangles()));
    let flat = mesh.triangles().iter().enumerate().filter(|(face, [a, b, c])| {
        a != b && b != c && c != a && whole::collinear(mesh.corners(FaceId::new(*face)))
    });
    assert_eq!(c.zero_area_faces, flat.count());
    assert_eq!(c.faces, mesh.face_count());
}

fn report_is_consistent(mesh: &Mesh, topology: &Topology, report: &CrackReport) {
    let c = &report.counts;
    let shells = &report.shell_list;
    assert_eq!(c.watertight, c.boundary_edges + c.non_manifold_edges + c.misoriented_edges == 0);
    assert_eq!(c.duplicate_faces, c.duplicate_same_winding + c.duplicate_opposite_winding);
    assert!(c.t_junctions_exact <= c.t_junctions && c.near_miss_edges <= c.boundary_edges);
    assert_eq!(shells.len(), c.shells);
    assert_eq!(shells.iter().filter(|shell| shell.watertight).count(), c.closed_shells);
    assert_eq!(shells.iter().filter(|shell| shell.inside_out).count(), c.inside_out_shells);
    assert_eq!(shells.iter().map(|shell| shell.faces).sum::<usize>(), c.faces - c.collapsed_faces);
    assert_eq!(shells.iter().map(|shell| shell.edges).sum::<usize>(), c.edges);
    for shell in shells {
        let euler = shell.vertices as i64 - shell.edges as i64 + shell.faces as i64;
        assert_eq!(shell.euler_characteristic, euler);
        assert!(shell.parent.is_none() == (shell.depth == 0) && (shell.watertight || shell.depth == 0));
        // The parent lies one shell farther out.
        assert!(shell.parent.is_none_or(|parent| shells[parent].depth < shell.depth));
    }
    assert!(report.near_miss.is_sorted_by(|a, b| a.distance <= b.distance));
    assert_eq!(report.near_miss.last().map_or(0, |near| near.edges), c.near_miss_edges);
    for kind in DefectKind::ALL {
        let items = report.items(kind, mesh, topology, usize::MAX);
        assert_eq!(Some(items.len()), report.count(kind), "{kind}");
        assert!(
            items.iter().all(|item| !item.faces.is_empty() && item.position.iter().all(|x| x.is_finite()))
        );
    }
}
