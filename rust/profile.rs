//! A checked piecewise-linear runway profile.

use crate::distance::Distance;
use crate::error::{Error, Place, Result, finite, non_decreasing, positive};

/// Largest elevation and slope: their squares must stay in double precision.
pub(crate) const LARGEST: f64 = 1e100;

/// Shortest footprint as a share of the stations: below it x ± length/2 has too few digits.
const SHORTEST_FOOTPRINT: f64 = 1e-9;

/// Chords that a tolerance may add to a footprint.
const MOST_CHORDS: f64 = 1e7;

/// Elevation against station: straight lines between breakpoints, level before the first
/// and after the last. A repeated station is a vertical step.
#[derive(Clone, Debug, PartialEq)]
pub struct Profile {
    x: Vec<f64>,
    z: Vec<f64>,
    /// Slope after so many breakpoints: 0 before the first, along a vertical step, after the last.
    slopes: Vec<f64>,
    steps: usize,
    /// Where it is one between all neighbouring stations, to the last digit.
    spacing: Option<f64>,
    finest: f64,
    coarsest: f64,
    range: f64,
}

impl Profile {
    /// A profile through the points (x, z).
    ///
    /// # Errors
    /// No points, lengths that differ, values not finite, stations that decrease, a slope or
    /// a step too large for double precision.
    pub fn new(mut x: Vec<f64>, mut z: Vec<f64>) -> Result<Self> {
        if x.is_empty() {
            return Err(Error::TooShort { argument: "x", found: 0, least: 1 });
        }
        if x.len() != z.len() {
            return Err(Error::WrongLength {
                argument: "z",
                found: z.len(),
                expected: x.len(),
                why: "one elevation a station",
            });
        }
        non_decreasing("x", &x)?;
        for (i, &value) in z.iter().enumerate() {
            let place = Place::at("z", i);
            if finite(place, value)?.abs() > LARGEST {
                return Err(Error::OutOfRange { place, value, why: "elevations up to 1e100 are allowed" });
            }
        }
        // −0 becomes 0: profiles with the same breakpoints have the same bits.
        x.iter_mut().chain(&mut z).for_each(|value| *value += 0.0);
        let mut slopes = vec![0.0; x.len() + 1];
        let (mut finest, mut coarsest, mut exact) = (f64::INFINITY, 0.0_f64, true);
        for i in 1..x.len() {
            let (run, rise) = (x[i] - x[i - 1], z[i] - z[i - 1]);
            if !run.is_finite() {
                let (place, why) = (Place::at("x", i), "the distance from the station before it overflows");
                return Err(Error::OutOfRange { place, value: x[i], why });
            }
            exact &= Distance::sum(x[i], -x[i - 1]) == Distance::exactly(run);
            if run > 0.0 {
                slopes[i] = rise / run;
                finest = finest.min(run);
                coarsest = coarsest.max(run);
            }
            if slopes[i].abs() > LARGEST {
                let place = Place::at("z", i);
                return Err(Error::OutOfRange { place, value: z[i], why: "slopes up to 1e100 are allowed" });
            }
        }
        let steps = x.windows(2).filter(|pair| pair[1] <= pair[0]).count();
        let extreme = |pick: fn(f64, f64) -> f64| z.iter().copied().reduce(pick).unwrap_or(0.0);
        let range = extreme(f64::max) - extreme(f64::min);
        let spacing = (exact && steps == 0 && finest >= coarsest && coarsest > 0.0).then_some(finest);
        Ok(Self { x, z, slopes, steps, spacing, finest, coarsest, range })
    }

    /// A level runway.
    #[must_use]
    pub fn level() -> Self {
        let (finest, coarsest) = (f64::INFINITY, 0.0);
        Self {
            x: vec![0.0],
            z: vec![0.0],
            slopes: vec![0.0; 2],
            steps: 0,
            spacing: None,
            finest,
            coarsest,
            range: 0.0,
        }
    }

    /// A smooth bump z = h/2 (1 − cos 2πx/L) as chords between `segments` + 1 equidistant points.
    ///
    /// # Errors
    /// A length that is not positive, a height not finite, fewer than two segments.
    pub fn one_minus_cosine(length: f64, height: f64, segments: usize, start: f64) -> Result<Self> {
        positive("length", length)?;
        finite("height", height)?;
        finite("start", start)?;
        if segments < 2 {
            return Err(Error::TooFew { argument: "segments", value: segments, least: 2 });
        }
        let share = |i: usize| i as f64 / segments as f64;
        let x = (0..=segments).map(|i| start + length * share(i)).collect();
        // sin² from the nearer end: the bump is symmetric to the last bit and ends at zero.
        let height_at = |i: usize| {
            let sine = libm::sin(std::f64::consts::PI * share(i.min(segments - i)));
            height * (sine * sine)
        };
        Self::new(x, (0..=segments).map(height_at).collect())
    }

    /// Stations of the breakpoints.
    #[must_use]
    pub fn x(&self) -> &[f64] {
        &self.x
    }

    /// Elevations of the breakpoints.
    #[must_use]
    pub fn z(&self) -> &[f64] {
        &self.z
    }

    /// Slope after so many breakpoints have been passed, n + 1 of them.
    #[inline]
    pub(crate) fn slopes(&self) -> &[f64] {
        &self.slopes
    }

    /// Stations at which anything happens: none on a level runway.
    #[inline]
    pub(crate) fn knots(&self) -> &[f64] {
        if self.is_level() { &[] } else { &self.x }
    }

    /// Distance between neighbouring stations, where it is one to the last digit.
    pub(crate) fn spacing(&self) -> Option<f64> {
        self.spacing
    }

    /// Shortest distance between two stations, infinite on the level.
    pub(crate) fn finest(&self) -> f64 {
        self.finest
    }

    /// How much of the distance between two neighbouring stations is in spans longer than `least`,
    /// and how many these are.
    pub(crate) fn long_spans(&self, least: f64) -> (f64, usize) {
        if self.coarsest <= least {
            return (0.0, 0);
        }
        let spans = self.x.windows(2).map(|pair| pair[1] - pair[0]).filter(|&span| span > least);
        spans.fold((0.0, 0), |(sum, count), span| (sum + span, count + 1))
    }

    /// Highest less lowest elevation.
    pub(crate) fn range(&self) -> f64 {
        self.range
    }

    /// Number of vertical steps.
    #[inline]
    pub(crate) fn steps(&self) -> usize {
        self.steps
    }

    /// Height of a vertical step that ends at the last of so many breakpoints.
    pub(crate) fn step_before(&self, passed: usize) -> f64 {
        match (self.x.get(passed.wrapping_sub(2)), self.x.get(passed - 1)) {
            (Some(before), Some(x)) if x <= before => self.z[passed - 1] - self.z[passed - 2],
            _ => 0.0,
        }
    }

    /// Whether the elevation is the same everywhere by construction (one point).
    #[must_use]
    pub fn is_level(&self) -> bool {
        self.x.len() == 1
    }

    /// Elevation at a station; at a step, after it.
    #[must_use]
    pub fn elevation(&self, station: f64) -> f64 {
        self.between(self.x.partition_point(|&x| x <= station), station)
    }

    /// Elevation at a station; at a step, before it.
    fn elevation_before(&self, station: f64) -> f64 {
        let next = self.x.partition_point(|&x| x < station);
        match self.x.get(next) {
            Some(&x) if x <= station => self.z[next],
            _ => self.between(next, station),
        }
    }

    /// Elevation on the line that ends at breakpoint `next`.
    fn between(&self, next: usize, station: f64) -> f64 {
        if next == 0 {
            return self.z[0];
        }
        if next == self.x.len() {
            return self.z[next - 1];
        }
        let (x0, z0) = (self.x[next - 1], self.z[next - 1]);
        let share = (station - x0) / (self.x[next] - x0);
        z0 + (self.z[next] - z0) * share
    }

    /// The same profile `dx` further down the runway.
    ///
    /// # Errors
    /// A shift that is not finite or takes a station out of range.
    pub fn shifted(&self, dx: f64) -> Result<Self> {
        finite("dx", dx)?;
        Self::new(self.x.iter().map(|x| x + dx).collect(), self.z.clone())
    }

    /// Sum of two profiles, with the breakpoints of both.
    ///
    /// # Errors
    /// A sum that overflows.
    pub fn sum(&self, other: &Self) -> Result<Self> {
        self.combine(other, |a, b| a + b)
    }

    /// f(this, other) for a linear f.
    fn combine(&self, other: &Self, f: impl Fn(f64, f64) -> f64) -> Result<Self> {
        let mut stations: Vec<f64> = self.x.iter().chain(&other.x).copied().collect();
        stations.sort_by(f64::total_cmp);
        stations.dedup();
        // Slope of the line that ends at a station, and the sum of the magnitudes of its two parts.
        let line_before = |index: usize| match stations.get(index) {
            Some(&at) => {
                let (one, two) = (self.slope_before(at), other.slope_before(at));
                (f(one, two), f(one, 0.0).abs() + f(0.0, two).abs())
            }
            None => (0.0, 0.0),
        };
        let mut draft = Draft::new(&stations);
        let (mut behind, mut here, mut last) = (0.0, line_before(0), stations[0]);
        for (i, &station) in stations.iter().enumerate() {
            let (next, (slope, steep)) = (line_before(i + 1), here);
            let z = f(self.elevation_before(station), other.elevation_before(station));
            draft.line_to((station, z), (station - last) * slope, steep.max(behind).max(next.1));
            (behind, here, last) = (steep, next, station);
            // Both sides of a step, whose breakpoint may be the first or the last.
            if self.steps_at(station) || other.steps_at(station) {
                draft.step_to(f(self.elevation(station), other.elevation(station)));
            }
        }
        Self::new(draft.x, draft.z)
    }

    /// Slope of the line that ends at a station or goes on there.
    fn slope_before(&self, station: f64) -> f64 {
        self.slopes[self.x.partition_point(|&x| x < station)]
    }

    fn steps_at(&self, station: f64) -> bool {
        let next = self.x.partition_point(|&x| x <= station);
        next >= 2 && self.x[next - 2] >= station
    }

    /// What a tire of contact length `length` feels: the mean elevation over
    /// [x − length/2, x + length/2].
    ///
    /// The mean of straight lines is piecewise quadratic: its slope is (z(x + length/2) −
    /// z(x − length/2)) ÷ length, itself piecewise linear. Each quadratic piece is replaced by
    /// equal chords through exact values, as many as keep the chords within `tolerance`
    /// of it (a chord of a quadratic of curvature κ errs by at most κ Δx²/8).
    ///
    /// # Errors
    /// A length or tolerance that is not positive, a length too short beside the stations, a
    /// tolerance that asks for too many chords.
    pub fn footprint(&self, length: f64, tolerance: f64) -> Result<Self> {
        positive("length", length)?;
        positive("tolerance", tolerance)?;
        let reach = self.x[0].abs().max(self.x[self.x.len() - 1].abs());
        if length < reach * SHORTEST_FOOTPRINT {
            let why = "too short beside the stations, whose rounding would be felt";
            return Err(Error::OutOfRange { place: "length".into(), value: length, why });
        }
        // From the first elevation, so that a high runway costs no digits.
        let base = self.z[0];
        let low = Self { z: self.z.iter().map(|z| z - base).collect(), ..self.clone() };
        let front = low.shifted(-0.5 * length)?;
        let back = low.shifted(0.5 * length)?;
        let slope = front.combine(&back, |f, b| (f - b) / length)?;
        let mut draft = Draft::new(&slope.x);
        draft.line_to((slope.x[0], base), 0.0, 0.0);
        let (mut mean, mut added) = (0.0, 0.0);
        for i in 1..slope.x.len() {
            let run = slope.x[i] - slope.x[i - 1];
            if run <= 0.0 {
                continue;
            }
            let (start, change) = (slope.z[i - 1], slope.z[i] - slope.z[i - 1]);
            let near = &slope.z[i.saturating_sub(2)..slope.z.len().min(i + 2)];
            let steepest = near.iter().fold(0.0, |most, slope| f64::max(most, slope.abs()));
            let chords = (0.125 * run * change.abs() / tolerance).sqrt().ceil().max(1.0);
            added += chords - 1.0;
            if added > MOST_CHORDS {
                let place = Place::from("tolerance");
                return Err(Error::OutOfRange { place, value: tolerance, why: "more than 1e7 chords" });
            }
            for chord in 1..=chords as usize {
                let (share, middle) = (chord as f64 / chords, (chord as f64 - 0.5) / chords);
                let station = if share < 1.0 { slope.x[i - 1] + run * share } else { slope.x[i] };
                let height = mean + run * share * (start + 0.5 * change * share);
                let rise = run / chords * (start + change * middle);
                draft.line_to((station, base + height), rise, steepest);
            }
            mean += run * (start + 0.5 * change);
        }
        let Draft { mut x, mut z, .. } = draft;
        // The end is known without the rounding of the sum; the last station may have been dropped.
        let last = x.len() - 1;
        (x[last], z[last]) = (slope.x[slope.x.len() - 1], self.z[self.z.len() - 1]);
        Self::new(x, z)
    }
}

/// Stations closer than this share of the farthest may be one but for rounding.
const NEAR: f64 = 1e-9;

/// Error of the slope between two of these, as a share of the steepest slope nearby, beyond which the
/// later one is dropped.
const MOST_SLOPE_ERROR: f64 = 1.0 / 256.0;

/// A profile in the making, whose rises are known more exactly than as differences of its elevations.
///
/// Between stations that are one but for rounding, the elevations would give a slope of nothing but
/// rounding, and dampers feel slopes. Of two such breakpoints the later is dropped, which moves the
/// profile by some last digits of its elevation.
struct Draft {
    x: Vec<f64>,
    z: Vec<f64>,
    /// Stations closer than this are near.
    near: f64,
    /// Exact rise since the last breakpoint kept, and the steepest slope nearby.
    rise: f64,
    steepest: f64,
}

impl Draft {
    /// Along these stations, or more between them.
    fn new(stations: &[f64]) -> Self {
        let (x, z) = (Vec::with_capacity(stations.len()), Vec::with_capacity(stations.len()));
        let farthest = stations[0].abs().max(stations[stations.len() - 1].abs());
        Self { x, z, near: NEAR * farthest, rise: 0.0, steepest: 0.0 }
    }

    /// Adds a breakpoint at (x, z). `rise` is the exact rise since the last call, `steepest` the largest
    /// slope nearby.
    ///
    /// A breakpoint near the last one kept is dropped if the slope between their elevations is further
    /// off that of the exact rise than [`MOST_SLOPE_ERROR`] allows.
    fn line_to(&mut self, (x, z): (f64, f64), rise: f64, steepest: f64) {
        self.rise += rise;
        self.steepest = self.steepest.max(steepest);
        if let (Some(from), Some(low)) = (self.x.last(), self.z.last()) {
            let (run, error) = (x - from, (z - low - self.rise).abs());
            if run <= self.near && error > MOST_SLOPE_ERROR * self.steepest * run {
                return;
            }
        }
        self.keep(x, z);
    }

    /// Adds a vertical step to another elevation.
    fn step_to(&mut self, z: f64) {
        self.keep(self.x[self.x.len() - 1], z);
    }

    fn keep(&mut self, x: f64, z: f64) {
        self.x.push(x);
        self.z.push(z);
        (self.rise, self.steepest) = (0.0, 0.0);
    }
}
