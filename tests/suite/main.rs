//! All integration tests, one file per stage, named as in `src`.

mod area;
mod chart;
#[path = "../../src/cli/chart.rs"]
mod svg;
mod cli;
mod compare;
mod crack;
mod data;
mod facts;
mod fuzz;
mod gltf;
#[cfg(feature = "gpu")]
mod gpu_compare;
#[cfg(feature = "gpu")]
mod gpu_silhouette;
#[cfg(feature = "gpu")]
mod gpu_stencil;
#[cfg(feature = "gpu")]
mod gpu_topology;
mod hard;
mod light_grid;
mod metamorphic;
mod oracle;
mod picture;
#[path = "../../benches/stages/plot.rs"]
mod plot;
mod read;
mod rooms;
mod screen;
mod silhouette;
mod stencil;
mod support;
mod technique;
mod torture;
mod verify;
mod volume;
mod write;
