//! Runs side by side, a block of periods at a time.
//!
//! A period consists of legs (see `setup`); eight periods are a chunk ([`CHUNK`]), [`PERIODS`] a block.
//! Each block, in this order:
//!
//! 1. `Read`: elevations.
//! 2. `find_states`: rises; states, and where needed heights, at the start of every leg.
//! 3. `find_moments`: sums of products, for the mean squares.
//! 4. `look`: values at kinks, where slopes may jump, set the records. A chunk whose bound beats a
//!    record of a run is kept for that run; in short runs all chunks are sifted (6) at once, and so is
//!    an incomplete last one.
//!
//! When a run is over, or has kept too many chunks:
//!
//! 5. `go_back`: the kept chunks whose bounds still beat a record take the block's place, one in each
//!    run's lane, and `find_states` marches over them again.
//! 6. `sift`: of each span between two kinks on which a record may be broken, `weigh` keeps the legs
//!    whose own bound beats it.
//! 7. `Records::settle`: the legs kept are searched, the most promising first.
//!
//! A block's numbers stay in the cache from one pass to the next; every pass is a plain loop over
//! registers full of runs. Only functions marked for inlining are compiled for the chosen instructions.
//! Closures are not, so there are none in loops.

use std::ops::Range;
use std::sync::Arc;

use pulp::{Arch, Simd, WithSimd};

use super::ahead::Ahead;
use super::constants::{Constants, States, of_lane};
use super::records::Records;
use super::setup::Layout;
use super::vector::parts;
use super::{Reader, Statistics};
use crate::modes::MODES;
use crate::row::{RUNS, Row};
use crate::watch::Watch;

mod look;
mod moments;
mod sift;
mod states;
mod view;

use look::ChunkBounds;
use sift::KeptChunks;

/// Periods of a block.
pub(super) const PERIODS: usize = 128;

/// Periods of a chunk: of each, the largest and the smallest value at kinks are known.
const CHUNK: usize = 8;

const ZERO: Row = Row::ZERO;

/// A row for each period of a block.
type BlockRows = [Row; PERIODS];

/// One more: where the last period ends.
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

/// Runs side by side and where they are.
pub(super) struct March {
    arch: Arch,
    /// Whether extremes are looked for between kinks too.
    between: bool,
    constants: Arc<Constants>,
    pub layout: Arc<Layout>,
    ground: Vec<Ground>,
    /// Elevations of the next block.
    ahead: Ahead,
    /// First elevations less those of the group of the first track.
    first: Vec<Row>,
    first_rows: Vec<BlockRows>,
    origin: Row,
    /// States at the start of each leg, leg by leg, and at the end of the block.
    states: Vec<States<MoreRows>>,
    state: States<Row>,
    /// Runs; the other lanes are idle.
    runs: usize,
    /// The block's first period.
    period: usize,
    /// Heights at the start of each leg, leg by leg, group by group.
    heights: Vec<Vec<BlockRows>>,
    /// Moments of the periods' rows, lower triangle, over the run and over its tail.
    moments: [Vec<Row>; 2],
    /// Rows of a period, by threes.
    triples: Vec<Range<usize>>,
    /// Roots of the sums of squares of the block's states and rises.
    norms: Vec<Row>,
    /// Of the runs that are over: integrals of the squares, output by output; 0 of those that have
    /// remained finite.
    squares: Vec<Row>,
    flaw: Row,
    records: Records,
    /// How far the outputs may come on the chunks of the block, output by output.
    chunk_bounds: Vec<[ChunkBounds; PERIODS / CHUNK]>,
    /// Run by run.
    kept: [KeptChunks; RUNS],
}

impl March {
    #[expect(clippy::large_stack_arrays, reason = "their way to the heap")]
    pub fn new(arch: Arch, between: bool, constants: Arc<Constants>) -> Self {
        let layout = Arc::clone(&constants.setups[0].layout);
        let groups = layout.groups.len();
        let rows = layout.rows();
        let heights = if layout.heights { groups } else { 0 };
        let none = [ZERO; PERIODS];
        let outputs = constants.weights.len();
        Self {
            arch,
            between,
            ground: vec![Ground { z: [ZERO; PERIODS + 1], rise: [ZERO; PERIODS + 1] }; groups],
            ahead: Ahead::default(),
            first: vec![ZERO; groups],
            first_rows: vec![none; heights],
            origin: ZERO,
            states: vec![[[ZERO; PERIODS + 1]; 2 * MODES]; layout.legs],
            state: [ZERO; 2 * MODES],
            runs: 0,
            period: 0,
            heights: vec![vec![none; heights]; layout.legs],
            moments: [vec![ZERO; rows * (rows + 1) / 2], vec![ZERO; rows * (rows + 1) / 2]],
            triples: layout.triples(),
            norms: vec![ZERO; 2 * MODES + groups + layout.inner().count()],
            squares: vec![ZERO; outputs],
            flaw: ZERO,
            records: Records::new(layout.loads, outputs),
            chunk_bounds: vec![[ChunkBounds { bend: ZERO, bounds: [ZERO; 2] }; PERIODS / CHUNK]; outputs],
            kept: std::array::from_fn(|_| KeptChunks::new(outputs)),
            constants,
            layout,
        }
    }

    /// Other runs from now on, whose stations fall like those of the runs so far.
    pub fn turn_to(&mut self, constants: &Arc<Constants>) {
        self.constants = Arc::clone(constants);
    }

    /// Begins anew, so many runs at rest on their first elevations.
    pub fn start(&mut self, reader: &mut impl Reader, runs: usize) {
        self.runs = runs;
        self.state = [ZERO; 2 * MODES];
        for ground in &mut self.ground {
            ground.rise[PERIODS] = ZERO;
        }
        for moments in &mut self.moments {
            moments.fill(ZERO);
        }
        self.records.restart();
        self.kept.iter_mut().for_each(KeptChunks::restart);
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
                self.records.update(part, output, rest, rest);
            }
        }
    }

    /// Marches over the next block, `count` periods from `period` on; after the last period, over the tail.
    pub fn block(&mut self, reader: &mut impl Reader, period: usize, count: usize) {
        self.period = period;
        let Self { arch, layout, ground, ahead, .. } = self;
        arch.dispatch(Read { layout: &*layout, ground, ahead, reader, period, count });
        arch.dispatch(Pass { march: self, over: Over::Next { period, count } });
    }

    /// Searches between kinks for the runs that have kept too many chunks.
    pub fn relieve(&mut self, reader: &impl Reader, watch: &mut Watch) {
        let full: [bool; RUNS] = std::array::from_fn(|lane| self.kept[lane].are_full());
        if full.contains(&true) {
            let state = self.state;
            self.search(reader, full, watch);
            self.state = state;
        }
    }

    /// Searches the chunks that some of the runs have kept.
    fn search(&mut self, reader: &impl Reader, runs: [bool; RUNS], watch: &mut Watch) {
        while self.go_back(reader, runs) {
            self.arch.dispatch(Pass { march: self, over: Over::Kept });
        }
        for lane in (0..RUNS).filter(|&lane| runs[lane]) {
            self.kept[lane].restart();
            let setup = of_lane(&self.constants.setups, lane);
            for output in 0..setup.readings.len() {
                self.records.settle(setup, (output, lane), watch);
            }
        }
    }

    /// Whether a run has remained in the range of double precision.
    fn is_finite(&self, lane: usize) -> bool {
        self.flaw[lane] == 0.0
    }

    /// Appends the results of runs that are over, and which of them have none; wrong results once the
    /// caller has asked to stop.
    pub fn finish(
        &mut self,
        reader: &impl Reader,
        runs: Range<usize>,
        out: &mut Statistics,
        watch: &mut Watch,
    ) {
        let complete = std::array::from_fn(|lane| lane < runs.len() && self.is_finite(lane));
        self.search(reader, complete, watch);
        for (lane, run) in runs.enumerate() {
            self.append_to(out, lane);
            if !out.last_is_finite(self.layout.loads, self.squares.len() - self.layout.loads) {
                out.failed.push(run);
            }
        }
    }

    fn append_to(&self, out: &mut Statistics, lane: usize) {
        let setup = of_lane(&self.constants.setups, lane);
        for (output, square) in self.squares.iter().enumerate() {
            let (mut max, mut min, mut rms) = (f64::NAN, f64::NAN, f64::NAN);
            if self.is_finite(lane) {
                (max, min) = (self.records.best_of(output, 0, lane), -self.records.best_of(output, 1, lane));
                // Rounding may leave a negative square, or something where there is nothing; NaN stays NaN.
                let nothing = square[lane] < 0.0 || setup.duration == 0.0;
                rms = if nothing { 0.0 } else { (square[lane] / setup.duration).sqrt() };
                let most = max.abs().max(min.abs());
                rms = if rms.is_finite() && rms > most { most } else { rms };
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

/// Reads the elevations of a block's stations and the one before. Separate from the rest, which need not
/// be compiled for each reader.
struct Read<'m, R> {
    layout: &'m Layout,
    ground: &'m mut [Ground],
    ahead: &'m mut Ahead,
    reader: &'m mut R,
    period: usize,
    count: usize,
}

impl<R: Reader> WithSimd for Read<'_, R> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { layout, ground, ahead, reader, period, count } = self;
        let stations = layout.stations;
        ahead.clear();
        for (ground, group) in ground.iter_mut().zip(&layout.groups) {
            ground.z[0] = ground.z[PERIODS];
            ground.rise[0] = ground.rise[PERIODS];
            // As `Layout::station` has it.
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
struct Pass<'m> {
    march: &'m mut March,
    over: Over,
}

/// What to march over.
enum Over {
    /// The next `count` periods, whose elevations have been read.
    Next { period: usize, count: usize },
    /// Kept chunks, one of each run.
    Kept,
}

impl WithSimd for Pass<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { march, over } = self;
        let (count, tail, again) = match over {
            Over::Next { period, count } => (count, period == march.layout.periods, false),
            Over::Kept => (CHUNK, false, true),
        };
        // The tail is the first legs of one more period.
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
