//! A mesh and all that is known of it before any light.

mod proofs;

pub use proofs::ShellProof;
