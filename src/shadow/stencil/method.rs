//! z-pass or z-fail, for every shell and light, with the reason.
//!
//! z-pass counts are exact iff the near rectangle of the camera is in no volume and is cut by none: iff no caster
//! meets the convex hull of the light and the rectangle (for a directional light, the prism that starts at the
//! rectangle). Everything else is z-fail. (The rule: Samuel Hornus, Jared Hoberock, Sylvain Lefebvre, John C. Hart,
//! *ZP+: Correct Z-pass Stencil Shadows*, 2005, section 2.) The proof stands in `apart.rs` and errs on the safe
//! side alone: a shell that nearly touches the hull is drawn with z-fail, which is right as well and only costs time.

use std::fmt;

use super::StencilMethod;
use super::light_pyramid::LightPyramid;
use crate::geom::{Aabb, Light};
use crate::mesh::{FaceId, Mesh};
use crate::topology::Shells;
use crate::view::Projection;

/// What the caller wants drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Asked {
    /// z-pass where that is proven to count right, z-fail elsewhere.
    #[default]
    Auto,
    /// z-pass everywhere, proven or not.
    ZPass,
    /// z-fail everywhere.
    ZFail,
}

/// Why a method was chosen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reason {
    /// It was asked for.
    Asked,
    /// No face of the shell meets the convex hull of the light and the near rectangle: proven.
    NothingBetween,
    /// A face may meet it: not disproven.
    MayLieBetween,
}

/// What was chosen for one shell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MethodChoice {
    /// How it is counted.
    pub method: StencilMethod,
    /// Why.
    pub reason: Reason,
}

/// The reason, in words.
impl fmt::Display for MethodChoice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match (self.reason, self.method) {
            (Reason::Asked, StencilMethod::ZPass) => "z-pass was asked for; nothing is proven",
            (Reason::Asked, StencilMethod::ZFail) => "z-fail was asked for",
            (Reason::NothingBetween, _) => "nothing of it can lie between the light and the near rectangle",
            (Reason::MayLieBetween, _) => "a face may lie between the light and the near rectangle",
        })
    }
}

/// How each shell is counted, for one light and one camera.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MethodPlan {
    /// One choice a shell, in the order of the shells.
    pub choices: Vec<MethodChoice>,
}

impl MethodPlan {
    /// Chooses for every shell. For many lights or frames on one mesh, prepare [`ShellBoxes`] once and use
    /// [`ShellBoxes::choose`].
    ///
    /// # Panics
    ///
    /// Panics if `shells` belongs to another mesh.
    ///
    /// ```
    /// use umbrage::geom::Light;
    /// use umbrage::view::Projection;
    /// use umbrage::shadow::stencil::{Asked, MethodPlan, StencilMethod};
    /// use umbrage::testing::shapes;
    /// use umbrage::topology::Topology;
    /// let cube = shapes::cube();
    /// let shells = Topology::build(cube.vertex_count(), cube.triangles().to_vec()).shells();
    /// let (right, up, forward) = ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]);
    /// let camera = Projection { eye: [0.0, 0.0, 5.0], right, up, forward, near: 0.1 };
    /// let beside = MethodPlan::choose(&cube, &shells, &camera, &"point:0,9,5".parse()?, Asked::Auto);
    /// assert_eq!(beside.choices[0].method, StencilMethod::ZPass);
    /// let behind = MethodPlan::choose(&cube, &shells, &camera, &"point:0,0,-5".parse()?, Asked::Auto);
    /// assert_eq!(behind.choices[0].method, StencilMethod::ZFail);
    /// # Ok::<(), umbrage::geom::LightError>(())
    /// ```
    #[must_use]
    pub fn choose(
        mesh: &Mesh,
        shells: &Shells,
        projection: &Projection,
        light: &Light,
        asked: Asked,
    ) -> Self {
        match asked {
            Asked::Auto => ShellBoxes::new(mesh, shells).choose(mesh, projection, light),
            Asked::ZPass => Self::as_asked(StencilMethod::ZPass, shells.count),
            Asked::ZFail => Self::as_asked(StencilMethod::ZFail, shells.count),
        }
    }

    fn as_asked(method: StencilMethod, count: usize) -> Self {
        Self { choices: vec![MethodChoice { method, reason: Reason::Asked }; count] }
    }

    /// How many shells each method has.
    #[must_use]
    pub fn count(&self, method: StencilMethod) -> usize {
        self.choices.iter().filter(|choice| choice.method == method).count()
    }

    /// For a person: how many shells each method has, and why. Empty without shells.
    #[must_use]
    pub fn summary(&self) -> String {
        let lines = [StencilMethod::ZPass, StencilMethod::ZFail].into_iter().filter_map(|method| {
            let count = self.count(method);
            // All shells of one method have one reason.
            let choice = self.choices.iter().find(|choice| choice.method == method)?;
            let shells = if count == 1 { "shell" } else { "shells" };
            Some(format!("{} for {count} {shells}: {choice}", method.name()))
        });
        let lines: Vec<String> = lines.collect();
        if lines.is_empty() { "nothing casts".to_owned() } else { lines.join("; ") }
    }
}

/// The faces of every shell in blocks with boxes around them, so that a shell far from the light's way to the camera
/// costs one test. Made once for a mesh that rests; 4 bytes a face and 32 a block.
#[derive(Clone, Debug)]
pub struct ShellBoxes {
    /// Faces by shell, ascending within each.
    faces: Vec<FaceId>,
    blocks: Vec<Block>,
    shells: Vec<Shell>,
}

/// Some faces of one shell: those before `end` that the block before it does not hold.
#[derive(Clone, Copy, Debug)]
struct Block {
    bounds: Aabb,
    end: u32,
}

/// All blocks of one shell: those before `end` that the shell before it does not hold.
#[derive(Clone, Copy, Debug)]
struct Shell {
    bounds: Aabb,
    end: u32,
}

/// Faces a block: neighbors in most files, so that their box is small.
const BLOCK: usize = 32;

impl ShellBoxes {
    /// Sorts the faces by shell and puts boxes around them. Linear time. Memory: 6 bytes a face at its peak, and 150 a
    /// shell.
    ///
    /// # Panics
    ///
    /// Panics if `shells` belongs to another mesh.
    #[must_use]
    pub fn new(mesh: &Mesh, shells: &Shells) -> Self {
        assert_eq!(shells.of_face.len(), mesh.face_count(), "one shell a face");
        let mut faces_of = vec![0_usize; shells.count + 1];
        for shell in shells.of_face.iter().flatten() {
            faces_of[*shell as usize + 1] += 1;
        }
        for shell in 0..shells.count {
            faces_of[shell + 1] += faces_of[shell];
        }
        let mut next = faces_of.clone();
        let mut faces = vec![FaceId::new(0); faces_of[shells.count]];
        for (face, shell) in shells.of_face.iter().enumerate() {
            let Some(shell) = shell else { continue }; // collapsed: never casts
            faces[next[*shell as usize]] = FaceId::new(face);
            next[*shell as usize] += 1;
        }
        let mut boxes = Self { faces: Vec::new(), blocks: Vec::new(), shells: Vec::new() };
        for run in faces_of.windows(2) {
            let mut bounds = Aabb::EMPTY;
            let mut end = run[0];
            for block in faces[run[0]..run[1]].chunks(BLOCK) {
                let around = Aabb::around(block.iter().flat_map(|&face| mesh.corners(face)));
                bounds = bounds.join(&around);
                end += block.len();
                boxes.blocks.push(Block { bounds: around, end: end as u32 }); // face ids are 32 bits
            }
            boxes.shells.push(Shell { bounds, end: boxes.blocks.len() as u32 });
        }
        Self { faces, ..boxes }
    }

    /// Chooses for every shell: z-pass where it is proven to count right, z-fail elsewhere. `mesh` is that of
    /// [`ShellBoxes::new`].
    ///
    /// A fraction of a microsecond for a shell whose box is out of the way; for others as much a block, and
    /// a face of those blocks, until one is found that may be in the way.
    ///
    /// # Panics
    ///
    /// Panics if `mesh` has fewer faces.
    #[must_use]
    pub fn choose(&self, mesh: &Mesh, projection: &Projection, light: &Light) -> MethodPlan {
        let mut wedge = LightPyramid::new(projection, light);
        let (mut first_block, mut first_face) = (0, 0);
        let choose = |shell: &Shell| {
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
                MethodChoice { method: StencilMethod::ZPass, reason: Reason::NothingBetween }
            } else {
                MethodChoice { method: StencilMethod::ZFail, reason: Reason::MayLieBetween }
            }
        };
        MethodPlan { choices: self.shells.iter().map(choose).collect() }
    }
}

/// The eight corners of a box. What misses them misses all in it.
fn corners(bounds: &Aabb) -> [[f32; 3]; 8] {
    std::array::from_fn(|k| {
        std::array::from_fn(|i| if k >> i & 1 == 0 { bounds.low[i] } else { bounds.high[i] })
    })
}
