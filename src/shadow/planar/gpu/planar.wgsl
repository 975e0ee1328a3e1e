// Casters flattened onto a plane, drawn over the samples that the plane receives. raster.wgsl comes before
// it, and clipped.wgsl or discarded.wgsl after it. Twin: `Plane` mirrors the struct in uniform.rs.

struct Plane {
    // Unit length, with the light in front.
    normal: vec3f,
    // The height of the light over the plane, times `light_w`.
    height: f32,
    // A point of the plane, scaled as vertices are.
    origin: vec3f,
    // A power of two that scales the light to about 1; 0 for a directional light.
    light_w: f32,
    // From the origin to the light, times `light_w`, or the direction to it.
    light: vec3f,
    padding: u32,
}

@group(0) @binding(6) var<uniform> shadow_plane: Plane;
// One bit per face: whether the plane passes through all its corners.
@group(0) @binding(7) var<storage, read> on_plane: array<u32>;
// The visible face and 1; 0 where there is none.
@group(0) @binding(8) var visible_faces: texture_2d<u32>;

struct Flat {
    clip: vec4f,
    // Above zero for what casts: the height over the plane, and what is left of it to the light.
    sides: vec2f,
}

fn is_on_plane(face: u32) -> bool {
    return (on_plane[face / 32u] >> (face % 32u) & 1u) == 1u;
}

// A corner on its light ray, on the plane: the classic matrix, without its translation. A face of the plane
// has no shadow on it: it is drawn as nothing.
fn flattened(index: u32) -> Flat {
    if is_on_plane(index / 3u) { return Flat(vec4f(0.0, 0.0, -1.0, 1.0), vec2f(-1.0)); }
    let v = vertex(triangles[index]) * frame.scale - shadow_plane.origin;
    let height = dot(shadow_plane.normal, v);
    let divisor = shadow_plane.height - shadow_plane.light_w * height;
    let image = v * shadow_plane.height - shadow_plane.light * height;
    let seen = image + (shadow_plane.origin - frame.eye) * divisor;
    return Flat(project(seen, divisor), vec2f(height, divisor));
}

// Samples that the plane receives pass.
@fragment
fn mark(@builtin(position) position: vec4f) {
    let face = textureLoad(visible_faces, vec2u(position.xy), 0).x;
    if face == 0u { discard; }
    if !is_on_plane(face - 1u) { discard; }
}

// The visibility of a sample that is marked and not drawn over, which the stencil test ensures.
@fragment
fn lit() -> @location(0) f32 {
    return 1.0;
}
