//! Calls WGSL functions item by item, on words in and words out.

use backend_api::{Access, Backend, BindingDecl, BufferDesc, Items, Kernel, Launch, Wgsl};
use backend_wgpu::WgpuBackend;

use crate::conformance::host::{Host, POISON, bind, noise};

/// Words in and words out of one item.
pub const WORDS: usize = 8;

/// An item's words.
pub type Item = [u32; WORDS];

const FRAME: &str = "
@group(0) @binding(0) var<storage, read> t_input: array<u32>;
@group(0) @binding(1) var<storage, read_write> t_output: array<u32>;
var<private> t_item: u32;
fn word(k: u32) -> u32 { return t_input[t_item * 8u + k]; }
fn word_i32(k: u32) -> i32 { return bitcast<i32>(word(k)); }
fn word_f32(k: u32) -> f32 { return bitcast<f32>(word(k)); }
fn word2(k: u32) -> vec2<u32> { return vec2<u32>(word(k), word(k + 1u)); }
fn put(k: u32, v: u32) { t_output[t_item * 8u + k] = v; }
fn put_f32(k: u32, v: f32) { put(k, bitcast<u32>(v)); }
fn put2(k: u32, v: vec2<u32>) { put(k, v.x); put(k + 1u, v.y); }
@compute @workgroup_size(64)
fn t_main(@builtin(global_invocation_id) gid: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    t_item = hc_item(gid, groups);
    if t_item < hc_launch.count { t_call(); }
}
";

fn only_on_gpus(_: &mut Launch<'_>) {
    unreachable!("the host calls the twin");
}

/// What `body` makes of `items`: WGSL statements that read words by `word(k)`, `word_i32`, `word_f32`, `word2` and
/// write them by `put(k, v)`, `put_f32`, `put2`, using `modules`. Words not written hold [`POISON`].
///
/// # Panics
/// When the backend refuses, with the device's words.
pub fn call(
    backend: &mut WgpuBackend,
    name: &'static str,
    modules: &[&'static str],
    body: &str,
    items: &[Item],
) -> Vec<Item> {
    // Kernels live as long as the program; a test makes a few dozen.
    let call: &'static str = format!("fn t_call() {{ {body} }}").leak();
    let modules: &'static [&'static str] = [modules, &[FRAME, call]].concat().leak();
    let decl = |name, access| BindingDecl { name, access, stride: size_of::<Item>() as u32 };
    let kernel: &'static Kernel = Box::leak(Box::new(Kernel {
        name,
        bindings: Box::leak(Box::new([decl("t_input", Access::In), decl("t_output", Access::OutPerItem)])),
        params_size: 0,
        body: only_on_gpus,
        wgsl: Some(Wgsl { modules, entry: "t_main", workgroup_size: 64 }),
        casts_rays: false,
    }));
    let words = items.len() * WORDS;
    let input = {
        let desc = BufferDesc { name, size: 4 * words as u64 };
        let buffer = backend.create(&desc).unwrap_or_else(|error| panic!("{name}: {error}"));
        backend.write(buffer, 0, bytemuck::cast_slice(items)).unwrap_or_else(|error| panic!("{name}: {error}"));
        buffer
    };
    let output = Host(backend).poison(words);
    let bindings = [bind(input, words), bind(output, words)];
    let dispatched = backend.dispatch(kernel, &[], &bindings, Items::Count(items.len() as u32));
    let ran = dispatched.and_then(|()| backend.submit());
    ran.unwrap_or_else(|error| panic!("{error}\n{}", backend.message()));
    let found = Host(backend).words(output, words);
    let statuses = backend.statuses();
    assert!(statuses.is_ok(), "{name}: {statuses:?}");
    backend.destroy(input).and_then(|()| backend.destroy(output)).expect("alive");
    bytemuck::pod_collect_to_vec(&found)
}

/// Words at which integer and float formulas break.
pub fn extremes() -> Vec<u32> {
    let mut words = vec![0, 1, 2, 3, u32::MAX, u32::MAX - 1, 0x8000_8000, 0x7fff_7fff, 0x8001_8001, 0xffff, 0x7fff];
    words.extend(
        [f32::NAN, f32::INFINITY, 1.0, 1.5, f32::MAX, f32::MIN_POSITIVE, 1e-40, 65_504.0, 65_520.0].map(f32::to_bits),
    );
    words.extend([1e-12_f32, 1e12, 1e7, 1e-4, 8192.0, 5e-7, 4.7e-7].map(f32::to_bits));
    // A signalling NaN, and the borders of exponents.
    words.extend([0x7f80_0001, 0x0080_0000, 0x007f_ffff, 0x7f7f_ffff, 0x3f80_0001, 0x3f7f_ffff]);
    words.extend(words.clone().iter().map(|word| word ^ 0x8000_0000).collect::<Vec<_>>());
    words.sort_unstable();
    words.dedup();
    words
}

/// Items for any function: every pair of extremes first, then 0 to 65535 in the first word, then random words with
/// extremes among them.
pub fn inputs() -> Vec<Item> {
    let extremes = extremes();
    let pick = |k: u32| extremes[k as usize % extremes.len()];
    let mut items = Vec::new();
    for (i, &a) in extremes.iter().enumerate() {
        for (k, &b) in extremes.iter().enumerate() {
            let k = k as u32;
            items.push([a, b, pick(k * 7), pick(k * 3 + i as u32), pick(k + 5), pick(k * 11), k, a ^ b]);
        }
    }
    for (low, rest) in (0..=0xffff).zip(noise(31, WORDS << 16).chunks_exact(WORDS)) {
        items.push([low, rest[1], rest[2], rest[3], rest[4], rest[5], rest[6], rest[7]]);
    }
    let random = noise(32, WORDS << 16);
    for (chunk, dice) in random.chunks_exact(WORDS).zip(noise(33, 1 << 16)) {
        let mut item: Item = bytemuck::pod_read_unaligned(bytemuck::cast_slice(chunk));
        if dice % 4 == 0 {
            item[(dice >> 8) as usize % WORDS] = pick(dice >> 16);
        }
        items.push(item);
    }
    items
}

/// Words written by `f`, with [`POISON`] in the others: what [`call`] should return.
pub fn expect<const N: usize>(items: &[Item], f: impl Fn(&Item) -> [u32; N]) -> Vec<Item> {
    items
        .iter()
        .map(|item| {
            let mut words = [POISON; WORDS];
            words[..N].copy_from_slice(&f(item));
            words
        })
        .collect()
}
