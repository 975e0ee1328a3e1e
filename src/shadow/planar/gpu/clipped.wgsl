// The two clips by the device.

struct Clipped {
    @builtin(position) clip: vec4f,
    @builtin(clip_distances) sides: array<f32, 2>,
}

@vertex
fn caster(@builtin(vertex_index) index: u32) -> Clipped {
    let flat = flattened(index);
    return Clipped(flat.clip, array(flat.sides.x, flat.sides.y));
}
