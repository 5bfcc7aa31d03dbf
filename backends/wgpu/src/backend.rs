//! The launcher.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use backend_api::{
    Backend, Binding, BufferDesc, BufferId, BufferTable, Error, Items, Kernel, Primitive, Status, Ticket, check,
};
use wgpu::{Buffer, BufferDescriptor, BufferUsages, CommandEncoderDescriptor, Device, Queue};

use crate::open::{self, AdapterChoice};
use crate::pipeline::{Pipelines, Program};
use crate::primitives::Scratch;
use crate::readback::{self, Readbacks};
use crate::recording::{self, Arena, Count, Range, Step};
use crate::scope::{self, Fault};

/// Launches kernels on a GPU.
///
/// Handles of wgpu are shared: the caller may go on using device and queue, and [`WgpuBackend::buffer`] gives the
/// device's buffer behind a handle, to draw or to copy from without a way over the host.
pub struct WgpuBackend {
    pub(crate) device: Device,
    queue: Queue,
    /// Raised when the device is lost, where the device is ours to watch.
    lost: Option<Arc<AtomicBool>>,
    pub(crate) limits: check::Limits,
    pub(crate) buffers: BufferTable<Buffer>,
    pub(crate) pipelines: Pipelines,
    pub(crate) steps: Vec<Step>,
    pub(crate) scratch: Scratch,
    arena: Arena,
    statuses: Statuses,
    readbacks: Readbacks,
    pub(crate) message: String,
}

/// Above this, the words of a binding and one more could not be counted in 32 bits.
const MAX_BINDING: u64 = 1 << 32;

/// Status words of what was submitted since they were asked for last.
#[derive(Default)]
struct Statuses {
    words: Option<Buffer>,
    /// Name of each word's dispatch, and whether the caller hears of it.
    names: Vec<(&'static str, bool)>,
}

impl WgpuBackend {
    /// A backend on the caller's device and queue.
    ///
    /// The device's callbacks are left alone: its loss shows when something is read back. Its
    /// `max_storage_buffers_per_shader_stage` should be 6 or more; 10 once kernels cast rays.
    pub fn new(device: Device, queue: Queue) -> Self {
        Self::with(device, queue, None)
    }

    /// A backend on a device of its own, with WebGPU's default limits (bindings up to 128 MiB) and 10 storage buffers
    /// a shader stage.
    ///
    /// # Errors
    /// [`Error::NoAdapter`] when there is no such adapter, or it has not these limits.
    pub fn open(choice: AdapterChoice) -> Result<Self, Error> {
        let (device, queue, lost) = open::open(choice)?;
        Ok(Self::with(device, queue, Some(lost)))
    }

    fn with(device: Device, queue: Queue, lost: Option<Arc<AtomicBool>>) -> Self {
        let limits = device.limits();
        // Whole words, and not more than one buffer may hold.
        let max_binding_size =
            limits.max_storage_buffer_binding_size.min(limits.max_buffer_size).min(MAX_BINDING) / 4 * 4;
        Self {
            device,
            queue,
            lost,
            limits: check::Limits { max_binding_size, has_geometry: false },
            buffers: BufferTable::new(),
            pipelines: Pipelines::default(),
            steps: Vec::new(),
            scratch: Scratch::default(),
            arena: Arena::default(),
            statuses: Statuses::default(),
            readbacks: Readbacks::default(),
            message: String::new(),
        }
    }

    /// Name of the adapter, as its driver gives it.
    pub fn adapter_name(&self) -> String {
        self.device.adapter_info().name
    }

    /// The device that the backend works on.
    pub const fn device(&self) -> &Device {
        &self.device
    }

    /// The queue that the backend submits to.
    pub const fn queue(&self) -> &Queue {
        &self.queue
    }

    /// The device's buffer behind a handle, or `None` when the handle is dead. Usages: storage, copy source and
    /// destination.
    pub fn buffer(&self, id: BufferId) -> Option<&Buffer> {
        self.buffers.get(id)
    }

    /// What the device said with the last error, for people: the compiler's message with [`Error::Shader`]. Empty when
    /// there was none.
    pub fn message(&self) -> &str {
        &self.message
    }

    /// Makes calls to the device; `size` is what they need in bytes.
    pub(crate) fn catch<T>(&mut self, size: u64, f: impl FnOnce(&mut Self) -> T) -> Result<T, Error> {
        let device = self.device.clone();
        let made = scope::catch(&device, || f(self)).map_err(|fault| self.fault(fault, size));
        self.alive()?;
        made
    }

    fn fault(&mut self, fault: Fault, size: u64) -> Error {
        let (error, message) = fault.into_error(size);
        self.message = message;
        error
    }

    fn alive(&self) -> Result<(), Error> {
        let Some(lost) = &self.lost else { return Ok(()) };
        // The callback that raises the flag is called from here.
        readback::poll(&self.device, None)?;
        if lost.load(Ordering::Relaxed) { Err(Error::DeviceLost) } else { Ok(()) }
    }

    fn size_of(&self, id: BufferId) -> Option<u64> {
        self.buffers.get(id).map(Buffer::size)
    }

    fn range(&self, at: &'static str, binding: &Binding) -> Result<Range, Error> {
        let buffer = self.buffers.get(binding.buffer).ok_or(Error::UnknownBuffer { at })?;
        Ok(Range { buffer: buffer.clone(), offset: binding.offset, size: binding.size })
    }

    fn step(
        &mut self,
        kernel: &'static Kernel,
        params: &[u8],
        bindings: &[Binding],
        items: Items,
    ) -> Result<Step, Error> {
        let program = Program::of(kernel)?;
        if !recording::fits(items.max(), program.workgroup_size) {
            return Err(Error::Unsupported { what: kernel.name });
        }
        let ranges = bindings.iter().map(|binding| self.range(kernel.name, binding)).collect::<Result<_, _>>()?;
        let pipeline = self.pipelines.get(&self.device, &program, &mut self.message)?;
        let count = match items {
            Items::Count(count) => Count::Known(count),
            Items::FromBuffer { buffer, index, max } => {
                let buffer = self.buffers.get(buffer).ok_or(Error::UnknownBuffer { at: kernel.name })?.clone();
                let counter = self.pipelines.count(&self.device, &mut self.message)?;
                Count::Word { buffer, index, max, counter }
            }
        };
        Ok(Step { name: kernel.name, pipeline, ranges, params: params.to_vec(), count, listed: true })
    }

    /// A larger buffer of status words that begins like the old one.
    fn grown(&self, old: Option<&Buffer>, size: u64) -> Buffer {
        let words = create_buffer(&self.device, "hashcache status", size);
        if let Some(old) = old {
            let mut encoder = self.device.create_command_encoder(&CommandEncoderDescriptor::default());
            encoder.copy_buffer_to_buffer(old, 0, &words, 0, old.size());
            self.queue.submit([encoder.finish()]);
        }
        words
    }

    /// The status words with room for `more`, set to "not run" where something is to run; and the first one's index.
    fn status_words(&mut self, steps: &[Step]) -> Result<(Buffer, u32), Error> {
        let first = self.statuses.names.len();
        let size = ((first + steps.len()) as u64 * 4).next_power_of_two().max(1024);
        let initial: Vec<u32> = steps.iter().map(|step| initial_status(&step.count).bits()).collect();
        let old = self.statuses.words.take();
        let words = self.catch(size, |this| {
            let words = match old {
                Some(words) if words.size() >= size => words,
                old => this.grown(old.as_ref(), size),
            };
            this.queue.write_buffer(&words, first as u64 * 4, bytemuck::cast_slice(&initial));
            words
        })?;
        self.statuses.words = Some(words.clone());
        self.statuses.names.extend(steps.iter().map(|step| (step.name, step.listed)));
        Ok((words, first as u32))
    }
}

/// A dispatch without items has nothing to run.
const fn initial_status(count: &Count) -> Status {
    match count {
        Count::Known(0) => Status::OK,
        _ => Status::NOT_RUN,
    }
}

/// A storage buffer that can be copied from and to.
pub(crate) fn create_buffer(device: &Device, name: &'static str, size: u64) -> Buffer {
    device.create_buffer(&BufferDescriptor {
        label: Some(name),
        size,
        usage: BufferUsages::STORAGE | BufferUsages::COPY_SRC | BufferUsages::COPY_DST,
        mapped_at_creation: false,
    })
}

impl Backend for WgpuBackend {
    fn name(&self) -> &'static str {
        "wgpu"
    }

    fn max_binding_size(&self) -> u64 {
        self.limits.max_binding_size
    }

    fn create(&mut self, desc: &BufferDesc) -> Result<BufferId, Error> {
        check::create(desc, self.limits.max_binding_size)?;
        // wgpu clears a buffer before its first use.
        let buffer = self.catch(desc.size, |this| create_buffer(&this.device, desc.name, desc.size))?;
        Ok(self.buffers.insert(buffer))
    }

    fn destroy(&mut self, buffer: BufferId) -> Result<(), Error> {
        // Recorded steps keep what they use alive.
        self.buffers.remove(buffer).map(|_| ()).ok_or(Error::UnknownBuffer { at: "destroy" })
    }

    fn write(&mut self, buffer: BufferId, offset: u64, bytes: &[u8]) -> Result<(), Error> {
        let at = "write";
        check::transfer(at, offset, bytes.len() as u64, self.size_of(buffer))?;
        let buffer = self.buffers.get(buffer).ok_or(Error::UnknownBuffer { at })?.clone();
        if bytes.is_empty() {
            return Ok(());
        }
        self.catch(bytes.len() as u64, |this| this.queue.write_buffer(&buffer, offset, bytes))
    }

    fn dispatch(
        &mut self,
        kernel: &'static Kernel,
        params: &[u8],
        bindings: &[Binding],
        items: Items,
    ) -> Result<(), Error> {
        check::dispatch(kernel, params, bindings, items, &self.limits, |id| self.size_of(id))?;
        let step = self.step(kernel, params, bindings, items)?;
        self.steps.push(step);
        Ok(())
    }

    fn primitive(&mut self, primitive: Primitive) -> Result<(), Error> {
        check::primitive(&primitive, &self.limits, |id| self.size_of(id))?;
        let recorded = self.steps.len();
        let result = self.record_primitive(primitive);
        if result.is_err() {
            self.steps.truncate(recorded);
        }
        result
    }

    fn submit(&mut self) -> Result<(), Error> {
        let steps = std::mem::take(&mut self.steps);
        if steps.is_empty() {
            return self.alive();
        }
        let (words, first) = self.status_words(&steps)?;
        self.catch(0, |this| {
            let commands = recording::encode(&this.device, &this.queue, &mut this.arena, &steps, &words, first);
            this.queue.submit([commands]);
        })
    }

    fn statuses(&mut self) -> Result<Vec<(&'static str, Status)>, Error> {
        let names = std::mem::take(&mut self.statuses.names);
        let Some(words) = self.statuses.words.clone().filter(|_| !names.is_empty()) else {
            return self.alive().map(|()| Vec::new());
        };
        let range = Range { buffer: words, offset: 0, size: names.len() as u64 * 4 };
        let ticket =
            self.readbacks.ask(&self.device, &self.queue, &range).map_err(|fault| self.fault(fault, range.size))?;
        let bytes = self.redeem(ticket, true)?.ok_or(Error::DeviceLost)?;
        let words = bytemuck::pod_collect_to_vec::<u8, u32>(&bytes);
        let statuses = names.iter().zip(words).map(|(&(name, listed), word)| (name, listed, Status::from_bits(word)));
        if let Some((kernel, ..)) = statuses.clone().find(|(.., status)| status.contains(Status::NOT_RUN)) {
            return Err(Error::NotRun { kernel });
        }
        Ok(statuses.filter(|&(_, listed, _)| listed).map(|(name, _, status)| (name, status)).collect())
    }

    fn read(&mut self, buffer: BufferId, offset: u64, size: u64) -> Result<Ticket, Error> {
        let at = "read";
        check::transfer(at, offset, size, self.size_of(buffer))?;
        let range = self.range(at, &Binding { buffer, offset, size })?;
        let ticket = self.readbacks.ask(&self.device, &self.queue, &range);
        self.alive()?;
        ticket.map_err(|fault| self.fault(fault, size))
    }

    fn redeem(&mut self, ticket: Ticket, wait: bool) -> Result<Option<Vec<u8>>, Error> {
        self.readbacks.redeem(&self.device, ticket, wait)
    }
}
