//! Which faces of which shell cast: half the geometry where that is proven to be enough, all of it elsewhere.
//!
//! With front faces only, the volume counts `(crossed + w)/2` at a point of winding number `w`: in or out exactly
//! if `w` is nowhere negative, the shell is balanced, and the light is in none of its volume and not on it. A
//! watertight shell that does not meet itself and whose volume is positive has `w` ∈ {0, 1} everywhere. With a
//! negative volume the same holds with all signs turned. Anything less is not proof: a figure-eight prism is
//! watertight and may have a positive volume, and its other lobe would stay lit.

use super::winding::{Crossing, crossing, scattered};
use super::{Caps, ShadowVolume};
use crate::caster::{Caster, ShellProof};
use crate::choice::{Choice, Reason};
use crate::facing::CasterFaces;
use crate::geom::Facing;
use crate::geom::Light;
use crate::geom::predicate::Homogeneous;
use crate::mesh::{FaceId, Mesh};
use crate::silhouette::Silhouette;
use crate::topology::Shells;

/// Where a light is with respect to one shell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum LightPlace {
    /// The shell winds this often around the light.
    Winding(i32),
    /// On a face of the shell, or so aligned with it that it could not be told.
    OnShell,
}

/// Which faces cast, shell by shell, for one light.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ShellFaces {
    /// One choice per shell, in the order of the shells.
    pub choices: Vec<Choice<CasterFaces>>,
}

impl ShellFaces {
    /// Chooses for every shell: the faces `asked` for, proven or not, or without these half the faces where that is
    /// proven to be enough. `proofs` may be empty if faces are asked for.
    ///
    /// # Panics
    ///
    /// Panics if no faces are asked for and there is not one proof per shell.
    #[must_use]
    pub fn choose(
        mesh: &Mesh,
        shells: &Shells,
        proofs: &[ShellProof],
        light: &Light,
        asked: Option<CasterFaces>,
    ) -> Self {
        let choices = match asked {
            Some(faces) => vec![Choice::new(faces, why_asked(faces)); shells.count],
            None => {
                assert_eq!(proofs.len(), shells.count, "one proof a shell");
                let places = light_places(mesh, shells, proofs, light);
                proofs.iter().zip(places).map(|(&proof, place)| choose(proof, place)).collect()
            }
        };
        Self { choices }
    }

    /// The sign that each face casts with: one entry per face.
    ///
    /// # Panics
    ///
    /// Panics if `shells` or `facing` belong to another mesh.
    #[must_use]
    pub fn signs(&self, shells: &Shells, facing: &[Facing]) -> Vec<i8> {
        assert_eq!(shells.of_face.len(), facing.len(), "one facing a face");
        let sign = |(shell, &facing): (&Option<u32>, &Facing)| {
            shell.map_or(0, |shell| self.choices[shell as usize].what.sign(facing))
        };
        shells.of_face.iter().zip(facing).map(sign).collect()
    }

    /// The sides on which each face casts, whatever the light: one entry per face, as [`CasterFaces::mask`].
    ///
    /// # Panics
    ///
    /// Panics if `shells` belong to another mesh.
    #[must_use]
    pub fn masks(&self, shells: &Shells) -> Vec<u8> {
        let mask = |shell: &Option<u32>| shell.map_or(0, |shell| self.choices[shell as usize].what.mask());
        shells.of_face.iter().map(mask).collect()
    }
}

impl Caster {
    /// Which faces cast from `light`, shell by shell: see [`ShellFaces::choose`].
    #[must_use]
    pub fn shell_faces(&self, light: &Light, asked: Option<CasterFaces>) -> ShellFaces {
        let proofs = if asked.is_none() { self.proofs() } else { &[] };
        ShellFaces::choose(self.mesh(), self.shells(), proofs, light, asked)
    }

    /// The shadow volume of `light`: half the faces of a shell where that is proven to be enough, else all.
    ///
    /// For light after light, an [`Extruder`](super::Extruder) does the same in memory that is kept.
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

/// `place` is where the light is with respect to a sound shell.
fn choose(proof: ShellProof, place: Option<LightPlace>) -> Choice<CasterFaces> {
    let why = match (proof, place) {
        (ShellProof::NotWatertight, _) => Reason::NotWatertight,
        (ShellProof::ZeroAreaFace, _) => Reason::ZeroAreaFace,
        (ShellProof::MeetsItself, _) => Reason::MeetsItself,
        (ShellProof::Unsettled, _) => Reason::Unsettled,
        (ShellProof::NoVolume, _) => Reason::NoVolume,
        (_, None | Some(LightPlace::OnShell)) => Reason::LightOnShell,
        (ShellProof::Outward, Some(LightPlace::Winding(0))) => {
            return Choice::new(CasterFaces::Front, Reason::FrontFacesSuffice);
        }
        (ShellProof::Inward, Some(LightPlace::Winding(0))) => {
            return Choice::new(CasterFaces::Back, Reason::BackFacesSuffice);
        }
        (_, Some(LightPlace::Winding(winding))) => Reason::LightInside { winding },
    };
    Choice::new(CasterFaces::All, why)
}

/// How often each sound shell winds around the light; shells that are not sound are not looked at.
fn light_places(
    mesh: &Mesh,
    shells: &Shells,
    proofs: &[ShellProof],
    light: &Light,
) -> Vec<Option<LightPlace>> {
    let place = |proof: &ShellProof| proof.is_sound().then_some(LightPlace::Winding(0));
    let mut places: Vec<Option<LightPlace>> = proofs.iter().map(place).collect();
    if light.is_directional() {
        return places; // nothing winds around infinity
    }
    let mut open: Vec<bool> = proofs.iter().map(|proof| proof.is_sound()).collect();
    const TRIES: u32 = 16;
    for direction in (0..TRIES).map(scattered) {
        if !open.contains(&true) {
            return places;
        }
        let target = Light::directional(direction).expect("scattered directions are not zero");
        let mut sums = vec![0; shells.count];
        let mut tie = vec![false; shells.count];
        let mut on = vec![false; shells.count];
        for (face, shell) in shells.of_face.iter().enumerate() {
            let Some(shell) = shell.map(|shell| shell as usize).filter(|&shell| open[shell]) else {
                continue;
            };
            let corners = mesh.corners(FaceId::new(face)).map(Homogeneous::point);
            match crossing(corners, Homogeneous::light(light), Homogeneous::light(&target)) {
                Crossing::Miss => {}
                Crossing::Through(sign) => sums[shell] += sign,
                Crossing::Starts => on[shell] = true,
                Crossing::Tie => tie[shell] = true,
            }
        }
        for shell in (0..shells.count).filter(|&shell| open[shell]).collect::<Vec<_>>() {
            if on[shell] {
                places[shell] = Some(LightPlace::OnShell);
            } else if !tie[shell] {
                places[shell] = Some(LightPlace::Winding(sums[shell]));
            }
            open[shell] = tie[shell] && !on[shell];
        }
    }
    for shell in (0..shells.count).filter(|&shell| open[shell]) {
        places[shell] = Some(LightPlace::OnShell);
    }
    places
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::check::CrackReport;
    use crate::topology::Topology;

    /// Two cones of so many faces each, base to base: all of a cone reach its apex.
    fn double_cone(sides: u32) -> Mesh {
        let rim = (0..sides).map(|i| {
            let (sin, cos) = (f64::from(i) * std::f64::consts::TAU / f64::from(sides)).sin_cos();
            [cos as f32, sin as f32, 0.0]
        });
        let positions = rim.chain([[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]]).collect();
        let faces = (0..sides).flat_map(|i| {
            let next = (i + 1) % sides;
            [[i, next, sides], [next, i, sides + 1]]
        });
        Mesh::new(positions, faces.collect()).unwrap()
    }

    #[test]
    fn plan_shells_that_would_each_take_seconds_share_one_allowance() {
        let one = double_cone(1500);
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
        let plan = ShellFaces::choose(&two, &shells[1], &proofs, &light, None);
        assert_eq!(plan.choices[0].what, CasterFaces::Front);
        assert_eq!(plan.choices[1].what, CasterFaces::All);
        assert_eq!(plan.choices[1].to_string(), "too many faces reach into one place for a proof");
    }
}
