//! PNG encoding of pictures.

use std::io::{self, Write};
use std::path::Path;

use super::Picture;
use crate::view::Size;
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

/// An animated PNG under construction: pictures of one size, one after the other, repeated for ever.
///
/// Viewers that know no animation show the first picture. The same pictures give the same bytes.
///
/// ```
/// use umbrage::render::{AnimatedPng, Picture};
/// use umbrage::view::Size;
/// let size = Size::new(2, 1)?;
/// let mut bytes = Vec::new();
/// let mut animated = AnimatedPng::new(&mut bytes, size, 2, 24.0)?;
/// for level in [0, 255] {
///     animated.add(&Picture { size, pixels: vec![[level; 4]; 2] })?;
/// }
/// animated.finish()?;
/// assert!(bytes.starts_with(b"\x89PNG"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct AnimatedPng<W: Write> {
    writer: png::Writer<W>,
    size: Size,
}

impl<W: Write> AnimatedPng<W> {
    /// Writes the header of `frames` pictures, `fps` of which are shown a second.
    ///
    /// # Errors
    ///
    /// The errors of `out`; and if there are no frames.
    pub fn new(out: W, size: Size, frames: u32, fps: f64) -> io::Result<Self> {
        let mut encoder = png::Encoder::new(out, size.width(), size.height());
        encoder.set_color(png::ColorType::Rgba);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
        encoder.set_animated(frames, 0)?;
        let (numerator, denominator) = delay(fps);
        encoder.set_frame_delay(numerator, denominator)?;
        Ok(Self { writer: encoder.write_header()?, size })
    }

    /// Adds the next picture.
    ///
    /// # Errors
    ///
    /// The errors of the output; and if the picture has another size, or is one too many.
    pub fn add(&mut self, picture: &Picture) -> io::Result<()> {
        if picture.size != self.size {
            return Err(io::Error::new(io::ErrorKind::InvalidInput, "the pictures differ in size"));
        }
        self.writer.write_image_data(picture.pixels.as_flattened())?;
        Ok(())
    }

    /// Ends the file.
    ///
    /// # Errors
    ///
    /// The errors of the output; and if pictures are missing.
    pub fn finish(self) -> io::Result<()> {
        self.writer.finish()?;
        Ok(())
    }
}

/// How long a picture is shown, as a fraction of seconds: exact for whole and for hundredths of pictures a
/// second as far as 16 bits go, else the nearest of those.
fn delay(fps: f64) -> (u16, u16) {
    let most = f64::from(u16::MAX);
    for numerator in [1_u16, 100] {
        let denominator = f64::from(numerator) * fps;
        if denominator.fract() == 0.0 && (1.0..=most).contains(&denominator) {
            return (numerator, denominator as u16);
        }
    }
    match 100.0 * fps {
        many if many > most => (1, fps.round().clamp(1.0, most) as u16),
        few if few < 100.0 => ((1000.0 / fps).round().clamp(1.0, most) as u16, 1000),
        between => (100, between.round() as u16),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn animated_png_holds_its_pictures_and_refuses_others() {
        let size = Size::new(3, 2).unwrap();
        let picture = |level: u8| Picture { size, pixels: vec![[level, 7, level, 255]; 6] };
        let mut bytes = Vec::new();
        let mut animated = AnimatedPng::new(&mut bytes, size, 3, 24.0).unwrap();
        for level in [1, 2, 3] {
            animated.add(&picture(level)).unwrap();
        }
        let wide = Size::new(6, 1).unwrap();
        assert!(animated.add(&Picture { size: wide, ..picture(4) }).is_err());
        animated.finish().unwrap();

        let mut reader = png::Decoder::new(io::Cursor::new(&bytes)).read_info().unwrap();
        let control = reader.info().animation_control.unwrap();
        assert_eq!((control.num_frames, control.num_plays), (3, 0));
        for level in [1, 2, 3] {
            let mut pixels = vec![0; 24];
            reader.next_frame(&mut pixels).unwrap();
            assert_eq!(pixels, picture(level).pixels.as_flattened());
            let frame = reader.info().frame_control.unwrap();
            assert_eq!((frame.delay_num, frame.delay_den), (1, 24));
        }
        assert!(AnimatedPng::new(Vec::new(), size, 0, 24.0).is_err());
    }

    #[test]
    fn delay_of_a_picture_is_the_nearest_fraction() {
        for (fps, wanted) in
            [(24.0, (1, 24)), (0.5, (100, 50)), (12.5, (100, 1250)), (1e6, (1, 65535)), (1e-9, (65535, 1000))]
        {
            assert_eq!(delay(fps), wanted, "{fps}");
        }
        assert_eq!(delay(23.976), (100, 2398));
    }
}
