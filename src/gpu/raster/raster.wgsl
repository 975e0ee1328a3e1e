// Triangles as a camera sees them, drawn without vertex buffers. Where triangles get their depth from their
// plane, there is one invocation per corner, looked up by its index. Otherwise there is one invocation per
// shared vertex, drawn with the triangles as indices. Twin: `Frame` below mirrors the struct in frame.rs.
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
    // The direction of the ray through (x, y) in normalized device coordinates is
    // ray_right·x + ray_up·y + ray_forward, at depth 1.
    ray_right: vec3f,
    vertex_count: u32,
    ray_up: vec3f,
    light_w: f32,
    ray_forward: vec3f,
    width: f32,
    eye: vec3f,
    height: f32,
    light: vec3f,
    // How far apart the components of a normal are stored; 0 where normals are not stored.
    plane_stride: u32,
}

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<storage, read> vertices: array<f32>;
@group(0) @binding(2) var<storage, read> triangles: array<u32>;
// Of the receivers' faces: the x of all unit normals, then y, z, and what the filter for sides has besides.
@group(0) @binding(3) var<storage, read> planes: array<f32>;
// The depth of the visible points; 0 where nothing is seen.
@group(0) @binding(4) var receiver_depth: texture_depth_2d;

struct Corner {
    @invariant @builtin(position) clip: vec4f,
    // Depth as a linear function of (x, y, 1) in normalized device coordinates.
    @location(0) @interpolate(flat) depth: vec3f,
    // The receiver's face index.
    @location(1) @interpolate(flat) face: u32,
}

fn vertex(id: u32) -> vec3f {
    return vec3f(vertices[3u * id], vertices[3u * id + 1u], vertices[3u * id + 2u]);
}

// The same direction with a largest component of 1, so that products of several keep their digits.
fn direction(v: vec3f) -> vec3f {
    let largest = max(max(abs(v.x), abs(v.y)), abs(v.z));
    return select(v / largest, vec3f(0.0), largest == 0.0);
}

// The unit normal of a receiver's face; zero where it has none.
fn face_normal(face: u32) -> vec3f {
    let stride = frame.plane_stride;
    if stride != 0u { return vec3f(planes[face], planes[stride + face], planes[2u * stride + face]); }
    let a = vertex(triangles[3u * face]);
    let b = vertex(triangles[3u * face + 1u]);
    let c = vertex(triangles[3u * face + 2u]);
    // Scaled first: the difference of two of the largest numbers is none.
    let u = b * frame.scale - a * frame.scale;
    let v = c * frame.scale - a * frame.scale;
    let normal = direction(cross(direction(u), direction(v)));
    return select(normalize(normal), vec3f(0.0), all(normal == vec3f(0.0)));
}

fn project(q: vec3f, w: f32) -> vec4f {
    return vec4f(dot(frame.right, q), dot(frame.up, q), frame.near * w, dot(frame.forward, q));
}

// The depth near/t at which rays meet the plane through `point` (from the eye) with `normal`; 0, at infinity,
// where the eye is in the plane and it covers nothing.
fn plane_depth(normal: vec3f, point: vec3f) -> vec3f {
    let distance = dot(normal, point);
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

// Flat values are those of a triangle's first corner; the others need none.
@vertex
fn receiver(@builtin(vertex_index) index: u32) -> Corner {
    let face = index / 3u;
    let q = vertex(triangles[index]) * frame.scale - frame.eye;
    if index % 3u != 0u { return Corner(project(q, 1.0), vec3f(0.0), face); }
    return Corner(project(q, 1.0), plane_depth(face_normal(face), q), face);
}

// A vertex of receivers, for triangles that share it: its depth is interpolated.
@vertex
fn receiver_vertex(@builtin(vertex_index) id: u32) -> Corner {
    return Corner(project(vertex(id) * frame.scale - frame.eye, 1.0), vec3f(0.0), 0u);
}

@fragment
fn plane(corner: Corner) -> @builtin(frag_depth) f32 {
    return depth_at(corner.clip.xy, corner.depth);
}

struct Face {
    @builtin(frag_depth) depth: f32,
    @location(0) face: u32,
}

// The visible face and 1, with the depth of its plane.
@fragment
fn face_of_plane(corner: Corner) -> Face {
    return Face(depth_at(corner.clip.xy, corner.depth), corner.face + 1u);
}

// The visible face and 1, with the interpolated depth.
@fragment
fn face(corner: Corner) -> @location(0) u32 {
    return corner.face + 1u;
}

// A triangle that covers the whole target, at depth 0: infinitely far.
@vertex
fn everywhere(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
    return vec4f(f32(4u * (index & 1u)) - 1.0, f32(2u * (index & 2u)) - 1.0, 0.0, 1.0);
}
