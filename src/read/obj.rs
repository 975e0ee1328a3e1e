use std::io::{BufRead, Seek};
use super::{ReadError, Source};
use crate::scene::Scene;
pub(super) fn read<R: BufRead + Seek>(_source: Source<R>) -> Result<Scene, ReadError> { unimplemented!() }
