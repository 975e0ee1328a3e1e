//! What is planned for.

use crate::caster::CasterGroup;
use crate::scene::Lamp;
use crate::shadow::Samples;

/// What a plan is made for: casters, lamps, a view, and how it is drawn.
///
/// ```
/// use umbrage::caster::{Caster, CasterGroup};
/// use umbrage::plan::{Budget, Costs, Scenery, plan};
/// use umbrage::shadow::Samples;
/// use umbrage::testing::shapes;
/// use umbrage::view::{Camera, Size, Up};
///
/// let caster = Caster::new(shapes::torus(24, 12, 2.0, 0.7));
/// let casters = CasterGroup::new(vec![&caster]);
/// let size = Size::new(64, 48)?;
/// let camera = Camera::fit(&casters.bounds(), Up::Y, size.aspect());
/// let samples = Samples::of_view(&casters, &camera.projection(size, 0.1), size, 1)?;
/// let lamps = ["point:3,9,5".parse()?, "directional:0,-1,0".parse()?];
///
/// let plan = plan(&Scenery::new(&casters, &lamps, &samples), &Budget::default(), &Costs::default());
/// assert_eq!(plan.lamps.len(), 2);
/// assert!(plan.meets_budget && plan.total.bound == 0.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct Scenery<'a> {
    /// The casters.
    pub casters: &'a CasterGroup<'a>,
    /// The lamps.
    pub lamps: &'a [Lamp],
    /// The visible points.
    pub samples: &'a Samples,
    /// Whether the lamps' light falls off with the distance, to 0 at their range.
    pub physical_falloff: bool,
    /// Number of pictures that share what does not depend on the lamps: ray trees and topology. At least 1.
    pub frames: u32,
    /// Whether the ray tree over the casters is built already.
    pub has_tree: bool,
    /// Name of the graphics adapter; `None` for the CPU alone.
    pub device: Option<&'a str>,
    /// Whether only what is exact or proven is admitted.
    pub prove: bool,
    /// Whether the picture has an ambient term, so that ambient occlusion could change it.
    pub ambient: bool,
    /// Whether all relevance tests run, also where they take longer than they may save.
    pub thorough: bool,
}

impl<'a> Scenery<'a> {
    /// One picture on the CPU, without falloff, with an ambient term. Bounds that were sampled are admitted.
    #[must_use]
    pub fn new(casters: &'a CasterGroup<'a>, lamps: &'a [Lamp], samples: &'a Samples) -> Self {
        Self {
            casters,
            lamps,
            samples,
            physical_falloff: false,
            frames: 1,
            // What casts is what is seen: the samples came from the same tree.
            has_tree: casters.seen_caster().is_none(),
            device: None,
            prove: false,
            ambient: true,
            thorough: false,
        }
    }
}
