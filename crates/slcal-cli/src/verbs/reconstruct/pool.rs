//! Parallel work on items, with results in the order of the items.

use std::collections::BTreeMap;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError, mpsc};
use std::thread;

use crate::exit::Outcome;

/// Each worker takes one item after another in its own thread. `take` gets the results in the order of the
/// items, as early as possible. Items are generated one at a time, when a worker is free.
///
/// Fails with the failure of `take`; no item is begun after that.
pub(super) fn in_order<T: Send, R: Send>(
    items: impl Iterator<Item = T> + Send,
    workers: Vec<impl FnMut(T) -> R + Send>,
    mut take: impl FnMut(R) -> Outcome,
) -> Outcome {
    let queue = Mutex::new(items.enumerate().fuse());
    let stop = AtomicBool::new(false);
    thread::scope(|scope| {
        let (send, receive) = mpsc::channel();
        for mut work in workers {
            let (send, queue, stop) = (send.clone(), &queue, &stop);
            scope.spawn(move || {
                while !stop.load(Ordering::Relaxed) {
                    let next = queue.lock().unwrap_or_else(PoisonError::into_inner).next();
                    let Some((index, item)) = next else { break };
                    if send.send((index, work(item))).is_err() {
                        break;
                    }
                }
            });
        }
        drop(send);
        let mut early = BTreeMap::new();
        let mut next = 0;
        for (index, result) in receive {
            early.insert(index, result);
            while let Some(result) = early.remove(&next) {
                next += 1;
                if let Err(failure) = take(result) {
                    stop.store(true, Ordering::Relaxed);
                    return Err(failure);
                }
            }
        }
        Ok(())
    })
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;
    use crate::exit::Failure;

    /// Later items are done sooner.
    fn slow(item: u64) -> u64 {
        thread::sleep(Duration::from_millis((20 - item % 20) / 4));
        item * item
    }

    #[test]
    fn results_come_in_order_from_any_number_of_workers() {
        for workers in [1, 2, 7] {
            let mut results = Vec::new();
            in_order(0..40, vec![slow; workers], |r| {
                results.push(r);
                Ok(())
            })
            .unwrap();
            assert_eq!(results, (0..40).map(|i| i * i).collect::<Vec<_>>());
        }
    }

    #[test]
    fn nothing_more_is_begun_after_a_failure() {
        let mut taken = 0;
        let failure = in_order(0.., vec![slow; 3], |_| {
            taken += 1;
            if taken == 5 { Err(Failure::ClosedPipe) } else { Ok(()) }
        });
        assert!(matches!(failure, Err(Failure::ClosedPipe)));
        assert_eq!(taken, 5);
    }
}
