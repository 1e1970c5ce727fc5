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

/// A block of the tracks' breakpoints in one order.
///
/// A vertical step makes two knots at one distance. Slot 0 of a block is the last knot of the
/// block before; in the first block, a knot at the distance of the first of all.
#[derive(Clone, Debug)]
pub(crate) struct Knots<'a> {
    run: &'a Run,
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
    /// Where all tracks follow the foremost one, its place.
    shared: Option<InStep<'a>>,
    /// A row a track, where they do not: how many of its breakpoints have been passed after each knot.
    passed: Vec<[usize; SLOTS]>,
    /// Vertical steps in the block, in the order of their slots.
    pub steps: Vec<Step>,
    /// Whether there is a vertical step anywhere.
    pub has_steps: bool,
}

impl<'a> Knots<'a> {
    /// A block without knots.
    pub fn none(run: &'a Run) -> Self {
        let tracks = run.tracks.len();
        Self {
            run,
            len: 1,
            distance: Distances::INFINITE,
            time: [f64::INFINITY; SLOTS + 1],
            dt: [0.0; SLOTS],
            is_even: false,
            slopes: vec![[0.0; SLOTS]; tracks],
            shared: None,
            passed: vec![[0; SLOTS]; tracks],
            steps: Vec::new(),
            has_steps: run.tracks.iter().any(|track| track.profile.steps() > 0),
        }
    }

    /// Whose knots these are.
    pub fn run(&self) -> &'a Run {
        self.run
    }

    /// How many breakpoints of a track have been passed after the knot of a slot.
    fn passed(&self, track: usize, slot: usize) -> usize {
        match &self.shared {
            Some(shared) => shared.passed(track, slot),
            None => self.passed[track][slot],
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

/// How knots are put in order: as long as possible by following the foremost track.
#[derive(Clone, Debug)]
enum Order<'a> {
    Shared(InStep<'a>),
    Merged(Merge<'a>),
}

/// Finds the knots, block after block.
#[derive(Clone, Debug)]
pub(crate) struct Finder<'a> {
    run: &'a Run,
    order: Order<'a>,
    /// The last knot found, and a track each the slope after it.
    last: Distance,
    slopes: Vec<f64>,
}

impl<'a> Finder<'a> {
    pub fn new(run: &'a Run) -> Self {
        let tracks = run.tracks.len();
        let order = match &run.shared_knots {
            Some(shared) => Order::Shared(InStep::new(&run.tracks, shared)),
            None => Order::Merged(Merge::new(&run.tracks, std::iter::repeat_n(0, tracks))),
        };
        // No time passes before the first knot.
        Self { run, order, last: run.first_knot(), slopes: vec![0.0; tracks] }
    }

    /// Fills a block with the next knots; none are left when it has slot 0 only.
    pub fn find(&mut self, knots: &mut Knots<'a>) {
        next_block(self, knots);
        knots.find_steps();
    }
}

#[multiversion(targets("x86_64+avx2"))]
fn next_block<'a>(finder: &mut Finder<'a>, knots: &mut Knots<'a>) {
    let Finder { run, order, last, slopes } = finder;
    knots.distance.set(0, *last);
    for (to, slope) in knots.slopes.iter_mut().zip(&*slopes) {
        to[0] = *slope;
    }
    if let Order::Shared(shared) = order
        && shared.is_over()
    {
        *order = Order::Merged(Merge::new(&run.tracks, shared.all_passed()));
    }
    knots.len = match order {
        Order::Shared(shared) => shared.fill(&mut knots.distance, &mut knots.slopes),
        Order::Merged(merge) => merge.fill(&mut knots.distance, &mut knots.slopes, &mut knots.passed),
    };
    knots.shared = match order {
        Order::Shared(shared) => Some(*shared),
        Order::Merged(_) => None,
    };
    knots.is_even = knots.distance.divide(run.speed, &mut knots.time, &mut knots.dt[..knots.len]);
    knots.time[knots.len] = f64::INFINITY;
    *last = knots.distance.get(knots.len - 1);
    for (slope, from) in slopes.iter_mut().zip(&knots.slopes) {
        *slope = from[knots.len - 1];
    }
}
