//! Choice between z-pass and z-fail, per shell and light, with its reason.
//!
//! z-pass counts are exact iff the near rectangle of the camera is in no volume and is cut by none. This
//! holds iff no caster meets the convex hull of the light and the rectangle (for a directional light, the
//! prism that starts at the rectangle). In all other cases z-fail is chosen. (The rule: Samuel Hornus, Jared
//! Hoberock, Sylvain Lefebvre, John C. Hart, *ZP+: Correct Z-pass Stencil Shadows*, 2005, section 2.) The
//! proof is in `light_pyramid.rs`. The proof errs on the safe side only: a shell that nearly touches the hull
//! is drawn with z-fail, which is also correct and only costs time.

use super::StencilMethod;
use super::light_pyramid::LightPyramid;
use crate::caster::{ShellBox, ShellBoxes};
use crate::choice::{Choice, Reason};
use crate::geom::{Aabb, Light};
use crate::mesh::Mesh;
use crate::topology::Shells;
use crate::view::Projection;

/// Counting methods of all shells, for one light and one camera.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ShellMethods {
    /// One choice per shell, in shell order.
    pub choices: Vec<Choice<StencilMethod>>,
}

impl ShellMethods {
    /// Chooses a method for every shell. For many lights or frames on one mesh, build [`ShellBoxes`] once and
    /// use [`ShellBoxes::choose`].
    ///
    /// # Panics
    ///
    /// Panics if `shells` belongs to another mesh.
    ///
    /// ```
    /// use umbrage::geom::Light;
    /// use umbrage::view::{Projection, ProjectionKind};
    /// use umbrage::shadow::stencil::{ShellMethods, StencilMethod};
    /// use umbrage::testing::shapes;
    /// use umbrage::topology::Topology;
    /// let cube = shapes::cube();
    /// let shells = Topology::of(&cube).shells();
    /// let (right, up, forward) = ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]);
    /// let kind = ProjectionKind::InfinitePerspective;
    /// let camera = Projection { eye: [0.0, 0.0, 5.0], right, up, forward, near: 0.1, kind };
    /// let beside = ShellMethods::choose(&cube, &shells, &camera, &"point:0,9,5".parse()?, None);
    /// assert_eq!(beside.choices[0].what, StencilMethod::ZPass);
    /// let behind = ShellMethods::choose(&cube, &shells, &camera, &"point:0,0,-5".parse()?, None);
    /// assert_eq!(behind.choices[0].what, StencilMethod::ZFail);
    /// # Ok::<(), umbrage::geom::LightError>(())
    /// ```
    #[must_use]
    pub fn choose(
        mesh: &Mesh,
        shells: &Shells,
        projection: &Projection,
        light: &Light,
        asked: Option<StencilMethod>,
    ) -> Self {
        match asked {
            None => ShellBoxes::new(mesh, shells).choose(mesh, projection, light),
            Some(method) => Self::all(method, shells.count),
        }
    }

    /// The same method for each of `count` shells, as requested.
    pub(crate) fn all(method: StencilMethod, count: usize) -> Self {
        let why = match method {
            StencilMethod::ZPass => Reason::ZPassAsked,
            StencilMethod::ZFail => Reason::ZFailAsked,
        };
        Self { choices: vec![Choice::new(method, why); count] }
    }

    /// The casting signs of the shells counted by `method`; 0 for all other faces.
    ///
    /// # Panics
    ///
    /// Panics if `shells` or `signs` belong to another mesh.
    #[must_use]
    pub fn signs_of(&self, method: StencilMethod, shells: &Shells, signs: &[i8]) -> Vec<i8> {
        assert_eq!(shells.of_face.len(), signs.len(), "one sign per face");
        let counted =
            |shell: Option<u32>| shell.is_some_and(|shell| self.choices[shell as usize].what == method);
        let sign = |(&shell, &sign): (&Option<u32>, &i8)| if counted(shell) { sign } else { 0 };
        shells.of_face.iter().zip(signs).map(sign).collect()
    }

    /// Number of shells counted by `method`.
    #[must_use]
    pub fn count(&self, method: StencilMethod) -> usize {
        self.choices.iter().filter(|choice| choice.what == method).count()
    }

    /// Summary for people: the number of shells per method, and the reason. Without shells: "nothing casts".
    #[must_use]
    pub fn summary(&self) -> String {
        let lines = [StencilMethod::ZPass, StencilMethod::ZFail].into_iter().filter_map(|method| {
            let count = self.count(method);
            // All shells of one method have the same reason.
            let choice = self.choices.iter().find(|choice| choice.what == method)?;
            let shells = if count == 1 { "shell" } else { "shells" };
            Some(format!("{} for {count} {shells}: {choice}", method.name()))
        });
        let lines: Vec<String> = lines.collect();
        if lines.is_empty() { "nothing casts".to_owned() } else { lines.join("; ") }
    }
}

impl ShellBoxes {
    /// Chooses a method for every shell: z-pass if proven to count correctly, otherwise z-fail. `mesh` must
    /// be the mesh given to [`ShellBoxes::new`].
    ///
    /// Cost: a fraction of a microsecond for a shell whose box misses the light pyramid. For other shells the
    /// same per block of faces, and per face of blocks that do not miss the pyramid, until a face is found
    /// that may meet the pyramid.
    ///
    /// # Panics
    ///
    /// Panics if `mesh` has fewer faces.
    #[must_use]
    pub fn choose(&self, mesh: &Mesh, projection: &Projection, light: &Light) -> ShellMethods {
        let mut wedge = LightPyramid::new(projection, light);
        let (mut first_block, mut first_face) = (0, 0);
        let choose = |shell: &ShellBox| {
            let blocks = &self.blocks[first_block..shell.end as usize];
            first_block = shell.end as usize;
            let faces_from = first_face;
            first_face = blocks.last().map_or(first_face, |block| block.end as usize);
            let clear = wedge.misses(&corners(&shell.bounds)) || {
                let mut start = faces_from;
                blocks.iter().all(|block| {
                    let faces = &self.faces[start..block.end as usize];
                    start = block.end as usize;
                    wedge.misses(&corners(&block.bounds))
                        || faces.iter().all(|&face| wedge.misses(&mesh.corners(face)))
                })
            };
            if clear {
                Choice::new(StencilMethod::ZPass, Reason::NothingBetween)
            } else {
                Choice::new(StencilMethod::ZFail, Reason::MayLieBetween)
            }
        };
        ShellMethods { choices: self.shells.iter().map(choose).collect() }
    }
}

/// The eight corners of a box. The convex hull of the corners contains the contents of the box.
fn corners(bounds: &Aabb) -> [[f32; 3]; 8] {
    std::array::from_fn(|k| {
        std::array::from_fn(|i| if k >> i & 1 == 0 { bounds.low[i] } else { bounds.high[i] })
    })
}
