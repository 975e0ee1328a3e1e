//! Every integration test, one file a stage, named as in `src`.

mod cli;
mod crack;
mod data;
mod facts;
mod gltf;
#[cfg(feature = "gpu")]
mod gpu_silhouette;
mod oracle;
mod picture;
mod read;
mod support;
mod verify;
mod volume;
mod write;
