//! What features cost by measurement, and that measuring leaves nothing behind.

mod common;

use std::collections::HashSet;

use backend_api::{BufferDesc, BufferId, Error};
use common::{Watch, Watched};
use hashcache::{Preview, Settings};

/// Knows the buffers, counts the bytes written and fails at a call.
struct Failing {
    alive: HashSet<BufferId>,
    written: usize,
    /// Calls that may still succeed.
    left: u32,
}

impl Watch for Failing {
    fn call(&mut self) -> Result<(), Error> {
        self.left = self.left.checked_sub(1).ok_or(Error::OutOfMemory { size: 1 })?;
        Ok(())
    }

    fn created(&mut self, buffer: BufferId, _: &BufferDesc) {
        self.alive.insert(buffer);
    }

    fn destroyed(&mut self, buffer: BufferId) {
        assert!(self.alive.remove(&buffer), "given back twice");
    }

    fn written(&mut self, bytes: usize) {
        self.written += bytes;
    }
}

/// A launcher that fails after so many calls.
fn failing(left: u32) -> Watched<Failing> {
    Watched::new(Failing { alive: HashSet::new(), written: 0, left })
}

fn preview(set: &[(&str, &str)]) -> Preview {
    let mut settings = Settings::default();
    for (key, value) in set {
        settings.set(key, value).unwrap();
    }
    Preview::open("builtin:cornell", &settings).unwrap()
}

#[test]
fn buffers_are_given_back_whatever_fails() {
    let preview = preview(&[("max_bounces", "0")]);
    // Four buffers with what they hold, the film, then three calls a run: any of the first runs may fail.
    for left in 0..15 {
        let mut backend = failing(left);
        assert!(preview.measured_plan(&mut backend).is_err(), "{left} calls are not enough");
        assert!(backend.watch.alive.is_empty(), "after {left} calls {} buffers are left", backend.watch.alive.len());
    }
    let mut backend = failing(u32::MAX);
    let measured = preview.measured_plan(&mut backend).unwrap();
    assert!(backend.watch.alive.is_empty() && measured.saved.iter().any(|saving| saving.ns_per_sample.is_some()));
    let calls = u32::MAX - backend.watch.left;
    let once = {
        let mut backend = failing(8);
        preview.measured_plan(&mut backend).unwrap_err();
        backend.watch.written
    };
    // The scene goes up once; a run changes a word.
    assert!(backend.watch.written - once <= 4 * calls as usize, "{} bytes after {once}", backend.watch.written);
}

#[test]
fn what_is_forced_is_not_left_out() {
    let names = |set| preview(set).plan().saved.iter().map(|saving| saving.feature).collect::<Vec<_>>();
    let all = names(&[]);
    let some = names(&[("needs.force", "coat,layers")]);
    let left: Vec<_> = all.iter().copied().filter(|name| !["coat", "layers"].contains(name)).collect();
    assert!(all.len() == left.len() + 2 && some == left, "{some:?} of {all:?}");
    assert_eq!(names(&[("needs.force", "all")]), ["alpha_masks", "second_uv", "check"]);
}

#[test]
fn a_feature_costs_less_than_a_sample() {
    let preview =
        preview(&[("cache", "none"), ("filter", "none"), ("size", "128x128"), ("spp", "16"), ("max_bounces", "2")]);
    let stats = preview.render(&mut |_| ()).unwrap().stats;
    let sample_ns = stats.cpu_s.stages["trace"] * 1e9 / f64::from(128 * 128 * 16);
    let mut backend = preview.backend().unwrap();
    let measured = preview.measured_plan(&mut backend).unwrap();
    for saving in &measured.saved {
        let is_loop = !["layers", "alpha_masks", "second_uv", "check"].contains(&saving.feature);
        assert_eq!(saving.ns_per_sample.is_some(), is_loop, "{saving:?}");
        // Each is a small part of the loop; half a sample also holds what noise a busy machine adds to the fastest run.
        let most = 0.5 * sample_ns;
        assert!(saving.ns_per_sample.is_none_or(|ns| ns.abs() < most), "{saving:?}, a sample takes {sample_ns:.0} ns");
    }
}
