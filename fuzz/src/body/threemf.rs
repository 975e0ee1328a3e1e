//! Bytes to a 3MF package, and to what reading it gives.

use super::read;

/// Reads `data`: an archive as it is, anything else as the model part of one. Few mutations of an archive
/// leave it readable, so that without this the model would never be reached.
pub(crate) fn run(data: &[u8]) {
    match data.starts_with(b"PK") {
        true => read::run(data, "a.3mf"),
        false => read::run(&package(data), "a.3mf"),
    }
}

/// An archive of one member, stored as it is. PKWARE, *.ZIP File Format Specification* 6.3.10, 2022, sections
/// 4.3.7, 4.3.12 and 4.3.16.
pub(crate) fn package(model: &[u8]) -> Vec<u8> {
    const NAME: &[u8] = b"3D/3dmodel.model";
    let size = u32::try_from(model.len()).expect("inputs are short").to_le_bytes();
    let name = (NAME.len() as u16).to_le_bytes();
    // Method 0, no date; checksum, both sizes, lengths of the name and of nothing else.
    let common =
        [&[0; 4][..], &[0, 0, 0x21, 0], &crc32(model).to_le_bytes(), &size, &size, &name, &[0; 2]].concat();
    let local = [b"PK\x03\x04\x0a\0", &common[..], NAME, model].concat();
    let central = [b"PK\x01\x02\x0a\0\x0a\0", &common[..], &[0; 14], NAME].concat();
    let lengths = [central.len(), local.len()].map(|length| (length as u32).to_le_bytes());
    let end = [&b"PK\x05\x06\0\0\0\0\x01\0\x01\0"[..], &lengths[0], &lengths[1], &[0; 2]].concat();
    [local, central, end].concat()
}

/// The checksum of ZIP: the polynomial of ISO 3309, lowest bit first.
fn crc32(bytes: &[u8]) -> u32 {
    let step = |crc: u32, _| if crc & 1 == 1 { crc >> 1 ^ 0xedb8_8320 } else { crc >> 1 };
    !bytes.iter().fold(!0, |crc, &byte| (0..8).fold(crc ^ u32::from(byte), step))
}
