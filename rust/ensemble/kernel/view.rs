//! One output's values along a block.

use std::ops::Range;

use pulp::Simd;

use super::super::constants::States;
use super::super::vector::{Part, Vector};
use super::{CHUNK, March, MoreRows};
use crate::modes::MODES;

/// Where a leg of a period begins: leg and period.
pub(super) type LegStart = (usize, usize);

/// One output of a register's runs over a block; `RATES` where velocities enter, `LINES` where slopes
/// or elevations do, so that it may jump.
pub(super) struct View<'m, S: Simd, const RATES: bool, const LINES: bool> {
    pub march: &'m March,
    pub part: Part<S>,
    pub output: usize,
    weights: States<Vector<S>>,
    /// Legs of the block at whose start its slope may jump; with `LINES`, all of them.
    pub kinks: &'m [usize],
    pub count: usize,
    legs: usize,
}

/// Does something with the view of an output, of whichever kind that is. A macro, since closures are not
/// compiled for the chosen instructions.
macro_rules! with_view {
    ($march:expr, $part:expr, $output:expr, $block:expr, $view:ident => $do:expr) => {
        match ($march.layout.by_rate[$output], $march.layout.lines) {
            (false, false) => {
                let $view = View::<S, false, false>::new($march, $part, $output, $block);
                $do
            }
            (true, false) => {
                let $view = View::<S, true, false>::new($march, $part, $output, $block);
                $do
            }
            (_, true) => {
                let $view = View::<S, true, true>::new($march, $part, $output, $block);
                $do
            }
        }
    };
}
pub(super) use with_view;

impl<'m, S: Simd, const RATES: bool, const LINES: bool> View<'m, S, RATES, LINES> {
    #[inline(always)]
    pub fn new(march: &'m March, part: Part<S>, output: usize, (count, legs): (usize, usize)) -> Self {
        let weights = part.load_all(&march.constants.weights[output].state);
        let kinks = &march.layout.kinks[output][..];
        let kinks = &kinks[..kinks.partition_point(|&leg| leg < legs)];
        Self { march, part, output, weights, kinks, count, legs }
    }

    #[inline(always)]
    pub fn periods(&self, chunk: usize) -> Range<usize> {
        CHUNK * chunk..self.count.min(CHUNK * (chunk + 1))
    }

    /// Where so many periods end.
    #[inline(always)]
    pub fn end(&self, periods: usize) -> LegStart {
        self.march.layout.after(self.legs - 1, periods - 1)
    }

    /// The largest and the smallest value in a chunk, which starts with this one, and the last.
    #[inline(always)]
    pub fn edges(&self, chunk: usize, start: Vector<S>) -> ([Vector<S>; 2], Vector<S>) {
        let periods = self.periods(chunk);
        let mut from = (0, periods.start);
        let [mut top, mut bottom] = [start; 2];
        if LINES {
            for i in periods.clone() {
                for &leg in self.kinks {
                    let (before, after) = (self.before(from, (leg, i)), self.after((leg, i)));
                    (top, bottom) = (top.max(before).max(after), bottom.min(before).min(after));
                    from = (leg, i);
                }
            }
        } else {
            for &leg in self.kinks {
                let states = &self.march.states[leg];
                for i in periods.clone() {
                    let value = value::<S, RATES>(self.part, &self.weights, states, i);
                    (top, bottom) = (top.max(value), bottom.min(value));
                }
            }
        }
        let end = self.before(from, self.end(periods.end));
        ([top.max(end), bottom.min(end)], end)
    }

    /// The value just after a place.
    #[inline(always)]
    pub fn after(&self, (leg, i): LegStart) -> Vector<S> {
        let value = value::<S, RATES>(self.part, &self.weights, &self.march.states[leg], i);
        if LINES { value + self.march.lines(self.part, self.output, (leg, i), false) } else { value }
    }

    /// The value just before a place, coming from another. With `LINES`, the place is `from` itself, or
    /// where the leg that begins at `from` ends: the lines are those of that leg.
    #[inline(always)]
    pub fn before(&self, from: LegStart, (leg, i): LegStart) -> Vector<S> {
        debug_assert!(!LINES || (leg, i) == from || (leg, i) == self.march.layout.after(from.0, from.1));
        let value = value::<S, RATES>(self.part, &self.weights, &self.march.states[leg], i);
        // No leg ends at the place itself: the value there.
        if LINES && from != (leg, i) {
            value + self.march.lines(self.part, self.output, from, true)
        } else if LINES {
            self.after(from)
        } else {
            value
        }
    }
}

impl March {
    /// What elevations and slopes add to values at the starts, or just before the ends, of legs.
    #[inline(always)]
    pub(super) fn lines<S: Simd>(
        &self,
        part: Part<S>,
        output: usize,
        (leg, i): (usize, usize),
        at_end: bool,
    ) -> Vector<S> {
        let weights = &self.constants.weights[output];
        let rises = if at_end { &weights.end_rise[leg] } else { &weights.rise };
        let mut line = part.all(0.0);
        for group in 0..self.ground.len() {
            let met = usize::from(self.layout.groups[group].leg <= leg);
            line = line + part.load(&rises[group]) * part.load(&self.ground[group].rise[i + met]);
            if self.layout.heights {
                let height = part.load(&weights.height[group]) * part.load(&self.heights[leg][group][i]);
                line = line + (height + part.load(&weights.first[group]) * part.load(&self.first[group]));
            }
        }
        line
    }
}

/// What a state gives; without rates, displacements alone.
#[inline(always)]
pub(super) fn value<S: Simd, const RATES: bool>(
    part: Part<S>,
    weights: &States<Vector<S>>,
    states: &States<MoreRows>,
    i: usize,
) -> Vector<S> {
    let mut value = weights[0] * part.load(&states[0][i]);
    for k in 1..MODES {
        value = value + weights[k] * part.load(&states[k][i]);
    }
    if RATES {
        let mut rates = weights[MODES] * part.load(&states[MODES][i]);
        for k in MODES + 1..2 * MODES {
            rates = rates + weights[k] * part.load(&states[k][i]);
        }
        value = value + rates;
    }
    value
}
