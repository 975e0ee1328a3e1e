//! Mode 0, attributes: differences between the bytes of consecutive elements, plane by plane.
//!
//! Elements come in blocks. In a block, each byte of the element has a plane of its own, in groups of 16
//! differences that are stored in few bits; a difference that does not fit is a sentinel, and follows as a
//! byte. Version 1 adds planes that are empty or stored as they are, and differences of two and four bytes.

use super::{LONG, Layout, Malformed, SHORT, take};

const GROUP: usize = 16;
/// The most elements of a block, and its most bytes.
const BLOCK_ELEMENTS: usize = 256;
const BLOCK_BYTES: usize = 8192;

/// What the stream's first byte and last ones say.
struct Header<'a> {
    /// Version 1 of the codec, with control bytes and channels.
    versioned: bool,
    /// The element that the first one is a difference from.
    baseline: &'a [u8],
    /// A mode for each four bytes of the element; none in version 0.
    channels: &'a [u8],
    /// The blocks.
    body: &'a [u8],
}

impl<'a> Header<'a> {
    fn of(stream: &'a [u8], stride: usize) -> Result<Self, Malformed> {
        let (versioned, least) = match stream.first() {
            Some(0xa0) => (false, 32),
            Some(0xa1) => (true, 24),
            Some(_) => return Err("the first byte is not that of attributes"),
            None => return Err(SHORT),
        };
        let tail = stride + if versioned { stride / 4 } else { 0 };
        let padded = stream.len().checked_sub(tail.max(least)).filter(|&end| end > 0).ok_or(SHORT)?;
        let (baseline, channels) = stream[stream.len() - tail..].split_at(stride);
        Ok(Self { versioned, baseline, channels, body: &stream[1..padded] })
    }
}

/// How many elements a block of full size has.
fn block_elements(stride: usize) -> usize {
    (BLOCK_BYTES / stride / GROUP * GROUP).min(BLOCK_ELEMENTS)
}

/// The fewest bytes that this many elements can take; `None` if that is beyond any stream.
pub(super) fn least_bytes(stream: &[u8], Layout { count, stride }: Layout) -> Option<usize> {
    let (most, blocks) = (block_elements(stride), count.div_ceil(block_elements(stride)));
    let (block, tail) = match stream.first() {
        // A header of two bits a group for each plane, which may be all; the last block may have fewer.
        Some(0xa0) => {
            let header = |elements: usize| elements.div_ceil(GROUP).div_ceil(4);
            let full = (count / most).checked_mul(header(most))?;
            return full
                .checked_add(header(count % most))?
                .checked_mul(stride)?
                .checked_add(1 + stride.max(32));
        }
        _ => (stride / 4, (stride + stride / 4).max(24)),
    };
    blocks.checked_mul(block)?.checked_add(1 + tail)
}

/// The elements of a stream that is long enough for `least_bytes`.
pub(super) fn decode(stream: &[u8], Layout { count, stride }: Layout) -> Result<Vec<u8>, Malformed> {
    let header = Header::of(stream, stride)?;
    let channel = |at: usize| Channel::of(header.channels.get(at / 4).copied().unwrap_or(0));
    for at in (0..stride).step_by(4) {
        channel(at)?;
    }
    let mut body = header.body;
    let mut elements = Vec::with_capacity(count * stride);
    let mut last = header.baseline.to_vec();
    let mut planes = vec![[0_u8; BLOCK_ELEMENTS]; stride];
    while elements.len() < count * stride {
        let here = block_elements(stride).min(count - elements.len() / stride);
        let controls = if header.versioned { take(&mut body, stride / 4)? } else { &[] };
        for (at, plane) in planes.iter_mut().enumerate() {
            let widths = match header.versioned {
                false => [0, 2, 4, 8],
                true => match controls[at / 4] >> (2 * (at % 4)) & 3 {
                    0 => [0, 1, 2, 4],
                    1 => [1, 2, 4, 8],
                    2 => {
                        plane.fill(0);
                        continue;
                    }
                    _ => {
                        plane[..here].copy_from_slice(take(&mut body, here)?);
                        continue;
                    }
                },
            };
            read_plane(&mut body, &mut plane[..here.next_multiple_of(GROUP)], widths)?;
        }
        for element in 0..here {
            for at in (0..stride).step_by(4) {
                let difference = std::array::from_fn(|byte| planes[at + byte][element]);
                let before = last[at..at + 4].try_into().expect("four bytes");
                last[at..at + 4].copy_from_slice(&channel(at)?.after(before, difference));
            }
            elements.extend_from_slice(&last);
        }
    }
    if body.is_empty() { Ok(elements) } else { Err(LONG) }
}

/// Groups of differences, each in one of four widths.
fn read_plane(body: &mut &[u8], plane: &mut [u8], widths: [usize; 4]) -> Result<(), Malformed> {
    let (groups, _) = plane.as_chunks_mut::<GROUP>();
    let header = take(body, groups.len().div_ceil(4))?;
    for (index, group) in groups.iter_mut().enumerate() {
        read_group(body, group, widths[usize::from(header[index / 4] >> (2 * (index % 4)) & 3)])?;
    }
    Ok(())
}

/// Sixteen differences of `width` bits each; those that are all ones follow as bytes.
fn read_group(body: &mut &[u8], group: &mut [u8; GROUP], width: usize) -> Result<(), Malformed> {
    let packed = take(body, 2 * width)?;
    if width == 0 {
        group.fill(0);
        return Ok(());
    }
    if width == 8 {
        group.copy_from_slice(packed);
        return Ok(());
    }
    let (sentinel, per_byte) = ((1_u8 << width) - 1, 8 / width);
    for (index, difference) in group.iter_mut().enumerate() {
        let within = index % per_byte;
        // Single bits begin at the lowest, all others at the highest.
        let shift = if width == 1 { within } else { 8 - width * (within + 1) };
        let stored = packed[index / per_byte] >> shift & sentinel;
        *difference = if stored == sentinel { take(body, 1)?[0] } else { stored };
    }
    Ok(())
}

/// What the four differences of a channel are taken from.
#[derive(Clone, Copy)]
enum Channel {
    Bytes,
    Shorts,
    /// Exclusive or, turned by that number of bits.
    Bits(u32),
}

impl Channel {
    fn of(mode: u8) -> Result<Self, Malformed> {
        match (mode & 15, mode >> 4) {
            (0, 0) => Ok(Self::Bytes),
            (1, 0) => Ok(Self::Shorts),
            (2, turn) => Ok(Self::Bits(u32::from(turn))),
            _ => Err("a channel has a mode that is not known"),
        }
    }

    /// The four bytes behind `before`.
    fn after(self, before: [u8; 4], difference: [u8; 4]) -> [u8; 4] {
        // Differences alternate between above and below: 0, −1, 1, −2, …
        let byte = |d: u8| d >> 1 ^ (d & 1).wrapping_neg();
        let short = |d: u16| d >> 1 ^ (d & 1).wrapping_neg();
        match self {
            Self::Bytes => std::array::from_fn(|at| before[at].wrapping_add(byte(difference[at]))),
            Self::Shorts => {
                let half = |at: usize| {
                    let [before, difference] =
                        [before, difference].map(|bytes| u16::from_le_bytes([bytes[at], bytes[at + 1]]));
                    before.wrapping_add(short(difference)).to_le_bytes()
                };
                let ([a, b], [c, d]) = (half(0), half(2));
                [a, b, c, d]
            }
            Self::Bits(turn) => {
                let difference = u32::from_le_bytes(difference).rotate_right(turn);
                (u32::from_le_bytes(before) ^ difference).to_le_bytes()
            }
        }
    }
}
