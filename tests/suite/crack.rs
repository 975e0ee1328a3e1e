//! Crack reports: tables of counts, positions, and naive references for the fast algorithms.

use std::collections::{BTreeMap, BTreeSet};

use umbrage::check::{CrackReport, DefectKind, self_intersections};
use umbrage::geom::predicate::{Sign, collinear, orient3d, turn};
use umbrage::mesh::{FaceId, Mesh, Weld, weld};
use umbrage::testing::shapes;
use umbrage::topology::Topology;

fn topology(mesh: &Mesh) -> Topology {
    Topology::of(mesh)
}

fn report(mesh: &Mesh) -> CrackReport {
    CrackReport::of(mesh, &topology(mesh))
}

fn welded(mesh: &Mesh) -> Mesh {
    weld(mesh, Weld::Exact).mesh
}

fn mesh(positions: &[[f32; 3]], triangles: &[[u32; 3]]) -> Mesh {
    Mesh::new(positions.to_vec(), triangles.to_vec()).unwrap()
}

/// Pseudo-random numbers below `most`.
fn random(seed: u32) -> impl FnMut(u32) -> u32 {
    let mut state = seed.wrapping_mul(2_654_435_761).wrapping_add(1);
    move |most| {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 8) % most
    }
}

/// Small triangles over few vertices of a small lattice, so that every kind of defect occurs often.
fn soup(seed: u32) -> Mesh {
    let mut next = random(seed);
    let vertices = 4 + next(8);
    let faces = 1 + next(16);
    let positions = (0..vertices).map(|_| std::array::from_fn(|_| next(4) as f32)).collect();
    let triangles = (0..faces).map(|_| std::array::from_fn(|_| next(vertices))).collect();
    Mesh::new(positions, triangles).unwrap()
}

#[test]
fn crack_counts_of_generated_meshes() {
    // χ, shells, closed, boundary edges, loops, non-manifold edges, misoriented, non-manifold vertices,
    // collapsed, zero area, duplicates same / opposite, exact T-junctions, inside out
    for (mesh, expected) in [
        (shapes::cube(), [2, 1, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0]),
        (shapes::icosphere(2), [2, 1, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0]),
        (shapes::torus(8, 6, 2.0, 1.0), [0, 1, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0]),
        (shapes::menger_sponge(1), [-8, 1, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0]),
        (shapes::hollow_cube(), [4, 2, 2, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0]),
        (shapes::nested_cubes(5), [10, 5, 5, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 2]),
        (shapes::inside_out(&shapes::cube()), [2, 1, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1]),
        (shapes::cubes_sharing_edge(), [3, 1, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0]),
        (shapes::cubes_sharing_vertex(), [3, 2, 2, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0]),
        (shapes::open_cube(), [1, 1, 0, 4, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0]),
        (shapes::misoriented_cube(), [2, 1, 0, 0, 0, 0, 3, 0, 0, 0, 0, 0, 0, 0]),
        (shapes::duplicated_face(), [3, 1, 0, 0, 0, 3, 0, 0, 0, 0, 1, 0, 0, 0]),
        (shapes::double_sheet(), [3, 1, 0, 0, 0, 1, 0, 0, 0, 0, 0, 2, 0, 0]),
        (shapes::t_junction(), [1, 1, 0, 3, 1, 0, 0, 0, 0, 0, 0, 0, 1, 0]),
        (shapes::collinear_face(), [2, 1, 1, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0]),
        (shapes::mobius(9), [0, 1, 0, 18, 1, 0, 1, 0, 0, 0, 0, 0, 0, 0]),
        (shapes::book(5), [1, 1, 0, 10, 1, 1, 0, 0, 0, 0, 0, 0, 0, 0]),
        (welded(&shapes::uv_capsule(8, 3, 1.0, 1.0)), [2, 1, 1, 0, 0, 0, 0, 0, 16, 0, 0, 0, 0, 0]),
        (shapes::sliver(), [2, 1, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0]),
        (mesh(&[], &[]), [0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0]),
        (mesh(&[[0.0; 3]], &[[0, 0, 0]; 3]), [0, 0, 0, 0, 0, 0, 0, 0, 3, 0, 0, 0, 0, 0]),
    ] {
        let c = report(&mesh).counts;
        let found = [
            c.shells,
            c.closed_shells,
            c.boundary_edges,
            c.boundary_loops,
            c.non_manifold_edges,
            c.misoriented_edges,
            c.non_manifold_vertices,
            c.collapsed_faces,
            c.zero_area_faces,
            c.duplicate_same_winding,
            c.duplicate_opposite_winding,
            c.t_junctions_exact,
            c.inside_out_shells,
        ];
        assert_eq!(c.euler_characteristic, expected[0], "{}", mesh.name);
        assert_eq!(found.map(|count| count as i64), expected[1..], "{}", mesh.name);
        assert_eq!(c.duplicate_faces, c.duplicate_same_winding + c.duplicate_opposite_winding);
    }
}

/// Results of naive code: all pairs of half-edges, components by repeated passes.
#[derive(Debug, PartialEq)]
struct Naive {
    edges: usize,
    boundary: usize,
    non_manifold: usize,
    misoriented: usize,
    max_faces: usize,
    shells: usize,
    loops: usize,
    pinched: usize,
    duplicates: usize,
    euler: i64,
}

/// The number of connected groups of `n` items, where `joined` connects two items.
fn groups(n: usize, joined: impl Fn(usize, usize) -> bool) -> usize {
    let mut label: Vec<usize> = (0..n).collect();
    for _ in 0..n {
        for i in 0..n {
            for j in 0..n {
                if joined(i, j) {
                    label[i] = label[i].min(label[j]);
                }
            }
        }
    }
    label.into_iter().collect::<BTreeSet<_>>().len()
}

fn naive(mesh: &Mesh) -> Naive {
    let faces: Vec<[u32; 3]> =
        mesh.triangles().iter().copied().filter(|&[a, b, c]| a != b && b != c && c != a).collect();
    let sides = |[a, b, c]: [u32; 3]| [[a, b], [b, c], [c, a]];
    let sorted = |[a, b]: [u32; 2]| [a.min(b), a.max(b)];
    let half_edges: Vec<[u32; 2]> = faces.iter().flat_map(|&face| sides(face)).collect();
    let edges: BTreeSet<[u32; 2]> = half_edges.iter().map(|&edge| sorted(edge)).collect();
    let uses = |edge: [u32; 2]| half_edges.iter().filter(move |&&other| sorted(other) == edge);
    let having =
        |test: &dyn Fn(usize) -> bool| edges.iter().filter(|&&edge| test(uses(edge).count())).count();
    let boundary: Vec<[u32; 2]> = edges.iter().copied().filter(|&edge| uses(edge).count() == 1).collect();
    let share_edge = |f: usize, g: usize, at: Option<u32>| {
        let edges = |face| sides(face).map(sorted);
        edges(faces[f])
            .iter()
            .any(|edge| edges(faces[g]).contains(edge) && at.is_none_or(|vertex| edge.contains(&vertex)))
    };
    let vertices: BTreeSet<u32> = faces.iter().flatten().copied().collect();
    let fans = |vertex: u32| {
        let around: Vec<usize> = (0..faces.len()).filter(|&f| faces[f].contains(&vertex)).collect();
        groups(around.len(), |i, j| share_edge(around[i], around[j], Some(vertex)))
    };
    let sets: BTreeSet<BTreeSet<u32>> = faces.iter().map(|face| face.iter().copied().collect()).collect();
    Naive {
        edges: edges.len(),
        boundary: having(&|n| n == 1),
        non_manifold: having(&|n| n > 2),
        misoriented: edges
            .iter()
            .filter(|&&edge| {
                uses(edge).count() == 2 && uses(edge).all(|other| other == uses(edge).next().unwrap())
            })
            .count(),
        max_faces: edges.iter().map(|&edge| uses(edge).count()).max().unwrap_or(0),
        shells: groups(faces.len(), |f, g| share_edge(f, g, None)),
        loops: groups(boundary.len(), |i, j| boundary[i].iter().any(|v| boundary[j].contains(v))),
        pinched: vertices.iter().filter(|&&vertex| fans(vertex) > 1).count(),
        duplicates: faces.len() - sets.len(),
        euler: vertices.len() as i64 - edges.len() as i64 + faces.len() as i64,
    }
}

fn fast(mesh: &Mesh) -> Naive {
    let c = report(mesh).counts;
    Naive {
        edges: c.edges,
        boundary: c.boundary_edges,
        non_manifold: c.non_manifold_edges,
        misoriented: c.misoriented_edges,
        max_faces: c.max_faces_per_edge,
        shells: c.shells,
        loops: c.boundary_loops,
        pinched: c.non_manifold_vertices,
        duplicates: c.duplicate_faces,
        euler: c.euler_characteristic,
    }
}

#[test]
fn crack_counts_of_random_soups_equal_the_naive_ones() {
    let mut pinched = 0;
    for seed in 0..400 {
        let mesh = soup(seed);
        assert_eq!(fast(&mesh), naive(&mesh), "{:?}", mesh.triangles());
        // Negative test: without its last face that has not collapsed it is another mesh.
        let (positions, mut triangles, ..) = mesh.clone().into_parts();
        let counted = naive(&mesh);
        pinched += usize::from(counted.pinched > 0);
        if let Some(last) = triangles.iter().rposition(|&[a, b, c]| a != b && b != c && c != a) {
            triangles.remove(last);
            assert_ne!(fast(&Mesh::new(positions, triangles).unwrap()), counted);
        }
    }
    assert!(pinched > 50, "{pinched} soups with a non-manifold vertex");
}

#[test]
fn crack_fans_of_a_hub_are_counted_like_those_of_a_short_one() {
    // Two cones of 40 faces on one apex: two fans, and too many faces for the fast path.
    let rim = 40;
    let mut triangles = Vec::new();
    for start in [1, 1 + rim] {
        triangles.extend((0..rim).map(|i| [0, start + i, start + (i + 1) % rim]));
    }
    let mesh = mesh(&vec![[0.0; 3]; 1 + 2 * rim as usize], &triangles);
    let fans = topology(&mesh).non_manifold_vertices();
    assert_eq!(fans.iter().map(|&(vertex, fans)| (vertex.0, fans)).collect::<Vec<_>>(), [(0, 2)]);
}

/// All pairs of intersecting faces without a common vertex, by separating axes in integer arithmetic. Two
/// triangles are disjoint iff their projections are disjoint on one of these axes: the two normals, the cross
/// products of two edges, the normals of the edges within the planes.
fn naive_pairs(mesh: &Mesh) -> Vec<[u32; 2]> {
    type P = [i64; 3];
    let sub = |a: P, b: P| [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
    let cross =
        |a: P, b: P| [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
    let dot = |a: P, b: P| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let parted = |f: [P; 3], g: [P; 3]| {
        let edges = |t: [P; 3]| [sub(t[1], t[0]), sub(t[2], t[1]), sub(t[0], t[2])];
        let (nf, ng) = (cross(edges(f)[0], edges(f)[1]), cross(edges(g)[0], edges(g)[1]));
        let mut axes = vec![nf, ng];
        for e in edges(f) {
            axes.push(cross(nf, e));
            axes.extend(edges(g).map(|h| cross(e, h)));
        }
        axes.extend(edges(g).map(|h| cross(ng, h)));
        axes.iter().any(|&axis| {
            let range = |t: [P; 3]| {
                let along = t.map(|p| dot(p, axis));
                (*along.iter().min().unwrap(), *along.iter().max().unwrap())
            };
            let ((a, b), (c, d)) = (range(f), range(g));
            b < c || d < a
        })
    };
    let corners = |face: [u32; 3]| face.map(|v| mesh.positions()[v as usize].map(|x| x as i64));
    let with_area = |t: [P; 3]| cross(sub(t[1], t[0]), sub(t[2], t[0])) != [0; 3];
    let faces = mesh.triangles();
    let mut pairs = Vec::new();
    for (i, &f) in faces.iter().enumerate() {
        for (j, &g) in faces.iter().enumerate().skip(i + 1) {
            let shared = f.iter().any(|v| g.contains(v));
            if !shared && with_area(corners(f)) && with_area(corners(g)) && !parted(corners(f), corners(g)) {
                pairs.push([i as u32, j as u32]);
            }
        }
    }
    pairs
}

fn unshared(mesh: &Mesh) -> Vec<[u32; 2]> {
    let apart = |[f, g]: &[FaceId; 2]| {
        let (f, g) = (mesh.triangles()[f.index()], mesh.triangles()[g.index()]);
        f.iter().all(|v| !g.contains(v))
    };
    let pairs = self_intersections(mesh, &topology(mesh));
    pairs.into_iter().filter(apart).map(|pair| pair.map(|face| face.0)).collect()
}

#[test]
fn crack_self_intersections_equal_separating_axes_over_all_pairs() {
    let mut met = 0;
    for seed in 0..600 {
        let mesh = shapes::soup(&soup(seed)); // no shared corner
        let expected = naive_pairs(&mesh);
        assert_eq!(unshared(&mesh), expected, "{seed}");
        met += expected.len();
        // Negative test: a face moved far away intersects nothing.
        if let Some(&[face, _]) = expected.first() {
            let (mut positions, triangles, ..) = mesh.into_parts();
            triangles[face as usize].iter().for_each(|&v| positions[v as usize][0] += 100.0);
            assert_ne!(unshared(&Mesh::new(positions, triangles).unwrap()), expected);
        }
    }
    assert!(met > 1000, "{met} pairs");
}

#[test]
fn crack_self_intersections_of_neighbors_by_hand() {
    let [o, x, y, z] = [[0.0; 3], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0], [0.0, 0.0, 4.0]];
    let count = |positions: &[[f32; 3]], g: [u32; 3]| {
        let mesh = mesh(positions, &[[0, 1, 2], g]);
        self_intersections(&mesh, &topology(&mesh)).len()
    };
    // Sharing an edge: hinged, coplanar, folded onto each other.
    assert_eq!(count(&[o, x, y, z], [1, 0, 3]), 0);
    assert_eq!(count(&[o, x, y, [1.0, -3.0, 0.0]], [1, 0, 3]), 0);
    assert_eq!(count(&[o, x, y, [1.0, 3.0, 0.0]], [1, 0, 3]), 1);
    // Sharing a vertex: disjoint, side by side in a plane, crossing, along a common ray, overlapping.
    assert_eq!(count(&[o, x, y, z, [0.0, 1.0, 4.0]], [0, 3, 4]), 0);
    assert_eq!(count(&[o, x, y, [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]], [0, 3, 4]), 0);
    assert_eq!(count(&[o, x, y, [1.0, 1.0, 1.0], [1.0, 1.0, -1.0]], [0, 3, 4]), 1);
    assert_eq!(count(&[o, x, y, [2.0, 0.0, 0.0], [2.0, 0.0, 5.0]], [0, 3, 4]), 1);
    assert_eq!(count(&[o, x, y, [1.0, 2.0, 0.0], [2.0, 1.0, 0.0]], [0, 3, 4]), 1);
    // A face with the same three vertices is a duplicate, not an intersection.
    assert_eq!(count(&[o, x, y], [1, 0, 2]), 0);
    // A face of zero area is skipped.
    assert_eq!(count(&[o, x, y, [1.0, 1.0, -1.0], [1.0, 1.0, 1.0], [1.0, 1.0, 2.0]], [3, 4, 5]), 0);
    assert_eq!(count(&[o, x, y, [1.0, 1.0, -1.0], [1.0, 1.0, 1.0], [1.0, 2.0, 2.0]], [3, 4, 5]), 1);
}

#[test]
fn crack_solids_are_free_of_self_intersections() {
    for mesh in
        [shapes::cube(), shapes::icosphere(3), shapes::menger_sponge(2), shapes::torus_knot(2, 3, 60, 8, 0.2)]
    {
        let mut report = report(&mesh);
        assert_eq!(report.count(DefectKind::SelfIntersection), None);
        report.add_self_intersections(&mesh, &topology(&mesh), 5);
        assert_eq!(report.count(DefectKind::SelfIntersection), Some(0), "{}", mesh.name);
    }
    let mesh = shapes::figure_eight_prism();
    let mut report = report(&mesh);
    report.add_self_intersections(&mesh, &topology(&mesh), 1);
    let found = report.self_intersections.unwrap();
    assert!(found.complete && found.pairs > 1 && found.first.len() == 1, "{found:?}");
}

#[test]
fn crack_nesting_gives_depth_and_parent() {
    let shells = report(&shapes::nested_cubes(4)).shell_list;
    assert_eq!(shells.iter().map(|shell| shell.depth).collect::<Vec<_>>(), [0, 1, 2, 3]);
    let parents: Vec<_> = shells.iter().map(|shell| shell.parent).collect();
    assert_eq!(parents, [None, Some(0), Some(1), Some(2)]);
    assert_eq!(shells.iter().map(|shell| shell.inside_out).collect::<Vec<_>>(), [false, true, false, true]);
    let hollow = report(&shapes::hollow_cube());
    assert!(hollow.counts.sound());
    assert_eq!(hollow.shell_list.iter().filter(|shell| shell.signed_volume < 0.0).count(), 1);
    assert_eq!(hollow.shell_list.iter().map(|shell| shell.depth).sum::<usize>(), 1);
}

#[test]
fn crack_nesting_of_a_shell_that_merely_cuts_another_is_none() {
    // The small cube's box lies in the tetrahedron's box, and the cube's first corner lies inside the
    // tetrahedron, but not the rest.
    let big = mesh(
        &[[0.0; 3], [8.0, 0.0, 0.0], [0.0, 8.0, 0.0], [0.0, 0.0, 8.0]],
        &[[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]],
    );
    for (low, high, depth) in [(1.0, 4.0, 0), (1.0, 2.0, 1)] {
        let both = Mesh::concat(&[big.clone(), shapes::cuboid([low; 3], [high; 3])]).unwrap();
        let shells = report(&both).shell_list;
        assert_eq!((shells[1].depth, shells[1].inside_out), (depth, depth == 1));
    }
    // Touching the container in a corner still counts as inside.
    let touching =
        Mesh::concat(&[shapes::cuboid([0.0; 3], [4.0; 3]), shapes::cuboid([0.0; 3], [2.0; 3])]).unwrap();
    assert_eq!(report(&touching).shell_list[1].depth, 1);
}

#[test]
fn crack_double_sided_sheets_are_not_inside_out() {
    let mesh = mesh(&[[0.1, 0.2, 0.3], [1e30, 0.0, 0.0], [0.0, 7.0, 1e-30]], &[[0, 1, 2], [0, 2, 1]]);
    let report_of_sheet = report(&mesh);
    let shell = report_of_sheet.shell_list[0];
    assert!(shell.watertight && !shell.inside_out);
    assert_eq!(report_of_sheet.counts.duplicate_opposite_winding, 1);
    // One ulp of volume decides the orientation.
    let sliver = report(&shapes::inside_out(&shapes::sliver()));
    assert_eq!(sliver.counts.inside_out_shells, 1);
}

#[test]
fn crack_genus_needs_one_fan_a_vertex() {
    let genus = |mesh: &Mesh| report(mesh).shell_list.iter().map(|shell| shell.genus).collect::<Vec<_>>();
    assert_eq!(genus(&shapes::torus(8, 6, 2.0, 1.0)), [Some(1)]);
    assert_eq!(genus(&shapes::menger_sponge(1)), [Some(5)]);
    assert_eq!(genus(&shapes::cubes_sharing_vertex()), [Some(0), Some(0)]);
    assert_eq!(genus(&shapes::open_cube()), [None]);
    // An octahedron whose poles are one vertex: one shell with two fans at this vertex, χ 1.
    let rim = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0; 3]];
    let triangles: Vec<[u32; 3]> =
        (0..4_u32).flat_map(|i| [[i, (i + 1) % 4, 4], [(i + 1) % 4, i, 5]]).collect();
    let pinched = triangles.iter().map(|t| t.map(|v| v.min(4))).collect::<Vec<_>>();
    let shells = report(&mesh(&rim, &pinched)).shell_list;
    assert_eq!((shells.len(), shells[0].genus), (1, None));
}

#[test]
fn crack_seams_close_at_the_distance_that_is_stated() {
    for (gap, closing) in [(0, [8; 4]), (4, [0, 8, 8, 8]), (50, [0, 0, 8, 8]), (500, [0, 0, 0, 8])] {
        let found = report(&shapes::seam(gap));
        assert_eq!(found.counts.boundary_edges, 8);
        assert_eq!(found.near_miss.iter().map(|near| near.edges).collect::<Vec<_>>(), closing, "{gap} ulps");
        assert_eq!(found.counts.near_miss_edges, 8);
    }
    assert_eq!(report(&shapes::open_cube()).counts.near_miss_edges, 0);
}

#[test]
fn crack_t_junctions_exact_and_rounded_are_told_apart() {
    // A point at a third of an edge cannot be exact in f32. One ulp farther off the point is no T-junction
    // any more.
    let (a, b) = ([0.1_f32, 0.2, 0.3], [1.3_f32, 2.7, 3.1]);
    let third: [f32; 3] =
        std::array::from_fn(|i| (f64::from(a[i]) + (f64::from(b[i]) - f64::from(a[i])) / 3.0) as f32);
    let off = [third[0], third[1], third[2] + 1e-5];
    for (point, expected) in [(third, (1, 0)), (off, (0, 0)), ([0.7, 1.45, 1.7], (1, 0))] {
        let mesh =
            mesh(&[a, b, [0.0, 9.0, 0.0], point, [9.0, 0.0, 0.0], [9.0, 0.0, 1.0]], &[[0, 1, 2], [3, 4, 5]]);
        let counts = report(&mesh).counts;
        assert_eq!((counts.t_junctions, counts.t_junctions_exact), expected, "{point:?}");
    }
    let junction = shapes::t_junction();
    let items = report(&junction).items(DefectKind::TJunction, &junction, &topology(&junction), 9);
    assert_eq!(items.len(), 1);
    assert_eq!(items[0].position, junction.positions()[8]);
}

#[test]
fn crack_items_are_as_many_as_were_counted() {
    let meshes = [
        shapes::open_cube(),
        shapes::misoriented_cube(),
        shapes::duplicated_face(),
        shapes::cubes_sharing_vertex(),
        shapes::cubes_sharing_edge(),
        shapes::collinear_face(),
        shapes::t_junction(),
        shapes::seam(5),
        shapes::inside_out(&shapes::cube()),
        shapes::figure_eight_prism(),
        welded(&shapes::uv_capsule(8, 3, 1.0, 1.0)),
    ];
    let mut seen = BTreeSet::new();
    for mesh in &meshes {
        let topology = topology(mesh);
        let mut report = CrackReport::of(mesh, &topology);
        report.add_self_intersections(mesh, &topology, usize::MAX);
        for kind in DefectKind::ALL {
            let items = report.items(kind, mesh, &topology, usize::MAX);
            assert_eq!(Some(items.len()), report.count(kind), "{kind} of {}", mesh.name);
            assert!(items.iter().all(|item| !item.faces.is_empty() && item.length.is_none_or(|l| l > 0.0)));
            assert_eq!(report.items(kind, mesh, &topology, 1)[..], items[..items.len().min(1)]);
            if !items.is_empty() {
                seen.insert(kind);
            }
        }
    }
    assert_eq!(seen.into_iter().collect::<Vec<_>>(), DefectKind::ALL);
    let names: BTreeMap<&str, &str> =
        DefectKind::ALL.iter().map(|kind| (kind.name(), kind.effect())).collect();
    assert_eq!(names.len(), DefectKind::ALL.len());
    let hole = report(&meshes[0]).items(DefectKind::BoundaryLoop, &meshes[0], &topology(&meshes[0]), 1);
    assert_eq!((hole[0].length, hole[0].segments.len(), hole[0].faces.len()), (Some(8.0), 4, 4));
}

#[test]
fn crack_reports_survive_the_ends_of_the_domain() {
    // No panic, and the counts that do not depend on positions are right.
    for scale in [1e-45_f32, 1e-38, 1e30, f32::MAX] {
        for mut mesh in [shapes::cube(), shapes::open_cube(), shapes::t_junction(), shapes::nested_cubes(2)] {
            let edges = report(&mesh).counts.boundary_edges;
            let (positions, triangles, ..) = mesh.into_parts();
            let most = positions.iter().flatten().fold(0.0_f32, |most, x| most.max(x.abs()));
            let moved = positions.iter().map(|p| p.map(|x| x / most * scale)).collect();
            mesh = Mesh::new(moved, triangles).unwrap();
            let mut report = report(&mesh);
            report.add_self_intersections(&mesh, &topology(&mesh), 3);
            assert_eq!(report.counts.boundary_edges, edges);
        }
    }
}

#[test]
fn crack_totals_add_and_take_what_is_weakest() {
    use umbrage::check::Counts;
    assert_eq!(Counts::total([]), None);
    let [sound, open] = [shapes::cube(), shapes::open_cube()].map(|mesh| report(&mesh).counts);
    let total = Counts::total([sound, open]).unwrap();
    assert_eq!((total.faces, total.boundary_edges, total.watertight), (22, 4, false));
    assert!(sound.sound() && !open.sound() && !total.sound());
}

#[test]
fn crack_zero_area_is_decided_exactly() {
    let along = |t: f32| [0.1 * t, 0.7 * t, -0.3 * t];
    let line = [along(1.0), along(2.0), along(4.0)]; // powers of two: exact
    assert!(collinear(line[0], line[1], line[2]));
    let off = [line[0], line[1], [line[2][0].next_up(), line[2][1], line[2][2]]];
    for (points, expected) in [(line, 1), (off, 0)] {
        assert_eq!(report(&mesh(&points, &[[0, 1, 2]])).counts.zero_area_faces, expected);
        let flat = (0..3).all(|axis| turn(points[0], points[1], points[2], axis) == Sign::Zero);
        assert_eq!(usize::from(flat), expected);
        assert_eq!(orient3d(points[0], points[1], points[2], points[0]), Sign::Zero);
    }
}

#[test]
fn crack_a_bar_through_a_u_is_not_nested_though_its_corners_are() {
    // All corners of the bar lie in the two arms. The bar's middle passes through the gap between the arms.
    let outline =
        [[0.0, 0.0], [3.0, 0.0], [3.0, 3.0], [2.0, 3.0], [2.0, 1.0], [1.0, 1.0], [1.0, 3.0], [0.0, 3.0]];
    let at = |z: f32| outline.map(|[x, y]: [f32; 2]| [x, y, z]);
    let positions = [at(0.0), at(3.0)].concat();
    // The outline cut into triangles: the foot, then the arms.
    let top = [[0, 1, 5], [1, 4, 5], [1, 2, 4], [2, 3, 4], [0, 5, 7], [5, 6, 7]];
    let mut faces: Vec<[u32; 3]> = top.iter().map(|t| t.map(|v| v + 8)).collect();
    faces.extend(top.iter().map(|&[a, b, c]| [a, c, b]));
    for i in 0..8 {
        let next = (i + 1) % 8;
        faces.extend([[i, next, next + 8], [i, next + 8, i + 8]]);
    }
    let u = Mesh::new(positions, faces).unwrap();
    let bar = shapes::cuboid([0.2, 2.0, 1.0], [2.8, 2.5, 2.0]);
    let both = Mesh::concat(&[u, bar]).unwrap();
    let topology = Topology::of(&both);
    let report = CrackReport::of(&both, &topology);
    assert!(report.counts.watertight);
    assert_eq!((report.counts.inside_out_shells, report.shell_list[1].depth), (0, 0));
}
