use umbrage::read::Format;
use umbrage::testing::shapes;

use super::{error, mesh, scene, stl};

#[test]
fn foreign_content_is_named_whatever_the_extension() {
    for (content, what) in [
        (&b"#VRML V2.0 utf8\nShape {}\n"[..], "VRML"),
        (b"#Inventor V2.1 ascii\n", "Open Inventor"),
        (b"\n <?xml version=\"1.0\"?>\n<COLLADA>", "XML"),
        (b"\xef\xbb\xbf<COLLADA version=\"1.4.1\">", "COLLADA"),
        (b"<!DOCTYPE html><p>404", "a web page"),
        (b"ISO-10303-21;\nHEADER;\n", "STEP"),
        (b"Kaydara FBX Binary  \0\x1a\0", "FBX"),
        (b"; FBX 7.3.0 project file\n", "FBX"),
        (b"BLENDER-v300", "Blender"),
        (b"#usda 1.0\n", "USD"),
        (b"%PDF-1.7\n", "PDF"),
        (b"\x89PNG\r\n\x1a\n", "a picture"),
        (b"MM\x0a\0\0\0\x02\0\0\0", "3DS"),
        (b"version https://git-lfs.github.com/spec/v1\n", "a pointer of Git LFS"),
    ] {
        for name in ["a.obj", "a.stl", "a.off", "a.wrl", "a", "a.gltf"] {
            let said = error(content, name);
            assert!(said.contains("the content is ") && said.contains(what), "{said}");
            assert!(said.contains("; ") && !said.contains("export the file again"), "{said}");
        }
    }
}

#[test]
fn foreign_extensions_are_named_but_a_mark_of_a_format_that_is_read_wins() {
    for (name, what) in
        [("a.fbx", "FBX"), ("a.STEP", "STEP"), ("a.wrl", "VRML"), ("a.usdz", "USD"), ("a.dae", "COLLADA")]
    {
        for content in [&b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"[..], b"# nothing\n", b"\x01\x02\x03"] {
            let said = error(content, name);
            assert!(said.contains(&format!("by its extension the file is {what}")), "{said}");
            assert!(said.contains("convert it to"), "{said}");
        }
        assert_eq!(mesh(stl::SAMPLE, name).face_count(), 2);
    }
    // Negative test: other unknown extensions say nothing.
    assert_eq!(mesh("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "a.txt").face_count(), 1);
}

/// Binary STL may begin with anything, also with the marks of other formats.
#[test]
fn foreign_beginnings_of_a_binary_stl_do_not_matter() {
    for shape in [shapes::cube(), shapes::icosphere(1)] {
        let triangles: Vec<_> = shape
            .triangles()
            .iter()
            .map(|corners| corners.map(|vertex| shape.positions()[vertex as usize]))
            .collect();
        let sound = stl::binary(&triangles);
        for beginning in [
            "glTF export",
            "glTF\x02\0\0\0",
            "IDP2",
            "ply\n",
            "{ }",
            "solid cube",
            "facet",
            "OFF\n",
            "#VRML",
            "<?xml",
            "%PDF",
            "v 0 0 0\n",
            "ISO-10303-21",
        ] {
            let mut bytes = sound.clone();
            bytes[..beginning.len()].copy_from_slice(beginning.as_bytes());
            let scene = scene(&bytes, "a.stl");
            assert_eq!((scene.format, scene.notes.len()), (Some(Format::Stl), 0), "{beginning:?}");
            assert_eq!(scene.meshes[0].positions(), triangles.as_flattened(), "{beginning:?}");
        }
        // Negative test: a real mark under another extension.
        let mut bytes = sound;
        bytes[..8].copy_from_slice(b"glTF\x02\0\0\0");
        assert!(error(&bytes, "a.glb").contains("(glb)"));
    }
}
