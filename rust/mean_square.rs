//! Root mean squares of the continuous response: no sampling, whatever the segments' lengths.
//!
//! Over at most a radian of the stiffest mode Gauss's rule gives the integral of a squared output to double
//! precision. Longer segments are not cut up: an output is a linear form of x = (d and v of each mode, 1, τ),
//! τ being the time since the segment's start. So ∫F² = wᵀ M w with the moments M = ∫ x xᵀ, and as
//! x(τ + t) = E(t) x(τ),
//!
//!   M(2t) = M(t) + E(t) M(t) E(t)ᵀ:
//!
//! a level stretch of a thousand cycles costs thirteen doublings.

use crate::error::{Error, Result};
use crate::inside::Inside;
use crate::lanes::{LANES, Lanes};
use crate::march::{Segment, Visitor, march};
use crate::modes::MODES;
use crate::readout::{Form, Heights, Line, Quantity};
use crate::run::Run;
use crate::transition::{Drive, Oscillators, State, Transition};
use crate::watch::{Pulse, Watch};

/// Nodes of Gauss's rule on (−1, 1), one half, with their weights: exact to double precision over a
/// radian of the stiffest mode.
pub(crate) const GAUSS: [(f64, f64); 4] = [
    (0.183_434_642_495_649_8, 0.362_683_783_378_362),
    (0.525_532_409_916_329, 0.313_706_645_877_887_3),
    (0.796_666_477_413_626_7, 0.222_381_034_453_374_47),
    (0.960_289_856_497_536_3, 0.101_228_536_290_376_26),
];

/// The same of four nodes, all of them: over a short time, as [`Oscillators::is_short`] has it, they leave
/// out 1e-14.
const GAUSS_SHORT: [(f64, f64); LANES] = [
    (-0.861_136_311_594_052_6, 0.347_854_845_137_453_9),
    (-0.339_981_043_584_856_3, 0.652_145_154_862_546_1),
    (0.339_981_043_584_856_3, 0.652_145_154_862_546_1),
    (0.861_136_311_594_052_6, 0.347_854_845_137_453_9),
];

/// Times since the start of a span `t` side by side, and their weights.
#[inline(always)]
fn nodes(rule: &[(f64, f64); LANES], sign: f64, t: f64) -> (Lanes, Lanes) {
    let time = rule.map(|(node, _)| 0.5 * t * (1.0 + sign * node));
    (Lanes(time), Lanes(rule.map(|(_, weight)| 0.5 * t * weight)))
}

/// Entries of x, and where 1 and τ stand.
const SIZE: usize = 2 * MODES + 2;
const ONE: usize = 2 * MODES;
const TAU: usize = ONE + 1;

type Vector = [f64; SIZE];

fn vector(state: &State, tau: f64) -> Vector {
    let mut x = [0.0; SIZE];
    for mode in 0..MODES {
        (x[mode], x[MODES + mode]) = (state.d[mode], state.v[mode]);
    }
    (x[ONE], x[TAU]) = (1.0, tau);
    x
}

fn weights(form: &Form, line: Line) -> Vector {
    let mut w = [0.0; SIZE];
    for mode in 0..MODES {
        (w[mode], w[MODES + mode]) = (form.d[mode], form.v[mode]);
    }
    (w[ONE], w[TAU]) = (line.start, line.rate);
    w
}

fn dot(a: &Vector, b: &Vector) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// E(t) x.
fn carry(Transition { g, s, w, h, .. }: &Transition, drive: &Drive, t: f64, x: &Vector) -> Vector {
    let mut y = *x;
    for mode in 0..MODES {
        let (d, v, one) = (x[mode], x[MODES + mode], x[ONE]);
        let (g, s, w, h) = (g[mode], s[mode], w[mode], h[mode]);
        let (beta, gamma) = (drive.beta[mode] * one, drive.gamma[mode] * one);
        y[mode] = d - g * d + s * v - h * beta + g * gamma;
        y[MODES + mode] = v - s * d - w * v + g * beta + s * gamma;
    }
    y[TAU] += t * x[ONE];
    y
}

/// M, symmetric: the order of its rows is that of its columns.
struct Moments([Vector; SIZE]);

impl Moments {
    /// Of a span `dt` of more than a radian.
    fn over(bank: &Oscillators, from: &State, drive: &Drive, dt: f64) -> Self {
        let (doublings, mut t) = bank.halved(dt);
        let mut moments = Self([[0.0; SIZE]; SIZE]);
        for sign in [-1.0, 1.0] {
            let (time, weight) = nodes(&GAUSS, sign, t);
            for (tau, weight) in time.0.into_iter().zip(weight.0) {
                moments.add(&vector(&bank.over(tau).apply(from, drive), tau), weight);
            }
        }
        let mut step = bank.over(t);
        for _ in 0..doublings {
            moments.double(&step, drive, t);
            (step, t) = (bank.doubled(&step), 2.0 * t);
        }
        moments
    }

    fn add(&mut self, x: &Vector, weight: f64) {
        for (row, a) in self.0.iter_mut().zip(x) {
            for (sum, b) in row.iter_mut().zip(x) {
                *sum += weight * a * b;
            }
        }
    }

    /// M + E(t) M E(t)ᵀ.
    fn double(&mut self, step: &Transition, drive: &Drive, t: f64) {
        // E times the rows of M are those of M Eᵀ; E times its columns, M moved on both sides.
        let half = self.0.each_ref().map(|row| carry(step, drive, t, row));
        for column in 0..SIZE {
            let moved = carry(step, drive, t, &half.each_ref().map(|row| row[column]));
            for (row, value) in self.0.iter_mut().zip(moved) {
                row[column] += value;
            }
        }
    }

    /// wᵀ M w. What is exactly zero may come out a rounding error below it.
    fn weighted(&self, w: &Vector) -> f64 {
        self.0.iter().zip(w).map(|(row, weight)| weight * dot(row, w)).sum::<f64>().max(0.0)
    }
}

/// An output: its straight-line part at present, and ∫F² so far.
struct Output {
    form: Form,
    line: Line,
    sum: f64,
}

/// The integrals of all outputs, stretch by stretch; at a single time, the squares.
struct Squares<'a> {
    run: &'a Run,
    outputs: Vec<Output>,
    heights: Heights,
    begin: f64,
    end: f64,
    /// Where the stretches after this one end.
    later: &'a [f64],
    /// Root mean squares of the stretches before.
    found: Vec<Vec<f64>>,
    inside: Inside<'a>,
    /// Each mode in a bank of its own, whose lanes are times.
    alone: Vec<Oscillators>,
    watch: Watch<'a>,
}

impl Squares<'_> {
    /// Adds the squares at four times after a state, side by side.
    #[inline(always)]
    fn add(
        &mut self,
        from: &State,
        drive: &Drive,
        (tau, weight): (Lanes, Lanes),
        over: impl Fn(&Oscillators, Lanes) -> Transition,
    ) {
        let mut at = [(Lanes::ZERO, Lanes::ZERO); MODES];
        for (mode, (alone, at)) in self.alone.iter().zip(&mut at).enumerate() {
            let all = |lanes: &Lanes| Lanes::all(lanes[mode]);
            let from = State { d: all(&from.d), v: all(&from.v), p: Lanes::ZERO };
            let drive = Drive { beta: all(&drive.beta), gamma: all(&drive.gamma) };
            let to = over(alone, tau).apply(&from, &drive);
            *at = (to.d, to.v);
        }
        for Output { form, line, sum } in &mut self.outputs {
            let mut value = Lanes::all(line.start) + tau * line.rate;
            for (mode, (d, v)) in at.into_iter().enumerate() {
                value += d * form.d[mode] + v * form.v[mode];
            }
            *sum += weight.dot(value * value);
        }
    }

    /// Whether nothing after a segment adds to the stretch.
    fn is_through(&self, segment: &Segment) -> bool {
        // A single time at the end of a segment is the start of the next one.
        segment.end > self.end || (segment.end == self.end && self.begin < self.end)
    }

    /// What a segment adds to the stretches that begin on it.
    #[cold]
    fn visit_next(&mut self, segment: &Segment) {
        while self.is_through(segment) && self.turn_to_next() {
            self.visit_part(segment);
        }
    }

    /// Ends a stretch, unless it is the last.
    fn turn_to_next(&mut self) -> bool {
        let Some((&end, later)) = self.later.split_first() else { return false };
        self.end_stretch();
        (self.begin, self.end, self.later) = (self.end, end, later);
        true
    }

    fn end_stretch(&mut self) {
        let span = if self.begin == self.end { 1.0 } else { self.end - self.begin };
        let root = |output: &mut Output| (std::mem::take(&mut output.sum) / span).sqrt();
        self.found.push(self.outputs.iter_mut().map(root).collect());
    }

    /// What a segment adds to the stretch.
    #[inline(always)]
    fn visit_part(&mut self, segment: &Segment) {
        let (from, to) = (segment.start.max(self.begin), segment.end.min(self.end));
        let instant = self.begin == self.end;
        if from > to || from == segment.end || (from == to && !instant) {
            return;
        }
        self.heights.read(segment, from);
        for Output { form, line, .. } in &mut self.outputs {
            *line = form.line(segment, &self.heights);
        }
        let inside = segment.start >= self.begin;
        let state = if inside { *segment.state() } else { self.inside.states(segment, &[from])[0] };
        let (bank, drive) = (&self.run.oscillators, segment.drive());
        if instant {
            for Output { form, line, sum } in &mut self.outputs {
                *sum = (form.value(&state) + line.start).powi(2);
            }
            return;
        }
        let dt = if inside && to == segment.end { segment.dt() } else { segment.elapsed(from, to) };
        if bank.is_short(dt) {
            self.add(&state, &drive, nodes(&GAUSS_SHORT, 1.0, dt), Oscillators::over_short_parts);
        } else if bank.halved(dt).0 == 0 {
            for sign in [-1.0, 1.0] {
                self.add(&state, &drive, nodes(&GAUSS, sign, dt), Oscillators::over_parts);
            }
        } else {
            let moments = Moments::over(bank, &state, &drive, dt);
            for Output { form, line, sum } in &mut self.outputs {
                *sum += moments.weighted(&weights(form, *line));
            }
        }
    }
}

impl Visitor for Squares<'_> {
    #[inline(always)]
    fn visit(&mut self, segment: &Segment) {
        self.visit_part(segment);
        if self.is_through(segment) {
            self.visit_next(segment);
        }
    }

    fn go_on(&mut self, work: u32) -> bool {
        self.watch.go_on(work)
    }
}

impl Run {
    /// Root mean squares of the given quantities between two times; at a single time, magnitudes.
    ///
    /// # Errors
    /// Times not finite or in the wrong order, an overflow, or what `pulse` gives.
    pub fn root_mean_squares(
        &self,
        quantities: &[Quantity],
        (begin, end): (f64, f64),
        pulse: Pulse,
    ) -> Result<Vec<f64>> {
        Ok(self.root_mean_squares_between(quantities, &[begin, end], pulse)?.swap_remove(0))
    }

    /// The same for each stretch between two successive times of a list: a list a stretch.
    ///
    /// # Errors
    /// Fewer than two times, or as for [`Run::root_mean_squares`].
    pub fn root_mean_squares_between(
        &self,
        quantities: &[Quantity],
        times: &[f64],
        pulse: Pulse,
    ) -> Result<Vec<Vec<f64>>> {
        let &[begin, end, ref later @ ..] = times else {
            return Err(Error::TooShort { argument: "times", found: times.len(), least: 2 });
        };
        self.check_times(times)?;
        let last = times[times.len() - 1];
        let forms: Vec<Form> = quantities.iter().flat_map(|quantity| Form::all(self, quantity)).collect();
        let heights = Heights::new(self, &forms);
        let output = |form| Output { form, line: Line { start: 0.0, rate: 0.0 }, sum: 0.0 };
        let mut squares = Squares {
            run: self,
            outputs: forms.into_iter().map(output).collect(),
            heights,
            begin,
            end,
            later,
            found: Vec::with_capacity(times.len() - 1),
            inside: Inside::new(self),
            alone: (0..self.modes.omega().len()).map(|mode| self.oscillators.alone(mode)).collect(),
            watch: Watch::new(pulse),
        };
        march(self, last, &mut squares);
        squares.end_stretch();
        squares.watch.outcome?;
        if squares.found.iter().flatten().all(|root| root.is_finite()) {
            Ok(squares.found)
        } else {
            Err(Error::Overflow { quantity: "a root mean square", time: last })
        }
    }
}
