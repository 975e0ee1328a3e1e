//! Lines over logarithmic axes: SVG by hand, the same bytes for the same numbers.

use std::fmt::Write as _;

/// A line of a chart.
#[derive(Clone, Debug)]
pub(crate) struct Curve {
    pub(crate) name: String,
    /// Both coordinates above 0, the first ascending.
    pub(crate) points: Vec<[f64; 2]>,
}

/// Curves between two axes, with their names at the right.
pub(crate) struct Panel<'a> {
    pub(crate) curves: &'a [Curve],
    /// Where the axes stand: left, right, top, bottom.
    pub(crate) frame: [f64; 4],
    /// What the axes mean, across and up.
    pub(crate) titles: [&'static str; 2],
    /// What follows a value where the pointer rests on it.
    pub(crate) unit: &'static str,
    /// Values that the upright axis must reach, besides those of the curves.
    pub(crate) reach: &'a [f64],
}

/// The beginning of a picture of this size on white, with a title; `</svg>` ends it.
pub(crate) fn begin([width, height]: [f64; 2], left: f64, title: &str) -> String {
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" width=\"{width}\" height=\"{height}\" \
         font-family=\"Helvetica, Arial, sans-serif\" font-size=\"13\" fill=\"#333\">\n\
         <rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n\
         <text x=\"{left}\" y=\"28\" font-size=\"17\" font-weight=\"bold\">{}</text>\n",
        escaped(title)
    )
}

/// What holds the names of two lines apart.
const LINE: f64 = 19.0;

/// Blue, vermilion, green, and others after Okabe and Ito, told apart by colour-blind people; each with dashes and
/// marks of its own.
const LOOKS: [(&str, &str, Mark); 12] = [
    ("#0072b2", "none", Mark::Circle),
    ("#c04a00", "8 4", Mark::Square),
    ("#00795a", "2 4", Mark::Triangle),
    ("#000000", "none", Mark::Square),
    ("#a8487f", "none", Mark::Triangle),
    ("#a07800", "8 4", Mark::Circle),
    ("#2f8fc8", "2 4", Mark::Square),
    ("#666666", "8 4", Mark::Triangle),
    ("#0072b2", "2 4", Mark::Triangle),
    ("#c04a00", "none", Mark::Circle),
    ("#00795a", "none", Mark::Square),
    ("#a8487f", "8 4", Mark::Circle),
];

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

impl Panel<'_> {
    /// Needs one curve at least and as many as there are looks at most, each with a point.
    pub(crate) fn draw(&self, out: &mut String) {
        let all = |axis: usize| {
            self.curves.iter().flat_map(move |curve| curve.points.iter().map(move |point| point[axis]))
        };
        let [left, right, top, bottom] = self.frame;
        let x = Axis::around(all(0), [left, right]);
        let y = Axis::around(all(1).chain(self.reach.iter().copied()), [bottom, top]);
        self.grid(out, &x, &y);
        // The names stand at the right ends, moved apart where they would meet.
        let mut ends: Vec<(usize, f64)> = Vec::new();
        for (index, (curve, (colour, dashes, mark))) in self.curves.iter().zip(LOOKS).enumerate() {
            let places: Vec<[f64; 2]> = curve.points.iter().map(|p| [x.place(p[0]), y.place(p[1])]).collect();
            let line: Vec<String> = places.iter().map(|[x, y]| format!("{x:.1},{y:.1}")).collect();
            add(
                out,
                format_args!(
                    "<g fill=\"{colour}\"><polyline points=\"{}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"2\" \
                     stroke-dasharray=\"{dashes}\"/>",
                    line.join(" ")
                ),
            );
            for (place, [across, up]) in places.iter().zip(&curve.points) {
                let path = mark.path(*place);
                let what = format!("{}: {} {}", number(*across), significant(*up), self.unit);
                add(out, format_args!("<path d=\"{path}\"><title>{what}</title></path>"));
            }
            add(out, format_args!("</g>"));
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
            let (colour, _, mark) = LOOKS[index];
            let path = mark.path([right + 16.0, height]);
            let (x, y, name) = (right + 26.0, height + 4.5, escaped(&self.curves[index].name));
            let text = format!("<path d=\"{path}\"/><text x=\"{x}\" y=\"{y:.1}\">{name}</text>");
            add(out, format_args!("<g fill=\"{colour}\">{text}</g>"));
        }
    }

    fn grid(&self, out: &mut String, x: &Axis, y: &Axis) {
        let [left, right, top, bottom] = self.frame;
        let line = |out: &mut String, x: f64, y: f64, to: &str| {
            add(out, format_args!("<path d=\"M{x:.1} {y:.1}{to}\" stroke=\"#ddd\"/>"));
        };
        for &tick in &x.ticks {
            let (place, label) = (x.place(tick), bottom + 18.0);
            line(out, place, top, &format!("V{bottom}"));
            let text = short(tick);
            add(
                out,
                format_args!("<text x=\"{place:.1}\" y=\"{label}\" text-anchor=\"middle\">{text}</text>"),
            );
        }
        for &tick in &y.ticks {
            let (place, label) = (y.place(tick), left - 8.0);
            line(out, left, place, &format!("H{right}"));
            let (baseline, text) = (place + 4.5, number(tick));
            add(
                out,
                format_args!("<text x=\"{label}\" y=\"{baseline:.1}\" text-anchor=\"end\">{text}</text>"),
            );
        }
        let [across, up] = self.titles;
        let (middle, below) = (0.5 * (left + right), bottom + 38.0);
        add(out, format_args!("<text x=\"{middle}\" y=\"{below}\" text-anchor=\"middle\">{across}</text>"));
        let middle = 0.5 * (top + bottom);
        let turned = format!("transform=\"translate(18 {middle}) rotate(-90)\" text-anchor=\"middle\"");
        add(out, format_args!("<text {turned}>{up}</text>"));
    }
}

/// A line of text.
pub(crate) fn add(out: &mut String, text: std::fmt::Arguments<'_>) {
    let _ = writeln!(out, "{text}"); // a String takes everything
}

/// As [`number`], thousands as k and millions as M.
fn short(x: f64) -> String {
    match x {
        ..1e3 => number(x),
        1e3..1e6 => format!("{}k", number(x / 1e3)),
        _ => format!("{}M", number(x / 1e6)),
    }
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

pub(crate) fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}
