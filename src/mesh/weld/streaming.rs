//! Exact welding where equal vertices are close together in the list, as in a soup whose faces follow the
//! surface: one hash table, behind a small direct-mapped cache of recent vertices.

use std::hint::select_unpredictable;

use multiversion::multiversion;

use super::exact::{BLOCK, Points, Record};
use super::id_table::Table;
use super::{Kept, Used};

/// Binary logarithm of the number of slots for recent vertices: 16 kB, which fits the first-level cache.
const LATEST_BITS: u32 = 10;

#[multiversion(targets("x86_64+avx2+bmi1+bmi2"))]
pub(super) fn merge<const MOVING: bool>(
    points: &Points<'_, MOVING>,
    used: &Used,
    vertex_of: &mut [u32],
) -> Kept {
    let mut places = Places::for_about(used.count() / 6); // a closed soup has six corners per vertex
    let mut latest = Box::new([Record::NOWHERE; 1 << LATEST_BITS]);
    let (mut unknown, mut earlier) = ([Record::NOWHERE; BLOCK], [0_u32; BLOCK]);
    points.for_each_block(used, |block| {
        let count = sift(points, block, &mut latest, &mut earlier, &mut unknown);
        places.settle(points, &unknown[..count], vertex_of);
        for (own, &earlier) in block.iter().zip(&earlier) {
            vertex_of[own.vertex() as usize] = vertex_of[earlier as usize];
        }
    });
    places.kept.positions.shrink_to_fit();
    places.kept
}

/// Looks a block of vertices up in the cache of recent vertices. `earlier` gets the equal recent vertex, or
/// the vertex itself. Vertices without a match are appended to `unknown`; their number is returned.
///
/// Branch-free: cache hits are hard to predict, and a misprediction costs as much as two look-ups.
#[inline(always)]
fn sift<const MOVING: bool>(
    points: &Points<'_, MOVING>,
    block: &[Record],
    latest: &mut [Record; 1 << LATEST_BITS],
    earlier: &mut [u32; BLOCK],
    unknown: &mut [Record; BLOCK],
) -> usize {
    let mut count = 0;
    for (&own, earlier) in block.iter().zip(earlier) {
        let latest = &mut latest[(points.hash(own) >> (64 - LATEST_BITS)) as usize];
        let found = latest.is_at(own) & points.same_frames(latest.vertex(), own.vertex());
        *latest = Record([own.0[0], select_unpredictable(found, latest.0[1], own.0[1])]);
        *earlier = latest.vertex();
        unknown[count % BLOCK] = own; // overwritten by the next one unless counted
        count += usize::from(!found);
    }
    count
}

/// The kept vertices, indexed by position.
struct Places {
    kept: Kept,
    table: Table,
}

impl Places {
    fn for_about(expected: usize) -> Self {
        // A closed mesh has slightly more vertices than half its faces.
        let kept = Kept { positions: Vec::with_capacity(expected + BLOCK), origins: Vec::new() };
        Self { kept, table: Table::for_about(expected) }
    }

    /// Finds or keeps each vertex of a block.
    ///
    /// A look-up waits for memory twice: for the table, and for the kept vertex that the table names. So all
    /// look-ups of a block are started before the first result is used, and their cache misses overlap. Then
    /// the vertices are settled in order. A vertex that entered the table during the block is found by a
    /// second look-up.
    #[inline(always)]
    fn settle<const MOVING: bool>(
        &mut self,
        points: &Points<'_, MOVING>,
        block: &[Record],
        vertex_of: &mut [u32],
    ) {
        let (mut hashes, mut guesses, mut right) = ([0; BLOCK], [0; BLOCK], [false; BLOCK]);
        let (hashes, guesses, right) =
            (&mut hashes[..block.len()], &mut guesses[..block.len()], &mut right[..block.len()]);
        for i in 0..block.len() {
            hashes[i] = points.hash(block[i]);
            guesses[i] = self.table.first(hashes[i]);
        }
        if let Some(last) = self.kept.positions.len().checked_sub(1) {
            for i in 0..block.len() {
                // Limited to the last id: a value that is no id is compared with the last kept vertex, and a
                // match there is right too.
                guesses[i] = guesses[i].min(last as u32);
                right[i] = is(&self.kept, points, guesses[i], block[i]);
            }
        }
        for (i, &record) in block.iter().enumerate() {
            let id = if right[i] { guesses[i] } else { self.find_or_keep(points, record, hashes[i]) };
            vertex_of[record.vertex() as usize] = id;
        }
        if self.table.is_full(self.kept.positions.len() + BLOCK) {
            self.grow(points);
        }
    }

    #[inline(always)]
    fn find_or_keep<const MOVING: bool>(
        &mut self,
        points: &Points<'_, MOVING>,
        record: Record,
        hash: u64,
    ) -> u32 {
        let new = self.kept.positions.len() as u32; // below the vertex count, which fits
        let Self { kept, table } = self;
        let id = table.find_or_insert(hash, new, |id| is(kept, points, id, record));
        if id == new {
            kept.positions.push(record.position());
            if MOVING {
                kept.origins.push(record.vertex());
            }
        }
        id
    }

    #[cold]
    fn grow<const MOVING: bool>(&mut self, points: &Points<'_, MOVING>) {
        let origin = |id: usize| self.kept.origins.get(id).copied().unwrap_or(0);
        let positions = self.kept.positions.iter().enumerate();
        self.table.grow(positions.map(|(id, &position)| points.hash(Record::new(position, origin(id)))));
    }
}

/// Whether a vertex equals the kept vertex `id`.
#[inline(always)]
fn is<const MOVING: bool>(kept: &Kept, points: &Points<'_, MOVING>, id: u32, other: Record) -> bool {
    Record::new(kept.positions[id as usize], 0).is_at(other)
        && (!MOVING || points.same_frames(kept.origins[id as usize], other.vertex()))
}
