//! The small files made after reports of other tools: read with the right counts, or named as what they are.

use umbrage::read::read;

use crate::support::reports;

#[test]
fn reports_of_slips_around_plain_geometry_are_read() {
    let Some(folder) = reports() else { return };
    for (name, vertices, note) in [
        ("b_attr_payload.stl", 12, "24 bytes of attributes behind triangles skipped"),
        ("b_glTF_header.stl", 12, ""),
        (
            "o_nancolor.obj",
            4,
            "3 color or weight values ignored for not being a number, the first on line 2 (`nan`)",
        ),
        ("o_2face.obj", 4, "1 face of fewer than three corners left out, on line 9"),
        ("p_2face.ply", 4, "1 face of fewer than three corners left out, on line 18"),
        (
            "p_nanind_normal.ply",
            4,
            "8 unread values of another type than declared, the first on line 13 (`-nan(ind)`)",
        ),
        ("p_polygon_elem.ply", 4, "4 polygon elements read as faces, since there is no element face"),
        ("s_endsolidName.stl", 12, "1 keyword run together with a name, on line 30 (`endsolidtetra`)"),
        ("s_nul_end.stl", 12, "1 control byte taken as blank, from line 31 on"),
        ("s_oneline.stl", 12, "4 facets not at the beginning of a line, the first on line 1"),
    ] {
        let scene = read(folder.join(name)).unwrap_or_else(|error| panic!("{error}"));
        let mesh = &scene.meshes[0];
        assert_eq!((mesh.vertex_count(), mesh.face_count()), (vertices, 4), "{name}");
        assert_eq!(mesh.bounds(), Some([[0.0; 3], [2.0, 3.0, 1.5]]), "{name}");
        assert_eq!(scene.notes, if note.is_empty() { vec![] } else { vec![note.to_owned()] }, "{name}");
    }
    let error = read(folder.join("x.wrl")).unwrap_err();
    assert!(error.problem.contains("VRML") && error.remedy.contains("convert"), "{error}");
}
