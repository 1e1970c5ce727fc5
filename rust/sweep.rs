//! One aircraft, one runway, many speeds.

use std::sync::Arc;

use crate::error::{Error, Place, Result, moderate};
use crate::extremes::Extreme;
use crate::modes::Modes;
use crate::parallel;
use crate::profile::Profile;
use crate::readout::Quantity;
use crate::run::{LAST_KNOT, Run, check_tracks};
use crate::watch::Pulse;

/// All of a run but its speed.
#[derive(Clone, Debug)]
pub struct Course {
    pub(crate) modes: Arc<Modes>,
    /// One a gear.
    pub(crate) profiles: Vec<Arc<Profile>>,
    pub(crate) damping_input: bool,
}

impl Course {
    /// `profiles` holds one profile a gear, in the aircraft's order; with `damping_input` the gears'
    /// dampers take part in the ground input and the loads.
    ///
    /// # Errors
    /// A wrong number of profiles.
    pub fn new(modes: Arc<Modes>, profiles: Vec<Arc<Profile>>, damping_input: bool) -> Result<Self> {
        check_tracks(&modes, &profiles)?;
        Ok(Self { modes, profiles, damping_input })
    }

    /// The modes.
    #[must_use]
    pub fn modes(&self) -> &Arc<Modes> {
        &self.modes
    }

    /// The run at a speed.
    pub(crate) fn at(&self, speed: f64) -> Result<Run> {
        Run::new(Arc::clone(&self.modes), &self.profiles, speed, self.damping_input)
    }

    /// True extremes of each quantity over the default span of time, speed by speed: a list a
    /// speed, the numbers of [`Run::extremes`]. Speeds are shared among threads.
    ///
    /// # Errors
    /// A speed out of range, an overflow, or what `pulse` gives.
    pub fn sweep(&self, speeds: &[f64], quantities: &[Quantity], pulse: Pulse) -> Result<Vec<Vec<Extreme>>> {
        for (i, &speed) in speeds.iter().enumerate() {
            moderate(Place::at("speeds", i), speed)?;
        }
        parallel::map(speeds.iter().enumerate(), pulse, |(i, &speed), pulse| {
            let run = self.at(speed).map_err(|error| match error {
                // The time over the profiles: all but the speed is as for other runs.
                Error::OutOfRange { place, why, .. } if place == Place::from(LAST_KNOT) => {
                    Error::OutOfRange { place: Place::at("speeds", i), value: speed, why }
                }
                other => other,
            })?;
            run.extremes(quantities, run.span()?, pulse)
        })
    }
}
