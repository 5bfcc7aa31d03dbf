//! The shortest way from words to a backend and back.

use backend_api::{Backend, Binding, BufferDesc, BufferId, Items, Kernel, Ticket};
use hashcache_core::hash::pcg;

/// What buffers hold before a test writes to them, so that a zero must have been written.
pub const POISON: u32 = 0xa5a5_a5a5;

/// Calls of a backend that must succeed.
pub struct Host<'b, B>(
    /// The backend under test.
    pub &'b mut B,
);

impl<B: Backend> Host<'_, B> {
    /// A buffer that holds `words`.
    pub fn buffer(&mut self, words: &[u32]) -> BufferId {
        let desc = BufferDesc { name: "conformance", size: 4 * words.len() as u64 };
        let buffer = self.0.create(&desc).expect("create");
        self.0.write(buffer, 0, bytemuck::cast_slice(words)).expect("write");
        buffer
    }

    /// A buffer of poison.
    pub fn poison(&mut self, words: usize) -> BufferId {
        self.buffer(&vec![POISON; words])
    }

    /// The first `words` words of a buffer.
    pub fn words(&mut self, buffer: BufferId, words: usize) -> Vec<u32> {
        let ticket = self.0.read(buffer, 0, 4 * words as u64).expect("read");
        self.redeem(ticket)
    }

    /// The words behind a ticket.
    pub fn redeem(&mut self, ticket: Ticket) -> Vec<u32> {
        let bytes = self.0.redeem(ticket, true).expect("redeem").expect("redeem waits");
        bytemuck::pod_collect_to_vec(&bytes)
    }

    /// Records a dispatch over whole buffers.
    pub fn record(&mut self, kernel: &'static Kernel, params: &[u32], bindings: &[(BufferId, usize)], items: Items) {
        let bindings: Vec<_> = bindings.iter().map(|&(buffer, words)| bind(buffer, words)).collect();
        self.0.dispatch(kernel, bytemuck::cast_slice(params), &bindings, items).expect("dispatch");
    }

    /// Records a dispatch over whole buffers and runs it.
    pub fn run(&mut self, kernel: &'static Kernel, params: &[u32], bindings: &[(BufferId, usize)], items: u32) {
        self.record(kernel, params, bindings, Items::Count(items));
        self.submit();
    }

    /// Runs what was recorded.
    pub fn submit(&mut self) {
        self.0.submit().expect("submit");
    }
}

/// The first `words` words of a buffer as a binding.
pub fn bind(buffer: BufferId, words: usize) -> Binding {
    Binding { buffer, offset: 0, size: 4 * words as u64 }
}

/// Words that look random, the same in every run.
pub fn noise(seed: u32, words: usize) -> Vec<u32> {
    (0..words as u32).map(|i| pcg(seed.wrapping_mul(0x9e37_79b9) ^ pcg(i))).collect()
}
