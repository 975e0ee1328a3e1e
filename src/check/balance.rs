//! Randomized test for balance: one sum over all half-edges, without an edge table.
//!
//! Give each vertex v two random words x(v) and y(v), and each half-edge from a to b the value
//!
//! ```text
//! f(a, b) = x(a) y(b) − y(a) x(b) = −f(b, a)
//! ```
//!
//! If the two directions of an edge are used equally often they cancel, so the sum over a balanced mesh is
//! always 0. Let n(a, b) be the surplus of the direction from a to b. The sum over any mesh is that of
//! n(a, b) (x(a) y(b) − x(b) y(a)) over its edges a < b: a polynomial whose monomials are all different, and
//! so not the zero polynomial unless the mesh is balanced. It vanishes at few points: Schwartz, *Fast
//! Probabilistic Algorithms for Verification of Polynomial Identities*, 1980; Zippel, *Probabilistic
//! Algorithms for Sparse Polynomials*, 1979.
//!
//! Theirs is a bound over a field, and the sum here is one modulo 2³². Let 2^v be the largest power of two
//! that divides every surplus, and k = 32 − v. The sum is 2^v Σ x(a) w(a) with w(a) = Σ m(a, b) y(b) modulo
//! 2^k, where some m(a, b) is odd. Whatever the other words are, w(a) and w(b) are two independent uniform
//! words, as the one holds m y(b) and the other −m y(a). So 2^j divides all w with probability at most 4^−j.
//! If j is the largest such exponent, the sum is uniform over 2^(k − j) values, and vanishes with probability
//! 2^(j − k). Together that is at most 2^−k (1 + Σ 4^−j 2^(j − 1)) = 1.5 · 2^−k: 3.5 · 10⁻¹⁰ for an edge with
//! one face too many in one direction, and 7 · 10⁻¹⁰ if it is two, as with a face turned over. Surpluses that
//! are all multiples of a larger power of two need as many sheets on top of each other.
//!
//! Over a face f adds up to (x(b) − x(a))(y(c) − y(a)) − (x(c) − x(a))(y(b) − y(a)), twice the area of a
//! triangle in the plane of the words: two multiplications, and plainly 0 for a face with two equal corners.
//!
//! The words come from two or three multiplications, with keys drawn from the seed. Their randomness is an
//! assumption: tests examine many seeds and the arrangements of vertex numbers and coordinates that meshes
//! have, but whoever knows the seed can construct an unbalanced mesh that passes. Two different positions get
//! the same words with a probability of about 2⁻³¹ (two different numbers never do); on the two sides of a
//! crack that hides it, which is why [`Screen::ERROR`] is more than the bound above.

use multiversion::multiversion;

use crate::mesh::Mesh;
use crate::random::SplitMix64;

/// A randomized test whether a mesh is balanced: the sum of a random function over its half-edges.
///
/// Constant memory, one pass. Time: 11 multiplications of 32 bits per triangle, eight at a time with AVX2:
/// less than twice the time of reading the indices, and an order of magnitude less than
/// [`Topology::build`](crate::topology::Topology::build). A mesh reported unbalanced is unbalanced; a mesh
/// reported balanced is unbalanced with a probability of at most [`Screen::ERROR`]. The same seed gives the
/// same answer everywhere; a second test with another seed multiplies the probabilities.
///
/// ```
/// use umbrage::testing::shapes;
/// use umbrage::check::Screen;
/// assert!(Screen::default().indices(shapes::cube().triangles()));
/// assert!(!Screen::default().indices(shapes::open_cube().triangles()));
/// let soup = shapes::soup(&shapes::cube());
/// assert!(Screen::default().positions(&soup) && !Screen::default().indices(soup.triangles()));
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Screen {
    seed: u64,
}

/// Faces per block: few enough for the first-level cache.
const BLOCK: usize = 32;

/// The lower half of a word.
const LOW: u64 = u32::MAX as u64;

impl Screen {
    /// Upper bound on the probability that an unbalanced mesh is reported balanced, for a seed drawn after
    /// the mesh was made and if no edge has a surplus of more than two.
    pub const ERROR: f64 = 1e-8;

    /// A screen whose random numbers are drawn from `seed`. The default one's is 0.
    #[must_use]
    pub fn new(seed: u64) -> Self {
        Self { seed }
    }

    /// Whether `triangles` are balanced: whether at every edge (a pair of vertex numbers) the two directions
    /// are used equally often.
    #[must_use]
    pub fn indices(self, triangles: &[[u32; 3]]) -> bool {
        sum_of_indices(&Keys::of(self.seed), triangles) == 0
    }

    /// Whether `mesh` is balanced if vertices with bit-equal positions in every frame count as one vertex, as
    /// under [`Weld::Exact`](crate::mesh::Weld::Exact).
    #[must_use]
    pub fn positions(self, mesh: &Mesh) -> bool {
        sum_of_positions(self.seed, mesh) as u32 == 0
    }
}

/// Keys of the hash from a vertex to its words.
struct Keys {
    /// Turns bits of the number before the first multiplication: twice the same 32 bits.
    flip: u64,
    /// Turns bits of a factor of the second one.
    turn: u64,
}

impl Keys {
    fn of(seed: u64) -> Self {
        let mut random = SplitMix64(seed);
        let flip = random.next() & LOW;
        Self { flip: flip << 32 | flip, turn: random.next() }
    }

    /// The two words of a vertex, in the lower halves, from 64 bits that differ for each vertex.
    ///
    /// The words are the halves of a product of the bits and the bits with some flipped: if the second factor
    /// were a key alone, equally spaced vertices would often have words on one line.
    #[inline(always)]
    fn words(&self, bits: u64) -> [u64; 2] {
        let x = bits ^ bits >> 32;
        [x, ((x & LOW) * ((bits ^ self.turn) & LOW)) >> 32]
    }

    /// The two words of a vertex number; the first words of different numbers differ.
    ///
    /// A word has 32 bits like the number, so that a vector register holds as many as it can. Halves are
    /// folded over each other because the low bits of a product do not depend on the high bits of its
    /// factors.
    #[inline(always)]
    fn words_of_number(&self, number: u32) -> [u32; 2] {
        // 2³² over the golden ratio (Knuth, *The Art of Computer Programming* 3, section 6.4), and a factor
        // of MurmurHash3 (Austin Appleby, 2011).
        let once = (number ^ self.flip as u32).wrapping_mul(0x9e37_79b1);
        let twice = (once ^ once >> 16).wrapping_mul(0x85eb_ca6b);
        let x = twice ^ twice >> 16;
        // Not linear in x: equally spaced words would lie on one line.
        let y = x.wrapping_mul(x ^ self.turn as u32);
        [x, y ^ y >> 16]
    }
}

/// The sum of f over a face; its lower half counts.
#[inline(always)]
fn area(a: [u64; 2], b: [u64; 2], c: [u64; 2]) -> u64 {
    // Products of halves are one instruction for two lanes.
    let minus = |x: u64, y: u64| x.wrapping_sub(y) & LOW;
    (minus(b[0], a[0]) * minus(c[1], a[1])).wrapping_sub(minus(c[0], a[0]) * minus(b[1], a[1]))
}

/// The sum over all faces.
#[multiversion(targets("x86_64+avx2+bmi1+bmi2"))]
fn sum_of_indices(keys: &Keys, triangles: &[[u32; 3]]) -> u32 {
    let mut sum = 0_u32;
    for &[a, b, c] in triangles {
        // (Three calls: `map` on an array would not be vectorized.)
        let (a, b, c) = (keys.words_of_number(a), keys.words_of_number(b), keys.words_of_number(c));
        let minus = u32::wrapping_sub;
        let one = minus(b[0], a[0]).wrapping_mul(minus(c[1], a[1]));
        let other = minus(c[0], a[0]).wrapping_mul(minus(b[1], a[1]));
        sum = sum.wrapping_add(one).wrapping_sub(other);
    }
    sum
}

/// The sum over all faces, with words made of the bits of the positions.
#[multiversion(targets("x86_64+avx2+bmi1+bmi2"))]
fn sum_of_positions(seed: u64, mesh: &Mesh) -> u64 {
    let keys = &Keys::of(seed);
    let mut random = SplitMix64(!seed);
    let mut factors = || [(); 3].map(|()| u64::from(random.next() as u32 | 1));
    let frames: Vec<(&[[f32; 3]], [u64; 3])> = std::iter::once(mesh.positions())
        .chain(mesh.frames().iter().map(Vec::as_slice))
        .map(|positions| (positions, factors()))
        .collect();
    let mut sum = 0_u64;
    // The coordinates x and y of each corner in one word, z in another.
    let (mut firsts, mut thirds) = ([[0_u64; BLOCK]; 3], [[0_u64; BLOCK]; 3]);
    for faces in mesh.triangles().chunks(BLOCK) {
        if faces.len() < BLOCK {
            // Collapsed faces, which add nothing, fill the last block.
            (firsts, thirds) = ([[0; BLOCK]; 3], [[0; BLOCK]; 3]);
        }
        // A linear form of all coordinates, with keys from the seed.
        let mut bits = [[keys.flip; BLOCK]; 3];
        for &(positions, [fx, fy, fz]) in &frames {
            for (i, corners) in faces.iter().enumerate() {
                for corner in 0..3 {
                    // (A loop: closures on arrays are not always inlined.)
                    let [x, y, z] = positions[corners[corner] as usize];
                    firsts[corner][i] = u64::from(x.to_bits()) | u64::from(y.to_bits()) << 32;
                    thirds[corner][i] = u64::from(z.to_bits());
                }
            }
            for corner in 0..3 {
                for i in 0..BLOCK {
                    let first = firsts[corner][i];
                    let form = ((first & LOW) * fx)
                        .wrapping_add((first >> 32) * fy)
                        .wrapping_add(thirds[corner][i] * fz);
                    bits[corner][i] = bits[corner][i].wrapping_add(form);
                }
            }
        }
        for i in 0..BLOCK {
            let (a, b, c) = (keys.words(bits[0][i]), keys.words(bits[1][i]), keys.words(bits[2][i]));
            sum = sum.wrapping_add(area(a, b, c));
        }
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Over many seeds the sum of an unbalanced mesh must look random: any twelve bits of it are 0 in 1 of
    /// 4096 seeds or a few more (the bound above allows for 1.5 and 3 times as many), and all 32 bits never.
    fn zeros(sum: impl Fn(u64) -> u64) -> [usize; 3] {
        const SEEDS: u64 = 1 << 15;
        let mut zeros = [0; 3];
        for seed in 0..SEEDS {
            let sum = sum(seed) as u32;
            for (zeros, part) in zeros.iter_mut().zip([sum, sum & 0xfff, sum >> 20]) {
                *zeros += usize::from(part == 0);
            }
        }
        zeros
    }

    fn assert_random([all, low, high]: [usize; 3], what: &dyn std::fmt::Debug) {
        // 8 are expected; 70 would be eight standard deviations above three times as many.
        assert!(all == 0 && low < 70 && high < 40, "{all} {low} {high} of {what:?}");
    }

    #[test]
    fn screen_sums_look_random_where_vertices_are_numbered_as_in_meshes() {
        // Holes at small numbers, at equal steps, at large ones; pairs of holes that are copies of each
        // other.
        for faces in [
            &[[0, 1, 2]][..],
            &[[0, 2, 4]],
            &[[0, 64, 65]],
            &[[0, 1 << 16, 2 << 16]],
            &[[0, 1 << 30, 1 << 31]],
            &[[0, 1, 2], [100, 102, 101]],
            &[[0, 1, 64], [256, 320, 257]],
            &[[0, 1, 65], [0, 65, 64], [4, 69, 5], [4, 68, 69]],
        ] {
            assert_random(zeros(|seed| sum_of_indices(&Keys::of(seed), faces).into()), &faces);
        }
    }

    #[test]
    fn screen_sum_is_that_of_all_half_edges_one_by_one() {
        let keys = Keys::of(3);
        let naive = |faces: &[[u32; 3]]| {
            let value = |a: u32, b: u32| {
                let ([ax, ay], [bx, by]) =
                    (keys.words_of_number(a).map(i128::from), keys.words_of_number(b).map(i128::from));
                ax * by - ay * bx
            };
            let sum: i128 = faces.iter().map(|&[a, b, c]| value(a, b) + value(b, c) + value(c, a)).sum();
            sum as u32
        };
        let mut random = SplitMix64(4);
        for count in 0..200 {
            let mut faces: Vec<[u32; 3]> =
                (0..count).map(|_| [(); 3].map(|()| random.next() as u32)).collect();
            let sum = sum_of_indices(&keys, &faces);
            assert_eq!(sum, naive(&faces), "{count} faces");
            // Fault injected: the last face turned over.
            if let Some(last) = faces.last_mut() {
                last.swap(0, 1);
                assert_ne!(sum, naive(&faces), "{count} faces");
            }
        }
    }

    #[test]
    fn screen_sums_look_random_where_positions_lie_on_a_grid() {
        let shift = |by: f32, faces: &[[[f32; 3]; 3]]| -> Vec<[[f32; 3]; 3]> {
            faces.iter().map(|&[a, b, c]| [a, c, b].map(|[x, y, z]| [x, y, z + by])).collect()
        };
        let corner = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        let line = [[4.0; 3], [5.0, 4.0, 4.0], [6.0, 4.0, 4.0]];
        let tiny = [[1e-38, 0.0, 0.0], [2e-38, 0.0, 0.0], [0.0, 4e-38, 0.0]];
        for faces in [vec![corner], vec![line], vec![tiny], [vec![corner], shift(1.0, &[corner])].concat()] {
            let count = faces.len() as u32;
            let triangles = (0..count).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
            let mesh = Mesh::new(faces.as_flattened().to_vec(), triangles).unwrap();
            assert_random(zeros(|seed| sum_of_positions(seed, &mesh)), &faces);
        }
    }

    #[test]
    fn screen_words_on_a_line_would_be_seen() {
        // Fault injected: words that depend on each other linearly. Then every area is 0.
        let words = |number: u32, seed: u64| [u64::from(number) + seed, u64::from(number) * 3];
        let sum = zeros(|seed| area(words(0, seed), words(1, seed), words(2, seed)));
        assert!(std::panic::catch_unwind(|| assert_random(sum, &())).is_err(), "{sum:?}");
    }
}
