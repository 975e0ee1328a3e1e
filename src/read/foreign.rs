//! Formats that are not read: named as what they are, with a remedy.

use std::path::Path;

use super::{Place, ReadError};

const CONVERT: &str = "convert it to glb, gltf, obj, ply, stl or off, with Blender for example";

/// The error for a file of `len` bytes whose first ones, without blanks, are those of a format that is not
/// read.
pub(super) fn by_content(head: &[u8], len: u64) -> Option<ReadError> {
    // 3D Studio: a mark of two letters, and the length of the file.
    let studio =
        head.starts_with(b"MM") && head.get(2..6).is_some_and(|bytes| bytes == (len as u32).to_le_bytes());
    let mark = || MARKS.iter().find(|(mark, _)| head.starts_with(mark)).map(|(_, name)| name);
    let name = if studio { &"3DS" } else { mark()? };
    let error = ReadError::new(None, Place::File, format!("the content is {name}, which is not read"));
    Some(error.remedy(match *name {
        WEB_PAGE => "download the file itself: this is a page about it, or about an error",
        POINTER => "fetch the file itself with `git lfs pull`",
        PICTURE => "name a mesh file",
        _ => CONVERT,
    }))
}

/// The error for a file whose extension is that of a format that is not read.
pub(super) fn by_extension(name: &Path) -> Option<ReadError> {
    let extension = name.extension()?.to_str()?.to_ascii_lowercase();
    let (_, format) = EXTENSIONS.iter().find(|(extensions, _)| extensions.contains(&extension.as_str()))?;
    let problem = format!("by its extension the file is {format}, which is not read");
    Some(ReadError::new(None, Place::File, problem).remedy(CONVERT))
}

const WEB_PAGE: &str = "HTML, a web page";
const POINTER: &str = "a pointer of Git LFS";
const PICTURE: &str = "a picture";

/// The first bytes of formats, the longer ones first.
const MARKS: [(&[u8], &str); 46] = [
    (b"#VRML", "VRML"),
    (b"#X3D", "X3D"),
    (b"#Inventor", "Open Inventor"),
    (b"#usda", "USD"),
    (b"PXR-USDC", "USD"),
    (b"<!DOCTYPE html", WEB_PAGE),
    (b"<!doctype html", WEB_PAGE),
    (b"<html", WEB_PAGE),
    (b"<HTML", WEB_PAGE),
    (b"<COLLADA", "COLLADA"),
    (b"<X3D", "X3D"),
    (b"<amf", "AMF"),
    (b"<svg", "SVG, a drawing"),
    (b"<VTKFile", "VTK"),
    (b"<!DOCTYPE", "XML (COLLADA, X3D or another)"),
    (b"<?xml", "XML (COLLADA, X3D, AMF or another)"),
    (b"<", "XML or another markup"),
    (b"ISO-10303-21", "STEP"),
    (b"Kaydara FBX Binary", "FBX"),
    (b"; FBX", "FBX"),
    (b"BLENDER", "a Blender file"),
    (b"%PDF", "PDF"),
    (b"%!PS", "PostScript"),
    (b"xof 0", "DirectX (.x)"),
    (b"AC3D", "AC3D"),
    (b"IDP3", "MD3"),
    (b"IDPO", "MDL"),
    (b"IDST", "MDL"),
    (b"MD5Version", "MD5"),
    (b"# vtk DataFile", "VTK"),
    (b"$MeshFormat", "Gmsh"),
    (b"MeshVersionFormatted", "Medit"),
    (b"DBRep_DrawableShape", "BREP"),
    (b"CASCADE Topology", "BREP"),
    (b"DRACO", "Draco"),
    (b"OCTM", "OpenCTM"),
    (b"Ogawa", "Alembic"),
    (b"3D Geometry File Format", "3DM"),
    (b"AutoCAD Binary DXF", "DXF"),
    (b"AC10", "DWG"),
    (b"# .PCD", "PCD, a point cloud"),
    (b"LASF", "LAS, a point cloud"),
    (b"version https://git-lfs", POINTER),
    (b"\x89PNG", PICTURE),
    (b"\xff\xd8\xff", PICTURE),
    (b"GIF8", PICTURE),
];

const EXTENSIONS: [(&[&str], &str); 32] = [
    (&["fbx"], "FBX"),
    (&["dae"], "COLLADA"),
    (&["3ds", "max"], "3D Studio"),
    (&["blend", "blend1"], "a Blender file"),
    (&["step", "stp", "p21"], "STEP"),
    (&["iges", "igs"], "IGES"),
    (&["wrl", "vrml", "wrz"], "VRML"),
    (&["x3d", "x3dv", "x3db"], "X3D"),
    (&["usd", "usda", "usdc", "usdz"], "USD"),
    (&["amf"], "AMF"),
    (&["dxf", "dwg"], "an AutoCAD drawing"),
    (&["ma", "mb"], "Maya"),
    (&["c4d"], "Cinema 4D"),
    (&["lwo", "lws"], "LightWave"),
    (&["3dm"], "Rhino 3DM"),
    (&["skp"], "SketchUp"),
    (&["iv"], "Open Inventor"),
    (&["abc"], "Alembic"),
    (&["ctm"], "OpenCTM"),
    (&["drc"], "Draco"),
    (&["vtk", "vtu", "vtp"], "VTK"),
    (&["msh"], "Gmsh"),
    (&["brep", "brp"], "BREP"),
    (&["sldprt", "sldasm"], "SolidWorks"),
    (&["ipt", "iam"], "Inventor"),
    (&["catpart", "catproduct"], "CATIA"),
    (&["jt"], "JT"),
    (&["ifc"], "IFC"),
    (&["md3", "mdl", "md5mesh"], "a game model"),
    (&["pcd", "las", "laz", "e57"], "a point cloud"),
    (&["pdf", "u3d", "prc"], "3D PDF"),
    (&["ac", "x"], "AC3D or DirectX"),
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn foreign_marks_of_one_format_do_not_hide_those_of_another() {
        for (at, (mark, _)) in MARKS.iter().enumerate() {
            let before = MARKS[..at].iter().find(|(other, _)| mark.starts_with(other));
            assert_eq!(before, None, "{mark:?}");
        }
    }

    #[test]
    fn foreign_extensions_are_listed_once_in_lower_case_and_none_is_read() {
        let all: Vec<_> = EXTENSIONS.iter().flat_map(|(extensions, _)| *extensions).collect();
        for (at, extension) in all.iter().enumerate() {
            assert!(!all[..at].contains(extension) && extension.to_lowercase() == **extension, "{extension}");
            let name = format!("a.{}", extension.to_uppercase());
            assert!(super::super::Format::from_extension(Path::new(&name)).is_none(), "{extension}");
            assert!(by_extension(Path::new(&name)).unwrap().to_string().contains("not read; convert it to"));
        }
    }
}
