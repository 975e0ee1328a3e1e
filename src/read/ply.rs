use super::{ReadError, Source};
use crate::scene::Scene;
use std::io::{BufRead, Seek};
pub(super) fn read<R: BufRead + Seek>(_source: Source<R>) -> Result<Scene, ReadError> {
    unimplemented!()
}
