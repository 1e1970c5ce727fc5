//! Runs side by side, a block of periods at a time: slopes, states, moments, values.
//!
//! A block's numbers stay in the first-level cache from one pass to the next. Every pass is a plain
//! loop over arrays of lanes; no operation mixes lanes or is fused, so that a run's bits depend
//! neither on its neighbours nor on the width of the machine's vectors.

use multiversion::multiversion;

use super::records::{Candidate, Records};
use super::setup::{Bound, Layout, MODES, Reading, Setup};
use super::{Reader, RUNS, Row};
use crate::lanes::Lanes;
use crate::transition::{Drive, State};

/// Periods of a block.
pub(super) const PERIODS: usize = 32;

const ZERO: Row = [0.0; RUNS];

/// A row for each period of a block.
type Rows = [Row; PERIODS];

/// A number of every lane's set-up.
fn gather(setups: &[&Setup], part: impl Fn(&Setup) -> f64) -> Row {
    std::array::from_fn(|lane| part(setups[lane.min(setups.len() - 1)]))
}

/// One mode's transition over a leg.
#[derive(Clone, Copy)]
struct Step {
    g: Row,
    s: Row,
    w: Row,
    h: Row,
}

/// Weights of an output.
struct Weights {
    d: [Row; MODES],
    v: [Row; MODES],
    rise: Vec<Row>,
    /// Of the rises, at the end of each leg: heights grow on the way.
    end_rise: Vec<Vec<Row>>,
    height: Vec<Row>,
    first: Vec<Row>,
    bulge: [BoundRow; 2],
}

/// See [`Bound`].
struct BoundRow {
    state: [[Row; MODES]; 2],
    after: Vec<Row>,
    before: Vec<Row>,
}

impl BoundRow {
    fn new(setups: &[&Setup], of: impl Fn(&Setup) -> &Bound) -> Self {
        let groups = setups[0].layout.groups.len();
        Self {
            state: [0, 1].map(|part| std::array::from_fn(|m| gather(setups, |s| of(s).state[part][m]))),
            after: (0..groups).map(|g| gather(setups, |s| of(s).after[g])).collect(),
            before: (0..groups).map(|g| gather(setups, |s| of(s).before[g])).collect(),
        }
    }
}

/// Constants of the runs side by side.
pub(super) struct Constants {
    /// Leg by leg, mode by mode.
    steps: Vec<[Step; MODES]>,
    climb: Vec<[Row; MODES]>,
    drag: Vec<[Row; MODES]>,
    weights: Vec<Weights>,
    /// How far each leg begins from a group's station, in spacings: leg by leg, group by group.
    from_station: Vec<Vec<Row>>,
}

impl Constants {
    pub fn new(setups: &[&Setup]) -> Self {
        let layout = &setups[0].layout;
        let (legs, groups) = (layout.legs, layout.groups.len());
        let step = |leg: usize, m: usize| Step {
            g: gather(setups, |s| s.transition[leg].g[m]),
            s: gather(setups, |s| s.transition[leg].s[m]),
            w: gather(setups, |s| s.transition[leg].w[m]),
            h: gather(setups, |s| s.transition[leg].h[m]),
        };
        let a_mode = |of: &dyn Fn(&Setup) -> Lanes| std::array::from_fn(|m| gather(setups, |s| of(s)[m]));
        let weights = |output: usize| {
            let a_group = |of: &dyn Fn(&Reading, usize) -> f64| -> Vec<Row> {
                (0..groups).map(|g| gather(setups, |s| of(&s.readings[output], g))).collect()
            };
            Weights {
                d: a_mode(&|s| s.readings[output].output.form.d),
                v: a_mode(&|s| s.readings[output].output.form.v),
                rise: a_group(&|r, g| r.rise[g]),
                end_rise: (0..legs)
                    .map(|leg| {
                        (0..groups)
                            .map(|g| {
                                gather(setups, |s| {
                                    let r = &s.readings[output];
                                    r.rise[g] + r.rate[g] * s.dt[leg]
                                })
                            })
                            .collect()
                    })
                    .collect(),
                height: a_group(&|r, g| r.output.form.height[g]),
                first: a_group(&|r, g| r.output.form.first[g]),
                bulge: [0, 1].map(|kind| BoundRow::new(setups, |s| &s.readings[output].bulge[kind])),
            }
        };
        Self {
            steps: (0..legs).map(|leg| std::array::from_fn(|m| step(leg, m))).collect(),
            climb: (0..groups).map(|g| a_mode(&|s| s.climb[g])).collect(),
            drag: (0..groups).map(|g| a_mode(&|s| s.drag[g])).collect(),
            weights: (0..setups[0].readings.len()).map(weights).collect(),
            from_station: (0..legs)
                .map(|leg| (0..groups).map(|g| gather(setups, |s| s.begin[leg] - s.part[g])).collect())
                .collect(),
        }
    }
}

/// One group's elevations and rises in a block.
#[derive(Clone)]
struct Ground {
    /// Elevation of the last station met before each period's own, and one more.
    z: [Row; PERIODS + 1],
    /// Rise up to each period's station, and one more: rise\[i + 1\] follows station i.
    rise: [Row; PERIODS + 1],
}

/// Where several runs are on their way.
pub(super) struct March<'a> {
    layout: &'a Layout,
    constants: &'a Constants,
    ground: Vec<Ground>,
    /// First elevations less those of the first group.
    first: Vec<Row>,
    origin: Row,
    /// State at the start of each leg, leg by leg: d and ẏ/ω of each mode, a row a period.
    states: Vec<[Rows; 2 * MODES]>,
    state: [Row; 2 * MODES],
    /// Heights at the start of each leg, leg by leg, group by group.
    heights: Vec<Vec<Rows>>,
    /// What drives the modes, by the leg on which it sets in: rate and force of the static position.
    drive: Vec<[[Rows; MODES]; 2]>,
    /// The same in the period before.
    last_drive: Vec<[[Row; MODES]; 2]>,
    /// Values of one output at the starts of the legs, and just before their ends where these are
    /// not the next ones' starts.
    values: Vec<Rows>,
    ends: Vec<Rows>,
    /// Moments of the periods' rows, lower triangle, over the run and over its tail.
    pub moments: [Vec<Row>; 2],
    first_rows: Vec<Rows>,
    pub records: Records,
}

impl<'a> March<'a> {
    pub fn new(layout: &'a Layout, constants: &'a Constants) -> Self {
        let groups = layout.groups.len();
        let rows = layout.rows();
        let heights = if layout.heights { groups } else { 0 };
        let outputs = constants.weights.len();
        Self {
            layout,
            constants,
            ground: vec![Ground { z: [ZERO; PERIODS + 1], rise: [ZERO; PERIODS + 1] }; groups],
            first: vec![ZERO; groups],
            origin: ZERO,
            states: vec![[[ZERO; PERIODS]; 2 * MODES]; layout.legs],
            state: [ZERO; 2 * MODES],
            heights: vec![vec![[ZERO; PERIODS]; heights]; layout.legs],
            drive: vec![[[[ZERO; PERIODS]; MODES]; 2]; layout.legs],
            last_drive: vec![[[ZERO; MODES]; 2]; layout.legs],
            values: vec![[ZERO; PERIODS]; layout.legs],
            ends: vec![[ZERO; PERIODS]; if layout.damped { layout.legs } else { 0 }],
            moments: [vec![ZERO; rows * (rows + 1) / 2], vec![ZERO; rows * (rows + 1) / 2]],
            first_rows: vec![[ZERO; PERIODS]; heights],
            records: Records::new(layout.loads, outputs),
        }
    }

    /// Begins anew, at rest on the first elevations.
    pub fn restart(&mut self, reader: &mut impl Reader) {
        self.state = [ZERO; 2 * MODES];
        for ground in &mut self.ground {
            ground.rise = [ZERO; PERIODS + 1];
        }
        self.last_drive.fill([[ZERO; MODES]; 2]);
        for moments in &mut self.moments {
            moments.fill(ZERO);
        }
        for group in 0..self.ground.len() {
            let mut first = [ZERO];
            reader.read(self.layout.groups[group].track, 0, &mut first);
            self.ground[group].z[PERIODS] = first[0];
        }
        self.origin = self.ground[0].z[PERIODS];
        for group in 0..self.ground.len() {
            for lane in 0..RUNS {
                self.first[group][lane] = self.ground[group].z[PERIODS][lane] - self.origin[lane];
            }
        }
        if self.layout.heights {
            for (rows, first) in self.first_rows.iter_mut().zip(&self.first) {
                rows.fill(*first);
            }
        }
        // At rest nothing but these elevations enters.
        self.records.restart();
        for (output, weights) in self.constants.weights.iter().enumerate() {
            let mut rest = ZERO;
            for group in 1..self.ground.len() {
                for lane in 0..RUNS {
                    rest[lane] +=
                        (weights.height[group][lane] + weights.first[group][lane]) * self.first[group][lane];
                }
            }
            self.records.see(output, &rest, &rest);
        }
    }

    /// The block of `count` periods that begins with `period`; of its periods only so many legs in
    /// the tail.
    pub fn block(&mut self, reader: &mut impl Reader, stations: usize, period: usize, count: usize, tail: bool) {
        for group in 0..self.ground.len() {
            let (track, whole) = (self.layout.groups[group].track, self.layout.groups[group].whole);
            let ground = &mut self.ground[group];
            ground.z[0] = ground.z[PERIODS];
            ground.rise[0] = ground.rise[PERIODS];
            // Period i meets station i − whole; station + 1 ends the rise that begins there. Beyond
            // either end the runway is level.
            let to = (period + 1 + count).saturating_sub(whole).min(stations);
            let level = whole.saturating_sub(period).min(count);
            let first = (period + 1 + level).saturating_sub(whole);
            let last = to.max(first);
            let read = last - first;
            for i in 0..level {
                ground.z[i + 1] = ground.z[0];
            }
            if read > 0 {
                reader.read(track, first, &mut ground.z[level + 1..=level + read]);
            }
            for i in level + read..count {
                ground.z[i + 1] = ground.z[level + read];
            }
        }
        let legs = if tail { self.layout.tail } else { self.layout.legs };
        work(self, count, legs, tail);
        for ground in &mut self.ground {
            ground.z[PERIODS] = ground.z[count];
            ground.rise[PERIODS] = ground.rise[count];
        }
    }
}

/// What of a block is arithmetic.
#[multiversion(targets("x86_64+avx512f+avx512dq+avx512vl+avx512bw", "x86_64+avx2"))]
fn work(march: &mut March, count: usize, legs: usize, tail: bool) {
    assert!(count <= PERIODS);
    for ground in &mut march.ground {
        let Ground { z, rise } = ground;
        for i in 0..count {
            for lane in 0..RUNS {
                rise[i + 1][lane] = z[i + 1][lane] - z[i][lane];
            }
        }
    }
    march.find_drives(count);
    match (march.layout.legs, march.layout.damped) {
        (1, false) if !tail => march.states::<1, false>(count, legs),
        (2, false) if !tail => march.states::<2, false>(count, legs),
        (_, false) => march.states::<0, false>(count, legs),
        (_, true) => march.states::<0, true>(count, legs),
    }
    if march.layout.heights {
        // The tail ends where its next leg begins.
        march.find_heights(count, if tail { legs + 1 } else { legs });
    }
    let reach = march.find_moments(count, tail);
    march.look(count, legs, &reach);
    if tail && march.layout.damped {
        march.look_back(legs);
    }
}

impl March<'_> {
    #[inline(always)]
    fn find_drives(&mut self, count: usize) {
        let Self { layout, constants, ground, drive, .. } = self;
        let kinds = if layout.damped { 2 } else { 1 };
        for (leg, drive) in drive.iter_mut().enumerate() {
            for (kind, of_group) in [&constants.climb, &constants.drag].into_iter().enumerate().take(kinds) {
                let mut fresh = true;
                for (group, ground) in ground.iter().enumerate() {
                    if layout.groups[group].leg != leg {
                        continue;
                    }
                    for mode in 0..MODES {
                        let weight = &of_group[group][mode];
                        let rows = &mut drive[kind][mode];
                        for i in 0..count {
                            for lane in 0..RUNS {
                                let share = weight[lane] * ground.rise[i + 1][lane];
                                rows[i][lane] = if fresh { share } else { rows[i][lane] + share };
                            }
                        }
                    }
                    fresh = false;
                }
            }
        }
    }

    /// States at the start of every leg; `L` legs, all for 0.
    #[inline(always)]
    fn states<const L: usize, const DAMPED: bool>(&mut self, count: usize, legs: usize) {
        let Self { constants, states, state, drive, last_drive, .. } = self;
        let legs = if L == 0 { legs } else { L };
        let all = drive.len();
        let mut now = *state;
        for i in 0..count {
            for leg in 0..legs {
                let steps = &constants.steps[leg];
                for mode in 0..MODES {
                    let Step { g, s, w, h } = &steps[mode];
                    let mut beta = ZERO;
                    let mut gamma = ZERO;
                    for from in 0..if L == 0 { all } else { L } {
                        let [beta_now, gamma_now] =
                            if from <= leg { drive[from].each_ref().map(|kind| kind[mode][i]) } else { last_drive[from].map(|kind| kind[mode]) };
                        for lane in 0..RUNS {
                            beta[lane] += beta_now[lane];
                            if DAMPED {
                                gamma[lane] += gamma_now[lane];
                            }
                        }
                    }
                    let (d, v) = (now[mode], now[MODES + mode]);
                    states[leg][mode][i] = d;
                    states[leg][MODES + mode][i] = v;
                    let (mut after_d, mut after_v) = (ZERO, ZERO);
                    for lane in 0..RUNS {
                        let pull = s[lane] * v[lane] - g[lane] * d[lane];
                        after_d[lane] = (d[lane] - h[lane] * beta[lane]) + pull;
                        after_v[lane] =
                            (v[lane] + g[lane] * beta[lane]) - (w[lane] * v[lane] + s[lane] * d[lane]);
                        if DAMPED {
                            after_d[lane] += g[lane] * gamma[lane];
                            after_v[lane] += s[lane] * gamma[lane];
                        }
                    }
                    now[mode] = after_d;
                    now[MODES + mode] = after_v;
                }
            }
            for from in 0..all {
                for kind in 0..if DAMPED { 2 } else { 1 } {
                    for mode in 0..MODES {
                        last_drive[from][kind][mode] = drive[from][kind][mode][i];
                    }
                }
            }
        }
        *state = now;
    }

    /// Elevations at the start of every leg, as heights above the first group's, and its own rise.
    #[inline(always)]
    fn find_heights(&mut self, count: usize, legs: usize) {
        let Self { layout, constants, ground, heights, origin, .. } = self;
        for leg in 0..legs {
            for (group, out) in heights[leg].iter_mut().enumerate() {
                let met = usize::from(layout.groups[group].leg <= leg);
                let own = &constants.from_station[leg][group];
                let met_first = usize::from(layout.groups[0].leg <= leg);
                let of_first = &constants.from_station[leg][0];
                for i in 0..count {
                    for lane in 0..RUNS {
                        let first_climb = of_first[lane] * ground[0].rise[i + met_first][lane];
                        let climb = own[lane] * ground[group].rise[i + met][lane];
                        out[i][lane] = if group == 0 {
                            (ground[0].z[i][lane] - origin[lane]) + first_climb
                        } else {
                            (ground[group].z[i][lane] - ground[0].z[i][lane]) + (climb - first_climb)
                        };
                    }
                }
            }
        }
    }

    /// Adds up the products of a block's rows; gives the roots of the squares of states and rises.
    #[inline(always)]
    fn find_moments(&mut self, count: usize, tail: bool) -> Vec<Row> {
        let Self { layout, ground, states, heights, first_rows, moments, .. } = self;
        let mut rows: Vec<&[Row]> = states[0].iter().map(|rows| &rows[..count]).collect();
        rows.extend(ground.iter().map(|ground| &ground.rise[1..=count]));
        rows.extend(layout.inner().map(|group| &ground[group].rise[..count]));
        let plain = rows.len();
        if layout.heights {
            rows.extend(heights[0].iter().map(|rows| &rows[..count]));
            rows.extend(first_rows.iter().map(|rows| &rows[..count]));
        }
        let moments = &mut moments[usize::from(tail)];
        let mut roots = vec![ZERO; plain];
        for top in (0..rows.len()).step_by(3) {
            let high = (rows.len() - top).min(3);
            for left in (0..=top).step_by(3) {
                let wide = (rows.len() - left).min(3);
                let pick = |at: usize, size: usize| {
                    std::array::from_fn::<&[Row], 3, _>(|k| &rows[at + k.min(size - 1)][..count])
                };
                let (a, b) = (pick(top, high), pick(left, wide));
                let sums = if top == left { triangle(a, count) } else { square(a, b, count) };
                for (i, sums) in sums.iter().enumerate().take(high) {
                    for (j, sum) in sums.iter().enumerate().take(wide) {
                        let (row, column) = (top + i, left + j);
                        if column > row {
                            continue;
                        }
                        let moment = &mut moments[row * (row + 1) / 2 + column];
                        for lane in 0..RUNS {
                            moment[lane] += sum[lane];
                        }
                        if column == row && row < plain {
                            for lane in 0..RUNS {
                                roots[row][lane] = sum[lane].sqrt();
                            }
                        }
                    }
                }
            }
        }
        roots
    }

    /// Values at the ends of all legs; keeps the stretches that may hold a record.
    #[inline(always)]
    fn look(&mut self, count: usize, legs: usize, reach: &[Row]) {
        if count * legs == 0 {
            return;
        }
        for output in 0..self.constants.weights.len() {
            let (mut top, mut bottom) = ([f64::NEG_INFINITY; RUNS], [f64::INFINITY; RUNS]);
            for leg in 0..legs {
                if self.layout.lines {
                    self.values_with_lines(output, leg, count);
                    scan(&self.values[leg][..count], &mut top, &mut bottom);
                } else if self.layout.by_rate[output] {
                    self.plain_values::<true>(output, leg, count, &mut top, &mut bottom);
                } else {
                    self.plain_values::<false>(output, leg, count, &mut top, &mut bottom);
                }
                if self.layout.damped {
                    for i in 0..count {
                        self.ends[leg][i] = self.end_value(output, leg, legs, i, count);
                    }
                    scan(&self.ends[leg][..count], &mut top, &mut bottom);
                }
            }
            let last = self.end_value(output, legs - 1, legs, count - 1, count);
            scan(&[last], &mut top, &mut bottom);
            self.records.see(output, &top, &bottom);
            let bulge = self.bulge(output, reach);
            if self.records.may_hold(output, &top, &bottom, &bulge) {
                self.keep(output, (count, legs), &[top, bottom, bulge, last]);
            }
        }
    }

    /// The far side of the last station of all, where a damped output may jump.
    fn look_back(&mut self, leg: usize) {
        for (rows, state) in self.states[leg].iter_mut().zip(self.state) {
            rows[0] = state;
        }
        for output in 0..self.constants.weights.len() {
            self.values_with_lines(output, leg, 1);
            self.records.see(output, &self.values[leg][0], &self.values[leg][0]);
        }
    }

    /// Values at the starts of a leg where only the state counts.
    #[inline(always)]
    fn plain_values<const RATES: bool>(
        &mut self,
        output: usize,
        leg: usize,
        count: usize,
        top: &mut Row,
        bottom: &mut Row,
    ) {
        let Weights { d, v, .. } = &self.constants.weights[output];
        let (states, values) = (&self.states[leg], &mut self.values[leg]);
        let (mut high, mut low) = (*top, *bottom);
        for i in 0..count {
            for lane in 0..RUNS {
                let mut value = (d[0][lane] * states[0][i][lane] + d[1][lane] * states[1][i][lane])
                    + d[2][lane] * states[2][i][lane];
                if RATES {
                    value += (v[0][lane] * states[3][i][lane] + v[1][lane] * states[4][i][lane])
                        + v[2][lane] * states[5][i][lane];
                }
                values[i][lane] = value;
                high[lane] = if value > high[lane] { value } else { high[lane] };
                low[lane] = if value < low[lane] { value } else { low[lane] };
            }
        }
        (*top, *bottom) = (high, low);
    }

    /// Values at the starts of a leg, elevations and slopes included.
    #[inline(always)]
    fn values_with_lines(&mut self, output: usize, leg: usize, count: usize) {
        let Self { layout, constants, ground, states, heights, first, values, .. } = self;
        let weights = &constants.weights[output];
        for i in 0..count {
            let mut value = ZERO;
            for mode in 0..MODES {
                for lane in 0..RUNS {
                    value[lane] += weights.d[mode][lane] * states[leg][mode][i][lane]
                        + weights.v[mode][lane] * states[leg][MODES + mode][i][lane];
                }
            }
            for group in 0..ground.len() {
                let met = usize::from(layout.groups[group].leg <= leg);
                for lane in 0..RUNS {
                    value[lane] += weights.rise[group][lane] * ground[group].rise[i + met][lane];
                    if layout.heights {
                        value[lane] += weights.height[group][lane] * heights[leg][group][i][lane]
                            + weights.first[group][lane] * first[group][lane];
                    }
                }
            }
            values[leg][i] = value;
        }
    }

    /// State just before the end of a leg.
    #[inline(always)]
    fn end_state(&self, leg: usize, legs: usize, i: usize, count: usize) -> [Row; 2 * MODES] {
        if leg + 1 < legs {
            std::array::from_fn(|part| self.states[leg + 1][part][i])
        } else if i + 1 < count {
            std::array::from_fn(|part| self.states[0][part][i + 1])
        } else {
            self.state
        }
    }

    /// Value just before the end of a leg.
    #[inline(always)]
    fn end_value(&self, output: usize, leg: usize, legs: usize, i: usize, count: usize) -> Row {
        let weights = &self.constants.weights[output];
        let state = self.end_state(leg, legs, i, count);
        let mut value = ZERO;
        for mode in 0..MODES {
            for lane in 0..RUNS {
                value[lane] += weights.d[mode][lane] * state[mode][lane]
                    + weights.v[mode][lane] * state[MODES + mode][lane];
            }
        }
        if self.layout.lines {
            for group in 0..self.ground.len() {
                let met = usize::from(self.layout.groups[group].leg <= leg);
                for lane in 0..RUNS {
                    value[lane] +=
                        weights.end_rise[leg][group][lane] * self.ground[group].rise[i + met][lane];
                    if self.layout.heights {
                        value[lane] += weights.height[group][lane] * self.heights[leg][group][i][lane]
                            + weights.first[group][lane] * self.first[group][lane];
                    }
                }
            }
        }
        value
    }

    /// How far an output may rise above, or fall below, its values at the ends of the legs.
    #[inline(always)]
    fn bulge(&self, output: usize, reach: &[Row]) -> Row {
        let groups = self.ground.len();
        let [by_bend, by_swing] = &self.constants.weights[output].bulge;
        let mut bounds = [ZERO; 2];
        for (bound, BoundRow { state, after, before }) in bounds.iter_mut().zip([by_bend, by_swing]) {
            for lane in 0..RUNS {
                for mode in 0..MODES {
                    bound[lane] += state[0][mode][lane] * reach[mode][lane]
                        + state[1][mode][lane] * reach[MODES + mode][lane];
                }
                for group in 0..groups {
                    bound[lane] += after[group][lane] * reach[2 * MODES + group][lane];
                }
            }
            for (place, group) in self.layout.inner().enumerate() {
                for lane in 0..RUNS {
                    bound[lane] += before[group][lane] * reach[2 * MODES + groups + place][lane];
                }
            }
        }
        std::array::from_fn(|lane| bounds[0][lane].min(bounds[1][lane]))
    }

    /// Keeps the stretches of a block that may hold a record of an output.
    #[cold]
    #[inline(never)]
    fn keep(&mut self, output: usize, (count, legs): (usize, usize), [top, bottom, bulge, last]: &[Row; 4]) {
        for lane in 0..RUNS {
            for (side, sign) in [1.0, -1.0].into_iter().enumerate() {
                let record = self.records.best(output, side, lane);
                let enough = record - bulge[lane];
                if [top[lane], -bottom[lane]][side] <= enough {
                    continue;
                }
                for i in 0..count {
                    for leg in 0..legs {
                        let end = if self.layout.damped {
                            self.ends[leg][i][lane]
                        } else if leg + 1 < legs {
                            self.values[leg + 1][i][lane]
                        } else if i + 1 < count {
                            self.values[0][i + 1][lane]
                        } else {
                            last[lane]
                        };
                        let highest = (sign * self.values[leg][i][lane]).max(sign * end);
                        if highest > enough {
                            let bound = highest + bulge[lane];
                            let candidate = self.candidate(output, leg, i, lane, bound);
                            self.records.keep(output, side, lane, candidate);
                        }
                    }
                }
            }
        }
    }

    /// A leg of one run as a stretch to be searched.
    fn candidate(&self, output: usize, leg: usize, i: usize, lane: usize, bound: f64) -> Candidate {
        let weights = &self.constants.weights[output];
        let none = Lanes::ZERO;
        let mut state = State { d: none, v: none, p: none };
        let mut drive = Drive { beta: none, gamma: none };
        let (mut start, mut growth) = (0.0, 0.0);
        for mode in 0..MODES {
            state.d[mode] = self.states[leg][mode][i][lane];
            state.v[mode] = self.states[leg][MODES + mode][i][lane];
        }
        for group in 0..self.ground.len() {
            let met = usize::from(self.layout.groups[group].leg <= leg);
            let rise = self.ground[group].rise[i + met][lane];
            for mode in 0..MODES {
                drive.beta[mode] += self.constants.climb[group][mode][lane] * rise;
                drive.gamma[mode] += self.constants.drag[group][mode][lane] * rise;
            }
            start += weights.rise[group][lane] * rise;
            growth += (weights.end_rise[leg][group][lane] - weights.rise[group][lane]) * rise;
            if self.layout.heights {
                start += weights.height[group][lane] * self.heights[leg][group][i][lane]
                    + weights.first[group][lane] * self.first[group][lane];
            }
        }
        Candidate { bound, leg, state, drive, start, growth }
    }
}

#[inline(always)]
fn scan(values: &[Row], top: &mut Row, bottom: &mut Row) {
    for value in values {
        for lane in 0..RUNS {
            top[lane] = if value[lane] > top[lane] { value[lane] } else { top[lane] };
            bottom[lane] = if value[lane] < bottom[lane] { value[lane] } else { bottom[lane] };
        }
    }
}

/// Sums of products of three rows with three.
#[inline(always)]
fn square(a: [&[Row]; 3], b: [&[Row]; 3], count: usize) -> [[Row; 3]; 3] {
    let (a, b) = (a.map(|row| &row[..count]), b.map(|row| &row[..count]));
    let mut sums = [[ZERO; 3]; 3];
    for i in 0..count {
        for row in 0..3 {
            for column in 0..3 {
                for lane in 0..RUNS {
                    sums[row][column][lane] += a[row][i][lane] * b[column][i][lane];
                }
            }
        }
    }
    sums
}

/// Sums of products of three rows with themselves, on and below the diagonal.
#[inline(always)]
fn triangle(a: [&[Row]; 3], count: usize) -> [[Row; 3]; 3] {
    let a = a.map(|row| &row[..count]);
    let mut sums = [[ZERO; 3]; 3];
    for i in 0..count {
        for row in 0..3 {
            for column in 0..=row {
                for lane in 0..RUNS {
                    sums[row][column][lane] += a[row][i][lane] * a[column][i][lane];
                }
            }
        }
    }
    sums
}
