//! What a picture shows, in words below it: a title, the numbers that matter, and what each color means.

use std::convert::Infallible;

use embedded_graphics::Drawable;
use embedded_graphics::Pixel;
use embedded_graphics::draw_target::DrawTarget;
use embedded_graphics::geometry::{Dimensions, Point, Size as Area};
use embedded_graphics::mono_font::iso_8859_1::{FONT_6X10, FONT_9X15};
use embedded_graphics::mono_font::{MonoFont, MonoTextStyle};
use embedded_graphics::pixelcolor::{Rgb888, RgbColor};
use embedded_graphics::primitives::Rectangle;
use embedded_graphics::text::{Baseline, Text};
use umbrage::render::Picture;
use umbrage::view::Size;

/// A color, and what it means.
pub(crate) type Key = ([u8; 3], String);

const PAPER: [u8; 3] = [250, 250, 248];
const INK: [u8; 3] = [38, 40, 44];
const RIM: [u8; 3] = [120, 122, 126];

/// Pixels around the text, and between lines.
const MARGIN: u32 = 8;
const LEADING: u32 = 5;
/// Pictures at least this wide have the larger font.
const WIDE: u32 = 480;
/// Below this width no word fits: such a picture has no caption.
const NARROW: u32 = 96;

/// The picture with a strip below it: lines of text, wrapped, and then the keys, side by side while they fit.
/// The picture itself stays as it is. One that is too small or too large for a strip is returned alone.
pub(crate) fn captioned(mut picture: Picture, lines: &[&str], keys: &[Key]) -> Picture {
    let width = picture.size.width();
    if width < NARROW {
        return picture;
    }
    let font = font(width);
    let layout = Layout::of(width, font, lines, keys);
    let Ok(size) = Size::new(width, picture.size.height() + layout.height) else { return picture };
    let pixels = (layout.height * width) as usize;
    if picture.pixels.try_reserve_exact(pixels).is_err() {
        return picture;
    }
    let mut strip = Strip { width, pixels: vec![[PAPER[0], PAPER[1], PAPER[2], 255]; pixels] };
    for (at, text) in &layout.texts {
        let style = MonoTextStyle::new(font, rgb(INK));
        let Ok(_) = Text::with_baseline(text, *at, style, Baseline::Top).draw(&mut strip);
    }
    for &(at, color) in &layout.swatches {
        let side = font.character_size.height - 2;
        strip.square(at, side, RIM);
        strip.square(at + Point::new(1, 1), side - 2, color);
    }
    picture.pixels.extend(strip.pixels);
    Picture { size, pixels: picture.pixels }
}

/// The height of the strip below a picture of such a width.
pub(crate) fn height(width: u32, lines: &[&str], keys: &[Key]) -> u32 {
    if width < NARROW { 0 } else { Layout::of(width, font(width), lines, keys).height }
}

fn font(width: u32) -> &'static MonoFont<'static> {
    if width >= WIDE { &FONT_9X15 } else { &FONT_6X10 }
}

fn rgb([r, g, b]: [u8; 3]) -> Rgb888 {
    Rgb888::new(r, g, b)
}

/// Where everything in the strip is.
struct Layout {
    height: u32,
    texts: Vec<(Point, String)>,
    swatches: Vec<(Point, [u8; 3])>,
}

impl Layout {
    fn of(width: u32, font: &MonoFont<'_>, lines: &[&str], keys: &[Key]) -> Self {
        let (step, line) = (font.character_size.width, font.character_size.height + LEADING);
        let columns = ((width - 2 * MARGIN) / step) as usize;
        let mut layout = Self { height: MARGIN, texts: Vec::new(), swatches: Vec::new() };
        for text in lines.iter().flat_map(|text| wrap(&drawable(text), columns)) {
            layout.texts.push((Point::new(MARGIN as i32, layout.height as i32), text));
            layout.height += line;
        }
        // A swatch takes two columns, and two more part one key from the next.
        let mut column = 0;
        for (color, text) in keys {
            let text = drawable(text);
            let taken = 2 + text.chars().count().min(columns.saturating_sub(2));
            if column > 0 && column + taken > columns {
                (column, layout.height) = (0, layout.height + line);
            }
            let at = |column: usize| Point::new((MARGIN + column as u32 * step) as i32, layout.height as i32);
            layout.swatches.push((at(column) + Point::new(0, 1), *color));
            layout.texts.push((at(column + 2), text.chars().take(taken - 2).collect()));
            column += taken + 2;
        }
        layout.height += if column > 0 { line } else { 0 } + MARGIN - LEADING;
        layout
    }
}

/// The text in characters that the font has.
fn drawable(text: &str) -> String {
    let mut plain = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '–' | '—' | '−' => plain.push('-'),
            '≤' => plain.push_str("<="),
            '≥' => plain.push_str(">="),
            c if c.is_control() || u32::from(c) > 0xff => plain.push('?'),
            c => plain.push(c),
        }
    }
    plain
}

/// The words of a text in lines of at most `columns` characters; a longer word is cut.
fn wrap(text: &str, columns: usize) -> Vec<String> {
    let mut lines = vec![String::new()];
    for word in text.split_whitespace() {
        let mut word: Vec<char> = word.chars().collect();
        loop {
            let line = lines.last_mut().expect("there is one");
            let room = columns.saturating_sub(line.chars().count() + usize::from(!line.is_empty()));
            if word.len() <= room || line.is_empty() {
                let rest = word.split_off(word.len().min(columns.max(1)));
                if !line.is_empty() {
                    line.push(' ');
                }
                line.extend(&word);
                if rest.is_empty() {
                    break;
                }
                word = rest;
            }
            lines.push(String::new());
        }
    }
    lines.retain(|line| !line.is_empty());
    lines
}

/// The pixels of a strip.
struct Strip {
    width: u32,
    pixels: Vec<[u8; 4]>,
}

impl Strip {
    fn square(&mut self, at: Point, side: u32, color: [u8; 3]) {
        let Ok(()) = self.fill_solid(&Rectangle::new(at, Area::new(side, side)), rgb(color));
    }
}

impl Dimensions for Strip {
    fn bounding_box(&self) -> Rectangle {
        let height = self.pixels.len() as u32 / self.width.max(1);
        Rectangle::new(Point::zero(), Area::new(self.width, height))
    }
}

impl DrawTarget for Strip {
    type Color = Rgb888;
    type Error = Infallible;

    fn draw_iter<I: IntoIterator<Item = Pixel<Rgb888>>>(&mut self, pixels: I) -> Result<(), Infallible> {
        let within = self.bounding_box();
        for Pixel(at, color) in pixels {
            if within.contains(at) {
                let place = (at.y as u32 * self.width + at.x as u32) as usize;
                self.pixels[place] = [color.r(), color.g(), color.b(), 255];
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn picture(width: u32, height: u32) -> Picture {
        let pixels = (0..width * height).map(|i| [i as u8, (i / 7) as u8, 9, 255]).collect();
        Picture { size: Size::new(width, height).unwrap(), pixels }
    }

    fn keys() -> Vec<Key> {
        ["boundary loop", "non-manifold edge", "self intersection, dimmed where hidden"]
            .into_iter()
            .zip([[230, 25, 25], [225, 20, 225], [250, 120, 150]])
            .map(|(name, color)| (color, name.to_owned()))
            .collect()
    }

    #[test]
    fn captioned_pictures_keep_their_pixels_and_show_every_color_once_or_more() {
        for (width, height) in [(96, 1), (97, 30), (320, 200), (960, 540)] {
            let plain = picture(width, height);
            let lines = ["A title that is as long as it has to be to wrap", "12 of 345,678 edges"];
            let with = captioned(plain.clone(), &lines, &keys());
            assert_eq!(with.size.width(), width);
            assert_eq!(with.pixels.len(), (width * with.size.height()) as usize);
            assert_eq!(with.size.height() - plain.size.height(), super::height(width, &lines, &keys()));
            let (top, strip) = with.pixels.split_at(plain.pixels.len());
            assert_eq!(top, plain.pixels);
            let count = |color: [u8; 3]| strip.iter().filter(|pixel| pixel[..3] == color).count();
            for (color, _) in keys() {
                assert!(count(color) >= 6 * 6, "{width}");
            }
            assert!(count(INK) > 300 && count(PAPER) > count(INK), "{width}");
            // Fault injected: a key that is left out is missed.
            let fewer = captioned(plain.clone(), &lines, &keys()[1..]);
            assert!(!fewer.pixels[plain.pixels.len()..].iter().any(|pixel| pixel[..3] == keys()[0].0));
        }
    }

    #[test]
    fn captions_of_tiny_and_of_huge_pictures_are_left_out() {
        for (width, height) in [(1, 1), (16, 16), (95, 400), (100, Size::MOST)] {
            let plain = picture(width, height);
            assert_eq!(captioned(plain.clone(), &["title"], &keys()), plain);
        }
    }

    #[test]
    fn wrapped_text_keeps_its_words_and_no_line_is_too_long() {
        let text = "verdicts of 100,000 pixels  where both methods agree, supercalifragilistic\tend";
        for columns in [1, 2, 7, 13, 40, 200] {
            let lines = wrap(text, columns);
            assert!(lines.iter().all(|line| (1..=columns).contains(&line.chars().count())), "{columns}");
            let joined = |text: &str| text.chars().filter(|c| !c.is_whitespace()).collect::<String>();
            assert_eq!(joined(&lines.concat()), joined(text));
        }
        assert_eq!(wrap("one two three", 7), ["one two", "three"]);
        assert!(wrap("  ", 7).is_empty());
    }

    #[test]
    fn captions_stay_within_their_strip() {
        for width in [96, 200, 479, 480, 2000] {
            for font in [&FONT_6X10, &FONT_9X15] {
                let layout = Layout::of(width, font, &["α → β, 3 ≤ x; naïve Möbius"], &keys());
                for (at, text) in &layout.texts {
                    let right = at.x as u32 + text.chars().count() as u32 * font.character_size.width;
                    assert!(right <= width - MARGIN && !text.contains('α'), "{text}");
                    assert!(at.y as u32 + font.character_size.height < layout.height);
                }
            }
        }
        assert_eq!(drawable("α–≤é\n"), "?-<=é?");
    }
}
