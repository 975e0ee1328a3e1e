//! Conversion of linear light to the sRGB bytes of a picture.

use glam::Vec3;

/// Linear value at which highlight compression starts: darker values are unchanged.
const KNEE: f32 = 0.75;

/// Linear light to sRGB bytes. Values near and above white are compressed smoothly, so that highlights keep
/// some form.
pub(super) fn encode(linear: Vec3) -> [u8; 4] {
    let [r, g, b] = linear.to_array().map(|x| quantize(srgb(shoulder(x))));
    [r, g, b, 255]
}

/// Highlight compression: the identity up to the knee, then a hyperbola of the same slope towards 1.
fn shoulder(x: f32) -> f32 {
    if x <= KNEE {
        return x.max(0.0);
    }
    let beyond = (x - KNEE) / (1.0 - KNEE);
    KNEE + (1.0 - KNEE) * (beyond / (1.0 + beyond))
}

/// The sRGB transfer function (IEC 61966-2-1).
fn srgb(linear: f32) -> f32 {
    if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 }
}

fn quantize(x: f32) -> u8 {
    (x.clamp(0.0, 1.0) * 255.0 + 0.5) as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn encode_knows_black_grey_and_white_and_never_darkens() {
        assert_eq!(encode(Vec3::ZERO), [0, 0, 0, 255]);
        assert_eq!(encode(Vec3::splat(0.215_86)), [128, 128, 128, 255]); // ((128/255 + 0.055) / 1.055)^2.4
        assert_eq!(encode(Vec3::splat(1e9)), [255, 255, 255, 255]);
        assert_eq!(encode(Vec3::splat(-1.0)), [0, 0, 0, 255]);
        let ramp: Vec<u8> = (0..4000).map(|i| encode(Vec3::splat(i as f32 * 1e-3))[0]).collect();
        assert!(ramp.is_sorted() && *ramp.last().unwrap() > 245);
    }
}
