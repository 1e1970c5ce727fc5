//! Knots of several tracks merged into one order.

use std::ops::Range;

use crate::distance::{Distance, Distances, rank};
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
    /// In which order.
    rank: [i64; AHEAD],
}

impl<'a> Cursor<'a> {
    /// With so many breakpoints passed.
    fn new(track: &'a Track, base: usize) -> Self {
        let Track { profile, lag, .. } = track;
        let (x, slopes) = (profile.knots(), profile.slopes());
        let (ahead, rank) = (Distances::INFINITE, [0; AHEAD]);
        let mut cursor = Self { x, slopes, lag: *lag, base, at: 0, ahead, rank };
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
        self.ahead.rank(&mut self.rank);
    }
}

/// Merges the breakpoints of all tracks, a block at a time.
#[derive(Clone, Debug)]
pub(crate) struct Merge<'a> {
    cursors: Vec<Cursor<'a>>,
}

impl<'a> Merge<'a> {
    /// Goes on after so many breakpoints of each track.
    pub fn new(tracks: &'a [Track], passed: impl Iterator<Item = usize>) -> Self {
        Self { cursors: tracks.iter().zip(passed).map(|(track, at)| Cursor::new(track, at)).collect() }
    }

    /// The next knots from slot 1 on; rows a track of the slopes after them, and of how many
    /// breakpoints have been passed then, in slot 0 too. Gives the slots in use.
    #[inline(always)]
    pub fn fill<const SLOTS: usize>(
        &mut self,
        distance: &mut Distances<SLOTS>,
        slopes: &mut [[f64; SLOTS]],
        passed: &mut [[usize; SLOTS]],
    ) -> usize {
        // The number of tracks as a constant where it is small: its loops unroll.
        match self.cursors.len() {
            2 => self.fill_tracks::<2, SLOTS>(distance, slopes, passed),
            3 => self.fill_tracks::<3, SLOTS>(distance, slopes, passed),
            _ => self.fill_tracks::<0, SLOTS>(distance, slopes, passed),
        }
    }

    /// `N` tracks, all for `N` = 0.
    #[inline(always)]
    fn fill_tracks<const N: usize, const SLOTS: usize>(
        &mut self,
        distance: &mut Distances<SLOTS>,
        slopes: &mut [[f64; SLOTS]],
        passed: &mut [[usize; SLOTS]],
    ) -> usize {
        let tracks = if N == 0 { self.cursors.len() } else { N };
        let cursors = &mut self.cursors[..tracks];
        let passed = &mut passed[..tracks];
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
                let found = one_by_one::<N, SLOTS>(cursors, slot..slot + sure, distance, passed, slopes);
                if found < slot + sure {
                    return found;
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

/// The next knots in these slots, each looked for; gives the first slot for which there is none.
#[inline(always)]
fn one_by_one<const N: usize, const SLOTS: usize>(
    cursors: &mut [Cursor],
    slots: Range<usize>,
    distance: &mut Distances<SLOTS>,
    passed: &mut [[usize; SLOTS]],
    slopes: &mut [[f64; SLOTS]],
) -> usize {
    const BEYOND: i64 = rank(f64::INFINITY);
    let tracks = cursors.len();
    // Places of their own, which stay in registers where loops unroll: each knot waits for those
    // that the one before has led to.
    let (mut few, mut many);
    let at: &mut [usize] = if N == 0 {
        many = cursors.iter().map(|cursor| cursor.at).collect::<Vec<_>>();
        &mut many
    } else {
        few = std::array::from_fn::<_, N, _>(|track| cursors[track].at);
        &mut few
    };
    let mut end = slots.end;
    for slot in slots {
        let rank = |track: usize, at: usize| cursors[track].rank[at % AHEAD];
        let next = |track: usize, at: usize| cursors[track].ahead.get(at % AHEAD);
        let mut nearest = BEYOND;
        for track in 0..tracks {
            nearest = nearest.min(rank(track, at[track]));
        }
        if nearest == BEYOND {
            end = slot;
            break;
        }
        let (mut first, mut count) = (0, 0);
        for track in 0..tracks {
            if rank(track, at[track]) == nearest {
                (first, count) = (track, count + 1);
            }
        }
        let mut knot = next(first, at[first]);
        if count == 1 {
            for track in 0..tracks {
                at[track] += usize::from(rank(track, at[track]) == nearest);
            }
        } else {
            // At one rounded distance, but not yet at one distance.
            for track in 0..tracks {
                knot = knot.shorter(next(track, at[track]));
            }
            for track in 0..tracks {
                at[track] += usize::from(next(track, at[track]) == knot);
            }
        }
        distance.set(slot, knot);
        for track in 0..tracks {
            passed[track][slot] = cursors[track].base + at[track];
            slopes[track][slot] = cursors[track].slopes[passed[track][slot]];
        }
    }
    for (cursor, at) in cursors.iter_mut().zip(at) {
        cursor.at = *at;
    }
    end
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::lanes::Lanes;
    use crate::profile::Profile;

    const SLOTS: usize = 64;

    /// A track whose slopes are the numbers of its segments.
    fn track(x: &[f64], lag: Distance) -> Track {
        let mut z = 0.0;
        let rise = |(segment, ends): (usize, &[f64])| {
            z += (segment as f64 + 1.0) * (ends[1] - ends[0]);
            z
        };
        let z: Vec<f64> = std::iter::once(0.0).chain(x.windows(2).enumerate().map(rise)).collect();
        let profile = Arc::new(Profile::new(x.to_vec(), z).unwrap());
        Track { profile, lag, lift: Lanes::ZERO, climb: Lanes::ZERO, drag: Lanes::ZERO }
    }

    /// Stations on a grid of eighths, some left out: many in common.
    fn stations(begin: f64, count: usize, mut bits: u64) -> Vec<f64> {
        let mut x = begin;
        let next = |_| {
            bits = bits.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            x += 0.125 * (1 + (bits >> 62)) as f64;
            x
        };
        (0..count).map(next).collect()
    }

    /// All knots of all tracks in order, each once.
    fn sorted(tracks: &[Track]) -> Vec<Distance> {
        let knots =
            |track: &Track| track.profile.knots().iter().map(|&x| track.lag.plus(x)).collect::<Vec<_>>();
        let mut all: Vec<_> = tracks.iter().flat_map(knots).collect();
        all.sort_by(|a, b| match (a.is_before(*b), b.is_before(*a)) {
            (true, _) => std::cmp::Ordering::Less,
            (_, true) => std::cmp::Ordering::Greater,
            _ => std::cmp::Ordering::Equal,
        });
        all.dedup();
        all
    }

    #[test]
    fn every_knot_comes_once_and_in_order() {
        // In step, half a grid aside, a rounding error aside, behind the origin, and a short one.
        let tiny = Distance::sum(1.0, 1e-17);
        let all = [
            track(&stations(-40.0, 900, 1), Distance::ZERO),
            track(&stations(-40.0, 900, 2), Distance::exactly(2.0)),
            track(&stations(-40.0, 700, 3), tiny),
            track(&stations(-3.0, 40, 4), Distance::exactly(0.0625)),
            track(&[5.0], Distance::ZERO),
        ];
        for tracks in [&all[..2], &all[..3], &all[1..3], &all[2..4], &all[..], &all[4..]] {
            let expected = sorted(tracks);
            let mut merge = Merge::new(tracks, std::iter::repeat_n(0, tracks.len()));
            let mut slopes = vec![[0.0; SLOTS]; tracks.len()];
            let mut passed = vec![[0; SLOTS]; tracks.len()];
            let mut distance = Distances::INFINITE;
            let mut found = Vec::new();
            loop {
                let len = merge.fill(&mut distance, &mut slopes, &mut passed);
                for slot in 1..len {
                    found.push(distance.get(slot));
                    for (index, track) in tracks.iter().enumerate() {
                        let met = |&&x: &&f64| !distance.get(slot).is_before(track.lag.plus(x));
                        let count = track.profile.knots().iter().filter(met).count();
                        assert_eq!(passed[index][slot], count);
                        assert_eq!(slopes[index][slot], track.profile.slopes()[count]);
                    }
                }
                if len < SLOTS {
                    break;
                }
            }
            assert_eq!(found, expected);
        }
    }
}
