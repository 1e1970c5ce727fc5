//! Distances rolled, kept with their rounding error.
//!
//! A knot's distance is a station plus a gear's lag behind the foremost gear. Rounded to one
//! double it would cost a narrow edge far down the runway most of its digits, so it is kept
//! as an unevaluated sum of two.

/// `hi + lo`, |lo| ≤ half a unit in the last place of hi.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Distance {
    hi: f64,
    lo: f64,
}

impl Distance {
    /// Beyond every knot.
    pub const INFINITE: Self = Self::exactly(f64::INFINITY);

    /// None at all.
    pub const ZERO: Self = Self::exactly(0.0);

    /// One double.
    #[inline(always)]
    #[must_use]
    pub const fn exactly(x: f64) -> Self {
        Self { hi: x, lo: 0.0 }
    }

    /// a + b without rounding (Knuth).
    #[inline(always)]
    #[must_use]
    pub fn sum(a: f64, b: f64) -> Self {
        let hi = a + b;
        let shadow = hi - a;
        Self { hi, lo: (a - (hi - shadow)) + (b - shadow) }
    }

    /// a b without rounding (Dekker), for |a|, |b| < 1e150.
    #[inline(always)]
    #[must_use]
    pub fn product(a: f64, b: f64) -> Self {
        let split = |value: f64| {
            let scaled = 134_217_729.0 * value; // 2²⁷ + 1
            let head = scaled - (scaled - value);
            (head, value - head)
        };
        let ((a1, a2), (b1, b2)) = (split(a), split(b));
        let hi = a * b;
        Self { hi, lo: ((a1 * b1 - hi) + a1 * b2 + a2 * b1) + a2 * b2 }
    }

    /// This distance, `x` further.
    #[inline(always)]
    #[must_use]
    pub fn plus(self, x: f64) -> Self {
        let sum = Self::sum(self.hi, x);
        let lo = sum.lo + self.lo;
        let hi = sum.hi + lo;
        Self { hi, lo: lo - (hi - sum.hi) }
    }

    /// This distance, another one further.
    #[inline(always)]
    #[must_use]
    pub fn further(self, other: Self) -> Self {
        self.plus(other.hi).plus(other.lo)
    }

    /// self − other, rounded once where the two are close.
    #[inline(always)]
    #[must_use]
    pub fn minus(self, other: Self) -> f64 {
        (self.hi - other.hi) + (self.lo - other.lo)
    }

    /// Whether this distance is shorter than another.
    #[inline(always)]
    #[must_use]
    pub fn is_before(self, other: Self) -> bool {
        self.hi < other.hi || (self.hi == other.hi && self.lo < other.lo)
    }

    /// The shorter of two distances.
    #[inline(always)]
    #[must_use]
    pub fn shorter(self, other: Self) -> Self {
        if other.is_before(self) { other } else { self }
    }

    /// The nearest double.
    #[inline(always)]
    #[must_use]
    pub fn nearest(self) -> f64 {
        self.hi
    }
}

/// A whole number in the order of the nearest doubles, of which the comparison takes a fraction of
/// the time.
#[inline(always)]
pub(crate) const fn rank(nearest: f64) -> i64 {
    // −0 is 0, and below 0 the larger is the lesser.
    let bits = (nearest + 0.0).to_bits().cast_signed();
    bits ^ ((bits >> 63).cast_unsigned() >> 1).cast_signed()
}

/// `N` distances as two arrays, which plain loops run through faster than through pairs.
#[derive(Clone, Debug)]
pub(crate) struct Distances<const N: usize> {
    hi: [f64; N],
    lo: [f64; N],
}

impl<const N: usize> Distances<N> {
    pub const INFINITE: Self = Self { hi: [f64::INFINITY; N], lo: [0.0; N] };

    #[inline(always)]
    pub fn get(&self, i: usize) -> Distance {
        Distance { hi: self.hi[i], lo: self.lo[i] }
    }

    #[inline(always)]
    pub fn set(&mut self, i: usize, distance: Distance) {
        (self.hi[i], self.lo[i]) = (distance.hi, distance.lo);
    }

    /// `lag` + x, from a place on.
    #[inline(always)]
    pub fn shift(&mut self, to: usize, x: &[f64], lag: Distance) {
        let (hi, lo) = (&mut self.hi[to..to + x.len()], &mut self.lo[to..to + x.len()]);
        if lag == Distance::ZERO {
            hi.copy_from_slice(x);
            lo.fill(0.0);
            return;
        }
        for ((hi, lo), &x) in hi.iter_mut().zip(lo).zip(x) {
            Distance { hi: *hi, lo: *lo } = lag.plus(x);
        }
    }

    /// Their [`rank`]s.
    #[inline(always)]
    pub fn rank(&self, ranks: &mut [i64; N]) {
        for (to, hi) in ranks.iter_mut().zip(&self.hi) {
            *to = rank(*hi);
        }
    }

    /// Copies `count` distances of another array.
    #[inline(always)]
    pub fn copy<const M: usize>(&mut self, to: usize, other: &Distances<M>, from: usize, count: usize) {
        self.hi[to..to + count].copy_from_slice(&other.hi[from..from + count]);
        self.lo[to..to + count].copy_from_slice(&other.lo[from..from + count]);
    }

    /// Whether `count` distances are those of another array.
    #[inline(always)]
    pub fn same(&self, at: usize, other: &Self, from: usize, count: usize) -> bool {
        let differ = |a: &[f64], b: &[f64]| a.iter().zip(b).fold(false, |any, (a, b)| any | (a != b));
        !differ(&self.hi[at..at + count], &other.hi[from..from + count])
            && !differ(&self.lo[at..at + count], &other.lo[from..from + count])
    }

    /// Times at which the distances are reached, and from each to the next; whether there are
    /// some of these, all the same.
    #[inline(always)]
    pub fn divide(&self, speed: f64, time: &mut [f64], dt: &mut [f64]) -> bool {
        for (time, hi) in time.iter_mut().zip(&self.hi) {
            *time = hi / speed;
        }
        let (Some(dt), hi, lo) = (dt.get_mut(1..), &self.hi[1..], &self.lo[1..]) else { return false };
        let before = self.hi.iter().zip(&self.lo);
        for ((dt, (hi, lo)), (hi_before, lo_before)) in dt.iter_mut().zip(hi.iter().zip(lo)).zip(before) {
            *dt = (hi - hi_before) + (lo - lo_before);
        }
        let Some(&first) = dt.first() else { return false };
        let is_even = !dt.iter().fold(false, |any, dt| any | (*dt != first));
        if is_even {
            dt.fill(first / speed);
        } else {
            for dt in dt {
                *dt /= speed;
            }
        }
        is_even
    }
}
