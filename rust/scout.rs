//! What a march will need, made ready by another thread: the next knots, and memory for the results.
//!
//! To put irregular knots of several tracks in order is nearly as much work as to march over them, and
//! needs no state; nor does it to fetch memory. So a long march does both at once. What it gives are the
//! same bits: the knots are the same, found in the same order.

use std::collections::VecDeque;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread::{self, Scope};

use crate::knots::{Finder, Knots, SLOTS};
use crate::pages::Pages;
use crate::parallel::thread_count;
use crate::run::Run;

/// Fewer knots are marched over in a few milliseconds, and not worth a thread: one that has to wait for a
/// core costs more than it gives.
const WORTH: usize = 1 << 19;

/// Nor are those that gears share. They are found in a tenth of the time; but from here on memory for
/// the results comes fresh from the system.
const WORTH_SHARED: usize = 1 << 21;

/// Blocks that change threads together: waking the other takes as long as a march over some of them.
const TOGETHER: usize = 256;

/// Lots in circulation: one is marched over, one waits, one is found.
const LOTS: usize = 3;

/// Gives one block of knots after another.
pub(crate) enum Supply<'a> {
    /// Finds them itself.
    Here(Finder<'a>),
    /// Gets them from another thread.
    Elsewhere(Ahead<'a>),
}

impl<'a> Supply<'a> {
    /// Puts the next block in the place of one that is done with.
    pub fn next(&mut self, knots: &mut Box<Knots<'a>>) {
        match self {
            Self::Here(finder) => finder.find(knots),
            Self::Elsewhere(ahead) => ahead.next(knots),
        }
    }
}

type Blocks<'a> = VecDeque<Box<Knots<'a>>>;

/// Blocks that another thread finds.
pub(crate) struct Ahead<'a> {
    ready: Blocks<'a>,
    done: Blocks<'a>,
    found: Receiver<Blocks<'a>>,
    to_fill: Sender<Blocks<'a>>,
}

impl<'a> Ahead<'a> {
    fn next(&mut self, knots: &mut Box<Knots<'a>>) {
        if self.ready.is_empty() {
            // Nobody takes or sends any more only if the other thread has panicked, which its scope passes on.
            if !self.done.is_empty() {
                let _ = self.to_fill.send(std::mem::take(&mut self.done));
            }
            self.ready = self.found.recv().unwrap_or_default();
        }
        let next = self.ready.pop_front().unwrap_or_else(|| Box::new(Knots::none(knots.run())));
        self.done.push_back(std::mem::replace(knots, next));
    }
}

/// Does some work with the knots of a run up to some time; a row of `pages` a knot will be written to.
pub(crate) fn with_knots<'a>(run: &'a Run, end: f64, pages: Pages, work: impl FnOnce(&mut Supply<'a>)) {
    let here = || Supply::Here(Finder::new(run));
    let knots = run.most_knots_by(end);
    if !is_worth_it(run, knots, &pages) {
        return work(&mut here());
    }
    let over = AtomicBool::new(false);
    thread::scope(|scope| {
        let helped = if run.shared_knots.is_some() {
            fetch_pages(scope, knots, pages, &over).map(|()| here())
        } else {
            find_knots(scope, run, pages).map(Supply::Elsewhere)
        };
        // Where the system gives no thread, this one does without.
        work(&mut helped.unwrap_or_else(here));
        over.store(true, Ordering::Relaxed);
    });
}

/// Whether there is enough to do, and a thread free for it: not if this one is of many that share work.
fn is_worth_it(run: &Run, knots: usize, pages: &Pages) -> bool {
    let enough =
        if run.shared_knots.is_some() { knots >= WORTH_SHARED && !pages.are_none() } else { knots >= WORTH };
    enough && rayon::current_thread_index().is_none() && thread_count() > 1
}

/// Has another thread fetch the pages until all is over.
fn fetch_pages<'s>(
    scope: &'s Scope<'s, '_>,
    knots: usize,
    mut pages: Pages,
    over: &'s AtomicBool,
) -> Option<()> {
    let steps = knots / (TOGETHER * SLOTS);
    let fetch = move || {
        for _ in 0..steps {
            if over.load(Ordering::Relaxed) {
                return;
            }
            pages.fetch(TOGETHER * SLOTS);
        }
    };
    thread::Builder::new().spawn_scoped(scope, fetch).ok().map(|_| ())
}

/// Has another thread find the knots, and fetch a page for each.
fn find_knots<'s, 'a: 's>(scope: &'s Scope<'s, '_>, run: &'a Run, mut pages: Pages) -> Option<Ahead<'a>> {
    let (to_fill, empty) = channel::<Blocks>();
    let (send, found) = channel();
    let find = move || {
        let mut finder = Finder::new(run);
        for mut blocks in empty {
            for knots in &mut blocks {
                finder.find(knots);
            }
            pages.fetch(blocks.len() * SLOTS);
            if send.send(blocks).is_err() {
                return;
            }
        }
    };
    thread::Builder::new().spawn_scoped(scope, find).ok()?;
    for _ in 0..LOTS {
        let _ = to_fill.send((0..TOGETHER).map(|_| Box::new(Knots::none(run))).collect());
    }
    Some(Ahead { ready: Blocks::new(), done: Blocks::new(), found, to_fill })
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::aircraft::{Aircraft, Gear, Inertia};
    use crate::modes::{Damping, Modes};
    use crate::profile::Profile;

    /// More blocks than change threads together, and vertical steps.
    const STATIONS: usize = 3 * TOGETHER * SLOTS;

    fn run(spacing: impl Fn(usize) -> f64) -> Run {
        let inertia = Inertia { mass: 145.5, pitch: 1.92e6, roll: 6.56e5, gravity: 386.0886 };
        let gear = |name, x, y, stiffness| Gear::new(name, x, y, stiffness, 0.0).unwrap();
        let gears = vec![gear("nose", 234.9, 0.0, 1502.0), gear("main", -44.35, 0.0, 18204.0)];
        let modes = Modes::natural(Arc::new(Aircraft::new(inertia, gears).unwrap()), Damping::Dampers);
        let mut station = 0.0;
        let x = (0..STATIONS).map(|i| {
            station += spacing(i);
            station
        });
        let z = (0..STATIONS).map(|i| (i * i % 11) as f64);
        let profile = Arc::new(Profile::new(x.collect(), z.collect()).unwrap());
        Run::new(Arc::new(modes.unwrap()), &[Arc::clone(&profile), profile], 405.0, false).unwrap()
    }

    /// The bits of what the march reads of all blocks, the last one empty.
    fn read<'a>(run: &'a Run, supply: &mut Supply<'a>) -> Vec<Vec<u64>> {
        let mut knots = Box::new(Knots::none(run));
        let mut blocks = Vec::new();
        loop {
            supply.next(&mut knots);
            let slot =
                |slot: usize| [knots.time[slot], knots.dt[slot], knots.slope(slot, 0), knots.slope(slot, 1)];
            let steps = knots.steps.iter().flat_map(|step| [step.slot as f64, step.height]);
            blocks.push((1..knots.len).flat_map(slot).chain(steps).map(f64::to_bits).collect());
            if knots.len == 1 {
                return blocks;
            }
        }
    }

    #[test]
    fn the_same_blocks_come_from_another_thread() {
        let uneven = |i: usize| 0.1 + (i * i % 7) as f64 / 7.0;
        let stepped = |i: usize| if i % 100 == 3 { 0.0 } else { uneven(i) };
        for run in [run(uneven), run(stepped), run(|_| 0.25)] {
            let alone = read(&run, &mut Supply::Here(Finder::new(&run)));
            assert!(alone.len() > 2 * TOGETHER);
            let beside = thread::scope(|scope| {
                read(&run, &mut Supply::Elsewhere(find_knots(scope, &run, Pages::default()).unwrap()))
            });
            assert!(alone == beside);
        }
    }

    #[test]
    fn a_march_may_end_early() {
        let run = run(|_| 0.3);
        for blocks in [0, 1, TOGETHER, TOGETHER + 1] {
            let mut knots = Box::new(Knots::none(&run));
            thread::scope(|scope| {
                let mut ahead = find_knots(scope, &run, Pages::default()).unwrap();
                (0..blocks).for_each(|_| ahead.next(&mut knots));
            });
        }
    }
}
