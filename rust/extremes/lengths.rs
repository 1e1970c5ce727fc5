//! How far a mode is from its moving steady position: lengths that never grow.

use crate::lanes::{LANES, Lanes};
use crate::transition::{Drive, Oscillators, State};

/// A number a mode, and another for the fast exponential of an overdamped one.
#[derive(Clone, Copy)]
pub(crate) struct SlowFast(pub [Lanes; 2]);

impl SlowFast {
    #[inline(always)]
    pub fn dot(self, other: Self) -> f64 {
        self.0[0].dot(other.0[0]) + self.0[1].dot(other.0[1])
    }
}

/// Beyond this 2ζ a mode counts as two exponentials; below, they are too much alike.
const APART: f64 = 2.5;

/// Rates ÷ ω of the two exponentials of a mode with 2ζ > [`APART`], slow and fast.
pub(super) fn rates(two_zeta: f64) -> Option<[f64; 2]> {
    let fast = 0.5 * two_zeta * (1.0 + (1.0 - 4.0 / two_zeta / two_zeta).sqrt());
    (two_zeta > APART).then_some([1.0 / fast, fast])
}

/// How lengths follow from y and w = ẏ/ω, lane by lane: a mode that oscillates has the length
/// of (y, w), an overdamped one |slow · (y, w)| and |fast · (y, w)|.
pub(crate) struct Lengths {
    slow: [Lanes; 2],
    across: Lanes,
    fast: [Lanes; 2],
}

impl Lengths {
    pub fn new(bank: &Oscillators) -> Self {
        let none = Lanes::ZERO;
        let mut lengths = Self { slow: [Lanes::all(1.0), none], across: Lanes::all(1.0), fast: [none; 2] };
        for i in 0..LANES {
            if let Some([slow, fast]) = rates(bank.two_zeta[i]) {
                let scale = 1.0 / (fast - slow);
                (lengths.slow[0][i], lengths.slow[1][i]) = (fast * scale, scale);
                (lengths.fast[0][i], lengths.fast[1][i]) = (slow * scale, scale);
                lengths.across[i] = 0.0;
            }
        }
        lengths
    }

    /// Components: along the slow exponential (or y), across it (w, or nothing), along the fast.
    #[inline(always)]
    fn parts(&self, (y, w): (Lanes, Lanes)) -> [Lanes; 3] {
        let Self { slow, across, fast } = self;
        [slow[0] * y + slow[1] * w, *across * w, fast[0] * y + fast[1] * w]
    }

    #[inline(always)]
    pub fn of(&self, departure: (Lanes, Lanes)) -> SlowFast {
        let [slow, across, fast] = self.parts(departure);
        SlowFast([(slow * slow + across * across).map(f64::sqrt), fast.abs()])
    }

    /// Weights of |y| and |ẏ/ω| in a sum that is not less than `weights` · lengths.
    pub fn bound_weights(&self, SlowFast([one, other]): SlowFast) -> [Lanes; 2] {
        let Self { slow, across, fast } = self;
        [
            one * slow[0].abs() + other * fast[0].abs(),
            one * (slow[1].abs() + across.abs()) + other * fast[1].abs(),
        ]
    }

    /// Not less than the lengths, without their root.
    #[inline(always)]
    pub fn at_most(&self, departure: (Lanes, Lanes)) -> SlowFast {
        let [slow, across, fast] = self.parts(departure);
        SlowFast([slow.abs() + across.abs(), fast.abs()])
    }
}

/// The moving steady position: y and ẏ/ω.
#[inline(always)]
pub(super) fn steady(bank: &Oscillators, drive: &Drive) -> (Lanes, Lanes) {
    (drive.gamma - bank.two_zeta * drive.beta, drive.beta)
}

/// Departure from it.
#[inline(always)]
pub(super) fn departure(bank: &Oscillators, drive: &Drive, state: &State) -> (Lanes, Lanes) {
    let (y, w) = steady(bank, drive);
    (state.d - y, state.v - w)
}
