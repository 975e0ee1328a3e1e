//! Vertices at one place become one vertex, so that faces which touch in space are neighbours in topology.

use hashbrown::{DefaultHashBuilder, HashMap, HashSet};
use std::hash::BuildHasher;

use super::{Mesh, VertexId};

/// Which vertices are the same.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Weld {
    /// Bit-equal positions, in every frame.
    #[default]
    Exact,
    /// Only equal indices: the file's own topology.
    None,
    /// Positions at most this far apart (mesh units, in every frame). Going through the vertices in order,
    /// each joins the lowest-numbered kept vertex within reach, or is kept itself: nothing moves farther than
    /// the distance, and there are no chains.
    Within(f32),
}

/// A welded mesh: no two vertices are the same, and every vertex belongs to a face.
#[derive(Clone, Debug)]
pub struct Welded {
    /// Positions of the kept vertices, faces in the order of the original with welded indices.
    pub mesh: Mesh,
    /// For each vertex of the original the vertex it became, or [`UNUSED`].
    vertex_of: Vec<u32>,
}

impl Welded {
    /// What a vertex of the original became; `None` if no face uses it.
    ///
    /// # Panics
    ///
    /// Panics if the original has no such vertex.
    #[must_use]
    pub fn vertex_of(&self, original: VertexId) -> Option<VertexId> {
        let vertex = self.vertex_of[original.index()];
        (vertex != UNUSED).then_some(VertexId(vertex))
    }

    /// How many vertices of the original no face uses.
    #[must_use]
    pub fn unreferenced(&self) -> usize {
        self.vertex_of.iter().filter(|&&vertex| vertex == UNUSED).count()
    }
}

/// Merges vertices. Expected linear time; kept vertices stay in their order.
///
/// Vertices that no face references are left out.
///
/// Memory: at its peak 33 bytes a face of a closed mesh, the result included, and at most 260 where no vertex is
/// shared; 400 with a distance.
///
/// ```
/// use umbrage::mesh::{Weld, solid, weld};
/// let soup = solid::soup(&solid::cube());
/// assert_eq!((soup.vertex_count(), weld(&soup, Weld::Exact).mesh.vertex_count()), (36, 8));
/// ```
#[must_use]
pub fn weld(mesh: &Mesh, how: Weld) -> Welded {
    let mut referenced = vec![false; mesh.vertex_count()];
    mesh.triangles().iter().flatten().for_each(|&vertex| referenced[vertex as usize] = true);
    let (vertex_of, kept) = match how {
        Weld::None => merge(&referenced, |_, _| None),
        Weld::Exact => exact(mesh, &referenced),
        Weld::Within(distance) if distance > 0.0 => {
            let frames: Vec<&[[f32; 3]]> =
                std::iter::once(mesh.positions()).chain(mesh.frames.iter().map(Vec::as_slice)).collect();
            within(&frames, &referenced, f64::from(distance))
        }
        Weld::Within(_) => exact(mesh, &referenced),
    };
    drop(referenced);
    let pick = |from: &[[f32; 3]]| kept.iter().map(|&vertex| from[vertex as usize]).collect::<Vec<_>>();
    // (Spelt out: `map` of an array is not always inlined.)
    let welded_of = |vertex: u32| vertex_of[vertex as usize];
    let triangles =
        mesh.triangles().iter().map(|&[a, b, c]| [welded_of(a), welded_of(b), welded_of(c)]).collect();
    let welded = Mesh {
        name: mesh.name.clone(),
        positions: pick(&mesh.positions),
        triangles,
        parts: mesh.parts.clone(),
        frames: mesh.frames.iter().map(|frame| pick(frame)).collect(),
    };
    Welded { mesh: welded, vertex_of }
}

/// For each point the number of the kept point that it joins, by the scheme of [`Weld::Within`].
pub(crate) fn weld_points(points: &[[f32; 3]], distance: f64) -> Vec<u32> {
    within(&[points], &vec![true; points.len()], distance).0
}

/// A mark that no vertex id reaches, see [`Mesh::new`].
const UNUSED: u32 = u32::MAX;

/// Goes through the referenced vertices in order. `find(vertex, new)` tells the welded vertex that `vertex`
/// joins, or `None` if it is kept as `new`. Gives each vertex's welded id, and each welded vertex's origin.
fn merge(referenced: &[bool], mut find: impl FnMut(u32, u32) -> Option<u32>) -> (Vec<u32>, Vec<u32>) {
    let mut vertex_of = vec![UNUSED; referenced.len()];
    let mut kept = Vec::new();
    for (vertex, _) in referenced.iter().enumerate().filter(|(_, used)| **used) {
        let new = kept.len() as u32; // below the vertex count, which fits
        vertex_of[vertex] = find(vertex as u32, new).unwrap_or_else(|| {
            kept.push(vertex as u32);
            new
        });
    }
    (vertex_of, kept)
}

fn exact(mesh: &Mesh, referenced: &[bool]) -> (Vec<u32>, Vec<u32>) {
    // Seeded by chance, so that no file can be made to collide; ids do not depend on it.
    let seeds: [u64; 2] = [0, 1].map(|i| DefaultHashBuilder::default().hash_one(i));
    let bits = |vertex: u32| {
        let [x, y, z] = mesh.positions[vertex as usize];
        [x.to_bits(), y.to_bits(), z.to_bits()]
    };
    let hash = |key: [u32; 3], vertex: u32| {
        let mix = |hash: u64, [x, y, z]: [u32; 3]| {
            // Both halves of a product with seeded factors, as foldhash and wyhash do.
            let left = u64::from(x) << 32 | u64::from(y);
            let product = u128::from(left ^ seeds[0]) * u128::from(u64::from(z) ^ hash);
            (product >> 64) as u64 ^ product as u64
        };
        let more = |hash, frame: &Vec<[f32; 3]>| mix(hash, frame[vertex as usize].map(f32::to_bits));
        mesh.frames.iter().fold(mix(seeds[1], key), more)
    };
    let still = mesh.frames.is_empty();
    let same_frames = |a: u32, b: u32| {
        let same = |frame: &Vec<[f32; 3]>| {
            frame[a as usize].map(f32::to_bits) == frame[b as usize].map(f32::to_bits)
        };
        mesh.frames.iter().all(same)
    };
    let used = referenced.iter().filter(|&&used| used).count();
    let mut table = Table::for_about(used / 6); // a closed soup has six corners a vertex
    // Each kept vertex's bits, and where it comes from.
    let mut kept: Vec<([u32; 3], u32)> = Vec::with_capacity(used / 6);
    let mut vertex_of = vec![UNUSED; referenced.len()];

    // A look-up waits for memory twice: for the table, and for the kept vertex that it names. So a block of them
    // is looked up ahead, all waiting at once, and then settled in order; a vertex that came into the table in
    // between is found by looking again.
    const BLOCK: usize = 32;
    let (mut block, mut keys, mut hashes) = ([0_u32; BLOCK], [[0; 3]; BLOCK], [0; BLOCK]);
    let (mut guesses, mut candidates) = ([UNUSED; BLOCK], [([0; 3], UNUSED); BLOCK]);
    let mut next = 0;
    while next < referenced.len() {
        let mut count = 0;
        while count < BLOCK && next < referenced.len() {
            block[count] = next as u32; // vertices are fewer than 2³²
            count += usize::from(referenced[next]);
            next += 1;
        }
        for i in 0..count {
            keys[i] = bits(block[i]);
            hashes[i] = hash(keys[i], block[i]);
        }
        for i in 0..count {
            guesses[i] = table.first(hashes[i]);
        }
        for i in 0..count {
            candidates[i] = kept.get(guesses[i] as usize).copied().unwrap_or(([0; 3], UNUSED));
        }
        for i in 0..count {
            let (vertex, key) = (block[i], keys[i]);
            let same =
                |(other, origin): ([u32; 3], u32)| other == key && (still || same_frames(origin, vertex));
            vertex_of[vertex as usize] = if candidates[i].1 != UNUSED && same(candidates[i]) {
                guesses[i]
            } else {
                let new = kept.len() as u32; // below the vertex count, which fits
                let id = table.find_or_insert(hashes[i], new, |id| same(kept[id as usize]));
                if id == new {
                    kept.push((key, vertex));
                }
                id
            };
        }
        if table.is_full(kept.len() + BLOCK) {
            table.grow(kept.iter().map(|&(key, origin)| hash(key, origin)));
        }
    }
    (vertex_of, kept.into_iter().map(|(_, origin)| origin).collect())
}

/// Ids by hash: open addressing with linear probing, a power of two of slots, at most half of them taken. So an id
/// needs fewer bits than a slot has; the others hold bits of the hash, so that hardly any other vertex is looked at
/// in vain.
struct Table {
    slots: Vec<u32>,
    /// Ones where a slot holds the id.
    id_bits: u32,
}

/// A slot without an id: no id has ones only, as that many do not fit.
const EMPTY: u32 = u32::MAX;

impl Table {
    fn for_about(ids: usize) -> Self {
        Self::with_slots((2 * ids).next_power_of_two().max(256))
    }

    fn with_slots(slots: usize) -> Self {
        Self { slots: vec![EMPTY; slots], id_bits: (slots / 2 - 1) as u32 } // ids fit 32 bits
    }

    /// Whether another id would be one too many, or nearly.
    fn is_full(&self, ids: usize) -> bool {
        2 * ids >= self.slots.len()
    }

    /// The id in the first place where `hash` may be, if it belongs there, or one that there cannot be.
    #[inline]
    fn first(&self, hash: u64) -> u32 {
        let slot = self.slots[hash as usize & (self.slots.len() - 1)];
        if self.is_of(slot, hash) { slot & self.id_bits } else { UNUSED }
    }

    #[inline]
    fn is_of(&self, slot: u32, hash: u64) -> bool {
        (slot ^ (hash >> 32) as u32) & !self.id_bits == 0
    }

    /// The id for which `same` holds, if it is there; otherwise `new`, which is put in its place.
    #[inline]
    fn find_or_insert(&mut self, hash: u64, new: u32, same: impl Fn(u32) -> bool) -> u32 {
        let mask = self.slots.len() - 1;
        let mut at = hash as usize & mask;
        loop {
            let slot = self.slots[at];
            if slot == EMPTY {
                self.slots[at] = (hash >> 32) as u32 & !self.id_bits | new;
                return new;
            }
            if self.is_of(slot, hash) && same(slot & self.id_bits) {
                return slot & self.id_bits;
            }
            at = (at + 1) & mask;
        }
    }

    /// Twice as many slots, filled anew with the hashes of the ids 0, 1, 2, …
    fn grow(&mut self, hashes: impl Iterator<Item = u64>) {
        *self = Self::with_slots(2 * self.slots.len());
        for (id, hash) in (0..).zip(hashes) {
            self.find_or_insert(hash, id, |_| false);
        }
    }
}

/// Kept vertices lie more than `distance` apart (in some frame), so a cell of that size holds few of them and
/// those in reach lie in the 27 cells around.
fn within(frames: &[&[[f32; 3]]], referenced: &[bool], distance: f64) -> (Vec<u32>, Vec<u32>) {
    let near = |a: u32, b: u32| {
        frames.iter().all(|frame| {
            let square =
                |i: usize| (f64::from(frame[a as usize][i]) - f64::from(frame[b as usize][i])).powi(2);
            square(0) + square(1) + square(2) <= distance * distance
        })
    };
    // Cell numbers stay f64: where they pass 2^53 the f32 grid itself is coarser than the cells.
    let cell_in =
        |frame: &[[f32; 3]], vertex: usize| frame[vertex].map(|x| (f64::from(x) / distance).floor());
    // By any one frame, as those in reach are so in all; where vertices lie in one place in some frame, another
    // parts them. The first of those that part them best.
    let spread = |frame: &[[f32; 3]]| {
        let used = (0..referenced.len()).filter(|&vertex| referenced[vertex]);
        used.map(|vertex| cell_in(frame, vertex).map(cell_bits)).collect::<HashSet<_>>().len()
    };
    let key = match frames {
        [only] => only,
        _ => frames.iter().rev().max_by_key(|frame| spread(frame)).expect("the positions are there"),
    };
    let cell = |vertex: u32| cell_in(key, vertex as usize);
    let mut cells: HashMap<[u64; 3], Vec<(u32, u32)>> = HashMap::new();
    merge(referenced, |vertex, new| {
        let home = cell(vertex);
        let mut found: Option<u32> = None;
        for_each_neighbour(home, |key| {
            let Some(residents) = cells.get(&key) else { return };
            for &(other, welded) in residents {
                if found.is_none_or(|best| welded < best) && near(vertex, other) {
                    found = Some(welded);
                }
            }
        });
        if found.is_none() {
            cells.entry(home.map(cell_bits)).or_default().push((vertex, new));
        }
        found
    })
}

fn cell_bits(cell: f64) -> u64 {
    (cell + 0.0).to_bits()
}

fn for_each_neighbour(home: [f64; 3], mut visit: impl FnMut([u64; 3])) {
    // Beyond 2^53 adding one changes nothing, and a cell must not be visited twice.
    let axis = |x: f64| [Some(x), Some(x - 1.0).filter(|y| *y != x), Some(x + 1.0).filter(|y| *y != x)];
    for x in axis(home[0]).into_iter().flatten() {
        for y in axis(home[1]).into_iter().flatten() {
            for z in axis(home[2]).into_iter().flatten() {
                visit([x, y, z].map(cell_bits));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// The welded id of every vertex, by looking at all kept ones: `same` decides.
    fn naive(mesh: &Mesh, same: impl Fn(usize, usize) -> bool) -> Vec<Option<VertexId>> {
        let used = |v: usize| mesh.triangles().iter().flatten().any(|&corner| corner as usize == v);
        let mut kept: Vec<usize> = Vec::new();
        (0..mesh.vertex_count())
            .map(|v| {
                if !used(v) {
                    return None;
                }
                let id = kept.iter().position(|&other| same(other, v)).unwrap_or_else(|| {
                    kept.push(v);
                    kept.len() - 1
                });
                Some(VertexId::new(id))
            })
            .collect()
    }

    fn found(mesh: &Mesh, how: Weld) -> Vec<Option<VertexId>> {
        let welded = weld(mesh, how);
        for (old, new) in mesh.triangles().iter().zip(welded.mesh.triangles()) {
            assert_eq!(old.map(|v| welded.vertex_of(VertexId(v)).unwrap().0), *new);
        }
        (0..mesh.vertex_count()).map(|v| welded.vertex_of(VertexId::new(v))).collect()
    }

    /// Positions on a small grid, so that many coincide; enough of them to fill blocks and to grow the table.
    fn mesh() -> impl Strategy<Value = Mesh> {
        let place = || [0_u8..9, 0_u8..9, 0_u8..9].prop_map(|p| p.map(f32::from));
        let corner = || any::<u32>();
        (
            prop::collection::vec((place(), place()), 1..600),
            prop::collection::vec([corner(), corner(), corner()], 0..400),
            any::<bool>(),
        )
            .prop_map(|(places, picks, animated)| {
                let n = places.len() as u32;
                let (positions, frame): (Vec<_>, Vec<_>) = places.into_iter().unzip();
                let triangles = picks.into_iter().map(|t| t.map(|i| i % n)).collect();
                let frames = if animated {
                    vec![frame.into_iter().map(|[x, _, _]| [x % 2.0; 3]).collect()]
                } else {
                    vec![]
                };
                Mesh::new(positions, triangles).unwrap().with_frames(frames).unwrap()
            })
    }

    proptest! {
        #[test]
        fn weld_equals_looking_at_all_kept_vertices(mesh in mesh()) {
            let all = |test: &dyn Fn([f32; 3], [f32; 3]) -> bool, a: usize, b: usize| {
                test(mesh.positions()[a], mesh.positions()[b]) && mesh.frames().iter().all(|f| test(f[a], f[b]))
            };
            prop_assert_eq!(found(&mesh, Weld::Exact), naive(&mesh, |a, b| all(&|p, q| p == q, a, b)));
            let near = |p: [f32; 3], q: [f32; 3]| (0..3).map(|i| (p[i] - q[i]).powi(2)).sum::<f32>() <= 2.25;
            prop_assert_eq!(found(&mesh, Weld::Within(1.5)), naive(&mesh, |a, b| all(&near, a, b)));
            prop_assert_eq!(found(&mesh, Weld::None), naive(&mesh, |_, _| false));
        }
    }

    #[test]
    fn weld_within_where_the_positions_all_coincide_is_not_quadratic() {
        // One vertex a cell in the second frame; looking at all kept ones would take minutes for the larger.
        for (count, compared) in [(900_u32, true), (600_000, false)] {
            let apart = |v: u32| [(v / 3 % 1000) as f32, (v / 3000) as f32, (v % 3) as f32 * 0.4];
            let triangles = (0..count / 3).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
            let frames = vec![vec![[0.0; 3]; count as usize], (0..count).map(apart).collect()];
            let still = Mesh::new(vec![[0.0; 3]; count as usize], triangles).unwrap();
            let mesh = still.with_frames(frames).unwrap();
            let found = found(&mesh, Weld::Within(0.5));
            assert_eq!(weld(&mesh, Weld::Within(0.5)).mesh.vertex_count(), 2 * count as usize / 3);
            if compared {
                let moved = &mesh.frames()[1];
                let near = |a: usize, b: usize| {
                    let square = |i: usize| (moved[a][i] - moved[b][i]).powi(2);
                    square(0) + square(1) + square(2) <= 0.25
                };
                assert_eq!(found, naive(&mesh, near));
            }
        }
    }

    #[test]
    fn weld_that_forgets_a_frame_is_seen() {
        let positions = vec![[0.0; 3], [0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        let still = Mesh::new(positions.clone(), vec![[0, 2, 3], [1, 3, 2]]).unwrap();
        let parting = vec![vec![[0.0; 3], [5.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]];
        let moving = still.clone().with_frames(parting).unwrap();
        assert_eq!(naive(&moving, |a, b| positions[a] == positions[b]), found(&still, Weld::Exact));
        assert_ne!(found(&moving, Weld::Exact), found(&still, Weld::Exact));
    }
}
