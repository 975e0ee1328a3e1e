// A shadow map under a lamp with an extent: its pyramid, and a visible point with its penumbra scale.
// raster.wgsl and map.wgsl come before it. Twins: pyramid.rs, light_map.rs, scene/lamp/horizon.rs; lamp.rs
// mirrors the struct.

struct SoftLamp {
    // Half the edges of a lamp with a fixed surface, in units of the light's space.
    across: vec3f,
    // Radius of a disk that faces the receiver; 0 for a fixed surface.
    radius: f32,
    along: vec3f,
    // Half-width of the penumbra in texels, per difference of depth, of a lamp of half-size 1.
    per_extent: f32,
    // From the light's origin; of a sun the direction towards it.
    center: vec3f,
    is_round: u32,
    // Points that are looked at for blockers, and by the filter; 0 for all texels.
    blockers: u32,
    taps: u32,
    // 1 over the side of the map.
    per_size: f32,
    spare: u32,
}

@group(0) @binding(8) var<uniform> lamp: SoftLamp;
// Least and greatest depth of squares of texels, level after level, of all layers each.
@group(0) @binding(9) var<storage, read> pyramid: array<vec2f>;
@group(0) @binding(10) var<storage, read_write> built: array<vec2f>;
@group(0) @binding(11) var<uniform> built_level: u32;

const PI: f32 = 3.14159265;
const TILE: i32 = 8;
// Bound of the ratio between a point's depths in two neighboring layers of a cube.
const MOST_RATIO: f32 = 3.0;

struct Level {
    // Cells along a side.
    side: u32,
    // Side of a cell in texels.
    cell: i32,
    // The first cell.
    first: u32,
}

fn first_level() -> Level {
    return Level((u32(light.size) + 7u) / 8u, TILE, 0u);
}

fn next_level(level: Level) -> Level {
    let count = light.layers * level.side * level.side;
    return Level((level.side + 1u) / 2u, 2 * level.cell, level.first + count);
}

fn cell_index(level: Level, layer: u32, i: u32, j: u32) -> u32 {
    return level.first + (layer * level.side + j) * level.side + i;
}

@compute @workgroup_size(WORKGROUP)
fn tiles(@builtin(global_invocation_id) global: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let id = linear_id(global, groups);
    let level = first_level();
    if id >= light.layers * level.side * level.side { return; }
    let at = vec2i(vec2u(id % level.side, id / level.side % level.side)) * TILE;
    let layer = id / (level.side * level.side);
    var found = vec2f(3e38, 0.0);
    for (var j = at.y; j < min(at.y + TILE, i32(light.size)); j++) {
        for (var i = at.x; i < min(at.x + TILE, i32(light.size)); i++) {
            let depth = textureLoad(map, vec2i(i, j), layer, 0);
            found = vec2f(min(found.x, depth), max(found.y, depth));
        }
    }
    built[id] = found;
}

// A level from the one below it.
@compute @workgroup_size(WORKGROUP)
fn join(@builtin(global_invocation_id) global: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let id = linear_id(global, groups);
    var below = first_level();
    for (var level = 1u; level < built_level; level++) { below = next_level(below); }
    let own = next_level(below);
    if id >= light.layers * own.side * own.side { return; }
    let at = 2u * vec2u(id % own.side, id / own.side % own.side);
    let layer = id / (own.side * own.side);
    var found = vec2f(3e38, 0.0);
    for (var j = at.y; j < min(at.y + 2u, below.side); j++) {
        for (var i = at.x; i < min(at.x + 2u, below.side); i++) {
            let range = built[cell_index(below, layer, i, j)];
            found = vec2f(min(found.x, range.x), max(found.y, range.y));
        }
    }
    built[own.first + id] = found;
}

// The greatest depth of the map.
fn most_drawn() -> f32 {
    var level = first_level();
    while level.side > 1u { level = next_level(level); }
    var most = 0.0;
    for (var layer = 0u; layer < light.layers; layer++) {
        most = max(most, pyramid[level.first + layer].y);
    }
    return most;
}

// The greatest depth of the cells under a box of texels of a layer.
fn most_of_box(layer: u32, low: vec2i, high: vec2i) -> f32 {
    let last = vec2i(i32(light.size) - 1);
    let first = clamp(low, vec2i(0), last);
    let end = clamp(high, vec2i(0), last);
    var level = first_level();
    while level.side > 1u && any(end / level.cell - first / level.cell >= vec2i(4)) { level = next_level(level); }
    var most = 0.0;
    for (var j = first.y / level.cell; j <= end.y / level.cell; j++) {
        for (var i = first.x / level.cell; i <= end.x / level.cell; i++) {
            most = max(most, pyramid[cell_index(level, layer, u32(i), u32(j))].y);
        }
    }
    return most;
}

// Where a receiver stands: positions are texels of its own layer, whose plane is continued beyond the rim.
struct Standing {
    layer: u32,
    at: vec2f,
    depth: f32,
    // Change of the plane's depth per column and row.
    slope: vec2f,
    bias: f32,
    // The penumbra law's K along columns and rows.
    k: vec2f,
    // Whether the map can tell anything: the point lies on it and is not edge-on.
    is_there: bool,
}

fn penumbra_scale(layer: u32, q: vec3f) -> vec2f {
    let forward = light.axis[layer].xyz;
    var right = light.right[layer].xyz;
    var up = light.up[layer].xyz;
    if light.is_central != 0u {
        right -= forward * (dot(q, right) / dot(q, forward));
        up -= forward * (dot(q, up) / dot(q, forward));
    }
    // A disk that faces the receiver is perpendicular to q, and so are both rows now.
    var extent = lamp.radius * vec2f(length(right), length(up));
    if lamp.radius == 0.0 {
        let across = vec2f(dot(lamp.across, right), dot(lamp.across, up));
        let along = vec2f(dot(lamp.along, right), dot(lamp.along, up));
        extent = sqrt(across * across + along * along);
    }
    let k = lamp.per_extent * extent;
    // A lamp that is seen edge-on has a penumbra in one direction alone; one without end covers any map.
    return clamp(k, vec2f(max(k.x, k.y) / 1024.0), vec2f(1e18));
}

fn standing(receiver: Receiver) -> Standing {
    let slope = vec2f(receiver.plane.x, -receiver.plane.y) * (2.0 / light.size);
    let bias = 0.5 * (abs(slope.x) + abs(slope.y)) + rounding(receiver.depth);
    let is_on_map = light.layers > 1u
        || (all(receiver.at >= vec2f(0.0)) && all(receiver.at < vec2f(light.size)));
    let is_sound = !all(receiver.plane == vec3f(0.0)) && abs(slope.x) + abs(slope.y) < 1e9 && receiver.depth < 1e9;
    let is_there = receiver.is_there && is_on_map && is_sound;
    let k = penumbra_scale(receiver.layer, receiver.q);
    return Standing(receiver.layer, receiver.at, receiver.depth, slope, bias, k, is_there);
}

// The share of a disk beyond a chord.
fn disk_below(height: f32, radius: f32) -> f32 {
    if !(height < radius) { return 0.0; }
    let x = height / radius;
    return (acos(x) - x * sqrt(max(1.0 - x * x, 0.0))) / PI;
}

// The share of the square from -1 to 1 where height + a x + b y is below 0.
fn square_below(height: f32, a: f32, b: f32) -> f32 {
    let long = max(a, b);
    let short = min(a, b);
    let depth = long + short - height;
    if !(depth > 0.0) { return 0.0; }
    if depth < 2.0 * short { return depth / long * (depth / short) / 8.0; }
    return (depth - short) / long / 2.0;
}

// The share of the lamp above the plane of the sample's own face: no visible share is greater. A sample that
// is asked faces the middle of the lamp, so that the part below is the smaller one.
fn share_above(receiver: Receiver) -> f32 {
    let normal = receiver.normal;
    var toward = lamp.center;
    if light.is_central != 0u { toward -= receiver.corner; }
    let height = abs(dot(normal, toward));
    if lamp.radius > 0.0 {
        let reach = lamp.radius * length(cross(normal, receiver.q / length(receiver.q)));
        return 1.0 - disk_below(height, reach);
    }
    let a = abs(dot(normal, lamp.across));
    let b = abs(dot(normal, lamp.along));
    if lamp.is_round != 0u { return 1.0 - disk_below(height, length(vec2f(a, b))); }
    return 1.0 - square_below(height, a, b);
}
