//! Reports of searches that gave up, and how far the searches get.

use super::{CrackReport, ShellReport};
use crate::mesh::Mesh;
use crate::testing::shapes;
use crate::topology::Topology;

fn topology(mesh: &Mesh) -> Topology {
    Topology::of(mesh)
}

/// Cubes in cubes, outermost first, every second one a cavity, but for those in `turned`.
fn onion(count: usize, turned: &[usize]) -> Mesh {
    let mesh = shapes::nested_cubes(count as u32);
    let per_cube = mesh.face_count() / count;
    let wound = |(face, &[a, b, c]): (usize, &[u32; 3])| {
        let cube = face / per_cube;
        if cube % 2 == usize::from(turned.contains(&cube)) { [a, b, c] } else { [a, c, b] }
    };
    let triangles = mesh.triangles().iter().enumerate().map(wound).collect();
    Mesh::new(mesh.positions().to_vec(), triangles).unwrap()
}

#[test]
fn crack_thousands_of_cavities_in_solids_are_sound() {
    for count in [1600, 2000] {
        let mesh = onion(count, &[]);
        let report = CrackReport::of(&mesh, &topology(&mesh));
        assert!(report.nesting_complete && report.counts.sound(), "{count}");
        for (depth, shell) in report.shell_list.iter().enumerate() {
            assert_eq!((shell.depth, shell.parent), (depth, depth.checked_sub(1)));
        }
    }
}

#[test]
fn crack_a_wrong_shell_at_depth_1501_is_found() {
    for turned in [vec![1501], (1501..1600).step_by(2).collect()] {
        let mesh = onion(1600, &turned);
        let report = CrackReport::of(&mesh, &topology(&mesh));
        let wrong = |shell: &(usize, &ShellReport)| shell.1.inside_out;
        let found: Vec<usize> = report.shell_list.iter().enumerate().filter(wrong).map(|s| s.0).collect();
        assert_eq!(found, turned);
        assert!(report.nesting_complete && !report.counts.sound());
    }
}

#[test]
fn crack_nesting_that_gave_up_condemns_and_acquits_no_shell() {
    for mesh in [onion(20, &[]), onion(20, &[19])] {
        let topology = topology(&mesh);
        let whole = CrackReport::of(&mesh, &topology);
        let mut known = Vec::new();
        for tests in 0..3000 {
            let report = CrackReport::within(&mesh, &topology, tests, 0);
            let undecided = report.shell_list.iter().filter(|shell| shell.undecided()).count();
            assert_eq!(
                (report.counts.undecided_shells, report.nesting_complete),
                (undecided, undecided == 0)
            );
            assert_eq!(report.counts.sound(), undecided == 0 && whole.counts.sound());
            for (shell, expected) in report.shell_list.iter().zip(&whole.shell_list) {
                if shell.depth_known {
                    assert_eq!(shell, expected);
                } else {
                    assert!(!shell.inside_out && shell.depth == 0 && shell.parent.is_none());
                }
            }
            known.push(20 - undecided);
        }
        // It gives up at every stage, and comes to its end.
        assert!(known.is_sorted() && (0..=20).all(|n| n == 18 || n == 19 || known.contains(&n)), "{known:?}");
    }
}

#[test]
fn crack_t_junctions_that_were_not_all_looked_for_are_said_to_be() {
    let mesh = shapes::t_junction();
    let topology = topology(&mesh);
    let whole = CrackReport::of(&mesh, &topology);
    assert!(whole.t_junctions_complete && whole.counts.t_junctions > 0);
    let report = CrackReport::within(&mesh, &topology, 1000, 1);
    assert!(!report.t_junctions_complete && report.nesting_complete);
    assert!(report.counts.t_junctions < whole.counts.t_junctions);
}
