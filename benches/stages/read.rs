//! Readers of all formats, from memory.

use umbrage::read::read_bytes;

use crate::files::{self, File};
use crate::measure::{Bench, Contender, Group, timed};

pub(crate) fn run(bench: &mut Bench<'_>) {
    if !bench.wants("read") {
        return;
    }
    let mesh = crate::ordered(bench.quick);
    for file in [files::obj, files::stl_text, files::stl, files::ply_text, files::ply, files::off, files::glb]
    {
        reader(bench, &mesh.name, mesh.face_count(), &file(&mesh));
    }
}

fn reader(bench: &mut Bench<'_>, mesh: &str, faces: usize, file: &File) {
    let File { name, kind, bytes, vertices } = file;
    let newlines = bytes.iter().filter(|&&byte| byte == b'\n').count();
    let contenders = vec![
        Contender::new("copy of the bytes", || {
            timed(|| bytes.clone(), |copy| format!("bytes={}", copy.len()))
        })
        .moves(2.0),
        Contender::new("newlines counted", || {
            let count = || bytes.iter().filter(|&&byte| byte == b'\n').count();
            timed(count, |count| format!("newlines={count}"))
        })
        .expects(format!("newlines={newlines}"))
        .moves(1.0),
        Contender::new("read_bytes", || {
            timed(
                || read_bytes(bytes, name).expect("it is well formed"),
                |scene| {
                    let mesh = &scene.meshes[0];
                    format!("vertices={} faces={}", mesh.vertex_count(), mesh.face_count())
                },
            )
        })
        .expects(format!("vertices={vertices} faces={faces}")),
    ];
    let (mesh, units) = (format!("{kind} · {mesh} of {faces} triangles"), bytes.len());
    bench.run(Group { stage: "read", mesh, units, unit: "byte", contenders });
}
