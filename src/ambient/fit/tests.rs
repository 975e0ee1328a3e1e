use super::*;
use crate::ambient::{Ambient, Effort, Per, RayOptions, Ring};
use crate::mesh::Mesh;
use crate::oracle::Oracle;
use crate::random::SplitMix64;
use crate::testing::shapes;

/// A function at the points of some receivers.
fn at(receivers: &Receivers, field: impl Fn([f32; 3]) -> f32) -> Vec<f32> {
    receivers.list().iter().map(|receiver| field(receiver.point)).collect()
}

fn most_apart(a: &[f32], b: &[f32]) -> f32 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max)
}

/// A floor whose squares grow towards one corner, each as two faces: areas from 1 to 6,561.
fn uneven() -> Mesh {
    let sheet = shapes::sheet(5);
    let grown = |p: &[f32; 3]| p.map(|x| 3_f32.powf(x) / 243.0);
    Mesh::new(sheet.positions().iter().map(grown).collect(), sheet.triangles().to_vec()).unwrap()
}

#[test]
fn linear_field_on_a_plane_is_found_again_and_not_if_points_weigh_wrongly() {
    let field = |[x, y, z]: [f32; 3]| 0.2 + 0.5 * x + 0.2 * y - 0.1 * z;
    for mesh in [uneven(), shapes::sheet(1)] {
        let receivers = Receivers::of(&[&mesh], Per::Vertex);
        let (known, truth) = (vec![0.5; receivers.list().len()], at(&receivers, field));
        for pieces in [1, 40, 3000] {
            let fit = receivers.fit(&known, pieces, &mut |inside| at(inside, field));
            assert!(most_apart(&fit, &truth) < 4e-6, "{} {pieces}: {}", mesh.name, most_apart(&fit, &truth));
        }
        // The sabotage: each point has the same weight, whatever it stands for.
        let cut = Pieces::of(&receivers, 40);
        let mean = cut.whole() / receivers.corners().len() as f64;
        let even = |_: FaceId, points: f64| mean / points;
        let wrong = fit_with(&cut, &known, FOLDS, &even, &mut |inside| at(inside, field));
        assert!(mesh.face_count() == 2 || most_apart(&wrong, &truth) > 0.01);
    }
}

#[test]
fn folds_spread_noise_and_with_the_wrong_sign_they_sharpen_it() {
    let receivers = Receivers::of(&[&shapes::sheet(9)], Per::Vertex);
    let field = |[x, y, _]: [f32; 3]| 0.3 + 0.02 * x + 0.03 * y;
    let truth = at(&receivers, field);
    let error = |folds: f64| {
        let cut = Pieces::of(&receivers, 1);
        let mut random = SplitMix64(4);
        let mut noisy = |inside: &Receivers| {
            at(inside, field).into_iter().map(|open| open + 0.2 * (random.unit() as f32 - 0.5)).collect()
        };
        let weight = |face, points| cut.area(face) / points;
        let fit = fit_with(&cut, &truth, folds, &weight, &mut noisy);
        fit.iter().zip(&truth).map(|(a, b)| f64::from(a - b).powi(2)).sum::<f64>()
    };
    let [with, without, wrong] = [FOLDS, 0.0, -FOLDS].map(error);
    assert!(with < 0.8 * without && wrong > 1.1 * without, "{with} {without} {wrong}");
}

/// A floor from −4 to 4, of some squares along each side, and a box that hovers over its middle.
fn covered(quads: u32) -> Mesh {
    let size = 8.0 / quads as f32;
    let floor = shapes::translated(&shapes::scaled(&shapes::sheet(quads), size), [-4.0, -4.0, 0.0]);
    Mesh::concat(&[floor, shapes::cuboid([-2.0, -2.0, 1.0], [2.0, 2.0, 3.0])]).unwrap()
}

#[test]
fn fit_lowers_the_mean_error_of_a_floor_under_a_box_and_the_worst_face_is_the_floor() {
    // A corner of the finer floor is under the box, so that points know more of it.
    for (quads, factor) in [(1, 0.65), (2, 0.85)] {
        let mesh = covered(quads);
        let receivers = Receivers::of(&[&mesh], Per::Corner);
        let oracle = Oracle::build(&mesh);
        let options = RayOptions { effort: Effort::Rays(64), ring: Ring::Off, ..RayOptions::default() };
        let mut ask = |of: &Receivers| Ambient::by_rays(&oracle, of, &options, &|_| {}).0.openness;
        let known = ask(&receivers);
        let fit = receivers.fit(&known, 150, &mut ask);
        let [before, after] = [&known, &fit].map(|of| receivers.inside_error(of, 200, &mut ask).unwrap());
        assert!(after.mean < factor * before.mean, "{before:?} {after:?}");
        assert!(before.face.0 < 2 * quads * quads && before.error > 0.15, "{before:?}");
        assert!(fit.iter().all(|open| (0.0..=1.0).contains(open)));
    }
}

#[test]
fn error_is_measured_inside_and_named_by_its_face() {
    // Dark around one point inside face 5 only: no corner knows.
    let mesh = shapes::sheet(4);
    let receivers = Receivers::of(&[&mesh], Per::Vertex);
    let open = vec![1.0; receivers.list().len()];
    let dark = |inside: &Receivers| -> Vec<f32> {
        inside
            .list()
            .iter()
            .map(|receiver| if receiver.face == Some(FaceId(5)) { 0.25 } else { 1.0 })
            .collect()
    };
    let found = receivers.inside_error(&open, 32 * 9, &mut |inside| dark(inside)).unwrap();
    assert_eq!((found.face, found.error, found.samples), (FaceId(5), 0.75, 32 * 9));
    assert!((found.mean - 0.75 / 32.0).abs() < 1e-12);
    assert_eq!(Receivers::default().inside_error(&[], 9, &mut |_| vec![]), None);
}

#[test]
fn faces_without_area_and_extreme_sizes_do_no_harm() {
    let thin = Mesh::new(vec![[0.0; 3], [1.0, 0.0, 0.0], [3.0, 0.0, 0.0]], vec![[0, 1, 2]]).unwrap();
    let largest = f32::MAX / 4.0;
    let smallest = f32::from_bits(1);
    for mesh in [
        thin,
        shapes::cuboid([-largest; 3], [largest; 3]),
        shapes::cuboid([0.0; 3], [smallest; 3]),
        shapes::double_sheet(),
        shapes::book(5),
    ] {
        let receivers = Receivers::of(&[&mesh], Per::Corner);
        let known = vec![0.5; receivers.list().len()];
        let fit = receivers.fit(&known, 100, &mut |inside| vec![0.5; inside.list().len()]);
        assert!(most_apart(&fit, &known) < 1e-6, "{}", mesh.name);
    }
}
