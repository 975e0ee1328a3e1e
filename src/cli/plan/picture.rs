//! What is proven about each point, in false colors.

use umbrage::caster::CasterGroup;
use umbrage::light_grid::{Chain, GridVerdict, LightGrid, SoftGrid, SoftVerdict};
use umbrage::oracle::PrimaryHit;
use umbrage::render::{Knowledge, MemoryError, Picture, knowledge};
use umbrage::scene::Lamp;
use umbrage::shadow::{Claim, Samples, Visibility};

use crate::cli::caption::captioned;

/// Cells along each side of the grid that proves.
const SIDE: u32 = 256;

/// The picture and its legend.
pub(super) fn draw(
    casters: &CasterGroup<'_>,
    lamps: &[Lamp],
    samples: &Samples,
) -> Result<(Picture, String), MemoryError> {
    let all = known(casters, lamps, samples);
    let count = |known: &Knowledge| all.iter().filter(|other| *other == known).count();
    let found: Vec<(Knowledge, usize)> =
        Knowledge::ALL.iter().map(|known| (*known, count(known))).filter(|(_, count)| *count > 0).collect();
    let legend = found.iter().map(|(known, count)| format!("{} {}: {count}", known.color().0, known.name()));
    let legend = legend.collect::<Vec<_>>().join(", ");
    let legend = format!("colors, with the number of samples: {legend}");
    let keys = found.iter().map(|(known, count)| (known.color().1, format!("{}: {count}", known.name())));
    let lines = ["What is proven about each visible point, whatever technique is chosen"];
    Ok((captioned(knowledge(samples, &all)?, &lines, &keys.collect::<Vec<_>>()), legend))
}

/// What is known of each sample. Of several lamps, the one of most doubt decides.
pub(crate) fn known(casters: &CasterGroup<'_>, lamps: &[Lamp], samples: &Samples) -> Vec<Knowledge> {
    let mut all = vec![Knowledge::Irrelevant; samples.len()];
    for lamp in lamps {
        // Whether each sample faces the lamp.
        let asked = Visibility::from_values(samples, lamp.light(), vec![0.0; samples.len()], Claim::Exact);
        let hits = samples.hits().iter().zip(asked.asked());
        let hits: Vec<Option<&PrimaryHit>> =
            hits.map(|(hit, asked)| hit.as_ref().filter(|_| *asked)).collect();
        let points = || hits.iter().flatten().map(|hit| hit.point);
        let chain = Chain::of(casters, lamp.light());
        let hard = LightGrid::build(&chain, points(), SIDE);
        let soft = lamp.has_extent().then(|| SoftGrid::build(&chain, lamp, points(), SIDE));
        for (known, hit) in all.iter_mut().zip(&hits) {
            let Some(hit) = hit else { continue };
            let found = match &soft {
                Some(grid) => match grid.verdict(hit) {
                    SoftVerdict::Lit => Knowledge::Lit,
                    SoftVerdict::Dark => Knowledge::Dark,
                    SoftVerdict::Maybe => Knowledge::Penumbra,
                },
                None => match hard.verdict(hit) {
                    GridVerdict::Lit => Knowledge::Lit,
                    GridVerdict::Dark => Knowledge::Dark,
                    GridVerdict::Undecided => Knowledge::Undecided,
                },
            };
            *known = (*known).max(found);
        }
    }
    all
}
