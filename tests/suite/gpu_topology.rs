//! The edge table that compute shaders build of real meshes, against the host's.

use umbrage::gpu::wgpu;
use umbrage::mesh::{Mesh, Weld, weld};
use umbrage::topology::{GpuTopology, GpuTopologyBuilder, Topology};

use crate::support::{facts, gpu, real_meshes};

/// Offsets and entries of the host's table, from what it tells everyone.
fn words(topology: &Topology) -> (Vec<u32>, Vec<u32>) {
    let (mut offsets, mut entries) = (vec![0], Vec::new());
    for edge in topology.edges() {
        for (half_edge, (_, direction)) in topology.half_edges(edge).zip(topology.uses(edge)) {
            entries.push(half_edge.0 << 1 | u32::from(direction < 0));
        }
        offsets.push(entries.len() as u32);
    }
    (offsets, entries)
}

#[test]
fn gpu_topology_of_real_meshes_equals_the_hosts() {
    let (Some(gpu), Some(folder)) = (gpu(), real_meshes()) else { return };
    let builder = GpuTopologyBuilder::new(&gpu).unwrap();
    let check = |mesh: &Mesh| {
        let topology = Topology::of(mesh);
        let sent = GpuTopology::upload(&gpu, &topology).unwrap();
        let built = builder.build(&gpu, sent.vertex_count, &sent.triangles, sent.face_count).unwrap();
        let expected = words(&topology);
        assert!(sent.download(&gpu).unwrap() == expected, "{} uploaded", mesh.name);
        assert!(built.download(&gpu).unwrap() == expected, "{} built", mesh.name);
        assert_eq!(built.edge_count, sent.edge_count);
        topology.collapsed_face_count()
    };
    let (mut files, mut collapsed) = (0, 0);
    for fact in facts(&folder) {
        let scene = umbrage::read::read(folder.join(&fact["name"])).unwrap();
        for mesh in &scene.meshes {
            check(mesh);
            collapsed += check(&weld(mesh, Weld::Exact).mesh);
        }
        files += 1;
    }
    assert_eq!(files, 29);
    assert!(collapsed > 0, "some real faces collapse");
}

#[test]
fn gpu_topology_of_a_mesh_changed_on_the_device_is_that_meshs() {
    let Some(gpu) = gpu() else { return };
    let builder = GpuTopologyBuilder::new(&gpu).unwrap();
    let mesh = umbrage::testing::shapes::icosphere(3);
    let mut topology = Topology::of(&mesh);
    let buffer: wgpu::Buffer = GpuTopology::upload(&gpu, &topology).unwrap().triangles;
    // Each frame another face collapses, as in a level-of-detail chain.
    for face in 0..5 {
        let mut triangles = topology.triangles().to_vec();
        triangles[face][1] = triangles[face][0];
        topology = Topology::build(mesh.vertex_count(), triangles);
        let bytes = topology.triangles()[face].map(u32::to_le_bytes).concat();
        gpu.queue().write_buffer(&buffer, 12 * face as u64, &bytes);
        let built = builder.build(&gpu, mesh.vertex_count() as u32, &buffer, mesh.face_count() as u32);
        assert_eq!(built.unwrap().download(&gpu).unwrap(), words(&topology));
    }
}
