//! The chart of `umbrage accuracy --svg`: wrong answers against time, a panel for each file.

use crate::cli::chart::{Axis, COLOR_COUNT, Mark, Svg, escaped, number, significant};
use umbrage::accuracy::{Method, Row};

use super::{Asked, FileResult, Measured};

const WIDTH: f64 = 760.0;

// Vertical positions, from the top of a panel.
const LEFT: f64 = 92.0;
const RIGHT: f64 = 716.0;
const TOP: f64 = 66.0;
const BOTTOM: f64 = 356.0;
const PANEL: f64 = 416.0;
/// Room below the panels, for notes.
const NOTES: f64 = 56.0;

/// One method's mark.
struct Spot<'a> {
    method: &'a Method,
    /// Its color and shape.
    look: usize,
    place: [f64; 2],
    /// Positions of its fastest and slowest round.
    spread: [f64; 2],
}

/// The box of a text or mark, which no other text may overlap: left, top, right, bottom.
type Taken = [f64; 4];

pub(super) fn svg(results: &[FileResult], asked: &Asked) -> String {
    let measured = results.iter().filter_map(|result| Some((result, result.measured.as_ref().ok()?)));
    let panels: Vec<(&FileResult, &Measured)> = measured.collect();
    let mut svg = Svg::new(WIDTH, PANEL * panels.len() as f64 + NOTES);
    for (index, (result, measured)) in panels.iter().enumerate() {
        panel(&mut svg, PANEL * index as f64, result, measured, asked);
    }
    let below = PANEL * panels.len() as f64 + 10.0;
    let notes = [
        "Filled: wrong answers, of queries with one right answer. Hollow: none was found; the mark is drawn at 3/n,",
        "which the rate is below with 95 % confidence, if queries are independent. Bars: the fastest and the slowest round.",
        "Thick line: the methods that no other one dominates, being as fast and as often right.",
    ];
    for (note, y) in notes.iter().zip([below, below + 16.0, below + 32.0]) {
        svg.add(format_args!("<text class=\"faint\" x=\"{LEFT}\" y=\"{y}\" font-size=\"11\">{note}</text>"));
    }
    svg.finish()
}

fn panel(svg: &mut Svg, top: f64, result: &FileResult, measured: &Measured, asked: &Asked) {
    let methods = &measured.found.methods;
    // 1. The heading.
    let name = result.file.file_name().unwrap_or(result.file.as_os_str()).to_string_lossy();
    let (first, second) = (top + 28.0, top + 48.0);
    svg.add(format_args!(
        "<text x=\"{LEFT}\" y=\"{first}\" font-size=\"17\" font-weight=\"bold\">Error against time: {}</text>",
        asked.question.name()
    ));
    svg.add(format_args!(
        "<text x=\"{LEFT}\" y=\"{second}\">{}, {} faces, {} queries</text>",
        escaped(&shortened(&name)),
        number(measured.faces as f64),
        number(measured.baseline().total.queries as f64)
    ));

    // 2. The axes.
    let times = methods.iter().flat_map(|method| [method.total.time.min, method.total.time.max]);
    let x = Axis::around(times.map(above_zero), [LEFT, RIGHT]);
    let y = Axis::decades(methods.iter().map(|method| height(&method.total)), [top + BOTTOM, top + TOP]);
    let titles = ["nanoseconds a query, median of the rounds", "wrong answers a query"];
    svg.grid(&x, &y, [number, power], titles);

    // 3. The front that no method beats, then the marks over it.
    let spots: Vec<Spot<'_>> =
        methods.iter().zip(0..).map(|(method, look)| spot(method, look, &x, &y)).collect();
    let mut front: Vec<[f64; 2]> =
        spots.iter().filter(|spot| !spot.method.dominated).map(|spot| spot.place).collect();
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
    for spot in &spots {
        label(svg, spot, top, &mut taken);
    }
}

fn spot<'a>(method: &'a Method, index: usize, x: &Axis, y: &Axis) -> Spot<'a> {
    let Row { time, .. } = method.total;
    let [place, low, high] = [time.median, time.min, time.max].map(|time| x.place(above_zero(time)));
    let place = [place, y.place(height(&method.total))];
    Spot { method, look: index % COLOR_COUNT, place, spread: [low, high] }
}

/// A mark with its spread, hollow where nothing is wrong.
fn draw(svg: &mut Svg, spot: &Spot<'_>) {
    let Spot { method, look, place: [x, y], spread: [low, high] } = *spot;
    let path = Mark::ALL[look].path([x, y]);
    let inside = if method.total.wrong == 0 { " class=\"paper\" style=\"stroke:currentColor\"" } else { "" };
    let title = escaped(&format!("{}: {}", method.name, said(method)));
    svg.add(format_args!(
        "<g class=\"c{look}\" fill=\"currentColor\" stroke=\"currentColor\"><path d=\"M{low:.1} {y:.1}H{high:.1}\"/><path \
         d=\"{path}\" stroke-width=\"1.8\"{inside}><title>{title}</title></path></g>"
    ));
}

/// Two lines of text next to a mark, at the nearest free position.
fn label(svg: &mut Svg, spot: &Spot<'_>, top: f64, taken: &mut Vec<Taken>) {
    let dominated = if spot.method.dominated { ", dominated" } else { "" };
    let (name, said) = (format!("{}{dominated}", spot.method.name), said(spot.method));
    // An upper bound: the font is not known here.
    let width = 8.4 * name.chars().count().max(said.chars().count()) as f64;
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
    let ([left, above, ..], look) = (area, spot.look);
    let (first, second) = (above + 14.0, above + 29.0);
    svg.add(format_args!(
        "<g class=\"c{look} halo\" fill=\"currentColor\"><text x=\"{left:.1}\" y=\"{first:.1}\" \
         font-weight=\"bold\">{}</text><text x=\"{left:.1}\" y=\"{second:.1}\" font-size=\"12\">{}</text></g>",
        escaped(&name),
        escaped(&said)
    ));
    taken.push(area);
}

/// "0.31 ns, 0 of 8,597,952 wrong".
fn said(method: &Method) -> String {
    let Row { wrong, judged, time, .. } = method.total;
    let time = above_zero(time.median);
    let time = if time < 1000.0 { significant(time) } else { number(time) };
    format!("{time} ns, {} of {} wrong", number(wrong as f64), number(judged as f64))
}

/// Wrong answers per query; if there are none, the upper bound.
fn height(row: &Row) -> f64 {
    row.bound_95().unwrap_or(row.error()).clamp(1e-12, 1.0)
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
fn shortened(name: &str) -> String {
    const MOST: usize = 48;
    if name.chars().count() <= MOST {
        return name.to_owned();
    }
    name.chars().take(MOST - 1).chain(['…']).collect()
}
