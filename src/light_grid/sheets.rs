//! Sheets: the connected pieces of the chain within a cell.

use super::chain::Chain;
use super::fault::{Fault, Faults};
use super::pairs::{GenericRay, Pair};

/// A connected piece of the chain within a cell: faces united across the edges between them that belong to no
/// boundary.
///
/// # Why one ray speaks for all
///
/// The boundary of a sheet is made of the edges whose multiplicities do not cancel within it. All faces at an
/// edge that meets the cell meet the cell too. If the edge has the multiplicity 0, they have been united, and
/// it cancels; otherwise the sheet is marked. So an unmarked sheet has no boundary among the rays of the
/// cell, and a ray can be moved to any other without its intersection number with the sheet changing, as
/// both ends stay off the sheet: beyond all faces, and at the light, which lies on no face of the chain.
/// Each crossing counts +1, as a face's sign in the chain is the side that it shows to the light. So every
/// ray that touches no edge crosses the sheet equally often. This holds for any mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Sheet {
    /// The greatest nearness in the cell, rounded up.
    pub(super) near: f32,
    /// The least nearness in the cell, rounded down.
    pub(super) far: f32,
    /// How often the generic ray crosses the sheet.
    pub(super) crossings: u32,
    /// Whether a boundary may meet the cell, or the generic ray an edge: then the crossings tell nothing.
    pub(super) is_outline: bool,
    /// A face of it.
    pub(super) face: u32,
}

impl Sheet {
    /// Whether every ray of the cell meets the sheet.
    pub(super) fn covers(&self) -> bool {
        !self.is_outline && self.crossings > 0
    }
}

/// Buffers of [`Uniting::sheets`], kept from cell to cell.
#[derive(Debug)]
pub(super) struct Uniting {
    parents: Vec<u32>,
    /// For each edge of the chain the number of the last cell that met it, and a face at it, as its index in
    /// that cell.
    last: Vec<[u32; 2]>,
    /// The number of the cell, from 1.
    cell: u32,
    numbers: Vec<u32>,
    is_outline: Vec<bool>,
}

impl Uniting {
    /// For the cells of one grid. Memory: 8 bytes for each edge of the chain.
    pub(super) fn of(chain: &Chain<'_>) -> Self {
        Self {
            parents: Vec::new(),
            last: vec![[0; 2]; chain.edge_count()],
            cell: 0,
            numbers: Vec::new(),
            is_outline: Vec::new(),
        }
    }

    /// Adds the sheets of a cell to `sheets`, in the order of their first faces, and the index of each face's
    /// sheet to `of_face`.
    pub(super) fn sheets(
        &mut self,
        chain: &Chain<'_>,
        pairs: &[Pair],
        faults: Faults,
        sheets: &mut Vec<Sheet>,
        of_face: &mut Vec<u32>,
    ) {
        self.parents.clear();
        self.parents.extend(0..pairs.len() as u32);
        self.is_outline.clear();
        self.cell += 1; // there are fewer cells than numbers
        for (index, pair) in (0..).zip(pairs) {
            let (edges, mut outline) = if pair.met == 0 { ([0; 3], 0) } else { chain.edges(pair.face) };
            self.is_outline.push(pair.met & outline != 0 && !faults.has(Fault::NoOutline));
            if faults.has(Fault::UnitedAcross) {
                outline = 0;
            }
            for k in (0..3).filter(|k| pair.met & !outline & (1 << k) != 0) {
                let [cell, other] = std::mem::replace(&mut self.last[edges[k] as usize], [self.cell, index]);
                if cell == self.cell {
                    self.unite(other, index);
                }
            }
        }
        self.numbers.clear();
        for (index, pair) in (0..).zip(pairs) {
            // The root is the first face of its sheet.
            let root = self.root(index);
            let number = if root == index { sheets.len() as u32 } else { self.numbers[root as usize] };
            self.numbers.push(number);
            of_face.push(number);
            let is_outline = self.is_outline[index as usize] || pair.ray == GenericRay::Unsure;
            let crossings = u32::from(pair.ray == GenericRay::Crosses);
            if root == index {
                let face = pair.face;
                sheets.push(Sheet { near: pair.near, far: pair.far, crossings, is_outline, face });
            } else {
                let sheet = &mut sheets[number as usize];
                sheet.near = sheet.near.max(pair.near);
                sheet.far = sheet.far.min(pair.far);
                sheet.crossings += crossings;
                sheet.is_outline |= is_outline;
            }
        }
    }

    fn root(&mut self, mut index: u32) -> u32 {
        while self.parents[index as usize] != index {
            // Halves the path.
            let parent = self.parents[index as usize];
            self.parents[index as usize] = self.parents[parent as usize];
            index = parent;
        }
        index
    }

    /// The lower root becomes that of both.
    fn unite(&mut self, a: u32, b: u32) {
        let [a, b] = [self.root(a), self.root(b)];
        self.parents[a.max(b) as usize] = a.min(b);
    }
}
