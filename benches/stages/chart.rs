//! Frame rates as a chart: SVG by hand, the same bytes for the same numbers.

use umbrage::picture::chart::{Axis, Mark, Svg, escaped, number, significant};

/// A line of a chart.
#[derive(Clone, Debug)]
pub(crate) struct Curve {
    pub(crate) name: String,
    /// How many triangles, how many frames a second; both above 0, triangles ascending.
    pub(crate) points: Vec<[f64; 2]>,
}

const WIDTH: f64 = 760.0;
const HEIGHT: f64 = 470.0;

// Where the axes stand.
const LEFT: f64 = 70.0;
const RIGHT: f64 = 606.0;
const TOP: f64 = 84.0;
const BOTTOM: f64 = 380.0;

/// What holds the names of two lines apart.
const LINE: f64 = 19.0;

/// Dashes and marks; the colours follow in order.
const LOOKS: [(&str, Mark); 3] = [("none", Mark::Circle), ("8 4", Mark::Square), ("2 4", Mark::Triangle)];

/// The chart of frames that were drawn on `adapter`. Needs one to three curves, each with a point.
pub(crate) fn svg(adapter: &str, curves: &[Curve]) -> String {
    let all = |axis: usize| curves.iter().flat_map(move |curve| curve.points.iter().map(move |p| p[axis]));
    let (x, y) = (Axis::around(all(0), [LEFT, RIGHT]), Axis::around(all(1), [BOTTOM, TOP]));
    let mut out = Svg::new(WIDTH, HEIGHT);
    out.add(format_args!(
        "<text x=\"{LEFT}\" y=\"28\" font-size=\"17\" font-weight=\"bold\">Frames per second against triangles</text>"
    ));
    out.add(format_args!("<text x=\"{LEFT}\" y=\"48\">{}</text>", escaped(adapter)));
    out.add(format_args!(
        "<text x=\"{LEFT}\" y=\"66\">512 × 512 pixels, z-fail with caps, a light that moves</text>"
    ));
    out.grid(&x, &y, [short, number], ["triangles", "frames per second"]);
    // The names stand at the right ends, moved apart where they would meet.
    let mut ends: Vec<(usize, f64)> = Vec::new();
    for (index, (curve, (dashes, mark))) in curves.iter().zip(LOOKS).enumerate() {
        let places: Vec<[f64; 2]> = curve.points.iter().map(|p| [x.place(p[0]), y.place(p[1])]).collect();
        let line: Vec<String> = places.iter().map(|[x, y]| format!("{x:.1},{y:.1}")).collect();
        out.add(format_args!(
            "<g class=\"c{index}\" fill=\"currentColor\"><polyline points=\"{}\" fill=\"none\" stroke=\"currentColor\" \
             stroke-width=\"2\" stroke-dasharray=\"{dashes}\"/>",
            line.join(" ")
        ));
        for (place, [triangles, rate]) in places.iter().zip(&curve.points) {
            let path = mark.path(*place);
            let what = format!("{}: {} frames/s", number(*triangles), significant(*rate));
            out.add(format_args!("<path d=\"{path}\"><title>{what}</title></path>"));
        }
        out.add(format_args!("</g>"));
        ends.extend(places.last().map(|end| (index, end[1])));
    }
    ends.sort_by(|a, b| a.1.total_cmp(&b.1));
    let mut free = TOP;
    for (_, height) in &mut ends {
        *height = height.max(free);
        free = *height + LINE;
    }
    let mut free = BOTTOM - 4.0;
    for (_, height) in ends.iter_mut().rev() {
        *height = height.min(free);
        free = *height - LINE;
    }
    for (index, height) in ends {
        let path = LOOKS[index].1.path([RIGHT + 16.0, height]);
        let (x, y, name) = (RIGHT + 26.0, height + 4.5, escaped(&curves[index].name));
        let text = format!("<path d=\"{path}\"/><text x=\"{x}\" y=\"{y:.1}\">{name}</text>");
        out.add(format_args!("<g class=\"c{index}\" fill=\"currentColor\">{text}</g>"));
    }
    let note = |out: &mut Svg, y, text| {
        out.add(format_args!("<text class=\"faint\" x=\"{LEFT}\" y=\"{y}\" font-size=\"11\">{text}</text>"));
    };
    note(
        &mut out,
        438,
        "The form is that of Zerari (2011), whose GeForce 9400M reached 3, 1 and 2 frames per second at 200,000 triangles",
    );
    note(
        &mut out,
        454,
        "without shadows, with CPU and with GPU silhouettes. Another machine, another scene: not a comparison of equals.",
    );
    out.finish()
}

/// As [`number`], thousands as k.
fn short(x: f64) -> String {
    if x < 1000.0 { number(x) } else { format!("{}k", number(x / 1000.0)) }
}
