//! Laws of the argument checks and of the primitives' model.
#![cfg(feature = "alloc")]

use backend_api::check::{self, Limits};
use backend_api::primitive::model;
use backend_api::{Access, Binding, BindingDecl, BufferId, Error, Items, Kernel, Launch, Primitive};
use proptest::prelude::*;

const LIMITS: Limits = Limits { max_binding_size: 4096, has_geometry: false };

static KERNEL: Kernel = Kernel {
    name: "toy.kernel",
    bindings: &[
        BindingDecl { name: "a", access: Access::In, stride: 12 },
        BindingDecl { name: "b", access: Access::OutPerItem, stride: 8 },
        BindingDecl { name: "c", access: Access::AtomicU64, stride: 16 },
    ],
    params_size: 16,
    body: |_: &mut Launch<'_>| {},
    wgsl: None,
    casts_rays: false,
};

/// Buffers 0..6 live and have this size in bytes.
fn size_of(id: BufferId) -> Option<u64> {
    (id.index < 6 && id.generation == 0).then(|| 768 * (u64::from(id.index) + 1))
}

fn id() -> impl Strategy<Value = BufferId> {
    (0..7_u32, 0..20_u32).prop_map(|(index, g)| BufferId { index, generation: u32::from(g == 0) })
}

/// Mostly small multiples of what is wanted, now and then anything.
fn number(unit: u64) -> impl Strategy<Value = u64> {
    prop_oneof![9 => (0..60_u64).prop_map(move |k| k * unit), 1 => any::<u64>(), 1 => 0..5000_u64]
}

fn binding() -> impl Strategy<Value = Binding> {
    (id(), prop_oneof![4 => Just(0), 2 => number(256)], number(48)).prop_map(|(buffer, offset, size)| Binding {
        buffer,
        offset,
        size,
    })
}

fn items() -> impl Strategy<Value = Items> {
    let from_buffer = (id(), prop_oneof![0..200_u32, any::<u32>()], 0..80_u32)
        .prop_map(|(buffer, index, max)| Items::FromBuffer { buffer, index, max });
    prop_oneof![4 => (0..80_u32).prop_map(Items::Count), 1 => any::<u32>().prop_map(Items::Count), 2 => from_buffer]
}

/// Whether a launcher could run the dispatch without ever leaving a buffer or handing out one word twice.
fn is_safe(bindings: &[Binding], items: Items) -> bool {
    let count = match items {
        Items::Count(count) | Items::FromBuffer { max: count, .. } => u128::from(count),
    };
    let fits = bindings.iter().zip(KERNEL.bindings).all(|(binding, decl)| {
        let (offset, size, stride) = (u128::from(binding.offset), u128::from(binding.size), u128::from(decl.stride));
        let elements = if decl.access == Access::OutPerItem { count.max(1) } else { 1 };
        size_of(binding.buffer).is_some_and(|len| offset + size <= u128::from(len))
            && size <= u128::from(LIMITS.max_binding_size)
            && offset % 256 == 0
            && size % stride == 0
            && size >= elements * stride
    });
    let ids = [bindings[0].buffer, bindings[1].buffer, bindings[2].buffer];
    let apart = ids[0] != ids[1] && ids[0] != ids[2] && ids[1] != ids[2];
    let counted = match items {
        Items::Count(_) => true,
        Items::FromBuffer { buffer, index, .. } => {
            size_of(buffer).is_some_and(|len| 4 * u64::from(index) + 4 <= len) && buffer != ids[1] && buffer != ids[2]
        }
    };
    fits && apart && counted
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(256))]

    #[test]
    fn a_dispatch_passes_when_it_is_safe_and_only_then(bindings in [binding(), binding(), binding()], items in items()) {
        let outcome = check::dispatch(&KERNEL, &[0; 16], &bindings, items, &LIMITS, size_of);
        prop_assert_eq!(outcome.is_ok(), is_safe(&bindings, items), "{:?}", outcome);
    }

    #[test]
    fn a_repaired_dispatch_passes(mut bindings in [binding(), binding(), binding()], count in 1..40_u32) {
        for (k, binding) in bindings.iter_mut().enumerate() {
            let buffer = BufferId { index: k as u32 + 1, generation: 0 };
            *binding = Binding { buffer, offset: binding.offset % 3 * 256, size: 48 * (binding.size % 10 + 1) };
            binding.size = binding.size.max(u64::from(count).div_ceil(6) * 48);
        }
        prop_assert_eq!(check::dispatch(&KERNEL, &[0; 16], &bindings, Items::Count(count), &LIMITS, size_of), Ok(()));
    }

    #[test]
    fn a_transfer_passes_when_it_stays_inside(offset in number(4), size in number(4), len in number(4)) {
        let inside = u128::from(offset) + u128::from(size) <= u128::from(len) && offset % 4 == 0 && size % 4 == 0;
        prop_assert_eq!(check::transfer("read", offset, size, Some(len)).is_ok(), inside);
        prop_assert_eq!(check::transfer("read", offset, size, None), Err(Error::UnknownBuffer { at: "read" }));
    }

    #[test]
    fn a_primitive_passes_when_it_is_safe_and_only_then(ids in [id(), id(), id(), id(), id()], count in 0..400_u32) {
        let [keys, values, unique, sums, runs] = ids;
        let primitive = Primitive::ReduceByKey { keys, values, unique, sums, runs, count };
        let words = [count, count, count, count, 1];
        let fits = ids.iter().zip(words).all(|(&id, words)| size_of(id).is_some_and(|len| 4 * u64::from(words) <= len));
        let apart = (2..5).all(|k| ids.iter().enumerate().all(|(other, &id)| other == k || id != ids[k]));
        prop_assert_eq!(check::primitive(&primitive, &LIMITS, size_of).is_ok(), fits && apart);
    }

    #[test]
    fn sums_differ_by_their_words(words in prop::collection::vec(any::<u32>(), 0..300)) {
        let mut output = vec![7; words.len() + 1];
        model::scan(&words, &mut output);
        prop_assert_eq!(output[0], 0);
        for (pair, word) in output.windows(2).zip(words) {
            prop_assert_eq!(pair[1].wrapping_sub(pair[0]), word);
        }
    }

    #[test]
    fn sorting_keeps_pairs_and_the_order_of_equals(words in prop::collection::vec(0..40_u32, 0..300)) {
        let mut keys = words.clone();
        let mut places: Vec<u32> = (0..words.len() as u32).collect();
        model::sort_pairs(&mut keys, &mut places);
        for (&key, &place) in keys.iter().zip(&places) {
            prop_assert_eq!(key, words[place as usize]);
        }
        let ascending = |k: usize| (keys[k], places[k]) < (keys[k + 1], places[k + 1]);
        prop_assert!((1..keys.len()).all(|k| ascending(k - 1)));
    }

    #[test]
    fn runs_repeat_into_the_keys(
        pairs in prop::collection::vec((0..3_u32, any::<u32>()), 0..300),
    ) {
        let (keys, values): (Vec<u32>, Vec<u32>) = pairs.into_iter().unzip();
        let (mut unique, mut sums) = (vec![0; keys.len()], vec![0; keys.len()]);
        let runs = model::reduce_by_key(&keys, &values, &mut unique, &mut sums) as usize;
        let mut squeezed = keys.clone();
        squeezed.dedup();
        prop_assert_eq!(&unique[..runs], squeezed);
        let sum = |words: &[u32]| words.iter().fold(0_u32, |a, &b| a.wrapping_add(b));
        prop_assert_eq!(sum(&sums[..runs]), sum(&values));
    }

    #[test]
    fn what_is_kept_is_set(flags in prop::collection::vec(0..3_u32, 0..300)) {
        let mut indices = vec![u32::MAX; flags.len()];
        let kept = model::compact(&flags, &mut indices) as usize;
        let set: Vec<u32> = (0..flags.len() as u32).filter(|&i| flags[i as usize] != 0).collect();
        prop_assert_eq!(&indices[..kept], set);
        prop_assert!(indices[kept..].iter().all(|&i| i == u32::MAX));
    }
}

#[test]
fn a_declaration_that_breaks_a_rule_is_found() {
    const fn one(access: Access, stride: u32) -> BindingDecl {
        BindingDecl { name: "a", access, stride }
    }
    let well_formed = |bindings, params_size| Kernel { bindings, params_size, ..KERNEL }.is_well_formed();
    assert!(well_formed(const { &[one(Access::AtomicU64, 24)] }, 65_536));
    assert!(well_formed(&[], 0));
    assert!(!well_formed(const { &[one(Access::AtomicU64, 20)] }, 0));
    assert!(!well_formed(const { &[one(Access::In, 0)] }, 0));
    assert!(!well_formed(const { &[one(Access::OutPerItem, 7)] }, 0));
    assert!(!well_formed(const { &[one(Access::In, 4); 6] }, 0));
    assert!(!well_formed(&[], 8));
    assert!(!well_formed(&[], 65_552));
}

#[test]
fn every_error_says_where_and_how_much() {
    for (error, words) in [
        (Error::BadSize { at: "grid", size: 6, limit: 64 }, &["grid", "6", "64"][..]),
        (Error::BadRange { at: "read", offset: 8, size: 16 }, &["read", "8", "16"]),
        (Error::BindingCount { kernel: "k", expected: 2, found: 3 }, &["k:", "2", "3"]),
        (Error::BindingTooSmall { kernel: "k", binding: "b", needed: 80, found: 64 }, &["k:", " b ", "80", "64"]),
        (Error::ParamsSize { kernel: "k", expected: 16, found: 12 }, &["k:", "16", "12"]),
        (Error::OutOfMemory { size: 1234 }, &["1234"]),
        (Error::Threads { wanted: 5000 }, &["5000"]),
    ] {
        let message = error.to_string();
        assert!(words.iter().all(|word| message.contains(word)) && !message.contains('\n'), "{message}");
    }
}
