//! Line charts with logarithmic axes.

use crate::svg::{Axis, COLOR_COUNT, Mark, Svg, escaped, number, significant};

/// A line of a chart.
#[derive(Clone, Debug)]
pub(crate) struct Curve {
    pub(crate) name: String,
    /// Points of the curve. Both coordinates are above 0, the first ascending.
    pub(crate) points: Vec<[f64; 2]>,
}

/// A panel of curves between two axes, with the names of the curves at the right.
pub(crate) struct Panel<'a> {
    pub(crate) curves: &'a [Curve],
    /// Positions of the axes: left, right, top, bottom.
    pub(crate) frame: [f64; 4],
    /// Titles of the horizontal and of the vertical axis.
    pub(crate) titles: [&'static str; 2],
    /// Unit shown after a value in the tooltip.
    pub(crate) unit: &'static str,
    /// Values that the vertical axis must include, besides those of the curves.
    pub(crate) reach: &'a [f64],
}

/// The start of a picture of this size, with a title.
pub(crate) fn begin([width, height]: [f64; 2], left: f64, title: &str) -> Svg {
    let (mut out, title) = (Svg::new(width, height), escaped(title));
    out.add(format_args!("<text x=\"{left}\" y=\"28\" font-size=\"17\" font-weight=\"bold\">{title}</text>"));
    out
}

/// Minimum vertical distance between the names of two curves.
const LINE: f64 = 19.0;

/// Dash patterns: each color appears once with its mark, then with the next dashes and the next mark, and so
/// on.
const DASHES: [&str; 3] = ["none", "8 4", "2 4"];

impl Panel<'_> {
    /// Draws the panel. Needs at least one curve; each curve needs a point.
    pub(crate) fn draw(&self, out: &mut Svg) {
        let all = |axis: usize| {
            self.curves.iter().flat_map(move |curve| curve.points.iter().map(move |point| point[axis]))
        };
        let [left, right, top, bottom] = self.frame;
        let x = Axis::around(all(0), [left, right]);
        let y = Axis::around(all(1).chain(self.reach.iter().copied()), [bottom, top]);
        out.grid(&x, &y, [short, number], self.titles);
        let look = |index: usize| {
            let round = index / COLOR_COUNT;
            let dashes = DASHES[round % DASHES.len()];
            (index % COLOR_COUNT, dashes, Mark::ALL[(index + round) % COLOR_COUNT])
        };
        // The names are placed at the curves' right ends, moved apart where they would overlap.
        let mut ends: Vec<(usize, f64)> = Vec::new();
        for (index, curve) in self.curves.iter().enumerate() {
            let (color, dashes, mark) = look(index);
            let places: Vec<[f64; 2]> = curve.points.iter().map(|p| [x.place(p[0]), y.place(p[1])]).collect();
            let line: Vec<String> = places.iter().map(|[x, y]| format!("{x:.1},{y:.1}")).collect();
            out.add(format_args!(
                "<g class=\"c{color}\" fill=\"currentColor\"><polyline points=\"{}\" fill=\"none\" \
                 stroke=\"currentColor\" stroke-width=\"2\" stroke-dasharray=\"{dashes}\"/>",
                line.join(" ")
            ));
            for (place, [across, up]) in places.iter().zip(&curve.points) {
                let path = mark.path(*place);
                let what = format!("{}: {} {}", number(*across), significant(*up), self.unit);
                out.add(format_args!("<path d=\"{path}\"><title>{what}</title></path>"));
            }
            out.add(format_args!("</g>"));
            ends.extend(places.last().map(|end| (index, end[1])));
        }
        ends.sort_by(|a, b| a.1.total_cmp(&b.1));
        let mut free = top;
        for (_, height) in &mut ends {
            *height = height.max(free);
            free = *height + LINE;
        }
        let mut free = bottom - 4.0;
        for (_, height) in ends.iter_mut().rev() {
            *height = height.min(free);
            free = *height - LINE;
        }
        for (index, height) in ends {
            let (color, _, mark) = look(index);
            let path = mark.path([right + 16.0, height]);
            let (x, y, name) = (right + 26.0, height + 4.5, escaped(&self.curves[index].name));
            let text = format!("<path d=\"{path}\"/><text x=\"{x}\" y=\"{y:.1}\">{name}</text>");
            out.add(format_args!("<g class=\"c{color}\" fill=\"currentColor\">{text}</g>"));
        }
    }
}

/// As [`number`], with thousands as k and millions as M.
fn short(x: f64) -> String {
    match x {
        ..1e3 => number(x),
        1e3..1e6 => format!("{}k", number(x / 1e3)),
        _ => format!("{}M", number(x / 1e6)),
    }
}
