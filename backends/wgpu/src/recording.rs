//! What was dispatched and not yet submitted, and how it becomes commands.

use bytemuck::{Pod, Zeroable};
use wgpu::{
    BindGroup, BindGroupDescriptor, BindGroupEntry, BindingResource, Buffer, BufferBinding, BufferDescriptor,
    BufferUsages, CommandBuffer, CommandEncoderDescriptor, ComputePassDescriptor, Device, Queue,
};

use crate::pipeline::{LAUNCH_BINDING, PARAMS_BINDING, Pipeline, STATUS_BINDING};

/// Bindings start at multiples of this many bytes.
const ALIGNMENT: u64 = backend_api::check::OFFSET_ALIGNMENT;

/// Workgroups in one dimension on every device.
const MAX_GROUPS: u32 = 65_535;

/// A range of a buffer on the device; holding it keeps the buffer alive.
#[derive(Clone, Debug)]
pub(crate) struct Range {
    pub(crate) buffer: Buffer,
    pub(crate) offset: u64,
    pub(crate) size: u64,
}

impl Range {
    fn binding(&self) -> BindingResource<'_> {
        BindingResource::Buffer(BufferBinding {
            buffer: &self.buffer,
            offset: self.offset,
            size: wgpu::BufferSize::new(self.size),
        })
    }
}

/// How many items a step has.
pub(crate) enum Count {
    /// Known when it was recorded.
    Known(u32),
    /// A word of a buffer, at most `max`; `counter` reads it.
    Word { buffer: Buffer, index: u32, max: u32, counter: Pipeline },
}

/// One launch to come.
pub(crate) struct Step {
    pub(crate) name: &'static str,
    pub(crate) pipeline: Pipeline,
    pub(crate) ranges: Vec<Range>,
    pub(crate) params: Vec<u8>,
    pub(crate) count: Count,
    /// Whether it is a kernel of the caller, whose status the caller hears of.
    pub(crate) listed: bool,
}

/// `HcLaunch` of `launch.wgsl`.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct LaunchInfo {
    count: u32,
    status: u32,
    workgroup_size: u32,
    max_count: u32,
    source_word: u32,
    groups: [u32; 3],
}

/// Byte offset of the workgroup counts in [`LaunchInfo`], where an indirect dispatch reads them.
const GROUPS_OFFSET: u64 = std::mem::offset_of!(LaunchInfo, groups) as u64;

/// Launch infos and parameter blocks of one submission, on the device. Grows; writes to it are ordered between
/// submissions, so one buffer serves all.
#[derive(Default)]
pub(crate) struct Arena {
    buffer: Option<Buffer>,
}

impl Arena {
    fn at_least(&mut self, device: &Device, size: u64) -> &Buffer {
        let fits = self.buffer.as_ref().is_some_and(|buffer| buffer.size() >= size);
        if !fits {
            self.buffer = None;
        }
        self.buffer.get_or_insert_with(|| {
            device.create_buffer(&BufferDescriptor {
                label: Some("hashcache launches"),
                size: size.next_power_of_two(),
                usage: BufferUsages::UNIFORM | BufferUsages::STORAGE | BufferUsages::INDIRECT | BufferUsages::COPY_DST,
                mapped_at_creation: false,
            })
        })
    }
}

/// Writes what `steps` need and encodes them, in order. The status word of step `k` is `first_status + k`.
pub(crate) fn encode(
    device: &Device,
    queue: &Queue,
    arena: &mut Arena,
    steps: &[Step],
    status: &Buffer,
    first_status: u32,
) -> CommandBuffer {
    let (bytes, offsets) = launches(steps, first_status);
    let arena = arena.at_least(device, bytes.len() as u64);
    queue.write_buffer(arena, 0, &bytes);
    let mut encoder = device.create_command_encoder(&CommandEncoderDescriptor { label: Some("hashcache") });
    let mut pass =
        encoder.begin_compute_pass(&ComputePassDescriptor { label: Some("hashcache"), ..Default::default() });
    for (step, &offset) in steps.iter().zip(&offsets) {
        if let Count::Known(0) = step.count {
            continue;
        }
        if let Count::Word { buffer, index, counter, .. } = &step.count {
            pass.set_pipeline(&counter.compute);
            pass.set_bind_group(0, &count_group(device, counter, buffer, *index, arena, offset, status), &[]);
            pass.dispatch_workgroups(1, 1, 1);
        }
        pass.set_pipeline(&step.pipeline.compute);
        pass.set_bind_group(0, &step_group(device, step, arena, offset, status), &[]);
        match step.count {
            Count::Known(count) => {
                let [x, y, z] = fold(count, step.pipeline.workgroup_size);
                pass.dispatch_workgroups(x, y, z);
            }
            Count::Word { .. } => pass.dispatch_workgroups_indirect(arena, offset + GROUPS_OFFSET),
        }
    }
    drop(pass);
    encoder.finish()
}

/// Launch infos and parameter blocks one after the other, each aligned; and where each info starts.
fn launches(steps: &[Step], first_status: u32) -> (Vec<u8>, Vec<u64>) {
    let mut bytes = Vec::new();
    let mut offsets = Vec::with_capacity(steps.len());
    for (step, status) in steps.iter().zip(first_status..) {
        offsets.push(bytes.len() as u64);
        let workgroup_size = step.pipeline.workgroup_size;
        let (count, max_count, source_word) = match step.count {
            Count::Known(count) => (count, count, 0),
            Count::Word { index, max, .. } => (0, max, index % (ALIGNMENT as u32 / 4)),
        };
        let groups = fold(count, workgroup_size);
        let info = LaunchInfo { count, status, workgroup_size, max_count, source_word, groups };
        for block in [bytemuck::bytes_of(&info), &step.params] {
            bytes.extend_from_slice(block);
            bytes.resize(bytes.len().next_multiple_of(ALIGNMENT as usize), 0);
        }
    }
    (bytes, offsets)
}

/// Whether `count` items fit into one launch: two dimensions of workgroups.
pub(crate) fn fits(count: u32, workgroup_size: u32) -> bool {
    count.div_ceil(workgroup_size) <= MAX_GROUPS * MAX_GROUPS
}

/// Workgroups for `count` items, in rows of at most [`MAX_GROUPS`].
fn fold(count: u32, workgroup_size: u32) -> [u32; 3] {
    if count == 0 {
        return [0; 3];
    }
    let groups = count.div_ceil(workgroup_size);
    let x = groups.min(MAX_GROUPS);
    [x, groups.div_ceil(x), 1]
}

fn step_group(device: &Device, step: &Step, arena: &Buffer, offset: u64, status: &Buffer) -> BindGroup {
    let of_arena = |offset, size: usize| {
        BindingResource::Buffer(BufferBinding { buffer: arena, offset, size: wgpu::BufferSize::new(size as u64) })
    };
    let storage = step.ranges.iter().zip(0..);
    let mut entries: Vec<_> =
        storage.map(|(range, binding)| BindGroupEntry { binding, resource: range.binding() }).collect();
    let info = of_arena(offset, size_of::<LaunchInfo>());
    entries.push(BindGroupEntry { binding: LAUNCH_BINDING, resource: info });
    if !step.params.is_empty() {
        let params = of_arena(offset + ALIGNMENT, step.params.len());
        entries.push(BindGroupEntry { binding: PARAMS_BINDING, resource: params });
    }
    entries.push(BindGroupEntry { binding: STATUS_BINDING, resource: status.as_entire_binding() });
    device.create_bind_group(&BindGroupDescriptor {
        label: Some(step.name),
        layout: &step.pipeline.layout,
        entries: &entries,
    })
}

fn count_group(
    device: &Device,
    counter: &Pipeline,
    source: &Buffer,
    index: u32,
    arena: &Buffer,
    offset: u64,
    status: &Buffer,
) -> BindGroup {
    let window = u64::from(index) * 4 / ALIGNMENT * ALIGNMENT;
    let size = wgpu::BufferSize::new(ALIGNMENT.min(source.size() - window));
    let source = BindingResource::Buffer(BufferBinding { buffer: source, offset: window, size });
    let size = wgpu::BufferSize::new(size_of::<LaunchInfo>() as u64);
    let target = BindingResource::Buffer(BufferBinding { buffer: arena, offset, size });
    device.create_bind_group(&BindGroupDescriptor {
        label: Some("backend.count"),
        layout: &counter.layout,
        entries: &[
            BindGroupEntry { binding: 0, resource: source },
            BindGroupEntry { binding: 1, resource: target },
            BindGroupEntry { binding: 2, resource: status.as_entire_binding() },
        ],
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn folding_covers_every_count() {
        for workgroup_size in [2, 64, 256] {
            for count in [0, 1, 63, 64, 65, 65_535 * 64, 65_535 * 64 + 1, 1 << 31, u32::MAX] {
                let [x, y, z] = fold(count, workgroup_size).map(u64::from);
                assert!(x * y * z * u64::from(workgroup_size) >= u64::from(count), "{count} {workgroup_size}");
                assert!(x <= 65_535 && y <= 65_535);
                // The first item of the last row has an index that fits, see `hc_item`.
                assert!(u32::try_from(y.saturating_sub(1) * x * u64::from(workgroup_size)).is_ok());
            }
        }
    }
}
