//! The strata: which meshes, lights and points meet in a round.

use crate::geom::Light;
use crate::mesh::Mesh;
use crate::random::SplitMix64;
use crate::testing::generate::{Damage, Draw, LightKind, Scale, Shape, damage};
use crate::verify::points::feature::Feature;
use crate::verify::points::sampler::PointKind;

/// What a stratum draws from, each list evenly.
pub(super) struct Recipe {
    pub(super) name: &'static str,
    pub(super) shapes: &'static [Shape],
    /// Whether faces are dropped, turned, doubled and collapsed.
    pub(super) damaged: bool,
    pub(super) scales: &'static [Scale],
    pub(super) lights: &'static [LightKind],
    pub(super) points: &'static [PointKind],
}

impl Recipe {
    /// A mesh with a face, and a light.
    pub(super) fn draw(&self, random: &mut SplitMix64) -> (Mesh, Light) {
        let draw: &mut dyn Draw = random;
        let mut draft = draw.pick(self.shapes).draw(draw);
        if self.damaged {
            for _ in 0..1 + draw.below(4) {
                damage(draw, Damage::KINDS, &mut draft);
            }
        }
        draw.pick(self.scales).apply(draw, &mut draft.positions);
        let mesh = Mesh::from(draft);
        let light = draw.pick(self.lights).draw(draw, &mesh);
        (mesh, light)
    }
}

const ANY_SHAPE: &[Shape] = {
    use Shape::{Bent, Boxes, Grid, Known, Sliver, Soup, Tetrahedra, Voxels};
    &[Known, Voxels, Boxes, Bent, Tetrahedra, Grid, Soup, Sliver]
};
/// Those with exact ties in all their planes.
const EXACT: &[Shape] = &[Shape::Known, Shape::Voxels, Shape::Boxes, Shape::Grid];
const SOLID: &[Shape] = &[Shape::Voxels, Shape::Boxes, Shape::Bent, Shape::Tetrahedra];

const ON_VERTEX: LightKind = LightKind::On(Feature::Vertex);
const ON_EDGE: &[LightKind] = &[LightKind::On(Feature::Edge), LightKind::On(Feature::Line)];
const IN_PLANE: LightKind = LightKind::On(Feature::Plane);
const FINITE: &[LightKind] = {
    use LightKind::{Corner, Inside, Outside, UlpOff};
    &[ON_VERTEX, ON_EDGE[0], ON_EDGE[1], IN_PLANE, UlpOff, Inside, Corner, Outside]
};
const DIRECTIONS: &[LightKind] = &[LightKind::Axis, LightKind::InPlane, LightKind::Direction];
const ANY_LIGHT: &[LightKind] = {
    use LightKind::{Axis, Corner, Direction, InPlane, Inside, Outside, UlpOff};
    let far = LightKind::FAR;
    &[ON_VERTEX, ON_EDGE[0], IN_PLANE, UlpOff, Inside, Corner, Outside, far, Axis, InPlane, Direction]
};

pub(super) const ON_SURFACE: PointKind = PointKind::On(&[Feature::Vertex, Feature::Edge, Feature::Face], 0);
const HIDDEN: PointKind = PointKind::Behind(&[Feature::Vertex], 2);
const ANY_POINT: &[PointKind] = {
    use PointKind::{BehindSilhouette, Boundary, Box, Corner, Light};
    const ON: [PointKind; 3] = [PointKind::VERTEX_OR_EDGE, PointKind::NEAR_FACE, PointKind::FACE_PLANE];
    &[ON[0], ON[1], ON[2], Corner, HIDDEN, BehindSilhouette(2), Boundary, Box, Light]
};
/// Three in four on the surface.
const SURFACE: &[PointKind] = &[ON_SURFACE, ON_SURFACE, ON_SURFACE, PointKind::FACE_PLANE];
const SHADOW: &[PointKind] =
    &[PointKind::Boundary, PointKind::Boundary, HIDDEN, PointKind::BehindSilhouette(2)];

const GENERIC: Recipe = Recipe {
    name: "generic",
    shapes: ANY_SHAPE,
    damaged: false,
    scales: &[Scale::One],
    lights: &[LightKind::Outside, LightKind::Direction],
    points: &[PointKind::Box],
};

const fn lit(name: &'static str, lights: &'static [LightKind]) -> Recipe {
    Recipe { name, lights, points: ANY_POINT, ..GENERIC }
}

const fn scaled(name: &'static str, scales: &'static [Scale]) -> Recipe {
    Recipe { name, scales, lights: ANY_LIGHT, points: ANY_POINT, ..GENERIC }
}

/// All strata, in the order of the rows. Unless stated otherwise: meshes of any kind without damage, near 1,
/// and points of every kind that [`ANY_POINT`] holds.
///
/// - `generic`: a light in a box five times as large as the mesh or far along any direction, points in a box
///   twice as large: nothing is aimed at.
/// - `light_on_vertex`: exactly. `light_on_edge`: on an edge or its line, rounded. `light_in_plane`: of a
///   face, inside or outside it, rounded.
/// - `light_one_ulp_off`: off one of these three by one ulp in one, two or three coordinates.
/// - `light_far`: a point light 2³⁰ to 2⁴⁰ diagonals away.
/// - `light_inside`: between vertices of a solid, and so mostly inside it.
/// - `points_on_surface`: three in four points on vertices, edges and faces but for rounding, the others in
///   planes of faces, under point lights.
/// - `shadow_boundary`: points on the sides of the volume, or behind vertices and silhouette edges.
/// - `slivers`: triangles and tetrahedra whose height is 1e-7 and less of their length.
/// - `tiny`: times 1e-30 and less, down to where numbers have few bits. `huge`: times 1e30 and more, up to
///   the end of `f32`.
/// - `mixed_scales`: axes, halves or vertices of one mesh times different factors from 1e-30 to 1e30; or
///   moved away by up to 2²⁰ times its size.
/// - `cad_ties`: meshes with exact coincidences, lights and points on their vertices, edges and planes.
/// - `directional`: any direction, along axes, along edges and in planes of faces.
/// - `damaged`: one to four faces dropped, turned, doubled, collapsed, or seams opened by an ulp or two.
/// - `everything`: all of these, damaged, and vertices of any bits.
pub(super) const RECIPES: [Recipe; 17] = [
    GENERIC,
    lit("light_on_vertex", &[ON_VERTEX]),
    lit("light_on_edge", ON_EDGE),
    lit("light_in_plane", &[IN_PLANE]),
    lit("light_one_ulp_off", &[LightKind::UlpOff]),
    lit("light_far", &[LightKind::FAR]),
    Recipe { shapes: SOLID, ..lit("light_inside", &[LightKind::Inside]) },
    Recipe { points: SURFACE, ..lit("points_on_surface", FINITE) },
    Recipe { points: SHADOW, ..lit("shadow_boundary", ANY_LIGHT) },
    Recipe { shapes: &[Shape::Sliver], ..lit("slivers", ANY_LIGHT) },
    scaled("tiny", &[Scale::Tiny]),
    scaled("huge", &[Scale::Huge]),
    Recipe { shapes: &Shape::ALL, ..scaled("mixed_scales", &[Scale::Mixed, Scale::Away]) },
    Recipe {
        shapes: EXACT,
        lights: &[ON_VERTEX, ON_EDGE[0], IN_PLANE, LightKind::Corner, LightKind::Axis, LightKind::InPlane],
        points: &[PointKind::VERTEX_OR_EDGE, PointKind::FACE_PLANE, PointKind::Corner, HIDDEN],
        ..lit("cad_ties", ANY_LIGHT)
    },
    lit("directional", DIRECTIONS),
    Recipe { damaged: true, ..lit("damaged", ANY_LIGHT) },
    Recipe { shapes: &Shape::ALL, damaged: true, scales: &Scale::ALL, ..lit("everything", ANY_LIGHT) },
];
