//! Creating, writing, reading, destroying.

use backend_api::{Backend, BufferDesc, BufferId, Error, Items, Ticket};

use super::host::{Host, bind, noise};
use super::toys;

/// A new buffer holds zeros, also where an old one of the same size held something else.
pub fn are_zero_at_first<B: Backend>(backend: &mut B) {
    let mut host = Host(backend);
    let old = host.buffer(&noise(1, 1000));
    host.0.destroy(old).expect("destroy");
    let new = host.0.create(&BufferDesc { name: "new", size: 4000 }).expect("create");
    assert_eq!(host.words(new, 1000), [0; 1000]);
}

/// Writes land where they should and nowhere else; reads see any part; later writes win.
pub fn keep_what_is_written<B: Backend>(backend: &mut B) {
    let mut host = Host(backend);
    let mut expected = noise(2, 777);
    let buffer = host.buffer(&expected);
    let patch = noise(3, 5);
    host.0.write(buffer, 4 * 700, bytemuck::cast_slice(&patch)).expect("write");
    host.0.write(buffer, 4 * 702, &[]).expect("a write of nothing");
    expected[700..705].copy_from_slice(&patch);
    assert_eq!(host.words(buffer, 777), expected);
    let tail = host.0.read(buffer, 4 * 699, 4 * 78).expect("read");
    let nothing = host.0.read(buffer, 4 * 777, 0).expect("a read of nothing");
    host.0.write(buffer, 4 * 699, &[0; 4]).expect("write");
    assert_eq!(host.redeem(tail), expected[699..], "a read shows the state of its time");
    assert_eq!(host.redeem(nothing), []);
    assert_eq!(host.words(buffer, 777)[699], 0);
}

/// Sizes that are 0, no multiple of 4 or more than there is.
pub fn refuse_bad_sizes<B: Backend>(backend: &mut B) {
    for size in [0, 1, 6, u64::MAX] {
        match backend.create(&BufferDesc { name: "odd", size }) {
            Err(Error::BadSize { at: "odd", size: told, .. }) => assert_eq!(told, size),
            other => panic!("{size}: {other:?}"),
        }
    }
    // More than any machine has: refused as a size or for want of memory, never an abort.
    for size in [1 << 48, (u64::MAX / 2) & !4095] {
        let made = backend.create(&BufferDesc { name: "huge", size });
        let refused = matches!(made, Err(Error::BadSize { .. } | Error::OutOfMemory { .. }));
        assert!(refused, "{size}: {made:?}");
    }
    let mut host = Host(backend);
    let buffer = host.buffer(&[1, 2]);
    assert_eq!(host.words(buffer, 2), [1, 2], "the backend works on");
}

/// Ranges that are misaligned or leave the buffer.
pub fn refuse_bad_ranges<B: Backend>(backend: &mut B) {
    let mut host = Host(backend);
    let words = noise(4, 16);
    let buffer = host.buffer(&words);
    for (offset, size) in [(2, 4), (0, 3), (0, 68), (64, 4), (68, 0), (!3, 8), (!3, 0)] {
        let at = |at| Error::BadRange { at, offset, size };
        assert_eq!(host.0.read(buffer, offset, size), Err(at("read")));
        assert_eq!(host.0.write(buffer, offset, &vec![0; size as usize]), Err(at("write")));
    }
    assert_eq!(host.words(buffer, 16), words);
}

/// A handle is dead after its destruction, also when its place is used again.
pub fn die_once<B: Backend>(backend: &mut B) {
    let mut host = Host(backend);
    let dead = host.buffer(&[1]);
    host.0.destroy(dead).expect("destroy");
    let heirs: Vec<_> = (0..4).map(|word| host.buffer(&[word])).collect();
    assert!(!heirs.contains(&dead), "a handle is never given out twice");
    for dead in [dead, BufferId { index: u32::MAX, generation: 0 }, BufferId { generation: 9, ..heirs[0] }] {
        assert_eq!(host.0.destroy(dead), Err(Error::UnknownBuffer { at: "destroy" }));
        assert_eq!(host.0.write(dead, 0, &[0; 4]), Err(Error::UnknownBuffer { at: "write" }));
        assert_eq!(host.0.read(dead, 0, 4), Err(Error::UnknownBuffer { at: "read" }));
    }
    for (word, &heir) in heirs.iter().enumerate() {
        assert_eq!(host.words(heir, 1), [word as u32]);
    }
}

/// Commands that were recorded before a buffer's destruction still run; its handle is dead all the same.
pub fn live_on_for_recorded_commands<B: Backend>(backend: &mut B) {
    let mut host = Host(backend);
    let input = noise(5, 300);
    let (source, target) = (host.buffer(&input), host.poison(600));
    host.record(&toys::SCALE, &[1, 0, 0, 0], &[(source, 300), (target, 600)], Items::Count(300));
    host.0.destroy(source).expect("destroy");
    assert_eq!(host.0.destroy(source), Err(Error::UnknownBuffer { at: "destroy" }));
    let again = host.0.dispatch(&toys::STEP, &[], &[bind(source, 300)], Items::Count(300));
    assert_eq!(again, Err(Error::UnknownBuffer { at: "toy.step" }));
    let heir = host.poison(300);
    assert_ne!(heir, source);
    host.submit();
    let expected: Vec<u32> = (0..300).flat_map(|i| toys::scaled(&input, i, 1, 0)).collect();
    assert_eq!(host.words(target, 600), expected);
    assert_eq!(host.words(heir, 300), [super::host::POISON; 300]);
}

/// A ticket is good for one answer, in any order.
pub fn tickets_are_redeemed_once<B: Backend>(backend: &mut B) {
    let mut host = Host(backend);
    let buffer = host.buffer(&[7, 8]);
    let first = host.0.read(buffer, 0, 4).expect("read");
    let second = host.0.read(buffer, 4, 4).expect("read");
    host.0.destroy(buffer).expect("destroy");
    assert_eq!(host.redeem(second), [8]);
    assert_eq!(host.redeem(first), [7], "the bytes outlive the buffer");
    assert_eq!(host.0.redeem(first, true), Err(Error::UnknownTicket));
    assert_eq!(host.0.redeem(Ticket(u64::MAX), false), Err(Error::UnknownTicket));
}
