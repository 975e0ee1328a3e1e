//! The window: events in, pictures and panels out.

use std::path::PathBuf;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use eframe::egui;
use egui::{ColorImage, Key, Modifiers, TextureHandle, TextureOptions};
use umbrage::render::Picture;
use umbrage::shadow::Technique;
use umbrage::view::Size;

use super::defects::Defects;
use super::frame::{Answer, ONCE, Plan};
use super::state::{Grip, Layer, Mode, OwnLamp, State};
use super::worker::{Facts, News, Worker};
use crate::cli::{Failure, output};

/// What came out of the window, for who opened it.
pub(super) type Outcome = Arc<Mutex<Option<Failure>>>;

pub(super) struct App {
    pub(super) worker: Worker,
    pub(super) state: State,
    pub(super) facts: Facts,
    pub(super) answer: Option<Answer>,
    pub(super) picture: Option<TextureHandle>,
    pub(super) truth: Option<TextureHandle>,
    pub(super) plan: Option<Plan>,
    pub(super) defects: Arc<OnceLock<Defects>>,
    /// The row of the list that was flown to last.
    pub(super) defect: Option<usize>,
    /// What could not be done.
    pub(super) failure: Option<String>,
    /// The text of the chosen lamp's technique while it is edited, and what is wrong about it.
    pub(super) technique_text: Option<(String, Option<String>)>,
    /// What is held, and where the pointer was.
    pub(super) held: Option<(Grip, egui::Pos2)>,
    pub(super) shows_help: bool,
    pub(super) is_moving: bool,
    /// The technique of lamps that are added, and of those of a file that is dropped.
    technique: Vec<Option<Technique>>,
    /// The number of the last picture that was drawn or failed, and of the last one asked for.
    answered: u64,
    asked: u64,
    moved: f64,
    screenshot: Screenshot,
    outcome: Outcome,
}

/// The picture of the window that ends it.
struct Screenshot {
    path: Option<PathBuf>,
    is_asked: bool,
    taken: Arc<Mutex<Option<Arc<ColorImage>>>>,
}

/// Seconds without a change after which something rests.
const REST: f64 = 0.15;

/// What the command line asks for.
pub(super) struct Wishes {
    pub(super) layers: Vec<Layer>,
    pub(super) mode: Mode,
    pub(super) techniques: Vec<Option<Technique>>,
    pub(super) screenshot: Option<PathBuf>,
}

impl App {
    pub(super) fn new(worker: Worker, facts: Facts, wishes: Wishes, outcome: Outcome) -> Self {
        let mut state = state_of(&facts, &wishes.techniques);
        (state.layers, state.mode) = (wishes.layers, wishes.mode);
        let screenshot = Screenshot { path: wishes.screenshot, is_asked: false, taken: Arc::default() };
        Self {
            worker,
            state,
            facts,
            answer: None,
            picture: None,
            truth: None,
            plan: None,
            defects: Arc::default(),
            defect: None,
            failure: None,
            technique_text: None,
            held: None,
            shows_help: false,
            is_moving: false,
            technique: wishes.techniques,
            answered: 0,
            asked: 0,
            moved: 0.0,
            screenshot,
            outcome,
        }
    }

    /// Whether a picture is being made.
    pub(super) fn is_busy(&self) -> bool {
        self.answered != self.asked
    }

    fn hear(&mut self, ctx: &egui::Context) {
        for news in self.worker.news() {
            match news {
                News::Opened(facts) => {
                    let (layers, mode) = (std::mem::take(&mut self.state.layers), self.state.mode);
                    self.state = state_of(&facts, &self.technique);
                    (self.state.layers, self.state.mode) = (layers, mode);
                    self.facts = *facts;
                    (self.answer, self.plan, self.defect, self.failure) = (None, None, None, None);
                    self.defects = Arc::default();
                    (self.answered, self.asked) = (0, 0);
                    self.technique_text = None;
                    ctx.send_viewport_cmd(egui::ViewportCommand::Title(title(&self.facts)));
                }
                News::Drawn(answer) => self.show(ctx, *answer),
                News::Defects(defects) => {
                    self.defects = defects;
                    if self.state.shows(Layer::Defects) {
                        self.state.forget();
                    }
                }
                News::Failed(number, line) => {
                    self.failure = Some(line);
                    match number {
                        Some(number) => self.answered = self.answered.max(number),
                        None => {
                            self.state.forget();
                            self.answered = self.asked;
                        }
                    }
                }
            }
        }
        if self.worker.has_ended() && self.failure.is_none() {
            self.failure = Some("the drawing thread has ended; see what it said in the terminal".to_owned());
        }
    }

    fn show(&mut self, ctx: &egui::Context, mut answer: Answer) {
        let request = &answer.request;
        let ms: f64 = answer.stages.iter().filter(|(name, _)| name != ONCE).map(|(_, ms)| ms).sum();
        self.state.pace.took(request.quality, request.size, ms / 1e3);
        self.answered = self.answered.max(request.number);
        load(ctx, &mut self.picture, "picture", &answer.picture);
        match &answer.truth {
            Some(truth) => load(ctx, &mut self.truth, "truth", truth),
            None => self.truth = None,
        }
        if let Some(plan) = answer.plan.take() {
            self.plan = Some(plan);
        }
        self.failure = None;
        self.answer = Some(answer);
    }

    /// Notes that something was moved, so that pictures are prompt until it rests.
    pub(super) fn touch(&mut self, ctx: &egui::Context) {
        self.moved = ctx.input(|input| input.time);
    }

    /// Asks for a picture of this size, if there is anything new to draw.
    pub(super) fn ask(&mut self, ctx: &egui::Context, pixels: Size) {
        let (now, is_down) = ctx.input(|input| (input.time, input.pointer.any_down()));
        let is_flying = self.state.advance(now);
        self.is_moving = is_flying || (is_down && self.held.is_some()) || now - self.moved < REST;
        if let Some(request) = self.state.next(pixels, self.is_moving, !self.is_busy()) {
            self.asked = request.number;
            self.worker.draw(request);
        }
        if is_flying {
            ctx.request_repaint();
        } else if self.is_moving {
            ctx.request_repaint_after(std::time::Duration::from_secs_f64(REST));
        }
    }

    /// Whether nothing is being made that would change what is seen.
    fn is_at_rest(&self) -> bool {
        let has_defects = self.defects.get().is_some();
        !self.is_busy() && !self.is_moving && self.answer.is_some() && has_defects
    }

    /// Takes the screenshot that was asked for once all is drawn, and ends.
    fn take_screenshot(&mut self, ctx: &egui::Context) {
        let Some(path) = &self.screenshot.path else { return };
        let taken = self.screenshot.taken.lock().unwrap_or_else(PoisonError::into_inner).take();
        if let Some(image) = taken {
            let [width, height] = image.size;
            let saved = Size::new(width as u32, height as u32)
                .map_err(|error| Failure::new(error, "choose another --size"))
                .and_then(|size| {
                    let pixels = image.pixels.iter().map(|pixel| pixel.to_array()).collect();
                    Picture { size, pixels }.write_png(path).map_err(Failure::from)
                });
            match saved {
                Ok(()) => output::wrote(path),
                Err(failure) => {
                    *self.outcome.lock().unwrap_or_else(PoisonError::into_inner) = Some(failure);
                }
            }
            self.screenshot.path = None;
            ctx.send_viewport_cmd(egui::ViewportCommand::Close);
        } else if !self.screenshot.is_asked && (self.is_at_rest() || self.failure.is_some()) {
            self.screenshot.is_asked = true;
            let (taken, waiting) = (self.screenshot.taken.clone(), ctx.clone());
            ctx.request_screenshot(move |image| {
                *taken.lock().unwrap_or_else(PoisonError::into_inner) = Some(image);
                waiting.request_repaint();
            });
        }
    }

    fn keys(&mut self, ctx: &egui::Context) {
        if ctx.input(|input| input.key_pressed(Key::Escape)) {
            self.shows_help = false;
        }
        if ctx.egui_wants_keyboard_input() {
            return;
        }
        let pressed = |key| ctx.input(|input| input.key_pressed(key));
        let shift = ctx.input(|input| input.modifiers.contains(Modifiers::SHIFT));
        let now = ctx.input(|input| input.time);
        let digits = [Key::Num1, Key::Num2, Key::Num3, Key::Num4, Key::Num5, Key::Num6];
        for (key, layer) in digits.into_iter().zip(Layer::ALL) {
            if pressed(key) {
                self.state.toggle(layer);
            }
        }
        if pressed(Key::T) {
            self.state.step_technique(!shift);
            self.technique_text = None;
        }
        if pressed(Key::L) {
            self.state.step_lamp();
            self.technique_text = None;
        }
        if pressed(Key::M) {
            self.state.mode = match self.state.mode {
                Mode::Picture => Mode::Difference,
                Mode::Difference => Mode::Grid,
                Mode::Grid => Mode::Picture,
            };
        }
        if pressed(Key::F) {
            self.state.fit(now);
        }
        if pressed(Key::N) {
            self.step_defect(!shift, now);
        }
        if pressed(Key::Questionmark) || pressed(Key::F1) {
            self.shows_help = !self.shows_help;
        }
        if pressed(Key::Q) {
            ctx.send_viewport_cmd(egui::ViewportCommand::Close);
        }
        let arrows = [Key::ArrowLeft, Key::ArrowRight, Key::ArrowUp, Key::ArrowDown].map(pressed);
        let [left, right, up, down] = arrows.map(|is_pressed| f64::from(u8::from(is_pressed)) / 24.0);
        if arrows.contains(&true) {
            self.state.land();
            self.state.orbit.turn([right - left, down - up]);
            self.touch(ctx);
        }
        for (keys, factor) in [([Key::Plus, Key::Equals], 0.9), ([Key::Minus, Key::Minus], 1.0 / 0.9)] {
            if keys.into_iter().any(pressed) {
                self.state.zoom(Grip::View, factor);
                self.touch(ctx);
            }
        }
    }

    /// Flies to the next defect of the list, or to the one before.
    fn step_defect(&mut self, forward: bool, now: f64) {
        let count = self.defects.get().map_or(0, |defects| defects.rows.len());
        if count > 0 {
            let step = if forward { 1 } else { count - 1 };
            let next = self.defect.map_or(if forward { 0 } else { count - 1 }, |at| (at + step) % count);
            self.fly_to(next, now);
        }
    }

    pub(super) fn fly_to(&mut self, index: usize, now: f64) {
        let Some(row) = self.defects.get().and_then(|defects| defects.rows.get(index).copied()) else {
            return;
        };
        self.defect = Some(index);
        if !self.state.shows(Layer::Defects) {
            self.state.toggle(Layer::Defects);
        }
        self.state.fly(row.target, row.reach, row.normal, now);
    }

    fn dropped(&mut self, ctx: &egui::Context) {
        let files = ctx.input(|input| {
            input.raw.dropped_files.iter().map(|file| file.path().to_owned()).collect::<Vec<PathBuf>>()
        });
        if let Some(file) = files.into_iter().next() {
            self.failure = None;
            self.worker.open(file);
        }
    }
}

impl eframe::App for App {
    fn ui(&mut self, ui: &mut egui::Ui, _: &mut eframe::Frame) {
        let ctx = ui.ctx().clone();
        self.hear(&ctx);
        self.dropped(&ctx);
        self.keys(&ctx);
        self.panels(ui);
        self.canvas(ui);
        self.help(&ctx);
        self.take_screenshot(&ctx);
    }

    fn on_exit(&mut self) {
        self.worker.stop();
    }
}

/// The title of the window.
pub(super) fn title(facts: &Facts) -> String {
    format!("{} – umbrage", output::plain(&facts.file.to_string_lossy()))
}

fn state_of(facts: &Facts, techniques: &[Option<Technique>]) -> State {
    let technique = |index: usize| techniques.get(index).or(techniques.last()).copied().flatten();
    let own = |(index, lamp): (usize, &umbrage::scene::Lamp)| OwnLamp {
        lamp: lamp.clone(),
        technique: technique(index),
        is_on: true,
    };
    State::new(facts.bounds, facts.up, &facts.camera, facts.lamps.iter().enumerate().map(own).collect())
}

/// Puts a picture into a texture.
fn load(ctx: &egui::Context, texture: &mut Option<TextureHandle>, name: &str, picture: &Picture) {
    let size = [picture.size.width(), picture.size.height()].map(|side| side as usize);
    let image = ColorImage::from_rgba_unmultiplied(size, picture.pixels.as_flattened());
    match texture {
        Some(texture) => texture.set(image, TextureOptions::LINEAR),
        None => *texture = Some(ctx.load_texture(name, image, TextureOptions::LINEAR)),
    }
}
