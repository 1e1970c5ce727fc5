//! Registers full of numbers of runs side by side, whatever their width.

use std::ops::{Add, BitAnd, BitOr, Div, Mul, Range, Sub};

use pulp::{Simd, cast};

use crate::row::{RUNS, Row};

/// Which numbers of a row one register holds.
#[derive(Clone, Copy)]
pub(super) struct Part<S> {
    simd: S,
    at: usize,
}

/// The parts of a row: one where registers are wide enough.
#[inline(always)]
pub(super) fn parts<S: Simd>(simd: S) -> impl Iterator<Item = Part<S>> {
    (0..RUNS / S::F64_LANES).map(move |at| Part { simd, at })
}

impl<S: Simd> Part<S> {
    /// The same number for every run.
    #[inline(always)]
    pub fn all(self, value: f64) -> Vector<S> {
        Vector { simd: self.simd, of: self.simd.splat_f64s(value) }
    }

    #[inline(always)]
    pub fn load(self, row: &Row) -> Vector<S> {
        Vector { simd: self.simd, of: S::as_simd_f64s(&row.0).0[self.at] }
    }

    #[inline(always)]
    pub fn load_all<const N: usize>(self, rows: &[Row; N]) -> [Vector<S>; N] {
        // No closure: it would not be compiled for the instructions of its surroundings.
        let mut vectors = [self.all(0.0); N];
        for i in 0..N {
            vectors[i] = self.load(&rows[i]);
        }
        vectors
    }

    /// The runs of this part.
    #[inline(always)]
    pub fn lanes(self) -> Range<usize> {
        self.at * S::F64_LANES..(self.at + 1) * S::F64_LANES
    }

    #[inline(always)]
    pub fn store(self, vector: Vector<S>, row: &mut Row) {
        S::as_mut_simd_f64s(&mut row.0).0[self.at] = vector.of;
    }
}

/// A register. No operation mixes runs or is fused: a run's bits depend neither on its neighbours nor
/// on the width.
#[derive(Clone, Copy)]
pub(super) struct Vector<S: Simd> {
    simd: S,
    of: S::f64s,
}

impl<S: Simd> Vector<S> {
    /// The larger of two.
    #[inline(always)]
    pub fn max(self, other: Self) -> Self {
        Self { of: self.simd.max_f64s(self.of, other.of), ..self }
    }

    /// The smaller of two.
    #[inline(always)]
    pub fn min(self, other: Self) -> Self {
        Self { of: self.simd.min_f64s(self.of, other.of), ..self }
    }

    /// Square root.
    #[inline(always)]
    pub fn sqrt(self) -> Self {
        Self { of: self.simd.sqrt_f64s(self.of), ..self }
    }

    /// Magnitude.
    #[inline(always)]
    pub fn abs(self) -> Self {
        let zero = Self { of: self.simd.splat_f64s(0.0), ..self };
        self.max(zero - self)
    }

    /// Where a number exceeds the other's.
    #[inline(always)]
    pub fn above(self, other: Self) -> Mask<S> {
        Mask { simd: self.simd, of: self.simd.greater_than_f64s(self.of, other.of) }
    }
}

/// A choice among a register's runs.
#[derive(Clone, Copy)]
pub(super) struct Mask<S: Simd> {
    simd: S,
    of: S::m64s,
}

impl<S: Simd> Mask<S> {
    /// Whether there is any.
    #[inline(always)]
    pub fn any(self) -> bool {
        self.simd.first_true_m64s(self.of) < S::F64_LANES
    }

    /// One of two numbers for each run.
    #[inline(always)]
    pub fn choose(self, one: Vector<S>, other: Vector<S>) -> Vector<S> {
        Vector { of: choose(self.simd, self.of, one.of, other.of), ..one }
    }
}

impl<S: Simd> BitAnd for Mask<S> {
    type Output = Self;
    #[inline(always)]
    fn bitand(self, other: Self) -> Self {
        Self { of: self.simd.and_m64s(self.of, other.of), ..self }
    }
}

impl<S: Simd> BitOr for Mask<S> {
    type Output = Self;
    #[inline(always)]
    fn bitor(self, other: Self) -> Self {
        Self { of: self.simd.or_m64s(self.of, other.of), ..self }
    }
}

impl<S: Simd> Add for Vector<S> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self { of: self.simd.add_f64s(self.of, other.of), ..self }
    }
}

impl<S: Simd> Sub for Vector<S> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self { of: self.simd.sub_f64s(self.of, other.of), ..self }
    }
}

impl<S: Simd> Div for Vector<S> {
    type Output = Self;
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        Self { of: self.simd.div_f64s(self.of, other.of), ..self }
    }
}

impl<S: Simd> Mul for Vector<S> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        Self { of: self.simd.mul_f64s(self.of, other.of), ..self }
    }
}

// `select_f64s` itself is not always inlined.
#[inline(always)]
fn choose<S: Simd>(simd: S, choice: S::m64s, one: S::f64s, other: S::f64s) -> S::f64s {
    cast(simd.select_u64s(choice, cast(one), cast(other)))
}

/// Turns runs one beside the other into rows.
#[inline(always)]
pub(super) fn turn<S: Simd, T: Copy + Into<f64>>(simd: S, runs: [&[T]; RUNS], out: &mut [Row]) {
    let width = S::F64_LANES;
    let tiled = out.len() - out.len() % width;
    let (tiles, rest) = out.split_at_mut(tiled);
    for part in parts(simd) {
        let runs = &runs[part.lanes()];
        for (t, tile) in tiles.chunks_exact_mut(width).enumerate() {
            let mut square = [simd.splat_f64s(0.0); RUNS];
            for (row, run) in square.iter_mut().zip(runs) {
                let from = &run[t * width..][..width];
                let values: [f64; RUNS] = std::array::from_fn(|i| from.get(i).map_or(0.0, |&x| x.into()));
                *row = S::as_simd_f64s(&values).0[0];
            }
            exchange::<S, 1>(simd, &mut square);
            exchange::<S, 2>(simd, &mut square);
            exchange::<S, 4>(simd, &mut square);
            for (row, of) in tile.iter_mut().zip(square) {
                part.store(Vector { simd, of }, row);
            }
        }
        for (i, row) in rest.iter_mut().enumerate() {
            for (lane, run) in part.lanes().zip(runs) {
                row[lane] = run[tiled + i].into();
            }
        }
    }
}

/// Of every square of 2 `K` × 2 `K` numbers, exchanges the quarters off the diagonal.
#[inline(always)]
fn exchange<S: Simd, const K: usize>(simd: S, square: &mut [S::f64s; RUNS]) {
    if K >= S::F64_LANES {
        return;
    }
    let right: [f64; RUNS] = std::array::from_fn(|i| if i & K == 0 { 0.0 } else { 1.0 });
    let right = simd.greater_than_f64s(S::as_simd_f64s(&right).0[0], simd.splat_f64s(0.0));
    for upper in 0..S::F64_LANES {
        if upper & K == 0 {
            let [a, b] = [square[upper], square[upper + K]];
            square[upper] = choose(simd, right, simd.rotate_right_f64s(b, K), a);
            square[upper + K] = choose(simd, right, b, simd.rotate_left_f64s(a, K));
        }
    }
}
