//! The picture with what lies over it: divider, lines, handles.

use eframe::egui;
use egui::{Align2, Color32, FontId, Mesh, PointerButton, Pos2, Rect, Sense, Shape, Vec2, pos2, vec2};
use umbrage::view::Size;

use super::app::App;
use super::state::{Grip, Layer, Mode};
use super::strokes::Stroke;

const HANDLE: Color32 = Color32::from_rgb(255, 214, 70);
const RIM: Color32 = Color32::from_rgb(30, 30, 30);
const PLATE: Color32 = Color32::from_rgba_unmultiplied_const(20, 22, 26, 235);

/// Width of lines, half of the width in which they fade, and radius of spots, in points.
const LINE: f32 = 1.6;
const FEATHER: f32 = 0.5;
const SPOT: f32 = 4.5;
/// Opacity of what is hidden.
const HIDDEN: f32 = 0.35;
/// How far below the upper edge the sides of the divider are named, in points: handles may be above.
const PLATES: f32 = 40.0;
/// Factor of the distance for a point of the wheel.
const WHEEL: f64 = 0.998;

impl App {
    pub(super) fn canvas(&mut self, ui: &mut egui::Ui) {
        egui::CentralPanel::default().frame(egui::Frame::NONE).show(ui, |ui| {
            let rect = ui.available_rect_before_wrap();
            let response = ui.allocate_rect(rect, Sense::click_and_drag());
            // What is laid out is known from the first frame on; a picture has a pixel at least.
            let points = sized(rect.size());
            let ctx = ui.ctx().clone();
            self.point(&ctx, &response, rect, points);
            self.ask(&ctx, sized(rect.size() * ctx.pixels_per_point()));
            self.paint(&ui.painter_at(rect), rect, points);
        });
    }

    /// Heeds the pointer.
    fn point(&mut self, ctx: &egui::Context, response: &egui::Response, rect: Rect, points: Size) {
        let camera = self.state.camera(points);
        let local = |at: Pos2| [at.x - rect.left(), at.y - rect.top()].map(f64::from);
        let grip_at = |app: &Self, at: Pos2| app.state.grip(local(at), &camera, points);
        if response.drag_started() {
            // Where the button went down, not where the drag was recognized.
            let origin = ctx.input(|input| input.pointer.press_origin());
            self.held = origin.map(|at| (grip_at(self, at), at));
        }
        // By positions: what moves between the last frame and the release is a part of the drag, too.
        let at = ctx.input(|input| input.pointer.latest_pos());
        if let (Some((grip, from)), Some(at)) = (self.held, at)
            && at != from
        {
            let drag = [at.x - from.x, at.y - from.y].map(f64::from);
            let is_primary = response.dragged_by(PointerButton::Primary)
                || response.drag_stopped_by(PointerButton::Primary);
            let shift = ctx.input(|input| input.modifiers.shift);
            match grip {
                Grip::View if shift || !is_primary => self.state.pan(drag, points),
                grip => self.state.drag(grip, drag, points),
            }
            self.held = Some((grip, at));
            self.technique_text = None;
            self.touch(ctx);
        }
        if !response.dragged() {
            self.held = None;
        }
        if let Some(at) = response.hover_pos() {
            let grip = grip_at(self, at);
            let wheel = ctx.input(|input| input.smooth_scroll_delta().y);
            if wheel != 0.0 {
                self.state.zoom(grip, WHEEL.powf(wheel.into()));
                self.touch(ctx);
            }
            ctx.set_cursor_icon(match self.held.map_or(grip, |held| held.0) {
                Grip::Lamp(_) => egui::CursorIcon::Grab,
                Grip::Divider => egui::CursorIcon::ResizeHorizontal,
                Grip::View => egui::CursorIcon::Default,
            });
        }
        if response.clicked()
            && let Some(at) = response.interact_pointer_pos()
            && let Grip::Lamp(lamp) = grip_at(self, at)
        {
            self.state.chosen = lamp;
            self.technique_text = None;
        }
        if response.double_clicked() {
            self.state.fit(ctx.input(|input| input.time));
        }
    }

    fn paint(&self, painter: &egui::Painter, rect: Rect, points: Size) {
        let whole = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
        painter.rect_filled(rect, 0.0, Color32::from_rgb(130, 138, 150));
        let Some(picture) = &self.picture else {
            painter.text(rect.center(), Align2::CENTER_CENTER, "drawing …", FontId::proportional(18.0), RIM);
            return;
        };
        painter.image(picture.id(), rect, whole, Color32::WHITE);
        let split = self.truth.as_ref().filter(|_| self.state.shows(Layer::Truth));
        let divider = self.state.divider as f32;
        if let Some(truth) = split {
            let left =
                Rect::from_min_max(rect.min, pos2(rect.left() + divider * rect.width(), rect.bottom()));
            let part = Rect::from_min_max(pos2(0.0, 0.0), pos2(divider, 1.0));
            painter.image(truth.id(), left, part, Color32::WHITE);
        }
        if let Some(answer) = &self.answer {
            painter.add(Shape::mesh(strokes(&answer.strokes, rect)));
            for spot in &answer.spots {
                let at = rect.lerp_inside(Vec2::from(spot.ends[0]));
                let [r, g, b] = spot.color;
                let opacity = if spot.is_hidden { HIDDEN } else { 1.0 };
                painter.circle(
                    at,
                    SPOT,
                    Color32::from_rgb(r, g, b).gamma_multiply(opacity),
                    (1.0, RIM.gamma_multiply(opacity)),
                );
            }
        }
        if split.is_some() {
            self.divider(painter, rect, rect.left() + divider * rect.width());
        }
        if self.state.shows(Layer::Lights) {
            self.handles(painter, rect, points);
        }
        let legend = self.answer.as_ref().and_then(|answer| answer.legend.as_ref());
        if let Some(legend) = legend {
            plate(
                painter,
                rect.left_bottom() + vec2(12.0, -12.0),
                Align2::LEFT_BOTTOM,
                legend,
                rect.width() - 48.0,
            );
        }
    }

    /// The line between truth and technique, and what is on its sides.
    fn divider(&self, painter: &egui::Painter, rect: Rect, x: f32) {
        let [top, bottom] = [pos2(x, rect.top()), pos2(x, rect.bottom())];
        painter.line_segment([top, bottom], (4.0, RIM.gamma_multiply(0.6)));
        painter.line_segment([top, bottom], (1.5, Color32::WHITE));
        let knob = pos2(x, rect.center().y);
        painter.circle(knob, 9.0, Color32::WHITE, (1.5, RIM));
        for (side, tip) in [(-1.0, -6.0), (1.0, 6.0)] {
            let points = [vec2(tip, 0.0), vec2(side * 2.0, -3.5), vec2(side * 2.0, 3.5)].map(|at| knob + at);
            painter.add(Shape::convex_polygon(points.to_vec(), RIM, egui::Stroke::NONE));
        }
        let right = match self.state.mode {
            Mode::Picture => self.technique_words(),
            Mode::Difference => format!("difference of {}", self.technique_words()),
            Mode::Grid => "light grid".to_owned(),
        };
        plate(painter, top + vec2(-16.0, PLATES), Align2::RIGHT_TOP, "truth", f32::INFINITY);
        plate(painter, top + vec2(16.0, PLATES), Align2::LEFT_TOP, &right, f32::INFINITY);
    }

    /// The techniques of the lamps that are on.
    fn technique_words(&self) -> String {
        let lamps = self.answer.as_ref().map_or(&[][..], |answer| &answer.lamps);
        let chosen = lamps.iter().find(|shown| shown.lamp == self.state.chosen);
        match (chosen, lamps.len()) {
            (Some(shown), 1) => shown.technique.clone(),
            (Some(shown), _) => format!("light {}: {}", shown.lamp + 1, shown.technique),
            (None, _) => "no light".to_owned(),
        }
    }

    fn handles(&self, painter: &egui::Painter, rect: Rect, points: Size) {
        let camera = self.state.camera(points);
        for (index, [x, y]) in self.state.handles(&camera, points).into_iter().enumerate() {
            let at = rect.min + vec2(x as f32, y as f32);
            let own = &self.state.lamps[index];
            let is_chosen = index == self.state.chosen;
            let fill = if own.is_on { HANDLE } else { Color32::from_gray(150) };
            if is_chosen {
                painter.circle_stroke(at, 13.0, (3.5, RIM.gamma_multiply(0.7)));
                painter.circle_stroke(at, 13.0, (2.0, Color32::WHITE));
            }
            painter.circle(at, 9.0, fill, (1.5, RIM));
            let number = (index + 1).to_string();
            painter.text(at, Align2::CENTER_CENTER, number, FontId::proportional(12.0), RIM);
        }
    }
}

/// A size of whole units, one at least.
fn sized(size: Vec2) -> Size {
    let side = |side: f32| (side.round() as u32).clamp(1, Size::MOST);
    Size::new(side(size.x), side(size.y)).expect("both sides are in range")
}

/// Text on a dark plate, whatever lies behind.
fn plate(painter: &egui::Painter, at: Pos2, anchor: Align2, text: &str, width: f32) {
    let font = FontId::proportional(14.0);
    let galley = painter.layout(text.to_owned(), font, Color32::from_gray(240), width.max(80.0));
    let rect = anchor.anchor_size(at, galley.size());
    painter.rect_filled(rect.expand2(vec2(8.0, 4.0)), 4.0, PLATE);
    painter.galley(rect.min, galley, Color32::WHITE);
}

/// Lines as one mesh: thousands of shapes would take longer than the picture.
fn strokes(strokes: &[Stroke], rect: Rect) -> Mesh {
    let mut mesh = Mesh::default();
    mesh.reserve_vertices(8 * strokes.len());
    mesh.reserve_triangles(6 * strokes.len());
    // What is hidden first: what is seen lies over it.
    for hidden in [true, false] {
        for stroke in strokes.iter().filter(|stroke| stroke.is_hidden == hidden) {
            let [a, b] = stroke.ends.map(|end| rect.lerp_inside(Vec2::from(end)));
            let along = (b - a).normalized();
            let aside = vec2(-along.y, along.x);
            let [red, green, blue] = stroke.color;
            let opacity = if hidden { HIDDEN } else { 1.0 };
            let color = Color32::from_rgb(red, green, blue).gamma_multiply(opacity);
            // Four lines beside each other: the outer ones are clear, so that edges are smooth.
            let first = mesh.vertices.len() as u32;
            let outer = 0.5 * LINE + FEATHER;
            for (reach, color) in [
                (outer, Color32::TRANSPARENT),
                (0.5 * LINE - FEATHER, color),
                (FEATHER - 0.5 * LINE, color),
                (-outer, Color32::TRANSPARENT),
            ] {
                mesh.colored_vertex(a + reach * aside, color);
                mesh.colored_vertex(b + reach * aside, color);
            }
            for strip in (first..first + 6).step_by(2) {
                mesh.add_triangle(strip, strip + 1, strip + 3);
                mesh.add_triangle(strip, strip + 3, strip + 2);
            }
        }
    }
    mesh
}
