//! Runs side by side, a block of periods at a time: slopes, states, moments, values.
//!
//! A block's numbers stay in the first-level cache from one pass to the next; every pass is a plain
//! loop over rows. (The rows' bounds are left to be checked in these loops on purpose: the compiler
//! would otherwise vectorise across periods instead of runs, by gathering and scattering.)

use std::ops::Range;

use multiversion::multiversion;

use super::records::{Candidate, Records};
use super::row::Row;
use super::setup::{Bound, Layout, MODES, Reading, Setup};
use super::{Reader, Statistics};
use crate::extremes::Output;
use crate::lanes::Lanes;
use crate::transition::{self, State};

/// Periods of a block.
pub(super) const PERIODS: usize = 32;

const ZERO: Row = Row::ZERO;

/// A row for each period of a block.
type Rows = [Row; PERIODS];

/// d and ẏ/ω of each mode.
type States<T> = [T; 2 * MODES];

/// The set-up of a lane; of idle ones, the last.
fn of_lane(setups: &[Setup], lane: usize) -> &Setup {
    &setups[lane.min(setups.len() - 1)]
}

/// A number of every lane's set-up.
fn gather(setups: &[Setup], part: impl Fn(&Setup) -> f64) -> Row {
    Row(std::array::from_fn(|lane| part(of_lane(setups, lane))))
}

/// One mode's transition over a leg.
#[derive(Clone, Copy)]
struct Step {
    g: Row,
    s: Row,
    w: Row,
    h: Row,
}

/// Weights of an output.
struct Weights {
    d: [Row; MODES],
    v: [Row; MODES],
    rise: Vec<Row>,
    /// Of the rises, at the end of each leg: heights grow on the way.
    end_rise: Vec<Vec<Row>>,
    height: Vec<Row>,
    first: Vec<Row>,
    bulge: [BoundRows; 2],
}

impl Weights {
    /// What the state gives; without rates, displacements alone.
    #[inline(always)]
    fn of(&self, state: &States<Row>, rates: bool) -> Row {
        let Self { d, v, .. } = self;
        let value = (d[0] * state[0] + d[1] * state[1]) + d[2] * state[2];
        if rates { value + ((v[0] * state[3] + v[1] * state[4]) + v[2] * state[5]) } else { value }
    }
}

/// See [`Bound`].
struct BoundRows {
    state: States<Row>,
    after: Vec<Row>,
    before: Vec<Row>,
}

impl BoundRows {
    fn new(setups: &[Setup], of: impl Fn(&Setup) -> &Bound) -> Self {
        let groups = setups[0].layout.groups.len();
        Self {
            state: std::array::from_fn(|i| gather(setups, |s| of(s).state[i / MODES][i % MODES])),
            after: (0..groups).map(|g| gather(setups, |s| of(s).after[g])).collect(),
            before: (0..groups).map(|g| gather(setups, |s| of(s).before[g])).collect(),
        }
    }
}

/// Constants of the runs side by side.
pub(super) struct Constants {
    /// Leg by leg, mode by mode.
    steps: Vec<[Step; MODES]>,
    climb: Vec<[Row; MODES]>,
    drag: Vec<[Row; MODES]>,
    weights: Vec<Weights>,
    /// Square of each leg's length as a share of the longest one's.
    shorter: Vec<Row>,
    /// How far each leg begins from a group's station, in spacings: leg by leg, group by group.
    from_station: Vec<Vec<Row>>,
}

impl Constants {
    pub fn new(setups: &[Setup]) -> Self {
        let layout = &setups[0].layout;
        let (legs, groups) = (layout.legs, layout.groups.len());
        let step = |leg: usize, m: usize| Step {
            g: gather(setups, |s| s.transition[leg].g[m]),
            s: gather(setups, |s| s.transition[leg].s[m]),
            w: gather(setups, |s| s.transition[leg].w[m]),
            h: gather(setups, |s| s.transition[leg].h[m]),
        };
        let by_mode = |of: &dyn Fn(&Setup) -> Lanes| std::array::from_fn(|m| gather(setups, |s| of(s)[m]));
        let weights = |output: usize| {
            let by_group = |of: &dyn Fn(&Reading, &Setup, usize) -> f64| -> Vec<Row> {
                (0..groups).map(|g| gather(setups, |s| of(&s.readings[output], s, g))).collect()
            };
            Weights {
                d: by_mode(&|s| s.readings[output].output.form.d),
                v: by_mode(&|s| s.readings[output].output.form.v),
                rise: by_group(&|r, _, g| r.rise[g]),
                end_rise: (0..legs)
                    .map(|leg| by_group(&|r, s, g| r.rise[g] + r.rate[g] * s.dt[leg]))
                    .collect(),
                height: by_group(&|r, _, g| r.height[g]),
                first: by_group(&|r, _, g| r.first[g]),
                bulge: [0, 1].map(|kind| BoundRows::new(setups, |s| &s.readings[output].bulge[kind])),
            }
        };
        Self {
            steps: (0..legs).map(|leg| std::array::from_fn(|m| step(leg, m))).collect(),
            climb: (0..groups).map(|g| by_mode(&|s| s.climb[g])).collect(),
            drag: (0..groups).map(|g| by_mode(&|s| s.drag[g])).collect(),
            weights: (0..setups[0].readings.len()).map(weights).collect(),
            shorter: (0..legs)
                .map(|leg| gather(setups, |s| (s.dt[leg] / s.dt.iter().copied().fold(0.0, f64::max)).powi(2)))
                .collect(),
            from_station: (0..legs)
                .map(|leg| (0..groups).map(|g| gather(setups, |s| s.begin[leg] - s.part[g])).collect())
                .collect(),
        }
    }
}

/// One group's elevations and rises in a block.
#[derive(Clone)]
struct Ground {
    /// Elevation of the station met in each period, and of the next one.
    z: [Row; PERIODS + 1],
    /// Rise up to the station met in each period, and from the last one on.
    rise: [Row; PERIODS + 1],
}

/// What drives the modes from one leg of a period on: rates of their static positions ÷ ω and
/// forces ÷ ω², in the period at hand and in the one before.
#[derive(Clone)]
struct Drive {
    groups: Range<usize>,
    beta: [Row; MODES],
    gamma: [Row; MODES],
    last_beta: [Row; MODES],
    last_gamma: [Row; MODES],
}

/// Where several runs are on their way.
pub(super) struct March<'a> {
    setups: &'a [Setup],
    pub layout: &'a Layout,
    constants: &'a Constants,
    ground: Vec<Ground>,
    /// First elevations less those of the first group.
    first: Vec<Row>,
    first_rows: Vec<Rows>,
    origin: Row,
    /// States at the start of each leg, leg by leg, and at the end of the block.
    states: Vec<States<Rows>>,
    state: States<Row>,
    /// Heights at the start of each leg, leg by leg, group by group.
    heights: Vec<Vec<Rows>>,
    /// Leg by leg.
    drives: Vec<Drive>,
    /// Values at the starts of the legs, output by output, leg by leg; of one output just before
    /// their ends, where these are not the next ones' starts.
    values: Vec<Vec<Rows>>,
    ends: Vec<Rows>,
    /// Largest and smallest values of each output in the block.
    edges: Vec<[Row; 2]>,
    /// Moments of the periods' rows, lower triangle, over the run and over its tail.
    moments: [Vec<Row>; 2],
    records: Records,
    /// Tools to search with, set-up by set-up, output by output.
    searches: Vec<Vec<Output>>,
}

impl<'a> March<'a> {
    pub fn new(setups: &'a [Setup], constants: &'a Constants) -> Self {
        let layout = &*setups[0].layout;
        let searches = |setup: &Setup| setup.readings.iter().map(|reading| reading.output.clone()).collect();
        let groups = layout.groups.len();
        let rows = layout.rows();
        let heights = if layout.heights { groups } else { 0 };
        let none = [ZERO; PERIODS];
        let still = [ZERO; MODES];
        let drive = |leg: usize| {
            let begin = layout.groups.iter().take_while(|group| group.leg < leg).count();
            let count = layout.groups.iter().filter(|group| group.leg == leg).count();
            let groups = begin..begin + count;
            Drive { groups, beta: still, gamma: still, last_beta: still, last_gamma: still }
        };
        Self {
            setups,
            layout,
            constants,
            ground: vec![Ground { z: [ZERO; PERIODS + 1], rise: [ZERO; PERIODS + 1] }; groups],
            first: vec![ZERO; groups],
            first_rows: vec![none; heights],
            origin: ZERO,
            states: vec![[none; 2 * MODES]; layout.legs],
            state: [ZERO; 2 * MODES],
            heights: vec![vec![none; heights]; layout.legs],
            drives: (0..layout.legs).map(drive).collect(),
            values: vec![vec![none; layout.legs]; constants.weights.len()],
            ends: vec![none; if layout.damped { layout.legs } else { 0 }],
            edges: vec![[ZERO; 2]; constants.weights.len()],
            moments: [vec![ZERO; rows * (rows + 1) / 2], vec![ZERO; rows * (rows + 1) / 2]],
            records: Records::new(layout.loads, constants.weights.len()),
            searches: setups.iter().map(searches).collect(),
        }
    }

    /// Begins anew, at rest on the first elevations.
    pub fn start(&mut self, reader: &mut impl Reader) {
        self.state = [ZERO; 2 * MODES];
        for drive in &mut self.drives {
            (drive.beta, drive.gamma) = ([ZERO; MODES], [ZERO; MODES]);
        }
        for ground in &mut self.ground {
            ground.rise[PERIODS] = ZERO;
        }
        for moments in &mut self.moments {
            moments.fill(ZERO);
        }
        self.records.restart();
        for (ground, group) in self.ground.iter_mut().zip(&self.layout.groups) {
            reader.read(group.track, 0, &mut ground.z[PERIODS..]);
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
                reader.read(group.track, first, &mut ground.z[before..after]);
            }
            let end = ground.z[after - 1];
            ground.z[after..=count].fill(end);
        }
        let legs = if tail { self.layout.tail } else { self.layout.legs };
        work(self, count, legs, tail);
        for ground in &mut self.ground {
            ground.z[PERIODS] = ground.z[count];
            ground.rise[PERIODS] = ground.rise[count];
        }
    }
}

impl March<'_> {
    /// Whether a run has remained in the range of double precision: what is not finite stays so, in
    /// states and moments; without any, in the first elevations.
    pub fn is_finite(&self, lane: usize) -> bool {
        self.moments.iter().flatten().chain(&self.first).all(|row| row[lane].is_finite())
            && self.origin[lane].is_finite()
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
                let squares = self.moments.iter().zip(&setup.readings[output].square);
                let square: f64 = squares.map(|(moments, form)| quadratic(moments, form, lane)).sum();
                rms = if setup.duration > 0.0 { (square.max(0.0) / setup.duration).sqrt() } else { 0.0 };
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

/// Σ form × moments, the moments' lower triangle given.
fn quadratic(moments: &[Row], form: &[f64], lane: usize) -> f64 {
    form.iter().zip(moments).map(|(weight, moment)| weight * moment[lane]).sum()
}

/// What of a block is arithmetic.
#[multiversion(targets("x86_64+avx512f+avx512dq+avx512vl+avx512bw", "x86_64+avx2"))]
fn work(march: &mut March, count: usize, legs: usize, tail: bool) {
    match (march.layout.legs, march.layout.damped) {
        (1, false) if !tail => march.find_states::<1, false>(count, legs),
        (2, false) if !tail => march.find_states::<2, false>(count, legs),
        (_, false) => march.find_states::<0, false>(count, legs),
        (_, true) => march.find_states::<0, true>(count, legs),
    }
    if march.layout.heights {
        // The tail ends where its next leg begins.
        march.find_heights(count, if tail { legs + 1 } else { legs });
    }
    let reach = march.find_moments(count, tail);
    march.look(count, legs, &reach);
    if tail && march.layout.damped {
        march.look_back(legs);
    }
}

impl March<'_> {
    /// Rises, and states at the start of every leg; `L` legs, any number for 0.
    #[inline(always)]
    fn find_states<const L: usize, const DAMPED: bool>(&mut self, count: usize, legs: usize) {
        let Self { layout, constants, ground, states, state, drives, values, edges, .. } = self;
        let outputs = constants.weights.len();
        edges.fill([Row::all(f64::NEG_INFINITY), Row::all(f64::INFINITY)]);
        let all = if L == 0 { drives.len() } else { L };
        let legs = if L == 0 { legs } else { L };
        let (drives, states, steps) = (&mut drives[..all], &mut states[..all], &constants.steps[..all]);
        let mut now = *state;
        for i in 0..count {
            for drive in &mut *drives {
                drive.last_beta = drive.beta;
                if DAMPED {
                    drive.last_gamma = drive.gamma;
                }
                let (mut beta, mut gamma) = ([ZERO; MODES], [ZERO; MODES]);
                for group in drive.groups.clone() {
                    let Ground { z, rise } = &mut ground[group];
                    let up = z[i + 1] - z[i];
                    rise[i + 1] = up;
                    for mode in 0..MODES {
                        beta[mode] += constants.climb[group][mode] * up;
                        if DAMPED {
                            gamma[mode] += constants.drag[group][mode] * up;
                        }
                    }
                }
                drive.beta = beta;
                if DAMPED {
                    drive.gamma = gamma;
                }
            }
            for leg in 0..legs {
                for output in 0..outputs {
                    let value = constants.weights[output].of(&now, layout.by_rate[output]);
                    values[output][leg][i] = value;
                    let [top, bottom] = &mut edges[output];
                    *top = top.max(value);
                    *bottom = bottom.min(value);
                }
                for mode in 0..MODES {
                    let Step { g, s, w, h } = steps[leg][mode];
                    let (mut beta, mut gamma) = (drives[0].beta[mode], drives[0].gamma[mode]);
                    for from in 1..all {
                        let Drive { beta: new_beta, gamma: new_gamma, last_beta, last_gamma, .. } =
                            &drives[from];
                        beta += if from <= leg { new_beta[mode] } else { last_beta[mode] };
                        if DAMPED {
                            gamma += if from <= leg { new_gamma[mode] } else { last_gamma[mode] };
                        }
                    }
                    let (d, v) = (now[mode], now[MODES + mode]);
                    states[leg][mode][i] = d;
                    states[leg][MODES + mode][i] = v;
                    let pull = s * v - g * d;
                    let (mut after_d, mut after_v) =
                        ((d - h * beta) + pull, (v + g * beta) - (w * v + s * d));
                    if DAMPED {
                        after_d += g * gamma;
                        after_v += s * gamma;
                    }
                    (now[mode], now[MODES + mode]) = (after_d, after_v);
                }
            }
        }
        *state = now;
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

    /// Adds up the products of a block's rows; gives the roots of the squares of states and rises.
    #[inline(always)]
    fn find_moments(&mut self, count: usize, tail: bool) -> Vec<Row> {
        let Self { layout, ground, states, heights, first_rows, moments, .. } = self;
        let mut rows: Vec<&[Row]> = states[0].iter().map(|rows| &rows[..count]).collect();
        rows.extend(ground.iter().map(|ground| &ground.rise[1..=count]));
        rows.extend(layout.inner().map(|group| &ground[group].rise[..count]));
        let plain = rows.len();
        rows.extend(heights[0].iter().map(|rows| &rows[..count]));
        rows.extend(first_rows.iter().map(|rows| &rows[..count]));
        let moments = &mut moments[usize::from(tail)];
        let mut roots = vec![ZERO; plain];
        for top in (0..rows.len()).step_by(3) {
            let high = (rows.len() - top).min(3);
            let pick =
                |at: usize| std::array::from_fn::<&[Row], 3, _>(|k| rows[(at + k).min(rows.len() - 1)]);
            let a = pick(top);
            for left in (0..=top).step_by(3) {
                let sums = match (top == left, high) {
                    (true, _) => triangle(a, count),
                    (false, 1) => products::<1>(a, pick(left), count),
                    (false, 2) => products::<2>(a, pick(left), count),
                    (false, _) => products::<3>(a, pick(left), count),
                };
                for (i, sums) in sums.iter().enumerate().take(high) {
                    let row = top + i;
                    for (column, sum) in (left..=row).zip(sums) {
                        moments[row * (row + 1) / 2 + column] += *sum;
                        if column == row && row < plain {
                            roots[row] = sum.sqrt();
                        }
                    }
                }
            }
        }
        roots
    }

    /// Values at the ends of all legs; keeps the stretches that may hold a record.
    #[inline(always)]
    fn look(&mut self, count: usize, legs: usize, reach: &[Row]) {
        if count * legs == 0 {
            return;
        }
        for output in 0..self.constants.weights.len() {
            let mut edges = self.edges[output];
            if self.layout.lines {
                edges = [Row::all(f64::NEG_INFINITY), Row::all(f64::INFINITY)];
            }
            for leg in 0..legs {
                if self.layout.lines {
                    self.add_lines(output, leg, count);
                    scan(&self.values[output][leg][..count], &mut edges);
                }
                if self.layout.damped {
                    for i in 0..count {
                        self.ends[leg][i] = self.end_value(output, leg, legs, i, count);
                    }
                    scan(&self.ends[leg][..count], &mut edges);
                }
            }
            let last = self.end_value(output, legs - 1, legs, count - 1, count);
            scan(&[last], &mut edges);
            let [top, bottom] = edges;
            self.records.see(output, top, bottom);
            let bulges = self.bulges(output, reach);
            if self.records.may_hold(output, top, bottom, bulges[0].min(bulges[1])) {
                self.sift(output, (count, legs), bulges, last);
            }
        }
    }

    /// The far side of the last station of all, where a damped output may jump.
    fn look_back(&mut self, leg: usize) {
        for output in 0..self.constants.weights.len() {
            self.values[output][leg][0] = self.constants.weights[output].of(&self.state, true);
            self.add_lines(output, leg, 1);
            let value = self.values[output][leg][0];
            self.records.see(output, value, value);
        }
    }

    /// Adds elevations and slopes to the values at the starts of a leg.
    #[inline(always)]
    fn add_lines(&mut self, output: usize, leg: usize, count: usize) {
        let Self { layout, constants, ground, heights, first, values, .. } = self;
        let weights = &constants.weights[output];
        for i in 0..count {
            let mut value = ZERO;
            for group in 0..ground.len() {
                let met = usize::from(layout.groups[group].leg <= leg);
                value += weights.rise[group] * ground[group].rise[i + met];
                if layout.heights {
                    value +=
                        weights.height[group] * heights[leg][group][i] + weights.first[group] * first[group];
                }
            }
            values[output][leg][i] += value;
        }
    }

    /// Value just before the end of a leg.
    #[inline(always)]
    fn end_value(&self, output: usize, leg: usize, legs: usize, i: usize, count: usize) -> Row {
        let weights = &self.constants.weights[output];
        let state: States<Row> = if leg + 1 < legs {
            std::array::from_fn(|part| self.states[leg + 1][part][i])
        } else if i + 1 < count {
            std::array::from_fn(|part| self.states[0][part][i + 1])
        } else {
            self.state
        };
        let mut value = weights.of(&state, self.layout.by_rate[output]);
        if self.layout.lines {
            for group in 0..self.ground.len() {
                let met = usize::from(self.layout.groups[group].leg <= leg);
                value += weights.end_rise[leg][group] * self.ground[group].rise[i + met];
                if self.layout.heights {
                    value += weights.height[group] * self.heights[leg][group][i]
                        + weights.first[group] * self.first[group];
                }
            }
        }
        value
    }

    /// How far an output may rise above, or fall below, its values at the ends of the legs: by what it
    /// bends on the longest leg, and by what it swings.
    #[inline(always)]
    fn bulges(&self, output: usize, reach: &[Row]) -> [Row; 2] {
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

    /// Keeps the stretches of a block that may hold a record of an output.
    ///
    /// Where |F″| h²/8 ≤ B and the values at the ends differ by D, F has no summit between them if
    /// |D| ≥ 4B; else it stays below their mean + B + D²/(16B).
    #[inline(always)]
    fn sift(&mut self, output: usize, (count, legs): (usize, usize), bulges: [Row; 2], last: Row) {
        let [high, low] = self.records.best(output);
        for leg in 0..legs {
            let bulge = bulges[0] * self.constants.shorter[leg];
            let (inverse, far) = (Row::all(0.0625).over(bulge), Row::all(4.0) * bulge);
            for i in 0..count {
                let start = self.values[output][leg][i];
                let end = if self.layout.damped {
                    self.ends[leg][i]
                } else if leg + 1 < legs {
                    self.values[output][leg + 1][i]
                } else if i + 1 < count {
                    self.values[output][0][i + 1]
                } else {
                    last
                };
                let (step, mean) = (end - start, Row::all(0.5) * (start + end));
                let over = bulge + step * step * inverse;
                let near = far.above(step) & step.above(Row::ZERO - far);
                let sides = [(mean + over).above(high) & near, (over - mean).above(low) & near];
                if sides != [0, 0] {
                    let bounds = [
                        (mean + over).min(start.max(end) + bulges[1]),
                        (over - mean).min(bulges[1] - start.min(end)),
                    ];
                    self.keep(output, (leg, i), sides, &bounds);
                }
            }
        }
    }

    /// Keeps a leg for the runs whose bits are set.
    #[cold]
    #[inline(never)]
    fn keep(&mut self, output: usize, (leg, i): (usize, usize), sides: [u8; 2], bounds: &[Row; 2]) {
        for side in 0..2 {
            let mut bits = sides[side];
            while bits != 0 {
                let lane = bits.trailing_zeros() as usize;
                bits &= bits - 1;
                let bound = bounds[side][lane];
                if bound > self.records.best(output)[side][lane] {
                    let candidate = self.candidate(output, leg, i, lane, bound);
                    self.records.keep(output, side, lane, candidate);
                }
            }
        }
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

/// Takes some rows into the largest and smallest.
#[inline(always)]
fn scan(values: &[Row], [top, bottom]: &mut [Row; 2]) {
    for value in values {
        *top = top.max(*value);
        *bottom = bottom.min(*value);
    }
}

/// Sums of products of `N` ≤ 3 rows with three.
#[inline(always)]
fn products<const N: usize>(a: [&[Row]; 3], b: [&[Row]; 3], count: usize) -> [[Row; 3]; 3] {
    let (a, b) = (a.map(|row| &row[..count]), b.map(|row| &row[..count]));
    let mut sums = [[ZERO; 3]; 3];
    for i in 0..count {
        for row in 0..N {
            for column in 0..3 {
                sums[row][column] += a[row][i] * b[column][i];
            }
        }
    }
    sums
}

/// Sums of products of three rows with themselves, on and below the diagonal.
#[inline(always)]
fn triangle(a: [&[Row]; 3], count: usize) -> [[Row; 3]; 3] {
    let a = a.map(|row| &row[..count]);
    let mut sums = [[ZERO; 3]; 3];
    for i in 0..count {
        for row in 0..3 {
            for column in 0..=row {
                sums[row][column] += a[row][i] * a[column][i];
            }
        }
    }
    sums
}
