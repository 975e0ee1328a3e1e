//! Pictures of the page: what each technique draws, what is true, and where the two differ.

use umbrage::accuracy::{ShadowAccuracy, ShadowRow};
use umbrage::oracle::Verdict;
use umbrage::render::{MemoryError, Picture, ShadedLight, View, render_samples};
use umbrage::shadow::{Claim, Samples, Visibility};
use umbrage::view::Size;

/// The pictures of one lamp.
pub(super) struct Pictures {
    pub(super) truth: Picture,
    /// One entry per row.
    pub(super) rows: Vec<RowPictures>,
}

/// The pictures of one row.
pub(super) struct RowPictures {
    pub(super) shown: Picture,
    pub(super) errors: Picture,
    /// The corner of the worst region; `None` where nothing differs.
    pub(super) worst: Option<[u32; 2]>,
}

/// Side of the region that is shown enlarged, in pixels.
pub(super) const REGION: u32 = 32;

/// Color of a value that is too dark, of one that is too light, and of a tie.
const DARK: [f32; 3] = [30.0, 136.0, 229.0];
const LIT: [f32; 3] = [255.0, 143.0, 0.0];
const TIE: [f32; 3] = [253.0, 216.0, 53.0];

/// The error of full color: for soft shadows smaller than for hard ones, which are right or wrong.
pub(super) fn full_scale(found: &ShadowAccuracy) -> f32 {
    if found.truth.fractions().is_some() { 0.5 } else { 1.0 }
}

impl Pictures {
    pub(super) fn of(
        found: &ShadowAccuracy,
        samples: &Samples,
        view: &View<'_>,
    ) -> Result<Self, MemoryError> {
        let light = found.lamp.light();
        let lamps = ShadedLight::equal(std::slice::from_ref(&found.lamp));
        let view = View { lamps: &lamps, ..*view };
        let draw = |values: &[f32]| {
            let values = values.iter().map(|value| value.clamp(0.0, 1.0)).collect();
            let visibility = Visibility::from_values(samples, light, values, Claim::Approximate);
            render_samples(samples, &view, &[visibility])
        };
        let right = right_values(found);
        let truth = draw(&right)?;
        let rows = found.rows.iter().map(|row| {
            let errors = errors(found, row, &right, samples, &truth);
            Ok(RowPictures { shown: draw(&row.values)?, worst: worst(row, &right, samples), errors })
        });
        let rows = rows.collect::<Result<_, MemoryError>>()?;
        Ok(Self { truth, rows })
    }
}

/// The true value of each sample. Under a lamp without extent a tie is lit.
fn right_values(found: &ShadowAccuracy) -> Vec<f32> {
    let verdicts = found.truth.verdicts().iter();
    match found.truth.fractions() {
        Some(fractions) => fractions.iter().map(|fraction| fraction.visible as f32).collect(),
        None => verdicts
            .map(|verdict| match verdict {
                Some(Verdict::Lit | Verdict::Grazing) => 1.0,
                _ => 0.0,
            })
            .collect(),
    }
}

/// Value less truth at each pixel, the mean over its samples; 0 where no technique is asked.
fn differences(row: &ShadowRow, right: &[f32], samples: &Samples) -> Vec<f32> {
    let (size, n) = (samples.size(), samples.per_side() as usize);
    let width = size.width() as usize;
    let at = |pixel: usize, k: usize| {
        let [x, y] = [pixel % width, pixel / width];
        let index = (y * n + k / n) * width * n + x * n + k % n;
        row.values[index] - right[index]
    };
    (0..size.pixels()).map(|pixel| (0..n * n).map(|k| at(pixel, k)).sum::<f32>() / (n * n) as f32).collect()
}

/// The truth in grey, and errors in color over it.
fn errors(
    found: &ShadowAccuracy,
    row: &ShadowRow,
    right: &[f32],
    samples: &Samples,
    truth: &Picture,
) -> Picture {
    let scale = full_scale(found);
    let is_tie = |pixel: usize| {
        samples.per_side() == 1
            && !row.errors.is_soft
            && found.truth.verdicts()[pixel] == Some(Verdict::Grazing)
    };
    let differences = differences(row, right, samples);
    let pixels = differences.iter().enumerate().map(|(pixel, &difference)| {
        let [r, g, b, _] = truth.pixels[pixel].map(f32::from);
        let grey = 40.0 + 0.3 * (0.3 * r + 0.6 * g + 0.1 * b);
        let color = match difference {
            _ if is_tie(pixel) => TIE,
            d if d < 0.0 => DARK,
            _ => LIT,
        };
        // The square root lets small errors be seen.
        let share = if is_tie(pixel) { 1.0 } else { (difference.abs() / scale).min(1.0).sqrt() };
        let [r, g, b] = color.map(|color| (grey + (color - grey) * share) as u8);
        [r, g, b, 255]
    });
    Picture { size: truth.size, pixels: pixels.collect() }
}

/// The region with the largest sum of errors, among regions that lie a quarter of their side apart.
fn worst(row: &ShadowRow, right: &[f32], samples: &Samples) -> Option<[u32; 2]> {
    let size = samples.size();
    let differences = differences(row, right, samples);
    let sum = |[left, top]: [u32; 2]| -> f64 {
        let rows = top..(top + REGION).min(size.height());
        rows.flat_map(|y| (left..(left + REGION).min(size.width())).map(move |x| (x, y)))
            .map(|(x, y)| f64::from(differences[(y * size.width() + x) as usize].abs()))
            .sum()
    };
    let corners = |side: u32| (0..=side.saturating_sub(REGION)).step_by(REGION as usize / 4);
    let regions = corners(size.height()).flat_map(|top| corners(size.width()).map(move |left| [left, top]));
    let (corner, sum) = regions.map(|corner| (corner, sum(corner))).max_by(|a, b| a.1.total_cmp(&b.1))?;
    (sum > 0.0).then_some(corner)
}

/// A region of a picture.
pub(super) fn crop(picture: &Picture, [left, top]: [u32; 2]) -> Option<Picture> {
    let whole = picture.size;
    let size = Size::new(REGION.min(whole.width()), REGION.min(whole.height())).ok()?;
    let rows = (0..size.height()).flat_map(|y| {
        let start = ((top + y) * whole.width() + left) as usize;
        picture.pixels[start..start + size.width() as usize].iter().copied()
    });
    Some(Picture { size, pixels: rows.collect() })
}
