//! The core alone: what a segment costs, on runs from a thousand to ten million of them, and
//! what one mat costs as a whole.
//!
//! One profile under three gears whose lag is a whole number of spacings, so that an equally
//! spaced profile has one knot a spacing. On an irregular one every gear adds its own.

use std::hint::black_box;
use std::sync::Arc;

use criterion::{BenchmarkId, Criterion, SamplingMode, Throughput, criterion_group, criterion_main};
use runway_modal::{profile::Profile, readout::Quantity, run::Run};

#[path = "../tests/f4e/mod.rs"]
mod f4e;

const SPEED: f64 = 405.0744; // 20 kt in in/s
const SPACING: f64 = 0.25; // in; the wheelbase is 1117 of them

/// Repeatable numbers in [0, 1).
fn uniform() -> impl FnMut() -> f64 {
    let mut bits = 1_u64;
    move || {
        bits = bits.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (bits >> 11) as f64 / (1_u64 << 53) as f64
    }
}

fn equal(segments: usize) -> Profile {
    let mut next = uniform();
    let x = (0..=segments).map(|i| SPACING * i as f64).collect();
    Profile::new(x, (0..=segments).map(|_| next()).collect()).unwrap()
}

/// No two segments of one length.
fn irregular(segments: usize) -> Profile {
    let mut next = uniform();
    let mut station = 0.0;
    let x = (0..=segments).map(|_| {
        station += SPACING * (0.5 + next());
        station
    });
    let x = x.collect();
    Profile::new(x, (0..=segments).map(|_| next()).collect()).unwrap()
}

fn over(profile: Profile) -> Run {
    let profile = Arc::new(profile);
    Run::new(f4e::modes(0.0, 0.01), &[Arc::clone(&profile), Arc::clone(&profile), profile], SPEED, false)
        .unwrap()
}

fn loads_and_pilot() -> [Quantity; 2] {
    [Quantity::Load, Quantity::Acceleration(vec![(0.0, 0.0)])]
}

/// Segments per second, the same for a thousand and for ten million.
fn segments(criterion: &mut Criterion) {
    // `--test` runs everything once: not the largest.
    let smoke = std::env::args().any(|argument| argument == "--test");
    let sizes: &[usize] = if smoke { &[1000] } else { &[1000, 10_000, 100_000, 1_000_000, 10_000_000] };
    let mut group = criterion.benchmark_group("segment");
    group.sampling_mode(SamplingMode::Flat).sample_size(10);
    for &size in sizes {
        for (name, profile) in [("equal", equal(size)), ("irregular", irregular(size))] {
            // Until the nose gear has passed the last knot: no tail of free vibration.
            let end = profile.x()[size] / SPEED;
            let run = over(profile);
            let grid = run.grid(Some(end)).unwrap();
            let most = grid.most;
            let (mut time, mut modal, mut rate) = (vec![0.0; most], vec![0.0; 3 * most], vec![0.0; 3 * most]);
            let span = (grid.begin, grid.end);
            group.throughput(Throughput::Elements(size as u64));
            group.bench_function(BenchmarkId::new(format!("sample/{name}"), size), |bencher| {
                bencher.iter(|| run.sample(grid, &mut time, &mut modal, &mut rate, &mut || Ok(())).unwrap());
            });
            group.bench_function(BenchmarkId::new(format!("extremes/{name}"), size), |bencher| {
                bencher.iter(|| run.extremes(&loads_and_pilot(), span, &mut || Ok(())).unwrap());
            });
        }
    }
    group.finish();
}

/// The full mat: setting up, default times, states at them, extremes.
fn one_mat(criterion: &mut Criterion) {
    let modes = f4e::modes(0.0, 0.01);
    let mat = Arc::new(Profile::new(vec![0.0, 12.0, 918.0, 930.0], vec![0.0, 1.5, 1.5, 0.0]).unwrap());
    let tracks = [Arc::clone(&mat), Arc::clone(&mat), mat];
    criterion.bench_function("one mat", |bencher| {
        bencher.iter(|| {
            let run = Run::new(Arc::clone(&modes), black_box(&tracks), SPEED, false).unwrap();
            let grid = run.grid(None).unwrap();
            let most = grid.most;
            let (mut time, mut modal, mut rate) = (vec![0.0; most], vec![0.0; 3 * most], vec![0.0; 3 * most]);
            run.sample(grid, &mut time, &mut modal, &mut rate, &mut || Ok(())).unwrap();
            let span = (grid.begin, grid.end);
            let extremes = run.extremes(&loads_and_pilot(), span, &mut || Ok(())).unwrap();
            (time, modal, rate, extremes)
        });
    });
}

criterion_group!(benches, segments, one_mat);
criterion_main!(benches);
