//! The search of one piece for the largest value of one output.

use multiversion::multiversion;

use super::lengths::{Lengths, SlowFast, departure, steady};
use super::output::{Hunt, Output};
use crate::transition::{Drive, Oscillators, State};
use crate::watch::Watch;

/// What sums of products are off by, as a share of the sum of magnitudes.
const ROUNDING: f64 = 16.0 * f64::EPSILON;

/// Halvings and Newton steps end here; both converge long before.
const MOST_STEPS: u32 = 60;

/// One output along one piece, upside down where a minimum is sought.
pub(super) struct Climb<'a> {
    pub bank: &'a Oscillators,
    pub lengths: &'a Lengths,
    pub drive: &'a Drive,
    pub hunt: &'a Hunt<'a>,
    pub sign: f64,
    pub slack: f64,
    /// The largest value so far; NaN once it cannot be told.
    pub best: f64,
    pub at: f64,
}

impl Climb<'_> {
    /// F, F′ and F″ at a state `tau` after the start of the line.
    #[inline(always)]
    fn jet(&self, state: &State, tau: f64) -> [f64; 3] {
        let Hunt { output: Output { slope, bend, .. }, line, .. } = self.hunt;
        let (y, w) = departure(self.bank, self.drive, state);
        let value = self.hunt.value(state, tau);
        let slope = slope[0].dot(y) + slope[1].dot(w) + line.rate;
        let bend = bend[0].dot(y) + bend[1].dot(w);
        [value, slope, bend].map(|part| self.sign * part)
    }

    #[inline(always)]
    fn offer(&mut self, value: f64, tau: f64) {
        if value > self.best + self.slack {
            (self.best, self.at) = (value, tau);
        }
    }

    /// Offers what a piece has to offer, if its bounds tell. Bounds that leave the range of double precision
    /// never would: the best value is then NaN.
    #[inline(always)]
    fn settles(&mut self, Piece { from, to, tau, h, .. }: &Piece) -> bool {
        let (tau, h) = (*tau, *h);
        let [f0, slope0, bend0] = self.jet(from, tau);
        let [f1, slope1, bend1] = self.jet(to, tau + h);
        self.offer(f0, tau);
        self.offer(f1, tau + h);
        let r = self.lengths.of(departure(self.bank, self.drive, from));
        let Output { second, third, .. } = self.hunt.output;
        let (second, third) = (second.dot(r), third.dot(r));
        let steepest = second.min(0.5 * (bend0.abs() + bend1.abs() + third * h));
        let enough = self.best + self.slack;
        let reach = f0.max(f1) + steepest * h * h / 8.0;
        if !reach.is_finite() {
            self.best = f64::NAN;
            return true;
        }
        if reach <= enough || one_sign(slope0, slope1, steepest * h) {
            return true;
        }
        let rounding = ROUNDING * second;
        let same = (bend0 <= rounding && bend1 <= rounding) || (bend0 >= -rounding && bend1 >= -rounding);
        if one_sign(bend0, bend1, third * h) || (same && self.bends_one_way(from, to, r, h)) {
            // F is below its tangents: the one at the start, up to where it meets that at the end.
            let meet = (f1 - f0 - slope1 * h) / (slope0 - slope1);
            if slope0 > 0.0 && slope1 < 0.0 && f0 + slope0 * meet > enough {
                self.summit(from, tau, h, crossing([slope0, slope1], [bend0 * h, bend1 * h]));
            }
            return true;
        }
        // Where hardly any amplitude is left, however long the piece.
        let (bottom, top) = self.hunt.range(steady(self.bank, self.drive), r, (tau, tau + h));
        (if self.sign > 0.0 { top } else { -bottom }) <= enough
    }

    /// Whether F‴ has one sign.
    fn bends_one_way(&self, from: &State, to: &State, r: SlowFast, h: f64) -> bool {
        let Output { jerk: [y, w], fourth, .. } = self.hunt.output;
        let jerk = |state| {
            let departure = departure(self.bank, self.drive, state);
            y.dot(departure.0) + w.dot(departure.1)
        };
        one_sign(jerk(from), jerk(to), fourth.dot(r) * h)
    }

    /// The one zero of F′ in a piece on which F is concave: Newton's method in a bracket.
    #[inline(always)]
    fn summit(&mut self, from: &State, tau: f64, h: f64, guess: f64) {
        // The step after one this short is a rounding error: convergence is quadratic.
        const SHORT: f64 = 1e-7;
        let (mut low, mut high, mut at) = (0.0, h, h * guess);
        for _ in 0..MOST_STEPS {
            let state = self.bank.over(at).apply(from, self.drive);
            let [value, slope, bend] = self.jet(&state, tau + at);
            self.offer(value, tau + at);
            if slope > 0.0 {
                low = at;
            } else {
                high = at;
            }
            let newton = at - slope / bend;
            let next = if newton > low && newton < high { newton } else { 0.5 * (low + high) };
            let short = (next - at).abs() <= SHORT * h;
            at = next;
            if short {
                if at == newton {
                    // As far as a step this short matters, F is a parabola.
                    self.offer(value - 0.5 * slope * slope / bend, tau + at);
                }
                break;
            }
        }
    }
}

/// Whether a function that changes by no more than `change` has one sign between two values.
#[inline(always)]
fn one_sign(a: f64, b: f64, change: f64) -> bool {
    a * b > 0.0 && a.abs() + b.abs() > change
}

/// Where a function that falls through zero on [0, 1] does so, by the cubic that its inverse
/// resembles: values and derivatives at both ends.
#[inline(always)]
fn crossing([a, b]: [f64; 2], [da, db]: [f64; 2]) -> f64 {
    let (fall, share) = (b - a, a / (a - b));
    let rest = 1.0 - share;
    let bent = share * rest * (rest / da - share / db) * fall;
    let guess = share * share * (3.0 - 2.0 * share) + bent;
    if guess > 0.0 && guess < 1.0 { guess } else { share }
}

/// A piece from `tau` to `tau + h`, with the states at its ends.
#[derive(Clone, Copy)]
pub(super) struct Piece {
    pub from: State,
    pub to: State,
    pub tau: f64,
    pub h: f64,
    pub halvings: u32,
}

/// Searches a piece, halving it where its bounds decide nothing; in vain once the caller has asked to
/// stop.
#[multiversion(targets("x86_64+avx2"))]
pub(super) fn climb(this: &mut Climb, piece: Piece, watch: &mut Watch) {
    let (mut now, mut later) = (piece, Vec::new());
    while watch.go_on(1) {
        if this.settles(&now) || now.halvings == MOST_STEPS {
            match later.pop() {
                Some(next) if !this.best.is_nan() => now = next,
                _ => return,
            }
        } else {
            let (h, halvings) = (0.5 * now.h, now.halvings + 1);
            let middle = this.bank.over(h).apply(&now.from, this.drive);
            later.push(Piece { from: middle, to: now.to, tau: now.tau + h, h, halvings });
            now = Piece { from: now.from, to: middle, tau: now.tau, h, halvings };
        }
    }
}
