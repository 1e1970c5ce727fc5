//! Sources of elevations, and stopping.

use runway_modal::ensemble::{Case, Memory, Plan, Reader, Shape, Simd, Source, simulate};
use runway_modal::error::{Error, Result};
use runway_modal::row::Row;
use runway_modal::watch::Pulse;

mod f4e;

const STATIONS: usize = 400;

fn plan() -> Plan {
    let cases = vec![Case { modes: f4e::modes(0.0, 0.01), points: vec![(0.0, 0.0)] }];
    Plan { cases, speed: vec![500.0], spacing: 10.0, damping_input: false, between: true }
}

/// Repeatable roughness, made where it is needed.
fn elevation(run: usize, track: usize, station: usize) -> f64 {
    let mut bits = (run * 3 + track) as u64 * 1_000_003 + station as u64;
    for _ in 0..3 {
        bits = (bits ^ (bits >> 31)).wrapping_mul(0x9E37_79B9_7F4A_7C15);
    }
    (bits >> 11) as f64 / (1_u64 << 53) as f64
}

/// So many runs.
struct Made(usize);

struct MadeReader {
    first: usize,
    count: usize,
}

impl Source for Made {
    type Reader<'a> = MadeReader;

    fn shape(&self) -> Shape {
        Shape { runs: self.0, tracks: 3, stations: STATIONS }
    }

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

    fn elevation(&self, run: usize, track: usize, station: usize) -> f64 {
        elevation(self.first + run, track, station)
    }
}

#[test]
fn made_on_the_way_as_from_memory() {
    let made = Made(21);
    let at = |i: usize| elevation(i / STATIONS / 3, i / STATIONS % 3, i % STATIONS);
    let elevations: Vec<f64> = (0..21 * 3 * STATIONS).map(at).collect();
    let memory = Memory::new(&elevations, made.shape()).unwrap();
    let found = simulate(&plan(), &made, &mut || Ok(())).unwrap();
    assert_eq!(found, simulate(&plan(), &memory, &mut || Ok(())).unwrap());
    assert!(found.failed.is_empty());
    assert_eq!(found.max_load.len(), 3 * 21);
    assert!(found.rms_acceleration.iter().all(|&rms| rms > 0.0));
}

#[test]
fn plans_that_do_not_fit_are_refused() {
    let refused = |plan: Plan, shape: Shape, words: &str| {
        let elevations = vec![0.0; shape.runs * shape.tracks * shape.stations];
        let memory = Memory::new(&elevations, shape).unwrap();
        let said = simulate(&plan, &memory, &mut || Ok(())).unwrap_err().to_string();
        assert!(said.contains(words), "{said}");
    };
    let shape = Shape { runs: 2, tracks: 3, stations: 4 };
    refused(Plan { cases: Vec::new(), ..plan() }, shape, "modes has 0 entries, 2 expected");
    refused(Plan { speed: vec![1.0; 3], ..plan() }, shape, "speed has 3 entries, 2 expected");
    refused(Plan { spacing: -1.0, ..plan() }, shape, "spacing = -1.0");
    let mut cases = vec![plan().cases[0].clone(), plan().cases[0].clone()];
    cases[1].points.clear();
    refused(Plan { cases, ..plan() }, shape, "stations has 0 entries, 1 expected");
    refused(plan(), Shape { tracks: 2, ..shape }, "elevations[0] has 2 entries, 3 expected");
    refused(plan(), Shape { stations: 0, ..shape }, "elevations has 0 entries");
    assert!(Memory::new(&[0.0; 5], shape).is_err());
    let none = Memory::<f64>::new(&[], Shape { runs: 0, ..shape }).unwrap();
    assert!(simulate(&plan(), &none, &mut || Ok(())).unwrap().max_load.is_empty());
}

#[test]
fn a_caller_can_stop() {
    let stopped = simulate(&plan(), &Made(1_000_000), &mut || Err(Error::Interrupted));
    assert_eq!(stopped, Err(Error::Interrupted));
}

/// What these runs give, bit by bit, on any machine and from any build.
#[test]
fn same_bits_on_every_machine() {
    let found = simulate(&Plan { damping_input: true, ..plan() }, &Made(21), &mut || Ok(())).unwrap();
    let results =
        [found.max_load, found.min_load, found.rms_load, found.max_acceleration, found.rms_acceleration];
    let digest = results
        .iter()
        .flatten()
        .fold(0_u64, |digest, x| (digest.rotate_left(5) ^ x.to_bits()).wrapping_mul(0x9E37_79B9_7F4A_7C15));
    assert_eq!(digest, 0x9ddd_fb02_1da7_971f, "{digest:#x}");
}
