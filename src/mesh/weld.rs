//! Welding.
/// x
pub struct Weld;
/// x
pub struct Welded;
/// x
pub fn weld() {}
