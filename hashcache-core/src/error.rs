//! What a constructor finds wrong with its arguments.

use core::fmt;

/// Why a parameter was refused. Numbers, not strings: `name` is the parameter's name in the code.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum ParamError {
    /// NaN or infinite.
    NotFinite {
        /// The parameter.
        name: &'static str,
    },
    /// Outside the closed range `min..=max`.
    OutOfRange {
        /// The parameter.
        name: &'static str,
        /// What was given.
        value: f64,
        /// Smallest accepted value.
        min: f64,
        /// Largest accepted value.
        max: f64,
    },
    /// Not a power of two.
    NotPowerOfTwo {
        /// The parameter.
        name: &'static str,
        /// What was given.
        value: u64,
    },
    /// Borrowed storage that is too short.
    TooShort {
        /// The parameter.
        name: &'static str,
        /// Elements needed.
        needed: u64,
        /// Elements given.
        found: u64,
    },
}

impl ParamError {
    /// Checks that `value` is finite and inside `min..=max`.
    ///
    /// # Errors
    /// [`ParamError::NotFinite`], [`ParamError::OutOfRange`].
    ///
    /// ```
    /// # use hashcache_core::error::ParamError;
    /// assert!(ParamError::check_range("jitter", 0.5, 0.0, 1.0).is_ok());
    /// assert!(ParamError::check_range("jitter", f64::NAN, 0.0, 1.0).is_err());
    /// ```
    pub fn check_range(name: &'static str, value: f64, min: f64, max: f64) -> Result<(), Self> {
        if !value.is_finite() {
            return Err(Self::NotFinite { name });
        }
        if value < min || value > max {
            return Err(Self::OutOfRange { name, value, min, max });
        }
        Ok(())
    }
}

impl fmt::Display for ParamError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::NotFinite { name } => write!(f, "{name}: not a finite number"),
            Self::OutOfRange { name, value, min, max } => write!(f, "{name}: {value} is outside {min}..={max}"),
            Self::NotPowerOfTwo { name, value } => write!(f, "{name}: {value} is not a power of two"),
            Self::TooShort { name, needed, found } => {
                write!(f, "{name}: {found} elements given, {needed} are needed")
            }
        }
    }
}

impl core::error::Error for ParamError {}
