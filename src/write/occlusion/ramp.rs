//! Openness as a texture: a ramp from black to white, and the texture coordinate of each value.
//!
//! An occlusion texture darkens indirect light only. A ramp that every vertex has a point of needs no
//! unwrapping: the value between vertices is the linear one. The trick is Don McCurdy's, of the function `ao`
//! of glTF-Transform, 2019.

use serde_json::json;

use super::WriteError;
use super::document::Document;

/// Texels of the ramp: one a value of eight bits.
const TEXELS: u16 = 256;

/// Where the ramp has this value: texel 0 has its middle half a texel from the edge.
pub(super) fn coordinates(openness: f32) -> [f32; 2] {
    let u = (0.5 + f64::from(TEXELS - 1) * f64::from(openness)) / f64::from(TEXELS);
    [u as f32, 0.5]
}

/// Adds image, sampler and texture, and says which texture it is.
pub(super) fn add(document: &mut Document<'_, '_>) -> Result<usize, WriteError> {
    let texels: Vec<u8> = (0..=u8::MAX).collect();
    let mut png = Vec::new();
    let mut encoder = png::Encoder::new(&mut png, TEXELS.into(), 1);
    encoder.set_color(png::ColorType::Grayscale);
    encoder.set_depth(png::BitDepth::Eight);
    let written = encoder.write_header().and_then(|mut writer| {
        writer.write_image_data(&texels)?;
        writer.finish()
    });
    written.map_err(|error| std::io::Error::other(error))?;
    let view = document.view(&png, None, None);
    let image = document.push("images", json!({"bufferView": view, "mimeType": "image/png"}));
    // Linear filters, and clamped: the ramp does not repeat.
    let sampler = json!({"magFilter": 9729, "minFilter": 9729, "wrapS": 33071, "wrapT": 33071});
    let sampler = document.push("samplers", sampler);
    Ok(document.push("textures", json!({"sampler": sampler, "source": image})))
}

#[cfg(test)]
mod tests {
    use super::coordinates;

    #[test]
    fn ramp_has_each_value_of_eight_bits_at_the_middle_of_a_texel() {
        for texel in 0..=255_u16 {
            let [u, v] = coordinates(f32::from(texel) / 255.0);
            assert!((u * 256.0 - (f32::from(texel) + 0.5)).abs() <= 256.0 * f32::EPSILON && v == 0.5);
        }
        // Without the half texel the ends would be half of the texel beside it.
        assert_eq!([coordinates(0.0)[0], coordinates(1.0)[0]], [0.5 / 256.0, 255.5 / 256.0]);
    }
}
