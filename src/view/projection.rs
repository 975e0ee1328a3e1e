//! From the world to clip space, with reversed depth: 1 at the near plane, 0 at the far plane or at infinity.
//!
//! Without a far plane depth is `near / distance`, so that a vertex at infinity (`w = 0`) gets exactly 0 and
//! nothing has to be pushed off the far plane. (An infinite far plane: Cass Everitt and Mark J. Kilgard,
//! *Practical and Robust Stenciled Shadow Volumes for Hardware-Accelerated Rendering*, 2002, §3.2; reversed,
//! so that the spacing of floats cancels that of `1/z`: Eric Lengyel, *Projection Matrix Tricks*, 2007.)

use glam::{DMat3, DVec2, DVec3, DVec4, Mat4};

/// An eye, the three rows of a projection, and its depth range: the very `f32` values that shaders use.
///
/// A homogeneous point `(p, w)` has the clip coordinates `x = right·q` and `y = up·q` with `q = p − w·eye`;
/// the other two are those of its [`Depth`](ProjectionKind). Subtracting the eye first, from coordinates that
/// are exact, costs one rounding; a matrix with the translation in it would cost the distance to the origin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Projection {
    /// Where the rays begin, in world space; for parallel rays, the one through the center of the picture.
    pub eye: [f32; 3],
    /// Clip `x` per mesh unit: 1 at the right edge of the picture, of a perspective one at depth 1.
    pub right: [f32; 3],
    /// Clip `y` per mesh unit: 1 at the upper edge of the picture, of a perspective one at depth 1.
    pub up: [f32; 3],
    /// Distance per mesh unit: the unit vector that the eye looks along.
    pub forward: [f32; 3],
    /// The distance of the near plane from the eye, in mesh units; more than 0 for a perspective projection.
    pub near: f32,
    /// Perspective or orthographic, and where depth ends.
    pub kind: ProjectionKind,
}

/// Clip `z` and `w`, as functions of the distance `d = forward·q` and the homogeneous coordinate `w` of a
/// point.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub enum ProjectionKind {
    /// Clip `z = near·w`, clip `w = d`: no far plane. The only kind that a stencil pass draws so far.
    #[default]
    InfinitePerspective,
    /// Clip `z = near·(far·w − d)/(far − near)`, clip `w = d`.
    Perspective {
        /// The distance of the far plane, more than that of the near plane.
        far: f32,
    },
    /// Clip `z = (far·w − d)/(far − near)`, clip `w = w`.
    Orthographic {
        /// The distance of the far plane, more than that of the near plane.
        far: f32,
    },
}

/// Why two matrices make no [`Projection`].
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ProjectionError {
    /// An entry is NaN or infinite.
    #[error("{0} has an entry that is not a finite number")]
    NotFinite(&'static str),
    /// The view matrix has another last row than 0, 0, 0, c, or flattens space.
    #[error("view_from_world is not an invertible affine transform")]
    View,
    /// The last row of the projection matrix is neither 0, 0, ±c, 0 nor 0, 0, 0, 1.
    #[error("clip_from_view is neither perspective (last row 0, 0, ±c, 0) nor orthographic (0, 0, 0, 1)")]
    Kind,
    /// The rows for x and y do not have the form of a picture around an axis.
    #[error(
        "clip_from_view flattens the picture, or moves the center of a perspective one away from the eye"
    )]
    Picture,
    /// Depth depends on x or y, as with a near plane that is tilted.
    #[error("clip_from_view has a depth that depends on x or y: tilted near planes are not supported")]
    TiltedDepth,
    /// The near and the far plane are not in front of the eye, in this order.
    #[error("the near plane at {near} and the far plane at {far} are not in front of the eye, in this order")]
    Range {
        /// Distance of the near plane in mesh units.
        near: f64,
        /// Distance of the far plane in mesh units.
        far: f64,
    },
    /// Left and right, or above and below, are exchanged.
    #[error("the picture is mirrored: use a right-handed view, and a clip space with y upwards")]
    Mirrored,
}

impl Projection {
    /// The projection of a view matrix and a projection matrix, as engines have them: perspective with or
    /// without a far plane, or orthographic; depth from 0 to 1 as in wgpu, Direct3D, Metal and Vulkan,
    /// reversed or not. The result always has reversed depth: whoever shares a depth buffer with it has to
    /// reverse theirs. The center of the picture may be off the axis. The space between the two matrices is
    /// right-handed for an orthographic projection (the camera looks along −z), and either for a perspective
    /// one.
    ///
    /// ```
    /// use glam::{Vec3, camera::rh};
    /// use umbrage::glam;
    /// use umbrage::view::{Projection, ProjectionKind};
    /// let view = rh::view::look_at_mat4(Vec3::new(0.0, 2.0, 5.0), Vec3::ZERO, Vec3::Y);
    /// let clip = rh::proj::directx::perspective_infinite_reverse(0.8, 16.0 / 9.0, 0.125);
    /// let projection = Projection::from_matrices(view, clip)?;
    /// assert_eq!(projection.kind, ProjectionKind::InfinitePerspective);
    /// assert_eq!(projection.near, 0.125);
    /// # Ok::<(), umbrage::view::ProjectionError>(())
    /// ```
    ///
    /// # Errors
    ///
    /// [`ProjectionError`] for what this type cannot represent: mirrored pictures, tilted near planes, depth
    /// from −1 to 1 where it shows.
    pub fn from_matrices(view_from_world: Mat4, clip_from_view: Mat4) -> Result<Self, ProjectionError> {
        for (name, matrix) in [("view_from_world", view_from_world), ("clip_from_view", clip_from_view)] {
            if !matrix.is_finite() {
                return Err(ProjectionError::NotFinite(name));
            }
        }
        let (view, clip) = (view_from_world.as_dmat4(), clip_from_view.as_dmat4());
        // The inverse of a camera's matrix has a last entry that is 1 but for rounding: a factor of all
        // coordinates.
        let view = match view.row(3).to_array() {
            [0.0, 0.0, 0.0, w] if w != 0.0 && view.determinant() != 0.0 => view * w.recip(),
            _ => return Err(ProjectionError::View),
        };
        // Distance in view space is ±z, up to a common factor of the matrix.
        let (perspective, along_z, factor) = match clip.row(3).to_array() {
            [0.0, 0.0, z, 0.0] if z != 0.0 => (true, z.signum(), z.abs()),
            [0.0, 0.0, 0.0, 1.0] => (false, -1.0, 1.0),
            _ => return Err(ProjectionError::Kind),
        };
        let [x, y, z] = [0, 1, 2].map(|row| clip.row(row) / factor);
        if perspective && (x.w, y.w) != (0.0, 0.0) {
            return Err(ProjectionError::Picture);
        }
        if (z.x, z.y) != (0.0, 0.0) {
            return Err(ProjectionError::TiltedDepth);
        }
        // Depth is slope + offset/distance, or slope·distance + offset: where is it 0, and where 1?
        let (slope, offset) = (z.z * along_z, z.w);
        let [zero, one] = match perspective {
            true => [-offset / slope, offset / (1.0 - slope)],
            false => [-offset / slope, (1.0 - offset) / slope],
        };
        // Infinitely far, whatever the sign of the division by zero.
        let [zero, one] = [zero, one].map(|d| if d.is_infinite() { f64::INFINITY } else { d });

        // In the world: rows of the linear part, and the constants for the eye.
        let linear = DMat3::from_mat4(view);
        let of_view = [x, y, DVec4::Z * along_z];
        let rows = of_view.map(|row| linear.transpose() * row.truncate());
        let at_origin = of_view.map(|row| row.truncate().dot(view.w_axis.truncate()) + row.w);
        let unit = rows[2].length();
        let scale = if perspective { unit } else { 1.0 };
        let [right, up, forward] = [rows[0] / scale, rows[1] / scale, rows[2] / unit];
        let at_eye = DVec3::new(at_origin[0] / scale, at_origin[1] / scale, at_origin[2] / unit);
        let handed = right.cross(up).dot(forward);
        if handed == 0.0 || !handed.is_finite() {
            return Err(ProjectionError::Picture);
        }
        if handed > 0.0 {
            return Err(ProjectionError::Mirrored);
        }
        let eye = DMat3::from_cols(right, up, forward).transpose().inverse() * -at_eye;

        let (near, far) = (zero.min(one) / unit, zero.max(one) / unit);
        let narrow = |v: DVec3| v.as_vec3().to_array();
        let kind = match (perspective, far as f32) {
            (true, far) if far.is_infinite() => ProjectionKind::InfinitePerspective,
            (true, far) => ProjectionKind::Perspective { far },
            (false, far) => ProjectionKind::Orthographic { far },
        };
        let projection = Self {
            eye: narrow(eye),
            right: narrow(right),
            up: narrow(up),
            forward: narrow(forward),
            near: near as f32,
            kind,
        };
        let in_front = if perspective { projection.near > 0.0 } else { projection.near.is_finite() };
        if !(in_front && projection.near.is_finite() && projection.far() > projection.near && far > 0.0)
            || !perspective && projection.far().is_infinite()
        {
            return Err(ProjectionError::Range { near, far });
        }
        let rows = [projection.eye, projection.right, projection.up];
        match rows.as_flattened().iter().all(|x| x.is_finite()) && projection.depth_one().is_finite() {
            true => Ok(projection),
            false => Err(ProjectionError::Picture),
        }
    }

    /// The distance of the far plane; infinite where there is none.
    #[must_use]
    pub fn far(&self) -> f32 {
        match self.kind {
            ProjectionKind::InfinitePerspective => f32::INFINITY,
            ProjectionKind::Perspective { far } | ProjectionKind::Orthographic { far } => far,
        }
    }

    /// Whether the rays of the picture are parallel.
    #[must_use]
    pub fn is_orthographic(&self) -> bool {
        matches!(self.kind, ProjectionKind::Orthographic { .. })
    }

    /// The clip coordinates of a homogeneous point, in `f64`.
    #[must_use]
    pub fn clip(&self, [x, y, z, w]: [f64; 4]) -> [f64; 4] {
        let q = DVec3::new(x, y, z) - w * wide(self.eye);
        let distance = wide(self.forward).dot(q);
        let (near, far) = (f64::from(self.near), f64::from(self.far()));
        let (z, w) = match self.kind {
            ProjectionKind::InfinitePerspective => (near * w, distance),
            ProjectionKind::Perspective { .. } => (near * (far * w - distance) / (far - near), distance),
            ProjectionKind::Orthographic { .. } => ((far * w - distance) / (far - near), w),
        };
        [wide(self.right).dot(q), wide(self.up).dot(q), z, w]
    }

    /// The direction, at depth 1 (`forward·direction = 1`), of the ray through a position of the picture in
    /// normalized device coordinates: −1 to 1 from left to right and from bottom to top. Inverts a matrix;
    /// for many rays there is [`Rays`](super::Rays).
    #[must_use]
    pub fn ray(&self, ndc: DVec2) -> DVec3 {
        match self.is_orthographic() {
            true => self.depth_one() * DVec3::Z,
            false => self.depth_one() * ndc.extend(1.0),
        }
    }

    /// The corners of the near rectangle in world space, counter-clockwise as seen, from the lower left one.
    #[must_use]
    pub fn near_corners(&self) -> [DVec3; 4] {
        let near = f64::from(self.near);
        [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(|(x, y)| match self.is_orthographic() {
            true => wide(self.eye) + self.depth_one() * DVec3::new(x, y, near),
            false => wide(self.eye) + near * self.ray(DVec2::new(x, y)),
        })
    }

    /// The inverse of the three rows: what is from the eye at the given `x`, `y` and distance, where clip
    /// coordinates are not divided.
    pub(super) fn depth_one(&self) -> DMat3 {
        self.rows().transpose().inverse()
    }

    /// Right, up and forward as the columns of a matrix.
    fn rows(&self) -> DMat3 {
        DMat3::from_cols(wide(self.right), wide(self.up), wide(self.forward))
    }
}

fn wide(p: [f32; 3]) -> DVec3 {
    DVec3::from(p.map(f64::from))
}

#[cfg(test)]
mod tests {
    use glam::camera::{lh, rh};
    use glam::{Quat, Vec3};
    use proptest::prelude::*;

    use super::*;

    fn projection(kind: ProjectionKind) -> Projection {
        let (eye, right) = ([1.0, 2.0, 3.0], [0.8, 0.0, -0.6]);
        Projection { eye, right, up: [0.0, 2.0, 0.0], forward: [-0.6, 0.0, -0.8], near: 0.25, kind }
    }

    const KINDS: [ProjectionKind; 3] = [
        ProjectionKind::InfinitePerspective,
        ProjectionKind::Perspective { far: 16.0 },
        ProjectionKind::Orthographic { far: 16.0 },
    ];

    #[test]
    fn projection_sends_the_far_plane_to_depth_zero_and_the_near_plane_to_one() {
        for kind in KINDS {
            let projection = projection(kind);
            // Coordinates are exact in f64 up to the rounding of a handful of products of numbers below 32.
            let error = 32.0 * 8.0 * f64::EPSILON / 0.25;
            for corner in projection.near_corners() {
                let [x, y, z, w] = projection.clip(corner.extend(1.0).to_array());
                assert!((z / w - 1.0).abs() < error, "{kind:?}");
                assert!(
                    ((x / w).abs() - 1.0).abs() < error && ((y / w).abs() - 1.0).abs() < error,
                    "{kind:?}"
                );
            }
            if kind == ProjectionKind::InfinitePerspective {
                assert_eq!(projection.clip([-3.0, 1.0, -4.0, 0.0])[2], 0.0);
            } else {
                let far = wide(projection.eye) + 16.0 * projection.ray(DVec2::ZERO);
                assert!(projection.clip(far.extend(1.0).to_array())[2].abs() < error, "{kind:?}");
            }
        }
    }

    #[test]
    fn projection_ray_goes_through_its_position_in_the_picture() {
        let projection = projection(ProjectionKind::InfinitePerspective);
        for ndc in [DVec2::ZERO, DVec2::new(0.75, -0.3), DVec2::new(-1.0, 1.0)] {
            let [x, y, _, w] = projection.clip(projection.ray(ndc).extend(0.0).to_array());
            assert!((w - 1.0).abs() < 1e-12 && (DVec2::new(x, y) - ndc).length() < 1e-12);
        }
    }

    /// Matrices whose entries are exact: a view turned by quarter turns, and powers of two.
    fn exact(kind: ProjectionKind, reversed: bool) -> (Mat4, Mat4) {
        let view = Mat4::from_cols_array_2d(&[
            // right is −z, up is y, back is x
            [0.0, 0.0, 1.0, 0.0],
            [0.0, 1.0, 0.0, 0.0],
            [-1.0, 0.0, 0.0, 0.0],
            [3.0, -2.0, -1.0, 1.0],
        ]);
        let (near, range) = (0.25, 1.0 / (0.5 - 0.25));
        let (slope, offset, w) = match (kind, reversed) {
            (ProjectionKind::InfinitePerspective, true) => (0.0, near, -1.0),
            (ProjectionKind::InfinitePerspective, false) => (-1.0, -near, -1.0),
            (ProjectionKind::Perspective { .. }, true) => (near * range, near * 0.5 * range, -1.0),
            (ProjectionKind::Perspective { .. }, false) => (-0.5 * range, -near * 0.5 * range, -1.0),
            (_, true) => (range, 0.5 * range, 0.0),
            (_, false) => (-range, -near * range, 0.0),
        };
        let clip = Mat4::from_cols_array_2d(&[
            [2.0, 0.0, 0.0, 0.0],
            [0.0, 4.0, 0.0, 0.0],
            [0.0, 0.0, slope, w],
            [0.0, 0.0, offset, if w == 0.0 { 1.0 } else { 0.0 }],
        ]);
        (view, clip)
    }

    #[test]
    fn projection_comes_back_from_exact_matrices_as_it_was() {
        for kind in [
            ProjectionKind::InfinitePerspective,
            ProjectionKind::Perspective { far: 0.5 },
            ProjectionKind::Orthographic { far: 0.5 },
        ] {
            let wanted = Projection {
                eye: [1.0, 2.0, 3.0],
                right: [0.0, 0.0, -2.0],
                up: [0.0, 4.0, 0.0],
                forward: [-1.0, 0.0, 0.0],
                near: 0.25,
                kind,
            };
            for reversed in [false, true] {
                let (view, clip) = exact(kind, reversed);
                assert_eq!(Projection::from_matrices(view, clip), Ok(wanted), "{kind:?} {reversed}");
                // A common factor of a perspective matrix, and a view in other units, are the same picture.
                if !wanted.is_orthographic() {
                    assert_eq!(Projection::from_matrices(view, clip * 8.0), Ok(wanted));
                    let halved = Mat4::from_scale(Vec3::splat(0.5)) * view;
                    let twice = Projection { near: 0.5, ..wanted };
                    let twice = match kind {
                        ProjectionKind::Perspective { .. } => {
                            Projection { kind: ProjectionKind::Perspective { far: 1.0 }, ..twice }
                        }
                        _ => twice,
                    };
                    assert_eq!(Projection::from_matrices(halved, clip), Ok(twice));
                }
                if kind == ProjectionKind::InfinitePerspective && reversed {
                    // The same matrices, from what comes back.
                    for p in [[0.0, 1.0, 2.0, 1.0], [-5.0, 1.0, 2.0, 0.0]] {
                        let there = (clip * view).as_dmat4() * DVec4::from_array(p);
                        assert_eq!(wanted.clip(p), there.to_array());
                    }
                }
            }
        }
    }

    #[test]
    fn projection_refuses_matrices_that_it_cannot_represent() {
        let (view, clip) = exact(ProjectionKind::InfinitePerspective, true);
        let refused = |view, clip| Projection::from_matrices(view, clip).unwrap_err();
        assert_eq!(refused(view, Mat4::NAN), ProjectionError::NotFinite("clip_from_view"));
        assert_eq!(refused(clip, clip), ProjectionError::View);
        assert_eq!(refused(Mat4::from_scale(Vec3::new(1.0, 0.0, 1.0)), clip), ProjectionError::View);
        assert_eq!(refused(view, Mat4::ZERO), ProjectionError::Kind);
        let flipped = Mat4::from_scale(Vec3::new(1.0, -1.0, 1.0));
        assert_eq!(refused(view, flipped * clip), ProjectionError::Mirrored);
        assert_eq!(
            refused(view, rh::proj::vulkan::perspective(1.0, 1.0, 0.1, 9.0)),
            ProjectionError::Mirrored
        );
        let left_handed = lh::view::look_at_mat4(Vec3::splat(5.0), Vec3::ZERO, Vec3::Y);
        let mirrored = lh::proj::directx::perspective(1.0, 1.0, 0.1, 9.0);
        assert_eq!(refused(left_handed, mirrored), ProjectionError::Mirrored);
        let behind = lh::proj::directx::orthographic(-1.0, 1.0, -1.0, 1.0, 0.1, 9.0);
        assert!(matches!(refused(left_handed, behind), ProjectionError::Range { .. }));
        let mut tilted = clip;
        tilted.x_axis.z = 0.5;
        assert_eq!(refused(view, tilted), ProjectionError::TiltedDepth);
        let mut moved = clip;
        moved.w_axis.x = 0.5;
        assert_eq!(refused(view, moved), ProjectionError::Picture);
        let mut flat = clip;
        flat.x_axis.x = 0.0;
        assert_eq!(refused(view, flat), ProjectionError::Picture);
        let mut nowhere = clip;
        nowhere.w_axis.z = 0.0;
        assert!(matches!(refused(view, nowhere), ProjectionError::Range { .. }));
    }

    proptest! {
        #[test]
        fn projection_of_matrices_shows_what_the_matrices_do(
            eye in [-9.0_f32..9.0, -9.0..9.0, -9.0..9.0], turn in [-1.0_f32..1.0, -1.0..1.0, -1.0..1.0, 0.1..1.0],
            fov in 0.2_f32..2.0, aspect in 0.3_f32..3.0, near in 0.01_f32..1.0, reach in 2.0_f32..100.0,
            kind in 0..4, at in [-1.0_f64..1.0, -1.0..1.0], distance in 1.0_f64..20.0,
        ) {
            let turn = Quat::from_array(turn).normalize();
            let view = Mat4::from_rotation_translation(turn, eye.into()).inverse();
            let (half, far) = (4.0 * fov, near * reach);
            let clip = match kind {
                0 => rh::proj::directx::perspective_infinite_reverse(fov, aspect, near),
                1 => rh::proj::directx::perspective_infinite(fov, aspect, near),
                2 => rh::proj::directx::perspective(fov, aspect, near, far),
                _ => rh::proj::directx::orthographic(-half * aspect, half * aspect, -half, half, near, far),
            };
            let projection = Projection::from_matrices(view, clip).unwrap();
            // A point that is well inside the picture.
            let tan = f64::from(0.5 * fov).tan() * distance;
            let half = if kind == 3 { f64::from(half) } else { tan };
            let local = DVec3::new(at[0] * half * f64::from(aspect), at[1] * half, -distance);
            let p = turn.as_dquat() * local + wide(eye);
            let [x, y, _, w] = projection.clip(p.extend(1.0).to_array());
            let there = clip.as_dmat4() * view.as_dmat4() * p.extend(1.0);
            // Entries of the view matrix are rounded to f32 about 16 times on their way; what they are
            // multiplied with is at most 50 long, and so is the eye. The rows make of it what is over the
            // distance, or over half a picture.
            let rows = 1.0 + 1.0 / half.min(half * f64::from(aspect));
            let bound = 16.0 * f64::from(f32::EPSILON) * 50.0 * rows;
            prop_assert!((x / w - there.x / there.w).abs() <= bound, "{} {}", x / w, there.x / there.w);
            prop_assert!((y / w - there.y / there.w).abs() <= bound, "{} {}", y / w, there.y / there.w);
        }
    }
}
