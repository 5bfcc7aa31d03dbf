//! Work on several threads whose result does not depend on their number.

use std::sync::Mutex;
use std::thread;

/// `threads` as an option says it: 0 is all that the machine has.
pub(crate) fn threads(option: usize) -> usize {
    if option == 0 { thread::available_parallelism().map_or(1, usize::from) } else { option }
}

/// `work` on every item, on at most `threads` threads; results in the items' order. Items are taken first to last.
pub(crate) fn map<T: Send, R: Send>(items: Vec<T>, threads: usize, work: impl Fn(T) -> R + Sync) -> Vec<R> {
    let threads = threads.min(items.len());
    if threads <= 1 {
        return items.into_iter().map(work).collect();
    }
    let queue = Mutex::new(items.into_iter().enumerate());
    // A thread that panics poisons nothing that matters: its panic goes on below.
    let next = || queue.lock().unwrap_or_else(std::sync::PoisonError::into_inner).next();
    let run = || std::iter::from_fn(next).map(|(i, item)| (i, work(item))).collect::<Vec<_>>();
    let mut results: Vec<(usize, R)> = thread::scope(|scope| {
        let others: Vec<_> = (1..threads).map(|_| scope.spawn(run)).collect();
        let mut all = run();
        for other in others {
            all.extend(other.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)));
        }
        all
    });
    results.sort_unstable_by_key(|r| r.0);
    results.into_iter().map(|r| r.1).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_keep_the_items_order() {
        for count in [0, 1, 2, 3, 100] {
            for threads in [0, 1, 2, 7] {
                let squares = map((0..count).collect(), threads, |i: u64| i * i);
                assert_eq!(squares, (0..count).map(|i| i * i).collect::<Vec<_>>());
            }
        }
    }
}
