//! Two segments of one length at a stride.
//!
//! A march is a chain in which each state waits for the one before. Over two equal segments the
//! second state can be had from the same one as the first: half as many links. With E and f of the
//! one segment, y₂ = E² y₀ + E f β₀ + f β₁. All of it are increments, as over one segment.

use crate::lanes::Lanes;
use crate::transition::{Oscillators, State, Transition};

/// The transitions over one segment and over two of them.
// Aligned, so that no vector that the march reads lies across two cache lines: 3 % of its time.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(32))]
pub(crate) struct Pair {
    pub once: Transition,
    /// E² (its `h` and `k` are those of one slope on both).
    twice: Transition,
    /// E f: what a unit rate on the first segment has done to d, v and p by the end of the second.
    first: State,
    /// Length of each.
    pub dt: f64,
}

impl Pair {
    pub fn new(bank: &Oscillators, dt: f64) -> Self {
        let once = bank.over(dt);
        let Transition { g, s, w, h, k } = once;
        let pull = s * g + g * h;
        let first = State { d: pull - h, v: (g + s * h) - w * g, p: k + pull };
        Self { once, twice: bank.doubled(&once), first, dt }
    }

    /// Carries a state over both segments, on which the static position moves at two rates.
    #[inline(always)]
    pub fn follow(&self, from: &State, [one, two]: [Lanes; 2]) -> State {
        let Self { once, twice, first, .. } = self;
        let pull = twice.s * from.v - twice.g * from.d;
        State {
            d: (from.d + (first.d * one - once.h * two)) + pull,
            p: (from.p + (first.p * one + once.k * two)) + pull,
            v: (from.v + (first.v * one + once.g * two)) - (twice.w * from.v + twice.s * from.d),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lanes::LANES;

    #[test]
    fn is_twice_a_segment() {
        let bank = Oscillators::new([(1.0, 0.0), (3.0, 0.02), (0.2, 1.0), (1.5, 4.0)]);
        let start = State {
            d: Lanes([1.0, -0.3, 0.7, 0.1]),
            v: Lanes([-0.2, 0.9, 0.4, -1.0]),
            p: Lanes([3.0, 0.0, -2.0, 0.5]),
        };
        let rates = [Lanes([0.3, -1.0, 0.0, 2.0]), Lanes([-0.7, 0.4, 1.1, 0.6])];
        for dt in [1e-9, 1e-4, 0.02, 0.3, 5.0, 700.0] {
            let once = bank.over(dt);
            let expected = once.follow(&once.follow(&start, rates[0]), rates[1]);
            let found = Pair::new(&bank, dt).follow(&start, rates);
            let parts = [(found.d, expected.d), (found.v, expected.v), (found.p, expected.p)];
            for (found, expected) in parts {
                for lane in 0..LANES {
                    let allowed = 2e-15 * (3.0 + expected[lane].abs());
                    assert!((found[lane] - expected[lane]).abs() <= allowed, "dt = {dt}, lane {lane}");
                }
            }
        }
    }
}
