//! Wrong arguments: the same error everywhere, and nothing changes.

use backend_api::{Access, Backend, Binding, BindingDecl, BufferId, Error, Items, Kernel, Launch, Primitive, Wgsl};

use super::host::{Host, POISON, bind};
use super::toys;

const DEAD: BufferId = BufferId { index: 1 << 20, generation: 3 };

fn no_body(_: &mut Launch<'_>) {}

const fn malformed(bindings: &'static [BindingDecl], params_size: u32, workgroup_size: u32) -> Kernel {
    let wgsl = Some(Wgsl { modules: &[], entry: "none", workgroup_size });
    Kernel { name: "toy.malformed", bindings, params_size, body: no_body, wgsl, casts_rays: false }
}

const NO_STRIDE: &[BindingDecl] = &[BindingDecl { name: "a", access: Access::In, stride: 0 }];
const ODD_STRIDE: &[BindingDecl] = &[BindingDecl { name: "a", access: Access::In, stride: 6 }];
const HALF_STRIDE: &[BindingDecl] = &[BindingDecl { name: "a", access: Access::AtomicU64, stride: 12 }];
const SIX: &[BindingDecl] = &[BindingDecl { name: "a", access: Access::In, stride: 4 }; 6];

static MALFORMED: [Kernel; 8] = [
    malformed(NO_STRIDE, 0, 64),
    malformed(ODD_STRIDE, 0, 64),
    malformed(HALF_STRIDE, 0, 64),
    malformed(SIX, 0, 64),
    malformed(&[], 12, 64),
    malformed(&[], 65_552, 64),
    malformed(&[], 0, 0),
    malformed(&[], 0, 257),
];

/// Kernels that break the rules of their declaration.
pub fn refuses_malformed_kernels<B: Backend>(backend: &mut B) {
    let mut host = Host(backend);
    let buffer = host.poison(48);
    for kernel in &MALFORMED {
        let bindings = vec![bind(buffer, 48); kernel.bindings.len()];
        let params = vec![0; kernel.params_size as usize];
        let refused = host.0.dispatch(kernel, &params, &bindings, Items::Count(1));
        assert_eq!(refused, Err(Error::Unsupported { what: "toy.malformed" }), "{:?}", kernel.bindings);
    }
    nothing_happened(&mut host, buffer, 48);
}

/// Another number of bindings or another parameter block than declared.
pub fn refuses_wrong_counts<B: Backend>(backend: &mut B) {
    let mut host = Host(backend);
    let buffer = host.poison(16);
    for given in [0, 2, 6] {
        let refused = host.0.dispatch(&toys::STEP, &[], &vec![bind(buffer, 16); given], Items::Count(1));
        let found = given as u32;
        assert_eq!(refused, Err(Error::BindingCount { kernel: "toy.step", expected: 1, found }));
    }
    for given in [1, 4, 16] {
        let refused = host.0.dispatch(&toys::STEP, &vec![0; given], &[bind(buffer, 16)], Items::Count(1));
        let found = given as u32;
        assert_eq!(refused, Err(Error::ParamsSize { kernel: "toy.step", expected: 0, found }));
    }
    nothing_happened(&mut host, buffer, 16);
}

/// Handles that name nothing, in every place where a handle stands.
pub fn refuses_dead_buffers<B: Backend>(backend: &mut B) {
    let mut host = Host(backend);
    let buffer = host.poison(16);
    let once_alive = host.poison(16);
    host.0.destroy(once_alive).expect("destroy");
    for dead in [DEAD, once_alive] {
        let refused = host.0.dispatch(&toys::STEP, &[], &[bind(dead, 16)], Items::Count(1));
        assert_eq!(refused, Err(Error::UnknownBuffer { at: "toy.step" }));
        let items = Items::FromBuffer { buffer: dead, index: 0, max: 1 };
        let refused = host.0.dispatch(&toys::STEP, &[], &[bind(buffer, 16)], items);
        assert_eq!(refused, Err(Error::UnknownBuffer { at: "toy.step" }));
        for (primitive, at) in [
            (Primitive::Fill { buffer: dead, word: 0 }, "fill"),
            (Primitive::Scan { input: buffer, output: dead, count: 0 }, "scan"),
            (Primitive::SortPairs { keys: dead, values: buffer, count: 0 }, "sort_pairs"),
            (Primitive::Compact { flags: dead, indices: dead, kept: buffer, count: 0 }, "compact"),
        ] {
            assert_eq!(host.0.primitive(primitive), Err(Error::UnknownBuffer { at }));
        }
    }
    nothing_happened(&mut host, buffer, 16);
}

/// Bindings of 0 bytes, of part of a word, of more than a device binds.
pub fn refuses_bad_sizes<B: Backend>(backend: &mut B) {
    let mut host = Host(backend);
    let buffer = host.poison(16);
    let limit = host.0.max_binding_size();
    for size in [0, 3, 6, u64::MAX, limit + 4] {
        let refused = host.0.dispatch(&toys::STEP, &[], &[Binding { buffer, offset: 0, size }], Items::Count(1));
        assert_eq!(refused, Err(Error::BadSize { at: "toy.step", size, limit }));
    }
    nothing_happened(&mut host, buffer, 16);
}

/// Bindings that leave their buffer or start between the borders of 256 bytes.
pub fn refuses_bad_ranges<B: Backend>(backend: &mut B) {
    let mut host = Host(backend);
    let buffer = host.poison(128);
    for (offset, size) in [(0, 516), (256, 260), (512, 4), (4, 4), (128, 4), (1 << 63, 4), (u64::MAX - 255, 256)] {
        let refused = host.0.dispatch(&toys::STEP, &[], &[Binding { buffer, offset, size }], Items::Count(1));
        assert_eq!(refused, Err(Error::BadRange { at: "toy.step", offset, size }));
    }
    nothing_happened(&mut host, buffer, 128);
}

/// Fewer elements than items, and torn elements.
pub fn refuses_small_bindings<B: Backend>(backend: &mut B) {
    let mut host = Host(backend);
    let (buffer, other) = (host.poison(16), host.poison(16));
    let small = |kernel, binding, needed, found| Err(Error::BindingTooSmall { kernel, binding, needed, found });
    for items in [Items::Count(17), Items::FromBuffer { buffer: other, index: 0, max: 17 }] {
        let refused = host.0.dispatch(&toys::STEP, &[], &[bind(buffer, 16)], items);
        assert_eq!(refused, small("toy.step", "toy_values", 68, 64));
    }
    let refused = host.0.dispatch(&toys::STEP, &[], &[bind(buffer, 16)], Items::Count(u32::MAX));
    assert_eq!(refused, small("toy.step", "toy_values", 4 * u64::from(u32::MAX), 64));
    let refused = host.0.dispatch(&toys::SCALE, &[0; 16], &[bind(other, 16), bind(buffer, 15)], Items::Count(1));
    assert_eq!(refused, small("toy.scale", "toy_output", 64, 60));
    let refused = host.0.dispatch(&toys::SUM, &[], &[bind(other, 16), bind(buffer, 1)], Items::Count(1));
    assert_eq!(refused, small("toy.sum", "toy_sums", 8, 4));
    nothing_happened(&mut host, buffer, 16);
}

/// One buffer twice, at least once to be written, whatever the ranges.
pub fn refuses_aliases<B: Backend>(backend: &mut B) {
    let mut host = Host(backend);
    let buffer = host.poison(128);
    let half = |offset| Binding { buffer, offset, size: 256 };
    for bindings in [[half(0), half(0)], [half(0), half(256)]] {
        let refused = host.0.dispatch(&toys::SCALE, &[0; 16], &bindings, Items::Count(1));
        assert_eq!(refused, Err(Error::Aliased { kernel: "toy.scale", binding: "toy_output" }));
        let refused = host.0.dispatch(&toys::HISTOGRAM, &[], &bindings, Items::Count(1));
        assert_eq!(refused, Err(Error::Aliased { kernel: "toy.histogram", binding: "toy_bins" }));
    }
    nothing_happened(&mut host, buffer, 128);
}

/// Counts that stand outside their buffer, or in one that the kernel writes.
pub fn refuses_bad_count_buffers<B: Backend>(backend: &mut B) {
    let mut host = Host(backend);
    let (buffer, counts) = (host.poison(16), host.poison(4));
    for index in [4, u32::MAX] {
        let items = Items::FromBuffer { buffer: counts, index, max: 1 };
        let refused = host.0.dispatch(&toys::STEP, &[], &[bind(buffer, 16)], items);
        assert_eq!(refused, Err(Error::BadRange { at: "toy.step", offset: 4 * u64::from(index), size: 4 }));
    }
    let items = Items::FromBuffer { buffer, index: 0, max: 1 };
    let refused = host.0.dispatch(&toys::STEP, &[], &[bind(buffer, 16)], items);
    assert_eq!(refused, Err(Error::Aliased { kernel: "toy.step", binding: "toy_values" }));
    nothing_happened(&mut host, buffer, 16);
}

/// Primitives over buffers that are too small or the same.
pub fn refuses_bad_primitives<B: Backend>(backend: &mut B) {
    let mut host = Host(backend);
    let [a, b, c, d] = [(); 4].map(|()| host.poison(16));
    let count = 16;
    let small = |kernel, binding, needed| Error::BindingTooSmall { kernel, binding, needed, found: 64 };
    let aliased = |kernel, binding| Error::Aliased { kernel, binding };
    for (primitive, error) in [
        (Primitive::Scan { input: a, output: b, count: 17 }, small("scan", "input", 68)),
        (Primitive::Scan { input: a, output: b, count }, small("scan", "output", 68)),
        (Primitive::Scan { input: a, output: b, count: u32::MAX }, small("scan", "input", 4 * u64::from(u32::MAX))),
        (Primitive::Scan { input: a, output: a, count: 3 }, aliased("scan", "output")),
        (Primitive::SortPairs { keys: a, values: b, count: 17 }, small("sort_pairs", "keys", 68)),
        (Primitive::SortPairs { keys: a, values: a, count }, aliased("sort_pairs", "keys")),
        (
            Primitive::ReduceByKey { keys: a, values: a, unique: b, sums: c, runs: d, count: 17 },
            small("reduce_by_key", "keys", 68),
        ),
        (
            Primitive::ReduceByKey { keys: a, values: b, unique: b, sums: c, runs: d, count },
            aliased("reduce_by_key", "unique"),
        ),
        (
            Primitive::ReduceByKey { keys: a, values: b, unique: c, sums: c, runs: d, count },
            aliased("reduce_by_key", "unique"),
        ),
        (
            Primitive::ReduceByKey { keys: a, values: b, unique: c, sums: d, runs: a, count },
            aliased("reduce_by_key", "runs"),
        ),
        (Primitive::Compact { flags: a, indices: b, kept: c, count: 17 }, small("compact", "flags", 68)),
        (Primitive::Compact { flags: a, indices: b, kept: b, count }, aliased("compact", "indices")),
        (Primitive::Compact { flags: a, indices: b, kept: a, count }, aliased("compact", "kept")),
    ] {
        assert_eq!(host.0.primitive(primitive), Err(error));
    }
    for buffer in [a, b, c, d] {
        nothing_happened(&mut host, buffer, 16);
    }
}

/// What was recorded before a refused call still runs, and only that.
pub fn refused_calls_change_nothing<B: Backend>(backend: &mut B) {
    let mut host = Host(backend);
    let values = host.buffer(&[1; 10]);
    host.record(&toys::STEP, &[], &[(values, 10)], Items::Count(10));
    let refused = host.0.dispatch(&toys::STEP, &[], &[bind(values, 10)], Items::Count(11));
    assert!(refused.is_err());
    assert!(host.0.primitive(Primitive::Fill { buffer: DEAD, word: 0 }).is_err());
    host.submit();
    assert_eq!(host.words(values, 10), (3..13).collect::<Vec<_>>());
    assert_eq!(host.0.statuses().expect("statuses").len(), 1);
}

/// Nothing refused was recorded, and the buffer is as it was made.
fn nothing_happened<B: Backend>(host: &mut Host<'_, B>, buffer: BufferId, words: usize) {
    host.submit();
    assert_eq!(host.0.statuses(), Ok(vec![]));
    assert_eq!(host.words(buffer, words), vec![POISON; words]);
}
