//! Vertices of a place come soon after each other, as in a soup whose faces follow the surface: one table, and in
//! front of it a small one of those met last.

use super::exact::Points;
use super::table::{NO_ID, Table};
use super::{Merged, UNUSED, Used};

/// How many places the vertices met last have: 64 kB, in the second-level cache.
const LATEST_BITS: u32 = 12;

/// So many vertices are looked up side by side.
const BLOCK: usize = 32;

pub(super) fn merged(points: &Points<'_>, used: &Used) -> Merged {
    let expected = used.count() / 6; // a closed soup has six corners a vertex
    let mut table = Table::for_about(expected);
    // Where each kept vertex comes from.
    let mut kept: Vec<u32> = Vec::with_capacity(expected);
    // Where all are used, memory that comes zeroed and is not touched before its time.
    let mut vertex_of = vec![if used.referenced.is_none() { 0 } else { UNUSED }; used.len];
    // By hash: bits and welded id.
    let mut latest = vec![([0_u32; 3], NO_ID); 1 << LATEST_BITS];

    // A look-up waits for memory twice: for the table, and for the kept vertex that it names. So a block of them
    // is looked up ahead, all waiting at once, and then settled in order; a vertex that came into the table in
    // between is found by looking again.
    let (mut block, mut keys, mut hashes) = ([0_u32; BLOCK], [[0; 3]; BLOCK], [0; BLOCK]);
    let (mut guesses, mut candidates) = ([NO_ID; BLOCK], [UNUSED; BLOCK]);
    let mut same = [false; BLOCK];
    let mut next = 0;
    while next < used.len {
        let mut count = 0;
        while count < BLOCK && next < used.len {
            let vertex = next as u32; // vertices are fewer than 2³²
            next += 1;
            if !used.has(vertex) {
                continue;
            }
            let key = points.bits(vertex);
            let hash = points.hash(key, vertex);
            let (other, id) = latest[(hash >> (64 - LATEST_BITS)) as usize];
            if other == key && id != NO_ID && points.same_frames(kept[id as usize], vertex) {
                vertex_of[vertex as usize] = id;
                continue;
            }
            (block[count], keys[count], hashes[count]) = (vertex, key, hash);
            count += 1;
        }
        for i in 0..count {
            guesses[i] = table.first(hashes[i]);
        }
        for i in 0..count {
            candidates[i] = kept.get(guesses[i] as usize).copied().unwrap_or(UNUSED);
        }
        let is_same = |origin: u32, key: [u32; 3], vertex: u32| {
            points.bits(origin) == key && points.same_frames(origin, vertex)
        };
        for i in 0..count {
            same[i] = candidates[i] != UNUSED && is_same(candidates[i], keys[i], block[i]);
        }
        for i in 0..count {
            let (vertex, key, hash) = (block[i], keys[i], hashes[i]);
            let id = if same[i] {
                guesses[i]
            } else {
                let new = kept.len() as u32; // below the vertex count, which fits
                let id = table.find_or_insert(hash, new, |id| is_same(kept[id as usize], key, vertex));
                if id == new {
                    kept.push(vertex);
                }
                id
            };
            vertex_of[vertex as usize] = id;
            latest[(hash >> (64 - LATEST_BITS)) as usize] = (key, id);
        }
        if table.is_full(kept.len() + BLOCK) {
            table.grow(kept.iter().map(|&origin| points.hash(points.bits(origin), origin)));
        }
    }
    Merged { vertex_of, kept }
}
