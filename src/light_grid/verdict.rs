//! Hard verdicts: what the sheets of a point's cell prove about it.

use super::facet::{Facet, Meeting, Square};
use super::fault::Fault;
use super::grid::{LightGrid, Place};
use super::sheets::Sheet;
use crate::geom::predicate::{side_of_light, side_of_point};
use crate::oracle::PrimaryHit;

/// What the grid proves about a point.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum GridVerdict {
    /// No face properly crosses the segment to the light.
    Lit,
    /// The segment to the light meets a face.
    Dark,
    /// Nothing: the exact ray cast has to decide.
    Undecided,
}

impl LightGrid<'_> {
    /// What is proven about a point that need not lie on a face, where an exact tie counts as either.
    ///
    /// *Dark*: every ray of the cell meets some sheet, and all of this sheet is nearer to the light than the
    /// point. *Lit*: all of every sheet is farther from the light.
    #[must_use]
    pub fn verdict_at(&self, p: [f32; 3]) -> GridVerdict {
        self.place(p).map_or(GridVerdict::Undecided, |place| verdict(&place, |_| false))
    }

    /// What is proven about a visible point.
    ///
    /// As [`LightGrid::verdict_at`], but its own sheet, which holds the visible face, is at no other depth. A
    /// ray that touches no edge crosses this sheet once, if it has no boundary in the cell and its generic
    /// ray crosses it once. If the point's ray properly crosses the visible face, and point and light lie on
    /// one side of this face, the one crossing is behind the point, and so the sheet does not shadow it.
    #[must_use]
    pub fn verdict(&self, hit: &PrimaryHit) -> GridVerdict {
        let Some(place) = self.place(hit.point) else { return GridVerdict::Undecided };
        verdict(&place, |number| self.is_own(&place, number, hit))
    }

    /// Whether a sheet holds the visible face and therefore does not shadow the point.
    pub(super) fn is_own(&self, place: &Place<'_>, number: usize, hit: &PrimaryHit) -> bool {
        let sheet = &place.sheets[number];
        let once = sheet.crossings == 1 || sheet.crossings == 2 && self.faults.has(Fault::TwoCrossings);
        if sheet.is_outline || !once {
            return false;
        }
        let own = self.chain.of_visible(hit).and_then(|face| place.faces.binary_search(&face).ok());
        if own.is_none_or(|own| place.sheet_of[own] - place.first_sheet != number as u32) {
            return false;
        }
        let side = side_of_light(hit.corners, self.chain.light());
        if side.is_zero() || side_of_point(hit.corners, hit.point) != side {
            return false;
        }
        // Zero is excluded, so this is 1 or −1.
        let facet = Facet::new(place.view, hit.corners, side.value() as i8);
        facet.meeting(&Square::around(place.y)) == Meeting::All
    }
}

/// What the sheets of a place prove, but for those that are the point's own.
pub(super) fn verdict(place: &Place<'_>, is_own: impl Fn(usize) -> bool) -> GridVerdict {
    let [least, most] = place.nearness;
    if place.sheets.iter().any(|sheet| sheet.covers() && f64::from(sheet.far) > most) {
        return GridVerdict::Dark;
    }
    let is_behind = |sheet: &Sheet| f64::from(sheet.near) < least;
    let mut sheets = place.sheets.iter().enumerate();
    if sheets.all(|(number, sheet)| is_behind(sheet) || is_own(number)) {
        return GridVerdict::Lit;
    }
    GridVerdict::Undecided
}
