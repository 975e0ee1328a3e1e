//! How much of a lamp reaches every sample.

use wgpu::{TextureAspect, TextureFormat};

use crate::gpu::{Gpu, GpuError, Texture, wgpu};
use crate::view::Size;

/// The visibility of one lamp on the device: a texture with one number per sample, 0 dark to 1 lit. Twin of
/// [`Visibility`](crate::shadow::Visibility).
///
/// Techniques fill it, and the picture multiplies it into the light of the lamp. A sample of the sky is 0.
/// The value of a face that turns away from the lamp is up to the technique: whoever shades decides those by
/// the exact sides of faces. Clones share the texture.
///
/// A technique of your own renders into [`GpuVisibility::view`].
#[derive(Clone, Debug)]
pub struct GpuVisibility(pub(crate) Texture);

impl GpuVisibility {
    /// The format of [`GpuVisibility::hard`].
    pub const HARD: TextureFormat = TextureFormat::R8Unorm;
    /// The format of [`GpuVisibility::soft`].
    pub const SOFT: TextureFormat = TextureFormat::R16Float;

    /// A texture for a hard technique, whose values are 0 or 1: 1 byte per sample. All 0 until it is drawn
    /// into.
    ///
    /// # Errors
    ///
    /// [`GpuError::Picture`] if it does not fit the device's limits, [`GpuError::OutOfMemory`],
    /// [`GpuError::Lost`].
    pub fn hard(gpu: &Gpu, size: Size) -> Result<Self, GpuError> {
        Ok(Self(gpu.texture("hard visibility", size, Self::HARD)?))
    }

    /// A texture for a soft technique, in half precision: 2 bytes per sample. All 0 until it is drawn into.
    ///
    /// # Errors
    ///
    /// As [`GpuVisibility::hard`].
    pub fn soft(gpu: &Gpu, size: Size) -> Result<Self, GpuError> {
        Ok(Self(gpu.texture("soft visibility", size, Self::SOFT)?))
    }

    /// A soft texture with one value in every sample, the sky's too.
    ///
    /// # Errors
    ///
    /// As [`GpuVisibility::hard`].
    pub fn constant(gpu: &Gpu, size: Size, value: f32) -> Result<Self, GpuError> {
        let visibility = Self::soft(gpu, size)?;
        let mut attachment = visibility.0.attachment(true);
        attachment.ops.load = wgpu::LoadOp::Clear(wgpu::Color { r: value.into(), ..wgpu::Color::BLACK });
        gpu.submit(|encoder| {
            encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                color_attachments: &[Some(attachment)],
                ..wgpu::RenderPassDescriptor::default()
            });
        })?;
        Ok(visibility)
    }

    /// Samples per row and column.
    #[must_use]
    pub fn size(&self) -> Size {
        self.0.size
    }

    /// The texture, to render into or to read in a shader.
    #[must_use]
    pub fn view(&self) -> &wgpu::TextureView {
        &self.0.view
    }

    /// Reads the values back, row after row from the top. Waits for the work that fills the texture.
    ///
    /// # Errors
    ///
    /// [`GpuError::TooLarge`] if they do not fit one buffer, [`GpuError::OutOfMemory`], [`GpuError::Lost`].
    pub fn download(&self, gpu: &Gpu) -> Result<Vec<f32>, GpuError> {
        let bytes = if self.0.texture.format() == Self::HARD { 1 } else { 2 };
        let back = gpu.staging_for(&self.0, bytes)?;
        gpu.submit(|encoder| self.0.copy(encoder, TextureAspect::All, bytes, &back))?;
        let value = |bytes: &[u8]| match *bytes {
            [unorm] => f32::from(unorm) / 255.0,
            [low, high] => from_half(u16::from_le_bytes([low, high])),
            _ => unreachable!("one or two bytes per sample"),
        };
        gpu.mapped(&back, |mapped| self.0.rows(mapped, bytes as usize, value))
    }
}

/// The value of a number in half precision (IEEE 754-2008 binary16), exactly.
fn from_half(bits: u16) -> f32 {
    let (exponent, fraction) = (u32::from(bits) >> 10 & 0x1f, u32::from(bits) & 0x3ff);
    let magnitude = match exponent {
        0 => fraction as f32 / (1 << 24) as f32, // subnormal: a multiple of 2⁻²⁴
        31 => f32::from_bits(0x7f80_0000 | fraction << 13),
        _ => f32::from_bits((exponent + 127 - 15) << 23 | fraction << 13),
    };
    if bits >> 15 == 1 { -magnitude } else { magnitude }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gpu::tests::gpu;

    #[test]
    fn visibility_halves_have_the_value_that_their_definition_gives() {
        for bits in 0..=u16::MAX {
            let sign = if bits & 0x8000 == 0 { 1.0 } else { -1.0 };
            let (exponent, fraction) = (i32::from(bits >> 10 & 31), f64::from(bits & 1023) / 1024.0);
            let expected = match (exponent, fraction) {
                (31, 0.0) => sign * f64::INFINITY,
                (31, _) => f64::NAN,
                (0, _) => sign * fraction * 2.0_f64.powi(-14),
                _ => sign * (1.0 + fraction) * 2.0_f64.powi(exponent - 15),
            };
            let value = f64::from(from_half(bits));
            assert!(value == expected || value.is_nan() && expected.is_nan(), "{bits:#06x}: {value}");
        }
    }

    #[test]
    fn visibility_comes_back_as_it_was_filled() {
        let Some(gpu) = gpu() else { return };
        // Rows that are padded for the copy.
        let size = Size::new(67, 3).unwrap();
        for value in [0.0, 0.5, 0.75, 1.0] {
            let back = GpuVisibility::constant(&gpu, size, value).unwrap().download(&gpu).unwrap();
            assert_eq!(back, vec![value; size.pixels()]);
        }
        assert_eq!(
            GpuVisibility::hard(&gpu, size).unwrap().download(&gpu).unwrap(),
            vec![0.0; size.pixels()]
        );
    }
}
