//! Largest and smallest values at the ends of legs, and the legs that may exceed them in between.

use std::ops::Range;

use pulp::Simd;

use super::super::constants::{BoundRows, States};
use super::super::records::Candidate;
use super::super::setup::MODES;
use super::super::vector::{Part, Vector, parts};
use super::{CHUNK, Ground, March, MoreRows, PERIODS, Row, ZERO};
use crate::lanes::Lanes;
use crate::transition::{Drive, State};

impl March<'_> {
    /// Values at the ends of all legs; keeps the stretches that may hold a record.
    #[inline(always)]
    pub(super) fn look<S: Simd>(&mut self, simd: S, count: usize, legs: usize) {
        if count * legs == 0 {
            return;
        }
        for output in 0..self.constants.weights.len() {
            match (self.layout.by_rate[output], self.layout.lines) {
                (false, false) => self.find_values::<S, false>(simd, output, count, legs),
                (true, false) => self.find_values::<S, true>(simd, output, count, legs),
                (_, true) => self.find_jumping_values(simd, output, count, legs),
            }
            let [mut top, mut bottom] = self.edges[0];
            for edges in &self.edges[1..count.div_ceil(CHUNK)] {
                (top, bottom) = (top.max(edges[0]), bottom.min(edges[1]));
            }
            self.records.see(output, top, bottom);
            if !self.between {
                continue;
            }
            let [high, low] = self.records.best(output);
            for part in parts(simd) {
                let [bend, swing] = self.bulges(part, output);
                let most = bend.min(swing);
                // From here on values may come to break a record between the ends of legs.
                let limits = [part.load(&high) - most, most - part.load(&low)];
                for chunk in 0..count.div_ceil(CHUNK) {
                    let [top, bottom] = part.load_all(&self.edges[chunk]);
                    if (top.above(limits[0]) | limits[1].above(bottom)).any() {
                        let periods = CHUNK * chunk..count.min(CHUNK * (chunk + 1));
                        self.sift(part, output, periods, legs, bend, limits);
                    }
                }
            }
        }
    }

    /// Values of an output at the ends of all legs.
    #[inline(always)]
    fn find_values<S: Simd, const RATES: bool>(&mut self, simd: S, output: usize, count: usize, legs: usize) {
        let Self { layout, constants, states, starts, edges, .. } = self;
        for part in parts(simd) {
            let weights = part.load_all(&constants.weights[output].state);
            let (next, then) = layout.after(legs - 1, count - 1);
            part.store(value::<S, RATES>(part, &weights, &states[next], then), &mut starts[next][then]);
            let mut all = [[part.all(f64::NEG_INFINITY), part.all(f64::INFINITY)]; PERIODS / CHUNK];
            for leg in 0..legs {
                let (states, starts) = (&states[leg], &mut starts[leg]);
                for (chunk, [top, bottom]) in all[..count.div_ceil(CHUNK)].iter_mut().enumerate() {
                    for i in CHUNK * chunk..count.min(CHUNK * (chunk + 1)) {
                        let value = value::<S, RATES>(part, &weights, states, i);
                        part.store(value, &mut starts[i]);
                        (*top, *bottom) = (top.max(value), bottom.min(value));
                    }
                }
            }
            for (chunk, [top, bottom]) in all[..count.div_ceil(CHUNK)].iter().enumerate() {
                let (next, then) = layout.after(legs - 1, count.min(CHUNK * (chunk + 1)) - 1);
                let end = part.load(&starts[next][then]);
                part.store(top.max(end), &mut edges[chunk][0]);
                part.store(bottom.min(end), &mut edges[chunk][1]);
            }
        }
    }

    /// The same where slopes or elevations enter, so that values may jump.
    #[inline(always)]
    fn find_jumping_values<S: Simd>(&mut self, simd: S, output: usize, count: usize, legs: usize) {
        for part in parts(simd) {
            let weights = part.load_all(&self.constants.weights[output].state);
            for chunk in 0..count.div_ceil(CHUNK) {
                let (mut top, mut bottom) = (part.all(f64::NEG_INFINITY), part.all(f64::INFINITY));
                for i in CHUNK * chunk..count.min(CHUNK * (chunk + 1)) {
                    for leg in 0..legs {
                        let start = value::<S, true>(part, &weights, &self.states[leg], i)
                            + self.lines(part, output, (leg, i), false);
                        let (next, then) = self.layout.after(leg, i);
                        let end = value::<S, true>(part, &weights, &self.states[next], then)
                            + self.lines(part, output, (leg, i), true);
                        part.store(start, &mut self.starts[leg][i]);
                        part.store(end, &mut self.ends[leg][i]);
                        (top, bottom) = (top.max(start).max(end), bottom.min(start).min(end));
                    }
                }
                part.store(top, &mut self.edges[chunk][0]);
                part.store(bottom, &mut self.edges[chunk][1]);
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
    pub(super) fn look_back<S: Simd>(&mut self, simd: S, leg: usize) {
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
    fn bulges<S: Simd>(&self, part: Part<S>, output: usize) -> [Vector<S>; 2] {
        let (states, rises) = self.reach.split_at(2 * MODES);
        let (rises, inner) = rises.split_at(self.ground.len());
        let mut bounds = [part.all(0.0); 2];
        for (bound, rows) in bounds.iter_mut().zip(&self.constants.weights[output].bulge) {
            for (weight, reach) in rows.state.iter().zip(states).chain(rows.after.iter().zip(rises)) {
                *bound = *bound + part.load(weight) * part.load(reach);
            }
            for (group, reach) in self.layout.inner().zip(inner) {
                *bound = *bound + part.load(&rows.before[group]) * part.load(reach);
            }
        }
        bounds
    }

    /// Keeps the stretches of a chunk that may hold a record: by the block's bounds, which are at hand,
    /// then by the period's own.
    ///
    /// Where |F″| h²/8 ≤ B and the values at the ends differ by D, F has no summit between them if
    /// |D| ≥ 4B; else it stays below their mean + B + D²/(16B).
    #[inline(always)]
    fn sift<S: Simd>(
        &mut self,
        part: Part<S>,
        output: usize,
        periods: Range<usize>,
        legs: usize,
        bend: Vector<S>,
        limits: [Vector<S>; 2],
    ) {
        for leg in 0..legs {
            let far = part.all(4.0) * bend * part.load(&self.constants.shorter[leg]);
            for i in periods.clone() {
                let [start, end] = self.ends_of(leg, i);
                let (start, end) = (part.load(start), part.load(end));
                let reached = start.max(end).above(limits[0]) | limits[1].above(start.min(end));
                if (reached & far.above((end - start).abs())).any() {
                    self.weigh(part, output, (leg, i));
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
        let [by_bend, by_swing] = &self.constants.weights[output].bulge;
        let bulge = self.own_bulge(part, by_bend, i) * part.load(&self.constants.shorter[leg]);
        let (step, mean) = (end - start, part.all(0.5) * (start + end));
        let over = bulge + step * step / (part.all(16.0) * bulge);
        let holds = (part.all(4.0) * bulge).above(step.abs());
        let records = self.records.best(output);
        let [high, low] = part.load_all(&records);
        if !(holds & ((mean + over).above(high) | (over - mean).above(low))).any() {
            return;
        }
        let swing = self.own_bulge(part, by_swing, i);
        let bounds = [(mean + over).min(start.max(end) + swing), (over - mean).min(swing - start.min(end))];
        for side in 0..2 {
            let mut row = ZERO;
            part.store(holds.choose(bounds[side], part.all(f64::NEG_INFINITY)), &mut row);
            for lane in part.lanes().filter(|&lane| row[lane] > records[side][lane]) {
                let candidate = self.candidate(output, leg, i, lane, row[lane]);
                self.records.keep(output, side, lane, candidate);
            }
        }
    }

    /// See [`March::bulges`], for one period and one kind.
    #[inline(always)]
    fn own_bulge<S: Simd>(&self, part: Part<S>, rows: &BoundRows, i: usize) -> Vector<S> {
        let mut bound = part.all(0.0);
        for (weight, states) in rows.state.iter().zip(&self.states[0]) {
            bound = bound + part.load(weight) * part.load(&states[i]).abs();
        }
        for (group, Ground { rise, .. }) in self.ground.iter().enumerate() {
            bound = bound + part.load(&rows.after[group]) * part.load(&rise[i + 1]).abs();
            bound = bound + part.load(&rows.before[group]) * part.load(&rise[i]).abs();
        }
        bound
    }

    /// A leg of one run as a stretch to be searched.
    fn candidate(&self, output: usize, leg: usize, i: usize, lane: usize, bound: f64) -> Candidate {
        let weights = &self.constants.weights[output];
        let none = Lanes::ZERO;
        let mut state = State { d: none, v: none, p: none };
        let mut drive = Drive { beta: none, gamma: none };
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
