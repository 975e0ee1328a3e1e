//! Every integration test, one file a stage, named as in `src`.

mod cli;
mod gltf;
mod picture;
mod read;
