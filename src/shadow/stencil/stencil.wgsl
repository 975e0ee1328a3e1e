// Receivers and shadow volumes, drawn without vertex buffers. Where triangles have a depth of their own,
// there is one invocation per corner, looked up by its index. Otherwise there is one invocation per shared
// vertex, drawn with the triangles as indices. Twin: `Frame` below mirrors the struct in gpu/uniforms.rs. The
// exact reference of the counts is verify/pixels.
//
// All values in `Frame` are scaled by powers of two, which is exact. Lengths are scaled by `scale`, so that
// the mesh has a size of about 1. Values of which only the direction matters (the light, vertices at
// infinity) are scaled by `light_scale`.

struct Frame {
    right: vec3f,
    scale: f32,
    up: vec3f,
    near: f32,
    forward: vec3f,
    light_scale: f32,
    // The direction of the ray through (x, y) in normalized device coordinates is ray_right·x + ray_up·y +
    // ray_forward, at depth 1.
    ray_right: vec3f,
    vertex_count: u32,
    ray_up: vec3f,
    light_w: f32,
    ray_forward: vec3f,
    width: f32,
    eye: vec3f,
    height: f32,
    light: vec3f,
    unused: f32,
}

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<storage, read> vertices: array<f32>;
@group(0) @binding(2) var<storage, read> triangles: array<u32>;
// Unit normals of the receivers' faces; zero for a face without a normal.
@group(0) @binding(3) var<storage, read> normals: array<f32>;

struct Corner {
    @invariant @builtin(position) clip: vec4f,
    // Depth as a linear function of (x, y, 1) in normalized device coordinates.
    @location(0) @interpolate(flat) depth: vec3f,
    // The receiver's face index.
    @location(1) @interpolate(flat) face: u32,
}

// A corner of a side of a volume.
struct Side {
    @invariant @builtin(position) clip: vec4f,
    // Depth, as for a receiver.
    @location(0) @interpolate(flat) depth: vec3f,
    // The lines where the side ends: its edge, and the lines along which the edge's two ends are extruded.
    // Each is a linear function of (x, y, 1) in normalized device coordinates: 0 on the line, rising by 1 per
    // unit towards the side. Zero for a line that is seen end-on.
    @location(1) @interpolate(flat) edge: vec3f,
    @location(2) @interpolate(flat) end_a: vec3f,
    @location(3) @interpolate(flat) end_b: vec3f,
}

fn vertex(id: u32) -> vec3f {
    return vec3f(vertices[3u * id], vertices[3u * id + 1u], vertices[3u * id + 2u]);
}

fn project(q: vec3f, w: f32) -> vec4f {
    return vec4f(dot(frame.right, q), dot(frame.up, q), frame.near * w, dot(frame.forward, q));
}

// The depth near/t at which rays meet the plane through `place` (relative to the eye) with `normal`. If the
// eye lies in the plane, the plane covers no pixel, and the depth is 0, at infinity.
fn plane_depth(normal: vec3f, place: vec3f) -> vec3f {
    let distance = dot(normal, place);
    if distance == 0.0 { return vec3f(0.0); }
    let slope = vec3f(dot(normal, frame.ray_right), dot(normal, frame.ray_up), dot(normal, frame.ray_forward));
    return slope * (frame.near / distance);
}

fn normalized(position: vec2f) -> vec2f {
    return vec2f(2.0 * position.x / frame.width - 1.0, 1.0 - 2.0 * position.y / frame.height);
}

fn depth_at(position: vec2f, depth: vec3f) -> f32 {
    return clamp(dot(depth, vec3f(normalized(position), 1.0)), 0.0, 1.0);
}

// Flat values come from a triangle's first corner; the other corners need none.
@vertex
fn receiver(@builtin(vertex_index) index: u32) -> Corner {
    let face = index / 3u;
    let q = vertex(triangles[index]) * frame.scale - frame.eye;
    if index % 3u != 0u { return Corner(project(q, 1.0), vec3f(0.0), face); }
    let normal = vec3f(normals[3u * face], normals[3u * face + 1u], normals[3u * face + 2u]);
    return Corner(project(q, 1.0), plane_depth(normal, q), face);
}

// A vertex of the receivers, for triangles that share vertices: no depth is needed except the interpolated
// one.
@vertex
fn receiver_vertex(@builtin(vertex_index) id: u32) -> Corner {
    return Corner(project(vertex(id) * frame.scale - frame.eye, 1.0), vec3f(0.0), 0u);
}

// The vertex of the caster that a volume vertex belongs to, finite or at infinity.
fn base(id: u32) -> u32 {
    return select(id, id - frame.vertex_count, id >= frame.vertex_count);
}

fn is_direction(id: u32) -> bool {
    return frame.light_w == 0.0 && id >= frame.vertex_count;
}

// Bit patterns in numerical order. Comparing floats directly might flush subnormal numbers.
fn ordered(v: vec3f) -> vec3i {
    let bits = bitcast<vec3i>(v);
    return bits ^ ((bits >> vec3u(31u)) & vec3i(0x7fffffff));
}

fn less(v: vec3f, w: vec3f) -> bool {
    let a = ordered(v);
    let b = ordered(w);
    if a.x != b.x { return a.x < b.x; }
    if a.y != b.y { return a.y < b.y; }
    return a.z < b.z;
}

// The same direction, scaled to a largest component of 1, so that products of several directions keep their
// digits.
fn direction(v: vec3f) -> vec3f {
    let largest = max(max(abs(v.x), abs(v.y)), abs(v.z));
    return select(v / largest, vec3f(0.0), largest == 0.0);
}

// The direction from the light to a vertex, or the travel direction of a directional light.
fn away(v: vec3f) -> vec3f {
    return v * (frame.light_scale * frame.light_w) - frame.light;
}

fn volume_clip(id: u32) -> vec4f {
    let v = vertex(base(id));
    if id >= frame.vertex_count {
        let far = away(v);
        // A vertex exactly at the light has no direction. Such a vertex stays in position for all triangles,
        // so nothing opens, and the triangles added have no area.
        if any(far != vec3f(0.0)) { return project(far, 0.0); }
    }
    return project(v * frame.scale - frame.eye, 1.0);
}

// The projected line from `v` along a direction, rising towards `inside`, which is a direction too.
//
// A side consists of the sums of `a`, `b` and, at infinity, away(a) and away(b), with positive weights.
// away(b) is away(a) plus a non-negative multiple of b - a. So two of these four lie on the line; the other
// two do not, and both of those lie on the side of `inside`. Hence the part of the volume's side in front of
// the eye appears on this side of the line, even if `a` and `b` are behind the eye.
fn line(v: vec3f, along: vec3f, inside: vec3f) -> vec3f {
    // Normal of the plane through the line and the eye.
    let normal = cross(direction(v * frame.scale - frame.eye), direction(along));
    let seen = vec3f(dot(normal, frame.ray_right), dot(normal, frame.ray_up), dot(normal, frame.ray_forward));
    let steepness = length(seen.xy);
    if steepness == 0.0 { return vec3f(0.0); }
    return seen * (sign(dot(normal, direction(inside))) / steepness);
}

// A corner of a volume. Its depth is that of the plane through the light and the silhouette edge, computed
// from the edge itself. Interpolating from a clipped corner to infinity would lose digits.
@vertex
fn volume(@builtin(vertex_index) index: u32) -> Side {
    let none = vec3f(0.0);
    if index % 3u != 0u { return Side(volume_clip(triangles[index]), none, none, none, none); }
    let ids = vec3u(triangles[index], triangles[index + 1u], triangles[index + 2u]);
    // The ends of the edge: the two vertices that the triangle's corners belong to, finite or extruded. The
    // single point at infinity of a directional light belongs to neither.
    let one = select(ids.x, ids.y, is_direction(ids.x));
    var other = ids.z;
    if is_direction(ids.z) || base(ids.z) == base(one) { other = ids.y; }
    var a = vertex(base(one));
    var b = vertex(base(other));
    // The same order for every side on these two positions, whatever the vertex indices.
    if less(b, a) {
        let swapped = a;
        a = b;
        b = swapped;
    }
    let edge = (b - a) * frame.scale;
    let normal = direction(cross(direction(edge), direction(away(a))));
    let depth = plane_depth(normal, a * frame.scale - frame.eye);
    let end_a = line(a, away(a), edge);
    let end_b = line(b, away(b), -edge);
    return Side(volume_clip(ids.x), depth, line(a, edge, away(a)), end_a, end_b);
}

// A vertex of a volume, finite or not, for triangles that share vertices: no depth is needed except the
// interpolated one.
@vertex
fn volume_vertex(@builtin(vertex_index) id: u32) -> Corner {
    return Corner(volume_clip(id), vec3f(0.0), 0u);
}

@fragment
fn plane(corner: Corner) -> @builtin(frag_depth) f32 {
    return depth_at(corner.clip.xy, corner.depth);
}

// Depth of a side, clamped to the side's boundary. A rasterizer rounds corners to 1/256 pixel, and so may
// cover a pixel just beyond a line where the side ends. There the plane of a side that is seen nearly edge-on
// lies far in front of the side, or far behind. So the depth is that of the nearest point of the side, at
// most 1/128 pixel away: a line that is seen nearly end-on is not known precisely.
fn side_depth(side: Side) -> f32 {
    let most = 1.0 / (64.0 * max(frame.width, frame.height));
    var p = normalized(side.clip.xy);
    p -= side.end_a.xy * clamp(dot(side.end_a, vec3f(p, 1.0)), -most, 0.0);
    p -= side.end_b.xy * clamp(dot(side.end_b, vec3f(p, 1.0)), -most, 0.0);
    p -= side.edge.xy * clamp(dot(side.edge, vec3f(p, 1.0)), -most, 0.0);
    return clamp(dot(side.depth, vec3f(p, 1.0)), 0.0, 1.0);
}

@fragment
fn side_plane(side: Side) -> @builtin(frag_depth) f32 {
    return side_depth(side);
}

// Integer counting in a buffer, for scenes that could overflow the stencil.

@group(0) @binding(4) var<storage, read_write> counts: array<atomic<i32>>;
@group(0) @binding(5) var receiver_depth: texture_depth_2d;

fn count(position: vec4f, by: i32) {
    let place = u32(position.y) * u32(frame.width) + u32(position.x);
    atomicAdd(&counts[place], by);
}

@fragment
fn count_all(corner: Corner, @builtin(front_facing) front: bool) {
    count(corner.clip, select(1, -1, front));
}

@fragment
fn count_behind(side: Side, @builtin(front_facing) front: bool) {
    let depth = side_depth(side);
    if !(depth > textureLoad(receiver_depth, vec2u(side.clip.xy), 0)) {
        count(side.clip, select(1, -1, front));
    }
}

@fragment
fn count_before(side: Side, @builtin(front_facing) front: bool) {
    let depth = side_depth(side);
    if depth > textureLoad(receiver_depth, vec2u(side.clip.xy), 0) {
        count(side.clip, select(-1, 1, front));
    }
}
