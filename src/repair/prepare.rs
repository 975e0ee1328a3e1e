//! All steps in their order.

use super::change::Step;
use super::fill::Fill;
use super::index_map::IndexMap;
use super::weld::weld_with;
use super::{drop_collapsed, drop_duplicates, drop_unreferenced, fill, orient, split, stitch};
use crate::mesh::{Mesh, MeshError, Weld};

/// Which steps are taken beside the first ones, which invent nothing and move nothing.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Options {
    /// Which vertices are the same to begin with.
    pub weld: Weld,
    /// Winds faces alike, and outwards: [`orient`](fn@orient).
    pub orient: bool,
    /// Makes vertices one that are at most this far apart.
    pub weld_within: Option<f32>,
    /// Cuts faces where vertices lie on their edges: [`stitch`](fn@stitch).
    pub stitch: bool,
    /// Takes fans apart: [`split`](fn@split).
    pub split: bool,
    /// Closes holes: [`fill`](fn@fill).
    pub fill: Option<Fill>,
    /// Keeps [`Prepared::map`]: 8 bytes per vertex and face, and as much again while a step is taken.
    pub map: bool,
}

/// A mesh, and what was done to it.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Prepared {
    /// The mesh after the last step.
    pub mesh: Mesh,
    /// The steps, in the order in which they were taken. The indices of each are those of the mesh that the
    /// step before it left.
    pub steps: Vec<Step>,
    /// Where the vertices, and the faces, of the input are in [`Prepared::mesh`]; `None` unless
    /// [`Options::map`] asks for it.
    pub map: Option<(IndexMap, IndexMap)>,
}

/// Takes the steps that `options` ask for, in a fixed order: equal vertices become one; collapsed faces,
/// duplicates and unused vertices go; faces are oriented; vertices within a distance become one; T-junctions
/// are stitched; fans are taken apart; holes are closed. Where a step after the orientation changed
/// something, faces are oriented again.
///
/// ```
/// use umbrage::repair::{Fill, Options, prepare};
/// use umbrage::testing::shapes;
/// use umbrage::topology::Topology;
/// let mut options = Options::default();
/// options.fill = Some(Fill::default());
/// let prepared = prepare(shapes::soup(&shapes::open_cube()), &options)?;
/// assert!(Topology::of(&prepared.mesh).edge_counts().watertight());
/// # Ok::<(), umbrage::mesh::MeshError>(())
/// ```
///
/// # Errors
///
/// [`MeshError::TooLarge`] if there come to be more faces or vertices than a mesh can have.
pub fn prepare(mesh: Mesh, options: &Options) -> Result<Prepared, MeshError> {
    let map =
        options.map.then(|| (IndexMap::identity(mesh.vertex_count()), IndexMap::identity(mesh.face_count())));
    let mut prepared = Prepared { mesh, steps: Vec::new(), map };
    if options.weld != Weld::None {
        prepared.take(|mesh| Ok(weld_with(mesh, options.weld, options.map)))?;
    }
    prepared.clean()?;
    if options.orient {
        prepared.take(orient)?;
    }
    let mut changed = 0;
    if let Some(distance) = options.weld_within {
        changed += prepared.take(|mesh| Ok(weld_with(mesh, Weld::Within(distance), options.map)))?;
        if changed > 0 {
            prepared.clean()?;
        }
    }
    if options.stitch {
        changed += prepared.take(stitch)?;
    }
    if options.orient && changed > 0 {
        prepared.take(orient)?;
    }
    if options.split {
        prepared.take(split)?;
    }
    if let Some(which) = options.fill {
        let closed = prepared.take(|mesh| fill(mesh, which))?;
        // Now that it is closed, a shell has an outside.
        if options.orient && closed > 0 {
            prepared.take(orient)?;
        }
    }
    Ok(prepared)
}

impl Prepared {
    /// Takes a step; the number of its changes.
    fn take(
        &mut self,
        step: impl FnOnce(Mesh) -> Result<(Mesh, Step), MeshError>,
    ) -> Result<usize, MeshError> {
        let (mesh, mut step) = step(std::mem::take(&mut self.mesh))?;
        // Of the whole, not of each step: they would take too much memory together.
        let taken = [step.vertices.take(), step.faces.take()];
        if let Some((vertices, faces)) = &mut self.map {
            for (map, next) in [vertices, faces].into_iter().zip(taken) {
                if let Some(next) = next {
                    *map = map.then(&next);
                }
            }
        }
        let count = step.count;
        self.mesh = mesh;
        self.steps.push(step);
        Ok(count)
    }

    /// Drops what adds nothing: collapsed faces, duplicates, unused vertices.
    fn clean(&mut self) -> Result<(), MeshError> {
        self.take(|mesh| Ok(drop_collapsed(mesh)))?;
        self.take(|mesh| Ok(drop_duplicates(mesh)))?;
        self.take(|mesh| Ok(drop_unreferenced(mesh)))?;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::super::test_support::{bits, boundary_chain, corners, without};
    use super::*;
    use crate::check::CrackReport;
    use crate::testing::shapes;
    use crate::topology::Topology;

    #[test]
    fn prepare_by_default_keeps_all_that_casts() {
        for mesh in [
            shapes::soup(&shapes::cube()),
            shapes::uv_capsule(8, 3, 1.0, 1.0),
            shapes::t_junction(),
            shapes::collinear_face(),
            shapes::mobius(8),
            shapes::cubes_sharing_edge(),
            shapes::double_sheet(),
            shapes::book(5),
        ] {
            let prepared = prepare(mesh.clone(), &Options::default()).unwrap();
            assert_eq!(boundary_chain(&prepared.mesh), boundary_chain(&mesh), "{}", mesh.name);
            let known = bits(&mesh);
            assert!(bits(&prepared.mesh).iter().all(|position| known.contains(position)));
            let names: Vec<_> = prepared.steps.iter().map(|step| step.name).collect();
            assert_eq!(names, ["weld", "collapsed", "duplicates", "unreferenced"]);
            assert!(prepared.steps.iter().all(|step| step.largest_move == 0.0));
            // It has nothing more to do.
            let again = prepare(prepared.mesh.clone(), &Options::default()).unwrap();
            assert_eq!(again.steps.iter().map(|step| step.count).sum::<usize>(), 0);
            assert_eq!(corners(&again.mesh), corners(&prepared.mesh));
        }
    }

    #[test]
    fn prepare_with_every_step_makes_a_spoiled_shape_sound() {
        let all = Options {
            orient: true,
            stitch: true,
            split: true,
            weld_within: Some(1e-3),
            fill: Some(Fill::default()),
            ..Options::default()
        };
        for mesh in [
            shapes::soup(&without(&shapes::torus(8, 6, 2.0, 0.5), 7)),
            shapes::inside_out(&shapes::open_cube()),
            shapes::seam(9),
            shapes::t_junction(),
            shapes::cubes_sharing_edge(),
            shapes::misoriented_cube(),
            without(&shapes::hollow_cube(), 20),
        ] {
            let prepared = prepare(mesh.clone(), &all).unwrap();
            let report = CrackReport::of(&prepared.mesh, &Topology::of(&prepared.mesh));
            assert!(report.counts.sound(), "{}: {}", mesh.name, report.counts.reasons());
        }
    }

    /// What is wrong with the map of a mesh that was prepared without filling: old faces whose new ones were
    /// not made of them, by the polygons that go with faces; new ones that nothing leads to; vertices at
    /// other positions; corners that are none of the old face's.
    #[cfg(feature = "verify")]
    fn wrong_in_map(mesh: &Mesh, prepared: &Prepared, (vertices, faces): &(IndexMap, IndexMap)) -> usize {
        use crate::mesh::FaceId;
        let new = &prepared.mesh;
        let step = |name| prepared.steps.iter().find(|step| step.name == name);
        // A duplicate goes where the face went that stands for it: one with the same corners.
        let places = |face: u32| {
            let mut at = mesh.corners(FaceId(face)).map(|corner| corner.map(f32::to_bits));
            at.sort_unstable();
            at
        };
        let (mut wrong, mut led_to) = (0, [vec![false; new.vertex_count()], vec![false; new.face_count()]]);
        for (old, to) in (0..).zip(vertices.iter()) {
            for &vertex in to {
                let at = |mesh: &Mesh, vertex: u32| mesh.positions()[vertex as usize].map(f32::to_bits);
                wrong += usize::from(at(new, vertex) != at(mesh, old));
                led_to[0][vertex as usize] = true;
            }
        }
        for (old, to) in (0..).zip(faces.iter()) {
            let corners: Vec<u32> = mesh.triangles()[old as usize]
                .iter()
                .flat_map(|&vertex| vertices.of(vertex).iter().copied())
                .collect();
            for &face in to {
                let from = new.origin(FaceId(face)).polygon;
                let is_own =
                    from == old || (step("duplicates").unwrap().count > 0 && places(from) == places(old));
                // A stitched face also has the vertex that it was cut at.
                let has_own = step("stitch").is_some()
                    || new.triangles()[face as usize].iter().all(|corner| corners.contains(corner));
                wrong += usize::from(!is_own) + usize::from(!has_own);
                led_to[1][face as usize] = true;
            }
        }
        wrong + led_to.iter().flatten().filter(|&&led_to| !led_to).count()
    }

    #[cfg(feature = "verify")]
    #[test]
    fn prepare_maps_old_vertices_and_faces_to_new_ones() {
        let steps = Options { orient: true, split: true, map: true, ..Options::default() };
        let (mut dropped, mut split, mut merged, mut cut, mut caught) = (0, 0, 0, 0, 0);
        for seed in 0..400 {
            let mesh = crate::testing::generate::mesh(&mut crate::random::SplitMix64(seed));
            for options in [steps, Options { stitch: true, ..steps }] {
                let prepared = prepare(mesh.clone(), &options).unwrap();
                let map = prepared.map.clone().unwrap();
                assert_eq!((map.0.len(), map.1.len()), (mesh.vertex_count(), mesh.face_count()));
                assert_eq!(wrong_in_map(&mesh, &prepared, &map), 0, "seed {seed}");
                dropped += map.1.iter().filter(|to| to.is_empty()).count();
                split += map.0.iter().filter(|to| to.len() > 1).count();
                cut += map.1.iter().filter(|to| to.len() > 1).count();
                merged += map.0.to_lists().1.len().saturating_sub(prepared.mesh.vertex_count());
                // Fault injected: each has what belongs to the one before it.
                let shifted = |map: &IndexMap| {
                    let mut lists: Vec<Option<u32>> = map.iter().map(|to| to.first().copied()).collect();
                    lists.rotate_right(1);
                    IndexMap::forward(lists.into_iter())
                };
                caught += usize::from(wrong_in_map(&mesh, &prepared, &(map.0, shifted(&map.1))) > 0);
            }
        }
        assert!(dropped > 50 && split > 100 && merged > 100 && cut > 10, "{dropped} {split} {merged} {cut}");
        assert!(caught > 600, "{caught}");
    }

    #[cfg(feature = "verify")]
    #[test]
    fn prepare_keeps_its_guarantees_on_any_mesh() {
        use super::super::ChangeKind;
        let all = Options {
            orient: true,
            stitch: true,
            split: true,
            fill: Some(Fill::default()),
            ..Options::default()
        };
        let (mut filled, mut split) = (0, 0);
        for seed in 0..600 {
            let mesh = crate::testing::generate::mesh(&mut crate::random::SplitMix64(seed));
            let known = bits(&mesh);
            let kept = |mesh: &Mesh| bits(mesh).iter().all(|position| known.contains(position));
            let plain = prepare(mesh.clone(), &Options::default()).unwrap();
            assert!(kept(&plain.mesh), "seed {seed}");
            let changes = || plain.steps.iter().flat_map(|step| &step.changes);
            if !changes().any(|change| change.kind == ChangeKind::DuplicateDropped) {
                assert_eq!(boundary_chain(&plain.mesh), boundary_chain(&mesh), "seed {seed}");
            }
            let gone = plain.steps[1].count + plain.steps[2].count;
            assert_eq!(plain.mesh.face_count() + gone, mesh.face_count(), "seed {seed}");

            let prepared = prepare(plain.mesh.clone(), &all).unwrap();
            assert!(kept(&prepared.mesh), "seed {seed}");
            assert!(prepared.mesh.face_count() >= plain.mesh.face_count(), "seed {seed}");
            let step = |name| prepared.steps.iter().find(|step| step.name == name).unwrap();
            let topology = Topology::of(&prepared.mesh);
            assert_eq!(topology.edge_counts().non_manifold, step("split").left, "seed {seed}");
            // What is still open was left, and said to be.
            let left = step("fill").changes.iter().filter(|change| change.kind == ChangeKind::HoleLeft);
            let open: usize = left.map(|change| change.patch.unwrap().edges).sum();
            assert_eq!(topology.edge_counts().boundary, open, "seed {seed}");
            filled += step("fill").count;
            split += step("split").count;
        }
        assert!(filled > 50 && split > 100, "{filled} {split}");
    }
}
