//! The ray cast against a loop over all faces, and against big integers.

use num_bigint::BigInt;
use umbrage::geom::{Facing, Light};
use umbrage::mesh::{FaceId, Mesh};
use umbrage::oracle::{Crossings, Hit, Intersection, Oracle, intersect};
use umbrage::testing::generate::{Bytes, light, mesh, point, position};
use umbrage::verify::reference;

use super::whole;

pub(crate) fn run(data: &[u8]) {
    let bytes = &mut Bytes::new(data);
    let mesh = mesh(bytes);
    let oracle = Oracle::build(&mesh);
    for _ in 0..4 {
        let light = light(bytes, &mesh);
        let p = point(bytes, &mesh, &light);
        judge(&mesh, &oracle, p, &light);
        judge_hit(&mesh, &oracle, p, position(bytes));
        if bytes.is_empty() {
            break;
        }
    }
}

/// Panics unless `oracle` finds between `p` and `light` what a loop over all faces and big integers find.
pub(crate) fn judge(mesh: &Mesh, oracle: &Oracle, p: [f32; 3], light: &Light) {
    let mut looped = Crossings::default();
    for face in (0..mesh.face_count()).map(FaceId::new) {
        match intersect(p, light, mesh.corners(face)) {
            Intersection::None => {}
            Intersection::Touching => looped.touching += 1,
            Intersection::Crossing(Facing::Front) => looped.front += 1,
            Intersection::Crossing(_) => looped.back += 1,
        }
    }
    let crossings = oracle.crossings(p, light);
    assert_eq!(crossings, looped, "tree and loop, {p:?} to {light}");
    assert_eq!(
        crossings,
        reference(mesh, p, light).crossings,
        "predicates and big integers, {p:?} to {light}"
    );
    assert_eq!(oracle.verdict(p, light), crossings.verdict());
}

/// Panics unless the first face along a ray passes through it, no other one is surely nearer, and the visible
/// point is on the eye's side.
fn judge_hit(mesh: &Mesh, oracle: &Oracle, eye: [f32; 3], direction: [f32; 3]) {
    let found = oracle.first_hit(eye, direction);
    let Ok(back) = Light::directional(direction.map(|x| -x)) else {
        return assert_eq!(found, None, "along no direction");
    };
    let passed: Vec<(FaceId, (BigInt, BigInt))> = (0..mesh.face_count())
        .map(FaceId::new)
        .filter(|&face| match intersect(eye, &back, mesh.corners(face)) {
            Intersection::None => false,
            Intersection::Crossing(_) => true,
            Intersection::Touching => whole::side_of_point(mesh.corners(face), eye) != 0,
        })
        .map(|face| (face, whole::distance(mesh.corners(face), eye, direction)))
        .collect();
    let Some(Hit { face, t }) = found else {
        return assert!(passed.is_empty(), "{passed:?} are passed");
    };
    let (_, (n, d)) = passed.iter().find(|(other, _)| *other == face).expect("the hit face is passed");
    // Nearer by more than 2⁻³⁶ of itself.
    let nearer = passed.iter().find(|(_, (m, e))| ((m * d) << 36) + (n * e) < (n * e) << 36);
    assert_eq!(nearer, None, "nearer than {face:?}");
    assert!(t.is_finite() && t >= 0.0, "{t}");
    let visible = oracle.first_visible(eye, direction).expect("a hit is visible");
    assert_eq!((visible.face, visible.t), (face, t));
    let sides = [eye, visible.point].map(|p| whole::side_of_point(mesh.corners(face), p));
    assert!(
        sides[0] == sides[1] && sides[0] != 0,
        "the visible point {:?} is on the eye's side",
        visible.point
    );
}
