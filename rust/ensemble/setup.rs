//! What modes, speed and spacing make of every period alike.
//!
//! A period lasts from one station under the foremost gears to the next. Each group of gears (one
//! track, one lag) meets exactly one station in it, always at the same share of it; between these
//! instants lie the legs of a period, on which every slope is constant.

use std::ops::Range;
use std::sync::Arc;

use crate::distance::Distance;
use crate::error::{Error, Place, Result};
use crate::extremes::{Lengths, Output};
use crate::lanes::Lanes;
use crate::modes::{MODES, Modes};
use crate::profile::Profile;
use crate::readout::{Form, Quantity};
use crate::run::Run;
use crate::track::HARMLESS;
use crate::transition::{Oscillators, Transition};

/// More spacings than this between two gears are a slip in the units.
const LONGEST_LAG: f64 = 1e8;

/// Where the stations of a group of gears fall.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Group {
    /// Whose elevations it meets.
    pub track: usize,
    /// Periods that it is behind the foremost gears.
    pub whole: usize,
    /// Leg that begins at its stations.
    pub leg: usize,
}

/// What runs side by side must have in common.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Layout {
    /// Stations of a track.
    pub stations: usize,
    /// In the order of their legs.
    pub groups: Vec<Group>,
    /// Which of them begin each leg.
    pub members: Vec<Range<usize>>,
    /// The group above whose elevation those of the others count.
    pub datum: usize,
    /// Legs of a period.
    pub legs: usize,
    /// Periods until the last gear is in that of its last station, and legs left in that.
    pub periods: usize,
    pub tail: usize,
    /// Loads come first among the outputs, then accelerations.
    pub loads: usize,
    /// Whether the dampers take part in the ground input, so that outputs may jump.
    pub damped: bool,
    /// Outputs into which velocities enter.
    pub by_rate: Vec<bool>,
    /// Legs at whose start an output's slope may jump: a load's, where its own gear meets a station.
    pub kinks: Vec<Vec<usize>>,
    /// Whether slopes or elevations enter an output.
    pub lines: bool,
    /// Whether elevations do.
    pub heights: bool,
}

impl Layout {
    /// Groups that meet their stations inside a period.
    pub fn inner(&self) -> impl Iterator<Item = usize> {
        (0..self.groups.len()).filter(|&group| self.groups[group].leg > 0)
    }

    /// The leg, with its period, that begins where one ends.
    pub fn after(&self, leg: usize, period: usize) -> (usize, usize) {
        if leg + 1 < self.legs { (leg + 1, period) } else { (0, period + 1) }
    }

    /// The station that a group meets in a period; beyond either end the runway is level.
    pub fn station(&self, group: &Group, period: usize) -> usize {
        period.saturating_sub(group.whole).min(self.stations - 1)
    }

    /// Rows of a period: modal state, rises after the groups' stations, rises before those inside
    /// the period, heights and first elevations.
    pub fn rows(&self) -> usize {
        self.inner_rows().end + if self.heights { 2 * self.groups.len() } else { 0 }
    }

    /// Those of the rises before stations inside the period.
    pub fn inner_rows(&self) -> Range<usize> {
        let begin = 2 * MODES + self.groups.len();
        begin..begin + self.inner().count()
    }

    /// Rows by threes, as their products are added up; none of one kind with one of another.
    pub fn triples(&self) -> Vec<Range<usize>> {
        let inner = self.inner_rows();
        let kinds = [0..2 * MODES, 2 * MODES..inner.start, inner.clone(), inner.end..self.rows()];
        let of_kind =
            |kind: Range<usize>| kind.clone().step_by(3).map(move |begin| begin..kind.end.min(begin + 3));
        kinds.into_iter().flat_map(of_kind).collect()
    }
}

/// One output: its form with what the constants of a period add.
pub(super) struct Reading {
    pub output: Output,
    /// Weights of the rises over a spacing, one a group.
    pub rise: Vec<f64>,
    /// Weights of heights and of first elevations, one a group.
    pub height: Vec<f64>,
    pub first: Vec<f64>,
    /// Rate of the straight-line part over a leg per rise.
    pub rate: Vec<f64>,
    /// Weights of the magnitudes of a period's rows, without heights, in two bounds on how far the output
    /// bulges above its values at two kinks in succession: by its curvature, and by its swing.
    pub bulge: [Vec<f64>; 2],
    /// Squares of durations as shares of that of the longest span between two kinks: of the span up to
    /// each kink, and of each leg.
    pub span: Vec<f64>,
    pub leg: Vec<f64>,
}

/// All that the runs of one set-up share.
pub(super) struct Setup {
    pub layout: Arc<Layout>,
    /// Share of a period at which each leg begins, and each group meets its station.
    pub begin: Vec<f64>,
    pub part: Vec<f64>,
    pub dt: Vec<f64>,
    pub transition: Vec<Transition>,
    /// Rates of the static position ÷ ω and forces ÷ ω² per rise over a spacing, one a group.
    pub climb: Vec<Lanes>,
    pub drag: Vec<Lanes>,
    pub bank: Oscillators,
    pub lengths: Arc<Lengths>,
    pub readings: Vec<Reading>,
    pub static_load: Vec<f64>,
    /// How long the statistics run.
    pub duration: f64,
}

/// A runway's grid.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stations {
    pub tracks: usize,
    pub count: usize,
    pub spacing: f64,
}

/// Whole spacings of a lag, and the rest.
fn split(lag: Distance, spacing: f64) -> Result<(usize, f64)> {
    let count = lag.nearest() / spacing;
    if count > LONGEST_LAG {
        let why = "more than 1e8 of them between two gears";
        return Err(Error::OutOfRange { place: Place::from("spacing"), value: spacing, why });
    }
    let rest = |whole: f64| lag.minus(Distance::product(whole, spacing));
    let whole = count.floor() + (rest(count.floor()) / spacing).floor();
    let harmless = HARMLESS * spacing;
    match rest(whole) {
        over if over >= spacing - harmless => Ok((whole as usize + 1, 0.0)),
        over if over <= harmless => Ok((whole as usize, 0.0)),
        over => Ok((whole as usize, over)),
    }
}

/// Whether a slope under some gears gives a form of this weight of ḋ a slope: rounding gives none.
fn jumps(weights: Lanes, climb: Lanes) -> bool {
    const ROUNDING: f64 = 1e-13;
    weights.dot(climb).abs() > ROUNDING * weights.abs().dot(climb.abs())
}

/// A run over profiles that stand for all: their grid, and first elevations of zero. Also the number of the
/// profile that each of the run's tracks has.
fn stand_in(
    modes: &Arc<Modes>,
    Stations { tracks, count, spacing }: Stations,
    speed: f64,
    damping_input: bool,
) -> Result<(Run, Vec<usize>)> {
    let last = (count.max(2) - 1) as f64 * spacing;
    let (x, z) = if count > 2 {
        (vec![0.0, spacing, last], vec![0.0, spacing, 0.0])
    } else {
        (vec![0.0, spacing], vec![0.0, spacing])
    };
    let profiles: Vec<Arc<Profile>> =
        (0..tracks).map(|_| Ok(Arc::new(Profile::new(x.clone(), z.clone())?))).collect::<Result<_>>()?;
    let gears = modes.aircraft().gears().len();
    let of_gear: Vec<Arc<Profile>> =
        (0..gears).map(|gear| Arc::clone(&profiles[if tracks == 1 { 0 } else { gear }])).collect();
    let run = Run::new(Arc::clone(modes), &of_gear, speed, damping_input)?;
    let source = |profile: &Arc<Profile>| profiles.iter().position(|other| Arc::ptr_eq(other, profile));
    let sources = run.tracks.iter().map(|track| source(&track.profile).unwrap_or(0)).collect();
    Ok((run, sources))
}

/// How the stations of a run's tracks divide a period into legs.
struct Division {
    /// Distance from the start of a period to that of each leg.
    begins: Vec<f64>,
    /// The run's tracks as groups, in the order of their legs.
    order: Vec<usize>,
    groups: Vec<Group>,
}

impl Division {
    /// `sources`: whose elevations each track meets.
    fn new(run: &Run, sources: &[usize], spacing: f64) -> Result<Self> {
        let lags = run.tracks.iter().map(|track| split(track.lag, spacing)).collect::<Result<Vec<_>>>()?;
        let mut begins: Vec<f64> = lags.iter().map(|&(_, rest)| rest).collect();
        begins.sort_by(f64::total_cmp);
        begins.dedup_by(|later, earlier| *later - *earlier <= HARMLESS * spacing);
        let leg_of = |rest: f64| begins.iter().rposition(|&begin| begin <= rest).unwrap_or(0);
        let group =
            |(&track, &(whole, rest)): (&usize, &(usize, f64))| Group { track, whole, leg: leg_of(rest) };
        let of_tracks: Vec<Group> = sources.iter().zip(&lags).map(group).collect();
        let mut order: Vec<usize> = (0..of_tracks.len()).collect();
        order.sort_by_key(|&track| of_tracks[track].leg);
        let groups = order.iter().map(|&track| of_tracks[track]).collect();
        Ok(Self { begins, order, groups })
    }

    /// The groups that begin a leg.
    fn members(&self, leg: usize) -> Range<usize> {
        let up_to = |leg: usize| self.groups.partition_point(|group| group.leg < leg);
        up_to(leg)..up_to(leg + 1)
    }

    /// `forms`: of `loads` loads, then of accelerations; `kinked`: whether the slope of an output may
    /// jump where a group meets a station.
    fn layout(
        &self,
        stations: usize,
        damped: bool,
        (loads, forms): (usize, &[Form]),
        kinked: impl Fn(&Form, usize) -> bool,
    ) -> Layout {
        let any = |weights: &[f64]| weights.iter().any(|&weight| weight != 0.0);
        let lines = forms.iter().any(Form::has_line);
        let legs = self.begins.len();
        let kinks = |form: &Form| -> Vec<usize> {
            let kinked = |&leg: &usize| lines || self.members(leg).any(|group| kinked(form, group));
            let legs: Vec<usize> = (0..legs).filter(kinked).collect();
            if legs.is_empty() { vec![0] } else { legs }
        };
        let behind = self.groups.iter().map(|group| (group.whole, group.leg)).max().unwrap_or((0, 0));
        Layout {
            stations,
            legs,
            members: (0..legs).map(|leg| self.members(leg)).collect(),
            periods: stations - 1 + behind.0,
            tail: behind.1,
            loads,
            damped,
            by_rate: forms.iter().map(|form| any(&form.v.0)).collect(),
            kinks: forms.iter().map(kinks).collect(),
            lines,
            heights: forms.iter().any(|form| any(&form.height) || any(&form.first)),
            datum: self.order.iter().position(|&track| track == 0).unwrap_or(0),
            groups: self.groups.clone(),
        }
    }
}

impl Setup {
    pub fn new(
        modes: &Arc<Modes>,
        stations: Stations,
        speed: f64,
        points: &[(f64, f64)],
        damping_input: bool,
    ) -> Result<Self> {
        let Stations { count, spacing, .. } = stations;
        let (run, sources) = stand_in(modes, stations, speed, damping_input)?;
        let division = Division::new(&run, &sources, spacing)?;
        let Division { begins, order, .. } = &division;
        let lag = run.tracks.iter().map(|track| track.lag.nearest()).fold(0.0, f64::max);
        let duration = (lag + (count - 1) as f64 * spacing) / speed;
        let ends = begins.iter().skip(1).copied().chain([spacing]);
        let dt: Vec<f64> = begins.iter().zip(ends).map(|(begin, end)| (end - begin) / speed).collect();
        let bank = run.oscillators.clone();
        let lengths = Lengths::new(&bank);
        let mut forms = Form::all(&run, &Quantity::Load);
        let loads = forms.len();
        forms.extend(Form::all(&run, &Quantity::Acceleration(points.to_vec())));
        let per_rise = |rate: Lanes| rate * (1.0 / spacing);
        let climb: Vec<Lanes> = order.iter().map(|&track| per_rise(run.tracks[track].climb)).collect();
        let kinked = |form: &Form, group: usize| jumps(form.d * bank.omega, climb[group]);
        let layout = division.layout(count, run.damping_input, (loads, &forms), kinked);
        let mut setup = Self {
            begin: begins.iter().map(|begin| begin / spacing).collect(),
            part: layout.groups.iter().map(|group| begins[group.leg] / spacing).collect(),
            transition: dt.iter().map(|&dt| bank.over(dt)).collect(),
            drag: order.iter().map(|&track| per_rise(run.tracks[track].drag * speed)).collect(),
            static_load: modes.aircraft().static_load().to_vec(),
            readings: Vec::new(),
            lengths: Arc::new(lengths),
            layout: Arc::new(layout),
            climb,
            dt,
            bank,
            duration,
        };
        let pace = speed / spacing;
        let readings = forms.into_iter().enumerate();
        setup.readings = readings.map(|(output, form)| setup.reading(output, form, order, pace)).collect();
        Ok(setup)
    }

    /// `order`: the run's tracks as groups; `pace`: spacings a time unit.
    fn reading(&self, index: usize, form: Form, order: &[usize], pace: f64) -> Reading {
        // Heights: that of the first track grows with its rise, the others with their own less that.
        let mut rate = form.height.clone();
        rate[0] -= form.height[1..].iter().sum::<f64>();
        let of_groups =
            |weights: &[f64], scale: f64| order.iter().map(|&track| weights[track] * scale).collect();
        let (rise, rate) = (of_groups(&form.rate, pace), of_groups(&rate, pace));
        let (height, first) = (of_groups(&form.height, 1.0), of_groups(&form.first, 1.0));
        let output = Output::new(form, &self.bank);
        let (kinks, legs) = (&self.layout.kinks[index], self.dt.len());
        // The legs from kink to kink; the span up to the first one begins in the period before.
        let before = kinks.iter().cycle().skip(kinks.len() - 1);
        let span =
            |(&kink, &before): (&usize, &usize)| before..if kink > before { kink } else { kink + legs };
        let spans: Vec<Range<usize>> = kinks.iter().zip(before).map(span).collect();
        let time = |span: &Range<usize>| span.clone().map(|leg| self.dt[leg % legs]).sum::<f64>();
        let times: Vec<f64> = spans.iter().map(time).collect();
        let longest = times.iter().copied().fold(0.0, f64::max);
        let squared = |times: &[f64]| times.iter().map(|time| (time / longest).powi(2)).collect();
        let (span, leg) = (squared(&times), squared(&self.dt));
        // F changes by at most twice its amplitude on one leg, and no place on a span is more than half the
        // span's legs, rounded up, from one of its ends.
        let swings = spans.iter().map(|span| span.len().div_ceil(2)).max().unwrap_or(1);
        let by_bend = self.bend(&output);
        let by_swing = self.bound([Lanes::ZERO; 2], self.lengths.bound_weights(output.amplitude));
        let scaled = |bound: Vec<f64>, scale: f64| bound.iter().map(|weight| weight * scale).collect();
        let bulge = [scaled(by_bend, longest * longest / 8.0), scaled(by_swing, 2.0 * swings as f64)];
        Reading { output, rise, height, first, rate, bulge, span, leg }
    }

    /// A bound on |F″| over all legs of a period.
    ///
    /// Through lengths, as in [`crate::extremes`], except for modes that oscillate slowly beside a
    /// period. Their F″ hangs on a = p̈ ÷ −ω², which is continuous, and hardly on the rate, which
    /// follows every slope: |a| is at most what it is at the start of the period and what it gains.
    fn bend(&self, output: &Output) -> Vec<f64> {
        let period: f64 = self.dt.iter().sum();
        let crude = self.lengths.bound_weights(output.second);
        let (mut state, mut lengths) = ([Lanes::ZERO; 2], crude);
        for mode in 0..MODES {
            let two_zeta = self.bank.two_zeta[mode];
            let gain = self.bank.omega[mode] * period * (1.0 + two_zeta + two_zeta * two_zeta);
            if gain > 0.5 || two_zeta > 1.0 || self.layout.damped {
                continue;
            }
            // y and ẏ/ω as a and ẏ/ω.
            let [y, w] = output.bend.map(|weights| weights[mode]);
            let (a, w) = (y.abs(), (w - two_zeta * y).abs());
            (state[0][mode], state[1][mode]) = (a, a * two_zeta);
            (lengths[0][mode], lengths[1][mode]) = (a * gain + w, a * gain + w);
        }
        self.bound(state, lengths)
    }

    /// state · (|d|, |ẏ/ω|) at the start of a period, and weights · lengths on any of its legs:
    /// lengths do not grow on a leg, and at a station by no more than the steady position jumps.
    fn bound(&self, state: [Lanes; 2], [y, w]: [Lanes; 2]) -> Vec<f64> {
        let states =
            [state[0] + y, state[1] + w].into_iter().flat_map(|part| (0..MODES).map(move |m| part[m]));
        let share = |group: usize| {
            let (beta, gamma) = (self.climb[group].abs(), self.drag[group].abs());
            y.dot(gamma + self.bank.two_zeta * beta) + w.dot(beta)
        };
        let after = (0..self.layout.groups.len()).map(share);
        let before = self.layout.inner().map(|group| 2.0 * share(group));
        states.chain(after).chain(before).collect()
    }
}
