//! Memory fetched from the system before it is written to.
//!
//! What an allocator has fresh from the system is not there until it is first touched, and then has to
//! be cleared: for long results as much work as the march that fills them. Another thread can do it.

use std::ops::Range;

/// Arrays that will be written to row by row.
#[derive(Clone, Debug, Default)]
pub(crate) struct Pages {
    /// The addresses of each, and the bytes of a row.
    arrays: Vec<(Range<usize>, usize)>,
    /// Rows fetched so far.
    rows: usize,
}

impl Pages {
    /// One more array, of so many columns.
    pub fn and(mut self, array: &[f64], columns: usize) -> Self {
        let Range { start, end } = array.as_ptr_range();
        self.arrays.push((start.addr()..end.addr(), columns * size_of::<f64>()));
        self
    }

    pub fn are_none(&self) -> bool {
        self.arrays.is_empty()
    }

    /// Fetches so many rows more.
    pub fn fetch(&mut self, count: usize) {
        let rows = self.rows..self.rows + count;
        for (addresses, bytes) in &self.arrays {
            let row = |row: usize| addresses.end.min(addresses.start + row * bytes);
            fetch(row(rows.start)..row(rows.end));
        }
        self.rows = rows.end;
    }
}

/// Fetches the pages in which these addresses lie.
#[cfg(target_os = "linux")]
fn fetch(addresses: Range<usize>) {
    // SAFETY: only asks for a number.
    let page = usize::try_from(unsafe { libc::sysconf(libc::_SC_PAGESIZE) }).unwrap_or(0).max(1);
    let begin = addresses.start / page * page;
    let count = addresses.end.saturating_sub(begin);
    // SAFETY: changes no value in memory, whoever else reads or writes it, and so may take in what shares
    // the first page. Older systems do not know it, and addresses without memory are refused: nothing is
    // lost but time.
    unsafe {
        libc::madvise(std::ptr::without_provenance_mut(begin), count, libc::MADV_POPULATE_WRITE);
    }
}

#[cfg(not(target_os = "linux"))]
fn fetch(_: Range<usize>) {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_there_stays() {
        let array: Vec<f64> = (0..30_000).map(f64::from).collect();
        let mut pages = Pages::default().and(&array, 3).and(&array[7..20], 1);
        // Further than they reach.
        for _ in 0..12 {
            pages.fetch(1000);
        }
        assert!(array.iter().zip(0..).all(|(&value, i)| value == f64::from(i)));
    }
}
