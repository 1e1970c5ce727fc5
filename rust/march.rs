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
    /// The last knot.
    distance: Distance,
    time: f64,
    /// State just after the last knot.
    pub(crate) state: State,
    /// What drives the modes until the next one.
    pub(crate) drive: Drive,
    kept: Box<[(f64, Transition)]>,
    crossed: u32,
}

impl<'a> March<'a> {
    /// At rest in equilibrium on the first elevations.
    #[must_use]
    pub fn new(run: &'a Run) -> Self {
        let none = [0.0; LANES];
        let knots = Knots::new(run);
        Self {
            run,
            distance: knots.upcoming,
            time: knots.upcoming_time().unwrap_or(f64::INFINITY),
            knots,
            state: State { d: none, v: none, p: run.modal_rest() },
            drive: Drive { beta: none, gamma: none },
            kept: vec![(0.0, run.oscillators.over(0.0)); KEPT].into(),
            crossed: 0,
        }
    }

    /// The transition over `dt`, computed once for each of the lengths in use.
    #[inline]
    pub(crate) fn transition(&mut self, dt: f64) -> &Transition {
        let slot = (dt.to_bits().wrapping_mul(0x9E37_79B9_7F4A_7C15) >> 58) as usize % KEPT;
        let kept = &mut self.kept[slot];
        if kept.0 != dt {
            *kept = (dt, self.run.oscillators.over(dt));
        }
        &kept.1
    }

    /// Time from the last knot to the next.
    #[inline]
    pub(crate) fn segment(&self) -> f64 {
        self.knots.upcoming.minus(self.distance) / self.run.speed
    }

    /// State just before the next knot.
    #[inline]
    pub(crate) fn before_knot(&mut self) -> State {
        let (state, drive) = (self.state, self.drive);
        let dt = self.segment();
        self.transition(dt).apply(&state, &drive)
    }

    /// Crosses the next knot from the state just before it.
    #[inline]
    pub(crate) fn cross(&mut self, before: State) {
        self.distance = self.knots.upcoming;
        self.time = self.knots.upcoming_time().unwrap_or(f64::INFINITY);
        self.state = before;
        let (run, state) = (self.run, &mut self.state);
        self.knots.cross(|track, height| {
            // The runway jumps, the aircraft does not; a damper in between gives it a blow.
            let track = &run.tracks[track];
            for i in 0..LANES {
                state.d[i] -= track.lift[i] * height;
                state.v[i] += track.drag[i] * run.oscillators.omega[i] * height;
            }
        });
        let none = [0.0; LANES];
        self.drive = Drive { beta: none, gamma: none };
        for (track, cursor) in run.tracks.iter().zip(&self.knots.cursors) {
            for i in 0..LANES {
                self.drive.beta[i] += track.push[i] * cursor.rate;
            }
            if run.damping_input {
                for i in 0..LANES {
                    self.drive.gamma[i] += track.drag[i] * cursor.rate;
                }
            }
        }
        self.crossed = self.crossed.wrapping_add(1);
    }

    /// Goes on to the last knot at or before `time`.
    ///
    /// # Errors
    /// What `pulse` gives.
    #[inline]
    pub fn advance(&mut self, time: f64, pulse: &mut Pulse) -> Result<()> {
        while self.knots.upcoming_time().is_some_and(|next| next <= time) {
            let before = self.before_knot();
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
        if time <= self.time { self.distance } else { Distance::product(time, self.run.speed) }
    }

    /// State at a time between the last knot and the next.
    #[inline]
    #[must_use]
    pub fn state_at(&self, time: f64) -> State {
        if time <= self.time {
            return self.state;
        }
        let since = self.distance_at(time).minus(self.distance) / self.run.speed;
        self.run.oscillators.over(since.max(0.0)).apply(&self.state, &self.drive)
    }

    /// Time of the last knot.
    #[must_use]
    pub(crate) fn time(&self) -> f64 {
        self.time
    }
}
