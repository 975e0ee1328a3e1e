//! All steps in their order.

use super::change::Step;
use super::fill::Fill;
use super::{drop_collapsed, drop_duplicates, drop_unreferenced, fill, orient, split, stitch, weld};
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
    let mut prepared = Prepared { mesh, steps: Vec::new() };
    if options.weld != Weld::None {
        prepared.take(|mesh| Ok(weld(mesh, options.weld)))?;
    }
    prepared.clean()?;
    if options.orient {
        prepared.take(orient)?;
    }
    let mut changed = 0;
    if let Some(distance) = options.weld_within {
        changed += prepared.take(|mesh| Ok(weld(mesh, Weld::Within(distance))))?;
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
        let (mesh, step) = step(std::mem::take(&mut self.mesh))?;
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
}
