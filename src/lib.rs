//! Meshes into verified shadows: half-edge topology and crack reports, exact silhouettes, closed shadow
//! volumes with vertices at infinity, and an exact ray cast that decides independently what is in shadow.
//!
//! # The map
//!
//! ```text
//! file ─read─► Scene (instances, lamps, cameras, clips) ─pose(time)─► Scene ─bake─► Mesh ─weld─► Caster
//! Caster: a mesh and all that is known of it before any light, each part made once, when first asked for:
//!         Topology · CrackReport · shells · face planes · proofs · Oracle (exact ray cast)
//! (Caster, Light) ─► facing ─► silhouette ─► ShadowVolume                      exact, closed, certified
//! (Casters, Light, Samples) ─Technique─► Visibility: how much light reaches each visible point; a Claim
//! Visibility + truth ─verify─► Errors by kind ─► accuracy: error against time, all techniques in one report
//! Oracle or stencil pass + lamps ─render─► Picture ─write_png─► PNG
//! ```
//!
//! The modules below come in the same order, and none imports one that comes after it. Each arrow borrows the
//! value before it and returns the next one owned.
//!
//! | module | what it holds |
//! |---|---|
//! | [`geom`] | exact predicates, [`Light`](geom::Light), [`Facing`](geom::Facing), boxes, box trees |
//! | [`mesh`] | [`Mesh`](mesh::Mesh), ids, welding |
//! | [`view`] | cameras, projections, the rays of pixels |
//! | `gpu` | graphics devices and what runs on them |
//! | [`animate`] | clips, skins and morph targets; poses |
//! | [`scene`] | instances, lamps, cameras of a file |
//! | `read`, `write` | one format per file |
//! | [`oracle`] | exact shadow rays and primary hits; visible fractions of lights with an extent |
//! | [`topology`] | half-edges and edges; never sees a position |
//! | [`check`] | the crack report: defects, shells, self-intersections |
//! | [`repair`] | a mesh into one that casts better, each change listed |
//! | [`facing`] | the side of every face that a light is on |
//! | [`caster`] | [`Caster`](caster::Caster), proofs |
//! | [`silhouette`] | silhouette edges: scan, tree, certificates for a moving light |
//! | [`light_grid`] | what a light sees, conservatively, in cells: most points are proven lit or dark |
//! | [`shadow`] | the contract of every technique; stencil shadow volumes, rays |
//! | [`ambient`] | ambient occlusion: exact rays, the analytic form, disks |
//! | [`plan`] | the planner: which shadows a scene calls for, by which technique, and why |
//! | [`verify`] | every method against every other, at points and at pixels; errors by kind |
//! | [`testing`] | generated shapes, strategies, torture; promises nothing between versions |
//! | `accuracy` | error against time |
//! | [`render`] | pictures by rays or device |
//!
//! # Conventions
//!
//! Right-handed coordinates in mesh units, `f32`, finite. A face is in front where its corners run
//! counter-clockwise. A light is homogeneous: `w = 1` a point, `w = 0` the direction *towards* a directional
//! light. Every sign is decided exactly, in [`geom::predicate`]; ties are declared, never guessed. A defect
//! of a mesh is data, not an error. Results do not depend on the number of threads.
//!
//! # From your own arrays to buffers you can draw
//!
//! ```
//! use umbrage::caster::Caster;
//! use umbrage::geom::Light;
//! use umbrage::shadow::volume::Caps;
//!
//! # let (positions, indices): (Vec<[f32; 3]>, Vec<u32>) = {
//! #     let (positions, triangles, ..) = umbrage::testing::shapes::cube().into_parts();
//! #     (positions, triangles.concat())
//! # };
//! // `positions: Vec<[f32; 3]>` and `indices: Vec<u32>` are yours. Vertices that are split for normals or
//! // texture coordinates are joined by position.
//! let caster = Caster::from_indexed(&positions, &indices)?;
//! let volume = caster.volume(&Light::point([2.0, 5.0, 3.0])?, Caps::Both);
//!
//! // Buffers: homogeneous vertices (w = 0 lies at infinity: draw with an infinite far plane) and indices.
//! let vertex_buffer: Vec<[f32; 4]> = volume.to_f32();
//! let index_buffer: &[u32] = volume.triangles().as_flattened();
//! assert!(index_buffer.iter().all(|&index| (index as usize) < vertex_buffer.len()));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! A frame loop, into buffers of your own and without allocations, is [`shadow::volume::FrameExtruder`].
//!
//! # From a mesh to a verdict
//!
//! ```
//! use umbrage::caster::Caster;
//! use umbrage::geom::Light;
//! use umbrage::oracle::Verdict;
//! use umbrage::shadow::volume::{Caps, winding_number};
//! use umbrage::testing::shapes;
//!
//! // A mesh: generated here; `umbrage::read::read("mesh.glb")?.bake(Scope::Mesh)?` gives those of a file.
//! let caster = Caster::new(shapes::torus(48, 24, 2.0, 0.7));
//! let counts = &caster.report().counts;
//! assert!(counts.sound() && counts.euler_characteristic == 0);
//!
//! // The volume, and its certificate.
//! let light = Light::point([3.0, 9.0, 5.0])?;
//! let volume = caster.volume(&light, Caps::Both);
//! assert!(volume.boundary_sum().is_closed());
//!
//! // Two independent methods: the exact ray cast, and the winding number of the emitted volume.
//! let behind = [-1.5, -6.0, -1.5];
//! assert_eq!(caster.oracle().verdict(behind, &light), Verdict::Shadowed);
//! assert!(winding_number(&volume, behind) > Some(0));
//! # Ok::<(), umbrage::geom::LightError>(())
//! ```
//!
//! # Features
//!
//! - `files` (default): readers and writers of mesh files, and pictures as PNG.
//! - `cli` (default): the command `umbrage`; brings `files`, `serde` and `verify`.
//! - `gpu` (default): silhouettes, volumes and the stencil pass on a graphics adapter, by wgpu.
//! - `parallel` (default): verification and pictures on several threads; the same bytes either way.
//! - `verify`: the big-integer reference, verification at points, `accuracy` and torture.
//! - `serde`: `Serialize` for reports, with the keys of the command's JSON.
//! - `viewer`: the window of `umbrage view`; needs Rust 1.95.
//! - `testing`: strategies for property tests of shadows, with proptest; promises nothing between versions.
//!
//! `--no-default-features` leaves a lean geometry library: at most 20 crates, itself included.
//!
//! # Limits
//!
//! - Everything is exact with respect to the `f32` positions after transforms are applied; what happens
//!   before that, in the modelling program or in the transform, is rounded.
//! - A scene that is not posed stands as its file stores it: a skinned mesh in its bind pose, MD2 in its
//!   first frame. [`Scene::pose`](scene::Scene::pose) puts it at a time; of KHR_animation_pointer nothing is
//!   read.
//! - Vertices of a posed mesh are one where they coincide at rest and every time of the clip moves them
//!   alike: a skin that parts a seam opens it in every pose, and none closes where a pose brings vertices
//!   together.
//! - Textures are not read. What a material makes invisible everywhere (a mask below its cutoff, a blend with
//!   alpha 0) neither is drawn nor casts, and a note says so; what a texture cuts out casts, and a note says
//!   that.
//! - Lights with an extent (`,radius=R`, `,angle=DEG`, `rect:…`) cast hard shadows from their center unless a
//!   soft technique is asked for; the command says so.
//! - Orthographic cameras are refused by the stencil pass as not built yet, while rays draw them.
//! - Pictures have plain falloff, the same light at every distance, unless `--falloff physical` asks for that
//!   of KHR_lights_punctual.
//! - Whether a shell may cast with half its faces is proven only for watertight shells that do not meet
//!   themselves; all others, sound or not, cast with all faces.
//! - A stencil pass is as good as its rasterizer: a count may differ from the exact one where that changes
//!   within 1/256 pixel or within the derived error of two depths (`umbrage::verify::pixels`), and nowhere
//!   else; `verify --gpu` looks. Single pixels that nothing explains are known in odd views (twelve of 30,000
//!   for `openscad_nonmanifold.obj` with the eye 0.15 units above a wall; the counts differ, in or out does
//!   not).
//! - Far from the origin the points that a ray-cast picture shades are as coarse as `f32` is there; the
//!   stencil pass and its comparison work relative to the eye and to the mesh.
//! - Buffers are not split: a mesh whose vertices, faces or volume do not fit one storage buffer of the
//!   adapter (128 MiB on Mesa's software driver, about 10 million triangles) is refused by name and stays
//!   with the processor.
//! - In real-time mode, without read-back, a face that the shader is not sure of keeps the sign that `f32`
//!   gave it: the volume is closed all the same, and the number of such faces can be read later.
//! - The verification abstains where a point lies exactly on the volume, and reports how often.
//! - The methods share their predicates; what guards those is integer arithmetic on a sample and in their own
//!   tests.
//! - A file larger than memory can still end the process in a stage after reading; counts that a file only
//!   claims cannot.
//! - No code here is `unsafe`, and lints forbid it; dependencies are another matter, and fuzzing runs them
//!   under AddressSanitizer.
#![cfg_attr(docsrs, feature(doc_cfg))]

pub mod geom;
pub mod mesh;
pub mod view;
#[cfg(feature = "gpu")]
pub mod gpu;
pub mod animate;
pub mod scene;
#[cfg(feature = "files")]
pub mod read;
#[cfg(feature = "files")]
pub mod write;
pub mod oracle;
pub mod topology;
pub mod check;
pub mod repair;
pub mod facing;
pub mod caster;
pub mod silhouette;
pub mod light_grid;
pub mod shadow;
pub mod ambient;
pub mod plan;
pub mod verify;
pub mod testing;
#[cfg(feature = "verify")]
pub mod accuracy;
pub mod render;

#[cfg(test)]
mod determinism;
mod built;
mod choice;
mod fault;
#[cfg(feature = "serde")]
mod json;
mod parallel;
mod random;

// Transforms and cameras speak glam; this is the version they speak.
pub use choice::{Choice, Reason};
pub use glam;
