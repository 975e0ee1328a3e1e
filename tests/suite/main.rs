//! Every integration test, one file a stage, named as in `src`.

#[cfg(feature = "cli")]
mod cli;
mod gltf;
mod read;
