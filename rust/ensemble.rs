//! Many profiles at once: extremes and mean squares of every run, without its history.
//!
//! Stations are equally spaced, so every period, from one station under the foremost gears to the
//! next, is like any other: see `setup`. Eight runs are marched side by side (`kernel`), blocks
//! of eight on all threads. A run's results are the same bits whatever runs beside it.
//!
//! * True extremes: a block of periods whose values at the stations come close enough to a record,
//!   by the bound of [`crate::extremes`], leaves its legs to be searched when the run is over; most
//!   of them have been outdone by then (`records`).
//! * Mean squares: on every leg ∫F² is a quadratic form of the state at the start of its period and
//!   the rises under the gears. The forms are constant, so what is added up on the way are the
//!   products of these numbers, whatever the number of outputs and whatever the damping.

use std::ops::Range;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use rayon::prelude::*;

use crate::error::{Error, Place, Result, finite, positive};
use crate::modes::Modes;
use crate::watch::Pulse;

mod kernel;
mod records;
mod row;
mod setup;

use kernel::{Constants, March, PERIODS};
pub use row::{RUNS, Row};
use setup::{Setup, Stations};

/// Largest elevation: as in a profile, its square must stay in double precision.
const HIGHEST: f64 = 1e100;

/// How often a caller that wants to stop is listened to.
const PATIENCE: Duration = Duration::from_millis(50);

/// Where elevations come from.
pub trait Source: Sync {
    /// Reads them for one thread.
    type Reader<'a>: Reader
    where
        Self: 'a;

    /// A reader for one more thread.
    fn reader(&self) -> Self::Reader<'_>;
}

/// Gives the elevations of up to [`RUNS`] runs side by side.
pub trait Reader {
    /// Turns to `count` runs from `first` on.
    fn open(&mut self, first: usize, count: usize);

    /// Elevations of a track at so many stations from `first` on. Lanes without a run are to hold
    /// finite numbers.
    fn read(&mut self, track: usize, first: usize, out: &mut [Row]);
}

/// Elevations in memory, run by run, track by track.
#[derive(Clone, Copy, Debug)]
pub struct Memory<'a, T> {
    elevations: &'a [T],
    tracks: usize,
    stations: usize,
}

impl<'a, T: Copy + Into<f64> + Sync> Memory<'a, T> {
    /// Elevations of shape (runs, tracks, stations).
    ///
    /// # Panics
    /// If they are not a whole number of runs.
    #[must_use]
    pub fn new(elevations: &'a [T], tracks: usize, stations: usize) -> Self {
        assert_eq!(elevations.len() % (tracks * stations), 0);
        Self { elevations, tracks, stations }
    }

    /// Why a run gave no finite result: its first elevation that is not finite or out of range.
    #[must_use]
    pub fn fault(&self, run: usize) -> Error {
        let size = self.tracks * self.stations;
        let fault = self.elevations[run * size..][..size].iter().enumerate().find_map(|(i, &value)| {
            let place = Place::station("elevations", run, i / self.stations, i % self.stations);
            match finite(place, value.into()) {
                Ok(value) if value.abs() > HIGHEST => {
                    Some(Error::OutOfRange { place, value, why: "elevations up to 1e100 are allowed" })
                }
                Ok(_) => None,
                Err(error) => Some(error),
            }
        });
        fault.unwrap_or(Error::RunOverflow { run })
    }
}

/// Reads elevations in memory.
pub struct MemoryReader<'a, T> {
    memory: Memory<'a, T>,
    first: usize,
    count: usize,
}

impl<T: Copy + Into<f64> + Sync> Source for Memory<'_, T> {
    type Reader<'a>
        = MemoryReader<'a, T>
    where
        Self: 'a;

    fn reader(&self) -> MemoryReader<'_, T> {
        MemoryReader { memory: *self, first: 0, count: 1 }
    }
}

impl<T: Copy + Into<f64>> Reader for MemoryReader<'_, T> {
    fn open(&mut self, first: usize, count: usize) {
        (self.first, self.count) = (first, count);
    }

    fn read(&mut self, track: usize, first: usize, out: &mut [Row]) {
        let Memory { elevations, tracks, stations } = self.memory;
        let lanes: [&[T]; RUNS] = std::array::from_fn(|lane| {
            // An idle lane repeats the last run.
            let run = self.first + lane.min(self.count - 1);
            &elevations[(run * tracks + track) * stations + first..][..out.len()]
        });
        for (i, row) in out.iter_mut().enumerate() {
            for lane in 0..RUNS {
                row[lane] = lanes[lane][i].into();
            }
        }
    }
}

/// What many runs have in common, and what not.
#[derive(Clone, Debug)]
pub struct Plan {
    /// One for all runs, or one a run.
    pub modes: Vec<Arc<Modes>>,
    /// One for all runs, or one a run.
    pub speed: Vec<f64>,
    /// Tracks: one for all gears, or one a gear.
    pub tracks: usize,
    /// Stations of a track.
    pub stations: usize,
    /// Distance between them.
    pub spacing: f64,
    /// Points (x, y) of the body at which accelerations are wanted: a list for each of `modes`.
    pub points: Vec<Vec<(f64, f64)>>,
    /// Whether the gears' dampers take part in the ground input.
    pub damping_input: bool,
}

/// Results of many runs: arrays of rows, a row a run.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Statistics {
    /// Largest load of each gear.
    pub max_load: Vec<f64>,
    /// Smallest load of each gear.
    pub min_load: Vec<f64>,
    /// Root mean square of each load less the static load.
    pub rms_load: Vec<f64>,
    /// Largest magnitude of the acceleration at each point.
    pub max_acceleration: Vec<f64>,
    /// Root mean square of the acceleration at each point.
    pub rms_acceleration: Vec<f64>,
    /// Runs that gave no finite result, ascending; their rows are NaN.
    pub failed: Vec<usize>,
}

impl Statistics {
    fn append(&mut self, mut other: Self) {
        self.max_load.append(&mut other.max_load);
        self.min_load.append(&mut other.min_load);
        self.rms_load.append(&mut other.rms_load);
        self.max_acceleration.append(&mut other.max_acceleration);
        self.rms_acceleration.append(&mut other.rms_acceleration);
        self.failed.append(&mut other.failed);
    }
}

impl Plan {
    fn check(&self, runs: usize) -> Result<()> {
        let allowed = 1e-100..1e100;
        if !allowed.contains(&positive("spacing", self.spacing)?) {
            let place = Place::from("spacing");
            return Err(Error::OutOfRange { place, value: self.spacing, why: "1e-100 to 1e100 is allowed" });
        }
        let why = "one for all runs, or one a run";
        for (argument, found) in [("modes", self.modes.len()), ("speed", self.speed.len())] {
            if found != 1 && found != runs {
                return Err(Error::WrongLength { argument, found, expected: runs, why });
            }
        }
        let (gears, points) = (self.gears(), self.points[0].len());
        let why = "as many in all modes";
        for (modes, of_modes) in self.modes.iter().zip(&self.points) {
            for (argument, found, expected) in [
                ("modes: gears", modes.aircraft().gears().len(), gears),
                ("modes: stations", of_modes.len(), points),
            ] {
                if found != expected {
                    return Err(Error::WrongLength { argument, found, expected, why });
                }
            }
        }
        for (i, &speed) in self.speed.iter().enumerate() {
            let place = if self.speed.len() == 1 { Place::from("speed") } else { Place::at("speed", i) };
            positive(place, speed)?;
        }
        if self.stations == 0 {
            return Err(Error::TooShort { argument: "elevations", found: 0, least: 1 });
        }
        if self.tracks != 1 && self.tracks != gears {
            let why = "tracks: one for all gears, or one a gear";
            return Err(Error::WrongLength { argument: "elevations[0]", found: self.tracks, expected: gears, why });
        }
        Ok(())
    }

    fn setup(&self, run: usize) -> Result<Setup> {
        let Self { tracks, stations: count, spacing, .. } = *self;
        let stations = Stations { tracks, count, spacing };
        let case = if self.modes.len() == 1 { 0 } else { run };
        let speed = self.speed[if self.speed.len() == 1 { 0 } else { run }];
        Setup::new(&self.modes[case], stations, speed, &self.points[case], self.damping_input)
    }

    /// Gears of the aircraft.
    #[must_use]
    pub fn gears(&self) -> usize {
        self.modes[0].aircraft().gears().len()
    }

    /// Whether all runs are set up alike.
    fn is_single(&self) -> bool {
        self.modes.len() == 1 && self.speed.len() == 1
    }
}

/// Runs all profiles of a source.
///
/// # Errors
/// A plan that cannot be run, or what `pulse` gives.
pub fn simulate(plan: &Plan, runs: usize, source: &impl Source, pulse: Pulse) -> Result<Statistics> {
    plan.check(runs)?;
    let single = if plan.is_single() { Some(plan.setup(0)?) } else { None };
    let blocks: Vec<Range<usize>> =
        (0..runs).step_by(RUNS).map(|first| first..(first + RUNS).min(runs)).collect();
    let stop = AtomicBool::new(false);
    let work = |worker: &mut Worker<_>, block: &Range<usize>| worker.run(plan, single.as_ref(), block.clone(), &stop);
    let worker = || Worker { reader: source.reader(), setups: Vec::new() };
    let mut parts = Vec::new();
    let mut outcome = Ok(());
    if blocks.len() == 1 {
        parts.push(work(&mut worker(), &blocks[0]));
    } else {
        // Threads of its own, which a forked process has as well; the caller's listens.
        let threads = rayon::ThreadPoolBuilder::new().build().expect("threads");
        let (done, caller) = (AtomicBool::new(false), std::thread::current());
        threads.in_place_scope(|scope| {
            scope.spawn(|_| {
                parts = blocks.par_iter().map_init(worker, |worker, block| work(worker, block)).collect();
                done.store(true, Ordering::Release);
                caller.unpark();
            });
            while !done.load(Ordering::Acquire) && outcome.is_ok() {
                // The last block wakes the caller at once.
                std::thread::park_timeout(PATIENCE);
                outcome = pulse();
            }
            stop.store(outcome.is_err(), Ordering::Relaxed);
        });
    }
    outcome?;
    let mut all = Statistics::default();
    for part in parts {
        all.append(part?);
    }
    Ok(all)
}

/// One thread's tools.
struct Worker<R> {
    reader: R,
    setups: Vec<Setup>,
}

impl<R: Reader> Worker<R> {
    fn run(&mut self, plan: &Plan, single: Option<&Setup>, runs: Range<usize>, stop: &AtomicBool) -> Result<Statistics> {
        if let Some(setup) = single {
            if self.setups.is_empty() {
                self.setups.push(setup.clone());
            }
        } else {
            self.setups = runs.clone().map(|run| plan.setup(run)).collect::<Result<_>>()?;
        }
        let mut found = Statistics::default();
        // Runs march side by side as far as their stations fall alike.
        let mut from = 0;
        while from < runs.len() {
            let alike = if single.is_some() {
                runs.len()
            } else {
                let layout = &self.setups[from].layout;
                from + self.setups[from..].iter().take_while(|setup| setup.layout == *layout).count()
            };
            let setups = if single.is_some() { 0..1 } else { from..alike };
            self.reader.open(runs.start + from, alike - from);
            self.march(plan, setups, runs.start + from..runs.start + alike, stop, &mut found)?;
            from = alike;
        }
        Ok(found)
    }

    fn march(&mut self, plan: &Plan, which: Range<usize>, runs: Range<usize>, stop: &AtomicBool, found: &mut Statistics) -> Result<()> {
        let setups = &mut self.setups[which];
        let shared: Vec<&Setup> = setups.iter().collect();
        let constants = Constants::new(&shared);
        let layout = Arc::clone(&setups[0].layout);
        let mut march = March::new(&layout, &constants);
        march.start(&mut self.reader);
        for period in (0..layout.periods).step_by(PERIODS) {
            if stop.load(Ordering::Relaxed) {
                return Err(Error::Interrupted);
            }
            march.block(&mut self.reader, plan.stations, period, PERIODS.min(layout.periods - period), false);
        }
        march.block(&mut self.reader, plan.stations, layout.periods, 1, true);
        let March { records, moments, .. } = &mut march;
        let last = setups.len() - 1;
        for (lane, run) in runs.enumerate() {
            let setup = &mut setups[lane.min(last)];
            // What is not finite stays so, in state and moments.
            let valid = plan.stations > 1 || {
                let mut z = [Row::ZERO];
                (0..plan.tracks).all(|track| {
                    self.reader.read(track, 0, &mut z);
                    z[0][lane].is_finite()
                })
            };
            let valid = valid && moments.iter().flatten().all(|moment| moment[lane].is_finite());
            if !valid {
                found.failed.push(run);
            }
            for output in 0..setup.readings.len() {
                let nan = f64::NAN;
                let (max, min) = if valid { records.settle(setup, output, lane) } else { (nan, nan) };
                let mut square = 0.0;
                for (moments, form) in moments.iter().zip(&setup.readings[output].square) {
                    for row in 0..form.nrows() {
                        for column in 0..=row {
                            let twice = if row == column { 1.0 } else { 2.0 };
                            square += twice * form[(row, column)] * moments[row * (row + 1) / 2 + column][lane];
                        }
                    }
                }
                let mean = if setup.duration > 0.0 { square.max(0.0) / setup.duration } else { 0.0 };
                let rms = if valid { mean.sqrt() } else { nan };
                if output < layout.loads {
                    found.max_load.push(setup.static_load[output] + max);
                    found.min_load.push(setup.static_load[output] + min);
                    found.rms_load.push(rms);
                } else {
                    found.max_acceleration.push(max.max(-min));
                    found.rms_acceleration.push(rms);
                }
            }
        }
        Ok(())
    }
}
