//! Many faces on one edge; solids that touch in an edge or in a vertex.

use umbrage::facing::{CasterFaces, classify};
use umbrage::mesh::{Mesh, VertexId};
use umbrage::shadow::volume::{Caps, ShadowVolume};
use umbrage::testing::shapes;

use super::figures::*;

/// The pages of a half-open book: all of them face a light at the side.
fn half_open(pages: u32) -> Mesh {
    let (positions, mut triangles, ..) = shapes::book(2 * pages).into_parts();
    triangles.truncate(pages as usize);
    Mesh::new(positions[..pages as usize + 2].to_vec(), triangles).unwrap()
}

fn at_angle(degrees: f64, radius: f64) -> [f32; 3] {
    let (sin, cos) = degrees.to_radians().sin_cos();
    [(radius * cos) as f32, (radius * sin) as f32, 0.5]
}

fn lamp(at: [f32; 3]) -> umbrage::geom::Light {
    umbrage::geom::Light::point(at).unwrap()
}

/// Guards against edge tables with two slots, where the third face overwrites one or is lost.
#[test]
fn hard_03_edge_keeps_three_five_nine_and_eighteen_faces() {
    for (pages, [front, back], spine) in [(3_u32, [1, 2], 1), (5, [3, 2], 1), (9, [4, 5], 1), (18, [9, 9], 0)]
    {
        let (book, n) = (shapes::book(pages), pages as usize);
        let c = counts(&book);
        assert_eq!(
            (c.non_manifold_edges, c.max_faces_per_edge, c.boundary_edges, c.shells),
            (1, n, 2 * n, 1)
        );
        let topology = topology(&book);
        let edge = topology.edge_between(VertexId::new(0), VertexId::new(1)).unwrap();
        assert_eq!(topology.valence(edge), n);
        assert!(topology.half_edges(edge).all(|half_edge| topology.twin(half_edge).is_none()));

        // A page at angle θ is in front of the light at 100.5° if θ is at most 180° behind this angle.
        let light = lamp(at_angle(100.5, 3.0));
        let edges = 2 * n + usize::from(spine > 0);
        expect_figures(&[(&book, light, ([front, back, 0], edges, 2 * n + spine))]);
        // The segment to the opposite side passes just beside the spine, through all pages of one kind.
        expect_crossings(
            &book,
            &light,
            &[(at_angle(100.5 + 179.9, 3.0), back as u32), (at_angle(100.5 - 179.9, 3.0), front as u32)],
        );
        expect_agreement(&book, &light);
    }
}

/// Guards against multiplicities capped at one or two copies of a side.
#[test]
fn hard_03_edge_that_all_faces_leave_one_way_has_a_side_for_each() {
    for pages in [3_u32, 5, 9, 18] {
        let (book, n) = (half_open(pages), pages as usize);
        let light = lamp(at_angle(180.0 - 90.0 / f64::from(pages), 3.0));
        expect_figures(&[(&book, light, ([n, 0, 0], 2 * n + 1, 3 * n))]);
        let (mut silhouette, _) = cast(&book, &light, CasterFaces::All);
        assert_eq!(silhouette.max_multiplicity(), pages);

        // Negative test: copies above two are dropped, and the spine is open by as many.
        for edge in &mut silhouette.edges {
            edge.multiplicity = edge.multiplicity.clamp(-2, 2);
        }
        let signs = CasterFaces::All.signs(&classify(&book, &light));
        let capped = ShadowVolume::extrude(&book, &topology(&book), &light, &signs, &silhouette, Caps::Both);
        assert_eq!(capped.boundary_sum().largest, u64::from(pages) - 2);
        assert!(!capped.boundary_sum().is_closed());
    }
}

/// Guards against pairing the four faces of a shared edge: the correct pairing depends on the light.
#[test]
fn hard_03_edge_of_two_cubes_is_no_outline_where_their_shadows_meet() {
    let cubes = shapes::cubes_sharing_edge();
    let c = counts(&cubes);
    assert_eq!((c.non_manifold_edges, c.max_faces_per_edge, c.boundary_edges, c.shells), (1, 4, 0, 1));
    assert_eq!((c.watertight, c.balanced, c.even, c.signed_volume), (false, true, true, 2.0));
    // For a light along the common edge's own diagonal plane, the edge is inside both hexagons. For a light
    // across this plane, the edge is on both hexagons and cancels.
    let (along, across) = (sun(-3.0, -5.0, -7.0), sun(-3.0, 5.0, -7.0));
    expect_figures(&[(&cubes, along, ([12, 12, 0], 12, 24)), (&cubes, across, ([12, 12, 0], 10, 20))]);
    // Through both cubes; and on either side of the segment through the edge, where one shadow continues as
    // the other.
    expect_crossings(&cubes, &sun(-1.0, -1.0, -0.01), &[([0.4, 0.5, 0.5], 3), ([-1.0, -0.9, 0.5], 4)]);
    expect_crossings(
        &cubes,
        &sun(-1.0, 1.0, -0.01),
        &[([0.8, 1.19, 0.5], 2), ([0.8, 1.21, 0.5], 2), ([0.8, 0.1, 0.5], 1)],
    );
    for light in [along, across, point(1.0, 1.0, 9.0), point(1.0, 1.0, 0.5)] {
        expect_agreement(&cubes, &light);
    }
    // Negative test: the separate cubes have an outline of twelve edges for each light.
    let apart =
        Mesh::concat(&[shapes::cuboid([0.0; 3], [1.0; 3]), shapes::cuboid([1.0, 1.0, 0.0], [2.0, 2.0, 1.0])]);
    expect_figures(&[(&apart.unwrap(), across, ([12, 12, 0], 12, 24))]);
}

/// Guards against connecting shells through a vertex: a fan would continue from one cube into the other.
#[test]
fn hard_03_edge_less_contact_in_a_vertex_keeps_two_shells() {
    let cubes = shapes::cubes_sharing_vertex();
    let contact = |mesh: &Mesh| {
        let c = counts(mesh);
        assert_eq!(c.signed_volume, 2.0);
        ([c.shells, c.closed_shells, c.non_manifold_vertices, c.non_manifold_edges], c.watertight, c.sound())
    };
    let expected = ([2, 2, 1, 0], true, true);
    assert_eq!(contact(&cubes), expected);
    let light = sun(-1.0, -1.0, -1.0);
    // Along the diagonal near the common vertex through both cubes; behind one of them.
    expect_crossings(
        &cubes,
        &light,
        &[([-1.0, -0.9, -1.05], 4), ([1.01, 1.02, 0.99], 2), ([0.5, 1.1, 0.9], 2)],
    );
    expect_figures(&[(&cubes, sun(-3.0, 5.0, -7.0), ([12, 12, 0], 12, 24))]);
    expect_agreement(&cubes, &point(1.0, 1.0, 1.0));
    // Negative tests: the same cubes, each with a vertex of its own at this position, and connected cubes.
    let apart = [shapes::cuboid([0.0; 3], [1.0; 3]), shapes::cuboid([1.0; 3], [2.0; 3])];
    assert_ne!(contact(&Mesh::concat(&apart).unwrap()), expected);
    assert_ne!(contact(&shapes::cubes_sharing_edge()), expected);
}
