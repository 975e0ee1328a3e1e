//! What the page says of each technique: what it is, and when to take it.

use umbrage::shadow::Technique;

/// What a technique is, in one sentence.
pub(super) fn what(technique: Technique) -> &'static str {
    match technique.name() {
        "rays" => "One exact shadow ray per sample, to the center of the lamp.",
        "stencil" => {
            "Shadow volumes, counted shell by shell: by z-pass where this is proven correct, otherwise by \
             z-fail."
        }
        "zfail" => "Shadow volumes, counted from behind the visible surface for every shell.",
        "zpass" => "Shadow volumes, counted from the near plane for every shell.",
        "zpass-plus" => {
            "Shadow volumes, counted from the near plane on, and the casting faces between it and the lamp."
        }
        "zpass-reversed" => "Shadow volumes, counted behind the sample by the complement of z-fail's test.",
        "counter" => {
            "Shadow volumes, drawn on the CPU in tiles, each counted from the side with less to count."
        }
        "samples" => "The mean of exact shadow rays to points spread over the lamp.",
        "area" => "The visible fraction of the lamp, computed analytically.",
        "map" => "The depth nearest to the lamp per texel, compared with that of the sample.",
        "pcf" => "A shadow map, compared at several texels and averaged.",
        "map-ids" => {
            "A shadow map of faces: the exact test decides about the faces of the texels around a sample."
        }
        "hybrid-3x3" => {
            "A shadow map where nine texels agree, and an exact shadow ray for every other sample."
        }
        "hybrid-2x2" => {
            "A shadow map where four texels agree, and an exact shadow ray for every other sample."
        }
        "reconstruct" => "The shadow volume of the surface that a shadow map shows.",
        "pcss" => "A shadow map: the mean depth of the blockers decides how wide the filter is.",
        "single-sample" => {
            "A shadow map: the distance to the nearest edge of the hard shadow decides about the light."
        }
        "soft-hybrid" => "Exact rays to the lamp where a shadow map is unsure.",
        "vsm" => "Two moments of the depth, filtered, and a bound of the share that lies behind.",
        "msm" => "Four moments of the depth, filtered, and a bound of the share that lies behind.",
        "smoothies" => "The exact hard shadow, with a fixed rim at the silhouette edges.",
        "penumbra-map" => {
            "The exact hard shadow, with a rim as wide as the penumbra at each silhouette edge."
        }
        "contact-blur" => "The exact hard shadow, blurred on the picture as wide as the blockers suggest.",
        "hybrid" => "A light grid where it proves a sample lit or dark, and an exact shadow ray elsewhere.",
        "alias-free" => {
            "The samples sorted into cells, and every face tested exactly against those it may hide."
        }
        "lod" => {
            "Shells of which no lit side is seen, simplified within a tolerance; an exact ray per sample."
        }
        "planar" => {
            "The casters flattened onto one plane, decided exactly; exact rays for all other samples."
        }
        "planar-blur" => "The planar shadow, blurred by one width: the penumbra of its mean caster.",
        "planar-contact" => "The planar shadow, blurred as wide as the casters around each sample suggest.",
        "planar-layers" => "The mean of planar shadows from points spread over the lamp.",
        "blob" => {
            "A dark spot under each shell: how much of the sky its bounding sphere hides, whatever the lamp."
        }
        "projective" => "A map of what the casters cover, projected from the lamp onto the receivers.",
        "none" => "No shadows: every surface that faces the lamp is lit.",
        "dark" => "No light from this lamp at all.",
        _ => "A technique without a description.",
    }
}

/// When a technique is the one to take.
pub(super) fn when(technique: Technique) -> &'static str {
    match technique.name() {
        "rays" => "Take it where exact hard shadows are wanted and there is no graphics adapter.",
        "stencil" => "Take it where exact hard shadows are wanted and there is a graphics adapter.",
        "zfail" => "Take it where one count has to be right for every position of the camera.",
        "zpass" => "Take it only where the camera is proven to be outside every shadow.",
        "zpass-plus" => "Take it to see what z-pass lacks, and what mending it costs.",
        "zpass-reversed" => "Take it to check a renderer's stencil state against z-fail.",
        "counter" => "Take it where a volume has to be counted without a graphics adapter.",
        "samples" => "Take it as the reference of soft shadows, or where its noise is below what matters.",
        "area" => "Take it as the truth about soft shadows.",
        "map" => "Take it where an edge that is off by a texel does not matter.",
        "pcf" => "Take it where edges may be blurred by a fixed number of texels.",
        "map-ids" => "Take it where a false shadow is worse than a missing one.",
        "hybrid-3x3" => "Take it where hard shadows should be right almost everywhere for a few rays.",
        "hybrid-2x2" => "Take it to see what the published rule of four texels misses.",
        "reconstruct" => "Take it where volumes are wanted of what only a map can be drawn of.",
        "pcss" => "Take it for soft shadows that run at the rate of a display.",
        "single-sample" => "Take it where one lookup table has to do, and shadows do not overlap.",
        "soft-hybrid" => "Take it where soft shadows should be near to exact for a few rays per sample.",
        "vsm" | "msm" => "Take it where many samples share one filtered map, and some leaking is accepted.",
        "smoothies" | "penumbra-map" => "Take it for clean models, where silhouettes are few.",
        "contact-blur" => "Take it where an exact hard shadow is there already.",
        "hybrid" => "Take it where exact rays are dear, and most samples lie away from silhouettes.",
        "alias-free" => "Take it where exact hard shadows are wanted of meshes that change in every frame.",
        "lod" => "Take it for far shadows of dense models: the number of wrong samples is bounded.",
        "planar" => "Take it where a floor receives nearly all of the shadow.",
        "planar-blur" => "Take it where a floor is looked at from afar.",
        "planar-contact" => "Take it where casters stand on a floor under a lamp with an extent.",
        "planar-layers" => "Take it as the reference of soft shadows on a floor.",
        "blob" => "Take it where a contact has to be seen, and the shape of the shadow does not matter.",
        "projective" => "Take it where few casters stand before curved receivers.",
        "none" => "Take it where the shadow is not seen: it is the cost of drawing without any.",
        "dark" => "Take it for a lamp that is switched off: it is the other end of the scale.",
        _ => "",
    }
}
