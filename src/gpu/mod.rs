//! A graphics device: opened by umbrage or by the caller; its limits are kept, and its failures are errors.
//!
//! Everything runs headless. [`Gpu::from_device`] takes a caller's own device and queue: whatever records
//! into a [`wgpu::CommandEncoder`] then runs in the caller's frame, without waiting for the device.
//!
//! # An engine's frame
//!
//! Once per device: [`Gpu::from_device`], [`VolumeShaders`](crate::shadow::volume::VolumeShaders),
//! [`StencilPass`](crate::shadow::stencil::StencilPass). Once per mesh:
//! [`GpuCaster`](crate::caster::GpuCaster), [`GpuExtrusion`](crate::shadow::volume::GpuExtrusion). Once per
//! frame: `record`, `prepare`, and two draws.
//!
//! ```
//! # use umbrage::gpu::{Gpu, GpuError};
//! use umbrage::caster::{Caster, GpuCaster};
//! use umbrage::gpu::wgpu;
//! use umbrage::shadow::Depth;
//! use umbrage::shadow::stencil::{Draw, StencilFrame, StencilMethod, StencilPass};
//! use umbrage::shadow::volume::{Caps, GpuExtrusion, VolumeShaders};
//! use umbrage::testing::shapes;
//! use umbrage::view::{Camera, Size, Up};
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! # let own = match Gpu::new(None) { Err(GpuError::NoAdapter) => return Ok(()), gpu => gpu? };
//! # let (device, queue) = (own.device().clone(), own.queue().clone());
//!
//! let gpu = Gpu::from_device(device, queue)?; // yours
//! let (shaders, pass) = (VolumeShaders::new(&gpu)?, StencilPass::new(&gpu, Depth::Plane)?);
//! let caster = GpuCaster::upload(&gpu, &Caster::new(shapes::torus(48, 24, 2.0, 0.7)))?;
//! let extrusion = GpuExtrusion::new(&shaders, &caster, Caps::Both, None)?;
//! # let size = Size::new(64, 64)?;
//! # let depth_stencil = gpu.device().create_texture(&wgpu::TextureDescriptor {
//! #     label: None,
//! #     size: wgpu::Extent3d { width: 64, height: 64, depth_or_array_layers: 1 },
//! #     mip_level_count: 1,
//! #     sample_count: 1,
//! #     dimension: wgpu::TextureDimension::D2,
//! #     format: StencilFrame::FORMAT,
//! #     usage: wgpu::TextureUsages::RENDER_ATTACHMENT,
//! #     view_formats: &[],
//! # });
//! # let view = depth_stencil.create_view(&Default::default());
//!
//! // A frame. `view` is a depth-stencil attachment of `StencilFrame::FORMAT`.
//! let camera = Camera::look_at([2.0, 5.0, 6.0], [0.0; 3], 0.8, Up::Y)?.projection(size, 0.1);
//! let mut encoder = gpu.device().create_command_encoder(&Default::default());
//! let volume = extrusion.record(&mut encoder, &"point:3,9,5".parse()?)?;
//! let draw = Draw { volume: &volume, method: StencilMethod::ZFail };
//! let frame = pass.prepare(&camera, size, &caster, &[draw])?;
//! let store = wgpu::StoreOp::Store;
//! let mut drawing = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
//!     depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
//!         view: &view,
//!         depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(0.0), store }),
//!         stencil_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(0), store }),
//!     }),
//!     ..Default::default()
//! });
//! frame.draw_receivers(&mut drawing); // or your own depth, reversed
//! frame.draw_volumes(&mut drawing);
//! drop(drawing);
//! // Now light whatever has stencil 0, and submit.
//! gpu.queue().submit([encoder.finish()]);
//! assert_eq!(extrusion.download_demand()?.exceeded, 0);
//! # Ok(())
//! # }
//! ```
//!
//! # Buffers
//!
//! The layouts of all buffers that the caller's own shaders may read. Words are `u32` unless said otherwise.
//!
//! - [`GpuCaster::vertices`](crate::caster::GpuCaster::vertices): positions, three `f32` per vertex.
//! - [`GpuCaster::planes`](crate::caster::GpuCaster::planes): five runs of `f32`, each with one number per
//!   face and then up to three more to a multiple of four (at least four): x, y and z of the unit normals,
//!   the offsets from a local origin in local units, and the error bounds of the filter for sides.
//! - [`GpuTopology::triangles`](crate::topology::GpuTopology::triangles): vertex ids, three per face; usage
//!   `INDEX` too.
//! - [`GpuTopology::offsets`](crate::topology::GpuTopology::offsets): one more than there are edges: the
//!   entries of edge `e` are those from `offsets[e]` up to `offsets[e + 1]`. Edges are numbered in the order
//!   of their vertices `(a, b)`, `a < b`.
//! - [`GpuTopology::entries`](crate::topology::GpuTopology::entries): three for each face that has not
//!   collapsed (four meaningless bytes if there is none), ascending per edge: a half-edge `entry >> 1`, and
//!   its direction `entry & 1`, 0 from the edge's smaller vertex to its larger, 1 back. Half-edge `h` belongs
//!   to face `h / 3` and leaves vertex `triangles[h]`.
//! - [`GpuSilhouette::facing`](crate::silhouette::GpuSilhouette::facing): four faces per word, the first in
//!   the lowest byte: 1 in front, 255 (−1) behind, 0 edge-on.
//! - [`GpuSilhouette::signs`](crate::silhouette::GpuSilhouette::signs): the same, with 0 for faces that do
//!   not cast.
//! - [`GpuSilhouette::edges`](crate::silhouette::GpuSilhouette::edges): the number of silhouette edges, the
//!   sum of their `|m|`, then for each edge, ascending, its id and its multiplicity `m` (`i32`).
//! - [`GpuSilhouette::quads`](crate::silhouette::GpuSilhouette::quads): for each silhouette edge the sum of
//!   `|m|` over those before it.
//! - [`GpuSilhouette::unsure`](crate::silhouette::GpuSilhouette::unsure): the number of unsure faces, then
//!   their ids in no particular order; 0 for a deforming caster.
//! - [`GpuVolume::vertices`](crate::shadow::volume::GpuVolume::vertices): finite positions, three `f32` per
//!   vertex.
//! - [`GpuVolume::triangles`](crate::shadow::volume::GpuVolume::triangles): vertex ids, three per triangle:
//!   `v` below the vertex count `n` is a finite vertex, `n + v` the same vertex at infinity, `v·w − L` with
//!   the light's homogeneous `(L, w)`. A directional light has one such point, whichever `v` it is written
//!   with. Usage `INDEX` too.
//! - [`GpuVolume::arguments`](crate::shadow::volume::GpuVolume::arguments): a
//!   [`wgpu::util::DrawIndexedIndirectArgs`] for each part (light cap, sides, dark cap): number of corners, 1
//!   instance, first corner, 0, 0. It starts with a [`wgpu::util::DrawIndirectArgs`]. Usage `INDIRECT` too.
//! - [`GpuExtrusion::demand`](crate::shadow::volume::GpuExtrusion::demand): a
//!   [`Demand`](crate::shadow::volume::Demand).

mod buffer;
mod error;
mod kernel;
#[cfg(test)]
pub(crate) mod layout;
mod prefix_sum;
pub(crate) mod raster;
mod sort;
mod texture;

use std::sync::{Arc, OnceLock};

pub use error::GpuError;
pub(crate) use kernel::{Kernel, Shader};
pub(crate) use prefix_sum::{Scan, ScanOf};
pub(crate) use sort::{Pairs, Sort};
pub(crate) use texture::Texture;

// Buffers, textures and encoders are of this version of wgpu.
pub use wgpu;

/// The environment variable that names an adapter where no argument does.
pub const ADAPTER_VARIABLE: &str = "UMBRAGE_ADAPTER";

/// The graphics interfaces that support every pass: OpenGL cannot copy a stencil.
const BACKENDS: wgpu::Backends =
    wgpu::Backends::VULKAN.union(wgpu::Backends::METAL).union(wgpu::Backends::DX12);

/// The features that every device must have: a stencil with a depth of 32 bits.
const FEATURES: wgpu::Features = wgpu::Features::DEPTH32FLOAT_STENCIL8;
/// The features that passes use where a device has them.
const WELCOME: wgpu::Features = wgpu::Features::CLIP_DISTANCES;

/// A device and its queue. Cheap to clone; all clones share one device.
#[derive(Clone, Debug)]
pub struct Gpu {
    device: wgpu::Device,
    queue: wgpu::Queue,
    limits: wgpu::Limits,
    info: wgpu::AdapterInfo,
    /// Why the device was lost, once it is.
    lost: Arc<OnceLock<String>>,
}

impl Gpu {
    /// Opens the adapter whose name contains `adapter`, ignoring case. Without one, the adapter that the
    /// environment variable [`ADAPTER_VARIABLE`] names; without that, the fastest kind available: discrete
    /// before integrated before virtual before software.
    ///
    /// Requests all of the adapter's limits. Takes some tens of milliseconds.
    ///
    /// # Errors
    ///
    /// [`GpuError::NoAdapter`], which says what to install; [`GpuError::NoSuchAdapter`];
    /// [`GpuError::Device`].
    pub fn new(adapter: Option<&str>) -> Result<Self, GpuError> {
        let variable = std::env::var(ADAPTER_VARIABLE).ok().filter(|name| !name.is_empty());
        let wanted = adapter.map(str::to_owned).or(variable);
        let mut adapters = adapters();
        let named = |adapter: &wgpu::Adapter, part: &str| {
            adapter.get_info().name.to_lowercase().contains(&part.to_lowercase())
        };
        if adapters.is_empty() {
            return Err(GpuError::NoAdapter);
        }
        if let Some(wanted) = wanted {
            let available = adapters.iter().map(|adapter| adapter.get_info().name).collect();
            adapters.retain(|adapter| named(adapter, &wanted));
            if adapters.is_empty() {
                return Err(GpuError::NoSuchAdapter { wanted, available });
            }
        }
        adapters.sort_by_key(|adapter| speed(adapter.get_info().device_type)); // stable: the first of a kind
        Self::open(&adapters[0])
    }

    fn open(adapter: &wgpu::Adapter) -> Result<Self, GpuError> {
        let request = adapter.request_device(&wgpu::DeviceDescriptor {
            label: Some("umbrage"),
            required_features: (FEATURES | WELCOME) & adapter.features(),
            required_limits: adapter.limits(),
            experimental_features: wgpu::ExperimentalFeatures::disabled(),
            memory_hints: wgpu::MemoryHints::Performance,
            trace: wgpu::Trace::Off,
        });
        let device = |error: wgpu::RequestDeviceError| GpuError::Device(error::line(&error.to_string()));
        let (device, queue) = pollster::block_on(request).map_err(device)?;
        let gpu = Self::from_device(device, queue)?;
        let lost = Arc::clone(&gpu.lost);
        gpu.device.set_device_lost_callback(move |reason, message| {
            // A device that is dropped is lost too, but then nobody asks.
            lost.get_or_init(|| format!("{reason:?}: {}", error::line(&message)));
        });
        Ok(gpu)
    }

    /// Uses a caller's device and queue. Nothing about them is changed; errors are caught in error scopes.
    ///
    /// # Errors
    ///
    /// [`GpuError::Device`] if the device has no depth of 32 bits with a stencil (ask for
    /// [`wgpu::Features::DEPTH32FLOAT_STENCIL8`]), or cannot run compute shaders with 256 invocations and six
    /// storage buffers.
    pub fn from_device(device: wgpu::Device, queue: wgpu::Queue) -> Result<Self, GpuError> {
        let (limits, info) = (device.limits(), device.adapter_info());
        let wanted = [
            ("compute invocations per workgroup", limits.max_compute_invocations_per_workgroup, 256),
            ("storage buffers per stage", limits.max_storage_buffers_per_shader_stage, 6),
        ];
        if !device.features().contains(FEATURES) {
            return Err(GpuError::Device(format!(
                "{}: the feature DEPTH32FLOAT_STENCIL8 is needed",
                info.name
            )));
        }
        match wanted.into_iter().find(|(_, has, needs)| has < needs) {
            Some((what, has, needs)) => {
                Err(GpuError::Device(format!("{}: {has} {what}, {needs} are needed", info.name)))
            }
            None => Ok(Self { device, queue, limits, info, lost: Arc::default() }),
        }
    }

    /// The adapter's name, with the driver's where it is known.
    #[must_use]
    pub fn name(&self) -> String {
        let wgpu::AdapterInfo { name, driver_info, .. } = &self.info;
        if driver_info.is_empty() || name.contains(driver_info.as_str()) {
            name.clone()
        } else {
            format!("{name}, {driver_info}")
        }
    }

    /// Whether the adapter is a software driver, not a graphics card.
    #[must_use]
    pub fn is_software(&self) -> bool {
        self.info.device_type == wgpu::DeviceType::Cpu
    }

    /// The device.
    #[must_use]
    pub fn device(&self) -> &wgpu::Device {
        &self.device
    }

    /// The queue.
    #[must_use]
    pub fn queue(&self) -> &wgpu::Queue {
        &self.queue
    }

    /// The limits of the device.
    #[must_use]
    pub fn limits(&self) -> &wgpu::Limits {
        &self.limits
    }

    /// Runs `work`, and returns what wgpu reports of it as an error.
    ///
    /// # Errors
    ///
    /// [`GpuError::OutOfMemory`], [`GpuError::Lost`], or [`GpuError::Wgpu`], which is a defect of umbrage.
    pub fn attempt<T>(&self, work: impl FnOnce() -> T) -> Result<T, GpuError> {
        use wgpu::ErrorFilter::{Internal, OutOfMemory, Validation};
        let scopes = [OutOfMemory, Internal, Validation].map(|filter| self.device.push_error_scope(filter));
        let result = work();
        // Scopes are a stack: the last one first.
        let errors = scopes.into_iter().rev().filter_map(|scope| pollster::block_on(scope.pop()));
        let error = errors.fold(None, |first, error| first.or(Some(error)));
        if let Some(why) = self.lost.get() {
            return Err(GpuError::Lost(why.clone()));
        }
        match error {
            None => Ok(result),
            Some(wgpu::Error::OutOfMemory { .. }) => Err(GpuError::OutOfMemory),
            Some(error) => Err(GpuError::Wgpu(error::line(&error.to_string()))),
        }
    }

    /// Submits what `record` writes into a new encoder. Does not wait.
    pub(crate) fn submit<T>(
        &self,
        record: impl FnOnce(&mut wgpu::CommandEncoder) -> T,
    ) -> Result<T, GpuError> {
        self.attempt(|| {
            let mut encoder = self.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
            let result = record(&mut encoder);
            self.queue.submit([encoder.finish()]);
            result
        })
    }
}

fn adapters() -> Vec<wgpu::Adapter> {
    let mut instance = wgpu::InstanceDescriptor::new_without_display_handle();
    instance.backends = BACKENDS;
    pollster::block_on(wgpu::Instance::new(instance).enumerate_adapters(BACKENDS))
}

/// Ascending: the fastest kind of adapter first.
fn speed(kind: wgpu::DeviceType) -> u8 {
    match kind {
        wgpu::DeviceType::DiscreteGpu => 0,
        wgpu::DeviceType::IntegratedGpu => 1,
        wgpu::DeviceType::VirtualGpu => 2,
        wgpu::DeviceType::Other => 3,
        wgpu::DeviceType::Cpu => 4,
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// The adapter for a test. Without one, prints that the test is skipped, or fails where one is demanded.
    pub(crate) fn gpu() -> Option<Gpu> {
        static GPU: OnceLock<Result<Gpu, String>> = OnceLock::new();
        let error = match GPU.get_or_init(|| Gpu::new(None).map_err(|error| error.to_string())) {
            Ok(gpu) => return Some(gpu.clone()),
            Err(error) => error,
        };
        let required = std::env::var("UMBRAGE_REQUIRE_GPU").is_ok_and(|value| value == "1");
        assert!(!required, "UMBRAGE_REQUIRE_GPU=1: {error}");
        // As the integration tests list what they skip.
        let thread = std::thread::current();
        let line = format!("SKIPPED {}: no graphics adapter: {error}\n", thread.name().unwrap_or("a test"));
        eprint!("{line}");
        if let Some(path) = std::env::var_os("UMBRAGE_SKIPPED") {
            let file = std::fs::OpenOptions::new().create(true).append(true).open(path);
            file.and_then(|mut file| std::io::Write::write_all(&mut file, line.as_bytes())).expect("written");
        }
        None
    }

    /// The same adapter with lower limits, so that small meshes reach them.
    pub(crate) fn limited_gpu(tighten: impl FnOnce(&mut wgpu::Limits)) -> Option<Gpu> {
        let name = gpu()?.info.name;
        let adapter = adapters().into_iter().find(|adapter| adapter.get_info().name == name)?;
        let mut required_limits = adapter.limits();
        tighten(&mut required_limits);
        let required_features = FEATURES;
        let descriptor = wgpu::DeviceDescriptor { required_features, required_limits, ..Default::default() };
        let (device, queue) = pollster::block_on(adapter.request_device(&descriptor)).unwrap();
        Some(Gpu::from_device(device, queue).unwrap())
    }

    #[test]
    fn gpu_adapter_that_is_not_there_is_refused_with_the_ones_that_are() {
        let Some(gpu) = gpu() else { return };
        let error = Gpu::new(Some("no such card")).unwrap_err();
        assert!(matches!(&error, GpuError::NoSuchAdapter { available, .. } if !available.is_empty()));
        assert!(error.to_string().contains(&gpu.info.name), "{error}");
    }

    #[test]
    fn gpu_validation_error_is_an_error_and_the_next_attempt_is_clean() {
        let Some(gpu) = gpu() else { return };
        let usage = wgpu::BufferUsages::STORAGE;
        let descriptor =
            |size| wgpu::BufferDescriptor { label: None, size, usage, mapped_at_creation: false };
        let too_large = gpu.limits().max_buffer_size.saturating_add(4);
        let error = gpu.attempt(|| gpu.device().create_buffer(&descriptor(too_large))).unwrap_err();
        assert!(matches!(error, GpuError::Wgpu(_) | GpuError::OutOfMemory), "{error}");
        assert!(!error.to_string().contains('\n'));
        assert!(gpu.attempt(|| gpu.device().create_buffer(&descriptor(4))).is_ok());
    }

    #[test]
    fn gpu_of_a_caller_works_and_a_lost_device_is_an_error() {
        let Some(own) = gpu() else { return };
        let lent = Gpu::from_device(own.device().clone(), own.queue().clone()).unwrap();
        let buffer = lent.upload("words", &[1_u32, 2, 3]).unwrap();
        assert_eq!(own.download::<u32>(&buffer, 3).unwrap(), [1, 2, 3]);
        // A device of its own, since it does not survive.
        let doomed = Gpu::new(None).unwrap();
        let buffer = doomed.upload("words", &[1_u32]).unwrap();
        doomed.device().destroy();
        let error = doomed.download::<u32>(&buffer, 1).unwrap_err();
        assert!(matches!(error, GpuError::Lost(_)), "{error}");
    }
}
