//! Each weld against a comparison with all kept vertices.

use super::*;
use crate::testing::shapes;
use proptest::prelude::*;

/// Reference: the welded id of every vertex by comparison with all kept vertices; `same` decides.
fn naive(mesh: &Mesh, same: impl Fn(usize, usize) -> bool) -> Vec<Option<VertexId>> {
    let used = |v: usize| mesh.triangles().iter().flatten().any(|&corner| corner as usize == v);
    let mut kept: Vec<usize> = Vec::new();
    (0..mesh.vertex_count())
        .map(|v| {
            if !used(v) {
                return None;
            }
            let id = kept.iter().position(|&other| same(other, v)).unwrap_or_else(|| {
                kept.push(v);
                kept.len() - 1
            });
            Some(VertexId::new(id))
        })
        .collect()
}

fn found(mesh: &Mesh, how: Weld) -> Vec<Option<VertexId>> {
    let welded = weld(mesh, how);
    let in_place = weld_in_place(mesh.clone(), how);
    assert_eq!((&in_place.mesh, &in_place.vertex_of), (&welded.mesh, &welded.vertex_of));
    for (old, new) in mesh.triangles().iter().zip(welded.mesh.triangles()) {
        assert_eq!(old.map(|v| welded.vertex_of(VertexId(v)).unwrap().0), *new);
    }
    (0..mesh.vertex_count()).map(|v| welded.vertex_of(VertexId::new(v))).collect()
}

/// Positions on a small grid, so that many coincide: enough to fill blocks and to grow the table.
fn mesh() -> impl Strategy<Value = Mesh> {
    let place = || [0_u8..9, 0_u8..9, 0_u8..9].prop_map(|p| p.map(f32::from));
    let corner = || any::<u32>();
    (
        prop::collection::vec((place(), place()), 1..600),
        prop::collection::vec([corner(), corner(), corner()], 0..400),
        any::<bool>(),
        any::<bool>(),
    )
        .prop_map(|(mut places, picks, animated, soup)| {
            let n = places.len() as u32;
            let triangles = if soup {
                places.truncate(n as usize / 3 * 3);
                (0..n / 3).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect()
            } else {
                picks.into_iter().map(|t| t.map(|i| i % n)).collect()
            };
            let (positions, frame): (Vec<_>, Vec<_>) = places.into_iter().unzip();
            let frames = if animated {
                vec![frame.into_iter().map(|[x, _, _]| [x % 2.0; 3]).collect()]
            } else {
                vec![]
            };
            Mesh::new(positions, triangles).unwrap().with_frames(frames).unwrap()
        })
}

proptest! {
    #[test]
    fn weld_equals_looking_at_all_kept_vertices(mesh in mesh()) {
        let all = |test: &dyn Fn([f32; 3], [f32; 3]) -> bool, a: usize, b: usize| {
            test(mesh.positions()[a], mesh.positions()[b]) && mesh.frames().iter().all(|f| test(f[a], f[b]))
        };
        prop_assert_eq!(found(&mesh, Weld::Exact), naive(&mesh, |a, b| all(&|p, q| p == q, a, b)));
        let near = |p: [f32; 3], q: [f32; 3]| (0..3).map(|i| (p[i] - q[i]).powi(2)).sum::<f32>() <= 2.25;
        prop_assert_eq!(found(&mesh, Weld::Within(1.5)), naive(&mesh, |a, b| all(&near, a, b)));
        prop_assert_eq!(found(&mesh, Weld::None), naive(&mesh, |_, _| false));
    }
}

#[test]
fn weld_within_where_the_positions_all_coincide_is_not_quadratic() {
    // One vertex per cell in the second frame. Comparing with all kept vertices would take minutes for the
    // larger mesh.
    for (count, compared) in [(900_u32, true), (600_000, false)] {
        let apart = |v: u32| [(v / 3 % 1000) as f32, (v / 3000) as f32, (v % 3) as f32 * 0.4];
        let triangles = (0..count / 3).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
        let frames = vec![vec![[0.0; 3]; count as usize], (0..count).map(apart).collect()];
        let still = Mesh::new(vec![[0.0; 3]; count as usize], triangles).unwrap();
        let mesh = still.with_frames(frames).unwrap();
        let found = found(&mesh, Weld::Within(0.5));
        assert_eq!(weld(&mesh, Weld::Within(0.5)).mesh.vertex_count(), 2 * count as usize / 3);
        if compared {
            let moved = &mesh.frames()[1];
            let near = |a: usize, b: usize| {
                let square = |i: usize| (moved[a][i] - moved[b][i]).powi(2);
                square(0) + square(1) + square(2) <= 0.25
            };
            assert_eq!(found, naive(&mesh, near));
        }
    }
}

#[test]
fn weld_that_forgets_a_frame_is_seen() {
    let positions = vec![[0.0; 3], [0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let still = Mesh::new(positions.clone(), vec![[0, 2, 3], [1, 3, 2]]).unwrap();
    let parting = vec![vec![[0.0; 3], [5.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]];
    let moving = still.clone().with_frames(parting).unwrap();
    assert_eq!(naive(&moving, |a, b| positions[a] == positions[b]), found(&still, Weld::Exact));
    assert_ne!(found(&moving, Weld::Exact), found(&still, Weld::Exact));
}

/// The exact weld by each of its methods: the kept vertices and the welded ids.
fn by_all_ways(mesh: &Mesh) -> Vec<(Kept, Vec<u32>)> {
    let used = Used::by(mesh);
    let by = |merge: &dyn Fn(&mut [u32]) -> Kept| {
        let mut vertex_of = vec![UNUSED; mesh.vertex_count()];
        (merge(&mut vertex_of), vertex_of)
    };
    if !mesh.frames().is_empty() {
        return vec![by(&|ids| streaming::merge(&exact::Points::<true>::of(mesh), &used, ids))];
    }
    let points = exact::Points::of(mesh);
    let far = [0, 3, 9].map(|bits| by(&|ids| bucketed::merge_by(&points, &used, ids, bits)));
    [by(&|ids| streaming::merge(&points, &used, ids))].into_iter().chain(far).collect()
}

fn ids(vertex_of: &[u32]) -> Vec<Option<VertexId>> {
    vertex_of.iter().map(|&vertex| (vertex != UNUSED).then_some(VertexId(vertex))).collect()
}

proptest! {
    #[test]
    fn weld_by_buckets_equals_the_one_by_a_table_and_looking_at_all(mesh in mesh()) {
        let same = |a: usize, b: usize| {
            mesh.positions()[a] == mesh.positions()[b] && mesh.frames().iter().all(|f| f[a] == f[b])
        };
        let expected = naive(&mesh, same);
        let origins = |kept: usize| expected.iter().position(|&id| id == Some(VertexId::new(kept))).unwrap();
        for (kept, vertex_of) in by_all_ways(&mesh) {
            prop_assert_eq!(ids(&vertex_of), expected.clone());
            for (id, &position) in kept.positions.iter().enumerate() {
                prop_assert_eq!(position, mesh.positions()[origins(id)]);
            }
            prop_assert_eq!(kept.positions.len(), expected.iter().flatten().max().map_or(0, |id| id.index() + 1));
        }
    }
}

#[test]
fn weld_by_buckets_takes_many_vertices_of_one_place_and_of_all_different_ones() {
    let soup = |places: &dyn Fn(u32) -> [f32; 3], n: u32| {
        Mesh::new((0..n).map(places).collect(), (0..n / 3).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect())
            .unwrap()
    };
    let n = 300_000;
    for (mesh, kept) in [
        (soup(&|_| [1.0; 3], n), 1),
        (soup(&|v| [v as f32, 0.0, 0.0], n), n),
        // Each position again after all others.
        (soup(&|v| [(v % (n / 6)) as f32, 0.0, 1.0], n), n / 6),
    ] {
        let ways = by_all_ways(&mesh);
        assert!(ways.iter().all(|way| *way == ways[0] && way.0.positions.len() == kept as usize));
        assert_eq!(merged(&mesh, &Used::by(&mesh), Weld::Exact), ways[0]);
        // Fault injected: a vertex moved by one unit in the last place.
        let (mut positions, triangles, ..) = mesh.into_parts();
        let last = n as usize - 1;
        positions[last][0] = positions[last][0].next_down();
        let moved = by_all_ways(&Mesh::new(positions, triangles).unwrap());
        assert!(kept == n || !moved.contains(&ways[0]));
    }
}

#[test]
fn weld_of_a_soup_in_any_order_gives_ids_in_order_of_first_use() {
    let by_map = |soup: &Mesh| -> Vec<Option<VertexId>> {
        let mut ids = std::collections::HashMap::new();
        let bits = soup.positions().iter().map(|p| p.map(f32::to_bits));
        bits.map(|bits| {
            let new = VertexId::new(ids.len());
            Some(*ids.entry(bits).or_insert(new))
        })
        .collect()
    };
    // Enough corners that the shuffled meshes take the bucketed method, and that blocks and table fill
    // several times.
    let [sphere, torus] = [shapes::icosphere(5), shapes::torus(90, 90, 2.0, 0.75)];
    for mesh in [shapes::shuffled(&sphere, 1), shapes::shuffled(&torus, 2), sphere, torus] {
        let soup = shapes::soup(&mesh);
        let expected = by_map(&soup);
        assert_eq!(found(&soup, Weld::Exact), expected);
        assert_eq!(weld(&soup, Weld::Exact).unreferenced(), 0);
        // The same vertices with an index list that does not list them in order, as no soup has.
        let turned = soup.triangles().iter().map(|&[a, b, c]| [b, c, a]).collect();
        let turned = Mesh::new(soup.positions().to_vec(), turned).unwrap();
        assert_eq!(found(&turned, Weld::Exact), expected);
        // Fault injected: a vertex moved by one unit in the last place.
        let (mut positions, triangles, ..) = soup.into_parts();
        let last = positions.len() - 1;
        positions[last][0] = positions[last][0].next_up();
        assert_ne!(found(&Mesh::new(positions, triangles).unwrap(), Weld::Exact), expected);
    }
}

#[test]
fn weld_of_many_points_without_faces_ends_and_keeps_none() {
    let points = Mesh::new((0..20_000).map(|i| [i as f32; 3]).collect(), vec![]).unwrap();
    assert!(by_all_ways(&points).iter().all(|(kept, _)| kept.positions.is_empty()));
    let welded = weld_in_place(points, Weld::Exact);
    assert_eq!((welded.mesh.vertex_count(), welded.unreferenced()), (0, 20_000));
}
