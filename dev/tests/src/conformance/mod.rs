//! What every backend must do alike: one suite, instantiated for each by one line.
//!
//! ```text
//! hashcache_dev_tests::conformance!(serial, Some(CpuBackend::serial()));
//! ```
//! The expression makes one backend for each test, or `None` where the machine has none (the test then says
//! "skipped"). All results are integers, so equality is of bits.
#![allow(clippy::missing_panics_doc, reason = "a law that does not hold is told by a panic")]

pub mod arguments;
pub mod buffers;
pub mod host;
pub mod launches;
pub mod primitives;
pub mod statuses;
pub mod toys;

/// A module of tests, one for each law, on the backends that `$make` makes (`Option<impl Backend>`).
#[macro_export]
macro_rules! conformance {
    ($name:ident, $make:expr) => {
        mod $name {
            #[allow(unused_imports, reason = "the expression names what it needs")]
            use super::*;

            $crate::conformance!(@tests $make,
                arguments: refuses_malformed_kernels, refuses_wrong_counts, refuses_dead_buffers, refuses_bad_sizes,
                    refuses_bad_ranges, refuses_small_bindings, refuses_aliases, refuses_bad_count_buffers,
                    refuses_bad_primitives, refused_calls_change_nothing;
                buffers: are_zero_at_first, keep_what_is_written, refuse_bad_sizes, refuse_bad_ranges,
                    die_once, live_on_for_recorded_commands, tickets_are_redeemed_once;
                launches: gather_and_write_per_item, read_and_write_per_item, start_at_offsets,
                    leave_the_rest_alone, run_in_order, wait_for_submit, take_counts_from_buffers, add_in_32_bits,
                    add_in_64_bits, take_five_bindings, fold_many_items;
                primitives: fill, scan, sort_pairs, reduce_by_key, compact, accept_nothing, follow_kernels;
                statuses: tell_what_was_raised, come_in_order_and_once, call_nothing_run;
            );
        }
    };
    (@tests $make:expr, $($topic:ident: $($test:ident),+;)+) => {
        $(mod $topic {
            #[allow(unused_imports, reason = "the expression names what it needs")]
            use super::*;

            $(#[test]
            fn $test() {
                match $make {
                    Some(mut backend) => $crate::conformance::$topic::$test(&mut backend),
                    None => eprintln!("skipped: no such backend on this machine"),
                }
            })+
        })+
    };
}
