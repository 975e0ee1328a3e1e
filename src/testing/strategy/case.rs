//! Lights and points that are hard for a mesh, and all three together.

use proptest::collection::vec;
use proptest::prelude::*;

use super::choices::{Choices, drawn};
use crate::geom::Light;
use crate::mesh::Mesh;
use crate::testing::generate::{self, LightKind};
use crate::verify::points::sampler::Sampler;

/// A point light or a directional one, often on the grid.
///
/// ```
/// use proptest::prelude::*;
/// use umbrage::geom::Light;
/// use umbrage::testing::strategy::light;
///
/// proptest!(|(light in light())| prop_assert_eq!(light.to_string().parse::<Light>(), Ok(light)));
/// ```
pub fn light() -> impl Strategy<Value = Light> + Clone {
    drawn(|draw| LightKind::Anywhere.draw(draw, &Mesh::default()))
}

/// A light that is drawn before its mesh is known; `any::<LightPick>()` draws one.
///
/// On a vertex, on an edge, on a face, in a face's plane, or one unit in the last place off; between
/// vertices, and where its coordinates are those of vertices; anywhere; up to 2⁴⁰ diagonals away; directional
/// along an axis, along an edge, or anywhere.
///
/// ```
/// use proptest::prelude::*;
/// use umbrage::testing::shapes;
/// use umbrage::testing::strategy::LightPick;
///
/// let cube = shapes::cube();
/// proptest!(|(pick in any::<LightPick>())| prop_assert_eq!(pick.at(&cube), pick.at(&cube)));
/// ```
#[derive(Clone, Copy, Debug)]
pub struct LightPick(Choices<16>);

impl LightPick {
    /// The light for `mesh`.
    #[must_use]
    pub fn at(&self, mesh: &Mesh) -> Light {
        self.0.give(|draw| generate::moderate_light(draw, mesh))
    }
}

impl Arbitrary for LightPick {
    type Parameters = ();
    type Strategy = BoxedStrategy<Self>;

    fn arbitrary_with((): ()) -> BoxedStrategy<Self> {
        Choices::any().prop_map(Self).boxed()
    }
}

/// A point that is drawn before its mesh and light are known; `any::<PointPick>()` draws one.
///
/// On a vertex, on an edge, on a face, in a face's plane; such a position pushed away from the light or
/// pulled towards it; on a side of the shadow volume, behind a silhouette edge or one of its ends; anywhere
/// in twice the box around the mesh, or anywhere. One in four is moved by up to two units in the last place.
///
/// ```
/// use proptest::prelude::*;
/// use umbrage::geom::Light;
/// use umbrage::oracle::Oracle;
/// use umbrage::testing::shapes;
/// use umbrage::testing::strategy::PointPick;
///
/// let (cube, light) = (shapes::cube(), Light::point([3.0, 4.0, 5.0])?);
/// let oracle = Oracle::build(&cube);
/// proptest!(|(pick in any::<PointPick>())| {
///     let p = pick.at(&cube, &light);
///     prop_assert_eq!(oracle.verdict(p, &light), oracle.crossings(p, &light).verdict());
/// });
/// # Ok::<(), umbrage::geom::LightError>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct PointPick(Choices<16>);

impl PointPick {
    /// The point for `mesh` and `light`. Builds the topology and the silhouette of the mesh.
    #[must_use]
    pub fn at(&self, mesh: &Mesh, light: &Light) -> [f32; 3] {
        self.among(&Sampler::of(mesh, light))
    }

    fn among(&self, sampler: &Sampler<'_>) -> [f32; 3] {
        self.0.give(|draw| sampler.any(draw))
    }
}

impl Arbitrary for PointPick {
    type Parameters = ();
    type Strategy = BoxedStrategy<Self>;

    fn arbitrary_with((): ()) -> BoxedStrategy<Self> {
        Choices::any().prop_map(Self).boxed()
    }
}

/// What a shadow test is asked about.
#[derive(Clone, Debug, PartialEq)]
pub struct Case {
    /// What casts.
    pub mesh: Mesh,
    /// Where the light comes from.
    pub light: Light,
    /// Where to ask.
    pub points: Vec<[f32; 3]>,
}

/// Meshes from `meshes`, each with a [`LightPick`] and one to `points` [`PointPick`]s of its own.
///
/// ```
/// use proptest::prelude::*;
/// use umbrage::caster::Caster;
/// use umbrage::facing::CasterFaces;
/// use umbrage::oracle::Verdict;
/// use umbrage::shadow::volume::{Caps, ShadowVolume, winding_number};
/// use umbrage::testing::strategy::{case, closed};
///
/// // The emitted volume and the exact ray cast agree, but for declared ties.
/// proptest!(|(case in case(closed(), 4))| {
///     let (caster, light) = (Caster::new(case.mesh.clone()), &case.light);
///     let signs = CasterFaces::All.signs(&caster.facing(light));
///     let edges = caster.silhouette(light, CasterFaces::All);
///     let volume =
///         ShadowVolume::extrude(caster.mesh(), caster.topology(), light, &signs, &edges, Caps::Both);
///     for &p in &case.points {
///         let verdict = caster.oracle().verdict(p, light);
///         if let (Some(winding), true) = (winding_number(&volume, p), verdict != Verdict::Grazing) {
///             prop_assert_eq!(winding > 0, verdict == Verdict::Shadowed, "at {:?}", p);
///         }
///     }
/// });
/// ```
///
/// # Panics
///
/// Panics if `points` is 0.
pub fn case(
    meshes: impl Strategy<Value = Mesh> + Clone,
    points: usize,
) -> impl Strategy<Value = Case> + Clone {
    // In the order in which they shrink: faces go more easily once the picks need few of them.
    (vec(any::<PointPick>(), 1..=points), any::<LightPick>(), meshes).prop_map(|(points, light, mesh)| {
        let light = light.at(&mesh);
        let sampler = Sampler::of(&mesh, &light);
        let points = points.iter().map(|point| point.among(&sampler)).collect();
        Case { mesh, light, points }
    })
}
