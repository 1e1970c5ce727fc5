//! The worst speed of a range, with a bound that no speed of the range exceeds.
//!
//! At a given place s on the runway the elevation under a gear does not depend on speed. Let p(s) be
//! the response of a mode at speed V and p₀(s) that at V₀, V = ρV₀ (Eq. 12), each with the rates of
//! its own time; let g = φᵀC₁(u − u at the start), with C₁ = 0 if the dampers' input is left out.
//! Without that input, p̈₀ is a₀ = p̈₀ − ġ₀, which is finite at vertical steps too. Then w = p − p₀
//! obeys, in the time of V,
//!
//!   ẅ + 2ζω ẇ + ω² w = −(ρ² − 1) a₀ − 2ζω (ρ − 1) ṗ₀ − (ρ − 1) ġ,   w = ẇ = 0 at the start:
//!
//! φᵀK₁u has cancelled. With |ρ − 1| ≤ e, A = max |a₀|, B = max |ṗ₀| the first two terms are at most
//! f = e(2 + e) A + 2ζω e B; integration by parts puts g, with |g| ≤ G, in place of the third term's
//! ġ. So until the last gear has passed the last knot, h being the impulse response,
//!
//!   |w| ≤ f ∫|h| + eG ∫|ḣ|,   |ẇ| ≤ f ∫|ḣ| + eG (1 + ∫|ḧ|),   ∫|ḧ| ≤ 2ζω ∫|ḣ| + ω² ∫|h|.
//!
//! Over n half-periods, each e^−a times the one before (a = πζ/√(1 − ζ²)), with
//! D = 1 + e^−a + … + e^−(n−1)a,
//!
//!   ∫|h| = (1 + e^−a) D ÷ ω²,   ∫|ḣ| ≤ 2D ÷ ω;   for ζ ≥ 1 the same with e^−a = 0, D = 1.
//!
//! After the last knot both are compared at the same time after it: p and p₀ differ by w there, their
//! rates by ẇ + (ρ − 1) ṗ₀, and √(p² + ṗ²/ω²) of a free motion never grows. So
//!
//!   r = √[|w|² + (|ẇ| + eB)² ÷ ω²],   with the bounds on |w| and |ẇ|,
//!
//! bounds the mode's difference throughout; that of a load k(u − u_g) is at most Σ k|φ_g| r, that of
//! an acceleration Σ |φ| ω²√(1 + 4ζ²) r. The dampers' input adds c(u̇ − u̇_g) to a load, which
//! changes by at most Σ c|φ_g| ω r + e c|u̇₀|, and Σ φ ġ to an acceleration, by at most e |Σ φ ġ₀|.
//! Hence one run gives a bound for all speeds near its own.
//!
//! The range is divided into cells, each with a run at its middle. Cells are cut in three (the middle
//! part keeps the run) until none can exceed the worst value found by more than the tolerance.

use nalgebra::Vector3;

use crate::error::{Error, Place, Result, moderate, not_negative, positive};
use crate::extremes::Extreme;
use crate::modes::Modes;
use crate::parallel;
use crate::readout::Quantity;
use crate::run::Run;
use crate::sweep::Course;
use crate::watch::Pulse;

/// Cells to begin with: enough for all threads.
const CELLS: usize = 64;

/// What is to be largest, or smallest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Target {
    /// Largest load of a gear.
    MaxLoad(usize),
    /// Smallest load of a gear.
    MinLoad(usize),
    /// Largest magnitude of vertical acceleration at a point (x, y) of the body.
    MaxAcceleration(f64, f64),
}

/// Where to look and how closely.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpeedRange {
    /// Lowest speed.
    pub low: f64,
    /// Highest speed.
    pub high: f64,
    /// How much worse than the worst value found a speed not tried may be.
    pub tolerance: f64,
    /// No more runs than this in all; the first 66 are always made.
    pub max_runs: usize,
}

/// The worst speed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Worst {
    /// A speed at which the value occurs.
    pub speed: f64,
    /// The worst value found.
    pub value: f64,
    /// No speed of the range has a worse value than this.
    pub bound: f64,
    /// Runs that it took.
    pub runs: usize,
}

impl Target {
    fn quantity(self) -> Quantity {
        match self {
            Self::MaxLoad(_) | Self::MinLoad(_) => Quantity::Load,
            Self::MaxAcceleration(x, y) => Quantity::Acceleration(vec![(x, y)]),
        }
    }

    /// Index of the target among the quantity's outputs, and their number.
    fn index(self, gears: usize) -> (usize, usize) {
        match self {
            Self::MaxLoad(gear) | Self::MinLoad(gear) => (gear, gears),
            Self::MaxAcceleration(..) => (0, 1),
        }
    }

    /// −1 where smaller is worse.
    fn sign(self) -> f64 {
        if matches!(self, Self::MinLoad(_)) { -1.0 } else { 1.0 }
    }

    /// Sign × value: the larger, the worse.
    fn badness(self, extreme: &Extreme) -> f64 {
        match self {
            Self::MaxLoad(_) => extreme.max,
            Self::MinLoad(_) => -extreme.min,
            Self::MaxAcceleration(..) => extreme.magnitude().0,
        }
    }
}

/// What a change of speed can do to the target.
#[derive(Clone, Debug)]
struct Sensitivity {
    /// Most that it changes per r of each mode.
    per_r: Vec<f64>,
    /// G of each mode.
    max_g: Vec<f64>,
    /// Through the dampers' input itself, per unit of speed.
    direct: f64,
}

impl Sensitivity {
    fn new(target: Target, course: &Course) -> Self {
        let Course { modes, profiles, damping_input } = course;
        let gears = modes.aircraft().gears();
        let damping = |gear: usize| if *damping_input { gears[gear].damping } else { 0.0 };
        let most = |values: &mut dyn Iterator<Item = f64>| values.fold(0.0, |most: f64, z| most.max(z.abs()));
        let rise = |gear: usize| {
            let z = profiles[gear].z();
            most(&mut z.iter().map(|height| height - z[0]))
        };
        let steepest = |gear: usize| most(&mut profiles[gear].slopes().iter().copied());
        // φᵀC₁, one a gear.
        let input = |shape: &Vector3<f64>, gear: usize| damping(gear) * gears[gear].row().dot(shape);
        let each = || modes.shapes().iter().zip(modes.omega()).zip(modes.damping_ratio());
        let sum = |term: &dyn Fn(usize) -> f64| (0..gears.len()).map(term).sum::<f64>();
        let (per_r, direct) = match target {
            Target::MaxLoad(gear) | Target::MinLoad(gear) => {
                let (row, k, c) = (gears[gear].row(), gears[gear].stiffness, damping(gear));
                let per_r = each().map(|((shape, omega), _)| row.dot(shape).abs() * (k + c * omega));
                (per_r.collect(), c * steepest(gear))
            }
            Target::MaxAcceleration(x, y) => {
                let point = Vector3::new(1.0, x, y);
                let per_r = each().map(|((shape, omega), zeta)| {
                    point.dot(shape).abs() * omega * omega * (1.0 + 4.0 * zeta * zeta).sqrt()
                });
                let gain =
                    |gear| modes.shapes().iter().map(|shape| point.dot(shape) * input(shape, gear)).sum();
                (per_r.collect(), sum(&|gear| f64::abs(gain(gear)) * steepest(gear)))
            }
        };
        let max_g = modes.shapes().iter().map(|shape| sum(&|gear| input(shape, gear).abs() * rise(gear)));
        Self { per_r, max_g: max_g.collect(), direct }
    }
}

/// What a run says about the speeds around its own.
#[derive(Clone, Debug)]
struct Trial {
    speed: f64,
    badness: f64,
    /// A = max |a₀| and B = max |ṗ₀| of each mode.
    motion: Vec<(f64, f64)>,
    /// Distance rolled until nothing more happens.
    distance: f64,
}

impl Trial {
    fn new(run: &Run, target: Target, pulse: Pulse) -> Result<Self> {
        let span = run.span()?;
        let quantities = [target.quantity(), Quantity::ModalAcceleration, Quantity::ModalRate];
        let found = run.extremes(&quantities, span, pulse)?;
        let (index, count) = target.index(run.modes().aircraft().gears().len());
        let (accelerations, rates) = found[count..].split_at(run.modes().omega().len());
        let motion = accelerations.iter().zip(rates).map(|(a, r)| (a.magnitude().0, r.magnitude().0));
        let badness = target.badness(&found[index]);
        Ok(Self { speed: run.speed(), badness, motion: motion.collect(), distance: run.distance() })
    }

    /// What no speed within `half` of this one exceeds: the derivation above, letter by letter.
    fn bound(&self, half: f64, modes: &Modes, sensitivity: &Sensitivity) -> f64 {
        let e = half / self.speed;
        let time = self.distance / (self.speed - half);
        let of_modes = modes.omega().iter().zip(modes.damping_ratio()).zip(&self.motion);
        let each = of_modes.zip(sensitivity.per_r.iter().zip(&sensitivity.max_g));
        let change = each.map(|(((&omega, &zeta), &(max_a, max_b)), (per_r, max_g))| {
            let (decay, d) = half_periods(omega * time, zeta);
            let f = e * (2.0 + e) * max_a + 2.0 * zeta * omega * e * max_b;
            // ∫|h|, ∫|ḣ|, ∫|ḧ|.
            let (int_h, int_h1) = ((1.0 + decay) * d / omega / omega, 2.0 * d / omega);
            let int_h2 = 2.0 * zeta * omega * int_h1 + omega * omega * int_h;
            let w = f * int_h + e * max_g * int_h1;
            // |ẇ| + eB.
            let w_rate = f * int_h1 + e * max_g * (1.0 + int_h2) + e * max_b;
            let r = w.hypot(w_rate / omega);
            per_r * r
        });
        self.badness + change.sum::<f64>() + half * sensitivity.direct
    }
}

/// e^−a and D over so many radians.
fn half_periods(radians: f64, zeta: f64) -> (f64, f64) {
    if zeta >= 1.0 {
        return (0.0, 1.0);
    }
    let damped = (1.0 - zeta * zeta).sqrt();
    let count = (radians * damped / std::f64::consts::PI).ceil();
    let a = std::f64::consts::PI * zeta / damped;
    let d = if zeta > 0.0 { libm::expm1(-count * a) / libm::expm1(-a) } else { count };
    (libm::exp(-a), d)
}

/// Speeds from `trial.speed` − `half` to `trial.speed` + `half`.
#[derive(Clone, Debug)]
struct Cell {
    trial: Trial,
    half: f64,
    bound: f64,
}

impl Course {
    /// The worst speed of a range; the same numbers on any number of threads.
    ///
    /// # Errors
    /// A gear that is not there, a range out of order, a tolerance that is not positive or asks for too
    /// many runs, an overflow, or what `pulse` gives.
    pub fn worst(&self, target: Target, range: SpeedRange, pulse: Pulse) -> Result<Worst> {
        let SpeedRange { low, high, tolerance, max_runs } = range;
        moderate(Place::at("speeds", 0), low)?;
        moderate(Place::at("speeds", 1), high)?;
        not_negative("speeds[1] - speeds[0]", high - low)?;
        positive("tolerance", tolerance)?;
        let (index, count) = target.index(self.modes.aircraft().gears().len());
        if index >= count {
            return Err(Error::NoSuchGear { index, gears: count });
        }
        let sensitivity = Sensitivity::new(target, self);
        let worst = (low, f64::NEG_INFINITY);
        let mut search = SpeedSearch { course: self, target, sensitivity, worst, runs: 0 };
        let half = 0.5 * (high - low) / CELLS as f64;
        // The ends count too: the worst speed is often one of them.
        let mut live = search.cells(&[low, high], 0.0, pulse)?;
        if half > 0.0 {
            let middles: Vec<f64> = (0..CELLS).map(|i| low + half * (2 * i + 1) as f64).collect();
            live.extend(search.cells(&middles, half, pulse)?);
        }
        // What the cells given up may hold.
        let mut bound = f64::NEG_INFINITY;
        loop {
            let (speed, worst) = search.worst;
            live.retain(|cell| {
                let open = cell.bound > worst + tolerance;
                bound = if open { bound } else { bound.max(cell.bound) };
                open
            });
            let sign = target.sign();
            let widest = live.iter().fold(bound, |most, cell| most.max(cell.bound)).max(worst);
            let worst = Worst { speed, value: sign * worst, bound: sign * widest, runs: search.runs };
            if live.is_empty() {
                return Ok(worst);
            }
            if search.runs + 2 * live.len() > max_runs {
                let Worst { speed, value, bound, runs } = worst;
                return Err(Error::Unresolved { tolerance, max_runs, runs, value, speed, bound });
            }
            live = search.cut(live, pulse)?;
        }
    }
}

struct SpeedSearch<'a> {
    course: &'a Course,
    target: Target,
    sensitivity: Sensitivity,
    /// Speed and badness of the worst run so far.
    worst: (f64, f64),
    runs: usize,
}

impl SpeedSearch<'_> {
    /// Cells of one width, each with its run.
    fn cells(&mut self, middles: &[f64], half: f64, pulse: Pulse) -> Result<Vec<Cell>> {
        let (course, target) = (self.course, self.target);
        let trials =
            parallel::map(middles, pulse, |&speed, pulse| Trial::new(&course.at(speed)?, target, pulse))?;
        self.runs += trials.len();
        for trial in &trials {
            if trial.badness > self.worst.1 {
                self.worst = (trial.speed, trial.badness);
            }
        }
        Ok(trials.into_iter().map(|trial| self.cell(trial, half)).collect())
    }

    fn cell(&self, trial: Trial, half: f64) -> Cell {
        let bound = trial.bound(half, &self.course.modes, &self.sensitivity);
        Cell { trial, half, bound }
    }

    /// Cuts cells of one width in three.
    fn cut(&mut self, cells: Vec<Cell>, pulse: Pulse) -> Result<Vec<Cell>> {
        let half = cells[0].half / 3.0;
        let beside = |cell: &Cell| [cell.trial.speed - 2.0 * half, cell.trial.speed + 2.0 * half];
        let mut parts = self.cells(&cells.iter().flat_map(beside).collect::<Vec<_>>(), half, pulse)?;
        parts.extend(cells.into_iter().map(|cell| self.cell(cell.trial, half)));
        Ok(parts)
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::aircraft::{Aircraft, Gear, Inertia};
    use crate::modes::Damping;
    use crate::profile::Profile;

    fn course(zeta: f64, profile: Profile, damping_input: bool) -> Course {
        let inertia = Inertia { mass: 145.5, pitch: 1.92e6, roll: 6.56e5, gravity: 386.0886 };
        let gear = |name, x, y, k| Gear::new(name, x, y, k, 0.02 * k).unwrap();
        let gears = vec![
            gear("nose", 234.9, 0.0, 1502.0),
            gear("left", -44.35, 109.25, 9102.0),
            gear("right", -44.35, -109.25, 9102.0),
        ];
        let aircraft = Arc::new(Aircraft::new(inertia, gears).unwrap());
        let modes = Arc::new(Modes::natural(aircraft, Damping::All(zeta)).unwrap());
        let profile = Arc::new(profile);
        Course::new(modes, vec![profile; 3], damping_input).unwrap()
    }

    #[test]
    fn a_run_bounds_all_speeds_near_its_own() {
        let heights = vec![0.0, 1.5, 1.5, 0.5, -1.0, 1.5, 0.0];
        let ramps = |length| {
            let x = vec![0.0, length, 300.0, 300.0, 700.0, 918.0, 918.0 + length];
            Profile::new(x, heights.clone()).unwrap()
        };
        // Some so steep that loads are made of the dampers' input, at the highest speed.
        let profiles = [(ramps(12.0), false), (ramps(12.0), true), (ramps(0.5), true)];
        let targets = [Target::MaxLoad(0), Target::MinLoad(1), Target::MaxAcceleration(200.0, 10.0)];
        let zetas = [0.0, 0.01, 0.3, 0.99, 1.0, 2.0];
        let cases = zetas.into_iter().flat_map(|zeta| profiles.iter().map(move |profile| (zeta, profile)));
        for (zeta, (profile, damped)) in cases {
            let course = course(zeta, profile.clone(), *damped);
            for target in targets {
                let sensitivity = Sensitivity::new(target, &course);
                let trial = |speed| Trial::new(&course.at(speed).unwrap(), target, &mut || Ok(())).unwrap();
                let mut closest = f64::INFINITY;
                for speed in [90.0, 405.0, 1500.0] {
                    let here = trial(speed);
                    for share in [1e-5, 1e-3, 0.03, 0.4] {
                        let half = share * speed;
                        let allowed = here.bound(half, &course.modes, &sensitivity) - here.badness;
                        for part in [-1.0, -0.6, 0.3, 1.0] {
                            let change = (trial(speed + part * half).badness - here.badness).abs();
                            assert!(
                                change <= allowed,
                                "{target:?} ζ {zeta} {damped} {speed} {share}: {change} > {allowed}"
                            );
                            closest = closest.min(allowed / change);
                        }
                    }
                }
                // A bound that allows anything would hold too. Loads of oscillating modes: the largest
                // acceleration may be the jump at a step, the same at every speed, and beyond
                // critical damping the bound is some forty times what happens.
                let judged = zeta <= 1.0 && !matches!(target, Target::MaxAcceleration(..));
                assert!(closest < 30.0 || !judged, "{target:?} ζ {zeta} {damped}: {closest}");
            }
        }
    }

    #[test]
    fn half_periods_sum_the_impulse_response() {
        for (zeta, radians) in [(0.0, 20.0), (0.01, 7.0), (0.2, 40.0), (1.0, 9.0), (3.0, 50.0)] {
            let (decay, d) = half_periods(radians, zeta);
            // ω = 1; h by the midpoint rule, its integrals by the trapezoidal one.
            let (step, mut h, mut rate) = (1e-4, 0.0_f64, 1.0_f64);
            let (mut int_h, mut int_h1) = (0.0, 0.0);
            for _ in 0..(radians / step) as usize {
                let middle = (h + 0.5 * step * rate, rate - 0.5 * step * (h + 2.0 * zeta * rate));
                let (before, now) = (h, h + step * middle.1);
                rate -= step * (middle.0 + 2.0 * zeta * middle.1);
                h = now;
                int_h += 0.5 * step * (before.abs() + now.abs());
                int_h1 += (now - before).abs();
            }
            let bound = (1.0 + decay) * d;
            assert!(int_h <= bound * (1.0 + 1e-6) && int_h1 <= 2.0 * d, "{zeta}: {int_h} {int_h1}");
            assert!(int_h > 0.6 * bound, "{zeta}: {int_h}");
        }
    }
}
