//! What the window shows: everything that a person can change, and what is asked of the worker. Knows no
//! window.

use umbrage::geom::Aabb;
use umbrage::glam::DVec3;
use umbrage::scene::Lamp;
use umbrage::shadow::Technique;
use umbrage::view::{Camera, Projected, Size, Up};

use super::handle;
use super::orbit::{self, Orbit};
use super::pace::{Pace, Quality};

/// A lamp and its technique.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct OwnLamp {
    pub(super) lamp: Lamp,
    /// `None`: the planner chooses.
    pub(super) technique: Option<Technique>,
    pub(super) is_on: bool,
}

/// What a pixel stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Mode {
    /// The lit scene.
    Picture,
    /// The difference to the truth in false colors, for the chosen light.
    Difference,
    /// What the light grid proves of each point, for all lights.
    Grid,
}

/// What is drawn over the picture, or beside it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Layer {
    /// The truth, left of a divider.
    Truth,
    /// Silhouette edges of the chosen light.
    Silhouette,
    /// Edges of its shadow volume.
    Volume,
    /// The faces of its caps: toward the light, and away from it.
    Caps,
    /// Defects of the meshes.
    Defects,
    /// Handles of the lights.
    Lights,
}

impl Layer {
    /// All layers, in the order of the panel; the number of a layer is its key.
    pub(super) const ALL: [Self; 6] =
        [Self::Truth, Self::Silhouette, Self::Volume, Self::Caps, Self::Defects, Self::Lights];

    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Truth => "truth beside it",
            Self::Silhouette => "silhouette",
            Self::Volume => "shadow volume",
            Self::Caps => "caps",
            Self::Defects => "defects",
            Self::Lights => "handles of lights",
        }
    }
}

/// What is asked of the worker.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Request {
    /// Counts up.
    pub(super) number: u64,
    pub(super) camera: Camera,
    pub(super) quality: Quality,
    /// Of the picture to be made.
    pub(super) size: Size,
    pub(super) lamps: Vec<OwnLamp>,
    /// The lamp that layers and false colors are about.
    pub(super) chosen: usize,
    pub(super) mode: Mode,
    pub(super) layers: Vec<Layer>,
}

impl Request {
    pub(super) fn shows(&self, layer: Layer) -> bool {
        self.layers.contains(&layer)
    }

    /// Whether the truth has to be found.
    pub(super) fn needs_truth(&self) -> bool {
        self.shows(Layer::Truth) || self.mode == Mode::Difference
    }
}

/// What a drag that begins somewhere moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Grip {
    Lamp(usize),
    Divider,
    View,
}

/// Everything that a person can change.
#[derive(Clone, Debug)]
pub(super) struct State {
    pub(super) bounds: Aabb,
    pub(super) up: Up,
    pub(super) orbit: Orbit,
    pub(super) lamps: Vec<OwnLamp>,
    pub(super) chosen: usize,
    pub(super) mode: Mode,
    pub(super) layers: Vec<Layer>,
    /// Where the divider is, from 0 at the left edge to 1.
    pub(super) divider: f64,
    pub(super) pace: Pace,
    /// A flight: from, to, and when it began, in seconds.
    flight: Option<(Orbit, Orbit, f64)>,
    number: u64,
    /// What was asked last.
    asked: Option<Request>,
}

/// How near to a handle or to the divider a drag has to begin, in points.
const GRIP: f64 = 14.0;
/// The most pixels of a picture: 72 bytes a sample.
const MOST_PIXELS: f64 = 2_500_000.0;
/// Time of a flight, in seconds.
const FLIGHT: f64 = 0.5;
/// How far from the center of the scene handles are, in diagonals.
const REACH: f64 = 0.4;

impl State {
    pub(super) fn new(bounds: Aabb, up: Up, camera: &Camera, lamps: Vec<OwnLamp>) -> Self {
        Self {
            bounds,
            up,
            orbit: Orbit::of(camera, &bounds, up),
            lamps,
            chosen: 0,
            mode: Mode::Picture,
            layers: vec![Layer::Lights],
            divider: 0.5,
            pace: Pace::default(),
            flight: None,
            number: 0,
            asked: None,
        }
    }

    pub(super) fn shows(&self, layer: Layer) -> bool {
        self.layers.contains(&layer)
    }

    pub(super) fn toggle(&mut self, layer: Layer) {
        match self.layers.iter().position(|&other| other == layer) {
            Some(at) => drop(self.layers.remove(at)),
            None => self.layers.push(layer),
        }
    }

    /// The next technique of the chosen lamp, or the one before it: `auto`, and then all in their order.
    pub(super) fn step_technique(&mut self, forward: bool) {
        let Some(own) = self.lamps.get_mut(self.chosen) else { return };
        let count = Technique::ALL.len() + 1;
        let name = own.technique.map(Technique::name);
        let now = Technique::ALL.iter().position(|other| Some(other.name()) == name).map_or(0, |at| at + 1);
        let next = (now + if forward { 1 } else { count - 1 }) % count;
        own.technique = next.checked_sub(1).map(|at| Technique::ALL[at]);
    }

    /// The next lamp is chosen.
    pub(super) fn step_lamp(&mut self) {
        self.chosen = (self.chosen + 1) % self.lamps.len().max(1);
    }

    /// The view of the whole scene, from the side that it is looked at now.
    pub(super) fn fit(&mut self, now: f64) {
        let reach = 0.5 * orbit::size(&self.bounds);
        let mut there = self.orbit.flown_to(self.center().into(), reach, [0.0; 3], &self.bounds);
        there.zoom(1.2 * 2.0 * reach / there.height(), &self.bounds);
        self.flight = Some((self.orbit, there, now));
    }

    /// Begins a flight to something that reaches so far around a point and is seen along a normal.
    pub(super) fn fly(&mut self, target: [f64; 3], reach: f64, normal: [f64; 3], now: f64) {
        let there = self.orbit.flown_to(target, reach, normal, &self.bounds);
        self.flight = Some((self.orbit, there, now));
    }

    /// Takes the flight so far; whether it goes on.
    pub(super) fn advance(&mut self, now: f64) -> bool {
        let Some((from, to, began)) = self.flight else { return false };
        let part = (now - began) / FLIGHT;
        self.orbit = from.towards_other(&to, part);
        if part >= 1.0 {
            self.flight = None;
        }
        true
    }

    /// Ends a flight where it is.
    pub(super) fn land(&mut self) {
        self.flight = None;
    }

    fn center(&self) -> DVec3 {
        orbit::center(&self.bounds)
    }

    fn reach(&self) -> f64 {
        REACH * orbit::size(&self.bounds)
    }

    /// Where the handle of each lamp is in a picture, in points; at its border, where it is beyond.
    pub(super) fn handles(&self, camera: &Camera, size: Size) -> Vec<[f64; 2]> {
        let rays = camera.rays(size);
        let [width, height] = [size.width(), size.height()].map(f64::from);
        let within = |[x, y]: [f64; 2]| {
            let at = |x: f64, side: f64| x.clamp(GRIP.min(0.5 * side), (side - GRIP).max(0.5 * side));
            [at(x, width), at(y, height)]
        };
        let place = |own: &OwnLamp| {
            let at = handle::place(&own.lamp, self.center(), self.reach());
            match rays.project(at.as_vec3().into()) {
                Some(Projected { x_px, y_px, .. }) => within([x_px, y_px]),
                // Behind the eye: towards where it would come in.
                None => {
                    let [x, y] = self.orbit.screen_axes().map(|axis| (at - self.center()).dot(axis));
                    let long = x.hypot(y).max(f64::MIN_POSITIVE);
                    within([0.5 * width + width * x / long, 0.5 * height - width * y / long])
                }
            }
        };
        self.lamps.iter().map(place).collect()
    }

    /// What a drag moves that begins at a position of the picture.
    pub(super) fn grip(&self, at: [f64; 2], camera: &Camera, size: Size) -> Grip {
        if self.shows(Layer::Lights) {
            let apart = |[x, y]: &[f64; 2]| (x - at[0]).hypot(y - at[1]);
            let handles = self.handles(camera, size);
            let nearest = handles.iter().enumerate().min_by(|a, b| apart(a.1).total_cmp(&apart(b.1)));
            if let Some((index, handle)) = nearest
                && apart(handle) <= GRIP
            {
                return Grip::Lamp(index);
            }
        }
        let from_divider = (at[0] - self.divider * f64::from(size.width())).abs();
        match self.shows(Layer::Truth) && from_divider <= 0.5 * GRIP {
            true => Grip::Divider,
            false => Grip::View,
        }
    }

    /// Moves what was taken hold of by pixels to the right and down.
    pub(super) fn drag(&mut self, grip: Grip, [right, down]: [f64; 2], size: Size) {
        let height = f64::from(size.height());
        match grip {
            Grip::View => {
                self.land();
                self.orbit.turn([right / height, down / height]);
            }
            Grip::Divider => {
                self.divider = (self.divider + right / f64::from(size.width())).clamp(0.0, 1.0);
            }
            Grip::Lamp(index) => {
                let (center, reach) = (self.center(), self.reach());
                let Some(own) = self.lamps.get_mut(index) else { return };
                let away = handle::place(&own.lamp, center, reach) - center;
                let axes = self.orbit.screen_axes();
                let is_behind = away.dot(axes[0].cross(axes[1])) < 0.0;
                let radius_px = away.length() * height / self.orbit.height();
                let turn = handle::turn([right, -down], radius_px, axes, is_behind);
                own.lamp = handle::turned(&own.lamp, center, turn);
                self.chosen = index;
            }
        }
    }

    /// Moves the target with the pointer.
    pub(super) fn pan(&mut self, [right, down]: [f64; 2], size: Size) {
        self.land();
        self.orbit.pan([right, down].map(|px| px / f64::from(size.height())));
    }

    /// Comes nearer to the target, or moves a lamp nearer to the center.
    pub(super) fn zoom(&mut self, grip: Grip, factor: f64) {
        match grip {
            Grip::Lamp(index) => {
                let center = self.center();
                if let Some(own) = self.lamps.get_mut(index) {
                    own.lamp = handle::at_distance(&own.lamp, center, factor);
                    self.chosen = index;
                }
            }
            _ => {
                self.land();
                self.orbit.zoom(factor, &self.bounds);
            }
        }
    }

    /// Asks again for what was asked last: something that is drawn has changed elsewhere.
    pub(super) fn forget(&mut self) {
        self.asked = None;
    }

    pub(super) fn camera(&self, size: Size) -> Camera {
        self.orbit.camera(&self.bounds, size.aspect())
    }

    /// The camera, lamps and layers as they are now, in a picture of this size.
    fn wish(&self, pixels: Size, quality: Quality) -> Request {
        Request {
            number: self.number,
            camera: self.camera(pixels),
            quality,
            size: quality.size(fitted(pixels)),
            lamps: self.lamps.clone(),
            chosen: self.chosen.min(self.lamps.len().saturating_sub(1)),
            mode: self.mode,
            layers: self.layers.clone(),
        }
    }

    /// What to ask next, if anything: something has changed, or there is time for a finer picture of the
    /// same. `is_idle` says that the worker has answered what was asked last.
    pub(super) fn next(&mut self, pixels: Size, is_moving: bool, is_idle: bool) -> Option<Request> {
        let asked = self.asked.take();
        let same = |asked: &Request| {
            let wish = Request { number: asked.number, ..self.wish(pixels, asked.quality) };
            wish == *asked
        };
        let quality = match &asked {
            Some(asked) if same(asked) => {
                let finer = (is_idle && !is_moving).then(|| self.pace.finer(asked.quality, asked.size));
                match finer.flatten() {
                    Some(finer) => finer,
                    None => {
                        self.asked = Some(asked.clone());
                        return None;
                    }
                }
            }
            _ => self.pace.first(fitted(pixels)),
        };
        self.number += 1;
        let request = self.wish(pixels, quality);
        self.asked = Some(request.clone());
        Some(request)
    }
}

/// The size itself, or one of the same shape that fits the memory.
fn fitted(size: Size) -> Size {
    let scale = (MOST_PIXELS / size.pixels() as f64).sqrt().min(1.0);
    let side = |side: u32| ((f64::from(side) * scale) as u32).max(1);
    Size::new(side(size.width()), side(size.height())).unwrap_or(size)
}

#[cfg(test)]
mod tests {
    use super::*;

    const BOUNDS: Aabb = Aabb { low: [-1.0; 3], high: [1.0; 3] };

    fn size() -> Size {
        Size::new(600, 400).unwrap()
    }

    fn state(lamps: &[&str]) -> State {
        let own = |text: &&str| OwnLamp { lamp: text.parse().unwrap(), technique: None, is_on: true };
        let camera = Camera::fit(&BOUNDS, Up::Y, 1.5);
        State::new(BOUNDS, Up::Y, &camera, lamps.iter().map(own).collect())
    }

    #[test]
    fn every_handle_is_in_the_picture_and_can_be_taken_hold_of() {
        let texts = [
            "point:5,9,4",
            "point:0,0.5,0",
            "directional:0,-1,0",
            "directional:-1,0,-1",
            "rect:3,3,3:1,0,0:0,1,0",
            "point:300,200,400",
            "spot:-9,1,-9:1,0,1:30",
        ];
        for text in texts {
            let mut state = state(&[text]);
            for turn in 0..8 {
                state.drag(Grip::View, [97.0 * f64::from(turn), 13.0], size());
                state.orbit.zoom(0.8, &BOUNDS);
                let camera = state.camera(size());
                let [x, y] = state.handles(&camera, size())[0];
                assert!((0.0..600.0).contains(&x) && (0.0..400.0).contains(&y), "{text}: {x} {y}");
                assert_eq!(state.grip([x + 5.0, y - 5.0], &camera, size()), Grip::Lamp(0));
            }
        }
    }

    #[test]
    fn lamp_that_is_dragged_goes_with_the_pointer() {
        for text in ["point:3,9,4", "directional:0.2,-1,-0.3", "point:0.4,0.3,0.5", "point:-3,-9,-5"] {
            let mut state = state(&[text]);
            let camera = state.camera(size());
            let before = state.handles(&camera, size())[0];
            state.drag(Grip::Lamp(0), [6.0, -3.0], size());
            let after = state.handles(&camera, size())[0];
            // Perspective, and the roundness of the way: not exactly by the same.
            let moved = [after[0] - before[0], before[1] - after[1]];
            assert!((2.0..14.0).contains(&moved[0]) || before[0] >= 585.0, "{text}: {before:?} {moved:?}");
            assert!((0.0..9.0).contains(&moved[1]), "{text}: {before:?} {moved:?}");
        }
    }

    #[test]
    fn drag_moves_what_it_began_on() {
        let mut state = state(&["point:5,9,4"]);
        let camera = state.camera(size());
        assert_eq!(state.grip([300.0, 390.0], &camera, size()), Grip::View);
        state.toggle(Layer::Truth);
        assert_eq!(state.grip([302.0, 390.0], &camera, size()), Grip::Divider);
        let orbit = state.orbit;
        state.drag(Grip::Divider, [150.0, 70.0], size());
        assert_eq!((state.divider, state.orbit), (0.75, orbit));
        state.drag(Grip::Divider, [1e9, 0.0], size());
        assert_eq!(state.divider, 1.0);
        state.toggle(Layer::Lights);
        let [x, y] = state.handles(&camera, size())[0];
        assert_eq!(
            state.grip([x, y], &camera, size()),
            Grip::View,
            "handles that are not shown are not there"
        );
        let before = state.lamps.clone();
        state.drag(Grip::View, [5.0, 5.0], size());
        assert!(state.lamps == before && state.orbit != orbit);
    }

    #[test]
    fn wheel_over_a_lamp_moves_the_lamp_and_elsewhere_the_eye() {
        let mut state = state(&["point:0,8,0"]);
        let distance = state.orbit.distance;
        state.zoom(Grip::Lamp(0), 0.5);
        assert_eq!(
            (handle::numbers(&state.lamps[0].lamp), state.orbit.distance),
            ([0.0, 4.0, 0.0], distance)
        );
        state.zoom(Grip::View, 0.5);
        assert_eq!(state.orbit.distance, 0.5 * distance);
    }

    #[test]
    fn technique_steps_through_all_and_back_to_auto() {
        let mut state = state(&["point:0,8,0"]);
        let mut seen = Vec::new();
        for _ in 0..=Technique::ALL.len() {
            seen.push(state.lamps[0].technique);
            state.step_technique(true);
        }
        assert_eq!(state.lamps[0].technique, None);
        assert!(Technique::ALL.iter().all(|technique| seen.contains(&Some(*technique))));
        state.step_technique(false);
        assert_eq!(state.lamps[0].technique, Technique::ALL.last().copied());
        // Options are of no account for the order.
        state.lamps[0].technique = Some("samples:n=16".parse().unwrap());
        let samples = Technique::ALL.iter().position(|it| it.name() == "samples").unwrap();
        state.step_technique(true);
        assert_eq!(state.lamps[0].technique, Some(Technique::ALL[samples + 1]));
        state.lamps.clear();
        state.step_technique(true);
        state.step_lamp();
    }

    #[test]
    fn nothing_is_asked_twice_and_what_rests_becomes_finer() {
        let mut state = state(&["point:0,8,0"]);
        let first = state.next(size(), false, true).unwrap();
        assert!(first.size.pixels() < size().pixels(), "coarse at first: nothing is known of the time");
        assert_eq!(state.next(size(), false, false), None, "the worker is busy with it");
        state.pace.took(first.quality, first.size, 0.001);
        let finer = state.next(size(), false, true).unwrap();
        assert!(finer.number > first.number && finer.size.pixels() > first.size.pixels());
        assert_eq!((finer.camera, &finer.lamps), (first.camera, &first.lamps));
        // While something moves nothing is refined, and a change is asked at once.
        assert_eq!(state.next(size(), true, true), None);
        state.drag(Grip::Lamp(0), [5.0, 5.0], size());
        let moved = state.next(size(), true, false).unwrap();
        assert!(moved.lamps != first.lamps);
        // Each of the others is a change, too.
        for change in [
            (|state: &mut State| state.toggle(Layer::Caps)) as fn(&mut State),
            |state| state.mode = Mode::Grid,
            |state| state.step_technique(true),
            |state| state.orbit.pan([0.1, 0.0]),
        ] {
            change(&mut state);
            assert!(state.next(size(), false, false).is_some());
        }
        assert!(state.next(Size::new(601, 400).unwrap(), false, false).is_some());
        // The divider and the number of the request are of the window alone.
        state.divider = 0.2;
        assert_eq!(state.next(Size::new(601, 400).unwrap(), false, false), None);
    }

    #[test]
    fn refinement_ends() {
        let mut state = state(&["point:0,8,0"]);
        let mut asked = 0;
        while let Some(request) = state.next(size(), false, true) {
            state.pace.took(request.quality, request.size, 1e-4);
            asked += 1;
            assert!(asked < 10);
        }
        assert!(asked >= 2);
    }

    #[test]
    fn flight_ends_at_its_goal_and_a_drag_lands_it() {
        let mut state = state(&[]);
        state.fly([1.0, 1.0, 1.0], 0.1, [0.0, 1.0, 0.0], 10.0);
        assert!(state.advance(10.1) && state.orbit.target != DVec3::ONE);
        assert!(state.advance(11.0) && state.orbit.target == DVec3::ONE);
        assert!(!state.advance(12.0));
        state.fit(20.0);
        state.drag(Grip::View, [1.0, 0.0], size());
        assert!(!state.advance(20.1));
    }

    #[test]
    fn picture_that_is_too_large_is_made_smaller_in_the_same_shape() {
        let huge = Size::new(16384, 8192).unwrap();
        let smaller = fitted(huge);
        assert!(smaller.pixels() <= MOST_PIXELS as usize);
        assert!((smaller.aspect() - 2.0).abs() < 0.01);
        assert_eq!(fitted(size()), size());
    }
}
