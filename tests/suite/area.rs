//! Area lights: the analytic fraction under changes that leave it as it is, and against exact rays on real meshes.

use std::path::Path;

use umbrage::geom::Light;
use umbrage::mesh::Mesh;
use umbrage::oracle::Verdict;
use umbrage::oracle::area::{AreaLight, Receiver, SoftOracle, Visible};
use umbrage::scene::Scope;
use umbrage::testing::shapes;

use crate::support::real_meshes;

/// Scattered numbers in −1 ..= 1, the same in every run.
struct Scatter(u64);

impl Scatter {
    fn next(&mut self) -> f32 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((self.0 >> 40) as f32) / (1_u32 << 23) as f32 - 1.0
    }

    fn vector(&mut self, size: f32) -> [f32; 3] {
        [(); 3].map(|()| self.next() * size)
    }
}

fn plus(a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
    [0, 1, 2].map(|i| a[i] + b[i])
}

type Vector = [f32; 3];

/// Meshes with a radius of about 3, a light above them, and points below.
fn scenes() -> Vec<(Mesh, [Vector; 3], Vec<Vector>)> {
    let mut scatter = Scatter(5);
    let mut at = |z: f32| plus(scatter.vector(3.0), [0.0, 0.0, z]);
    [
        shapes::torus(24, 12, 2.0, 0.75),
        shapes::torus_knot(2, 3, 40, 6, 0.4),
        shapes::menger_sponge(1),
        shapes::book(5),
        shapes::mobius(24),
    ]
    .into_iter()
    .map(|mesh| (mesh, [at(6.0), at(0.0), at(0.0)], (0..12).map(|_| at(-4.0)).collect()))
    .collect()
}

fn seen(mesh: &Mesh, light: &AreaLight, points: &[[f32; 3]]) -> Vec<Visible> {
    let soft = SoftOracle::build(mesh);
    points.iter().map(|&p| soft.visible(Receiver::facing(p, [0.1, 0.2, 1.0]), light).unwrap()).collect()
}

fn light([corner, e1, e2]: [[f32; 3]; 3]) -> AreaLight {
    AreaLight::parallelogram(corner, e1, e2).unwrap()
}

fn in_penumbra(seen: &[Visible]) -> bool {
    seen.iter().filter(|seen| seen.fraction > 0.0 && seen.fraction < 1.0).count() > 1
}

#[test]
fn area_fraction_is_the_same_bits_for_other_numbers_of_faces_and_at_another_power_of_two() {
    for (mesh, corners, points) in scenes() {
        let found = seen(&mesh, &light(corners), &points);
        assert!(in_penumbra(&found), "{found:?}");
        assert_eq!(seen(&shapes::shuffled(&mesh, 9), &light(corners), &points), found);
        assert_eq!(seen(&shapes::soup(&mesh), &light(corners), &points), found);
        for scale in [2_f32.powi(-80), 0.25, 2_f32.powi(90)] {
            let scaled = |v: [f32; 3]| v.map(|x| x * scale);
            let points: Vec<_> = points.iter().map(|&p| scaled(p)).collect();
            let at_scale = seen(&shapes::scaled(&mesh, scale), &light(corners.map(scaled)), &points);
            assert_eq!(at_scale, found, "{scale}");
        }
        // The negative: another light is seen otherwise.
        assert_ne!(seen(&mesh, &light([corners[0], corners[1], plus(corners[2], [0.1; 3])]), &points), found);
    }
}

#[test]
fn area_fraction_stays_within_bounds_under_splits_swaps_casters_and_cuts_of_the_light() {
    for (mesh, corners, points) in scenes() {
        let [corner, e1, e2] = corners;
        let found = seen(&mesh, &light(corners), &points);
        let near = |other: &[Visible]| {
            found.iter().zip(other).all(|(a, b)| (a.fraction - b.fraction).abs() <= a.bound + b.bound)
        };
        assert!(near(&seen(&mesh, &light([corner, e2, e1]), &points)));
        assert!(near(&seen(&shapes::inside_out(&mesh), &light(corners), &points)));
        // Faces split at a point within, moved there exactly: corners are multiples of 2⁻¹⁰ first.
        let grid = |x: f32| (x * 1024.0).round() / 1024.0;
        let positions: Vec<[f32; 3]> = mesh.positions().iter().map(|p| p.map(grid)).collect();
        let whole = Mesh::new(positions.clone(), mesh.triangles().to_vec()).unwrap();
        let (mut more, mut faces) = (positions, Vec::new());
        for &[a, b, c] in mesh.triangles() {
            let middle = [0, 1, 2].map(|i| {
                let at = |v: u32| more[v as usize][i];
                0.5 * (at(a) + 0.5 * (at(b) + at(c)))
            });
            let m = more.len() as u32;
            more.push(middle);
            faces.extend([[a, b, m], [b, c, m], [c, a, m]]);
        }
        let split = seen(&Mesh::new(more, faces).unwrap(), &light(corners), &points);
        let found_whole = seen(&whole, &light(corners), &points);
        for (a, b) in found_whole.iter().zip(&split) {
            assert!((a.fraction - b.fraction).abs() <= a.bound + b.bound, "{a:?} {b:?}");
        }
        // One more caster never lets more light through.
        let more = Mesh::concat(&[mesh.clone(), shapes::translated(&shapes::octahedron(), [0.5, 0.25, 3.0])])
            .unwrap();
        for (before, after) in found.iter().zip(seen(&more, &light(corners), &points)) {
            assert!(after.fraction <= before.fraction + before.bound + after.bound);
            assert!(after.form <= before.form.map(|form| form + 1e-12));
        }
        // The light cut in two: the areas add up, and so do the forms.
        let half = e1.map(|x| 0.5 * x);
        let halves =
            [corner, plus(corner, half)].map(|corner| seen(&mesh, &light([corner, half, e2]), &points));
        for ((whole, a), b) in found.iter().zip(&halves[0]).zip(&halves[1]) {
            let off = whole.fraction - 0.5 * (a.fraction + b.fraction);
            // The second corner is rounded to f32.
            assert!(off.abs() <= whole.bound + a.bound + b.bound + 1e-6, "{off}");
            let forms = [whole, a, b].map(|seen| seen.form.unwrap());
            assert!((forms[0] - forms[1] - forms[2]).abs() < 1e-6, "{forms:?}");
        }
        // The sabotage: half of the light is not all of it.
        assert!(!near(&halves[0]));
    }
}

#[test]
fn area_fraction_of_a_small_light_is_the_verdict_of_its_middle() {
    for (mesh, [corner, e1, e2], points) in scenes() {
        let soft = SoftOracle::build(&mesh);
        let small = |e: [f32; 3]| e.map(|x| x * 2_f32.powi(-20));
        let light = AreaLight::parallelogram(corner, small(e1), small(e2)).unwrap();
        let mut kinds = [0; 2];
        for &p in &points {
            let found = soft.visible(p, &light).unwrap();
            // The corner is as good as the middle, off the outline.
            let verdict = soft.oracle().verdict(p, &Light::point(corner).unwrap());
            let expected = if verdict == Verdict::Lit { 1.0 } else { 0.0 };
            assert!((found.fraction - expected).abs() <= found.bound, "{found:?} {verdict:?}");
            kinds[usize::from(verdict == Verdict::Lit)] += 1;
        }
        assert!(kinds[0] + kinds[1] == points.len());
    }
}

#[test]
fn area_batch_says_what_single_queries_say() {
    let soft = SoftOracle::build(&shapes::torus(24, 12, 2.0, 0.75));
    let light = AreaLight::facing_disk([1.0, 0.5, 6.0], 1.5).unwrap();
    let mut scatter = Scatter(8);
    let mut receivers: Vec<Receiver> =
        (0..1000).map(|_| plus(scatter.vector(3.0), [0.0, 0.0, -3.0]).into()).collect();
    receivers[17] = [1.0, 0.5, 6.0].into();
    let mut found = vec![None; receivers.len()];
    soft.visible_into(&receivers, &light, &mut found);
    let single: Vec<_> = receivers.iter().map(|&receiver| soft.visible(receiver, &light)).collect();
    assert!(found == single && found[17].is_none());
    // The sabotage: an answer moved by one.
    found.rotate_left(1);
    assert_ne!(found, single);
    soft.visible_into(&[], &light, &mut []);
}

#[test]
fn area_fraction_of_coordinates_at_the_end_of_the_range() {
    let far = 3.0e38_f32;
    let light = AreaLight::parallelogram([-far, -far, far], [far, 0.0, 0.0], [0.0, far, 0.0]).unwrap();
    let half = Mesh::new(
        vec![
            [-far, -far, 0.5 * far],
            [-0.5 * far, -far, 0.5 * far],
            [-0.5 * far, far, 0.5 * far],
            [-far, far, 0.5 * far],
        ],
        vec![[0, 1, 2], [0, 2, 3]],
    )
    .unwrap();
    let seen = SoftOracle::build(&half).visible([-0.5 * far, -0.5 * far, 0.0], &light).unwrap();
    assert!((seen.fraction - 0.5).abs() <= seen.bound && seen.bound < 1e-10, "{seen:?}");
}

/// Points around a mesh, half of them at its vertices, and lights of three sizes: the answers that differ from
/// those of rays by more than six times the error of rays, and of sixteen times as many, the points in
/// penumbra, and the largest difference.
fn disagreements(mesh: &Mesh, points: usize, rays: u32) -> (usize, usize, f64) {
    let soft = SoftOracle::build(mesh);
    let bounds = soft.oracle().bounds();
    let (center, size) = (bounds.center(), bounds.diagonal() as f32);
    let mut scatter = Scatter(2);
    let (mut apart, mut penumbra, mut worst) = (0, 0, 0.0_f64);
    for side in [0.03, 0.1, 0.5] {
        let corner = plus(center, [0.4 * size, 0.9 * size, 0.6 * size]);
        let edges = [[side * size, 0.0, 0.0], [0.0, 0.3 * side * size, -side * size]];
        let lights = [
            AreaLight::parallelogram(corner, edges[0], edges[1]).unwrap(),
            AreaLight::facing_disk(corner, 0.5 * side * size).unwrap(),
        ];
        for i in 0..points {
            let vertex = mesh.positions()[i * 7919 % mesh.vertex_count()];
            let p = match i % 4 {
                0 | 1 => vertex,
                // Behind the vertex, seen from the light.
                2 => [0, 1, 2].map(|k| vertex[k] + 0.5 * (vertex[k] - corner[k])),
                _ => plus(center, scatter.vector(0.5 * size)),
            };
            let light = &lights[i % 2];
            let Some(found) = soft.visible(p, light) else { continue };
            let sampled = soft.sampled(p, light, rays, i as u64).unwrap();
            penumbra += usize::from(found.fraction > 0.0 && found.fraction < 1.0);
            let off = (found.fraction - sampled.fraction).abs();
            worst = worst.max(off);
            let noise = |rays: u32| 6.0 * 0.4 * f64::from(rays).powf(-0.75);
            // An outline across most of the light, as of many small boxes, needs more rays: their own error falls
            // then, an error of the fraction would stay.
            let more = || soft.sampled(p, light, 16 * rays, 99).unwrap().fraction;
            apart += usize::from(
                off > noise(rays) + found.bound
                    && (found.fraction - more()).abs() > noise(16 * rays) + found.bound,
            );
        }
    }
    (apart, penumbra, worst)
}

fn bakeable(folder: &Path) -> Vec<(String, Mesh)> {
    let mut names: Vec<_> = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    names.sort();
    let read = |path: std::path::PathBuf| {
        let meshes = umbrage::read::read(&path).ok()?.bake(Scope::Mesh).ok()?;
        let mesh = Mesh::concat(&meshes).ok()?;
        (mesh.face_count() > 0).then(|| (path.file_name().unwrap().to_string_lossy().into_owned(), mesh))
    };
    names.into_iter().filter_map(read).collect()
}

#[test]
fn area_fraction_of_real_meshes_agrees_with_rays() {
    let Some(folder) = real_meshes() else { return };
    for name in ["bunny_hr.obj", "office_chair.obj", "menger_sponge3.glb"] {
        let meshes = umbrage::read::read(folder.join(name)).unwrap().bake(Scope::Mesh).unwrap();
        let (apart, penumbra, worst) = disagreements(&Mesh::concat(&meshes).unwrap(), 24, 4096);
        assert!(apart == 0 && penumbra > 3, "{name}: {apart} apart, {penumbra} in penumbra, {worst}");
    }
}

#[test]
#[ignore = "minutes: 2^17 rays a point; cargo test --release --test suite area_fraction_of_all -- --ignored"]
fn area_fraction_of_all_real_meshes_agrees_with_many_rays() {
    let Some(folder) = real_meshes() else { return };
    let mut all = 0;
    for (name, mesh) in bakeable(&folder) {
        let (apart, penumbra, worst) = disagreements(&mesh, 8, 1 << 17);
        eprintln!(
            "{name}: {} faces, {penumbra} in penumbra, {apart} apart, at most {worst:.1e}",
            mesh.face_count()
        );
        all += apart;
    }
    assert_eq!(all, 0);
}
