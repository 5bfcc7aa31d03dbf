//! What features cost by measurement, and that measuring leaves nothing behind.

use std::collections::HashSet;

use backend_api::{Backend, Binding, BufferDesc, BufferId, Error, Items, Kernel, Primitive, Status, Ticket};
use backend_cpu::CpuBackend;
use hashcache::{Preview, Settings};
use hashcache_core::geometry::Geometry;
use hashcache_core::stages::CastsRays;

/// A launcher that knows its buffers, counts the bytes written and fails at a call.
struct Watched {
    inner: CpuBackend,
    alive: HashSet<BufferId>,
    written: usize,
    /// Calls that may still succeed.
    left: u32,
}

impl Watched {
    fn new(left: u32) -> Self {
        Self { inner: CpuBackend::serial(), alive: HashSet::new(), written: 0, left }
    }

    fn call(&mut self) -> Result<(), Error> {
        self.left = self.left.checked_sub(1).ok_or(Error::OutOfMemory { size: 1 })?;
        Ok(())
    }
}

impl Backend for Watched {
    fn name(&self) -> &'static str {
        "watched"
    }

    fn max_binding_size(&self) -> u64 {
        self.inner.max_binding_size()
    }

    fn create(&mut self, desc: &BufferDesc) -> Result<BufferId, Error> {
        self.call()?;
        let buffer = self.inner.create(desc)?;
        self.alive.insert(buffer);
        Ok(buffer)
    }

    fn destroy(&mut self, buffer: BufferId) -> Result<(), Error> {
        assert!(self.alive.remove(&buffer), "given back twice");
        self.inner.destroy(buffer)
    }

    fn write(&mut self, buffer: BufferId, offset: u64, bytes: &[u8]) -> Result<(), Error> {
        self.call()?;
        self.written += bytes.len();
        self.inner.write(buffer, offset, bytes)
    }

    fn dispatch(&mut self, kernel: &'static Kernel, params: &[u8], to: &[Binding], items: Items) -> Result<(), Error> {
        self.call()?;
        self.inner.dispatch(kernel, params, to, items)
    }

    fn primitive(&mut self, primitive: Primitive) -> Result<(), Error> {
        self.call()?;
        self.inner.primitive(primitive)
    }

    fn submit(&mut self) -> Result<(), Error> {
        self.call()?;
        self.inner.submit()
    }

    fn statuses(&mut self) -> Result<Vec<(&'static str, Status)>, Error> {
        self.inner.statuses()
    }

    fn read(&mut self, buffer: BufferId, offset: u64, size: u64) -> Result<Ticket, Error> {
        self.inner.read(buffer, offset, size)
    }

    fn redeem(&mut self, ticket: Ticket, wait: bool) -> Result<Option<Vec<u8>>, Error> {
        self.inner.redeem(ticket, wait)
    }
}

impl CastsRays for Watched {
    fn set_geometry(&mut self, geometry: &Geometry<'_>) -> Result<(), Error> {
        self.inner.set_geometry(geometry)
    }
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
        let mut backend = Watched::new(left);
        assert!(preview.measured_plan(&mut backend).is_err(), "{left} calls are not enough");
        assert!(backend.alive.is_empty(), "after {left} calls {} buffers are left", backend.alive.len());
    }
    let mut backend = Watched::new(u32::MAX);
    let measured = preview.measured_plan(&mut backend).unwrap();
    assert!(backend.alive.is_empty() && measured.saved.iter().any(|saving| saving.ns_per_sample.is_some()));
    let calls = u32::MAX - backend.left;
    let once = {
        let mut backend = Watched::new(8);
        preview.measured_plan(&mut backend).unwrap_err();
        backend.written
    };
    // The scene goes up once; a run changes a word.
    assert!(backend.written - once <= 4 * calls as usize, "{} bytes after {once}", backend.written);
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
