// The search of single-sample soft shadows. soft.wgsl comes before it. Twins: around.rs, edge_search.rs, with
// the same results bit by bit: lengths are integers, products of the receiver's plane are exact, so that
// fusing one with a sum changes nothing, and quotients are compared by products of 64 bits.

// A receiver as the search takes it.
struct Around {
    own: vec2i,
    // Position within the own texel, in units.
    within: vec2u,
    // Change of the plane's depth per column and row, of 15 binary digits.
    slope: vec2f,
    // Units of half-width per difference of depth, along columns and rows.
    k: vec2f,
    // By how much distances are longer along each axis.
    aspect: vec2f,
    // Depth of the plane at the center of the own texel, and of the receiver.
    plane: f32,
    depth: f32,
    bias: f32,
    layer: u32,
    is_there: u32,
    spare: u32,
}

// The nearest change: the squares of its distance and its penumbra's half-width, in units.
struct Found {
    gap: u32,
    width: u32,
    is_inner: u32,
    spare: u32,
}

@group(0) @binding(12) var<storage, read_write> placed: array<Around>;
@group(0) @binding(13) var<storage, read> receivers: array<Around>;
@group(0) @binding(14) var<storage, read_write> searched: array<Found>;
@group(0) @binding(15) var<storage, read> changes: array<Found>;

// Units per texel.
const UNITS: i32 = 128;
// The farthest that is searched, in units.
const FARTHEST: i32 = 128 * UNITS;
// Farther than the centers of two texels are from the points of them that are nearest to one another.
const CENTERS: i32 = 182;
// A distance whose square is below 2³¹.
const MOST_GAP: f32 = 46340.0;
// A half-width whose square is below 2³².
const MOST_WIDTH: f32 = 65535.0;
// Farther than any map, in units.
const BEYOND: f32 = 4194304.0;

// The nearest number of 15 binary digits.
fn short(x: f32) -> f32 {
    return bitcast<f32>((bitcast<u32>(x) + 256u) & 0xfffffe00u);
}

@compute @workgroup_size(WORKGROUP)
fn place(@builtin(global_invocation_id) global: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let id = linear_id(global, groups);
    let width = u32(frame.width);
    if id >= width * u32(frame.height) { return; }
    let pixel = vec2u(id % width, id / width);
    let seen = textureLoad(faces, pixel, 0).x;
    var found = Around();
    if seen != 0u {
        let here = standing(receiver_of(vec2f(pixel) + 0.5, seen - 1u));
        if here.is_there {
            let own = floor(here.at);
            let widest = max(here.k.x, here.k.y);
            found.own = vec2i(own);
            found.within = min(vec2u((here.at - own) * f32(UNITS)), vec2u(u32(UNITS - 1)));
            found.slope = vec2f(short(here.slope.x), short(here.slope.y));
            found.k = f32(UNITS) * here.k;
            found.aspect = select(vec2f(1.0), vec2f(widest) / here.k, here.k > vec2f(0.0));
            found.plane = here.depth + dot(here.slope, own + 0.5 - here.at);
            found.depth = here.depth;
            found.bias = here.bias;
            found.layer = here.layer;
            found.is_there = 1u;
        }
    }
    placed[id] = found;
}

// The stored depth in terms of a layer; below 0 outside the map.
fn stored(layer: u32, texel: vec2i) -> f32 {
    if is_on_layer(texel) { return textureLoad(map, texel, layer, 0); }
    if light.layers == 1u { return -1.0; }
    // The direction to the texel's center in integers: the rows of a cube are axes.
    let side = i32(light.size);
    let towards = (2 * texel.x + 1 - side) * vec3i(light.right[layer].xyz)
        + (side - 1 - 2 * texel.y) * vec3i(light.up[layer].xyz) + side * vec3i(light.axis[layer].xyz);
    let size = abs(towards);
    var axis = 0u;
    if size.y > size.x { axis = 1u; }
    if size.z > size[axis] { axis = 2u; }
    let other = 2u * axis + select(0u, 1u, towards[axis] < 0);
    let x = dot(towards, vec3i(light.right[other].xyz));
    let y = dot(towards, vec3i(light.up[other].xyz));
    let z = size[axis];
    let found = min(vec2i(z + x, z - y) * side / (2 * z), vec2i(side - 1));
    // Along a ray from the light, depths of two layers have a constant ratio.
    return textureLoad(map, found, other, 0) * f32(z) * lamp.per_size;
}

fn plane_at(here: Around, offset: vec2i) -> f32 {
    return here.plane + here.slope.x * f32(offset.x) + here.slope.y * f32(offset.y);
}

fn width_of(here: Around, above: f32) -> u32 {
    return u32(clamp(max(here.k.x, here.k.y) * above, 64.0, MOST_WIDTH));
}

fn scaled(gap: i32, aspect: f32) -> u32 {
    return u32(min(f32(max(gap, 0)) * aspect, MOST_GAP));
}

// The square of the least distance between the receiver and a square of texels.
fn gap_to(here: Around, offset: vec2i, side: i32) -> u32 {
    let low = offset * UNITS - vec2i(here.within);
    let high = low + side * UNITS;
    let x = scaled(max(low.x, -high.x), here.aspect.x);
    let y = scaled(max(low.y, -high.y), here.aspect.y);
    return x * x + y * y;
}

fn product(a: u32, b: u32) -> vec2u {
    let low = (a & 0xffffu) * (b & 0xffffu);
    let middle = (a >> 16u) * (b & 0xffffu) + (low >> 16u);
    let other = (a & 0xffffu) * (b >> 16u) + (middle & 0xffffu);
    let high = (a >> 16u) * (b >> 16u) + (middle >> 16u) + (other >> 16u);
    return vec2u(high, (other << 16u) | (low & 0xffffu));
}

// The sign of a.x/a.y − b.x/b.y.
fn compared(a: vec2u, b: vec2u) -> i32 {
    let left = product(a.x, b.y);
    let right = product(b.x, a.y);
    if left.x != right.x { return select(1, -1, left.x < right.x); }
    if left.y != right.y { return select(1, -1, left.y < right.y); }
    return 0;
}

// Half-sides of the smallest box that holds all blockers; the greater one.
fn radius_of(here: Around) -> i32 {
    let cube = light.layers > 1u;
    // Of 18 binary digits, so that ratios of it are exact.
    let drawn = bitcast<f32>((bitcast<u32>(most_drawn()) + 63u) & 0xffffffc0u);
    let at = here.own * UNITS + vec2i(here.within);
    let size = i32(light.size);
    var most = select(drawn, MOST_RATIO * drawn, cube);
    var half = vec2i(0);
    for (var round = 0; round < 6; round++) {
        half = vec2i(clamp(ceil(here.k * (most - here.depth)), vec2f(64.0), vec2f(BEYOND)));
        let low = clamp((at - half) >> vec2u(7u), vec2i(-1), vec2i(size));
        let high = clamp((at + half) >> vec2u(7u), vec2i(-1), vec2i(size));
        var found = 0.0;
        if cube && !(is_on_layer(low) && is_on_layer(high)) {
            // Sixteenths of half a side, rounded up.
            let middle = size * (UNITS / 2);
            let farthest = abs(at - middle) + half;
            let ratio = (16 * max(farthest.x, farthest.y) + middle - 1) / middle;
            found = f32(clamp(ratio, 16, 48)) * 0.0625 * drawn;
        } else {
            found = most_of_box(here.layer, low, high);
        }
        if found >= most { break; }
        most = found;
    }
    return min(max(half.x, half.y), FARTHEST);
}

struct Search {
    here: Around,
    is_inner: bool,
    // Half-width of the own blocker's penumbra.
    own_width: u32,
    radius: i32,
    best: vec2u,
}

fn visit(search: ptr<function, Search>, offset: vec2i) {
    let far = (*search).radius + CENTERS;
    if all(offset == vec2i(0)) || UNITS * UNITS * dot(offset, offset) > far * far { return; }
    let here = (*search).here;
    let gap = gap_to(here, offset, 1);
    var width = (*search).own_width;
    if (*search).is_inner && compared(vec2u(gap, width * width), (*search).best) > 0 { return; }
    let depth = stored(here.layer, here.own + offset);
    if depth < 0.0 { return; }
    let plane = plane_at(here, offset);
    if (depth > plane + here.bias) == (*search).is_inner { return; }
    if !(*search).is_inner { width = width_of(here, depth - plane); }
    let found = vec2u(gap, width * width);
    let order = compared(found, (*search).best);
    if order < 0 || (order == 0 && found.y < (*search).best.y) { (*search).best = found; }
}

// The whole tile, if something in it may matter. A tile that lies on no layer as a whole is read.
fn visit_tile(search: ptr<function, Search>, tile: vec2i) {
    let here = (*search).here;
    let level = first_level();
    let low = tile * TILE - here.own;
    if all(tile >= vec2i(0)) && all(tile < vec2i(i32(level.side))) {
        let range = pyramid[cell_index(level, here.layer, u32(tile.x), u32(tile.y))];
        let gap = gap_to(here, low, TILE);
        let ends = low + TILE - 1;
        var width = (*search).own_width;
        if (*search).is_inner {
            let highest = plane_at(here, select(low, ends, here.slope > vec2f(0.0)));
            if range.x > highest + here.bias { return; }
        } else {
            let lowest = plane_at(here, select(ends, low, here.slope > vec2f(0.0)));
            if range.y <= lowest + here.bias { return; }
            width = width_of(here, range.y - lowest);
        }
        if compared(vec2u(gap, width * width), (*search).best) > 0 { return; }
    } else if light.layers == 1u {
        return;
    }
    for (var j = low.y; j < low.y + TILE; j++) {
        for (var i = low.x; i < low.x + TILE; i++) { visit(search, vec2i(i, j)); }
    }
}

@compute @workgroup_size(WORKGROUP)
fn search(@builtin(global_invocation_id) global: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let id = linear_id(global, groups);
    if id >= arrayLength(&receivers) { return; }
    let here = receivers[id];
    // Nothing found is a distance of one half-width.
    if here.is_there == 0u {
        searched[id] = Found(1u, 1u, 0u, 0u);
        return;
    }
    let depth = stored(here.layer, here.own);
    let is_inner = depth > here.plane + here.bias;
    let own_width = width_of(here, depth - here.depth);
    var radius = min(i32(own_width), FARTHEST);
    if !is_inner { radius = radius_of(here); }
    var state = Search(here, is_inner, own_width, radius, vec2u(1u));
    let own = here.own >> vec2u(3u);
    let rings = (radius + CENTERS + TILE * UNITS - 1) / (TILE * UNITS);
    for (var ring = 0; ring <= rings; ring++) {
        for (var row = -ring; row <= ring; row++) {
            let step = select(max(2 * ring, 1), 1, abs(row) == ring);
            for (var column = -ring; column <= ring; column += step) {
                visit_tile(&state, own + vec2i(column, row));
            }
        }
    }
    searched[id] = Found(state.best.x, state.best.y, select(0u, 1u, is_inner), 0u);
}

@fragment
fn single_sample(@builtin(position) position: vec4f) -> @location(0) f32 {
    let pixel = vec2u(position.xy);
    let seen = textureLoad(faces, pixel, 0).x;
    if seen == 0u { return 0.0; }
    let lit = lit_by_change(changes[pixel.y * u32(frame.width) + pixel.x]);
    return min(lit, share_above(receiver_of(position.xy, seen - 1u)));
}

fn lit_by_change(found: Found) -> f32 {
    let distance = min(sqrt(f32(found.gap) / f32(found.width)), 1.0);
    let x = select(distance, -distance, found.is_inner != 0u);
    // Exact for a straight edge.
    if lamp.is_round == 0u { return 0.5 + 0.5 * x; }
    // asin is approximate: at the ends of its range the sum may leave that of a share.
    return clamp(0.5 + (asin(x) + x * sqrt(max(1.0 - x * x, 0.0))) / PI, 0.0, 1.0);
}
