//! What items see and what they leave behind.

use backend_api::{Backend, Binding, Items};

use super::host::{Host, POISON, bind, noise};
use super::toys;

/// Numbers of items around the borders of workgroups and launches.
const COUNTS: [usize; 9] = [1, 2, 63, 64, 65, 255, 257, 1000, 40_000];

/// Items gather from anywhere and write their own element.
pub fn gather_and_write_per_item<B: Backend>(backend: &mut B) {
    let mut host = Host(backend);
    for n in COUNTS {
        let input = noise(n as u32, n);
        let (source, target) = (host.buffer(&input), host.poison(2 * n));
        host.run(&toys::SCALE, &[0x9e37_79b9, 5, 0, 0], &[(source, n), (target, 2 * n)], n as u32);
        let expected: Vec<u32> = (0..n as u32).flat_map(|i| toys::scaled(&input, i, 0x9e37_79b9, 5)).collect();
        assert_eq!(host.words(target, 2 * n), expected, "{n} items");
        assert_eq!(host.words(source, n), input, "{n} items");
    }
}

/// Items find in their element what was there before.
pub fn read_and_write_per_item<B: Backend>(backend: &mut B) {
    let mut host = Host(backend);
    for n in COUNTS {
        let input = noise(n as u32, n);
        let values = host.buffer(&input);
        host.run(&toys::STEP, &[], &[(values, n)], n as u32);
        assert_eq!(host.words(values, n), stepped(&input, n), "{n} items");
    }
}

/// A binding shows its range: item 0 is at its offset, lengths are its own.
pub fn start_at_offsets<B: Backend>(backend: &mut B) {
    let mut host = Host(backend);
    let input = noise(6, 64 * 5);
    let (source, target) = (host.buffer(&input), host.poison(64 * 5));
    let bindings =
        [Binding { buffer: source, offset: 256, size: 4 * 65 }, Binding { buffer: target, offset: 512, size: 8 * 65 }];
    host.0.dispatch(&toys::SCALE, bytemuck::cast_slice(&[3, 1, 0, 0]), &bindings, Items::Count(65)).expect("dispatch");
    host.submit();
    let mut expected = vec![POISON; 64 * 5];
    let written: Vec<u32> = (0..65).flat_map(|i| toys::scaled(&input[64..129], i, 3, 1)).collect();
    expected[128..258].copy_from_slice(&written);
    assert_eq!(host.words(target, 64 * 5), expected);

    // One buffer may be read through several bindings, overlapping ones too.
    let (results, bins, sums) = (host.poison(65), host.buffer(&[0]), host.buffer(&[0; 2]));
    let bindings = [
        bind(source, 128),
        Binding { buffer: source, offset: 256, size: 4 * 65 },
        bind(results, 65),
        bind(bins, 1),
        bind(sums, 2),
    ];
    host.0.dispatch(&toys::FIVE, &[0; 272], &bindings, Items::Count(65)).expect("dispatch");
    host.submit();
    let expected: Vec<u32> = (0..65).map(|i| input[i].wrapping_mul(input[i + 64])).collect();
    assert_eq!(host.words(results, 65), expected);
}

/// Elements beyond the items stay as they were.
pub fn leave_the_rest_alone<B: Backend>(backend: &mut B) {
    let mut host = Host(backend);
    let input = noise(7, 1000);
    for n in [0, 1, 300, 999] {
        let values = host.buffer(&input);
        host.run(&toys::STEP, &[], &[(values, 1000)], n as u32);
        assert_eq!(host.words(values, 1000), stepped(&input, n), "{n} items");
    }
}

/// A dispatch sees what those recorded before it wrote, within a submit and across them.
pub fn run_in_order<B: Backend>(backend: &mut B) {
    let mut host = Host(backend);
    let mut expected = noise(8, 5000);
    let (values, pairs) = (host.buffer(&expected), host.poison(10_000));
    for _ in 0..3 {
        for _ in 0..4 {
            host.record(&toys::STEP, &[], &[(values, 5000)], Items::Count(5000));
            expected = stepped(&expected, 5000);
        }
        host.record(&toys::SCALE, &[1, 0, 0, 0], &[(values, 5000), (pairs, 10_000)], Items::Count(5000));
        host.submit();
    }
    let expected: Vec<u32> = (0..5000).flat_map(|i| toys::scaled(&expected, i, 1, 0)).collect();
    assert_eq!(host.words(pairs, 10_000), expected);
}

/// What is recorded has not run yet: reads do not see it, and it sees writes made before the submit.
pub fn wait_for_submit<B: Backend>(backend: &mut B) {
    let mut host = Host(backend);
    let (source, target) = (host.buffer(&[1; 10]), host.poison(20));
    host.record(&toys::SCALE, &[5, 0, 0, 0], &[(source, 10), (target, 20)], Items::Count(10));
    host.record(&toys::STEP, &[], &[(source, 10)], Items::Count(10));
    assert_eq!(host.words(target, 20), [POISON; 20]);
    assert_eq!(host.words(source, 10), [1; 10]);
    host.0.write(source, 0, bytemuck::cast_slice(&[2; 10])).expect("write");
    host.submit();
    let expected: Vec<u32> = (0..10).flat_map(|i| [10, i]).collect();
    assert_eq!(host.words(target, 20), expected);
    assert_eq!(host.words(source, 10), stepped(&[2; 10], 10));
    host.submit();
    assert_eq!(host.words(source, 10), stepped(&[2; 10], 10), "a second submit repeats nothing");
}

/// The count is what the word holds when the dispatch's turn comes, at most `max`.
pub fn take_counts_from_buffers<B: Backend>(backend: &mut B) {
    let mut host = Host(backend);
    let input = noise(9, 1000);
    for (count, max) in
        [(0, 1000), (1, 1000), (64, 1000), (65, 1000), (1000, 1000), (1001, 1000), (u32::MAX, 700), (9, 0)]
    {
        let values = host.buffer(&input);
        let counts = host.buffer(&[77, 78, count, 79]);
        let items = Items::FromBuffer { buffer: counts, index: 2, max };
        host.record(&toys::STEP, &[], &[(values, 1000)], items);
        host.submit();
        assert_eq!(host.words(values, 1000), stepped(&input, count.min(max) as usize), "{count}, at most {max}");
        assert_eq!(host.words(counts, 4), [77, 78, count, 79]);
    }

    // A count that the same submit makes: four of the values fall into bin 1.
    let (values, bins, target) = (host.buffer(&[1, 0, 1, 1, 2, 1]), host.buffer(&[0; 3]), host.buffer(&[0; 10]));
    host.record(&toys::HISTOGRAM, &[], &[(values, 6), (bins, 3)], Items::Count(6));
    host.record(&toys::STEP, &[], &[(target, 10)], Items::FromBuffer { buffer: bins, index: 1, max: 10 });
    host.submit();
    assert_eq!(host.words(target, 10), [0, 1, 2, 3, 0, 0, 0, 0, 0, 0]);
}

/// Atomic sums of 32 bits lose nothing, with few and with many addresses.
pub fn add_in_32_bits<B: Backend>(backend: &mut B) {
    let mut host = Host(backend);
    let n = 50_000;
    let input = noise(10, n);
    let values = host.buffer(&input);
    for bins in [1, 3, 4096] {
        let mut expected = vec![u32::MAX - 5; bins];
        let buffer = host.buffer(&expected);
        host.run(&toys::HISTOGRAM, &[], &[(values, n), (buffer, bins)], n as u32);
        for &value in &input {
            let bin = &mut expected[value as usize % bins];
            *bin = bin.wrapping_add(1);
        }
        assert_eq!(host.words(buffer, bins), expected, "{bins} bins");
    }
}

/// Atomic sums of 64 bits carry from the low word to the high one; the bytes are the same everywhere.
pub fn add_in_64_bits<B: Backend>(backend: &mut B) {
    let mut host = Host(backend);
    let n = 20_000;
    let input = noise(11, 2 * n);
    let values = host.buffer(&input);
    for sums in [1, 5, 1024] {
        let mut expected = vec![u64::from(u32::MAX); sums];
        let buffer = host.buffer(bytemuck::cast_slice(&expected));
        host.run(&toys::SUM, &[], &[(values, 2 * n), (buffer, 2 * sums)], n as u32);
        for pair in input.chunks_exact(2) {
            let sum = &mut expected[pair[0] as usize % sums];
            *sum = sum.wrapping_add(u64::from(pair[1]) << 32 | u64::from(pair[0]));
        }
        let found: Vec<u64> = bytemuck::pod_collect_to_vec(&host.words(buffer, 2 * sums));
        assert_eq!(found, expected, "{sums} sums");
    }
}

/// As many bindings as a kernel may have, of all kinds, beside a long parameter block.
pub fn take_five_bindings<B: Backend>(backend: &mut B) {
    let mut host = Host(backend);
    let n = 3000;
    let (a, b) = (noise(12, n), noise(13, n));
    let buffers = [host.buffer(&a), host.buffer(&b), host.poison(n), host.buffer(&[0; 7]), host.buffer(&[0; 2])];
    let mut params = noise(14, 68);
    params[67] = 1234;
    let lengths = [n, n, n, 7, 2];
    let bindings: Vec<_> = buffers.into_iter().zip(lengths).collect();
    host.run(&toys::FIVE, &params, &bindings, n as u32);
    let products: Vec<u32> = a.iter().zip(&b).map(|(a, b)| a.wrapping_mul(*b)).collect();
    let sum: u64 = products.iter().copied().map(u64::from).sum();
    let mut bins = [0_u32; 7];
    for (i, a) in a.iter().enumerate() {
        bins[i % 7] = bins[i % 7].wrapping_add(*a);
    }
    assert_eq!(host.words(buffers[4], 2), [sum as u32, (sum >> 32) as u32]);
    assert_eq!(host.words(buffers[3], 7), bins);
    assert_eq!(host.words(buffers[2], n), products.iter().map(|p| p.wrapping_add(1234)).collect::<Vec<_>>());
}

/// More workgroups than one dimension of a GPU's launch has (65,535).
pub fn fold_many_items<B: Backend>(backend: &mut B) {
    let mut host = Host(backend);
    let n = 64 * 65_535 + 64 * 3 + 1;
    let desc = backend_api::BufferDesc { name: "many", size: 4 * n as u64 };
    let values = host.0.create(&desc).expect("create");
    host.run(&toys::STEP, &[], &[(values, n)], n as u32);
    let count = host.buffer(&[n as u32]);
    host.record(&toys::STEP, &[], &[(values, n)], Items::FromBuffer { buffer: count, index: 0, max: n as u32 });
    host.submit();
    let wrong = host.words(values, n).iter().zip(0_u32..).position(|(&value, i)| value != i.wrapping_mul(4));
    assert_eq!(wrong, None);
}

/// What [`toys::STEP`] makes of the first `n` words.
fn stepped(words: &[u32], n: usize) -> Vec<u32> {
    let mut words = words.to_vec();
    for (value, i) in words[..n].iter_mut().zip(0..) {
        *value = value.wrapping_mul(3).wrapping_add(i);
    }
    words
}
