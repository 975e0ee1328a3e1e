// A shadow volume from stored signs and a listed silhouette. Twin: extrude.rs, which it equals triangle by
// triangle.
//
// One invocation takes four faces, as their signs are stored; silhouette edges are shared out among all
// invocations. Positions in the list come from prefix sums: those of casting faces by runs of RUN words,
// those of quads from the silhouette.

struct Parameters {
    vertices: u32,
    faces: u32,
    // The largest number of triangles.
    capacity: u32,
    // CAPS, DIRECTIONAL
    flags: u32,
}

struct Found {
    edges: u32,
    quads: u32,
    list: array<vec2u>,
}

// As wgpu's DrawIndexedIndirectArgs, which starts with a DrawIndirectArgs.
struct Draw {
    vertex_count: u32,
    instance_count: u32,
    first_vertex: u32,
    base_vertex: i32,
    first_instance: u32,
}

struct Demand {
    cap_faces: u32,
    edges: u32,
    quads: u32,
    // 1 if the volume exceeds the capacity: then nothing is drawn.
    exceeded: u32,
}

@group(0) @binding(0) var<uniform> parameters: Parameters;
@group(0) @binding(1) var<storage, read> signs: array<u32>;
// The number of casting faces of each run. After the scan: of all runs before it.
@group(0) @binding(2) var<storage, read_write> run_faces: array<u32>;
@group(0) @binding(3) var<storage, read> triangles: array<u32>;
@group(0) @binding(4) var<storage, read> vertices: array<f32>;
@group(0) @binding(5) var<storage, read> found: Found;
@group(0) @binding(6) var<storage, read> quads: array<u32>;
@group(0) @binding(7) var<storage, read> offsets: array<u32>;
@group(0) @binding(8) var<storage, read> entries: array<u32>;
// The vertices of each listed edge, the one whose position comes first in front.
@group(0) @binding(9) var<storage, read_write> ends: array<vec2u>;
@group(0) @binding(10) var<storage, read_write> volume: array<u32>;
// Light cap, sides, dark cap.
@group(0) @binding(11) var<storage, read_write> draws: array<Draw, 3>;
@group(0) @binding(12) var<storage, read_write> demand: Demand;

fn casting(word: u32) -> u32 { return countOneBits(word & 0x01010101u); }

@compute @workgroup_size(WORKGROUP)
fn count_caps(@builtin(global_invocation_id) global: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let run = linear_id(global, groups);
    let words = (parameters.faces + 3u) / 4u;
    let start = run * RUN;
    if start >= words { return; }
    let end = min(start + RUN, words);
    var count = 0u;
    for (var i = start; i < end; i++) { count += casting(signs[i]); }
    run_faces[run] = count;
}

// One invocation: the offsets of the parts, and whether they fit.
@compute @workgroup_size(1)
fn arrange() {
    let words = (parameters.faces + 3u) / 4u;
    let directional = (parameters.flags & DIRECTIONAL) != 0u;
    let per_quad = select(2u, 1u, directional);
    var caps = 0u;
    if (parameters.flags & CAPS) != 0u { caps = run_faces[(words + RUN - 1u) / RUN]; }
    let dark = select(caps, 0u, directional);
    // Step by step, since the sum may exceed u32.
    var room = parameters.capacity;
    var fits = caps <= room;
    room -= min(caps, room);
    fits &= dark <= room;
    room -= min(dark, room);
    fits &= found.quads <= room / per_quad;
    demand = Demand(caps, found.edges, found.quads, select(1u, 0u, fits));
    let sides = found.quads * per_quad;
    let instances = select(0u, 1u, fits);
    let drawn = 3u * instances;
    draws[0] = Draw(drawn * caps, instances, 0u, 0, 0u);
    draws[1] = Draw(drawn * sides, instances, drawn * caps, 0, 0u);
    draws[2] = Draw(drawn * dark, instances, drawn * (caps + sides), 0, 0u);
}

fn write(index: u32, a: u32, b: u32, c: u32, reversed: bool) {
    volume[3u * index] = a;
    volume[3u * index + 1u] = select(b, c, reversed);
    volume[3u * index + 2u] = select(c, b, reversed);
}

@compute @workgroup_size(WORKGROUP)
fn caps(@builtin(global_invocation_id) global: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let group = linear_id(global, groups);
    if 4u * group >= parameters.faces { return; }
    let word = signs[group];
    if casting(word) == 0u || draws[0].instance_count == 0u { return; }
    let run = group / RUN;
    var index = run_faces[run];
    for (var i = run * RUN; i < group; i++) { index += casting(signs[i]); }
    let dark = draws[2].vertex_count != 0u;
    let dark_start = draws[2].first_vertex / 3u;
    let far = parameters.vertices;
    for (var lane = 0u; lane < 4u; lane++) {
        let side = (word >> (8u * lane)) & 0xffu;
        if side == 0u { continue; }
        let face = 4u * group + lane;
        let a = triangles[3u * face];
        let b = triangles[3u * face + 1u];
        let c = triangles[3u * face + 2u];
        write(index, a, b, c, side != 1u);
        if dark { write(dark_start + index, far + a, far + b, far + c, side == 1u); }
        index++;
    }
}

// Integers in the order of the floats: a comparison of floats may flush subnormal ones.
fn ordered(x: f32) -> i32 {
    let bits = bitcast<i32>(x);
    return bits ^ ((bits >> 31u) & 0x7fffffff);
}

// The vertices of every listed edge. The diagonal of its quad goes by their positions, so that coincident
// quads of two meshes agree.
@compute @workgroup_size(WORKGROUP)
fn find_ends(@builtin(global_invocation_id) global: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let step = groups.x * groups.y * WORKGROUP;
    for (var i = linear_id(global, groups); i < found.edges; i += step) {
        let entry = entries[offsets[found.list[i].x]];
        let half_edge = entry >> 1u;
        let next = select(half_edge + 1u, half_edge - 2u, half_edge % 3u == 2u);
        let tail = triangles[half_edge];
        let head = triangles[next];
        let a = min(tail, head);
        let b = max(tail, head);
        var before = false;
        for (var axis = 0u; axis < 3u; axis++) {
            let p = ordered(vertices[3u * a + axis]);
            let q = ordered(vertices[3u * b + axis]);
            if p != q {
                before = q < p;
                break;
            }
        }
        ends[i] = select(vec2u(a, b), vec2u(b, a), before);
    }
}

@compute @workgroup_size(WORKGROUP)
fn sides(@builtin(global_invocation_id) global: vec3u, @builtin(num_workgroups) groups: vec3u) {
    if draws[1].instance_count == 0u { return; }
    let step = groups.x * groups.y * WORKGROUP;
    let directional = (parameters.flags & DIRECTIONAL) != 0u;
    let start = draws[1].first_vertex / 3u;
    let far = parameters.vertices;
    for (var i = linear_id(global, groups); i < found.edges; i += step) {
        let a = ends[i].x;
        let b = ends[i].y;
        let m = bitcast<i32>(found.list[i].y);
        let reversed = (m < 0) != (a > b);
        let copies = u32(abs(m));
        for (var quad = quads[i]; quad < quads[i] + copies; quad++) {
            if directional {
                write(start + quad, b, a, far + a, reversed);
            } else {
                write(start + 2u * quad, b, a, far + a, reversed);
                write(start + 2u * quad + 1u, b, far + a, far + b, reversed);
            }
        }
    }
}
