//! Natural modes of the aircraft on its gears (Eqs. 6–11).

use std::sync::Arc;

use nalgebra::{Matrix3, SymmetricEigen, Vector3};

use crate::aircraft::{Aircraft, Gear, gram};
use crate::error::{Error, Place, Result, finite, moderate, not_negative};
use crate::strains::orthogonal_strains;

/// Most modes there can be: bounce, pitch and roll are the degrees of freedom.
pub const MODES: usize = 3;

/// How far ΦᵀMΦ of given shapes may be from the identity: three printed digits, as in
/// the report's tables, are off by up to 1.3e-3.
pub const ORTHONORMALITY: f64 = 5e-3;

/// Given modes this close (ΦᵀKΦ against ω², relative) to the aircraft's own are its own.
const OWN: f64 = 1e-12;

/// Damping ratios above this are refused: beyond any damper, and of the series' range.
const MOST_DAMPING: f64 = 1e6;

/// Components within this share of each other are a tie when the sign of a mode is chosen.
const TIE: f64 = 1e-9;

/// Where the damping ratios of an aircraft's own modes come from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Damping<'a> {
    /// The gears' dampers (Eq. 11).
    Dampers,
    /// One ratio for all modes.
    All(f64),
    /// One ratio per mode.
    Each(&'a [f64]),
}

/// Modes of an aircraft, its own or measured.
#[derive(Clone, Debug, PartialEq)]
pub struct Modes {
    aircraft: Arc<Aircraft>,
    omega: Vec<f64>,
    damping_ratio: Vec<f64>,
    shapes: Vec<Vector3<f64>>,
    statics: Statics,
}

/// Where the gears come to rest on given elevations, and what is left to their springs there.
///
/// On elevations u under the gears the modes put the gears to rest at R u, R = G Φ ω⁻² Φᵀ `K_1`: the
/// springs are left with (I − R) u. Where the modes are the aircraft's own and no gear is redundant, R is
/// the identity, and a load depends on the modal motion alone. `Form::load` says what else enters.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Statics {
    /// I − R of these modes, once corrected that of the aircraft's own; one row a gear. Rows sum to zero
    /// when `lifted`.
    pub unfollowed: Vec<Vec<f64>>,
    /// I − R of the aircraft's own modes: elevations out of plane strain the springs even at rest. Rows
    /// sum to zero.
    pub warp: Vec<Vec<f64>>,
    /// CG coordinates at rest ÷ elevation, of the aircraft's own modes, one column a gear.
    pub rest: Vec<Vector3<f64>>,
    /// Whether the same elevation under all gears lifts them by as much: with the aircraft's own modes or
    /// a correction.
    pub lifted: bool,
    /// What a correction adds to `rest` of these modes to give that of the aircraft's own, one column a
    /// gear; empty without a correction.
    pub lack: Vec<Vector3<f64>>,
}

impl Modes {
    /// The aircraft's own modes.
    ///
    /// # Errors
    /// A negative or non-finite ratio, a wrong number of them, no convergence.
    pub fn natural(aircraft: Arc<Aircraft>, damping: Damping) -> Result<Self> {
        let (omega, shapes) = eigen(&aircraft)?;
        let damping_ratio = match damping {
            Damping::All(ratio) => vec![check_ratio("damping_ratio".into(), ratio)?; omega.len()],
            Damping::Each(ratios) => check_ratios(ratios, omega.len())?,
            Damping::Dampers => {
                let ratio = |(shape, omega): (&Vector3<f64>, &f64)| {
                    rayleigh(&aircraft, shape, |gear| gear.damping) / (2.0 * omega)
                };
                check_ratios(&shapes.iter().zip(&omega).map(ratio).collect::<Vec<_>>(), omega.len())?
            }
        };
        let statics = Statics::own(&aircraft, &omega, &shapes);
        Ok(Self { aircraft, omega, damping_ratio, shapes, statics })
    }

    /// Measured modes: as many as were measured, in the order given. With `static_correction` the
    /// aircraft follows slow rises by its own static position, and the modes carry only the departure from
    /// theirs: q = rest · u + Φ (p − ω⁻² Φᵀ `K_1` u).
    ///
    /// # Errors
    /// Values out of range, lengths that differ, shapes that are not orthonormal (Eq. 7).
    pub fn measured(
        aircraft: Arc<Aircraft>,
        omega: Vec<f64>,
        damping_ratio: &[f64],
        shapes: Vec<Vector3<f64>>,
        static_correction: bool,
    ) -> Result<Self> {
        if omega.is_empty() {
            return Err(Error::TooShort { argument: "omega", found: 0, least: 1 });
        }
        for (i, &value) in omega.iter().enumerate() {
            moderate(Place::at("omega", i), value)?;
        }
        let damping_ratio = check_ratios(damping_ratio, omega.len())?;
        if shapes.len() != omega.len() {
            return Err(Error::WrongLength {
                argument: "shapes",
                found: shapes.len(),
                expected: omega.len(),
                why: "one column per mode",
            });
        }
        check_orthonormal(&aircraft, &shapes)?;
        let statics = Statics::measured(&aircraft, &omega, &shapes, static_correction)?;
        Ok(Self { aircraft, omega, damping_ratio, shapes, statics })
    }

    /// The aircraft.
    #[must_use]
    pub fn aircraft(&self) -> &Arc<Aircraft> {
        &self.aircraft
    }

    /// ω, ascending for natural modes.
    #[must_use]
    pub fn omega(&self) -> &[f64] {
        &self.omega
    }

    /// ζ.
    #[must_use]
    pub fn damping_ratio(&self) -> &[f64] {
        &self.damping_ratio
    }

    /// Mode shapes {bounce, pitch, roll}, ΦᵀMΦ = I (Eq. 7).
    #[must_use]
    pub fn shapes(&self) -> &[Vector3<f64>] {
        &self.shapes
    }

    pub(crate) fn statics(&self) -> &Statics {
        &self.statics
    }

    /// Where on the centreline a mode does not move: x = −bounce ÷ pitch, forward of the CG.
    /// Infinite for pure bounce, NaN for a mode that leaves the whole centreline at rest.
    #[must_use]
    pub fn node(&self) -> Vec<f64> {
        let scale = self.aircraft.inertia().diagonal().map(f64::sqrt);
        self.shapes
            .iter()
            .map(|shape| {
                let weighted = shape.component_mul(&scale);
                if weighted.xy().amax() <= TIE * weighted.amax() { f64::NAN } else { -shape[0] / shape[1] }
            })
            .collect()
    }

    /// What dropping the off-diagonal terms of `C_P` neglects (Eq. 9): |`C_ij`| ÷ √(`C_ii` `C_jj`)
    /// off the diagonal, 0 on it and where a mode has no damper.
    #[must_use]
    pub fn damping_coupling(&self) -> Vec<Vec<f64>> {
        // Gear by gear: a product with the summed matrix cancels where gears differ much.
        let gears = self.aircraft.gears();
        let coupling = |a: &Vector3<f64>, b: &Vector3<f64>| -> f64 {
            gears.iter().map(|gear| gear.damping * gear.row().dot(a) * gear.row().dot(b)).sum()
        };
        (0..self.shapes.len())
            .map(|i| {
                (0..self.shapes.len())
                    .map(|j| {
                        let (a, b) = (&self.shapes[i], &self.shapes[j]);
                        let own = coupling(a, a).sqrt() * coupling(b, b).sqrt();
                        if i == j || own == 0.0 { 0.0 } else { (coupling(a, b) / own).abs() }
                    })
                    .collect()
            })
            .collect()
    }
}

impl Statics {
    fn own(aircraft: &Aircraft, omega: &[f64], shapes: &[Vector3<f64>]) -> Self {
        let gears = aircraft.gears();
        let rest = at_rest(aircraft, omega, shapes);
        let mut warp = leftover(gears, &rest);
        for (g, row) in warp.iter_mut().enumerate() {
            if gears.len() == aircraft.rank() {
                row.fill(0.0);
            } else {
                // The same elevation under all gears lifts them by as much: rows sum to zero.
                row[g] = 0.0;
                row[g] = -row.iter().sum::<f64>();
            }
        }
        Self { unfollowed: warp.clone(), warp, rest, lifted: true, lack: Vec::new() }
    }

    fn measured(
        aircraft: &Arc<Aircraft>,
        omega: &[f64],
        shapes: &[Vector3<f64>],
        correction: bool,
    ) -> Result<Self> {
        let (own_omega, own_shapes) = eigen(aircraft)?;
        let own = Self::own(aircraft, &own_omega, &own_shapes);
        let stiffness = aircraft.stiffness_matrix();
        let is_own = shapes.len() == own_shapes.len()
            && (0..shapes.len()).all(|i| {
                (0..shapes.len()).all(|j| {
                    let expected = if i == j { omega[i] * omega[i] } else { 0.0 };
                    (shapes[i].dot(&(stiffness * shapes[j])) - expected).abs() <= OWN * omega[i] * omega[j]
                })
            });
        if is_own {
            return Ok(own);
        }
        let rest = at_rest(aircraft, omega, shapes);
        if correction {
            let lack = own.rest.iter().zip(&rest).map(|(own, rest)| own - rest).collect();
            return Ok(Self { lack, ..own });
        }
        let unfollowed = leftover(aircraft.gears(), &rest);
        Ok(Self { unfollowed, lifted: false, ..own })
    }
}

/// Φ ω⁻² Φᵀ `K_1`, column by column: CG coordinates at rest on a unit elevation of each gear.
fn at_rest(aircraft: &Aircraft, omega: &[f64], shapes: &[Vector3<f64>]) -> Vec<Vector3<f64>> {
    let column = |gear: &Gear| {
        let push = gear.row() * gear.stiffness;
        shapes.iter().zip(omega).map(|(shape, omega)| shape * (shape.dot(&push) / omega / omega)).sum()
    };
    aircraft.gears().iter().map(column).collect()
}

/// I − G · rest.
fn leftover(gears: &[Gear], rest: &[Vector3<f64>]) -> Vec<Vec<f64>> {
    let entry = |g: usize, j: usize| f64::from(u8::from(g == j)) - gears[g].row().dot(&rest[j]);
    (0..gears.len()).map(|g| (0..gears.len()).map(|j| entry(g, j)).collect()).collect()
}

/// φᵀ (Gᵀ w G) φ ÷ φᵀMφ as a sum of squares: nothing cancels between the gears.
fn rayleigh(aircraft: &Aircraft, shape: &Vector3<f64>, weight: impl Fn(&Gear) -> f64) -> f64 {
    let mass = shape.component_mul(shape).dot(&aircraft.inertia().diagonal());
    let sum: f64 = aircraft.gears().iter().map(|gear| weight(gear) * gear.row().dot(shape).powi(2)).sum();
    sum / mass
}

/// ω ascending and Φ of (K − ω²M) φ = 0, ΦᵀMΦ = I (Eqs. 6–8).
fn eigen(aircraft: &Aircraft) -> Result<(Vec<f64>, Vec<Vector3<f64>>)> {
    /// Ten or so do for 3 × 3.
    const ITERATIONS: usize = 1000;
    let springs: Vec<Vector3<f64>> =
        aircraft.gears().iter().map(|gear| aircraft.normal_row(gear) * gear.stiffness.sqrt()).collect();
    let normal = gram(springs.iter().map(|row| (*row, 1.0)));
    let eigen = SymmetricEigen::try_new(normal, f64::EPSILON, ITERATIONS)
        .ok_or(Error::NotConverged { iterations: ITERATIONS })?;
    let mut modes: Vec<(f64, Vector3<f64>)> = orthogonal_strains(&springs, eigen.eigenvectors)
        .column_iter()
        .map(|vector| {
            let vector = vector.into_owned();
            let largest = vector.amax();
            let leading = vector.iter().find(|c| c.abs() >= (1.0 - TIE) * largest).copied();
            let scale = aircraft.inertia().diagonal().map(f64::sqrt);
            let shape = (vector * leading.unwrap_or(1.0).signum()).component_div(&scale);
            (rayleigh(aircraft, &shape, |gear| gear.stiffness).sqrt(), shape)
        })
        .collect();
    modes.sort_by(|a, b| a.0.total_cmp(&b.0));
    // The lowest 3 − rank have no stiffness and, statics having passed, no excitation.
    let mut modes = modes.split_off(3 - aircraft.rank());
    // An axis that no gear has an arm for does not move in them, not even by rounding.
    for axis in (0..3).filter(|&axis| springs.iter().all(|row| row[axis] == 0.0)) {
        for (_, shape) in &mut modes {
            shape[axis] = 0.0;
        }
    }
    Ok(modes.into_iter().unzip())
}

fn check_ratios(ratios: &[f64], modes: usize) -> Result<Vec<f64>> {
    if ratios.len() != modes {
        return Err(Error::WrongLength {
            argument: "damping_ratio",
            found: ratios.len(),
            expected: modes,
            why: "one per mode, or a number for all",
        });
    }
    ratios.iter().enumerate().map(|(i, &z)| check_ratio(Place::at("damping_ratio", i), z)).collect()
}

fn check_ratio(place: Place, value: f64) -> Result<f64> {
    if not_negative(place, value)? > MOST_DAMPING {
        return Err(Error::OutOfRange { place, value, why: "0 to 1e6 is allowed" });
    }
    Ok(value)
}

fn check_orthonormal(aircraft: &Aircraft, shapes: &[Vector3<f64>]) -> Result<()> {
    for (column, shape) in shapes.iter().enumerate() {
        for (row, &value) in shape.iter().enumerate() {
            finite(Place::cell("shapes", row, column), value)?;
        }
    }
    let mass = Matrix3::from_diagonal(&aircraft.inertia().diagonal());
    let (product, tolerance) = (|a: usize, b: usize| shapes[a].dot(&(mass * shapes[b])), ORTHONORMALITY);
    let within = |value: f64, expected: f64| (value - expected).abs() <= tolerance;
    for column in 0..shapes.len() {
        let value = product(column, column);
        if !within(value, 1.0) {
            return Err(Error::NotNormal { column, value, tolerance });
        }
    }
    for row in 0..shapes.len() {
        for column in 0..row {
            let value = product(row, column);
            if !within(value, 0.0) {
                return Err(Error::NotOrthogonal { row, column, value, tolerance });
            }
        }
    }
    Ok(())
}
