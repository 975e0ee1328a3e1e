//! Keys: what a part depends on, and nothing else.

use std::hash::{Hash, Hasher};

use super::Posed;
use super::fault::{Fault, Faults};
use crate::scene::Lamp;
use crate::shadow::Technique;
use crate::view::{Projection, Size};

/// What the positions of a caster depend on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) struct CasterKey {
    pub(super) mesh: u32,
    frame: u32,
    /// Of the transform, the bits: −0 and 0 round differently.
    place: [u32; 16],
}

impl CasterKey {
    pub(super) fn of(posed: &Posed<'_>, faults: Faults) -> Self {
        let place = posed.world_from_mesh.to_cols_array().map(f32::to_bits);
        Self {
            mesh: posed.mesh,
            frame: if faults.has(Fault::Frame) { 0 } else { posed.frame },
            place: if faults.has(Fault::Place) { [0; 16] } else { place },
        }
    }
}

/// What a shadow volume depends on beside its caster.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct LightKey([u32; 4]);

impl LightKey {
    pub(super) fn of(lamp: &Lamp, faults: Faults) -> Self {
        let light = lamp.light();
        let [x, y, z] = light.xyz();
        let w = f32::from(u8::from(!light.is_directional()));
        Self(if faults.has(Fault::Light) { [0; 4] } else { [x, y, z, w].map(f32::to_bits) })
    }
}

impl Hash for LightKey {
    fn hash<H: Hasher>(&self, state: &mut H) {
        self.0.hash(state);
    }
}

/// What the visible points depend on.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct ViewKey {
    casters: Vec<CasterKey>,
    view: Option<(Projection, Size)>,
}

impl ViewKey {
    pub(super) fn of(casters: &[CasterKey], view: (Projection, Size), faults: Faults) -> Self {
        Self {
            casters: if faults.has(Fault::Casters) { Vec::new() } else { casters.to_vec() },
            view: (!faults.has(Fault::View)).then_some(view),
        }
    }
}

/// What the entries of a light grid depend on: the light, all casters, and how fine it is.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct GridKey {
    casters: Vec<CasterKey>,
    light: Option<LightKey>,
    side: u32,
}

impl GridKey {
    pub(super) fn of(casters: &[CasterKey], lamp: &Lamp, side: u32, faults: Faults) -> Self {
        Self {
            casters: if faults.has(Fault::GridCasters) { Vec::new() } else { casters.to_vec() },
            light: (!faults.has(Fault::GridLight)).then(|| LightKey::of(lamp, faults)),
            side: if faults.has(Fault::GridSide) { 0 } else { side },
        }
    }
}

/// What relevance depends on: all of a lamp, and the visible points.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct RelevanceKey {
    pub(super) view: ViewKey,
    lamp: Lamp,
    physical_falloff: bool,
}

impl RelevanceKey {
    pub(super) fn of(view: &ViewKey, lamp: &Lamp, physical_falloff: bool, faults: Faults) -> Self {
        let mut lamp = lamp.clone();
        if faults.has(Fault::Brightness) {
            (lamp.intensity, lamp.color, lamp.range) = (1.0, [1.0; 3], None);
        }
        Self { view: view.clone(), lamp, physical_falloff }
    }
}

/// What the visibility of a lamp depends on: not on how bright it is.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct VisibilityKey {
    view: ViewKey,
    lamp: Lamp,
    technique: Technique,
}

impl VisibilityKey {
    pub(super) fn of(view: &ViewKey, lamp: &Lamp, technique: Technique) -> Self {
        let shape =
            Lamp { name: String::new(), color: [1.0; 3], intensity: 1.0, range: None, ..lamp.clone() };
        Self { view: view.clone(), lamp: shape, technique }
    }
}
