//! The strata: which meshes, lights and points meet in a round.

use super::aim::Aim;
use super::place::Place;
use super::scale::Scale;
use super::shape::Shape;

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
const SURFACE: &[Aim] = &[Aim::Vertex, Aim::Plane, Aim::Face];
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

/// All strata, in the order of the rows.
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
