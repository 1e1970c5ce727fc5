//! The march: knots in time → modal states. The segment loop, nothing else.

use multiversion::multiversion;

use crate::distance::Distance;
use crate::knots::{Knots, SLOTS};
use crate::lanes::{LANES, Lanes};
use crate::run::{Run, Track};
use crate::transition::{Drive, Oscillators, State, Transition};

/// Transitions kept by the bits of their Δt. Nominally equal segments differ by the rounding
/// of their stations and then take a handful of values between them; a lag between gears
/// splits every segment in the same two.
const KEPT: usize = 64;

/// One segment: from a knot, crossed, to the next. The first begins before all time, at rest;
/// the last never ends.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Segment<'a> {
    run: &'a Run,
    knots: &'a Knots<'a>,
    /// Slot of the knot at which it begins.
    slot: usize,
    /// State just after that knot.
    pub state: State,
    /// What drives the modes until the next.
    pub drive: Drive,
    /// Rounded time of the knot at which it begins.
    pub start: f64,
    /// Rounded time of the knot at which it ends.
    pub end: f64,
    /// How long it is, to the last digit.
    pub dt: f64,
}

impl Segment<'_> {
    /// Whether a vertical step begins at its end.
    #[inline(always)]
    pub fn ends_at_step(&self) -> bool {
        self.knots.has_steps && self.knots.begins_step(self.slot + 1)
    }

    /// Slope under a track.
    #[inline(always)]
    pub fn slope(&self, track: usize) -> f64 {
        self.knots.slope[track][self.slot]
    }

    /// Elevation under a track: at its last breakpoint, and the climb since.
    pub fn elevation(&self, track: usize, time: f64) -> (f64, f64) {
        self.knots.elevation(self.slot, track, self.distance(time))
    }

    /// Distance rolled by `time`; at the rounded time of a knot, that knot itself.
    fn distance(&self, time: f64) -> Distance {
        if time <= self.start {
            self.knots.distance(self.slot)
        } else if time >= self.end {
            self.knots.distance(self.slot + 1)
        } else {
            Distance::product(time, self.run.speed)
        }
    }

    /// Time between two instants, to the last digit.
    pub fn elapsed(&self, from: f64, to: f64) -> f64 {
        (self.distance(to).minus(self.distance(from)) / self.run.speed).max(0.0)
    }

    /// State at `time`, just before the end of the segment if that is its end.
    #[inline(always)]
    pub fn state_at(&self, time: f64) -> State {
        if time <= self.start {
            self.state
        } else {
            // By value: the segment loop keeps its state in registers.
            propagate(&self.run.oscillators, self.elapsed(self.start, time), self.state, self.drive)
        }
    }
}

#[multiversion(targets("x86_64+avx2"))]
fn propagate(bank: &Oscillators, dt: f64, state: State, drive: Drive) -> State {
    bank.over(dt).apply(&state, &drive)
}

/// Watches for bumps so short that the aircraft hardly moves on them.
///
/// Such a bump takes d to its height and back and leaves the rounding of that height in it, while
/// p knows the small motion to its own precision. The two differ by the static position: where
/// that is the more exact way, d at the start of a level stretch is p less it. Once the aircraft
/// has moved by a thousandth of what the profiles lift it by, there is nothing left to gain.
struct ShortBumps {
    /// Whether there may be something to gain.
    watching: bool,
    was_level: bool,
    enough: Lanes,
    /// Largest magnitudes so far: d and p err by the rounding of these.
    d: Lanes,
    p: Lanes,
}

impl ShortBumps {
    fn new(run: &Run) -> Self {
        let lifted = |sum: Lanes, track: &Track| sum + track.lift.abs() * track.profile.range();
        let enough = run.tracks.iter().fold(Lanes::ZERO, lifted) * 1e-3;
        Self { watching: true, was_level: true, enough, d: Lanes::ZERO, p: Lanes::ZERO }
    }

    #[cold]
    fn see(&mut self, knots: &Knots, slot: usize, mut state: State, level: bool) -> State {
        self.d = self.d.max(state.d.abs());
        self.p = self.p.max(state.p.abs());
        if level && !self.was_level {
            let risen = knots.risen(slot);
            let (other, error) = (state.p - risen, self.p + risen.abs());
            for i in 0..LANES {
                if error[i] < self.d[i] {
                    (state.d[i], self.d[i]) = (other[i], error[i]);
                }
            }
        }
        self.was_level = level;
        self.watching = self.enough.any_above(self.p);
        state
    }
}

/// Sees every segment of a march.
pub(crate) trait Visitor {
    /// `whole` is the transition over the whole segment, of no meaning for the first and last.
    fn visit(&mut self, segment: &Segment, whole: &Transition);

    /// Whether to go on after `work` more knots.
    fn go_on(&mut self, work: u32) -> bool;
}

/// Visits every segment that begins at or before `end`, with the transition over the whole of
/// it, unless stopped.
///
/// The march begins at rest in equilibrium on the first elevations.
#[inline(always)]
pub(crate) fn march(run: &Run, end: f64, visitor: &mut impl Visitor) {
    let bank = &run.oscillators;
    let rest = bank.over(0.0);
    let mut kept = [(0.0, rest); KEPT];
    let mut place = 0;
    let mut knots = Knots::new(run);
    let mut state = State { d: Lanes::ZERO, v: Lanes::ZERO, p: Lanes::ZERO };
    let mut drive = Drive { beta: Lanes::ZERO, gamma: Lanes::ZERO };
    let mut short_bumps = ShortBumps::new(run);
    let mut start = f64::NEG_INFINITY;
    loop {
        let mut step = 0;
        for slot in 1..knots.len {
            let dt = knots.dt[slot];
            if kept[place].0 != dt {
                place = (dt.to_bits().wrapping_mul(0x9E37_79B9_7F4A_7C15) >> 58) as usize % KEPT;
                if kept[place].0 != dt {
                    kept[place] = (dt, bank.over(dt));
                }
            }
            let whole = &kept[place].1;
            let end_of_segment = knots.time[slot];
            let segment =
                Segment { run, knots: &knots, slot: slot - 1, state, drive, start, end: end_of_segment, dt };
            visitor.visit(&segment, whole);
            start = end_of_segment;
            if start > end {
                return;
            }
            state = whole.apply(&state, &drive);
            while let Some(jump) = knots.steps.get(step).filter(|jump| jump.slot == slot) {
                // The runway jumps, the aircraft does not; a damper in between gives it a blow.
                let track = &run.tracks[jump.track];
                state.d -= track.lift * jump.height;
                state.v += track.drag * bank.omega * jump.height;
                step += 1;
            }
            drive.beta = Lanes::ZERO;
            for (track, slope) in run.tracks.iter().zip(&knots.slope) {
                drive.beta += track.climb * slope[slot];
            }
            if short_bumps.watching {
                state = short_bumps.see(&knots, slot, state, drive.beta == Lanes::ZERO);
            }
            if run.damping_input {
                drive.gamma = Lanes::ZERO;
                for (track, slope) in run.tracks.iter().zip(&knots.slope) {
                    drive.gamma += track.drag * (slope[slot] * run.speed);
                }
            }
        }
        if !visitor.go_on(SLOTS as u32) {
            return;
        }
        if !knots.advance() {
            break;
        }
    }
    let end = f64::INFINITY;
    visitor.visit(&Segment { run, knots: &knots, slot: 0, state, drive, start, end, dt: end }, &rest);
}
