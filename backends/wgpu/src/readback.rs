//! Bytes on their way back to the host.

use std::collections::HashMap;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::mpsc::{Receiver, TryRecvError, sync_channel};
use std::time::Duration;

use backend_api::{Error, Ticket};
use wgpu::{
    Buffer, BufferAsyncError, BufferDescriptor, BufferUsages, CommandEncoderDescriptor, Device, MapMode, PollType,
    Queue, SubmissionIndex,
};

use crate::recording::Range;
use crate::scope::{self, Fault};

/// How long a callback may be under way on another thread once its work is done. It takes microseconds; a thread that
/// does not get to it for so long has died, and without an end the caller would wait with it.
const CALLBACK_TIMEOUT: Duration = Duration::from_secs(20);

/// A copy of a range that the host may map once the device has made it.
struct Staged {
    buffer: Buffer,
    mapped: Receiver<Result<(), BufferAsyncError>>,
    submission: SubmissionIndex,
}

/// Tickets given out and not redeemed.
#[derive(Default)]
pub(crate) struct Readbacks {
    staged: HashMap<u64, Option<Staged>>,
    next: u64,
}

impl Readbacks {
    /// Copies the range after all submitted work.
    pub(crate) fn ask(&mut self, device: &Device, queue: &Queue, range: &Range) -> Result<Ticket, Fault> {
        let staged = if range.size == 0 { None } else { Some(stage(device, queue, range)?) };
        let ticket = Ticket(self.next);
        self.next += 1;
        self.staged.insert(ticket.0, staged);
        Ok(ticket)
    }

    /// The bytes, or `None` while the copy is under way.
    pub(crate) fn redeem(&mut self, device: &Device, ticket: Ticket, wait: bool) -> Result<Option<Vec<u8>>, Error> {
        let Some(staged) = self.staged.get(&ticket.0).ok_or(Error::UnknownTicket)? else {
            self.staged.remove(&ticket.0);
            return Ok(Some(Vec::new()));
        };
        let polled = poll(device, wait.then(|| staged.submission.clone()));
        let answer = match staged.mapped.try_recv() {
            Err(TryRecvError::Empty) if !wait && polled.is_ok() => return Ok(None),
            // Another thread that polls the shared device may have taken the callback and not called it yet.
            Err(TryRecvError::Empty) if polled.is_ok() => staged.mapped.recv_timeout(CALLBACK_TIMEOUT).ok(),
            answer => answer.ok(),
        };
        let result = match answer {
            Some(Ok(())) => bytes(&staged.buffer),
            Some(Err(_)) | None => Err(Error::DeviceLost),
        };
        self.staged.remove(&ticket.0);
        result.map(Some)
    }
}

fn stage(device: &Device, queue: &Queue, range: &Range) -> Result<Staged, Fault> {
    scope::catch(device, || {
        let buffer = device.create_buffer(&BufferDescriptor {
            label: Some("hashcache readback"),
            size: range.size,
            usage: BufferUsages::MAP_READ | BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let mut encoder = device.create_command_encoder(&CommandEncoderDescriptor::default());
        encoder.copy_buffer_to_buffer(&range.buffer, range.offset, &buffer, 0, range.size);
        let submission = queue.submit([encoder.finish()]);
        let (sender, mapped) = sync_channel(1);
        buffer.map_async(MapMode::Read, .., move |result| {
            // Nobody listens any more when the backend was dropped.
            let _ = sender.send(result);
        });
        Staged { buffer, mapped, submission }
    })
}

/// Lets the device call back; with a submission, waits until it is done.
pub(crate) fn poll(device: &Device, submission: Option<SubmissionIndex>) -> Result<(), Error> {
    let poll_type = match submission {
        Some(index) => PollType::Wait { submission_index: Some(index), timeout: None },
        None => PollType::Poll,
    };
    // wgpu panics when the device is lost while it waits; its own state is consistent then, as its callers on other
    // threads need it to be.
    match catch_unwind(AssertUnwindSafe(|| device.poll(poll_type))) {
        Ok(Ok(_)) => Ok(()),
        Ok(Err(_)) | Err(_) => Err(Error::DeviceLost),
    }
}

fn bytes(buffer: &Buffer) -> Result<Vec<u8>, Error> {
    let bytes = buffer.slice(..).get_mapped_range().map_err(|_| Error::DeviceLost)?.to_vec();
    buffer.unmap();
    Ok(bytes)
}
