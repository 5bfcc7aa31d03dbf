//! Results that must be right.

/// The first result that was wrong.
#[derive(Default)]
pub struct Checks {
    wrong: Option<&'static str>,
}

impl Checks {
    /// Notes a result: `right`, or the name of what was called.
    pub fn that(&mut self, name: &'static str, right: bool) {
        if !right && self.wrong.is_none() {
            self.wrong = Some(name);
        }
    }

    /// The name of the first wrong result.
    pub const fn first_wrong(&self) -> Option<&'static str> {
        self.wrong
    }
}
