//! From dispatches to submissions: collected while they fit into the governor's plan, timed, and learnt from.

use crate::context::{Buffer, Context, Kernel, MAX_PARAMS};
use crate::governor::{Governor, Work};
use lightcuts_render::device::DeviceFault;
use std::time::{Duration, Instant};

/// Dispatches of one submission at most.
const MAX_PENDING: usize = 64;

/// Where a dispatch finds its buffers: by their name, the parts of split ones in order.
pub(crate) type Find<'a> = &'a dyn Fn(&str) -> &'a [Buffer];

/// Collects dispatches and submits them.
pub(crate) struct Dispatcher {
    pub(crate) governor: Governor,
    encoder: Option<wgpu::CommandEncoder>,
    pending: Vec<Pending>,
    expected_s: f64,
    /// Parameters of the pending dispatches, and where the device finds them.
    params: Vec<u8>,
    params_buffer: Buffer,
    clock: Option<Clock>,
    began: Option<Instant>,
    staging: Option<Buffer>,
}

struct Pending {
    work: Work,
    units: f64,
    expected_s: f64,
}

/// Timestamps before and after each dispatch.
struct Clock {
    queries: wgpu::QuerySet,
    resolved: Buffer,
    readable: Buffer,
    seconds_per_tick: f64,
}

impl Dispatcher {
    pub(crate) fn new(context: &Context, budget: Duration) -> Result<Self, DeviceFault> {
        let usage = wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST;
        Ok(Self {
            governor: Governor::new(budget),
            encoder: None,
            pending: Vec::new(),
            expected_s: 0.0,
            params: Vec::new(),
            params_buffer: context.allocate_for("params", MAX_PARAMS * MAX_PENDING as u64, usage)?,
            clock: context.timestamp_period.map(|period| Clock::new(context, period)).transpose()?,
            began: None,
            staging: None,
        })
    }

    /// Adds a dispatch of `items` invocations, which take `units` units of work of its stage.
    pub(crate) fn dispatch<P: bytemuck::NoUninit>(
        &mut self,
        context: &Context,
        kernel: &Kernel,
        params: &P,
        find: Find<'_>,
        items: u32,
        units: f64,
    ) -> Result<(), DeviceFault> {
        if items == 0 {
            return Ok(());
        }
        let work = self.governor.work(kernel.entry);
        let expected_s = self.governor.expected(work, units);
        let is_full = self.expected_s + expected_s > self.governor.planned() || self.pending.len() == MAX_PENDING;
        if is_full && !self.pending.is_empty() {
            self.flush(context)?;
        }
        let group = self.bind(context, kernel, find);
        let offset = self.push_params(bytemuck::bytes_of(params));
        let number = self.pending.len() as u32;
        let encoder = Self::encoder(&mut self.encoder, context);
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: Some(kernel.entry),
            timestamp_writes: self.clock.as_ref().map(|clock| wgpu::ComputePassTimestampWrites {
                query_set: &clock.queries,
                beginning_of_pass_write_index: Some(2 * number),
                end_of_pass_write_index: Some(2 * number + 1),
            }),
        });
        pass.set_pipeline(&kernel.pipeline);
        pass.set_bind_group(0, &group, &[offset]);
        pass.dispatch_workgroups(items.div_ceil(kernel.program.workgroup), 1, 1);
        drop(pass);
        self.pending.push(Pending { work, units, expected_s });
        self.expected_s += expected_s;
        Ok(())
    }

    /// Runs a program with nothing to do, before the pending dispatches. Some drivers compile a program for their
    /// processor when it first runs: that is no work of a submission, and must not count as such.
    pub(crate) fn warm_up(&self, context: &Context, kernel: &Kernel, find: Find<'_>) -> Result<(), DeviceFault> {
        let group = self.bind(context, kernel, find);
        let mut encoder = context.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
        pass.set_pipeline(&kernel.pipeline);
        pass.set_bind_group(0, &group, &[0]);
        pass.dispatch_workgroups(1, 1, 1);
        drop(pass);
        // Every program takes a count, and does nothing where that is 0.
        context.queue.write_buffer(&self.params_buffer.raw, 0, &[0; MAX_PARAMS as usize]);
        context.submit(encoder.finish())
    }

    /// Fills a buffer with zeros, after the pending dispatches.
    pub(crate) fn clear(&mut self, context: &Context, buffer: &Buffer) {
        Self::encoder(&mut self.encoder, context).clear_buffer(&buffer.raw, 0, None);
    }

    /// Does what is pending and returns the first bytes of some buffers.
    pub(crate) fn read(&mut self, context: &Context, wanted: &[(&Buffer, u64)]) -> Result<Vec<Vec<u8>>, DeviceFault> {
        let total: u64 = wanted.iter().map(|(_, size)| size).sum();
        if self.staging.as_ref().is_none_or(|staging| staging.raw.size() < total) {
            let usage = wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST;
            self.staging = None;
            self.staging = Some(context.allocate_for("staging", total.next_power_of_two().max(1 << 16), usage)?);
        }
        let Some(staging) = &self.staging else { return Ok(Vec::new()) };
        let raw = staging.raw.clone();
        let encoder = Self::encoder(&mut self.encoder, context);
        let mut offset = 0;
        for (buffer, size) in wanted.iter().filter(|(_, size)| *size > 0) {
            encoder.copy_buffer_to_buffer(&buffer.raw, 0, &raw, offset, *size);
            offset += size;
        }
        self.flush(context)?;
        let bytes = context.map(&raw, total)?;
        let mut start = 0;
        Ok(wanted
            .iter()
            .map(|&(_, size)| {
                start += size as usize;
                bytes[start - size as usize..start].to_vec()
            })
            .collect())
    }

    /// Submits what is pending, waits for it, and learns from it.
    pub(crate) fn flush(&mut self, context: &Context) -> Result<(), DeviceFault> {
        let Some(mut encoder) = self.encoder.take() else { return Ok(()) };
        let count = self.pending.len();
        if let Some(clock) = self.clock.as_ref().filter(|_| count > 0) {
            clock.resolve(&mut encoder, count);
        }
        if !self.params.is_empty() {
            context.queue.write_buffer(&self.params_buffer.raw, 0, &self.params);
        }
        let start = Instant::now();
        let began_s = start.duration_since(*self.began.get_or_insert(start)).as_secs_f64();
        context.submit(encoder.finish())?;
        let mut seconds = start.elapsed().as_secs_f64();
        let pending = std::mem::take(&mut self.pending);
        let expected_s = std::mem::take(&mut self.expected_s);
        self.params.clear();
        if count == 0 {
            return Ok(());
        }
        let timed = match &self.clock {
            Some(clock) => clock.read(context, count)?,
            None => None,
        };
        if let Some((of_all, _)) = &timed {
            seconds = *of_all;
        }
        for (number, Pending { work, units, expected_s: part }) in pending.into_iter().enumerate() {
            // Without timestamps the whole is shared out in proportion to what was expected.
            let of_one =
                timed.as_ref().map_or(seconds * part / expected_s.max(f64::MIN_POSITIVE), |(_, of)| of[number]);
            self.governor.learn(work, units, of_one);
        }
        self.governor.finish(began_s, seconds);
        Ok(())
    }

    fn encoder<'e>(slot: &'e mut Option<wgpu::CommandEncoder>, context: &Context) -> &'e mut wgpu::CommandEncoder {
        slot.get_or_insert_with(|| context.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default()))
    }

    fn bind(&self, context: &Context, kernel: &Kernel, find: Find<'_>) -> wgpu::BindGroup {
        let params =
            wgpu::BufferBinding { buffer: &self.params_buffer.raw, offset: 0, size: wgpu::BufferSize::new(MAX_PARAMS) };
        let buffers = kernel.program.bindings().flat_map(|binding| find(binding.name));
        let resources = std::iter::once(wgpu::BindingResource::Buffer(params))
            .chain(buffers.map(|buffer| buffer.raw.as_entire_binding()));
        let entries: Vec<_> =
            resources.zip(0..).map(|(resource, binding)| wgpu::BindGroupEntry { binding, resource }).collect();
        context.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some(kernel.entry),
            layout: &kernel.layout,
            entries: &entries,
        })
    }

    /// Keeps parameters until the submission; returns where they will be.
    fn push_params(&mut self, params: &[u8]) -> u32 {
        let offset = self.params.len();
        self.params.extend_from_slice(params);
        self.params.resize(offset + MAX_PARAMS as usize, 0);
        offset as u32
    }
}

impl Clock {
    fn new(context: &Context, period_ns: f32) -> Result<Self, DeviceFault> {
        let count = 2 * MAX_PENDING as u32;
        let bytes = u64::from(count) * 8;
        let queries = context.device.create_query_set(&wgpu::QuerySetDescriptor {
            label: Some("timestamps"),
            ty: wgpu::QueryType::Timestamp,
            count,
        });
        let resolve = wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC;
        let read = wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST;
        Ok(Self {
            queries,
            resolved: context.allocate_for("timestamps", bytes, resolve)?,
            readable: context.allocate_for("timestamps to be read", bytes, read)?,
            seconds_per_tick: f64::from(period_ns) * 1e-9,
        })
    }

    fn resolve(&self, encoder: &mut wgpu::CommandEncoder, count: usize) {
        let bytes = 16 * count as u64;
        encoder.resolve_query_set(&self.queries, 0..2 * count as u32, &self.resolved.raw, 0);
        encoder.copy_buffer_to_buffer(&self.resolved.raw, 0, &self.readable.raw, 0, bytes);
    }

    /// Seconds of the whole submission and of each dispatch; `None` if the device's clock makes no sense.
    fn read(&self, context: &Context, count: usize) -> Result<Option<(f64, Vec<f64>)>, DeviceFault> {
        let bytes = context.map(&self.readable.raw, 16 * count as u64)?;
        let ticks: Vec<u64> = bytes
            .chunks_exact(8)
            .map(|word| u64::from_le_bytes(word.try_into().expect("chunks of eight bytes")))
            .collect();
        let is_sane = ticks.iter().all(|&tick| tick > 0) && ticks.is_sorted();
        let seconds = |from: u64, to: u64| (to - from) as f64 * self.seconds_per_tick;
        Ok(is_sane.then(|| {
            let parts = ticks.chunks_exact(2).map(|pair| seconds(pair[0], pair[1])).collect();
            (seconds(ticks[0], ticks[ticks.len() - 1]), parts)
        }))
    }
}
