// The two clips by fragments, for devices without clip distances.

struct Discarded {
    @builtin(position) clip: vec4f,
    @location(0) sides: vec2f,
}

@vertex
fn caster(@builtin(vertex_index) index: u32) -> Discarded {
    let flat = flattened(index);
    return Discarded(flat.clip, flat.sides);
}

@fragment
fn discard_sides(corner: Discarded) {
    if any(corner.sides <= vec2f(0.0)) { discard; }
}
