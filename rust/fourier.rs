//! Inverse Fourier transforms of eight runs side by side.
//!
//! Libraries choose their instructions, fused ones among them, by the machine they run on, so
//! their last bits differ; and where they do not, they transform one series at a time. Here every
//! lane does the same plain arithmetic, whatever the width of the machine's vectors.

use std::f64::consts::TAU;

use crate::error::Result;
use crate::parallel;
use crate::row::Row;
use crate::watch::{Pulse, Watch};

/// Real and imaginary parts of one term, or two neighbouring stations.
pub(crate) type Term = [Row; 2];

pub(crate) const NONE: Term = [Row::ZERO; 2];

/// Largest odd part of a quick size: threes and fives cost more than fours.
const MOST_ODD: usize = 27;

/// A transform of one size, a product of twos, threes and fives.
#[derive(Clone, Debug)]
pub(crate) struct Transform {
    /// Radices; the first is that of the last pass.
    radices: Vec<usize>,
    /// e^(2πik ÷ 2 size) for 0 ≤ k < size, as cos and sin.
    turns: Vec<[f64; 2]>,
    size: usize,
}

impl Transform {
    /// The least size ≥ `least` that is quick: nearly all twos.
    pub fn fast_size(least: usize) -> usize {
        let mut size = least.max(1);
        while left_over(size) != 1 || size >> size.trailing_zeros() > MOST_ODD {
            size += 1;
        }
        size
    }

    /// # Errors
    /// What `pulse` gives.
    pub fn new(size: usize, pulse: Pulse) -> Result<Self> {
        let mut radices = vec![];
        let mut left = size;
        while left > 1 {
            // A two only where the fours leave one over; fours last, for the small blocks.
            let odd_two = left.trailing_zeros() % 2 == 1;
            let radix = [5, 3].into_iter().find(|radix| left.is_multiple_of(*radix));
            radices.push(radix.unwrap_or(if odd_two { 2 } else { 4 }));
            left /= radices[radices.len() - 1];
        }
        let turn = |k: usize| {
            let (sin, cos) = libm::sincos(TAU * (k as f64 / (2 * size) as f64));
            [cos, sin]
        };
        Ok(Self { radices, size, turns: parallel::list(0..size, pulse, turn)? })
    }

    /// Terms.
    pub fn size(&self) -> usize {
        self.size
    }

    /// e^(2πik ÷ 2 size), k < size.
    pub fn turn(&self, k: usize) -> [f64; 2] {
        self.turns[k]
    }

    /// Where to put term k.
    pub fn place(&self, mut k: usize) -> u32 {
        let (mut block, mut place) = (self.size, 0);
        for radix in &self.radices {
            block /= radix;
            place += k % radix * block;
            k /= radix;
        }
        place as u32
    }

    /// Turns terms in their places into their sums: x_j = Σ X_k e^(2πijk ÷ size).
    ///
    /// Block by block, so that what a pass reads still is in the cache from the pass before. Leaves
    /// them half summed once the caller has asked to stop.
    #[inline(always)]
    pub fn sum(&self, x: &mut [Term], watch: &mut Watch) {
        let Some((&leaf, outer)) = self.radices.split_last() else { return };
        for done in 1..=x.len() / leaf {
            let mut block = leaf;
            self.pass(leaf, &mut x[(done - 1) * leaf..done * leaf]);
            let mut blocks = done;
            for &radix in outer.iter().rev() {
                if blocks % radix != 0 {
                    break;
                }
                blocks /= radix;
                block *= radix;
                self.pass(radix, &mut x[(blocks - 1) * block..blocks * block]);
                if !watch.go_on(block as u32) {
                    return;
                }
            }
        }
    }

    #[inline(always)]
    fn pass(&self, radix: usize, x: &mut [Term]) {
        match radix {
            2 => self.join::<2>(x),
            3 => self.join::<3>(x),
            4 => self.join::<4>(x),
            _ => self.join::<5>(x),
        }
    }

    /// Joins R transforms that stand one after another to one of R times the size.
    #[inline(always)]
    fn join<const R: usize>(&self, x: &mut [Term])
    where
        [Term; R]: Butterfly,
    {
        let stride = x.len() / R;
        let step = 2 * self.size / x.len();
        for j in 0..stride {
            let mut terms = [NONE; R];
            terms[0] = x[j];
            let first = self.turns[j * step];
            let mut turn = first;
            for r in 1..R {
                terms[r] = times(x[j + r * stride], turn);
                turn = [turn[0] * first[0] - turn[1] * first[1], turn[0] * first[1] + turn[1] * first[0]];
            }
            let sums = terms.butterfly();
            for r in 0..R {
                x[j + r * stride] = sums[r];
            }
        }
    }
}

/// What stays of a size without its twos, threes and fives.
fn left_over(mut size: usize) -> usize {
    for prime in [2, 3, 5] {
        while size.is_multiple_of(prime) {
            size /= prime;
        }
    }
    size
}

#[inline(always)]
fn plus(a: Term, b: Term) -> Term {
    [a[0] + b[0], a[1] + b[1]]
}

#[inline(always)]
fn minus(a: Term, b: Term) -> Term {
    [a[0] - b[0], a[1] - b[1]]
}

#[inline(always)]
fn scaled(a: Term, factor: f64) -> Term {
    let factor = Row::all(factor);
    [factor * a[0], factor * a[1]]
}

/// Times i.
#[inline(always)]
fn turned([re, im]: Term) -> Term {
    [Row::ZERO - im, re]
}

/// Times a complex number, the same in every lane.
#[inline(always)]
pub(crate) fn times([re, im]: Term, turn: [f64; 2]) -> Term {
    let [cos, sin] = turn.map(Row::all);
    [re * cos - im * sin, re * sin + im * cos]
}

/// The transform of a few terms.
trait Butterfly {
    fn butterfly(self) -> Self;
}

impl Butterfly for [Term; 2] {
    #[inline(always)]
    fn butterfly(self) -> Self {
        let [a, b] = self;
        [plus(a, b), minus(a, b)]
    }
}

impl Butterfly for [Term; 3] {
    #[inline(always)]
    fn butterfly(self) -> Self {
        const SIN: f64 = 0.866_025_403_784_438_6; // of 120°
        let [a, b, c] = self;
        let sum = plus(b, c);
        let (middle, side) = (minus(a, scaled(sum, 0.5)), turned(scaled(minus(b, c), SIN)));
        [plus(a, sum), plus(middle, side), minus(middle, side)]
    }
}

impl Butterfly for [Term; 4] {
    #[inline(always)]
    fn butterfly(self) -> Self {
        let [a, b, c, d] = self;
        let ([p, q], [r, s]) = ([a, c].butterfly(), [b, d].butterfly());
        let ([p, r], [q, s]) = ([p, r].butterfly(), [q, turned(s)].butterfly());
        [p, q, r, s]
    }
}

impl Butterfly for [Term; 5] {
    #[inline(always)]
    fn butterfly(self) -> Self {
        // cos and sin of 72° and 144°.
        const COS: [f64; 2] = [0.309_016_994_374_947_45, -0.809_016_994_374_947_5];
        const SIN: [f64; 2] = [0.951_056_516_295_153_5, 0.587_785_252_292_473_1];
        let [a, b, c, d, e] = self;
        let ([near, near_side], [far, far_side]) = ([b, e].butterfly(), [c, d].butterfly());
        let middle_1 = plus(a, plus(scaled(near, COS[0]), scaled(far, COS[1])));
        let middle_2 = plus(a, plus(scaled(near, COS[1]), scaled(far, COS[0])));
        let side_1 = turned(plus(scaled(near_side, SIN[0]), scaled(far_side, SIN[1])));
        let side_2 = turned(minus(scaled(near_side, SIN[1]), scaled(far_side, SIN[0])));
        let ([b, e], [c, d]) = ([middle_1, side_1].butterfly(), [middle_2, side_2].butterfly());
        [plus(a, plus(near, far)), b, c, d, e]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::row::RUNS;

    /// Against the sum as it is written, for every radix and mixtures of them.
    #[test]
    fn sums() {
        for size in [1, 2, 3, 4, 5, 6, 8, 9, 16, 20, 25, 30, 48, 60, 120, 128, 150, 240] {
            let transform = Transform::new(size, &mut || Ok(())).unwrap();
            let term = |k: usize, lane: usize| {
                let value = |shift: usize| ((31 * k + 7 * lane + shift) % 17) as f64 - 8.0;
                [value(0), value(5)]
            };
            let mut x = vec![NONE; size];
            for (k, lane) in (0..size).flat_map(|k| (0..RUNS).map(move |lane| (k, lane))) {
                let [re, im] = term(k, lane);
                x[transform.place(k) as usize][0][lane] = re;
                x[transform.place(k) as usize][1][lane] = im;
            }
            transform.sum(&mut x, &mut Watch::new(&mut || Ok(())));
            for (j, lane) in (0..size).flat_map(|j| (0..RUNS).map(move |lane| (j, lane))) {
                let mut expected = [0.0; 2];
                for k in 0..size {
                    let (sin, cos) = libm::sincos(TAU * ((j * k % size) as f64 / size as f64));
                    let [re, im] = term(k, lane);
                    expected[0] += re * cos - im * sin;
                    expected[1] += re * sin + im * cos;
                }
                for part in 0..2 {
                    assert!((x[j][part][lane] - expected[part]).abs() < 1e-14 * 9.0 * size as f64);
                }
            }
        }
    }

    #[test]
    fn sizes() {
        for (least, size) in
            [(1, 1), (7, 8), (11, 12), (13, 15), (31, 32), (81, 96), (6001, 6144), (6145, 6400)]
        {
            assert_eq!(Transform::fast_size(least), size);
        }
    }
}
