//! Knots of several tracks merged into one order.

use crate::distance::{Distance, Distances};
use crate::track::Track;

/// Breakpoints of one track looked ahead at.
const AHEAD: usize = 256;

/// One track's place on its profile.
#[derive(Clone, Debug)]
struct Cursor<'a> {
    x: &'a [f64],
    slopes: &'a [f64],
    lag: Distance,
    /// Breakpoints before the ones looked ahead at.
    base: usize,
    /// How many of these have been passed.
    at: usize,
    /// Where they are met; infinite past the last.
    ahead: Distances<AHEAD>,
}

impl<'a> Cursor<'a> {
    /// With so many breakpoints passed.
    fn new(track: &'a Track, base: usize) -> Self {
        let Track { profile, lag, .. } = track;
        let (x, slopes) = (profile.knots(), profile.slopes());
        let mut cursor = Self { x, slopes, lag: *lag, base, at: 0, ahead: Distances::INFINITE };
        cursor.look_ahead();
        cursor
    }

    /// Where it meets its next breakpoint.
    #[inline(always)]
    fn next(&self) -> Distance {
        self.ahead.get(self.at % AHEAD)
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

/// Merges the breakpoints of all tracks, a block of so many slots at a time.
#[derive(Clone, Debug)]
pub(crate) struct Merge<'a, const SLOTS: usize> {
    cursors: Vec<Cursor<'a>>,
    /// A row a track: how many of its breakpoints have been passed after each knot.
    passed: Vec<[usize; SLOTS]>,
}

impl<'a, const SLOTS: usize> Merge<'a, SLOTS> {
    /// Goes on after so many breakpoints of each track.
    pub fn new(tracks: &'a [Track], passed: impl Iterator<Item = usize>) -> Self {
        let cursors: Vec<_> = tracks.iter().zip(passed).map(|(track, at)| Cursor::new(track, at)).collect();
        Self { passed: vec![[0; SLOTS]; cursors.len()], cursors }
    }

    /// How many breakpoints of a track have been passed after the knot of a slot.
    #[inline(always)]
    pub fn passed(&self, track: usize, slot: usize) -> usize {
        self.passed[track][slot]
    }

    /// The next knots from slot 1 on, and a row a track of the slopes after them; gives the slots
    /// in use.
    #[inline(always)]
    pub fn fill(&mut self, distance: &mut Distances<SLOTS>, slopes: &mut [[f64; SLOTS]]) -> usize {
        // The number of tracks as a constant where it is small: its loops unroll.
        match self.cursors.len() {
            2 => self.fill_tracks::<2>(distance, slopes),
            3 => self.fill_tracks::<3>(distance, slopes),
            _ => self.fill_tracks::<0>(distance, slopes),
        }
    }

    /// `N` tracks, all for `N` = 0.
    #[inline(always)]
    fn fill_tracks<const N: usize>(
        &mut self,
        distance: &mut Distances<SLOTS>,
        slopes: &mut [[f64; SLOTS]],
    ) -> usize {
        let tracks = if N == 0 { self.cursors.len() } else { N };
        let cursors = &mut self.cursors[..tracks];
        let passed = &mut self.passed[..tracks];
        let slopes = &mut slopes[..tracks];
        for (cursor, passed) in cursors.iter().zip(&mut *passed) {
            passed[0] = cursor.passed();
        }
        let mut slot = 1;
        while slot < SLOTS {
            for cursor in cursors.iter_mut().filter(|cursor| cursor.at >= AHEAD) {
                cursor.look_ahead();
            }
            // No knot passes more than one breakpoint a track: so many need no look ahead.
            let sure = cursors.iter().map(|cursor| AHEAD - cursor.at).min().unwrap_or(0).min(SLOTS - slot);
            if let Some(first) = together(cursors, sure) {
                let next = cursors[first].next();
                distance.copy(slot, &cursors[first].ahead, cursors[first].at, sure);
                for ((cursor, passed), slopes) in cursors.iter_mut().zip(&mut *passed).zip(&mut *slopes) {
                    let (so_far, passes) = (cursor.passed(), usize::from(cursor.next() == next));
                    let rows = passed[slot..slot + sure].iter_mut().zip(&mut slopes[slot..]);
                    for (count, (passed, slope)) in rows.enumerate() {
                        *passed = so_far + passes * (count + 1);
                        *slope = cursor.slopes[*passed];
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
                        slopes[track][slot] = cursor.slopes[cursor.passed()];
                    }
                    distance.set(slot, knot);
                }
            }
            slot += sure;
        }
        SLOTS
    }
}

/// The track whose next `count` breakpoints are the next knots of all, if one is: the others meet
/// theirs where it does, or later: gears side by side, or the stretch that only the foremost or the
/// last gear has bumps on.
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
