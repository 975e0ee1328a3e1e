//! The shadow volumes of a frame loop: indices for one light after another, without a pass over all faces.

use std::ops::Range;

use super::cap::{self, CapFaces};
use super::cap_clusters::{CapClusters, FoundCap};
use super::extrude::{Sides, first_at_infinity, write_sides};
use super::{BufferTooSmall, Caps, ShellFaces, VolumeParts};
use crate::caster::Caster;
use crate::choice::Choice;
use crate::facing::CasterFaces;
use crate::geom::{Facing, Light};
use crate::silhouette::{SilhouetteFinder, SilhouetteMethod};

/// The shadow volumes of one caster for light after light, as indices into buffers that a renderer draws.
///
/// Chooses the casting faces per shell ([`ShellFaces`]), finds the silhouette ([`SilhouetteFinder`]), writes
/// the sides and the single triangles of the caps into the caller's buffer, and gives the rest of the caps as
/// ranges of an index buffer that never changes ([`FrameExtruder::static_triangles`], from
/// [`FaceClusters`](crate::facing::FaceClusters)). Together these are exactly the triangles that
/// [`Extruder::write_indices`](super::Extruder::write_indices) writes for the same light: a closed volume for
/// every mesh.
///
/// The vertices are the same for every light: vertex `v < n` of a mesh of `n` vertices is its position `p`,
/// with `w = 1`. Vertex `n + v` lies at infinity: `(p − L, 0)` for a point light at `L`. For a directional
/// light there is one, vertex `n`: the direction in which the light travels, with `w = 0`. A vertex shader
/// computes them from the positions.
///
/// Cost of a frame: when the light moves a little, one comparison per 512 faces and per shell, and what lies
/// near the silhouette. Every face is visited when the mesh has fewer than 256 faces or many edges without
/// two faces in opposite directions, and when many faces lie in a plane with the light or the silhouette runs
/// through most of the mesh; [`FrameExtruder::method`] then says [`SilhouetteMethod::Scan`], and why. Nothing
/// is allocated once all buffers have grown: the second frame builds what follows a moving light.
///
/// Memory: about 160 bytes per face besides the parts of the [`Caster`].
///
/// ```
/// use umbrage::caster::Caster;
/// use umbrage::geom::Light;
/// use umbrage::shadow::volume::{Caps, FrameExtruder};
///
/// # let (positions, triangles, ..) = umbrage::testing::shapes::icosphere(6).into_parts();
/// # let indices = triangles.concat();
/// // Vertex and index arrays of your own: `positions: Vec<[f32; 3]>`, `indices: Vec<u32>`.
/// let caster = Caster::from_indexed(&positions, &indices)?;
/// let mut extruder = FrameExtruder::new(&caster, None);
///
/// // Upload once: `caster.mesh().positions()`, and this index buffer.
/// let static_indices: &[u32] = extruder.static_triangles().as_flattened();
/// # assert_eq!(static_indices.len(), 2 * indices.len());
///
/// // Mapped memory of the renderer, say; grown where a frame asks for more.
/// let mut buffer = vec![[0; 3]; 1024];
/// for step in 0..5 {
///     let light = Light::point([3.0, 4.0, 5.0 + 0.001 * step as f32])?;
///     let frame = match extruder.write(&caster, &light, Caps::Both, &mut buffer) {
///         Ok(frame) => frame,
///         Err(small) => {
///             buffer.resize(2 * small.needed, [0; 3]);
///             extruder.write(&caster, &light, Caps::Both, &mut buffer)?
///         }
///     };
///     // One draw of what was written, and a draw per range of the static index buffer.
///     let written: &[u32] = buffer[..frame.written.triangle_count()].as_flattened();
///     # assert!(!written.is_empty());
///     for range in frame.light_cap {
///         // draw_indexed(3 * range.start..3 * range.end, base_vertex: 0)
///         # assert!(range.end as usize <= static_indices_len(&caster) / 3);
///     }
///     for range in frame.dark_cap() {
///         // draw_indexed(3 * range.start..3 * range.end, base_vertex: caster.mesh().vertex_count())
///         # assert!(range.end as usize <= static_indices_len(&caster) / 3);
///     }
///     assert!(frame.written.triangle_count() < caster.mesh().face_count() / 4);
/// }
/// # fn static_indices_len(caster: &Caster) -> usize { 6 * caster.mesh().face_count() }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct FrameExtruder {
    asked: Option<CasterFaces>,
    shortest_range: u32,
    finder: SilhouetteFinder,
    clusters: CapClusters,
    light: Option<Light>,
    faces: ShellFaces,
    method: Option<Choice<SilhouetteMethod>>,
    /// Where the caps of `light` are.
    caps: FoundCaps,
    cap: FoundCap,
    /// The sides and signs of all faces, where neither clusters nor the finder do without them.
    facing: Vec<Facing>,
    signs: Vec<i8>,
    /// Casting faces before each chunk of faces, where the caps are written face by face.
    starts: Vec<u32>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum FoundCaps {
    Not,
    /// In the cap found by clusters.
    Clustered,
    /// In the signs that the finder has.
    ScannedByFinder,
    /// In the signs that were computed here.
    Scanned,
}

/// The volume of one light, as [`FrameExtruder::write`] left it.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct FrameVolume<'a> {
    /// Parts of the volume in the buffer that was written.
    pub written: VolumeParts,
    /// The rest of the light cap: ranges of [`FrameExtruder::static_triangles`].
    pub light_cap: &'a [Range<u32>],
    /// Half the length of the static triangles.
    half: u32,
    directional: bool,
}

impl FrameVolume<'_> {
    /// The rest of the dark cap: ranges of [`FrameExtruder::static_triangles`], to be drawn with the number
    /// of vertices added to every index. Empty for a directional light.
    pub fn dark_cap(&self) -> impl Iterator<Item = Range<u32>> + '_ {
        let ranges = if self.directional { &[] } else { self.light_cap };
        // The same triangles in the other half, where they are reversed.
        ranges.iter().map(|range| {
            if range.start < self.half {
                range.start + self.half..range.end + self.half
            } else {
                range.start - self.half..range.end - self.half
            }
        })
    }

    /// How many triangles the volume has, written or in ranges.
    #[must_use]
    pub fn triangle_count(&self) -> usize {
        let in_ranges = |ranges: &[Range<u32>]| ranges.iter().map(|range| range.len()).sum::<usize>();
        let caps = if self.directional { 1 } else { 2 };
        self.written.triangle_count() + caps * in_ranges(self.light_cap)
    }
}

/// The least length of a range unless it is set: a draw is taken to cost about as much as writing these
/// triangles.
const SHORTEST_RANGE: u32 = 512;

impl FrameExtruder {
    /// Prepares for many lights: planes, silhouette tree and clusters, and without
    /// `asked` the proofs of the caster ([`Caster::proofs`]).
    ///
    /// `asked` are the faces that cast, proven or not; without these, half the faces of a shell cast where
    /// that is proven to be enough.
    #[must_use]
    pub fn new(caster: &Caster, asked: Option<CasterFaces>) -> Self {
        let finder = SilhouetteFinder::new(caster, usize::MAX);
        let clusters = if finder.has_tree() {
            CapClusters::new(caster, asked.is_none())
        } else {
            CapClusters::default()
        };
        Self {
            asked,
            shortest_range: SHORTEST_RANGE,
            finder,
            clusters,
            light: None,
            faces: ShellFaces::default(),
            method: None,
            caps: FoundCaps::Not,
            cap: FoundCap::default(),
            facing: Vec::new(),
            signs: Vec::new(),
            starts: Vec::new(),
        }
    }

    /// The same, with another least length of the ranges of caps; triangles of shorter ranges are written.
    /// 512 unless set. With `u32::MAX` everything
    /// is written, and one draw is enough.
    ///
    /// ```
    /// # use umbrage::{caster::Caster, shadow::volume::{Caps, FrameExtruder}, testing::shapes};
    /// let caster = Caster::new(shapes::icosphere(5));
    /// let mut extruder = FrameExtruder::new(&caster, None).with_shortest_range(u32::MAX);
    /// let mut buffer = vec![[0; 3]; 4 * caster.mesh().face_count()];
    /// let frame = extruder.write(&caster, &"point:3,4,5".parse()?, Caps::Both, &mut buffer)?;
    /// assert!(frame.light_cap.is_empty());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn with_shortest_range(self, triangles: u32) -> Self {
        Self { shortest_range: triangles, caps: FoundCaps::Not, ..self }
    }

    /// The index buffer that caps are ranges of: the faces that can cast in the order of their clusters, and
    /// once more in that order, each reversed. Empty where every frame visits all faces.
    #[must_use]
    pub fn static_triangles(&self) -> &[[u32; 3]] {
        self.clusters.triangles()
    }

    /// Which faces cast, per shell, for the last light.
    #[must_use]
    pub fn faces(&self) -> &ShellFaces {
        &self.faces
    }

    /// How the silhouette of the last light was found, and why; `None` before the first light.
    #[must_use]
    pub fn method(&self) -> Option<Choice<SilhouetteMethod>> {
        self.method
    }

    /// Writes the volume of a light: the light cap, the sides, the dark cap, as far as the caps are not
    /// ranges of [`FrameExtruder::static_triangles`].
    ///
    /// Every byte of what was written is written once, and none is read, as suits mapped memory. For the
    /// light of the last time nothing is computed again. After [`Caster::repose`], and for another caster,
    /// everything is built again first, static triangles included.
    ///
    /// # Errors
    ///
    /// If the buffer is too small: then nothing is written. `2·(faces + Σ|m|)` triangles are always enough,
    /// where m are the multiplicities of the silhouette.
    ///
    /// # Panics
    ///
    /// Panics if the mesh has more than 2³¹ vertices and the light is a point: then `n + v` does not fit in
    /// 32 bits.
    pub fn write(
        &mut self,
        caster: &Caster,
        light: &Light,
        caps: Caps,
        buffer: &mut [[u32; 3]],
    ) -> Result<FrameVolume<'_>, BufferTooSmall> {
        let directional = light.is_directional();
        let far = first_at_infinity(caster.mesh().vertex_count(), directional);
        self.find(caster, light, caps);
        let copies = self.finder.copies();
        let cap = match (caps, self.caps) {
            (Caps::None, _) => 0,
            (Caps::Both, FoundCaps::Clustered) => self.cap.single.len(),
            (Caps::Both, _) => self.starts.last().map_or(0, |&count| count as usize),
        };
        let sides = cap + if directional { copies } else { 2 * copies };
        let end = if directional { sides } else { sides + cap };
        let written = VolumeParts { light_cap: 0..cap, sides: cap..sides, dark_cap: sides..end };
        let room = buffer.len();
        let buffer = buffer.get_mut(..end).ok_or(BufferTooSmall { needed: end, room })?;
        let (light_cap, rest) = buffer.split_at_mut(cap);
        let (side, dark_cap) = rest.split_at_mut(sides - cap);
        if cap > 0 {
            self.write_caps(caster, far, light_cap, dark_cap);
        }
        let (mesh, topology, edges) = (caster.mesh(), caster.topology(), self.finder.edges());
        write_sides(Sides { mesh, topology, directional, edges }, |v| v, far, side);
        let in_ranges = caps == Caps::Both && self.caps == FoundCaps::Clustered;
        let light_cap = if in_ranges { &self.cap.ranges[..] } else { &[] };
        Ok(FrameVolume { written, light_cap, half: self.clusters.face_count(), directional })
    }

    /// Finds what is to be written for a light, unless that was done the last time.
    fn find(&mut self, caster: &Caster, light: &Light, caps: Caps) {
        if !self.finder.is_of(caster) {
            *self = Self::new(caster, self.asked).with_shortest_range(self.shortest_range);
        }
        if self.light != Some(*light) {
            caster.shell_faces_into(light, self.asked, &mut self.faces);
            self.method = Some(self.finder.find(caster, light, caster.rule(&self.faces)));
            self.light = Some(*light);
            self.caps = FoundCaps::Not;
        }
        if caps == Caps::Both && self.caps == FoundCaps::Not {
            self.caps = self.find_caps(caster, light);
        }
    }

    fn find_caps(&mut self, caster: &Caster, light: &Light) -> FoundCaps {
        let Self { finder, clusters, faces, cap, facing, signs, starts, .. } = self;
        let (found, signs) = if let Some(signs) = finder.signs() {
            (FoundCaps::ScannedByFinder, signs)
        } else if clusters.find(caster, light, faces, self.shortest_range, cap) {
            return FoundCaps::Clustered;
        } else {
            caster.planes().classify_into(caster.mesh(), light, facing);
            caster.rule(faces).signs_into(facing, signs);
            (FoundCaps::Scanned, &signs[..])
        };
        let collapsed = caster.topology().collapsed_face_count() > 0;
        cap::count(caster.mesh().triangles(), signs, collapsed, starts);
        found
    }

    fn write_caps(&self, caster: &Caster, far: u32, light: &mut [[u32; 3]], dark: &mut [[u32; 3]]) {
        let signs = match self.caps {
            FoundCaps::Clustered => {
                light.copy_from_slice(&self.cap.single);
                for (dark, &[a, b, c]) in dark.iter_mut().zip(&self.cap.single) {
                    *dark = [a + far, c + far, b + far];
                }
                return;
            }
            FoundCaps::ScannedByFinder => self.finder.signs().unwrap_or(&[]),
            FoundCaps::Scanned | FoundCaps::Not => &self.signs,
        };
        let faces = CapFaces {
            triangles: caster.mesh().triangles(),
            signs,
            collapsed: caster.topology().collapsed_face_count() > 0,
            starts: &self.starts,
        };
        cap::fill(faces, |v| v, far, light, dark);
    }
}

#[cfg(test)]
mod tests;
