//! One run: an aircraft in its modes, a profile under each gear, a constant speed.

use std::sync::Arc;

use nalgebra::Vector3;

use crate::distance::Distance;
use crate::error::{Error, Place, Result, moderate, non_decreasing, positive};
use crate::lanes::Lanes;
use crate::modes::Modes;
use crate::profile::Profile;
use crate::shared_knots::SharedKnots;
use crate::track::{Track, lag};
use crate::transition::Oscillators;

/// Samples a period of the fastest mode, at least, in the default time points.
const SAMPLES_PER_PERIOD: f64 = 20.0;

/// How long the default time points go on after the last gear has passed the last knot.
const AFTER_LAST_KNOT: f64 = 5.0;

/// What errors call the end of the span that follows from it.
const DEFAULT_DURATION: &str = "the default duration";

/// More default time points between knots than this are refused: a slip in the units, not a wish.
const MOST_SAMPLES: f64 = 1e8;

/// What an error calls the time at which the last gear meets the last breakpoint.
pub(crate) const LAST_KNOT: &str = "time of the last knot";

/// Largest time · ω max(1, 2ζ) of a mode: beyond, its phase has no digits left.
const LONGEST_PHASE: f64 = 1e12;

/// Latest time on a level runway: its distance must stay in double precision.
const LONGEST_TIME: f64 = 1e200;

/// Refuses a wrong number of profiles.
pub(crate) fn check_tracks(modes: &Modes, profiles: &[Arc<Profile>]) -> Result<()> {
    let (found, expected) = (profiles.len(), modes.aircraft().gears().len());
    if found != expected {
        let why = "one profile per gear";
        return Err(Error::WrongLength { argument: "tracks", found, expected, why });
    }
    Ok(())
}

/// The default time points of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grid {
    /// First time.
    pub begin: f64,
    /// Last time.
    pub end: f64,
    /// Largest gap.
    pub(crate) step: f64,
    /// No more points than this.
    pub most: usize,
}

/// A checked run, ready to be marched over.
#[derive(Clone, Debug)]
pub struct Run {
    pub(crate) modes: Arc<Modes>,
    pub(crate) tracks: Vec<Track>,
    /// Track of each gear.
    pub(crate) track_of: Vec<usize>,
    /// If the knots of all tracks fall on one grid.
    pub(crate) shared_knots: Option<SharedKnots>,
    pub(crate) oscillators: Oscillators,
    pub(crate) speed: f64,
    pub(crate) damping_input: bool,
}

impl Run {
    /// Sets up a run. `profiles` holds one profile a gear, in the aircraft's order.
    ///
    /// # Errors
    /// A speed that is not positive, a wrong number of profiles, slopes or times that leave
    /// the range of double precision.
    pub fn new(
        modes: Arc<Modes>,
        profiles: &[Arc<Profile>],
        speed: f64,
        damping_input: bool,
    ) -> Result<Self> {
        moderate("speed", speed)?;
        let aircraft = modes.aircraft();
        let gears = aircraft.gears();
        check_tracks(&modes, profiles)?;
        // Without dampers there is nothing to take part.
        let damping_input = damping_input && gears.iter().any(|gear| gear.damping > 0.0);
        let omega = modes.omega();
        let oscillators = Oscillators::new(omega.iter().copied().zip(modes.damping_ratio().iter().copied()));
        let front = gears.iter().map(|gear| gear.x).fold(f64::NEG_INFINITY, f64::max);
        let mut tracks: Vec<Track> = Vec::new();
        let mut track_of = Vec::with_capacity(gears.len());
        for (gear, profile) in gears.iter().zip(profiles) {
            let lag = lag(front, gear.x, profile);
            let same = |track: &Track| track.lag == lag && Arc::ptr_eq(&track.profile, profile);
            let index = tracks.iter().position(same).unwrap_or_else(|| {
                let none = Lanes::ZERO;
                tracks.push(Track { profile: Arc::clone(profile), lag, lift: none, climb: none, drag: none });
                tracks.len() - 1
            });
            track_of.push(index);
            let track = &mut tracks[index];
            for (lane, (shape, omega)) in modes.shapes().iter().zip(omega).enumerate() {
                let travel = gear.row().dot(shape);
                let lift = gear.stiffness * travel / omega / omega;
                track.lift[lane] += lift;
                track.climb[lane] += lift * speed / omega;
                if damping_input {
                    track.drag[lane] += gear.damping * travel / omega / omega;
                }
            }
        }
        let shared_knots = SharedKnots::find(&tracks);
        let run = Self { modes, tracks, track_of, shared_knots, oscillators, speed, damping_input };
        run.check_span(LAST_KNOT, run.last_time())?;
        run.check_span("time of the first knot", run.first_time())?;
        Ok(run)
    }

    /// The modes.
    #[must_use]
    pub fn modes(&self) -> &Arc<Modes> {
        &self.modes
    }

    /// Ground speed.
    #[must_use]
    pub fn speed(&self) -> f64 {
        self.speed
    }

    /// Where the first gear meets the first breakpoint, if there is one.
    pub(crate) fn first_knot(&self) -> Distance {
        self.tracks.iter().fold(Distance::INFINITE, |first, track| first.shorter(track.first_knot()))
    }

    /// Time at which that happens, 0 without any.
    fn first_time(&self) -> f64 {
        match self.first_knot() {
            Distance::INFINITE => 0.0,
            first => first.nearest() / self.speed,
        }
    }

    /// Time at which the last gear meets the last breakpoint, 0 without any.
    fn last_time(&self) -> f64 {
        let last =
            |track: &Track| track.profile.knots().last().map(|&x| track.lag.plus(x).nearest() / self.speed);
        self.tracks.iter().filter_map(last).reduce(f64::max).unwrap_or(0.0)
    }

    /// Refuses times at which the phase of a mode has no digits left.
    fn check_span(&self, place: impl Into<Place>, time: f64) -> Result<()> {
        let level = self.tracks.iter().all(|track| track.profile.is_level());
        if time.abs() * self.oscillators.stiffest() < LONGEST_PHASE || (level && time.abs() < LONGEST_TIME) {
            return Ok(());
        }
        let why = "a mode's phase has no digits left where time · ω · max(1, 2ζ) reaches 1e12";
        Err(Error::OutOfRange { place: place.into(), value: time, why })
    }

    /// Checks times given by a caller: finite, never decreasing, at least one, none so late that a phase
    /// has no digits left.
    pub(crate) fn check_times(&self, times: &[f64]) -> Result<()> {
        non_decreasing("times", times)?;
        let (Some(first), Some(last)) = (times.first(), times.last()) else {
            return Err(Error::TooShort { argument: "times", found: 0, least: 1 });
        };
        self.check_span(Place::at("times", 0), *first)?;
        self.check_span(Place::at("times", times.len() - 1), *last)
    }

    /// Default span of time: from 0 or the first knot until 5 time units after the last gear has
    /// passed the last knot.
    ///
    /// # Errors
    /// A span so long that a phase has no digits left.
    pub fn span(&self) -> Result<(f64, f64)> {
        let end = self.last_time().max(0.0) + AFTER_LAST_KNOT;
        self.check_span(DEFAULT_DURATION, end)?;
        Ok((self.first_time().min(0.0), end))
    }

    /// Distance rolled from the beginning of the default span until nothing more happens.
    pub(crate) fn distance(&self) -> f64 {
        (self.last_time().max(0.0) - self.first_time().min(0.0)) * self.speed
    }

    /// Default time points: every knot of every gear, both sides of a vertical step, and enough
    /// between them for a smooth plot. From 0 or the first knot until `duration`, by default
    /// until 5 time units after the last gear has passed the last knot.
    ///
    /// # Errors
    /// A duration that is not positive, or too many points.
    pub fn grid(&self, duration: Option<f64>) -> Result<Grid> {
        let begin = self.first_time().min(0.0);
        let (name, end) = match duration {
            Some(end) => ("duration", positive("duration", end)?),
            None => (DEFAULT_DURATION, self.span()?.1),
        };
        self.check_span(name, end)?;
        let step = std::f64::consts::TAU / (self.oscillators.fastest() * SAMPLES_PER_PERIOD);
        let between = (end - begin) / step;
        if between > MOST_SAMPLES {
            return Err(Error::OutOfRange {
                place: name.into(),
                value: end,
                why: "more than 1e8 time points; give times",
            });
        }
        // At most: a row a knot, the other side of each jump, the two ends, and a few for rounding.
        let everywhere = between as usize + 1;
        let between = |least: usize, track: &Track| least.min(self.between(track, begin, end, step));
        let between = self.tracks.iter().fold(everywhere, between);
        let knots = self.most_knots();
        let jumps = if self.jumps_at_knots() {
            knots
        } else {
            self.tracks.iter().map(|track| track.profile.steps()).sum()
        };
        let most = between + knots + jumps + 8;
        Ok(Grid { begin, end, step, most })
    }

    /// Whether loads and accelerations jump wherever a slope changes: dampers feel slopes.
    pub(crate) fn jumps_at_knots(&self) -> bool {
        self.damping_input
    }

    /// An upper bound on the number of knots. The closer it is, the less memory is fetched for results.
    pub(crate) fn most_knots(&self) -> usize {
        match &self.shared_knots {
            Some(shared) => shared.most(&self.tracks),
            None => self.tracks.iter().map(|track| track.profile.knots().len()).sum(),
        }
    }

    /// An upper bound on the number of knots up to a time.
    pub(crate) fn most_knots_by(&self, end: f64) -> usize {
        let reached = |track: &Track| {
            let station = end * self.speed - track.lag.nearest();
            track.profile.knots().partition_point(|&x| x <= station) + 1
        };
        self.most_knots().min(self.tracks.iter().map(reached).sum())
    }

    /// An upper bound on the number of default time points between knots: they lie only where the knots of
    /// all tracks are far apart, hence where those of this one are.
    fn between(&self, track: &Track, begin: f64, end: f64, step: f64) -> usize {
        // Shortest span, in steps, that may hold a time point: a whole step but for the rounding of times.
        const NEARLY: f64 = 0.99;
        let x = track.profile.knots();
        let (Some(&first), Some(&last)) = (x.first(), x.last()) else {
            return ((end - begin) / step) as usize + 1;
        };
        let time = |x: f64| track.lag.plus(x).nearest() / self.speed;
        let (spans, count) = track.profile.long_spans(NEARLY * step * self.speed);
        let outside = (time(first) - begin).max(0.0) + (end - time(last)).max(0.0);
        ((outside + spans / self.speed) / step) as usize + count + 2
    }

    /// CG coordinates at the start: at rest in equilibrium on the first elevations.
    pub(crate) fn rest(&self) -> Vector3<f64> {
        // A lift of all gears is pure bounce, to the last bit: only differences tilt.
        let lift = self.tracks[0].profile.z()[0];
        let rest = &self.modes.statics().rest;
        let tilt: Vector3<f64> =
            rest.iter().zip(self.first_elevations()).map(|(column, u)| column * (u - lift)).sum();
        tilt + Vector3::x() * lift
    }

    /// Modal coordinates at the start.
    pub(crate) fn modal_rest(&self) -> Lanes {
        self.tracks.iter().fold(Lanes::ZERO, |p, track| p + track.lift * track.profile.z()[0])
    }

    /// First elevation under each gear.
    pub(crate) fn first_elevations(&self) -> impl Iterator<Item = f64> {
        self.track_of.iter().map(|&track| self.tracks[track].profile.z()[0])
    }
}
