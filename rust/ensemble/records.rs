//! The records of runs side by side, and the legs that may yet break them.

use pulp::Simd;

use super::setup::Setup;
use super::vector::{Part, Vector};
use crate::extremes::{Extreme, Hunt};
use crate::readout::Line;
use crate::row::{RUNS, Row};
use crate::transition::{Drive, State};
use crate::watch::Watch;

/// Legs kept for one record before those that no longer matter are thrown out.
const MANY: usize = 32;

/// A leg on which an output may exceed what it has reached at kinks.
#[derive(Clone, Copy)]
pub(super) struct Candidate {
    pub bound: f64,
    pub leg: usize,
    pub state: State,
    pub drive: Drive,
    /// The straight-line part at its start, and how much it grows.
    pub start: f64,
    pub growth: f64,
}

/// The larger of two values, of which the first is NaN if neither could be told.
fn larger(max: f64, min: f64) -> f64 {
    if max.is_nan() { max } else { max.max(min) }
}

/// One output of all runs: the largest values of F and of −F so far, and the legs that may exceed them.
struct Record {
    best: [Row; 2],
    candidates: [[Vec<Candidate>; RUNS]; 2],
}

/// Records of all outputs. Of an acceleration only the magnitude counts.
#[derive(Default)]
pub(super) struct Records {
    loads: usize,
    records: Vec<Record>,
}

impl Records {
    pub fn new(loads: usize, outputs: usize) -> Self {
        let record = || Record {
            best: [Row::all(f64::NEG_INFINITY); 2],
            candidates: std::array::from_fn(|_| std::array::from_fn(|_| Vec::new())),
        };
        Self { loads, records: (0..outputs).map(|_| record()).collect() }
    }

    pub fn restart(&mut self) {
        for record in &mut self.records {
            record.best = [Row::all(f64::NEG_INFINITY); 2];
            record.candidates.iter_mut().flatten().for_each(Vec::clear);
        }
    }

    /// Takes in the largest and smallest of some more values.
    #[inline(always)]
    pub fn update<S: Simd>(&mut self, part: Part<S>, output: usize, top: Vector<S>, bottom: Vector<S>) {
        let [mut high, mut low] = self.best(part, output);
        (high, low) = (high.max(top), low.max(part.all(0.0) - bottom));
        if output >= self.loads {
            let magnitude = high.max(low);
            (high, low) = (magnitude, magnitude);
        }
        let best = &mut self.records[output].best;
        part.store(high, &mut best[0]);
        part.store(low, &mut best[1]);
    }

    /// Largest values of F and of −F.
    #[inline(always)]
    pub fn best<S: Simd>(&self, part: Part<S>, output: usize) -> [Vector<S>; 2] {
        part.load_all(&self.records[output].best)
    }

    /// Of one run: of F, or of −F.
    #[inline(always)]
    pub fn best_of(&self, output: usize, side: usize, lane: usize) -> f64 {
        self.records[output].best[side][lane]
    }

    /// Keeps a leg for later: by then most will have been outdone.
    pub fn keep(&mut self, output: usize, side: usize, lane: usize, candidate: Candidate) {
        let Record { best, candidates } = &mut self.records[output];
        let (best, list) = (best[side][lane], &mut candidates[side][lane]);
        if list.len() >= MANY && list.len().is_power_of_two() {
            list.retain(|candidate| candidate.bound > best);
        }
        list.push(candidate);
    }

    /// Searches the legs kept for an output of one run.
    pub fn settle(&mut self, setup: &Setup, (output, lane): (usize, usize), watch: &mut Watch) {
        let Record { best, candidates } = &mut self.records[output];
        let magnitude = output >= self.loads;
        let mut hunt = Hunt::new(&setup.readings[output].output);
        hunt.record = Extreme { max: best[0][lane], time_of_max: 0.0, min: -best[1][lane], time_of_min: 0.0 };
        for (side, sign) in [1.0, -1.0].into_iter().enumerate() {
            let list = &mut candidates[side][lane];
            // The most promising first: it outdoes most of the others.
            list.sort_by(|one, other| other.bound.total_cmp(&one.bound));
            for Candidate { bound, leg, state, drive, start, growth } in list.drain(..) {
                let (max, min) = (hunt.record.max, -hunt.record.min);
                let record = if magnitude { larger(max, min) } else { [max, min][side] };
                if bound <= record {
                    break;
                }
                let h = setup.dt[leg];
                hunt.line = Line { start, rate: growth / h };
                let end = setup.transition[leg].apply(&state, &drive);
                let bank = (&setup.bank, &*setup.lengths);
                hunt.search(bank, (&state, &end), &drive, (0.0, 0.0, h), &[(sign, bound)], watch);
            }
        }
        let (max, min) = (hunt.record.max, -hunt.record.min);
        let found = if magnitude { [larger(max, min); 2] } else { [max, min] };
        for (best, found) in best.iter_mut().zip(found) {
            best[lane] = found;
        }
    }
}
