//! Which faces of which shell cast: half the geometry where that is proven to be enough, all of it elsewhere.
//!
//! With front faces only, the volume counts `(crossed + w)/2` at a point of winding number `w`: in or out
//! exactly if `w` is nowhere negative, the shell is balanced, and the light is in none of its volume and not
//! on it. A watertight shell that does not intersect itself and whose volume is positive has `w` ∈ {0, 1}
//! everywhere. With a negative volume the same holds with all signs turned. Anything less is not proof: a
//! figure-eight prism is watertight and may have a positive volume, and its other lobe would stay lit.

use super::winding::{Crossing, TRIES, crossing, scattered};
use super::{Caps, ShadowVolume};
use crate::caster::{Caster, CasterRule, ShellBoxes, ShellProof};
use crate::choice::{Choice, Reason};
use crate::facing::CasterFaces;
use crate::geom::predicate::Homogeneous;
use crate::geom::{Facing, Light, Segment};
use crate::mesh::Mesh;
use crate::silhouette::Silhouette;
use crate::topology::Shells;

/// Which faces cast, shell by shell, for one light.
///
/// ```
/// use umbrage::caster::Caster;
/// use umbrage::facing::CasterFaces;
/// use umbrage::testing::shapes;
/// let caster = Caster::new(shapes::cube());
/// let (outside, inside) = ("point:2,3,5".parse()?, "point:0.1,0.2,0.3".parse()?);
/// let mut faces = caster.shell_faces(&outside, None);
/// assert_eq!(faces.choices[0].what, CasterFaces::Front); // half the geometry
/// // Another light, in the same memory.
/// faces.choose_into(caster.mesh(), caster.shell_boxes(), caster.proofs(), &inside, None);
/// assert_eq!(faces.choices[0].what, CasterFaces::All);
/// assert_eq!(faces.choices[0].to_string(), "the light is inside the shell");
/// # Ok::<(), umbrage::geom::LightError>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct ShellFaces {
    /// One choice per shell, in the order of the shells.
    pub choices: Vec<Choice<CasterFaces>>,
}

impl ShellFaces {
    /// Chooses for every shell: the faces `asked` for, proven or not; without these, half the faces where
    /// that is proven to be enough. `proofs` may be empty if faces are asked for.
    ///
    /// Cost: one box test per shell whose box does not hold the light. A sound shell whose box holds a point
    /// light costs an exact ray cast: a box test per 32 of its faces, and an exact test per face near the
    /// ray. Memory: 12 bytes per shell.
    ///
    /// # Panics
    ///
    /// Panics if no faces are asked for and there is not one proof per shell.
    #[must_use]
    pub fn choose(
        mesh: &Mesh,
        boxes: &ShellBoxes,
        proofs: &[ShellProof],
        light: &Light,
        asked: Option<CasterFaces>,
    ) -> Self {
        let mut faces = Self::default();
        faces.choose_into(mesh, boxes, proofs, light, asked);
        faces
    }

    /// As [`ShellFaces::choose`], in place of earlier choices, whose memory is kept.
    ///
    /// # Panics
    ///
    /// As [`ShellFaces::choose`].
    pub fn choose_into(
        &mut self,
        mesh: &Mesh,
        boxes: &ShellBoxes,
        proofs: &[ShellProof],
        light: &Light,
        asked: Option<CasterFaces>,
    ) {
        self.choices.clear();
        if let Some(faces) = asked {
            self.choices.resize(boxes.shell_count(), Choice::new(faces, why_asked(faces)));
            return;
        }
        assert_eq!(proofs.len(), boxes.shell_count(), "one proof per shell");
        let choices = proofs
            .iter()
            .enumerate()
            .map(|(shell, &proof)| choose(proof, || winding_around_light(mesh, boxes, shell, light)));
        self.choices.extend(choices);
    }

    /// The sign that each face casts with: one entry per face.
    ///
    /// # Panics
    ///
    /// Panics if `shells` or `facing` belong to another mesh.
    #[must_use]
    pub fn signs(&self, shells: &Shells, facing: &[Facing]) -> Vec<i8> {
        let mut signs = Vec::new();
        self.signs_into(shells, facing, &mut signs);
        signs
    }

    /// As [`ShellFaces::signs`], into a buffer that keeps its memory.
    ///
    /// # Panics
    ///
    /// As [`ShellFaces::signs`].
    pub fn signs_into(&self, shells: &Shells, facing: &[Facing], signs: &mut Vec<i8>) {
        assert_eq!(shells.of_face.len(), facing.len(), "one facing per face");
        signs.clear();
        signs.extend(
            shells.of_face.iter().zip(facing).map(|(shell, &facing)| {
                shell.map_or(0, |shell| self.choices[shell as usize].what.sign(facing))
            }),
        );
    }

    /// The sides on which each face casts, whatever the light: one entry per face, as [`CasterFaces::mask`].
    ///
    /// # Panics
    ///
    /// Panics if `shells` belong to another mesh.
    #[must_use]
    pub fn masks(&self, shells: &Shells) -> Vec<u8> {
        let mut masks = Vec::new();
        self.masks_into(shells, &mut masks);
        masks
    }

    /// As [`ShellFaces::masks`], into a buffer that keeps its memory.
    ///
    /// # Panics
    ///
    /// As [`ShellFaces::masks`].
    pub fn masks_into(&self, shells: &Shells, masks: &mut Vec<u8>) {
        let mask = |shell: &Option<u32>| shell.map_or(0, |shell| self.choices[shell as usize].what.mask());
        masks.clear();
        masks.extend(shells.of_face.iter().map(mask));
    }
}

impl Caster {
    /// Which faces cast from `light`, shell by shell: see [`ShellFaces::choose`].
    #[must_use]
    pub fn shell_faces(&self, light: &Light, asked: Option<CasterFaces>) -> ShellFaces {
        let mut faces = ShellFaces::default();
        self.shell_faces_into(light, asked, &mut faces);
        faces
    }

    /// As [`Caster::shell_faces`], in place of earlier choices, whose memory is kept.
    pub fn shell_faces_into(&self, light: &Light, asked: Option<CasterFaces>, faces: &mut ShellFaces) {
        let proofs = if asked.is_none() { self.proofs() } else { &[] };
        faces.choose_into(self.mesh(), self.shell_boxes(), proofs, light, asked);
    }

    /// The faces that were chosen, as a rule for silhouettes and volumes.
    ///
    /// # Panics
    ///
    /// Panics if the choices are of a mesh with another number of shells.
    #[must_use]
    pub fn rule<'a>(&'a self, faces: &'a ShellFaces) -> CasterRule<'a> {
        CasterRule::by_shell(&faces.choices, self.shells(), self.shell_boxes())
    }

    /// The shadow volume of `light`: half the faces of a shell where that is proven to be enough, otherwise
    /// all.
    ///
    /// For light after light, a [`FrameExtruder`](super::FrameExtruder) does the same in memory that is kept.
    ///
    /// ```
    /// use umbrage::caster::Caster;
    /// use umbrage::shadow::volume::Caps;
    /// use umbrage::testing::shapes;
    /// let volume = Caster::new(shapes::cube()).volume(&"point:2,3,5".parse()?, Caps::Both);
    /// // Homogeneous vertices (w = 0 lies at infinity: draw with an infinite far plane) and indices.
    /// let (vertices, indices) = (volume.to_f32(), volume.triangles().as_flattened());
    /// assert!(indices.iter().all(|&index| (index as usize) < vertices.len()));
    /// # Ok::<(), umbrage::geom::LightError>(())
    /// ```
    #[must_use]
    pub fn volume(&self, light: &Light, caps: Caps) -> ShadowVolume {
        self.volume_of(light, &self.shell_faces(light, None), caps)
    }

    /// The shadow volume of `light`, cast by `faces`, which [`Caster::shell_faces`] chose.
    #[must_use]
    pub fn volume_of(&self, light: &Light, faces: &ShellFaces, caps: Caps) -> ShadowVolume {
        let signs = faces.signs(self.shells(), &self.facing(light));
        self.volume_of_signs(light, &signs, caps)
    }

    /// The volume of faces that cast with these signs: one entry per face, −1, 0 or +1.
    pub(crate) fn volume_of_signs(&self, light: &Light, signs: &[i8], caps: Caps) -> ShadowVolume {
        let silhouette = Silhouette::extract(self.topology(), signs);
        ShadowVolume::extrude(self.mesh(), self.topology(), light, signs, &silhouette, caps)
    }
}

fn why_asked(faces: CasterFaces) -> Reason {
    match faces {
        CasterFaces::All => Reason::AllFacesAsked,
        CasterFaces::Front => Reason::FrontFacesAsked,
        CasterFaces::Back => Reason::BackFacesAsked,
    }
}

/// `winding` gives how often a sound shell winds around the light; `None` if the light is on it.
#[inline]
fn choose(proof: ShellProof, winding: impl FnOnce() -> Option<i32>) -> Choice<CasterFaces> {
    let (half, enough) = match proof {
        ShellProof::NotWatertight => return Choice::new(CasterFaces::All, Reason::NotWatertight),
        ShellProof::ZeroAreaFace => return Choice::new(CasterFaces::All, Reason::ZeroAreaFace),
        ShellProof::MeetsItself => return Choice::new(CasterFaces::All, Reason::MeetsItself),
        ShellProof::Unsettled => return Choice::new(CasterFaces::All, Reason::Unsettled),
        ShellProof::NoVolume => return Choice::new(CasterFaces::All, Reason::NoVolume),
        ShellProof::Outward => (CasterFaces::Front, Reason::FrontFacesSuffice),
        ShellProof::Inward => (CasterFaces::Back, Reason::BackFacesSuffice),
    };
    match winding() {
        Some(0) => Choice::new(half, enough),
        Some(winding) => Choice::new(CasterFaces::All, Reason::LightInside { winding }),
        None => Choice::new(CasterFaces::All, Reason::LightOnShell),
    }
}

/// How often a sound shell winds around the light, exactly; `None` if the light lies on a face, or if each of
/// sixteen rays runs exactly through an edge.
///
/// Nothing winds around infinity, nor around a point outside a box that holds the shell. For any other light
/// the crossings of a ray are summed up. A block of faces whose box the ray misses is not crossed.
#[inline]
fn winding_around_light(mesh: &Mesh, boxes: &ShellBoxes, shell: usize, light: &Light) -> Option<i32> {
    if light.is_directional() || !boxes.shells[shell].bounds.contains(light.xyz()) {
        return Some(0);
    }
    winding_by_rays(mesh, boxes, shell, light)
}

#[inline(never)]
fn winding_by_rays(mesh: &Mesh, boxes: &ShellBoxes, shell: usize, light: &Light) -> Option<i32> {
    let start = Homogeneous::light(light);
    for direction in (0..TRIES).map(scattered) {
        let target = Light::directional(direction).expect("no direction is zero");
        let (ray, target) = (Segment::to_light(light.xyz(), &target), Homogeneous::light(&target));
        let mut sum = 0;
        let mut tie = false;
        for face in
            boxes.blocks_of(shell).filter(|(bounds, _)| ray.may_meet(bounds)).flat_map(|block| block.1)
        {
            match crossing(mesh.corners(*face).map(Homogeneous::point), start, target) {
                Crossing::Miss => {}
                Crossing::Through(sign) => sum += sign,
                Crossing::Starts => return None,
                Crossing::Tie => tie = true, // another ray; but first all faces, for the light may lie on one
            }
        }
        if !tie {
            return Some(sum);
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::check::CrackReport;
    use crate::geom::Aabb;
    use crate::mesh::FaceId;
    use crate::testing::{shapes, strategy};
    use crate::topology::Topology;

    /// The reference: rays from every light against every face of every sound shell, without a box.
    fn naive(caster: &Caster, light: &Light) -> Vec<Choice<CasterFaces>> {
        let winding = |shell: u32| {
            if light.is_directional() {
                return Some(0);
            }
            (0..TRIES).map(scattered).find_map(|direction| {
                let target = Homogeneous::light(&Light::directional(direction).unwrap());
                let (mut sum, mut tie) = (0, false);
                for (face, of) in caster.shells().of_face.iter().enumerate() {
                    if *of != Some(shell) {
                        continue;
                    }
                    let corners = caster.mesh().corners(FaceId::new(face)).map(Homogeneous::point);
                    match crossing(corners, Homogeneous::light(light), target) {
                        Crossing::Miss => {}
                        Crossing::Through(sign) => sum += sign,
                        Crossing::Starts => return Some(None),
                        Crossing::Tie => tie = true,
                    }
                }
                (!tie).then_some(Some(sum))
            })?
        };
        (0..).zip(caster.proofs()).map(|(shell, &proof)| choose(proof, || winding(shell))).collect()
    }

    fn agrees(caster: &Caster, boxes: &ShellBoxes, light: &Light) -> bool {
        let mut faces = caster.shell_faces(&Light::directional([1.0, 2.0, 3.0]).unwrap(), None);
        faces.choose_into(caster.mesh(), boxes, caster.proofs(), light, None);
        faces.choices == naive(caster, light)
    }

    /// Closed shells beside, within and through each other, on a grid: a light often lies on one.
    fn shells() -> impl Strategy<Value = Mesh> {
        let shape = prop_oneof![
            Just(shapes::cube()),
            Just(shapes::octahedron()),
            Just(shapes::inside_out(&shapes::cube())),
            Just(shapes::torus(16, 12, 2.0, 0.75)),
            Just(shapes::open_cube()),
            Just(shapes::icosphere(2)),
        ];
        let part = (shape, [-2_i8..=2, -2_i8..=2, -2_i8..=2], 1_u8..4).prop_map(|(mesh, at, size)| {
            shapes::translated(&shapes::scaled(&mesh, f32::from(size)), at.map(f32::from))
        });
        prop::collection::vec(part, 1..6).prop_map(|parts| Mesh::concat(&parts).unwrap())
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(200))]

        #[test]
        fn plan_by_boxes_equals_rays_against_every_face(
            mesh in shells(),
            soup in strategy::soup(60),
            grid in prop::collection::vec([-8_i8..=8, -8_i8..=8, -8_i8..=8], 10),
            lights in prop::collection::vec(strategy::light(), 4),
        ) {
            let grid = grid.into_iter().map(|at| Light::point(at.map(|x| f32::from(x) / 2.0)).unwrap());
            let lights: Vec<Light> = grid.chain(lights).collect();
            for mesh in [mesh, soup] {
                let caster = Caster::new(mesh);
                for light in &lights {
                    prop_assert!(agrees(&caster, caster.shell_boxes(), light), "{light}");
                }
            }
        }
    }

    #[test]
    fn plan_by_boxes_that_are_too_small_is_caught() {
        let caster = Caster::new(shapes::torus(60, 40, 2.0, 0.75));
        let inside = Light::point([2.0, 0.1, 0.1]).unwrap();
        let boxes = caster.shell_boxes();
        assert!(agrees(&caster, boxes, &inside));
        let (mut shrunk, mut without_blocks) = (boxes.clone(), boxes.clone());
        shrunk.shells[0].bounds = Aabb { low: [-1.0; 3], high: [1.0; 3] };
        assert!(!agrees(&caster, &shrunk, &inside));
        let elsewhere = Aabb { low: [50.0; 3], high: [51.0; 3] };
        without_blocks.blocks.iter_mut().for_each(|block| block.bounds = elsewhere);
        assert!(!agrees(&caster, &without_blocks, &inside));
    }

    #[test]
    fn plan_signs_and_masks_replace_what_a_buffer_held() {
        let caster = Caster::new(Mesh::concat(&[shapes::cube(), shapes::open_cube()]).unwrap());
        let light = Light::point([3.0, 9.0, 5.0]).unwrap();
        let (faces, facing) = (caster.shell_faces(&light, None), caster.facing(&light));
        let (mut signs, mut masks) = (vec![7; 99], vec![7; 99]);
        faces.signs_into(caster.shells(), &facing, &mut signs);
        faces.masks_into(caster.shells(), &mut masks);
        assert_eq!(signs, faces.signs(caster.shells(), &facing));
        assert_eq!(masks, faces.masks(caster.shells()));
        let by_rule =
            (0..).map(FaceId).zip(&facing).map(|(face, &side)| caster.rule(&faces).of(face).sign(side));
        assert!(signs.iter().copied().eq(by_rule));
        assert!(masks.contains(&3) && masks.contains(&1));
    }

    /// Two flat cones of `sides` faces each, base to base: all faces of a cone meet at its apex, and nearly
    /// all of them lie in one thin slab. From a side of the rim a spike goes up, and from this another one
    /// down: no point inside sees everything.
    fn flat_double_cone(sides: u32) -> Mesh {
        let rim = (0..sides).map(|i| {
            let (sin, cos) = (f64::from(i) * std::f64::consts::TAU / f64::from(sides)).sin_cos();
            [cos as f32, sin as f32, 0.0]
        });
        let tips = [[0.0, 0.0, 1e-3], [0.0, 0.0, -1e-3], [1.5, 0.0, 0.3], [1.2, 0.0, -0.5]];
        let [top, bottom, up, down] = [0, 1, 2, 3].map(|tip| sides + tip);
        let spikes = [[1, top, up], [top, 0, up], [1, up, down], [up, 0, down], [0, 1, down]];
        let faces = (0..sides).flat_map(|i| {
            let next = (i + 1) % sides;
            [[i, next, top], [next, i, bottom]]
        });
        Mesh::new(rim.chain(tips).collect(), faces.skip(1).chain(spikes).collect()).unwrap()
    }

    #[test]
    fn plan_shells_that_would_each_take_seconds_share_one_allowance() {
        let one = flat_double_cone(3000);
        let two = Mesh::concat(&[one.clone(), one.clone()]).unwrap();
        let built = |mesh: &Mesh| Topology::of(mesh);
        let topologies = [&one, &two].map(built);
        let shells = [0, 1].map(|i| topologies[i].shells());
        let reports = [(&one, &topologies[0]), (&two, &topologies[1])].map(|(m, t)| CrackReport::of(m, t));
        let proofs_of_one = |spare| ShellProof::within(&one, &topologies[0], &shells[0], &reports[0], spare);
        assert_eq!(proofs_of_one(0), [ShellProof::Unsettled]);
        let step = 1 << 20;
        let spare = (1..16).map(|k| k * step).find(|&spare| proofs_of_one(spare) == [ShellProof::Outward]);
        let spare = spare.expect("the default is enough");
        assert!(spare > 2 * step, "so that it is not enough for two");

        let proofs = ShellProof::within(&two, &topologies[1], &shells[1], &reports[1], spare);
        assert_eq!(proofs, [ShellProof::Outward, ShellProof::Unsettled]);
        let light = Light::directional([1.0, 2.0, 3.0]).unwrap();
        let plan = ShellFaces::choose(&two, &ShellBoxes::new(&two, &shells[1]), &proofs, &light, None);
        assert_eq!(plan.choices[0].what, CasterFaces::Front);
        assert_eq!(plan.choices[1].what, CasterFaces::All);
        assert_eq!(plan.choices[1].to_string(), "too many faces reach into one place for a proof");
    }
}
