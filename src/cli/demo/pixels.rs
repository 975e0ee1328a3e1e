//! Pixels of the demo: the stencil pass next to the ray cast, and where the two differ.

use umbrage::caster::Caster;
use umbrage::gpu::{Gpu, GpuError};
use umbrage::render;
use umbrage::render::{Picture, View};
use umbrage::scene::Lamp;
use umbrage::verify::pixels::{PixelVerdict, Rendered, compare};
use umbrage::view::Size;

use crate::cli::lights::lamp_label;
use crate::cli::output::{Table, plain};
use crate::cli::progress::Progress;
use crate::cli::stencil_render::{Shadowing, Stage};

/// The picture of the stencil pass, and its comparison with the ray cast.
pub(super) struct Judged {
    pub(super) picture: Picture,
    /// The verdicts in false color, one picture per light, side by side.
    pub(super) verdicts: Picture,
    pub(super) text: String,
    pub(super) agrees: bool,
}

/// Rays along each side of a pixel, all of them counted.
const SAMPLES: u32 = 2;

/// Draws the view by a stencil pass, and compares its pixels with the ray cast for each light. `lights` are
/// those of the lamps.
pub(super) fn judge(gpu: &Gpu, caster: &Caster, view: View<'_>, lights: &[Lamp]) -> Result<Judged, GpuError> {
    let stage = {
        let view = View { edge_samples: SAMPLES, ..view };
        Stage::new(gpu, [caster; 2], view, &vec![Shadowing::Counted(None); lights.len()])?
    };
    let picture = stage.picture()?;
    let progress = Progress::bar("judging pixels", (lights.len() as u64) * u64::from(view.size.height()));
    let mut table = Table::new(&["light", "pixels", "sky", "agree", "grazing", "disagree"]);
    let (mut panels, mut methods, mut agrees) = (Vec::new(), String::new(), true);
    for (lamp, (light, casting)) in lights.iter().zip(&stage.castings).enumerate() {
        let Some(casting) = casting else { continue };
        let mask = stage.mask(lamp)?;
        let rendered = Rendered {
            caster,
            seen: None,
            signs: &casting.signs,
            light: light.light(),
            projection: &stage.projection,
            seen_from: 0.0,
            mask: &mask,
            unsure: &[],
        };
        let result = compare(&rendered, 0, &|rows| progress.done(rows));
        let counts = [
            view.size.pixels(),
            result.count(PixelVerdict::Sky),
            result.count(PixelVerdict::Lit) + result.count(PixelVerdict::Shadowed),
            result.count(PixelVerdict::Grazing),
        ];
        let disagree = counts[0] - counts[1..].iter().sum::<usize>();
        let cells = counts.into_iter().chain([disagree]).map(|count| count.to_string());
        let name = lamp_label(light);
        methods += &format!("  {name}: {}\n", casting.methods.summary());
        table.row([name].into_iter().chain(cells).collect());
        agrees &= result.agrees();
        panels.push(render::verdicts(caster.oracle(), &stage.projection, &result, &|_| {}));
    }
    drop(progress);
    let verdict = if agrees { "every pixel agrees or grazes" } else { "some pixels disagree" };
    let text = format!(
        "{}, {} pixels\n{table}\n{methods}\nverdict: {verdict}\n{LEGEND}\n",
        plain(&gpu.name()),
        view.size
    );
    // A few small pictures fit the memory that the previous ones were in.
    let panels: Vec<Picture> = panels.into_iter().flatten().collect();
    let verdicts = beside(&panels.iter().collect::<Vec<_>>());
    Ok(Judged { picture, verdicts, text, agrees })
}

const LEGEND: &str = "agree: the stencil pass counts exactly what the ray cast does; grazing: it does within the \
                      rasterizer's rounding; in verdicts.png light gray is lit, dark gray shadowed, yellow grazing, and what \
                      disagrees is ringed";

/// Columns between two pictures.
const GAP: usize = 6;

/// Pictures of one height in a row, from left to right.
pub(super) fn beside(pictures: &[&Picture]) -> Picture {
    let [first, ..] = pictures else { panic!("nothing to show") };
    let height = first.size.height() as usize;
    let mut pixels = Vec::new();
    for y in 0..height {
        for (i, picture) in pictures.iter().enumerate() {
            let width = picture.size.width() as usize;
            pixels.extend(std::iter::repeat_n([255; 4], if i > 0 { GAP } else { 0 }));
            pixels.extend(&picture.pixels[y * width..(y + 1) * width]);
        }
    }
    let size = Size::new((pixels.len() / height) as u32, height as u32).expect("a few small pictures");
    Picture { size, pixels }
}
