//! The march: knots in time → modal states, a block of knots at a time.

use multiversion::multiversion;

use crate::distance::Distance;
use crate::knots::{Knots, SLOTS};
use crate::lanes::{LANES, Lanes};
use crate::run::{Run, Track};
use crate::transition::{Drive, Oscillators, State, Transition};

/// How many transitions are kept.
const KEPT: usize = 32;

/// Transitions kept by the bits of their Δt. Nominally equal segments differ by the rounding
/// of their stations and then take a handful of values between them; a lag between gears
/// splits every segment in the same two.
#[derive(Clone, Debug)]
struct Kept([(f64, Transition); KEPT]);

impl Kept {
    fn new(bank: &Oscillators) -> Self {
        Self([(0.0, bank.over(0.0)); KEPT])
    }

    /// Place of the transition over `dt`, which is likely that of the last one.
    #[inline(always)]
    fn place(&mut self, bank: &Oscillators, dt: f64, last: usize) -> usize {
        if self.0[last % KEPT].0 == dt {
            return last % KEPT;
        }
        let place = (dt.to_bits().wrapping_mul(0x9E37_79B9_7F4A_7C15) >> 59) as usize % KEPT;
        if self.0[place].0 != dt {
            self.0[place] = (dt, bank.over(dt));
        }
        place
    }
}

/// A block of knots and the states there.
#[derive(Clone, Debug)]
pub(crate) struct Block<'a> {
    run: &'a Run,
    knots: Knots<'a>,
    /// Time at which the first segment of the block begins: before all time in the first block.
    start: f64,
    /// State just after each knot.
    state: [State; SLOTS],
    /// State just before each knot, unless the block is `plain`.
    before: [State; SLOTS],
    /// Whether nothing happens at the knots but changes of slope.
    plain: bool,
    /// What drives the modes after each knot.
    beta: [Lanes; SLOTS],
    gamma: [Lanes; SLOTS],
    kept: Kept,
    short_bumps: ShortBumps,
}

impl<'a> Block<'a> {
    /// The first block: at rest in equilibrium on the first elevations.
    fn new(run: &'a Run) -> Self {
        let rest = State { d: Lanes::ZERO, v: Lanes::ZERO, p: Lanes::ZERO };
        let mut block = Self {
            run,
            knots: Knots::new(run),
            start: f64::NEG_INFINITY,
            state: [rest; SLOTS],
            before: [rest; SLOTS],
            plain: true,
            beta: [Lanes::ZERO; SLOTS],
            gamma: [Lanes::ZERO; SLOTS],
            kept: Kept::new(&run.oscillators),
            short_bumps: ShortBumps::new(run),
        };
        march_block(&mut block);
        block
    }

    /// Goes on to the next block; whether there is one.
    fn advance(&mut self) -> bool {
        let last = self.knots.len - 1;
        self.start = if last > 0 { self.knots.time[last] } else { self.start };
        self.state[0] = self.state[last];
        (self.beta[0], self.gamma[0]) = (self.beta[last], self.gamma[last]);
        let more = self.knots.advance();
        march_block(self);
        more
    }

    /// Times of the knots after slot 0.
    pub fn times(&self) -> &[f64] {
        &self.knots.time[1..self.knots.len]
    }

    /// Time at which the first segment begins.
    pub fn start(&self) -> f64 {
        self.start
    }

    /// States in which its segments begin.
    pub fn states(&self) -> &[State] {
        &self.state[..self.knots.len - 1]
    }

    /// Whether nothing happens at the knots but changes of slope.
    pub fn is_plain(&self) -> bool {
        self.plain && !self.knots.has_steps
    }

    /// The segments that end in this block.
    pub fn segments(&self) -> impl Iterator<Item = Segment<'_>> {
        (1..self.knots.len).map(|end| self.segment(end - 1, self.knots.time[end]))
    }

    #[inline(always)]
    fn segment(&self, slot: usize, end: f64) -> Segment<'_> {
        let start = if slot == 0 { self.start } else { self.knots.time[slot] };
        Segment { block: self, slot, start, end }
    }
}

/// Watches for bumps so short that the aircraft hardly moves on them.
///
/// Such a bump takes d to its height and back and leaves the rounding of that height in it, while
/// p knows the small motion to its own precision. The two differ by the static position: where
/// that is the more exact way, d at the start of a level stretch is p less it. Once the aircraft
/// has moved by a thousandth of what the profiles lift it by, there is nothing left to gain.
#[derive(Clone, Debug)]
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

    fn see(&mut self, knots: &Knots, slot: usize, state: &mut State, level: bool) {
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
    }
}

/// Fills a block with states, from the one in slot 0 on.
#[multiversion(targets("x86_64+avx2"))]
fn march_block(block: &mut Block) {
    let Block { run, knots, state, before, beta, gamma, kept, .. } = block;
    let (run, bank, len) = (*run, &run.oscillators, knots.len);
    beta[1..len].fill(Lanes::ZERO);
    for (track, slope) in run.tracks.iter().zip(&knots.slope) {
        for (beta, slope) in beta[1..len].iter_mut().zip(&slope[1..len]) {
            *beta += track.climb * *slope;
        }
    }
    block.plain = knots.steps.is_empty() && !run.damping_input && !block.short_bumps.watching;
    let (mut now, mut place) = (state[0], 0);
    if block.plain {
        let segments = knots.dt[1..len].iter().zip(&beta[..len - 1]);
        for ((dt, beta), state) in segments.zip(&mut state[1..len]) {
            place = kept.place(bank, *dt, place);
            now = kept.0[place].1.follow(&now, *beta);
            *state = now;
        }
        return;
    }
    let mut step = 0;
    for slot in 1..len {
        place = kept.place(bank, knots.dt[slot], place);
        now = kept.0[place].1.apply(&now, &Drive { beta: beta[slot - 1], gamma: gamma[slot - 1] });
        before[slot] = now;
        while let Some(jump) = knots.steps.get(step).filter(|jump| jump.slot == slot) {
            // The runway jumps, the aircraft does not; a damper in between gives it a blow.
            let track = &run.tracks[jump.track];
            now.d -= track.lift * jump.height;
            now.v += track.drag * bank.omega * jump.height;
            step += 1;
        }
        if run.damping_input {
            gamma[slot] = Lanes::ZERO;
            for (track, slope) in run.tracks.iter().zip(&knots.slope) {
                gamma[slot] += track.drag * (slope[slot] * run.speed);
            }
        }
        if block.short_bumps.watching {
            block.short_bumps.see(knots, slot, &mut now, beta[slot] == Lanes::ZERO);
        }
        state[slot] = now;
    }
}

/// One segment: from a knot, crossed, to the next. The first begins before all time, at rest;
/// the last never ends.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Segment<'a> {
    block: &'a Block<'a>,
    /// Slot of the knot at which it begins.
    slot: usize,
    /// Rounded time of the knot at which it begins.
    pub start: f64,
    /// Rounded time of the knot at which it ends.
    pub end: f64,
}

impl<'a> Segment<'a> {
    /// State just after the knot at which it begins.
    #[inline(always)]
    pub fn state(&self) -> &'a State {
        &self.block.state[self.slot]
    }

    /// State just before the knot at which it ends.
    #[inline(always)]
    pub fn end_state(&self) -> &'a State {
        let states = if self.block.plain { &self.block.state } else { &self.block.before };
        &states[self.slot + 1]
    }

    /// What drives the modes on it.
    #[inline(always)]
    pub fn drive(&self) -> Drive {
        Drive { beta: self.block.beta[self.slot], gamma: self.block.gamma[self.slot] }
    }

    /// How long it is, to the last digit.
    #[inline(always)]
    pub fn dt(&self) -> f64 {
        self.block.knots.dt[self.slot + 1]
    }

    /// Whether a vertical step begins at its end.
    #[inline(always)]
    pub fn ends_at_step(&self) -> bool {
        self.block.knots.has_steps && self.block.knots.begins_step(self.slot + 1)
    }

    /// Slope under a track.
    #[inline(always)]
    pub fn slope(&self, track: usize) -> f64 {
        self.block.knots.slope[track][self.slot]
    }

    /// Elevation under a track: at its last breakpoint, and the climb since.
    pub fn elevation(&self, track: usize, time: f64) -> (f64, f64) {
        self.block.knots.elevation(self.slot, track, self.distance(time))
    }

    /// Distance rolled by `time`; at the rounded time of a knot, that knot itself.
    fn distance(&self, time: f64) -> Distance {
        if time <= self.start {
            self.block.knots.distance(self.slot)
        } else if time >= self.end {
            self.block.knots.distance(self.slot + 1)
        } else {
            Distance::product(time, self.block.run.speed)
        }
    }

    /// Time between two instants, to the last digit.
    pub fn elapsed(&self, from: f64, to: f64) -> f64 {
        (self.distance(to).minus(self.distance(from)) / self.block.run.speed).max(0.0)
    }

    /// State at `time`, just before the end of the segment if that is its end.
    pub fn state_at(&self, time: f64) -> State {
        if time <= self.start { *self.state() } else { state_after(self, time) }
    }

    /// State at a `time` after the start.
    #[inline(always)]
    pub fn state_between(&self, time: f64) -> State {
        let Block { run, knots, .. } = self.block;
        let past = time >= self.end;
        let now = if past { knots.distance(self.slot + 1) } else { Distance::product(time, run.speed) };
        let since = (now.minus(knots.distance(self.slot)) / run.speed).max(0.0);
        run.oscillators.over(since).apply(self.state(), &self.drive())
    }
}

#[multiversion(targets("x86_64+avx2"))]
fn state_after(segment: &Segment, time: f64) -> State {
    segment.state_between(time)
}

/// Sees every segment of a march.
pub(crate) trait Visitor {
    /// One segment. The last one has no end.
    fn visit(&mut self, segment: &Segment);

    /// The segments that end in a block.
    fn visit_block(&mut self, block: &Block) {
        for segment in block.segments() {
            self.visit(&segment);
        }
    }

    /// Whether to go on after `work` more knots.
    fn go_on(&mut self, work: u32) -> bool;
}

/// Visits every segment that begins at or before `end` (and a few more), unless stopped.
pub(crate) fn march(run: &Run, end: f64, visitor: &mut impl Visitor) {
    let mut block = Block::new(run);
    loop {
        visitor.visit_block(&block);
        let past = block.times().last().is_some_and(|&last| last > end);
        if past || !visitor.go_on(SLOTS as u32) {
            return;
        }
        if !block.advance() {
            break;
        }
    }
    visitor.visit(&block.segment(0, f64::INFINITY));
}
