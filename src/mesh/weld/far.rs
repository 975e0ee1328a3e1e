//! Vertices of a place lie anywhere in the list, or alone: they are first brought together by hash, in buckets so
//! small that looking one up in its bucket stays in the cache.
//!
//! Of those at one place the first is the one that is kept, whatever the order of the buckets; its number is how many
//! are kept before it.

use multiversion::multiversion;

use super::exact::Points;
use super::table::Table;
use super::{Merged, UNUSED, Used};

/// About so many vertices have a bucket: 16 bytes each, and twice as many places of 4 in the table.
const BUCKET: usize = 1 << 14;

/// How the vertices are divided.
#[derive(Clone, Copy, Debug)]
pub(super) struct Buckets {
    /// 2^`bits` buckets.
    pub(super) bits: u32,
    /// In so many rounds, one range of buckets after the other, so that only this fraction of the vertices is copied
    /// at a time.
    pub(super) rounds: u32,
}

impl Buckets {
    fn for_about(vertices: usize) -> Self {
        // More buckets in a round than 4096 are more than the processor can write to at once.
        let bits = (vertices / BUCKET).next_power_of_two().ilog2().min(20);
        Self { bits, rounds: vertices.div_ceil(BUCKET << 12).max(1) as u32 }
    }
}

/// A vertex behind its bits. (An array, as memory for those comes zeroed and is not touched before its time.)
type Record = [u32; 4];

pub(super) fn merged(points: &Points<'_>, used: &Used) -> Merged {
    merged_by(points, used, Buckets::for_about(used.count()))
}

pub(super) fn merged_by(points: &Points<'_>, used: &Used, Buckets { bits, rounds }: Buckets) -> Merged {
    // The bits that choose the bucket are not those that choose the place in a table of a bucket.
    let bucket_of = |hash: u64| (hash >> 40) as u32 & ((1 << bits) - 1);
    // How many vertices each bucket has.
    let mut places = vec![0_u32; 1 << bits];
    for vertex in used.iter() {
        places[bucket_of(points.hash(points.bits(vertex), vertex)) as usize] += 1;
    }
    let share = used.count().div_ceil(rounds as usize).max(1);
    let mut merger = Merger::new(used.len);
    let mut records: Vec<Record> = Vec::new();
    let mut first = 0;
    while first < places.len() {
        // Counts turn into places as far as this round goes.
        let (mut last, mut count) = (first, 0);
        while last < places.len() && count < share {
            count += std::mem::replace(&mut places[last], count as u32) as usize; // fewer than 2³²
            last += 1;
        }
        if records.len() < count {
            drop(std::mem::take(&mut records)); // first, so that never both are there
            records = vec![[0; 4]; count];
        }
        let ends = &mut places[first..last];
        for vertex in used.iter() {
            let key @ [x, y, z] = points.bits(vertex);
            // What lies below `first` wraps around and is out of range as well.
            let bucket = bucket_of(points.hash(key, vertex)).wrapping_sub(first as u32);
            if let Some(place) = ends.get_mut(bucket as usize) {
                records[*place as usize] = [x, y, z, vertex];
                *place += 1;
            }
        }
        let mut start = 0;
        for &end in ends.iter() {
            merger.add(points, &records[start as usize..end as usize]);
            start = end;
        }
        first = last;
    }
    drop(records);
    merger.finish(used)
}

/// For each vertex the first one at its place, as far as they are known.
struct Merger {
    first_of: Vec<u32>,
    /// A bit for each vertex: whether it is the first one.
    firsts: Vec<u64>,
    table: Table,
    /// The different places of a bucket.
    kept: Vec<Record>,
}

impl Merger {
    fn new(vertices: usize) -> Self {
        Self {
            first_of: vec![0; vertices],
            firsts: vec![0; vertices.div_ceil(64)],
            table: Table::for_about(0),
            kept: Vec::new(),
        }
    }

    /// Adds a bucket, its vertices ascending.
    fn add(&mut self, points: &Points<'_>, records: &[Record]) {
        let Self { first_of, firsts, table, kept } = self;
        table.reset(records.len().min(4 * BUCKET));
        kept.clear();
        for &[x, y, z, vertex] in records {
            let new = kept.len() as u32;
            let same = |id: u32| {
                let other = kept[id as usize];
                other[..3] == [x, y, z] && points.same_frames(other[3], vertex)
            };
            let id = table.find_or_insert(points.hash([x, y, z], vertex), new, same);
            if id == new {
                kept.push([x, y, z, vertex]);
                firsts[vertex as usize / 64] |= 1 << (vertex % 64);
                if table.is_full(kept.len() + 1) {
                    table.grow(kept.iter().map(|&[x, y, z, vertex]| points.hash([x, y, z], vertex)));
                }
            }
            first_of[vertex as usize] = kept[id as usize][3];
        }
    }

    fn finish(self, used: &Used) -> Merged {
        let Self { first_of: mut vertex_of, firsts, table, kept: records } = self;
        drop((table, records));
        let mut before = Vec::with_capacity(firsts.len());
        let mut count = 0;
        for word in &firsts {
            before.push(count);
            count += word.count_ones();
        }
        let mut kept = Vec::with_capacity(count as usize);
        for (word, &bits) in (0_u32..).zip(&firsts) {
            let mut bits = bits;
            while bits != 0 {
                kept.push(64 * word + bits.trailing_zeros());
                bits &= bits - 1;
            }
        }
        number(&mut vertex_of, &firsts, &before);
        if let Some(referenced) = &used.referenced {
            for (vertex, _) in vertex_of.iter_mut().zip(referenced).filter(|(_, used)| !**used) {
                *vertex = UNUSED;
            }
        }
        Merged { vertex_of, kept }
    }
}

/// Puts the number of a vertex, how many are kept before it, in its own place.
#[multiversion(targets("x86_64+popcnt+bmi1+bmi2"))]
fn number(vertices: &mut [u32], firsts: &[u64], before: &[u32]) {
    for vertex in vertices {
        let (word, bit) = (*vertex as usize / 64, *vertex % 64);
        *vertex = before[word] + (firsts[word] & ((1 << bit) - 1)).count_ones();
    }
}
