//! Lights for the facing queries.

use super::{MOST_LIGHTS, Options};
use crate::geom::Light;
use crate::mesh::Mesh;
use crate::random::SplitMix64;
use crate::testing::generate::LightKind;
use crate::verify::points::feature::Feature;

/// Names of the light strata, each with the rule that draws its lights. `None` stands for the lights given by
/// the user. See [`Question::strata`](super::Question::strata).
pub(super) const STRATA: [(&str, Option<LightKind>); 8] = [
    ("given", None),
    ("general", Some(LightKind::Outside)),
    ("vertex", Some(LightKind::On(Feature::Vertex))),
    ("face_plane", Some(LightKind::On(Feature::Plane))),
    ("one_ulp_off", Some(LightKind::UlpOff)),
    ("far", Some(LightKind::FAR)),
    ("axis", Some(LightKind::Axis)),
    ("along_face", Some(LightKind::InPlane)),
];

/// Maximum number of lights per stratum: enough for a mesh of few faces.
const MOST: u64 = 4096;

/// The lights of each stratum for `mesh`, which has at least one face.
pub(super) fn draw(mesh: &Mesh, given: &[Light], options: &Options) -> Vec<Vec<Light>> {
    let count = options.queries.div_ceil(mesh.face_count() as u64).clamp(1, MOST);
    let of_stratum = |(stratum, (_, kind)): (usize, (_, Option<LightKind>))| match kind {
        None => spread(given),
        Some(kind) => {
            let mut random = source(options.seed, stratum);
            (0..count).map(|_| kind.draw(&mut random, mesh)).collect()
        }
    };
    STRATA.into_iter().enumerate().map(of_stratum).collect()
}

/// At most [`MOST_LIGHTS`] of the lights, evenly spaced in the list.
pub(super) fn spread(lights: &[Light]) -> Vec<Light> {
    let count = lights.len().min(MOST_LIGHTS);
    (0..count).map(|i| lights[i * lights.len() / count]).collect()
}

/// A random source for one stratum, different for each stratum.
pub(super) fn source(seed: u64, stratum: usize) -> SplitMix64 {
    SplitMix64(SplitMix64(SplitMix64(seed).next() ^ stratum as u64).next())
}
