// Maps of face numbers with a test of the faces. hybrid.wgsl comes before it. Twin: ids.rs.

// The face of each texel and 1; 0 where there is none.
@group(0) @binding(11) var names: texture_2d_array<u32>;

struct Named {
    @builtin(frag_depth) depth: f32,
    @location(0) name: u32,
}

@fragment
fn caster_named(corner: Corner) -> Named {
    return Named(drawn_depth(corner), corner.face + 1u);
}

fn name_at(receiver: Receiver, texel: vec2i) -> u32 {
    if is_on_layer(texel) { return textureLoad(names, texel, receiver.layer, 0).x; }
    if light.layers == 1u { return 0u; }
    let other = beyond_rim(receiver.layer, texel);
    return textureLoad(names, other.texel, other.layer, 0).x;
}

const MISSED: u32 = 0u;
const CROSSED: u32 = 1u;
const UNSURE: u32 = 2u;

// 2⁻¹⁹: lengths are at most about 1, and a position is a sum of four rounded terms of its size.
const POSITION: f32 = 1.0 / 524288.0;

// From a corner of a face to the next one, rounded once.
fn edge(face: u32, corner: u32) -> vec3f {
    let next = triangles[3u * face + (corner + 1u) % 3u];
    return (vertex(next) * light.scale) - vertex(triangles[3u * face + corner]) * light.scale;
}

// Whether the segment from a point to the light crosses a face. Signs of volumes decide; one within its
// rounding decides nothing.
fn crossed(q: vec3f, face: u32) -> u32 {
    let a = from_light(triangles[3u * face]) - q;
    let b = from_light(triangles[3u * face + 1u]) - q;
    let c = from_light(triangles[3u * face + 2u]) - q;
    var towards = light.axis[0].xyz;
    if light.is_central != 0u { towards = -q; }
    // Of the line: on one side of all three edges.
    let edges = array<vec3f, 3>(edge(face, 0u), edge(face, 1u), edge(face, 2u));
    let volumes = vec3f(
        dot(towards, cross(a, edges[0])), dot(towards, cross(b, edges[1])), dot(towards, cross(c, edges[2])));
    let sizes = vec3f(length(edges[0]), length(edges[1]), length(edges[2]));
    let far = 1.0 + max(length(a), max(length(b), length(c))) + length(towards);
    let bounds = sizes * (POSITION * far * length(towards));
    let above = volumes > bounds;
    let below = volumes < -bounds;
    if any(above) && any(below) { return MISSED; }
    // The parameter at which the segment to the light crosses the plane.
    let normal = cross(edges[0], edges[1]);
    let slope = dot(normal, towards);
    let height = dot(normal, a);
    let size = max(sizes.x, max(sizes.y, sizes.z));
    let bound = 2.0 * POSITION * far * size * size;
    if abs(slope) <= bound { return UNSURE; }
    let way = height * sign(slope);
    if way < -bound { return MISSED; }
    let end = way - abs(slope);
    if light.is_central != 0u && end > bound { return MISSED; }
    let is_between = way > bound && (light.is_central == 0u || end < -bound);
    return select(UNSURE, CROSSED, is_between && (all(above) || all(below)));
}

// As in `seen_by`, and whether a face named by a texel is crossed.
fn crossed_or_seen(receiver: Receiver, own: u32) -> u32 {
    let seen = seen_by(receiver);
    if seen == BLOCKED { return BLOCKED; }
    if !receiver.is_there { return MIXED; }
    let reach = i32(light.reach);
    let middle = vec2i(floor(receiver.at));
    var found = OPEN;
    var last = own;
    for (var j = -reach; j <= reach; j++) {
        for (var i = -reach; i <= reach; i++) {
            let name = name_at(receiver, middle + vec2i(i, j));
            if name == 0u || name == own || name == last { continue; }
            last = name;
            let crossing = crossed(receiver.q, name - 1u);
            if crossing == CROSSED { return BLOCKED; }
            if crossing == UNSURE { found = MIXED; }
        }
    }
    return found;
}

@fragment
fn tested(@builtin(position) position: vec4f) -> @location(0) f32 {
    let seen = textureLoad(faces, vec2u(position.xy), 0).x;
    if seen == 0u { return 0.0; }
    return marked_unless(crossed_or_seen(receiver_of(position.xy, seen - 1u), seen), position.xy);
}
