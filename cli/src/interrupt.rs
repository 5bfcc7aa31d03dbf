//! Ctrl-C and other requests to end wait until no file is half written; a render is given up at once.

use std::sync::{Mutex, PoisonError};

/// Held while there is a temporary file or folder.
static WRITING: Mutex<()> = Mutex::new(());

/// Runs `work` to its end even if the program is asked to end meanwhile. Not to be nested.
pub fn uninterrupted<T>(work: impl FnOnce() -> T) -> T {
    let _writing = WRITING.lock().unwrap_or_else(PoisonError::into_inner);
    work()
}

/// From now on signals respect [`uninterrupted`]; then the program ends by the signal, as a shell expects.
#[cfg(unix)]
pub fn install() {
    use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
    // Without a handler the system ends the program on the spot, which costs a temporary file at worst.
    let Ok(mut signals) = signal_hook::iterator::Signals::new([SIGHUP, SIGINT, SIGTERM]) else { return };
    std::thread::spawn(move || {
        for signal in signals.forever() {
            let _none_writes = WRITING.lock().unwrap_or_else(PoisonError::into_inner);
            let _ = signal_hook::low_level::emulate_default_handler(signal);
        }
    });
}

/// Elsewhere the system ends the program on the spot, which costs a temporary file at worst.
#[cfg(not(unix))]
pub fn install() {}
