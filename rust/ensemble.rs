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

use crate::error::{Error, Place, Result, finite, moderate};
use crate::modes::Modes;
use crate::parallel::{self, Tools};
use crate::profile::LARGEST;
use crate::row::{RUNS, Row};
use crate::run::LAST_KNOT;
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

/// How many elevations there are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shape {
    /// Runs.
    pub runs: usize,
    /// Tracks of a run: one for all gears, or one a gear.
    pub tracks: usize,
    /// Stations of a track.
    pub stations: usize,
}

/// Where elevations come from.
pub trait Source: Sync {
    /// How many there are.
    fn shape(&self) -> Shape;

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

    /// One elevation of a run, of those side by side, as `read` gives it.
    fn elevation(&self, run: usize, track: usize, station: usize) -> f64;

    /// Says where in memory the elevations stand, if they are there, that will be read next: of a
    /// track, so many from `first` on.
    fn foresee(&self, _track: usize, _first: usize, _count: usize, _ahead: &mut Ahead) {}
}

/// Elevations in memory, run by run, track by track.
#[derive(Clone, Copy, Debug)]
pub struct Memory<'a, T> {
    elevations: &'a [T],
    shape: Shape,
}

impl<'a, T: Copy + Into<f64> + Sync> Memory<'a, T> {
    /// Elevations of a shape.
    ///
    /// # Errors
    /// If they are not as many.
    pub fn new(elevations: &'a [T], shape: Shape) -> Result<Self> {
        let (found, expected) = (elevations.len(), shape.runs * shape.tracks * shape.stations);
        if found != expected {
            let why = "runs times tracks times stations";
            return Err(Error::WrongLength { argument: "elevations", found, expected, why });
        }
        Ok(Self { elevations, shape })
    }

    /// Why a run gave no finite result: its first elevation that is not finite or out of range.
    #[must_use]
    pub fn fault(&self, run: usize) -> Error {
        let Shape { tracks, stations, .. } = self.shape;
        let size = tracks * stations;
        let fault = self.elevations[run * size..][..size].iter().enumerate().find_map(|(i, &value)| {
            let place = Place::station("elevations", run, i / stations, i % stations);
            match finite(place, value.into()) {
                Ok(value) if value.abs() > LARGEST => {
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

    fn shape(&self) -> Shape {
        self.shape
    }

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
            &self.elevations[(run * self.shape.tracks + track) * self.shape.stations + first..][..count]
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

    fn elevation(&self, run: usize, track: usize, station: usize) -> f64 {
        let Shape { tracks, stations, .. } = self.memory.shape;
        self.memory.elevations[((self.runs.start + run) * tracks + track) * stations + station].into()
    }

    fn foresee(&self, track: usize, first: usize, count: usize, ahead: &mut Ahead) {
        let Shape { runs: all, stations, .. } = self.memory.shape;
        let (mut runs, mut first) = (self.runs.clone(), first);
        if first >= stations {
            // Most likely the next runs are up next.
            (runs, first) = (runs.end..all.min(runs.end + RUNS), 0);
        }
        if !runs.is_empty() {
            ahead.extend(self.memory.lanes(&runs, track, first, count.min(stations - first)));
        }
    }
}

/// What rolls over the profiles.
#[derive(Clone, Debug)]
pub struct Case {
    /// An aircraft in its modes.
    pub modes: Arc<Modes>,
    /// Points (x, y) of its body at which accelerations are wanted.
    pub points: Vec<(f64, f64)>,
}

impl Case {
    fn gears(&self) -> usize {
        self.modes.aircraft().gears().len()
    }
}

/// What many runs have in common, and what not.
#[derive(Clone, Debug)]
pub struct Plan {
    /// One for all runs, or one a run; all with as many gears and points.
    pub cases: Vec<Case>,
    /// One for all runs, or one a run.
    pub speed: Vec<f64>,
    /// Distance between two stations.
    pub spacing: f64,
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
    /// With room for all results.
    fn with_room(runs: usize, gears: usize, points: usize) -> Result<Self> {
        let room = |columns: usize| {
            let mut values = Vec::new();
            let reserved = runs.checked_mul(columns).map(|count| values.try_reserve_exact(count));
            if matches!(reserved, Some(Ok(()))) { Ok(values) } else { Err(Error::NoRoom { runs }) }
        };
        Ok(Self {
            max_load: room(gears)?,
            min_load: room(gears)?,
            rms_load: room(gears)?,
            max_acceleration: room(points)?,
            rms_acceleration: room(points)?,
            failed: Vec::new(),
        })
    }

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
    fn check(&self, Shape { runs, tracks, stations }: Shape) -> Result<()> {
        moderate("spacing", self.spacing)?;
        let why = "one for all runs, or one per run";
        for (argument, found) in [("modes", self.cases.len()), ("speed", self.speed.len())] {
            if found != 1 && found != runs {
                return Err(Error::WrongLength { argument, found, expected: runs, why });
            }
        }
        let Some(first) = self.cases.first() else { return Ok(()) };
        let (gears, points) = (first.gears(), first.points.len());
        let why = "as many in all modes";
        for case in &self.cases {
            for (argument, found, expected) in
                [("modes: gears", case.gears(), gears), ("modes: stations", case.points.len(), points)]
            {
                if found != expected {
                    return Err(Error::WrongLength { argument, found, expected, why });
                }
            }
        }
        for (i, &speed) in self.speed.iter().enumerate() {
            moderate(self.place_of_speed(i), speed)?;
        }
        if stations == 0 {
            return Err(Error::TooShort { argument: "elevations", found: 0, least: 1 });
        }
        if tracks != 1 && tracks != gears {
            let (argument, why) = ("elevations[0]", "tracks: one for all gears, or one per gear");
            return Err(Error::WrongLength { argument, found: tracks, expected: gears, why });
        }
        Ok(())
    }

    fn setup(&self, shape: Shape, run: usize) -> Result<Setup> {
        let stations = Stations { tracks: shape.tracks, count: shape.stations, spacing: self.spacing };
        let Case { modes, points } = &self.cases[if self.cases.len() == 1 { 0 } else { run }];
        let speed = self.speed[if self.speed.len() == 1 { 0 } else { run }];
        let setup = Setup::new(modes, stations, speed, points, self.damping_input);
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

    /// Whether all runs are set up alike.
    fn is_single(&self) -> bool {
        self.cases.len() == 1 && self.speed.len() == 1
    }
}

/// Runs all profiles of a source.
///
/// # Errors
/// A plan that cannot be run, or what `pulse` gives.
pub fn simulate(plan: &Plan, source: &impl Source, pulse: Pulse) -> Result<Statistics> {
    simulate_on(Arch::new(), plan, source, pulse)
}

/// With the instructions of `arch`.
fn simulate_on(arch: Arch, plan: &Plan, source: &impl Source, pulse: Pulse) -> Result<Statistics> {
    let shape = source.shape();
    plan.check(shape)?;
    let Some(first) = plan.cases.first() else { return Ok(Statistics::default()) };
    let mut all = Statistics::with_room(shape.runs, first.gears(), first.points.len())?;
    let constants = |setups| Arc::new(Constants::new(arch, setups));
    let shared = if plan.is_single() { Some(constants(vec![plan.setup(shape, 0)?])) } else { None };
    let blocks = (0..shape.runs).step_by(RUNS).map(|first| first..(first + RUNS).min(shape.runs));
    let workers = Tools::new();
    let parts = parallel::map(blocks, pulse, |block, pulse| {
        let shared = shared.as_ref();
        let worker = || Worker { arch, plan, shape, shared, reader: source.reader(), march: None };
        workers.lend(worker, |worker| worker.block(block, pulse))
    })?;
    for part in parts {
        all.append(part);
    }
    Ok(all)
}

/// One thread's tools.
struct Worker<'a, R> {
    arch: Arch,
    plan: &'a Plan,
    shape: Shape,
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
        let mut setups: Vec<Setup> =
            runs.clone().map(|run| self.plan.setup(self.shape, run)).collect::<Result<_>>()?;
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
        march.start(reader, runs.len());
        let periods = march.layout.periods;
        let mut watch = Watch::new(pulse);
        for period in (0..periods).step_by(PERIODS) {
            let count = PERIODS.min(periods - period);
            if !watch.go_on((RUNS * count) as u32) {
                return watch.outcome;
            }
            march.block(reader, period, count);
            march.relieve(reader, &mut watch);
        }
        march.block(reader, periods, 1);
        march.finish(reader, runs, found, &mut watch);
        watch.outcome
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::aircraft::{Aircraft, Gear, Inertia};
    use crate::modes::Damping;

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
        let modes =
            |ratio: f64| Arc::new(Modes::natural(Arc::clone(&aircraft), Damping::All(ratio)).unwrap());
        let wave = |i: usize| ((i * i) as f64 * 0.37).sin() + 0.002 * (i % STATIONS) as f64;
        let elevations: Vec<f64> = (0..RUNS * 3 * STATIONS).map(wave).collect();
        let memory = Memory::new(&elevations, Shape { runs: RUNS, tracks: 3, stations: STATIONS }).unwrap();
        for damping_input in [false, true] {
            for (count, speeds) in [(1, 1), (RUNS, RUNS)] {
                let plan = Plan {
                    cases: (0..count)
                        .map(|run| Case {
                            modes: modes(0.004 * run as f64 + 0.01),
                            points: vec![(0.0, 0.0), (120.0, 3.0)],
                        })
                        .collect(),
                    speed: (0..speeds).map(|run| 500.0 + 3.0 * run as f64).collect(),
                    spacing: 10.0,
                    damping_input,
                    between: true,
                };
                let on = |arch| simulate_on(arch, &plan, &memory, &mut || Ok(())).unwrap();
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
