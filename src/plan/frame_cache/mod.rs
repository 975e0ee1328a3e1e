//! Parts of a frame that are kept for the next one: only what depends on what has moved is made again.
//!
//! | moved | made again |
//! |---|---|
//! | nothing | nothing |
//! | the camera | visible points; relevance and visibility of each lamp |
//! | a lamp | its volumes, its light grid, its relevance, its visibility |
//! | the brightness or the range of a lamp | its relevance |
//! | a caster, or its vertices | this caster, its volumes; ray tree, visible points; all of each lamp |
//!
//! The topology of a mesh is made once, whatever moves: it depends on no position.
//!
//! A moved caster is baked: its positions in the world are rounded to `f32`, and all signs are those of the
//! rounded positions. So a cached frame has the bytes of a frame that is made anew. Volumes are cast by all
//! faces: a proof that half of them suffice holds for one set of positions, and costs more than it saves in
//! one frame.

mod fault;
mod key;
#[cfg(test)]
mod tests;

use std::sync::Arc;

use glam::Mat4;
use hashbrown::HashMap;

use self::fault::Faults;
use self::key::{CasterKey, GridKey, LightKey, RelevanceKey, ViewKey, VisibilityKey};
use super::relevance::{Pieces, Question, Relevance, TestSet, relevant};
use crate::caster::{Caster, CasterGroup};
use crate::facing::CasterFaces;
use crate::geom::Light;
use crate::light_grid::{Chain, GridEntries, LightGrid};
use crate::mesh::{FaceId, Mesh, MeshError};
use crate::oracle::Oracle;
use crate::scene::{Lamp, OwnSpace};
use crate::shadow::volume::{Caps, ShadowVolume};
use crate::shadow::{PrepareError, Request, Samples, Technique, TooManySamples, Visibility, by_grid};
use crate::view::{Projection, Size};

/// A mesh where it is in one frame.
#[derive(Clone, Copy, Debug)]
pub struct Posed<'a> {
    /// The number of the mesh, which the caller gives: the same number is the same mesh.
    pub mesh: u32,
    /// The number of its positions, such as the frame of an animation: within a mesh, the same number is the
    /// same positions.
    pub frame: u32,
    /// The mesh with these positions. It is only read where the cache has it not.
    pub shape: &'a Mesh,
    /// Its transform.
    pub world_from_mesh: Mat4,
}

/// A scene in one frame.
#[derive(Clone, Copy, Debug)]
pub struct Moment<'a> {
    /// The casters.
    pub casters: &'a [Posed<'a>],
    /// The lamps.
    pub lamps: &'a [Lamp],
    /// Whether shadow volumes are wanted: with both caps, one for each caster and lamp.
    pub volumes: bool,
    /// The view, where visible points, relevance and visibility are wanted.
    pub view: Option<(Projection, Size)>,
    /// The technique of all lamps.
    pub technique: Technique,
    /// Whether the lamps' light falls off with the distance.
    pub physical_falloff: bool,
}

/// How many parts were made for the last frame; all others were kept.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct Made {
    /// Topologies.
    pub topologies: usize,
    /// Casters: positions in the world, and what hangs on them.
    pub casters: usize,
    /// Shadow volumes, with facing and silhouette.
    pub volumes: usize,
    /// Ray trees over all casters, with the casters' pieces.
    pub trees: usize,
    /// Sets of visible points.
    pub samples: usize,
    /// Light grids, a lamp each, where the technique is `hybrid`.
    pub grids: usize,
    /// Relevances, a lamp each.
    pub relevances: usize,
    /// Visibilities, a lamp each.
    pub visibilities: usize,
}

/// Reason why a frame cannot be made. The cache stays as it was, or forgets parts.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FrameError {
    /// A transform carries a position beyond `f32`.
    #[error("caster {caster}: {error}; move it nearer to the origin")]
    Mesh {
        /// The index of the caster.
        caster: usize,
        /// What is wrong with it.
        error: MeshError,
    },
    /// The view has too many samples.
    #[error(transparent)]
    Samples(#[from] TooManySamples),
    /// The technique cannot be used for a lamp.
    #[error("lamp {lamp}: {error}")]
    Technique {
        /// The index of the lamp.
        lamp: usize,
        /// Why it cannot.
        error: PrepareError,
    },
}

/// Keeps the parts of the last frame.
///
/// ```
/// use glam::{Mat4, Vec3};
/// use umbrage::plan::{FrameCache, Moment, Posed};
/// use umbrage::shadow::Technique;
/// use umbrage::testing::shapes;
///
/// let (floor, cube) = (shapes::sheet(4), shapes::cube());
/// let lamps = ["point:3,9,5".parse()?, "directional:0,-1,0".parse()?];
/// let mut cache = FrameCache::default();
/// for frame in 0..3_u8 {
///     let lifted = Mat4::from_translation(Vec3::Y * f32::from(frame));
///     let posed = |mesh, shape, world_from_mesh| Posed { mesh, frame: 0, shape, world_from_mesh };
///     let casters = [posed(0, &floor, Mat4::IDENTITY), posed(1, &cube, lifted)];
///     let frame = cache.frame(&Moment {
///         casters: &casters,
///         lamps: &lamps,
///         volumes: true,
///         view: None,
///         technique: Technique::Rays,
///         physical_falloff: false,
///     })?;
///     assert_eq!(frame.volumes.len(), 4); // caster by caster, a volume for each lamp
/// }
/// // The floor's volumes were kept; the cube, which moved, has new ones. Nobody asked for a ray tree.
/// let made = cache.made();
/// assert_eq!((made.casters, made.volumes, made.trees), (1, 2, 0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Default)]
pub struct FrameCache {
    /// One caster of each mesh, for its topology.
    rests: HashMap<u32, Caster>,
    casters: HashMap<CasterKey, Caster>,
    volumes: HashMap<(CasterKey, LightKey), ShadowVolume>,
    tree: Option<(Vec<CasterKey>, Arc<Oracle>, Arc<Pieces>)>,
    samples: Option<(ViewKey, Samples)>,
    grids: Vec<(GridKey, GridEntries)>,
    relevances: Vec<(RelevanceKey, Relevance)>,
    visibilities: Vec<(VisibilityKey, Visibility)>,
    made: Made,
    faults: Faults,
}

/// The parts of a frame.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Frame<'a> {
    /// The casters, in order, in the world.
    pub casters: Vec<&'a Caster>,
    /// The shadow volumes, caster by caster, one for each lamp; none if they are not wanted.
    pub volumes: Vec<&'a ShadowVolume>,
    /// The visible points; `None` without a view.
    pub samples: Option<&'a Samples>,
    /// The entries of the light grid of each lamp, over all that is there; none without a view, or unless the
    /// technique is `hybrid`.
    pub grids: Vec<&'a GridEntries>,
    /// What can change a visible point, for each lamp; none without a view.
    pub relevances: Vec<&'a Relevance>,
    /// How much of each lamp reaches each visible point; none without a view.
    pub visibilities: Vec<&'a Visibility>,
}

impl FrameCache {
    /// The parts of a frame: those of the last one where nothing that they depend on has changed. What the
    /// frame does not use is forgotten.
    ///
    /// Memory: the parts of one frame, and a caster of each mesh.
    ///
    /// # Errors
    ///
    /// [`FrameError`]; the next frame is right all the same.
    pub fn frame(&mut self, moment: &Moment<'_>) -> Result<Frame<'_>, FrameError> {
        self.made = Made::default();
        let keys: Vec<CasterKey> =
            moment.casters.iter().map(|posed| CasterKey::of(posed, self.faults)).collect();
        let lights: Vec<LightKey> = moment.lamps.iter().map(|lamp| LightKey::of(lamp, self.faults)).collect();
        self.casters(moment, &keys)?;
        self.volumes(moment, &keys, &lights);
        match moment.view {
            Some(view) => self.picture(moment, &keys, view)?,
            None => self.forget_the_picture(),
        }
        let volumes = keys.iter().flat_map(|key| lights.iter().map(|light| &self.volumes[&(*key, *light)]));
        Ok(Frame {
            casters: keys.iter().map(|key| &self.casters[key]).collect(),
            volumes: if moment.volumes { volumes.collect() } else { Vec::new() },
            samples: self.samples.as_ref().map(|(_, samples)| samples),
            grids: self.grids.iter().map(|(_, entries)| entries).collect(),
            relevances: self.relevances.iter().map(|(_, relevance)| relevance).collect(),
            visibilities: self.visibilities.iter().map(|(_, visibility)| visibility).collect(),
        })
    }

    /// What was made for the last frame.
    #[must_use]
    pub fn made(&self) -> Made {
        self.made
    }

    fn casters(&mut self, moment: &Moment<'_>, keys: &[CasterKey]) -> Result<(), FrameError> {
        self.casters.retain(|key, _| keys.contains(key));
        self.rests.retain(|mesh, _| keys.iter().any(|key| key.mesh == *mesh));
        for (index, (posed, key)) in moment.casters.iter().zip(keys).enumerate() {
            if self.casters.contains_key(key) {
                continue;
            }
            let at_rest = self.rests.get(&posed.mesh);
            let fits = at_rest.is_some_and(|rest| {
                rest.mesh().triangles() == posed.shape.triangles()
                    && rest.mesh().vertex_count() == posed.shape.vertex_count()
            });
            if !fits {
                let rest = Caster::new(posed.shape.clone());
                // Made before it is copied.
                let _ = rest.topology();
                self.rests.insert(posed.mesh, rest);
                self.made.topologies += 1;
            }
            let mut caster = self.rests[&posed.mesh].clone();
            let placed = OwnSpace::placed(posed.shape, &posed.world_from_mesh)
                .and_then(|placed| caster.repose(placed.positions().to_vec()));
            placed.map_err(|error| FrameError::Mesh { caster: index, error })?;
            self.casters.insert(*key, caster);
            self.made.casters += 1;
        }
        Ok(())
    }

    fn volumes(&mut self, moment: &Moment<'_>, keys: &[CasterKey], lights: &[LightKey]) {
        if !moment.volumes {
            self.volumes.clear();
            return;
        }
        self.volumes.retain(|(key, light), _| keys.contains(key) && lights.contains(light));
        for key in keys {
            let caster = &self.casters[key];
            for (lamp, light) in moment.lamps.iter().zip(lights) {
                self.volumes.entry((*key, *light)).or_insert_with(|| {
                    self.made.volumes += 1;
                    let signs = CasterFaces::All.signs(&caster.facing(lamp.light()));
                    caster.volume_of_signs(lamp.light(), &signs, Caps::Both)
                });
            }
        }
    }

    fn forget_the_picture(&mut self) {
        (self.tree, self.samples) = (None, None);
        self.grids.clear();
        self.relevances.clear();
        self.visibilities.clear();
    }

    fn picture(
        &mut self,
        moment: &Moment<'_>,
        keys: &[CasterKey],
        view: (Projection, Size),
    ) -> Result<(), FrameError> {
        let casters: Vec<&Caster> = keys.iter().map(|key| &self.casters[key]).collect();
        let kept = self.tree.take().filter(|(of, ..)| of == keys);
        let (of, oracle, pieces) = kept.unwrap_or_else(|| {
            self.made.trees += 1;
            let group = CasterGroup::new(casters.clone());
            let oracle = group.shared_oracle();
            (keys.to_vec(), oracle, Arc::new(Pieces::of(&group)))
        });
        let group = CasterGroup::new(casters).with_oracle(oracle.clone());
        self.tree = Some((of, oracle, pieces.clone()));

        let key = ViewKey::of(keys, view, self.faults);
        let samples = match self.samples.take() {
            Some((of, samples)) if of == key => samples,
            last => {
                self.made.samples += 1;
                // Most pixels see the face that they saw in the last frame, unless faces are smaller.
                let faces: usize = group.casters().iter().map(|caster| caster.mesh().face_count()).sum();
                let is_coarse = faces <= view.1.pixels();
                let last = last.iter().filter(|_| is_coarse).flat_map(|(_, samples)| samples.hits());
                let expected: Vec<Option<FaceId>> = last.map(|hit| hit.map(|hit| hit.face)).collect();
                Samples::of_view_expecting(&group, &view.0, view.1, 1, &expected)?
            }
        };
        let (_, samples) = self.samples.insert((key.clone(), samples));

        let mut old = std::mem::take(&mut self.relevances).into_iter();
        for (number, lamp) in moment.lamps.iter().enumerate() {
            let key = RelevanceKey::of(&key, lamp, moment.physical_falloff, self.faults);
            let kept = old.next().filter(|(of, _)| *of == key);
            self.relevances.push(kept.unwrap_or_else(|| {
                self.made.relevances += 1;
                let question = Question {
                    casters: &group,
                    pieces: &pieces,
                    lamp,
                    number,
                    samples,
                    physical_falloff: moment.physical_falloff,
                    level: 0.0,
                    tests: TestSet::ALL,
                };
                (key, relevant(&question))
            }));
        }
        let grid_key = |lamp: &Lamp, side| GridKey::of(keys, lamp, side, self.faults);
        self.made.grids = renew_grids(&mut self.grids, moment, &group, grid_key);
        let mut old = std::mem::take(&mut self.visibilities).into_iter();
        for (number, lamp) in moment.lamps.iter().enumerate() {
            let key = VisibilityKey::of(&key, lamp, moment.technique);
            let kept = old.next().filter(|(of, _)| *of == key);
            self.visibilities.push(match kept {
                Some(kept) => kept,
                None => {
                    self.made.visibilities += 1;
                    let visibility = match self.grids.get_mut(number) {
                        Some((_, entries)) => Ok(shade_by_grid(&group, lamp.light(), samples, entries)),
                        None => moment.technique.shade(&Request { casters: &group, lamp, samples }),
                    };
                    (key, visibility.map_err(|error| FrameError::Technique { lamp: number, error })?)
                }
            });
        }
        Ok(())
    }
}

/// Makes the light grids of all lamps that are missing, if the technique asks for any; how many.
fn renew_grids(
    grids: &mut Vec<(GridKey, GridEntries)>,
    moment: &Moment<'_>,
    group: &CasterGroup<'_>,
    key: impl Fn(&Lamp, u32) -> GridKey,
) -> usize {
    let (mut old, mut made) = (std::mem::take(grids).into_iter(), 0);
    let Technique::Hybrid(options) = moment.technique else { return 0 };
    for lamp in moment.lamps {
        let key = key(lamp, options.grid);
        let kept = old.next().filter(|(of, _)| *of == key);
        grids.push(kept.unwrap_or_else(|| {
            made += 1;
            let chain = Chain::of(group, lamp.light());
            (key, LightGrid::over(&chain, &group.bounds(), options.grid).into_entries())
        }));
    }
    made
}

/// The visibility of `hybrid`, by the entries of its grid.
fn shade_by_grid(
    group: &CasterGroup<'_>,
    light: &Light,
    samples: &Samples,
    entries: &mut GridEntries,
) -> Visibility {
    let chain = Chain::of(group, light);
    let grid = LightGrid::of_entries(&chain, std::mem::take(entries));
    let visibility = by_grid(&grid, group.oracle(), light, samples);
    *entries = grid.into_entries();
    visibility
}
