//! Sources of elevations, and stopping.

use std::sync::Arc;

use runway_modal::aircraft::{Aircraft, Gear, Inertia};
use runway_modal::ensemble::{Memory, Plan, Reader, Simd, Source, simulate};
use runway_modal::error::{Error, Result};
use runway_modal::modes::Modes;
use runway_modal::row::Row;
use runway_modal::watch::Pulse;

const STATIONS: usize = 400;

fn plan() -> Plan {
    let inertia = Inertia { mass: 145.5, pitch: 1.92e6, roll: 6.56e5, gravity: 386.0886 };
    let gear = |name, x, y, stiffness| Gear::new(name, x, y, stiffness, 0.0).unwrap();
    let gears = vec![
        gear("nose", 234.9, 0.0, 1502.0),
        gear("left", -44.35, 109.25, 9102.0),
        gear("right", -44.35, -109.25, 9102.0),
    ];
    let aircraft = Arc::new(Aircraft::new(inertia, gears).unwrap());
    Plan {
        modes: vec![Arc::new(Modes::natural(aircraft, Some(&[0.01])).unwrap())],
        speed: vec![500.0],
        tracks: 3,
        stations: STATIONS,
        spacing: 10.0,
        points: vec![vec![(0.0, 0.0)]],
        damping_input: false,
        between: true,
    }
}

/// Repeatable roughness, made where it is needed.
fn elevation(run: usize, track: usize, station: usize) -> f64 {
    let mut bits = (run * 3 + track) as u64 * 1_000_003 + station as u64;
    for _ in 0..3 {
        bits = (bits ^ (bits >> 31)).wrapping_mul(0x9E37_79B9_7F4A_7C15);
    }
    (bits >> 11) as f64 / (1_u64 << 53) as f64
}

struct Made;

struct MadeReader {
    first: usize,
    count: usize,
}

impl Source for Made {
    type Reader<'a> = MadeReader;

    fn reader(&self) -> MadeReader {
        MadeReader { first: 0, count: 0 }
    }
}

impl Reader for MadeReader {
    fn open(&mut self, first: usize, count: usize, _: Pulse) -> Result<()> {
        (self.first, self.count) = (first, count);
        Ok(())
    }

    fn read<S: Simd>(&mut self, _simd: S, track: usize, first: usize, out: &mut [Row]) {
        assert!(first + out.len() <= STATIONS);
        for (i, row) in out.iter_mut().enumerate() {
            for lane in 0..self.count {
                row[lane] = elevation(self.first + lane, track, first + i);
            }
        }
    }
}

#[test]
fn made_on_the_way_as_from_memory() {
    const RUNS: usize = 21;
    let at = |i: usize| elevation(i / STATIONS / 3, i / STATIONS % 3, i % STATIONS);
    let elevations: Vec<f64> = (0..RUNS * 3 * STATIONS).map(at).collect();
    let memory = Memory::new(&elevations, 3, STATIONS);
    let made = simulate(&plan(), RUNS, &Made, &mut || Ok(())).unwrap();
    assert_eq!(made, simulate(&plan(), RUNS, &memory, &mut || Ok(())).unwrap());
    assert!(made.failed.is_empty());
    assert_eq!(made.max_load.len(), 3 * RUNS);
    assert!(made.rms_acceleration.iter().all(|&rms| rms > 0.0));
}

#[test]
fn a_caller_can_stop() {
    let stopped = simulate(&plan(), 1_000_000, &Made, &mut || Err(Error::Interrupted));
    assert_eq!(stopped, Err(Error::Interrupted));
}

/// What these runs give, bit by bit, on any machine and from any build.
#[test]
fn same_bits_on_every_machine() {
    let found = simulate(&Plan { damping_input: true, ..plan() }, 21, &Made, &mut || Ok(())).unwrap();
    let results =
        [found.max_load, found.min_load, found.rms_load, found.max_acceleration, found.rms_acceleration];
    let digest = results
        .iter()
        .flatten()
        .fold(0_u64, |digest, x| (digest.rotate_left(5) ^ x.to_bits()).wrapping_mul(0x9E37_79B9_7F4A_7C15));
    assert_eq!(digest, 0x9ddd_fb02_1da7_971f, "{digest:#x}");
}
