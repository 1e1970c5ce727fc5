//! Laws of spectra, coherencies and random profiles, through the interface of the core alone.

use std::f64::consts::TAU;

use runway_modal::coherence::Coherency;
use runway_modal::error::{Error, Result};
use runway_modal::roughness::{Generator, Stretch};
use runway_modal::row::RUNS;
use runway_modal::spectrum::{PowerLaw, Spectrum};
use runway_modal::watch::Pulse;

const STRETCH: Stretch = Stretch { length: 300.0, spacing: 0.5 };

fn class_a(waviness: f64) -> Spectrum {
    let law = PowerLaw { coefficient: 16e-6, waviness, reference: 0.1, band: (0.01, 1.0) };
    Spectrum::power_law(law).unwrap()
}

#[expect(clippy::unnecessary_wraps, reason = "a pulse")]
fn go_on() -> Result<()> {
    Ok(())
}

fn consecutive(first: u64) -> [u64; RUNS] {
    std::array::from_fn(|lane| first + lane as u64)
}

/// ∫ c (n/r)^−w dn by hand, and additive whatever the cuts.
#[test]
fn variance() {
    for waviness in [0.0, 1.0, 1.0 + 1e-12, 2.0, 2.2, 7.0] {
        let spectrum = class_a(waviness);
        let primitive = |n: f64| {
            let x: f64 = n / 0.1;
            if (waviness - 1.0).abs() < 1e-9 { x.ln() } else { x.powf(1.0 - waviness) / (1.0 - waviness) }
        };
        let by_hand = 16e-6 * 0.1 * (primitive(1.0) - primitive(0.01));
        let found = spectrum.variance(0.0, 9.0);
        assert!((found / by_hand - 1.0).abs() < 1e-9, "{waviness}: {found} {by_hand}");

        let cuts: Vec<f64> = (0..=1000).map(|i| 0.0011 * f64::from(i)).collect();
        let sum: f64 = cuts.windows(2).map(|cut| spectrum.variance(cut[0], cut[1])).sum();
        assert!((sum / found - 1.0).abs() < 1e-13);
    }
}

/// A table with points on a power law is that power law.
#[test]
fn table_of_a_power_law() {
    let law = class_a(2.0);
    let n: Vec<f64> = [0.01, 0.02, 0.1, 0.5, 1.0].to_vec();
    let density: Vec<f64> = n.iter().map(|&n| law.density(n)).collect();
    let table = Spectrum::table(&n, &density).unwrap();
    for i in 0..=200 {
        let n = 0.006 * f64::from(i);
        assert!((table.density(n) - law.density(n)).abs() <= 1e-14 * law.density(n));
        assert!(
            (table.variance(n, 2.0 * n) - law.variance(n, 2.0 * n)).abs() <= 1e-13 * law.variance(0.0, 9.0)
        );
    }
}

/// Bessel functions of half-integer order are elementary.
#[test]
fn coherency_in_closed_form() {
    let (one, three) = (Coherency::new(1.0), Coherency::new(3.0));
    for i in 0..400 {
        let x = 1e-9 * 1.07_f64.powi(i);
        let n = x / TAU;
        assert!((one.at(n, 1.0) - (-x).exp()).abs() < 2e-15, "{x}");
        assert!((three.at(n, 1.0) - (1.0 + x) * (-x).exp()).abs() < 2e-15, "{x}");
    }
}

/// L Lᵀ gives the coherencies back, for tracks that are nearly one too.
#[test]
fn factors() {
    let coherency = Coherency::new(2.0);
    for y in [&[0.0, 2.77, -2.77][..], &[0.0, 1e-9, 5.0, 5.0 + 1e-7], &[1.0, 2.0, 3.0, 4.0, 5.0]] {
        for n in [1e-6, 1e-3, 0.03, 1.0, 50.0] {
            let mut triangle = vec![];
            coherency.factor(n, y, &mut triangle);
            let entry = |i: usize, j: usize| if j > i { 0.0 } else { triangle[i * (i + 1) / 2 + j] };
            for (i, j) in (0..y.len()).flat_map(|i| (0..=i).map(move |j| (i, j))) {
                let product: f64 = (0..y.len()).map(|k| entry(i, k) * entry(j, k)).sum();
                let expected = if i == j { 1.0 } else { coherency.at(n, (y[i] - y[j]).abs()) };
                assert!((product - expected).abs() < 1e-7, "{y:?} {n}: {product} {expected}");
            }
        }
    }
}

/// A run is itself in any lane, beside any others.
#[test]
fn any_company() {
    let generator = Generator::new(&class_a(2.0), STRETCH, &[0.0, 5.0], 1980, &mut go_on).unwrap();
    let (mut block, mut other) = (generator.block(), generator.block());
    generator.fill(consecutive(731), &mut block, &mut go_on).unwrap();
    generator.fill([5, 4, 3, u64::MAX, 734, 731, 731, 0], &mut other, &mut go_on).unwrap();
    for track in 0..2 {
        for (row, other) in block.track(track).iter().zip(other.track(track)) {
            assert_eq!([row[3], row[0], row[0]], other.0[4..7]);
            assert_ne!(row[0], other[7]);
        }
    }
}

/// Bits that every machine must give, and every build.
#[test]
fn same_bits_on_every_machine() {
    let generator = Generator::new(&class_a(2.0), STRETCH, &[0.0, 5.0], 1980, &mut go_on).unwrap();
    let mut block = generator.block();
    generator.fill(consecutive(731), &mut block, &mut go_on).unwrap();
    let mut bits = 0_u64;
    for row in [0, 1].into_iter().flat_map(|track| &block.track(track)[..generator.stations()]) {
        for value in row.0 {
            bits = (bits ^ value.to_bits()).wrapping_mul(0x0000_0100_0000_01b3);
        }
    }
    assert_eq!(bits, 0x7744_bbb2_bc93_b76c, "{bits:#018x}");
}

/// A finer grid and a longer period: the spectrum alone sets the variance of a station.
#[test]
fn variance_of_a_station() {
    for (length, spacing) in [(20.0, 0.5), (50.0, 0.1), (111.0, 0.37)] {
        let generator =
            Generator::new(&class_a(2.0), Stretch { length, spacing }, &[0.0], 3, &mut go_on).unwrap();
        let (mut block, mut sum, runs) = (generator.block(), 0.0, 800);
        for first in (0..runs).step_by(RUNS) {
            generator.fill(consecutive(first), &mut block, &mut go_on).unwrap();
            sum += block.track(0)[7].0.iter().map(|z| z * z).sum::<f64>();
        }
        let share = sum / runs as f64 / class_a(2.0).variance(0.0, 9.0);
        // Four standard errors of the variance of so many normal deviates.
        assert!((share - 1.0).abs() < 4.0 * (2.0 / runs as f64).sqrt(), "{share}");
    }
}

/// At whatever question, in the middle of drawing or summing.
#[test]
fn stops_when_asked() {
    let stretch = Stretch { length: 20_000.0, spacing: 0.5 };
    let generator = Generator::new(&class_a(2.0), stretch, &[0.0, 5.0, -5.0], 1, &mut go_on).unwrap();
    let mut block = generator.block();
    let mut fill = |patience: usize| {
        let mut asked = 0;
        let outcome = generator.fill(consecutive(0), &mut block, &mut || {
            asked += 1;
            if asked > patience { Err(Error::Interrupted) } else { Ok(()) }
        });
        (outcome, asked)
    };
    let (outcome, questions) = fill(usize::MAX);
    assert!(outcome.is_ok() && questions >= 5, "{questions}");
    for patience in 0..questions {
        assert_eq!(fill(patience), (Err(Error::Interrupted), patience + 1));
    }
    let stop: Pulse = &mut || Err(Error::Interrupted);
    let mut out = vec![0.0; generator.stations() * 3];
    assert_eq!(generator.elevations(0, &mut out, stop), Err(Error::Interrupted));
}
