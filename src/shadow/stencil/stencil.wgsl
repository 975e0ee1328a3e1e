// Shadow volumes, counted against the depth of the receivers. raster.wgsl comes before it. The exact
// counterpart of the counts is verify/pixels.

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
    // Scaled first: the difference of two of the largest numbers is none.
    let edge = b * frame.scale - a * frame.scale;
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

@group(0) @binding(5) var<storage, read_write> counts: array<atomic<i32>>;

fn pixel(position: vec4f) -> u32 {
    return u32(position.y) * u32(frame.width) + u32(position.x);
}

fn count(position: vec4f, by: i32) {
    atomicAdd(&counts[pixel(position)], by);
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

// The visibility of a sample whose count in the stencil is 0, which the stencil test ensures.
@fragment
fn lit() -> @location(0) f32 {
    return 1.0;
}

// The visibility of a sample by its integer count.
@fragment
fn lit_by_count(@builtin(position) position: vec4f) -> @location(0) f32 {
    return select(0.0, 1.0, atomicLoad(&counts[pixel(position)]) == 0);
}

// The masked stencil: only samples of which nothing is proven are counted.

// What is proven of each sample: 0 nothing, 1 lit, 2 dark.
@group(0) @binding(6) var<storage, read> proven: array<u32>;

@fragment
fn undecided(@builtin(position) position: vec4f) {
    if proven[pixel(position)] != 0u { discard; }
}

@fragment
fn proven_lit(@builtin(position) position: vec4f) -> @location(0) f32 {
    if proven[pixel(position)] != 1u { discard; }
    return 1.0;
}

// A corner of a casting face, seen from the light on the near plane: where the line through the corner and
// the light meets it. With g(X) = forward·X − near·w, which is 0 on the plane, for the corner V and the light
// L this is the point g(L)·V − g(V)·L. Its weight is positive where the light is farther from the plane than
// V, on V's side; V is between the two where g(V) has the sign of g(L), which clipping by depth ensures.
@vertex
fn near_vertex(@builtin(vertex_index) id: u32) -> Corner {
    let v = vertex(base(id)) * frame.scale - frame.eye;
    // The light in the same units, up to a positive factor.
    let weight = frame.light_w * (frame.light_scale / frame.scale);
    let light = frame.light - frame.eye * weight;
    let of_light = dot(frame.forward, light) - frame.near * weight;
    let of_vertex = dot(frame.forward, v) - frame.near;
    let side = sign(of_light);
    let q = side * (of_light * v - of_vertex * light);
    let w = side * (of_light - of_vertex * weight);
    // As project(q, w), but with a depth that is small and positive between light and plane.
    let depth = exp2(-24.0) * frame.near * side * of_vertex;
    let clip = vec4f(dot(frame.right, q), dot(frame.up, q), depth, frame.near * w);
    return Corner(clip, vec3f(0.0), 0u);
}
