//! What a file holds beyond what is shown.

use std::collections::HashMap;
use std::fmt;

use crate::error::brief;

/// Something in the file that is shown differently or not at all. Each kind is named once, with its first place.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Warning {
    /// What is there and what is done about it.
    pub what: String,
    /// JSON pointer of the first place.
    pub pointer: String,
    /// At how many places.
    pub count: usize,
}

impl fmt::Display for Warning {
    /// One line: what, the first place, how many.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} (at {}", self.what, self.pointer)?;
        match self.count {
            0 | 1 => f.write_str(")"),
            n => write!(f, " and {} more)", n - 1),
        }
    }
}

/// Warnings in the order in which their kinds were first met.
#[derive(Debug, Default)]
pub(crate) struct Warnings {
    list: Vec<Warning>,
    by_what: HashMap<String, usize>,
}

impl Warnings {
    /// Counts one more place with `what`; the pointer is only made for the first.
    pub fn add(&mut self, what: &str, pointer: impl FnOnce() -> String) {
        self.add_many(what, 1, pointer);
    }

    /// Counts `count` more places with `what`.
    pub fn add_many(&mut self, what: &str, count: usize, pointer: impl FnOnce() -> String) {
        if count == 0 {
            return;
        }
        if let Some(&i) = self.by_what.get(what) {
            self.list[i].count += count;
        } else {
            self.by_what.insert(what.to_owned(), self.list.len());
            self.list.push(Warning { what: brief(what), pointer: brief(&pointer()), count });
        }
    }

    /// Whether this has been said.
    pub fn contains(&self, what: &str) -> bool {
        self.by_what.contains_key(what)
    }

    /// The list.
    pub fn into_vec(self) -> Vec<Warning> {
        self.list
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_kind_is_named_once_with_its_first_place() {
        let mut warnings = Warnings::default();
        warnings.add("a", || "/x/0".into());
        warnings.add("b", || "/y/0".into());
        warnings.add("a", || unreachable!("the first place is kept"));
        warnings.add_many("c", 0, || unreachable!("nothing to name"));
        let list = warnings.into_vec();
        assert_eq!(list.len(), 2);
        assert_eq!(list[0].to_string(), "a (at /x/0 and 1 more)");
        assert_eq!(list[1].to_string(), "b (at /y/0)");
    }
}
