//! Silhouettes and volumes of the device against those of the CPU: the same lists, and closed as well.

use umbrage::animate::Pose;
use umbrage::caster::{Caster, GpuCaster, ShellBoxes, ShellProof};
use umbrage::facing::{CasterFaces, classify};
use umbrage::geom::{Aabb, Facing, Light};
use umbrage::gpu::{Gpu, wgpu};
use umbrage::mesh::{FaceId, Mesh, Weld, weld};
use umbrage::scene::{Scene, Scope};
use umbrage::shadow::volume::{Caps, GpuExtrusion, GpuVolume, Part, ShadowVolume, ShellFaces, VolumeShaders};
use umbrage::silhouette::{GpuSilhouette, Silhouette};
use umbrage::testing::shapes;
use umbrage::topology::{GpuTopology, Topology};

use crate::support::{gpu, real_meshes};

/// The positions of a pose go up as those of any caster, and the device finds what the CPU finds.
#[test]
fn gpu_silhouette_of_poses_is_that_of_the_cpu() {
    let Some(device) = device() else { return };
    let ball = shapes::icosphere(2);
    let squeezed = ball.positions().iter().map(|&[x, y, z]| [x * (1.0 - 0.4 * y), 0.5 * y, z + 0.3 * x]);
    let scene = Scene::of(ball.clone().with_frames(vec![squeezed.collect()]).unwrap());
    let light = Light::point([0.4, 2.0, 0.7]).unwrap();
    let mut caster = Caster::new(ball.clone());
    let mut seen = Vec::new();
    for frame in [0.0, 0.35, 1.0] {
        let posed = scene.pose(&Pose::at(frame).fps(1.0)).unwrap().bake(Scope::Mesh).unwrap().remove(0);
        caster.repose(weld(&posed, Weld::Exact).mesh.positions().to_vec()).unwrap();
        let case = Case::new(&device, caster.mesh());
        case.judge(&light, "pose");
        seen.push(caster.facing(&light));
    }
    assert!(seen[0] != seen[1] && seen[1] != seen[2], "each pose has other sides");
}

struct Device {
    gpu: Gpu,
    volumes: VolumeShaders,
}

fn device() -> Option<Device> {
    let gpu = gpu()?;
    let volumes = VolumeShaders::new(&gpu).unwrap();
    Some(Device { gpu, volumes })
}

/// A mesh on the host and on the device.
struct Case<'a> {
    device: &'a Device,
    caster: Caster,
    silhouette: GpuSilhouette,
}

impl<'a> Case<'a> {
    fn new(device: &'a Device, mesh: &Mesh) -> Self {
        let caster = Caster::new(mesh.clone());
        let uploaded = GpuCaster::upload(&device.gpu, &caster).unwrap();
        let silhouette = GpuSilhouette::new(device.volumes.silhouettes(), &uploaded).unwrap();
        Self { device, caster, silhouette }
    }

    /// Compares everything for one light. Returns the number of unsure faces.
    fn judge(&self, light: &Light, what: &str) -> usize {
        let mesh = self.caster.mesh();
        let facing = self.caster.facing(light);
        self.silhouette.set_masks(&vec![CasterFaces::All.mask(); mesh.face_count()]).unwrap();
        let found = self.silhouette.find(mesh, light).unwrap();
        assert!(self.silhouette.download_facing().unwrap() == facing, "{what} {light}: other sides");
        self.judge_volume(light, &CasterFaces::All.signs(&facing), &found.silhouette, Caps::Both, what);

        self.silhouette.set_masks(&vec![CasterFaces::Front.mask(); mesh.face_count()]).unwrap();
        let outline = self.silhouette.extract().unwrap();
        self.judge_volume(light, &CasterFaces::Front.signs(&facing), &outline, Caps::None, what);
        found.unsure_faces
    }

    /// Compares the device's silhouette for these signs, and the volume extruded from it.
    fn judge_volume(&self, light: &Light, signs: &[i8], found: &Silhouette, caps: Caps, what: &str) {
        let Self { device, caster, silhouette } = self;
        let (mesh, topology) = (caster.mesh(), caster.topology());
        let expected = Silhouette::extract(topology, signs);
        assert!(*found == expected, "{what} {light}: another silhouette");
        let volume = ShadowVolume::extrude(mesh, topology, light, signs, &expected, caps);
        let extruded = GpuVolume::extrude(&device.volumes, silhouette, light, caps).unwrap();
        assert_eq!(parts(&device.gpu, &extruded), parts_of(mesh, &volume), "{what} {light} {caps:?}");
        if caps == Caps::Both {
            assert!(extruded.boundary_sum(&device.gpu).unwrap().is_closed(), "{what} {light}");
        }
    }
}

/// The triangles of a volume on the device. All vertices that a directional light sends to infinity get one
/// id.
fn parts(gpu: &Gpu, volume: &GpuVolume) -> [Vec<[u32; 3]>; 3] {
    let one_far = |id: u32| if volume.light().is_directional() { id.min(volume.vertex_count()) } else { id };
    Part::ALL.map(|part| {
        let triangles = volume.download(gpu, part).unwrap();
        triangles.into_iter().map(|corners| corners.map(one_far)).collect()
    })
}

/// The triangles of a volume, with the vertex ids of [`GpuVolume`].
fn parts_of(mesh: &Mesh, volume: &ShadowVolume) -> [Vec<[u32; 3]>; 3] {
    let count = volume.positions().len() as u32;
    let far = mesh.vertex_count() as u32;
    let id = |index: u32| match index.checked_sub(count) {
        None => volume.casters()[index as usize].0,
        Some(_) if volume.light().is_directional() => far,
        Some(base) => far + volume.casters()[base as usize].0,
    };
    let part = |range: std::ops::Range<usize>| {
        volume.triangles()[range].iter().map(|corners| corners.map(id)).collect()
    };
    [part(volume.light_cap()), part(volume.sides()), part(volume.dark_cap())]
}

/// Lights: outside, on a vertex, and directional along an axis.
fn lights(mesh: &Mesh) -> [Light; 3] {
    let [low, high] = mesh.bounds().expect("it has faces");
    let bounds = Aabb { low, high };
    let (center, size) = (bounds.center(), bounds.diagonal() as f32);
    let size = size.min(f32::MAX / 4.0);
    [
        Light::point([center[0] + 0.7 * size, center[1] + 1.1 * size, center[2] + 0.4 * size]),
        Light::point(mesh.positions()[mesh.vertex_count() / 2]),
        Light::directional([0.0, -1.0, 0.0]),
    ]
    .map(|light| light.expect("finite and not zero"))
}

#[test]
fn gpu_silhouette_and_volume_of_every_real_mesh_equal_the_processors() {
    let (Some(folder), Some(device)) = (real_meshes(), device()) else { return };
    let mut files: Vec<_> = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.sort();
    let mut judged = 0;
    for file in files {
        let Ok(scene) = umbrage::read::read(&file) else { continue }; // notes and facts, a buffer
        let name = file.file_name().expect("a file").to_string_lossy().into_owned();
        let meshes: Vec<Mesh> =
            scene.bake(Scope::Mesh).unwrap().iter().map(|mesh| weld(mesh, Weld::Exact).mesh).collect();
        let mesh = Mesh::concat(&meshes).unwrap();
        let case = Case::new(&device, &mesh);
        let unsure = lights(&mesh).map(|light| case.judge(&light, &name));
        eprintln!("{name}: {} faces, unsure {unsure:?}", mesh.face_count());
        judged += 1;
    }
    assert_eq!(judged, 29);
}

/// A mesh with coincident corners, and one more face.
fn collapsed() -> Mesh {
    let positions = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.3, 0.7, 0.11]];
    let triangles = vec![[0, 0, 1], [1, 3, 3], [0, 1, 2], [2, 1, 2], [3, 3, 3], [1, 3, 2]];
    Mesh::new(positions, triangles).unwrap().with_name("collapsed")
}

#[test]
fn gpu_silhouette_and_volume_of_hard_meshes_equal_the_processors() {
    let Some(device) = device() else { return };
    let sphere = shapes::icosphere(2);
    let meshes = [
        shapes::mobius(24),
        shapes::book(18),
        shapes::double_sheet(),
        shapes::duplicated_face(),
        shapes::misoriented_cube(),
        shapes::collinear_face(),
        shapes::sliver(),
        shapes::uv_capsule(8, 2, 1.0, 0.5),
        shapes::shuffled(&shapes::torus(24, 16, 2.0, 0.7), 7),
        shapes::soup(&sphere),
        shapes::menger_sponge(2),
        collapsed(),
        Mesh::new(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]]).unwrap(),
        Mesh::new(vec![], vec![]).unwrap(),
        Mesh::new(vec![[1.0; 3]; 3], vec![[0, 1, 2]]).unwrap(),
        shapes::scaled(&sphere, 1e-30),
        shapes::scaled(&sphere, 1e-42), // subnormal
        shapes::scaled(&sphere, 1e30),
        shapes::scaled(&shapes::cube(), f32::MAX),
        shapes::translated(&shapes::scaled(&sphere, 1e-4), [4096.0, -4096.0, 1.0]),
    ];
    let everywhere = ["point:0,0,0", "point:3,4,5", "point:1099511627776,0,1", "directional:1,-2,3"];
    let everywhere: Vec<Light> = everywhere.iter().map(|light| light.parse().unwrap()).collect();
    for mesh in &meshes {
        let case = Case::new(&device, mesh);
        let own = if mesh.face_count() > 0 { lights(mesh).to_vec() } else { Vec::new() };
        for light in everywhere.iter().chain(&own) {
            case.judge(light, &mesh.name);
        }
    }
}

#[test]
fn gpu_silhouette_of_a_plan_casts_shell_by_shell() {
    let Some(device) = device() else { return };
    let outward = shapes::translated(&shapes::icosphere(2), [5.0, 0.0, 0.0]);
    let mesh = Mesh::concat(&[shapes::inside_out(&shapes::cube()), outward, shapes::mobius(12)]).unwrap();
    let case = Case::new(&device, &mesh);
    let shells = case.caster.shells();
    let proofs = ShellProof::of(&mesh, case.caster.topology(), shells);
    for light in ["point:3,14,5", "point:0.1,0.2,0.3", "directional:-1,-2,0.5"] {
        let light: Light = light.parse().unwrap();
        let plan = ShellFaces::choose(&mesh, &ShellBoxes::new(&mesh, shells), &proofs, &light, None);
        case.silhouette.set_masks(&plan.masks(shells)).unwrap();
        let found = case.silhouette.find(&mesh, &light).unwrap();
        let signs = plan.signs(shells, &classify(&mesh, &light));
        case.judge_volume(&light, &signs, &found.silhouette, Caps::Both, "a plan");
    }
}

#[test]
fn gpu_silhouette_recorded_with_its_volume_is_closed_even_where_f32_is_wrong() {
    let Some(device) = device() else { return };
    let mesh = shapes::menger_sponge(2);
    let case = Case::new(&device, &mesh);
    // The light lies in many planes; f32 puts the light on one side of some and on the other side of others.
    let light = Light::point(mesh.positions()[mesh.vertex_count() / 2]).unwrap();
    let extrusion = GpuExtrusion::of(&device.volumes, &case.silhouette, Caps::Both, None).unwrap();
    let mut encoder = device.gpu.device().create_command_encoder(&Default::default());
    let volume = extrusion.record(&mut encoder, &light).unwrap();
    device.gpu.queue().submit([encoder.finish()]);
    assert!(case.silhouette.download_unsure_count().unwrap() > 0);
    assert!(volume.boundary_sum(&device.gpu).unwrap().is_closed());
    assert_eq!(extrusion.download_demand().unwrap().exceeded, 0);
    // Where the filter was sure, f32 was right, face by face.
    let recorded = case.silhouette.download_facing().unwrap();
    let unsure = case.silhouette.download_unsure().unwrap();
    assert_eq!(unsure.len(), case.silhouette.download_unsure_count().unwrap());
    let exact = classify(&mesh, &light);
    for (face, (recorded, exact)) in recorded.iter().zip(&exact).enumerate() {
        assert!(recorded == exact || unsure.binary_search(&FaceId::new(face)).is_ok(), "face {face}");
    }
}

#[test]
fn gpu_silhouette_longer_than_one_read_back_is_read_back_whole() {
    let Some(device) = device() else { return };
    // More unsure faces, and more edges, than the first copy transfers.
    let sponge = shapes::menger_sponge(3);
    let case = Case::new(&device, &sponge);
    let light = "directional:0,0,-1".parse().unwrap();
    assert!(case.silhouette.find(&sponge, &light).unwrap().unsure_faces > 4095);
    case.judge(&light, "menger sponge 3");
    let soup = shapes::soup(&shapes::icosphere(5));
    let case = Case::new(&device, &soup);
    let light = "point:3,4,5".parse().unwrap();
    assert!(case.silhouette.find(&soup, &light).unwrap().silhouette.edges.len() > 16_384);
    case.judge(&light, "soup");
}

#[test]
fn gpu_silhouette_of_positions_that_change_follows_them() {
    let Some(device) = device() else { return };
    let mesh = shapes::icosphere(3);
    let topology = Topology::of(&mesh);
    let positions: Vec<f32> = mesh.positions().concat();
    let bytes: Vec<u8> = positions.iter().flat_map(|x| x.to_ne_bytes()).collect();
    let vertices = device.gpu.device().create_buffer(&wgpu::BufferDescriptor {
        label: None,
        size: bytes.len() as u64,
        usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    let uploaded = GpuTopology::upload(&device.gpu, &topology).unwrap();
    let caster = GpuCaster::deforming(&device.gpu, vertices.clone(), 1.0, uploaded);
    let silhouette = GpuSilhouette::new(device.volumes.silhouettes(), &caster).unwrap();
    let light = Light::point([3.0, 4.125, 5.5]).unwrap();
    for stretch in [1.0, 0.4] {
        let (moved, triangles, ..) = mesh.clone().into_parts();
        let moved = moved.into_iter().map(|[x, y, z]| [x, y * stretch, z + 0.1 * x]).collect();
        let moved = Mesh::new(moved, triangles).unwrap();
        let bytes: Vec<u8> = moved.positions().iter().flatten().flat_map(|x| x.to_ne_bytes()).collect();
        device.gpu.queue().write_buffer(&vertices, 0, &bytes);
        let mut encoder = device.gpu.device().create_command_encoder(&Default::default());
        silhouette.record(&mut encoder, &light).unwrap();
        device.gpu.queue().submit([encoder.finish()]);
        let facing = classify(&moved, &light);
        assert_eq!(silhouette.download_facing().unwrap(), facing, "in general position f32 is right");
        let expected = Silhouette::extract(&topology, &CasterFaces::All.signs(&facing));
        assert_eq!(silhouette.extract().unwrap(), expected);
        assert!(facing.contains(&Facing::Front) && facing.contains(&Facing::Back));
    }
}
