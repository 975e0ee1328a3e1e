//! Sides of faces, silhouettes, volumes and winding numbers, each against a naive reference.

use std::collections::BTreeMap;

use umbrage::caster::{ShellBoxes, ShellProof};
use umbrage::facing::{CasterFaces, FacePlanes, classify};
use umbrage::geom::{Aabb, Facing, Light};
use umbrage::mesh::{FaceId, Mesh, Weld, weld};
use umbrage::oracle::{Intersection, Oracle};
use umbrage::shadow::volume::{Caps, ShadowVolume, ShellFaces, WindingIndex, winding_number};
use umbrage::silhouette::Silhouette;
use umbrage::testing::generate::{Bytes, Draw, light, mesh, point};
use umbrage::topology::Topology;

use super::{naive, whole};

pub(crate) fn run(data: &[u8]) {
    let bytes = &mut Bytes::new(data);
    let (mesh, light, points) = drawn(bytes);
    let facing = FacePlanes::new(&mesh).classify(&mesh, &light);
    judge(&mesh, &light, &points, &facing);

    // Any signs: the volume is closed, and counts as they say. Only faces that the light lies on (here: that
    // are edge-on, with the light in their box) do not cast: at such a face no direction is away from the
    // light.
    let holds_light = |face: usize| {
        let corners = mesh.corners(FaceId::new(face));
        let in_box = !light.is_directional() && Aabb::around(corners).contains(light.xyz());
        in_box && facing[face] == Facing::EdgeOn
    };
    let sign = |face| if holds_light(face) { 0 } else { bytes.below(3) as i8 - 1 };
    let any: Vec<i8> = (0..mesh.face_count()).map(sign).collect();
    judge_signs(&mesh, &light, &points, &facing, &any);
}

/// A mesh without doubled vertices, a light, and points.
pub(crate) fn drawn(bytes: &mut Bytes) -> (Mesh, Light, Vec<[f32; 3]>) {
    let mesh = weld(&mesh(bytes), Weld::Exact).mesh;
    let light = light(bytes, &mesh);
    let points = (0..1 + bytes.below(6)).map(|_| point(bytes, &mesh, &light)).collect();
    (mesh, light, points)
}

/// Panics unless the volume of any signs is closed and counts as they say.
pub(crate) fn judge_signs(mesh: &Mesh, light: &Light, points: &[[f32; 3]], facing: &[Facing], signs: &[i8]) {
    Scene::new(mesh, light, points).judge_volume(signs, facing);
}

/// Panics unless `facing` is right, and so are the volumes made of it.
pub(crate) fn judge(mesh: &Mesh, light: &Light, points: &[[f32; 3]], facing: &[Facing]) {
    assert_eq!(facing, classify(mesh, light), "filtered, and face by face");
    for (face, facing) in facing.iter().enumerate() {
        let truth = whole::side_of_light(mesh.corners(FaceId::new(face)), light);
        assert_eq!(facing.sign(), truth, "face {face}, by big integers");
    }
    let scene = Scene::new(mesh, light, points);
    for casters in [CasterFaces::All, CasterFaces::Front] {
        scene.judge_volume(&casters.signs(facing), facing);
    }
    // What is in shadow is inside the volume of the chosen faces too.
    let shells = scene.topology.shells();
    let proofs = ShellProof::of(mesh, &scene.topology, &shells);
    let plan = ShellFaces::choose(mesh, &ShellBoxes::new(mesh, &shells), &proofs, light, None);
    let chosen = scene.judge_volume(&plan.signs(&shells, facing), facing);
    for (p, winding) in points.iter().zip(chosen) {
        let crossings = scene.oracle.crossings(*p, light);
        let (crossed, touched) = (crossings.front + crossings.back > 0, crossings.touching > 0);
        if let Some(winding) = winding {
            assert!(
                if crossed { winding > 0 } else { winding == 0 || touched },
                "{p:?}: {winding}, {crossings:?}"
            );
        }
    }
}

/// A mesh under a light, and points in it.
struct Scene<'a> {
    mesh: &'a Mesh,
    light: &'a Light,
    points: &'a [[f32; 3]],
    topology: Topology,
    oracle: Oracle,
}

impl<'a> Scene<'a> {
    fn new(mesh: &'a Mesh, light: &'a Light, points: &'a [[f32; 3]]) -> Self {
        let topology = Topology::of(mesh);
        Self { mesh, light, points, topology, oracle: Oracle::build(mesh) }
    }

    /// Casts the faces with `signs`; returns the winding number at each point.
    fn judge_volume(&self, signs: &[i8], facing: &[Facing]) -> Vec<Option<i32>> {
        let silhouette = Silhouette::extract(&self.topology, signs);
        self.judge_silhouette(signs, &silhouette);
        let volume =
            ShadowVolume::extrude(self.mesh, &self.topology, self.light, signs, &silhouette, Caps::Both);
        assert!(volume.boundary_sum().is_closed(), "{:?}", volume.boundary_sum());
        let drawn = volume.to_f32();
        assert_eq!(drawn.len(), volume.vertex_count());
        assert!(drawn.iter().flatten().all(|x| x.is_finite()));
        assert!(volume.clamped(1000.0).iter().flatten().all(|x| x.is_finite()));

        let index = WindingIndex::build(&volume, Aabb::around(self.points.iter().copied()));
        let judge_point = |&p: &[f32; 3]| {
            let (winding, indexed) = (winding_number(&volume, p), index.number(p));
            if let (Some(winding), Some(indexed)) = (winding, indexed) {
                assert_eq!(winding, indexed, "all triangles and the tree, {p:?}");
            }
            // A face that is crossed counts with its sign and side; one that is touched may.
            let (mut low, mut high) = (0, 0);
            self.oracle.for_each_meeting(p, self.light, |face, meeting| {
                let count = i32::from(signs[face.index()]) * i32::from(facing[face.index()].sign());
                let touched = meeting == Intersection::Touching;
                low += if touched { count.min(0) } else { count };
                high += if touched { count.max(0) } else { count };
            });
            let winding = winding.or(indexed);
            assert!(
                winding.is_none_or(|w| (low..=high).contains(&w)),
                "{p:?} to {}: {winding:?}, not {low}..={high}; {signs:?} on {:?}",
                self.light,
                self.mesh
            );
            winding
        };
        self.points.iter().map(judge_point).collect()
    }

    /// The silhouette is the sum over all directed uses of each edge.
    fn judge_silhouette(&self, signs: &[i8], silhouette: &Silhouette) {
        let mut sums = BTreeMap::new();
        for (face, tail, head) in naive::half_edges(self.mesh.triangles()) {
            let way = if tail < head { 1 } else { -1 };
            *sums.entry([tail.min(head), tail.max(head)]).or_insert(0) += way * i32::from(signs[face]);
        }
        sums.retain(|_, sum| *sum != 0);
        let found: Vec<([u32; 2], i32)> = silhouette
            .edges
            .iter()
            .map(|edge| (self.topology.vertices(edge.edge).map(|vertex| vertex.0), edge.multiplicity))
            .collect();
        assert_eq!(found, sums.into_iter().collect::<Vec<_>>());
        let in_loops = silhouette.loops(&self.topology).iter().map(Vec::len).sum::<usize>();
        assert_eq!(in_loops, found.len());
    }
}
