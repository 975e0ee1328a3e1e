//! Tree, certificates and the finder against the linear scan, on whole meshes.

use umbrage::facing::{CasterFaces, FacePlanes, classify};
use umbrage::geom::{Aabb, Light};
use umbrage::mesh::{FaceId, Mesh, Weld, weld};
use umbrage::scene::Scope;
use umbrage::silhouette::{
    KineticSilhouette, KineticStep, Silhouette, SilhouetteFinder, SilhouetteMethod, SilhouetteTree,
    TreeSearch,
};
use umbrage::testing::shapes;
use umbrage::topology::Topology;

use crate::support::real_meshes;

/// How often each method was used.
#[derive(Debug, Default)]
struct Taken {
    searched: usize,
    scanned: usize,
    followed: usize,
}

/// Lights: outside, inside, on a vertex, in the plane of a face and one ulp off, far away, directional.
fn lights(mesh: &Mesh) -> Vec<Light> {
    let [low, high] = mesh.bounds().expect("it has faces");
    let bounds = Aabb { low, high };
    let (center, size) = (bounds.center(), bounds.diagonal() as f32);
    let size = size.min(f32::MAX / 8.0);
    let at = |x: f32, y: f32, z: f32| [center[0] + x * size, center[1] + y * size, center[2] + z * size];
    let [a, b, c] = mesh.corners(FaceId::new(mesh.face_count() / 2));
    let in_plane = [0, 1, 2].map(|i| 0.5 * a[i] + 0.25 * b[i] + 0.25 * c[i]);
    let points = [
        at(0.7, 1.1, 0.4),
        at(-4.0, 2.0, 3.0),
        center,
        a,
        in_plane,
        in_plane.map(f32::next_up),
        [1e30, -1e20, 0.0],
    ];
    let travels = [[0.0, -1.0, 0.0], [1.0, 0.3, -0.2]];
    let points = points.map(|point| point.map(|x| x.clamp(f32::MIN, f32::MAX)));
    let points = points.into_iter().map(|point| Light::point(point).expect("finite"));
    points.chain(travels.map(|travel| Light::directional(travel).expect("not zero"))).collect()
}

/// Light `i` of a walk: small steps past a mesh, a rest, a jump, and small steps again.
fn walk(mesh: &Mesh, i: u16) -> Light {
    let [low, high] = mesh.bounds().expect("it has faces");
    let bounds = Aabb { low, high };
    let (center, size) = (bounds.center(), (bounds.diagonal() as f32).min(f32::MAX / 8.0));
    let (jump, i) = (if i > 12 { 1.5 } else { 0.0 }, f32::from(if i == 7 { 6 } else { i }));
    let way = [0.6, 0.2 + jump + 1e-4 * i, 0.5 - 2e-5 * i];
    Light::point([0, 1, 2].map(|axis| center[axis] + way[axis] * size)).expect("finite")
}

/// Compares every method with the scan.
fn judge(mesh: &Mesh, taken: &mut Taken) {
    let topology = Topology::of(mesh);
    let planes = FacePlanes::new(mesh);
    let mut tree = SilhouetteTree::new(mesh, &topology);
    for light in lights(mesh) {
        let facing = classify(mesh, &light);
        assert!(planes.classify(mesh, &light) == facing, "{} {light}: other sides", mesh.name);
        for casters in [CasterFaces::All, CasterFaces::Front] {
            let expected = Silhouette::extract(&topology, &casters.signs(&facing));
            let (found, search) = tree.search(mesh, &topology, &light, casters);
            assert!(found == expected, "{} {light} {casters:?}: another silhouette, {search:?}", mesh.name);
            match search {
                TreeSearch::Searched { .. } => taken.searched += 1,
                TreeSearch::Scanned | TreeSearch::Crowded => taken.scanned += 1,
            }
        }
    }
    let casters = CasterFaces::All;
    let mut moving = KineticSilhouette::new(mesh, &topology, &mut tree, &walk(mesh, 0), casters);
    let mut finder = SilhouetteFinder::new(mesh, &topology, casters, usize::MAX);
    for light in (0..20).map(|i| walk(mesh, i)).chain(lights(mesh)) {
        let expected = Silhouette::extract(&topology, &casters.signs(&planes.classify(mesh, &light)));
        let step = moving.step(mesh, &topology, &mut tree, &light);
        assert!(moving.silhouette() == expected, "{} {light}: another silhouette, {step:?}", mesh.name);
        taken.followed += usize::from(matches!(step, KineticStep::Followed { .. }));
        let found = finder.find(mesh, &topology, &light);
        assert!(finder.edges().eq(expected.edges.iter().copied()), "{} {light}: {found:?}", mesh.name);
    }
}

#[test]
fn silhouette_by_every_way_is_that_of_the_scan_on_generated_meshes() {
    let sphere = shapes::icosphere(4);
    let meshes = [
        shapes::cube(),
        shapes::tetrahedron(),
        shapes::octahedron(),
        sphere.clone(),
        shapes::torus(60, 40, 2.0, 0.7),
        shapes::icosphere(6),
        shapes::torus(240, 160, 2.0, 0.7),
        shapes::shuffled(&shapes::torus(200, 150, 2.0, 0.7), 3),
        shapes::torus_knot(2, 3, 120, 12, 0.3),
        shapes::shuffled(&shapes::torus(60, 40, 2.0, 0.7), 7),
        shapes::hollow_cube(),
        shapes::nested_cubes(20),
        shapes::figure_eight_prism(),
        shapes::open_cube(),
        shapes::misoriented_cube(),
        shapes::duplicated_face(),
        shapes::t_junction(),
        shapes::collinear_face(),
        shapes::seam(1),
        shapes::sliver(),
        shapes::sheet(20),
        shapes::double_sheet(),
        shapes::mobius(24),
        shapes::book(18),
        shapes::uv_capsule(24, 8, 1.0, 0.5),
        shapes::menger_sponge(2),
        shapes::cubes_sharing_edge(),
        shapes::cubes_sharing_vertex(),
        shapes::inside_out(&sphere),
        shapes::soup(&shapes::icosphere(2)),
        shapes::scaled(&sphere, 1e-30),
        shapes::scaled(&sphere, 1e-42), // subnormal
        shapes::scaled(&sphere, 1e30),
        shapes::scaled(&shapes::cube(), f32::MAX),
        shapes::translated(&shapes::scaled(&sphere, 1e-4), [4096.0, -4096.0, 1.0]),
        Mesh::new(vec![[1.0; 3]; 3], vec![[0, 1, 2]]).unwrap(),
        Mesh::new(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2], [0, 0, 1]]).unwrap(),
    ];
    let mut taken = Taken::default();
    for mesh in &meshes {
        judge(mesh, &mut taken);
    }
    assert!(taken.searched > 60 && taken.scanned > 100 && taken.followed > 100, "{taken:?}");
}

#[test]
fn silhouette_of_an_empty_mesh_is_empty_by_every_way() {
    let mesh = Mesh::new(vec![], vec![]).unwrap();
    let topology = Topology::build(0, vec![]);
    let mut tree = SilhouetteTree::new(&mesh, &topology);
    let [a, b] = [1.0, 2.0].map(|x| Light::point([x, 0.0, 0.0]).unwrap());
    assert_eq!(tree.silhouette(&mesh, &topology, &a, CasterFaces::All), Silhouette::default());
    let mut moving = KineticSilhouette::new(&mesh, &topology, &mut tree, &a, CasterFaces::All);
    moving.step(&mesh, &topology, &mut tree, &b);
    assert!(moving.is_empty() && moving.changes().is_empty());
    let mut finder = SilhouetteFinder::new(&mesh, &topology, CasterFaces::All, usize::MAX);
    assert_eq!(finder.find(&mesh, &topology, &a).what, SilhouetteMethod::Scan);
    assert_eq!(finder.edges().count(), 0);
}

#[test]
fn silhouette_by_every_way_is_that_of_the_scan_on_real_meshes() {
    let Some(folder) = real_meshes() else { return };
    let mut files: Vec<_> = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.sort();
    let (mut judged, mut taken) = (0, Taken::default());
    for file in files {
        let Ok(scene) = umbrage::read::read(&file) else { continue }; // notes and facts, a buffer
        let meshes: Vec<Mesh> =
            scene.bake(Scope::Mesh).unwrap().iter().map(|mesh| weld(mesh, Weld::Exact).mesh).collect();
        judge(&Mesh::concat(&meshes).unwrap(), &mut taken);
        judged += 1;
    }
    assert_eq!(judged, 29);
    assert!(taken.searched > 50 && taken.scanned > 20 && taken.followed > 200, "{taken:?}");
}
