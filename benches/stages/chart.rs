//! Frame rates as a chart.

use crate::svg::{Svg, escaped};

use crate::plot::{Curve, Panel, begin};

const WIDTH: f64 = 760.0;
const HEIGHT: f64 = 470.0;

// Positions of the axes.
const LEFT: f64 = 70.0;
const RIGHT: f64 = 606.0;
const TOP: f64 = 84.0;
const BOTTOM: f64 = 380.0;

/// The chart of frames drawn on `adapter`: frames per second over triangles.
pub(crate) fn svg(adapter: &str, curves: &[Curve]) -> String {
    let mut out = begin([WIDTH, HEIGHT], LEFT, "Frames per second against triangles");
    let adapter = escaped(adapter);
    out.add(format_args!("<text x=\"{LEFT}\" y=\"48\">{adapter}</text>"));
    let what = "512 × 512 pixels, z-fail with caps, a light that moves";
    out.add(format_args!("<text x=\"{LEFT}\" y=\"66\">{what}</text>"));
    Panel {
        curves,
        frame: [LEFT, RIGHT, TOP, BOTTOM],
        titles: ["triangles", "frames per second"],
        unit: "frames/s",
        reach: &[],
    }
    .draw(&mut out);
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
