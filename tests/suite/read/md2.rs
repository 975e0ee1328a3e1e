use umbrage::animate::Pose;

use super::{expect_errors, mesh};

/// A file of `frames` frames of `vertices`, with scale 2 and translation (10, 20, 30 + frame).
fn file(vertices: &[[u8; 3]], triangles: &[[u16; 3]], frames: u32) -> Vec<u8> {
    let frame_bytes = 40 + 4 * vertices.len() as u32;
    let frames_at = 68 + 12 * triangles.len() as u32;
    let end = frames_at + frames * frame_bytes;
    let counts = [frame_bytes, 0, vertices.len() as u32, 0, triangles.len() as u32, 0, frames];
    let header = [&[8, 64, 64][..], &counts, &[68, 68, 68, frames_at, end, end]].concat();
    let mut bytes = b"IDP2".to_vec();
    bytes.extend(header.iter().flat_map(|field| field.to_le_bytes()));
    for triangle in triangles {
        bytes.extend(triangle.iter().chain(&[0; 3]).flat_map(|corner| corner.to_le_bytes()));
    }
    for frame in 0..frames {
        bytes.extend(
            [2.0, 2.0, 2.0, 10.0, 20.0, 30.0 + frame as f32].iter().flat_map(|v: &f32| v.to_le_bytes()),
        );
        bytes.extend(b"stand01\0\0\0\0\0\0\0\0\0");
        bytes.extend(vertices.iter().flat_map(|&[x, y, z]| [x, y, z, 0]));
    }
    assert_eq!(bytes.len(), end as usize);
    bytes
}

pub(super) fn sample() -> Vec<u8> {
    file(&[[0, 0, 0], [1, 0, 0], [0, 255, 0], [0, 0, 3]], &[[0, 1, 2], [0, 2, 3]], 3)
}

#[test]
fn md2_positions_are_scaled_and_frames_follow() {
    let mesh = mesh(sample(), "a.md2");
    assert_eq!(
        mesh.positions(),
        [[10.0, 20.0, 30.0], [12.0, 20.0, 30.0], [10.0, 530.0, 30.0], [10.0, 20.0, 36.0]]
    );
    assert_eq!(mesh.frames().len(), 2);
    for (index, frame) in mesh.frames().iter().enumerate() {
        let moved = |&[x, y, z]: &[f32; 3]| [x, y, z + 1.0 + index as f32];
        assert_eq!(*frame, mesh.positions().iter().map(moved).collect::<Vec<_>>());
    }
}

#[test]
fn md2_clockwise_faces_are_turned() {
    assert_eq!(mesh(sample(), "a.md2").triangles(), [[0, 2, 1], [0, 3, 2]]);
    // A tetrahedron that is clockwise seen from outside has a positive volume once its faces are turned.
    let clockwise =
        file(&[[0, 0, 0], [9, 0, 0], [0, 9, 0], [0, 0, 9]], &[[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]], 1);
    let mesh = mesh(clockwise, "a.md2");
    let volume = |[a, b, c]: [[f32; 3]; 3]| {
        let [a, b, c] = [a, b, c].map(glam::Vec3::from);
        a.dot(b.cross(c))
    };
    let six_volumes: f32 =
        mesh.triangles().iter().map(|t| volume(t.map(|v| mesh.positions()[v as usize]))).sum();
    assert_eq!(six_volumes, 18.0 * 18.0 * 18.0);
}

#[test]
fn md2_errors_name_the_byte() {
    let with = |field: usize, value: u32| {
        let mut bytes = sample();
        bytes[4 * field..4 * field + 4].copy_from_slice(&value.to_le_bytes());
        bytes
    };
    let [frame_0, frame_2] = [68 + 24, 68 + 24 + 2 * 56];
    let infinite = |frame: usize| with(frame / 4 + 1, f32::INFINITY.to_bits());
    let mut index = sample();
    index[68 + 12 + 2] = 4;
    expect_errors(
        "a.md2",
        &[
            (b"IDP2", " (md2): an MD2 header has 68 bytes, but the file has 4"),
            (
                &with(16, 9999),
                ", byte 64 (md2): the header says that the file has 9999 bytes, but it has 260",
            ),
            (&with(10, 0), ", byte 40 (md2): the file has no frame, and so no positions"),
            (&with(6, u32::MAX), ", byte 16 (md2): a frame of 56 bytes cannot hold 4294967295 vertices"),
            (
                &with(8, u32::MAX),
                ", byte 32 (md2): 4294967295 triangles from byte 68 do not fit a file of 260 bytes",
            ),
            (
                &with(13, u32::MAX),
                ", byte 32 (md2): 2 triangles from byte 4294967295 do not fit a file of 260 bytes",
            ),
            (
                &with(10, u32::MAX),
                ", byte 40 (md2): 4294967295 frames of 56 bytes from byte 92 do not fit a file of 260 bytes",
            ),
            (
                &with(14, 93),
                ", byte 40 (md2): 3 frames of 56 bytes from byte 93 do not fit a file of 260 bytes",
            ),
            (&index, ", byte 80 (md2): triangle 1 names vertex 4, but the file has 4 vertices"),
            (
                &infinite(frame_0),
                ", byte 92 (md2): frame 0 gives vertex 0 a coordinate that is not a finite number",
            ),
            (
                &infinite(frame_2),
                ", byte 204 (md2): frame 2 gives vertex 0 a coordinate that is not a finite number",
            ),
            (
                &with(1, 15),
                ", byte 4 (md2): MD2 version 15 is not known, only version 8 is; export the file as a Quake II model",
            ),
        ],
    );
    expect_errors(
        "b.md2",
        &[(&[b'x'; 100], ", byte 0 (md2): an MD2 file begins with IDP2, this one does not")],
    );
}

#[test]
fn md2_poses_lie_on_straight_lines_between_frames() {
    let scene = umbrage::read::read_bytes(&sample(), "a.md2").unwrap();
    assert!(scene.moves() && scene.last_frame() == 2);
    let rest = scene.meshes[0].positions().to_vec();
    let raised = |by: f32| rest.iter().map(|&[x, y, z]| [x, y, z + by]).collect::<Vec<_>>();
    let posed = |pose: Pose| scene.pose(&pose).map(|posed| posed.meshes[0].positions().to_vec());
    // Frame N is raised by N: a time is in frames at one frame a second.
    for (time, by) in
        [(0.0, 0.0), (0.25, 0.25), (1.0, 1.0), (1.75, 1.75), (2.0, 2.0), (9.0, 2.0), (-1.0, 0.0)]
    {
        assert_eq!(posed(Pose::at(time).fps(1.0)), Ok(raised(by)), "{time}");
    }
    for frame in 0..3 {
        assert_eq!(posed(Pose::frame(frame)), Ok(raised(frame as f32)), "bit for bit");
    }
    let beyond = posed(Pose::frame(3)).unwrap_err();
    assert_eq!(beyond.to_string(), "there is no frame 3: the last one is 2");
    let late = scene.pose(&Pose::at(9.0)).unwrap();
    assert!(late.notes.iter().any(|note| note.contains("beyond frames 0 to 2: the nearest one is held")));
    // The pose of a pose is that pose: it has nothing that moves.
    assert!(!late.moves());
    assert_eq!(late.pose(&Pose::at(0.0)).unwrap().meshes, late.meshes);
}
