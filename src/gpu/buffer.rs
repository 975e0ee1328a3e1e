//! Buffers on the device: created, filled and read back, never beyond the limits of the device.

use std::sync::mpsc::{self, RecvTimeoutError};
use std::time::Duration;

use bytemuck::{NoUninit, Pod};
use wgpu::BufferUsages;

use super::{Gpu, GpuError};

/// The usages of every buffer, besides its own.
const STORAGE: BufferUsages =
    BufferUsages::STORAGE.union(BufferUsages::COPY_SRC).union(BufferUsages::COPY_DST);

impl Gpu {
    /// A storage buffer for `count` values of `T`, all zero; at least four bytes.
    pub(crate) fn storage<T: Pod>(&self, what: &'static str, count: usize) -> Result<wgpu::Buffer, GpuError> {
        self.storage_for::<T>(what, count, BufferUsages::empty())
    }

    /// As [`Gpu::storage`], with further usages.
    pub(crate) fn storage_for<T: Pod>(
        &self,
        what: &'static str,
        count: usize,
        also: BufferUsages,
    ) -> Result<wgpu::Buffer, GpuError> {
        let size = self.checked_size::<T>(what, count)?;
        self.attempt(|| {
            let usage = STORAGE | also;
            self.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(what),
                size,
                usage,
                mapped_at_creation: false,
            })
        })
    }

    /// A storage buffer that holds `values`.
    pub(crate) fn upload<T: NoUninit>(
        &self,
        what: &'static str,
        values: &[T],
    ) -> Result<wgpu::Buffer, GpuError> {
        self.filled(what, values, STORAGE)
    }

    /// As [`Gpu::upload`], with further usages.
    pub(crate) fn upload_for<T: NoUninit>(
        &self,
        what: &'static str,
        values: &[T],
        also: BufferUsages,
    ) -> Result<wgpu::Buffer, GpuError> {
        self.filled(what, values, STORAGE | also)
    }

    /// A uniform buffer that holds `value`.
    pub(crate) fn uniform<T: NoUninit>(&self, value: &T) -> Result<wgpu::Buffer, GpuError> {
        self.filled("parameters", std::slice::from_ref(value), BufferUsages::UNIFORM)
    }

    /// Resources at their bindings.
    pub(crate) fn bind_group<'a>(
        &self,
        layout: &wgpu::BindGroupLayout,
        resources: impl IntoIterator<Item = (u32, wgpu::BindingResource<'a>)>,
    ) -> Result<wgpu::BindGroup, GpuError> {
        let entry = |(binding, resource)| wgpu::BindGroupEntry { binding, resource };
        let entries: Vec<_> = resources.into_iter().map(entry).collect();
        self.attempt(|| {
            let descriptor = wgpu::BindGroupDescriptor { label: None, layout, entries: &entries };
            self.device.create_bind_group(&descriptor)
        })
    }

    fn filled<T: NoUninit>(
        &self,
        what: &'static str,
        values: &[T],
        usage: BufferUsages,
    ) -> Result<wgpu::Buffer, GpuError> {
        let size = self.checked_size::<T>(what, values.len())?;
        self.attempt(|| {
            let buffer = self.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(what),
                size,
                usage,
                mapped_at_creation: true,
            });
            let bytes: &[u8] = bytemuck::cast_slice(values);
            if let Ok(mut view) = buffer.get_mapped_range_mut(..) {
                view.slice(..bytes.len()).copy_from_slice(bytes);
            }
            buffer.unmap();
            buffer
        })
    }

    /// The first `count` values of a buffer. Waits for the work that writes it.
    pub(crate) fn download<T: Pod>(&self, buffer: &wgpu::Buffer, count: usize) -> Result<Vec<T>, GpuError> {
        let bytes = (count * size_of::<T>()) as u64;
        if count == 0 {
            return Ok(Vec::new());
        }
        let size = bytes.next_multiple_of(wgpu::COPY_BUFFER_ALIGNMENT);
        let staging = self.staging(size)?;
        self.submit(|encoder| encoder.copy_buffer_to_buffer(buffer, 0, &staging, 0, size))?;
        self.mapped(&staging, |mapped| bytemuck::pod_collect_to_vec(&mapped[..bytes as usize]))
    }

    /// A buffer that the host can read.
    pub(crate) fn staging(&self, size: u64) -> Result<wgpu::Buffer, GpuError> {
        self.attempt(|| {
            self.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("read-back"),
                size,
                usage: BufferUsages::MAP_READ | BufferUsages::COPY_DST,
                mapped_at_creation: false,
            })
        })
    }

    /// Waits for all work, then passes the bytes of a staging buffer to `read`. The buffer can be used again
    /// afterwards.
    pub(crate) fn mapped<T>(
        &self,
        staging: &wgpu::Buffer,
        read: impl FnOnce(&[u8]) -> T,
    ) -> Result<T, GpuError> {
        let (sender, receiver) = mpsc::channel();
        let result = self.attempt(|| {
            staging.map_async(wgpu::MapMode::Read, .., move |mapped| {
                let _ = sender.send(mapped); // the receiver may be gone; then the result is not needed
            });
            // Another thread that polls may be the one to call back, a moment after our own poll returns.
            loop {
                self.device.poll(wgpu::PollType::wait_indefinitely()).ok()?;
                match receiver.recv_timeout(Duration::from_millis(10)) {
                    Ok(mapped) => break mapped.ok()?,
                    Err(RecvTimeoutError::Timeout) if self.lost.get().is_none() => {}
                    Err(_) => return None,
                }
            }
            let result = read(&staging.get_mapped_range(..).ok()?);
            staging.unmap();
            Some(result)
        })?;
        let gone = || "a buffer could not be read back".to_owned();
        result.ok_or_else(|| GpuError::Lost(self.lost.get().cloned().unwrap_or_else(gone)))
    }

    /// The bytes of `count` values of `T`, which must fit one binding of a shader.
    pub(crate) fn checked_size<T>(&self, what: &'static str, count: usize) -> Result<u64, GpuError> {
        let bytes = (count as u64).saturating_mul(size_of::<T>() as u64);
        let limit = self.limits.max_storage_buffer_binding_size.min(self.limits.max_buffer_size);
        if bytes > limit {
            let remedy = "use the processor's method, or a smaller mesh";
            return Err(GpuError::TooLarge { what, bytes, limit, remedy });
        }
        Ok(bytes.max(4).next_multiple_of(wgpu::COPY_BUFFER_ALIGNMENT))
    }
}
