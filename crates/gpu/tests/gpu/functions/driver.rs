//! The adapter, and a shader run on it.

use crate::functions::compare::CASES;
use crate::twins::BUFFERS;
use lightcuts_gpu::{DeviceChoice, adapters, choose};
use wgpu::util::DeviceExt as _;

/// An open device.
pub(crate) struct Driver {
    device: wgpu::Device,
    queue: wgpu::Queue,
    /// Whether it computes as the processor does: each operation rounded by itself.
    pub(crate) is_software: bool,
    pub(crate) name: String,
}

impl Driver {
    /// The adapter that `--device gpu` takes; the same drivers in the same order.
    pub(crate) fn open() -> Self {
        let place = choose(&DeviceChoice::Gpu, &adapters()).expect("there is an adapter").expect("a GPU is no CPU");
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor {
            backends: wgpu::Backends::VULKAN | wgpu::Backends::METAL | wgpu::Backends::DX12,
            flags: wgpu::InstanceFlags::empty(),
            ..wgpu::InstanceDescriptor::new_without_display_handle()
        });
        let mut all = pollster::block_on(instance.enumerate_adapters(wgpu::Backends::all()));
        all.sort_by_key(|adapter| match adapter.get_info().device_type {
            wgpu::DeviceType::DiscreteGpu => 0,
            wgpu::DeviceType::IntegratedGpu => 1,
            wgpu::DeviceType::VirtualGpu => 2,
            wgpu::DeviceType::Other => 3,
            wgpu::DeviceType::Cpu => 4,
        });
        let (adapter, info) = (&all[place], all[place].get_info());
        let descriptor =
            wgpu::DeviceDescriptor { required_limits: adapter.limits(), ..wgpu::DeviceDescriptor::default() };
        let (device, queue) = pollster::block_on(adapter.request_device(&descriptor)).expect("the adapter opens");
        Self { device, queue, is_software: info.device_type == wgpu::DeviceType::Cpu, name: info.name }
    }

    fn buffer(&self, contents: &[u8]) -> wgpu::Buffer {
        let usage = wgpu::BufferUsages::STORAGE;
        self.device.create_buffer_init(&wgpu::util::BufferInitDescriptor { label: None, contents, usage })
    }

    /// Runs a shader over all cases. `tables` are the contents of [`BUFFERS`]; the result has `size` words.
    pub(crate) fn run(&self, wgsl: &str, tables: &[&[u8]; BUFFERS.len()], inputs: &[u32], size: usize) -> Vec<u32> {
        let outputs = self.device.create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size: size as u64 * 4,
            usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC,
            mapped_at_creation: false,
        });
        let mut buffers: Vec<_> = tables.iter().map(|content| self.buffer(content)).collect();
        buffers.extend([self.buffer(bytemuck::cast_slice(inputs)), outputs.clone()]);
        let layout = self.layout(buffers.len() as u32);
        let mut encoder = self.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
        pass.set_pipeline(&self.pipeline(wgsl, &layout));
        pass.set_bind_group(0, &self.group(&layout, &buffers), &[]);
        pass.dispatch_workgroups(CASES / 64, 1, 1);
        drop(pass);
        self.download(encoder, &outputs)
    }

    fn group(&self, layout: &wgpu::BindGroupLayout, buffers: &[wgpu::Buffer]) -> wgpu::BindGroup {
        let numbered = buffers.iter().map(wgpu::Buffer::as_entire_binding).zip(0..);
        let entries: Vec<_> = numbered.map(|(resource, binding)| wgpu::BindGroupEntry { binding, resource }).collect();
        self.device.create_bind_group(&wgpu::BindGroupDescriptor { label: None, layout, entries: &entries })
    }

    /// Storage buffers only, the last of them written.
    fn layout(&self, count: u32) -> wgpu::BindGroupLayout {
        let entry = |binding: u32| wgpu::BindGroupLayoutEntry {
            binding,
            visibility: wgpu::ShaderStages::COMPUTE,
            ty: wgpu::BindingType::Buffer {
                ty: wgpu::BufferBindingType::Storage { read_only: binding + 1 < count },
                has_dynamic_offset: false,
                min_binding_size: None,
            },
            count: None,
        };
        let entries: Vec<_> = (0..count).map(entry).collect();
        self.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: None, entries: &entries })
    }

    fn pipeline(&self, wgsl: &str, layout: &wgpu::BindGroupLayout) -> wgpu::ComputePipeline {
        let source = wgpu::ShaderSource::Wgsl(wgsl.into());
        let module = self.device.create_shader_module(wgpu::ShaderModuleDescriptor { label: None, source });
        let layout = self.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: None,
            bind_group_layouts: &[Some(layout)],
            immediate_size: 0,
        });
        self.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: None,
            layout: Some(&layout),
            module: &module,
            entry_point: Some("main"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            cache: None,
        })
    }

    /// Submits the commands and reads a buffer.
    fn download(&self, mut encoder: wgpu::CommandEncoder, buffer: &wgpu::Buffer) -> Vec<u32> {
        let staging = self.device.create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size: buffer.size(),
            usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        encoder.copy_buffer_to_buffer(buffer, 0, &staging, 0, buffer.size());
        self.queue.submit([encoder.finish()]);
        staging.slice(..).map_async(wgpu::MapMode::Read, |result| result.expect("a buffer for reading is mapped"));
        self.device.poll(wgpu::PollType::wait_indefinitely()).expect("the device works");
        let view = staging.slice(..).get_mapped_range().expect("the buffer is mapped");
        bytemuck::cast_slice(&view).to_vec()
    }
}
