//! Runs side by side, a block of periods at a time: rises, states, values, moments.
//!
//! A block's numbers stay in the cache from one pass to the next; every pass is a plain loop over
//! registers full of runs. What is not marked to be inlined is not compiled for the instructions
//! chosen, closures neither: in loops there are none.

use std::ops::Range;

use pulp::{Arch, Simd, WithSimd};

use super::constants::{Constants, States, of_lane};
use super::records::Records;
use super::row::Row;
use super::setup::{Layout, MODES, Setup};
use super::vector::parts;
use super::{Reader, Statistics};
use crate::extremes::Output;
use crate::watch::Watch;

mod look;
mod moments;
mod states;

/// Periods of a block.
pub(super) const PERIODS: usize = 64;

/// Periods whose values are looked at again together.
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
    /// First elevations less those of the first group.
    first: Vec<Row>,
    first_rows: Vec<Rows>,
    origin: Row,
    /// States at the start of each leg, leg by leg, and at the end of the block.
    states: Vec<States<MoreRows>>,
    state: States<Row>,
    /// Heights at the start of each leg, leg by leg, group by group.
    heights: Vec<Vec<Rows>>,
    /// Leg by leg, since their gears' last stations.
    pushes: Vec<Push<Row>>,
    /// One output's values at the starts of the legs, leg by leg, and at the end of the block; where it
    /// may jump, also just before the legs' ends.
    starts: Vec<MoreRows>,
    ends: Vec<Rows>,
    /// The largest and the smallest of them in each chunk.
    edges: [[Row; 2]; PERIODS / CHUNK],
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
            first: vec![ZERO; groups],
            first_rows: vec![none; heights],
            origin: ZERO,
            states: vec![[[ZERO; PERIODS + 1]; 2 * MODES]; layout.legs],
            state: [ZERO; 2 * MODES],
            heights: vec![vec![none; heights]; layout.legs],
            pushes: vec![[[ZERO; MODES]; 2]; layout.legs],
            starts: vec![[ZERO; PERIODS + 1]; layout.legs],
            ends: vec![none; if layout.lines { layout.legs } else { 0 }],
            edges: [[ZERO; 2]; PERIODS / CHUNK],
            moments: [vec![ZERO; rows * (rows + 1) / 2], vec![ZERO; rows * (rows + 1) / 2]],
            triples: layout.triples(),
            reach: vec![ZERO; 2 * MODES + groups + layout.inner().count()],
            squares: vec![ZERO; outputs],
            flaw: ZERO,
            records: Records::new(layout.loads, outputs),
            searches: setups.iter().map(searches).collect(),
        }
    }

    /// Begins anew, at rest on the first elevations.
    pub fn start(&mut self, reader: &mut impl Reader) {
        self.state = [ZERO; 2 * MODES];
        self.pushes.fill([[ZERO; MODES]; 2]);
        for ground in &mut self.ground {
            ground.rise[PERIODS] = ZERO;
        }
        for moments in &mut self.moments {
            moments.fill(ZERO);
        }
        self.records.restart();
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
            self.records.see(output, rest, rest);
        }
    }

    /// The block of `count` periods that begins with `period`; in the tail, only so many legs of one.
    pub fn block(
        &mut self,
        reader: &mut impl Reader,
        stations: usize,
        period: usize,
        count: usize,
        tail: bool,
    ) {
        let block = Block { march: self, reader, stations, period, count, tail };
        block.march.arch.dispatch(block);
    }

    /// Elevations of the block's stations and the one before.
    #[inline(always)]
    fn read_ground<S: Simd>(
        &mut self,
        simd: S,
        reader: &mut impl Reader,
        stations: usize,
        period: usize,
        count: usize,
    ) {
        for (ground, group) in self.ground.iter_mut().zip(&self.layout.groups) {
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
        }
    }
}

impl March<'_> {
    /// Whether a run has remained in the range of double precision.
    pub fn is_finite(&self, lane: usize) -> bool {
        self.flaw[lane] == 0.0
    }

    /// Appends the results of a run that is over; wrong ones once the caller has asked to stop.
    pub fn read(&mut self, lane: usize, out: &mut Statistics, watch: &mut Watch) {
        let setup = of_lane(self.setups, lane);
        let last = self.searches.len() - 1;
        let valid = self.is_finite(lane);
        for (output, search) in self.searches[lane.min(last)].iter_mut().enumerate() {
            let (mut max, mut min, mut rms) = (f64::NAN, f64::NAN, f64::NAN);
            if valid {
                (max, min) = self.records.settle(setup, (output, lane), search, watch);
                let square = self.squares[output][lane];
                // Rounding may leave less than nothing; what is no number stays so.
                let nothing = square < 0.0 || setup.duration == 0.0;
                rms = if nothing { 0.0 } else { (square / setup.duration).sqrt() };
            }
            if let Some(level) = setup.static_load.get(output) {
                out.max_load.push(level + max);
                out.min_load.push(level + min);
                out.rms_load.push(rms);
            } else {
                out.max_acceleration.push(max.max(-min));
                out.rms_acceleration.push(rms);
            }
        }
    }
}

/// See [`March::block`].
struct Block<'m, 'a, R> {
    march: &'m mut March<'a>,
    reader: &'m mut R,
    stations: usize,
    period: usize,
    count: usize,
    tail: bool,
}

impl<R: Reader> WithSimd for Block<'_, '_, R> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { march, reader, stations, period, count, tail } = self;
        march.read_ground(simd, reader, stations, period, count);
        march.find_rises(simd, count);
        if tail {
            march.close_moments(simd);
        }
        let legs = if tail { march.layout.tail } else { march.layout.legs };
        match (legs, march.layout.damped) {
            (0, _) => march.states[0].iter_mut().zip(&march.state).for_each(|(rows, now)| rows[0] = *now),
            (1, false) if !tail => march.find_states::<S, 1, false>(simd, count, legs),
            (2, false) if !tail => march.find_states::<S, 2, false>(simd, count, legs),
            (3, false) if !tail => march.find_states::<S, 3, false>(simd, count, legs),
            (2, true) if !tail => march.find_states::<S, 2, true>(simd, count, legs),
            (_, false) => march.find_states::<S, 0, false>(simd, count, legs),
            (_, true) => march.find_states::<S, 0, true>(simd, count, legs),
        }
        if march.layout.heights {
            // The tail ends where its next leg begins.
            march.find_heights(count, if tail { legs + 1 } else { legs });
        }
        march.find_moments(simd, count, tail);
        march.look(simd, count, legs);
        if tail && march.layout.damped {
            march.look_back(simd, legs);
        }
        if tail {
            march.conclude(simd);
        }
        for ground in &mut march.ground {
            ground.z[PERIODS] = ground.z[count];
            ground.rise[PERIODS] = ground.rise[count];
        }
    }
}

impl March<'_> {
    /// Rises up to the stations met.
    #[inline(always)]
    fn find_rises<S: Simd>(&mut self, simd: S, count: usize) {
        for Ground { z, rise } in &mut self.ground {
            let (z, rise) = (&z[..=count], &mut rise[..=count]);
            for part in parts(simd) {
                for i in 0..count {
                    part.store(part.load(&z[i + 1]) - part.load(&z[i]), &mut rise[i + 1]);
                }
            }
        }
    }
}
