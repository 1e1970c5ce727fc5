//! Rows of results: at the default times, or at any a caller asks for.

use multiversion::multiversion;

use crate::error::{Error, Result};
use crate::inside::{AT_ONCE, Inside};
use crate::lanes::{LANES, Lanes};
use crate::march::{KnotBlock, Segment, Visitor, march, visit_each};
use crate::pages::Pages;
use crate::path::Trail;
use crate::readout::{Form, Heights, Quantity};
use crate::run::{Grid, Run};
use crate::transition::State;
use crate::watch::{Pulse, Watch};

/// Where the rows of a run are written: displacements and rates, `width` columns each.
struct Rows<'a> {
    width: usize,
    omega: Lanes,
    rest: Lanes,
    modal: &'a mut [f64],
    rate: &'a mut [f64],
    count: usize,
}

impl Rows<'_> {
    #[inline(always)]
    fn push(&mut self, state: &State) {
        let at = self.count * self.width;
        write(self.rest + state.p, self.modal, at, self.width);
        write(state.v * self.omega, self.rate, at, self.width);
        self.count += 1;
    }

    /// Whether there is room for so many rows, and for what idle lanes write after the last.
    fn has_room(&self, count: usize) -> bool {
        let end = (self.count + count) * self.width + LANES;
        end <= self.modal.len() && end <= self.rate.len()
    }

    /// A row a segment of a block.
    #[inline(always)]
    fn march<const N: usize>(&mut self, block: &mut KnotBlock) {
        let begin = self.count * N;
        self.count += block.times().len();
        let Self { omega, rest, modal, rate, .. } = self;
        let (modal, rate) = (&mut modal[begin..], &mut rate[begin..]);
        block.march_plain(&mut Wide::<N> { omega: *omega, rest: *rest, modal, rate });
    }
}

#[multiversion(targets("x86_64+avx2"))]
fn push_all(rows: &mut Rows, states: &[State]) {
    for state in states {
        rows.push(state);
    }
}

/// One row of so many columns. All lanes are written where there is room, in one store: what an
/// idle lane writes, the next row overwrites.
#[inline(always)]
fn write(lanes: Lanes, rows: &mut [f64], at: usize, width: usize) {
    if let Some(out) = rows.get_mut(at..at + LANES) {
        out.copy_from_slice(&lanes.0);
    } else {
        write_last(&lanes, rows, at, width);
    }
}

#[cold]
#[inline(never)]
fn write_last(lanes: &Lanes, rows: &mut [f64], at: usize, width: usize) {
    rows[at..at + width].copy_from_slice(&lanes.0[..width]);
}

/// Rows of `N` columns, where there is room for idle lanes.
struct Wide<'a, const N: usize> {
    omega: Lanes,
    rest: Lanes,
    modal: &'a mut [f64],
    rate: &'a mut [f64],
}

impl<const N: usize> Trail for Wide<'_, N> {
    #[inline(always)]
    fn see(&mut self, slot: usize, state: &State) {
        let row = slot * N..slot * N + LANES;
        self.modal[row.clone()].copy_from_slice(&(self.rest + state.p).0);
        self.rate[row].copy_from_slice(&(state.v * self.omega).0);
    }
}

/// Rows on a grid.
struct OnGrid<'a, 'b> {
    inside: Inside<'a>,
    /// Whether loads jump at every knot.
    jumps: bool,
    grid: Grid,
    time: &'a mut [f64],
    rows: &'a mut Rows<'b>,
    watch: Watch<'a>,
}

impl OnGrid<'_, '_> {
    fn push(&mut self, time: f64, state: &State) {
        self.time[self.rows.count] = time;
        self.rows.push(state);
    }

    /// Rows between a segment's ends.
    fn fill(&mut self, segment: &Segment, begin: f64, end: f64) {
        let parts = ((end - begin) / self.grid.step).ceil();
        let mut part = 1;
        while part < parts as usize {
            let count = (parts as usize - part).min(AT_ONCE);
            if !self.watch.go_on(count as u32) {
                return;
            }
            let first = self.rows.count;
            for (row, time) in self.time[first..first + count].iter_mut().enumerate() {
                *time = begin + (end - begin) * ((part + row) as f64 / parts);
            }
            self.look(segment, count);
            part += count;
        }
        // The end of the grid, or the last instant before a jump: the jump's own time shows the
        // other side.
        let over = segment.end > end;
        let last = if over { end } else { end.next_down() };
        let jumps = self.jumps || segment.ends_at_step();
        if last > begin && (over || jumps) {
            self.time[self.rows.count] = last;
            self.look(segment, 1);
        }
    }

    /// Rows at the next times.
    fn look(&mut self, segment: &Segment, count: usize) {
        let first = self.rows.count;
        push_all(self.rows, self.inside.states(segment, &self.time[first..first + count]));
    }

    /// Whether every segment from one of these times to the next gives one row, but for vertical
    /// steps: the usual block of a finely sampled profile.
    fn row_a_knot(&self, times: &[f64]) -> bool {
        let Grid { begin, end, step, .. } = self.grid;
        let (Some(&first), Some(&last)) = (times.first(), times.last()) else { return false };
        first >= begin && last <= end && are_spaced(times, step)
    }

    /// Times of the knots of a block but the last, so many rows on.
    fn keep_times(&mut self, rows: usize, block: &KnotBlock) {
        let [times @ .., _] = block.times() else { return };
        self.time[self.rows.count + rows..][..times.len()].copy_from_slice(times);
    }
}

impl Visitor for OnGrid<'_, '_> {
    fn visit(&mut self, segment: &Segment) {
        // Rows are those times of a segment that lie before its end: of several knots at one
        // rounded time the last counts.
        let begin = segment.start.max(self.grid.begin);
        if begin < segment.end && begin <= self.grid.end {
            self.push(begin, segment.state());
            let end = segment.end.min(self.grid.end);
            self.fill(segment, begin, end);
        }
    }

    fn visit_block(&mut self, block: &mut KnotBlock) {
        let jumps = self.jumps || block.has_steps();
        if jumps || !self.row_a_knot(block.times()) {
            block.march();
            visit_each(self, block);
            return;
        }
        // The first segment's row, and those of all knots but the last, which is the next block's
        // first.
        let (first, count) = (block.times()[0], block.times().len());
        let whole = self.row_a_knot(&[block.start(), first]);
        if whole && block.is_plain() && self.rows.has_room(count) {
            self.time[self.rows.count] = block.start();
            self.keep_times(1, block);
            march_into(self.rows, block);
        } else {
            block.march();
            self.visit(&block.first_segment());
            self.keep_times(0, block);
            push_all(self.rows, &block.states()[1..count]);
        }
    }

    fn pages(&self) -> Pages {
        let Rows { width, modal, rate, .. } = &*self.rows;
        Pages::default().and(self.time, 1).and(modal, *width).and(rate, *width)
    }

    fn go_on(&mut self, work: u32) -> bool {
        self.watch.go_on(work)
    }
}

/// Whether times are apart, by no more than a step.
#[multiversion(targets("x86_64+avx2"))]
fn are_spaced(times: &[f64], step: f64) -> bool {
    let pairs = times.iter().zip(&times[1..]);
    !pairs.fold(false, |any, (start, end)| any | (end <= start) | (end - start > step))
}

#[multiversion(targets("x86_64+avx2"))]
fn march_into(rows: &mut Rows, block: &mut KnotBlock) {
    match rows.width {
        1 => rows.march::<1>(block),
        2 => rows.march::<2>(block),
        _ => rows.march::<3>(block),
    }
}

/// Rows at given times: `write` gets the segment, the first row and the times in a row.
struct AtTimes<'a, W> {
    times: &'a [f64],
    row: usize,
    write: W,
    watch: Watch<'a>,
}

impl<W: FnMut(&Segment, usize, &[f64])> Visitor for AtTimes<'_, W> {
    fn visit(&mut self, segment: &Segment) {
        loop {
            let ahead = self.times[self.row..].iter().take(AT_ONCE);
            let count = ahead.take_while(|&&time| time < segment.end).count();
            if count == 0 || !self.watch.go_on(count as u32) {
                return;
            }
            (self.write)(segment, self.row, &self.times[self.row..self.row + count]);
            self.row += count;
        }
    }

    fn go_on(&mut self, work: u32) -> bool {
        self.watch.go_on(work)
    }
}

/// Marches over `times`.
fn at_times(
    run: &Run,
    times: &[f64],
    pulse: Pulse,
    write: impl FnMut(&Segment, usize, &[f64]),
) -> Result<()> {
    let mut visitor = AtTimes { times, row: 0, write, watch: Watch::new(pulse) };
    march(run, times.last().copied().unwrap_or(f64::NEG_INFINITY), &mut visitor);
    visitor.watch.outcome
}

fn sample_grid(run: &Run, grid: Grid, time: &mut [f64], rows: &mut Rows, pulse: Pulse) -> Result<()> {
    let mut visitor = OnGrid {
        inside: Inside::new(run),
        jumps: run.jumps_at_knots(),
        grid,
        time,
        rows,
        watch: Watch::new(pulse),
    };
    march(run, grid.end, &mut visitor);
    visitor.watch.outcome
}

fn sample_times(run: &Run, times: &[f64], rows: &mut Rows, pulse: Pulse) -> Result<()> {
    let mut inside = Inside::new(run);
    at_times(run, times, pulse, |segment, _, times| push_all(rows, inside.states(segment, times)))
}

impl Run {
    fn rows<'a>(&self, modal: &'a mut [f64], rate: &'a mut [f64]) -> Rows<'a> {
        let (width, omega) = (self.modes.omega().len(), self.oscillators.omega);
        Rows { width, omega, rest: self.modal_rest(), modal, rate, count: 0 }
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
        pulse: Pulse,
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
    /// Times that cannot be sampled, an overflow, or what `pulse` gives.
    ///
    /// # Panics
    /// If a slice has another length than rows times columns.
    pub fn states(&self, times: &[f64], modal: &mut [f64], rate: &mut [f64], pulse: Pulse) -> Result<()> {
        self.check_times(times)?;
        let size = times.len() * self.modes.omega().len();
        assert!(modal.len() == size && rate.len() == size, "modal or rate: not a row per time");
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
    /// Times that cannot be sampled, an overflow, or what `pulse` gives.
    ///
    /// # Panics
    /// If `out` has another length than rows times columns.
    pub fn read(&self, quantity: &Quantity, times: &[f64], out: &mut [f64], pulse: Pulse) -> Result<()> {
        self.check_times(times)?;
        let forms = Form::all(self, quantity);
        let mut heights = Heights::new(self, &forms);
        let width = forms.len();
        assert_eq!(out.len(), times.len() * width, "out: not a row per time");
        if width == 0 {
            return Ok(());
        }
        let mut inside = Inside::new(self);
        at_times(self, times, pulse, |segment, row, times| {
            let rows = out[row * width..].chunks_exact_mut(width);
            for ((row, state), &time) in rows.zip(inside.states(segment, times)).zip(times) {
                heights.read(segment, time);
                for (value, form) in row.iter_mut().zip(&forms) {
                    *value = form.value(state) + form.line(segment, &heights).start;
                }
            }
        })?;
        check_finite("a result", times, out, width)
    }

    /// Elevation under each gear at `times`, row by row; at a step, after it.
    ///
    /// # Errors
    /// Times that cannot be sampled, or what `pulse` gives.
    ///
    /// # Panics
    /// If `out` has another length than rows times columns.
    pub fn elevations(&self, times: &[f64], out: &mut [f64], pulse: Pulse) -> Result<()> {
        self.check_times(times)?;
        let width = self.track_of.len();
        assert_eq!(out.len(), times.len() * width, "out: not a row per time");
        at_times(self, times, pulse, |segment, row, times| {
            for (row, &time) in out[row * width..].chunks_exact_mut(width).zip(times) {
                for (value, &track) in row.iter_mut().zip(&self.track_of) {
                    let (base, climb) = segment.elevation(track, time);
                    *value = base + climb;
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
