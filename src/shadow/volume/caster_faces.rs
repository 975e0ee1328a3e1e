//! Which faces of which shell cast: half the geometry where that is proven to be enough, all of it elsewhere.
//!
//! With front faces only, the volume counts `(crossed + w)/2` at a point of winding number `w`: in or out exactly
//! if `w` is nowhere negative, the shell is balanced, and the light is in none of its volume and not on it. A
//! watertight shell that does not meet itself and whose volume is positive has `w` ∈ {0, 1} everywhere. With a
//! negative volume the same holds with all signs turned. Anything less is not proof: a figure-eight prism is
//! watertight and may have a positive volume, and its other lobe would stay lit.

use std::fmt;

use super::winding::{Crossing, crossing, scattered};
use crate::caster::ShellProof;
use crate::facing::{CASTS_BEHIND, CASTS_IN_FRONT};
use crate::geom::Facing;
use crate::geom::Light;
use crate::geom::predicate::Homogeneous;
use crate::mesh::{FaceId, Mesh};
use crate::topology::Shells;

/// Which faces of a shell cast.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Variant {
    /// Every face that is not edge-on, with its sign. Right for any mesh.
    General,
    /// Front faces only.
    FrontOnly,
    /// Back faces only: the front faces of a shell whose faces look inwards.
    BackOnly,
}

impl Variant {
    /// Lower-case name, as in reports.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::General => "general",
            Self::FrontOnly => "front",
            Self::BackOnly => "back",
        }
    }

    /// The sign that a face of the shell casts with.
    #[inline]
    #[must_use]
    pub fn sign(self, facing: Facing) -> i8 {
        match self {
            Self::General => facing.sign(),
            Self::FrontOnly => facing.sign().max(0),
            Self::BackOnly => facing.sign().min(0),
        }
    }

    /// Which sides a face of the shell casts on, as bits: [`CASTS_IN_FRONT`], [`CASTS_BEHIND`].
    #[inline]
    #[must_use]
    pub fn mask(self) -> u8 {
        match self {
            Self::General => CASTS_IN_FRONT | CASTS_BEHIND,
            Self::FrontOnly => CASTS_IN_FRONT,
            Self::BackOnly => CASTS_BEHIND,
        }
    }
}

/// What the caller wants cast.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Faces {
    /// Half the faces where that is proven to be enough.
    #[default]
    Auto,
    /// The general form everywhere.
    All,
    /// Front faces everywhere, proven or not.
    Front,
}

/// Where a light is with respect to one shell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LightPlace {
    /// The shell winds this often around the light.
    Winding(i32),
    /// On a face of the shell, or so aligned with it that it could not be told.
    OnShell,
}

/// What was chosen for one shell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ShellChoice {
    /// Which faces cast.
    pub variant: Variant,
    /// What was asked for.
    pub faces: Faces,
    /// What is known of the shell; `None` where nothing needed proof.
    pub proof: Option<ShellProof>,
    /// Where the light is; `None` where that was not looked at.
    pub light: Option<LightPlace>,
}

/// The reason, in words.
impl fmt::Display for ShellChoice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match (self.faces, self.proof, self.light) {
            (Faces::All, ..) => "all faces were asked for",
            (Faces::Front, ..) => "front faces were asked for; nothing is proven",
            (_, Some(ShellProof::NotWatertight), _) => "the shell is not watertight",
            (_, Some(ShellProof::ZeroAreaFace), _) => "a face of the shell has no area",
            (_, Some(ShellProof::MeetsItself), _) => "the shell meets itself",
            (_, Some(ShellProof::Unsettled), _) => "too many faces reach into one place for a proof",
            (_, Some(ShellProof::NoVolume), _) => "the shell encloses no volume",
            (.., Some(LightPlace::OnShell)) => "the light is on the shell",
            (.., Some(LightPlace::Winding(w))) if w != 0 => "the light is inside the shell",
            (_, Some(ShellProof::Inward), _) => {
                "watertight, faces inwards, does not meet itself, and the light is outside: back faces are enough"
            }
            _ => "watertight, does not meet itself, and the light is outside: front faces are enough",
        })
    }
}

/// Which faces cast, shell by shell, for one light.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Plan {
    /// One choice a shell, in the order of the shells.
    pub choices: Vec<ShellChoice>,
}

impl Plan {
    /// Chooses for every shell. `proofs` may be empty unless `faces` is [`Faces::Auto`].
    ///
    /// # Panics
    ///
    /// Panics if `faces` is [`Faces::Auto`] and there is not one proof a shell.
    #[must_use]
    pub fn choose(mesh: &Mesh, shells: &Shells, proofs: &[ShellProof], light: &Light, faces: Faces) -> Self {
        let plain = |variant| ShellChoice { variant, faces, proof: None, light: None };
        let choices = match faces {
            Faces::All => vec![plain(Variant::General); shells.count],
            Faces::Front => vec![plain(Variant::FrontOnly); shells.count],
            Faces::Auto => {
                assert_eq!(proofs.len(), shells.count, "one proof a shell");
                let places = light_places(mesh, shells, proofs, light);
                let choose = |(&proof, light): (&ShellProof, Option<LightPlace>)| {
                    let outside = light == Some(LightPlace::Winding(0));
                    let variant = match proof {
                        ShellProof::Outward if outside => Variant::FrontOnly,
                        ShellProof::Inward if outside => Variant::BackOnly,
                        _ => Variant::General,
                    };
                    ShellChoice { variant, faces, proof: Some(proof), light }
                };
                proofs.iter().zip(places).map(choose).collect()
            }
        };
        Self { choices }
    }

    /// The sign that each face casts with: one entry a face.
    ///
    /// # Panics
    ///
    /// Panics if `shells` or `facing` belong to another mesh.
    #[must_use]
    pub fn signs(&self, shells: &Shells, facing: &[Facing]) -> Vec<i8> {
        assert_eq!(shells.of_face.len(), facing.len(), "one facing a face");
        let sign = |(shell, &facing): (&Option<u32>, &Facing)| {
            shell.map_or(0, |shell| self.choices[shell as usize].variant.sign(facing))
        };
        shells.of_face.iter().zip(facing).map(sign).collect()
    }

    /// Which sides each face casts on, whatever the light: one entry a face, as [`Variant::mask`].
    ///
    /// # Panics
    ///
    /// Panics if `shells` belong to another mesh.
    #[must_use]
    pub fn masks(&self, shells: &Shells) -> Vec<u8> {
        let mask = |shell: &Option<u32>| shell.map_or(0, |shell| self.choices[shell as usize].variant.mask());
        shells.of_face.iter().map(mask).collect()
    }
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
        let built = |mesh: &Mesh| Topology::build(mesh.vertex_count(), mesh.triangles().to_vec());
        let topologies = [&one, &two].map(built);
        let shells = [0, 1].map(|i| topologies[i].shells());
        let proofs_of_one = |spare| ShellProof::within(&one, &topologies[0], &shells[0], spare);
        assert_eq!(proofs_of_one(0), [ShellProof::Unsettled]);
        let step = 1 << 20;
        let spare = (1..16).map(|k| k * step).find(|&spare| proofs_of_one(spare) == [ShellProof::Outward]);
        let spare = spare.expect("the default is enough");
        assert!(spare > 2 * step, "so that it is not enough for two");

        let proofs = ShellProof::within(&two, &topologies[1], &shells[1], spare);
        assert_eq!(proofs, [ShellProof::Outward, ShellProof::Unsettled]);
        let light = Light::directional([1.0, 2.0, 3.0]).unwrap();
        let plan = Plan::choose(&two, &shells[1], &proofs, &light, Faces::Auto);
        assert_eq!(plan.choices[0].variant, Variant::FrontOnly);
        assert_eq!(plan.choices[1].variant, Variant::General);
        assert_eq!(plan.choices[1].to_string(), "too many faces reach into one place for a proof");
    }
}
