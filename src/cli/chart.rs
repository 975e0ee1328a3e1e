//! Charts as SVG: logarithmic axes, marks and text. The same numbers give the same bytes, and the colors
//! follow the light or dark scheme of the reader.

use std::fmt;

/// A chart under construction: lines of SVG.
#[derive(Clone, Debug)]
pub(crate) struct Svg {
    text: String,
}

/// The colors of the classes `c0` to `c4`, as `currentColor`, on light and on dark ground: blue, vermilion
/// and green after Okabe and Ito, then purple and ochre, which color-blind people can distinguish.
const COLORS: [[&str; 2]; 5] = [
    ["#0072b2", "#56b4e9"],
    ["#c04a00", "#ff9b57"],
    ["#00795a", "#35c79b"],
    ["#8b4a9c", "#d59ae6"],
    ["#7a6200", "#e3c44a"],
];

/// Number of colors.
pub(crate) const COLOR_COUNT: usize = COLORS.len();

impl Svg {
    /// An empty chart of the given size in pixels.
    ///
    /// Classes: `c0` to `c4` are colors, as `currentColor`; `grid` strokes lines of a grid, `faint` fills
    /// text of less weight, `paper` fills and strokes in the color of the ground, `halo` outlines text in
    /// that color.
    #[must_use]
    pub(crate) fn new(width: f64, height: f64) -> Self {
        let classes = |side: usize| -> String {
            let colors = COLORS.iter().enumerate();
            colors.map(|(i, color)| format!(".c{i}{{color:{}}}", color[side])).collect()
        };
        let mut svg = Self { text: String::new() };
        svg.add(format_args!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" width=\"{width}\" \
             height=\"{height}\" font-family=\"Helvetica, Arial, sans-serif\" font-size=\"13\">"
        ));
        svg.add(format_args!(
            "<style>svg{{fill:#333}}.paper{{fill:#fff;stroke:#fff}}.grid{{stroke:#ddd}}.faint{{fill:#666}}\
             .halo{{stroke:#fff;stroke-width:4px;stroke-linejoin:round;paint-order:stroke}}{}\n\
             @media(prefers-color-scheme:dark){{svg{{fill:#ddd}}.paper{{fill:#16181d;stroke:#16181d}}.grid{{stroke:#3a3e46}}\
             .faint{{fill:#9aa0a8}}.halo{{stroke:#16181d}}{}}}</style>",
            classes(0),
            classes(1)
        ));
        svg.add(format_args!("<rect class=\"paper\" width=\"100%\" height=\"100%\"/>"));
        svg
    }

    /// A line of SVG; text in it is already [`escaped`].
    pub(crate) fn add(&mut self, line: fmt::Arguments<'_>) {
        use fmt::Write as _;
        let _ = writeln!(self.text, "{line}"); // a String takes everything
    }

    /// Grid lines and numbers at the ticks of two axes, and the titles of the axes; all text is already
    /// [`escaped`].
    pub(crate) fn grid(&mut self, x: &Axis, y: &Axis, labels: [fn(f64) -> String; 2], titles: [&str; 2]) {
        let ([left, right], [bottom, top]) = (x.ends, y.ends);
        for &tick in &x.ticks {
            let (place, below) = (x.place(tick), bottom + 18.0);
            self.add(format_args!("<path class=\"grid\" d=\"M{place:.1} {top:.1}V{bottom}\"/>"));
            let label = labels[0](tick);
            self.add(format_args!(
                "<text x=\"{place:.1}\" y=\"{below}\" text-anchor=\"middle\">{label}</text>"
            ));
        }
        for &tick in &y.ticks {
            let (place, beside) = (y.place(tick), left - 8.0);
            self.add(format_args!("<path class=\"grid\" d=\"M{left:.1} {place:.1}H{right}\"/>"));
            let (label, baseline) = (labels[1](tick), place + 4.5);
            self.add(format_args!(
                "<text x=\"{beside}\" y=\"{baseline:.1}\" text-anchor=\"end\">{label}</text>"
            ));
        }
        let (middle, below) = (0.5 * (left + right), bottom + 38.0);
        self.add(format_args!(
            "<text x=\"{middle}\" y=\"{below}\" text-anchor=\"middle\">{}</text>",
            titles[0]
        ));
        let (beside, middle) = (left - 52.0, 0.5 * (top + bottom));
        self.add(format_args!(
            "<text transform=\"translate({beside} {middle}) rotate(-90)\" text-anchor=\"middle\">{}</text>",
            titles[1]
        ));
    }

    /// The whole document.
    #[must_use]
    pub(crate) fn finish(self) -> String {
        self.text + "</svg>\n"
    }
}

/// An axis with a logarithmic scale, from one tick to another.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Axis {
    pub(crate) ticks: Vec<f64>,
    ends: [f64; 2],
}

/// Ticks per axis at most.
const MOST_TICKS: usize = 13;

impl Axis {
    /// Ticks at 1, 2 and 5 of each decade, or at the decades if those were too many; the outermost ones just
    /// enclose the values, which are above 0. `ends` are the positions of the lowest and the highest tick, in
    /// pixels.
    #[must_use]
    pub(crate) fn around(values: impl Iterator<Item = f64> + Clone, ends: [f64; 2]) -> Self {
        let ticks = Self::ticks_around(Self::range(values.clone()), &[1.0, 2.0, 5.0]);
        if ticks.len() > MOST_TICKS { Self::decades(values, ends) } else { Self { ticks, ends } }
    }

    /// As [`Axis::around`], with ticks at the decades alone.
    #[must_use]
    pub(crate) fn decades(values: impl Iterator<Item = f64> + Clone, ends: [f64; 2]) -> Self {
        Self { ticks: Self::ticks_around(Self::range(values), &[1.0]), ends }
    }

    /// The lowest and the highest value among those that have a logarithm.
    fn range(values: impl Iterator<Item = f64> + Clone) -> [f64; 2] {
        let (low, high) = (values.clone().fold(f64::INFINITY, f64::min), values.fold(0.0, f64::max));
        if low <= high { [low.max(1e-300), high.max(1e-300)] } else { [1.0, 1.0] }
    }

    fn ticks_around([low, high]: [f64; 2], digits: &[f64]) -> Vec<f64> {
        // One more on either side, in case rounding has chosen the wrong power of ten.
        let decades = low.log10().floor() as i32 - 1..=high.log10().ceil() as i32 + 1;
        let tick = |decade: i32, digit: f64| format!("{digit}e{decade}").parse().unwrap_or(digit);
        let all: Vec<f64> =
            decades.flat_map(|decade| digits.iter().map(move |&digit| tick(decade, digit))).collect();
        let last_below = all.iter().rposition(|&tick| tick <= low).unwrap_or(0);
        // A single value still needs an axis of positive length.
        let first_above =
            all.iter().position(|&tick| tick >= high).unwrap_or(all.len() - 1).max(last_below + 1);
        all[last_below..=first_above.min(all.len() - 1)].to_vec()
    }

    /// Position of a value, in pixels.
    #[must_use]
    pub(crate) fn place(&self, value: f64) -> f64 {
        let [low, high] = [self.ticks[0], self.ticks[self.ticks.len() - 1]].map(f64::ln);
        self.ends[0] + (value.ln() - low) / (high - low) * (self.ends[1] - self.ends[0])
    }
}

/// Shape of a mark, about 8 pixels wide.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Mark {
    /// A disc.
    Circle,
    /// Upright.
    Square,
    /// Point upwards.
    Triangle,
    /// On its corner.
    Diamond,
    /// Point downwards.
    Wedge,
}

impl Mark {
    /// All of them, one for each color.
    pub(crate) const ALL: [Self; COLOR_COUNT] =
        [Self::Circle, Self::Square, Self::Triangle, Self::Diamond, Self::Wedge];

    /// The outline around a point, as the `d` of a path.
    #[must_use]
    pub(crate) fn path(self, [x, y]: [f64; 2]) -> String {
        match self {
            Self::Circle => format!("M{:.1} {y:.1}a4 4 0 1 0 8 0a4 4 0 1 0-8 0z", x - 4.0),
            Self::Square => format!("M{:.1} {:.1}h7v7h-7z", x - 3.5, y - 3.5),
            Self::Triangle => format!("M{x:.1} {:.1}l4.6 8h-9.2z", y - 5.0),
            Self::Diamond => format!("M{x:.1} {:.1}l5 5l-5 5l-5-5z", y - 5.0),
            Self::Wedge => format!("M{x:.1} {:.1}l4.6-8h-9.2z", y + 5.0),
        }
    }
}

/// A number with a comma at each thousand.
#[must_use]
pub(crate) fn number(x: f64) -> String {
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

/// Three digits, or all before the point; of a number above 0.
#[must_use]
pub(crate) fn significant(x: f64) -> String {
    let decimals = (2 - x.log10().floor() as i32).clamp(0, 9) as usize;
    format!("{x:.decimals$}")
}

/// Text fit for SVG: no markup, no control characters.
#[must_use]
pub(crate) fn escaped(text: &str) -> String {
    let text = text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;");
    text.replace(|c: char| c.is_control() || matches!(c, '\u{fffe}' | '\u{ffff}'), "\u{fffd}")
}
