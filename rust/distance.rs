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
    pub const INFINITE: Self = Self { hi: f64::INFINITY, lo: 0.0 };

    /// a + b without rounding (Knuth).
    #[inline]
    #[must_use]
    pub fn sum(a: f64, b: f64) -> Self {
        let hi = a + b;
        let shadow = hi - a;
        Self { hi, lo: (a - (hi - shadow)) + (b - shadow) }
    }

    /// a b without rounding (Dekker), for |a|, |b| < 1e150.
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
    #[inline]
    #[must_use]
    pub fn plus(self, x: f64) -> Self {
        let sum = Self::sum(self.hi, x);
        let lo = sum.lo + self.lo;
        let hi = sum.hi + lo;
        Self { hi, lo: lo - (hi - sum.hi) }
    }

    /// self − other, rounded once where the two are close.
    #[inline]
    #[must_use]
    pub fn minus(self, other: Self) -> f64 {
        (self.hi - other.hi) + (self.lo - other.lo)
    }

    /// The shorter of two distances.
    #[inline(always)]
    #[must_use]
    pub fn shorter(self, other: Self) -> Self {
        // Without branches: which gear comes next is not to be guessed.
        let other_first = (other.hi < self.hi) | ((other.hi == self.hi) & (other.lo < self.lo));
        if other_first { other } else { self }
    }

    /// The nearest double.
    #[inline]
    #[must_use]
    pub fn nearest(self) -> f64 {
        self.hi
    }
}
