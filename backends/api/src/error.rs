//! What can go wrong between a pipeline and a backend.

use core::fmt;

/// An error of a backend: numbers and names, no strings of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Error {
    /// A handle that names no living buffer.
    UnknownBuffer {
        /// Where: the kernel's or operation's name.
        at: &'static str,
    },
    /// A size that is 0, no multiple of 4, or beyond what the device binds.
    BadSize {
        /// Where: the buffer's or kernel's name.
        at: &'static str,
        /// The size asked for, in bytes.
        size: u64,
        /// The largest size possible there, in bytes.
        limit: u64,
    },
    /// A range that leaves its buffer or is misaligned.
    BadRange {
        /// Where: the kernel's or operation's name.
        at: &'static str,
        /// First byte.
        offset: u64,
        /// Bytes.
        size: u64,
    },
    /// Another number of bindings than the kernel declares.
    BindingCount {
        /// The kernel.
        kernel: &'static str,
        /// Declared.
        expected: u32,
        /// Given.
        found: u32,
    },
    /// A binding that is smaller than the items need.
    BindingTooSmall {
        /// The kernel.
        kernel: &'static str,
        /// The binding's name.
        binding: &'static str,
        /// Bytes needed.
        needed: u64,
        /// Bytes bound.
        found: u64,
    },
    /// One buffer bound twice, at least once to be written.
    Aliased {
        /// The kernel.
        kernel: &'static str,
        /// The binding's name.
        binding: &'static str,
    },
    /// A parameter block of another size than the kernel declares.
    ParamsSize {
        /// The kernel.
        kernel: &'static str,
        /// Declared bytes.
        expected: u32,
        /// Given bytes.
        found: u32,
    },
    /// The kernel casts rays and the backend holds no geometry.
    NoGeometry {
        /// The kernel.
        kernel: &'static str,
    },
    /// The backend cannot run this kernel or primitive.
    Unsupported {
        /// The kernel's or primitive's name.
        what: &'static str,
    },
    /// A dispatch was submitted and no launch of it ran.
    NotRun {
        /// The kernel.
        kernel: &'static str,
    },
    /// The device refused a kernel's shader.
    Shader {
        /// The kernel.
        kernel: &'static str,
    },
    /// No adapter, or it lacks what is needed.
    NoAdapter,
    /// The device was lost or reported an error.
    DeviceLost,
    /// Memory did not suffice.
    OutOfMemory {
        /// The size asked for, in bytes.
        size: u64,
    },
    /// A ticket that was never given out or was redeemed before.
    UnknownTicket,
    /// A pool of so many threads could not be started.
    Threads {
        /// The number asked for.
        wanted: u32,
    },
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::UnknownBuffer { at } => write!(f, "{at}: the handle names no living buffer"),
            Self::BadSize { at, size, limit } => {
                write!(f, "{at}: a size of {size} bytes is not possible (a multiple of 4 from 4 to {limit})")
            }
            Self::BadRange { at, offset, size } => {
                write!(f, "{at}: bytes {offset}..{offset}+{size} leave the buffer or are misaligned")
            }
            Self::BindingCount { kernel, expected, found } => {
                write!(f, "{kernel}: {found} bindings given, {expected} declared")
            }
            Self::BindingTooSmall { kernel, binding, needed, found } => {
                write!(f, "{kernel}: binding {binding} holds {found} bytes, {needed} are needed")
            }
            Self::Aliased { kernel, binding } => {
                write!(f, "{kernel}: binding {binding} is written and overlaps another binding")
            }
            Self::ParamsSize { kernel, expected, found } => {
                write!(f, "{kernel}: a parameter block of {found} bytes given, {expected} declared")
            }
            Self::NoGeometry { kernel } => write!(f, "{kernel}: casts rays, and no geometry was given to the backend"),
            Self::Unsupported { what } => write!(f, "{what}: this backend cannot run it"),
            Self::NotRun { kernel } => write!(f, "{kernel}: was submitted and never ran"),
            Self::Shader { kernel } => write!(f, "{kernel}: the device refused the shader"),
            Self::NoAdapter => f.write_str("no GPU adapter that can run compute shaders was found"),
            Self::DeviceLost => f.write_str("the GPU device was lost"),
            Self::OutOfMemory { size } => write!(f, "not enough memory for {size} bytes"),
            Self::UnknownTicket => f.write_str("the ticket was never given out, or was redeemed before"),
            Self::Threads { wanted } => write!(f, "a pool of {wanted} threads could not be started"),
        }
    }
}

impl core::error::Error for Error {}
