//! Exact welding where equal vertices are far apart in the list, or few: the vertices are first sorted by
//! hash into buckets small enough that a look-up within a bucket stays in the cache.
//!
//! Within its bucket each distinct position gets a number. Then the vertices are visited once more in their
//! order, with one cursor per bucket. The first vertex of each position gets the next id. Every access is
//! sequential, in memory or within a bucket, except for the ids by position number.

use std::hint::select_unpredictable;

use multiversion::multiversion;

use super::exact::{BLOCK, Points, Record};
use super::id_table::Table;
use super::{Kept, Used};

/// Vertices per bucket, about: 12 bytes each, plus a position and table slots for one in six.
const BUCKET: usize = 1 << 14;

/// Binary logarithm of the largest number of buckets: with more, the processor cannot keep a write position
/// open in each.
const MOST_BITS: u32 = 12;

pub(super) fn merge(points: &Points<'_, false>, used: &Used, vertex_of: &mut [u32]) -> Kept {
    let bits = (used.count() / BUCKET).next_power_of_two().ilog2().min(MOST_BITS);
    merge_by(points, used, vertex_of, bits)
}

/// As [`merge`], with 2^`bits` buckets.
pub(super) fn merge_by(points: &Points<'_, false>, used: &Used, vertex_of: &mut [u32], bits: u32) -> Kept {
    let mut ends = vec![0; 1 << bits];
    count(points, used, &mut ends);
    let mut sum = 0;
    for end in &mut ends {
        sum += std::mem::replace(end, sum); // fewer than 2³²
    }
    let mut buckets = vec![[0; 3]; sum as usize];
    scatter(points, used, &mut ends, &mut buckets);
    let (mut places, mut kept, mut table) = (0, Vec::new(), Table::for_about(0));
    let mut start = 0;
    for end in &mut ends {
        number(points, &mut buckets[start as usize..*end as usize], places, &mut kept, &mut table);
        places += kept.len() as u32; // at most the vertex count
        start = std::mem::replace(end, start);
    }
    drop((kept, table));
    let positions = in_order(points, used, vertex_of, &ends, &buckets, places);
    Kept { positions, origins: Vec::new() }
}

/// The bucket of a hash. Its bits differ from those that choose the slot in a bucket's table.
#[inline(always)]
fn bucket(hash: u64, buckets: usize) -> usize {
    (hash >> 40) as usize & (buckets - 1)
}

/// Counts the vertices of each bucket.
#[multiversion(targets("x86_64+avx2+bmi1+bmi2"))]
fn count(points: &Points<'_, false>, used: &Used, counts: &mut [u32]) {
    points.for_each_block(used, |block| {
        for &record in block {
            counts[bucket(points.hash(record), counts.len())] += 1;
        }
    });
}

/// Sorts the positions into their buckets, each bucket in the order of the vertices.
#[multiversion(targets("x86_64+avx2+bmi1+bmi2"))]
fn scatter(points: &Points<'_, false>, used: &Used, ends: &mut [u32], buckets: &mut [[u32; 3]]) {
    points.for_each_block(used, |block| {
        for &record in block {
            let end = &mut ends[bucket(points.hash(record), ends.len())];
            let [x, y, z] = record.position();
            buckets[*end as usize] = [x.to_bits(), y.to_bits(), z.to_bits()];
            *end += 1;
        }
    });
}

/// Numbers the distinct positions of a bucket from `first` on, and collects them in `kept`. The numbers of
/// the bucket's vertices overwrite the first third of the bucket.
#[multiversion(targets("x86_64+avx2+bmi1+bmi2"))]
fn number(
    points: &Points<'_, false>,
    bucket: &mut [[u32; 3]],
    first: u32,
    kept: &mut Vec<[f32; 3]>,
    table: &mut Table,
) {
    table.reset(bucket.len() / 6); // a closed soup has six corners per vertex
    kept.clear();
    for i in 0..bucket.len() {
        let [x, y, z] = bucket[i];
        let record = Record::new([f32::from_bits(x), f32::from_bits(y), f32::from_bits(z)], 0);
        let new = kept.len() as u32;
        let is = |id: u32| Record::new(kept[id as usize], 0).is_at(record);
        let id = table.find_or_insert(points.hash(record), new, is);
        if id == new {
            kept.push(record.position());
            if table.is_full(kept.len() + 1) {
                table.grow(kept.iter().map(|&position| points.hash(Record::new(position, 0))));
            }
        }
        bucket.as_flattened_mut()[i] = first + id;
    }
}

/// Assigns ids in the order of the vertices; `starts` holds the starts of the buckets.
#[multiversion(targets("x86_64+avx2+bmi1+bmi2"))]
fn in_order(
    points: &Points<'_, false>,
    used: &Used,
    vertex_of: &mut [u32],
    starts: &[u32],
    buckets: &[[u32; 3]],
    places: u32,
) -> Vec<[f32; 3]> {
    let mut nexts: Vec<usize> = starts.iter().map(|&start| 3 * start as usize).collect();
    let numbers = buckets.as_flattened();
    // Stored inverted, so that zeroed memory means "no id yet".
    let mut ids = vec![0_u32; places as usize];
    let mut kept = vec![[0.0; 3]; places as usize + 1];
    let mut new = 0;
    let mut found = [0; BLOCK];
    points.for_each_block(used, |block| {
        for (&record, number) in block.iter().zip(&mut found) {
            let next = &mut nexts[bucket(points.hash(record), starts.len())];
            *number = numbers[*next];
            *next += 1;
        }
        for (&record, &number) in block.iter().zip(&found) {
            let id = &mut ids[number as usize];
            let first = *id == 0;
            *id = select_unpredictable(first, !new, *id);
            vertex_of[record.vertex() as usize] = !*id;
            kept[new as usize] = record.position(); // overwritten by the next one unless counted
            new += u32::from(first);
        }
    });
    kept.truncate(new as usize);
    kept
}
