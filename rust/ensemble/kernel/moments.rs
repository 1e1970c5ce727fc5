//! Sums of products of a period's numbers, of which all mean squares are made.

use std::ops::Range;

use pulp::Simd;

use super::super::setup::MODES;
use super::super::vector::parts;
use super::{March, Row, ZERO};

impl March<'_> {
    /// Adds up the products of a block's rows.
    #[inline(always)]
    pub(super) fn find_moments<S: Simd>(&mut self, simd: S, count: usize, tail: bool) {
        let Self { layout, ground, states, heights, first_rows, moments, reach, triples, .. } = self;
        let mut rows: Vec<&[Row]> = states[0].iter().map(|rows| &rows[..count]).collect();
        rows.extend(ground.iter().map(|ground| &ground.rise[1..=count]));
        rows.extend(layout.inner().map(|group| &ground[group].rise[..count]));
        rows.extend(heights[0].iter().map(|rows| &rows[..count]));
        rows.extend(first_rows.iter().map(|rows| &rows[..count]));
        let moments = &mut moments[usize::from(tail)];
        let (plain, inner) = (2 * MODES, layout.inner_rows());
        for (t, top) in triples.iter().enumerate() {
            let pick = |triple: &Range<usize>| {
                std::array::from_fn::<&[Row], 3, _>(|k| rows[(triple.start + k).min(triple.end - 1)])
            };
            let a = pick(top);
            for left in &triples[..=t] {
                // Over whole periods these follow from the products of the one before.
                let known = left.end <= plain || inner.contains(&left.start);
                if !tail && inner.contains(&top.start) && known {
                    continue;
                }
                let sums = match (top == left, top.len()) {
                    (true, _) => triangle(simd, a),
                    (false, 1) => products::<S, 1>(simd, a, pick(left)),
                    (false, 2) => products::<S, 2>(simd, a, pick(left)),
                    (false, _) => products::<S, 3>(simd, a, pick(left)),
                };
                for (row, sums) in top.clone().zip(&sums) {
                    for (column, sum) in left.clone().zip(sums).filter(|&(column, _)| column <= row) {
                        moments[place(row, column)] += *sum;
                        if column == row && row < reach.len() {
                            reach[row] = sum.sqrt();
                        }
                    }
                }
            }
        }
        for (row, (group, before)) in inner.zip(layout.inner().zip(&rows[layout.inner_rows()])) {
            let after = reach[plain + group];
            reach[row] = (after * after + before[0] * before[0]).sqrt();
        }
    }

    /// Of the products that follow from others, what the end of the last period lacks: see
    /// [`Setup::follow`](super::super::setup::Setup::follow).
    #[inline(always)]
    pub(super) fn close_moments<S: Simd>(&mut self, simd: S) {
        let Self { layout, ground, state, moments, .. } = self;
        let [moments, _] = moments;
        for part in parts(simd) {
            for (row, group) in layout.inner_rows().zip(layout.inner()) {
                let last = part.all(0.0) - part.load(&ground[group].rise[0]);
                for (column, state) in state.iter().enumerate() {
                    part.store(last * part.load(state), &mut moments[place(row, column)]);
                }
                for (column, group) in
                    layout.inner_rows().zip(layout.inner()).take_while(|&(column, _)| column <= row)
                {
                    part.store(last * part.load(&ground[group].rise[0]), &mut moments[place(row, column)]);
                }
            }
        }
    }

    /// Integrals of the squares over the runs, and what is not finite: that stays so, in states and
    /// moments; without any, in the first elevations.
    #[inline(always)]
    pub(super) fn conclude<S: Simd>(&mut self, simd: S) {
        for part in parts(simd) {
            let mut flaw = part.all(0.0) * part.load(&self.origin);
            for row in self.moments.iter().flatten().chain(&self.first) {
                flaw = flaw + part.all(0.0) * part.load(row);
            }
            part.store(flaw, &mut self.flaw);
            for (weights, square) in self.constants.weights.iter().zip(&mut self.squares) {
                let mut sum = part.all(0.0);
                for (weight, moment) in weights.square.iter().flatten().zip(self.moments.iter().flatten()) {
                    sum = sum + part.load(weight) * part.load(moment);
                }
                part.store(sum, square);
            }
        }
    }
}

/// Where the product of two rows stands among the moments.
#[inline(always)]
fn place(row: usize, column: usize) -> usize {
    row * (row + 1) / 2 + column
}

/// Sums of products of `N` ≤ 3 rows with three.
#[inline(always)]
fn products<S: Simd, const N: usize>(simd: S, a: [&[Row]; 3], b: [&[Row]; 3]) -> [[Row; 3]; 3] {
    let mut sums = [[ZERO; 3]; 3];
    let count = a[0].len();
    let (a, b) = (a.map(|row| &row[..count]), b.map(|row| &row[..count]));
    for part in parts(simd) {
        let mut sum = [[part.all(0.0); 3]; N];
        for i in 0..count {
            let b = [part.load(&b[0][i]), part.load(&b[1][i]), part.load(&b[2][i])];
            for row in 0..N {
                let a = part.load(&a[row][i]);
                for column in 0..3 {
                    sum[row][column] = sum[row][column] + a * b[column];
                }
            }
        }
        for row in 0..N {
            for column in 0..3 {
                part.store(sum[row][column], &mut sums[row][column]);
            }
        }
    }
    sums
}

/// Sums of products of three rows with themselves, on and below the diagonal.
#[inline(always)]
fn triangle<S: Simd>(simd: S, a: [&[Row]; 3]) -> [[Row; 3]; 3] {
    let mut sums = [[ZERO; 3]; 3];
    let count = a[0].len();
    let a = a.map(|row| &row[..count]);
    for part in parts(simd) {
        let mut sum = [[part.all(0.0); 3]; 3];
        for i in 0..count {
            let a = [part.load(&a[0][i]), part.load(&a[1][i]), part.load(&a[2][i])];
            for row in 0..3 {
                for column in 0..=row {
                    sum[row][column] = sum[row][column] + a[row] * a[column];
                }
            }
        }
        for row in 0..3 {
            for column in 0..=row {
                part.store(sum[row][column], &mut sums[row][column]);
            }
        }
    }
    sums
}
