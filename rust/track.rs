//! Gears that meet one profile at one time, and how far they are behind the foremost gear.

use std::sync::Arc;

use crate::distance::Distance;
use crate::lanes::Lanes;
use crate::profile::Profile;

/// Gears that meet the same profile at the same time.
#[derive(Clone, Debug)]
pub(crate) struct Track {
    pub profile: Arc<Profile>,
    /// Distance of the gears behind the foremost one.
    pub lag: Distance,
    /// Static modal displacement per elevation, φᵀK₁ ÷ ω² (Eq. 12).
    pub lift: Lanes,
    /// Its change per radian and slope, lift · speed ÷ ω.
    pub climb: Lanes,
    /// The dampers' share per rate of elevation, φᵀC₁ ÷ ω²; zero unless the damping input is kept.
    pub drag: Lanes,
}

impl Track {
    /// Where it meets its first breakpoint, if there is one.
    pub fn first_knot(&self) -> Distance {
        self.profile.knots().first().map_or(Distance::INFINITE, |&x| self.lag.plus(x))
    }
}

/// Share of a spacing within which a lag is a whole number of them.
pub(crate) const HARMLESS: f64 = 1e-13;

/// How far a gear is behind the foremost one.
///
/// Exactly the difference of the arms; rounded to one double where that moves no elevation by
/// more than 1e-13 of the steepest segment's rise, so that a grid whose lag is nominally a whole
/// number of spacings has common knots and not pairs of them a rounding error apart.
pub(crate) fn lag(front: f64, x: f64, profile: &Profile) -> Distance {
    let exact = Distance::sum(front, -x);
    let rounded = Distance::exactly(exact.nearest());
    if exact.minus(rounded).abs() <= HARMLESS * profile.finest() { rounded } else { exact }
}
