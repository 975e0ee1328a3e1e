//! A material: what shadows and flat pictures need of it.

/// Color and transparency of faces. Textures are not read.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// The name in the file; may be empty.
    pub name: String,
    /// Linear red, green, blue, each from 0 to 1; `None` if the file states none.
    pub base_color: Option<[f32; 3]>,
    /// 1 is opaque, 0 is not there; from 0 to 1. Only modes other than opaque heed it.
    pub alpha: f32,
    /// What alpha does.
    pub alpha_mode: AlphaMode,
    /// Of a mask: the alpha from which on there is something.
    pub alpha_cutoff: f32,
    /// Whether a texture says where alpha is less than [`Material::alpha`].
    pub textured: bool,
}

/// The effect of alpha on faces.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum AlphaMode {
    /// Nothing.
    #[default]
    Opaque,
    /// The face is there where alpha is at least the cutoff, and is not there elsewhere.
    Mask,
    /// The face covers what is behind it by this part.
    Blend,
}

/// Opaque, and without a name or a color.
impl Default for Material {
    fn default() -> Self {
        Self {
            name: String::new(),
            base_color: None,
            alpha: 1.0,
            alpha_mode: AlphaMode::Opaque,
            alpha_cutoff: 0.5,
            textured: false,
        }
    }
}

impl Material {
    /// Whether a face of it is never seen: a mask whose alpha is below the cutoff everywhere, or a blend of
    /// 0. A texture cannot change that: it multiplies alpha by 1 at most.
    #[must_use]
    pub fn is_invisible(&self) -> bool {
        match self.alpha_mode {
            AlphaMode::Opaque => false,
            AlphaMode::Mask => self.alpha < self.alpha_cutoff,
            AlphaMode::Blend => self.alpha == 0.0,
        }
    }

    /// Whether a texture that is not read may make parts of faces invisible.
    #[must_use]
    pub fn may_be_cut_out(&self) -> bool {
        self.textured && self.alpha_mode != AlphaMode::Opaque && !self.is_invisible()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn material_is_invisible_by_its_mode() {
        let material =
            |alpha_mode, alpha| Material { alpha_mode, alpha, textured: true, ..Material::default() };
        for (mode, alpha, invisible) in [
            (AlphaMode::Opaque, 0.0, false),
            (AlphaMode::Mask, 0.49, true),
            (AlphaMode::Mask, 0.5, false),
            (AlphaMode::Blend, 0.0, true),
            (AlphaMode::Blend, 1e-6, false),
        ] {
            let material = material(mode, alpha);
            assert_eq!(material.is_invisible(), invisible, "{material:?}");
            assert_eq!(material.may_be_cut_out(), mode != AlphaMode::Opaque && !invisible, "{material:?}");
        }
    }
}
