//! The weights that make ∫F² of the moments, for runs side by side.
//!
//! On a leg an output is a linear form of the leg's vector: d and ẏ/ω of each mode, the rises over a
//! spacing on that leg, and where they are needed heights and first elevations. ∫F² over a leg is thus a
//! quadratic form of the vector at its start, and through that of the rows of its period. Summed over
//! the periods it is the form's weights times the moments, the sums of the rows' products.
//!
//! As in [`kernel`](super::kernel), only functions marked for inlining are compiled for the chosen
//! instructions.

use pulp::{Simd, WithSimd};

use super::constants::{Constants, ModeStep, Weights, of_lane};
use super::setup::Layout;
use super::vector::parts;
use crate::mean_square::GAUSS;
use crate::modes::MODES;
use crate::row::{RUNS, Row};
use crate::transition::Transition;

const ONE: Row = Row::all(1.0);

/// Weights of the products of a period's rows, lower triangle, in ∫F² over the periods and over the tail.
pub(super) type Square = [Vec<Row>; 2];

/// Finds the [`Square`] of each output.
pub(super) struct Integrate<'a> {
    /// Complete but for what is to be found.
    pub constants: &'a Constants,
}

impl WithSimd for Integrate<'_> {
    type Output = Vec<Square>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Vec<Square> {
        let layout = &*self.constants.setups[0].layout;
        let (size, rows) = (self.size(), layout.rows());
        let forms = self.forms();
        let zeros = |size: usize| vec![Row::ZERO; triangle_index(size, 0)];
        let mut squares = vec![[zeros(rows), zeros(rows)]; forms.len()];
        let mut of_leg = vec![zeros(size); forms.len()];
        let mut work = vec![Row::ZERO; size];
        let (mut at, mut next) = (Sparse::new(rows, size), Sparse::new(rows, size));
        let mut step = Sparse::new(size, size);
        self.begin(&mut at);
        for leg in 0..layout.legs {
            self.integrate(simd, leg, &forms, &mut of_leg, &mut step, &mut work);
            for (square, [whole, tail]) in of_leg.iter().zip(&mut squares) {
                add_congruent(simd, whole, square, &at, &mut work);
                if leg + 1 == layout.tail {
                    tail.copy_from_slice(whole);
                }
            }
            let dt = std::array::from_fn(|lane| of_lane(&self.constants.setups, lane).dt[leg]);
            self.step(Row(dt), &mut step);
            self.follow(leg + 1, &step, &at, &mut next, &mut work);
            std::mem::swap(&mut at, &mut next);
        }
        for [whole, tail] in &mut squares {
            eliminate_rises_before(layout, &at, whole);
            double_off_diagonal(whole);
            double_off_diagonal(tail);
        }
        squares
    }
}

impl Integrate<'_> {
    /// Numbers of a leg's vector.
    fn size(&self) -> usize {
        let layout = &self.constants.setups[0].layout;
        let groups = layout.groups.len();
        2 * MODES + if layout.heights { 3 * groups } else { groups }
    }

    /// Outputs on a leg's vector.
    fn forms(&self) -> Vec<Vec<Row>> {
        let form = |Weights { state, rise, height, first, .. }: &Weights| {
            let mut form = [&state[..], rise, height, first].concat();
            form.truncate(self.size());
            form
        };
        self.constants.weights.iter().map(form).collect()
    }

    /// The first leg's vector from the rows of its period.
    fn begin(&self, at: &mut Sparse) {
        let layout = &*self.constants.setups[0].layout;
        let (rises, heights) = (2 * MODES, layout.inner_rows().end);
        for row in 0..layout.rows() {
            if row < rises {
                at.push(row, ONE);
            } else if row < heights {
                push_rises(layout, 0, row, at);
            } else {
                at.push(rises + layout.groups.len() + (row - heights), ONE);
            }
            at.end_column();
        }
    }

    /// The vector of a leg from the rows of its period: what `step` makes of that of the leg before, `at`,
    /// but for the rises, which are its own.
    #[inline(always)]
    fn follow(&self, leg: usize, step: &Sparse, at: &Sparse, next: &mut Sparse, work: &mut [Row]) {
        let layout = &*self.constants.setups[0].layout;
        let rises = 2 * MODES..2 * MODES + layout.groups.len();
        next.clear();
        for row in 0..layout.rows() {
            work.fill(Row::ZERO);
            for (inner, factor) in at.column(row) {
                for (entry, value) in step.column(inner) {
                    work[entry] += *value * *factor;
                }
            }
            for (entry, &value) in work.iter().enumerate() {
                if !rises.contains(&entry) && value != Row::ZERO {
                    next.push(entry, value);
                }
            }
            push_rises(layout, leg, row, next);
            next.end_column();
        }
    }

    /// Transition of a leg's vector over a time.
    #[inline(always)]
    fn step(&self, time: Row, step: &mut Sparse) {
        let Constants { climb, drag, .. } = self.constants;
        let layout = &*self.constants.setups[0].layout;
        let (groups, rises) = (layout.groups.len(), 2 * MODES);
        let modes = self.mode_steps(time);
        step.clear();
        for (mode, ModeStep { g, s, .. }) in modes.iter().enumerate() {
            step.push(mode, ONE - *g);
            step.push(MODES + mode, Row::ZERO - *s);
            step.end_column();
        }
        for (mode, ModeStep { s, w, .. }) in modes.iter().enumerate() {
            step.push(mode, *s);
            step.push(MODES + mode, ONE - *w);
            step.end_column();
        }
        let share = if layout.heights { self.share(time) } else { Row::ZERO };
        for group in 0..groups {
            for (mode, ModeStep { g, s, h, .. }) in modes.iter().enumerate() {
                let (beta, gamma) = (climb[group][mode], drag[group][mode]);
                step.push(mode, *g * gamma - *h * beta);
                step.push(MODES + mode, *g * beta + *s * gamma);
            }
            step.push(rises + group, ONE);
            if layout.heights {
                // That of the datum grows with its rise, the others with their own less that.
                for other in (0..groups).filter(|&other| other != group && group == layout.datum) {
                    step.push(rises + groups + other, Row::ZERO - share);
                }
                step.push(rises + groups + group, share);
            }
            step.end_column();
        }
        for constant in rises + groups..self.size() {
            step.push(constant, ONE);
            step.end_column();
        }
    }

    /// Which share of a period a time is.
    fn share(&self, time: Row) -> Row {
        let period = |lane| of_lane(&self.constants.setups, lane).dt.iter().sum::<f64>();
        Row(std::array::from_fn(|lane| time[lane] / period(lane)))
    }

    #[inline(always)]
    fn mode_steps(&self, time: Row) -> [ModeStep; MODES] {
        let mut steps = [ModeStep { g: Row::ZERO, s: Row::ZERO, w: Row::ZERO, h: Row::ZERO }; MODES];
        if let [shared] = &self.constants.setups[..] {
            let Transition { g, s, w, h, .. } = shared.bank.over(time[0]);
            for (mode, step) in steps.iter_mut().enumerate() {
                let all = Row::all;
                *step = ModeStep { g: all(g[mode]), s: all(s[mode]), w: all(w[mode]), h: all(h[mode]) };
            }
            return steps;
        }
        for lane in 0..RUNS {
            let Transition { g, s, w, h, .. } = of_lane(&self.constants.setups, lane).bank.over(time[lane]);
            for (mode, step) in steps.iter_mut().enumerate() {
                (step.g[lane], step.s[lane]) = (g[mode], s[mode]);
                (step.w[lane], step.h[lane]) = (w[mode], h[mode]);
            }
        }
        steps
    }

    /// Weights of the products of a leg's vector in ∫F² over it: by Gauss's rule over a radian of the
    /// stiffest mode, W(2t) = W(t) + E(t)ᵀ W(t) E(t) beyond.
    #[inline(always)]
    fn integrate<S: Simd>(
        &self,
        simd: S,
        leg: usize,
        forms: &[Vec<Row>],
        squares: &mut [Vec<Row>],
        step: &mut Sparse,
        work: &mut [Row],
    ) {
        let (mut doublings, mut time) = ([0; RUNS], Row::ZERO);
        for lane in 0..RUNS {
            let setup = of_lane(&self.constants.setups, lane);
            (doublings[lane], time[lane]) = setup.bank.halved(setup.dt[leg]);
        }
        for square in &mut *squares {
            square.fill(Row::ZERO);
        }
        for (node, weight) in GAUSS {
            for node in [-node, node] {
                self.step(time * Row::all(0.5 * (1.0 + node)), step);
                let weight = time * Row::all(0.5 * weight);
                for (form, square) in forms.iter().zip(&mut *squares) {
                    add_square(simd, square, form, step, weight, work);
                }
            }
        }
        for doubling in 0..doublings.into_iter().max().unwrap_or(0) {
            self.step(time, step);
            let goes_on = Row(doublings.map(|count| if doubling < count { 1.0 } else { 0.0 }));
            for square in &mut *squares {
                let first: Vec<Row> = square.iter().map(|&weight| weight * goes_on).collect();
                add_congruent(simd, square, &first, step, work);
            }
            time += time * goes_on;
        }
    }
}

/// A matrix of each run, column by column, without entries that are zero in all of them.
struct Sparse {
    /// Of each entry.
    rows: Vec<usize>,
    values: Vec<Row>,
    /// Where each column ends among them.
    ends: Vec<usize>,
}

impl Sparse {
    /// With room for so many columns of so many entries.
    fn new(columns: usize, entries: usize) -> Self {
        let size = columns * entries;
        Self {
            rows: Vec::with_capacity(size),
            values: Vec::with_capacity(size),
            ends: Vec::with_capacity(columns),
        }
    }

    fn clear(&mut self) {
        self.rows.clear();
        self.values.clear();
        self.ends.clear();
    }

    /// One more entry of the last column.
    #[inline(always)]
    fn push(&mut self, row: usize, value: Row) {
        self.rows.push(row);
        self.values.push(value);
    }

    #[inline(always)]
    fn end_column(&mut self) {
        self.ends.push(self.rows.len());
    }

    #[inline(always)]
    fn column(&self, column: usize) -> impl Iterator<Item = (usize, &Row)> {
        let begin = if column == 0 { 0 } else { self.ends[column - 1] };
        let entries = begin..self.ends[column];
        self.rows[entries.clone()].iter().copied().zip(&self.values[entries])
    }
}

/// Where the product of two rows stands in a lower triangle.
#[inline(always)]
pub(super) fn triangle_index(row: usize, column: usize) -> usize {
    row * (row + 1) / 2 + column
}

/// Enters the rises of a leg that are those of this row of its period.
#[inline(always)]
fn push_rises(layout: &Layout, leg: usize, row: usize, column: &mut Sparse) {
    for (group, of_group) in layout.groups.iter().enumerate() {
        let before = layout.inner().position(|inner| inner == group && of_group.leg > leg);
        let of_period = before.map_or(2 * MODES + group, |place| layout.inner_rows().start + place);
        if of_period == row {
            column.push(2 * MODES + group, ONE);
        }
    }
}

/// Adds weight · (form · step)ᵀ (form · step).
#[inline(always)]
fn add_square<S: Simd>(
    simd: S,
    square: &mut [Row],
    form: &[Row],
    step: &Sparse,
    weight: Row,
    work: &mut [Row],
) {
    for part in parts(simd) {
        let weight = part.load(&weight);
        for row in 0..form.len() {
            let mut sum = part.all(0.0);
            for (entry, value) in step.column(row) {
                sum = sum + part.load(&form[entry]) * part.load(value);
            }
            part.store(sum, &mut work[row]);
            let weighted = weight * sum;
            let line = &mut square[triangle_index(row, 0)..][..=row];
            for (sum, earlier) in line.iter_mut().zip(&*work) {
                part.store(part.load(sum) + weighted * part.load(earlier), sum);
            }
        }
    }
}

/// Adds matrixᵀ · square · matrix.
#[inline(always)]
fn add_congruent<S: Simd>(simd: S, sum: &mut [Row], square: &[Row], matrix: &Sparse, work: &mut [Row]) {
    let columns = matrix.ends.len();
    for part in parts(simd) {
        for right in 0..columns {
            for (row, sum) in work.iter_mut().enumerate() {
                let mut product = part.all(0.0);
                for (inner, factor) in matrix.column(right) {
                    let place = triangle_index(row.max(inner), row.min(inner));
                    product = product + part.load(&square[place]) * part.load(factor);
                }
                part.store(product, sum);
            }
            for left in right..columns {
                let sum = &mut sum[triangle_index(left, right)];
                let mut product = part.load(sum);
                for (row, factor) in matrix.column(left) {
                    product = product + part.load(factor) * part.load(&work[row]);
                }
                part.store(product, sum);
            }
        }
    }
}

/// Rewrites a form over whole periods so that some products need not be added up: those of the rises
/// before stations inside a period, b, with each other and with the state at its start, s.
///
/// These rises are those after the same stations a period earlier, a, and nothing has risen before
/// the first period: b_i = a_{i−1}, b_0 = 0. With x_i the rows of period i and s_{i+1} = T x_i, the
/// first entries of the vector `after` the period,
///
///   Σ b_i b_iᵀ = Σ a_i a_iᵀ − a_end a_endᵀ,   Σ b_i s_iᵀ = Σ a_i (T x_i)ᵀ − a_end s_endᵀ,
///
/// where a_end belongs to the last period and s_end is the state after it. So the weights of the
/// sums on the left are added to those of the sums on the right. They also stay where they are:
/// [`March::close_moments`](super::kernel::March::close_moments) puts the two terms of the end in
/// the place of the sums on the left.
#[inline(always)]
fn eliminate_rises_before(layout: &Layout, after: &Sparse, square: &mut [Row]) {
    let rises = 2 * MODES;
    for (row, group) in layout.inner_rows().zip(layout.inner()) {
        let earlier = rises + group;
        // 2 b Q s = 2 a (Q T) x: half of it on either side of the diagonal.
        for column in 0..layout.rows() {
            let mut weight = Row::ZERO;
            for (state, value) in after.column(column).filter(|&(entry, _)| entry < rises) {
                weight += square[triangle_index(row, state)] * *value;
            }
            let place = triangle_index(column.max(earlier), column.min(earlier));
            square[place] += if column == earlier { weight + weight } else { weight };
        }
        for (column, as_early) in layout.inner_rows().zip(layout.inner()).take_while(|at| at.0 <= row) {
            square[triangle_index(earlier, rises + as_early)] += square[triangle_index(row, column)];
        }
    }
}

/// Makes the weights of the products on one side of the diagonal those of both.
#[inline(always)]
fn double_off_diagonal(square: &mut [Row]) {
    let mut at = 0;
    for row in 0.. {
        if at == square.len() {
            break;
        }
        for weight in &mut square[at..at + row] {
            *weight += *weight;
        }
        at += row + 1;
    }
}
