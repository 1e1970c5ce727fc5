//! Gears that meet their knots where the foremost one meets its own: the stations of all lie on one
//! grid, and the lags between them are whole numbers of its spacings.

use crate::distance::{Distance, Distances};
use crate::track::Track;

/// How the knots of all tracks lie on those of one of them, as far as these go.
#[derive(Clone, Debug)]
pub(crate) struct SharedKnots {
    /// The track that meets the first knot of all.
    foremost: usize,
    /// Of each track: how many knots the foremost one meets before its first.
    apart: Vec<usize>,
}

impl SharedKnots {
    /// What the tracks share, if all of them do.
    pub fn find(tracks: &[Track]) -> Option<Self> {
        let mut foremost = 0;
        for (index, track) in tracks.iter().enumerate() {
            if track.first_knot().is_before(tracks[foremost].first_knot()) {
                foremost = index;
            }
        }
        let apart = tracks
            .iter()
            .enumerate()
            .map(|(index, track)| if index == foremost { Some(0) } else { apart(&tracks[foremost], track) });
        Some(Self { foremost, apart: apart.collect::<Option<_>>()? })
    }

    /// At most so many knots in all.
    pub fn most(&self, tracks: &[Track]) -> usize {
        let shared = tracks[self.foremost].profile.knots().len();
        let beyond = |(track, apart): (&Track, &usize)| {
            let count = track.profile.knots().len();
            (apart + count).saturating_sub(shared).min(count)
        };
        shared + tracks.iter().zip(&self.apart).map(beyond).sum::<usize>()
    }
}

/// Goes from knot to knot of the foremost track, all others in step with it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct InStep<'a> {
    tracks: &'a [Track],
    shared: &'a SharedKnots,
    /// Breakpoints that the foremost track has passed at slot 0 of the block, and in the block.
    from: usize,
    count: usize,
}

impl<'a> InStep<'a> {
    pub fn new(tracks: &'a [Track], shared: &'a SharedKnots) -> Self {
        Self { tracks, shared, from: 0, count: 0 }
    }

    /// Stations that the foremost track has yet to meet after the block.
    #[inline(always)]
    fn ahead(&self) -> &'a [f64] {
        &self.tracks[self.shared.foremost].profile.knots()[self.from + self.count..]
    }

    /// Whether there are none.
    #[inline(always)]
    pub fn is_over(&self) -> bool {
        self.ahead().is_empty()
    }

    /// How many breakpoints of a track have been passed after the knot of a slot.
    #[inline(always)]
    pub fn passed(&self, track: usize, slot: usize) -> usize {
        let last = self.tracks[track].profile.knots().len();
        (self.from + slot).saturating_sub(self.shared.apart[track]).min(last)
    }

    /// How many breakpoints of each track have been passed after the block.
    pub fn all_passed(self) -> impl Iterator<Item = usize> {
        (0..self.tracks.len()).map(move |track| self.passed(track, self.count))
    }

    /// The next knots from slot 1 on, and a row a track of the slopes after them; gives the slots
    /// in use.
    #[inline(always)]
    pub fn fill<const N: usize>(&mut self, distance: &mut Distances<N>, slopes: &mut [[f64; N]]) -> usize {
        let x = self.ahead();
        (self.from, self.count) = (self.from + self.count, x.len().min(N - 1));
        let Self { tracks, shared, from, count } = *self;
        distance.shift(1, &x[..count], tracks[shared.foremost].lag);
        for (index, slopes) in slopes.iter_mut().enumerate() {
            let (profile, apart) = (&tracks[index].profile, shared.apart[index]);
            // It waits on the level, moves on with the foremost, and has moved on to the level.
            let begin = apart.saturating_sub(from).min(count);
            let end = (apart + profile.knots().len()).saturating_sub(from).min(count);
            let (waiting, rest) = slopes[1..=count].split_at_mut(begin);
            let (moving, done) = rest.split_at_mut(end - begin);
            waiting.fill(0.0);
            if !moving.is_empty() {
                moving.copy_from_slice(&profile.slopes()[from + begin + 1 - apart..][..moving.len()]);
            }
            done.fill(0.0);
        }
        count + 1
    }
}

/// How many spacings a track's first knot is behind that of another, if both are on one grid.
fn apart(foremost: &Track, track: &Track) -> Option<usize> {
    /// More spacings than any profile has.
    const MOST: f64 = 1e15;
    let (front, back) = (foremost.first_knot(), track.first_knot());
    if back == Distance::INFINITE {
        return Some(0);
    }
    let spacing =
        foremost.profile.spacing().filter(|_| foremost.profile.spacing() == track.profile.spacing())?;
    let apart = (back.minus(front) / spacing).round();
    let there = Distance::product(apart, spacing);
    let whole = (0.0..MOST).contains(&apart) && front.further(there) == back;
    whole.then_some(apart as usize)
}
