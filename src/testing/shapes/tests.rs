//! The documented counts, by naive counting.

use std::collections::{HashMap, HashSet};

use super::*;

/// What a naive pass over a mesh finds.
#[derive(Debug, PartialEq)]
struct Counts {
    vertices: usize,
    edges: usize,
    faces: usize,
    /// Edges with one face.
    boundary: usize,
    /// Edges with over two faces.
    non_manifold: usize,
    /// Edges whose two faces both run in the same direction.
    misoriented: usize,
    volume: f64,
}

/// Each undirected edge with how many faces run along it up (from the lower vertex) and down.
fn faces_per_edge(mesh: &Mesh) -> HashMap<[u32; 2], [usize; 2]> {
    let mut edges = HashMap::new();
    for &[a, b, c] in mesh.triangles() {
        for [tail, head] in [[a, b], [b, c], [c, a]] {
            let ways: &mut [usize; 2] = edges.entry([tail.min(head), tail.max(head)]).or_default();
            ways[usize::from(tail > head)] += 1;
        }
    }
    edges
}

fn volume(mesh: &Mesh) -> f64 {
    let six: f64 = mesh
        .triangles()
        .iter()
        .map(|t| {
            let [a, b, c] = t.map(|v| mesh.positions()[v as usize].map(f64::from));
            a[0] * (b[1] * c[2] - b[2] * c[1])
                + a[1] * (b[2] * c[0] - b[0] * c[2])
                + a[2] * (b[0] * c[1] - b[1] * c[0])
        })
        .sum();
    six / 6.0
}

fn count(mesh: &Mesh) -> Counts {
    let edges = faces_per_edge(mesh);
    let used: HashSet<u32> = mesh.triangles().iter().flatten().copied().collect();
    assert_eq!(used.len(), mesh.vertex_count(), "{} has vertices without a face", mesh.name);
    Counts {
        vertices: mesh.vertex_count(),
        edges: edges.len(),
        faces: mesh.face_count(),
        boundary: edges.values().filter(|ways| ways[0] + ways[1] == 1).count(),
        non_manifold: edges.values().filter(|ways| ways[0] + ways[1] > 2).count(),
        misoriented: edges
            .values()
            .filter(|ways| ways[0].max(ways[1]) == 2 && ways[0].min(ways[1]) == 0)
            .count(),
        volume: volume(mesh),
    }
}

#[test]
fn solids_have_their_documented_counts() {
    // V, E, F, χ; boundary, non-manifold and misoriented edges; volume, to 1e-6 of itself.
    type Row = (Mesh, [i64; 4], [usize; 3], f64);
    // No closed form worth writing down: these volumes have tests of their own.
    let some = f64::NAN;
    #[rustfmt::skip]
    let rows: Vec<Row> = vec![
        (cube(),                                     [8, 18, 12, 2],           [0, 0, 0], 8.0),
        (cuboid([0.0; 3], [1.0, 2.0, 3.0]),          [8, 18, 12, 2],           [0, 0, 0], 6.0),
        (tetrahedron(),                              [4, 6, 4, 2],             [0, 0, 0], 8.0 / 3.0),
        (octahedron(),                               [6, 12, 8, 2],            [0, 0, 0], 4.0 / 3.0),
        (icosphere(0),                               [12, 30, 20, 2],          [0, 0, 0], 2.536_150_7),
        (icosphere(1),                               [42, 120, 80, 2],         [0, 0, 0], some),
        (icosphere(4),                               [2562, 7680, 5120, 2],    [0, 0, 0], some),
        (torus(3, 3, 2.0, 1.0),                      [9, 27, 18, 0],           [0, 0, 0], some),
        (torus(24, 12, 2.0, 0.5),                    [288, 864, 576, 0],       [0, 0, 0], some),
        (torus_knot(2, 3, 200, 12, 0.4),             [2400, 7200, 4800, 0],    [0, 0, 0], some),
        (menger_sponge(0),                           [8, 18, 12, 2],           [0, 0, 0], 1.0),
        (menger_sponge(1),                           [64, 216, 144, -8],       [0, 0, 0], 20.0),
        (menger_sponge(2),                           [896, 3168, 2112, -160],  [0, 0, 0], 400.0),
        (menger_sponge(3),                           [15_232, 54_144, 36_096, -2816], [0, 0, 0], 8000.0),
        (figure_eight_prism(),                       [8, 18, 12, 2],           [0, 0, 0], 6.0),
        (hollow_cube(),                              [16, 36, 24, 4],          [0, 0, 0], 56.0),
        (nested_cubes(3),                            [24, 54, 36, 6],          [0, 0, 0], 8.0 + 64.0 + 216.0),
        (nested_cubes(0),                            [0, 0, 0, 0],             [0, 0, 0], 0.0),
        (cubes_sharing_edge(),                       [14, 35, 24, 3],          [0, 1, 0], 2.0),
        (cubes_sharing_vertex(),                     [15, 36, 24, 3],          [0, 0, 0], 2.0),
        (sliver(),                                   [4, 6, 4, 2],             [0, 0, 0], 2f64.powi(-40) / 3.0),
        (collinear_face(),                           [9, 21, 14, 2],           [0, 0, 0], 8.0),
        (double_sheet(),                             [4, 5, 4, 3],             [0, 1, 0], 0.0),
        (sheet(1),                                   [4, 5, 2, 1],             [4, 0, 0], 0.0),
        (sheet(5),                                   [36, 85, 50, 1],          [20, 0, 0], 0.0),
        (mobius(3),                                  [6, 12, 6, 0],            [6, 0, 1], some),
        (mobius(50),                                 [100, 200, 100, 0],       [100, 0, 1], some),
        (book(1),                                    [3, 3, 1, 1],             [3, 0, 0], 0.0),
        (book(2),                                    [4, 5, 2, 1],             [4, 0, 1], 0.0),
        (book(18),                                   [20, 37, 18, 1],          [36, 1, 0], 0.0),
        (open_cube(),                                [8, 17, 10, 1],           [4, 0, 0], 8.0 - 8.0 / 6.0),
        (t_junction(),                               [9, 21, 13, 1],           [3, 0, 0], 8.0),
        (seam(0),                                    [12, 22, 12, 2],          [8, 0, 0], 8.0),
        (seam(3),                                    [12, 22, 12, 2],          [8, 0, 0], 8.0),
        (uv_capsule(8, 3, 1.0, 2.0),                 [72, 183, 112, 1],        [30, 0, 0], some),
        (duplicated_face(),                          [8, 18, 13, 3],           [0, 3, 0], 8.0 + 2.0 / 3.0),
        (misoriented_cube(),                         [8, 18, 12, 2],           [0, 0, 3], 8.0 - 4.0 / 3.0),
        (inside_out(&cube()),                        [8, 18, 12, 2],           [0, 0, 0], -8.0),
        (soup(&cube()),                              [36, 36, 12, 12],         [36, 0, 0], 8.0),
        (shuffled(&hollow_cube(), 3),                [16, 36, 24, 4],          [0, 0, 0], 56.0),
        (translated(&cube(), [3.0, 0.0, -1.0]),      [8, 18, 12, 2],           [0, 0, 0], 8.0),
        (scaled(&cube(), 0.5),                       [8, 18, 12, 2],           [0, 0, 0], 1.0),
        (scaled(&cube(), -1.0),                      [8, 18, 12, 2],           [0, 0, 0], -8.0),
    ];
    let mut wrong = Vec::new();
    for (mesh, [v, e, f, euler], [boundary, non_manifold, misoriented], expected) in rows {
        let found = count(&mesh);
        let [fv, fe, ff] = [found.vertices, found.edges, found.faces].map(|n| n as i64);
        let volume_fits = expected.is_nan() || (found.volume - expected).abs() <= 1e-6 * expected.abs();
        if [fv, fe, ff, fv - fe + ff] != [v, e, f, euler]
            || [found.boundary, found.non_manifold, found.misoriented]
                != [boundary, non_manifold, misoriented]
            || !volume_fits
            || mesh.name.is_empty()
        {
            wrong.push(format!("{}: {found:?}, χ {}", mesh.name, fv - fe + ff));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn counts_notice_a_face_dropped_turned_or_doubled() {
    let sound = count(&icosphere(1));
    let sabotages: [fn(&mut Vec<[u32; 3]>); 4] = [
        |faces| faces.truncate(79),
        |faces| faces[0].swap(0, 1),
        |faces| faces.push(faces[0]),
        |faces| faces[0][0] = faces[40][0],
    ];
    for sabotage in sabotages {
        let (positions, mut triangles, ..) = icosphere(1).into_parts();
        sabotage(&mut triangles);
        assert_ne!(count(&build("sabotaged", positions, triangles)), sound);
    }
}

#[test]
fn icosphere_is_round_and_local() {
    let sphere = icosphere(6);
    for &p in sphere.positions() {
        let length = p.iter().map(|&x| f64::from(x) * f64::from(x)).sum::<f64>().sqrt();
        assert!((length - 1.0).abs() < 1e-7, "{p:?}");
    }
    // Inscribed in the unit sphere, and nearly as large: 4π/3 = 4.18879.
    assert!((4.18..4.189).contains(&volume(&sphere)), "{}", volume(&sphere));
    // Each run of four faces has the six vertices of one cut face.
    for four in sphere.triangles().chunks(4) {
        assert_eq!(four.iter().flatten().collect::<HashSet<_>>().len(), 6);
    }
    assert!(sphere.positions().iter().map(|p| p.map(f32::to_bits)).collect::<HashSet<_>>().len() == 40_962);
}

#[test]
fn torus_and_knot_enclose_nearly_their_closed_form_volume() {
    use std::f64::consts::PI;
    // Pappus: 2π²Rr².
    let exact = 2.0 * PI * PI * 2.0 * 0.25;
    let found = volume(&torus(200, 100, 2.0, 0.5));
    assert!(found < exact && found > 0.998 * exact, "{found} of {exact}");
    // A tube has the volume of its section times the length of its middle, here that of 20,000 chords.
    let middle = |i: u64| {
        let ([cos_p, sin_p], [cos_q, sin_q]) = (circle::turn(2 * i, 20_000), circle::turn(3 * i, 20_000));
        [(2.0 + cos_q) * cos_p, (2.0 + cos_q) * sin_p, sin_q]
    };
    let chord = |i| {
        let (p, q) = (middle(i), middle(i + 1));
        (0..3).map(|k| (p[k] - q[k]).powi(2)).sum::<f64>().sqrt()
    };
    let exact = PI * 0.16 * (0..20_000).map(chord).sum::<f64>();
    let found = volume(&torus_knot(2, 3, 1000, 100, 0.4));
    assert!(found < exact && found > 0.998 * exact, "{found} of {exact}");
}

#[test]
fn torus_knot_trefoil_stays_clear_of_itself() {
    // Points of the center line over a sixth of the knot apart keep more than two tube radii of distance.
    let knot = torus_knot(2, 3, 300, 4, 0.4);
    let center: Vec<[f32; 3]> = knot
        .positions()
        .chunks(4)
        .map(|ring| std::array::from_fn(|i| ring.iter().map(|p| p[i]).sum::<f32>() / 4.0))
        .collect();
    for i in 0..300 {
        for j in i + 50..(i + 251).min(300) {
            let distance = (0..3).map(|k| (center[i][k] - center[j][k]).powi(2)).sum::<f32>().sqrt();
            assert!(distance > 0.8, "{i} {j}: {distance}");
        }
    }
}

#[test]
fn mobius_has_no_consistent_winding() {
    // Spread one choice of winding over the faces; an orientable surface never contradicts itself.
    let consistent = |mesh: &Mesh| {
        let faces = mesh.triangles();
        let mut flip: Vec<Option<bool>> = vec![None; faces.len()];
        let mut ways: HashMap<[u32; 2], Vec<(usize, bool)>> = HashMap::new();
        for (face, &[a, b, c]) in faces.iter().enumerate() {
            for [tail, head] in [[a, b], [b, c], [c, a]] {
                ways.entry([tail.min(head), tail.max(head)]).or_default().push((face, tail > head));
            }
        }
        flip[0] = Some(false);
        for _ in 0..faces.len() {
            for pair in ways.values().filter(|faces| faces.len() == 2) {
                let [(f, down_f), (g, down_g)] = [pair[0], pair[1]];
                for (f, g) in [(f, g), (g, f)] {
                    if let (Some(turned), None) = (flip[f], flip[g]) {
                        flip[g] = Some(turned ^ (down_f == down_g));
                    }
                }
            }
        }
        ways.values().filter(|faces| faces.len() == 2).all(|pair| {
            let [(f, down_f), (g, down_g)] = [pair[0], pair[1]];
            flip[f].unwrap() ^ flip[g].unwrap() == (down_f == down_g)
        })
    };
    assert!(!consistent(&mobius(9)));
    assert!(consistent(&sheet(3)) && consistent(&misoriented_cube()));
}

#[test]
fn uv_capsule_closes_when_equal_positions_are_merged() {
    let capsule = uv_capsule(8, 3, 1.0, 2.0);
    let mut ids = HashMap::new();
    let mut positions = Vec::new();
    let merged: Vec<u32> = capsule
        .positions()
        .iter()
        .map(|p| {
            *ids.entry(p.map(f32::to_bits)).or_insert_with(|| {
                positions.push(*p);
                positions.len() as u32 - 1
            })
        })
        .collect();
    let triangles = capsule.triangles().iter().map(|t| t.map(|v| merged[v as usize]));
    let triangles: Vec<_> = triangles.filter(|[a, b, c]| a != b && b != c && c != a).collect();
    assert_eq!(triangles.len(), capsule.face_count() - 16);
    let found = count(&Mesh::new(positions, triangles).unwrap());
    assert_eq!((found.vertices, found.boundary, found.non_manifold, found.misoriented), (50, 0, 0, 0));
    assert_eq!(found.vertices + found.faces, found.edges + 2);
    // Between the inscribed prism and the round capsule: 4π + 4π/3.
    assert!((12.0..16.76).contains(&found.volume), "{}", found.volume);
}

#[test]
fn voxels_are_balanced_for_random_cells() {
    let mut random = crate::random::SplitMix64(5);
    let cells: Vec<bool> = (0..6 * 5 * 4).map(|_| random.below(2) == 1).collect();
    let mesh = voxels([6, 5, 4], |[x, y, z]| cells[((z * 5 + y) * 6 + x) as usize]);
    assert!(faces_per_edge(&mesh).values().all(|ways| ways[0] == ways[1] && ways[0] <= 2));
    assert_eq!(volume(&mesh).round(), cells.iter().filter(|&&filled| filled).count() as f64);
}

#[test]
fn figure_eight_prism_has_lobes_of_both_signs() {
    // Signed crossings of the ray from each point along +z with the caps above it.
    let mesh = figure_eight_prism();
    let winding = |x: f64, y: f64| -> i64 {
        let above = mesh.triangles().iter().map(|t| t.map(|v| mesh.positions()[v as usize]));
        let hits = above.filter(|t| t.iter().all(|p| p[2] == 1.0)).map(|t| {
            let p = t.map(|p| [f64::from(p[0]) - x, f64::from(p[1]) - y]);
            let side = |i: usize| p[i][0] * p[(i + 1) % 3][1] - p[i][1] * p[(i + 1) % 3][0];
            let signs = [0, 1, 2].map(|i| side(i).signum());
            if signs == [1.0; 3] { 1 } else { -i64::from(signs == [-1.0; 3]) }
        });
        hits.sum()
    };
    assert_eq!([winding(1.5, 0.1), winding(-0.8, 0.1), winding(0.1, 0.9), winding(0.1, -0.9)], [1, -1, 0, 0]);
}

#[test]
fn shuffled_keeps_every_triangle_of_the_surface() {
    let triangles = |mesh: &Mesh| {
        let mut all: Vec<[[u32; 3]; 3]> = (0..mesh.face_count())
            .map(|face| {
                let mut corners = mesh.corners(crate::mesh::FaceId::new(face)).map(|p| p.map(f32::to_bits));
                let least = (0..3).min_by_key(|&i| corners[i]).unwrap();
                corners.rotate_left(least);
                corners
            })
            .collect();
        all.sort_unstable();
        all
    };
    let knot = torus_knot(2, 3, 60, 6, 0.3);
    let mixed = shuffled(&knot, 42);
    assert_ne!(mixed.triangles(), knot.triangles());
    assert_eq!(triangles(&mixed), triangles(&knot));
    assert_eq!(triangles(&soup(&knot)), triangles(&knot));
    assert_ne!(triangles(&inside_out(&knot)), triangles(&knot));
    assert_eq!(shuffled(&knot, 42), mixed);
    assert_ne!(shuffled(&knot, 43), mixed);
}

#[test]
fn shuffled_moves_every_frame_alike() {
    let raised = cube().positions().iter().map(|p| [p[0], p[1], p[2] + 8.0]).collect();
    let mixed = shuffled(&cube().with_frames(vec![raised]).unwrap(), 1);
    for (p, q) in mixed.positions().iter().zip(&mixed.frames()[0]) {
        assert_eq!([p[0], p[1], p[2] + 8.0], *q);
    }
}

#[test]
fn seam_opens_by_exactly_the_units_asked_for() {
    for gap in [0, 1, 5] {
        let mesh = seam(gap);
        for vertex in 4..8 {
            let [low, high] = [mesh.positions()[vertex], mesh.positions()[vertex + 4]];
            assert_eq!(low[..2], high[..2]);
            assert_eq!(high[2] - low[2], gap as f32 * f32::EPSILON);
        }
    }
}
