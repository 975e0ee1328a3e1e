//! All methods that answer for the points of one mesh under one light.

use super::naive_f32::Plain;
use crate::caster::{ShellBoxes, ShellProof};
use crate::facing::{CasterFaces, FacePlanes, classify};
use crate::geom::{Aabb, Facing, Light};
use crate::mesh::Mesh;
use crate::oracle::{Oracle, Verdict};
use crate::random::SplitMix64;
use crate::shadow::volume::{Caps, ShadowVolume, ShellFaces, WindingIndex, WindingTable, stands_on};
use crate::silhouette::Silhouette;
use crate::topology::Topology;
use crate::verify::points::judge::Cast;
use crate::verify::points::sampler::Sampler;

/// Where tests inject faults, to show that they are found.
#[derive(Clone, Copy)]
pub(super) struct Seam {
    pub(super) facing: fn(&mut [Facing]),
    /// Changes the signs that all faces cast with, and those of the halved volume.
    pub(super) signs: fn(&mut [i8]),
    pub(super) volume: fn(&mut ShadowVolume),
    pub(super) oracle: fn(&Mesh) -> Oracle,
    pub(super) cast: fn(&mut Cast),
    /// Changes the answer of a winding number.
    pub(super) winding: fn(Option<i32>) -> Option<i32>,
    /// How many queries per round that touch or lie on something are decided with big integers.
    pub(super) audits: usize,
}

/// See [`Seam::audits`].
const AUDITS: usize = 8;

impl Seam {
    /// No fault.
    pub(super) const SOUND: Self = Self {
        facing: |_| {},
        signs: |_| {},
        volume: |_| {},
        oracle: Oracle::build,
        cast: |_| {},
        winding: |winding| winding,
        audits: AUDITS,
    };
}

/// A mesh under a light, with its volumes and its ray cast.
pub(super) struct Prepared<'a> {
    mesh: &'a Mesh,
    light: &'a Light,
    seam: Seam,
    topology: Topology,
    silhouette: Silhouette,
    oracle: Oracle,
    all: ShadowVolume,
    /// The volume of the faces that [`ShellFaces`] chooses.
    half: Option<ShadowVolume>,
    /// The signs of `half`; without it, those of all faces.
    chosen: Vec<i8>,
    plain: Plain,
    pub(super) found: Found,
}

/// The checks of a round that need no point.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Found {
    pub(super) faces: u64,
    /// Faces whose side by the filter differs from that by the predicate.
    pub(super) faces_wrong: u64,
    pub(super) plain_f32_faces_wrong: u64,
    pub(super) volumes: u64,
    pub(super) open_volumes: u64,
}

impl<'a> Prepared<'a> {
    /// Draws points around the mesh and its shadow.
    pub(super) fn sampler(&self) -> Sampler<'_> {
        Sampler::new(self.mesh, self.light, &self.topology, &self.silhouette)
    }

    /// `signs` is the seed of random signs, whose volume has to be closed as well. With `half` the halved
    /// volume is checked too.
    pub(super) fn new(mesh: &'a Mesh, light: &'a Light, signs: u64, half: bool, seam: Seam) -> Self {
        // 1. The side of every face, by the filter and face by face.
        let topology = Topology::of(mesh);
        let mut facing = FacePlanes::new(mesh).classify(mesh, light);
        (seam.facing)(&mut facing);
        let truth = classify(mesh, light);
        let plain = Plain::new(mesh, light);

        // 2. The volumes, each with its certificate.
        let mut all_signs = CasterFaces::All.signs(&facing);
        (seam.signs)(&mut all_signs);
        let extrude = |signs: &[i8]| {
            let silhouette = Silhouette::extract(&topology, signs);
            let mut volume = ShadowVolume::extrude(mesh, &topology, light, signs, &silhouette, Caps::Both);
            (seam.volume)(&mut volume);
            (silhouette, volume)
        };
        let (silhouette, all) = extrude(&all_signs);
        let mut random = SplitMix64(signs);
        let any: Vec<i8> = facing.iter().map(|_| random.below(3) as i8 - 1).collect();
        let (_, any) = extrude(&any);
        let (chosen, half) = if half {
            let shells = topology.shells();
            let proofs = ShellProof::of(mesh, &topology, &shells);
            let boxes = ShellBoxes::new(mesh, &shells);
            let plan = ShellFaces::choose(mesh, &boxes, &proofs, light, None);
            let mut chosen = plan.signs(&shells, &facing);
            (seam.signs)(&mut chosen);
            let (_, half) = extrude(&chosen);
            (chosen, Some(half))
        } else {
            (all_signs, None)
        };
        let is_open = |volume: &ShadowVolume| !volume.boundary_sum().is_closed();
        let found = Found {
            faces: facing.len() as u64,
            faces_wrong: facing.iter().zip(&truth).filter(|(filtered, exact)| filtered != exact).count()
                as u64,
            plain_f32_faces_wrong: plain.faces_wrong(&truth),
            volumes: 2 + u64::from(half.is_some()),
            open_volumes: [Some(&all), Some(&any), half.as_ref()]
                .into_iter()
                .flatten()
                .map(|volume| u64::from(is_open(volume)))
                .sum(),
        };
        let oracle = (seam.oracle)(mesh);
        Self { mesh, light, seam, topology, silhouette, oracle, all, half, chosen, plain, found }
    }

    /// The methods for points in a box that is not empty.
    pub(super) fn bench(&'a self, within: Aabb) -> Bench<'a> {
        Bench {
            prepared: self,
            audits: self.seam.audits,
            all: WindingTable::new(&self.all, within),
            half: self.half.as_ref().map(|half| WindingIndex::build(half, within)),
        }
    }
}

/// All methods for one mesh and light.
pub(super) struct Bench<'a> {
    prepared: &'a Prepared<'a>,
    /// How many more ties are decided with big integers.
    audits: usize,
    all: WindingTable<'a>,
    half: Option<WindingIndex<'a>>,
}

/// What the methods answered for one point.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Judged {
    cast: Cast,
    all: Option<i32>,
    /// The winding number of the halved volume, where there is one.
    half: Option<Option<i32>>,
    /// The volumes whose winding number abstains although the point does not lie on them.
    shy: Vec<&'static str>,
    /// Whether big integers decided this point too.
    pub(super) audited: bool,
    /// What big integers found, where they differ.
    whole: Option<String>,
    /// The verdict of the ray cast that stops at the first face, where it differs.
    hasty: Option<Verdict>,
    plain: bool,
}

impl Bench<'_> {
    /// Asks all methods about a point. Big integers are asked if `whole` is set, and at the first points that
    /// touch or lie on something: there the other methods allow more than one answer.
    pub(super) fn judge(&mut self, p: [f32; 3], whole: bool) -> Judged {
        let Prepared { mesh, light, oracle, chosen, plain, seam, .. } = self.prepared;
        let mut cast = Cast::of(oracle, p, light, chosen);
        (seam.cast)(&mut cast);
        let all = (seam.winding)(self.all.number(p));
        let half = self.half.as_ref().map(|half| (seam.winding)(half.number(p)));
        let mut shy = Vec::new();
        if all.is_none() && !stands_on(&self.prepared.all, p) {
            shy.push("all faces");
        }
        if let (Some(None), Some(volume)) = (half, &self.prepared.half)
            && !stands_on(volume, p)
        {
            shy.push("chosen faces");
        }
        let is_loose = cast.crossings.touching > 0 || all.is_none() || half == Some(None);
        let audit = is_loose && self.audits > 0;
        self.audits -= usize::from(audit);
        let (mut hasty, mut differs) = (None, None);
        if whole || audit {
            differs = cast.in_whole_numbers(mesh, p, light).err();
            hasty = Some(oracle.verdict(p, light)).filter(|&verdict| verdict != cast.verdict());
        }
        Judged {
            cast,
            all,
            half,
            shy,
            audited: whole || audit,
            whole: differs,
            hasty,
            plain: plain.shadowed(p),
        }
    }
}

impl Judged {
    /// Whether the volume of all faces contradicts the ray cast.
    #[inline]
    fn all_wrong(&self) -> bool {
        self.all.is_some_and(|winding| !self.cast.allows(winding, &self.cast.all()))
    }

    fn half_wrong(&self) -> bool {
        self.half.flatten().is_some_and(|winding| !self.cast.allows(winding, &self.cast.chosen()))
    }

    /// Whether any method contradicts another.
    #[inline]
    pub(super) fn is_wrong(&self) -> bool {
        self.all_wrong()
            || self.half_wrong()
            || !self.shy.is_empty()
            || self.whole.is_some()
            || self.hasty.is_some()
    }

    /// Whether every winding number abstains.
    #[inline]
    pub(super) fn abstained(&self) -> bool {
        self.all.is_none() && self.half.flatten().is_none()
    }

    /// Whether the segment only touches the mesh.
    #[inline]
    pub(super) fn grazes(&self) -> bool {
        self.cast.verdict() == Verdict::Grazing
    }

    /// Whether nothing checks the ray cast: either answer is right, or every winding number abstains.
    #[inline]
    pub(super) fn is_tie(&self) -> bool {
        self.grazes() || self.abstained()
    }

    /// Whether plain `f32` confuses lit and shadowed.
    #[inline]
    pub(super) fn plain_wrong(&self) -> bool {
        !self.grazes() && self.plain != (self.cast.verdict() == Verdict::Shadowed)
    }

    /// What each method answered, one line each.
    pub(super) fn say(&self) -> Vec<String> {
        let crossings = self.cast.crossings;
        let number =
            |winding: Option<i32>| winding.map_or("abstains".to_owned(), |number| number.to_string());
        let mark = |wrong: bool| if wrong { " (contradicts)" } else { "" };
        let mut said = vec![format!(
            "ray cast: {} front and {} back faces crossed, {} touched: {}",
            crossings.front,
            crossings.back,
            crossings.touching,
            word(self.cast.verdict())
        )];
        said.push(format!(
            "winding number, all faces: {}, expected {:?}{}",
            number(self.all),
            self.cast.all(),
            mark(self.all_wrong())
        ));
        if let Some(half) = self.half {
            said.push(format!(
                "winding number, chosen faces: {}, expected {:?}{}",
                number(half),
                self.cast.chosen(),
                mark(self.half_wrong())
            ));
        }
        for volume in &self.shy {
            said.push(format!("winding number, {volume}: stands on no triangle of its volume{}", mark(true)));
        }
        if let Some(whole) = &self.whole {
            said.push(format!("whole numbers: {whole}{}", mark(true)));
        }
        if let Some(hasty) = self.hasty {
            said.push(format!("ray cast that stops at the first face: {}{}", word(hasty), mark(true)));
        }
        let plain = if self.plain { Verdict::Shadowed } else { Verdict::Lit };
        let mark = if self.plain_wrong() { " (wrong)" } else { "" };
        said.push(format!("plain f32: {}{mark}", word(plain)));
        said
    }
}

fn word(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Lit => "lit",
        Verdict::Shadowed => "shadowed",
        Verdict::Grazing => "grazing",
    }
}
