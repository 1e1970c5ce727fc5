//! Four numbers side by side: one an oscillator, three modes and an idle lane.

use std::ops::{Mul, SubAssign};

/// Numbers in a [`Lanes`].
pub const LANES: usize = 4;

/// Four numbers on which arithmetic acts lane by lane. Written out so that the compiler turns
/// each operation into vector instructions of whatever width the machine has; no operation
/// mixes lanes or is fused, so the bits do not depend on it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Lanes(pub [f64; LANES]);

impl Lanes {
    /// All zero.
    pub const ZERO: Self = Self([0.0; LANES]);

    /// The same number in every lane.
    #[inline(always)]
    #[must_use]
    pub fn all(value: f64) -> Self {
        Self([value; LANES])
    }

    /// Lane by lane.
    #[inline(always)]
    #[must_use]
    pub fn map(self, f: impl Fn(f64) -> f64) -> Self {
        let [a, b, c, d] = self.0;
        Self([f(a), f(b), f(c), f(d)])
    }

    /// Lane by lane with another.
    #[inline(always)]
    #[must_use]
    pub fn zip(self, other: Self, f: impl Fn(f64, f64) -> f64) -> Self {
        let ([a, b, c, d], [p, q, r, s]) = (self.0, other.0);
        Self([f(a, p), f(b, q), f(c, r), f(d, s)])
    }

    /// Magnitudes.
    #[inline(always)]
    #[must_use]
    pub fn abs(self) -> Self {
        self.map(f64::abs)
    }

    /// The larger of two, neither NaN.
    #[inline(always)]
    #[must_use]
    pub fn max(self, other: Self) -> Self {
        self.zip(other, |a, b| if a > b { a } else { b })
    }

    /// The smaller of two, neither NaN.
    #[inline(always)]
    #[must_use]
    pub fn min(self, other: Self) -> Self {
        self.zip(other, |a, b| if a < b { a } else { b })
    }

    /// Whether any lane exceeds the other's.
    #[inline(always)]
    #[must_use]
    pub fn any_above(self, other: Self) -> bool {
        let ([a, b, c, d], [p, q, r, s]) = (self.0, other.0);
        (a > p) | (b > q) | (c > r) | (d > s)
    }

    /// Sum of products.
    #[inline(always)]
    #[must_use]
    pub fn dot(self, other: Self) -> f64 {
        let [a, b, c, d] = (self * other).0;
        (a + b) + (c + d)
    }
}

/// Arithmetic entry by entry, by the type's own `zip`, and access to the entries.
macro_rules! entrywise {
    ($type:ident) => {
        $crate::lanes::entrywise!($type, Add::add, |a, b| a + b);
        $crate::lanes::entrywise!($type, Sub::sub, |a, b| a - b);
        $crate::lanes::entrywise!($type, Mul::mul, |a, b| a * b);

        impl std::ops::AddAssign for $type {
            #[inline(always)]
            fn add_assign(&mut self, other: Self) {
                *self = *self + other;
            }
        }

        impl std::ops::Index<usize> for $type {
            type Output = f64;
            #[inline(always)]
            fn index(&self, lane: usize) -> &f64 {
                &self.0[lane]
            }
        }

        impl std::ops::IndexMut<usize> for $type {
            #[inline(always)]
            fn index_mut(&mut self, lane: usize) -> &mut f64 {
                &mut self.0[lane]
            }
        }
    };
    ($type:ident, $trait:ident :: $method:ident, $of_entries:expr) => {
        impl std::ops::$trait for $type {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                self.zip(other, $of_entries)
            }
        }
    };
}
pub(crate) use entrywise;

entrywise!(Lanes);

impl Mul<f64> for Lanes {
    type Output = Self;
    #[inline(always)]
    fn mul(self, factor: f64) -> Self {
        self.map(|value| value * factor)
    }
}

impl SubAssign for Lanes {
    #[inline(always)]
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}
