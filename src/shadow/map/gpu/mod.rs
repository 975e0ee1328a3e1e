//! Shadow maps on a device: one depth texture with a layer per side of a cube, and the lookup that fills a
//! visibility texture.

mod hybrid;
mod ids;
mod uniform;
#[cfg(test)]
mod test_support;
#[cfg(test)]
mod tests;

pub use hybrid::{HybridPass, Marked};
pub use ids::{GpuIdMap, IdPass};

use wgpu::{
    CompareFunction, StencilState, TextureAspect, TextureFormat, TextureUsages, TextureViewDimension,
};

pub(in crate::shadow) use self::uniform::{LightUniform, ROUNDING};
use super::{Bias, DepthSource, Filter, LightSpace, Rule};
use crate::caster::GpuCaster;
use crate::gpu::raster::{self, GpuSamples, GpuVisibility, Pipeline, Receivers, everywhere};
use crate::gpu::{Gpu, GpuError, Shader, wgpu};

pub(in crate::shadow) const SOURCE: &str = include_str!("map.wgsl");

const FORMAT: TextureFormat = TextureFormat::Depth32Float;

/// How a map on a device is looked up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Lookup {
    /// The filter: all but those of Poisson.
    pub filter: Filter,
    /// The bias: all but [`Bias::Second`]. [`Bias::Offset`] needs a map of [`MapPass::draw_interpolated`]
    /// with the offset of this lookup.
    pub bias: Bias,
}

/// A shadow map on a device: reversed depth, 0 where nothing casts.
#[derive(Clone, Debug)]
pub struct GpuMap {
    texture: wgpu::Texture,
    pub(in crate::shadow) view: wgpu::TextureView,
    space: LightSpace,
    pub(in crate::shadow) uniform: LightUniform,
    depth: DepthSource,
}

impl GpuMap {
    /// All layers, as a `texture_depth_2d_array` of the format `Depth32Float`.
    #[must_use]
    pub fn view(&self) -> &wgpu::TextureView {
        &self.view
    }

    /// The light's space: rows, projection and side of the map.
    #[must_use]
    pub fn space(&self) -> &LightSpace {
        &self.space
    }

    /// Memory on the device, in bytes.
    #[must_use]
    pub fn bytes(&self) -> usize {
        4 * (self.space.size() as usize).pow(2) * self.space.layers()
    }

    /// Reads the depths of one layer back, row after row from the top. Waits for the work that draws them.
    ///
    /// # Errors
    ///
    /// [`GpuError::OutOfMemory`], [`GpuError::Lost`].
    ///
    /// # Panics
    ///
    /// Panics if there is no such layer.
    pub fn download(&self, gpu: &Gpu, layer: usize) -> Result<Vec<f32>, GpuError> {
        assert!(layer < self.space.layers(), "there is no layer {layer}");
        let side = self.space.size();
        let row = (4 * side).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
        let back = gpu.staging(u64::from(row) * u64::from(side))?;
        gpu.submit(|encoder| {
            encoder.copy_texture_to_buffer(
                wgpu::TexelCopyTextureInfo {
                    texture: &self.texture,
                    mip_level: 0,
                    origin: wgpu::Origin3d { x: 0, y: 0, z: layer as u32 }, // below 6
                    aspect: TextureAspect::DepthOnly,
                },
                wgpu::TexelCopyBufferInfo {
                    buffer: &back,
                    layout: wgpu::TexelCopyBufferLayout {
                        offset: 0,
                        bytes_per_row: Some(row),
                        rows_per_image: None,
                    },
                },
                wgpu::Extent3d { width: side, height: side, depth_or_array_layers: 1 },
            );
        })?;
        gpu.mapped(&back, |bytes| {
            let rows = bytes.chunks_exact(row as usize);
            let depths = rows.flat_map(|row| row[..4 * side as usize].chunks_exact(4));
            depths.map(|depth| f32::from_ne_bytes([depth[0], depth[1], depth[2], depth[3]])).collect()
        })
    }
}

/// The compiled passes, for one device.
#[derive(Clone, Debug)]
pub struct MapPass {
    gpu: Gpu,
    module: wgpu::ShaderModule,
    draw: wgpu::RenderPipeline,
    look: wgpu::RenderPipeline,
}

impl MapPass {
    /// Compiles the shaders.
    ///
    /// # Errors
    ///
    /// [`GpuError::Lost`], [`GpuError::OutOfMemory`].
    pub fn new(gpu: &Gpu) -> Result<Self, GpuError> {
        Self::of(gpu, SOURCE)
    }

    /// The passes with one text of their shader replaced, for the injected faults of tests.
    #[cfg(test)]
    pub(crate) fn with_fault(gpu: &Gpu, text: &str, fault: &str) -> Self {
        assert!(SOURCE.contains(text), "{text}");
        Self::of(gpu, &SOURCE.replace(text, fault)).expect("it compiles")
    }

    fn of(gpu: &Gpu, source: &str) -> Result<Self, GpuError> {
        let module = Shader::new("shadow map", &format!("{}{source}", raster::SOURCE)).module(gpu)?;
        let look = Pipeline {
            vertex: "everywhere",
            fragment: Some("visibility"),
            targets: &[Some(GpuVisibility::SOFT.into())],
            depth_stencil: None,
            layout: None,
        };
        Ok(Self {
            gpu: gpu.clone(),
            draw: drawing(gpu, &module, "caster_depth", &[])?,
            look: look.build(gpu, &module)?,
            module,
        })
    }

    /// Draws the map of a caster in a light's space: one pass per layer. Submits without waiting.
    ///
    /// # Errors
    ///
    /// [`GpuError::Picture`] if a layer is larger than the device allows; [`GpuError::Subnormal`] if the
    /// caster is too small to be drawn; [`GpuError::OutOfMemory`]; [`GpuError::Lost`].
    pub fn draw(&self, caster: &GpuCaster, space: &LightSpace) -> Result<GpuMap, GpuError> {
        draw(&self.gpu, &self.draw, caster, space, None)
    }

    /// Draws the map with the depth that the device interpolates between corners, moved by the polygon offset
    /// of a lookup with [`Bias::Offset`]. Compiles a pipeline, of which the offset is part; submits without
    /// waiting.
    ///
    /// # Errors
    ///
    /// As [`MapPass::draw`].
    pub fn draw_interpolated(
        &self,
        caster: &GpuCaster,
        space: &LightSpace,
        lookup: Lookup,
    ) -> Result<GpuMap, GpuError> {
        let rule = Rule::new(lookup.bias, lookup.filter.reach(), DepthSource::Interpolated, space);
        let offset = rule.polygon_offset();
        // Away from the light: depth is reversed.
        let bias = wgpu::DepthBiasState {
            constant: -offset.constant,
            slope_scale: -offset.slope_scale as f32,
            clamp: 0.0,
        };
        let draw_between = Pipeline {
            vertex: "caster_between",
            fragment: None,
            targets: &[],
            depth_stencil: Some(wgpu::DepthStencilState { bias, ..depth_of_casters() }),
            layout: None,
        };
        let pipeline = draw_between.build(&self.gpu, &self.module)?;
        let map = draw(&self.gpu, &pipeline, caster, space, None)?;
        Ok(GpuMap { depth: DepthSource::Interpolated, ..map })
    }

    /// The filtered map at every sample. Submits without waiting.
    ///
    /// # Errors
    ///
    /// [`GpuError::NotBuilt`] of a filter or bias without a device form; [`GpuError::OutOfMemory`];
    /// [`GpuError::Lost`].
    pub fn visibility(
        &self,
        samples: &GpuSamples,
        map: &GpuMap,
        lookup: Lookup,
    ) -> Result<GpuVisibility, GpuError> {
        let uniform = map.uniform.with_lookup(&map.space, map.depth, lookup);
        let uniform = uniform.ok_or(GpuError::NotBuilt("this filter or bias of a shadow map"))?;
        let light = self.gpu.uniform(&uniform)?;
        let visibility = GpuVisibility::soft(&self.gpu, samples.size())?;
        let more = [
            (5, wgpu::BindingResource::TextureView(&samples.faces.view)),
            (6, light.as_entire_binding()),
            (7, wgpu::BindingResource::TextureView(&map.view)),
        ];
        let bind = bind(&self.gpu, &self.look, &samples.receivers, &samples.uniform, &more)?;
        self.gpu.submit(|encoder| {
            everywhere(visibility.0.begin(encoder, true), &self.look, Some(&bind));
        })?;
        Ok(visibility)
    }
}

/// The pipeline that draws casters, with targets beside the depth.
fn drawing(
    gpu: &Gpu,
    module: &wgpu::ShaderModule,
    fragment: &str,
    targets: &[Option<wgpu::ColorTargetState>],
) -> Result<wgpu::RenderPipeline, GpuError> {
    let draw = Pipeline {
        vertex: "caster",
        fragment: Some(fragment),
        targets,
        depth_stencil: Some(depth_of_casters()),
        layout: None,
    };
    draw.build(gpu, module)
}

/// The nearest to the light is kept.
fn depth_of_casters() -> wgpu::DepthStencilState {
    wgpu::DepthStencilState {
        format: FORMAT,
        depth_write_enabled: Some(true),
        depth_compare: Some(CompareFunction::Greater),
        stencil: StencilState::default(),
        bias: wgpu::DepthBiasState::default(),
    }
}

/// Draws the map of a caster in a light's space, one pass per layer, and what the pipeline writes beside the
/// depth into the layers of `names`.
fn draw(
    gpu: &Gpu,
    pipeline: &wgpu::RenderPipeline,
    caster: &GpuCaster,
    space: &LightSpace,
    names: Option<&wgpu::Texture>,
) -> Result<GpuMap, GpuError> {
    let receivers = caster.receivers()?;
    let (texture, uniform) = (texture(gpu, space, FORMAT)?, LightUniform::new(space, receivers.largest));
    let layers = (0..space.layers() as u32).map(|index| {
        let light = gpu.uniform(&uniform.with_layer(index))?;
        let frame = gpu.uniform(&raster::Frame::without_camera(receivers.largest, receivers.plane_stride))?;
        let bind = bind(gpu, pipeline, &receivers, &frame, &[(6, light.as_entire_binding())])?;
        let names = names.map(|names| layer(gpu, names, index)).transpose()?;
        Ok((bind, layer(gpu, &texture, index)?, names))
    });
    let layers = layers.collect::<Result<Vec<_>, GpuError>>()?;
    gpu.submit(|encoder| {
        for (bind, view, names) in &layers {
            let colors: Vec<_> = names.iter().map(named).collect();
            let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                color_attachments: &colors,
                depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                    view,
                    depth_ops: Some(wgpu::Operations {
                        load: wgpu::LoadOp::Clear(0.0),
                        store: wgpu::StoreOp::Store,
                    }),
                    stencil_ops: None,
                }),
                ..wgpu::RenderPassDescriptor::default()
            });
            pass.set_pipeline(pipeline);
            pass.set_bind_group(0, bind, &[]);
            pass.draw(0..receivers.corners, 0..1);
        }
    })?;
    let view = all_layers(gpu, &texture)?;
    Ok(GpuMap { texture, view, space: *space, uniform, depth: DepthSource::Plane })
}

/// A layer of names, cleared to none.
fn named(view: &wgpu::TextureView) -> Option<wgpu::RenderPassColorAttachment<'_>> {
    let ops =
        wgpu::Operations { load: wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT), store: wgpu::StoreOp::Store };
    Some(wgpu::RenderPassColorAttachment { view, depth_slice: None, resolve_target: None, ops })
}

fn texture(gpu: &Gpu, space: &LightSpace, format: TextureFormat) -> Result<wgpu::Texture, GpuError> {
    let (side, limit) = (space.size(), gpu.limits().max_texture_dimension_2d);
    if side > limit {
        return Err(GpuError::Picture { side, limit });
    }
    gpu.attempt(|| {
        gpu.device().create_texture(&wgpu::TextureDescriptor {
            label: Some("shadow map"),
            size: wgpu::Extent3d { width: side, height: side, depth_or_array_layers: space.layers() as u32 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage: TextureUsages::RENDER_ATTACHMENT
                | TextureUsages::TEXTURE_BINDING
                | TextureUsages::COPY_SRC,
            view_formats: &[],
        })
    })
}

fn layer(gpu: &Gpu, texture: &wgpu::Texture, layer: u32) -> Result<wgpu::TextureView, GpuError> {
    gpu.attempt(|| {
        texture.create_view(&wgpu::TextureViewDescriptor {
            dimension: Some(TextureViewDimension::D2),
            base_array_layer: layer,
            array_layer_count: Some(1),
            ..Default::default()
        })
    })
}

fn all_layers(gpu: &Gpu, texture: &wgpu::Texture) -> Result<wgpu::TextureView, GpuError> {
    gpu.attempt(|| {
        texture.create_view(&wgpu::TextureViewDescriptor {
            dimension: Some(TextureViewDimension::D2Array),
            ..Default::default()
        })
    })
}

/// Group 0 of a pipeline that reads triangles.
pub(in crate::shadow) fn bind<'a>(
    gpu: &Gpu,
    pipeline: &wgpu::RenderPipeline,
    receivers: &'a Receivers,
    frame: &'a wgpu::Buffer,
    more: &[(u32, wgpu::BindingResource<'a>)],
) -> Result<wgpu::BindGroup, GpuError> {
    let layout = gpu.attempt(|| pipeline.get_bind_group_layout(0))?;
    gpu.bind_group(&layout, receivers.bindings(frame).into_iter().chain(more.iter().cloned()))
}
