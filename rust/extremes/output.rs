//! One output: its weights, the bounds that follow from them, and the hunt for its record.

use super::Extreme;
use super::climb::{Climb, Piece, climb};
use super::lengths::{Lengths, SlowFast, rates};
use crate::lanes::{LANES, Lanes};
use crate::readout::{Form, Line};
use crate::transition::{Drive, Oscillators, State};
use crate::watch::Watch;

/// A value this close to the record (in units in the last place of the range) ties with it:
/// of equal peaks the first counts.
pub(super) const TIE: f64 = 4.0 * f64::EPSILON;

/// An output with the bounds that follow from its weights.
pub(crate) struct Output {
    pub form: Form,
    /// Weights of y and ẏ/ω in F′.
    pub(super) slope: [Lanes; 2],
    /// Weights of y and ẏ/ω in F″.
    pub bend: [Lanes; 2],
    /// Weights of y and ẏ/ω in F‴.
    pub(super) jerk: [Lanes; 2],
    /// Σ amplitude · r bounds the oscillating part.
    pub amplitude: SlowFast,
    /// Σ second · r bounds |F″|.
    pub second: SlowFast,
    /// Σ third · r bounds |F‴|.
    pub(super) third: SlowFast,
    /// Σ fourth · r bounds |F⁗|.
    pub(super) fourth: SlowFast,
}

/// The hunt for an output's extremes: its straight-line part at present, and its record so far.
pub(crate) struct Hunt<'a> {
    pub output: &'a Output,
    pub line: Line,
    pub record: Extreme,
}

impl Output {
    pub fn new(form: Form, bank: &Oscillators) -> Self {
        // d/dt of a y + b ẏ/ω is (−ωb) y + ω(a − 2ζb) ẏ/ω.
        let derive =
            |[a, b]: [Lanes; 2]| [Lanes::ZERO - bank.omega * b, bank.omega * (a - bank.two_zeta * b)];
        let length = |[a, b]: [Lanes; 2]| SlowFast([(a * a + b * b).map(f64::sqrt), Lanes::ZERO]);
        let weights = [form.d, form.v];
        let slope = derive(weights);
        let bend = derive(slope);
        let mut amplitude = length(weights);
        let jerk = derive(bend);
        let (mut second, mut third, mut fourth) = (length(bend), length(jerk), length(derive(jerk)));
        for i in 0..LANES {
            for (part, rate) in rates(bank.two_zeta[i]).into_iter().flatten().enumerate() {
                let size = (form.d[i] - form.v[i] * rate).abs();
                let rate = bank.omega[i] * rate;
                amplitude.0[part][i] = size;
                second.0[part][i] = size * rate * rate;
                third.0[part][i] = size * rate * rate * rate;
                fourth.0[part][i] = size * rate * rate * rate * rate;
            }
        }
        Self { form, slope, bend, jerk, amplitude, second, third, fourth }
    }
}

impl<'a> Hunt<'a> {
    pub fn new(output: &'a Output) -> Self {
        let record =
            Extreme { max: f64::NEG_INFINITY, time_of_max: 0.0, min: f64::INFINITY, time_of_min: 0.0 };
        Self { output, line: Line { start: output.form.constant, rate: 0.0 }, record }
    }

    /// The value at a state `tau` after the start of the line.
    #[inline(always)]
    pub(super) fn value(&self, state: &State, tau: f64) -> f64 {
        self.output.form.value(state) + (self.line.start + self.line.rate * tau)
    }

    /// Offers the value at a state `tau` after `time`, where the line starts.
    pub(super) fn offer(&mut self, state: &State, time: f64, tau: f64) {
        let value = self.value(state, tau);
        self.record.offer(value, time + tau, self.slack());
    }

    /// Searches one piece from `tau` to `tau` + `h` after `time`: its end, and its inside as far
    /// as the bounds (sign, sign × bound) reach beyond the record.
    #[cold]
    pub fn search(
        &mut self,
        (bank, lengths): (&Oscillators, &Lengths),
        (from, to): (&State, &State),
        drive: &Drive,
        (time, tau, h): (f64, f64, f64),
        bounds: &[(f64, f64)],
        watch: &mut Watch,
    ) {
        self.offer(to, time, tau + h);
        for &(sign, bound) in bounds {
            let best = if sign > 0.0 { self.record.max } else { -self.record.min };
            let slack = self.slack();
            if !bound.is_finite() {
                // A bound that says nothing would have every piece halved for ever.
                self.record.max = f64::NAN;
            } else if bound > best + slack {
                let mut search = Climb { bank, lengths, drive, hunt: self, sign, slack, best, at: f64::NAN };
                climb(&mut search, Piece { from: *from, to: *to, tau, h, halvings: 0 }, watch);
                if search.best.is_nan() {
                    self.record.max = f64::NAN;
                } else if search.best > best {
                    let (value, at) = (sign * search.best, time + search.at);
                    self.record.offer(value, at, 0.0);
                }
            }
        }
    }

    /// What it stays between from `tau` to `later`, about a steady position with lengths left.
    pub(super) fn range(
        &self,
        (y, w): (Lanes, Lanes),
        lengths: SlowFast,
        (tau, later): (f64, f64),
    ) -> (f64, f64) {
        let Self { output: Output { form, amplitude, .. }, line, .. } = self;
        let level = form.d.dot(y) + form.v.dot(w) + line.start;
        let (a, b) = (level + line.rate * tau, level + line.rate * later);
        let swing = amplitude.dot(lengths);
        (a.min(b) - swing, a.max(b) + swing)
    }

    pub(super) fn slack(&self) -> f64 {
        let slack = TIE * self.record.max.abs().max(self.record.min.abs());
        if slack.is_finite() { slack } else { 0.0 }
    }
}
