//! The knots of all gears in the order in which they are met.
//!
//! They are put in order a block at a time: distances, times and lengths of segments then come out
//! of plain loops over arrays, and the march that consumes them is not held up by divisions.

use multiversion::multiversion;

use crate::distance::{Distance, Distances};
use crate::lanes::Lanes;
use crate::run::{Run, Track};
use crate::shared_knots::SharedKnots;

/// Slots of a block.
pub(crate) const SLOTS: usize = 64;

/// Breakpoints of one track looked ahead at.
const AHEAD: usize = 256;

/// One track's place on its profile.
#[derive(Clone, Debug)]
struct Cursor<'a> {
    x: &'a [f64],
    lag: Distance,
    /// Breakpoints before the ones looked ahead at.
    base: usize,
    /// How many breakpoints after these have been passed; AHEAD and more call for another look.
    at: usize,
    /// Where they are met; infinite past the last.
    ahead: Distances<AHEAD>,
}

impl<'a> Cursor<'a> {
    fn new(track: &'a Track) -> Self {
        let (x, lag) = (track.profile.knots(), track.lag);
        let mut cursor = Self { x, lag, base: 0, at: 0, ahead: Distances::INFINITE };
        cursor.look_ahead();
        cursor
    }

    /// Where it meets its next breakpoint.
    #[inline(always)]
    fn next(&self) -> Distance {
        self.ahead.get(self.at % AHEAD)
    }

    #[inline(always)]
    fn has_more(&self) -> bool {
        self.passed() < self.x.len()
    }

    /// How many breakpoints have been passed.
    #[inline(always)]
    fn passed(&self) -> usize {
        self.base + self.at
    }

    #[inline(always)]
    fn look_ahead(&mut self) {
        self.base += self.at;
        self.at = 0;
        let x = self.x.get(self.base..).unwrap_or(&[]);
        if let Some(x) = x.first_chunk::<AHEAD>() {
            self.ahead.shift(0, x, self.lag);
        } else {
            self.ahead = Distances::INFINITE;
            self.ahead.shift(0, x, self.lag);
        }
    }
}

/// A vertical step under the gears of a track.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Step {
    /// Slot of its knot.
    pub slot: usize,
    pub track: usize,
    pub height: f64,
}

/// Merges the tracks' breakpoints, a block of knots at a time.
///
/// A vertical step makes two knots at one distance. Slot 0 of a block is the last knot of the
/// block before; what lies before the first knot of all counts as one, at its distance.
#[derive(Clone, Debug)]
pub(crate) struct Knots<'a> {
    run: &'a Run,
    cursors: Vec<Cursor<'a>>,
    /// Slots in use.
    pub len: usize,
    distance: Distances<SLOTS>,
    /// Rounded times: the names of instants that are known more exactly. Infinite in the slot
    /// after the last knot of the run.
    pub time: [f64; SLOTS + 1],
    /// Time from the knot before.
    pub dt: [f64; SLOTS],
    /// A row a track: how many of its breakpoints have been passed after each knot.
    pub passed: Vec<[usize; SLOTS]>,
    /// Vertical steps in the block, in the order of their slots.
    pub steps: Vec<Step>,
    /// Whether there is a vertical step anywhere.
    pub has_steps: bool,
}

impl<'a> Knots<'a> {
    /// The first block.
    pub fn new(run: &'a Run) -> Self {
        let cursors: Vec<Cursor> = run.tracks.iter().map(Cursor::new).collect();
        let mut knots = Self {
            run,
            len: 1,
            distance: Distances::INFINITE,
            time: [f64::INFINITY; SLOTS + 1],
            dt: [0.0; SLOTS],
            passed: vec![[0; SLOTS]; cursors.len()],
            steps: Vec::new(),
            has_steps: run.tracks.iter().any(|track| track.profile.steps() > 0),
            cursors,
        };
        // No time passes before the first knot.
        let first = knots.cursors.iter().fold(Distance::INFINITE, |d, cursor| d.shorter(cursor.ahead.get(0)));
        knots.distance.set(0, first);
        knots.advance();
        knots
    }

    /// Goes on to the next block; whether there is one.
    pub fn advance(&mut self) -> bool {
        next_block(self);
        self.find_steps();
        self.len > 1
    }

    /// Finds the vertical steps that end at the knots of the block.
    fn find_steps(&mut self) {
        self.steps.clear();
        if !self.has_steps {
            return;
        }
        for slot in 1..self.len {
            for track in 0..self.passed.len() {
                let height = self.step(slot, track, 0);
                if height != 0.0 {
                    self.steps.push(Step { slot, track, height });
                }
            }
        }
    }

    /// Height of a vertical step that ends so many breakpoints after the one a track meets at the
    /// knot of a slot.
    fn step(&self, slot: usize, track: usize, after: usize) -> f64 {
        let passed = &self.passed[track];
        if passed[slot] > passed[slot - 1] {
            self.run.tracks[track].profile.step_before(passed[slot] + after)
        } else {
            0.0
        }
    }

    /// Whether a vertical step begins at the knot of a slot; its end is the next knot.
    pub fn begins_step(&self, slot: usize) -> bool {
        slot < self.len && (0..self.passed.len()).any(|track| self.step(slot, track, 1) != 0.0)
    }

    /// The knot of a slot.
    pub fn distance(&self, slot: usize) -> Distance {
        self.distance.get(slot)
    }

    /// Slope under a track after the knot of a slot.
    #[inline(always)]
    pub fn slope(&self, slot: usize, track: usize) -> f64 {
        self.run.tracks[track].profile.slopes()[self.passed[track][slot]]
    }

    /// How far the static position of each mode has risen by the knot of a slot since the start.
    pub fn risen(&self, slot: usize) -> Lanes {
        let tracks = self.run.tracks.iter().enumerate();
        tracks.fold(Lanes::ZERO, |sum, (index, track)| {
            let (base, climb) = self.elevation(slot, index, self.distance(slot));
            sum + track.lift * ((base - track.profile.z()[0]) + climb)
        })
    }

    /// Elevation under a track at a distance between the knot of a slot and the next, as that of
    /// the last breakpoint and the climb since: the difference of two tracks high above the datum
    /// keeps its digits only if these are not added up first.
    pub fn elevation(&self, slot: usize, track: usize, distance: Distance) -> (f64, f64) {
        let passed = self.passed[track][slot];
        let Track { profile, lag, .. } = &self.run.tracks[track];
        let base = profile.z()[passed.saturating_sub(1)];
        match self.slope(slot, track) {
            0.0 => (base, 0.0),
            slope => (base, slope * distance.minus(lag.plus(profile.x()[passed - 1]))),
        }
    }
}

/// Fills the block with the next knots.
#[multiversion(targets("x86_64+avx2"))]
fn next_block(knots: &mut Knots) {
    let last = knots.len - 1;
    knots.distance.set(0, knots.distance.get(last));
    for passed in &mut knots.passed {
        passed[0] = passed[last];
    }
    knots.len = match &knots.run.shared_knots {
        Some(shared) if knots.cursors[shared.foremost].has_more() => follow(knots, shared),
        // The number of tracks as a constant where it is small: its loops unroll.
        _ => match knots.cursors.len() {
            1 => merge_tracks::<1>(knots),
            2 => merge_tracks::<2>(knots),
            3 => merge_tracks::<3>(knots),
            _ => merge_tracks::<0>(knots),
        },
    };
    let speed = knots.run.speed;
    knots.distance.divide(speed, &mut knots.time, &mut knots.dt);
    knots.time[knots.len] = f64::INFINITY;
}

/// The next knots of the foremost track, which are those of all others too; gives the slots in use.
#[inline(always)]
fn follow(knots: &mut Knots, shared: &SharedKnots) -> usize {
    let foremost = &knots.cursors[shared.foremost];
    let from = foremost.passed();
    let x = &foremost.x[from..];
    let count = x.len().min(SLOTS - 1);
    knots.distance.shift(1, &x[..count], foremost.lag);
    for ((cursor, passed), &apart) in knots.cursors.iter_mut().zip(&mut knots.passed).zip(&shared.apart) {
        // It waits, moves on with the foremost, and has moved on to its last.
        let begin = apart.saturating_sub(from).min(count);
        let end = (apart + cursor.x.len()).saturating_sub(from).min(count);
        let (waiting, rest) = passed[1..=count].split_at_mut(begin);
        let (moving, done) = rest.split_at_mut(end - begin);
        waiting.fill(0);
        let so_far = (from + begin).wrapping_sub(apart);
        for (slot, passed) in moving.iter_mut().enumerate() {
            *passed = so_far.wrapping_add(slot + 1);
        }
        done.fill(cursor.x.len());
        cursor.at += end - begin;
    }
    count + 1
}

/// Merges `N` tracks, all for `N` = 0, from slot 1 on; gives the slots in use.
#[inline(always)]
fn merge_tracks<const N: usize>(knots: &mut Knots) -> usize {
    let tracks = if N == 0 { knots.cursors.len() } else { N };
    let cursors = &mut knots.cursors[..tracks];
    let passed = &mut knots.passed[..tracks];
    let mut slot = 1;
    while slot < SLOTS {
        for cursor in cursors.iter_mut().filter(|cursor| cursor.at >= AHEAD) {
            cursor.look_ahead();
        }
        // No knot passes more than one breakpoint a track: so many need no look ahead.
        let sure = cursors.iter().map(|cursor| AHEAD - cursor.at).min().unwrap_or(0).min(SLOTS - slot);
        if let Some(first) = together(cursors, sure) {
            let next = cursors[first].next();
            knots.distance.copy(slot, &cursors[first].ahead, cursors[first].at, sure);
            for (cursor, passed) in cursors.iter_mut().zip(&mut *passed) {
                let (so_far, passes) = (cursor.passed(), usize::from(cursor.next() == next));
                for (count, passed) in passed[slot..slot + sure].iter_mut().enumerate() {
                    *passed = so_far + passes * (count + 1);
                }
                cursor.at += passes * sure;
            }
        } else {
            for slot in slot..slot + sure {
                let mut knot = Distance::INFINITE;
                for cursor in &*cursors {
                    knot = knot.shorter(cursor.next());
                }
                if knot == Distance::INFINITE {
                    return slot;
                }
                for track in 0..tracks {
                    let cursor = &mut cursors[track];
                    cursor.at += usize::from(cursor.next() == knot);
                    passed[track][slot] = cursor.passed();
                }
                knots.distance.set(slot, knot);
            }
        }
        slot += sure;
    }
    SLOTS
}

/// The track whose next `count` breakpoints are the next knots of all, if one is: the others meet
/// theirs where it does, or later. A grid whose lag is a whole number of spacings, gears side by
/// side, or the stretch that only the foremost or the last gear has bumps on.
#[inline(always)]
fn together(cursors: &[Cursor], count: usize) -> Option<usize> {
    let mut first = 0;
    for track in 1..cursors.len() {
        if cursors[track].next().is_before(cursors[first].next()) {
            first = track;
        }
    }
    let Cursor { ahead, at, .. } = &cursors[first];
    let last = ahead.get(at + count - 1);
    let mut all = last != Distance::INFINITE;
    for (track, cursor) in cursors.iter().enumerate() {
        all = all
            && (track == first
                || last.is_before(cursor.next())
                || ahead.same(*at, &cursor.ahead, cursor.at, count));
    }
    all.then_some(first)
}
