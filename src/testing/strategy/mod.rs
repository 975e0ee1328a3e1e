//! Strategies for property tests: meshes, lights and points that are hard for shadows.
//!
//! For the `proptest` crate. Values come from [`generate`](super::generate). The choices of the generator are
//! what shrinks, so a failure ends at few faces with small integer coordinates. Sizes are small: hundreds of
//! cases take seconds.
//!
//! - meshes: [`soup`], [`soup_at`]; [`closed()`] (of [`voxel_solid`], [`hollow`], [`bent`], [`several`]);
//!   [`cad()`]; [`damaged`], which reports its damage; [`mesh()`], any of the small ones; [`at_scale`]
//! - lights: [`light()`], and for a given mesh [`LightPick`]
//! - points: [`place`], and for a given mesh and light [`PointPick`]
//! - all three together: [`case()`], a [`Case`]
//!
//! A pick is drawn before the mesh is known and resolved by its method `at`, as proptest's own
//! [`Index`](proptest::sample::Index) is: so mesh, light and points shrink independently.
//!
//! # Your own shadows against the oracle
//!
//! A textbook shadow ray with its customary epsilon; the strategies find where it is wrong.
//!
//! ```
//! use proptest::prelude::*;
//! use proptest::test_runner::{Config, TestError, TestRunner};
//! use umbrage::mesh::Mesh;
//! use umbrage::oracle::{Oracle, Verdict};
//! use umbrage::testing::strategy::{case, closed};
//!
//! // Yours: whether the ray from p towards a point or direction meets the triangle (Möller & Trumbore 1997).
//! fn hits(p: [f32; 3], ray: [f64; 3], [a, b, c]: [[f32; 3]; 3]) -> Option<f64> {
//!     let sub = |u: [f32; 3], v: [f32; 3]| [0, 1, 2].map(|i| f64::from(u[i]) - f64::from(v[i]));
//!     let dot = |u: [f64; 3], v: [f64; 3]| u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
//!     let cross = |u: [f64; 3], v: [f64; 3]| {
//!         [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]
//!     };
//!     let (e1, e2, s) = (sub(b, a), sub(c, a), sub(p, a));
//!     let (h, k) = (cross(ray, e2), cross(s, e1));
//!     let det = dot(e1, h);
//!     let (u, v, t) = (dot(s, h) / det, dot(ray, k) / det, dot(e2, k) / det);
//!     (det != 0.0 && u >= 0.0 && v >= 0.0 && u + v <= 1.0).then_some(t)
//! }
//! fn in_shadow(mesh: &Mesh, p: [f32; 3], [x, y, z, w]: [f32; 4]) -> bool {
//!     let toward = [x, y, z].map(f64::from);
//!     let ray = [0, 1, 2].map(|i| toward[i] - f64::from(p[i]) * f64::from(w));
//!     let far = if w == 0.0 { f64::INFINITY } else { 1.0 };
//!     let corners = |face: &[u32; 3]| face.map(|vertex| mesh.positions()[vertex as usize]);
//!     let mut hits = mesh.triangles().iter().filter_map(|face| hits(p, ray, corners(face)));
//!     hits.any(|t| 1e-3 < t && t < far)
//! }
//!
//! // In a test of your own: `proptest! { #[test] fn .. (case in case(closed(), 8)) { .. } }`.
//! let config = Config { failure_persistence: None, ..Config::default() };
//! let found = TestRunner::new(config).run(&case(closed(), 8), |case| {
//!     let oracle = Oracle::build(&case.mesh);
//!     for &p in &case.points {
//!         let yours = in_shadow(&case.mesh, p, case.light.homogeneous());
//!         match oracle.verdict(p, &case.light) {
//!             Verdict::Grazing => {} // an exact tie: both answers are right
//!             verdict => prop_assert_eq!(yours, verdict == Verdict::Shadowed, "at {:?}", p),
//!         }
//!     }
//!     Ok(())
//! });
//! assert!(matches!(found, Err(TestError::Fail(..)))); // the case, shrunk
//! ```
//!
//! # Right wherever it can be
//!
//! A tracer in single precision may be wrong where the segment nearly touches something.
//! [`Oracle::margin`](crate::oracle::Oracle::margin) says how nearly: hold it to the exact answer wherever
//! the margin exceeds its error. Here the segment between two points, among several meshes, for a tracer
//! whose ends lie on a grid; a case that fails is shrunk, and prints as an OBJ and as Rust to paste.
//!
//! ```
//! use proptest::prelude::*;
//! use proptest::test_runner::{Config, TestError, TestRunner};
//! use umbrage::geom::Light;
//! use umbrage::oracle::{Oracle, Verdict};
//! use umbrage::testing::shapes;
//! use umbrage::testing::strategy::{Case, closed, place};
//!
//! // Yours: right for the nearest points of a grid of this many cells per unit.
//! fn yours(oracle: &Oracle, from: [f32; 3], to: [f32; 3], cells: f32) -> Verdict {
//!     let [from, to] = [from, to].map(|p| p.map(|x| (x * cells).round() / cells));
//!     oracle.verdict(from, &Light::point(to).unwrap())
//! }
//! let roof = shapes::translated(&shapes::cube(), [0.5, 4.0, 0.25]);
//! let check = |cells: f32| {
//!     let config = Config { cases: 200, failure_persistence: None, ..Config::default() };
//!     TestRunner::new(config).run(&(closed(), place(), place()), |(mesh, from, to)| {
//!         let oracle = Oracle::over(&[&mesh, &roof]);
//!         let light = Light::point(to).unwrap();
//!         // No coordinate of an end is off by more than half a cell.
//!         if oracle.margin(from, &light) > 3_f64.sqrt() / 2.0 / 1024.0 {
//!             let case = Case { mesh, light, points: vec![from] };
//!             let (obj, rust) = (case.to_obj(from), case.to_rust(from));
//!             let (yours, exact) = (yours(&oracle, from, to, cells), oracle.verdict(from, &light));
//!             prop_assert_eq!(yours, exact, "{}{}", obj, rust);
//!         }
//!         Ok(())
//!     })
//! };
//! assert!(check(1024.0).is_ok());
//! assert!(matches!(check(2.0), Err(TestError::Fail(..)))); // a grid that is coarser than it claims
//! ```

mod case;
mod choices;
mod mesh;
mod print;

#[cfg(test)]
mod tests;

pub use super::generate::Damage;
pub use case::{Case, LightPick, PointPick, case, light};
pub use mesh::{
    Damaged, at_scale, bent, cad, closed, coordinate, damaged, hollow, mesh, place, power_of_two, several,
    soup, soup_at, voxel_solid,
};
