//! Charts of error against cost, a panel for each file or light.

use crate::cli::chart::{Axis, COLOR_COUNT, Mark, Svg, escaped, number, significant};
use umbrage::accuracy::{Method, Spread};
use umbrage::verify::Tally;

use super::{Asked, FileResult, Measured};

const WIDTH: f64 = 760.0;

// Vertical positions, from the top of a panel.
const LEFT: f64 = 92.0;
const RIGHT: f64 = 716.0;
const TOP: f64 = 66.0;
/// From the top of a panel to the axis below: more where there are many marks, for their labels.
const BOTTOM: f64 = 356.0;
/// From the axis below to the next panel.
const FOOT: f64 = 60.0;
/// Marks from which on a panel is crowded: it is higher, and what is dominated has short labels.
const CROWDED: usize = 11;
const PER_MARK: f64 = 22.0;
/// Distance between a mark and its label above which a line joins the two.
const LEADER: f64 = 40.0;
/// Room below the panels, for notes.
const NOTES: f64 = 56.0;

/// Notes below charts whose errors are counts.
pub(super) const NOTES_OF_COUNTS: &[&str] = &[
    "Filled: wrong answers, of those with one right answer. Hollow: none was found; the mark is drawn at 3/n,",
    "which the rate is below with 95 % confidence, if answers are independent. Bars: the fastest and the slowest round.",
    "Thick line: what nothing else dominates, being as fast and as often right.",
];

/// One chart of several, below each other.
pub(super) struct Panel {
    pub(super) heading: String,
    pub(super) second_line: String,
    /// Titles of the two axes.
    pub(super) titles: [&'static str; 2],
    /// What a hollow mark means, and what the bars and the thick line do.
    pub(super) notes: &'static [&'static str],
    pub(super) entries: Vec<Entry>,
}

impl Panel {
    fn is_crowded(&self) -> bool {
        self.entries.len() >= CROWDED
    }

    fn bottom(&self) -> f64 {
        BOTTOM + PER_MARK * (self.entries.len() + 1).saturating_sub(CROWDED) as f64
    }
}

/// What a mark stands for.
pub(super) struct Entry {
    pub(super) name: String,
    /// Second line of the label.
    pub(super) said: String,
    /// Time or memory, in the unit of the axis.
    pub(super) cost: Spread,
    /// Height of the mark, from 0 to 1.
    pub(super) error: f64,
    /// Whether the mark is hollow: no error was found, and `error` is only a bound.
    pub(super) is_hollow: bool,
    pub(super) dominated: bool,
}

/// One entry's mark.
struct Spot<'a> {
    entry: &'a Entry,
    /// Its color, and its shape among [`Mark::ALL`].
    look: [usize; 2],
    place: [f64; 2],
    /// Positions of its fastest and slowest round.
    spread: [f64; 2],
}

/// The box of a text or mark, which no other text may overlap: left, top, right, bottom.
type Taken = [f64; 4];

/// The panels of measured queries, one for each file.
pub(super) fn of_queries(results: &[FileResult], asked: &Asked) -> Vec<Panel> {
    let measured = results.iter().filter_map(|result| Some((result, result.measured.as_ref().ok()?)));
    measured.map(|(result, measured)| of_file(result, measured, asked)).collect()
}

fn of_file(result: &FileResult, measured: &Measured, asked: &Asked) -> Panel {
    let name = result.file.file_name().unwrap_or(result.file.as_os_str()).to_string_lossy();
    let (faces, queries) = (measured.faces as f64, measured.baseline().total.queries as f64);
    let entry = |method: &Method| Entry {
        name: method.name.to_owned(),
        said: said(method.total.time.median, "ns", &method.total.tally()),
        cost: method.total.time,
        error: height(&method.total.tally()),
        is_hollow: method.total.tally().wrong == 0,
        dominated: method.dominated,
    };
    Panel {
        heading: format!("Error against time: {}", asked.question.name()),
        second_line: format!("{}, {} faces, {} queries", shortened(&name), number(faces), number(queries)),
        titles: ["nanoseconds a query, median of the rounds", "wrong answers a query"],
        notes: NOTES_OF_COUNTS,
        entries: measured.found.methods.iter().map(entry).collect(),
    }
}

/// The chart of all panels.
pub(super) fn svg(panels: &[Panel]) -> String {
    let height: f64 = panels.iter().map(|panel| panel.bottom() + FOOT).sum();
    let mut svg = Svg::new(WIDTH, height + NOTES);
    let mut top = 0.0;
    for chart in panels {
        panel(&mut svg, top, chart);
        top += chart.bottom() + FOOT;
    }
    let below = height + 10.0;
    for (note, y) in panels.last().map_or(NOTES_OF_COUNTS, |panel| panel.notes).iter().zip([
        below,
        below + 16.0,
        below + 32.0,
    ]) {
        svg.add(format_args!("<text class=\"faint\" x=\"{LEFT}\" y=\"{y}\" font-size=\"11\">{note}</text>"));
    }
    svg.finish()
}

fn panel(svg: &mut Svg, top: f64, panel: &Panel) {
    // 1. The heading.
    let (first, second) = (top + 28.0, top + 48.0);
    svg.add(format_args!(
        "<text x=\"{LEFT}\" y=\"{first}\" font-size=\"17\" font-weight=\"bold\">{}</text>",
        escaped(&panel.heading)
    ));
    svg.add(format_args!("<text x=\"{LEFT}\" y=\"{second}\">{}</text>", escaped(&panel.second_line)));

    // 2. The axes.
    let entries = &panel.entries;
    let times = entries.iter().flat_map(|entry| [entry.cost.min, entry.cost.max]);
    let x = Axis::around(times.map(above_zero), [LEFT, RIGHT]);
    let y = Axis::decades(entries.iter().map(|entry| entry.error), [top + panel.bottom(), top + TOP]);
    svg.grid(&x, &y, [tick, power], panel.titles);

    // 3. The front that nothing beats, then the marks over it.
    let spots: Vec<Spot<'_>> =
        entries.iter().enumerate().map(|(index, entry)| spot(entry, index, &x, &y)).collect();
    let mut front: Vec<[f64; 2]> =
        spots.iter().filter(|spot| !spot.entry.dominated).map(|spot| spot.place).collect();
    front.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let line: Vec<String> = front.iter().map(|[x, y]| format!("{x:.1},{y:.1}")).collect();
    svg.add(format_args!(
        "<polyline class=\"grid\" points=\"{}\" fill=\"none\" stroke-width=\"3\"/>",
        line.join(" ")
    ));
    let taken = |spot: &Spot<'_>| {
        let ([x, y], [low, high]) = (spot.place, spot.spread);
        [low.min(x - 7.0), y - 7.0, high.max(x + 7.0), y + 7.0]
    };
    let mut taken: Vec<Taken> = spots.iter().map(taken).collect();
    for spot in &spots {
        draw(svg, spot);
    }
    // What nothing dominates is labeled first. Lines to labels come before the labels, lest one cross the
    // text of another.
    let room = [top + TOP, top + panel.bottom()];
    let mut order: Vec<&Spot<'_>> = spots.iter().collect();
    order.sort_by_key(|spot| spot.entry.dominated);
    let labels: Vec<(&Spot<'_>, Label)> = order
        .into_iter()
        .map(|spot| (spot, Label::place(spot, panel.is_crowded(), room, &mut taken)))
        .collect();
    for (spot, label) in &labels {
        leader(svg, spot, &label.area);
    }
    for (spot, label) in &labels {
        label.draw(svg, spot);
    }
}

fn spot<'a>(entry: &'a Entry, index: usize, x: &Axis, y: &Axis) -> Spot<'a> {
    let time = entry.cost;
    let [place, low, high] = [time.median, time.min, time.max].map(|time| x.place(above_zero(time)));
    // Two entries of one color differ in shape.
    let look = [index % COLOR_COUNT, (index + index / COLOR_COUNT) % COLOR_COUNT];
    Spot { entry, look, place: [place, y.place(entry.error)], spread: [low, high] }
}

/// A mark with its spread, hollow where nothing is wrong.
fn draw(svg: &mut Svg, spot: &Spot<'_>) {
    let Spot { entry, look: [color, shape], place: [x, y], spread: [low, high] } = *spot;
    let path = Mark::ALL[shape].path([x, y]);
    let inside = if entry.is_hollow { " class=\"paper\" style=\"stroke:currentColor\"" } else { "" };
    let title = escaped(&format!("{}: {}", entry.name, entry.said));
    svg.add(format_args!(
        "<g class=\"c{color}\" fill=\"currentColor\" stroke=\"currentColor\"><path d=\"M{low:.1} {y:.1}H{high:.1}\"/><path \
         d=\"{path}\" stroke-width=\"1.8\"{inside}><title>{title}</title></path></g>"
    ));
}

/// The text beside a mark: a name in bold, and below it what was measured; where many marks crowd a panel,
/// what is dominated has its name alone.
struct Label {
    name: String,
    said: Option<String>,
    area: Taken,
}

impl Label {
    /// The nearest free position for the text next to a mark; `room` is the top and the bottom of the panel.
    fn place(spot: &Spot<'_>, is_crowded: bool, [above, below]: [f64; 2], taken: &mut Vec<Taken>) -> Self {
        let is_short = is_crowded && spot.entry.dominated;
        let name = match spot.entry.dominated && !is_short {
            true => format!("{}, dominated", spot.entry.name),
            false => spot.entry.name.clone(),
        };
        let said = (!is_short).then(|| spot.entry.said.clone());
        // An upper bound: the font is not known here.
        let letters = name.chars().count().max(said.as_ref().map_or(0, |said| said.chars().count()));
        let (width, half) = if is_short { (6.4 * letters as f64, 8.0) } else { (7.8 * letters as f64, 17.0) };
        let [x, y] = spot.place;
        let at = |left: f64, middle: f64| [left, middle - half, left + width, middle + half];
        let inside = |[left, top, right, bottom]: Taken| {
            left >= LEFT + 2.0 && right <= RIGHT && top >= above - 14.0 && bottom <= below - 2.0
        };
        let free = |area: &Taken| {
            taken.iter().all(|other| {
                area[2] <= other[0] || other[2] <= area[0] || area[3] <= other[1] || other[3] <= area[1]
            })
        };
        let [low, high] = spot.spread;
        let sides = [high.max(x + 7.0) + 5.0, low.min(x - 7.0) - 5.0 - width, x - 0.5 * width];
        // Then farther to either side, until the panel ends.
        let farther =
            (1..12).flat_map(|k| [1.0, -1.0].map(|sign| x - 0.5 * width + sign * 60.0 * f64::from(k)));
        let columns: Vec<f64> = sides.into_iter().chain(farther).collect();
        let steps = (0..80).flat_map(|step| [1.0, -1.0].map(|sign| sign * 8.0 * f64::from(step)));
        let fits = |area: &Taken| inside(*area) && free(area);
        let nearest = |columns: &[f64]| {
            let places = steps.clone().flat_map(|step| columns.iter().map(move |&left| (left, step)));
            places.map(|(left, step)| at(left, y + step)).find(fits)
        };
        // If nothing fits: at the left end, below everything else.
        let area = nearest(&columns[..3]).or_else(|| nearest(&columns[3..]));
        let area = area.unwrap_or_else(|| at(LEFT + 6.0, below - half - 7.0));
        taken.push(area);
        Self { name, said, area }
    }

    fn draw(&self, svg: &mut Svg, spot: &Spot<'_>) {
        let ([left, above, ..], [color, _]) = (self.area, spot.look);
        let (name, first) = (escaped(&self.name), above + if self.said.is_some() { 14.0 } else { 12.0 });
        let size = if self.said.is_some() { 13 } else { 11 };
        svg.add(format_args!(
            "<g class=\"c{color} halo\" fill=\"currentColor\"><text x=\"{left:.1}\" y=\"{first:.1}\" \
             font-weight=\"bold\" font-size=\"{size}\">{name}</text>"
        ));
        if let Some(said) = &self.said {
            let second = above + 29.0;
            svg.add(format_args!(
                "<text x=\"{left:.1}\" y=\"{second:.1}\" font-size=\"12\">{}</text>",
                escaped(said)
            ));
        }
        svg.add(format_args!("</g>"));
    }
}

/// A line from a mark to its label, unless the two are beside each other.
fn leader(svg: &mut Svg, spot: &Spot<'_>, &[left, above, right, below]: &Taken) {
    let ([x, y], [color, _]) = (spot.place, spot.look);
    let [to_x, to_y] = [x.clamp(left, right), y.clamp(above, below)];
    if (to_x - x).hypot(to_y - y) > LEADER {
        svg.add(format_args!(
            "<path class=\"c{color}\" stroke=\"currentColor\" stroke-width=\"0.7\" \
             d=\"M{x:.1} {y:.1}L{to_x:.1} {to_y:.1}\"/>"
        ));
    }
}

/// "0.31 ns, 0 of 8,597,952 wrong".
pub(super) fn said(time: f64, unit: &str, tally: &Tally) -> String {
    let time = above_zero(time);
    let time = if time < 1000.0 { significant(time) } else { number(time) };
    format!("{time} {unit}, {} of {} wrong", number(tally.wrong as f64), number(tally.judged as f64))
}

/// Wrong answers per query; if there are none, the upper bound.
pub(super) fn height(tally: &Tally) -> f64 {
    tally.bound_95().unwrap_or(tally.error()).clamp(1e-12, 1.0)
}

/// Times of a chart may lie below 1.
fn tick(time: f64) -> String {
    if time < 1.0 { significant(time).trim_end_matches('0').to_owned() } else { number(time) }
}

/// Numbers that have a logarithm.
fn above_zero(ns: f64) -> f64 {
    ns.max(1e-3)
}

/// A power of ten, the small ones written as such.
fn power(x: f64) -> String {
    if x > 0.005 {
        return number(x);
    }
    format!("10<tspan dy=\"-5\" font-size=\"10\">{}</tspan>", x.log10().round())
}

/// A name that fits the heading.
pub(super) fn shortened(name: &str) -> String {
    const MOST: usize = 48;
    if name.chars().count() <= MOST {
        return name.to_owned();
    }
    name.chars().take(MOST - 1).chain(['…']).collect()
}
