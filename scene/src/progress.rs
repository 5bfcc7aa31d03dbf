//! How far loading is.

/// A step of loading and how much of it is done.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct Progress {
    /// What is being done: `"textures"`, then `"triangles"`.
    pub what: &'static str,
    /// Units done: texels or triangles.
    pub done: u64,
    /// Units in this step, at least `done`.
    pub total: u64,
}

/// Whom progress is told.
pub(crate) type Listener<'a> = &'a (dyn Fn(Progress) + Sync);

/// Tells nobody.
pub(crate) fn nobody(_: Progress) {}
