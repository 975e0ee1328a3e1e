//! Lights inside closed shells; cavities, and shells within shells.

use umbrage::Reason;
use umbrage::caster::ShellProof;
use umbrage::facing::CasterFaces;
use umbrage::mesh::Mesh;
use umbrage::shadow::volume::ShellFaces;
use umbrage::testing::shapes;
use umbrage::topology::Topology;

use super::figures::*;

/// The casting faces chosen for each shell.
fn plan(mesh: &Mesh, light: &umbrage::geom::Light) -> ShellFaces {
    let topology: Topology = topology(mesh);
    let shells = topology.shells();
    let proofs = ShellProof::of(mesh, &topology, &shells);
    ShellFaces::choose(mesh, &shells, &proofs, light, None)
}

fn variants(plan: &ShellFaces) -> Vec<CasterFaces> {
    plan.choices.iter().map(|choice| choice.what).collect()
}

/// Guards against casting front faces alone. A light inside sees none of them, so the world outside would be
/// lit.
#[test]
fn hard_02_light_inside_a_closed_shell_shadows_all_outside() {
    let light = point(0.1, 0.2, 0.3);
    for (mesh, faces) in
        [(shapes::cube(), 12), (shapes::icosphere(2), 320), (shapes::inside_out(&shapes::cube()), 12)]
    {
        let inverted = mesh.name.contains("inside out");
        let sides = if inverted { [faces, 0, 0] } else { [0, faces, 0] };
        // No silhouette at all: the volume consists of the two caps.
        expect_figures(&[(&mesh, light, (sides, 0, 0))]);
        expect_crossings(
            &mesh,
            &light,
            &[([0.0; 3], 0), ([-0.3, 0.2, 0.5], 0), ([3.0, 1.0, 2.0], 1), ([-900.0, 70.0, 1e6], 1)],
        );
        expect_agreement(&mesh, &light);
        let choice = plan(&mesh, &light).choices[0];
        assert_eq!(choice.what, CasterFaces::All);
        assert_eq!(choice.why, Reason::LightInside { winding: if inverted { -1 } else { 1 } });
        assert_eq!(choice.to_string(), "the light is inside the shell");
    }
    // Negative test: front faces alone.
    let (_, nothing) = cast(&shapes::cube(), &light, CasterFaces::Front);
    assert_eq!((nothing.triangles().len(), nothing.boundary_sum().is_closed()), (0, true));
}

/// Guards against equating "inside" with "sees back faces only": in a bent tube the light sees some faces of
/// either kind.
#[test]
fn hard_02_light_inside_a_ring_leaves_through_three_walls() {
    let ring = shapes::torus(24, 12, 2.0, 0.5);
    let light = point(2.0, 0.01, 0.02);
    expect_crossings(
        &ring,
        &light,
        &[
            ([1.9, 0.1, 0.0], 0),
            ([0.3, 0.1, 0.05], 1),
            ([-2.0, 0.1, 0.05], 2),
            ([-4.0, 0.1, 0.05], 3),
            ([4.0, 0.1, 0.0], 1),
        ],
    );
    expect_agreement(&ring, &light);
    assert_eq!(variants(&plan(&ring, &light)), [CasterFaces::All]);
    // From behind the far tube, front faces alone count two of the three, and none of the one before.
    assert_eq!(winding(&ring, &light, CasterFaces::Front, [-4.0, 0.1, 0.05]), Some(1));
    assert_eq!(winding(&ring, &light, CasterFaces::Front, [0.3, 0.1, 0.05]), Some(0));
}

/// Guards against treating a cavity alone (it would be inside out), and against one choice for the entire
/// mesh.
#[test]
fn hard_22_cavity_is_sound_and_each_shell_has_its_own_plan() {
    let hollow = shapes::hollow_cube();
    let found = report(&hollow);
    assert!(found.counts.sound());
    assert_eq!(
        (found.counts.shells, found.counts.inside_out_shells, found.counts.signed_volume),
        (2, 0, 56.0)
    );
    let shells: Vec<_> =
        found.shell_list.iter().map(|shell| (shell.depth, shell.parent, shell.signed_volume)).collect();
    assert_eq!(shells, [(0, None, 64.0), (1, Some(0), -8.0)]);

    let (outside, between, within) = (point(0.3, 0.2, 9.0), point(0.3, 0.2, 1.5), point(0.3, 0.2, 0.5));
    // Points in the cavity, in the solid below the cavity, and below everything.
    let points = [[0.1, 0.25, -0.5], [0.1, 0.25, -1.5], [0.1, 0.25, -3.0]];
    for (light, expected, chosen) in [
        (outside, [2, 3, 4], [CasterFaces::Front, CasterFaces::Back]),
        (between, [1, 2, 3], [CasterFaces::All, CasterFaces::Back]),
        (within, [0, 1, 2], [CasterFaces::All, CasterFaces::All]),
    ] {
        let rows: Vec<_> = points.into_iter().zip(expected).collect();
        expect_crossings(&hollow, &light, &rows);
        expect_agreement(&hollow, &light);
        assert_eq!(variants(&plan(&hollow, &light)), chosen, "{light}");
    }
    // Negative test: without its winding reversed, the inner shell is inside out.
    let solid_core = Mesh::concat(&[shapes::cuboid([-2.0; 3], [2.0; 3]), shapes::cube()]).unwrap();
    assert_eq!(counts(&solid_core).inside_out_shells, 1);
    assert!(!counts(&solid_core).sound());
}

/// Guards against nesting that is only one level deep.
#[test]
fn hard_22_nested_shells_alternate_between_solid_and_cavity() {
    // Cubes of half sides 6 … 1, every second one reversed: solid, cavity, solid, …
    let cubes: Vec<Mesh> = (1..=6)
        .rev()
        .map(|k| {
            let cube = shapes::cuboid([-(k as f32); 3], [k as f32; 3]);
            if k % 2 == 0 { cube } else { shapes::inside_out(&cube) }
        })
        .collect();
    let onion = Mesh::concat(&cubes).unwrap();
    let found = report(&onion);
    assert!(found.counts.sound());
    assert_eq!(found.shell_list.iter().map(|shell| shell.depth).collect::<Vec<_>>(), [0, 1, 2, 3, 4, 5]);
    // 12³ − 10³ + 8³ − 6³ + 4³ − 2³.
    assert_eq!(found.counts.signed_volume, 1728.0 - 1000.0 + 512.0 - 216.0 + 64.0 - 8.0);
    let light = sun(0.0, 0.0, -1.0);
    let rows: Vec<_> = (0..7_u32).map(|k| ([0.3, 0.2, 6.5 - k as f32], k)).collect();
    expect_crossings(&onion, &light, &rows);
    expect_agreement(&onion, &point(3.1, 2.2, 4.3));
    let (front, back) = (CasterFaces::Front, CasterFaces::Back);
    assert_eq!(variants(&plan(&onion, &light)), [front, back, front, back, front, back]);
    // Negative test: with equal windings, every second cube contradicts its depth.
    assert_eq!(counts(&shapes::nested_cubes(6)).inside_out_shells, 3);
}

/// Guards against relying on edges alone: the prism is watertight with a positive volume, but one lobe has
/// winding −1.
#[test]
fn hard_21_winding_of_a_lobe_is_negative_and_front_faces_are_refused() {
    let mesh = shapes::figure_eight_prism();
    let c = counts(&mesh);
    assert_eq!((c.watertight, c.inside_out_shells, c.signed_volume), (true, 0, 6.0));
    let mut found = report(&mesh);
    found.add_self_intersections(&mesh, &topology(&mesh), 1);
    assert!(found.counts.self_intersections > Some(0));

    let light = sun(0.0, 0.0, -1.0);
    // Each cap consists of two overlapping triangles, one of each winding; their common edge counts twice.
    expect_figures(&[(&mesh, light, ([2, 2, 8], 10, 12))]);
    // Points in the lobes, behind the lobes, where the triangles overlap outside both lobes, and beside the
    // prism.
    let rows = [
        ([1.5, 0.1, 0.0], 1, 1),
        ([1.5, 0.1, -3.0], 2, 1),
        ([-0.8, 0.1, 0.0], 1, 0),
        ([-0.8, 0.1, -3.0], 2, 1),
        ([0.5, -1.0, 0.0], 2, 1),
        ([0.5, -1.0, -3.0], 4, 2),
        ([0.0, 1.9, -3.0], 0, 0),
    ];
    expect_crossings(&mesh, &light, &rows.map(|(p, all, _)| (p, all)));
    expect_agreement(&mesh, &light);
    let choice = plan(&mesh, &light).choices[0];
    assert_eq!((choice.what, choice.why), (CasterFaces::All, Reason::MeetsItself));
    assert_eq!(choice.to_string(), "the shell meets itself");
    // Negative test: front faces alone light the inside of the negative lobe.
    for (p, _, front) in rows {
        assert_eq!(winding(&mesh, &light, CasterFaces::Front, p), Some(front), "{p:?}");
    }
}

/// Guards against refusing to halve where parts merely overlap: each part is sound, and their counts add up.
#[test]
fn hard_21_winding_of_parts_that_interpenetrate_adds_up() {
    let both =
        Mesh::concat(&[shapes::cube(), shapes::translated(&shapes::cube(), [1.0, 0.25, 0.5])]).unwrap();
    let mut found = report(&both);
    found.add_self_intersections(&both, &topology(&both), 1);
    assert!(found.counts.sound() && found.counts.self_intersections > Some(0));
    let light = point(0.4, 0.1, 50.0);
    // Points in one part, in both, behind one, behind both.
    let rows = [
        ([-0.5, 0.1, 0.1], 1, 1),
        ([0.5, 0.2, 0.1], 2, 2),
        ([-0.5, 0.1, -2.0], 2, 1),
        ([0.5, 0.2, -2.0], 4, 2),
    ];
    expect_crossings(&both, &light, &rows.map(|(p, all, _)| (p, all)));
    expect_agreement(&both, &light);
    assert_eq!(variants(&plan(&both, &light)), [CasterFaces::Front; 2]);
    for (p, all, front) in rows {
        assert_eq!(winding(&both, &light, CasterFaces::Front, p), Some(front), "{p:?}");
        assert!(all > 0 && front > 0, "in or out is the same");
    }
}
