//! The format of a file, told by its first bytes, its length and its extension together.

use std::path::Path;

use super::{Format, Place, ReadError, foreign, off, stl};

/// The format that the first bytes of a file show together with its length and its extension.
pub(super) fn sniff(head: &[u8], len: u64, name: &Path) -> Result<Format, ReadError> {
    let named = Format::from_extension(name);
    let text = head.strip_prefix(b"\xef\xbb\xbf").unwrap_or(head).trim_ascii_start();
    // A binary STL may begin with anything; its length is the stronger sign: 80 + 4 + 50 bytes a triangle.
    // Only the mark of another binary format is stronger, and only under another extension.
    let binary_stl = stl::has_binary_length(head, len);
    let versions: [&[u8]; 3] = [b"glTF\x01\0\0\0", b"glTF\x02\0\0\0", b"IDP2\x08\0\0\0"];
    let versioned = versions.iter().any(|mark| head.starts_with(mark));
    let named_stl = named == Some(Format::Stl);
    let begins = |word: &[u8]| text.get(..word.len()).is_some_and(|start| start.eq_ignore_ascii_case(word));
    match text {
        _ if binary_stl && (named_stl || !versioned) => Ok(Format::Stl),
        _ if head.starts_with(b"glTF") && (versioned || !named_stl) => Ok(Format::Glb),
        _ if head.starts_with(b"IDP2") && (versioned || !named_stl) => Ok(Format::Md2),
        // No header of a PLY ends before byte 84, and text has no zero byte.
        _ if named_stl && head.len() >= 84 && head[..84].contains(&0) => {
            foreign::by_content(text, len).map_or(Ok(Format::Stl), Err)
        }
        _ if head.starts_with(b"ply\n") || head.starts_with(b"ply\r") => Ok(Format::Ply),
        _ if text.starts_with(b"{") => Ok(Format::Gltf),
        _ if begins(b"solid") || begins(b"facet") => Ok(Format::Stl),
        _ if first_line(text).is_some_and(off::is_keyword) => Ok(Format::Off),
        _ => match foreign::by_content(text, len).or_else(|| foreign::by_extension(name)) {
            Some(error) => Err(error),
            None => unmarked(text, named),
        },
    }
}

/// The format of a file whose content has no mark; `named` is that of its extension.
fn unmarked(head: &[u8], named: Option<Format>) -> Result<Format, ReadError> {
    let is_text = !head.iter().any(|byte| byte.is_ascii_control() && !byte.is_ascii_whitespace());
    let shown = if is_text { obj_statement(head) } else { Obj::Unlike };
    match (named, shown) {
        (Some(Format::Obj), _) | (_, Obj::Statement) | (None, Obj::Comment) => Ok(Format::Obj),
        (None, Obj::Unlike) => {
            let problem = "neither the content nor the extension tells the format";
            Err(ReadError::new(None, Place::File, problem)
                .remedy("name a file in obj, gltf, glb, stl, ply, off, md2 or 3mf format"))
        }
        // Text STL begins with a mark, and GLB is binary; the readers of the other formats report it
        // themselves.
        (Some(format @ (Format::Glb | Format::Stl)), _) if is_text => {
            let problem = format!("the content is text, but not that of a file in {format} format");
            Err(ReadError::new(format, Place::File, problem)
                .remedy("give the file the extension of its format, or export it again"))
        }
        (Some(format), _) => Ok(format),
    }
}

/// How much a text looks like Wavefront OBJ.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Obj {
    /// Its first line that is no comment is a statement.
    Statement,
    /// It begins with a comment, and has nothing else to decide by.
    Comment,
    /// Neither.
    Unlike,
}

/// The first line that is neither empty nor a comment.
fn first_line(text: &[u8]) -> Option<&[u8]> {
    let mut lines = text.split(|byte| matches!(byte, b'\n' | b'\r')).map(<[u8]>::trim_ascii);
    lines.find(|line| !line.is_empty() && !line.starts_with(b"#"))
}

fn obj_statement(text: &[u8]) -> Obj {
    match first_line(text).and_then(|line| line.split(u8::is_ascii_whitespace).next()) {
        Some(b"v" | b"vn" | b"vt" | b"f" | b"o" | b"g" | b"s" | b"l" | b"p" | b"mtllib" | b"usemtl") => {
            Obj::Statement
        }
        None if text.starts_with(b"#") => Obj::Comment,
        _ => Obj::Unlike,
    }
}
