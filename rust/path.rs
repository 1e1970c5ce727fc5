//! What can be known of a block without a state: its knots, the transitions between them, and
//! what drives the modes between them.

use multiversion::multiversion;

use crate::knots::{Knots, SLOTS};
use crate::lanes::Lanes;
use crate::pair::Pair;
use crate::run::Run;
use crate::scout::Supply;
use crate::transition::{Drive, Oscillators, State, Transition};

/// Hashes of Δt: so many more than places that two of them seldom share one.
const HASHES: usize = 256;

/// Transitions by the bits of their Δt, a block's worth. Nominally equal segments differ by the
/// rounding of their stations and then take a handful of values between them; a lag between
/// gears splits every segment in the same two.
#[derive(Clone, Debug)]
struct Kept {
    dt: [f64; SLOTS],
    /// As many as were needed so far.
    transition: Vec<Transition>,
    /// Where a Δt may be found, by a hash of its bits.
    place: [u8; HASHES],
    /// One bit a place: whether the block at hand uses it.
    used: u64,
    next: u8,
}

// A bit a place.
const _: () = assert!(SLOTS == u64::BITS as usize);

impl Kept {
    fn new(bank: &Oscillators) -> Self {
        let mut transition = Vec::with_capacity(SLOTS);
        transition.push(bank.over(0.0));
        Self { dt: [0.0; SLOTS], transition, place: [0; HASHES], used: 0, next: 0 }
    }

    /// Place of the transition over `dt`, which is likely that of the last one.
    #[inline(always)]
    fn place(&mut self, bank: &Oscillators, dt: f64, last: u8) -> u8 {
        if self.dt[usize::from(last) % SLOTS] == dt {
            return last;
        }
        let hash = (dt.to_bits().wrapping_mul(0x9E37_79B9_7F4A_7C15) >> 56) as usize % HASHES;
        let mut place = self.place[hash];
        if self.dt[usize::from(place) % SLOTS] != dt {
            // A block has fewer segments than there are places: one is free.
            while self.used >> self.next & 1 == 1 {
                self.next = (self.next + 1) % SLOTS as u8;
            }
            place = self.next;
            self.place[hash] = place;
            self.dt[usize::from(place)] = dt;
            if self.transition.len() <= usize::from(place) {
                self.transition.push(self.transition[0]);
            }
            let transition = &mut self.transition[usize::from(place)];
            *transition = bank.over(dt);
        }
        self.used |= 1 << place;
        place
    }

    #[inline(always)]
    fn get(&self, place: u8) -> &Transition {
        &self.transition[usize::from(place)]
    }
}

/// Segments marched over between two detours through memory; even, as they are taken in pairs.
const ROUND: usize = 32;

/// How the march gets the transitions of a block.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Way {
    /// All segments are of one length: two at a stride.
    Even,
    /// All are short: computed as the march proceeds, while it waits for its last state, and not kept.
    Short,
    /// Looked up among those kept.
    Kept,
}

/// A block of knots and the transitions between them: all that can be known without a state.
#[derive(Clone, Debug)]
pub(crate) struct Path<'a> {
    pub run: &'a Run,
    pub knots: Box<Knots<'a>>,
    way: Way,
    pair: Pair,
    /// Transition to each knot: its place among those kept.
    place: [u8; SLOTS],
    kept: Kept,
}

impl<'a> Path<'a> {
    /// Before the first knot.
    pub fn new(run: &'a Run) -> Self {
        let (pair, kept) = (Pair::new(&run.oscillators, 0.0), Kept::new(&run.oscillators));
        let knots = Box::new(Knots::none(run));
        Self { run, knots, way: Way::Kept, pair, place: [0; SLOTS], kept }
    }

    /// Goes on to the next block.
    pub fn advance(&mut self, supply: &mut Supply<'a>) {
        supply.next(&mut self.knots);
        find_transitions(self);
    }

    /// Transition to the knot of a slot.
    #[inline(always)]
    pub fn transition(&self, slot: usize) -> Transition {
        match self.way {
            Way::Even => self.pair.once,
            Way::Short => self.short(slot),
            Way::Kept => *self.kept(slot),
        }
    }

    #[inline(always)]
    fn short(&self, slot: usize) -> Transition {
        self.run.oscillators.over_short(self.knots.dt[slot])
    }

    #[inline(always)]
    fn kept(&self, slot: usize) -> &Transition {
        self.kept.get(self.place[slot])
    }

    /// What drives the modes after the knot of a slot.
    #[inline(always)]
    pub fn drive(&self, slot: usize) -> Drive {
        let mut drive = Drive { beta: Lanes::ZERO, gamma: Lanes::ZERO };
        for (index, track) in self.run.tracks.iter().enumerate() {
            drive.beta += self.share(index).beta(slot);
            if self.run.damping_input {
                drive.gamma += track.drag * (self.knots.slope(slot, index) * self.run.speed);
            }
        }
        drive
    }

    /// The last state of a block in which nothing happens at the knots but changes of slope;
    /// `trail` sees the others.
    #[inline(always)]
    pub fn follow(&self, from: State, trail: &mut impl Trail) -> State {
        // The number of tracks as a constant where it is small: its loop unrolls.
        match self.run.tracks.len() {
            1 => self.follow_tracks::<1>(from, trail),
            2 => self.follow_tracks::<2>(from, trail),
            3 => self.follow_tracks::<3>(from, trail),
            _ => self.follow_tracks::<0>(from, trail),
        }
    }

    /// `N` tracks, all for `N` = 0.
    #[inline(always)]
    fn follow_tracks<const N: usize>(&self, from: State, trail: &mut impl Trail) -> State {
        let few: [Share; N] = std::array::from_fn(|track| self.share(track));
        let many: Vec<Share>;
        let shares = if N == 0 {
            many = (0..self.run.tracks.len()).map(|track| self.share(track)).collect();
            &many[..]
        } else {
            &few[..]
        };
        // Opaque, so that the compiler keeps lanes together in the loop: otherwise it shuffles them,
        // in more than twice the instructions. What is opaque lives in memory, which would
        // take half of a row's time: so most rows are gone through in another variable.
        let mut now = std::hint::black_box(from);
        let mut slot = 1;
        while slot < self.knots.len {
            let end = (slot + ROUND).min(self.knots.len);
            let mut here = now;
            match self.way {
                Way::Even => {
                    let pair = &self.pair;
                    while slot + 1 < end {
                        let rates = [beta(shares, slot - 1), beta(shares, slot)];
                        trail.see(slot - 1, &here);
                        trail.see(slot, &pair.once.follow(&here, rates[0]));
                        here = pair.follow(&here, rates);
                        slot += 2;
                    }
                    if slot < end {
                        here = turn(shares, slot, &pair.once, &here, trail);
                    }
                }
                Way::Short => {
                    for slot in slot..end {
                        here = turn(shares, slot, &self.short(slot), &here, trail);
                    }
                }
                Way::Kept => {
                    for slot in slot..end {
                        here = turn(shares, slot, self.kept(slot), &here, trail);
                    }
                }
            }
            (now, slot) = (here, end);
        }
        now
    }

    #[inline(always)]
    fn share(&self, track: usize) -> Share<'_> {
        Share { climb: self.run.tracks[track].climb, slopes: &self.knots.slopes[track] }
    }
}

/// From the knot before a slot to that of the slot.
#[inline(always)]
fn turn(shares: &[Share], slot: usize, over: &Transition, from: &State, trail: &mut impl Trail) -> State {
    trail.see(slot - 1, from);
    over.follow(from, beta(shares, slot - 1))
}

/// Rate of the static position ÷ ω after the knot of a slot.
#[inline(always)]
fn beta(shares: &[Share], slot: usize) -> Lanes {
    shares[1..].iter().fold(shares[0].beta(slot), |sum, share| sum + share.beta(slot))
}

/// What one track adds to the rate of the static position.
struct Share<'a> {
    climb: Lanes,
    slopes: &'a [f64; SLOTS],
}

impl Share<'_> {
    #[inline(always)]
    fn beta(&self, slot: usize) -> Lanes {
        self.climb * self.slopes[slot]
    }
}

/// Finds the transitions of a block.
#[multiversion(targets("x86_64+avx2"))]
fn find_transitions(path: &mut Path) {
    let Path { run, knots, way, pair, place, kept } = path;
    let bank = &run.oscillators;
    if knots.is_even {
        *way = Way::Even;
        if knots.dt[1] != pair.dt {
            *pair = Pair::new(bank, knots.dt[1]);
        }
        return;
    }
    let short = |dt: &f64| bank.is_short(*dt);
    if knots.dt[1..knots.len].iter().fold(true, |all, dt| all & short(dt)) {
        *way = Way::Short;
        return;
    }
    *way = Way::Kept;
    let mut last = place[0];
    kept.used = 1 << last;
    for slot in 1..knots.len {
        last = kept.place(bank, knots.dt[slot], last);
        place[slot] = last;
    }
    place[0] = last;
}

/// Sees the states in which the segments of a block begin, one by one.
pub(crate) trait Trail {
    fn see(&mut self, slot: usize, state: &State);
}

impl Trail for [State; SLOTS] {
    #[inline(always)]
    fn see(&mut self, slot: usize, state: &State) {
        self[slot] = *state;
    }
}
