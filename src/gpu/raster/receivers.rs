//! The surfaces that shadows fall on: their triangles, and the pass that draws their depth.

use wgpu::{CompareFunction, StencilFaceState};

use super::pipeline::{Drawing, Pipeline, depth_stencil, layout};
use super::{Frame, SOURCE};
use crate::gpu::{Gpu, GpuError, Shader, wgpu};
use crate::view::{Projection, Size};

/// Where the depth of a fragment comes from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Depth {
    /// From the plane of its face or volume side, in the fragment: off by some units in the last place, even
    /// where a side runs from near the eye to infinity. The depth is never that of a point beyond the lines
    /// where the side ends (its silhouette edge, and the two lines on which that edge's ends are extruded): a
    /// rasterizer may cover a pixel there. Only the side of an edge nearly in line with the light has a plane
    /// that is itself inexact, by the inverse of the sine of that angle; it is as thin as the angle is small.
    #[default]
    Plane,
    /// Interpolated from the corners by the rasterizer: fewer instructions, and an error that scales with the
    /// nearest corner's depth, not the pixel's.
    Interpolated,
}

/// Triangles on the device that a camera sees.
#[derive(Clone, Debug)]
pub(crate) struct Receivers {
    pub(crate) vertices: wgpu::Buffer,
    /// Of usage `INDEX`, for [`Depth::Interpolated`].
    pub(crate) triangles: wgpu::Buffer,
    /// Runs of the normals' x, y and z; any buffer if `plane_stride` is 0.
    pub(crate) planes: wgpu::Buffer,
    /// The length of a run, or 0 if normals come from the corners.
    pub(crate) plane_stride: u32,
    /// Three per face.
    pub(crate) corners: u32,
    /// The largest magnitude of a coordinate, or more.
    pub(crate) largest: f32,
}

impl Receivers {
    /// The camera for these triangles.
    pub(crate) fn frame(&self, projection: &Projection, size: Size) -> Result<Frame, GpuError> {
        Ok(Frame::new(projection, size, self.largest)?.with_planes(self.plane_stride))
    }

    /// What bindings 0 to 3 of raster.wgsl hold.
    pub(crate) fn bindings<'a>(&'a self, frame: &'a wgpu::Buffer) -> [(u32, wgpu::BindingResource<'a>); 4] {
        [
            (0, frame.as_entire_binding()),
            (1, self.vertices.as_entire_binding()),
            (2, self.triangles.as_entire_binding()),
            (3, self.planes.as_entire_binding()),
        ]
    }
}

/// The pipeline that draws the depth of receivers.
#[derive(Clone, Debug)]
pub(crate) struct ReceiverDepth {
    /// Frame, vertices, triangles, planes.
    pub(crate) layout: wgpu::BindGroupLayout,
    pub(crate) drawing: Drawing,
}

impl ReceiverDepth {
    pub(crate) fn new(gpu: &Gpu, depth: Depth) -> Result<Self, GpuError> {
        let module = Shader::new("receivers", SOURCE).module(gpu)?;
        let layout = layout(gpu)?;
        let (vertex, fragment) = match depth {
            Depth::Plane => ("receiver", Some("plane")),
            Depth::Interpolated => ("receiver_vertex", None),
        };
        let keep = StencilFaceState::IGNORE;
        let pipeline = Pipeline {
            vertex,
            fragment,
            targets: &[],
            depth_stencil: Some(depth_stencil(true, CompareFunction::Greater, keep, keep)),
            layout: Some(&layout),
        };
        Ok(Self { drawing: Drawing::new(pipeline, gpu, &module)?, layout })
    }

    /// Draws the depth into a pass that starts infinitely far.
    pub(crate) fn draw(
        &self,
        pass: &mut wgpu::RenderPass<'_>,
        bind: &wgpu::BindGroup,
        triangles: &wgpu::Buffer,
        corners: u32,
    ) {
        pass.set_bind_group(0, bind, &[]);
        self.drawing.all(pass, triangles, corners);
    }
}
