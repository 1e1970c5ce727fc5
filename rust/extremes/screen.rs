//! The test that dismisses nearly every piece, four outputs side by side.

use super::lengths::{Lengths, SlowFast, departure};
use super::output::{Hunt, Output, TIE};
use crate::lanes::{LANES, Lanes};
use crate::transition::{Drive, Oscillators, State};
use crate::watch::Watch;

/// Four outputs side by side.
pub(super) struct Screen {
    /// Weights of the modes' d and v, and of their lengths in the bound on |F″|.
    weights: [[Lanes; 4]; LANES],
    line: Lanes,
    rate: Lanes,
    /// Values at the start of the next piece.
    pub start: Lanes,
    /// Records, with the slack for ties, or values ahead that will be records.
    pub high: Lanes,
    pub low: Lanes,
    /// Largest and smallest values seen ahead, less the slack.
    ahead: (Lanes, Lanes),
}

impl Screen {
    pub fn new(hunts: &[Hunt]) -> Self {
        let gather = |part: &dyn Fn(&Output) -> f64| {
            let mut lanes = Lanes::ZERO;
            for (lane, hunt) in hunts.iter().enumerate() {
                lanes[lane] = part(hunt.output);
            }
            lanes
        };
        let weights = std::array::from_fn(|mode| {
            [
                gather(&|output| output.form.d[mode]),
                gather(&|output| output.form.v[mode]),
                gather(&|output| output.second.0[0][mode]),
                gather(&|output| output.second.0[1][mode]),
            ]
        });
        let none = Lanes::ZERO;
        let ahead = (Lanes::all(f64::NEG_INFINITY), Lanes::all(f64::INFINITY));
        let mut screen = Self { weights, line: none, rate: none, start: none, high: none, low: none, ahead };
        screen.read_lines(hunts);
        screen.read_records(hunts);
        screen
    }

    pub fn read_lines(&mut self, hunts: &[Hunt]) {
        for (lane, hunt) in hunts.iter().enumerate() {
            (self.line[lane], self.rate[lane]) = (hunt.line.start, hunt.line.rate);
        }
    }

    pub fn read_records(&mut self, hunts: &[Hunt]) {
        for (lane, hunt) in hunts.iter().enumerate() {
            let slack = hunt.slack();
            (self.high[lane], self.low[lane]) = (hunt.record.max + slack, hunt.record.min - slack);
        }
        (self.high, self.low) = (self.high.max(self.ahead.0), self.low.min(self.ahead.1));
    }

    /// Looks ahead at values, so that pieces that do not reach the largest are dismissed at once.
    #[inline(always)]
    pub fn look_ahead(&mut self, values: &[Lanes]) {
        for value in values {
            let slack = value.abs() * TIE;
            self.ahead = (self.ahead.0.max(*value - slack), self.ahead.1.min(*value + slack));
        }
        (self.high, self.low) = (self.high.max(self.ahead.0), self.low.min(self.ahead.1));
    }

    /// Values at a state `tau` after the start of the line.
    #[inline(always)]
    pub fn values(&self, state: &State, tau: f64) -> Lanes {
        let mut sum = self.line + self.rate * tau;
        for (mode, [d, v, ..]) in self.weights.iter().enumerate() {
            sum += *d * state.d[mode] + *v * state.v[mode];
        }
        sum
    }

    /// What the outputs cannot exceed, nor fall below, on a piece from the values `start` to
    /// the values `end`.
    #[inline(always)]
    fn bounds(
        &self,
        (start, end): (Lanes, Lanes),
        SlowFast([slow, fast]): SlowFast,
        h: f64,
    ) -> (Lanes, Lanes) {
        let mut second = Lanes::ZERO;
        for (mode, [_, _, one, other]) in self.weights.iter().enumerate() {
            second += *one * slow[mode] + *other * fast[mode];
        }
        let bulge = second * (h * h / 8.0);
        (start.max(end) + bulge, start.min(end) - bulge)
    }

    /// Searches a piece as far as the bounds on it reach beyond the records.
    #[inline(always)]
    pub fn check(
        &mut self,
        hunts: &mut [Hunt],
        bank: (&Oscillators, &Lengths),
        (ends, values): ((&State, &State), (Lanes, Lanes)),
        drive: &Drive,
        (time, tau, h): (f64, f64, f64),
        watch: &mut Watch,
    ) {
        let lengths = bank.1.at_most(departure(bank.0, drive, ends.0));
        let (top, bottom) = self.bounds(values, lengths, h);
        if top.any_above(self.high) || self.low.any_above(bottom) {
            for (lane, hunt) in hunts.iter_mut().enumerate() {
                if top[lane] > self.high[lane] || bottom[lane] < self.low[lane] {
                    let signs = [(1.0, top[lane]), (-1.0, -bottom[lane])];
                    hunt.search(bank, ends, drive, (time, tau, h), &signs, watch);
                }
            }
            self.read_records(hunts);
        }
    }
}
