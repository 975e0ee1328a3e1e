//! Meshes in their own spaces, and what rounding to `f32` does to positions.

use glam::{DMat4, DVec3, Mat4};

use super::{Instance, Scene, Scope, split};
use crate::animate::AtRest;
use crate::geom::Aabb;
use crate::mesh::{Mesh, MeshError};

/// A mesh as the file stores it, and where the scene puts it.
#[derive(Clone, Debug)]
pub struct OwnSpace {
    /// The mesh, in its own space.
    pub mesh: Mesh,
    /// Column-major, column vectors.
    pub world_from_mesh: Mat4,
}

/// Rounding below this part of the diagonal is not worth a word: the positions of a mesh around its own
/// origin are rounded by 2⁻²⁵ of their size anyway.
const NEGLIGIBLE: f64 = 1.0 / (1 << 20) as f64;

impl Scene {
    /// The meshes, one for each `scope`, where nothing moved them: placing a mesh far out rounds its
    /// positions, which can open seams and collapse faces that the mesh itself does not have. With
    /// [`Scope::Scene`] the meshes have to be placed, and the one mesh is in world space.
    ///
    /// # Errors
    ///
    /// As [`Scene::bake`], but for transforms.
    pub fn in_own_space(mut self, scope: Scope) -> Result<Vec<OwnSpace>, MeshError> {
        if scope == Scope::Scene {
            let place = |mesh| OwnSpace { mesh, world_from_mesh: Mat4::IDENTITY };
            return Ok(self.bake(scope)?.into_iter().map(place).collect());
        }
        let unplaced =
            |instance: &mut Instance| std::mem::replace(&mut instance.world_from_mesh, Mat4::IDENTITY);
        self.rig.at_rest.iter_mut().for_each(|at| *at = AtRest { world_from_mesh: Mat4::IDENTITY, mover: 0 });
        let transforms: Vec<Mat4> = self.instances.iter_mut().map(unplaced).collect();
        let mut all = Vec::with_capacity(transforms.len());
        for (mesh, world_from_mesh) in self.bake(Scope::Mesh)?.into_iter().zip(transforms) {
            let pieces = if scope == Scope::Primitive { split(mesh)? } else { vec![mesh] };
            all.extend(pieces.into_iter().map(|mesh| OwnSpace { mesh, world_from_mesh }));
        }
        Ok(all)
    }

    /// What to say of [`Scene::rounding`]; `None` where it is small beside every mesh.
    pub(crate) fn rounding_note(&self) -> Option<String> {
        if self.rounding == 0.0 {
            return None;
        }
        // A few corners of a mesh nearly always are far enough apart, and its diagonal is at least that long.
        let large = |mesh: &Mesh| self.rounding <= NEGLIGIBLE * spread(mesh);
        let beside = |mesh| diagonal(mesh).is_none_or(|diagonal| self.rounding <= NEGLIGIBLE * diagonal);
        (!self.meshes.iter().all(|mesh| large(mesh) || beside(mesh))).then(|| {
            format!(
                "coordinates have more digits than 32-bit numbers hold: the largest moved by {}; move the model \
                 towards the origin before it is exported",
                short(self.rounding)
            )
        })
    }

    /// How far rounding moved a coordinate at most: when the file was read, and where `placed`, when the
    /// scene was placed. `None` where that is small beside the meshes.
    #[must_use]
    pub fn judged_rounding(&self, placed: bool) -> Option<f64> {
        let read = if self.rounding_note().is_some() { self.rounding } else { 0.0 };
        let all = if placed { read.max(self.placing_moves()) } else { read };
        (all > 0.0).then_some(all)
    }

    /// The largest distance, along an axis, by which placing an instance rounds a position, in the units of
    /// the scene; 0 where that is small beside each instance.
    #[must_use]
    pub fn placing_moves(&self) -> f64 {
        self.instances
            .iter()
            .map(|instance| placing_moves(&self.meshes[instance.mesh], instance))
            .fold(0.0, f64::max)
    }
}

impl OwnSpace {
    /// A mesh of this space with its positions in the world, each rounded once; its faces keep their winding,
    /// also where the transform mirrors them.
    ///
    /// # Errors
    ///
    /// [`MeshError`] if the transform carries a position beyond `f32`.
    pub fn placed(mesh: &Mesh, world_from_mesh: &Mat4) -> Result<Mesh, MeshError> {
        if *world_from_mesh == Mat4::IDENTITY {
            return Ok(mesh.clone());
        }
        let wide = world_from_mesh.as_dmat4();
        let positions = mesh.positions().iter().map(|&p| exact(&wide, p).as_vec3().into()).collect();
        let mut placed = mesh.clone();
        placed.set_positions(positions)?;
        Ok(placed)
    }

    /// The factor by which the transform changes volumes, without the sign.
    #[must_use]
    pub fn volume_factor(world_from_mesh: &Mat4) -> f64 {
        world_from_mesh.as_dmat4().determinant().abs()
    }
}

fn exact(world_from_mesh: &DMat4, p: [f32; 3]) -> DVec3 {
    world_from_mesh.transform_point3(DVec3::from_array(p.map(f64::from)))
}

/// The diagonal of the box around the first corner of some 64 faces.
fn spread(mesh: &Mesh) -> f64 {
    let step = mesh.face_count() / 64 + 1;
    let corners = mesh.triangles().iter().step_by(step).map(|face| mesh.positions()[face[0] as usize]);
    Aabb::around(corners).diagonal()
}

fn diagonal(mesh: &Mesh) -> Option<f64> {
    mesh.bounds().map(|[low, high]| Aabb { low, high }.diagonal())
}

fn placing_moves(mesh: &Mesh, instance: &Instance) -> f64 {
    if instance.world_from_mesh == Mat4::IDENTITY {
        return 0.0;
    }
    let wide = instance.world_from_mesh.as_dmat4();
    // A position moves by a few half units in the last place of the largest coordinate.
    let Some([low, high]) = mesh.bounds() else { return 0.0 };
    let corner =
        |i: usize| std::array::from_fn(|axis| if i >> axis & 1 == 0 { low[axis] } else { high[axis] });
    let corners: Vec<DVec3> = (0..8).map(|i| exact(&wide, corner(i))).collect();
    let largest = corners.iter().map(|p| p.abs().max_element()).fold(0.0, f64::max);
    let size = (1..8).map(|i| corners[i].distance(corners[0])).fold(0.0, f64::max);
    let allowed = NEGLIGIBLE * size;
    if 8.0 * largest * f64::from(f32::EPSILON) <= allowed {
        return 0.0;
    }
    let moved = |&p: &[f32; 3]| {
        let rounded = instance.world_from_mesh.transform_point3(p.into()).as_dvec3();
        (rounded - exact(&wide, p)).abs().max_element()
    };
    let most = mesh.positions().iter().map(moved).fold(0.0, f64::max);
    if most > allowed { most } else { 0.0 }
}

/// Two digits are enough to see how bad it is.
fn short(x: f64) -> String {
    if (1e-3..1e5).contains(&x) {
        let digits = (1 - x.log10().floor() as i32).max(0) as usize;
        format!("{x:.digits$}")
    } else {
        format!("{x:.1e}")
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;
    use crate::mesh::{Weld, weld};
    use crate::testing::shapes;

    fn at(mesh: Mesh, world_from_mesh: Mat4) -> Scene {
        let mut scene = Scene::of(mesh);
        scene.instances[0].world_from_mesh = world_from_mesh;
        scene
    }

    #[test]
    fn meshes_placed_far_out_are_whole_in_their_own_space() {
        for mesh in [shapes::scaled(&shapes::cube(), 0.1), shapes::scaled(&shapes::icosphere(2), 0.3)] {
            let far = Mat4::from_translation(Vec3::new(4_387_923.5, 717_653.3, -4_555_123.5));
            let scene = at(mesh.clone(), far);
            let moves = scene.placing_moves();
            assert!(moves > 0.05 && moves <= 0.25, "{moves}");
            let own = scene.clone().in_own_space(Scope::Mesh).unwrap().remove(0);
            assert_eq!((&own.mesh, own.world_from_mesh), (&mesh, far));
            // Fault injected: judged where it is placed, vertices fall together.
            let placed = scene.bake(Scope::Mesh).unwrap().remove(0);
            assert!(weld(&placed, Weld::Exact).mesh.vertex_count() < mesh.vertex_count());
            assert!(OwnSpace::placed(&own.mesh, &far).unwrap().positions()[0][0] > 4e6);
        }
        let near = Mat4::from_scale_rotation_translation(
            Vec3::splat(0.3),
            glam::Quat::from_rotation_x(1.0),
            Vec3::new(1.0, 2.0, 3.0),
        );
        assert_eq!(at(shapes::icosphere(2), near).placing_moves(), 0.0);
        assert!((OwnSpace::volume_factor(&near) - 0.027).abs() < 1e-6);
    }

    #[test]
    fn rounding_is_noted_where_it_is_large_beside_the_mesh() {
        let mut scene = Scene::of(shapes::cube());
        scene.rounding = 1e-7;
        assert_eq!(scene.rounding_note(), None);
        scene.rounding = 0.013_75;
        assert!(scene.rounding_note().unwrap().contains("the largest moved by 0.014;"));
        assert_eq!([short(0.25), short(12.34), short(123.4), short(2e-7)], ["0.25", "12", "123", "2.0e-7"]);
    }
}
