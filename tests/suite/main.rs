//! Every integration test, one file a stage, named as in `src`.

mod data;
mod facts;
mod gltf;
mod oracle;
mod read;
mod support;
mod volume;
mod verify;
