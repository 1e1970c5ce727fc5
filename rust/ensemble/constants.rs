//! What the set-ups of runs side by side make of every period, number by number in rows.

use pulp::Arch;

use super::setup::{Reading, Setup};
use super::squares::{Integrate, Square};
use crate::lanes::Lanes;
use crate::modes::MODES;
use crate::readout::Form;
use crate::row::Row;

/// d and ẏ/ω of each mode.
pub(super) type States<T> = [T; 2 * MODES];

/// The set-up of a lane; of idle ones, the last.
pub(super) fn of_lane(setups: &[Setup], lane: usize) -> &Setup {
    &setups[lane.min(setups.len() - 1)]
}

/// A number of every lane's set-up.
fn gather(setups: &[Setup], part: impl Fn(&Setup) -> f64) -> Row {
    match setups {
        [shared] => Row::all(part(shared)),
        _ => Row(std::array::from_fn(|lane| part(of_lane(setups, lane)))),
    }
}

/// One mode's transition over a leg.
#[derive(Clone, Copy)]
pub(super) struct ModeStep {
    pub g: Row,
    pub s: Row,
    pub w: Row,
    pub h: Row,
}

/// Weights of an output.
pub(super) struct Weights {
    pub state: States<Row>,
    pub rise: Vec<Row>,
    /// Of the rises, at the end of each leg: heights grow on the way.
    pub end_rise: Vec<Vec<Row>>,
    pub height: Vec<Row>,
    pub first: Vec<Row>,
    pub bulge: [Vec<Row>; 2],
    /// Squares of durations as shares of that of the longest span between two kinks: of the span up to
    /// each kink, and of each leg.
    pub span: Vec<Row>,
    pub leg: Vec<Row>,
    /// Of the moments of the periods and of the tail.
    pub square: Square,
}

/// Constants of the runs side by side.
pub(super) struct Constants {
    /// One for all of them, or one a run; in all of them, the stations fall alike.
    pub setups: Vec<Setup>,
    /// Leg by leg, mode by mode.
    pub steps: Vec<[ModeStep; MODES]>,
    /// Rates of the static position ÷ ω and forces ÷ ω² per rise, group by group.
    pub climb: Vec<[Row; MODES]>,
    pub drag: Vec<[Row; MODES]>,
    pub weights: Vec<Weights>,
    /// How far each leg begins from a group's station, in spacings: leg by leg, group by group.
    pub from_station: Vec<Vec<Row>>,
}

impl Constants {
    pub fn new(arch: Arch, setups: Vec<Setup>) -> Self {
        let layout = &setups[0].layout;
        let (legs, groups) = (layout.legs, layout.groups.len());
        let step = |leg: usize, m: usize| ModeStep {
            g: gather(&setups, |s| s.transition[leg].g[m]),
            s: gather(&setups, |s| s.transition[leg].s[m]),
            w: gather(&setups, |s| s.transition[leg].w[m]),
            h: gather(&setups, |s| s.transition[leg].h[m]),
        };
        let by_mode = |of: &dyn Fn(&Setup) -> Lanes| std::array::from_fn(|m| gather(&setups, |s| of(s)[m]));
        let weights = |output: usize| {
            let by_group = |of: &dyn Fn(&Reading, &Setup, usize) -> f64| -> Vec<Row> {
                (0..groups).map(|g| gather(&setups, |s| of(&s.readings[output], s, g))).collect()
            };
            Weights {
                state: std::array::from_fn(|part| {
                    let of = |form: &Form| [form.d, form.v][part / MODES][part % MODES];
                    gather(&setups, |s| of(&s.readings[output].output.form))
                }),
                rise: by_group(&|r, _, g| r.rise[g]),
                end_rise: (0..legs)
                    .map(|leg| by_group(&|r, s, g| r.rise[g] + r.rate[g] * s.dt[leg]))
                    .collect(),
                height: by_group(&|r, _, g| r.height[g]),
                first: by_group(&|r, _, g| r.first[g]),
                bulge: [0, 1].map(|kind| {
                    let rows = 0..setups[0].readings[output].bulge[kind].len();
                    rows.map(|row| gather(&setups, |s| s.readings[output].bulge[kind][row])).collect()
                }),
                span: (0..layout.kinks[output].len())
                    .map(|kink| gather(&setups, |s| s.readings[output].span[kink]))
                    .collect(),
                leg: (0..legs).map(|leg| gather(&setups, |s| s.readings[output].leg[leg])).collect(),
                square: Square::default(),
            }
        };
        let mut constants = Self {
            steps: (0..legs).map(|leg| std::array::from_fn(|m| step(leg, m))).collect(),
            climb: (0..groups).map(|g| by_mode(&|s| s.climb[g])).collect(),
            drag: (0..groups).map(|g| by_mode(&|s| s.drag[g])).collect(),
            weights: (0..setups[0].readings.len()).map(weights).collect(),
            from_station: (0..legs)
                .map(|leg| (0..groups).map(|g| gather(&setups, |s| s.begin[leg] - s.part[g])).collect())
                .collect(),
            setups,
        };
        let squares = arch.dispatch(Integrate { constants: &constants });
        for (weights, square) in constants.weights.iter_mut().zip(squares) {
            weights.square = square;
        }
        constants
    }
}
