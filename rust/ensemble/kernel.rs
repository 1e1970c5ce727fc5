//! Runs side by side, a block of periods at a time: rises, states, values, moments.
//!
//! A block's numbers stay in the first-level cache from one pass to the next; every pass is a plain
//! loop over registers full of runs.

use std::ops::Range;

use pulp::{Arch, Simd, WithSimd};

use super::constants::{BoundRows, Constants, States, of_lane};
use super::records::{Candidate, Records};
use super::row::Row;
use super::setup::{Layout, MODES, Setup};
use super::vector::{Part, Vector, parts};
use super::{Reader, Statistics};
use crate::extremes::Output;
use crate::lanes::Lanes;
use crate::transition::{self, State};

/// Periods of a block.
pub(super) const PERIODS: usize = 32;

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
    pub fn new(arch: Arch, setups: &'a [Setup], constants: &'a Constants) -> Self {
        let layout = &*setups[0].layout;
        let searches = |setup: &Setup| setup.readings.iter().map(|reading| reading.output.clone()).collect();
        let groups = layout.groups.len();
        let rows = layout.rows();
        let heights = if layout.heights { groups } else { 0 };
        let none = [ZERO; PERIODS];
        let outputs = constants.weights.len();
        Self {
            arch,
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

    /// Appends the results of a run that is over.
    pub fn read(&mut self, lane: usize, out: &mut Statistics) {
        let setup = of_lane(self.setups, lane);
        let last = self.searches.len() - 1;
        let valid = self.is_finite(lane);
        for (output, search) in self.searches[lane.min(last)].iter_mut().enumerate() {
            let (mut max, mut min, mut rms) = (f64::NAN, f64::NAN, f64::NAN);
            if valid {
                (max, min) = self.records.settle(setup, output, lane, search);
                let square = self.squares[output][lane].max(0.0);
                rms = if setup.duration > 0.0 { (square / setup.duration).sqrt() } else { 0.0 };
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

    /// States at the start of every leg; `L` legs, any number for 0.
    #[inline(always)]
    fn find_states<S: Simd, const L: usize, const DAMPED: bool>(
        &mut self,
        simd: S,
        count: usize,
        legs: usize,
    ) {
        for part in parts(simd) {
            if L == 0 {
                let mut pushes: Vec<_> = self.pushes.iter().map(|push| loaded(part, push)).collect();
                self.march::<S, DAMPED>(part, count, legs, &mut pushes);
            } else {
                let mut pushes = [[[part.all(0.0); MODES]; 2]; L];
                for (push, kept) in pushes.iter_mut().zip(&self.pushes) {
                    *push = loaded(part, kept);
                }
                self.march::<S, DAMPED>(part, count, L, &mut pushes);
            }
        }
    }

    #[inline(always)]
    fn march<S: Simd, const DAMPED: bool>(
        &mut self,
        part: Part<S>,
        count: usize,
        legs: usize,
        pushes: &mut [Push<Vector<S>>],
    ) {
        let Self { layout, constants, ground, states, state, .. } = self;
        let (members, steps) = (&layout.members[..legs], &constants.steps[..legs]);
        let mut now = part.load_all(state);
        for i in 0..count {
            for leg in 0..legs {
                let mut push = [[part.all(0.0); MODES]; 2];
                for group in members[leg].clone() {
                    let rise = part.load(&ground[group].rise[i + 1]);
                    for mode in 0..MODES {
                        push[0][mode] = push[0][mode] + part.load(&constants.climb[group][mode]) * rise;
                        if DAMPED {
                            push[1][mode] = push[1][mode] + part.load(&constants.drag[group][mode]) * rise;
                        }
                    }
                }
                pushes[leg] = push;
                for (now, rows) in now.iter().zip(&mut states[leg]) {
                    part.store(*now, &mut rows[i]);
                }
                for mode in 0..MODES {
                    let [mut beta, mut gamma] = [pushes[0][0][mode], pushes[0][1][mode]];
                    for [more_beta, more_gamma] in &pushes[1..] {
                        beta = beta + more_beta[mode];
                        if DAMPED {
                            gamma = gamma + more_gamma[mode];
                        }
                    }
                    let step = &steps[leg][mode];
                    let [g, s, w, h] = part.load_all(&[step.g, step.s, step.w, step.h]);
                    let (d, v) = (now[mode], now[MODES + mode]);
                    let mut after_d = (d - h * beta) + (s * v - g * d);
                    let mut after_v = (v + g * beta) - (w * v + s * d);
                    if DAMPED {
                        after_d = after_d + g * gamma;
                        after_v = after_v + s * gamma;
                    }
                    (now[mode], now[MODES + mode]) = (after_d, after_v);
                }
            }
        }
        let (leg, i) = layout.after(legs - 1, count - 1);
        for (k, now) in now.into_iter().enumerate() {
            part.store(now, &mut states[leg][k][i]);
            part.store(now, &mut state[k]);
        }
        for (push, kept) in pushes.iter().flatten().flatten().zip(self.pushes.iter_mut().flatten().flatten())
        {
            part.store(*push, kept);
        }
    }

    /// Elevations at the start of every leg, as heights above the first group's, and its own rise.
    #[inline(always)]
    fn find_heights(&mut self, count: usize, legs: usize) {
        let Self { layout, constants, ground, heights, origin, .. } = self;
        for leg in 0..legs {
            for (group, out) in heights[leg].iter_mut().enumerate() {
                let met = |group: usize| usize::from(layout.groups[group].leg <= leg);
                let (share, datum) = (&constants.from_station[leg], layout.datum);
                for i in 0..count {
                    let below = share[datum] * ground[datum].rise[i + met(datum)];
                    let climb = share[group] * ground[group].rise[i + met(group)];
                    out[i] = if group == datum {
                        (ground[group].z[i] - *origin) + climb
                    } else {
                        (ground[group].z[i] - ground[datum].z[i]) + (climb - below)
                    };
                }
            }
        }
    }

    /// Adds up the products of a block's rows.
    #[inline(always)]
    fn find_moments<S: Simd>(&mut self, simd: S, count: usize, tail: bool) {
        let Self { layout, ground, states, heights, first_rows, moments, reach, triples, .. } = self;
        let mut rows: Vec<&[Row]> = states[0].iter().map(|rows| &rows[..count]).collect();
        rows.extend(ground.iter().map(|ground| &ground.rise[1..=count]));
        rows.extend(layout.inner().map(|group| &ground[group].rise[..count]));
        rows.extend(heights[0].iter().map(|rows| &rows[..count]));
        rows.extend(first_rows.iter().map(|rows| &rows[..count]));
        let moments = &mut moments[usize::from(tail)];
        let (plain, inner) = (2 * MODES, layout.inner_rows());
        for (t, top) in triples.iter().enumerate() {
            let pick = |triple: &Range<usize>| {
                std::array::from_fn::<&[Row], 3, _>(|k| rows[(triple.start + k).min(triple.end - 1)])
            };
            let a = pick(top);
            for left in &triples[..=t] {
                let follows =
                    inner.contains(&top.start) && (left.end <= plain || inner.contains(&left.start));
                if follows && !tail {
                    continue;
                }
                let sums = match (top == left, top.len()) {
                    (true, _) => triangle(simd, a),
                    (false, 1) => products::<S, 1>(simd, a, pick(left)),
                    (false, 2) => products::<S, 2>(simd, a, pick(left)),
                    (false, _) => products::<S, 3>(simd, a, pick(left)),
                };
                for (row, sums) in top.clone().zip(&sums) {
                    for (column, sum) in left.clone().zip(sums).filter(|&(column, _)| column <= row) {
                        moments[place(row, column)] += *sum;
                        if column == row && row < reach.len() {
                            reach[row] = sum.sqrt();
                        }
                    }
                }
            }
        }
        for (row, (group, before)) in inner.zip(layout.inner().zip(&rows[layout.inner_rows()])) {
            let after = reach[plain + group];
            reach[row] = (after * after + before[0] * before[0]).sqrt();
        }
    }

    /// What the end of the last period adds to the moments that follow from others: see
    /// [`Setup::square`].
    #[inline(always)]
    fn close_moments<S: Simd>(&mut self, simd: S) {
        let Self { layout, ground, state, moments, .. } = self;
        let [moments, _] = moments;
        for part in parts(simd) {
            for (row, group) in layout.inner_rows().zip(layout.inner()) {
                let last = part.all(0.0) - part.load(&ground[group].rise[0]);
                for (column, state) in state.iter().enumerate() {
                    part.store(last * part.load(state), &mut moments[place(row, column)]);
                }
                for (column, group) in
                    layout.inner_rows().zip(layout.inner()).take_while(|&(column, _)| column <= row)
                {
                    part.store(last * part.load(&ground[group].rise[0]), &mut moments[place(row, column)]);
                }
            }
        }
    }

    /// Integrals of the squares over the runs, and what is not finite: that stays so, in states and
    /// moments; without any, in the first elevations.
    #[inline(always)]
    fn conclude<S: Simd>(&mut self, simd: S) {
        for part in parts(simd) {
            let mut flaw = part.all(0.0) * part.load(&self.origin);
            for row in self.moments.iter().flatten().chain(&self.first) {
                flaw = flaw + part.all(0.0) * part.load(row);
            }
            part.store(flaw, &mut self.flaw);
            for (weights, square) in self.constants.weights.iter().zip(&mut self.squares) {
                let mut sum = part.all(0.0);
                for (weight, moment) in weights.square.iter().flatten().zip(self.moments.iter().flatten()) {
                    sum = sum + part.load(weight) * part.load(moment);
                }
                part.store(sum, square);
            }
        }
    }

    /// Values at the ends of all legs; keeps the stretches that may hold a record.
    #[inline(always)]
    fn look<S: Simd>(&mut self, simd: S, count: usize, legs: usize) {
        if count * legs == 0 {
            return;
        }
        for output in 0..self.constants.weights.len() {
            match (self.layout.by_rate[output], self.layout.lines) {
                (false, false) => self.find_values::<S, false, false>(simd, output, count, legs),
                (true, false) => self.find_values::<S, true, false>(simd, output, count, legs),
                (_, true) => self.find_values::<S, true, true>(simd, output, count, legs),
            }
            let [mut top, mut bottom] = self.edges[0];
            for edges in &self.edges[1..count.div_ceil(CHUNK)] {
                (top, bottom) = (top.max(edges[0]), bottom.min(edges[1]));
            }
            self.records.see(output, top, bottom);
            let bulges = self.bulges(output);
            let most = bulges[0].min(bulges[1]);
            if self.records.may_break(output, top, bottom, most) != [0, 0] {
                for chunk in 0..count.div_ceil(CHUNK) {
                    let [top, bottom] = self.edges[chunk];
                    if self.records.may_break(output, top, bottom, most) != [0, 0] {
                        let periods = CHUNK * chunk..count.min(CHUNK * (chunk + 1));
                        self.sift(simd, output, periods, legs, [&bulges[0], &most]);
                    }
                }
            }
        }
    }

    /// Values of an output at the ends of all legs.
    #[inline(always)]
    fn find_values<S: Simd, const RATES: bool, const LINES: bool>(
        &mut self,
        simd: S,
        output: usize,
        count: usize,
        legs: usize,
    ) {
        for part in parts(simd) {
            let weights = part.load_all(&self.constants.weights[output].state);
            for chunk in 0..count.div_ceil(CHUNK) {
                let periods = CHUNK * chunk..count.min(CHUNK * (chunk + 1));
                let (mut top, mut bottom) = (part.all(f64::NEG_INFINITY), part.all(f64::INFINITY));
                for leg in 0..legs {
                    for i in periods.clone() {
                        let mut value = value::<S, RATES>(part, &weights, &self.states[leg], i);
                        if LINES {
                            value = value + self.lines(part, output, (leg, i), false);
                        }
                        part.store(value, &mut self.starts[leg][i]);
                        (top, bottom) = (top.max(value), bottom.min(value));
                    }
                    if LINES {
                        for i in periods.clone() {
                            let (next, then) = self.layout.after(leg, i);
                            let mut value = value::<S, RATES>(part, &weights, &self.states[next], then);
                            value = value + self.lines(part, output, (leg, i), true);
                            part.store(value, &mut self.ends[leg][i]);
                            (top, bottom) = (top.max(value), bottom.min(value));
                        }
                    }
                }
                if !LINES {
                    let (next, then) = self.layout.after(legs - 1, periods.end - 1);
                    let value = value::<S, RATES>(part, &weights, &self.states[next], then);
                    part.store(value, &mut self.starts[next][then]);
                    (top, bottom) = (top.max(value), bottom.min(value));
                }
                let [high, low] = &mut self.edges[chunk];
                part.store(top, high);
                part.store(bottom, low);
            }
        }
    }

    /// What elevations and slopes add to values at the starts, or just before the ends, of legs.
    #[inline(always)]
    fn lines<S: Simd>(
        &self,
        part: Part<S>,
        output: usize,
        (leg, i): (usize, usize),
        at_end: bool,
    ) -> Vector<S> {
        let weights = &self.constants.weights[output];
        let rises = if at_end { &weights.end_rise[leg] } else { &weights.rise };
        let mut line = part.all(0.0);
        for group in 0..self.ground.len() {
            let met = usize::from(self.layout.groups[group].leg <= leg);
            line = line + part.load(&rises[group]) * part.load(&self.ground[group].rise[i + met]);
            if self.layout.heights {
                let height = part.load(&weights.height[group]) * part.load(&self.heights[leg][group][i]);
                line = line + (height + part.load(&weights.first[group]) * part.load(&self.first[group]));
            }
        }
        line
    }

    /// The far side of the last station of all, where a damped output may jump.
    #[inline(always)]
    fn look_back<S: Simd>(&mut self, simd: S, leg: usize) {
        for output in 0..self.constants.weights.len() {
            let mut row = ZERO;
            for part in parts(simd) {
                let weights = part.load_all(&self.constants.weights[output].state);
                let value = value::<S, true>(part, &weights, &self.states[leg], 0);
                part.store(value + self.lines(part, output, (leg, 0), false), &mut row);
            }
            self.records.see(output, row, row);
        }
    }

    /// How far an output may rise above, or fall below, its values at the ends of the legs: by what it
    /// bends on the longest leg, and by what it swings.
    #[inline(always)]
    fn bulges(&self, output: usize) -> [Row; 2] {
        let reach = &self.reach;
        let groups = self.ground.len();
        let [by_bend, by_swing] = &self.constants.weights[output].bulge;
        [by_bend, by_swing].map(|BoundRows { state, after, before }| {
            let mut bound = ZERO;
            for (weight, reach) in state.iter().chain(after).zip(reach) {
                bound += *weight * *reach;
            }
            for (group, reach) in self.layout.inner().zip(&reach[2 * MODES + groups..]) {
                bound += before[group] * *reach;
            }
            bound
        })
    }

    /// Keeps the stretches of a chunk that may hold a record: by the block's bounds, which are at hand,
    /// then by the period's own.
    ///
    /// Where |F″| h²/8 ≤ B and the values at the ends differ by D, F has no summit between them if
    /// |D| ≥ 4B; else it stays below their mean + B + D²/(16B).
    #[inline(always)]
    fn sift<S: Simd>(
        &mut self,
        simd: S,
        output: usize,
        periods: Range<usize>,
        legs: usize,
        [bend, most]: [&Row; 2],
    ) {
        for part in parts(simd) {
            let most = part.load(most);
            for leg in 0..legs {
                let far = part.all(4.0) * part.load(bend) * part.load(&self.constants.shorter[leg]);
                for i in periods.clone() {
                    let [start, end] = self.ends_of(leg, i);
                    let (start, end) = (part.load(start), part.load(end));
                    let [high, low] = part.load_all(&self.records.best(output));
                    let high = (start.max(end) + most).above(high);
                    let low = (most - start.min(end)).above(low);
                    if (far.above((end - start).abs()) & (high | low)).any() {
                        self.weigh(part, output, (leg, i));
                    }
                }
            }
        }
    }

    /// Values at the ends of a leg.
    #[inline(always)]
    fn ends_of(&self, leg: usize, i: usize) -> [&Row; 2] {
        let (next, then) = self.layout.after(leg, i);
        [&self.starts[leg][i], if self.layout.lines { &self.ends[leg][i] } else { &self.starts[next][then] }]
    }

    /// See [`March::sift`], with the period's own bounds.
    #[inline(always)]
    fn weigh<S: Simd>(&mut self, part: Part<S>, output: usize, (leg, i): (usize, usize)) {
        let [start, end] = self.ends_of(leg, i);
        let (start, end) = (part.load(start), part.load(end));
        let [bend, swing] = self.own_bulges(part, output, i);
        let bulge = bend * part.load(&self.constants.shorter[leg]);
        let (step, mean) = (end - start, part.all(0.5) * (start + end));
        let over = bulge + step * step / (part.all(16.0) * bulge);
        let holds = (part.all(4.0) * bulge).above(step.abs());
        let bounds = [(mean + over).min(start.max(end) + swing), (over - mean).min(swing - start.min(end))];
        for side in 0..2 {
            let record = self.records.best(output)[side];
            let breaks = holds & bounds[side].above(part.load(&record));
            if breaks.any() {
                let mut row = ZERO;
                part.store(breaks.choose(bounds[side], part.all(f64::NEG_INFINITY)), &mut row);
                for lane in part.lanes().filter(|&lane| row[lane] > record[lane]) {
                    let candidate = self.candidate(output, leg, i, lane, row[lane]);
                    self.records.keep(output, side, lane, candidate);
                }
            }
        }
    }

    /// See [`March::bulges`], for one period.
    #[inline(always)]
    fn own_bulges<S: Simd>(&self, part: Part<S>, output: usize, i: usize) -> [Vector<S>; 2] {
        let mut bounds = [part.all(0.0); 2];
        for (bound, rows) in bounds.iter_mut().zip(&self.constants.weights[output].bulge) {
            for (weight, states) in rows.state.iter().zip(&self.states[0]) {
                *bound = *bound + part.load(weight) * part.load(&states[i]).abs();
            }
            for (group, Ground { rise, .. }) in self.ground.iter().enumerate() {
                *bound = *bound + part.load(&rows.after[group]) * part.load(&rise[i + 1]).abs();
                *bound = *bound + part.load(&rows.before[group]) * part.load(&rise[i]).abs();
            }
        }
        bounds
    }

    /// A leg of one run as a stretch to be searched.
    fn candidate(&self, output: usize, leg: usize, i: usize, lane: usize, bound: f64) -> Candidate {
        let weights = &self.constants.weights[output];
        let none = Lanes::ZERO;
        let mut state = State { d: none, v: none, p: none };
        let mut drive = transition::Drive { beta: none, gamma: none };
        let (mut start, mut growth) = (0.0, 0.0);
        for mode in 0..MODES {
            state.d[mode] = self.states[leg][mode][i][lane];
            state.v[mode] = self.states[leg][MODES + mode][i][lane];
        }
        for group in 0..self.ground.len() {
            let met = usize::from(self.layout.groups[group].leg <= leg);
            let rise = self.ground[group].rise[i + met][lane];
            for mode in 0..MODES {
                drive.beta[mode] += self.constants.climb[group][mode][lane] * rise;
                drive.gamma[mode] += self.constants.drag[group][mode][lane] * rise;
            }
            start += weights.rise[group][lane] * rise;
            growth += (weights.end_rise[leg][group][lane] - weights.rise[group][lane]) * rise;
            if self.layout.heights {
                start += weights.height[group][lane] * self.heights[leg][group][i][lane]
                    + weights.first[group][lane] * self.first[group][lane];
            }
        }
        Candidate { bound, leg, state, drive, start, growth }
    }
}

/// Where the product of two rows stands among the moments.
#[inline(always)]
fn place(row: usize, column: usize) -> usize {
    row * (row + 1) / 2 + column
}

/// A push in registers.
#[inline(always)]
fn loaded<S: Simd>(part: Part<S>, push: &Push<Row>) -> Push<Vector<S>> {
    [part.load_all(&push[0]), part.load_all(&push[1])]
}

/// What a state gives; without rates, displacements alone.
#[inline(always)]
fn value<S: Simd, const RATES: bool>(
    part: Part<S>,
    weights: &States<Vector<S>>,
    states: &States<MoreRows>,
    i: usize,
) -> Vector<S> {
    let mut value = weights[0] * part.load(&states[0][i]);
    for k in 1..MODES {
        value = value + weights[k] * part.load(&states[k][i]);
    }
    if RATES {
        let mut rates = weights[MODES] * part.load(&states[MODES][i]);
        for k in MODES + 1..2 * MODES {
            rates = rates + weights[k] * part.load(&states[k][i]);
        }
        value = value + rates;
    }
    value
}

/// Sums of products of `N` ≤ 3 rows with three.
#[inline(always)]
fn products<S: Simd, const N: usize>(simd: S, a: [&[Row]; 3], b: [&[Row]; 3]) -> [[Row; 3]; 3] {
    let mut sums = [[ZERO; 3]; 3];
    let count = a[0].len();
    let (a, b) = (a.map(|row| &row[..count]), b.map(|row| &row[..count]));
    for part in parts(simd) {
        let mut sum = [[part.all(0.0); 3]; N];
        for i in 0..count {
            let b = [part.load(&b[0][i]), part.load(&b[1][i]), part.load(&b[2][i])];
            for row in 0..N {
                let a = part.load(&a[row][i]);
                for column in 0..3 {
                    sum[row][column] = sum[row][column] + a * b[column];
                }
            }
        }
        for row in 0..N {
            for column in 0..3 {
                part.store(sum[row][column], &mut sums[row][column]);
            }
        }
    }
    sums
}

/// Sums of products of three rows with themselves, on and below the diagonal.
#[inline(always)]
fn triangle<S: Simd>(simd: S, a: [&[Row]; 3]) -> [[Row; 3]; 3] {
    let mut sums = [[ZERO; 3]; 3];
    let count = a[0].len();
    let a = a.map(|row| &row[..count]);
    for part in parts(simd) {
        let mut sum = [[part.all(0.0); 3]; 3];
        for i in 0..count {
            let a = [part.load(&a[0][i]), part.load(&a[1][i]), part.load(&a[2][i])];
            for row in 0..3 {
                for column in 0..=row {
                    sum[row][column] = sum[row][column] + a[row] * a[column];
                }
            }
        }
        for row in 0..3 {
            for column in 0..=row {
                part.store(sum[row][column], &mut sums[row][column]);
            }
        }
    }
    sums
}
