//! The panels: lights, layers, plan, defects, times; the line of the state; the help.

use eframe::egui;
use egui::{Align, Color32, Layout, RichText, ScrollArea};
use umbrage::check::DefectKind;
use umbrage::glam::DQuat;
use umbrage::shadow::Technique;
use umbrage::verify::errors::Errors;
use umbrage::view::Size;

use super::app::App;
use super::frame::{Shown, label};
use super::handle;
use super::state::{Layer, Mode, OwnLamp};
use crate::cli::check::defect_color;
use crate::cli::output;

/// Width of the panel, and height of the line of the state, in points.
const WIDTH: f32 = 340.0;
const LINE: f32 = 25.0;

/// The size that a window leaves for the picture.
pub(super) fn beside(window: Size) -> Size {
    let side = |side: u32, panel: f32| side.saturating_sub(panel as u32).max(1);
    Size::new(side(window.width(), WIDTH), side(window.height(), LINE)).unwrap_or(window)
}

/// How much a number of a lamp changes for each point of a drag, in diagonals of the scene.
const STEP: f64 = 0.002;

/// Keys and what they do.
const KEYS: [(&str, &str); 12] = [
    ("drag", "turn the view; on a light or the divider: move it"),
    ("right drag, Shift + drag", "move the view"),
    ("wheel, + and −", "come nearer; the wheel over a light moves the light"),
    ("arrows", "turn the view"),
    ("1 to 6", "layers: truth, silhouette, volume, caps, defects, handles"),
    ("M", "picture, difference to the truth, light grid"),
    ("L", "next light"),
    ("T, Shift + T", "next technique of the light, and the one before"),
    ("N, Shift + N", "fly to the next defect, and to the one before"),
    ("F, double click", "show everything"),
    ("drop a file", "open it"),
    ("Q", "close the window"),
];

impl App {
    pub(super) fn panels(&mut self, ui: &mut egui::Ui) {
        egui::Panel::bottom("state").show(ui, |ui| {
            ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                if ui.button("? Help").clicked() {
                    self.shows_help = !self.shows_help;
                }
                ui.with_layout(Layout::left_to_right(Align::Center), |ui| {
                    ui.add_space(4.0);
                    ui.add(egui::Label::new(self.words()).truncate());
                });
            });
        });
        egui::Panel::right("panel").resizable(false).exact_size(WIDTH).show(ui, |ui| {
            ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
                ui.add_space(4.0);
                ui.set_max_width(WIDTH - 28.0);
                self.lamps(ui);
                self.layers(ui);
                self.plan(ui);
                self.list(ui);
                self.times(ui);
            });
        });
    }

    /// What is seen, and what is going on.
    fn words(&self) -> RichText {
        if let Some(failure) = &self.failure {
            return RichText::new(failure).color(Color32::from_rgb(220, 60, 50));
        }
        let file = self.facts.file.file_name().unwrap_or(self.facts.file.as_os_str()).to_string_lossy();
        let mut words = format!("{}: {} faces", output::plain(&file), spaced(self.facts.faces as u64));
        if let Some(answer) = &self.answer {
            let ms: f64 = answer.stages.iter().map(|(_, ms)| ms).sum();
            let samples = match answer.request.quality.per_side() {
                1 => String::new(),
                n => format!(", {} samples a pixel", n * n),
            };
            words += &format!("   ·   {}{samples} in {ms:.0} ms", answer.request.size);
        }
        if self.is_busy() {
            words += "   ·   drawing …";
        } else if self.defects.get().is_none() {
            words += "   ·   looking for defects …";
        }
        RichText::new(words)
    }

    fn lamps(&mut self, ui: &mut egui::Ui) {
        heading(ui, "Lights");
        for index in 0..self.state.lamps.len() {
            ui.horizontal(|ui| {
                ui.checkbox(&mut self.state.lamps[index].is_on, "");
                let own = &self.state.lamps[index];
                let is_chosen = index == self.state.chosen;
                let name = format!("{}  {}", index + 1, label(own));
                let name = egui::Button::selectable(is_chosen, name).truncate();
                if ui.add(name).clicked() {
                    self.state.chosen = index;
                    self.technique_text = None;
                }
            });
        }
        let chosen = self.state.chosen;
        if chosen < self.state.lamps.len() {
            self.technique(ui, chosen);
            let size = super::orbit::size(&self.state.bounds);
            numbers(ui, &mut self.state.lamps[chosen], size);
        }
        ui.horizontal(|ui| {
            if ui.button("Add a light").clicked() {
                let own = self.state.lamps.get(chosen).cloned();
                let lamp = own.map_or_else(|| self.facts.lamps.first().cloned(), |own| Some(own.lamp));
                if let Some(lamp) = lamp {
                    let around = super::orbit::center(&self.state.bounds);
                    let up = self.state.up.turn([0.0, 1.0, 0.0]).into();
                    let turn = DQuat::from_axis_angle(up, 1.5);
                    let lamp = handle::turned(&lamp, around, turn);
                    let technique = self.state.lamps.get(chosen).and_then(|own| own.technique);
                    self.state.lamps.push(OwnLamp { lamp, technique, is_on: true });
                    self.state.chosen = self.state.lamps.len() - 1;
                    self.technique_text = None;
                }
            }
            let some = !self.state.lamps.is_empty();
            if ui.add_enabled(some, egui::Button::new("Remove it")).clicked() {
                self.state.lamps.remove(chosen);
                self.state.chosen = chosen.min(self.state.lamps.len().saturating_sub(1));
                self.technique_text = None;
            }
        });
        let answer = self.answer.as_ref();
        for shown in answer.iter().flat_map(|answer| &answer.lamps) {
            if let Some(errors) = &shown.errors {
                ui.add_space(4.0);
                figures(ui, shown, errors);
            }
        }
    }

    /// The technique of a lamp: from a list, and as text with options.
    fn technique(&mut self, ui: &mut egui::Ui, chosen: usize) {
        let now = self.state.lamps[chosen].technique;
        ui.horizontal(|ui| {
            ui.label("Shadow by");
            let name = now.map_or("auto", Technique::name);
            egui::ComboBox::from_id_salt("technique").selected_text(name).width(130.0).height(420.0).show_ui(
                ui,
                |ui| {
                    let mut pick = None;
                    let auto = "auto: the planner's choice";
                    if ui.selectable_label(now.is_none(), auto).clicked() {
                        pick = Some(None);
                    }
                    for technique in Technique::ALL {
                        let is_it = now.is_some_and(|now| now.name() == technique.name());
                        if ui.selectable_label(is_it, technique.name()).clicked() {
                            pick = Some(Some(technique));
                        }
                    }
                    if let Some(pick) = pick {
                        self.state.lamps[chosen].technique = pick;
                        self.technique_text = None;
                    }
                },
            );
            for (sign, forward, words) in [("<", false, "the one before"), (">", true, "the next one")] {
                if ui.button(sign).on_hover_text(words).clicked() {
                    self.state.step_technique(forward);
                    self.technique_text = None;
                }
            }
        });
        let Some(technique) = self.state.lamps[chosen].technique else { return };
        if technique.parameters().is_empty() {
            return;
        }
        let (text, wrong) = self.technique_text.get_or_insert_with(|| (technique.to_string(), None));
        let field = egui::TextEdit::singleline(text).desired_width(f32::INFINITY);
        if ui.add(field).on_hover_text("options of the technique; Enter takes them").lost_focus() {
            match text.parse::<Technique>() {
                Ok(technique) => {
                    self.state.lamps[chosen].technique = Some(technique);
                    self.technique_text = None;
                }
                Err(error) => *wrong = Some(error.to_string()),
            }
        }
        if let Some((_, Some(wrong))) = &self.technique_text {
            ui.colored_label(ui.visuals().error_fg_color, wrong);
        }
    }

    fn layers(&mut self, ui: &mut egui::Ui) {
        heading(ui, "Show");
        ui.horizontal(|ui| {
            for (mode, name) in
                [(Mode::Picture, "picture"), (Mode::Difference, "difference"), (Mode::Grid, "light grid")]
            {
                ui.radio_value(&mut self.state.mode, mode, name);
            }
        });
        egui::Grid::new("layers").num_columns(2).spacing([24.0, 4.0]).show(ui, |ui| {
            for (index, layer) in Layer::ALL.into_iter().enumerate() {
                let mut is_shown = self.state.shows(layer);
                if ui.checkbox(&mut is_shown, format!("{}  {}", index + 1, layer.name())).changed() {
                    self.state.toggle(layer);
                }
                if index % 2 == 1 {
                    ui.end_row();
                }
            }
        });
        let silhouette = self.state.shows(Layer::Silhouette);
        let caps = self.state.shows(Layer::Caps);
        if silhouette || caps || self.state.shows(Layer::Volume) {
            let keys = [
                (silhouette, super::strokes::SILHOUETTE, "silhouette edges"),
                (self.state.shows(Layer::Volume), super::strokes::VOLUME, "edges of the volume"),
                (caps, super::colors::LIGHT_CAP, "toward the light"),
                (caps, super::colors::DARK_CAP, "away from it"),
            ];
            egui::Grid::new("colors").num_columns(4).min_col_width(0.0).spacing([8.0, 2.0]).show(ui, |ui| {
                let shown = keys.into_iter().filter(|(is_shown, ..)| *is_shown);
                for (index, (_, color, words)) in shown.enumerate() {
                    swatch(ui, color);
                    ui.label(RichText::new(words).small());
                    if index % 2 == 1 {
                        ui.end_row();
                    }
                }
            });
        }
    }

    fn plan(&self, ui: &mut egui::Ui) {
        heading(ui, "The planner's choice");
        let Some(plan) = &self.plan else {
            ui.weak("comes with the first fine picture that shows a surface");
            return;
        };
        for row in &plan.rows {
            let name = format!("light {}: {}", row.lamp + 1, row.technique);
            ui.label(RichText::new(name).strong());
            ui.label(&row.reason);
            let title = format!("{} techniques not chosen", row.rejected.len());
            egui::CollapsingHeader::new(title).id_salt((row.lamp, &row.technique)).show(ui, |ui| {
                for (technique, why) in &row.rejected {
                    ui.label(RichText::new(technique).strong());
                    ui.label(why);
                }
            });
        }
        ui.weak(format!(
            "for an exact picture in the least time on the CPU; planned in {:.1} ms",
            plan.planning_ms
        ));
    }

    fn list(&mut self, ui: &mut egui::Ui) {
        heading(ui, "Defects");
        let defects = self.defects.clone();
        let Some(defects) = defects.get() else {
            ui.weak("looked for after the first picture");
            return;
        };
        if self.facts.faces == 0 {
            ui.label("there are no faces");
            return;
        }
        if defects.kinds.is_empty() {
            ui.label("none: every shell is watertight, and none is inside out");
            return;
        }
        if defects.is_sound {
            ui.label("sound: every shell is watertight, and none is inside out");
        }
        for &(kind, count) in &defects.kinds {
            let color = Some(defect_color(kind).1);
            row(ui, color, &words(kind), spaced(count as u64)).on_hover_text(kind.effect());
        }
        ui.add_space(4.0);
        let now = ui.input(|input| input.time);
        let height = ui.text_style_height(&egui::TextStyle::Button) + 2.0 * ui.spacing().button_padding.y;
        let mut fly = None;
        ScrollArea::vertical().id_salt("defects").max_height(180.0).auto_shrink([false, true]).show_rows(
            ui,
            height,
            defects.rows.len(),
            |ui, rows| {
                for index in rows {
                    let row = defects.rows[index];
                    let [x, y, z] = row.position.map(|x| output::significant(x.into()));
                    let text = format!("{} at {x}, {y}, {z}", words(row.kind));
                    let button = egui::Button::selectable(self.defect == Some(index), text).truncate();
                    if ui.add(button).clicked() {
                        fly = Some(index);
                    }
                }
            },
        );
        if defects.rows.len() < defects.count() {
            ui.weak(format!("{} of {} are listed", defects.rows.len(), spaced(defects.count() as u64)));
        }
        if let Some(index) = fly {
            self.fly_to(index, now);
        }
    }

    fn times(&self, ui: &mut egui::Ui) {
        heading(ui, "Times, ms");
        let Some(answer) = &self.answer else { return };
        let total: f64 = answer.stages.iter().map(|(_, ms)| ms).sum();
        let stages = answer.stages.iter().map(|(name, ms)| (name.as_str(), *ms));
        for (name, ms) in stages.chain([("all", total)]) {
            row(ui, None, name, format!("{ms:.1}"));
        }
    }

    pub(super) fn help(&mut self, ctx: &egui::Context) {
        let mut open = self.shows_help;
        egui::Window::new("Help")
            .open(&mut open)
            .resizable(false)
            .collapsible(false)
            .default_pos([60.0, 60.0])
            .show(ctx, |ui| {
                egui::Grid::new("keys").num_columns(2).spacing([24.0, 6.0]).show(ui, |ui| {
                    for (key, what) in KEYS {
                        ui.strong(key);
                        ui.label(what);
                        ui.end_row();
                    }
                });
            });
        self.shows_help &= open;
    }
}

/// Position or direction of a lamp, and its extent, in a scene of some size.
fn numbers(ui: &mut egui::Ui, own: &mut OwnLamp, size: f64) {
    let is_directional = own.lamp.light().is_directional();
    let mut xyz = handle::numbers(&own.lamp);
    let before = xyz;
    ui.horizontal(|ui| {
        ui.label(if is_directional { "shines to" } else { "is at" });
        let speed = if is_directional { 0.01 } else { STEP * size };
        for x in &mut xyz {
            ui.add(egui::DragValue::new(x).speed(speed).custom_formatter(|x, _| brief(x)));
        }
    });
    if xyz != before {
        own.lamp = handle::with_light(&own.lamp, xyz);
    }
    if let Some(mut extent) = handle::extent(&own.lamp) {
        let before = extent;
        ui.horizontal(|ui| {
            ui.label(if is_directional { "half its angle in the sky, degrees" } else { "its radius" });
            let speed = if is_directional { 0.02 } else { STEP * size };
            let most = if is_directional { 90.0 } else { f32::MAX };
            ui.add(
                egui::DragValue::new(&mut extent)
                    .speed(speed)
                    .range(0.0..=most)
                    .custom_formatter(|x, _| brief(x)),
            );
        });
        if extent != before {
            own.lamp = handle::with_extent(&own.lamp, extent);
        }
    }
}

/// How far a lamp's shadow is from the truth.
fn figures(ui: &mut egui::Ui, shown: &Shown, errors: &Errors) {
    ui.label(
        RichText::new(format!("light {}: {}, {}", shown.lamp + 1, shown.technique, shown.claim)).strong(),
    );
    let mut row = |name: &str, value: String| drop(row(ui, None, name, value));
    if errors.is_soft {
        row("mean error", format!("{:.5}", errors.mean));
        row("99th percentile", format!("{:.5}", errors.p99));
        row("largest error", format!("{:.5}", errors.max));
        row("samples judged", spaced(errors.judged));
    } else {
        row("wrong", format!("{} of {}", spaced(errors.wrong), spaced(errors.judged)));
        if errors.wrong > 0 {
            row("falsely dark", spaced(errors.acne + errors.alias_dark));
            row("falsely lit", spaced(errors.leak + errors.alias_lit));
            if errors.outside > 0 {
                row("outside the map", spaced(errors.outside));
            }
        }
    }
}

fn heading(ui: &mut egui::Ui, text: &str) {
    ui.add_space(10.0);
    ui.heading(text);
    ui.add_space(2.0);
}

fn swatch(ui: &mut egui::Ui, [r, g, b]: [u8; 3]) {
    let (rect, _) = ui.allocate_exact_size(egui::vec2(12.0, 12.0), egui::Sense::hover());
    ui.painter().rect_filled(rect, 2.0, Color32::from_rgb(r, g, b));
}

/// Words at the left edge, cut where they meet the number at the right edge.
fn row(ui: &mut egui::Ui, color: Option<[u8; 3]>, words: &str, number: String) -> egui::Response {
    let row = ui.horizontal(|ui| {
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            ui.label(RichText::new(number).monospace());
            ui.with_layout(Layout::left_to_right(Align::Center), |ui| {
                if let Some(color) = color {
                    swatch(ui, color);
                }
                ui.add(egui::Label::new(words).truncate());
            });
        });
    });
    row.response
}

/// The kind of a defect in words.
fn words(kind: DefectKind) -> String {
    kind.name().replace('_', " ")
}

/// A number in four digits.
fn brief(number: f64) -> String {
    let rounded: f64 = format!("{number:.3e}").parse().unwrap_or(number);
    match rounded.abs() {
        size if size == 0.0 || (1e-3..1e6).contains(&size) => (rounded + 0.0).to_string(),
        _ => format!("{rounded:e}"),
    }
}

/// A count with commas between thousands.
fn spaced(number: u64) -> String {
    let digits = number.to_string();
    let mut text = String::new();
    for (at, digit) in digits.chars().enumerate() {
        if at > 0 && (digits.len() - at).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}
