//! EXT_meshopt_compression: a naive encoder, which reads back to the same bytes; and streams of any bytes, which
//! decode or are refused in one line.

use umbrage::read::read_bytes;
use umbrage::testing::generate::Bytes;

const NAME: &str = "a.glb";

/// The first bytes choose mode, filter, stride, and whether the others are what is encoded or the stream itself.
pub(crate) fn run(data: &[u8]) {
    let mut bytes = Bytes::new(data);
    let (mode, encode) = (usize::from(bytes.byte()) % 3, bytes.byte().is_multiple_of(2));
    let filter = ["NONE", "OCTAHEDRAL", "QUATERNION", "EXPONENTIAL"][usize::from(bytes.byte()) % 4];
    let (width, count) = (bytes.byte(), u16::from_le_bytes([bytes.byte(), bytes.byte()]));
    let stride = match mode {
        0 => 4 + 4 * usize::from(width % 64),
        _ => 2 + 2 * usize::from(width % 2),
    };
    let rest = bytes.take(usize::MAX);
    if !encode {
        let filter = if mode == 0 { filter } else { "NONE" };
        if let Err(line) = read(mode, filter, stride, count.into(), rest) {
            super::read::is_one_line(&line, NAME);
        }
        return;
    }
    // Whole elements, whole triangles.
    let step = if mode == 1 { 3 * stride } else { stride };
    let elements = &rest[..rest.len() / step * step];
    judge(mode, stride, elements, &encoded(mode, stride, elements));
}

/// Elements as a stream of this mode.
pub(crate) fn encoded(mode: usize, stride: usize, elements: &[u8]) -> Vec<u8> {
    let indices: Vec<u32> = elements
        .chunks(stride)
        .map(|bytes| bytes.iter().rev().fold(0, |index, &byte| index << 8 | u32::from(byte)))
        .collect();
    match mode {
        0 => attributes(elements, stride),
        1 => triangles(&indices),
        _ => sequence(&indices),
    }
}

/// Panics unless the stream reads as the elements.
pub(crate) fn judge(mode: usize, stride: usize, elements: &[u8], stream: &[u8]) {
    // The second baseline of indices is written in 31 bits.
    let far = |bytes: &[u8]| bytes.len() == 4 && bytes[3] >= 0x20;
    if mode == 2 && elements.chunks(stride).any(far) {
        return;
    }
    let read =
        read(mode, "NONE", stride, elements.len() / stride, stream).unwrap_or_else(|line| panic!("{line}"));
    let wanted: Vec<[f32; 3]> = elements
        .as_chunks::<6>()
        .0
        .iter()
        .map(|bytes| [0, 2, 4].map(|at| f32::from(u16::from_le_bytes([bytes[at], bytes[at + 1]]))))
        .collect();
    assert_eq!(read, wanted, "mode {mode}, stride {stride}");
}

/// What the stream decodes to, as positions of 16 bits without gaps.
fn read(
    mode: usize,
    filter: &str,
    stride: usize,
    count: usize,
    stream: &[u8],
) -> Result<Vec<[f32; 3]>, String> {
    let (mode, length) = (["ATTRIBUTES", "TRIANGLES", "INDICES"][mode], count * stride);
    let mut json = format!(
        r#"{{"asset":{{"version":"2.0"}},"extensionsUsed":["EXT_meshopt_compression","KHR_mesh_quantization"],
        "buffers":[{{"byteLength":{}}},{{"byteLength":{length}}}],
        "bufferViews":[{{"buffer":1,"byteLength":{length},"extensions":{{"EXT_meshopt_compression":
        {{"buffer":0,"byteLength":{},"byteStride":{stride},"count":{count},"mode":"{mode}","filter":"{filter}"}}}}}}],
        "accessors":[{{"bufferView":0,"componentType":5123,"type":"VEC3","count":{}}}],
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}}}}]}}],"nodes":[{{"mesh":0}}]}}"#,
        stream.len(),
        stream.len(),
        length / 6,
    )
    .into_bytes();
    json.resize(json.len().next_multiple_of(4), b' ');
    let mut glb = b"glTF\x02\0\0\0".to_vec();
    glb.extend((12 + 8 + json.len() as u32 + 8 + stream.len() as u32).to_le_bytes());
    for (kind, chunk) in [(b"JSON", &json[..]), (b"BIN\0", stream)] {
        glb.extend((chunk.len() as u32).to_le_bytes());
        glb.extend(kind);
        glb.extend(chunk);
    }
    let mut scene = read_bytes(&glb, NAME).map_err(|error| error.to_string())?;
    Ok(scene.meshes.remove(0).positions().to_vec())
}

/// Attributes in version 0: for every group of 16 differences the narrowest of the four widths.
pub(crate) fn attributes(bytes: &[u8], stride: usize) -> Vec<u8> {
    let elements: Vec<&[u8]> = bytes.chunks(stride).collect();
    let mut out = vec![0xa0];
    let most = (8192 / stride / 16 * 16).min(256);
    let mut before = vec![0; stride];
    for block in elements.chunks(most) {
        for at in 0..stride {
            let mut last = before[at];
            let mut differences: Vec<u8> = block
                .iter()
                .map(|element| {
                    let difference = element[at].wrapping_sub(last) as i8;
                    last = element[at];
                    ((difference << 1) ^ (difference >> 7)) as u8
                })
                .collect();
            differences.resize(differences.len().next_multiple_of(16), 0);
            let groups: Vec<(u8, Vec<u8>)> = differences.chunks(16).map(group).collect();
            for four in groups.chunks(4) {
                out.push(four.iter().enumerate().map(|(index, (width, _))| width << (2 * index)).sum());
            }
            groups.iter().for_each(|(_, bytes)| out.extend(bytes));
        }
        before = block.last().unwrap().to_vec();
    }
    let tail = out.len() + stride.max(32) - stride;
    out.resize(tail, 0);
    out.extend(vec![0; stride]); // the baseline
    out
}

/// The code of a width, and sixteen differences in it.
fn group(differences: &[u8]) -> (u8, Vec<u8>) {
    let packed = |width: usize| -> Vec<u8> {
        let most = (1 << width) - 1;
        let bits = differences.chunks(8 / width);
        let mut bytes: Vec<u8> =
            bits.map(|some| some.iter().fold(0, |byte, &d| byte << width | d.min(most))).collect();
        bytes.extend(differences.iter().filter(|&&d| d >= most));
        bytes
    };
    let zeros = differences.iter().all(|&d| d == 0).then(Vec::new);
    let all = [zeros, Some(packed(2)), Some(packed(4)), Some(differences.to_vec())];
    let kinds = all.into_iter().enumerate().filter_map(|(code, bytes)| Some((code as u8, bytes?)));
    kinds.min_by_key(|(_, bytes)| bytes.len()).unwrap()
}

fn varint(mut value: u32, out: &mut Vec<u8>) {
    while value > 127 {
        out.push(value as u8 | 128);
        value >>= 7;
    }
    out.push(value as u8);
}

fn zigzag(difference: u32) -> u32 {
    (difference << 1) ^ ((difference as i32) >> 31) as u32
}

/// Triangles: those of three new vertices as such, all others corner by corner.
pub(crate) fn triangles(indices: &[u32]) -> Vec<u8> {
    let (mut codes, mut data) = (vec![0xe1], Vec::new());
    let (mut next, mut last) = (0, 0);
    for corners in indices.chunks(3) {
        if corners == [next, next + 1, next + 2] {
            codes.push(0xf0);
            next += 3;
            continue;
        }
        codes.push(0xff);
        data.push(0xff);
        for &corner in corners {
            varint(zigzag(corner.wrapping_sub(last)), &mut data);
            last = corner;
        }
    }
    [codes, data, vec![0; 16]].concat()
}

/// Indices, by turns from either of the two before.
pub(crate) fn sequence(indices: &[u32]) -> Vec<u8> {
    let (mut out, mut last) = (vec![0xd1], [0_u32; 2]);
    for (at, &index) in indices.iter().enumerate() {
        let which = at % 2;
        varint(zigzag(index.wrapping_sub(last[which])) << 1 | which as u32, &mut out);
        last[which] = index;
    }
    [out, vec![0; 4]].concat()
}
