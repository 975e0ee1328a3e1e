//! The stencil pass against the exact oracle, pixel by pixel: the last word.
//!
//! For each pixel the visible point comes from a ray through the pixel's middle, not from a depth buffer, and the
//! casting faces between it and the light are counted exactly. A stencil count that differs is then explained, or
//! real.

mod counts;
mod footprint;
mod recenter;

use glam::{DVec2, DVec3};

pub use counts::PixelCounts;
use footprint::step;
use recenter::Recentered;

use crate::caster::Caster;
use crate::geom::bvh::Bvh;
use crate::geom::{Aabb, Light};
use crate::mesh::{FaceId, Mesh};
use crate::oracle::{Intersection, Oracle, PrimaryHit};
use crate::parallel;
use crate::shadow::stencil::{Counting, ShadowMask};
use crate::silhouette::{Silhouette, SilhouetteEdge};
use crate::view::Projection;
use crate::view::Size;

/// What is said of one pixel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[repr(u8)]
pub enum PixelVerdict {
    /// Neither sees anything there.
    #[default]
    Sky,
    /// Both count 0.
    Lit,
    /// Both count the same, not 0.
    Shadowed,
    /// They differ, and the exact count changes within the pixel's footprint.
    Grazing,
    /// They differ, and a face whose side was left to `f32` is between the point and the light.
    Unsure,
    /// They differ by a multiple of 256: the stencil has wrapped.
    Overflow,
    /// They differ, and nothing explains it.
    Real,
}

impl PixelVerdict {
    /// All of them.
    pub const ALL: [Self; 7] =
        [Self::Sky, Self::Lit, Self::Shadowed, Self::Grazing, Self::Unsure, Self::Overflow, Self::Real];

    /// Lower-case name, as in reports.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Sky => "sky",
            Self::Lit => "lit",
            Self::Shadowed => "shadowed",
            Self::Grazing => "grazing",
            Self::Unsure => "unsure",
            Self::Overflow => "overflow",
            Self::Real => "real",
        }
    }
}

/// A pixel whose stencil count nothing explains.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mismatch {
    /// From the left.
    pub x: u32,
    /// From the top.
    pub y: u32,
    /// What the oracle sees there.
    pub point: Option<[f32; 3]>,
    /// How many casting faces are between that point and the light.
    pub exact: Option<u32>,
    /// What the stencil counted; `None` for sky.
    pub counted: Option<i32>,
}

/// All pixels of a picture, judged.
#[derive(Clone, Debug, PartialEq)]
pub struct Comparison {
    /// How many pixels there are.
    pub size: Size,
    /// Row after row from the top.
    pub verdicts: Vec<PixelVerdict>,
    /// The first few pixels that nothing explains, in reading order.
    pub mismatches: Vec<Mismatch>,
}

impl Comparison {
    /// How many pixels got this verdict.
    #[must_use]
    pub fn count(&self, verdict: PixelVerdict) -> usize {
        self.verdicts.iter().filter(|&&v| v == verdict).count()
    }

    /// Whether every pixel agrees or is explained by its footprint: what a volume with exact signs and a count
    /// that cannot overflow must reach.
    #[must_use]
    pub fn agrees(&self) -> bool {
        self.verdicts.iter().all(|&verdict| verdict < PixelVerdict::Unsure)
    }
}

/// What was rendered, for [`compare`].
#[derive(Clone, Copy, Debug)]
pub struct Rendered<'a> {
    /// What casts and receives.
    pub caster: &'a Caster,
    /// The sign that each face casts with, exact: one entry a face.
    pub signs: &'a [i8],
    /// The light.
    pub light: &'a Light,
    /// The camera, as the shaders have it.
    pub projection: &'a Projection,
    /// What the stencil pass made of it.
    pub mask: &'a ShadowMask,
    /// Faces that cast with another sign than `signs` says, since `f32` had to decide; ascending. Empty for volumes
    /// with exact signs.
    pub unsure: &'a [FaceId],
}

/// Judges every pixel of `rendered` by the exact ray cast, and keeps the places of the first `keep` real
/// mismatches. With the feature `parallel`, rows are shared among threads.
///
/// `progress` hears of rows done, from any thread. About 4 µs a pixel and thread for a mesh of 10⁵ faces.
///
/// # Panics
///
/// Panics if `signs` has another length than the faces of the mesh.
#[must_use]
pub fn compare(rendered: &Rendered<'_>, keep: usize, progress: &(dyn Fn(u64) + Sync)) -> Comparison {
    assert_eq!(rendered.signs.len(), rendered.caster.mesh().face_count(), "one sign a face");
    match Recentered::of(rendered.caster.mesh(), rendered.light, rendered.projection) {
        None => judge_all(rendered.caster.mesh(), rendered.caster.oracle(), rendered, keep, progress),
        Some(Recentered { mesh, light, projection, origin }) => {
            let moved = Rendered { light: &light, projection: &projection, ..*rendered };
            let mut comparison = judge_all(&mesh, &Oracle::build(&mesh), &moved, keep, progress);
            for point in comparison.mismatches.iter_mut().filter_map(|mismatch| mismatch.point.as_mut()) {
                *point = [0, 1, 2].map(|i| point[i] + origin[i]);
            }
            comparison
        }
    }
}

/// So many pixels of a row may be called real before the search for explanations stops at the nearest places.
const THOROUGH: usize = 16;

fn judge_all(
    mesh: &Mesh,
    oracle: &Oracle,
    rendered: &Rendered<'_>,
    keep: usize,
    progress: &(dyn Fn(u64) + Sync),
) -> Comparison {
    let size = rendered.mask.size();
    let topology = rendered.caster.topology();
    let silhouette = Silhouette::extract(topology, rendered.signs);
    let ends = |edge: &SilhouetteEdge| topology.vertices(edge.edge);
    let edges = silhouette.edges.iter().map(|edge| ends(edge).map(|v| mesh.positions()[v.index()]));
    let edges: Vec<[[f32; 3]; 2]> = edges.collect();
    let boxes: Vec<Aabb> = edges.iter().map(|ends| Aabb::around(*ends)).collect();
    let edge_tree = Bvh::build(&boxes);
    let pixels = Pixels { oracle, rendered, size, step: step(rendered.projection, size), edges, edge_tree };
    let mut verdicts = vec![PixelVerdict::Sky; size.pixels()];
    parallel::rows(&mut verdicts, size.width() as usize, |y, row| {
        // Where a row is full of mismatches that nothing explains, more of them are not worth a long search each.
        let mut real = 0;
        for (x, verdict) in (0..).zip(row) {
            *verdict = pixels.judge(x, y as u32, real < THOROUGH); // a picture has at most 2¹⁴ rows
            real += usize::from(*verdict == PixelVerdict::Real);
        }
        progress(1);
    });
    let real = (0..).zip(&verdicts).filter(|(_, verdict)| **verdict == PixelVerdict::Real);
    let mismatches = real
        .take(keep)
        .map(|(place, _): (u32, _)| pixels.mismatch(place % size.width(), place / size.width()))
        .collect();
    Comparison { size, verdicts, mismatches }
}

/// What the oracle finds along one ray.
#[derive(Clone, Copy, Debug)]
struct Seen {
    visible: PrimaryHit,
    /// Casting faces that are properly crossed on the way to the light.
    count: u32,
    /// Whether casting faces are only touched: then the count may be more.
    touching: bool,
}

impl Seen {
    /// Whether a count of one must not be held against the other.
    fn differs(&self, there: &Self) -> bool {
        self.count != there.count || there.touching
    }
}

struct Pixels<'a> {
    oracle: &'a Oracle,
    rendered: &'a Rendered<'a>,
    size: Size,
    /// How far sideways the footprint of a pixel reaches, in pixels.
    step: f64,
    /// The ends of the silhouette edges.
    edges: Vec<[[f32; 3]; 2]>,
    /// Over their boxes.
    edge_tree: Bvh,
}

impl Pixels<'_> {
    /// A `thorough` search leaves no explanation out; else only the nearest places are looked at.
    fn judge(&self, x: u32, y: u32, thorough: bool) -> PixelVerdict {
        let counted = self.rendered.mask.count(x, y);
        let middle = [f64::from(x) + 0.5, f64::from(y) + 0.5];
        let seen = self.look(middle);
        match (seen, counted) {
            (None, None) => return PixelVerdict::Sky,
            (Some(seen), Some(counted)) if i64::from(seen.count) == i64::from(counted) => {
                return if counted == 0 { PixelVerdict::Lit } else { PixelVerdict::Shadowed };
            }
            (Some(seen), Some(counted)) => {
                let stencil = self.rendered.mask.counting() == Counting::Stencil;
                if stencil && seen.count > 255 && seen.count & 255 == counted as u32 & 255 {
                    return PixelVerdict::Overflow;
                }
                if seen.touching || self.changes_along_the_ray(&seen, middle) {
                    return PixelVerdict::Grazing;
                }
                if self.meets_unsure(&seen) {
                    return PixelVerdict::Unsure;
                }
            }
            // Coverage alone differs, so only an outline explains it.
            (seen, _) => {
                let outline = self.is_at_outline(seen.is_some(), middle);
                return if outline { PixelVerdict::Grazing } else { PixelVerdict::Real };
            }
        }
        let explained = seen.is_some_and(|seen| self.changes_sideways(&seen, middle, thorough));
        if explained { PixelVerdict::Grazing } else { PixelVerdict::Real }
    }

    fn mismatch(&self, x: u32, y: u32) -> Mismatch {
        let seen = self.look([f64::from(x) + 0.5, f64::from(y) + 0.5]);
        Mismatch {
            x,
            y,
            point: seen.map(|seen| seen.visible.point),
            exact: seen.map(|seen| seen.count),
            counted: self.rendered.mask.count(x, y),
        }
    }

    /// What is seen through a place of the picture, in pixels from the upper left corner.
    fn look(&self, place: [f64; 2]) -> Option<Seen> {
        let projection = self.rendered.projection;
        let direction = self.ray(place).as_vec3().into();
        let visible = self.oracle.first_visible_beyond(projection.eye, direction, projection.near.into())?;
        let (count, touching) = self.count(visible.point);
        Some(Seen { visible, count, touching })
    }

    fn ray(&self, [x, y]: [f64; 2]) -> DVec3 {
        let (width, height) = (f64::from(self.size.width()), f64::from(self.size.height()));
        self.rendered.projection.ray(DVec2::new(2.0 * x / width - 1.0, 1.0 - 2.0 * y / height))
    }

    /// How many casting faces are between a point and the light, and whether any is only touched.
    fn count(&self, point: [f32; 3]) -> (u32, bool) {
        let (mut count, mut touching) = (0, false);
        self.oracle.for_each_meeting(point, self.rendered.light, |face, meeting| match meeting {
            _ if self.rendered.signs[face.index()] == 0 => {}
            Intersection::Crossing(_) => count += 1,
            _ => touching = true,
        });
        (count, touching)
    }

    fn meets_unsure(&self, seen: &Seen) -> bool {
        let unsure = self.rendered.unsure;
        let mut met = unsure.binary_search(&seen.visible.face).is_ok();
        self.oracle.for_each_meeting(seen.visible.point, self.rendered.light, |face, _| {
            met |= unsure.binary_search(&face).is_ok();
        });
        met
    }
}
