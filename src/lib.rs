//! Meshes into verified shadows: half-edge topology and crack reports, exact silhouettes, closed shadow volumes
//! with vertices at infinity, and an exact ray cast that says independently what is in shadow.
//!
//! # The map
//!
//! ```text
//! file ─read─► Scene ─bake─► Mesh ─weld─► Mesh ─Topology::build─► Topology ─► CrackReport::of(&Mesh, &Topology)
//! Topology + Light ─classify─► Facing per face ─extract─► Silhouette ─extrude─► ShadowVolume ─► winding number ┐
//! Mesh ─Oracle::build─► Oracle ─verdict─► Lit | Shadowed | Grazing ────────────────────────────────► verify ◄──┘
//! Mesh + Light + Projection ─Caster::cast─► StencilVolumes (volumes, z-pass or z-fail and why) ─StencilPass::mask─► ShadowMask
//! ShadowMask + Oracle ─compare─► Comparison: the last word on every pixel
//! Mesh + Lights ─Question::measure─► Accuracy: how often each way to decide is wrong, beside what it costs
//! Oracle + View (camera, lamps) ─render─► Picture ─write_png─► PNG
//! proptest ─strategy─► meshes, lights and points that are hard for all of this
//! ```
//!
//! Each arrow is one function that borrows the value before it and returns the next one owned. The modules below
//! stand in the same order.
//!
//! # Conventions
//!
//! Right-handed coordinates in mesh units, `f32`, finite. A face is in front where its corners run
//! counter-clockwise. A light is homogeneous: `w = 1` a point, `w = 0` the direction *towards* a directional light.
//! Every sign is decided exactly, in [`geom::predicate`]; ties are declared, never guessed. A defect of a mesh is
//! data, not an error. Results do not depend on the number of threads.
//!
//! # From a mesh to a verdict
//!
//! ```
//! use umbrage::geom::Light;
//! use umbrage::mesh::{Weld, weld};
//! use umbrage::testing::shapes;
//! use umbrage::oracle::{Oracle, Verdict};
//! use umbrage::facing::{CasterFaces, classify};
//! use umbrage::silhouette::Silhouette;
//! use umbrage::check::CrackReport;
//! use umbrage::topology::Topology;
//! use umbrage::shadow::volume::{Caps, ShadowVolume, winding_number};
//!
//! // A mesh: generated here; `umbrage::read::read("mesh.glb")?.bake(Scope::Mesh)?` gives those of a file.
//! let mesh = weld(&shapes::torus(48, 24, 2.0, 0.7), Weld::Exact).mesh;
//!
//! // Topology and crack report.
//! let topology = Topology::of(&mesh);
//! let report = CrackReport::of(&mesh, &topology);
//! assert!(report.counts.sound() && report.counts.euler_characteristic == 0);
//!
//! // Silhouette from a light.
//! let light = Light::point([3.0, 9.0, 5.0])?;
//! let signs = CasterFaces::All.signs(&classify(&mesh, &light));
//! let silhouette = Silhouette::extract(&topology, &signs);
//!
//! // Volume, and its certificate.
//! let volume = ShadowVolume::extrude(&mesh, &topology, &light, &signs, &silhouette, Caps::Both);
//! assert!(volume.boundary_sum().is_closed());
//!
//! // Two independent judges.
//! let behind = [-1.5, -6.0, -1.5];
//! assert_eq!(Oracle::build(&mesh).verdict(behind, &light), Verdict::Shadowed);
//! assert!(winding_number(&volume, behind) > Some(0));
//! # Ok::<(), umbrage::geom::LightError>(())
//! ```
//!
//! # From your own arrays to buffers you can draw
//!
//! Weld, build and prove once for a mesh; then each light costs one classification, one scan and one extrusion.
//!
//! ```
//! use umbrage::geom::Light;
//! use umbrage::mesh::{Mesh, Weld, weld};
//! use umbrage::facing::FacePlanes;
//! use umbrage::silhouette::Silhouette;
//! use umbrage::topology::Topology;
//! use umbrage::shadow::volume::{Caps, ShellFaces, ShadowVolume};
//! use umbrage::caster::ShellProof;
//!
//! # let (positions, indices): (Vec<[f32; 3]>, Vec<u32>) = {
//! #     let (positions, triangles, ..) = umbrage::testing::shapes::cube().into_parts();
//! #     (positions, triangles.concat())
//! # };
//! // `positions: Vec<[f32; 3]>` and `indices: Vec<u32>` are yours. Vertices that are split for normals or texture
//! // coordinates are joined by position.
//! let triangles = indices.chunks_exact(3).map(|t| [t[0], t[1], t[2]]).collect();
//! let mesh = weld(&Mesh::new(positions, triangles)?, Weld::Exact).mesh;
//! let topology = Topology::of(&mesh);
//! let (planes, shells) = (FacePlanes::new(&mesh), topology.shells());
//! let proofs = ShellProof::of(&mesh, &topology, &shells);
//!
//! // For each light: half the faces cast wherever that is proven to be enough.
//! let light = Light::point([2.0, 5.0, 3.0])?;
//! let plan = ShellFaces::choose(&mesh, &shells, &proofs, &light, None);
//! let signs = plan.signs(&shells, &planes.classify(&mesh, &light));
//! let silhouette = Silhouette::extract(&topology, &signs);
//! let volume = ShadowVolume::extrude(&mesh, &topology, &light, &signs, &silhouette, Caps::Both);
//!
//! // Buffers: homogeneous vertices (w = 0 lies at infinity: draw with an infinite far plane) and indices.
//! let vertex_buffer: Vec<[f32; 4]> = volume.to_f32();
//! let index_buffer: &[u32] = volume.triangles().as_flattened();
//! assert_eq!(index_buffer.len() / 3, volume.light_cap().len() + volume.sides().len() + volume.dark_cap().len());
//! assert!(index_buffer.iter().all(|&index| (index as usize) < vertex_buffer.len()));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Features
//!
//! - `cli` (default): the command `umbrage`, and `reference`.
//! - `parallel` (default): verification and pictures on several threads; the same bytes either way.
//! - `reference`: the whole-number judge and the module `verify`.
//! - `proptest`: the module `strategy`, meshes, lights and points for property tests of shadows.
//! - `gpu` (default): silhouettes, volumes and the stencil pass on a graphics adapter, by wgpu.
//!
//! `--no-default-features` leaves a lean geometry library.

pub mod geom;
pub mod mesh;
pub mod view;
pub mod scene;
pub mod read;
pub mod write;
pub mod oracle;
pub mod topology;
pub mod check;
pub mod facing;
pub mod silhouette;
pub mod caster;
#[cfg(feature = "gpu")]
pub mod gpu;
pub mod shadow;
pub mod render;
pub mod verify;
pub mod testing;
#[cfg(feature = "verify")]
pub mod accuracy;

#[cfg(test)]
mod determinism;
mod built;
mod choice;
mod parallel;
mod random;

// Transforms and cameras speak glam; this is the version they speak.
pub use choice::{Choice, Reason};
pub use glam;
