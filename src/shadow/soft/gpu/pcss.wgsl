// Percentage-closer soft shadows. soft.wgsl comes before it. Twins: pcss.rs, window.rs.

// Points that fill the unit square evenly.
@group(0) @binding(12) var<storage, read> points: array<vec2f>;

const MOST_STRIPS: i32 = 128;

// Columns, or rows, that there are: from, and up to but without.
fn limits() -> vec2i {
    let side = i32(light.size);
    return select(vec2i(0, side), vec2i(-side, 2 * side), light.layers > 1u);
}

// The stored depth in terms of a layer; below 0 outside the map.
fn stored(layer: u32, texel: vec2i) -> f32 {
    if is_on_layer(texel) { return textureLoad(map, texel, layer, 0); }
    if light.layers == 1u { return -1.0; }
    let at = from_texels(vec2f(texel) + 0.5);
    let towards = light.axis[layer].xyz
        + light.half * (at.x * light.right[layer].xyz + at.y * light.up[layer].xyz);
    let other = layer_of(towards);
    let there = on_layer(other, towards);
    let found = clamp(vec2i(floor(to_texels(there.xy / there.w))), vec2i(0), vec2i(i32(light.size) - 1));
    // Along a ray from the light, depths of two layers have a constant ratio.
    return textureLoad(map, found, other, 0) * there.w;
}

// The depth of a texel that lies before the receiver's plane; below 0 for any other.
fn blocker(here: Standing, texel: vec2i) -> f32 {
    let depth = stored(here.layer, texel);
    let plane = here.depth + dot(here.slope, vec2f(texel) + 0.5 - here.at);
    return select(-1.0, depth, depth >= 0.0 && depth > plane + here.bias);
}

// Half-sides of the smallest box that holds all blockers.
fn search_box(here: Standing) -> vec2f {
    let cube = light.layers > 1u;
    let drawn = most_drawn();
    var most = select(drawn, MOST_RATIO * drawn, cube);
    var half = vec2f(0.5);
    for (var round = 0; round < 6; round++) {
        half = max(here.k * (most - here.depth), vec2f(0.5));
        let low = vec2i(clamp(floor(here.at - half), vec2f(-1.0), vec2f(light.size)));
        let high = vec2i(clamp(floor(here.at + half), vec2f(-1.0), vec2f(light.size)));
        var found = 0.0;
        if cube && !(is_on_layer(low) && is_on_layer(high)) {
            let middle = 0.5 * light.size;
            let farthest = (abs(here.at - middle) + half) / middle;
            found = clamp(max(farthest.x, farthest.y), 1.0, MOST_RATIO) * drawn;
        } else {
            found = most_of_box(here.layer, low, high);
        }
        if found >= most { break; }
        most = found;
    }
    return half;
}

struct Blockers {
    // Their part of the window.
    share: f32,
    // Their depths, each times its part.
    depth: f32,
    // Whether nothing in the window is open.
    is_whole: bool,
}

fn add(found: ptr<function, Blockers>, weight: f32, depth: f32) {
    if depth >= 0.0 {
        (*found).share += weight;
        (*found).depth += weight * depth;
    } else {
        (*found).is_whole = false;
    }
}

fn gather(here: Standing, half: vec2f, taps: u32) -> Blockers {
    if taps == 0u { return gather_all(here, half); }
    var found = Blockers(0.0, 0.0, true);
    let shift = shift_at(here.at);
    let low = limits().x;
    let high = limits().y;
    for (var index = 0u; index < taps; index++) {
        var point = 2.0 * fract(points[index] + shift) - 1.0;
        if lamp.is_round != 0u { point = concentric(point); }
        let texel = vec2i(floor(here.at + half * point));
        var depth = -1.0;
        if all(texel >= vec2i(low)) && all(texel < vec2i(high)) { depth = blocker(here, texel); }
        add(&found, 1.0 / f32(taps), depth);
    }
    return found;
}

fn concentric(at: vec2f) -> vec2f {
    if abs(at.x) > abs(at.y) {
        let angle = 0.25 * PI * (at.y / at.x);
        return at.x * vec2f(cos(angle), sin(angle));
    }
    if at.y == 0.0 { return vec2f(0.0); }
    let angle = 0.5 * PI - 0.25 * PI * (at.x / at.y);
    return at.y * vec2f(cos(angle), sin(angle));
}

fn mul_high(a: u32, b: u32) -> u32 {
    let low = (a & 0xffffu) * (b & 0xffffu);
    let middle = (a >> 16u) * (b & 0xffffu) + (low >> 16u);
    let other = (a & 0xffffu) * (b >> 16u) + (middle & 0xffffu);
    return (a >> 16u) * (b >> 16u) + (middle >> 16u) + (other >> 16u);
}

// The fraction of a number of 64 bits behind the point times an integer, in units of 2⁻³².
fn fraction(high: u32, low: u32, by: u32) -> u32 {
    return high * by + mul_high(low, by);
}

// Interleaved gradient noise, with integers: 0.06711056·x + 0.00583715·y, and 52.9829189 times its fraction.
fn noise(x: u32, y: u32) -> f32 {
    let sum = fraction(0x112e285cu, 0x6a8f1506u, x) + fraction(0x017e8b20u, 0x5a129b0du, y);
    let product = 52u * sum + mul_high(sum, 0xfba092b2u);
    return f32(product >> 8u) / 16777216.0;
}

fn shift_at(at: vec2f) -> vec2f {
    let part = vec2u(floor(8.0 * at));
    return vec2f(noise(part.x, part.y), noise(part.y, part.x));
}

// Number of strips of a side: its texels, or as many equal ones as there are at most.
fn strips(low: f32, high: f32) -> i32 {
    if !(low < high) { return 0; }
    return i32(min(ceil(high) - floor(low), f32(MOST_STRIPS)));
}

// The texel of a strip, and its ends.
fn strip(low: f32, high: f32, index: i32) -> vec3f {
    if ceil(high) - floor(low) <= f32(MOST_STRIPS) {
        let texel = floor(low) + f32(index);
        return vec3f(texel, max(low, texel), min(high, texel + 1.0));
    }
    let step = (high - low) / f32(MOST_STRIPS);
    let first = low + f32(index) * step;
    return vec3f(floor(first + 0.5 * step), first, first + step);
}

fn left_of(t: f32) -> f32 {
    return 0.5 * (t * sqrt(max(1.0 - t * t, 0.0)) + asin(t));
}

// Mean half-width of the unit shape between two heights.
fn mean_chord(top: f32, bottom: f32) -> f32 {
    if lamp.is_round == 0u { return 1.0; }
    let low = clamp(top, -1.0, 1.0);
    let high = clamp(bottom, -1.0, 1.0);
    if !(high > low) { return 0.0; }
    return (left_of(high) - left_of(low)) / (high - low);
}

fn gather_all(here: Standing, half: vec2f) -> Blockers {
    var found = Blockers(0.0, 0.0, true);
    let low = f32(limits().x);
    let high = f32(limits().y);
    let area = 4.0 * select(1.0, 0.25 * PI, lamp.is_round != 0u) * half.x * half.y;
    let upper = max(here.at.y - half.y, low);
    let lower = min(here.at.y + half.y, high);
    for (var j = 0; j < strips(upper, lower); j++) {
        let row = strip(upper, lower, j);
        let width = half.x * mean_chord((row.y - here.at.y) / half.y, (row.z - here.at.y) / half.y);
        let left = max(here.at.x - width, low);
        let right = min(here.at.x + width, high);
        for (var i = 0; i < strips(left, right); i++) {
            let column = strip(left, right, i);
            let part = (column.z - column.y) * (row.z - row.y);
            add(&found, part / area, blocker(here, vec2i(vec2f(column.x, row.x))));
        }
    }
    if any(here.at - half < vec2f(low)) || any(here.at + half > vec2f(high)) { found.is_whole = false; }
    return found;
}

fn lit_by_map(here: Standing) -> f32 {
    if !here.is_there { return 1.0; }
    let blockers = gather(here, search_box(here), lamp.blockers);
    if !(blockers.share > 0.0) { return 1.0; }
    let half = max(here.k * (blockers.depth / blockers.share - here.depth), vec2f(0.5));
    let found = gather(here, half, lamp.taps);
    return select(clamp(1.0 - found.share, 0.0, 1.0), 0.0, found.is_whole);
}

@fragment
fn soft_visibility(@builtin(position) position: vec4f) -> @location(0) f32 {
    let seen = textureLoad(faces, vec2u(position.xy), 0).x;
    if seen == 0u { return 0.0; }
    let receiver = receiver_of(position.xy, seen - 1u);
    return min(lit_by_map(standing(receiver)), share_above(receiver));
}
