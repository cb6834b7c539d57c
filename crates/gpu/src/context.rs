//! A device of the graphics library with its queue: memory, pipelines, reading back, and what went wrong.

use crate::adapter::{kind, ordered};
use crate::buffers::Split;
use crate::program::Program;
use crate::sabotage::Sabotage;
use lightcuts_render::device::{DeviceFault, DeviceKind};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

/// An open device.
pub(crate) struct Context {
    pub(crate) device: wgpu::Device,
    pub(crate) queue: wgpu::Queue,
    pub(crate) kind: DeviceKind,
    pub(crate) limits: wgpu::Limits,
    /// Nanoseconds of a timestamp's unit, where there are timestamps.
    pub(crate) timestamp_period: Option<f32>,
    condition: Arc<Condition>,
    sabotage: Arc<Sabotage>,
    /// Bytes that were allocated and not freed.
    allocated: Arc<AtomicU64>,
}

/// The first thing that went wrong. The library reports errors to a handler, not to who caused them.
#[derive(Default)]
struct Condition {
    fault: Mutex<Option<DeviceFault>>,
}

impl Condition {
    fn note(&self, fault: DeviceFault) {
        self.fault.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(fault);
    }

    fn check(&self) -> Result<(), DeviceFault> {
        self.fault.lock().unwrap_or_else(PoisonError::into_inner).clone().map_or(Ok(()), Err)
    }
}

/// A buffer; copies are of the handle.
#[derive(Debug, Clone)]
pub(crate) struct Buffer {
    pub(crate) raw: wgpu::Buffer,
    _held: Arc<Held>,
}

/// Bytes that are released with the last handle.
#[derive(Debug)]
struct Held {
    bytes: u64,
    allocated: Arc<AtomicU64>,
}

impl Drop for Held {
    fn drop(&mut self) {
        self.allocated.fetch_sub(self.bytes, Ordering::Relaxed);
    }
}

/// An entry point of a program, compiled.
#[derive(Debug)]
pub(crate) struct Kernel {
    pub(crate) entry: &'static str,
    pub(crate) program: &'static Program,
    pub(crate) pipeline: wgpu::ComputePipeline,
    pub(crate) layout: wgpu::BindGroupLayout,
}

/// Bytes of parameters that a dispatch can have.
pub(crate) const MAX_PARAMS: u64 = 256;

impl Context {
    /// Opens the adapter at a place in the order of [`crate::adapters`]; without `has_clock` it is not asked for
    /// timestamps.
    pub(crate) fn open(place: usize, has_clock: bool, sabotage: &Arc<Sabotage>) -> Result<Self, DeviceFault> {
        let adapter = ordered().get(place).ok_or_else(|| DeviceFault::Lost("the adapter is not there".to_owned()))?;
        let info = adapter.get_info();
        let has_timestamps = has_clock && adapter.features().contains(wgpu::Features::TIMESTAMP_QUERY);
        // All that the adapter offers: only scenes that need it use it.
        let limits = adapter.limits();
        let descriptor = wgpu::DeviceDescriptor {
            label: Some("lightcuts"),
            required_features: if has_timestamps { wgpu::Features::TIMESTAMP_QUERY } else { wgpu::Features::empty() },
            required_limits: limits.clone(),
            ..wgpu::DeviceDescriptor::default()
        };
        let (device, queue) = pollster::block_on(adapter.request_device(&descriptor))
            .map_err(|error| DeviceFault::Failed(format!("`{}` cannot be opened: {error}", info.name)))?;
        let condition = Arc::new(Condition::default());
        let of_errors = Arc::clone(&condition);
        device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| of_errors.note(fault(&error))));
        let of_loss = Arc::clone(&condition);
        device.set_device_lost_callback(move |_, message| of_loss.note(DeviceFault::Lost(reason(message))));
        Ok(Self {
            timestamp_period: has_timestamps.then(|| queue.get_timestamp_period()),
            device,
            queue,
            kind: kind(&info),
            limits,
            condition,
            sabotage: Arc::clone(sabotage),
            allocated: Arc::default(),
        })
    }

    /// Fails if anything went wrong so far.
    pub(crate) fn check(&self) -> Result<(), DeviceFault> {
        self.condition.check()
    }

    /// Bytes that are allocated now.
    pub(crate) fn allocated(&self) -> u64 {
        self.allocated.load(Ordering::Relaxed)
    }

    /// A storage buffer of at least one element of 16 bytes, filled with zeros.
    pub(crate) fn allocate(&self, label: &str, bytes: u64) -> Result<Buffer, DeviceFault> {
        let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC | wgpu::BufferUsages::COPY_DST;
        self.allocate_for(label, bytes.max(16).next_multiple_of(4), usage)
    }

    /// A buffer for given uses.
    pub(crate) fn allocate_for(
        &self,
        label: &str,
        size: u64,
        usage: wgpu::BufferUsages,
    ) -> Result<Buffer, DeviceFault> {
        if self.sabotage.refuses_allocation() {
            return Err(DeviceFault::OutOfMemory(format!("{size} bytes for `{label}` (simulated)")));
        }
        let limit = if usage.contains(wgpu::BufferUsages::STORAGE) {
            self.limits.max_storage_buffer_binding_size.min(self.limits.max_buffer_size)
        } else {
            self.limits.max_buffer_size
        };
        if size > limit {
            return Err(DeviceFault::OutOfMemory(format!("`{label}` has {size} bytes, of which {limit} are possible")));
        }
        let descriptor = wgpu::BufferDescriptor { label: Some(label), size, usage, mapped_at_creation: false };
        let raw = self.device.create_buffer(&descriptor);
        self.check()?;
        self.allocated.fetch_add(size, Ordering::Relaxed);
        let held = Held { bytes: size, allocated: Arc::clone(&self.allocated) };
        Ok(Buffer { raw, _held: Arc::new(held) })
    }

    /// A storage buffer with a content.
    pub(crate) fn upload<T: bytemuck::NoUninit>(&self, label: &str, content: &[T]) -> Result<Buffer, DeviceFault> {
        let bytes: &[u8] = bytemuck::cast_slice(content);
        let buffer = self.allocate(label, bytes.len() as u64)?;
        if !bytes.is_empty() {
            self.queue.write_buffer(&buffer.raw, 0, bytes);
        }
        self.check()?;
        Ok(buffer)
    }

    /// Compiles an entry point of a program; `split` says how the world's buffers are split.
    pub(crate) fn compile(
        &self,
        entry: &'static str,
        program: &'static Program,
        split: impl Fn(&str) -> Split,
    ) -> Result<Kernel, DeviceFault> {
        let text = program.text(&split);
        let parts = |name: &str| split(name).parts;
        let count: u32 = program.bindings().map(|binding| parts(binding.name)).sum();
        if count > self.limits.max_storage_buffers_per_shader_stage {
            let limit = self.limits.max_storage_buffers_per_shader_stage;
            return Err(DeviceFault::OutOfMemory(format!(
                "the scene would take {count} buffers in `{entry}`, of which {limit} are possible"
            )));
        }
        let storage = program.bindings().flat_map(|binding| {
            let ty = wgpu::BufferBindingType::Storage { read_only: !binding.is_written };
            std::iter::repeat_n(ty, parts(binding.name) as usize)
        });
        let entries: Vec<_> = std::iter::once(wgpu::BufferBindingType::Uniform)
            .chain(storage)
            .zip(0..)
            .map(|(ty, binding)| wgpu::BindGroupLayoutEntry {
                binding,
                visibility: wgpu::ShaderStages::COMPUTE,
                ty: wgpu::BindingType::Buffer { ty, has_dynamic_offset: binding == 0, min_binding_size: None },
                count: None,
            })
            .collect();
        let label = Some(entry);
        let layout =
            self.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label, entries: &entries });
        let of_pipeline = self.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label,
            bind_group_layouts: &[Some(&layout)],
            immediate_size: 0,
        });
        let module = self.device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label,
            source: wgpu::ShaderSource::Wgsl(text.wgsl.into()),
        });
        let pipeline = self.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label,
            layout: Some(&of_pipeline),
            module: &module,
            entry_point: label,
            compilation_options: wgpu::PipelineCompilationOptions {
                zero_initialize_workgroup_memory: false,
                ..wgpu::PipelineCompilationOptions::default()
            },
            cache: None,
        });
        self.check()?;
        Ok(Kernel { entry, program, pipeline, layout })
    }

    /// Submits commands and waits until they are done.
    pub(crate) fn submit(&self, commands: wgpu::CommandBuffer) -> Result<(), DeviceFault> {
        if self.sabotage.loses_submission() {
            self.device.destroy();
        }
        self.check()?;
        self.queue.submit([commands]);
        self.wait()
    }

    /// Waits until everything that was submitted is done.
    pub(crate) fn wait(&self) -> Result<(), DeviceFault> {
        let polled = self.device.poll(wgpu::PollType::wait_indefinitely());
        self.check()?;
        polled.map(drop).map_err(|error| DeviceFault::Lost(error.to_string()))
    }

    /// Bytes of a buffer that can be mapped; nothing may be using it.
    pub(crate) fn map(&self, buffer: &wgpu::Buffer, size: u64) -> Result<Vec<u8>, DeviceFault> {
        if size == 0 {
            return Ok(Vec::new());
        }
        let slice = buffer.slice(..size);
        let of_mapping = Arc::clone(&self.condition);
        slice.map_async(wgpu::MapMode::Read, move |result| {
            if let Err(error) = result {
                of_mapping.note(DeviceFault::Lost(error.to_string()));
            }
        });
        self.wait()?;
        let content = match slice.get_mapped_range() {
            Ok(view) => view.to_vec(),
            Err(error) => return Err(DeviceFault::Lost(error.to_string())),
        };
        buffer.unmap();
        Ok(content)
    }
}

/// Drivers need not say why.
fn reason(message: String) -> String {
    if message.trim().is_empty() { "the driver gave no reason".to_owned() } else { message }
}

fn fault(error: &wgpu::Error) -> DeviceFault {
    match error {
        wgpu::Error::OutOfMemory { .. } => DeviceFault::OutOfMemory(error.to_string()),
        // A lost device makes every later call invalid; its own report says more, and comes first.
        _ if error.to_string().contains("lost") => DeviceFault::Lost(error.to_string()),
        _ => DeviceFault::Failed(error.to_string()),
    }
}
