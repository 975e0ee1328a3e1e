//! Streams of the reference encoder (meshoptimizer 1.3) with the numbers that went in, and streams that are
//! none.

use super::*;

fn shorts(bytes: &[u8]) -> Vec<i16> {
    bytes.as_chunks().0.iter().map(|&bytes| i16::from_le_bytes(bytes)).collect()
}

fn floats(bytes: &[u8]) -> Vec<f32> {
    bytes.as_chunks().0.iter().map(|&bytes| f32::from_le_bytes(bytes)).collect()
}

/// (0, 0, 0), (300, 0, 0), (0, 300, 0), (300, 300, 7) in version 0: 33 bytes, padding, baseline.
fn square_v0() -> Vec<u8> {
    let blocks = [
        0xa0, 0x01, 0x3f, 0x00, 0x00, 0x00, 0x58, 0x57, 0x58, 0x01, 0x26, 0x00, 0x00, 0x00, 0x01, 0x0c, 0x00,
        0x00, 0x00, 0x58, 0x01, 0x08, 0x00, 0x00, 0x00, 0x01, 0x03, 0x00, 0x00, 0x00, 0x0e, 0x00, 0x00, 0x00,
    ];
    [&blocks[..], &[0; 32]].concat()
}

/// The same in version 1.
const SQUARE_V1: [u8; 39] = [
    0xa1, 0xee, 0xab, 0x00, 0x4b, 0x4b, 0x4b, 0x00, 0x00, 0x4b, 0x00, 0x00, 0x00, 0x00, 0x0e, 0x00, 0x00,
    0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00,
    0x00, 0x00, 0x00, 0x62, 0x00,
];

const SQUARE: [i16; 16] = [0, 0, 0, 0, 300, 0, 0, 0, 0, 300, 0, 0, 300, 300, 7, 0];

/// Triangles 012, 213, 423.
const TRIANGLES: [u8; 20] = [
    0xe1, 0xf0, 0x10, 0x00, 0x00, 0x76, 0x87, 0x56, 0x67, 0x78, 0xa9, 0x86, 0x65, 0x89, 0x68, 0x98, 0x01,
    0x69, 0x00, 0x00,
];

/// The same as indices.
const SEQUENCE: [u8; 14] =
    [0xd1, 0x00, 0x04, 0x04, 0x00, 0x02, 0x08, 0x04, 0x06, 0x04, 0x00, 0x00, 0x00, 0x00];

#[test]
fn meshopt_attributes_of_both_versions_decode() {
    let layout = Layout { count: 4, stride: 8 };
    assert_eq!(shorts(&attributes::decode(&square_v0(), layout).unwrap()), SQUARE);
    assert_eq!(shorts(&attributes::decode(&SQUARE_V1, layout).unwrap()), SQUARE);
    // Floats by exclusive or, in planes stored as they are.
    let stream = [
        0xa1, 0xfa, 0xfa, 0xfa, 0x00, 0x00, 0x40, 0x40, 0x00, 0x00, 0x00, 0x04, 0x00, 0x20, 0x1f, 0x00, 0x00,
        0x00, 0x00, 0x02, 0x00, 0x00, 0x00, 0x3f, 0x00, 0x00, 0x00, 0xfd, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00,
        0x00, 0x00, 0x00, 0x00, 0x00, 0xc0, 0x3f, 0x00, 0x00, 0x10, 0x40, 0x00, 0x00, 0x40, 0xc0, 0x00, 0x00,
        0x00,
    ];
    let wanted = [1.5, 2.25, -3.0, 1.5, 2.5, -3.0, 1.75, 2.25, -3.0, 8.0, 9.0, 10.0];
    assert_eq!(floats(&attributes::decode(&stream, Layout { count: 4, stride: 12 }).unwrap()), wanted);
}

#[test]
fn meshopt_triangles_and_indices_decode_in_both_widths() {
    // A triangle keeps its winding, but may begin at another corner.
    let wanted = [0, 1, 2, 2, 1, 3, 2, 3, 4];
    let narrow = Layout { count: 9, stride: 2 };
    assert_eq!(shorts(&indices::decode_triangles(&TRIANGLES, narrow).unwrap()), wanted);
    let wide = indices::decode_triangles(&TRIANGLES, Layout { count: 9, stride: 4 }).unwrap();
    assert_eq!(
        wide.as_chunks().0.iter().map(|&bytes| i32::from_le_bytes(bytes) as i16).collect::<Vec<_>>(),
        wanted
    );
    let wanted = [0, 1, 2, 2, 1, 3, 4, 2, 3];
    assert_eq!(shorts(&indices::decode_sequence(&SEQUENCE, narrow).unwrap()), wanted);
}

#[test]
fn meshopt_filters_decode() {
    // The element, and the nearest 16-bit quaternion: the identity, one of equal parts, a quarter turn.
    let half = 16384;
    let turned = 23170;
    for (stored, wanted) in [
        ([0, 0, 0, 0x7ff], [0, 0, 0, 32767]),
        ([0x5a7, 0x5a7, 0x5a7, 0x7fc], [half; 4]),
        ([0, -2047, 0, 0x7fc], [turned, 0, -turned, 0]),
    ] {
        let mut bytes: Vec<u8> = stored.iter().flat_map(|x: &i16| x.to_le_bytes()).collect();
        filter::apply("QUATERNION", &mut bytes, 8);
        let off = shorts(&bytes).iter().zip(wanted).map(|(is, wanted)| (is - wanted).abs()).max().unwrap();
        // A step of twelve bits is 2⁻¹¹/√2, and the fourth component is off by half a step for each other
        // one.
        assert!(off <= 17, "{stored:?}: {:?}", shorts(&bytes));
    }
    // Mantissa and exponent: 0x60·2⁻⁶, 0x50·2⁻⁵, −0x60·2⁻⁵; the widest exponents.
    let mut bytes =
        [0x60, 0, 0, 0xfa, 0x50, 0, 0, 0xfb, 0xa0, 0xff, 0xff, 0xfb, 1, 0, 0, 100, 1, 0, 0, 0x80].to_vec();
    filter::apply("EXPONENTIAL", &mut bytes, 4);
    assert_eq!(floats(&bytes), [1.5, 2.5, -3.0, 2_f32.powi(100), f32::from_bits(1 << 21)]);
    // Octahedral: an axis, the opposite of another, which is a corner of the square, and an edge of it.
    let mut bytes = [127, 0, 127, 5, 127, 127, 127, 6, 64, 63, 127, 7].to_vec();
    filter::apply("OCTAHEDRAL", &mut bytes, 4);
    assert_eq!(bytes[..8], [127, 0, 0, 5, 0, 0, -127_i8 as u8, 6]);
    assert_eq!(bytes[8..], [91, 89, 0, 7]); // 127/√2 times 64/63.5 and 63/63.5, rounded

    let mut bytes: Vec<u8> = [0_i16, -511, 511, 9].iter().flat_map(|x| x.to_le_bytes()).collect();
    filter::apply("OCTAHEDRAL", &mut bytes, 8);
    assert_eq!(shorts(&bytes), [0, -32767, 0, 9]);
    // No scale of 0 panics.
    for (filter, stride) in [("OCTAHEDRAL", 4), ("OCTAHEDRAL", 8), ("QUATERNION", 8), ("EXPONENTIAL", 4)] {
        for byte in [0, 0x80, 0xff] {
            filter::apply(filter, &mut [byte; 8], stride);
        }
    }
}

/// Decodes as the mode says, whatever the stream is.
fn any(mode: usize, stream: &[u8], layout: Layout) -> Result<Vec<u8>, Malformed> {
    let least = match mode {
        0 => attributes::least_bytes(stream, layout),
        _ => indices::least_bytes(if mode == 1 { layout.count / 3 } else { layout.count }),
    };
    if least.is_none_or(|least| stream.len() < least) {
        return Err(SHORT);
    }
    [attributes::decode, indices::decode_triangles, indices::decode_sequence][mode](stream, layout)
}

#[test]
fn meshopt_streams_that_are_cut_longer_or_of_another_kind_are_refused() {
    let attributes = Layout { count: 4, stride: 8 };
    let indices = Layout { count: 9, stride: 2 };
    let streams = [
        (0, square_v0(), attributes),
        (0, SQUARE_V1.to_vec(), attributes),
        (1, TRIANGLES.to_vec(), indices),
        (2, SEQUENCE.to_vec(), indices),
    ];
    for (mode, stream, layout) in streams {
        any(mode, &stream, layout).unwrap();
        for end in 0..stream.len() {
            assert!(any(mode, &stream[..end], layout).is_err(), "mode {mode}, {end} bytes");
        }
        let mut longer = stream.clone();
        longer.insert(stream.len() - 40.min(stream.len() - 1), 0);
        assert!(any(mode, &longer, layout).is_err(), "mode {mode}");
        let mut other = stream.clone();
        other[0] ^= 0x10;
        assert!(any(mode, &other, layout).unwrap_err().contains("first byte"), "mode {mode}");
        for count in [usize::MAX, usize::MAX - 2, 1 << 40, 3 << 20] {
            assert!(any(mode, &stream, Layout { count, ..layout }).is_err(), "{count} elements");
        }
    }
    // A channel of a mode that is not known.
    let mut stream = SQUARE_V1;
    stream[38] = 3;
    assert!(attributes::decode(&stream, attributes_layout()).unwrap_err().contains("channel"));
    // A triangle that refers to one before the first; an entry of the table that is not allowed.
    let mut stream = TRIANGLES;
    stream[1] = 0x10;
    assert!(indices::decode_triangles(&stream, indices_layout()).unwrap_err().contains("before the first"));
    let mut stream = TRIANGLES;
    stream[4] = 0xf0;
    assert!(indices::decode_triangles(&stream, indices_layout()).unwrap_err().contains("table"));
}

fn attributes_layout() -> Layout {
    Layout { count: 4, stride: 8 }
}

fn indices_layout() -> Layout {
    Layout { count: 9, stride: 2 }
}

#[test]
fn meshopt_streams_with_any_byte_changed_never_panic() {
    let streams = [
        (0, square_v0(), attributes_layout()),
        (0, SQUARE_V1.to_vec(), attributes_layout()),
        (1, TRIANGLES.to_vec(), indices_layout()),
        (2, SEQUENCE.to_vec(), indices_layout()),
    ];
    let (mut read, mut refused) = (0, 0);
    for (mode, stream, layout) in streams {
        for at in 0..stream.len() {
            for byte in 0..=255 {
                let mut changed = stream.clone();
                changed[at] = byte;
                match any(mode, &changed, layout) {
                    Ok(bytes) => {
                        assert_eq!(bytes.len(), layout.count * layout.stride);
                        read += 1;
                    }
                    Err(_) => refused += 1,
                }
            }
        }
    }
    assert!(read > 1000 && refused > 1000, "{read} read, {refused} refused");
}
