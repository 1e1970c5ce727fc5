//! A number of each of the runs that march side by side.

use crate::lanes::entrywise;

/// Runs side by side.
pub const RUNS: usize = 8;

/// A number of each of the runs side by side, on which arithmetic acts run by run. Written out like
/// [`Lanes`](crate::lanes::Lanes), but aligned to a cache line. No operation mixes runs or is fused: a
/// run's bits depend neither on its neighbours nor on the width.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C, align(64))]
pub struct Row(pub [f64; RUNS]);

impl Row {
    /// All zero.
    pub const ZERO: Self = Self([0.0; RUNS]);

    /// The same number in every run.
    #[inline(always)]
    #[must_use]
    pub const fn all(value: f64) -> Self {
        Self([value; RUNS])
    }

    #[inline(always)]
    fn zip(self, other: Self, f: impl Fn(f64, f64) -> f64) -> Self {
        let ([a, b, c, d, e, g, h, i], [j, k, l, m, n, o, p, q]) = (self.0, other.0);
        Self([f(a, j), f(b, k), f(c, l), f(d, m), f(e, n), f(g, o), f(h, p), f(i, q)])
    }
}

entrywise!(Row);
