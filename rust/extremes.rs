//! True maxima and minima of the continuous response.
//!
//! Between two knots an output is a straight line plus damped oscillations. About its moving
//! steady position each mode's (y, ẏ/ω) has a length r that never grows, which bounds every
//! derivative of the output from the state at the start:
//!
//! * |F″| ≤ M₂ = Σ c₂ r, so F stays below its larger end + M₂h²/8. Nearly every segment of a
//!   finely sampled profile is dismissed by this one test.
//! * |F″(0)| > M₃h: curvature of one sign, at most one turning point, found by Newton's method.
//! * |F′(0)| > M₂h: no turning point at all.
//!
//! A piece that none of these decides is halved. Pieces are at most one radian of the fastest
//! mode long, so a level stretch with a hundred cycles is searched cycle by cycle, as far as
//! the amplitudes left can still reach the record.

use crate::error::{Error, Result};
use crate::march::March;
use crate::readout::{Form, Heights, Line, Quantity};
use crate::run::{Pulse, Run};
use crate::transition::{Drive, LANES, Lanes, Oscillators, State, Transition};

/// A value this close to the record (in units in the last place of the range) ties with it:
/// of equal peaks the first counts.
const TIE: f64 = 4.0 * f64::EPSILON;

/// Halvings and Newton steps end here; both converge long before.
const MOST_STEPS: u32 = 60;

/// Largest and smallest value of one output and when they occur.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extreme {
    /// Largest value.
    pub max: f64,
    /// When it first occurs.
    pub time_of_max: f64,
    /// Smallest value.
    pub min: f64,
    /// When it first occurs.
    pub time_of_min: f64,
}

impl Extreme {
    #[inline]
    fn offer(&mut self, value: f64, time: f64, slack: f64) {
        if value > self.max + slack {
            (self.max, self.time_of_max) = (value, time);
        }
        if value < self.min - slack {
            (self.min, self.time_of_min) = (value, time);
        }
    }
}

/// An output with the bounds that follow from its weights.
struct Output {
    form: Form,
    /// Σ amplitude · r bounds the oscillating part.
    amplitude: Lanes,
    /// Σ second · r bounds |F″|.
    second: Lanes,
    /// Σ third · r bounds |F‴|.
    third: Lanes,
    line: Line,
    record: Extreme,
}

/// Departure from the moving steady position: y and ẏ/ω.
fn departure(bank: &Oscillators, drive: &Drive, state: &State) -> (Lanes, Lanes) {
    let (mut y, mut w) = ([0.0; LANES], [0.0; LANES]);
    for i in 0..LANES {
        y[i] = state.d[i] - (drive.gamma[i] - bank.two_zeta[i] * drive.beta[i]);
        w[i] = state.v[i] - drive.beta[i];
    }
    (y, w)
}

/// r of the module text.
#[inline]
fn lengths(bank: &Oscillators, drive: &Drive, state: &State) -> Lanes {
    let (y, w) = departure(bank, drive, state);
    let mut r = [0.0; LANES];
    for i in 0..LANES {
        r[i] = (y[i] * y[i] + w[i] * w[i]).sqrt();
    }
    r
}

#[inline]
fn dot(a: &Lanes, b: &Lanes) -> f64 {
    (a[0] * b[0] + a[1] * b[1]) + (a[2] * b[2] + a[3] * b[3])
}

impl Output {
    fn new(form: Form, bank: &Oscillators) -> Self {
        let none = [0.0; LANES];
        let (mut amplitude, mut second, mut third) = (none, none, none);
        for i in 0..LANES {
            let (omega, two_zeta) = (bank.omega[i], bank.two_zeta[i]);
            let [a, b] = curvature(&form, bank, i);
            amplitude[i] = (form.d[i] * form.d[i] + form.v[i] * form.v[i]).sqrt();
            second[i] = (a * a + b * b).sqrt();
            // The norm of [[0, 1], [−1, −2ζ]].
            third[i] = second[i] * omega * (0.5 * two_zeta + (1.0 + 0.25 * two_zeta * two_zeta).sqrt());
        }
        let record =
            Extreme { max: f64::NEG_INFINITY, time_of_max: 0.0, min: f64::INFINITY, time_of_min: 0.0 };
        Self { form, amplitude, second, third, line: Line { start: 0.0, rate: 0.0 }, record }
    }

    fn slack(&self) -> f64 {
        let slack = TIE * self.record.max.abs().max(self.record.min.abs());
        if slack.is_finite() { slack } else { 0.0 }
    }
}

/// Weights of y and ẏ/ω in F″.
fn curvature(form: &Form, bank: &Oscillators, i: usize) -> [f64; 2] {
    let (a, b, two_zeta) = (form.d[i], form.v[i], bank.two_zeta[i]);
    let square = bank.omega[i] * bank.omega[i];
    [square * (two_zeta * b - a), square * ((two_zeta * two_zeta - 1.0) * b - two_zeta * a)]
}

/// One output along one piece, upside down where a minimum is sought.
struct Climb<'a> {
    bank: &'a Oscillators,
    drive: &'a Drive,
    output: &'a Output,
    sign: f64,
    slack: f64,
    best: f64,
    at: f64,
}

impl Climb<'_> {
    /// F, F′ and F″ at a state `tau` after the start of the line.
    fn jet(&self, state: &State, tau: f64) -> [f64; 3] {
        let Output { form, line, .. } = self.output;
        let (y, w) = departure(self.bank, self.drive, state);
        let (mut slope, mut bend) = (line.rate, 0.0);
        for i in 0..LANES {
            let back = y[i] + self.bank.two_zeta[i] * w[i];
            slope += self.bank.omega[i] * (form.d[i] * w[i] - form.v[i] * back);
            let [a, b] = curvature(form, self.bank, i);
            bend += a * y[i] + b * w[i];
        }
        let value = form.value(state) + (line.start + line.rate * tau);
        [value, slope, bend].map(|part| self.sign * part)
    }

    fn offer(&mut self, value: f64, tau: f64) {
        if value > self.best + self.slack {
            (self.best, self.at) = (value, tau);
        }
    }

    /// Searches [tau, tau + h] from the state at tau.
    fn search(&mut self, from: &State, tau: f64, h: f64, depth: u32) {
        let to = self.bank.over(h).apply(from, self.drive);
        let [f0, slope0, bend0] = self.jet(from, tau);
        let [f1, slope1, _] = self.jet(&to, tau + h);
        self.offer(f0, tau);
        self.offer(f1, tau + h);
        let r = lengths(self.bank, self.drive, from);
        let (second, third) = (dot(&self.output.second, &r), dot(&self.output.third, &r));
        if f0.max(f1) + second * h * h / 8.0 <= self.best + self.slack {
            return;
        }
        if bend0.abs() > third * h {
            if slope0 > 0.0 && slope1 < 0.0 {
                self.summit(from, tau, h, slope0 / (slope0 - slope1));
            }
            return;
        }
        if slope0.abs() > second * h || depth == MOST_STEPS {
            return;
        }
        let half = 0.5 * h;
        let middle = self.bank.over(half).apply(from, self.drive);
        self.search(from, tau, half, depth + 1);
        self.search(&middle, tau + half, half, depth + 1);
    }

    /// The one zero of F′ in a piece on which F is concave: Newton's method in a bracket.
    fn summit(&mut self, from: &State, tau: f64, h: f64, guess: f64) {
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
            if (next - at).abs() <= f64::EPSILON * h {
                break;
            }
            at = next;
        }
    }
}

/// The search over all outputs, piece by piece.
struct Search<'a> {
    run: &'a Run,
    outputs: Vec<Output>,
    fastest: f64,
}

impl Search<'_> {
    /// Reads the straight-line parts of a segment that begins at `time` and offers its start.
    fn begin(&mut self, march: &March, heights: &mut Heights, time: f64, state: &State) {
        heights.read(march, time);
        for output in &mut self.outputs {
            output.line = output.form.line(march, heights);
            let value = output.form.value(state) + output.line.start;
            let slack = output.slack();
            output.record.offer(value, time, slack);
        }
    }

    /// Searches a segment of length `dt` that begins at `time` with `state`.
    fn segment(
        &mut self,
        from: &State,
        drive: &Drive,
        (time, dt): (f64, f64),
        whole: &Transition,
        pulse: &mut Pulse,
    ) -> Result<()> {
        let radians = self.fastest * dt;
        if radians <= 1.0 {
            self.piece(from, &whole.apply(from, drive), drive, (time, 0.0, dt));
            return Ok(());
        }
        let pieces = radians.ceil();
        let h = dt / pieces;
        let step = self.run.oscillators.over(h);
        let (mut state, mut count) = (*from, 0_u64);
        while (count as f64) < pieces && self.reachable(&state, drive, (count as f64 * h, dt)) {
            let next = step.apply(&state, drive);
            self.piece(&state, &next, drive, (time, count as f64 * h, h));
            state = next;
            count += 1;
            if count.is_multiple_of(1 << 16) {
                pulse()?;
            }
        }
        // The end of the segment, which the search may have stopped short of.
        let end = whole.apply(from, drive);
        for output in &mut self.outputs {
            let value = output.form.value(&end) + (output.line.start + output.line.rate * dt);
            let slack = output.slack();
            output.record.offer(value, time + dt, slack);
        }
        Ok(())
    }

    /// Whether the amplitudes left can still set a record between `tau` and `dt`.
    fn reachable(&self, state: &State, drive: &Drive, (tau, dt): (f64, f64)) -> bool {
        let bank = &self.run.oscillators;
        let r = lengths(bank, drive, state);
        self.outputs.iter().any(|output| {
            let steady = |i: usize| {
                let d = drive.gamma[i] - bank.two_zeta[i] * drive.beta[i];
                output.form.d[i] * d + output.form.v[i] * drive.beta[i]
            };
            let steady = (0..LANES).map(steady).sum::<f64>() + output.line.start;
            let (a, b) = (steady + output.line.rate * tau, steady + output.line.rate * dt);
            let swing = dot(&output.amplitude, &r);
            let slack = output.slack();
            a.max(b) + swing > output.record.max + slack || a.min(b) - swing < output.record.min - slack
        })
    }

    /// One piece: its end, and its inside where the bound does not dismiss it.
    #[inline]
    fn piece(&mut self, from: &State, to: &State, drive: &Drive, (time, tau, h): (f64, f64, f64)) {
        let bank = &self.run.oscillators;
        let r = lengths(bank, drive, from);
        for output in &mut self.outputs {
            let start = output.form.value(from) + (output.line.start + output.line.rate * tau);
            let end = output.form.value(to) + (output.line.start + output.line.rate * (tau + h));
            let bulge = dot(&output.second, &r) * h * h / 8.0;
            let slack = output.slack();
            output.record.offer(end, time + tau + h, slack);
            for sign in [1.0, -1.0] {
                let best = if sign > 0.0 { output.record.max } else { -output.record.min };
                if (sign * start).max(sign * end) + bulge > best + slack {
                    let mut climb = Climb { bank, drive, output, sign, slack, best, at: f64::NAN };
                    climb.search(from, tau, h, 0);
                    let (value, at) = (sign * climb.best, time + climb.at);
                    if climb.best > best {
                        output.record.offer(value, at, 0.0);
                    }
                }
            }
        }
    }
}

impl Run {
    /// True extremes of the given quantities between two times, between samples too.
    /// At a vertical step both sides count.
    ///
    /// # Errors
    /// An overflow, or what `pulse` gives.
    pub fn extremes(
        &self,
        quantities: &[Quantity],
        (begin, end): (f64, f64),
        pulse: &mut Pulse,
    ) -> Result<Vec<Extreme>> {
        let forms: Vec<Form> = quantities.iter().flat_map(|quantity| Form::all(self, quantity)).collect();
        let mut heights = Heights::new(self, &forms);
        let bank = &self.oscillators;
        let fastest = bank.omega.iter().copied().fold(0.0, f64::max);
        let outputs = forms.into_iter().map(|form| Output::new(form, bank)).collect();
        let mut search = Search { run: self, outputs, fastest };
        let mut march = March::new(self);
        march.advance(begin, pulse)?;
        let mut time = begin;
        let mut count = 0_u32;
        loop {
            let from = march.state_at(time);
            search.begin(&march, &mut heights, time, &from);
            let next = march.knots.upcoming_time();
            let (drive, last) = (march.drive, next > end);
            if !last && time <= march.knots.time() {
                // The usual case: a whole segment, its transition shared with the march.
                let dt = march.knots.dt();
                let whole = *march.transition();
                search.segment(&from, &drive, (time, dt), &whole, pulse)?;
                march.cross(whole.apply(&from, &drive));
            } else {
                let there = if last { march.distance_at(end) } else { march.knots.upcoming() };
                let dt = (there.minus(march.distance_at(time)) / self.speed).max(0.0);
                search.segment(&from, &drive, (time, dt), &bank.over(dt), pulse)?;
                march.advance(next.min(end), pulse)?;
            }
            if last {
                break;
            }
            time = next;
            count = count.wrapping_add(1);
            if count.is_multiple_of(1 << 16) {
                pulse()?;
            }
        }
        let records: Vec<Extreme> = search.outputs.iter().map(|output| output.record).collect();
        if records.iter().all(|r| (r.max - r.min).is_finite()) {
            Ok(records)
        } else {
            Err(Error::Overflow { quantity: "an extreme", time: end })
        }
    }
}
