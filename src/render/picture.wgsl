// The lit picture: one invocation per sample of a triangle that covers everything, after the visible faces
// and their depth are drawn. raster.wgsl comes before it. Twin: shade.rs; gpu.rs has the structs.
//
// Points are relative to the eye and scaled as in Frame.

struct Scene {
    up: vec3f,
    // The first face of the ground; beyond all faces where there is none.
    first_ground: u32,
    ground_center: vec3f,
    // Diagonals of the mesh per unit of length.
    diagonals: f32,
    // Samples along each side of a pixel of the finished picture.
    samples: u32,
}

struct Lamp {
    // The direction from a point to the lamp is towards − point·approach, of any length.
    towards: vec3f,
    approach: f32,
    color: vec3f,
    // The cosine of the angle where a spot light ends, and the inverse of its difference to that of full
    // light.
    outer: f32,
    spot: vec3f,
    slope: f32,
    // Physical falloff: 1 over the distance at which the color holds, 0 for plain falloff, and 1 over the
    // distance at which the light ends, 0 for none; both in lengths of the direction from a place to the
    // lamp.
    per_full: f32,
    per_range: f32,
}

// The visible face and 1; 0 where there is none.
@group(0) @binding(5) var faces: texture_2d<u32>;
@group(0) @binding(6) var<uniform> scene: Scene;
// The side of each face that the eye is on, 1 or −1; for a lamp 0 unless it is on the same side.
@group(0) @binding(7) var<storage, read> sides: array<i32>;
@group(0) @binding(8) var<storage, read> paint: array<f32>;
@group(0) @binding(9) var<uniform> lamp: Lamp;
// How much of the lamp reaches each sample: 0 dark to 1 lit.
@group(0) @binding(10) var visibility: texture_2d<f32>;
@group(0) @binding(11) var light: texture_2d<f32>;

struct Seen {
    // Along the ray, at depth 1.
    direction: vec3f,
    point: vec3f,
    // Towards the side that `sides` says.
    normal: vec3f,
    base: vec3f,
    // How much of the background shows through.
    fade: f32,
}

fn look(position: vec2f, face: u32) -> Seen {
    let ndc = normalized(position);
    let direction = frame.ray_right * ndc.x + frame.ray_up * ndc.y + frame.ray_forward;
    let point = direction * (frame.near / textureLoad(receiver_depth, vec2u(position), 0));
    var fade = 0.0;
    if face >= scene.first_ground {
        fade = smoothstep(FADE_BEGINS, FADE_ENDS, distance(point, scene.ground_center) * scene.diagonals);
    }
    let first = 3u * face;
    let front = face_normal(face);
    let base = vec3f(paint[first], paint[first + 1u], paint[first + 2u]);
    return Seen(direction, point, select(front, -front, sides[face] < 0), base, fade);
}

fn background(y: f32) -> vec3f {
    return mix(BELOW, ABOVE, 1.0 - y / frame.height);
}

// The unit vector of the same direction; 0 of 0.
fn unit(v: vec3f) -> vec3f {
    let most = max(abs(v.x), max(abs(v.y), abs(v.z)));
    if most == 0.0 { return v; }
    return normalize(v / most);
}

// The factor that falloff has, `to_lamp` away from the lamp. Lengths are cut where the result is known, so
// that no power leaves the range.
fn falloff(to_lamp: vec3f) -> f32 {
    if lamp.per_full == 0.0 { return 1.0; }
    let most = max(abs(to_lamp.x), max(abs(to_lamp.y), abs(to_lamp.z)));
    if most == 0.0 { return MOST_FALLOFF; }
    let distance = most * length(to_lamp / most);
    let part = min(distance * lamp.per_range, 2.0);
    let window = clamp(1.0 - part * part * part * part, 0.0, 1.0);
    let full = min(distance * lamp.per_full, 1e18);
    return window / max(full * full, window / MOST_FALLOFF);
}

// The light that needs no lamp.
@fragment
fn ambient(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let sky = background(position.y);
    let id = textureLoad(faces, vec2u(position.xy), 0).r;
    if id == 0u { return vec4f(sky, 1.0); }
    let seen = look(position.xy, id - 1u);
    let light = seen.base * (AMBIENT + AMBIENT_SLOPE * dot(scene.up, seen.normal));
    return vec4f(mix(light, sky, seen.fade), 1.0);
}

fn lit(position: vec2f) -> vec4f {
    let id = textureLoad(faces, vec2u(position), 0).r;
    if id == 0u { return vec4f(0.0); }
    // A face that turns away from the lamp shadows itself.
    if sides[id - 1u] == 0 { return vec4f(0.0); }
    let seen = look(position, id - 1u);
    let to_lamp = lamp.towards - seen.point * lamp.approach;
    let to_light = unit(to_lamp);
    let cone = clamp((dot(-lamp.spot, to_light) - lamp.outer) * lamp.slope, 0.0, 1.0);
    let half_way = unit(to_light - unit(seen.direction));
    var highlight = max(dot(seen.normal, half_way), 0.0);
    for (var i = 0u; i < SPECULAR_SQUARINGS; i++) { highlight *= highlight; }
    let diffuse = max(dot(seen.normal, to_light), 0.0);
    let light = lamp.color * (cone * cone * falloff(to_lamp)) * (seen.base * diffuse + SPECULAR * highlight);
    return vec4f(light * (1.0 - seen.fade), 0.0);
}

// The light of a lamp that reaches a sample. The shading of a dark sample does not count, even if it is
// infinite.
@fragment
fn add_lamp(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let part = textureLoad(visibility, vec2u(position.xy), 0).r;
    if part == 0.0 { return vec4f(0.0); }
    return lit(position.xy) * part;
}

// The mean of a pixel's samples. Each is cut at white first, lest one highlight outweigh its neighbors,
// unless all are brighter.
@fragment
fn resolve(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let n = scene.samples;
    let first = vec2u(position.xy) * n;
    var sum = vec3f(0.0);
    var cut = vec3f(0.0);
    var least = vec3f(1.0);
    for (var y = 0u; y < n; y++) {
        for (var x = 0u; x < n; x++) {
            let sample = textureLoad(light, first + vec2u(x, y), 0).rgb;
            sum += sample;
            cut += min(sample, vec3f(1.0));
            least = min(least, sample);
        }
    }
    return vec4f(select(cut, sum, least >= vec3f(1.0)) / f32(n * n), 1.0);
}
