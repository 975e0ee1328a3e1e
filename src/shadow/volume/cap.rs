//! Both caps of a volume, written in one pass over all faces.
//!
//! Casting faces are counted first, so that the slots of the triangles of every run of faces are known:
//! threads write to disjoint parts of the buffers, and each thread writes in order.

use crate::parallel;
use crate::topology::has_collapsed;

/// Faces per count.
const CHUNK: usize = 1024;
/// Faces per block: they stay in the first-level cache.
const BLOCK: usize = 64;
/// Chunks that one thread writes: tens of microseconds, several times what it takes to wake it.
const GRAIN: usize = 32;

/// Faces that may cast.
#[derive(Clone, Copy)]
pub(super) struct CapFaces<'a> {
    pub(super) triangles: &'a [[u32; 3]],
    pub(super) signs: &'a [i8],
    /// Whether some of them have collapsed.
    pub(super) collapsed: bool,
    /// What [`count`] found.
    pub(super) starts: &'a [u32],
}

/// Counts the casting faces. `starts` receives the count before each chunk of [`CHUNK`] faces, and at last
/// the total.
pub(super) fn count(triangles: &[[u32; 3]], signs: &[i8], collapsed: bool, starts: &mut Vec<u32>) -> usize {
    starts.clear();
    starts.push(0);
    let mut sum = 0;
    for (triangles, signs) in triangles.chunks(CHUNK).zip(signs.chunks(CHUNK)) {
        sum += if collapsed {
            triangles.iter().zip(signs).filter(|(face, sign)| **sign != 0 && !has_collapsed(**face)).count()
        } else {
            // A byte counts to 255.
            let nonzero = |part: &[i8]| part.iter().fold(0, |sum, &sign| sum + u8::from(sign != 0));
            signs.chunks(128).map(|part| usize::from(nonzero(part))).sum()
        } as u32; // fewer than there are faces
        starts.push(sum);
    }
    sum as usize
}

impl CapFaces<'_> {
    /// Whether several threads pay.
    pub(super) fn are_many(&self) -> bool {
        self.starts.len() > 2 * GRAIN
    }

    fn split(self, chunk: usize) -> [Self; 2] {
        let (triangles, signs) = (self.triangles.split_at(chunk * CHUNK), self.signs.split_at(chunk * CHUNK));
        [
            Self { triangles: triangles.0, signs: signs.0, starts: &self.starts[..=chunk], ..self },
            Self { triangles: triangles.1, signs: signs.1, starts: &self.starts[chunk..], ..self },
        ]
    }
}

/// Writes the casting faces, turned towards the light, with the numbers of their vertices; and, unless there
/// is no dark cap, the same reversed, with `shift` added to each number.
pub(super) fn fill(
    faces: CapFaces<'_>,
    number: impl Fn(u32) -> u32 + Copy + Send + Sync,
    shift: u32,
    light: &mut [[u32; 3]],
    dark: &mut [[u32; 3]],
) {
    if !faces.are_many() {
        return fill_in_order(faces, number, shift, light, dark);
    }
    let half = faces.starts.len() / 2;
    let place = (faces.starts[half] - faces.starts[0]) as usize;
    let [left, right] = faces.split(half);
    let (light, dark) = (light.split_at_mut(place), dark.split_at_mut(place.min(dark.len())));
    parallel::join(
        || fill(left, number, shift, light.0, dark.0),
        || fill(right, number, shift, light.1, dark.1),
    );
}

fn fill_in_order(
    faces: CapFaces<'_>,
    number: impl Fn(u32) -> u32 + Copy,
    shift: u32,
    mut light: &mut [[u32; 3]],
    mut dark: &mut [[u32; 3]],
) {
    for (triangles, signs) in faces.triangles.chunks(BLOCK).zip(faces.signs.chunks(BLOCK)) {
        let mut count: usize = signs.iter().fold(0, |sum, &sign| sum + u8::from(sign != 0)).into();
        let mut picks = [0; BLOCK + 8];
        let all = count == signs.len() && !faces.collapsed;
        if !all && count > 0 {
            count = pick(signs, &mut picks);
            if faces.collapsed {
                let mut kept = 0;
                for i in 0..count {
                    let place = picks[i];
                    picks[kept] = place;
                    kept += usize::from(!has_collapsed(triangles[place as usize]));
                }
                count = kept;
            }
        }
        let light = light.split_off_mut(..count).expect("they were counted");
        let dark_count = count.min(dark.len());
        let dark = dark.split_off_mut(..dark_count).expect("no more than there are");
        if all {
            let numbered = triangles.iter().map(|triangle| triangle.map(number));
            emit(numbered.zip(signs.iter().copied()), shift, light, dark);
        } else {
            let picked = |&place: &u8| (triangles[place as usize].map(number), signs[place as usize]);
            emit(picks.iter().map(picked), shift, light, dark);
        }
    }
}

/// Writes the indices of the non-zero signs of a block, ascending, and returns their number. Entries past it
/// are unspecified.
///
/// Eight at a time, as words of eight bytes: in a mesh whose faces are in random order, branches on their
/// signs would be mispredicted and cost more than the rest.
#[inline(always)]
fn pick(signs: &[i8], picks: &mut [u8; BLOCK + 8]) -> usize {
    const ONES: u64 = 0x0101_0101_0101_0101;
    let (eights, rest) = signs.as_chunks::<8>();
    let mut count = 0;
    for (group, eight) in (0..).zip(eights) {
        let word = u64::from_le_bytes(eight.map(i8::cast_unsigned));
        // The top bit of each byte that is not 0, moved down.
        let nonzero = ((((word & (0x7f * ONES)) + 0x7f * ONES) | word) >> 7) & ONES;
        // One product brings the eight bits together, the other adds them up.
        let places = PLACES[(nonzero.wrapping_mul(0x0102_0408_1020_4080) >> 56) as usize];
        let room = picks[count..].first_chunk_mut().expect("there is slack");
        *room = (u64::from_le_bytes(places) + 8 * group * ONES).to_le_bytes();
        count += (nonzero.wrapping_mul(ONES) >> 56) as usize;
    }
    for (place, sign) in (8 * eights.len() as u8..).zip(rest) {
        picks[count] = place;
        count += usize::from(*sign != 0);
    }
    count
}

/// For each byte, the indices of its bits that are set, ascending.
const PLACES: [[u8; 8]; 256] = {
    let mut table = [[0; 8]; 256];
    let mut byte = 0;
    while byte < 256 {
        let (mut bit, mut count) = (0, 0);
        while bit < 8 {
            if byte >> bit & 1 != 0 {
                table[byte][count] = bit as u8;
                count += 1;
            }
            bit += 1;
        }
        byte += 1;
    }
    table
};

/// Writes numbered faces into both caps. A face is reversed by swapping its last two corners: a rotation of
/// the word of both by half its width.
#[inline(always)]
fn emit(
    faces: impl Iterator<Item = ([u32; 3], i8)>,
    shift: u32,
    light: &mut [[u32; 3]],
    dark: &mut [[u32; 3]],
) {
    let turned = |([a, b, c], sign): ([u32; 3], i8)| {
        let half_a_turn = u32::from((sign as u8) >> 2 & 32); // where the sign bit is set
        (a, (u64::from(b) | u64::from(c) << 32).rotate_left(half_a_turn))
    };
    let triangle = |a, rest: u64| [a, rest as u32, (rest >> 32) as u32];
    if dark.is_empty() {
        for (near, face) in light.iter_mut().zip(faces) {
            let (a, rest) = turned(face);
            *near = triangle(a, rest);
        }
    } else {
        // No sum overflows its half: vertices at infinity have 32-bit indices too.
        let shifts = u64::from(shift) << 32 | u64::from(shift);
        for ((near, far), face) in light.iter_mut().zip(dark).zip(faces) {
            let (a, rest) = turned(face);
            *near = triangle(a, rest);
            *far = triangle(a + shift, rest.rotate_left(32).wrapping_add(shifts));
        }
    }
}

/// A triangle, or the same triangle reversed.
#[inline]
pub(super) fn turned([a, b, c]: [u32; 3], reverse: bool) -> [u32; 3] {
    if reverse { [a, c, b] } else { [a, b, c] }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::SplitMix64;

    #[test]
    fn cap_picks_are_the_signs_that_are_not_zero() {
        let mut random = SplitMix64(1);
        for _ in 0..2000 {
            let zeros = random.below(4);
            let mut signs: Vec<i8> = (0..=random.below(BLOCK)).map(|_| random.next() as i8).collect();
            signs.iter_mut().filter(|_| random.below(4) < zeros).for_each(|sign| *sign = 0);
            let naive: Vec<u8> =
                (0..).zip(&signs).filter(|(_, sign)| **sign != 0).map(|(place, _)| place).collect();
            let mut picks = [0xee; BLOCK + 8];
            let count = pick(&signs, &mut picks);
            assert_eq!(&picks[..count], &naive, "{signs:?}");
            // The fault injected: one sign more or less.
            let place = random.below(signs.len());
            signs[place] = i8::from(signs[place] == 0);
            let count = pick(&signs, &mut picks);
            assert_ne!(&picks[..count], &naive, "{signs:?}");
        }
    }
}
