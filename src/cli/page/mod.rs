//! Pages that need nothing else: one file of HTML with its style, its script, its pictures and its data.
//!
//! Text goes in through `maud`, which escapes it; data through [`data`].

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use maud::{DOCTYPE, Markup, PreEscaped, html};
use serde_json::Value;
use umbrage::render::Picture;

/// The look that all pages share.
const STYLE: &str = include_str!("page.css");

/// A page: `style` is added to the style of all pages, `script` runs at its end.
pub(crate) fn document(title: &str, style: &str, body: &Markup, script: &str) -> String {
    let html = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                title { (title) }
                style { (PreEscaped(STYLE)) (PreEscaped(style)) }
            }
            body {
                (body)
                script { (PreEscaped(script)) }
            }
        }
    };
    html.into_string()
}

/// Data for the script, as the text of an element that it finds by `id`.
///
/// Texts in it come from files: without `<` none can end the element or begin a comment in it.
pub(crate) fn data(id: &str, value: &Value) -> Markup {
    let text = value.to_string().replace('<', "\\u003c");
    html! { script type="application/json" id=(id) { (PreEscaped(text)) } }
}

/// Bytes as base64.
pub(crate) fn base64(bytes: &[u8]) -> String {
    STANDARD.encode(bytes)
}

/// A picture as the address of an `img`: PNG without alpha, compressed as far as it goes.
pub(crate) fn picture_url(picture: &Picture) -> String {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, picture.size.width(), picture.size.height());
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_compression(png::Compression::High);
    let colors: Vec<u8> = picture.pixels.iter().flat_map(|&[r, g, b, _]| [r, g, b]).collect();
    let written = encoder.write_header().and_then(|mut writer| writer.write_image_data(&colors));
    written.expect("a Vec takes everything, and the size is that of the picture");
    format!("data:image/png;base64,{}", base64(&bytes))
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn page_data_cannot_end_its_element_and_is_read_back() {
        for text in ["</script><b>", "<!--", "\"'&", "\\u003c", "]]>"] {
            let html = data("x", &json!({ "name": text })).into_string();
            let inside = html.strip_prefix("<script type=\"application/json\" id=\"x\">").unwrap();
            let inside = inside.strip_suffix("</script>").unwrap();
            assert!(!inside.contains('<'), "{inside}");
            let read: Value = serde_json::from_str(inside).unwrap();
            assert_eq!(read["name"], text);
        }
    }
}
