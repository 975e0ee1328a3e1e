//! Animation frames: vertices that coincide in one frame and separate in another.

use umbrage::facing::{CasterFaces, classify};
use umbrage::mesh::{Mesh, Weld, weld};
use umbrage::shadow::volume::{Caps, ShadowVolume};
use umbrage::silhouette::Silhouette;
use umbrage::testing::shapes;

use super::figures::*;

/// Two unit quads side by side, each with its own copy of the common edge: closed in frame 0, open by 1 in
/// frame 1, closed in frame 2.
fn zip() -> Mesh {
    let quad = |x: f32| [[x, 0.0, 0.0], [x + 1.0, 0.0, 0.0], [x + 1.0, 1.0, 0.0], [x, 1.0, 0.0]];
    let closed = [quad(0.0), quad(1.0)].concat();
    let open = [quad(0.0), quad(2.0)].concat();
    let faces = vec![[0, 1, 2], [0, 2, 3], [4, 5, 6], [4, 6, 7]];
    Mesh::new(closed.clone(), faces).unwrap().with_frames(vec![open, closed]).unwrap()
}

/// One frame of a mesh, as a mesh.
fn frame(mesh: &Mesh, number: usize) -> Mesh {
    let positions = if number == 0 { mesh.positions() } else { &mesh.frames()[number - 1] };
    Mesh::new(positions.to_vec(), mesh.triangles().to_vec()).unwrap()
}

/// Guards against adjacency that depends on the frame: edges and buffers would change from frame to frame.
#[test]
fn hard_23_frames_in_which_vertices_part_keep_them_apart_in_all() {
    let zip = zip();
    for how in [Weld::Exact, Weld::Within(0.25)] {
        let welded = weld(&zip, how).mesh;
        assert_eq!((welded.vertex_count(), welded.frames().len()), (8, 2));
        let topology = topology(&welded);
        assert_eq!(
            (topology.edge_count(), topology.edge_counts().boundary, topology.shells().count),
            (10, 8, 2)
        );
        for number in 0..3 {
            let mesh = frame(&welded, number);
            // One topology serves every frame: eight edges of outline, whether the slit is open or not.
            expect_figures(&[(&mesh, point(1.3, 0.4, 5.0), ([4, 0, 0], 8, 8))]);
            expect_agreement(&mesh, &point(1.3, 0.4, 5.0));
            let in_the_slit = u32::from(number != 1);
            expect_crossings(
                &mesh,
                &sun(0.0, 0.0, -1.0),
                &[([1.25, 0.5, -1.0], in_the_slit), ([0.75, 0.5, -1.0], 1)],
            );
        }
    }
    // Negative test: welded by one frame alone, the quads are connected and the slit cannot open.
    let by_one = weld(&frame(&zip, 0), Weld::Exact).mesh;
    assert_eq!((by_one.vertex_count(), counts(&by_one).boundary_edges, counts(&by_one).shells), (6, 6, 1));
    // A later frame is as good as the first: closed, and open in the opposite direction.
    let (positions, triangles, _, frames) = zip.into_parts();
    let [open, closed] = <[Vec<[f32; 3]>; 2]>::try_from(frames).unwrap();
    assert_eq!(positions, closed);
    let late = Mesh::new(open, triangles).unwrap().with_frames(vec![closed]).unwrap();
    assert_eq!(weld(&late, Weld::Exact).mesh.vertex_count(), 8);
}

/// Guards against keeping vertices apart that never separate: split vertices that move alike are one.
#[test]
fn hard_23_frames_of_split_vertices_that_move_alike_close() {
    let ball = shapes::soup(&shapes::icosphere(1));
    // Pressed flat step by step, and moved: in the last frame all vertices lie in one plane, opposite ones at
    // one position.
    let pressed = |factor: f32| -> Vec<[f32; 3]> {
        ball.positions().iter().map(|&[x, y, z]| [x + 4.0 * factor, y, z * (1.0 - factor)]).collect()
    };
    let moving = ball.clone().with_frames(vec![pressed(0.5), pressed(1.0)]).unwrap();
    let welded = weld(&moving, Weld::Exact).mesh;
    let topology = topology(&welded);
    assert_eq!((welded.vertex_count(), topology.edge_count()), (42, 120));
    assert!(topology.edge_counts().watertight());
    let light = point(3.0, 5.0, 7.0);
    for number in 0..3 {
        let mesh = frame(&welded, number);
        let signs = CasterFaces::All.signs(&classify(&mesh, &light));
        let silhouette = Silhouette::extract(&topology, &signs);
        let volume = ShadowVolume::extrude(&mesh, &topology, &light, &signs, &silhouette, Caps::Both);
        assert!(volume.boundary_sum().is_closed(), "frame {number}");
        let x = [0.0, 2.0, 4.0][number];
        expect_crossings(
            &mesh,
            &sun(0.0, 0.0, -1.0),
            &[([x + 0.1, 0.07, -5.0], 2), ([x + 1.5, 0.07, -5.0], 0)],
        );
        expect_agreement(&mesh, &light);
    }
    // Negative test: welded alone, the pressed frame joins its two sides.
    let alone = weld(&Mesh::new(pressed(1.0), ball.triangles().to_vec()).unwrap(), Weld::Exact).mesh;
    assert!(alone.vertex_count() < 42 && !counts(&alone).watertight);
}
