//! True maxima and minima of the continuous response.
//!
//! Between two knots an output is a straight line plus damped oscillations. About its moving
//! steady position each mode's (y, ẏ/ω) has a length r that never grows, which bounds every
//! derivative of the output from the state at the start. (A mode damped well beyond critical
//! counts as its two decaying exponentials, each with its own length: one length for both
//! would pair the size of the slow one with the derivatives of the fast one.)
//!
//! * |F″| ≤ M₂ = Σ c₂ r, so F stays below its larger end + M₂h²/8. Nearly every segment of a
//!   finely sampled profile is dismissed by this one test. Where F″ is known at both ends, it is
//!   also at most (|F″(0)| + |F″(h)| + M₃h)/2, which may be much less.
//! * F″ of one sign at both ends, |F″(0)| + |F″(h)| > M₃h: of one sign throughout, so at most one
//!   turning point, found by Newton's method where the tangents at the ends meet high enough.
//! * F′ of one sign at both ends, |F′(0)| + |F′(h)| > M₂h: no turning point at all.
//! * F‴ of one sign at both ends, |F‴(0)| + |F‴(h)| > M₄h: of one sign throughout, so F″ does not
//!   change its sign if its ends have the same or one is zero. So do loads start that a gear
//!   elsewhere sets off: as the cube of time.
//!
//! A piece that none of these decides is halved. Pieces are at most one radian of the fastest
//! mode long, so a level stretch with a hundred cycles is searched cycle by cycle, as far as
//! the amplitudes left can still reach the record.

use multiversion::multiversion;

use crate::error::{Error, Result};
use crate::inside::Inside;
use crate::lanes::{LANES, Lanes};
use crate::march::{Block, Segment, Visitor, march};
use crate::readout::{Form, Heights, Line, Quantity};
use crate::run::Run;
use crate::transition::{Drive, Oscillators, State, Transition};
use crate::watch::{Pulse, Watch};

/// A value this close to the record (in units in the last place of the range) ties with it:
/// of equal peaks the first counts.
const TIE: f64 = 4.0 * f64::EPSILON;

/// What sums of products are off by, as a share of the sum of magnitudes.
const ROUNDING: f64 = 16.0 * f64::EPSILON;

/// Pieces of a long segment whose ends are known before any is searched: a few cycles.
const BATCH: usize = 32;

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
    /// Largest magnitude and when it occurs.
    #[must_use]
    pub fn magnitude(&self) -> (f64, f64) {
        if self.max >= -self.min { (self.max, self.time_of_max) } else { (-self.min, self.time_of_min) }
    }

    /// Sums of times round; what was found lies between the two given.
    fn within(mut self, begin: f64, end: f64) -> Self {
        self.time_of_max = self.time_of_max.clamp(begin, end);
        self.time_of_min = self.time_of_min.clamp(begin, end);
        self
    }

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

/// A number a mode, and another for the fast exponential of an overdamped one.
#[derive(Clone, Copy)]
pub(crate) struct Pair([Lanes; 2]);

impl Pair {
    #[inline(always)]
    fn dot(self, other: Self) -> f64 {
        self.0[0].dot(other.0[0]) + self.0[1].dot(other.0[1])
    }
}

/// Beyond this 2ζ a mode counts as two exponentials; below, they are too much alike.
const APART: f64 = 2.5;

/// Rates ÷ ω of the two exponentials of a mode with 2ζ > [`APART`], slow and fast.
fn rates(two_zeta: f64) -> Option<[f64; 2]> {
    let fast = 0.5 * two_zeta * (1.0 + (1.0 - 4.0 / two_zeta / two_zeta).sqrt());
    (two_zeta > APART).then_some([1.0 / fast, fast])
}

/// How lengths follow from y and w = ẏ/ω, lane by lane: a mode that oscillates has the length
/// of (y, w), an overdamped one |slow · (y, w)| and |fast · (y, w)|.
pub(crate) struct Lengths {
    slow: [Lanes; 2],
    across: Lanes,
    fast: [Lanes; 2],
}

impl Lengths {
    pub fn new(bank: &Oscillators) -> Self {
        let none = Lanes::ZERO;
        let mut lengths = Self { slow: [Lanes::all(1.0), none], across: Lanes::all(1.0), fast: [none; 2] };
        for i in 0..LANES {
            if let Some([slow, fast]) = rates(bank.two_zeta[i]) {
                let scale = 1.0 / (fast - slow);
                (lengths.slow[0][i], lengths.slow[1][i]) = (fast * scale, scale);
                (lengths.fast[0][i], lengths.fast[1][i]) = (slow * scale, scale);
                lengths.across[i] = 0.0;
            }
        }
        lengths
    }

    /// Components: along the slow exponential (or y), across it (w, or nothing), along the fast.
    #[inline(always)]
    fn parts(&self, (y, w): (Lanes, Lanes)) -> [Lanes; 3] {
        let Self { slow, across, fast } = self;
        [slow[0] * y + slow[1] * w, *across * w, fast[0] * y + fast[1] * w]
    }

    #[inline(always)]
    fn of(&self, departure: (Lanes, Lanes)) -> Pair {
        let [slow, across, fast] = self.parts(departure);
        Pair([(slow * slow + across * across).map(f64::sqrt), fast.abs()])
    }

    /// Weights of |y| and |ẏ/ω| in a sum that is not less than `weights` · lengths.
    pub fn reach(&self, Pair([one, other]): Pair) -> [Lanes; 2] {
        let Self { slow, across, fast } = self;
        [
            one * slow[0].abs() + other * fast[0].abs(),
            one * (slow[1].abs() + across.abs()) + other * fast[1].abs(),
        ]
    }

    /// Not less than the lengths, without their root.
    #[inline(always)]
    fn at_most(&self, departure: (Lanes, Lanes)) -> Pair {
        let [slow, across, fast] = self.parts(departure);
        Pair([slow.abs() + across.abs(), fast.abs()])
    }
}

/// An output with the bounds that follow from its weights.
#[derive(Clone)]
pub(crate) struct Output {
    pub form: Form,
    /// Weights of y and ẏ/ω in F′.
    slope: [Lanes; 2],
    /// Weights of y and ẏ/ω in F″.
    pub bend: [Lanes; 2],
    /// Weights of y and ẏ/ω in F‴.
    jerk: [Lanes; 2],
    /// Σ amplitude · r bounds the oscillating part.
    pub amplitude: Pair,
    /// Σ second · r bounds |F″|.
    pub second: Pair,
    /// Σ third · r bounds |F‴|.
    third: Pair,
    /// Σ fourth · r bounds |F⁗|.
    fourth: Pair,
    pub line: Line,
    pub record: Extreme,
}

/// Departure from the moving steady position: y and ẏ/ω.
#[inline(always)]
fn departure(bank: &Oscillators, drive: &Drive, state: &State) -> (Lanes, Lanes) {
    (state.d - (drive.gamma - bank.two_zeta * drive.beta), state.v - drive.beta)
}

impl Output {
    pub fn new(form: Form, bank: &Oscillators) -> Self {
        // d/dt of a y + b ẏ/ω is (−ωb) y + ω(a − 2ζb) ẏ/ω.
        let derive =
            |[a, b]: [Lanes; 2]| [Lanes::ZERO - bank.omega * b, bank.omega * (a - bank.two_zeta * b)];
        let length = |[a, b]: [Lanes; 2]| Pair([(a * a + b * b).map(f64::sqrt), Lanes::ZERO]);
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
        let record =
            Extreme { max: f64::NEG_INFINITY, time_of_max: 0.0, min: f64::INFINITY, time_of_min: 0.0 };
        let line = Line { start: form.constant, rate: 0.0 };
        Self { form, slope, bend, jerk, amplitude, second, third, fourth, line, record }
    }

    /// Offers the value at a state `tau` after `time`, where the line starts.
    fn offer(&mut self, state: &State, time: f64, tau: f64) {
        let value = self.form.value(state) + (self.line.start + self.line.rate * tau);
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
                let mut search =
                    Climb { bank, lengths, drive, output: self, sign, slack, best, at: f64::NAN };
                climb(&mut search, Stretch { from: *from, to: *to, tau, h, halvings: 0 }, watch);
                if search.best > best {
                    let (value, at) = (sign * search.best, time + search.at);
                    self.record.offer(value, at, 0.0);
                }
            }
        }
    }

    fn slack(&self) -> f64 {
        let slack = TIE * self.record.max.abs().max(self.record.min.abs());
        if slack.is_finite() { slack } else { 0.0 }
    }
}

/// One output along one piece, upside down where a minimum is sought.
struct Climb<'a> {
    bank: &'a Oscillators,
    lengths: &'a Lengths,
    drive: &'a Drive,
    output: &'a Output,
    sign: f64,
    slack: f64,
    best: f64,
    at: f64,
}

impl Climb<'_> {
    /// F, F′ and F″ at a state `tau` after the start of the line.
    #[inline(always)]
    fn jet(&self, state: &State, tau: f64) -> [f64; 3] {
        let Output { form, slope, bend, line, .. } = self.output;
        let (y, w) = departure(self.bank, self.drive, state);
        let value = form.value(state) + (line.start + line.rate * tau);
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

    /// Offers what a stretch has to offer, if its bounds tell.
    #[inline(always)]
    fn settles(&mut self, Stretch { from, to, tau, h, .. }: &Stretch) -> bool {
        let (tau, h) = (*tau, *h);
        let [f0, slope0, bend0] = self.jet(from, tau);
        let [f1, slope1, bend1] = self.jet(to, tau + h);
        self.offer(f0, tau);
        self.offer(f1, tau + h);
        let r = self.lengths.of(departure(self.bank, self.drive, from));
        let (second, third) = (self.output.second.dot(r), self.output.third.dot(r));
        let steepest = second.min(0.5 * (bend0.abs() + bend1.abs() + third * h));
        let enough = self.best + self.slack;
        if f0.max(f1) + steepest * h * h / 8.0 <= enough || one_sign(slope0, slope1, steepest * h) {
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
        false
    }

    /// Whether F‴ has one sign.
    fn bends_one_way(&self, from: &State, to: &State, r: Pair, h: f64) -> bool {
        let [y, w] = self.output.jerk;
        let jerk = |state| {
            let departure = departure(self.bank, self.drive, state);
            y.dot(departure.0) + w.dot(departure.1)
        };
        one_sign(jerk(from), jerk(to), self.output.fourth.dot(r) * h)
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

/// A stretch from `tau` to `tau + h`, with the states at its ends.
#[derive(Clone, Copy)]
struct Stretch {
    from: State,
    to: State,
    tau: f64,
    h: f64,
    halvings: u32,
}

/// Searches a stretch, halving it where its bounds decide nothing; in vain once the caller has asked to
/// stop.
#[multiversion(targets("x86_64+avx2"))]
fn climb(this: &mut Climb, stretch: Stretch, watch: &mut Watch) {
    let (mut now, mut later) = (stretch, Vec::new());
    while watch.go_on(1) {
        if this.settles(&now) || now.halvings == MOST_STEPS {
            match later.pop() {
                Some(next) => now = next,
                None => return,
            }
        } else {
            let (h, halvings) = (0.5 * now.h, now.halvings + 1);
            let middle = this.bank.over(h).apply(&now.from, this.drive);
            later.push(Stretch { from: middle, to: now.to, tau: now.tau + h, h, halvings });
            now = Stretch { from: now.from, to: middle, tau: now.tau, h, halvings };
        }
    }
}

/// Four outputs side by side, for the test that dismisses nearly every segment.
struct Screen {
    /// Weights of the modes' d and v, and of their lengths in the bound on |F″|.
    weights: [[Lanes; 4]; LANES],
    line: Lanes,
    rate: Lanes,
    /// Values at the start of the next piece.
    start: Lanes,
    /// Records, with the slack for ties, or values ahead that will be records.
    high: Lanes,
    low: Lanes,
    /// Largest and smallest values seen ahead, less the slack.
    ahead: (Lanes, Lanes),
}

impl Screen {
    fn new(outputs: &[Output]) -> Self {
        let gather = |part: &dyn Fn(&Output) -> f64| {
            let mut lanes = Lanes::ZERO;
            for (lane, output) in outputs.iter().enumerate() {
                lanes[lane] = part(output);
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
        screen.read_lines(outputs);
        screen.read_records(outputs);
        screen
    }

    fn read_lines(&mut self, outputs: &[Output]) {
        for (lane, output) in outputs.iter().enumerate() {
            (self.line[lane], self.rate[lane]) = (output.line.start, output.line.rate);
        }
    }

    fn read_records(&mut self, outputs: &[Output]) {
        for (lane, output) in outputs.iter().enumerate() {
            let slack = output.slack();
            (self.high[lane], self.low[lane]) = (output.record.max + slack, output.record.min - slack);
        }
        (self.high, self.low) = (self.high.max(self.ahead.0), self.low.min(self.ahead.1));
    }

    /// Looks ahead at values, so that pieces that do not reach the largest are dismissed at once.
    #[inline(always)]
    fn look_ahead(&mut self, values: &[Lanes]) {
        for value in values {
            let slack = value.abs() * TIE;
            self.ahead = (self.ahead.0.max(*value - slack), self.ahead.1.min(*value + slack));
        }
        (self.high, self.low) = (self.high.max(self.ahead.0), self.low.min(self.ahead.1));
    }

    /// Values at a state `tau` after the start of the line.
    #[inline(always)]
    fn values(&self, state: &State, tau: f64) -> Lanes {
        let mut sum = self.line + self.rate * tau;
        for (mode, [d, v, ..]) in self.weights.iter().enumerate() {
            sum += *d * state.d[mode] + *v * state.v[mode];
        }
        sum
    }

    /// What the outputs cannot exceed, nor fall below, on a piece from the values `start` to
    /// the values `end`.
    #[inline(always)]
    fn bounds(&self, (start, end): (Lanes, Lanes), Pair([slow, fast]): Pair, h: f64) -> (Lanes, Lanes) {
        let mut second = Lanes::ZERO;
        for (mode, [_, _, one, other]) in self.weights.iter().enumerate() {
            second += *one * slow[mode] + *other * fast[mode];
        }
        let bulge = second * (h * h / 8.0);
        (start.max(end) + bulge, start.min(end) - bulge)
    }
}

impl Screen {
    /// Searches a piece as far as the bounds on it reach beyond the records.
    #[inline(always)]
    fn check(
        &mut self,
        outputs: &mut [Output],
        bank: (&Oscillators, &Lengths),
        (ends, values): ((&State, &State), (Lanes, Lanes)),
        drive: &Drive,
        (time, tau, h): (f64, f64, f64),
        watch: &mut Watch,
    ) {
        let lengths = bank.1.at_most(departure(bank.0, drive, ends.0));
        let (top, bottom) = self.bounds(values, lengths, h);
        if top.any_above(self.high) || self.low.any_above(bottom) {
            for (lane, output) in outputs.iter_mut().enumerate() {
                if top[lane] > self.high[lane] || bottom[lane] < self.low[lane] {
                    let signs = [(1.0, top[lane]), (-1.0, -bottom[lane])];
                    output.search(bank, ends, drive, (time, tau, h), &signs, watch);
                }
            }
            self.read_records(outputs);
        }
    }
}

/// The search over all outputs, piece by piece, between two times.
struct Search<'a> {
    run: &'a Run,
    outputs: Vec<Output>,
    screens: Vec<Screen>,
    lengths: Lengths,
    heights: Heights,
    /// Whether the straight-line parts change from segment to segment.
    has_lines: bool,
    fastest: f64,
    begin: f64,
    end: f64,
    last: State,
    inside: Inside<'a>,
    watch: Watch<'a>,
}

impl Search<'_> {
    /// Takes up a segment at `time`: its straight-line parts, and the values there.
    #[inline(always)]
    fn begin(&mut self, segment: &Segment, time: f64, state: &State) {
        if self.has_lines {
            self.heights.read(segment, time);
            for output in &mut self.outputs {
                output.line = output.form.line(segment, &self.heights);
            }
        }
        for (screen, outputs) in self.screens.iter_mut().zip(self.outputs.chunks_mut(LANES)) {
            if self.has_lines {
                screen.read_lines(outputs);
            }
            screen.start = screen.values(state, 0.0);
            if screen.start.any_above(screen.high) || screen.low.any_above(screen.start) {
                for output in &mut *outputs {
                    output.offer(state, time, 0.0);
                }
                screen.read_records(outputs);
            }
        }
    }

    /// A segment of more than a radian, a batch of pieces at a time.
    #[inline(always)]
    fn long(&mut self, from: &State, drive: &Drive, (time, dt): (f64, f64), whole: &Transition) {
        let pieces = (self.fastest * dt).ceil();
        let h = dt / pieces;
        let step = self.run.oscillators.over(h);
        let mut states = [*from; BATCH + 1];
        let mut count = 0_u64;
        while (count as f64) < pieces {
            let tau = count as f64 * h;
            // Asked once a batch: whether the amplitudes left still reach a record.
            let batch = (pieces - count as f64).min(BATCH as f64) as usize;
            if !(self.watch.go_on(batch as u32) && self.reachable(&states[0], drive, (tau, dt))) {
                break;
            }
            for end in 1..=batch {
                states[end] = step.apply(&states[end - 1], drive);
            }
            self.pieces(&states[..=batch], drive, time, |piece| (count + piece as u64) as f64 * h, h);
            states[0] = states[batch];
            count += batch as u64;
        }
        // The end of the segment, which the search may have stopped short of.
        let end = whole.apply(from, drive);
        for output in &mut self.outputs {
            output.offer(&end, time, dt);
        }
        for (screen, outputs) in self.screens.iter_mut().zip(self.outputs.chunks(LANES)) {
            screen.read_records(outputs);
        }
    }

    /// Whether the amplitudes left can still set a record between `tau` and `dt`.
    fn reachable(&self, state: &State, drive: &Drive, (tau, dt): (f64, f64)) -> bool {
        let bank = &self.run.oscillators;
        let r = self.lengths.of(departure(bank, drive, state));
        let steady = drive.gamma - bank.two_zeta * drive.beta;
        self.outputs.iter().any(|Output { form, line, amplitude, record, .. }| {
            let level = form.d.dot(steady) + form.v.dot(drive.beta) + line.start;
            let (a, b) = (level + line.rate * tau, level + line.rate * dt);
            let swing = amplitude.dot(r);
            a.max(b) + swing > record.max || a.min(b) - swing < record.min
        })
    }

    /// One piece of at most a radian.
    #[inline(always)]
    fn piece(&mut self, ends: (&State, &State), drive: &Drive, (time, h): (f64, f64)) {
        let bank = (&self.run.oscillators, &self.lengths);
        for (screen, outputs) in self.screens.iter_mut().zip(self.outputs.chunks_mut(LANES)) {
            let values = (screen.start, screen.values(ends.1, h));
            screen.start = values.1;
            screen.check(outputs, bank, (ends, values), drive, (time, 0.0, h), &mut self.watch);
        }
    }

    /// Pieces of length `h` from one state to the next, the first `tau` after `time`.
    #[inline(always)]
    fn pieces(&mut self, states: &[State], drive: &Drive, time: f64, tau: impl Fn(usize) -> f64, h: f64) {
        let bank = (&self.run.oscillators, &self.lengths);
        for (screen, outputs) in self.screens.iter_mut().zip(self.outputs.chunks_mut(LANES)) {
            let mut values = [screen.start; BATCH + 1];
            for (piece, state) in states[1..].iter().enumerate() {
                values[piece + 1] = screen.values(state, tau(piece) + h);
            }
            screen.start = values[states.len() - 1];
            screen.look_ahead(&values[1..states.len()]);
            for (piece, ends) in states.windows(2).enumerate() {
                let values = (values[piece], values[piece + 1]);
                screen.check(
                    outputs,
                    bank,
                    ((&ends[0], &ends[1]), values),
                    drive,
                    (time, tau(piece), h),
                    &mut self.watch,
                );
            }
        }
    }
}

impl Visitor for Search<'_> {
    fn visit(&mut self, segment: &Segment) {
        self.look(segment);
    }

    fn visit_block(&mut self, block: &mut Block) {
        block.march();
        look_at_block(self, block);
    }

    fn go_on(&mut self, work: u32) -> bool {
        self.watch.go_on(work)
    }
}

#[multiversion(targets("x86_64+avx2"))]
fn look_at_block(search: &mut Search, block: &Block) {
    for segment in block.segments() {
        search.look(&segment);
    }
}

#[multiversion(targets("x86_64+avx2"))]
fn search_long(search: &mut Search, from: &State, drive: &Drive, span: (f64, f64), whole: &Transition) {
    search.long(from, drive, span, whole);
}

impl Search<'_> {
    #[inline(always)]
    fn look(&mut self, segment: &Segment) {
        // Of a vertical step only the two sides count, not what lies between.
        if segment.end < self.begin || segment.start > self.end || segment.start == segment.end {
            return;
        }
        self.last = *segment.state();
        let inside = segment.start >= self.begin && segment.end <= self.end;
        if inside && self.fastest * segment.dt() <= 1.0 {
            let ends = (segment.state(), segment.end_state());
            self.begin(segment, segment.start, ends.0);
            self.piece(ends, &segment.drive(), (segment.start, segment.dt()));
        } else {
            self.visit_part(segment);
        }
    }
}

impl Search<'_> {
    /// A long segment, or one that is only partly in the window.
    #[cold]
    fn visit_part(&mut self, segment: &Segment) {
        let (from, to) = (segment.start.max(self.begin), segment.end.min(self.end));
        let state = self.inside.states(segment, &[from])[0];
        let dt = segment.elapsed(from, to);
        let whole = self.run.oscillators.over(dt);
        self.begin(segment, from, &state);
        if self.fastest * dt <= 1.0 {
            let end = whole.apply(&state, &segment.drive());
            self.piece((&state, &end), &segment.drive(), (from, dt));
        } else {
            search_long(self, &state, &segment.drive(), (from, dt), &whole);
        }
    }
}

impl Run {
    /// True extremes of the given quantities between two times, between samples too.
    /// At a vertical step both sides count.
    ///
    /// # Errors
    /// Times not finite or in the wrong order, an overflow, or what `pulse` gives.
    pub fn extremes(
        &self,
        quantities: &[Quantity],
        (begin, end): (f64, f64),
        pulse: Pulse,
    ) -> Result<Vec<Extreme>> {
        self.check_times(&[begin, end])?;
        let forms: Vec<Form> = quantities.iter().flat_map(|quantity| Form::all(self, quantity)).collect();
        let bank = &self.oscillators;
        let heights = Heights::new(self, &forms);
        let has_lines = forms.iter().any(Form::has_line);
        let outputs: Vec<Output> = forms.into_iter().map(|form| Output::new(form, bank)).collect();
        let mut search = Search {
            run: self,
            screens: outputs.chunks(LANES).map(Screen::new).collect(),
            lengths: Lengths::new(bank),
            outputs,
            heights,
            has_lines,
            fastest: bank.omega.0.into_iter().fold(0.0, f64::max),
            begin,
            end,
            last: State::REST,
            inside: Inside::new(self),
            watch: Watch::new(pulse),
        };
        march(self, end, &mut search);
        search.watch.outcome?;
        // What is no longer finite stays so, and sets no record: the last state tells of all.
        let last = search.last.d.dot(search.last.d) + search.last.v.dot(search.last.v);
        let records: Vec<Extreme> = search.outputs.iter().map(|o| o.record.within(begin, end)).collect();
        if !last.is_nan() && records.iter().all(|r| (r.max - r.min).is_finite()) {
            Ok(records)
        } else {
            Err(Error::Overflow { quantity: "an extreme", time: end })
        }
    }
}
