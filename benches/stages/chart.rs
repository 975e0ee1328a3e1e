//! Frame rates as a chart: SVG by hand, the same bytes for the same numbers.

use std::fmt::Write as _;

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

/// Blue, vermilion and green after Okabe and Ito, told apart by colour-blind people; each with dashes and marks of its
/// own.
const LOOKS: [(&str, &str, Mark); 3] =
    [("#0072b2", "none", Mark::Circle), ("#c04a00", "8 4", Mark::Square), ("#00795a", "2 4", Mark::Triangle)];

#[derive(Clone, Copy)]
enum Mark {
    Circle,
    Square,
    Triangle,
}

impl Mark {
    fn path(self, [x, y]: [f64; 2]) -> String {
        match self {
            Self::Circle => format!("M{:.1} {y:.1}a4 4 0 1 0 8 0a4 4 0 1 0-8 0z", x - 4.0),
            Self::Square => format!("M{:.1} {:.1}h7v7h-7z", x - 3.5, y - 3.5),
            Self::Triangle => format!("M{x:.1} {:.1}l4.6 8h-9.2z", y - 5.0),
        }
    }
}

/// An axis with a logarithmic scale, from one tick to another.
struct Axis {
    ticks: Vec<f64>,
    /// Where its ends stand.
    ends: [f64; 2],
}

impl Axis {
    /// Ticks at 1, 2 and 5 of each decade, the outermost just around the values.
    fn around(values: impl Iterator<Item = f64> + Clone, ends: [f64; 2]) -> Self {
        let low = values.clone().fold(f64::INFINITY, f64::min);
        let high = values.fold(0.0, f64::max);
        let decades = low.log10().floor() as i32..=high.log10().ceil() as i32;
        let all: Vec<f64> =
            decades.flat_map(|decade| [1.0, 2.0, 5.0].map(|digit| digit * 10_f64.powi(decade))).collect();
        let last_below = all.iter().rposition(|&tick| tick <= low).unwrap_or(0);
        let first_above = all.iter().position(|&tick| tick >= high).unwrap_or(all.len() - 1);
        // One value still wants an axis of some length.
        let first_above = first_above.max(last_below + 1);
        Self { ticks: all[last_below..=first_above].to_vec(), ends }
    }

    fn place(&self, value: f64) -> f64 {
        let [low, high] = [self.ticks[0], self.ticks[self.ticks.len() - 1]].map(f64::ln);
        self.ends[0] + (value.ln() - low) / (high - low) * (self.ends[1] - self.ends[0])
    }
}

/// The chart of frames that were drawn on `adapter`. Needs one to three curves, each with a point.
pub(crate) fn svg(adapter: &str, curves: &[Curve]) -> String {
    let all = |axis: usize| curves.iter().flat_map(move |curve| curve.points.iter().map(move |p| p[axis]));
    let (x, y) = (Axis::around(all(0), [LEFT, RIGHT]), Axis::around(all(1), [BOTTOM, TOP]));
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH} {HEIGHT}\" width=\"{WIDTH}\" height=\"{HEIGHT}\" \
         font-family=\"Helvetica, Arial, sans-serif\" font-size=\"13\" fill=\"#333\">\n\
         <rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n\
         <text x=\"{LEFT}\" y=\"28\" font-size=\"17\" font-weight=\"bold\">Frames per second against triangles</text>\n\
         <text x=\"{LEFT}\" y=\"48\">{}</text>\n\
         <text x=\"{LEFT}\" y=\"66\">512 × 512 pixels, z-fail with caps, a light that moves</text>\n",
        escaped(adapter)
    );
    grid(&mut out, &x, &y);
    // The names stand at the right ends, moved apart where they would meet.
    let mut ends: Vec<(usize, f64)> = Vec::new();
    for (index, (curve, (colour, dashes, mark))) in curves.iter().zip(LOOKS).enumerate() {
        let places: Vec<[f64; 2]> = curve.points.iter().map(|p| [x.place(p[0]), y.place(p[1])]).collect();
        let line: Vec<String> = places.iter().map(|[x, y]| format!("{x:.1},{y:.1}")).collect();
        add(
            &mut out,
            format_args!(
                "<g fill=\"{colour}\"><polyline points=\"{}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"2\" \
                 stroke-dasharray=\"{dashes}\"/>",
                line.join(" ")
            ),
        );
        for (place, [triangles, rate]) in places.iter().zip(&curve.points) {
            let path = mark.path(*place);
            let what = format!("{}: {} frames/s", number(*triangles), significant(*rate));
            add(&mut out, format_args!("<path d=\"{path}\"><title>{what}</title></path>"));
        }
        add(&mut out, format_args!("</g>"));
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
        let (colour, _, mark) = LOOKS[index];
        let path = mark.path([RIGHT + 16.0, height]);
        let (x, y, name) = (RIGHT + 26.0, height + 4.5, escaped(&curves[index].name));
        let text = format!("<path d=\"{path}\"/><text x=\"{x}\" y=\"{y:.1}\">{name}</text>");
        add(&mut out, format_args!("<g fill=\"{colour}\">{text}</g>"));
    }
    let note = |out: &mut String, y, text| {
        add(out, format_args!("<text x=\"{LEFT}\" y=\"{y}\" font-size=\"11\" fill=\"#666\">{text}</text>"));
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
    out += "</svg>\n";
    out
}

fn grid(out: &mut String, x: &Axis, y: &Axis) {
    let line = |out: &mut String, x: f64, y: f64, to: &str| {
        add(out, format_args!("<path d=\"M{x:.1} {y:.1}{to}\" stroke=\"#ddd\"/>"));
    };
    for &tick in &x.ticks {
        let (place, label) = (x.place(tick), BOTTOM + 18.0);
        line(out, place, TOP, &format!("V{BOTTOM}"));
        add(
            out,
            format_args!(
                "<text x=\"{place:.1}\" y=\"{label}\" text-anchor=\"middle\">{}</text>",
                short(tick)
            ),
        );
    }
    for &tick in &y.ticks {
        let (place, label) = (y.place(tick), LEFT - 8.0);
        line(out, LEFT, place, &format!("H{RIGHT}"));
        let baseline = place + 4.5;
        add(
            out,
            format_args!(
                "<text x=\"{label}\" y=\"{baseline:.1}\" text-anchor=\"end\">{}</text>",
                number(tick)
            ),
        );
    }
    let (middle, below) = (0.5 * (LEFT + RIGHT), BOTTOM + 38.0);
    add(out, format_args!("<text x=\"{middle}\" y=\"{below}\" text-anchor=\"middle\">triangles</text>"));
    let middle = 0.5 * (TOP + BOTTOM);
    let turned = format!("transform=\"translate(18 {middle}) rotate(-90)\" text-anchor=\"middle\"");
    add(out, format_args!("<text {turned}>frames per second</text>"));
}

/// A line of text.
fn add(out: &mut String, text: std::fmt::Arguments<'_>) {
    let _ = writeln!(out, "{text}"); // a String takes everything
}

/// As [`number`], thousands as k.
fn short(x: f64) -> String {
    if x < 1000.0 { number(x) } else { format!("{}k", number(x / 1000.0)) }
}

/// A number with a comma at each thousand.
fn number(x: f64) -> String {
    if x < 1000.0 {
        return format!("{x}");
    }
    let digits = format!("{x:.0}");
    let grouped = digits.char_indices().map(|(place, digit)| {
        let comma = place > 0 && (digits.len() - place) % 3 == 0;
        if comma { format!(",{digit}") } else { digit.to_string() }
    });
    grouped.collect()
}

/// Three digits, or all before the point.
fn significant(x: f64) -> String {
    let decimals = (2 - x.log10().floor() as i32).clamp(0, 9) as usize;
    format!("{x:.decimals$}")
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}
