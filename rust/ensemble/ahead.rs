//! Memory that is asked for before it is read.
//!
//! Eight runs on several tracks are more streams than a processor foresees by itself, each read for a
//! kilobyte at a time: it would wait for memory at the beginning of every block. So while one block is
//! computed, the lines of the next are asked for, a few a period: all at once would wait again.

use std::ops::Range;

use crate::row::RUNS;

/// Bytes that come from memory together.
const LINE: usize = 64;

/// Addresses that the next block will read: a range for each track and run.
#[derive(Clone, Debug, Default)]
pub struct Ahead {
    ranges: Vec<Range<usize>>,
}

impl Ahead {
    pub(super) fn clear(&mut self) {
        self.ranges.clear();
    }

    /// One more track, the numbers of each run one after the other.
    pub fn extend<T>(&mut self, runs: [&[T]; RUNS]) {
        let addresses = |run: &[T]| run.as_ptr_range().start.addr()..run.as_ptr_range().end.addr();
        self.ranges.extend(runs.map(addresses));
    }

    /// Asks for what falls to one of the block's periods: in each track the next line of one run. Eight
    /// periods of double precision are a line, so the last ones complete a block.
    #[inline(always)]
    pub(super) fn ask(&self, period: usize) {
        for range in self.ranges.iter().skip(period % RUNS).step_by(RUNS) {
            let address = range.start + period / RUNS * LINE;
            if address < range.end {
                ask(address);
            }
        }
    }
}

#[inline(always)]
fn ask(address: usize) {
    #[cfg(target_arch = "x86_64")]
    // SAFETY: a hint; it reads nothing, and no address makes it fail.
    unsafe {
        use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
        _mm_prefetch::<_MM_HINT_T0>(std::ptr::without_provenance(address));
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = address;
}
