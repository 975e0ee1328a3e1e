//! PNG encoding of pictures.

use std::io::{self, Write};
use std::path::Path;

use super::Picture;
use crate::write::{WriteError, write_atomic};

impl Picture {
    /// Writes a PNG file, 8 bits of red, green, blue and alpha, marked as sRGB. The file is written
    /// atomically. The same picture gives the same bytes.
    ///
    /// # Errors
    ///
    /// [`WriteError`] if the file cannot be written.
    pub fn write_png(&self, path: impl AsRef<Path>) -> Result<(), WriteError> {
        write_atomic(path, |out| self.encode_png(out))
    }

    /// Encodes the bytes of a PNG file.
    ///
    /// # Errors
    ///
    /// The errors of `out`.
    pub fn encode_png(&self, out: impl Write) -> io::Result<()> {
        let mut encoder = png::Encoder::new(out, self.size.width(), self.size.height());
        encoder.set_color(png::ColorType::Rgba);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
        let mut writer = encoder.write_header()?;
        writer.write_image_data(self.pixels.as_flattened())?;
        writer.finish()?;
        Ok(())
    }
}
