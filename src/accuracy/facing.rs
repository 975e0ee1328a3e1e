//! Methods that decide which side of a face a light is on.

use std::ops::{Add, Mul, Sub};

use super::compare::{Ask, Contender, Stratum, compare, prepared};
use super::lights::STRATA;
use super::{Accuracy, Options, lights};
use crate::facing::{FacePlanes, facing_of};
use crate::geom::{Facing, Light, predicate};
use crate::mesh::{FaceId, Mesh};
use crate::verify::{WholeLight, WholePlane};

pub(super) fn measure(mesh: &Mesh, given: &[Light], options: &Options, progress: &dyn Fn(u64)) -> Accuracy {
    let lights = lights::draw(mesh, given, options);
    let strata = truth(mesh, &lights);
    progress(STRATA.len() as u64);
    let (planes, prepare_ns) = prepared(mesh.face_count(), || FacePlanes::new(mesh));
    let mut contenders = contenders(mesh, &lights, &planes, prepare_ns);
    let methods = compare(&strata, &mut contenders, options.rounds, progress);
    Accuracy { methods, judged_by_all_faces: None }
}

/// All methods, plain `f32` first.
pub(super) fn contenders<'a>(
    mesh: &'a Mesh,
    lights: &'a [Vec<Light>],
    planes: &'a FacePlanes,
    prepare_ns: f64,
) -> Vec<Contender<'a, Facing>> {
    let exact = |name, prepare_ns, ask| Contender { name, exact: true, prepare_ns, every: 1, ask };
    let plain = |name, ask| Contender { name, exact: false, prepare_ns: None, every: 1, ask };
    vec![
        plain("plain f32", by_cross_product::<f32>(mesh, lights)),
        plain("plain f64", by_cross_product::<f64>(mesh, lights)),
        exact(
            "filtered planes",
            Some(prepare_ns),
            Box::new(move |stratum, batch, out| {
                planes.classify_into(mesh, &lights[stratum][batch], out);
            }),
        ),
        exact("filtered predicate", None, each_face(mesh, lights, facing_of)),
        exact(
            "always exact",
            None,
            each_face(mesh, lights, |mesh, face, light| {
                Facing::of(predicate::side_of_light_unfiltered(mesh.corners(face), light))
            }),
        ),
    ]
}

fn each_face<'a>(
    mesh: &'a Mesh,
    lights: &'a [Vec<Light>],
    side: impl Fn(&Mesh, FaceId, &Light) -> Facing + 'a,
) -> Ask<'a, Facing> {
    Box::new(move |stratum, batch, out| {
        let light = &lights[stratum][batch];
        out.clear();
        out.extend((0..mesh.face_count()).map(|face| side(mesh, FaceId::new(face), light)));
    })
}

/// The usual method: a cross product of two edges, dotted with the vector from their common corner to the
/// light.
fn by_cross_product<'a, T: Number>(mesh: &'a Mesh, lights: &'a [Vec<Light>]) -> Ask<'a, Facing> {
    Box::new(move |stratum, batch, out| {
        let light = lights[stratum][batch].homogeneous().map(T::from);
        let (positions, zero) = (mesh.positions(), T::from(0.0));
        out.clear();
        out.extend(mesh.triangles().iter().map(|&[a, b, c]| {
            let [a, b, c] =
                [number(positions[a as usize]), number(positions[b as usize]), number(positions[c as usize])];
            // A table lookup: half of the branches would be mispredicted.
            [Facing::Back, Facing::Front][usize::from(height([a, b, c], light) > zero)]
        }));
    })
}

/// A floating-point type for the cross product.
trait Number:
    Copy + PartialOrd + From<f32> + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self>
{
}

impl Number for f32 {}
impl Number for f64 {}

/// Closures on arrays are not always inlined, and then dominate the time; so this function and its callers
/// list the elements.
#[inline(always)]
fn number<T: Number>(p: [f32; 3]) -> [T; 3] {
    [T::from(p[0]), T::from(p[1]), T::from(p[2])]
}

/// The height of a light over a face's plane, times twice the face's area.
#[inline(always)]
fn height<T: Number>([a, b, c]: [[T; 3]; 3], [x, y, z, w]: [T; 4]) -> T {
    let (u, v) = ([b[0] - a[0], b[1] - a[1], b[2] - a[2]], [c[0] - a[0], c[1] - a[1], c[2] - a[2]]);
    let n = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
    n[0] * (x - w * a[0]) + n[1] * (y - w * a[1]) + n[2] * (z - w * a[2])
}

/// The true side of every face, with big integers: one plane per face, evaluated for each light.
pub(super) fn truth(mesh: &Mesh, lights: &[Vec<Light>]) -> Vec<Stratum<Facing>> {
    let whole: Vec<Vec<WholeLight>> =
        lights.iter().map(|lights| lights.iter().map(WholeLight::from).collect()).collect();
    let faces = mesh.face_count();
    let empty = |((name, _), lights): (_, &Vec<Light>)| {
        let truth = lights.iter().map(|_| Vec::with_capacity(faces)).collect();
        Stratum { name, truth }
    };
    let mut strata: Vec<Stratum<Facing>> = STRATA.into_iter().zip(lights).map(empty).collect();
    for face in 0..faces {
        let plane = WholePlane::of(mesh.corners(FaceId::new(face)));
        for (stratum, lights) in strata.iter_mut().zip(&whole) {
            for (truth, light) in stratum.truth.iter_mut().zip(lights) {
                truth.push(plane.side(light));
            }
        }
    }
    strata
}
