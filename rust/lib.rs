//! What does this runway do to this aircraft? Loads and motion of a rigid aircraft on
//! linear gears, exact in continuous time.
//!
//! The model is that of R. R. Gajewski, *Modal analysis for aircraft response to runway
//! surface roughness*, USAF Academy, 1980; "Eq." numbers in this crate are that report's.
//!
//! | symbol | meaning |
//! |---|---|
//! | x, y, z | axes at the centre of gravity: forward, to the left, up |
//! | q = {bounce, pitch, roll} | CG coordinates; pitch nose up, roll left wing up |
//! | M, I_P, I_R | mass, pitch inertia, roll inertia |
//! | k, c | stiffness and damping of a gear, strut and tire in series |
//! | G | geometry rows [1, x, y]; gear displacement = G q (Eq. 1) |
//! | K_D, C_D, K_1, C_1 | GᵀkG, GᵀcG, Gᵀk, Gᵀc (Eqs. 4, 5) |
//! | Φ, ω, ζ | mode shapes with ΦᵀMΦ = I, circular frequencies, damping ratios (Eqs. 6–11) |
//! | u | elevation under a gear |
//! | p | modal coordinates, q = Φ p (Eq. 10) |
//!
//! *Units*: any consistent system. Gravity is a parameter and nothing is converted.
//!
//! The house, each floor using only those before it:
//!
//! | module | what it knows |
//! |---|---|
//! | [`error`] | the one error enum |
//! | `strains` | directions in which springs are strained independently |
//! | [`aircraft`] | gears and masses → matrices, static loads |
//! | `distance` | distances rolled, with their rounding error |
//! | [`profile`] | a checked piecewise-linear profile |
//! | [`modes`] | the eigenproblem, damping ratios, measured modes; no time |
//! | [`lanes`] | four numbers side by side |
//! | [`transition`] | the exact propagator of a bank of oscillators; no aircraft |
//! | [`watch`] | long work that its caller can stop |
//! | `parallel` | independent pieces of work on all threads |
//! | `track` | gears that meet one profile at one time |
//! | `shared_knots` | tracks that meet their breakpoints where the foremost one does |
//! | [`run`] | modes + profiles + speed, and when to look |
//! | `merge` | breakpoints of several tracks in one order |
//! | `knots` | the breakpoints of all gears in order, a block at a time |
//! | `pair` | two equal segments at a stride |
//! | `pages` | memory fetched before it is written to |
//! | `scout` | knots found ahead, on a thread of their own |
//! | `path` | the transitions between a block's knots, and what drives the modes there |
//! | `march` | knots → modal states: the segment loop |
//! | `inside` | states between a segment's ends |
//! | [`readout`] | loads, motions and accelerations as linear forms of the state |
//! | [`sample`] | rows of results at the default times or at any |
//! | [`extremes`] | true maxima and minima between samples |
//! | `mean_square` | root mean squares over time, without sampling |
//! | [`sweep`] | one runway at many speeds |
//! | [`worst`] | the worst speed of a range, with a bound on all others |
//! | [`row`] | eight runs side by side: a number of each |
//! | `random` | normal deviates, a pure function of seed, run, line and track |
//! | `fourier` | inverse transforms of eight runs side by side |
//! | [`spectrum`] | one-sided spectra: piecewise power laws in a band |
//! | [`coherence`] | how alike parallel tracks over an isotropic surface are |
//! | [`ensemble`] | many equally spaced profiles at once: statistics without a history |
//! | [`roughness`] | spectrum → random profiles, block by block |
//! | `python` | the only file that names pyo3 or numpy, behind the feature `python` |
//!
//! ```
//! use std::sync::Arc;
//! use runway_modal::aircraft::{Aircraft, Gear, Inertia};
//! use runway_modal::{modes::{Damping, Modes}, profile::Profile, readout::Quantity, run::Run};
//!
//! # fn main() -> runway_modal::error::Result<()> {
//! // Table 1 and Table 2, lbf, in, s.
//! let inertia = Inertia { mass: 145.5, pitch: 1.92e6, roll: 6.56e5, gravity: 386.0886 };
//! let aircraft = Aircraft::new(inertia, vec![
//!     Gear::new("nose", 234.9, 0.0, 1502.0, 0.0)?,
//!     Gear::new("left", -44.35, 109.25, 9102.0, 0.0)?,
//!     Gear::new("right", -44.35, -109.25, 9102.0, 0.0)?,
//! ])?;
//! let modes = Arc::new(Modes::natural(Arc::new(aircraft), Damping::All(0.01))?);
//! assert!((modes.omega()[1] - 12.01632).abs() < 1e-5); // Table 3
//!
//! let mat = Arc::new(Profile::new(vec![0.0, 12.0, 918.0, 930.0], vec![0.0, 1.5, 1.5, 0.0])?);
//! let run = Run::new(modes, &[mat.clone(), mat.clone(), mat], 405.0744, false)?;
//! let loads = run.extremes(&[Quantity::Load], (0.0, 8.0), &mut || Ok(()))?;
//! assert!(loads[1].max > 40_000.0);
//! # Ok(())
//! # }
//! ```

pub mod aircraft;
pub mod coherence;
mod distance;
pub mod ensemble;
pub mod error;
pub mod extremes;
mod fourier;
mod inside;
mod knots;
pub mod lanes;
mod march;
mod mean_square;
mod merge;
pub mod modes;
mod pages;
mod pair;
mod parallel;
mod path;
pub mod profile;
#[cfg(feature = "python")]
mod python;
mod random;
pub mod readout;
pub mod roughness;
pub mod row;
pub mod run;
pub mod sample;
mod scout;
mod shared_knots;
pub mod spectrum;
mod strains;
pub mod sweep;
mod track;
pub mod transition;
pub mod watch;
pub mod worst;
