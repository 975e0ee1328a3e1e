// The side of every face, and the edges where sides change. Twins: facing/planes.rs and silhouette/linear.rs.
//
// One invocation takes four faces: their sides are four bytes of a u32 (0x01 in front, 0xff behind, 0x00
// edge-on), so that no two invocations write one word. One invocation takes EDGES edges, or RUN where
// positions in the list are counted; the order of the list is that of the edges, fixed by prefix sums.

struct Light {
    // The light in the units of the mesh (facing/gpu.rs), or as it is (`facing_by_positions`).
    l: vec4f,
    reach: f32,
    lowest: f32,
    faces: u32,
    padding: u32,
}

struct Unsure {
    count: atomic<u32>,
    faces: array<u32>,
}

struct Patch {
    word: u32,
    keep: u32,
    bits: u32,
}

struct Found {
    edges: u32,
    quads: u32,
    list: array<vec2u>,
}

@group(0) @binding(0) var<uniform> light: Light;
// x of the normals of all groups of four, then y, z, offsets, errors.
@group(0) @binding(1) var<storage, read> planes: array<vec4f>;
@group(0) @binding(2) var<storage, read_write> facing: array<u32>;
@group(0) @binding(3) var<storage, read_write> unsure: Unsure;
@group(0) @binding(4) var<storage, read> triangles: array<u32>;
@group(0) @binding(5) var<storage, read> vertices: array<f32>;
@group(0) @binding(6) var<storage, read> patches: array<Patch>;
// Bit 0 of a face's byte: it casts if in front; bit 1: it casts if behind.
@group(0) @binding(7) var<storage, read_write> masks: array<u32>;
// The sides of faces that cast; 0 for all others.
@group(0) @binding(8) var<storage, read> signs: array<u32>;
// The same three, sixteen faces at a time.
@group(0) @binding(2) var<storage, read_write> facing_16: array<vec4u>;
@group(0) @binding(7) var<storage, read_write> masks_16: array<vec4u>;
@group(0) @binding(8) var<storage, read_write> signs_16: array<vec4u>;
@group(0) @binding(9) var<storage, read> offsets: array<u32>;
@group(0) @binding(10) var<storage, read> entries: array<u32>;
@group(0) @binding(11) var<storage, read_write> multiplicities: array<i32>;
// For each run the number of silhouette edges, then for each run the sum of their |m|. After the scan: the
// sum of everything before, in one sequence.
@group(0) @binding(12) var<storage, read_write> runs: array<u32>;
@group(0) @binding(13) var<storage, read_write> found: Found;
// For each listed edge the sum of |m| over those before it.
@group(0) @binding(14) var<storage, read_write> quads: array<u32>;
// x: edges, faces or patches.
@group(0) @binding(15) var<uniform> size: vec4u;

fn packed(s: vec4f) -> u32 {
    let bytes = select(select(vec4u(0u), vec4u(0xffu), s < vec4f(0.0)), vec4u(1u), s > vec4f(0.0));
    return bytes.x | (bytes.y << 8u) | (bytes.z << 16u) | (bytes.w << 24u);
}

// The filter: right where |s| exceeds the bound; elsewhere s keeps its sign, and the face is listed as
// unsure.
@compute @workgroup_size(WORKGROUP)
fn facing_by_planes(@builtin(global_invocation_id) global: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let group = linear_id(global, groups);
    let count = (light.faces + 3u) / 4u;
    if group >= count { return; }
    let x = planes[group] * light.l.x;
    let y = planes[group + count] * light.l.y;
    let z = planes[group + 2u * count] * light.l.z;
    let d = planes[group + 3u * count] * light.l.w;
    let e = planes[group + 4u * count];
    let s = (x + y) + (z + d);
    let bound = EVALUATION * ((abs(x) + abs(y)) + (abs(z) + abs(d))) + (e * light.reach + light.lowest);
    facing[group] = packed(s);
    let open = select(vec4u(0u), vec4u(1u, 2u, 4u, 8u), abs(s) <= bound);
    var left = open.x | open.y | open.z | open.w;
    while left != 0u {
        let face = 4u * group + firstTrailingBit(left);
        left &= left - 1u;
        if face < light.faces {
            unsure.faces[atomicAdd(&unsure.count, 1u)] = face;
        }
    }
}

fn vertex(i: u32) -> vec3f {
    return vec3f(vertices[3u * i], vertices[3u * i + 1u], vertices[3u * i + 2u]);
}

fn side(face: u32) -> f32 {
    if face >= light.faces { return 0.0; }
    let a = vertex(triangles[3u * face]);
    let b = vertex(triangles[3u * face + 1u]);
    let c = vertex(triangles[3u * face + 2u]);
    return dot(cross(b - a, c - a), light.l.xyz - a * light.l.w);
}

// From positions that change with every frame: without an error bound, relative to a corner of the face.
@compute @workgroup_size(WORKGROUP)
fn facing_by_positions(@builtin(global_invocation_id) global: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let group = linear_id(global, groups);
    let face = 4u * group;
    if face >= light.faces { return; }
    facing[group] = packed(vec4f(side(face), side(face + 1u), side(face + 2u), side(face + 3u)));
}

// Writes the sides that the host decided, word by word.
@compute @workgroup_size(WORKGROUP)
fn settle(@builtin(global_invocation_id) global: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let i = linear_id(global, groups);
    if i >= size.x { return; }
    let word = patches[i].word;
    facing[word] = (facing[word] & patches[i].keep) | patches[i].bits;
}

// A face with two equal corners never casts.
@compute @workgroup_size(WORKGROUP)
fn drop_collapsed(@builtin(global_invocation_id) global: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let group = linear_id(global, groups);
    if 4u * group >= size.x { return; }
    var kept = 0u;
    for (var lane = 0u; lane < 4u; lane++) {
        let face = 4u * group + lane;
        if face < size.x {
            let a = triangles[3u * face];
            let b = triangles[3u * face + 1u];
            let c = triangles[3u * face + 2u];
            if a != b && b != c && c != a { kept |= 0xffu << (8u * lane); }
        }
    }
    masks[group] &= kept;
}

@compute @workgroup_size(WORKGROUP)
fn choose_casters(@builtin(global_invocation_id) global: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let i = linear_id(global, groups);
    if 16u * i >= size.x { return; }
    let each = vec4u(0x01010101u);
    let sides = facing_16[i];
    let mask = masks_16[i];
    let back = (sides >> vec4u(1u)) & each;
    let front = sides & each & ~back;
    let casts = (front & mask) | (back & (mask >> vec4u(1u)));
    signs_16[i] = sides & (casts * 0xffu);
}

// An entry's sign, along or against its edge.
fn use_of(entry: u32) -> i32 {
    let face = (entry >> 1u) / 3u;
    let s = bitcast<i32>(signs[face >> 2u] << (24u - 8u * (face & 3u))) >> 24u;
    return select(s, -s, (entry & 1u) == 1u);
}

@compute @workgroup_size(WORKGROUP)
fn multiply(@builtin(global_invocation_id) global: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let first = EDGES * linear_id(global, groups);
    if first >= size.x { return; }
    let last = min(first + EDGES, size.x);
    var i = offsets[first];
    for (var edge = first; edge < last; edge++) {
        let end = offsets[edge + 1u];
        var m = 0;
        for (; i < end; i++) { m += use_of(entries[i]); }
        multiplicities[edge] = m;
    }
}

fn run_count() -> u32 { return (size.x + RUN - 1u) / RUN; }

@compute @workgroup_size(WORKGROUP)
fn count_runs(@builtin(global_invocation_id) global: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let run = linear_id(global, groups);
    let start = run * RUN;
    if start >= size.x { return; }
    let end = min(start + RUN, size.x);
    var edges = 0u;
    var sum = 0u;
    for (var i = start; i < end; i++) {
        let m = u32(abs(multiplicities[i]));
        edges += u32(m != 0u);
        sum += m;
    }
    runs[run] = edges;
    runs[run_count() + run] = sum;
}

@compute @workgroup_size(WORKGROUP)
fn list_runs(@builtin(global_invocation_id) global: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let run = linear_id(global, groups);
    let count = run_count();
    let all = runs[count];
    if run == 0u {
        found.edges = all;
        found.quads = runs[2u * count] - all;
    }
    let start = run * RUN;
    if start >= size.x { return; }
    // Most runs have none.
    var index = runs[run];
    if index == runs[run + 1u] { return; }
    let end = min(start + RUN, size.x);
    var sum = runs[count + run] - all;
    for (var i = start; i < end; i++) {
        let m = multiplicities[i];
        if m != 0 {
            found.list[index] = vec2u(i, bitcast<u32>(m));
            quads[index] = sum;
            index++;
            sum += u32(abs(m));
        }
    }
}
