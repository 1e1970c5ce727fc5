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

mod climb;
mod lengths;
mod output;
mod screen;

use self::lengths::{departure, steady};
use self::screen::Screen;
use crate::error::{Error, Result};
use crate::inside::Inside;
use crate::lanes::LANES;
use crate::march::{Segment, Visitor, march};
use crate::readout::{Form, Heights, Quantity};
use crate::run::Run;
use crate::transition::{Drive, State, Transition};
use crate::watch::{Pulse, Watch};

pub(crate) use self::lengths::Lengths;
pub(crate) use self::output::{Hunt, Output};

/// Pieces of a long segment whose ends are known before any is searched: a few cycles.
const BATCH: usize = 32;

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

    /// With both times in [`begin`, `end`]: they are sums, which rounding may take outside.
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

/// The search over all outputs, piece by piece, stretch by stretch of time.
struct Search<'a> {
    run: &'a Run,
    hunts: Vec<Hunt<'a>>,
    screens: Vec<Screen>,
    lengths: Lengths,
    heights: Heights,
    /// Whether the straight-line parts change from segment to segment.
    has_lines: bool,
    fastest: f64,
    /// The stretch at present, and where those after it end.
    begin: f64,
    end: f64,
    later: &'a [f64],
    /// Records of the stretches that are over.
    found: Vec<Vec<Extreme>>,
    last: State,
    inside: Inside<'a>,
    watch: Watch<'a>,
}

impl Search<'_> {
    /// Ends a stretch, unless it is the last.
    #[cold]
    fn turn_to_next(&mut self) -> bool {
        let Some((&end, later)) = self.later.split_first() else { return false };
        self.end_stretch();
        (self.begin, self.end, self.later) = (self.end, end, later);
        for hunt in &mut self.hunts {
            *hunt = Hunt::new(hunt.output);
        }
        self.screens = self.hunts.chunks(LANES).map(Screen::new).collect();
        true
    }

    fn end_stretch(&mut self) {
        self.found.push(self.hunts.iter().map(|hunt| hunt.record.within(self.begin, self.end)).collect());
    }

    /// A long segment, or one that is only partly in the stretch.
    #[cold]
    fn visit_part(&mut self, segment: &Segment) {
        let (from, to) = (segment.start.max(self.begin), segment.end.min(self.end));
        let state = self.inside.states(segment, &[from])[0];
        let dt = segment.elapsed(from, to);
        let whole = self.run.oscillators.over(dt);
        self.enter(segment, from, &state);
        if self.fastest * dt <= 1.0 {
            let end = whole.apply(&state, &segment.drive());
            self.piece((&state, &end), &segment.drive(), (from, dt));
        } else {
            search_long(self, &state, &segment.drive(), (from, dt), &whole);
        }
    }

    /// Takes up a segment at `time`: its straight-line parts, and the values there.
    #[inline(always)]
    fn enter(&mut self, segment: &Segment, time: f64, state: &State) {
        if self.has_lines {
            self.heights.read(segment, time);
            for hunt in &mut self.hunts {
                hunt.line = hunt.output.form.line(segment, &self.heights);
            }
        }
        for (screen, hunts) in self.screens.iter_mut().zip(self.hunts.chunks_mut(LANES)) {
            if self.has_lines {
                screen.read_lines(hunts);
            }
            screen.start = screen.values(state, 0.0);
            if screen.start.any_above(screen.high) || screen.low.any_above(screen.start) {
                for hunt in &mut *hunts {
                    hunt.offer(state, time, 0.0);
                }
                screen.read_records(hunts);
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
        for hunt in &mut self.hunts {
            hunt.offer(&end, time, dt);
        }
        for (screen, hunts) in self.screens.iter_mut().zip(self.hunts.chunks(LANES)) {
            screen.read_records(hunts);
        }
    }

    /// Whether the amplitudes left can still set a record between `tau` and `dt`.
    fn reachable(&self, state: &State, drive: &Drive, (tau, dt): (f64, f64)) -> bool {
        let bank = &self.run.oscillators;
        let r = self.lengths.of(departure(bank, drive, state));
        let steady = steady(bank, drive);
        self.hunts.iter().any(|hunt| {
            let (bottom, top) = hunt.range(steady, r, (tau, dt));
            top > hunt.record.max || bottom < hunt.record.min
        })
    }

    /// One piece of at most a radian.
    #[inline(always)]
    fn piece(&mut self, ends: (&State, &State), drive: &Drive, (time, h): (f64, f64)) {
        let bank = (&self.run.oscillators, &self.lengths);
        for (screen, hunts) in self.screens.iter_mut().zip(self.hunts.chunks_mut(LANES)) {
            let values = (screen.start, screen.values(ends.1, h));
            screen.start = values.1;
            screen.check(hunts, bank, (ends, values), drive, (time, 0.0, h), &mut self.watch);
        }
    }

    /// Pieces of length `h` from one state to the next, the first `tau` after `time`.
    #[inline(always)]
    fn pieces(&mut self, states: &[State], drive: &Drive, time: f64, tau: impl Fn(usize) -> f64, h: f64) {
        let bank = (&self.run.oscillators, &self.lengths);
        for (screen, hunts) in self.screens.iter_mut().zip(self.hunts.chunks_mut(LANES)) {
            let mut values = [screen.start; BATCH + 1];
            for (piece, state) in states[1..].iter().enumerate() {
                values[piece + 1] = screen.values(state, tau(piece) + h);
            }
            screen.start = values[states.len() - 1];
            screen.look_ahead(&values[1..states.len()]);
            for (piece, ends) in states.windows(2).enumerate() {
                let values = (values[piece], values[piece + 1]);
                screen.check(
                    hunts,
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
    #[inline(always)]
    fn visit(&mut self, segment: &Segment) {
        // Of a vertical step only the two sides count, not what lies between.
        if segment.end < self.begin || segment.start > self.end || segment.start == segment.end {
            return;
        }
        self.last = *segment.state();
        let inside = segment.start >= self.begin && segment.end <= self.end;
        if inside && self.fastest * segment.dt() <= 1.0 {
            let ends = (segment.state(), segment.end_state());
            self.enter(segment, segment.start, ends.0);
            self.piece(ends, &segment.drive(), (segment.start, segment.dt()));
        } else {
            self.visit_part(segment);
        }
        while segment.end >= self.end && self.turn_to_next() {
            if segment.end > self.begin {
                self.visit_part(segment);
            }
        }
    }

    fn go_on(&mut self, work: u32) -> bool {
        self.watch.go_on(work)
    }
}

#[multiversion(targets("x86_64+avx2"))]
fn search_long(search: &mut Search, from: &State, drive: &Drive, span: (f64, f64), whole: &Transition) {
    search.long(from, drive, span, whole);
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
        Ok(self.extremes_between(quantities, &[begin, end], pulse)?.swap_remove(0))
    }

    /// The same for each stretch between two successive times of a list: a list a stretch. Of a vertical
    /// step where one stretch ends and the next begins, each has its own side.
    ///
    /// # Errors
    /// Fewer than two times, or as for [`Run::extremes`].
    pub fn extremes_between(
        &self,
        quantities: &[Quantity],
        times: &[f64],
        pulse: Pulse,
    ) -> Result<Vec<Vec<Extreme>>> {
        let &[begin, first, ref later @ ..] = times else {
            return Err(Error::TooShort { argument: "times", found: times.len(), least: 2 });
        };
        self.check_times(times)?;
        let last = times[times.len() - 1];
        let forms: Vec<Form> = quantities.iter().flat_map(|quantity| Form::all(self, quantity)).collect();
        let bank = &self.oscillators;
        let heights = Heights::new(self, &forms);
        let has_lines = forms.iter().any(Form::has_line);
        let outputs: Vec<Output> = forms.into_iter().map(|form| Output::new(form, bank)).collect();
        let hunts: Vec<Hunt> = outputs.iter().map(Hunt::new).collect();
        let mut search = Search {
            run: self,
            screens: hunts.chunks(LANES).map(Screen::new).collect(),
            lengths: Lengths::new(bank),
            hunts,
            heights,
            has_lines,
            fastest: bank.fastest(),
            begin,
            end: first,
            later,
            found: Vec::with_capacity(times.len() - 1),
            last: State::REST,
            inside: Inside::new(self),
            watch: Watch::new(pulse),
        };
        march(self, last, &mut search);
        search.end_stretch();
        search.watch.outcome?;
        // What is no longer finite stays so, and sets no record: the last state tells of all.
        let rest = search.last.d.dot(search.last.d) + search.last.v.dot(search.last.v);
        let finite = |record: &Extreme| (record.max - record.min).is_finite();
        if !rest.is_nan() && search.found.iter().flatten().all(finite) {
            Ok(search.found)
        } else {
            Err(Error::Overflow { quantity: "an extreme", time: last })
        }
    }
}
