//! Runs side by side, a block of periods at a time: rises, states, values, moments.
//!
//! A block's numbers stay in the cache from one pass to the next; every pass is a plain loop over
//! registers full of runs. What is not marked to be inlined is not compiled for the instructions
//! chosen, closures neither: in loops there are none.

use std::ops::Range;

use pulp::{Arch, Simd, WithSimd};

use super::ahead::Ahead;
use super::constants::{Constants, States, of_lane};
use super::records::Records;
use super::setup::{Layout, MODES, Setup};
use super::vector::parts;
use super::{Reader, Statistics};
use crate::extremes::Output;
use crate::row::{RUNS, Row};
use crate::watch::Watch;

mod look;
mod moments;
mod sift;
mod states;
mod view;

use look::Reach;
use sift::Stretches;

/// Periods of a block.
pub(super) const PERIODS: usize = 128;

/// Periods of which the largest and the smallest value are known.
const CHUNK: usize = 8;

const ZERO: Row = Row::ZERO;

/// A row for each period of a block.
type Rows = [Row; PERIODS];

/// One more: what the last period leaves.
type MoreRows = [Row; PERIODS + 1];

/// What the slopes under the gears of one leg drive the modes with: rates of their static positions
/// ÷ ω and forces ÷ ω².
type Push<T> = [[T; MODES]; 2];

/// One group's elevations and rises in a block.
#[derive(Clone)]
struct Ground {
    /// Elevation of the station met in each period, and of the next one.
    z: MoreRows,
    /// Rise up to the station met in each period, and from the last one on.
    rise: MoreRows,
}

/// Where several runs are on their way.
pub(super) struct March<'a> {
    arch: Arch,
    /// Whether extremes are looked for between the ends of legs.
    between: bool,
    setups: &'a [Setup],
    pub layout: &'a Layout,
    constants: &'a Constants,
    ground: Vec<Ground>,
    /// Elevations of the next block.
    ahead: Ahead,
    /// First elevations less those of the first group.
    first: Vec<Row>,
    first_rows: Vec<Rows>,
    origin: Row,
    /// States at the start of each leg, leg by leg, and at the end of the block.
    states: Vec<States<MoreRows>>,
    state: States<Row>,
    /// Heights at the start of each leg, leg by leg, group by group.
    heights: Vec<Vec<Rows>>,
    /// Moments of the periods' rows, lower triangle, over the run and over its tail.
    moments: [Vec<Row>; 2],
    /// Rows of a period, by threes.
    triples: Vec<Range<usize>>,
    /// Roots of the sums of squares of the block's states and rises.
    reach: Vec<Row>,
    /// Of the runs that are over: integrals of the squares, output by output; 0 of those that have
    /// remained finite.
    squares: Vec<Row>,
    flaw: Row,
    records: Records,
    /// How far the outputs may come on the chunks of the block, output by output.
    reaches: Vec<[Reach; PERIODS / CHUNK]>,
    /// Run by run.
    stretches: [Stretches; RUNS],
    /// Tools to search with, set-up by set-up, output by output.
    searches: Vec<Vec<Output>>,
}

impl<'a> March<'a> {
    #[expect(clippy::large_stack_arrays, reason = "their way to the heap")]
    pub fn new(arch: Arch, between: bool, setups: &'a [Setup], constants: &'a Constants) -> Self {
        let layout = &*setups[0].layout;
        let searches = |setup: &Setup| setup.readings.iter().map(|reading| reading.output.clone()).collect();
        let groups = layout.groups.len();
        let rows = layout.rows();
        let heights = if layout.heights { groups } else { 0 };
        let none = [ZERO; PERIODS];
        let outputs = constants.weights.len();
        Self {
            arch,
            between,
            setups,
            layout,
            constants,
            ground: vec![Ground { z: [ZERO; PERIODS + 1], rise: [ZERO; PERIODS + 1] }; groups],
            ahead: Ahead::default(),
            first: vec![ZERO; groups],
            first_rows: vec![none; heights],
            origin: ZERO,
            states: vec![[[ZERO; PERIODS + 1]; 2 * MODES]; layout.legs],
            state: [ZERO; 2 * MODES],
            heights: vec![vec![none; heights]; layout.legs],
            moments: [vec![ZERO; rows * (rows + 1) / 2], vec![ZERO; rows * (rows + 1) / 2]],
            triples: layout.triples(),
            reach: vec![ZERO; 2 * MODES + groups + layout.inner().count()],
            squares: vec![ZERO; outputs],
            flaw: ZERO,
            records: Records::new(layout.loads, outputs),
            reaches: vec![[Reach { bend: ZERO, bounds: [ZERO; 2] }; PERIODS / CHUNK]; outputs],
            stretches: std::array::from_fn(|_| Stretches::new(layout, outputs)),
            searches: setups.iter().map(searches).collect(),
        }
    }

    /// Begins anew, at rest on the first elevations.
    pub fn start(&mut self, reader: &mut impl Reader) {
        self.state = [ZERO; 2 * MODES];
        for ground in &mut self.ground {
            ground.rise[PERIODS] = ZERO;
        }
        for moments in &mut self.moments {
            moments.fill(ZERO);
        }
        self.records.restart();
        self.stretches.iter_mut().for_each(Stretches::restart);
        for (ground, group) in self.ground.iter_mut().zip(&self.layout.groups) {
            reader.read(pulp::Scalar, group.track, 0, &mut ground.z[PERIODS..]);
        }
        self.origin = self.ground[self.layout.datum].z[PERIODS];
        for (first, ground) in self.first.iter_mut().zip(&self.ground) {
            *first = ground.z[PERIODS] - self.origin;
        }
        for (rows, first) in self.first_rows.iter_mut().zip(&self.first) {
            rows.fill(*first);
        }
        // At rest nothing but these elevations enters.
        for (output, weights) in self.constants.weights.iter().enumerate() {
            let mut rest = ZERO;
            for group in 0..self.ground.len() {
                rest += (weights.height[group] + weights.first[group]) * self.first[group];
            }
            for part in parts(pulp::Scalar) {
                let rest = part.load(&rest);
                self.records.see(part, output, rest, rest);
            }
        }
    }

    /// The block of `count` periods that begins with `period`, the next one; after the last, the tail.
    pub fn block(&mut self, reader: &mut impl Reader, stations: usize, period: usize, count: usize) {
        let Self { arch, layout, ground, ahead, .. } = self;
        arch.dispatch(Read { layout, ground, ahead, reader, stations, period, count });
        arch.dispatch(Block { march: self, way: Way::On { period, count } });
    }

    /// Looks for records between the places looked at so far, for runs that have kept much.
    pub fn relieve(&mut self, watch: &mut Watch) {
        let full: [bool; RUNS] = std::array::from_fn(|lane| self.stretches[lane].are_full());
        if full.contains(&true) {
            let state = self.state;
            self.search(full, watch);
            self.state = state;
        }
    }

    /// Looks for records between the places looked at so far, for some of the runs.
    fn search(&mut self, runs: [bool; RUNS], watch: &mut Watch) {
        while self.go_back(runs) {
            self.arch.dispatch(Block { march: self, way: Way::Again });
        }
        let last = self.searches.len() - 1;
        for lane in (0..RUNS).filter(|&lane| runs[lane]) {
            self.stretches[lane].restart();
            let setup = of_lane(self.setups, lane);
            for (output, search) in self.searches[lane.min(last)].iter_mut().enumerate() {
                self.records.settle(setup, (output, lane), search, watch);
            }
        }
    }

    /// Whether a run has remained in the range of double precision.
    fn is_finite(&self, lane: usize) -> bool {
        self.flaw[lane] == 0.0
    }

    /// Appends the results of so many runs that are over, and the numbers of those without any; wrong
    /// ones once the caller has asked to stop.
    pub fn finish(&mut self, runs: Range<usize>, out: &mut Statistics, watch: &mut Watch) {
        self.search(std::array::from_fn(|lane| lane < runs.len() && self.is_finite(lane)), watch);
        for (lane, run) in runs.enumerate() {
            self.read(lane, out);
            if !out.last_is_finite(self.layout.loads, self.squares.len() - self.layout.loads) {
                out.failed.push(run);
            }
        }
    }

    fn read(&self, lane: usize, out: &mut Statistics) {
        let setup = of_lane(self.setups, lane);
        for (output, square) in self.squares.iter().enumerate() {
            let (mut max, mut min, mut rms) = (f64::NAN, f64::NAN, f64::NAN);
            if self.is_finite(lane) {
                (max, min) = (self.records.best_of(output, 0, lane), -self.records.best_of(output, 1, lane));
                // Rounding may leave less than nothing; what is no number stays so.
                let nothing = square[lane] < 0.0 || setup.duration == 0.0;
                rms = if nothing { 0.0 } else { (square[lane] / setup.duration).sqrt() };
            }
            if let Some(level) = setup.static_load.get(output) {
                out.max_load.push(level + max);
                out.min_load.push(level + min);
                out.rms_load.push(rms);
            } else {
                out.max_acceleration.push(max);
                out.rms_acceleration.push(rms);
            }
        }
    }
}

/// Reads the elevations of a block's stations and the one before. Apart from the rest, which is the
/// same for all readers.
struct Read<'m, R> {
    layout: &'m Layout,
    ground: &'m mut [Ground],
    ahead: &'m mut Ahead,
    reader: &'m mut R,
    stations: usize,
    period: usize,
    count: usize,
}

impl<R: Reader> WithSimd for Read<'_, R> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { layout, ground, ahead, reader, stations, period, count } = self;
        ahead.clear();
        for (ground, group) in ground.iter_mut().zip(&layout.groups) {
            ground.z[0] = ground.z[PERIODS];
            ground.rise[0] = ground.rise[PERIODS];
            // Period i meets station i − whole. Beyond either end the runway is level.
            let level = group.whole.saturating_sub(period).min(count);
            let first = (period + level + 1).saturating_sub(group.whole);
            let last = (period + count + 1).saturating_sub(group.whole).min(stations).max(first);
            let (before, after) = (level + 1, level + 1 + last - first);
            let start = ground.z[0];
            ground.z[1..before].fill(start);
            if after > before {
                reader.read(simd, group.track, first, &mut ground.z[before..after]);
            }
            let end = ground.z[after - 1];
            ground.z[after..=count].fill(end);
            reader.foresee(group.track, last, PERIODS, ahead);
        }
    }
}

/// See [`March::block`] and [`March::search`].
struct Block<'m, 'a> {
    march: &'m mut March<'a>,
    way: Way,
}

/// Where to go.
enum Way {
    /// Over so many more periods, whose elevations have been read.
    On { period: usize, count: usize },
    /// Over stretches again, each run over one of its own.
    Again,
}

impl WithSimd for Block<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { march, way } = self;
        let (count, tail, again) = match way {
            Way::On { period, count } => (count, period == march.layout.periods, false),
            Way::Again => (CHUNK, false, true),
        };
        // The tail: only so many legs of a period.
        let legs = if tail { march.layout.tail } else { march.layout.legs };
        if tail {
            march.close_moments(simd);
        }
        march.find_states(simd, count, legs);
        let mut chunks = 0..1;
        if !again {
            march.find_moments(simd, count, tail);
            chunks = march.look(simd, count, legs);
            if tail && march.layout.damped {
                march.look_back(simd, legs);
            }
            if tail {
                march.conclude(simd);
            }
        }
        for chunk in chunks {
            march.sift(simd, chunk, count, legs);
        }
        if !again {
            for ground in &mut march.ground {
                ground.z[PERIODS] = ground.z[count];
                ground.rise[PERIODS] = ground.rise[count];
            }
        }
    }
}
