//! Sums of products of a period's numbers, of which all mean squares are made.

use std::ops::Range;

use pulp::Simd;

use super::super::squares::triangle_index;
use super::super::vector::{Part, Vector, parts};
use super::{March, Row};
use crate::modes::MODES;

impl March {
    /// Adds up the products of the rows of a block's periods, and leaves in `norms` the roots of the
    /// block's own sums of squares.
    #[inline(always)]
    pub(super) fn find_moments<S: Simd>(&mut self, simd: S, count: usize, tail: bool) {
        let Self { layout, ground, states, heights, first_rows, moments, norms, triples, .. } = self;
        let mut rows: Vec<&[Row]> = states[0].iter().map(|rows| &rows[..count]).collect();
        rows.extend(ground.iter().map(|ground| &ground.rise[1..=count]));
        rows.extend(layout.inner().map(|group| &ground[group].rise[..count]));
        rows.extend(heights[0].iter().map(|rows| &rows[..count]));
        rows.extend(first_rows.iter().map(|rows| &rows[..count]));
        let moments = &mut moments[usize::from(tail)];
        let (plain, inner) = (2 * MODES, layout.inner_rows());
        for part in parts(simd) {
            for (t, top) in triples.iter().enumerate() {
                let a = pick(&rows, top);
                for left in &triples[..=t] {
                    // Rises before stations with each other and with states: other products and two
                    // terms of the end make them up (see `close_moments`).
                    let known = left.end <= plain || inner.contains(&left.start);
                    if !tail && inner.contains(&top.start) && known {
                        continue;
                    }
                    let b = pick(&rows, left);
                    let sums = match (top == left, top.len()) {
                        (true, _) => triangle(part, a),
                        (false, 1) => products::<S, 1>(part, a, b),
                        (false, 2) => products::<S, 2>(part, a, b),
                        (false, _) => products::<S, 3>(part, a, b),
                    };
                    for (row, sums) in top.clone().zip(sums) {
                        for (column, sum) in left.clone().zip(sums) {
                            if column > row {
                                break;
                            }
                            let moment = &mut moments[triangle_index(row, column)];
                            part.store(part.load(moment) + sum, moment);
                            if column == row && row < norms.len() {
                                part.store(sum.sqrt(), &mut norms[row]);
                            }
                        }
                    }
                }
            }
            for (row, (group, before)) in inner.clone().zip(layout.inner().zip(&rows[inner.clone()])) {
                let (after, before) = (part.load(&norms[plain + group]), part.load(&before[0]));
                part.store((after * after + before * before).sqrt(), &mut norms[row]);
            }
        }
    }

    /// Puts −a_end a_endᵀ and −a_end s_endᵀ where the sums of products that `find_moments` skips would
    /// stand: what the other sums lack of them, once their weights have been moved there. See
    /// [`squares`](super::super::squares).
    #[inline(always)]
    pub(super) fn close_moments<S: Simd>(&mut self, simd: S) {
        let Self { layout, ground, state, moments, .. } = self;
        let [moments, _] = moments;
        for part in parts(simd) {
            for (row, group) in layout.inner_rows().zip(layout.inner()) {
                let last = part.all(0.0) - part.load(&ground[group].rise[0]);
                for (column, state) in state.iter().enumerate() {
                    part.store(last * part.load(state), &mut moments[triangle_index(row, column)]);
                }
                for (column, group) in
                    layout.inner_rows().zip(layout.inner()).take_while(|&(column, _)| column <= row)
                {
                    part.store(
                        last * part.load(&ground[group].rise[0]),
                        &mut moments[triangle_index(row, column)],
                    );
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

/// Three rows; the last one in place of those that are lacking.
fn pick<'a>(rows: &[&'a [Row]], triple: &Range<usize>) -> [&'a [Row]; 3] {
    std::array::from_fn(|k| rows[(triple.start + k).min(triple.end - 1)])
}

/// Sums of products of `N` ≤ 3 rows with three.
#[inline(always)]
fn products<S: Simd, const N: usize>(part: Part<S>, a: [&[Row]; 3], b: [&[Row]; 3]) -> [[Vector<S>; 3]; 3] {
    let mut sums = [[part.all(0.0); 3]; 3];
    let count = a[0].len();
    let (a, b) = (a.map(|row| &row[..count]), b.map(|row| &row[..count]));
    for i in 0..count {
        let b = [part.load(&b[0][i]), part.load(&b[1][i]), part.load(&b[2][i])];
        for row in 0..N {
            let a = part.load(&a[row][i]);
            for column in 0..3 {
                sums[row][column] = sums[row][column] + a * b[column];
            }
        }
    }
    sums
}

/// Sums of products of three rows with themselves, on and below the diagonal.
#[inline(always)]
fn triangle<S: Simd>(part: Part<S>, a: [&[Row]; 3]) -> [[Vector<S>; 3]; 3] {
    let mut sums = [[part.all(0.0); 3]; 3];
    let count = a[0].len();
    let a = a.map(|row| &row[..count]);
    for i in 0..count {
        let a = [part.load(&a[0][i]), part.load(&a[1][i]), part.load(&a[2][i])];
        for row in 0..3 {
            for column in 0..=row {
                sums[row][column] = sums[row][column] + a[row] * a[column];
            }
        }
    }
    sums
}
