//! Every integration test, one file a stage, named as in `src`.

mod crack;
mod facts;
mod gltf;
mod read;
