//! Meshes into verified shadows.

pub mod geom;
pub mod mesh;
pub mod scene;
pub mod read;
pub mod write;
pub mod topology;
pub mod silhouette;
pub mod volume;
pub mod oracle;
pub mod picture;
