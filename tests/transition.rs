//! The propagator against closed forms, and the laws that it must obey.

use proptest::prelude::*;
use proptest::test_runner::RngSeed;
use runway_modal::lanes::Lanes;
use runway_modal::transition::{Drive, Oscillators, State, Transition};

/// One oscillator with ω = 1: the transition over a phase x.
fn over(zeta: f64, x: f64) -> Transition {
    Oscillators::new([(1.0, zeta)]).over(x)
}

/// E₁₁, E₁₂ = −E₂₁ and E₂₂ by the textbook formula of each damping regime.
fn closed_form(zeta: f64, x: f64) -> [f64; 3] {
    if zeta < 1.0 {
        let damped = libm::sqrt((1.0 - zeta) * (1.0 + zeta));
        let decay = libm::exp(-zeta * x);
        let (sine, cosine) = (decay * libm::sin(damped * x) / damped, decay * libm::cos(damped * x));
        [cosine + zeta * sine, sine, cosine - zeta * sine]
    } else if zeta > 1.0 {
        let root = libm::sqrt((zeta - 1.0) * (zeta + 1.0));
        let fast = zeta + root;
        let slow = 1.0 / fast;
        let (slowly, quickly) = (libm::exp(-slow * x), libm::exp(-fast * x));
        let span = 2.0 * root;
        [
            (fast * slowly - slow * quickly) / span,
            (slowly - quickly) / span,
            (fast * quickly - slow * slowly) / span,
        ]
    } else {
        let decay = libm::exp(-x);
        [decay * (1.0 + x), decay * x, decay * (1.0 - x)]
    }
}

fn entries(transition: &Transition) -> [f64; 3] {
    [1.0 - transition.g[0], transition.s[0], 1.0 - transition.w[0]]
}

/// Rounding of a phase x, which every method shares, and of a few operations.
fn rounding(x: f64) -> f64 {
    f64::EPSILON * (8.0 + 4.0 * x)
}

fn first(value: f64) -> Lanes {
    Lanes([value, 0.0, 0.0, 0.0])
}

fn state(d: f64, v: f64) -> State {
    State { d: first(d), v: first(v), p: first(0.0) }
}

fn drive(beta: f64, gamma: f64) -> Drive {
    Drive { beta: first(beta), gamma: first(gamma) }
}

/// 1e-6 … 1e3, evenly over the decades.
fn phase() -> impl Strategy<Value = f64> {
    (-6.0..3.0).prop_map(|exponent| libm::pow(10.0, exponent))
}

/// All regimes; closed forms lose their digits next to ζ = 1, which has a test of its own.
fn damping() -> impl Strategy<Value = f64> {
    let away = |zeta: &f64| (zeta - 1.0).abs() > 0.02;
    prop_oneof![Just(0.0), Just(1e-6), Just(0.01), Just(1.0), (0.0..10.0).prop_filter("near 1", away)]
}

/// The same cases on every machine; the variable PROPTEST_CASES asks for more of them.
fn cases() -> ProptestConfig {
    ProptestConfig { rng_seed: RngSeed::Fixed(1980), failure_persistence: None, ..ProptestConfig::default() }
}

proptest! {
    #![proptest_config(cases())]

    #[test]
    fn agrees_with_the_closed_form(zeta in damping(), x in phase()) {
        let expected = closed_form(zeta, x);
        for (found, expected) in entries(&over(zeta, x)).into_iter().zip(expected) {
            // 1/√(1 − ζ²) amplifies the closed form's own rounding.
            let own = 1.0 / (1.0 - zeta * zeta).abs().clamp(1e-2, 1.0);
            prop_assert!((found - expected).abs() <= own * rounding(x), "{found:e} {expected:e}");
        }
    }

    #[test]
    fn short_segments_keep_relative_precision(zeta in 0.0..10.0, x in 1e-9..1e-3) {
        // Leading terms of the series; what they leave out is of the next order but one.
        let found = over(zeta, x);
        let left_out = (1.0 + 4.0 * zeta * zeta) * x * x + 8.0 * f64::EPSILON;
        let half_square = 0.5 * x * x;
        let step = half_square * (1.0 - 2.0 * zeta * x / 3.0);
        let lag = half_square * x / 3.0 * (1.0 - zeta * x / 2.0);
        prop_assert!((found.g[0] / step - 1.0).abs() <= left_out);
        prop_assert!((found.k[0] / lag - 1.0).abs() <= left_out);
        prop_assert!((found.s[0] / (x * (1.0 - zeta * x)) - 1.0).abs() <= left_out);
    }

    #[test]
    fn two_steps_make_one(
        zeta in 0.0..10.0, a in phase(), b in phase(),
        d in -1.0..1.0, v in -1.0..1.0, beta in -1.0..1.0, gamma in -1.0..1.0,
    ) {
        let (from, drive) = (state(d, v), drive(beta, gamma));
        let twice = over(zeta, b).apply(&over(zeta, a).apply(&from, &drive), &drive);
        let once = over(zeta, a + b).apply(&from, &drive);
        // The static position lags by 2ζβ and has gone β (a + b).
        let size = 3.0 + 4.0 * zeta + a + b;
        for (twice, once) in [(twice.d, once.d), (twice.v, once.v), (twice.p, once.p)] {
            prop_assert!((twice[0] - once[0]).abs() <= size * rounding(a + b));
        }
    }

    #[test]
    fn unforced_energy_never_grows(zeta in 0.0..10.0, x in phase(), d in -1.0..1.0, v in -1.0..1.0) {
        let after = over(zeta, x).apply(&state(d, v), &drive(0.0, 0.0));
        let energy = |s: &State| s.d[0] * s.d[0] + s.v[0] * s.v[0];
        prop_assert!(energy(&after) <= energy(&state(d, v)) * (1.0 + 2.0 * rounding(x)));
    }

    #[test]
    fn critical_damping_is_no_seam(x in phase(), side in prop_oneof![Just(-1e-9), Just(1e-9)]) {
        // The entries' derivatives by ζ are of order 1: x² and x³ times e^−x.
        let critical = closed_form(1.0, x);
        for (near, critical) in entries(&over(1.0 + side, x)).into_iter().zip(critical) {
            prop_assert!((near - critical).abs() <= 2.0 * side.abs() + rounding(x));
        }
    }
}

#[test]
fn oscillators_of_a_bank_do_not_meet() {
    let modes = [(7.27, 0.0), (12.0, 0.01), (18.2, 1.0), (300.0, 3.0)];
    let bank = Oscillators::new(modes).over(0.3);
    for (lane, (omega, zeta)) in modes.into_iter().enumerate() {
        let expected = closed_form(zeta, omega * 0.3);
        let found = [1.0 - bank.g[lane], bank.s[lane], 1.0 - bank.w[lane]];
        for (found, expected) in found.into_iter().zip(expected) {
            // The stiffest mode of the bank sets how often all of them are doubled.
            assert!((found - expected).abs() <= rounding(2.0 * 3.0 * 300.0 * 0.3));
        }
    }
}
