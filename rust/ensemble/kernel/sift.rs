//! Chunks that may hold a record between the places looked at: kept, gone over again later, and sifted
//! for the legs that may. By then most of them have been outdone.

use std::ops::Range;

use pulp::Simd;

use super::super::records::{Candidate, Records};
use super::super::setup::{Layout, MODES};
use super::super::vector::{Mask, Part, Vector, parts};
use super::look::ChunkBounds;
use super::view::{LegStart, View, with_view};
use super::{CHUNK, Ground, March, RUNS, Row};
use crate::lanes::Lanes;
use crate::transition::{Drive, State};

/// Chunks of one run kept before those that no longer matter are thrown out.
const MANY: usize = 128;

/// Chunks of one run that matter, kept before they are gone over again: this bounds the memory on a
/// runway of any length, even if every wave brings the same load once more.
const FULL: usize = 1024;

/// Where the numbers of a kept chunk stand, one after the other: the state at its start, each group's
/// last rise and elevations, each output's bend, and last, each output's bounds.
#[derive(Clone, Copy)]
struct Fields {
    groups: usize,
    outputs: usize,
}

impl Fields {
    /// A rise and the elevations from the station before the chunk to its last.
    const OF_GROUP: usize = 1 + (CHUNK + 1);

    fn state() -> Range<usize> {
        0..2 * MODES
    }

    fn rise(group: usize) -> usize {
        2 * MODES + group * Self::OF_GROUP
    }

    fn elevations(group: usize) -> Range<usize> {
        Self::rise(group) + 1..Self::rise(group + 1)
    }

    fn bend(self, output: usize) -> usize {
        Self::rise(self.groups) + output
    }

    fn bounds(self, output: usize) -> Range<usize> {
        let begin = self.bend(self.outputs) + 2 * output;
        begin..begin + 2
    }

    fn all_bounds(self) -> Range<usize> {
        self.bounds(0).start..self.size()
    }

    fn size(self) -> usize {
        self.bounds(self.outputs).start
    }

    /// Whether a run may break a record on a kept chunk.
    fn matter(self, records: &Records, lane: usize) -> impl Fn(&[f64]) -> bool {
        move |numbers| {
            let breaks = |(at, &bound): (usize, &f64)| bound > records.best_of(at / 2, at % 2, lane);
            numbers[self.all_bounds()].iter().enumerate().any(breaks)
        }
    }
}

/// Chunks on which a run may exceed the records it has reached where it was looked at.
#[derive(Clone)]
pub(super) struct KeptChunks {
    fields: Fields,
    /// One chunk after the other. What is beyond those in use is left from earlier ones.
    numbers: Vec<f64>,
    used: usize,
    /// How many numbers there are when it is time to throw out.
    many: usize,
    /// Where to continue when they are gone over again.
    at: usize,
}

impl KeptChunks {
    /// For so many outputs.
    pub fn new(layout: &Layout, outputs: usize) -> Self {
        let fields = Fields { groups: layout.groups.len(), outputs };
        Self { fields, numbers: Vec::new(), used: 0, many: 0, at: 0 }
    }

    pub fn restart(&mut self) {
        (self.used, self.many, self.at) = (0, MANY * self.fields.size(), 0);
    }

    /// Whether it is time to go over them.
    pub fn are_full(&self) -> bool {
        self.used >= FULL * self.fields.size()
    }

    /// One more, to be filled in; when there are many, without those that no longer matter.
    fn add(&mut self, records: &Records, lane: usize) -> &mut [f64] {
        let size = self.fields.size();
        if self.used >= self.many {
            let matters = self.fields.matter(records, lane);
            let mut kept = 0;
            for begin in (0..self.used).step_by(size) {
                if matters(&self.numbers[begin..begin + size]) {
                    self.numbers.copy_within(begin..begin + size, kept);
                    kept += size;
                }
            }
            self.used = kept;
            self.many = self.many.max(2 * kept);
        }
        let begin = self.used;
        self.used += size;
        if self.numbers.len() < self.used {
            self.numbers.resize(self.used, 0.0);
        }
        &mut self.numbers[begin..self.used]
    }

    /// The next that matters.
    fn next(&mut self, records: &Records, lane: usize) -> Option<&[f64]> {
        let matters = self.fields.matter(records, lane);
        while self.at < self.used {
            let begin = self.at;
            self.at += self.fields.size();
            if matters(&self.numbers[begin..self.at]) {
                return Some(&self.numbers[begin..self.at]);
            }
        }
        None
    }
}

impl ChunkBounds {
    /// Runs that may break these records.
    #[inline(always)]
    pub fn runs<S: Simd>(&self, part: Part<S>, [high, low]: [Vector<S>; 2]) -> Mask<S> {
        let [top, bottom] = part.load_all(&self.bounds);
        top.above(high) | bottom.above(low)
    }
}

impl March {
    /// Keeps a chunk of the block for a run.
    pub(super) fn keep(&mut self, chunk: usize, lane: usize) {
        let Self { ground, states, chunk_bounds, kept, records, .. } = self;
        // The remainder: so that the compiler knows it is a lane.
        let (first, lane) = (CHUNK * chunk, lane % RUNS);
        let fields = kept[lane].fields;
        let numbers = kept[lane].add(records, lane);
        for (number, rows) in numbers[Fields::state()].iter_mut().zip(&states[0]) {
            *number = rows[first][lane];
        }
        for (group, Ground { rise, z }) in ground.iter().enumerate() {
            numbers[Fields::rise(group)] = rise[first][lane];
            for (number, row) in numbers[Fields::elevations(group)].iter_mut().zip(&z[first..=first + CHUNK])
            {
                *number = row[lane];
            }
        }
        for (output, chunks) in chunk_bounds.iter().enumerate() {
            numbers[fields.bend(output)] = chunks[chunk].bend[lane];
            for (number, row) in numbers[fields.bounds(output)].iter_mut().zip(&chunks[chunk].bounds) {
                *number = row[lane];
            }
        }
    }

    /// Loads the next kept chunk of each of some runs, in place of the block's first; whether there were
    /// any.
    pub(super) fn go_back(&mut self, runs: [bool; RUNS]) -> bool {
        let Self { ground, state, chunk_bounds, kept, records, .. } = self;
        let mut any = false;
        for (lane, kept) in kept.iter_mut().enumerate() {
            let fields = kept.fields;
            let next = if runs[lane] { kept.next(records, lane) } else { None };
            let Some(numbers) = next else {
                for chunks in &mut *chunk_bounds {
                    chunks[0].bounds.iter_mut().for_each(|bound| bound[lane] = f64::NEG_INFINITY);
                }
                continue;
            };
            any = true;
            for (row, &number) in state.iter_mut().zip(&numbers[Fields::state()]) {
                row[lane] = number;
            }
            for (group, Ground { rise, z }) in ground.iter_mut().enumerate() {
                rise[0][lane] = numbers[Fields::rise(group)];
                for (row, &number) in z.iter_mut().zip(&numbers[Fields::elevations(group)]) {
                    row[lane] = number;
                }
            }
            for (output, chunks) in chunk_bounds.iter_mut().enumerate() {
                chunks[0].bend[lane] = numbers[fields.bend(output)];
                for (row, &number) in chunks[0].bounds.iter_mut().zip(&numbers[fields.bounds(output)]) {
                    row[lane] = number;
                }
            }
        }
        any
    }

    /// Keeps the legs of a chunk that may hold a record.
    #[inline(always)]
    pub(super) fn sift<S: Simd>(&mut self, simd: S, chunk: usize, count: usize, legs: usize) {
        // Apart while the rest is read.
        let mut records = std::mem::take(&mut self.records);
        for output in 0..self.chunk_bounds.len() {
            for part in parts(simd) {
                with_view!(self, part, output, (count, legs), view => view.sift(&mut records, chunk));
            }
        }
        self.records = records;
    }

    /// The most an output may bulge on a leg of a period if the leg lasted as long as the longest span
    /// between two kinks.
    #[inline(always)]
    fn own_bulge<S: Simd>(&self, part: Part<S>, weights: &[Row], i: usize) -> Vector<S> {
        let (states, rises) = weights.split_at(2 * MODES);
        let (rises, inner) = rises.split_at(self.ground.len());
        let mut bound = part.all(0.0);
        for (weight, states) in states.iter().zip(&self.states[0]) {
            bound = bound + part.load(weight) * part.load(&states[i]).abs();
        }
        for (weight, ground) in rises.iter().zip(&self.ground) {
            bound = bound + part.load(weight) * part.load(&ground.rise[i + 1]).abs();
        }
        for (weight, group) in inner.iter().zip(self.layout.inner()) {
            bound = bound + part.load(weight) * part.load(&self.ground[group].rise[i]).abs();
        }
        bound
    }

    /// A leg of one run, ready to be searched.
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

impl<S: Simd, const RATES: bool, const LINES: bool> View<'_, S, RATES, LINES> {
    /// See [`March::sift`].
    #[inline(always)]
    fn sift(&self, records: &mut Records, chunk: usize) {
        let Self { march, part, output, .. } = *self;
        let bounds = &march.chunk_bounds[output][chunk];
        let (bend, runs) = (part.load(&bounds.bend), bounds.runs(part, records.best(part, output)));
        if !runs.any() {
            return;
        }
        let periods = self.periods(chunk);
        let first = (0, periods.start);
        let mut from = first;
        let mut start = self.after(from);
        for i in periods.clone() {
            for (kink, &leg) in self.kinks.iter().enumerate() {
                let to = (leg, i);
                if to == first {
                    continue;
                }
                let end = self.before(from, to);
                self.look_between(records, (from, to), (start, end), kink, bend, runs);
                (from, start) = (to, if LINES { self.after(to) } else { end });
            }
        }
        let to = self.end(periods.end);
        let kinks = &march.layout.kinks[output];
        // The chunk ends on the span to the next kink.
        let kink = kinks.partition_point(|&leg| leg < to.0) % kinks.len();
        self.look_between(records, (from, to), (start, self.before(from, to)), kink, bend, runs);
    }

    /// Weighs the legs of the span up to a kink if one of `runs` may have a record there: by the block's
    /// bound, which is at hand, then by those of the span's own periods.
    #[inline(always)]
    fn look_between(
        &self,
        records: &mut Records,
        (from, to): (LegStart, LegStart),
        (start, end): (Vector<S>, Vector<S>),
        kink: usize,
        bend: Vector<S>,
        runs: Mask<S>,
    ) {
        let Self { march, part, output, .. } = *self;
        let weights = &march.constants.weights[output];
        let (share, best) = (part.load(&weights.span[kink]), records.best(part, output));
        let runs = runs & summits(part, (start, end), bend * share, best);
        if !runs.any() {
            return;
        }
        let mut bend = march.own_bulge(part, &weights.bulge[0], from.1);
        if to.0 > 0 && to.1 > from.1 {
            bend = bend.max(march.own_bulge(part, &weights.bulge[0], to.1));
        }
        let runs = runs & summits(part, (start, end), bend * share, best);
        let mut place = from;
        while runs.any() && place != to {
            self.weigh(records, place, runs);
            place = march.layout.after(place.0, place.1);
        }
    }

    /// Keeps a leg for the runs that may have a record on it.
    #[inline(always)]
    fn weigh(&self, records: &mut Records, place: LegStart, runs: Mask<S>) {
        let Self { march, part, output, .. } = *self;
        let (leg, i) = place;
        let (start, end) = (self.after(place), self.before(place, march.layout.after(leg, i)));
        let none = part.all(f64::NEG_INFINITY);
        let (top, bottom) = (start.max(end), start.min(end));
        let of_runs = [runs.choose(top, none), runs.choose(bottom, part.all(f64::INFINITY))];
        records.update(part, output, of_runs[0], of_runs[1]);
        let weights = &march.constants.weights[output];
        let [by_bend, by_swing] = &weights.bulge;
        let bend = march.own_bulge(part, by_bend, i) * part.load(&weights.leg[leg]);
        let runs = runs & summits(part, (start, end), bend, records.best(part, output));
        if !runs.any() {
            return;
        }
        let (step, mean) = (end - start, part.all(0.5) * (start + end));
        let over = bend + step * step / (part.all(16.0) * bend);
        let swing = march.own_bulge(part, by_swing, i);
        let bounds = [(mean + over).min(top + swing), (over - mean).min(swing - bottom)];
        for side in 0..2 {
            let mut row = Row::ZERO;
            part.store(runs.choose(bounds[side], none), &mut row);
            for lane in part.lanes() {
                if row[lane] > records.best_of(output, side, lane) {
                    records.keep(output, side, lane, march.candidate(output, leg, i, lane, row[lane]));
                }
            }
        }
    }
}

/// Where F may exceed a record between two values.
///
/// Where |F″| h²/8 ≤ B and the values at the ends differ by D, F has no summit between them if
/// |D| ≥ 4B; else it stays below their mean + B + D²/(16B).
#[inline(always)]
fn summits<S: Simd>(
    part: Part<S>,
    (start, end): (Vector<S>, Vector<S>),
    bend: Vector<S>,
    [high, low]: [Vector<S>; 2],
) -> Mask<S> {
    let (step, mean) = (end - start, part.all(0.5) * (start + end));
    let (square, sixteen) = (step * step, part.all(16.0) * bend);
    let over = square.above(sixteen * ((high - mean) - bend)) | square.above(sixteen * ((low + mean) - bend));
    over & (part.all(4.0) * bend).above(step.abs())
}
