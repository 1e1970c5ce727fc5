//! The knots of all gears in the order in which they are met.
//!
//! They are put in order a block at a time: distances, times and lengths of segments then come out
//! of plain loops over arrays, and the march that consumes them is not held up by divisions.

use multiversion::multiversion;

use crate::distance::{Distance, Distances};
use crate::lanes::Lanes;
use crate::merge::Merge;
use crate::run::Run;
use crate::shared_knots::InStep;
use crate::track::Track;

/// Slots of a block.
pub(crate) const SLOTS: usize = 64;

/// A vertical step under the gears of a track.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Step {
    /// Slot of its knot.
    pub slot: usize,
    pub track: usize,
    pub height: f64,
}

/// How knots are put in order: as long as possible by following the foremost track.
#[derive(Clone, Debug)]
enum Order<'a> {
    Shared(InStep<'a>),
    Merged(Merge<'a, SLOTS>),
}

/// The tracks' breakpoints in one order, a block of knots at a time.
///
/// A vertical step makes two knots at one distance. Slot 0 of a block is the last knot of the
/// block before; in the first block, a knot at the distance of the first of all.
#[derive(Clone, Debug)]
pub(crate) struct Knots<'a> {
    run: &'a Run,
    order: Order<'a>,
    /// Slots in use.
    pub len: usize,
    distance: Distances<SLOTS>,
    /// Rounded times: labels of instants that are known more exactly. Infinite in the slot after the
    /// last knot.
    pub time: [f64; SLOTS + 1],
    /// Time from the knot before.
    pub dt: [f64; SLOTS],
    /// Whether the block has knots after slot 0, and the times between them are all the same.
    pub is_even: bool,
    /// A row a track: slope after each knot.
    pub slopes: Vec<[f64; SLOTS]>,
    /// Vertical steps in the block, in the order of their slots.
    pub steps: Vec<Step>,
    /// Whether there is a vertical step anywhere.
    pub has_steps: bool,
}

impl<'a> Knots<'a> {
    /// The first block.
    pub fn new(run: &'a Run) -> Self {
        let tracks = run.tracks.len();
        let order = match &run.shared_knots {
            Some(shared) => Order::Shared(InStep::new(&run.tracks, shared)),
            None => Order::Merged(Merge::new(&run.tracks, std::iter::repeat_n(0, tracks))),
        };
        let mut knots = Self {
            run,
            order,
            len: 1,
            distance: Distances::INFINITE,
            time: [f64::INFINITY; SLOTS + 1],
            dt: [0.0; SLOTS],
            is_even: false,
            slopes: vec![[0.0; SLOTS]; tracks],
            steps: Vec::new(),
            has_steps: run.tracks.iter().any(|track| track.profile.steps() > 0),
        };
        // No time passes before the first knot.
        knots.distance.set(0, run.first_knot());
        knots.advance();
        knots
    }

    /// Goes on to the next block; whether there is one.
    pub fn advance(&mut self) -> bool {
        next_block(self);
        self.find_steps();
        self.len > 1
    }

    /// How many breakpoints of a track have been passed after the knot of a slot.
    fn passed(&self, track: usize, slot: usize) -> usize {
        match &self.order {
            Order::Shared(shared) => shared.passed(track, slot),
            Order::Merged(merge) => merge.passed(track, slot),
        }
    }

    /// Finds the vertical steps that end at the knots of the block.
    fn find_steps(&mut self) {
        self.steps.clear();
        if !self.has_steps {
            return;
        }
        for slot in 1..self.len {
            for track in 0..self.run.tracks.len() {
                let height = self.step(slot, track, 0);
                if height != 0.0 {
                    self.steps.push(Step { slot, track, height });
                }
            }
        }
    }

    /// Height of a vertical step that ends so many breakpoints after the one a track meets at the
    /// knot of a slot.
    fn step(&self, slot: usize, track: usize, after: usize) -> f64 {
        let passed = self.passed(track, slot);
        if passed > self.passed(track, slot - 1) {
            self.run.tracks[track].profile.step_before(passed + after)
        } else {
            0.0
        }
    }

    /// Whether a vertical step begins at the knot of a slot; its end is the next knot.
    pub fn begins_step(&self, slot: usize) -> bool {
        slot < self.len && (0..self.run.tracks.len()).any(|track| self.step(slot, track, 1) != 0.0)
    }

    /// The knot of a slot.
    pub fn distance(&self, slot: usize) -> Distance {
        self.distance.get(slot)
    }

    /// Slope under a track after the knot of a slot.
    #[inline(always)]
    pub fn slope(&self, slot: usize, track: usize) -> f64 {
        self.slopes[track][slot]
    }

    /// How far the static position of each mode has risen by the knot of a slot since the start.
    pub fn risen(&self, slot: usize) -> Lanes {
        let tracks = self.run.tracks.iter().enumerate();
        tracks.fold(Lanes::ZERO, |sum, (index, track)| {
            let (base, climb) = self.elevation(slot, index, self.distance(slot));
            sum + track.lift * ((base - track.profile.z()[0]) + climb)
        })
    }

    /// Elevation under a track at a distance between the knot of a slot and the next, as that of
    /// the last breakpoint and the climb since: the difference of two tracks high above the datum
    /// keeps its digits only if these are not added up first.
    pub fn elevation(&self, slot: usize, track: usize, distance: Distance) -> (f64, f64) {
        let passed = self.passed(track, slot);
        let Track { profile, lag, .. } = &self.run.tracks[track];
        let base = profile.z()[passed.saturating_sub(1)];
        match self.slope(slot, track) {
            0.0 => (base, 0.0),
            slope => (base, slope * distance.minus(lag.plus(profile.x()[passed - 1]))),
        }
    }
}

/// Fills the block with the next knots.
#[multiversion(targets("x86_64+avx2"))]
fn next_block(knots: &mut Knots) {
    let Knots { run, order, distance, slopes, .. } = knots;
    let last = knots.len - 1;
    distance.set(0, distance.get(last));
    for slopes in &mut *slopes {
        slopes[0] = slopes[last];
    }
    if let Order::Shared(shared) = order
        && shared.is_over()
    {
        let passed = (0..run.tracks.len()).map(|track| shared.passed(track, last));
        *order = Order::Merged(Merge::new(&run.tracks, passed));
    }
    knots.len = match order {
        Order::Shared(shared) => shared.fill(distance, slopes),
        Order::Merged(merge) => merge.fill(distance, slopes),
    };
    knots.is_even = knots.distance.divide(run.speed, &mut knots.time, &mut knots.dt[..knots.len]);
    knots.time[knots.len] = f64::INFINITY;
}
