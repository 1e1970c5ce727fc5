//! Random numbers without a state: a pure function of seed, run, line and track, eight runs
//! side by side.
//!
//! The generator is Philox4x32-10 (Salmon, Moraes, Dror and Shaw, *Parallel random numbers: as
//! easy as 1, 2, 3*, SC 2011): its key is the seed and its counter says which number is meant, so
//! a number does not depend on which were drawn before it, nor by whom.
//!
//! Normal deviates come in pairs by Box and Muller's transform. Logarithm, cosine and sine are
//! written here from +, −, ×, ÷ and √ alone: each of those rounds the same on every machine and
//! vectorises, which no library's functions do.

use std::f64::consts::{FRAC_PI_2, LN_2, SQRT_2};

use crate::row::{RUNS, Row};

/// Lines drawn at once: loops this long keep a processor's units busy.
pub const LINES: usize = 8;

/// Two independent deviates of each of [`LINES`] lines.
pub type Deviates = [[Row; LINES]; 2];

const MANY: usize = LINES * RUNS;

const LOW: u64 = 0xffff_ffff;

/// Bits of 1.0; below them stand the 52 of the fraction.
const ONE: u64 = 0x3ff0_0000_0000_0000;
const FRACTION: u64 = (1 << 52) - 1;

/// Ten rounds. Words of 32 bits stand in the low halves of 64, where vector units multiply them.
#[inline(always)]
fn philox([mut k0, mut k1]: [u64; 2], [mut c0, mut c1, mut c2, mut c3]: [u64; 4]) -> [u64; 4] {
    for _ in 0..10 {
        let (p0, p1) = (c0 * 0xd251_1f53, c2 * 0xcd9e_8d57);
        (c0, c1) = ((p1 >> 32) ^ c1 ^ k0, p1 & LOW);
        (c2, c3) = ((p0 >> 32) ^ c3 ^ k1, p0 & LOW);
        k0 = (k0 + 0x9e37_79b9) & LOW;
        k1 = (k1 + 0xbb67_ae85) & LOW;
    }
    [c0, c1, c2, c3]
}

/// The streams of eight runs.
#[derive(Clone, Copy, Debug)]
pub struct Streams {
    key: [u64; 2],
    /// Low and high words of the runs, over again for every line.
    runs: [[u64; MANY]; 2],
}

impl Streams {
    /// The streams of eight runs.
    #[must_use]
    pub fn new(seed: u64, runs: [u64; RUNS]) -> Self {
        let [low, high] = [runs.map(|run| run & LOW), runs.map(|run| run >> 32)];
        let again = |words: [u64; RUNS]| std::array::from_fn(|i| words[i % RUNS]);
        Self { key: [seed & LOW, seed >> 32], runs: [again(low), again(high)] }
    }

    /// Standard normal deviates of some lines of a track. Drawn in three loops, each with few
    /// enough steps a number for many numbers to be under way at once.
    #[inline(always)]
    #[must_use]
    pub fn normals(&self, lines: &[u32; LINES], track: u32) -> Deviates {
        let mut line = [0; MANY];
        for i in 0..MANY {
            line[i] = u64::from(lines[i / RUNS]);
        }
        let mut words = [[0; MANY]; 2];
        for i in 0..MANY {
            let counter = [line[i], u64::from(track), self.runs[0][i], self.runs[1][i]];
            let [a, b, c, d] = philox(self.key, counter);
            words[0][i] = a | (b << 32);
            words[1][i] = c | (d << 32);
        }
        let mut radius = [0.0; MANY];
        for i in 0..MANY {
            radius[i] = minus_two_log(uniform(words[0][i])).sqrt();
        }
        let mut parts = [[0.0; MANY]; 2];
        for i in 0..MANY {
            let [cos, sin] = direction(words[1][i]);
            parts[0][i] = radius[i] * cos;
            parts[1][i] = radius[i] * sin;
        }
        parts.map(|part| std::array::from_fn(|line| Row(std::array::from_fn(|run| part[line * RUNS + run]))))
    }
}

/// Uniform in (0, 1], a multiple of 2⁻⁵², from the 52 highest of 64 bits.
#[inline(always)]
fn uniform(word: u64) -> f64 {
    2.0 - f64::from_bits(ONE | (word >> 12))
}

/// −2 ln u for 2⁻⁵² ≤ u ≤ 1, to four units in the last place.
#[inline(always)]
fn minus_two_log(u: f64) -> f64 {
    // u = m 2⁻ᵏ with √½ ≤ m < √2 and 0 ≤ k ≤ 52, so 64 − k is positive.
    let shifted = u.to_bits() + (64 << 52) - (SQRT_2 / 2.0).to_bits();
    let m = f64::from_bits(u.to_bits() + (64 << 52) - (shifted & !FRACTION));
    let k = 64.0 - exact(shifted >> 52);
    // ln m = 2 artanh s.
    let s = (m - 1.0) / (m + 1.0);
    let square = s * s;
    let mut sum = 1.0 / 21.0;
    for term in (1..10).rev() {
        sum = sum * square + 1.0 / f64::from(2 * term + 1);
    }
    (2.0 * LN_2) * k - (4.0 * s + (4.0 * s) * (square * sum))
}

/// cos and sin of a uniformly distributed angle: two bits for the quadrant, 52 for the rest.
#[inline(always)]
fn direction(bits: u64) -> [f64; 2] {
    let part = f64::from_bits(ONE | (bits & FRACTION)) - 1.5;
    let [cos, sin] = cos_sin(part * FRAC_PI_2);
    // Mirrored at the diagonal, the right quadrant is the upper one; half a turn makes the others.
    let mirrored = if bits >> 63 == 1 { [sin, cos] } else { [cos, sin] };
    let half_turn = (bits << 1) & (1 << 63);
    mirrored.map(|part| f64::from_bits(part.to_bits() ^ half_turn))
}

/// cos and sin for |angle| ≤ π/4, by their series; the first terms left out are below 2⁻⁵³ of
/// the sums.
#[inline(always)]
fn cos_sin(angle: f64) -> [f64; 2] {
    let square = angle * angle;
    let (mut cos, mut sin) = (1.0 / FACTORIAL[16], -1.0 / FACTORIAL[15]);
    for n in (0..8).rev() {
        let sign = if n % 2 == 0 { 1.0 } else { -1.0 };
        cos = cos * square + sign / FACTORIAL[2 * n];
        if n < 7 {
            sin = sin * square + sign / FACTORIAL[2 * n + 1];
        }
    }
    [cos, angle * sin]
}

const FACTORIAL: [f64; 17] = {
    let mut all = [1.0; 17];
    let mut n = 1;
    while n < 17 {
        all[n] = n as f64 * all[n - 1];
        n += 1;
    }
    all
};

/// A whole number below 2⁵² as a double, without the conversion that few vector units have.
#[inline(always)]
fn exact(value: u64) -> f64 {
    const SCALE: u64 = 0x4330_0000_0000_0000; // bits of 2⁵²
    f64::from_bits(SCALE | value) - f64::from_bits(SCALE)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Known answers that the generator's authors publish (Random123, `kat_vectors`).
    #[test]
    fn known_answers() {
        let cases: [([u64; 4], [u64; 2], [u64; 4]); 3] = [
            ([0; 4], [0; 2], [0x6627_e8d5, 0xe169_c58d, 0xbc57_ac4c, 0x9b00_dbd8]),
            ([LOW; 4], [LOW; 2], [0x408f_276d, 0x41c8_3b0e, 0xa20b_c7c6, 0x6d54_51fd]),
            (
                [0x243f_6a88, 0x85a3_08d3, 0x1319_8a2e, 0x0370_7344],
                [0xa409_3822, 0x299f_31d0],
                [0xd16c_fe09, 0x94fd_cceb, 0x5001_e420, 0x2412_6ea1],
            ),
        ];
        for (counter, key, answer) in cases {
            assert_eq!(philox(key, counter), answer);
        }
    }

    /// Against the library's functions, from one end of the range to the other.
    #[test]
    fn functions() {
        let mut state = 1_u64;
        for case in 0..200_000 {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            // Shifted, small numbers come up too.
            let word = (state ^ (state >> 29)) >> (case % 50);
            let u = match case {
                0 => 1.0,
                1 => f64::EPSILON,
                _ => uniform(word),
            };
            assert!((f64::EPSILON..=1.0).contains(&u));
            let (found, expected) = (minus_two_log(u), -2.0 * libm::log(u));
            assert!(
                (found - expected).abs() <= 4.0 * f64::EPSILON * expected,
                "{u:?} {found:?} {expected:?}"
            );

            let angle = (u - 0.5) * FRAC_PI_2;
            let (sin, cos) = libm::sincos(angle);
            let [c, s] = cos_sin(angle);
            assert!((c - cos).abs() <= f64::EPSILON && (s - sin).abs() <= 2.0 * f64::EPSILON * sin.abs());
        }
    }

    /// All four quadrants: the directions are spread evenly over the circle.
    #[test]
    fn directions() {
        let count = 1_u64 << 12;
        let mut octants = [0_u64; 8];
        for turn in 0..count {
            let word = (turn << 62) | ((turn >> 2) << 42);
            let [cos, sin] = direction(word);
            assert!((cos * cos + sin * sin - 1.0).abs() < 4.0 * f64::EPSILON);
            let octant = 4.0 * (libm::atan2(sin, cos) / std::f64::consts::PI + 1.0);
            octants[octant as usize % 8] += 1;
        }
        assert!(octants.iter().all(|found| found.abs_diff(count / 8) <= 2), "{octants:?}");
    }
}
