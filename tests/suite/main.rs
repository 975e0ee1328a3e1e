//! The integration tests, one file a stage.

mod gltf;
