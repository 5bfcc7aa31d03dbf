//! The status word of each dispatch.

use backend_api::{Backend, Items, Primitive, Status};

use super::host::Host;
use super::toys;

/// Flags of all items come together; a body cannot raise "not run".
pub fn tell_what_was_raised<B: Backend>(backend: &mut B) {
    let mut host = Host(backend);
    let mut flags = vec![0; 1000];
    flags[3] = Status::NON_FINITE.bits();
    flags[999] = Status::OVERFLOW.bits() | Status::NOT_RUN.bits();
    let buffer = host.buffer(&flags);
    host.run(&toys::RAISE, &[], &[(buffer, 1000)], 1000);
    host.run(&toys::RAISE, &[], &[(buffer, 1000)], 999);
    host.run(&toys::RAISE, &[], &[(buffer, 1000)], 3);
    let all = Status::NON_FINITE.union(Status::OVERFLOW);
    let expected = [("toy.raise", all), ("toy.raise", Status::NON_FINITE), ("toy.raise", Status::OK)];
    assert_eq!(host.0.statuses().expect("statuses"), expected);
}

/// One entry for each submitted dispatch, in order, told once; primitives have none.
pub fn come_in_order_and_once<B: Backend>(backend: &mut B) {
    let mut host = Host(backend);
    let full = host.buffer(&[Status::TABLE_FULL.bits()]);
    let values = host.poison(1);
    assert_eq!(host.0.statuses(), Ok(vec![]));
    host.record(&toys::STEP, &[], &[(values, 1)], Items::Count(1));
    host.0.primitive(Primitive::Fill { buffer: values, word: 0 }).expect("primitive");
    host.record(&toys::RAISE, &[], &[(full, 1)], Items::Count(1));
    host.submit();
    host.run(&toys::STEP, &[], &[(values, 1)], 1);
    host.record(&toys::RAISE, &[], &[(full, 1)], Items::Count(1));
    let expected = [("toy.step", Status::OK), ("toy.raise", Status::TABLE_FULL), ("toy.step", Status::OK)];
    assert_eq!(host.0.statuses().expect("statuses"), expected, "what was not submitted is not told");
    host.submit();
    assert_eq!(host.0.statuses().expect("statuses"), [("toy.raise", Status::TABLE_FULL)]);
    assert_eq!(host.0.statuses(), Ok(vec![]));
}

/// A dispatch without items has run, whether its count was known before or not; nothing submitted is nothing told.
pub fn call_nothing_run<B: Backend>(backend: &mut B) {
    let mut host = Host(backend);
    let (flags, none) = (host.buffer(&[Status::TABLE_FULL.bits()]), host.buffer(&[0]));
    host.submit();
    assert_eq!(host.0.statuses(), Ok(vec![]));
    host.record(&toys::RAISE, &[], &[(flags, 1)], Items::Count(0));
    host.record(&toys::RAISE, &[], &[(flags, 1)], Items::FromBuffer { buffer: none, index: 0, max: 1 });
    host.submit();
    assert_eq!(host.0.statuses().expect("statuses"), [("toy.raise", Status::OK); 2]);
}
