// The edge table of a triangle list. Twin: build.rs, which sorts differently to the same result; driven by
// gpu/build.rs. `list` writes every half-edge with its larger vertex as key, the host sorts, `rekey` makes
// the smaller vertex the key, the host sorts again (stable: half-edges now ascend by smaller vertex, larger
// vertex and id), `mark` marks the first half-edge of each edge, a prefix sum makes edge numbers of the
// marks, `put_offsets` writes where each edge starts. Every kernel runs over half-edges. A half-edge of a
// collapsed face has the vertex count as key, and so comes after all others.

@group(0) @binding(0) var<storage, read> triangles: array<u32>;
@group(0) @binding(1) var<storage, read_write> keys: array<u32>;
// Half-edge ids, each before one bit of direction: 1 if it runs from the larger vertex to the smaller.
@group(0) @binding(2) var<storage, read_write> entries: array<u32>;
// Marks, then their prefix sums.
@group(0) @binding(3) var<storage, read_write> edges: array<u32>;
@group(0) @binding(4) var<storage, read_write> offsets: array<u32>;
@group(0) @binding(5) var<storage, read_write> found: Found;
@group(0) @binding(6) var<uniform> size: Size;

struct Size {
    half_edges: u32,
    vertices: u32,
}

struct Found {
    // The first face with a corner that is no vertex; all ones without any.
    bad_face: atomic<u32>,
    // The number of half-edges that belong to an edge.
    kept: u32,
}

fn next(half_edge: u32) -> u32 {
    return select(half_edge + 1u, half_edge - 2u, half_edge % 3u == 2u);
}

fn larger_vertex(entry: u32) -> u32 {
    let half_edge = entry >> 1u;
    return triangles[select(next(half_edge), half_edge, (entry & 1u) == 1u)];
}

fn smaller_vertex(entry: u32) -> u32 {
    let half_edge = entry >> 1u;
    return triangles[select(half_edge, next(half_edge), (entry & 1u) == 1u)];
}

@compute @workgroup_size(WORKGROUP)
fn list(@builtin(global_invocation_id) global: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let half_edge = linear_id(global, groups);
    if half_edge >= size.half_edges { return; }
    let tail = triangles[half_edge];
    let head = triangles[next(half_edge)];
    let other = triangles[next(next(half_edge))];
    let largest = max(tail, max(head, other));
    var key = max(tail, head);
    if largest >= size.vertices {
        atomicMin(&found.bad_face, half_edge / 3u);
        key = size.vertices;
    } else if tail == head || head == other || other == tail {
        key = size.vertices;
    }
    keys[half_edge] = key;
    entries[half_edge] = half_edge << 1u | u32(tail > head);
}

@compute @workgroup_size(WORKGROUP)
fn rekey(@builtin(global_invocation_id) global: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let i = linear_id(global, groups);
    if i >= size.half_edges || keys[i] == size.vertices { return; }
    keys[i] = smaller_vertex(entries[i]);
}

@compute @workgroup_size(WORKGROUP)
fn mark(@builtin(global_invocation_id) global: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let i = linear_id(global, groups);
    if i >= size.half_edges { return; }
    let key = keys[i];
    var first = false;
    if key != size.vertices {
        first = i == 0u;
        if !first {
            first = keys[i - 1u] != key || larger_vertex(entries[i - 1u]) != larger_vertex(entries[i]);
        }
        var last = i + 1u == size.half_edges;
        if !last { last = keys[i + 1u] == size.vertices; }
        if last { found.kept = i + 1u; }
    }
    edges[i] = u32(first);
}

@compute @workgroup_size(WORKGROUP)
fn put_offsets(@builtin(global_invocation_id) global: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let i = linear_id(global, groups);
    if i >= size.half_edges { return; }
    if edges[i + 1u] != edges[i] { offsets[edges[i]] = i; }
    if i == 0u { offsets[edges[size.half_edges]] = found.kept; }
}
