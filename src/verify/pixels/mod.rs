//! Comparison of a stencil pass with the exact oracle, pixel by pixel.
//!
//! For each pixel the visible point comes from a ray through the pixel's center, not from a depth buffer. The
//! ray begins at the eye: a surface that a near plane cuts away is a mismatch, unless the plane was asked
//! for. The casting faces between this point and the light are counted in coordinates relative to the eye, so
//! that it does not matter how far from the origin they are. A stencil count that differs is either explained
//! or real.

mod counts;
mod footprint;
#[cfg(all(feature = "gpu", any(test, feature = "verify")))]
mod planar;
mod ray_point;

pub use counts::PixelCounts;
#[cfg(all(feature = "gpu", any(test, feature = "verify")))]
pub(crate) use planar::Footprint as PlanarFootprint;

use crate::caster::Caster;
use crate::geom::bvh::Bvh;
use crate::geom::predicate::{Homogeneous, Rounded};
use crate::geom::{Aabb, Light};
use crate::mesh::FaceId;
use crate::oracle::{Oracle, PrimaryHit};
use crate::parallel;
use crate::shadow::stencil::{Counting, ShadowMask};
use crate::silhouette::{Silhouette, SilhouetteEdge};
use crate::view::{Projection, Rays, Size};

/// Outcome of the comparison at one pixel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[repr(u8)]
pub enum PixelVerdict {
    /// Neither the oracle nor the stencil pass sees a surface there.
    #[default]
    Sky,
    /// Both count 0.
    Lit,
    /// Both count the same number, not 0.
    Shadowed,
    /// The counts differ, and the exact count changes within the pixel's footprint.
    Grazing,
    /// The counts differ, and a face whose side was left to `f32` lies between the point and the light.
    Unsure,
    /// The counts differ by a multiple of 256: the stencil buffer has wrapped.
    Overflow,
    /// The counts differ, and nothing explains the difference.
    Real,
}

impl PixelVerdict {
    /// All verdicts, from harmless to real.
    pub const ALL: [Self; 7] =
        [Self::Sky, Self::Lit, Self::Shadowed, Self::Grazing, Self::Unsure, Self::Overflow, Self::Real];

    /// Lower-case name, as printed in reports.
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
    /// Column, from the left.
    pub x: u32,
    /// Row, from the top.
    pub y: u32,
    /// The point that the oracle sees there; `None` for sky.
    pub point: Option<[f32; 3]>,
    /// Number of casting faces between this point and the light; `None` for sky.
    pub exact: Option<u32>,
    /// The stencil count; `None` for sky.
    pub counted: Option<i32>,
    /// Whether the point lies before the near plane, which has cut it away.
    pub cut: bool,
}

/// Verdicts for all pixels of a picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Comparison {
    /// Width and height of the picture.
    pub size: Size,
    /// One verdict per pixel, row by row from the top.
    pub verdicts: Vec<PixelVerdict>,
    /// The first real mismatches, in reading order.
    pub mismatches: Vec<Mismatch>,
}

impl Comparison {
    /// Number of pixels with this verdict.
    #[must_use]
    pub fn count(&self, verdict: PixelVerdict) -> usize {
        self.verdicts.iter().filter(|&&v| v == verdict).count()
    }

    /// Whether every pixel agrees or is explained by its footprint. A volume with exact signs and a count
    /// that cannot overflow must reach this.
    #[must_use]
    pub fn agrees(&self) -> bool {
        self.verdicts.iter().all(|&verdict| verdict < PixelVerdict::Unsure)
    }
}

/// Input of [`compare`]: what was rendered.
#[derive(Clone, Copy, Debug)]
pub struct Rendered<'a> {
    /// The mesh that casts.
    pub caster: &'a Caster,
    /// All that is seen: the caster's faces, and then those that only receive. `None` if there are none such.
    pub seen: Option<&'a Caster>,
    /// The exact sign with which each face casts: one entry per face.
    pub signs: &'a [i8],
    /// The light.
    pub light: &'a Light,
    /// The projection, with the same bits as in the shaders.
    pub projection: &'a Projection,
    /// The distance from which on surfaces were to be seen: that of a near plane that was asked for, else 0.
    /// With a near plane beyond it, a surface that the plane cuts away is a real mismatch, whatever was
    /// counted behind the surface.
    pub seen_from: f32,
    /// The counts of the stencil pass.
    pub mask: &'a ShadowMask,
    /// Faces that cast with another sign than in `signs`, because `f32` had to decide; ascending. Empty for
    /// volumes with exact signs.
    pub unsure: &'a [FaceId],
}

/// Real mismatches per row after which the search for explanations is limited to the nearest positions.
const THOROUGH: usize = 16;

/// Compares every pixel of `rendered` with the exact ray cast, and keeps the first `keep` real mismatches
/// with their positions. With the feature `parallel`, rows are shared among threads.
///
/// `progress` is called with the number of rows done, from any thread. Cost: about 4 µs per pixel and thread
/// for a mesh of 10⁵ faces.
///
/// # Panics
///
/// Panics if `signs` does not have one entry per face of the mesh.
///
/// ```
/// use umbrage::caster::{Caster, CasterGroup};
/// use umbrage::facing::CasterFaces;
/// use umbrage::geom::Light;
/// use umbrage::shadow::Samples;
/// use umbrage::shadow::stencil::{Counting, ShadowMask};
/// use umbrage::testing::shapes;
/// use umbrage::verify::pixels::{PixelVerdict, Rendered, compare};
/// use umbrage::view::{Projection, ProjectionKind, Size};
///
/// let (right, up, forward) = ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]);
/// let (eye, kind) = ([0.0, 0.0, 5.0], ProjectionKind::default());
/// let projection = &Projection { eye, right, up, forward, near: 0.1, kind };
/// let size = Size::new(32, 32)?;
/// let caster = &Caster::new(shapes::cube());
/// let samples = Samples::of_view(&CasterGroup::new(vec![caster]), projection, size, 1)?;
/// // The mask of a renderer that draws no shadows at all.
/// let receiver = samples.hits().iter().map(Option::is_some).collect();
/// let mask = &ShadowMask::new(size, Counting::Integer, vec![0; size.pixels()], receiver);
///
/// // There is no shadow to draw if the light is on the eye's side of the cube. Otherwise there is.
/// for (z, agrees) in [(9.0, true), (-9.0, false)] {
///     let light = &Light::point([0.0, 0.0, z])?;
///     let signs = &CasterFaces::All.signs(&caster.facing(light));
///     let (seen, seen_from) = (None, 0.0);
///     let rendered = Rendered { caster, seen, signs, light, projection, seen_from, mask, unsure: &[] };
///     let comparison = compare(&rendered, 1, &|_| {});
///     assert_eq!(comparison.agrees(), agrees);
///     assert_eq!(comparison.count(PixelVerdict::Real) == 0, agrees);
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[must_use]
pub fn compare(rendered: &Rendered<'_>, keep: usize, progress: &(dyn Fn(u64) + Sync)) -> Comparison {
    assert_eq!(rendered.signs.len(), rendered.caster.mesh().face_count(), "one sign a face");
    let Rendered { caster, projection, light, mask, .. } = *rendered;
    let (mesh, topology, size) = (caster.mesh(), caster.topology(), mask.size());
    let silhouette = Silhouette::extract(topology, rendered.signs);
    let ends = |edge: &SilhouetteEdge| topology.vertices(edge.edge);
    let edges = silhouette.edges.iter().map(|edge| ends(edge).map(|v| mesh.positions()[v.index()]));
    let edges: Vec<[[f32; 3]; 2]> = edges.collect();
    let boxes: Vec<Aabb> = edges.iter().map(|ends| Aabb::around(*ends)).collect();
    let edge_tree = Bvh::build(&boxes);
    let pixels = Pixels {
        oracle: caster.oracle(),
        seen: rendered.seen.unwrap_or(caster).oracle(),
        rendered,
        rays: Rays::new(projection, size),
        step: footprint::step(projection, size),
        light: Rounded::seen_from(projection.eye, Homogeneous::light(light)),
        edges,
        edge_tree,
    };
    let mut verdicts = vec![PixelVerdict::Sky; size.pixels()];
    parallel::rows(&mut verdicts, size.width() as usize, |y, row| {
        // In a row full of unexplained mismatches, further ones are not worth a long search each.
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

/// The first surface along a ray, with its exact count.
#[derive(Clone, Copy, Debug)]
struct Seen {
    visible: PrimaryHit,
    /// The direction of the ray.
    direction: [f32; 3],
    /// Casting faces that the segment to the light properly crosses.
    count: u32,
    /// Whether the segment touches casting faces without crossing them; then the count may be higher.
    touching: bool,
}

impl Seen {
    /// Whether the two samples may legitimately have different counts.
    fn differs(&self, there: &Self) -> bool {
        self.count != there.count || there.touching
    }
}

struct Pixels<'a> {
    /// Of what casts.
    oracle: &'a Oracle,
    /// Of what is seen.
    seen: &'a Oracle,
    rendered: &'a Rendered<'a>,
    rays: Rays,
    /// How far sideways the footprint of a pixel reaches, in pixels.
    step: f64,
    /// The light as seen from the eye.
    light: Rounded,
    /// The end points of the silhouette edges.
    edges: Vec<[[f32; 3]; 2]>,
    /// Bounding volume hierarchy over the boxes of the silhouette edges.
    edge_tree: Bvh,
}

impl Pixels<'_> {
    /// Compares one pixel. A `thorough` search leaves no explanation out; otherwise only the nearest
    /// positions are searched.
    fn judge(&self, x: u32, y: u32, thorough: bool) -> PixelVerdict {
        let counted = self.rendered.mask.count(x, y);
        let middle = [f64::from(x) + 0.5, f64::from(y) + 0.5];
        let seen = self.look(middle);
        if seen.is_some_and(|seen| self.is_cut(&seen)) {
            return PixelVerdict::Real;
        }
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
                if seen.touching || self.changes_along_the_ray(&seen) {
                    return PixelVerdict::Grazing;
                }
                if self.meets_unsure(&seen) {
                    return PixelVerdict::Unsure;
                }
            }
            // Only the coverage differs, so only an outline explains the difference.
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
            cut: seen.is_some_and(|seen| self.is_cut(&seen)),
        }
    }

    /// The surface and exact count seen through `place`, in pixels from the upper left corner.
    fn look(&self, place: [f64; 2]) -> Option<Seen> {
        let ray = self.rays.ray(place[0], place[1]);
        let nearest = self.rendered.seen_from.into();
        let visible = self.seen.first_visible_beyond(ray.origin, ray.direction, nearest)?;
        let (count, touching) = self.count(&visible, ray.direction);
        Some(Seen { visible, direction: ray.direction, count, touching })
    }

    /// Whether the near plane has cut away what is seen.
    fn is_cut(&self, seen: &Seen) -> bool {
        seen.visible.t < self.rendered.projection.near.into()
    }
}
