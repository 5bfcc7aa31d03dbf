//! The primitives against their serial model.

use backend_api::primitive::model;
use backend_api::{Backend, Items, Primitive};

use super::host::{Host, POISON, noise};
use super::toys;

/// Numbers of words around the borders of workgroups, chunks and passes.
const COUNTS: [usize; 10] = [1, 2, 255, 256, 257, 1024, 4097, 16_384, 16_385, 100_003];

/// Words of every kind that primitives meet: all equal, few values, ascending, descending, any.
fn patterns(n: usize) -> Vec<Vec<u32>> {
    let any = noise(n as u32, n);
    vec![
        vec![u32::MAX; n],
        vec![0; n],
        any.iter().map(|word| word % 3).collect(),
        any.iter().map(|word| word % 1000 / 999).collect(),
        (0..n as u32).collect(),
        (0..n as u32).map(|i| u32::MAX - i / 300).collect(),
        any,
    ]
}

/// Fill reaches every word.
pub fn fill<B: Backend>(backend: &mut B) {
    let mut host = Host(backend);
    for n in COUNTS {
        let buffer = host.poison(n);
        for word in [0, 1, u32::MAX, 0x1234_5678] {
            host.0.primitive(Primitive::Fill { buffer, word }).expect("primitive");
            host.submit();
            assert_eq!(host.words(buffer, n), vec![word; n]);
        }
    }
}

/// Exclusive sums that wrap, and the whole sum behind them.
pub fn scan<B: Backend>(backend: &mut B) {
    let mut host = Host(backend);
    for n in COUNTS {
        for words in patterns(n) {
            let (input, output) = (host.buffer(&words), host.poison(n + 3));
            host.0.primitive(Primitive::Scan { input, output, count: n as u32 }).expect("primitive");
            host.submit();
            let mut expected = vec![POISON; n + 3];
            model::scan(&words, &mut expected);
            assert!(host.words(output, n + 3) == expected, "{n} words from {:?}", &words[..n.min(4)]);
            assert!(host.words(input, n) == words, "{n} words");
            release(&mut host, [input, output]);
        }
    }
}

/// The order is ascending and stable.
pub fn sort_pairs<B: Backend>(backend: &mut B) {
    let mut host = Host(backend);
    for n in COUNTS {
        for mut words in patterns(n) {
            let mut payload: Vec<u32> = (0..n as u32 + 2).rev().collect();
            words.extend([0, 1]);
            let (keys, values) = (host.buffer(&words), host.buffer(&payload));
            host.0.primitive(Primitive::SortPairs { keys, values, count: n as u32 }).expect("primitive");
            host.submit();
            model::sort_pairs(&mut words[..n], &mut payload[..n]);
            assert!(host.words(keys, n + 2) == words, "{n} keys, sorted {:?}", &words[..n.min(4)]);
            assert!(host.words(values, n + 2) == payload, "{n} values, keys sorted {:?}", &words[..n.min(4)]);
            release(&mut host, [keys, values]);
        }
    }
}

/// Runs of equal neighbours, from one run over everything to one a word.
pub fn reduce_by_key<B: Backend>(backend: &mut B) {
    let mut host = Host(backend);
    for n in COUNTS {
        for words in patterns(n) {
            let weights = noise(99, n);
            let [mut unique, mut sums] = [vec![POISON; n], vec![POISON; n]];
            let runs = model::reduce_by_key(&words, &weights, &mut unique, &mut sums);
            let buffers = [host.buffer(&words), host.buffer(&weights), host.poison(n), host.poison(n), host.poison(1)];
            let [keys, values, at_unique, at_sums, at_runs] = buffers;
            let count = n as u32;
            let primitive =
                Primitive::ReduceByKey { keys, values, unique: at_unique, sums: at_sums, runs: at_runs, count };
            host.0.primitive(primitive).expect("primitive");
            host.submit();
            assert_eq!(host.words(at_runs, 1), [runs], "{n} keys from {:?}", &words[..n.min(4)]);
            assert!(host.words(at_unique, n) == unique, "{n} keys from {:?}", &words[..n.min(4)]);
            assert!(host.words(at_sums, n) == sums, "{n} keys from {:?}", &words[..n.min(4)]);
            release(&mut host, buffers);
        }
    }
}

/// Indices of what is not 0, ascending.
pub fn compact<B: Backend>(backend: &mut B) {
    let mut host = Host(backend);
    for n in COUNTS {
        for words in patterns(n) {
            let mut expected = vec![POISON; n];
            let number = model::compact(&words, &mut expected);
            let buffers = [host.buffer(&words), host.poison(n), host.poison(1)];
            let [flags, indices, kept] = buffers;
            host.0.primitive(Primitive::Compact { flags, indices, kept, count: n as u32 }).expect("primitive");
            host.submit();
            assert_eq!(host.words(kept, 1), [number], "{n} flags from {:?}", &words[..n.min(4)]);
            assert!(host.words(indices, n) == expected, "{n} flags from {:?}", &words[..n.min(4)]);
            release(&mut host, buffers);
        }
    }
}

/// No words: sums and counts are 0, the rest stays.
pub fn accept_nothing<B: Backend>(backend: &mut B) {
    let mut host = Host(backend);
    let [a, b, c, d, e] = [1, 2, 3, 4, 5].map(|word| host.buffer(&[word, word]));
    let count = 0;
    for primitive in [
        Primitive::SortPairs { keys: a, values: b, count },
        Primitive::Scan { input: a, output: c, count },
        Primitive::ReduceByKey { keys: a, values: b, unique: c, sums: d, runs: e, count },
        Primitive::Compact { flags: a, indices: b, kept: d, count },
    ] {
        host.0.primitive(primitive).expect("primitive");
    }
    host.submit();
    assert_eq!([a, b, c, d, e].map(|buffer| host.words(buffer, 2)), [[1, 1], [2, 2], [0, 3], [0, 4], [0, 5]]);
}

/// Primitives and kernels of one submit see each other's work: which values are odd, moved to the front.
pub fn follow_kernels<B: Backend>(backend: &mut B) {
    let mut host = Host(backend);
    let n = 3000;
    let input = noise(21, n);
    let [bins, indices] = [host.buffer(&[0; 50]), host.poison(50)];
    let [values, kept, pairs] = [host.buffer(&input), host.poison(1), host.poison(100)];
    host.record(&toys::HISTOGRAM, &[], &[(values, n), (bins, 50)], Items::Count(n as u32));
    host.0.primitive(Primitive::Compact { flags: bins, indices, kept, count: 50 }).expect("primitive");
    let items = Items::FromBuffer { buffer: kept, index: 0, max: 50 };
    host.record(&toys::SCALE, &[2, 1, 0, 0], &[(indices, 50), (pairs, 100)], items);
    host.submit();
    let filled: Vec<u32> = (0..50).collect();
    assert_eq!(host.words(kept, 1), [50], "3000 values reach each of 50 bins");
    let expected: Vec<u32> = (0..50).flat_map(|i| toys::scaled(&filled, i, 2, 1)).collect();
    assert_eq!(host.words(pairs, 100), expected);
}

fn release<B: Backend, const N: usize>(host: &mut Host<'_, B>, buffers: [backend_api::BufferId; N]) {
    for buffer in buffers {
        host.0.destroy(buffer).expect("destroy");
    }
}
