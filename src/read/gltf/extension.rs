//! Extensions that a document may require: which of them change geometry.
//!
//! An extension that is not in this list leaves geometry alone, as far as is known: what it adds is not read,
//! and a note says so where the document requires it.

/// What an extension does to geometry.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Effect {
    /// It is read.
    Read,
    /// It stands in for plain data: where the plain data is there too, nothing is missing.
    Stored,
    /// It changes what the plain data means.
    Changed,
}

/// The remedy where an extension stores data in a form that cannot be read.
pub(super) const DECOMPRESS: &str = "write the file without it: `gltf-transform cp IN.glb OUT.glb` does";

/// The remedy for geometry that is described by other means than vertices and triangles.
const AS_TRIANGLES: &str = "export triangles";

/// Every extension that is read, or that changes geometry; and the remedy where it is not read.
const GEOMETRY: &[(&str, Effect, &str)] = &[
    ("EXT_mesh_gpu_instancing", Effect::Read, ""),
    ("EXT_meshopt_compression", Effect::Read, ""),
    ("KHR_meshopt_compression", Effect::Read, ""),
    ("KHR_mesh_quantization", Effect::Read, ""),
    ("KHR_node_visibility", Effect::Read, ""),
    ("KHR_lights_punctual", Effect::Read, ""),
    #[cfg(feature = "draco")]
    ("KHR_draco_mesh_compression", Effect::Read, ""),
    #[cfg(not(feature = "draco"))]
    ("KHR_draco_mesh_compression", Effect::Stored, DECOMPRESS),
    ("MESHOPT_compression", Effect::Stored, DECOMPRESS),
    ("KHR_gaussian_splatting_compression_spz", Effect::Stored, DECOMPRESS),
    ("KHR_gaussian_splatting_compression_spz_2", Effect::Stored, DECOMPRESS),
    ("3DTILES_draco_point_compression", Effect::Stored, DECOMPRESS),
    ("WEB3D_quantized_attributes", Effect::Changed, "export with KHR_mesh_quantization or plain floats"),
    ("CESIUM_RTC", Effect::Changed, "export with the center as the translation of the root node"),
    ("EXT_mesh_primitive_restart", Effect::Changed, "export one primitive for each strip"),
    ("EXT_primitive_voxels", Effect::Changed, AS_TRIANGLES),
    ("EXT_implicit_ellipsoid_region", Effect::Changed, AS_TRIANGLES),
    ("EXT_implicit_cylinder_region", Effect::Changed, AS_TRIANGLES),
    ("MPEG_accessor_timed", Effect::Changed, "export a single moment"),
    ("MPEG_buffer_circular", Effect::Changed, "export a single moment"),
];

/// The extensions whose data is decoded, so that a few bytes stand for many.
pub(super) const CODECS: &[&str] = &[
    "EXT_meshopt_compression",
    "KHR_meshopt_compression",
    #[cfg(feature = "draco")]
    "KHR_draco_mesh_compression",
];

/// What an extension does to geometry, and the remedy where it is not read; `None` if it leaves geometry
/// alone. A compression that is not in the list is one all the same.
pub(super) fn effect(name: &str) -> Option<(Effect, &'static str)> {
    let listed = GEOMETRY.iter().find(|(listed, ..)| *listed == name);
    let compression = || name.contains("compress").then_some((Effect::Stored, DECOMPRESS));
    listed.map(|&(_, effect, remedy)| (effect, remedy)).or_else(compression)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn extensions_that_are_not_read_have_a_remedy() {
        for &(name, effect, remedy) in GEOMETRY {
            assert_eq!(effect == Effect::Read, remedy.is_empty(), "{name}");
            assert_eq!(super::effect(name), Some((effect, remedy)), "listed once");
        }
        assert_eq!(effect("ACME_fancy_compression"), Some((Effect::Stored, DECOMPRESS)));
        for harmless in ["EXT_mesh_features", "KHR_techniques_webgl", "KHR_materials_unlit", ""] {
            assert_eq!(effect(harmless), None, "{harmless}");
        }
    }
}
