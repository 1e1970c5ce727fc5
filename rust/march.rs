//! The march: knots in time → modal states, a block of knots at a time.

use multiversion::multiversion;

use crate::distance::Distance;
use crate::knots::{Knots, SLOTS};
use crate::lanes::{LANES, Lanes};
use crate::pages::Pages;
use crate::path::{Path, Trail};
use crate::run::Run;
use crate::scout::{Supply, with_knots};
use crate::track::Track;
use crate::transition::{Drive, State};

/// A block of knots and the states there.
#[derive(Clone, Debug)]
pub(crate) struct KnotBlock<'a> {
    path: Path<'a>,
    /// Time at which the first segment of the block begins: before all time in the first block.
    start: f64,
    /// State just after each knot.
    state: Box<[State; SLOTS]>,
    /// State just before each knot, unless the block is `plain`.
    before: Box<[State; SLOTS]>,
    /// Whether nothing happens at the knots but changes of slope.
    plain: bool,
    short_bumps: ShortBumps,
}

impl<'a> KnotBlock<'a> {
    /// Before the first block: at rest in equilibrium on the first elevations.
    fn new(run: &'a Run) -> Self {
        Self {
            path: Path::new(run),
            start: f64::NEG_INFINITY,
            state: Box::new([State::REST; SLOTS]),
            before: Box::new([State::REST; SLOTS]),
            plain: false,
            short_bumps: ShortBumps::new(run),
        }
    }

    /// Goes on to the next block, whose states are yet to be marched to; whether it has knots.
    fn advance(&mut self, supply: &mut Supply<'a>) -> bool {
        let Self { path, start, state, plain, short_bumps, .. } = self;
        let last = path.knots.len - 1;
        *start = if last > 0 { path.knots.time[last] } else { *start };
        state[0] = state[last];
        path.advance(supply);
        *plain = path.knots.steps.is_empty() && !path.run.damping_input && !short_bumps.watching;
        path.knots.len > 1
    }

    /// Times of the knots after slot 0.
    pub fn times(&self) -> &[f64] {
        &self.path.knots.time[1..self.path.knots.len]
    }

    /// Time at which the first segment begins.
    pub fn start(&self) -> f64 {
        self.start
    }

    /// Whether there is a vertical step anywhere in the run.
    pub fn has_steps(&self) -> bool {
        self.path.knots.has_steps
    }

    /// Whether nothing happens at the knots but changes of slope.
    pub fn is_plain(&self) -> bool {
        self.plain
    }

    /// States just after the knots, that in which the first segment begins before them.
    pub fn states(&self) -> &[State] {
        &self.state[..self.path.knots.len]
    }

    /// The first segment that ends in this block.
    pub fn first_segment(&self) -> Segment<'_> {
        self.segment(0, self.path.knots.time[1])
    }

    /// The segments that end in this block.
    pub fn segments(&self) -> impl Iterator<Item = Segment<'_>> {
        (1..self.path.knots.len).map(|end| self.segment(end - 1, self.path.knots.time[end]))
    }

    #[inline(always)]
    fn segment(&self, slot: usize, end: f64) -> Segment<'_> {
        let start = if slot == 0 { self.start } else { self.path.knots.time[slot] };
        Segment { block: self, slot, start, end }
    }

    /// Marches through the block, and keeps the states.
    pub fn march(&mut self) {
        march_block(self);
    }

    /// Marches through a plain block; only `trail` sees the states in which its segments begin.
    #[inline(always)]
    pub fn march_plain(&mut self, trail: &mut impl Trail) {
        self.state[self.path.knots.len - 1] = self.path.follow(self.state[0], trail);
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

    /// Takes in a state just after a knot; where a level stretch begins, corrects d if p tells it better.
    fn correct(&mut self, knots: &Knots, slot: usize, state: &mut State, level: bool) {
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
fn march_block(block: &mut KnotBlock) {
    let KnotBlock { path, state, before, plain, short_bumps, .. } = block;
    let path = &*path;
    let Path { run, knots, .. } = path;
    if *plain {
        state[knots.len - 1] = path.follow(state[0], &mut **state);
        return;
    }
    let (mut now, mut drive, mut step) = (state[0], path.drive(0), 0);
    for slot in 1..knots.len {
        now = path.transition(slot).apply(&now, &drive);
        before[slot] = now;
        while let Some(jump) = knots.steps.get(step).filter(|jump| jump.slot == slot) {
            // The runway jumps, the aircraft does not; a damper in between gives it a blow.
            let track = &run.tracks[jump.track];
            now.d -= track.lift * jump.height;
            now.v += track.drag * run.oscillators.omega * jump.height;
            step += 1;
            short_bumps.was_level = false;
        }
        drive = path.drive(slot);
        if short_bumps.watching {
            short_bumps.correct(knots, slot, &mut now, drive.beta == Lanes::ZERO);
        }
        state[slot] = now;
    }
}

/// One segment: from a knot, crossed, to the next. The first begins before all time, at rest;
/// the last never ends.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Segment<'a> {
    block: &'a KnotBlock<'a>,
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
        self.block.path.drive(self.slot)
    }

    /// How long it is, to the last digit.
    #[inline(always)]
    pub fn dt(&self) -> f64 {
        self.block.path.knots.dt[self.slot + 1]
    }

    /// Whether a vertical step begins at its end.
    #[inline(always)]
    pub fn ends_at_step(&self) -> bool {
        self.block.path.knots.has_steps && self.block.path.knots.begins_step(self.slot + 1)
    }

    /// Slope under a track.
    #[inline(always)]
    pub fn slope(&self, track: usize) -> f64 {
        self.block.path.knots.slope(self.slot, track)
    }

    /// Elevation under a track: at its last breakpoint, and the climb since.
    pub fn elevation(&self, track: usize, time: f64) -> (f64, f64) {
        self.block.path.knots.elevation(self.slot, track, self.distance(time))
    }

    /// Distance rolled by `time`; at the rounded time of a knot, that knot itself.
    fn distance(&self, time: f64) -> Distance {
        if time <= self.start {
            self.begins_at()
        } else if time >= self.end {
            self.ends_at()
        } else {
            Distance::product(time, self.block.path.run.speed)
        }
    }

    /// Time between two instants, to the last digit.
    pub fn elapsed(&self, from: f64, to: f64) -> f64 {
        (self.distance(to).minus(self.distance(from)) / self.block.path.run.speed).max(0.0)
    }

    /// The knot at which it begins.
    #[inline(always)]
    pub fn begins_at(&self) -> Distance {
        self.block.path.knots.distance(self.slot)
    }

    /// The knot at which it ends.
    #[inline(always)]
    pub fn ends_at(&self) -> Distance {
        self.block.path.knots.distance(self.slot + 1)
    }
}

/// Sees every segment of a march.
pub(crate) trait Visitor: Sized {
    /// One segment. The last one has no end.
    fn visit(&mut self, segment: &Segment);

    /// The segments that end in a block, which is yet to be marched through.
    fn visit_block(&mut self, block: &mut KnotBlock) {
        block.march();
        visit_each(self, block);
    }

    /// Memory that will be written to: a row a knot, or more.
    fn pages(&self) -> Pages {
        Pages::default()
    }

    /// Whether to go on after `work` more knots.
    fn go_on(&mut self, work: u32) -> bool;
}

/// Visits the segments of a block that has been marched through.
#[multiversion(targets("x86_64+avx2"))]
pub(crate) fn visit_each<V: Visitor>(visitor: &mut V, block: &KnotBlock) {
    for segment in block.segments() {
        visitor.visit(&segment);
    }
}

/// Visits every segment that begins at or before `end` (and a few more), unless stopped.
pub(crate) fn march(run: &Run, end: f64, visitor: &mut impl Visitor) {
    let pages = visitor.pages();
    with_knots(run, end, pages, |supply| march_over(run, end, visitor, supply));
}

fn march_over<'a>(run: &'a Run, end: f64, visitor: &mut impl Visitor, supply: &mut Supply<'a>) {
    let mut block = KnotBlock::new(run);
    while block.advance(supply) {
        visitor.visit_block(&mut block);
        let past = block.times().last().is_some_and(|&last| last > end);
        if past || !visitor.go_on(SLOTS as u32) {
            return;
        }
    }
    visitor.visit(&block.segment(0, f64::INFINITY));
}
