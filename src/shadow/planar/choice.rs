//! The choice of the plane that receives the shadow.

use std::collections::BTreeMap;

use glam::DVec3;

use super::Plane;
use super::options::Ground;
use crate::geom::Light;
use crate::oracle::PrimaryHit;
use crate::shadow::{Samples, is_front_lit};

/// Planes that are counted: those that look largest by their rounded numbers.
const COUNTED: usize = 16;
/// Steps of the rounded numbers per unit. Faces of one plane are one or a few steps apart.
const STEPS: f64 = (1_u64 << 16) as f64;

impl Ground {
    /// The plane, if there is one: without samples that face the light there is none with most of them.
    pub(crate) fn plane(self, samples: &Samples, light: &Light) -> Option<Plane> {
        match self {
            Self::Given(given) => Some(given.plane()),
            Self::Most => most(samples, light),
        }
    }
}

impl Plane {
    /// The middle of the samples that are on the plane and face the light; the plane's origin if there are
    /// none.
    pub(super) fn middle(&self, samples: &Samples, light: &Light) -> [f32; 3] {
        let on_plane = samples.hits().iter().flatten();
        let on_plane = on_plane.filter(|hit| is_front_lit(hit, light) && self.holds(hit.corners));
        let (sum, count) = on_plane.fold((DVec3::ZERO, 0.0), |(sum, count), hit| {
            (sum + DVec3::from(hit.point.map(f64::from)), count + 1.0)
        });
        let middle = if count > 0.0 { sum / count } else { self.origin };
        middle.clamp(DVec3::splat(f32::MIN.into()), DVec3::splat(f32::MAX.into())).as_vec3().into()
    }
}

/// A face with the number of its samples.
type Counted<'a> = (&'a PrimaryHit, usize);

/// The plane of most samples. Of planes with equally many, that of the face with most samples; of such faces,
/// the one with the lowest number.
fn most(samples: &Samples, light: &Light) -> Option<Plane> {
    let faces = faces(samples, light);
    let size =
        faces.iter().flat_map(|(hit, _)| hit.corners).flatten().fold(0.0_f32, |most, x| most.max(x.abs()));
    let mut cells: BTreeMap<[i64; 4], (usize, Counted<'_>)> = BTreeMap::new();
    for &(hit, count) in &faces {
        let Some(plane) = Plane::of_face(hit.corners) else { continue };
        let (all, largest) = cells.entry(rounded(&plane, size.into())).or_insert((0, (hit, 0)));
        *all += count;
        if count > largest.1 {
            *largest = (hit, count);
        }
    }
    let mut cells: Vec<(usize, Counted<'_>)> = cells.into_values().collect();
    let rank = |&(all, (hit, count)): &(usize, Counted<'_>)| (all, count, std::cmp::Reverse(hit.face));
    cells.sort_by_key(|cell| std::cmp::Reverse(rank(cell)));
    let counted = cells.into_iter().take(COUNTED).filter_map(|(_, (hit, own))| {
        let plane = Plane::of_face(hit.corners)?;
        let on_plane = faces.iter().filter(|(other, _)| plane.holds(other.corners));
        Some((rank(&(on_plane.map(|(_, count)| count).sum(), (hit, own))), plane))
    });
    counted.max_by_key(|&(rank, _)| rank).map(|(_, plane)| plane)
}

/// The faces that have samples which face the light, in ascending order.
fn faces<'a>(samples: &'a Samples, light: &Light) -> Vec<Counted<'a>> {
    let mut hits: Vec<&PrimaryHit> =
        samples.hits().iter().flatten().filter(|hit| is_front_lit(hit, light)).collect();
    hits.sort_unstable_by_key(|hit| hit.face);
    hits.chunk_by(|a, b| a.face == b.face).map(|run| (run[0], run.len())).collect()
}

/// The numbers of a plane in steps: a key that most faces of one plane share.
fn rounded(plane: &Plane, size: f64) -> [i64; 4] {
    let axis = plane.axes().iter().fold(3, |rest, axis| rest - axis);
    let normal = plane.normal * plane.normal[axis].signum();
    let offset = normal.dot(plane.origin) / size.max(f64::MIN_POSITIVE);
    [normal.x, normal.y, normal.z, offset].map(|x| (x * STEPS).round() as i64)
}
