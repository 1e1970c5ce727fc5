//! Many profiles at once: extremes and mean squares of every run, without its history.
//!
//! Stations are equally spaced, so every period, from one station under the foremost gears to the
//! next, is like any other: see `setup`. Eight runs are marched side by side (`kernel`), blocks
//! of eight on all threads. A run's results are the same bits whatever runs beside it.
//!
//! * True extremes: outputs are looked at where their slopes may jump. Chunks of eight periods on which
//!   a record may be broken in between, by the bound of [`crate::extremes`], are kept and gone over
//!   again when the run is over: most of them have been outdone by then (`kernel::sift`). The legs
//!   that are left are searched (`records`).
//! * Mean squares: on every leg ∫F² is a quadratic form of the state at the start of its period and
//!   the rises under the gears. The forms are constant, so only the products of these numbers are
//!   added up along the run, whatever the number of outputs and whatever the damping.

use std::ops::Range;
use std::sync::Arc;

use crate::error::{Error, Place, Result, finite, positive};
use crate::modes::Modes;
use crate::parallel::{self, Tools};
use crate::row::{RUNS, Row};
use crate::run::{LAST_KNOT, check_speed};
use crate::watch::{Pulse, Watch};

mod ahead;
mod constants;
mod kernel;
mod records;
mod setup;
mod squares;
mod vector;

pub use ahead::Ahead;
use constants::Constants;
use kernel::{March, PERIODS};
use pulp::Arch;
pub use pulp::Simd;
use setup::{Setup, Stations};

/// Largest elevation: as in a profile, its square must stay in double precision.
const HIGHEST: f64 = 1e100;

/// Where elevations come from.
pub trait Source: Sync {
    /// Reads them, for one thread at a time.
    type Reader<'a>: Reader + Send
    where
        Self: 'a;

    /// One more reader.
    fn reader(&self) -> Self::Reader<'_>;
}

/// Gives the elevations of up to [`RUNS`] runs side by side.
pub trait Reader {
    /// Turns to `count` runs from `first` on.
    ///
    /// # Errors
    /// What `pulse` gives: making elevations takes time.
    fn open(&mut self, first: usize, count: usize, pulse: Pulse) -> Result<()>;

    /// Elevations of a track at so many stations from `first` on, by the instructions of `simd`. Lanes
    /// without a run are to hold finite numbers.
    fn read<S: Simd>(&mut self, simd: S, track: usize, first: usize, out: &mut [Row]);

    /// Says where in memory the elevations stand, if they are there, that will be read next: of a
    /// track, so many from `first` on.
    fn foresee(&self, _track: usize, _first: usize, _count: usize, _ahead: &mut Ahead) {}
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
        fault.unwrap_or(Error::RunOverflow { place: Place::at("elevations", run) })
    }
}

/// Reads elevations in memory.
pub struct MemoryReader<'a, T> {
    memory: Memory<'a, T>,
    runs: Range<usize>,
}

impl<T: Copy + Into<f64> + Sync> Source for Memory<'_, T> {
    type Reader<'a>
        = MemoryReader<'a, T>
    where
        Self: 'a;

    fn reader(&self) -> MemoryReader<'_, T> {
        MemoryReader { memory: *self, runs: 0..1 }
    }
}

impl<T> Memory<'_, T> {
    /// So many elevations of a track from station `first` on, of these runs.
    #[inline(always)]
    fn lanes(&self, runs: &Range<usize>, track: usize, first: usize, count: usize) -> [&[T]; RUNS] {
        std::array::from_fn(|lane| {
            // An idle lane repeats the last run.
            let run = (runs.start + lane).min(runs.end - 1);
            &self.elevations[(run * self.tracks + track) * self.stations + first..][..count]
        })
    }
}

impl<T: Copy + Into<f64>> Reader for MemoryReader<'_, T> {
    fn open(&mut self, first: usize, count: usize, _: Pulse) -> Result<()> {
        self.runs = first..first + count;
        Ok(())
    }

    #[inline(always)]
    fn read<S: Simd>(&mut self, simd: S, track: usize, first: usize, out: &mut [Row]) {
        vector::turn(simd, self.memory.lanes(&self.runs, track, first, out.len()), out);
    }

    fn foresee(&self, track: usize, first: usize, count: usize, ahead: &mut Ahead) {
        let Memory { elevations, tracks, stations } = self.memory;
        let (mut runs, mut first) = (self.runs.clone(), first);
        if first >= stations {
            // Most likely the next runs are up next.
            let all = elevations.len() / (tracks * stations);
            (runs, first) = (runs.end..all.min(runs.end + RUNS), 0);
        }
        if !runs.is_empty() {
            ahead.extend(self.memory.lanes(&runs, track, first, count.min(stations - first)));
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
    /// Whether extremes are looked for between the gears' stations too.
    pub between: bool,
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
    /// Whether all results of the run read last are finite; its row becomes NaN if not.
    fn last_is_finite(&mut self, gears: usize, points: usize) -> bool {
        let all = [
            (&mut self.max_load, gears),
            (&mut self.min_load, gears),
            (&mut self.rms_load, gears),
            (&mut self.max_acceleration, points),
            (&mut self.rms_acceleration, points),
        ];
        let rows = all.map(|(values, columns)| values.rchunks_mut(columns.max(1)).next().unwrap_or_default());
        let finite = rows.iter().all(|row| row.iter().all(|value| value.is_finite()));
        if !finite {
            for row in rows {
                row.fill(f64::NAN);
            }
        }
        finite
    }

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
        let why = "one for all runs, or one per run";
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
            check_speed(self.place_of_speed(i), speed)?;
        }
        if self.stations == 0 {
            return Err(Error::TooShort { argument: "elevations", found: 0, least: 1 });
        }
        if self.tracks != 1 && self.tracks != gears {
            let why = "tracks: one for all gears, or one per gear";
            return Err(Error::WrongLength {
                argument: "elevations[0]",
                found: self.tracks,
                expected: gears,
                why,
            });
        }
        Ok(())
    }

    fn setup(&self, run: usize) -> Result<Setup> {
        let Self { tracks, stations: count, spacing, .. } = *self;
        let stations = Stations { tracks, count, spacing };
        let case = if self.modes.len() == 1 { 0 } else { run };
        let speed = self.speed[if self.speed.len() == 1 { 0 } else { run }];
        let setup = Setup::new(&self.modes[case], stations, speed, &self.points[case], self.damping_input);
        setup.map_err(|error| match error {
            // The time over the profiles: all but the speed is as for other runs.
            Error::OutOfRange { place, why, .. } if place == Place::from(LAST_KNOT) => {
                Error::OutOfRange { place: self.place_of_speed(run), value: speed, why }
            }
            other => other,
        })
    }

    fn place_of_speed(&self, run: usize) -> Place {
        if self.speed.len() == 1 { Place::from("speed") } else { Place::at("speed", run) }
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
    simulate_on(Arch::new(), plan, runs, source, pulse)
}

/// With the instructions of `arch`.
fn simulate_on(
    arch: Arch,
    plan: &Plan,
    runs: usize,
    source: &impl Source,
    pulse: Pulse,
) -> Result<Statistics> {
    plan.check(runs)?;
    let shared =
        if plan.is_single() { Some(Arc::new(Constants::new(arch, vec![plan.setup(0)?]))) } else { None };
    let blocks = (0..runs).step_by(RUNS).map(|first| first..(first + RUNS).min(runs));
    let workers = Tools::new();
    let parts = parallel::map(blocks, pulse, |block, pulse| {
        let worker = || Worker { arch, plan, shared: shared.as_ref(), reader: source.reader(), march: None };
        workers.lend(worker, |worker| worker.block(block, pulse))
    })?;
    let mut all = Statistics::default();
    for part in parts {
        all.append(part);
    }
    Ok(all)
}

/// One thread's tools.
struct Worker<'a, R> {
    arch: Arch,
    plan: &'a Plan,
    /// Of runs that are all set up alike.
    shared: Option<&'a Arc<Constants>>,
    reader: R,
    march: Option<March>,
}

impl<R: Reader> Worker<'_, R> {
    fn block(&mut self, runs: Range<usize>, pulse: Pulse) -> Result<Statistics> {
        let mut found = Statistics::default();
        if let Some(constants) = self.shared {
            self.march_over(constants, runs, &mut found, pulse)?;
            return Ok(found);
        }
        let mut setups: Vec<Setup> = runs.clone().map(|run| self.plan.setup(run)).collect::<Result<_>>()?;
        let mut first = runs.start;
        while !setups.is_empty() {
            // Runs march side by side as far as their stations fall alike.
            let layout = Arc::clone(&setups[0].layout);
            let alike = setups.iter().take_while(|setup| setup.layout == layout).count();
            let others = setups.split_off(alike);
            let constants = Arc::new(Constants::new(self.arch, setups));
            self.march_over(&constants, first..first + alike, &mut found, pulse)?;
            (setups, first) = (others, first + alike);
        }
        Ok(found)
    }

    /// Runs up to [`RUNS`] profiles side by side.
    fn march_over(
        &mut self,
        constants: &Arc<Constants>,
        runs: Range<usize>,
        found: &mut Statistics,
        pulse: Pulse,
    ) -> Result<()> {
        let Self { arch, plan, reader, march, .. } = self;
        let march = match march {
            Some(march) if march.layout == constants.setups[0].layout => {
                march.turn_to(constants);
                march
            }
            _ => march.insert(March::new(*arch, plan.between, Arc::clone(constants))),
        };
        reader.open(runs.start, runs.len(), pulse)?;
        march.start(reader);
        let periods = march.layout.periods;
        let mut watch = Watch::new(pulse);
        for period in (0..periods).step_by(PERIODS) {
            let count = PERIODS.min(periods - period);
            if !watch.go_on((RUNS * count) as u32) {
                return watch.outcome;
            }
            march.block(reader, plan.stations, period, count);
            march.relieve(&mut watch);
        }
        march.block(reader, plan.stations, periods, 1);
        march.finish(runs, found, &mut watch);
        watch.outcome
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::aircraft::{Aircraft, Gear, Inertia};

    /// What vectors of any width that this machine has give are the bits of the plain build.
    #[test]
    fn same_bits_from_any_instructions() {
        const RUNS: usize = 19;
        const STATIONS: usize = 300;
        let inertia = Inertia { mass: 145.5, pitch: 1.92e6, roll: 6.56e5, gravity: 386.0886 };
        let gear = |name, x, y, stiffness| Gear::new(name, x, y, stiffness, 90.0).unwrap();
        let gears = vec![
            gear("nose", 234.9, 0.0, 1502.0),
            gear("left", -44.35, 109.25, 9102.0),
            gear("right", -57.1, -109.25, 9102.0),
        ];
        let aircraft = Arc::new(Aircraft::new(inertia, gears).unwrap());
        let modes = |ratio: f64| Arc::new(Modes::natural(Arc::clone(&aircraft), Some(&[ratio])).unwrap());
        let wave = |i: usize| ((i * i) as f64 * 0.37).sin() + 0.002 * (i % STATIONS) as f64;
        let elevations: Vec<f64> = (0..RUNS * 3 * STATIONS).map(wave).collect();
        let memory = Memory::new(&elevations, 3, STATIONS);
        for damping_input in [false, true] {
            for (count, speeds) in [(1, 1), (RUNS, RUNS)] {
                let plan = Plan {
                    modes: (0..count).map(|run| modes(0.004 * run as f64 + 0.01)).collect(),
                    speed: (0..speeds).map(|run| 500.0 + 3.0 * run as f64).collect(),
                    tracks: 3,
                    stations: STATIONS,
                    spacing: 10.0,
                    points: vec![vec![(0.0, 0.0), (120.0, 3.0)]; count],
                    damping_input,
                    between: true,
                };
                let on = |arch| simulate_on(arch, &plan, RUNS, &memory, &mut || Ok(())).unwrap();
                let plain = on(Arch::Scalar);
                assert_eq!(plain, on(Arch::new()));
                #[cfg(target_arch = "x86_64")]
                if let Some(simd) = pulp::x86::V3::try_new() {
                    assert_eq!(plain, on(Arch::V3(simd)));
                }
            }
        }
    }
}
