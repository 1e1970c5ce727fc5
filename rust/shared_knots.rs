//! Gears that meet their knots where the foremost one meets its own: equally spaced stations and
//! a lag of a whole number of spacings, or gears side by side.

use multiversion::multiversion;

use crate::distance::Distance;
use crate::run::Track;

/// How the knots of all tracks lie on those of one of them, as far as these go.
#[derive(Clone, Debug)]
pub(crate) struct SharedKnots {
    /// The track that meets the first knot of all.
    pub foremost: usize,
    /// Of each track: how many knots the foremost one meets before its first.
    pub apart: Vec<usize>,
}

impl SharedKnots {
    /// What the tracks share, if all of them do.
    pub fn find(tracks: &[Track]) -> Option<Self> {
        let first = |track: &Track| track.profile.knots().first().map(|&x| track.lag.plus(x));
        let mut foremost = 0;
        for (index, track) in tracks.iter().enumerate() {
            let next = first(track).unwrap_or(Distance::INFINITE);
            if next.is_before(first(&tracks[foremost]).unwrap_or(Distance::INFINITE)) {
                foremost = index;
            }
        }
        let (x, lag) = (tracks[foremost].profile.knots(), tracks[foremost].lag);
        let apart = tracks.iter().enumerate().map(|(index, track)| {
            if index == foremost {
                return Some(0);
            }
            let start = first(track).unwrap_or(Distance::INFINITE);
            let apart = x.partition_point(|&x| lag.plus(x).is_before(start));
            coincide(track.profile.knots(), track.lag, &x[apart..], lag).then_some(apart)
        });
        Some(Self { foremost, apart: apart.collect::<Option<_>>()? })
    }
}

/// Whether stations under one track are met where those under another are, each by each.
#[multiversion(targets("x86_64+avx2"))]
fn coincide(x: &[f64], lag: Distance, others: &[f64], other_lag: Distance) -> bool {
    x.chunks(256).zip(others.chunks(256)).all(|(x, others)| {
        let pairs = x.iter().zip(others);
        !if other_lag == Distance::ZERO {
            pairs.fold(false, |any, (x, other)| any | (lag.plus(*x) != Distance::exactly(*other)))
        } else {
            pairs.fold(false, |any, (x, other)| any | (lag.plus(*x) != other_lag.plus(*other)))
        }
    })
}
