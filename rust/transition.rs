//! The exact propagator of a bank of damped oscillators over one straight segment.
//!
//! One oscillator of frequency ω and damping ratio ζ follows a static position that
//! moves at a constant rate (Eq. 13, Eq. 14). With x = ωΔt and lengths in the
//! oscillator's own unit, its state is
//!
//! * `d`: displacement from the *current* static position, and
//! * `v`: velocity ÷ ω,
//!
//! and with β = rate of the static position ÷ ω, γ = constant force ÷ ω²,
//!
//! ```text
//! d(x) = d − G d + S v − H β + G γ        H = S + 2ζG
//! v(x) = v − S d − W v + G β + S γ        W = G + 2ζS
//! p(x) = p − G d + S v + K β + G γ        p: displacement from a fixed origin
//! ```
//!
//! where S is the impulse response, G = ∫S the step response and K = ∫G. Everything is
//! an *increment*: a short segment changes the state by a small number known to full
//! relative precision, so nothing is lost where textbook coefficients subtract nearly
//! equal numbers. `d` keeps the loads exact (no elevation enters), `p` keeps the
//! displacements exact.
//!
//! G satisfies G″ + 2ζG′ + G = 1, so its Taylor coefficients follow from ζ alone by a
//! two-term recurrence, and Δt is reached from a short Taylor step by doubling:
//! E(2x) = E(x)². One path serves undamped, underdamped, critical and overdamped motion
//! alike. It uses only +, − and × (and, once for the coefficients, ÷): the same bits on every machine.

use crate::lanes::Lanes;

/// Highest power of x in the Taylor polynomial of G. At max(1, 2ζ) x = 1 the first
/// term left out is below 2⁻⁵⁸ of the sum.
const DEGREE: usize = 19;

/// Coefficients of G ÷ x², and of K ÷ x³ = Σ aₙ xⁿ⁻² ÷ (n + 1).
const TERMS: usize = DEGREE - 1;

/// Up to this many radians the first [`SHORT_TERMS`] do: what they leave out is below 2⁻⁵⁷ of the sum.
const SHORT: f64 = 0.125;
const SHORT_TERMS: usize = TERMS - 8;

/// The transition over one segment, one lane an oscillator. See the module text.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transition {
    /// Step response, 1 − E₁₁.
    pub g: Lanes,
    /// Impulse response, E₁₂ = −E₂₁.
    pub s: Lanes,
    /// 1 − E₂₂.
    pub w: Lanes,
    /// How far `d` falls behind a static position that moves at unit rate.
    pub h: Lanes,
    /// How far `p` follows it.
    pub k: Lanes,
}

/// Motion of a bank of oscillators: `d`, `v` and `p` of the module text.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct State {
    /// Displacement from the current static position.
    pub d: Lanes,
    /// Velocity ÷ ω.
    pub v: Lanes,
    /// Displacement from a fixed origin; in a run, from where it starts.
    pub p: Lanes,
}

/// What drives a bank along one segment, constant on it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drive {
    /// Rate of the static position ÷ ω.
    pub beta: Lanes,
    /// Constant force ÷ ω² (the dampers' share of the ground input).
    pub gamma: Lanes,
}

impl State {
    /// At rest where it starts.
    pub const REST: Self = Self { d: Lanes::ZERO, v: Lanes::ZERO, p: Lanes::ZERO };
}

impl Transition {
    /// Carries a state over the segment while the static position moves at rate `beta`.
    #[inline(always)]
    #[must_use]
    pub fn follow(&self, from: &State, beta: Lanes) -> State {
        let (d, v, p) = (from.d, from.v, from.p);
        let pull = self.s * v - self.g * d;
        State {
            d: (d - self.h * beta) + pull,
            p: (p + self.k * beta) + pull,
            v: (v + self.g * beta) - (self.w * v + self.s * d),
        }
    }

    /// Carries a state over the segment.
    #[inline(always)]
    #[must_use]
    pub fn apply(&self, from: &State, drive: &Drive) -> State {
        let State { d, v, p } = self.follow(from, drive.beta);
        let push = self.g * drive.gamma;
        State { d: d + push, v: v + self.s * drive.gamma, p: p + push }
    }
}

/// A bank of oscillators: frequencies, damping ratios and what follows from them alone.
#[derive(Clone, Debug, PartialEq)]
pub struct Oscillators {
    /// Undamped circular frequencies, 0 in idle lanes.
    pub omega: Lanes,
    /// 2ζ.
    pub two_zeta: Lanes,
    /// Fastest rate of change, the largest ω max(1, 2ζ) of the bank: sets the Taylor step.
    stiffest: f64,
    taylor_g: [Lanes; TERMS],
    taylor_k: [Lanes; TERMS],
}

impl Oscillators {
    /// A bank of at most [`LANES`](crate::lanes::LANES) oscillators given as (ω, ζ).
    ///
    /// # Panics
    /// If there are more than [`LANES`](crate::lanes::LANES).
    #[must_use]
    pub fn new(modes: impl IntoIterator<Item = (f64, f64)>) -> Self {
        let mut bank = Self {
            omega: Lanes::ZERO,
            two_zeta: Lanes::ZERO,
            stiffest: 0.0,
            taylor_g: [Lanes::ZERO; TERMS],
            taylor_k: [Lanes::ZERO; TERMS],
        };
        for (lane, (omega, zeta)) in modes.into_iter().enumerate() {
            let two_zeta = 2.0 * zeta;
            bank.omega[lane] = omega;
            bank.two_zeta[lane] = two_zeta;
            bank.stiffest = bank.stiffest.max(omega * two_zeta.max(1.0));
            // a(n+2) (n+2)(n+1) + 2ζ a(n+1) (n+1) + a(n) = 0, from G″ + 2ζG′ + G = 1.
            let mut a = [0.0; DEGREE + 1];
            a[2] = 0.5;
            for n in 1..DEGREE - 1 {
                let m = n as f64;
                a[n + 2] = -(two_zeta * (m + 1.0) * a[n + 1] + a[n]) / ((m + 2.0) * (m + 1.0));
            }
            for (term, a) in a[2..].iter().enumerate() {
                bank.taylor_g[term][lane] = *a;
                bank.taylor_k[term][lane] = a / (term as f64 + 3.0);
            }
        }
        bank
    }

    /// Highest frequency.
    pub(crate) fn fastest(&self) -> f64 {
        self.omega.0.into_iter().fold(0.0, f64::max)
    }

    /// Largest ω max(1, 2ζ).
    pub(crate) fn stiffest(&self) -> f64 {
        self.stiffest
    }

    /// The transition over a time `dt` ≥ 0.
    #[inline(always)]
    #[must_use]
    pub fn over(&self, dt: f64) -> Transition {
        if self.is_short(dt) {
            return self.over_short(dt);
        }
        let (doublings, dt) = self.halved(dt);
        let mut step = self.step::<TERMS>(Lanes::all(dt));
        for _ in 0..doublings {
            step = self.doubled(&step);
        }
        step
    }

    /// A time halved until it is at most a radian of the stiffest mode: how often, and what is left.
    #[inline(always)]
    pub(crate) fn halved(&self, dt: f64) -> (u32, f64) {
        let doublings = doublings(self.stiffest * dt);
        (doublings, dt * power_of_half(doublings))
    }

    /// Longest power of two that is at most a radian of the stiffest mode, and its inverse.
    #[inline(always)]
    fn stride(&self) -> (f64, f64) {
        let exponent = (self.stiffest.to_bits() >> 52) & 0x7ff;
        let power = |exponent: u64| f64::from_bits(exponent << 52);
        (power(2045 - exponent), power(exponent + 1))
    }

    /// A time as whole strides and what is left, both exact.
    #[inline(always)]
    pub(crate) fn strides(&self, dt: f64) -> (f64, f64) {
        let (stride, inverse) = self.stride();
        let count = (dt * inverse).floor();
        (count, dt - count * stride)
    }

    /// The transition over one stride.
    pub(crate) fn over_stride(&self) -> Transition {
        self.over_parts(Lanes::all(self.stride().0))
    }

    /// The transition over at most a stride, a time a lane.
    #[inline(always)]
    pub(crate) fn over_parts(&self, dt: Lanes) -> Transition {
        self.step::<TERMS>(dt)
    }

    /// The bank with one of its oscillators in every lane: for several times side by side.
    pub(crate) fn alone(&self, lane: usize) -> Self {
        let alone = |lanes: &Lanes| Lanes::all(lanes[lane]);
        Self {
            omega: alone(&self.omega),
            two_zeta: alone(&self.two_zeta),
            stiffest: self.stiffest,
            taylor_g: self.taylor_g.each_ref().map(alone),
            taylor_k: self.taylor_k.each_ref().map(alone),
        }
    }

    /// Whether [`over_short`](Self::over_short) will do.
    #[inline(always)]
    pub(crate) fn is_short(&self, dt: f64) -> bool {
        self.stiffest * dt <= SHORT
    }

    /// The transition over a short time, by fewer terms.
    #[inline(always)]
    pub(crate) fn over_short(&self, dt: f64) -> Transition {
        self.over_short_parts(Lanes::all(dt))
    }

    /// The same, a time a lane.
    #[inline(always)]
    pub(crate) fn over_short_parts(&self, dt: Lanes) -> Transition {
        self.step::<SHORT_TERMS>(dt)
    }

    /// The transition over times of at most a radian, one a lane, by `N` terms of the series.
    #[inline(always)]
    fn step<const N: usize>(&self, dt: Lanes) -> Transition {
        let x = self.omega * dt;
        let square = x * x;
        let g = square * evaluate::<N>(&self.taylor_g, x, square);
        let k = (square * x) * evaluate::<N>(&self.taylor_k, x, square);
        // K + 2ζG + S = x, the equation of motion integrated once.
        let s = x - (k + self.two_zeta * g);
        Transition { g, s, w: g + self.two_zeta * s, h: s + self.two_zeta * g, k }
    }

    /// The transition over twice the time.
    #[inline(always)]
    pub(crate) fn doubled(&self, Transition { g, s, w, h, k }: &Transition) -> Transition {
        let two = Lanes::all(2.0);
        let square = *s * *s;
        let k = two * *k + *g * (*s + *h);
        let s = *s * (two - (*g + *w));
        let g = *g * (two - *g) + square;
        Transition { g, s, w: *w * (two - *w) + square, h: s + self.two_zeta * g, k }
    }
}

/// Smallest n ≥ 0 with x 2⁻ⁿ ≤ 1, read off the exponent (one more at exact powers of two).
#[inline]
fn doublings(x: f64) -> u32 {
    let exponent = ((x.to_bits() >> 52) & 0x7ff) as u32;
    exponent.saturating_sub(1022)
}

/// 2⁻ⁿ for n ≤ 1022, exact.
#[inline]
fn power_of_half(n: u32) -> f64 {
    f64::from_bits(u64::from(1023 - n.min(1022)) << 52)
}

/// Every fourth power in a chain of its own: a quarter of the latency of Horner's.
#[inline(always)]
fn evaluate<const N: usize>(series: &[Lanes; TERMS], x: Lanes, square: Lanes) -> Lanes {
    const { assert!(N % 4 == 2) };
    let fourth = square * square;
    let (low, top) = series[..N].split_at(N - 6);
    let mut chains = [top[0] + top[4] * fourth, top[1] + top[5] * fourth, top[2], top[3]];
    for four in low.rchunks_exact(4) {
        for (chain, term) in chains.iter_mut().zip(four) {
            *chain = *chain * fourth + *term;
        }
    }
    let [a, b, c, d] = chains;
    (a + b * x) + (c + d * x) * square
}
