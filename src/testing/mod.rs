//! Hard inputs, for this crate's tests and for those of others. Promises nothing between versions.
//!
//! Names, draws and counts here may change in every release, for the sake of harder inputs. The rest of
//! the crate keeps to semantic versioning.
//!
//! - [`shapes`]: meshes with known counts
//! - [`scenes`]: many casters, with views
//! - `corpus` (features `files` and `testing`): small files with known defects
//! - `generate` (feature `verify`): meshes, lights and points from any source of choices, each written once
//! - `strategy` (feature `testing`): the same for proptest, with shrinking
//! - `torture` (feature `verify`): the same at random, and all exact methods compared on them
//!
//! A property test of another crate usually needs three things: a `strategy`, a
//! [`Caster`](crate::caster::Caster) with its [`Oracle`](crate::oracle::Oracle), and the
//! [`Verdict`](crate::oracle::Verdict) to compare with:
//!
//! ```
//! use umbrage::caster::Caster;
//! use umbrage::geom::Light;
//! use umbrage::oracle::Verdict;
//! use umbrage::testing::shapes;
//!
//! let caster = Caster::new(shapes::cube());
//! let light = Light::point([0.0, 5.0, 0.0])?;
//! let verdict = |p| caster.oracle().verdict(p, &light);
//! assert_eq!(verdict([0.0, -2.0, 0.5]), Verdict::Shadowed);
//! assert_eq!(verdict([0.0, 3.0, 0.5]), Verdict::Lit);
//! assert_eq!(verdict([1.0, -1.0, 1.0]), Verdict::Grazing); // on a corner: either answer is right
//! # Ok::<(), umbrage::geom::LightError>(())
//! ```

#[cfg(any(test, feature = "testing"))]
pub use crate::built::{Part as BuiltPart, record as record_built};

#[cfg(feature = "verify")]
#[cfg_attr(
    not(any(test, feature = "testing")),
    expect(dead_code, unused_imports, reason = "only strategies draw some of these meshes")
)]
pub mod generate;
#[cfg(all(feature = "files", any(test, feature = "testing")))]
pub mod corpus;
pub mod scenes;
pub mod shapes;
#[cfg(any(test, feature = "testing"))]
pub mod strategy;
#[cfg(feature = "verify")]
pub mod torture;
