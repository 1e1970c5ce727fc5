//! Independent pieces of work on all threads, under one watch.

use std::ops::Range;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::Duration;

use rayon::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};

use crate::error::{Error, Result};
use crate::watch::Pulse;

/// Time between two calls of the caller's pulse.
const PULSE_INTERVAL: Duration = Duration::from_millis(50);

/// Entries of a list that one thread makes at a time: milliseconds.
const PORTION: usize = 1 << 10;

/// How many threads `RAYON_NUM_THREADS` asks for, 0 if it does not say; as last read.
static ASKED: AtomicUsize = AtomicUsize::new(NOT_READ);
const NOT_READ: usize = usize::MAX;

fn asked() -> usize {
    let asked = std::env::var_os("RAYON_NUM_THREADS");
    asked.and_then(|number| number.to_str()?.parse().ok()).unwrap_or(0)
}

/// Reads the environment, for where others may change it: in Python under the interpreter's lock.
#[cfg(feature = "python")]
pub(crate) fn read_environment() {
    ASKED.store(asked(), Ordering::Relaxed);
}

/// How many threads share work: one per core, unless `RAYON_NUM_THREADS` sets another number.
pub(crate) fn thread_count() -> usize {
    let asked = match ASKED.load(Ordering::Relaxed) {
        NOT_READ => asked(),
        asked => asked,
    };
    if asked > 0 { asked } else { thread::available_parallelism().map_or(1, usize::from) }
}

/// This process's threads. Not rayon's global ones: a forked process (Python's multiprocessing)
/// inherits their names but not the threads, and would wait for them for ever. None where the system
/// gives no threads.
fn threads() -> Option<Arc<ThreadPool>> {
    static THREADS: Mutex<Option<(u32, Arc<ThreadPool>)>> = Mutex::new(None);
    let process = std::process::id();
    let mut kept = THREADS.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some((_, pool)) = kept.as_ref().filter(|(owner, _)| *owner == process) {
        return Some(Arc::clone(pool));
    }
    let pool = Arc::new(ThreadPoolBuilder::new().num_threads(thread_count()).build().ok()?);
    // What was inherited has no threads to end.
    std::mem::forget(kept.replace((process, Arc::clone(&pool))));
    Some(pool)
}

/// Sorts entries by a key that all of them have of their own.
pub(crate) fn sort_by_key<T: Send, K: Ord>(entries: &mut [T], key: impl Fn(&T) -> K + Send + Sync) {
    match threads() {
        Some(threads) => threads.install(|| entries.par_sort_unstable_by_key(key)),
        None => entries.sort_unstable_by_key(key),
    }
}

/// Results of `work` for every piece, in their order; of several errors the first in that order,
/// whichever thread met it. This thread asks `pulse` while others work.
///
/// # Errors
/// What `work` or `pulse` gives.
pub(crate) fn map<I: Send, T: Send>(
    pieces: impl IntoIterator<Item = I>,
    pulse: Pulse,
    work: impl Fn(I, Pulse) -> Result<T> + Sync,
) -> Result<Vec<T>> {
    let mut pieces: Vec<I> = pieces.into_iter().collect();
    if pieces.len() <= 1 {
        // One piece is not worth waking threads for.
        return pieces.pop().map(|piece| work(piece, pulse)).into_iter().collect();
    }
    let Some(threads) = threads() else {
        return pieces.into_iter().map(|piece| work(piece, pulse)).collect();
    };
    let stop = AtomicBool::new(false);
    let go_on = || if stop.load(Ordering::Relaxed) { Err(Error::Interrupted) } else { Ok(()) };
    let one = |piece| go_on().and_then(|()| work(piece, &mut || go_on()));
    let (done, wait) = channel();
    threads.in_place_scope(|scope| {
        let all = &one;
        scope.spawn(move |_| {
            let results: Vec<Result<T>> = pieces.into_par_iter().map(all).collect();
            // Nobody waits any more only if this scope is already unwinding.
            let _ = done.send(results);
        });
        let mut asked = Ok(());
        loop {
            match wait.recv_timeout(PULSE_INTERVAL) {
                Ok(results) => return asked.and_then(|()| results.into_iter().collect()),
                Err(RecvTimeoutError::Timeout) => {
                    if asked.is_ok() {
                        asked = pulse();
                        stop.store(asked.is_err(), Ordering::Relaxed);
                    }
                }
                // A panic in `work`, which the scope passes on.
                Err(RecvTimeoutError::Disconnected) => return Err(Error::Interrupted),
            }
        }
    })
}

/// A list of `entry` for all numbers of a range; each must take no more than microseconds.
///
/// # Errors
/// What `pulse` gives.
pub(crate) fn list<T: Clone + Send>(
    range: Range<usize>,
    pulse: Pulse,
    entry: impl Fn(usize) -> T + Sync,
) -> Result<Vec<T>> {
    let end = range.end;
    let portions = range.step_by(PORTION).map(|first| first..(first + PORTION).min(end));
    let parts = map(portions, pulse, |portion, pulse| {
        pulse()?;
        Ok(portion.map(&entry).collect::<Vec<T>>())
    })?;
    Ok(parts.concat())
}

/// Tools that serve one piece of work after another: no more are made than there are threads.
pub(crate) struct Tools<T>(Mutex<Vec<T>>);

impl<T> Tools<T> {
    pub fn new() -> Self {
        Self(Mutex::new(Vec::new()))
    }

    /// Does a piece of work with tools that lie idle, or with new ones.
    pub fn lend<R>(&self, make: impl FnOnce() -> T, work: impl FnOnce(&mut T) -> R) -> R {
        let idle = || self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let ready = idle().pop();
        let mut tools = ready.unwrap_or_else(make);
        let result = work(&mut tools);
        idle().push(tools);
        result
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_come_in_order_and_the_first_error_counts() {
        let square = |i: usize, _: Pulse| Ok(i * i);
        assert_eq!(
            map(0..1000, &mut || Ok(()), square).unwrap(),
            (0..1000).map(|i| i * i).collect::<Vec<_>>()
        );
        let fails = |i: usize, _: Pulse| -> Result<usize> {
            if i % 10 == 7 { Err(Error::NotConverged { iterations: i }) } else { Ok(i) }
        };
        assert_eq!(map(0..1000, &mut || Ok(()), fails), Err(Error::NotConverged { iterations: 7 }));
    }

    #[test]
    fn the_caller_can_stop_it() {
        let for_ever = |_: usize, pulse: Pulse| -> Result<()> {
            loop {
                pulse()?;
                thread::sleep(Duration::from_millis(1));
            }
        };
        assert_eq!(map(0..8, &mut || Err(Error::Interrupted), for_ever), Err(Error::Interrupted));
    }
}
