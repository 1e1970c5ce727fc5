//! What is read off the modal motion: one linear form an output.

use nalgebra::Vector3;

use crate::lanes::Lanes;
use crate::march::Segment;
use crate::run::Run;
use crate::transition::State;

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
    /// The dynamic part of that: without the static load.
    DynamicLoad,
    /// Vertical acceleration at points (x, y) of the body.
    Acceleration(Vec<(f64, f64)>),
    /// Accelerations of the modal coordinates, without the dampers' input.
    ModalAcceleration,
    /// Rates of the modal coordinates.
    ModalRate,
}

/// One output as a linear form of state, rates of elevation and elevations.
///
/// Elevations enter as differences: of track 0 from its start, of the others from track 0. So a runway
/// high above its datum costs no digits.
#[derive(Clone, Debug)]
pub(crate) struct Form {
    pub constant: f64,
    pub d: Lanes,
    pub v: Lanes,
    p: Lanes,
    /// One a track.
    pub rate: Vec<f64>,
    /// One a track: entry 0 of the rise of track 0 since the start, the others of track − track 0.
    pub height: Vec<f64>,
    /// One a track, of first elevations less that of track 0. Already in `constant`.
    pub first: Vec<f64>,
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
        let weights = vec![0.0; tracks];
        Self {
            constant: 0.0,
            d: none,
            v: none,
            p: none,
            rate: weights.clone(),
            height: weights.clone(),
            first: weights,
        }
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

    /// Displacement along `direction`: of where the run starts, Φp since, and what a correction adds.
    fn displacement(run: &Run, direction: Vector3<f64>) -> Self {
        let mut form = Self::zero(run);
        for (lane, shape) in run.modes.shapes().iter().enumerate() {
            form.p[lane] = direction.dot(shape);
        }
        form.constant = direction.dot(&run.rest());
        let datum = run.tracks[0].profile.z()[0];
        let gears = run.track_of.iter().zip(run.first_elevations());
        for (lack, (&track, first)) in run.modes.statics().lack.iter().zip(gears) {
            let weight = direction.dot(lack);
            form.add_height(track, weight);
            form.constant -= weight * (first - datum);
        }
        form
    }

    fn velocity(run: &Run, direction: Vector3<f64>) -> Self {
        let mut form = Self::zero(run);
        for (lane, shape) in run.modes.shapes().iter().enumerate() {
            form.v[lane] = direction.dot(shape) * run.oscillators.omega[lane];
        }
        for (lack, &track) in run.modes.statics().lack.iter().zip(&run.track_of) {
            form.rate[track] += direction.dot(lack);
        }
        form
    }

    /// Adds weight × (u_t − u_t(0)), the rise of a track since the start, as those of track 0 and of
    /// u_t − u_0. It leaves weight × (u_t(0) − u_0(0)) for the caller to subtract.
    fn add_height(&mut self, track: usize, weight: f64) {
        self.height[0] += weight;
        if track != 0 {
            self.height[track] += weight;
        }
    }

    /// A form of one mode alone, by its weights of d and v.
    fn modal(run: &Run, lane: usize, d: f64, v: f64) -> Self {
        let mut form = Self::zero(run);
        (form.d[lane], form.v[lane]) = (d, v);
        form
    }

    /// Load of a gear g = (1, x, y) less its static load,
    ///
    ///   F = − k gᵀΦ d + k Σ_j U_gj (u_j − u_j(0)) + k Σ_j W_gj u_j(0),
    ///
    /// and its damper's force where that input is kept. U and W are `unfollowed` and `warp` of
    /// [`Statics`](crate::modes::Statics): the modes follow elevations from where the aircraft itself
    /// stands at rest. As heights, gear j being on track t,
    ///
    ///   u_j − u_j(0) = (u_0 − u_0(0)) + (u_t − u_0) − (u_t(0) − u_0(0)),
    ///
    /// and Σ_j W_gj u_j(0) = Σ_j W_gj (u_j(0) − u_0(0)), since rows of W sum to zero. If those of U do
    /// (`lifted`), the weight of track 0 is exactly zero.
    fn dynamic_load(run: &Run, gear: usize) -> Self {
        let aircraft = run.modes.aircraft();
        let statics = run.modes.statics();
        let (k, row) = (aircraft.gears()[gear].stiffness, aircraft.gears()[gear].row());
        let mut form = Self::zero(run);
        for (lane, shape) in run.modes.shapes().iter().enumerate() {
            form.d[lane] = -k * row.dot(shape);
        }
        if run.damping_input {
            let c = aircraft.gears()[gear].damping;
            form.v = form.d * (c / k) * run.oscillators.omega;
            form.rate[run.track_of[gear]] = c;
            for (lack, &track) in statics.lack.iter().zip(&run.track_of) {
                form.rate[track] -= c * row.dot(lack);
            }
        }
        let first: Vec<f64> = run.first_elevations().collect();
        let mut of_first = 0.0;
        for (j, &track) in run.track_of.iter().enumerate() {
            let (since_start, at_start) = (k * statics.unfollowed[gear][j], k * statics.warp[gear][j]);
            form.add_height(track, since_start);
            form.first[track] += at_start - since_start;
            of_first += (at_start - since_start) * (first[j] - first[0]);
        }
        if statics.lifted {
            form.height[0] = 0.0;
        }
        form.constant = of_first;
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
            Quantity::Load => {
                let mut forms = Self::all(run, &Quantity::DynamicLoad);
                for (form, load) in forms.iter_mut().zip(run.modes.aircraft().static_load()) {
                    form.constant += load;
                }
                forms
            }
            Quantity::DynamicLoad => (0..gears.len()).map(|gear| Self::dynamic_load(run, gear)).collect(),
            Quantity::Acceleration(points) => {
                points.iter().map(|&(x, y)| Self::acceleration(run, Vector3::new(1.0, x, y))).collect()
            }
            Quantity::ModalAcceleration => {
                let bank = &run.oscillators;
                let one = |lane| {
                    let stiffness = bank.omega[lane] * bank.omega[lane];
                    Self::modal(run, lane, -stiffness, -stiffness * bank.two_zeta[lane])
                };
                (0..run.modes.omega().len()).map(one).collect()
            }
            Quantity::ModalRate => {
                let one = |lane| Self::modal(run, lane, 0.0, run.oscillators.omega[lane]);
                (0..run.modes.omega().len()).map(one).collect()
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
        let (base, climb) = segment.elevation(0, time);
        self.value[0] = (base - self.first) + climb;
        self.rate[0] = segment.slope(0) * self.speed;
        for track in 1..self.value.len() {
            let (other_base, other_climb) = segment.elevation(track, time);
            self.value[track] = (other_base - base) + (other_climb - climb);
            self.rate[track] = segment.slope(track) * self.speed - self.rate[0];
        }
    }
}
