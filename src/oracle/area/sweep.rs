//! A sweep over the unit square: what is covered, cut into trapezoids.
//!
//! Events are the ends of all edges. Between two neighboring events every active edge spans the slab; the
//! edges are sorted by u in the middle, and where two neighbors have another order at the lower or upper end,
//! the slab is divided at their crossing. From left to right, winding numbers are added up.

use super::fault::{Fault, Faults};
use super::frame::EPSILON;

/// What an edge bounds.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Kind {
    /// What hides the light.
    Chain,
    /// The light, if it is not the whole square.
    Light,
    /// What the receiver's normal allows it to see.
    Horizon,
}

/// An edge that rises from `low` to `high`, both (u, v).
#[derive(Clone, Copy, Debug)]
pub(super) struct Edge {
    low: [f64; 2],
    high: [f64; 2],
    /// 1 over the height.
    inverse: f64,
    /// What is added to the winding number from left to right.
    change: i32,
    kind: Kind,
}

impl Edge {
    /// The edge of a counter-clockwise boundary; `None` if it is horizontal.
    pub(super) fn between(from: [f64; 2], to: [f64; 2], times: i32, kind: Kind) -> Option<Self> {
        let (low, high, change) = if from[1] < to[1] { (from, to, -times) } else { (to, from, times) };
        let inverse = 1.0 / (high[1] - low[1]);
        (from[1] != to[1]).then_some(Self { low, high, inverse, change, kind })
    }

    /// u at a height between the ends, off by at most 5ε for a given height.
    #[inline]
    fn at(&self, v: f64) -> f64 {
        let ([u0, v0], [u1, v1]) = (self.low, self.high);
        if v <= v0 {
            u0
        } else if v >= v1 {
            u1
        } else {
            let t = ((v - v0) * self.inverse).min(1.0);
            u0 + t * (u1 - u0)
        }
    }

    /// An order that does not depend on where the edge stands in a list.
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        let key = |edge: &Self| [edge.low[1], edge.low[0], edge.high[1], edge.high[0]];
        let (a, b) = (key(self), key(other));
        let first = (0..4).map(|i| a[i].total_cmp(&b[i])).find(|order| order.is_ne());
        first.unwrap_or_else(|| (self.kind, self.change).cmp(&(other.kind, other.change)))
    }
}

/// A part of the square between two heights and two lines, each given by u at both heights.
#[derive(Clone, Copy, Debug)]
pub(super) struct Trapezoid {
    pub(super) v: [f64; 2],
    pub(super) left: [f64; 2],
    pub(super) right: [f64; 2],
}

/// Takes the parts that a sweep finds.
pub(super) trait Sink {
    /// A part of the light that is hidden.
    fn covered(&mut self, part: Trapezoid);
    /// A part of the light that is not hidden, and above the horizon.
    fn visible(&mut self, part: Trapezoid);
}

/// Winding numbers just right of u = 0.
#[derive(Clone, Copy, Debug)]
pub(super) struct AtLeft {
    pub(super) chain: i32,
    pub(super) light: i32,
    pub(super) horizon: i32,
}

impl AtLeft {
    fn cross(&mut self, edge: &Edge) {
        match edge.kind {
            Kind::Chain => self.chain += edge.change,
            Kind::Light => self.light += edge.change,
            Kind::Horizon => self.horizon += edge.change,
        }
    }

    fn covered(self) -> bool {
        self.light != 0 && self.chain != 0
    }

    fn visible(self) -> bool {
        self.light != 0 && self.chain == 0 && self.horizon != 0
    }
}

/// An edge within a slab.
#[derive(Clone, Copy, Debug)]
struct Span {
    edge: u32,
    u: [f64; 2],
}

/// Buffers of a sweep.
#[derive(Debug, Default)]
pub(super) struct Sweep {
    levels: Vec<f64>,
    active: Vec<Span>,
    open: Vec<([f64; 2], u32)>,
    /// How large an area rounding may have assigned wrongly.
    pub(super) lost: f64,
}

/// Two neighbors in the wrong order by no more than this are equal: both are off by at most 5ε.
const SAME: f64 = 10.0 * EPSILON;

/// Divisions of a slab, one in another.
const MOST_DEPTH: u32 = 60;

impl Sweep {
    /// `left` holds changes of the winding number of the chain right of u = 0, at a height each.
    pub(super) fn run(
        &mut self,
        edges: &mut [Edge],
        left: &mut [(f64, i32)],
        mut at_left: AtLeft,
        faults: Faults,
        sink: &mut impl Sink,
    ) {
        edges.sort_unstable_by(Edge::cmp);
        left.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
        self.levels.clear();
        self.levels.extend([0.0, 1.0]);
        self.levels.extend(edges.iter().flat_map(|edge| [edge.low[1], edge.high[1]]));
        // Pieces that follow one another along u = 0 change nothing where they meet.
        for same in left.chunk_by(|a, b| a.0 == b.0) {
            self.levels
                .extend((same.iter().map(|(_, change)| change).sum::<i32>() != 0).then_some(same[0].0));
        }
        self.levels.sort_unstable_by(f64::total_cmp);
        self.levels.dedup();
        self.active.clear();
        self.lost = 0.0;
        let (mut next_edge, mut next_left) = (0, 0);
        for level in 1..self.levels.len() {
            let v = [self.levels[level - 1], self.levels[level]];
            self.active.retain(|span| edges[span.edge as usize].high[1] > v[0]);
            while let Some(edge) = edges.get(next_edge).filter(|edge| edge.low[1] <= v[0]) {
                self.active.push(Span { edge: next_edge as u32, u: [edge.low[0]; 2] });
                next_edge += 1;
            }
            while let Some((_, change)) = left.get(next_left).filter(|(height, _)| *height <= v[0]) {
                at_left.chain += change;
                next_left += 1;
            }
            self.slab(edges, v, at_left, faults, sink);
        }
    }

    /// Measures a slab, divided where edges cross. The lower ends of all spans are known.
    fn slab(&mut self, edges: &[Edge], v: [f64; 2], at_left: AtLeft, faults: Faults, sink: &mut impl Sink) {
        self.open.push((v, 0));
        while let Some((v, depth)) = self.open.pop() {
            for span in &mut self.active {
                span.u[1] = edges[span.edge as usize].at(v[1]);
            }
            sort(&mut self.active);
            match self.crossing(v) {
                Some(crossing) if depth < MOST_DEPTH => {
                    self.open.push(([crossing, v[1]], depth + 1));
                    self.open.push(([v[0], crossing], depth + 1));
                    continue;
                }
                Some(_) => self.lost += v[1] - v[0],
                None => {}
            }
            // Each line of a part is off by at most SAME.
            self.lost += (v[1] - v[0]) * self.active.len() as f64 * 2.0 * SAME;
            across(edges, &self.active, v, at_left, faults, sink);
            for span in &mut self.active {
                span.u[0] = span.u[1];
            }
        }
    }

    /// The lowest height strictly within a slab at which two neighbors cross. A crossing that rounds to an
    /// end is as close to it as ε: the area between the two lines beyond it is less than that.
    fn crossing(&mut self, v: [f64; 2]) -> Option<f64> {
        let mut lowest = f64::INFINITY;
        for pair in self.active.windows(2) {
            let [below, above] = [0, 1].map(|end| pair[1].u[end] - pair[0].u[end]);
            if below < -SAME || above < -SAME {
                let at = v[0] + (v[1] - v[0]) * (below / (below - above)).clamp(0.0, 1.0);
                if v[0] < at && at < v[1] {
                    lowest = lowest.min(at);
                } else {
                    self.lost += EPSILON;
                }
            }
        }
        lowest.is_finite().then_some(lowest)
    }
}

/// From left to right, by the middle. Spans are nearly in order from the slab before, so that each moves by a
/// few places; where that is not so, a sort that does not depend on it takes over.
fn sort(spans: &mut [Span]) {
    let before = |a: &Span, b: &Span| {
        let middle = |span: &Span| span.u[0] + span.u[1];
        middle(a).total_cmp(&middle(b)).then(a.u[0].total_cmp(&b.u[0])).then(a.edge.cmp(&b.edge))
    };
    let mut moves = 8 * spans.len();
    for end in 1..spans.len() {
        let span = spans[end];
        let mut at = end;
        while at > 0 && before(&span, &spans[at - 1]).is_lt() {
            spans[at] = spans[at - 1];
            at -= 1;
        }
        spans[at] = span;
        moves = moves.saturating_sub(end - at);
        if moves == 0 {
            return spans.sort_unstable_by(before);
        }
    }
}

/// Adds up winding numbers from left to right.
fn across(
    edges: &[Edge],
    active: &[Span],
    v: [f64; 2],
    at_left: AtLeft,
    faults: Faults,
    sink: &mut impl Sink,
) {
    let mut state = at_left;
    let start = [0.0; 2];
    let mut covered = state.covered().then_some(start);
    let mut visible = state.visible().then_some(start);
    let mut last = start;
    for span in active {
        if faults.has(Fault::Sum) {
            for _ in 1..state.chain.abs() {
                sink.covered(Trapezoid { v, left: last, right: span.u });
            }
            last = span.u;
        }
        state.cross(&edges[span.edge as usize]);
        if state.covered() != covered.is_some() {
            match covered.take() {
                Some(left) => sink.covered(Trapezoid { v, left, right: span.u }),
                None => covered = Some(span.u),
            }
        }
        if state.visible() != visible.is_some() {
            match visible.take() {
                Some(left) => sink.visible(Trapezoid { v, left, right: span.u }),
                None => visible = Some(span.u),
            }
        }
    }
    let right = [1.0; 2];
    if faults.has(Fault::NoClosing) {
        return;
    }
    if let Some(left) = covered {
        sink.covered(Trapezoid { v, left, right });
    }
    if let Some(left) = visible {
        sink.visible(Trapezoid { v, left, right });
    }
}
