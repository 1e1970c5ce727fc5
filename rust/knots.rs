//! The knots of all gears in the order in which they are met.

use crate::distance::Distance;
use crate::run::{Run, Track};

/// One track's place on its profile.
#[derive(Clone, Debug)]
pub(crate) struct Cursor<'a> {
    x: &'a [f64],
    z: &'a [f64],
    lag: Distance,
    next: usize,
    upcoming: Distance,
    passed: Distance,
    elevation: f64,
    /// Rate of elevation, speed × slope.
    pub rate: f64,
}

impl<'a> Cursor<'a> {
    fn new(track: &'a Track) -> Self {
        // A level profile has nothing to meet.
        let (x, z) = (track.profile.x(), track.profile.z());
        let x = if track.profile.is_level() { &x[1..] } else { x };
        let upcoming = x.first().map_or(Distance::INFINITE, |&x| track.lag.plus(x));
        Self {
            x,
            z,
            lag: track.lag,
            next: 0,
            upcoming,
            passed: Distance::INFINITE,
            elevation: z[0],
            rate: 0.0,
        }
    }

    /// Crosses the next breakpoint; gives the height of a vertical step there.
    #[inline]
    fn cross(&mut self, speed: f64) -> f64 {
        let i = self.next;
        let (x, z) = (self.x[i], self.z[i]);
        let step = if i > 0 && x <= self.x[i - 1] { z - self.z[i - 1] } else { 0.0 };
        self.elevation = z;
        self.passed = self.upcoming;
        self.next = i + 1;
        (self.upcoming, self.rate) = match self.x.get(i + 1) {
            Some(&end) => {
                // Slopes from differences of station, never of rounded times.
                let run = end - x;
                let rate = if run > 0.0 { speed * ((self.z[i + 1] - z) / run) } else { 0.0 };
                (self.lag.plus(end), rate)
            }
            None => (Distance::INFINITE, 0.0),
        };
        step
    }

    /// Elevation at a distance rolled, not past the next breakpoint.
    pub fn elevation(&self, distance: Distance, speed: f64) -> f64 {
        if self.rate == 0.0 {
            self.elevation
        } else {
            self.elevation + self.rate * (distance.minus(self.passed) / speed)
        }
    }
}

/// Merges the tracks' breakpoints.
#[derive(Clone, Debug)]
pub(crate) struct Knots<'a> {
    pub cursors: Vec<Cursor<'a>>,
    /// The next knot.
    pub upcoming: Distance,
    speed: f64,
}

impl<'a> Knots<'a> {
    pub fn new(run: &'a Run) -> Self {
        let cursors: Vec<Cursor> = run.tracks.iter().map(Cursor::new).collect();
        let mut knots = Self { cursors, upcoming: Distance::INFINITE, speed: run.speed };
        knots.find_upcoming();
        knots
    }

    #[inline]
    fn find_upcoming(&mut self) {
        self.upcoming = Distance::INFINITE;
        for cursor in &self.cursors {
            if cursor.upcoming < self.upcoming {
                self.upcoming = cursor.upcoming;
            }
        }
    }

    /// Rounded time of the next knot: the name of an instant that is known more exactly.
    #[inline]
    pub fn upcoming_time(&self) -> Option<f64> {
        let distance = self.upcoming.nearest();
        (distance < f64::INFINITY).then(|| distance / self.speed)
    }

    /// Crosses the next knot on every track that has it; tells each vertical step
    /// (track, height) and whether there was one.
    #[inline]
    pub fn cross(&mut self, mut step: impl FnMut(usize, f64)) -> bool {
        let knot = self.upcoming;
        let mut stepped = false;
        for (track, cursor) in self.cursors.iter_mut().enumerate() {
            while cursor.upcoming == knot {
                let height = cursor.cross(self.speed);
                if height != 0.0 {
                    stepped = true;
                    step(track, height);
                }
            }
        }
        self.find_upcoming();
        stepped
    }
}
