//! Figures of a mesh under one light, and the number of faces between given points and the light.

use umbrage::caster::Caster;
use umbrage::check::{Counts, CrackReport};
use umbrage::facing::{CasterFaces, FacePlanes, classify};
use umbrage::geom::Light;
use umbrage::mesh::Mesh;
use umbrage::oracle::Oracle;
use umbrage::shadow::volume::{Caps, ShadowVolume, winding_number};
use umbrage::silhouette::Silhouette;
use umbrage::topology::Topology;
use umbrage::verify::points::{Options, Verifier};
use umbrage::verify::reference;

pub(super) fn topology(mesh: &Mesh) -> Topology {
    let topology = Topology::of(mesh);
    topology.validate();
    topology
}

pub(super) fn report(mesh: &Mesh) -> CrackReport {
    CrackReport::of(mesh, &topology(mesh))
}

pub(super) fn counts(mesh: &Mesh) -> Counts {
    report(mesh).counts
}

pub(super) fn point(x: f32, y: f32, z: f32) -> Light {
    Light::point([x, y, z]).unwrap()
}

/// A directional light that travels along (x, y, z).
pub(super) fn sun(x: f32, y: f32, z: f32) -> Light {
    Light::directional([x, y, z]).unwrap()
}

/// The silhouette and the volume of the faces selected by `casters`.
pub(super) fn cast(mesh: &Mesh, light: &Light, casters: CasterFaces) -> (Silhouette, ShadowVolume) {
    let (topology, signs) = (topology(mesh), casters.signs(&classify(mesh, light)));
    let silhouette = Silhouette::extract(&topology, &signs);
    let volume = ShadowVolume::extrude(mesh, &topology, light, &signs, &silhouette, Caps::Both);
    (silhouette, volume)
}

pub(super) fn shadow(mesh: &Mesh, light: &Light) -> ShadowVolume {
    cast(mesh, light, CasterFaces::All).1
}

/// Faces in front, behind and edge-on; number of silhouette edges; sum of the magnitudes of their
/// multiplicities.
pub(super) type Figures = ([usize; 3], usize, usize);

/// The figures of a mesh with all its faces casting. Consequences of the figures are asserted too: both
/// methods agree on the sides, the volume has the expected number of triangles, and the volume is closed.
pub(super) fn figures(mesh: &Mesh, light: &Light) -> Figures {
    let facing = classify(mesh, light);
    assert_eq!(FacePlanes::new(mesh).classify(mesh, light), facing, "{} {light}", mesh.name);
    let sides = [1, -1, 0].map(|sign| facing.iter().filter(|facing| facing.sign() == sign).count());
    let (silhouette, volume) = cast(mesh, light, CasterFaces::All);
    let sum = silhouette.edges.iter().map(|edge| edge.multiplicity.unsigned_abs() as usize).sum();
    let cap = sides[0] + sides[1];
    let expected = if light.is_directional() { [cap, sum, 0] } else { [cap, 2 * sum, cap] };
    let parts = [volume.light_cap(), volume.sides(), volume.dark_cap()].map(|part| part.len());
    assert_eq!(parts, expected, "light cap, sides and dark cap of {} {light}", mesh.name);
    assert!(volume.boundary_sum().is_closed(), "{} {light}: {:?}", mesh.name, volume.boundary_sum());
    (sides, silhouette.edges.len(), sum)
}

/// Asserts a table of figures; the message names the mesh of a wrong row.
pub(super) fn expect_figures(rows: &[(&Mesh, Light, Figures)]) {
    for (mesh, light, expected) in rows {
        assert_eq!(figures(mesh, light), *expected, "{} {light}", mesh.name);
    }
}

/// Asserts the number of faces between each point and the light: by the ray cast, by big integers, and by the
/// winding number of the volume.
pub(super) fn expect_crossings(mesh: &Mesh, light: &Light, points: &[([f32; 3], u32)]) {
    let (oracle, volume) = (Oracle::build(mesh), shadow(mesh, light));
    for &(p, expected) in points {
        let crossings = oracle.crossings(p, light);
        let what = format!("{} {light} at {p:?}", mesh.name);
        assert_eq!(crossings.front + crossings.back, expected, "{what}: {crossings:?}");
        assert_eq!(crossings.touching, 0, "{what}");
        assert_eq!(reference(mesh, p, light).crossings, crossings, "{what}");
        assert_eq!(winding_number(&volume, p), Some(expected as i32), "{what}");
    }
}

/// Asserts that no method contradicts another at adversarial points.
pub(super) fn expect_agreement(mesh: &Mesh, light: &Light) {
    let options = Options { points: 250, ..Options::default() };
    let found = Verifier::new(&Caster::new(mesh.clone())).verify(light, &options, &|_| {});
    assert!(found.agrees(), "{} {light}: {:?} {:?}", mesh.name, found.judges, found.disagreements);
    assert_eq!(found.total().points, 250);
}

/// The winding number of a point in a volume made by another rule.
pub(super) fn winding(mesh: &Mesh, light: &Light, casters: CasterFaces, p: [f32; 3]) -> Option<i32> {
    winding_number(&cast(mesh, light, casters).1, p)
}
