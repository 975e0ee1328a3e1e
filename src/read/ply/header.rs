//! What the header declares: elements, how many there are of each, and their properties.

use std::io::BufRead;

use super::file_error;
use super::junk::Junk;
pub(super) use super::number::Number;
use super::values::Values;
use crate::read::ReadError;
use crate::read::slips::Slips;
use crate::read::text::{self, Line, Lines, counted, parse, quote};

pub(super) struct Header {
    pub(super) encoding: Encoding,
    pub(super) elements: Vec<Element>,
    pub(super) slips: Slips,
}

#[derive(Clone, Copy)]
pub(super) enum Encoding {
    Text,
    LittleEndian,
    BigEndian,
}

pub(super) struct Element {
    pub(super) name: String,
    pub(super) count: u64,
    pub(super) properties: Vec<Property>,
}

pub(super) struct Property {
    name: String,
    pub(super) kind: Kind,
}

#[derive(Clone, Copy)]
pub(super) enum Kind {
    Scalar(Number),
    List { length: Number, item: Number },
}

impl Header {
    /// Reads up to and including `end_header`.
    pub(super) fn read<R: BufRead>(lines: &mut Lines<R>) -> Result<Self, ReadError> {
        let (mut encoding, mut elements, mut slips) = (None, Vec::<Element>::new(), Slips::default());
        // A line that may be an element with its keyword misspelt: then properties follow it.
        let mut doubtful = None;
        if lines.next_line()?.is_none_or(|line| line.rest.trim_ascii() != b"ply") {
            return Err(lines.current().error("a PLY file begins with the line `ply`, this one does not"));
        }
        loop {
            let Some(mut line) = lines.next_line()? else {
                return Err(lines.error_at_end("the file ends inside the header, before `end_header`"));
            };
            let whole = line;
            match line.word() {
                None | Some(b"comment" | b"obj_info") => continue,
                Some(b"format") => encoding = Some(Encoding::read(line)?),
                Some(b"element") => elements.push(Element::read(line)?),
                Some(b"property") => match (doubtful, elements.last_mut()) {
                    (Some(refused), _) => return Err(refused),
                    (None, Some(element)) => element.properties.push(Property::read(line)?),
                    (None, None) => return Err(line.error("a property is declared before any element")),
                },
                Some(b"end_header") => break,
                Some(word) => {
                    let refused = || whole.error(format!("{} is not a header statement", quote(word)));
                    match Junk::of(whole) {
                        Junk::Data => {
                            let problem = format!("{} is data, but `end_header` is missing", quote(word));
                            return Err(whole.error(problem));
                        }
                        Junk::Property => return Err(refused()),
                        Junk::Element => doubtful = Some(refused()),
                        Junk::Words => {}
                    }
                    slips.add("line", "of the header ignored", || format!("{} ({})", line.at(), quote(word)));
                    continue;
                }
            }
            doubtful = None;
        }
        let encoding = encoding.ok_or_else(|| lines.current().error("the header declares no format"))?;
        Ok(Self { encoding, elements, slips })
    }

    /// The element of that name, if it is declared.
    pub(super) fn element(&self, name: &str) -> Result<Option<&Element>, ReadError> {
        let mut named = self.elements.iter().filter(|element| element.name == name);
        match (named.next(), named.next()) {
            (_, Some(_)) => Err(file_error(format!("the header declares element {name} twice"))),
            (element, None) => Ok(element),
        }
    }

    /// Refuses counts that the `len` bytes after the header cannot hold.
    pub(super) fn check_size(&self, len: u64) -> Result<(), ReadError> {
        let mut needed = 0_u128; // no sum of lines of one file, 64 bits a count, comes near its end
        for element in &self.elements {
            let one: u64 =
                element.properties.iter().map(|property| property.least_bytes(self.encoding)).sum();
            needed += u128::from(element.count) * u128::from(one);
            // The last number of a text file needs no blank after it.
            if needed > u128::from(len) + 1 {
                let things = counted(element.count, &format!("{} element", element.name));
                let problem = format!("the header declares {things}, but only {len} bytes follow it");
                return Err(file_error(problem));
            }
        }
        Ok(())
    }
}

impl Encoding {
    fn read(mut line: Line<'_>) -> Result<Self, ReadError> {
        match line.word() {
            Some(b"ascii") => Ok(Self::Text),
            Some(b"binary_little_endian") => Ok(Self::LittleEndian),
            Some(b"binary_big_endian") => Ok(Self::BigEndian),
            word => Err(line.error(format!("{} is not a PLY encoding", quote(word.unwrap_or_default())))),
        }
    }
}

impl Element {
    fn read(mut line: Line<'_>) -> Result<Self, ReadError> {
        let Some(name) = line.word() else { return Err(line.error("an element needs a name and a count")) };
        let count = line.word().unwrap_or_default();
        match parse(count) {
            Some(count) => Ok(Self { name: text::name(name), count, properties: Vec::new() }),
            None => Err(line.error(format!("{} is not a count of elements", quote(count)))),
        }
    }

    /// The index of the scalar property of that name.
    pub(super) fn scalar(&self, name: &str) -> Result<usize, ReadError> {
        let place = self.only(&[name])?;
        place
            .filter(|&at| matches!(self.properties[at].kind, Kind::Scalar(_)))
            .ok_or_else(|| file_error(format!("element {} has no number {name}", self.name)))
    }

    /// Whether it looks like faces under another name. Lines, strips and solid cells have lists of vertices
    /// too.
    pub(super) fn is_like_faces(&self) -> bool {
        let name = self.name.to_ascii_lowercase();
        let other = ["vertex", "edge", "line", "path", "curve", "strip", "fan", "tet", "hex", "voxel"];
        !other.iter().any(|other| name.contains(other)) && self.index_list().is_ok()
    }

    /// The index of the property with the list of vertex indices.
    pub(super) fn index_list(&self) -> Result<usize, ReadError> {
        let place = self.only(&["vertex_indices", "vertex_index"])?;
        place
            .filter(|&at| matches!(self.properties[at].kind, Kind::List { item, .. } if item.is_whole()))
            .ok_or_else(|| {
                file_error(format!("element {} has no list of integers vertex_indices", self.name))
            })
    }

    /// The index of the one property with one of these names.
    fn only(&self, names: &[&str]) -> Result<Option<usize>, ReadError> {
        let mut named =
            (0..self.properties.len()).filter(|&at| names.contains(&self.properties[at].name.as_str()));
        match (named.next(), named.next()) {
            (_, Some(_)) => Err(file_error(format!("element {} declares {} twice", self.name, names[0]))),
            (place, None) => Ok(place),
        }
    }
}

impl Property {
    fn read(line: Line<'_>) -> Result<Self, ReadError> {
        let number = |word: Option<&[u8]>| {
            let word = word.unwrap_or_default();
            Number::named(word).ok_or_else(|| line.error(format!("{} is not a PLY type", quote(word))))
        };
        let mut words = line;
        let kind = match words.word() {
            Some(b"list") => {
                let (length, item) = (number(words.word())?, number(words.word())?);
                if !length.is_whole() {
                    return Err(line.error("the length of a list must be an integer"));
                }
                Kind::List { length, item }
            }
            word => Kind::Scalar(number(word)?),
        };
        match words.word() {
            Some(name) => Ok(Self { name: text::name(name), kind }),
            None => Err(line.error("a property needs a name")),
        }
    }

    /// The fewest bytes that a value takes: an empty list, a digit and a blank.
    fn least_bytes(&self, encoding: Encoding) -> u64 {
        match (encoding, self.kind) {
            (Encoding::Text, _) => 2,
            (_, Kind::Scalar(number) | Kind::List { length: number, .. }) => number.bytes(),
        }
    }
}

impl Kind {
    /// Reads past a value of this kind.
    pub(super) fn skip(self, values: &mut impl Values) -> Result<(), ReadError> {
        match self {
            Self::Scalar(number) => values.skip(number),
            Self::List { length, item } => {
                for _ in 0..values.length(length)? {
                    values.skip(item)?;
                }
                Ok(())
            }
        }
    }
}
