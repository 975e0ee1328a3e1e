//! Opens the window and waits until it is closed.

use std::sync::PoisonError;

use eframe::egui;
use umbrage::gpu::GpuError;

use super::app::{self, App, Wishes};
use super::panels;
use super::state::{Layer, Mode};
use super::worker::{Opener, Worker};
use super::{Args, LayerArg, ModeArg, ThemeArg};
use crate::cli::{Failure, Outcome, output};

impl From<LayerArg> for Layer {
    fn from(layer: LayerArg) -> Self {
        match layer {
            LayerArg::Truth => Self::Truth,
            LayerArg::Silhouette => Self::Silhouette,
            LayerArg::Volume => Self::Volume,
            LayerArg::Caps => Self::Caps,
            LayerArg::Defects => Self::Defects,
            LayerArg::Lights => Self::Lights,
        }
    }
}

impl From<ModeArg> for Mode {
    fn from(mode: ModeArg) -> Self {
        match mode {
            ModeArg::Picture => Self::Picture,
            ModeArg::Difference => Self::Difference,
            ModeArg::Grid => Self::Grid,
        }
    }
}

impl From<ThemeArg> for egui::ThemePreference {
    fn from(theme: ThemeArg) -> Self {
        match theme {
            ThemeArg::System => Self::System,
            ThemeArg::Light => Self::Light,
            ThemeArg::Dark => Self::Dark,
        }
    }
}

/// What to do without a display.
const NO_DISPLAY: &str = "run it on a desktop, or with xvfb-run; umbrage render needs no display";

pub(super) fn open(args: Args) -> Result<Outcome, Failure> {
    require_display()?;
    args.threads.apply()?;
    let file = args.source.file.clone();
    let size = panels::beside(args.size);
    let opener = Opener { source: args.source, view: args.view, size, ground: args.ground };
    let opened = opener.open(file)?;
    let facts = opened.facts().clone();
    let techniques = args.shadow.of_lamps(&facts.lamps)?;
    let gpu = match args.adapter.find()? {
        Ok(gpu) => Some(gpu),
        Err(GpuError::NoAdapter) => None,
        Err(error) => {
            output::say(format_args!("note: stencil passes are counted on the CPU: {error}"));
            None
        }
    };
    let layers = match &args.show[..] {
        [] => vec![Layer::Lights],
        show => show.iter().map(|&layer| layer.into()).collect(),
    };
    let wishes = Wishes { layers, mode: args.mode.into(), techniques, screenshot: args.screenshot };
    let [width, height] = [args.size.width(), args.size.height()].map(|side| side as f32);
    let title = app::title(&facts);
    let viewport = egui::ViewportBuilder::default()
        .with_title(&title)
        .with_app_id("umbrage")
        .with_inner_size([width, height])
        .with_min_inner_size([640.0, 400.0])
        .with_icon(egui::IconData::default());
    let options = eframe::NativeOptions { viewport, centered: true, ..Default::default() };
    let outcome = app::Outcome::default();
    let (told, theme) = (outcome.clone(), args.theme);
    let shown = eframe::run_native(
        "umbrage",
        options,
        Box::new(move |creation| {
            let ctx = &creation.egui_ctx;
            style(ctx, theme.into());
            let wake = ctx.clone();
            let worker = Worker::start(opener, opened, gpu, move || wake.request_repaint());
            Ok(Box::new(App::new(worker, facts, wishes, told)))
        }),
    );
    shown.map_err(|error| explained(&error))?;
    let failure = outcome.lock().unwrap_or_else(PoisonError::into_inner).take();
    failure.map_or(Ok(Outcome::Sound), Err)
}

/// Refuses to work for a window that nobody could see, before a file is read.
fn require_display() -> Result<(), Failure> {
    let is_named = |name| std::env::var_os(name).is_some_and(|value| !value.is_empty());
    let has_one = ["DISPLAY", "WAYLAND_DISPLAY", "WAYLAND_SOCKET"].into_iter().any(is_named);
    match cfg!(all(unix, not(target_os = "macos"))) && !has_one {
        true => Err(Failure::new("there is no display for a window", NO_DISPLAY)),
        false => Ok(()),
    }
}

/// Why there is no window.
fn explained(error: &eframe::Error) -> Failure {
    let remedy = match error {
        eframe::Error::Wgpu(_) => {
            "install a graphics driver that does Vulkan (Debian and Ubuntu: mesa-vulkan-drivers); umbrage \
             render --shadow rays needs none"
        }
        _ => NO_DISPLAY,
    };
    Failure::new(format_args!("the window cannot be opened: {error}"), remedy)
}

/// The look: that of the pages.
fn style(ctx: &egui::Context, theme: egui::ThemePreference) {
    use egui::Color32;
    ctx.set_theme(theme);
    let gray = |hex: u32| {
        let [_, r, g, b] = hex.to_be_bytes();
        Color32::from_rgb(r, g, b)
    };
    let looks = [
        (egui::Theme::Light, egui::Visuals::light(), [0xf5f6f8, 0x222222, 0x666666]),
        (egui::Theme::Dark, egui::Visuals::dark(), [0x16181d, 0xdddddd, 0x9aa0a8]),
    ];
    for (theme, mut visuals, [paper, ink, faint]) in looks {
        visuals.panel_fill = gray(paper);
        visuals.window_fill = gray(paper);
        visuals.widgets.noninteractive.fg_stroke.color = gray(ink);
        visuals.widgets.inactive.fg_stroke.color = gray(ink);
        visuals.weak_text_color = Some(gray(faint));
        ctx.set_visuals_of(theme, visuals);
    }
    ctx.all_styles_mut(|style| {
        use egui::{FontFamily::Proportional, FontId, TextStyle};
        style.text_styles.insert(TextStyle::Heading, FontId::new(17.0, Proportional));
        style.text_styles.insert(TextStyle::Body, FontId::new(14.0, Proportional));
        style.text_styles.insert(TextStyle::Button, FontId::new(14.0, Proportional));
        style.text_styles.insert(TextStyle::Small, FontId::new(12.0, Proportional));
        style.text_styles.insert(TextStyle::Monospace, FontId::new(13.0, egui::FontFamily::Monospace));
    });
}
