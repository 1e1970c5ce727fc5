//! The march: knots in time → modal states. The segment loop, nothing else.

use crate::distance::Distance;
use crate::error::Result;
use crate::knots::Knots;
use crate::run::{Pulse, Run};
use crate::transition::{Drive, LANES, State, Transition};

/// Transitions kept by the bits of their Δt. Nominally equal segments differ by the rounding
/// of their stations and then take a handful of values between them; a lag between gears
/// splits every segment in the same two.
const KEPT: usize = 64;

/// Walks over a run from knot to knot, with the exact state at the last one.
#[derive(Clone, Debug)]
pub struct March<'a> {
    run: &'a Run,
    pub(crate) knots: Knots<'a>,
    /// State just after the last knot.
    pub(crate) state: State,
    /// What drives the modes until the next one.
    pub(crate) drive: Drive,
    kept: Box<[(f64, Transition); KEPT]>,
    crossed: u32,
}

impl<'a> March<'a> {
    /// At rest in equilibrium on the first elevations.
    #[must_use]
    pub fn new(run: &'a Run) -> Self {
        let none = [0.0; LANES];
        Self {
            run,
            knots: Knots::new(run),
            state: State { d: none, v: none, p: run.modal_rest() },
            drive: Drive { beta: none, gamma: none },
            kept: Box::new([(0.0, run.oscillators.over(0.0)); KEPT]),
            crossed: 0,
        }
    }

    /// The transition to the next knot, computed once for each of the lengths in use.
    #[inline(always)]
    pub(crate) fn transition(&mut self) -> &Transition {
        let dt = self.knots.dt();
        let slot = (dt.to_bits().wrapping_mul(0x9E37_79B9_7F4A_7C15) >> 58) as usize % KEPT;
        let kept = &mut self.kept[slot];
        if kept.0 != dt {
            *kept = (dt, self.run.oscillators.over(dt));
        }
        &kept.1
    }

    /// Crosses the next knot from the state just before it.
    #[inline(always)]
    pub(crate) fn cross(&mut self, before: State) {
        let run = self.run;
        self.state = before;
        for step in self.knots.upcoming_steps() {
            // The runway jumps, the aircraft does not; a damper in between gives it a blow.
            let track = &run.tracks[step.track];
            for i in 0..LANES {
                self.state.d[i] -= track.lift[i] * step.height;
                self.state.v[i] += track.drag[i] * run.oscillators.omega[i] * step.height;
            }
        }
        self.knots.cross();
        let none = [0.0; LANES];
        self.drive = Drive { beta: none, gamma: none };
        for (index, track) in run.tracks.iter().enumerate() {
            let slope = self.knots.slope(index);
            for i in 0..LANES {
                self.drive.beta[i] += track.climb[i] * slope;
            }
            if run.damping_input {
                for i in 0..LANES {
                    self.drive.gamma[i] += track.drag[i] * (slope * run.speed);
                }
            }
        }
        self.crossed = self.crossed.wrapping_add(1);
    }

    /// Goes on to the last knot at or before `time`.
    ///
    /// # Errors
    /// What `pulse` gives.
    #[inline(always)]
    pub fn advance(&mut self, time: f64, pulse: &mut Pulse) -> Result<()> {
        while self.knots.upcoming_time() <= time {
            let (state, drive) = (self.state, self.drive);
            let before = self.transition().apply(&state, &drive);
            self.cross(before);
            if self.crossed.is_multiple_of(1 << 16) {
                pulse()?;
            }
        }
        Ok(())
    }

    /// Distance rolled at `time`; at the rounded time of the last knot, that knot itself.
    #[inline]
    pub(crate) fn distance_at(&self, time: f64) -> Distance {
        if time <= self.knots.time() {
            self.knots.distance()
        } else {
            Distance::product(time, self.run.speed)
        }
    }

    /// State at a time between the last knot and the next.
    #[inline(always)]
    #[must_use]
    pub fn state_at(&self, time: f64) -> State {
        if time <= self.knots.time() { self.state } else { self.state_between(time) }
    }

    fn state_between(&self, time: f64) -> State {
        let since = self.distance_at(time).minus(self.knots.distance()) / self.run.speed;
        self.run.oscillators.over(since.max(0.0)).apply(&self.state, &self.drive)
    }
}
