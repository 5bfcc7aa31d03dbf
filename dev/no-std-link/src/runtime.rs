//! What std would have brought: an entry point, a panic handler, and an allocator where one is wanted.
#![expect(unsafe_code, reason = "without std, the entry point and the C library are reached by unsafe declarations")]

use core::ffi::{c_char, c_int, c_void};
use core::panic::PanicInfo;

#[link(name = "c")]
#[link(name = "gcc_s")]
unsafe extern "C" {
    fn abort() -> !;
    fn write(file: c_int, bytes: *const c_void, count: usize) -> isize;
}

fn say(text: &str) {
    // SAFETY: the pointer and the length are those of a living slice; a failed write changes nothing.
    unsafe { write(2, text.as_ptr().cast(), text.len()) };
}

/// Called by the C library's start code.
#[unsafe(no_mangle)]
extern "C" fn main(_arguments: c_int, _values: *const *const c_char) -> c_int {
    match crate::run().first_wrong() {
        None => 0,
        Some(name) => {
            say("wrong: ");
            say(name);
            say("\n");
            1
        }
    }
}

#[panic_handler]
fn panic(_: &PanicInfo<'_>) -> ! {
    say("panicked\n");
    // SAFETY: ends the process, has no conditions.
    unsafe { abort() }
}

/// The prebuilt `core` was compiled to unwind and names this function; nothing calls it when panics abort.
#[unsafe(no_mangle)]
extern "C" fn rust_eh_personality() {}

#[cfg(feature = "alloc")]
mod heap {
    use core::alloc::{GlobalAlloc, Layout};
    use core::cell::UnsafeCell;
    use core::sync::atomic::{AtomicUsize, Ordering::Relaxed};

    /// Enough for the tables and scenes of the checks.
    const SIZE: usize = 4 << 20;

    /// Hands out memory front to back and takes none back.
    #[repr(align(64))]
    struct Bump {
        memory: UnsafeCell<[u8; SIZE]>,
        used: AtomicUsize,
    }

    // SAFETY: a range is handed out once, by the atomic addition that reserves it.
    unsafe impl Sync for Bump {}

    // SAFETY: ranges lie inside `memory`, are aligned as asked for (up to the 64 of the whole), and never overlap.
    unsafe impl GlobalAlloc for Bump {
        unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
            if layout.align() > 64 {
                return core::ptr::null_mut();
            }
            // A whole number of 64 bytes each, so that every range starts aligned.
            let size = layout.size().next_multiple_of(64);
            let start = self.used.fetch_add(size, Relaxed);
            if start.saturating_add(size) > SIZE {
                return core::ptr::null_mut();
            }
            // SAFETY: `start` lies inside.
            unsafe { self.memory.get().cast::<u8>().add(start) }
        }

        unsafe fn dealloc(&self, _: *mut u8, _: Layout) {}
    }

    #[global_allocator]
    static HEAP: Bump = Bump { memory: UnsafeCell::new([0; SIZE]), used: AtomicUsize::new(0) };
}
