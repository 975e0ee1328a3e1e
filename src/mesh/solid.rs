//! Solids
