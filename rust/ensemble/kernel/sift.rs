//! Chunks that may hold a record between the places looked at: kept, gone over again later, and sifted
//! for the legs that may. By then most of them have been outdone.

use pulp::Simd;

use super::super::Reader;
use super::super::constants::States;
use super::super::records::{Candidate, Records};
use super::super::vector::{Mask, Part, Vector, parts};
use super::look::ChunkBounds;
use super::view::{LegStart, View, with_view};
use super::{CHUNK, Ground, March, RUNS, Row};
use crate::lanes::Lanes;
use crate::modes::MODES;
use crate::transition::{Drive, State};

/// Chunks of one run kept before those that no longer matter are thrown out.
const MANY: usize = 128;

/// Chunks of one run that matter, kept before they are gone over again: this bounds the memory on a
/// runway of any length, even if every wave brings the same load once more.
const FULL: usize = 1024;

/// Where a run was when it began a chunk.
#[derive(Clone, Copy)]
struct Start {
    period: usize,
    state: States<f64>,
}

/// How far an output may come on a chunk: its bend, what F stays below, and what −F does.
type Reach = [f64; 3];

/// Chunks on which a run may exceed the records it has reached where it was looked at.
#[derive(Clone)]
pub(super) struct KeptChunks {
    outputs: usize,
    starts: Vec<Start>,
    /// Chunk by chunk, output by output.
    reaches: Vec<Reach>,
    /// How many there are when it is time to throw out.
    many: usize,
    /// Where to continue when they are gone over again.
    at: usize,
}

impl KeptChunks {
    /// For so many outputs.
    pub fn new(outputs: usize) -> Self {
        Self { outputs, starts: Vec::new(), reaches: Vec::new(), many: MANY, at: 0 }
    }

    pub fn restart(&mut self) {
        self.starts.clear();
        self.reaches.clear();
        (self.many, self.at) = (MANY, 0);
    }

    /// Whether it is time to go over them.
    pub fn are_full(&self) -> bool {
        self.starts.len() >= FULL
    }

    fn reach(&self, chunk: usize) -> &[Reach] {
        &self.reaches[chunk * self.outputs..][..self.outputs]
    }

    /// Whether a run may break a record on a chunk.
    fn matters(&self, chunk: usize, records: &Records, lane: usize) -> bool {
        let breaks = |(output, &[_, top, bottom]): (usize, &Reach)| {
            top > records.best_of(output, 0, lane) || bottom > records.best_of(output, 1, lane)
        };
        self.reach(chunk).iter().enumerate().any(breaks)
    }

    /// When there are many, throws out those that no longer matter.
    fn thin_out(&mut self, records: &Records, lane: usize) {
        if self.starts.len() < self.many {
            return;
        }
        let mut kept = 0;
        for chunk in 0..self.starts.len() {
            if self.matters(chunk, records, lane) {
                self.starts[kept] = self.starts[chunk];
                let begin = chunk * self.outputs;
                self.reaches.copy_within(begin..begin + self.outputs, kept * self.outputs);
                kept += 1;
            }
        }
        self.starts.truncate(kept);
        self.reaches.truncate(kept * self.outputs);
        self.many = self.many.max(2 * kept);
    }

    /// The next that matters.
    fn next(&mut self, records: &Records, lane: usize) -> Option<(&Start, &[Reach])> {
        let chunk = (self.at..self.starts.len()).find(|&chunk| self.matters(chunk, records, lane));
        self.at = chunk.map_or(self.starts.len(), |chunk| chunk + 1);
        chunk.map(|chunk| (&self.starts[chunk], self.reach(chunk)))
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
        let Self { states, chunk_bounds, kept, records, .. } = self;
        // The remainder: so that the compiler knows it is a lane.
        let (first, lane) = (CHUNK * chunk, lane % RUNS);
        let kept = &mut kept[lane];
        kept.thin_out(records, lane);
        let state = std::array::from_fn(|k| states[0][k][first][lane]);
        kept.starts.push(Start { period: self.period + first, state });
        kept.reaches.extend(chunk_bounds.iter().map(|chunks| {
            let ChunkBounds { bend, bounds: [top, bottom] } = &chunks[chunk];
            [bend[lane], top[lane], bottom[lane]]
        }));
    }

    /// Loads the next kept chunk of each of some runs, in place of the block's first; whether there were
    /// any.
    pub(super) fn go_back(&mut self, reader: &impl Reader, runs: [bool; RUNS]) -> bool {
        let Self { layout, ground, state, chunk_bounds, kept, records, .. } = self;
        let mut any = false;
        for (lane, kept) in kept.iter_mut().enumerate() {
            let next = if runs[lane] { kept.next(records, lane) } else { None };
            let Some((start, reaches)) = next else {
                for chunks in &mut *chunk_bounds {
                    chunks[0].bounds.iter_mut().for_each(|bound| bound[lane] = f64::NEG_INFINITY);
                }
                continue;
            };
            any = true;
            for (row, number) in state.iter_mut().zip(start.state) {
                row[lane] = number;
            }
            for (Ground { rise, z }, group) in ground.iter_mut().zip(&layout.groups) {
                let elevation = |period| reader.elevation(lane, group.track, layout.station(group, period));
                for (i, row) in z[..=CHUNK].iter_mut().enumerate() {
                    row[lane] = elevation(start.period + i);
                }
                rise[0][lane] = z[0][lane] - elevation(start.period.saturating_sub(1));
            }
            for (chunks, &[bend, top, bottom]) in chunk_bounds.iter_mut().zip(reaches) {
                chunks[0].bend[lane] = bend;
                (chunks[0].bounds[0][lane], chunks[0].bounds[1][lane]) = (top, bottom);
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
