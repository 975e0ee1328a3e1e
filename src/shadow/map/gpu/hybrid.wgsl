// A map where its texels agree, marks elsewhere. map.wgsl comes before it. Twin: neighborhood.rs.

// One bit per sample, by rows.
@group(0) @binding(8) var<storage, read_write> marks: array<atomic<u32>>;
@group(0) @binding(9) var<storage, read> marked: array<u32>;
@group(0) @binding(10) var<storage, read> dark: array<u32>;

fn sample_at(position: vec2f) -> u32 {
    return u32(position.y) * u32(frame.width) + u32(position.x);
}

const OPEN: u32 = 0u;
const BLOCKED: u32 = 1u;
const MIXED: u32 = 2u;

fn seen_by(receiver: Receiver) -> u32 {
    // A plane that contains the direction to the light has no depth.
    if !receiver.is_there || all(receiver.plane == vec3f(0.0)) { return MIXED; }
    let reach = i32(light.reach);
    let own = vec2i(floor(receiver.at));
    // Beside a directional light's map of the scene nothing casts a shadow; a spot's does not show all
    // casters.
    let shows_all = light.is_central == 0u || light.layers > 1u;
    var blocked = 0;
    var open = 0;
    for (var j = -reach; j <= reach; j++) {
        for (var i = -reach; i <= reach; i++) {
            let texel = own + vec2i(i, j);
            if !shows_all && !is_on_layer(texel) { return MIXED; }
            if blocks(receiver, texel) { blocked += 1; } else { open += 1; }
        }
    }
    if open == 0 { return BLOCKED; }
    return select(MIXED, OPEN, blocked == 0);
}

@fragment
fn certain(@builtin(position) position: vec4f) -> @location(0) f32 {
    let seen = textureLoad(faces, vec2u(position.xy), 0).x;
    if seen == 0u { return 0.0; }
    return marked_unless(seen_by(receiver_of(position.xy, seen - 1u)), position.xy);
}

// The value of what is sure; a mark for anything else.
fn marked_unless(found: u32, position: vec2f) -> f32 {
    if found == MIXED {
        let id = sample_at(position);
        atomicOr(&marks[id / 32u], 1u << (id % 32u));
    }
    return select(0.0, 1.0, found == OPEN);
}

// The exact answers, where there is a mark.
@fragment
fn resolve(@builtin(position) position: vec4f) -> @location(0) f32 {
    let id = sample_at(position.xy);
    let bit = 1u << (id % 32u);
    if (marked[id / 32u] & bit) == 0u { discard; }
    return select(1.0, 0.0, (dark[id / 32u] & bit) != 0u);
}
