//! Filters: what decoded attributes stand for, element by element, in place.
//!
//! Source: *EXT_meshopt_compression*, appendix B.

/// Applies a filter to decoded elements of `stride` bytes, which it allows.
pub(super) fn apply(filter: &str, bytes: &mut [u8], stride: usize) {
    match (filter, stride) {
        ("OCTAHEDRAL", 4) => bytes.as_chunks_mut().0.iter_mut().for_each(octahedral8),
        ("OCTAHEDRAL", _) => bytes.as_chunks_mut().0.iter_mut().for_each(octahedral16),
        ("QUATERNION", _) => bytes.as_chunks_mut().0.iter_mut().for_each(quaternion),
        ("EXPONENTIAL", _) => bytes.as_chunks_mut().0.iter_mut().for_each(exponential),
        _ => {}
    }
}

fn octahedral8(element: &mut [u8; 4]) {
    let [x, y, one, _] = element.map(|byte| f32::from(byte as i8));
    let unit = octahedral(x / one, y / one);
    for (to, from) in element.iter_mut().zip(unit) {
        *to = (from * 127.0).round() as i8 as u8;
    }
}

fn octahedral16(element: &mut [u8; 8]) {
    let [x, y, one, _] = shorts(element).map(f32::from);
    let unit = octahedral(x / one, y / one);
    for (to, from) in element.as_chunks_mut().0.iter_mut().zip(unit) {
        *to = ((from * 32767.0).round() as i16).to_le_bytes();
    }
}

/// The unit vector of a point on the unfolded octahedron: the lower half is the corners of the square, folded
/// outwards.
fn octahedral(x: f32, y: f32) -> [f32; 3] {
    let z = 1.0 - x.abs() - y.abs();
    let fold = z.min(0.0);
    let (x, y) = (x - fold.copysign(x), y - fold.copysign(y));
    let length = (x * x + y * y + z * z).sqrt();
    [x / length, y / length, z / length]
}

/// Three components and where the fourth, the largest, was left out: it is what makes the length 1.
fn quaternion(element: &mut [u8; 8]) {
    let [x, y, z, scale] = shorts(element);
    let largest = usize::from(scale as u16 & 3);
    let one = f32::from(scale | 3);
    let [x, y, z] = [x, y, z].map(|c| f32::from(c) / one * std::f32::consts::FRAC_1_SQRT_2);
    let w = (1.0 - x * x - y * y - z * z).max(0.0).sqrt();
    for (step, component) in [w, x, y, z].into_iter().enumerate() {
        let at = (largest + step) % 4;
        element[2 * at..][..2].copy_from_slice(&((component * 32767.0).round() as i16).to_le_bytes());
    }
}

/// A mantissa of 24 bits and an exponent of eight, both signed.
fn exponential(element: &mut [u8; 4]) {
    let bits = i32::from_le_bytes(*element);
    // From −128 to 127: a power of two by the bits of its exponent, whose bias is 1023.
    let power = f64::from_bits(((bits >> 24) + 1023) as u64 * (1 << 52));
    // Exact in f64, and so in f32 unless it is out of its range.
    let value = f64::from(bits << 8 >> 8) * power;
    *element = (value as f32).to_le_bytes();
}

fn shorts(element: &[u8; 8]) -> [i16; 4] {
    std::array::from_fn(|at| i16::from_le_bytes([element[2 * at], element[2 * at + 1]]))
}
