//! The edge table in linear time, without hashing.

use super::{Entry, Topology, has_collapsed};
use crate::mesh::MAX_TRIANGLES;

/// A half-edge on its way into the table: the larger vertex above, the [`Entry`] below, so that sorting a
/// bucket groups its edges and orders their half-edges.
type Keyed = u64;

pub(super) fn build(vertex_count: usize, triangles: Vec<[u32; 3]>) -> Topology {
    assert!(triangles.len() <= MAX_TRIANGLES, "{} triangles; at most {MAX_TRIANGLES} fit", triangles.len());
    let (starts, collapsed_faces) = bucket_starts(vertex_count, &triangles);
    let keyed = scatter(starts, &triangles);
    let Buckets { ends, mut keyed } = keyed;

    // Within each bucket: sort, then cut where the larger vertex changes.
    let mut offsets = Vec::with_capacity(keyed.len() / 2 + 1);
    let mut entries = Vec::with_capacity(keyed.len());
    offsets.push(0);
    let mut start = 0;
    for &end in &ends {
        let bucket = &mut keyed[start as usize..end as usize];
        start = end;
        sort(bucket);
        for (i, &key) in bucket.iter().enumerate() {
            if i > 0 && key >> 32 != bucket[i - 1] >> 32 {
                offsets.push(entries.len() as u32); // at most 3 × MAX_TRIANGLES
            }
            entries.push(Entry(key as u32));
        }
        if !bucket.is_empty() {
            offsets.push(entries.len() as u32);
        }
    }
    offsets.shrink_to_fit();
    let topology = Topology { vertex_count, triangles, offsets, entries, collapsed_faces };
    #[cfg(debug_assertions)]
    topology.validate();
    topology
}

struct Buckets {
    /// Where each vertex's bucket ends; it starts where the one before ends.
    ends: Vec<u32>,
    keyed: Vec<Keyed>,
}

/// Where the bucket of each vertex starts, and how many faces have collapsed.
fn bucket_starts(vertex_count: usize, triangles: &[[u32; 3]]) -> (Vec<u32>, usize) {
    let mut counts = vec![0_u32; vertex_count];
    let mut collapsed = 0;
    for &corners in triangles {
        if has_collapsed(corners) {
            assert!(
                corners.iter().all(|&v| (v as usize) < vertex_count),
                "{corners:?} of {vertex_count} vertices"
            );
            collapsed += 1;
            continue;
        }
        let [a, b, c] = corners;
        for (tail, head) in [(a, b), (b, c), (c, a)] {
            assert!((head as usize) < vertex_count, "vertex {head} of {vertex_count}");
            counts[tail.min(head) as usize] += 1;
        }
    }
    let mut sum = 0;
    for count in &mut counts {
        (sum, *count) = (sum + *count, sum);
    }
    (counts, collapsed)
}

/// Counting sort by the smaller vertex; the starts turn into the ends on the way.
fn scatter(mut starts: Vec<u32>, triangles: &[[u32; 3]]) -> Buckets {
    let total: usize = triangles.iter().filter(|&&corners| !has_collapsed(corners)).count() * 3;
    let mut keyed = vec![0; total];
    for (face, &corners) in triangles.iter().enumerate() {
        if has_collapsed(corners) {
            continue;
        }
        let [a, b, c] = corners;
        for (corner, (tail, head)) in [(a, b), (b, c), (c, a)].into_iter().enumerate() {
            let half_edge = (3 * face + corner) as u64;
            let place = &mut starts[tail.min(head) as usize];
            keyed[*place as usize] =
                u64::from(tail.max(head)) << 32 | half_edge << 1 | u64::from(tail > head);
            *place += 1;
        }
    }
    Buckets { ends: starts, keyed }
}

/// Buckets are short (about six) except at the hub of a fan.
#[inline]
fn sort(bucket: &mut [Keyed]) {
    const SHORT: usize = 20; // about where insertion sort stops winning
    if bucket.len() > SHORT {
        bucket.sort_unstable();
        return;
    }
    for i in 1..bucket.len() {
        let key = bucket[i];
        let mut j = i;
        while j > 0 && bucket[j - 1] > key {
            bucket[j] = bucket[j - 1];
            j -= 1;
        }
        bucket[j] = key;
    }
}
