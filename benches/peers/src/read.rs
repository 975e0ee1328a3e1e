//! Text and binary files, from memory.

use std::io::Cursor;

use umbrage::mesh::Mesh;
use umbrage::read::read_bytes;

use crate::files::{self, File};
use crate::measure::{Bench, Contender, Group, timed};

pub(crate) fn run(bench: &mut Bench<'_>, mesh: &Mesh) {
    if !bench.wants("read") {
        return;
    }
    let file = files::obj(mesh);
    let tobj = Contender::new("tobj", || {
        let options = tobj::LoadOptions { triangulate: true, ..Default::default() };
        let work = || {
            let mut reader = Cursor::new(&file.bytes);
            let read = tobj::load_obj_buf(&mut reader, &options, |_| Err(tobj::LoadError::GenericFailure));
            read.expect("it is well formed").0
        };
        timed(work, |models| {
            let sum =
                |of: fn(&tobj::Mesh) -> usize| models.iter().map(|model| of(&model.mesh)).sum::<usize>();
            answer(sum(|mesh| mesh.positions.len()) / 3, sum(|mesh| mesh.indices.len()) / 3)
        })
    })
    .expects(answer(file.vertices, mesh.face_count()));
    group(bench, mesh, &file, vec![tobj]);
    for file in [files::stl_text(mesh), files::stl(mesh)] {
        let triangles = Contender::new("stl_io, triangles", || {
            let work = || {
                let mut reader = Cursor::new(&file.bytes);
                let triangles = stl_io::create_stl_reader(&mut reader).expect("it is well formed");
                triangles.collect::<Result<Vec<_>, _>>().expect("it is well formed")
            };
            timed(work, |triangles| answer(3 * triangles.len(), triangles.len()))
        })
        .expects(answer(file.vertices, mesh.face_count()));
        let indexed = Contender::new("stl_io, welded", || {
            let work = || stl_io::read_stl(&mut Cursor::new(&file.bytes)).expect("it is well formed");
            timed(work, |mesh| answer(mesh.vertices.len(), mesh.faces.len()))
        });
        group(bench, mesh, &file, vec![triangles, indexed]);
    }
}

/// The peers, then our reader.
fn group<'a>(bench: &mut Bench<'_>, mesh: &Mesh, file: &'a File, mut contenders: Vec<Contender<'a>>) {
    let File { name, kind, bytes, vertices } = file;
    let ours = Contender::new("read_bytes", move || {
        timed(
            || read_bytes(bytes, name).expect("it is well formed"),
            |scene| answer(scene.meshes[0].vertex_count(), scene.meshes[0].face_count()),
        )
    });
    contenders.push(ours.expects(answer(*vertices, mesh.face_count())));
    let (mesh, units) = (format!("{kind} · {}", mesh.name), bytes.len());
    bench.run(Group { stage: "read", mesh, units, unit: "byte", contenders });
}

fn answer(vertices: usize, faces: usize) -> String {
    format!("vertices={vertices} faces={faces}")
}
