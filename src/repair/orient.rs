//! The step that winds faces alike, and outwards.

use super::change::{ChangeKind, Step};
use super::parity::Parity;
use super::split::split;
use crate::check::CrackReport;
use crate::mesh::{FaceId, Mesh, MeshError};
use crate::topology::{Topology, has_collapsed};

/// Turns faces so that neighbors agree, and closed shells so that they face outwards, or inwards where they
/// are cavities.
///
/// Faces agree across every edge of two faces. Of the two ways, a surface takes the one that turns fewer
/// faces. A closed shell is then turned if the exact sign of its volume is wrong for its nesting depth; where
/// shells share edges, each is judged for itself. An open shell keeps the way that turns fewer faces.
///
/// Guarantee: only windings change. A surface that has no orientation (a Möbius strip) is left as it is, and
/// the step says so ([`ChangeKind::ShellLeft`]); all others are still done.
///
/// ```
/// use umbrage::{repair, testing::shapes, topology::Topology};
/// let (mesh, step) = repair::orient(shapes::misoriented_cube())?;
/// assert!(step.count == 1 && Topology::of(&mesh).edge_counts().watertight());
/// assert_eq!(repair::orient(shapes::mobius(9))?.1.left, 1);
/// # Ok::<(), umbrage::mesh::MeshError>(())
/// ```
///
/// # Errors
///
/// [`MeshError::TooLarge`] if shells that share edges have more vertices together than 32-bit ids.
pub fn orient(mesh: Mesh) -> Result<(Mesh, Step), MeshError> {
    let mut step = Step::new("orient");
    let topology = Topology::of(&mesh);
    let mut turned = vec![false; mesh.face_count()];
    let twisted = agree(&topology, &mut turned);
    let agreed = with_turned(mesh.clone(), &turned);
    let mut inside_out = inside_out(&agreed, &topology)?;
    if topology.edge_counts().non_manifold > 0 && inside_out.contains(&None) {
        // Shells that touch along an edge may come apart only if what is inside is solid.
        let other = with_turned(agreed, &vec![true; mesh.face_count()]);
        for (here, there) in inside_out.iter_mut().zip(self::inside_out(&other, &topology)?) {
            *here = here.or(there.map(|inside_out| !inside_out));
        }
    }
    for (turned, inside_out) in turned.iter_mut().zip(inside_out) {
        *turned ^= inside_out == Some(true);
    }
    for (face, _) in (0..).zip(&turned).filter(|(_, turned)| **turned) {
        let at = mesh.corners(FaceId(face))[0];
        step.add(ChangeKind::FaceTurned, Some(face), Some(face), at);
    }
    for face in twisted {
        step.add(ChangeKind::ShellLeft, Some(face), Some(face), mesh.corners(FaceId(face))[0]);
    }
    Ok((with_turned(mesh, &turned), step))
}

/// Marks the faces to turn so that neighbors agree. The first face of each surface that has no orientation,
/// of which none is marked.
fn agree(topology: &Topology, turned: &mut [bool]) -> Vec<u32> {
    let mut sides = Parity::new(topology.face_count());
    let mut conflicts = Vec::new();
    for edge in topology.edges() {
        let mut uses = topology.uses(edge);
        if let (2, Some((f, along)), Some((g, other))) = (uses.len(), uses.next(), uses.next())
            && !sides.join(f.0, g.0, along == other)
        {
            conflicts.push(f.0);
        }
    }
    // For each surface, by its first face: its faces, and those of them on the other side than the first.
    let faces = topology.face_count() as u32;
    let (mut count, mut other) = (vec![0_u32; faces as usize], vec![0_u32; faces as usize]);
    for face in 0..faces {
        let (leader, differs) = sides.find(face);
        count[leader as usize] += 1;
        other[leader as usize] += u32::from(differs);
    }
    let mut twisted: Vec<u32> = conflicts.into_iter().map(|face| sides.find(face).0).collect();
    twisted.sort_unstable();
    twisted.dedup();
    for face in 0..faces {
        let (leader, differs) = sides.find(face);
        let fewer = 2 * other[leader as usize] <= count[leader as usize];
        turned[face as usize] = differs == fewer && twisted.binary_search(&leader).is_err();
        turned[face as usize] &= !has_collapsed(topology.triangles()[face as usize]);
    }
    twisted
}

/// For each face, whether its shell is inside out, or `None` if the shell is not closed. Shells that share
/// edges are taken apart to judge them; their faces keep their numbers. `topology` is that of the mesh, but
/// for windings.
fn inside_out(mesh: &Mesh, topology: &Topology) -> Result<Vec<Option<bool>>, MeshError> {
    let apart = match topology.edge_counts().non_manifold {
        0 => mesh.clone(),
        _ => split(mesh.clone())?.0,
    };
    let topology = Topology::of(&apart);
    let report = CrackReport::of(&apart, &topology);
    let of_shell = |shell: u32| {
        let shell = &report.shell_list[shell as usize];
        shell.watertight.then_some(shell.inside_out)
    };
    Ok(topology.shells().of_face.into_iter().map(|shell| shell.and_then(of_shell)).collect())
}

fn with_turned(mesh: Mesh, turned: &[bool]) -> Mesh {
    if !turned.contains(&true) {
        return mesh;
    }
    let (name, origins, skin) = (mesh.name.clone(), mesh.origins().cloned(), mesh.skin().cloned());
    let (positions, mut triangles, parts, frames) = mesh.into_parts();
    for (corners, _) in triangles.iter_mut().zip(turned).filter(|(_, turned)| **turned) {
        corners.swap(1, 2);
    }
    let mesh = Mesh::new(positions, triangles).expect("the same corners in another order");
    let mesh = mesh.with_name(name).with_parts(parts).with_origins_of(origins).with_skin(skin);
    mesh.with_frames(frames).expect("the frames are those that it had")
}

#[cfg(test)]
mod tests {
    use super::super::test_support::{bits, without};
    use super::*;
    use crate::random::SplitMix64;
    use crate::testing::shapes;

    /// The mesh with faces turned at random.
    fn tousled(mesh: &Mesh, seed: u64) -> Mesh {
        let mut random = SplitMix64(seed);
        let turned: Vec<bool> = (0..mesh.face_count()).map(|_| random.below(3) == 0).collect();
        with_turned(mesh.clone(), &turned)
    }

    fn count_inside_out(mesh: &Mesh) -> usize {
        CrackReport::of(mesh, &Topology::of(mesh)).counts.inside_out_shells
    }

    #[test]
    fn oriented_closed_shells_are_as_they_were_made() {
        for (seed, shape) in (0..).zip([
            shapes::cube(),
            shapes::torus(7, 5, 2.0, 0.5),
            shapes::hollow_cube(),
            shapes::cubes_sharing_edge(),
            shapes::cubes_sharing_vertex(),
            shapes::menger_sponge(1),
        ]) {
            for spoiled in [tousled(&shape, seed), shapes::inside_out(&shape)] {
                let (mesh, step) = orient(spoiled.clone()).unwrap();
                // The corners of a face that was turned twice start elsewhere, but it is the same face.
                let canonical = |mesh: &Mesh| -> Vec<[u32; 3]> {
                    let least = |mut t: [u32; 3]| {
                        let first = (0..3).min_by_key(|&i| t[i]).unwrap();
                        t.rotate_left(first);
                        t
                    };
                    mesh.triangles().iter().map(|&t| least(t)).collect()
                };
                assert_eq!(canonical(&mesh), canonical(&shape), "{}", shape.name);
                assert_eq!(bits(&mesh), bits(&spoiled));
                let differ =
                    canonical(&spoiled).iter().zip(canonical(&shape)).filter(|(a, b)| *a != b).count();
                assert_eq!((step.count, step.left), (differ, 0), "{}", shape.name);
                assert_eq!(count_inside_out(&mesh), 0);
                // Fault injected: one face.
                assert_ne!(canonical(&tousled(&mesh, 5)), canonical(&shape));
            }
        }
    }

    #[test]
    fn oriented_shells_alternate_where_they_nest() {
        let (mesh, step) = orient(shapes::nested_cubes(4)).unwrap();
        let report = CrackReport::of(&mesh, &Topology::of(&mesh));
        assert!(report.counts.sound() && step.count == 24);
        assert!(report.shell_list.iter().all(|shell| (shell.signed_volume > 0.0) == (shell.depth % 2 == 0)));
        // Fault injected: all of them as they were.
        assert_eq!(count_inside_out(&shapes::nested_cubes(4)), 2);
    }

    #[test]
    fn orient_leaves_a_mobius_strip_and_does_all_others() {
        let moved = |mesh: &Mesh, x: f32| shapes::translated(mesh, [x, 0.0, 0.0]);
        let open = without(&shapes::inside_out(&shapes::cube()), 4);
        let parts = [
            moved(&shapes::mobius(9), 0.0),
            moved(&tousled(&open, 3), 10.0),
            moved(&shapes::inside_out(&shapes::octahedron()), 20.0),
        ];
        let (mesh, step) = orient(Mesh::concat(&parts).unwrap()).unwrap();
        assert_eq!((step.left, count_inside_out(&mesh)), (1, 0));
        assert_eq!(mesh.triangles()[..18], parts[0].triangles()[..]);
        let left = step.changes.iter().find(|change| change.kind == ChangeKind::ShellLeft).unwrap();
        assert_eq!(left.old, Some(0));
        // The open cube agrees with itself: what is misoriented is the strip's one edge.
        assert_eq!(Topology::of(&mesh).edge_counts().misoriented, 1);
        assert!(Topology::of(&parts[1]).edge_counts().misoriented > 0);
    }
}
