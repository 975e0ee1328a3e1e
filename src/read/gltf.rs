use super::{Format, ReadError, Source};
use crate::scene::Scene;
use std::io::{BufRead, Seek};
use std::path::Path;
pub(super) fn read<R: BufRead + Seek>(
    _source: Source<R>,
    _format: Format,
    _folder: Option<&Path>,
) -> Result<Scene, ReadError> {
    unimplemented!()
}
