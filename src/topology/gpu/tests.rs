//! Against the edge table that the host builds, word for word.

use super::build::{Found, Size, shader};
use super::*;
use crate::gpu::layout::{assert_layout, members};
use crate::gpu::tests::{gpu, limited_gpu};
use crate::mesh::{Mesh, Weld, weld};
use crate::random::SplitMix64;
use crate::testing::shapes;
use crate::topology::Topology;

type Table = (Vec<u32>, Vec<u32>);

fn on_host(vertices: u32, triangles: &[[u32; 3]]) -> Table {
    let topology = Topology::build(vertices as usize, triangles.to_vec());
    (topology.offsets, topology.entries)
}

fn on_device(gpu: &Gpu, builder: &GpuTopologyBuilder, vertices: u32, triangles: &[[u32; 3]]) -> Table {
    let buffer = gpu.upload("triangles", triangles).unwrap();
    let built = builder.build(gpu, vertices, &buffer, triangles.len() as u32).unwrap();
    assert_eq!((built.face_count, built.vertex_count), (triangles.len() as u32, vertices));
    let table = built.download(gpu).unwrap();
    // Exact sizes: other shaders may ask a buffer how long it is.
    assert_eq!(built.offsets.size(), 4 * table.0.len() as u64);
    assert_eq!(built.entries.size(), 4 * table.1.len().max(1) as u64);
    table
}

/// Triangles over `vertices` vertices, some of which are hubs: any multiplicity, collapsed and equal faces.
fn soup(seed: u64, faces: usize, vertices: usize) -> Vec<[u32; 3]> {
    let mut random = SplitMix64(seed);
    (0..faces)
        .map(|_| {
            std::array::from_fn(|_| {
                let below = if random.below(3) == 0 { vertices.min(4) } else { vertices };
                random.below(below) as u32
            })
        })
        .collect()
}

#[test]
fn gpu_topology_of_soups_equals_the_hosts() {
    let Some(gpu) = gpu() else { return };
    let builder = GpuTopologyBuilder::new(&gpu).unwrap();
    for seed in 0..60 {
        let mut random = SplitMix64(seed);
        let (faces, vertices) = (1 + random.below(600), 1 + random.below(300));
        let triangles = soup(seed, faces, vertices);
        let host = on_host(vertices as u32, &triangles);
        assert_eq!(on_device(&gpu, &builder, vertices as u32, &triangles), host, "seed {seed}");
    }
}

#[test]
fn gpu_topology_of_solids_equals_the_hosts() {
    let Some(gpu) = gpu() else { return };
    let builder = GpuTopologyBuilder::new(&gpu).unwrap();
    let check = |mesh: &Mesh| {
        let vertices = mesh.vertex_count() as u32;
        let host = on_host(vertices, mesh.triangles());
        assert!(on_device(&gpu, &builder, vertices, mesh.triangles()) == host, "{}", mesh.name);
        host.0.len() - 1
    };
    assert_eq!(check(&shapes::cube()), 18);
    check(&shapes::book(18));
    check(&shapes::mobius(12));
    check(&shapes::menger_sponge(2));
    check(&weld(&shapes::uv_capsule(16, 8, 1.0, 2.0), Weld::Exact).mesh); // faces collapse at the poles
    // Indices of more than 16 bits.
    let knot = shapes::shuffled(&shapes::torus_knot(2, 3, 1100, 64, 0.3), 5);
    assert!(knot.vertex_count() > 1 << 16);
    assert_eq!(check(&knot), 3 * knot.face_count() / 2);
}

#[test]
fn gpu_topology_of_next_to_nothing_equals_the_hosts() {
    let Some(gpu) = gpu() else { return };
    let builder = GpuTopologyBuilder::new(&gpu).unwrap();
    let cases: [(u32, &[[u32; 3]]); 8] = [
        (0, &[]),
        (5, &[]),
        (3, &[[0, 1, 2]]),
        (3, &[[2, 1, 0]]),
        (1, &[[0, 0, 0]]),
        (9, &[[8, 8, 1], [3, 5, 3], [2, 7, 7], [4, 4, 4]]),
        (9, &[[8, 8, 1], [3, 8, 5], [2, 7, 7]]),
        (u32::MAX - 1, &[[0, 0, 1]]),
    ];
    for (vertices, triangles) in cases {
        let host = if vertices < 10 { on_host(vertices, triangles) } else { (vec![0], vec![]) }; // else it takes memory
        assert_eq!(on_device(&gpu, &builder, vertices, triangles), host, "{triangles:?} of {vertices}");
    }
}

#[test]
fn gpu_topology_of_more_workgroups_than_a_row_holds_equals_the_hosts() {
    // 16 workgroups at most instead of 65,535²: two-dimensional grids, the last row only in part of use.
    let Some(gpu) = limited_gpu(|limits| limits.max_compute_workgroups_per_dimension = 4) else { return };
    let builder = GpuTopologyBuilder::new(&gpu).unwrap();
    for faces in [85, 86, 110, 300, 341] {
        let triangles = soup(faces, faces as usize, 90);
        assert_eq!(on_device(&gpu, &builder, 90, &triangles), on_host(90, &triangles), "{faces} faces");
    }
}

#[test]
fn gpu_topology_beyond_the_limits_of_the_device_is_refused() {
    let limit = 12 << 10;
    let Some(gpu) = limited_gpu(|limits| limits.max_storage_buffer_binding_size = limit) else { return };
    let builder = GpuTopologyBuilder::new(&gpu).unwrap();
    let build = |faces: u64, face_count: u32| {
        let (size, usage) = (12 * faces, wgpu::BufferUsages::STORAGE);
        let descriptor = wgpu::BufferDescriptor { label: None, size, usage, mapped_at_creation: false };
        let zeros = gpu.device().create_buffer(&descriptor);
        builder.build(&gpu, 1, &zeros, face_count).map(|built| built.edge_count)
    };
    let remedy = "use the processor's method, or a smaller mesh";
    let too_large = |what, bytes| Err(GpuError::TooLarge { what, bytes, limit, remedy });
    assert_eq!(build(1023, 1023), Ok(0));
    // Three keys per face, and one more.
    assert_eq!(build(1024, 1024), too_large("keys of half-edges", limit + 4));
    assert_eq!(build(1024, 1023), Ok(0));
    assert_eq!(build(1025, 1025), too_large("triangles", limit + 12));
    assert_eq!(build(1025, 1), too_large("triangles", limit + 12));
}

#[test]
fn gpu_topology_from_too_few_bits_or_without_a_half_edge_is_caught() {
    let Some(gpu) = gpu() else { return };
    let builder = GpuTopologyBuilder::new(&gpu).unwrap();
    let mesh = shapes::shuffled(&shapes::torus(20, 15, 2.0, 0.75), 3);
    let (vertices, half_edges) = (mesh.vertex_count() as u32, 3 * mesh.face_count());
    let triangles = gpu.upload("triangles", mesh.triangles()).unwrap();
    let table = |half_edges, bits| {
        let (offsets, entries, edges) =
            builder.build_by(&gpu, vertices, &triangles, half_edges, bits).unwrap();
        let offsets: Vec<u32> = gpu.download(&offsets, edges as usize + 1).unwrap();
        let count = offsets[edges as usize] as usize;
        (offsets, gpu.download::<u32>(&entries, count).unwrap())
    };
    let host = on_host(vertices, mesh.triangles());
    assert_eq!(vertices, 300);
    assert_eq!(table(half_edges, 9), host);
    assert_ne!(table(half_edges, 8), host);
    assert_ne!(table(half_edges - 1, 9), host);
}

#[test]
fn gpu_topology_with_an_index_out_of_range_is_refused_by_its_first_face() {
    let Some(gpu) = gpu() else { return };
    let builder = GpuTopologyBuilder::new(&gpu).unwrap();
    let mesh = shapes::menger_sponge(1);
    let vertices = mesh.vertex_count() as u32;
    for bad in [vertices, vertices + 1, 1 << 31, u32::MAX] {
        let mut triangles = mesh.triangles().to_vec();
        triangles[100][2] = bad;
        triangles[50] = [bad, bad, bad]; // collapsed, and still bad
        let buffer = gpu.upload("triangles", &triangles).unwrap();
        let error = builder.build(&gpu, vertices, &buffer, triangles.len() as u32).unwrap_err();
        assert_eq!(error, GpuError::BadIndex { face: 50, vertex_count: vertices });
        // Faces beyond the count do not matter.
        assert!(builder.build(&gpu, vertices, &buffer, 50).is_ok());
    }
    let buffer = gpu.upload("triangles", &[[0_u32, 0, 0]]).unwrap();
    let error = GpuTopology::build(&gpu, 0, &buffer, 1).unwrap_err();
    assert_eq!(error, GpuError::BadIndex { face: 0, vertex_count: 0 });
}

#[test]
fn gpu_topology_of_more_faces_than_the_buffer_holds_is_refused() {
    let Some(gpu) = gpu() else { return };
    let buffer = gpu.upload("triangles", &[[0_u32, 1, 2], [2, 1, 3]]).unwrap();
    let build = |faces| GpuTopology::build(&gpu, 4, &buffer, faces).map(|built| built.edge_count);
    assert_eq!(build(2), Ok(5));
    let too_small = |needed| Err(GpuError::TooSmall { what: "triangles", bytes: 24, needed });
    assert_eq!(build(3), too_small(36));
    assert_eq!(build(u32::MAX), too_small(12 * u64::from(u32::MAX)));
}

#[test]
fn gpu_topology_comes_back_from_the_device_as_it_went() {
    let Some(gpu) = gpu() else { return };
    for mesh in [shapes::book(5), shapes::menger_sponge(1)] {
        let topology = Topology::of(&mesh);
        let lent = GpuTopology::upload(&gpu, &topology).unwrap();
        assert_eq!(lent.edge_count as usize, topology.edge_count());
        let host = on_host(lent.vertex_count, mesh.triangles());
        assert_eq!(lent.download(&gpu).unwrap(), host);
        let triangles: Vec<[u32; 3]> = gpu.download(&lent.triangles, mesh.face_count()).unwrap();
        assert_eq!(triangles, mesh.triangles());
    }
}

#[test]
fn gpu_topology_shader_has_one_layout_in_rust_and_wgsl() {
    let shader = shader();
    assert_layout!(shader.source(), "Size", Size: half_edges, vertices);
    // Rust adds the count that the prefix sum leaves.
    let here =
        [("bad_face", std::mem::offset_of!(Found, bad_face)), ("kept", std::mem::offset_of!(Found, kept))];
    let here = here.map(|(name, offset)| (name.to_owned(), offset)).to_vec();
    assert_eq!(members(shader.source(), "Found").0, here);
}
