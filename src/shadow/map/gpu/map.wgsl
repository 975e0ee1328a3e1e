// Shadow maps: the depth of casters from a light, and its comparison with the visible points. raster.wgsl
// comes before it. Twins: space.rs, filter.rs, bias.rs; uniform.rs mirrors the struct.
//
// Coordinates are scaled by a power of two and relative to the light's origin. Depth is affine on every plane
// in normalized device coordinates: d = c.x·x + c.y·y + c.z. Casters and receivers get it from the same
// expression, so that a plane has one depth in both.

struct Light {
    right: array<vec4f, 6>,
    up: array<vec4f, 6>,
    axis: array<vec4f, 6>,
    origin: vec3f,
    scale: f32,
    // Half the side that a layer covers: a length, or for a central projection that at distance 1.
    half: f32,
    per_half: f32,
    lowest: f32,
    per_range: f32,
    near: f32,
    is_central: u32,
    layers: u32,
    // The layer that is drawn.
    layer: u32,
    // Side of a layer in texels.
    size: f32,
    // Side of the kernel in texels; 0 for the nearest texel.
    side: f32,
    is_tent: u32,
    // The bias: RECEIVER and so on.
    way: u32,
    reach: f32,
    // Texels by whose change of depth a plane at a texel's center is raised.
    slack: f32,
    rounding: f32,
    // What is added to the depth, or multiplied by it.
    bias: f32,
}

// The slope of the receiver's plane.
const RECEIVER = 0u;
// The receiver's plane at each texel's center.
const TEXEL = 1u;
const ADDED = 2u;
const MULTIPLIED = 3u;
// The lookup moves along the normal.
const NORMAL = 4u;

// The visible face and 1; 0 where there is none.
@group(0) @binding(5) var faces: texture_2d<u32>;
@group(0) @binding(6) var<uniform> light: Light;
@group(0) @binding(7) var map: texture_depth_2d_array;

fn from_light(id: u32) -> vec3f {
    return vertex(id) * light.scale - light.origin;
}

// x·w, y·w, depth·w and w.
fn on_layer(layer: u32, q: vec3f) -> vec4f {
    let x = dot(light.right[layer].xyz, q) * light.per_half;
    let y = dot(light.up[layer].xyz, q) * light.per_half;
    let z = dot(light.axis[layer].xyz, q);
    if light.is_central != 0u { return vec4f(x, y, light.near, z); }
    return vec4f(x, y, (z - light.lowest) * light.per_range, 1.0);
}

// The depth on the plane through q; 0, infinitely far, where the plane contains the direction to the light
// and covers nothing.
fn depth_plane(layer: u32, normal: vec3f, q: vec3f) -> vec3f {
    let r = dot(normal, light.right[layer].xyz);
    let u = dot(normal, light.up[layer].xyz);
    let f = dot(normal, light.axis[layer].xyz);
    let offset = dot(normal, q);
    if light.is_central != 0u {
        if offset == 0.0 { return vec3f(0.0); }
        return vec3f(r * light.half, u * light.half, f) * (light.near / offset);
    }
    if f == 0.0 { return vec3f(0.0); }
    return vec3f(-r * light.half, -u * light.half, offset - light.lowest * f) / f * light.per_range;
}

fn to_texels(at: vec2f) -> vec2f {
    return vec2f(1.0 + at.x, 1.0 - at.y) * (0.5 * light.size);
}

fn from_texels(t: vec2f) -> vec2f {
    return vec2f(2.0 * t.x / light.size - 1.0, 1.0 - 2.0 * t.y / light.size);
}

@vertex
fn caster(@builtin(vertex_index) index: u32) -> Corner {
    return corner_of(index);
}

// With the depth of its corners. No corner before a spot is nearer than its near plane.
@vertex
fn caster_between(@builtin(vertex_index) index: u32) -> Corner {
    var corner = corner_of(index);
    corner.clip.z = on_layer(light.layer, from_light(triangles[index])).z;
    return corner;
}

// Flat values are those of a triangle's first corner. The clip depth is always inside: nothing is clipped
// before the light but what is behind it.
fn corner_of(index: u32) -> Corner {
    let face = index / 3u;
    let q = from_light(triangles[index]);
    let at = on_layer(light.layer, q);
    let clip = vec4f(at.xy, 0.5 * at.w, at.w);
    if index % 3u != 0u { return Corner(clip, vec3f(0.0), face); }
    return Corner(clip, depth_plane(light.layer, face_normal(face), q), face);
}

@fragment
fn caster_depth(corner: Corner) -> @builtin(frag_depth) f32 {
    return drawn_depth(corner);
}

fn drawn_depth(corner: Corner) -> f32 {
    return clamp(dot(corner.depth, vec3f(from_texels(corner.clip.xy), 1.0)), 0.0, 1.0);
}

fn layer_of(q: vec3f) -> u32 {
    if light.layers == 1u { return 0u; }
    let size = abs(q);
    var axis = 0u;
    if size.y > size.x { axis = 1u; }
    if size.z > size[axis] { axis = 2u; }
    return 2u * axis + select(0u, 1u, q[axis] < 0.0);
}

// A visible point on its layer.
struct Receiver {
    layer: u32,
    normal: vec3f,
    corner: vec3f,
    plane: vec3f,
    depth: f32,
    // In texels.
    at: vec2f,
    // From the light, or from the middle of a parallel map.
    q: vec3f,
    // Whether the map has a position for it: it is not behind a spot.
    is_there: bool,
}

// By how much a lookup moves along a normal that points to the light's side: twin of Rule::normal_offset.
fn normal_offset(layer: u32, normal: vec3f, q: vec3f) -> f32 {
    let along = abs(dot(normal, light.right[layer].xyz)) + abs(dot(normal, light.up[layer].xyz));
    let part = light.reach * along * 2.0 * light.half / light.size;
    if light.is_central == 0u { return part; }
    let axis = light.axis[layer].xyz;
    return part * max(dot(q, axis), 0.0) / max(1.0 - part * dot(normal, axis), 0.0625);
}

// Where the map is asked about a visible point.
fn lookup(q: vec3f, normal: vec3f) -> vec3f {
    if light.way != NORMAL { return q; }
    let towards = select(light.axis[0].xyz, -q, light.is_central != 0u);
    let up = select(normal, -normal, dot(normal, towards) < 0.0);
    let layer = layer_of(q);
    var offset = normal_offset(layer, up, q);
    // A lookup that moves across the seam of a cube is read along other axes.
    let moved = layer_of(q + offset * up);
    if moved != layer { offset = max(offset, normal_offset(moved, up, q)); }
    return q + offset * up;
}

// Where the ray of a pixel meets the plane of the visible face.
fn receiver_of(position: vec2f, face: u32) -> Receiver {
    let first = triangles[3u * face];
    let normal = face_normal(face);
    let screen = normalized(position);
    let ray = screen.x * frame.ray_right + screen.y * frame.ray_up + frame.ray_forward;
    let distance = dot(normal, vertex(first) * frame.scale - frame.eye) / dot(normal, ray);
    let seen = (frame.eye + distance * ray) * (light.scale / frame.scale) - light.origin;
    let q = lookup(seen, normal);

    let layer = layer_of(q);
    let at = on_layer(layer, q);
    let texels = to_texels(at.xy / at.w);
    let corner = from_light(first);
    let plane = depth_plane(layer, normal, corner);
    var depth = dot(plane, vec3f(at.xy / at.w, 1.0));
    // Beside the plane.
    if light.way == NORMAL { depth = at.z / at.w; }
    let is_there = at.w > 0.0 && all(abs(texels) < vec2f(1e9));
    return Receiver(layer, normal, corner, plane, depth, texels, q, is_there);
}

// Depth of a plane at a texel's center, and what it changes over `slack` texels.
fn with_slack(plane: vec3f, texel: vec2i, slack: f32) -> f32 {
    let center = from_texels(vec2f(texel) + 0.5);
    let slope = (abs(plane.x) + abs(plane.y)) * (2.0 / light.size);
    return dot(plane, vec3f(center, 1.0)) + slack * slope;
}

fn rounding(depth: f32) -> f32 {
    return select(light.rounding, light.rounding * depth, light.is_central != 0u);
}

fn is_on_layer(texel: vec2i) -> bool {
    return all(texel >= vec2i(0)) && all(texel < vec2i(i32(light.size)));
}

fn blocks(receiver: Receiver, texel: vec2i) -> bool {
    if is_on_layer(texel) {
        var least = receiver.depth;
        if light.way == TEXEL { least = with_slack(receiver.plane, texel, light.slack); }
        return textureLoad(map, texel, receiver.layer, 0) > least + rounding(receiver.depth);
    }
    // Outside the map is lit.
    if light.layers == 1u { return false; }
    let other = beyond_rim(receiver.layer, texel);
    let plane = depth_plane(other.layer, receiver.normal, receiver.corner);
    var least = with_slack(plane, other.texel, light.slack);
    if light.way != TEXEL { least = beyond_seam(receiver, other); }
    return textureLoad(map, other.texel, other.layer, 0) > least + rounding(least);
}

// The biased depth of a receiver in the layer beyond a seam: a texel has its own distance from the lookup
// there. Twin of Rule::blocks.
fn beyond_seam(receiver: Receiver, other: Place) -> f32 {
    let own = on_layer(other.layer, receiver.q);
    let depth = own.z / own.w;
    let away = vec2f(other.texel) + 0.5 - to_texels(own.xy / own.w);
    let slope = depth_plane(other.layer, receiver.normal, receiver.q).xy * (2.0 / light.size);
    var bias = 0.0;
    if light.way == RECEIVER { bias = light.reach * (abs(slope.x) + abs(slope.y)); }
    if light.way == ADDED { bias = light.bias; }
    if light.way == MULTIPLIED { bias = light.bias * depth; }
    return depth + max(bias, abs(slope.x * away.x) + abs(slope.y * away.y));
}

struct Place {
    texel: vec2i,
    layer: u32,
}

// The texel beyond a layer's rim: a cube goes on in the layer that looks in this direction.
fn beyond_rim(own: u32, texel: vec2i) -> Place {
    let at = from_texels(vec2f(texel) + 0.5);
    let towards = light.axis[own].xyz
        + light.half * (at.x * light.right[own].xyz + at.y * light.up[own].xyz);
    let layer = layer_of(towards);
    let there = on_layer(layer, towards);
    let most = vec2i(i32(light.size) - 1);
    return Place(clamp(vec2i(floor(to_texels(there.xy / there.w))), vec2i(0), most), layer);
}

// The part of the kernel to the left of x.
fn part(x: f32) -> f32 {
    if light.is_tent == 0u { return clamp(x / light.side + 0.5, 0.0, 1.0); }
    let t = clamp(2.0 * x / light.side, -1.0, 1.0);
    return 0.5 + t - 0.5 * t * abs(t);
}

fn weight(texel: f32, at: f32) -> f32 {
    return part(texel + 1.0 - at) - part(texel - at);
}

@fragment
fn visibility(@builtin(position) position: vec4f) -> @location(0) f32 {
    let seen = textureLoad(faces, vec2u(position.xy), 0).x;
    if seen == 0u { return 0.0; }
    var receiver = receiver_of(position.xy, seen - 1u);
    if !receiver.is_there { return 1.0; }
    if light.way == ADDED { receiver.depth += light.bias; }
    if light.way == MULTIPLIED { receiver.depth *= 1.0 + light.bias; }
    if light.way == RECEIVER {
        let slope = (abs(receiver.plane.x) + abs(receiver.plane.y)) * (2.0 / light.size);
        receiver.depth += light.reach * slope;
    }
    let t = receiver.at;
    if light.side == 0.0 { return select(1.0, 0.0, blocks(receiver, vec2i(floor(t)))); }
    var lit = 0.0;
    var dark = 0.0;
    let low = floor(t - 0.5 * light.side);
    let count = i32(light.side) + 1;
    for (var j = 0; j < count; j++) {
        let y = low.y + f32(j);
        let along = weight(y, t.y);
        for (var i = 0; i < count; i++) {
            let x = low.x + f32(i);
            let share = along * weight(x, t.x);
            if share <= 0.0 { continue; }
            if blocks(receiver, vec2i(vec2f(x, y))) { dark += share; } else { lit += share; }
        }
    }
    // Exactly 0 or 1 where all texels agree.
    if dark == 0.0 { return 1.0; }
    return lit / (lit + dark);
}
