//! The chart that the benches write.

#[path = "../../benches/stages/chart.rs"]
mod drawn;

use crate::plot::Curve;
use crate::svg::{Axis, escaped, number, significant};
use drawn::svg;

fn curves() -> Vec<Curve> {
    let curve = |name: &str, factor: f64| Curve {
        name: name.to_owned(),
        points: [364.0, 1000.0, 30_000.0, 200_000.0].map(|x| [x, factor * 1e5 / x]).to_vec(),
    };
    vec![curve("one < two", 2.0), curve("two", 1.0), curve("three", 1.01)]
}

/// Whether tags nest and close, and no text holds a bare `<` or `&`.
pub(crate) fn well_formed(text: &str) -> bool {
    let mut open = Vec::new();
    let mut rest = text;
    while let Some(start) = rest.find('<') {
        let Some(end) = rest[start..].find('>') else { return false };
        let tag = &rest[start + 1..start + end];
        let quotes = tag.matches('"').count();
        let name = |tag: &str| tag.split([' ', '/']).next().unwrap_or_default().to_owned();
        let entities = rest[..start].split('&').skip(1);
        let known = |entity: &str| ["amp;", "lt;", "gt;"].iter().any(|name| entity.starts_with(name));
        if tag.contains('<') || !quotes.is_multiple_of(2) || !entities.into_iter().all(known) {
            return false;
        }
        match tag.strip_prefix('/') {
            Some(closed) if open.pop() != Some(closed.to_owned()) => return false,
            Some(_) => {}
            None if tag.ends_with('/') => {}
            None => open.push(name(tag)),
        }
        rest = &rest[start + end + 1..];
    }
    open.is_empty() && rest.trim().is_empty()
}

#[test]
fn chart_is_well_formed_and_small_and_holds_every_point() {
    let (curves, text) = (curves(), svg("a <card> & driver", &curves()));
    assert!(well_formed(&text), "{text}");
    assert!(!well_formed(&text.replacen("</g>", "", 1)) && !well_formed(&text.replacen("&amp;", "&", 1)));
    assert!(text.len() < 10_000, "{} bytes", text.len());
    assert_eq!(text.matches("<title>").count(), 12);
    for point in
        ["364: 549 frames/s", "1,000: 100 frames/s", "30,000: 6.67 frames/s", "200,000: 0.505 frames/s"]
    {
        assert!(text.contains(&format!("<title>{point}</title>")), "{point}");
    }
    assert!(text.contains(">one &lt; two</text>") && text.contains("a &lt;card&gt; &amp; driver"));
    assert_eq!(text, svg("a <card> & driver", &curves));
    // Nothing lies outside of the picture, and three names fit where curves end side by side.
    let heights: Vec<f64> = text
        .lines()
        .filter(|line| line.ends_with("</text></g>"))
        .map(|line| line.split(" y=\"").nth(1).and_then(|y| y.split('"').next()?.parse().ok()).unwrap())
        .collect();
    assert_eq!(heights.len(), 3);
    assert!(heights.windows(2).all(|pair| pair[1] - pair[0] >= 18.9) && heights.iter().all(|&y| y < 430.0));
}

#[test]
fn chart_of_a_single_point_is_one() {
    let point = Curve { name: "one".to_owned(), points: vec![[1000.0, 1.0]] };
    let text = svg("", &[point]);
    assert!(well_formed(&text) && !text.contains("NaN") && !text.contains("inf"), "{text}");
}

#[test]
fn chart_axis_ends_just_around_its_values() {
    let of = |values: &[f64]| Axis::around(values.iter().copied(), [0.0, 100.0]);
    assert_eq!(of(&[0.3, 40.0]).ticks, [0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0]);
    assert_eq!(of(&[10.0]).ticks, [10.0, 20.0]);
    assert_eq!(of(&[3e-7, 0.5]).ticks, [1e-7, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 1e-1, 1.0]);
    let axis = of(&[1.0, 100.0]);
    assert_eq!([1.0, 10.0, 100.0].map(|x| axis.place(x).round()), [0.0, 50.0, 100.0]);
    for odd in [&[][..], &[0.0], &[1e-308, 1e308]] {
        let axis = of(odd);
        assert!(axis.ticks.len() > 1 && axis.ticks.iter().all(|tick| tick.is_finite()), "{odd:?}");
    }
}

#[test]
fn chart_numbers_are_short() {
    assert_eq!([0.5, 999.0, 1e3, 1234567.0].map(number), ["0.5", "999", "1,000", "1,234,567"]);
    assert_eq!([0.01234, 1.0, 12.34, 1234.5].map(significant), ["0.0123", "1.00", "12.3", "1234"]);
}

#[test]
fn chart_text_holds_no_markup_and_no_control_characters() {
    assert_eq!(escaped("a<b> & \u{1b}c"), "a&lt;b&gt; &amp; \u{fffd}c");
}
