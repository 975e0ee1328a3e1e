//! The strata: which meshes, lights and points meet in a round.

use super::lights::Place;
use super::meshes::Shape;
use super::points::Aim;
use super::scales::Scale;

/// What a stratum draws from, each list evenly.
pub(super) struct Recipe {
    pub(super) name: &'static str,
    pub(super) shapes: &'static [Shape],
    /// Whether faces are dropped, turned, doubled and collapsed.
    pub(super) damaged: bool,
    pub(super) scales: &'static [Scale],
    pub(super) places: &'static [Place],
    pub(super) aims: &'static [Aim],
}

const ANY_SHAPE: &[Shape] = &[
    Shape::Soup,
    Shape::Grid,
    Shape::Voxels,
    Shape::Ball,
    Shape::Tetrahedra,
    Shape::Boxes,
    Shape::Classic,
    Shape::Sliver,
];
/// Those with exact ties in all their planes.
const EXACT: &[Shape] = &[Shape::Grid, Shape::Voxels, Shape::Boxes, Shape::Classic];
const SOLID: &[Shape] = &[Shape::Voxels, Shape::Ball, Shape::Tetrahedra, Shape::Boxes];
const FINITE: &[Place] =
    &[Place::Outside, Place::Vertex, Place::Edge, Place::Plane, Place::UlpOff, Place::Inside, Place::Corner];
const ANY_PLACE: &[Place] = &[
    Place::Outside,
    Place::Vertex,
    Place::Edge,
    Place::Plane,
    Place::UlpOff,
    Place::Far,
    Place::Inside,
    Place::Corner,
    Place::Direction,
    Place::Axis,
    Place::InPlane,
];
const DIRECTIONS: &[Place] = &[Place::Direction, Place::Axis, Place::InPlane];
const ANY_AIM: &[Aim] =
    &[Aim::Box, Aim::Face, Aim::Boundary, Aim::Plane, Aim::Vertex, Aim::Corner, Aim::Behind, Aim::Light];
/// Three in four on the surface.
const SURFACE: &[Aim] = &[Aim::Surface, Aim::Surface, Aim::Surface, Aim::Plane];
const SHADOW: &[Aim] = &[Aim::Boundary, Aim::Behind];

const GENERIC: Recipe = Recipe {
    name: "generic",
    shapes: ANY_SHAPE,
    damaged: false,
    scales: &[Scale::One],
    places: &[Place::Outside, Place::Direction],
    aims: &[Aim::Box],
};

const fn lit(name: &'static str, places: &'static [Place]) -> Recipe {
    Recipe { name, places, aims: ANY_AIM, ..GENERIC }
}

const fn scaled(name: &'static str, scales: &'static [Scale]) -> Recipe {
    Recipe { name, scales, places: ANY_PLACE, aims: ANY_AIM, ..GENERIC }
}

/// All strata, in the order of the rows. Where nothing else is said: meshes of any kind without damage, near 1, and points
/// of every kind that [`ANY_AIM`] holds.
///
/// - `generic`: a light in a box five times as large as the mesh or far along any direction, points in a box twice as
///   large: nothing is aimed at.
/// - `light_on_vertex`: exactly. `light_on_edge`: on an edge or its line, rounded. `light_in_plane`: of a face, inside
///   or outside it, rounded.
/// - `light_one_ulp_off`: off one of these three by one ulp in one, two or three coordinates.
/// - `light_far`: a point light 2³⁰ to 2⁴⁰ diagonals away.
/// - `light_inside`: between vertices of a solid, and so mostly inside it.
/// - `points_on_surface`: three in four points on vertices, edges and faces but for rounding, the others in planes of
///   faces, under point lights.
/// - `shadow_boundary`: points on the sides of the volume, or behind vertices and silhouette edges.
/// - `slivers`: triangles and tetrahedra whose height is 1e-7 and less of their length.
/// - `tiny`: times 1e-30 and less, down to where numbers have few bits. `huge`: times 1e30 and more, up to the end of
///   `f32`.
/// - `mixed_scales`: axes, halves or vertices of one mesh times different factors from 1e-30 to 1e30; or moved away by
///   up to 2²⁰ times its size.
/// - `cad_ties`: meshes with exact coincidences, lights and points on their vertices, edges and planes.
/// - `directional`: any direction, along axes, along edges and in planes of faces.
/// - `damaged`: one to four faces dropped, turned, doubled, collapsed, or seams opened by an ulp or two.
/// - `everything`: all of these, damaged, and vertices of any bits.
pub(super) const RECIPES: [Recipe; 17] = [
    GENERIC,
    lit("light_on_vertex", &[Place::Vertex]),
    lit("light_on_edge", &[Place::Edge]),
    lit("light_in_plane", &[Place::Plane]),
    lit("light_one_ulp_off", &[Place::UlpOff]),
    lit("light_far", &[Place::Far]),
    Recipe { shapes: SOLID, ..lit("light_inside", &[Place::Inside]) },
    Recipe { places: FINITE, aims: SURFACE, ..lit("points_on_surface", FINITE) },
    Recipe { places: ANY_PLACE, aims: SHADOW, ..lit("shadow_boundary", ANY_PLACE) },
    Recipe { shapes: &[Shape::Sliver], ..lit("slivers", ANY_PLACE) },
    scaled("tiny", &[Scale::Tiny]),
    scaled("huge", &[Scale::Huge]),
    Recipe {
        shapes: &[Shape::Bits, Shape::Soup, Shape::Boxes, Shape::Ball, Shape::Tetrahedra, Shape::Voxels],
        ..scaled("mixed_scales", &[Scale::Mixed, Scale::Away])
    },
    Recipe {
        shapes: EXACT,
        places: &[Place::Vertex, Place::Edge, Place::Plane, Place::Corner, Place::Axis, Place::InPlane],
        aims: &[Aim::Vertex, Aim::Plane, Aim::Corner, Aim::Behind],
        ..lit("cad_ties", ANY_PLACE)
    },
    lit("directional", DIRECTIONS),
    Recipe { damaged: true, ..lit("damaged", ANY_PLACE) },
    Recipe {
        shapes: &[
            Shape::Soup,
            Shape::Grid,
            Shape::Voxels,
            Shape::Ball,
            Shape::Tetrahedra,
            Shape::Boxes,
            Shape::Classic,
            Shape::Sliver,
            Shape::Bits,
        ],
        damaged: true,
        scales: &[Scale::One, Scale::Tiny, Scale::Huge, Scale::Mixed, Scale::Away],
        ..lit("everything", ANY_PLACE)
    },
];
