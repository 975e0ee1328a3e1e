//! Vertices of a place lie anywhere in the list, or alone: they are first brought together by hash, in buckets so
//! small that looking one up in its bucket stays in the cache.
//!
//! Within its bucket each place gets a number. Then the vertices are gone through once more in their order, and each
//! bucket with it: a place that is met for the first time gets the next id. What is read and written lies in a row,
//! in memory or in its bucket, but for the ids of the places.

use std::hint::select_unpredictable;

use multiversion::multiversion;

use super::exact::{BLOCK, Points, Record};
use super::id_table::Table;
use super::{Kept, Used};

/// About so many vertices have a bucket: 12 bytes each, and for one in six of them a place and slots of a table.
const BUCKET: usize = 1 << 14;

/// More buckets than 2 to the power of this are more than the processor can write to at once.
const MOST_BITS: u32 = 12;

pub(super) fn merge(points: &Points<'_, false>, used: &Used, vertex_of: &mut [u32]) -> Kept {
    let bits = (used.count() / BUCKET).next_power_of_two().ilog2().min(MOST_BITS);
    merge_by(points, used, vertex_of, bits)
}

/// With 2^`bits` buckets.
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
        places += kept.len() as u32; // no more than vertices
        start = std::mem::replace(end, start);
    }
    drop((kept, table));
    let positions = in_order(points, used, vertex_of, &ends, &buckets, places);
    Kept { positions, origins: Vec::new() }
}

/// The bits of the hash that choose the bucket are not those that choose the place in a table of a bucket.
#[inline(always)]
fn bucket(hash: u64, buckets: usize) -> usize {
    (hash >> 40) as usize & (buckets - 1)
}

/// How many vertices each bucket has.
#[multiversion(targets("x86_64+avx2+bmi1+bmi2"))]
fn count(points: &Points<'_, false>, used: &Used, counts: &mut [u32]) {
    points.for_each_block(used, |block| {
        for &record in block {
            counts[bucket(points.hash(record), counts.len())] += 1;
        }
    });
}

/// Brings positions into their buckets, each in the order of the vertices.
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

/// Numbers the places of a bucket, which are then `kept`, from `first` on. The numbers of its vertices take the first
/// third of the bucket.
#[multiversion(targets("x86_64+avx2+bmi1+bmi2"))]
fn number(
    points: &Points<'_, false>,
    bucket: &mut [[u32; 3]],
    first: u32,
    kept: &mut Vec<[f32; 3]>,
    table: &mut Table,
) {
    table.reset(bucket.len() / 6); // a closed soup has six corners a vertex
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

/// Gives out ids in the order of the vertices; `starts` are those of the buckets.
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
    // Turned over, so that memory which comes zeroed tells of no id.
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
            kept[new as usize] = record.position(); // stays if it is counted
            new += u32::from(first);
        }
    });
    kept.truncate(new as usize);
    kept
}
