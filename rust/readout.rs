//! What is read off the modal motion: one linear form an output.

use multiversion::multiversion;
use nalgebra::Vector3;

use crate::error::{Error, Result};
use crate::lanes::{LANES, Lanes};
use crate::march::{Segment, Visitor, march};
use crate::run::{Grid, Pulse, Run};
use crate::transition::{State, Transition};

/// Which quantity to read.
#[derive(Clone, Debug, PartialEq)]
pub enum Quantity {
    /// CG coordinates {bounce, pitch, roll} (Eq. 19).
    Cg,
    /// Their rates.
    CgRate,
    /// Their accelerations.
    CgAcceleration,
    /// Displacement of the body at each gear (Eq. 20).
    GearDisplacement,
    /// Compression load of each gear, static load included (Eq. 21, general form).
    Load,
    /// Vertical acceleration at points (x, y) of the body.
    Acceleration(Vec<(f64, f64)>),
}

/// One output as a linear form of state, rates of elevation and elevations.
///
/// Elevations enter as differences between tracks (and one from the start), so that a runway
/// high above its datum costs no digits.
#[derive(Clone, Debug)]
pub(crate) struct Form {
    pub constant: f64,
    pub d: Lanes,
    pub v: Lanes,
    p: Lanes,
    /// One a track.
    rate: Vec<f64>,
    /// Entry 0: rise of the first track since the start; others: track − first track.
    height: Vec<f64>,
}

/// The straight-line part of a form along one segment.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Line {
    pub start: f64,
    pub rate: f64,
}

impl Form {
    fn zero(run: &Run) -> Self {
        let (none, tracks) = (Lanes::ZERO, run.tracks.len());
        Self { constant: 0.0, d: none, v: none, p: none, rate: vec![0.0; tracks], height: vec![0.0; tracks] }
    }

    /// Acceleration along `direction`: p̈ = −ω²d − 2ζω ṗ, plus the dampers' input.
    fn acceleration(run: &Run, direction: Vector3<f64>) -> Self {
        let mut form = Self::zero(run);
        for (lane, shape) in run.modes.shapes().iter().enumerate() {
            let omega = run.oscillators.omega[lane];
            let scale = direction.dot(shape) * omega * omega;
            form.d[lane] = -scale;
            form.v[lane] = -scale * run.oscillators.two_zeta[lane];
            for (rate, track) in form.rate.iter_mut().zip(&run.tracks) {
                *rate += scale * track.drag[lane];
            }
        }
        form
    }

    /// Displacement along `direction`; `rest` is where the run starts.
    fn displacement(run: &Run, direction: Vector3<f64>) -> Self {
        let mut form = Self::zero(run);
        for (lane, shape) in run.modes.shapes().iter().enumerate() {
            form.p[lane] = direction.dot(shape);
        }
        if !run.modes.statics().own {
            // Modes that are not all of the aircraft's own start from where it stands.
            form.constant = direction.dot(&run.rest()) - form.p.dot(run.modal_rest());
        }
        form
    }

    fn velocity(run: &Run, direction: Vector3<f64>) -> Self {
        let mut form = Self::zero(run);
        for (lane, shape) in run.modes.shapes().iter().enumerate() {
            form.v[lane] = direction.dot(shape) * run.oscillators.omega[lane];
        }
        form
    }

    /// k (u − gear displacement) + static load, and the damper's force where its input is kept.
    fn load(run: &Run, gear: usize) -> Self {
        let aircraft = run.modes.aircraft();
        let statics = run.modes.statics();
        let k = aircraft.gears()[gear].stiffness;
        let mut form = Self::zero(run);
        for (lane, shape) in run.modes.shapes().iter().enumerate() {
            form.d[lane] = -k * aircraft.gears()[gear].row().dot(shape);
        }
        if run.damping_input {
            let c = aircraft.gears()[gear].damping;
            form.v = form.d * (c / k) * run.oscillators.omega;
            form.rate[run.track_of[gear]] = c;
        }
        // Elevations as heights: the first gear's rise since the start, the others above it.
        let first: Vec<f64> = run.first_elevations().collect();
        let mut warp = 0.0;
        for (j, &track) in run.track_of.iter().enumerate() {
            let (now, start) = (k * statics.unfollowed[gear][j], k * statics.warp[gear][j]);
            form.height[0] += now;
            if track != 0 {
                form.height[track] += now;
            }
            warp += (start - now) * (first[j] - first[0]);
        }
        if statics.own {
            form.height[0] = 0.0;
        }
        form.constant = aircraft.static_load()[gear] + warp;
        form
    }

    /// The forms of a quantity, one an output.
    pub fn all(run: &Run, quantity: &Quantity) -> Vec<Self> {
        let gears = run.modes.aircraft().gears();
        let axes = [Vector3::x(), Vector3::y(), Vector3::z()];
        match quantity {
            Quantity::Cg => axes.map(|axis| Self::displacement(run, axis)).into(),
            Quantity::CgRate => axes.map(|axis| Self::velocity(run, axis)).into(),
            Quantity::CgAcceleration => axes.map(|axis| Self::acceleration(run, axis)).into(),
            Quantity::GearDisplacement => {
                gears.iter().map(|gear| Self::displacement(run, gear.row())).collect()
            }
            Quantity::Load => (0..gears.len()).map(|gear| Self::load(run, gear)).collect(),
            Quantity::Acceleration(points) => {
                points.iter().map(|&(x, y)| Self::acceleration(run, Vector3::new(1.0, x, y))).collect()
            }
        }
    }

    /// Whether elevations enter.
    fn needs_heights(&self) -> bool {
        self.height.iter().any(|&weight| weight != 0.0)
    }

    /// Whether anything but the modal state and a constant enters.
    pub fn has_line(&self) -> bool {
        self.needs_heights() || self.rate.iter().any(|&weight| weight != 0.0)
    }

    /// The part that the modal state does not carry, at heights given by [`Heights`].
    pub fn line(&self, segment: &Segment, heights: &Heights) -> Line {
        let mut line = Line { start: self.constant, rate: 0.0 };
        for track in 0..self.rate.len() {
            let climb = segment.slope(track) * heights.speed;
            line.start += self.rate[track] * climb + self.height[track] * heights.value[track];
            line.rate += self.height[track] * heights.rate[track];
        }
        line
    }

    /// Value at a state.
    #[inline]
    pub fn value(&self, state: &State) -> f64 {
        (self.d.dot(state.d) + self.v.dot(state.v)) + self.p.dot(state.p)
    }
}

/// Elevations of the tracks as heights (see [`Form::height`]), and their rates.
#[derive(Clone, Debug)]
pub(crate) struct Heights {
    needed: bool,
    speed: f64,
    first: f64,
    pub value: Vec<f64>,
    pub rate: Vec<f64>,
}

impl Heights {
    pub fn new(run: &Run, forms: &[Form]) -> Self {
        let none = vec![0.0; run.tracks.len()];
        Self {
            needed: forms.iter().any(Form::needs_heights),
            speed: run.speed,
            first: run.tracks[0].profile.z()[0],
            value: none.clone(),
            rate: none,
        }
    }

    /// Reads the heights at a time within a segment.
    pub fn read(&mut self, segment: &Segment, time: f64) {
        if !self.needed {
            return;
        }
        let base = segment.elevation(0, time);
        self.value[0] = base - self.first;
        self.rate[0] = segment.slope(0) * self.speed;
        for track in 1..self.value.len() {
            self.value[track] = segment.elevation(track, time) - base;
            self.rate[track] = segment.slope(track) * self.speed - self.rate[0];
        }
    }
}

/// Where the rows of a run are written: displacements and rates, `width` columns each.
struct Rows<'a> {
    width: usize,
    omega: Lanes,
    modal: &'a mut [f64],
    rate: &'a mut [f64],
    count: usize,
}

impl Rows<'_> {
    #[inline(always)]
    fn push(&mut self, state: &State) {
        let rate = state.v * self.omega;
        let at = self.count * self.width;
        for (out, Lanes(lanes)) in [(&mut *self.modal, state.p), (&mut *self.rate, rate)] {
            // Idle lanes spill into the next row, which is written later.
            match out.get_mut(at..at + LANES) {
                Some(row) => row.copy_from_slice(&lanes),
                None => out[at..at + self.width].copy_from_slice(&lanes[..self.width]),
            }
        }
        self.count += 1;
    }
}

/// Rows on a grid.
struct OnGrid<'a, 'b> {
    grid: Grid,
    time: &'a mut [f64],
    rows: &'a mut Rows<'b>,
}

impl OnGrid<'_, '_> {
    #[inline(always)]
    fn push(&mut self, time: f64, state: &State) {
        self.time[self.rows.count] = time;
        self.rows.push(state);
    }

    /// Rows between a segment's ends.
    #[cold]
    fn fill(&mut self, segment: Segment, begin: f64, end: f64) {
        let parts = ((end - begin) / self.grid.step).ceil();
        for part in 1..parts as usize {
            let between = begin + (end - begin) * (part as f64 / parts);
            self.push(between, &segment.state_at(between));
        }
        // The end of the grid, or the last instant before a vertical step: the step's own time
        // shows the other side.
        let over = segment.end > end;
        let last = if over { end } else { end.next_down() };
        if last > begin && (over || segment.ends_at_step()) {
            self.push(last, &segment.state_at(last));
        }
    }
}

impl Visitor for OnGrid<'_, '_> {
    #[inline(always)]
    fn visit(&mut self, segment: &Segment, _: &Transition) {
        // Rows are those times of a segment that lie before its end: of several knots at one
        // rounded time the last counts.
        let Grid { begin: first, end: last, step, .. } = self.grid;
        let begin = if segment.start > first { segment.start } else { first };
        if begin < segment.end {
            self.push(begin, &segment.state);
            let end = if segment.end < last { segment.end } else { last };
            if end - begin > step || segment.end > last || segment.ends_at_step() {
                self.fill(*segment, begin, end);
            }
        }
    }
}

/// Rows at given times.
struct AtTimes<'a, 'b> {
    times: &'a [f64],
    rows: &'a mut Rows<'b>,
}

impl Visitor for AtTimes<'_, '_> {
    #[inline(always)]
    fn visit(&mut self, segment: &Segment, _: &Transition) {
        while let Some(&time) = self.times.get(self.rows.count).filter(|&&time| time < segment.end) {
            self.rows.push(&segment.state_at(time));
        }
    }
}

#[multiversion(targets("x86_64+avx2"))]
fn sample_grid(run: &Run, grid: Grid, time: &mut [f64], rows: &mut Rows, pulse: &mut Pulse) -> Result<()> {
    march(run, grid.end, pulse, &mut OnGrid { grid, time, rows })
}

#[multiversion(targets("x86_64+avx2"))]
fn sample_times(run: &Run, times: &[f64], rows: &mut Rows, pulse: &mut Pulse) -> Result<()> {
    let end = times.last().copied().unwrap_or(f64::NEG_INFINITY);
    march(run, end, pulse, &mut AtTimes { times, rows })
}

impl Run {
    fn rows<'a>(&self, modal: &'a mut [f64], rate: &'a mut [f64]) -> Rows<'a> {
        Rows { width: self.modes.omega().len(), omega: self.oscillators.omega, modal, rate, count: 0 }
    }

    /// Times of a grid, modal displacements and rates at them, row by row, one column a mode.
    /// Gives the number of rows; there is room for `grid.most`.
    ///
    /// # Errors
    /// An overflow, or what `pulse` gives.
    ///
    /// # Panics
    /// If a slice is too short.
    pub fn sample(
        &self,
        grid: Grid,
        time: &mut [f64],
        modal: &mut [f64],
        rate: &mut [f64],
        pulse: &mut Pulse,
    ) -> Result<usize> {
        let mut rows = self.rows(modal, rate);
        sample_grid(self, grid, time, &mut rows, pulse)?;
        let (count, width) = (rows.count, rows.width);
        self.check_last(&time[..count], &rate[..count * width])?;
        Ok(count)
    }

    /// Modal displacements and rates at `times`, row by row, one column a mode.
    ///
    /// # Errors
    /// An overflow, or what `pulse` gives.
    ///
    /// # Panics
    /// If a slice is too short.
    pub fn states(
        &self,
        times: &[f64],
        modal: &mut [f64],
        rate: &mut [f64],
        pulse: &mut Pulse,
    ) -> Result<()> {
        let mut rows = self.rows(modal, rate);
        sample_times(self, times, &mut rows, pulse)?;
        self.check_last(times, rate)
    }

    /// What is no longer finite stays so: the last row tells of all.
    fn check_last(&self, times: &[f64], rate: &[f64]) -> Result<()> {
        let width = self.modes.omega().len();
        let last = rate.len().saturating_sub(width);
        check_finite("modal motion", &times[times.len().saturating_sub(1)..], &rate[last..], width)
    }

    /// A quantity at `times`, row by row.
    ///
    /// # Errors
    /// An overflow, or what `pulse` gives.
    pub fn read(&self, quantity: &Quantity, times: &[f64], out: &mut [f64], pulse: &mut Pulse) -> Result<()> {
        let forms = Form::all(self, quantity);
        let mut heights = Heights::new(self, &forms);
        let width = forms.len();
        let mut rows = times.iter().zip(out.chunks_exact_mut(width)).peekable();
        march(self, times.last().copied().unwrap_or(0.0), pulse, &mut |segment: &Segment| {
            while let Some((&time, row)) = rows.next_if(|row| *row.0 < segment.end) {
                let state = segment.state_at(time);
                heights.read(segment, time);
                for (value, form) in row.iter_mut().zip(&forms) {
                    *value = form.value(&state) + form.line(segment, &heights).start;
                }
            }
        })?;
        check_finite("a result", times, out, width)
    }

    /// Elevation under each gear at `times`, row by row; at a step, after it.
    ///
    /// # Errors
    /// What `pulse` gives.
    pub fn elevations(&self, times: &[f64], out: &mut [f64], pulse: &mut Pulse) -> Result<()> {
        let mut rows = times.iter().zip(out.chunks_exact_mut(self.track_of.len())).peekable();
        march(self, times.last().copied().unwrap_or(0.0), pulse, &mut |segment: &Segment| {
            while let Some((&time, row)) = rows.next_if(|row| *row.0 < segment.end) {
                for (value, &track) in row.iter_mut().zip(&self.track_of) {
                    *value = segment.elevation(track, time);
                }
            }
        })
    }
}

fn check_finite(quantity: &'static str, times: &[f64], values: &[f64], width: usize) -> Result<()> {
    match values.iter().position(|value| !value.is_finite()) {
        None => Ok(()),
        Some(i) => Err(Error::Overflow { quantity, time: times[i / width] }),
    }
}
