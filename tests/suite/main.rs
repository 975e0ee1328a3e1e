//! Every integration test, one file a stage, named as in `src`.

mod cli;
mod gltf;
mod oracle;
mod read;
mod support;
mod volume;
mod verify;
