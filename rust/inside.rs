//! The inside of segments: states at several times.
//!
//! From the start of a segment there are whole strides, and what is left of the last one. A
//! stride is a power of two and at most a radian, so that the number of strides and what is left
//! are exact, and a Taylor step does the rest. Strides are taken by the binary digits of their
//! number, the largest first: a state depends on its segment and time alone, and from one time to
//! the next nearly all digits stay. Four times side by side take the last step together, mode by mode;
//! one alone takes it with its modes side by side, by the same operations.

use std::hint::black_box;

use multiversion::multiversion;

use crate::distance::Distance;
use crate::lanes::{LANES, Lanes};
use crate::march::Segment;
use crate::run::Run;
use crate::transition::{Drive, Oscillators, State, Transition};

/// No more times are looked at at once.
pub(crate) const AT_ONCE: usize = 64;

/// Whole strides from the start of a segment.
#[derive(Clone, Debug)]
struct Walk {
    count: u64,
    /// Entry n: the state after that number without its last n digits.
    path: Vec<State>,
    /// Transitions over 1, 2, 4, … strides, as far as they were needed.
    strides: Vec<Transition>,
}

impl Walk {
    #[inline(always)]
    fn start(&mut self, state: State) {
        self.count = 0;
        self.path.clear();
        self.path.push(state);
    }

    /// State after so many strides.
    #[inline(always)]
    fn to(&mut self, count: u64, bank: &Oscillators, drive: &Drive) -> &State {
        if count != self.count {
            let digits = (u64::BITS - (count ^ self.count).leading_zeros()) as usize;
            if self.path.len() <= digits {
                // Digits that were all zero so far.
                let start = self.path[self.path.len() - 1];
                self.path.resize(digits + 1, start);
            }
            while self.strides.len() < digits {
                let twice = bank.doubled(&self.strides[self.strides.len() - 1]);
                self.strides.push(twice);
            }
            for digit in (0..digits).rev() {
                let from = self.path[digit + 1];
                let taken = count >> digit & 1 == 1;
                self.path[digit] = if taken { self.strides[digit].apply(&from, drive) } else { from };
            }
            self.count = count;
        }
        &self.path[0]
    }
}

/// Times of which each is better off alone: modes side by side are as many as three times.
const FEW: usize = 2;

/// Looks into one segment after another.
#[derive(Clone, Debug)]
pub(crate) struct Inside<'a> {
    run: &'a Run,
    /// Each mode in a bank of its own, whose lanes are times.
    alone: Vec<Oscillators>,
    walk: Walk,
    states: [State; AT_ONCE],
}

impl<'a> Inside<'a> {
    pub fn new(run: &'a Run) -> Self {
        let bank = &run.oscillators;
        let alone = (0..run.modes.omega().len()).map(|mode| bank.alone(mode)).collect();
        let walk = Walk { count: 0, path: Vec::new(), strides: vec![bank.over_stride()] };
        Self { run, alone, walk, states: [State::REST; AT_ONCE] }
    }

    /// States of a segment at times that do not decrease, [`AT_ONCE`] at most: just before its
    /// end if that is a time.
    pub fn states(&mut self, segment: &Segment, times: &[f64]) -> &[State] {
        find_states(self, segment, times);
        &self.states[..times.len()]
    }
}

#[multiversion(targets("x86_64+avx2"))]
fn find_states(inside: &mut Inside, segment: &Segment, times: &[f64]) {
    let Inside { run, alone, walk, states } = inside;
    let before = times.iter().take_while(|&&time| time <= segment.start).count();
    states[..before].fill(*segment.state());
    let (times, states) = (&times[before..], &mut states[before..]);
    if times.is_empty() {
        return;
    }
    let (bank, drive) = (&run.oscillators, segment.drive());
    let (begin, end) = (segment.begins_at(), segment.ends_at());
    let elapsed = |time: f64| {
        let now = if time >= segment.end { end } else { Distance::product(time, run.speed) };
        (now.minus(begin) / run.speed).max(0.0)
    };
    walk.start(*segment.state());
    if times.len() <= FEW {
        for (state, &time) in states.iter_mut().zip(times) {
            let (count, left) = bank.strides(elapsed(time));
            *state = last_step(bank, walk.to(count as u64, bank, &drive), left, &drive);
        }
        return;
    }
    let (mut count, mut left) = ([0.0; AT_ONCE], [0.0; AT_ONCE]);
    for ((&time, count), left) in times.iter().zip(&mut count).zip(&mut left) {
        (*count, *left) = bank.strides(elapsed(time));
    }
    let groups = count.chunks_exact(LANES).zip(left.chunks_exact(LANES));
    for (states, (count, left)) in states[..times.len()].chunks_mut(LANES).zip(groups) {
        if states.len() <= FEW {
            for ((state, &count), &left) in states.iter_mut().zip(count).zip(left) {
                *state = last_step(bank, walk.to(count as u64, bank, &drive), left, &drive);
            }
            return;
        }
        let mut from = [State::REST; LANES];
        for (from, (&count, _)) in from.iter_mut().zip(count.iter().zip(&*states)) {
            *from = *walk.to(count as u64, bank, &drive);
        }
        let left = Lanes([left[0], left[1], left[2], left[3]]);
        for (mode, alone) in alone.iter().enumerate() {
            let column = |part: fn(&State) -> &Lanes| Lanes(from.each_ref().map(|state| part(state)[mode]));
            let from = State { d: column(|s| &s.d), v: column(|s| &s.v), p: column(|s| &s.p) };
            let drive = Drive { beta: Lanes::all(drive.beta[mode]), gamma: Lanes::all(drive.gamma[mode]) };
            // Opaque, so that the compiler keeps lanes together: it would take them one by one.
            let (from, left) = (black_box(from), black_box(left));
            let to = black_box(alone.over_parts(left).apply(&from, &drive));
            for (lane, state) in states.iter_mut().enumerate() {
                (state.d[mode], state.v[mode], state.p[mode]) = (to.d[lane], to.v[lane], to.p[lane]);
            }
        }
    }
}

/// One time, its modes side by side.
#[inline(always)]
fn last_step(bank: &Oscillators, from: &State, left: f64, drive: &Drive) -> State {
    black_box(bank.over_parts(Lanes::all(black_box(left))).apply(&black_box(*from), drive))
}
