//! The knots of all gears in the order in which they are met.
//!
//! They are merged a block at a time: distances, times and lengths of segments then come out
//! of plain loops over arrays, and the march that consumes them is not held up by divisions.

use crate::distance::Distance;
use crate::run::{Run, Track};

/// Slots of a block.
const SLOTS: usize = 128;

/// Breakpoints of one track looked ahead at.
const AHEAD: usize = 64;

/// One track's place on its profile.
#[derive(Clone, Debug)]
struct Cursor<'a> {
    track: &'a Track,
    /// Breakpoints before the ones looked ahead at.
    base: usize,
    /// How many of these have been passed.
    at: usize,
    /// Where they are met; infinite past the last.
    ahead: [Distance; AHEAD],
}

impl<'a> Cursor<'a> {
    fn new(track: &'a Track) -> Self {
        let mut cursor = Self { track, base: 0, at: 0, ahead: [Distance::INFINITE; AHEAD] };
        cursor.look_ahead();
        cursor
    }

    fn look_ahead(&mut self) {
        self.base += self.at;
        self.at = 0;
        let x = self.track.profile.knots().get(self.base..).unwrap_or(&[]);
        for (ahead, &x) in self.ahead.iter_mut().zip(x) {
            *ahead = self.track.lag.plus(x);
        }
        self.ahead[x.len().min(AHEAD)..].fill(Distance::INFINITE);
    }
}

/// A vertical step under the gears of a track.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Step {
    /// Slot of its knot.
    slot: usize,
    pub track: usize,
    pub height: f64,
}

/// Merges the tracks' breakpoints and hands them out one by one.
///
/// A vertical step makes two knots at one distance. Slot 0 of the block is the last knot of the
/// block before; what lies before the first knot of all counts as one.
#[derive(Clone, Debug)]
pub(crate) struct Knots<'a> {
    run: &'a Run,
    cursors: Vec<Cursor<'a>>,
    /// Slot of the next knot; the last one crossed is in the slot before it.
    next: usize,
    /// Slots in use.
    len: usize,
    distance: [Distance; SLOTS],
    /// Rounded times, infinite after the last knot of the run.
    time: [f64; SLOTS + 1],
    /// Time from the knot before.
    dt: [f64; SLOTS],
    /// A row a track: how many of its breakpoints have been passed after each knot.
    passed: Vec<[usize; SLOTS]>,
    steps: Vec<Step>,
}

impl<'a> Knots<'a> {
    pub fn new(run: &'a Run) -> Self {
        let cursors: Vec<Cursor> = run.tracks.iter().map(Cursor::new).collect();
        let mut knots = Self {
            run,
            next: 1,
            len: 1,
            distance: [Distance::INFINITE; SLOTS],
            time: [f64::INFINITY; SLOTS + 1],
            dt: [0.0; SLOTS],
            passed: vec![[0; SLOTS]; cursors.len()],
            steps: Vec::new(),
            cursors,
        };
        // No time passes before the first knot.
        knots.distance[0] = knots.cursors.iter().fold(Distance::INFINITE, |d, c| d.shorter(c.ahead[0]));
        knots.merge();
        knots
    }

    /// Fills the block with the next knots.
    fn merge(&mut self) {
        let last = self.len - 1;
        self.distance[0] = self.distance[last];
        for passed in &mut self.passed {
            passed[0] = passed[last];
        }
        // The number of tracks as a constant where it is small: its loops unroll.
        self.len = match self.cursors.len() {
            1 => self.merge_tracks::<1>(),
            2 => self.merge_tracks::<2>(),
            3 => self.merge_tracks::<3>(),
            _ => self.merge_tracks::<0>(),
        };
        self.next = 1;
        self.find_steps();
        let speed = self.run.speed;
        for (time, distance) in self.time.iter_mut().zip(&self.distance) {
            *time = distance.nearest() / speed;
        }
        self.time[self.len] = f64::INFINITY;
        for i in 1..SLOTS {
            self.dt[i] = self.distance[i].minus(self.distance[i - 1]) / speed;
        }
    }

    /// Merges `N` tracks, all for `N` = 0, from slot 1 on; gives the slots in use.
    fn merge_tracks<const N: usize>(&mut self) -> usize {
        let tracks = if N == 0 { self.cursors.len() } else { N };
        let (cursors, passed) = (&mut self.cursors[..tracks], &mut self.passed[..tracks]);
        let mut slot = 1;
        while slot < SLOTS {
            // No knot passes more than one breakpoint a track: so many need no look ahead.
            let sure = cursors.iter().map(|cursor| AHEAD - cursor.at).min().unwrap_or(0);
            for slot_now in slot..SLOTS.min(slot + sure) {
                let mut knot = Distance::INFINITE;
                for cursor in &*cursors {
                    knot = knot.shorter(cursor.ahead[cursor.at % AHEAD]);
                }
                if knot == Distance::INFINITE {
                    return slot_now;
                }
                for (cursor, passed) in cursors.iter_mut().zip(&mut *passed) {
                    cursor.at += usize::from(cursor.ahead[cursor.at % AHEAD] == knot);
                    passed[slot_now] = cursor.base + cursor.at;
                }
                self.distance[slot_now] = knot;
            }
            slot += sure;
            for cursor in cursors.iter_mut().filter(|cursor| cursor.at == AHEAD) {
                cursor.look_ahead();
            }
        }
        SLOTS
    }

    /// Finds the vertical steps at the knots of the block.
    fn find_steps(&mut self) {
        self.steps.clear();
        for (track, passed) in self.passed.iter().enumerate() {
            let profile = &self.run.tracks[track].profile;
            if !profile.has_steps() {
                continue;
            }
            for slot in 1..self.len {
                let height = profile.step_before(passed[slot]);
                if passed[slot] > passed[slot - 1] && height != 0.0 {
                    self.steps.push(Step { slot, track, height });
                }
            }
        }
    }

    /// Rounded time of the next knot, infinite after the last: the name of an instant that is
    /// known more exactly.
    #[inline(always)]
    pub fn upcoming_time(&self) -> f64 {
        self.time[self.next]
    }

    /// The next knot.
    pub fn upcoming(&self) -> Distance {
        self.distance[self.next]
    }

    /// Time from the last knot to the next.
    #[inline(always)]
    pub fn dt(&self) -> f64 {
        self.dt[self.next]
    }

    /// Vertical steps at the next knot.
    #[inline(always)]
    pub fn upcoming_steps(&self) -> impl Iterator<Item = &Step> {
        self.steps.iter().filter(|step| step.slot == self.next)
    }

    /// Goes past the next knot.
    #[inline(always)]
    pub fn cross(&mut self) {
        self.next += 1;
        if self.next == self.len {
            self.merge();
        }
    }

    /// Rounded time of the last knot crossed; before any, of the first.
    #[inline(always)]
    pub fn time(&self) -> f64 {
        self.time[self.next - 1]
    }

    /// The last knot crossed; before any, the first.
    #[inline(always)]
    pub fn distance(&self) -> Distance {
        self.distance[self.next - 1]
    }

    /// Slope under a track since the last knot.
    #[inline(always)]
    pub fn slope(&self, track: usize) -> f64 {
        self.run.tracks[track].profile.slopes()[self.passed[track][self.next - 1]]
    }

    /// Elevation under a track at a distance between the last knot and the next.
    pub fn elevation(&self, track: usize, distance: Distance) -> f64 {
        let passed = self.passed[track][self.next - 1];
        let Track { profile, lag, .. } = &self.run.tracks[track];
        let base = profile.z()[passed.saturating_sub(1)];
        match profile.slopes()[passed] {
            0.0 => base,
            slope => base + slope * distance.minus(lag.plus(profile.x()[passed - 1])),
        }
    }
}
