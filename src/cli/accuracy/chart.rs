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
const BOTTOM: f64 = 356.0;
const PANEL: f64 = 416.0;
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
    let mut svg = Svg::new(WIDTH, PANEL * panels.len() as f64 + NOTES);
    for (index, chart) in panels.iter().enumerate() {
        panel(&mut svg, PANEL * index as f64, chart);
    }
    let below = PANEL * panels.len() as f64 + 10.0;
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
    let y = Axis::decades(entries.iter().map(|entry| entry.error), [top + BOTTOM, top + TOP]);
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
    // Lines to labels come before the labels, lest one cross the text of another.
    let areas: Vec<Taken> = spots.iter().map(|spot| label_area(spot, top, &mut taken)).collect();
    for (spot, area) in spots.iter().zip(&areas) {
        leader(svg, spot, area);
    }
    for (spot, area) in spots.iter().zip(&areas) {
        label(svg, spot, area);
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

/// The name as labels have it.
fn name(entry: &Entry) -> String {
    format!("{}{}", entry.name, if entry.dominated { ", dominated" } else { "" })
}

/// The nearest free position for two lines of text next to a mark.
fn label_area(spot: &Spot<'_>, top: f64, taken: &mut Vec<Taken>) -> Taken {
    let (name, said) = (name(spot.entry), &spot.entry.said);
    // An upper bound: the font is not known here.
    let width = 7.8 * name.chars().count().max(said.chars().count()) as f64;
    let [x, y] = spot.place;
    let at = |left: f64, middle: f64| [left, middle - 17.0, left + width, middle + 17.0];
    let inside = |[left, above, right, below]: Taken| {
        left >= LEFT + 2.0 && right <= RIGHT && above >= top + TOP - 14.0 && below <= top + BOTTOM - 2.0
    };
    let free = |area: &Taken| {
        taken.iter().all(|other| {
            area[2] <= other[0] || other[2] <= area[0] || area[3] <= other[1] || other[3] <= area[1]
        })
    };
    let [low, high] = spot.spread;
    let sides = [high.max(x + 7.0) + 5.0, low.min(x - 7.0) - 5.0 - width, x - 0.5 * width];
    let steps = (0..40).flat_map(|step| [1.0, -1.0].map(|sign| sign * 8.0 * f64::from(step)));
    let places = steps.flat_map(|step| sides.map(|left| at(left, y + step)));
    let fits = |area: &Taken| inside(*area) && free(area);
    // If nothing fits: at the left end, below everything else.
    let area = places.into_iter().find(fits).unwrap_or_else(|| at(LEFT + 6.0, top + BOTTOM - 24.0));
    taken.push(area);
    area
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

/// Two lines of text.
fn label(svg: &mut Svg, spot: &Spot<'_>, &[left, above, ..]: &Taken) {
    let (first, second, [color, _]) = (above + 14.0, above + 29.0, spot.look);
    svg.add(format_args!(
        "<g class=\"c{color} halo\" fill=\"currentColor\"><text x=\"{left:.1}\" y=\"{first:.1}\" \
         font-weight=\"bold\">{}</text><text x=\"{left:.1}\" y=\"{second:.1}\" font-size=\"12\">{}</text></g>",
        escaped(&name(spot.entry)),
        escaped(&spot.entry.said)
    ));
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
