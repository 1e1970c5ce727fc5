//! The aircraft: a rigid body on any number of gears (Eqs. 1–5).

use nalgebra::{Matrix3, Vector3};

use crate::error::{Error, Place, Result, finite, is_moderate, not_negative, positive};
use crate::strains::Strains;

/// Bounce, pitch and roll.
pub const FREEDOMS: [&str; 3] = ["bounce", "pitch", "roll"];

/// A singular value below this share of the largest one counts as zero: geometry that
/// is only rounding away from carrying no load.
const RANK_TOLERANCE: f64 = 1e-13;

/// A share of the weight that may be rounding: of a gear that carries nothing.
const NO_LOAD: f64 = 1e-9;

/// A gear: strut and tire in series, reduced to one linear spring and damper.
#[derive(Clone, Debug, PartialEq)]
pub struct Gear {
    /// Name, unique on its aircraft.
    pub name: String,
    /// Arm forward of the centre of gravity.
    pub x: f64,
    /// Arm to the left of the centre of gravity.
    pub y: f64,
    /// k, force per length.
    pub stiffness: f64,
    /// c, force per speed.
    pub damping: f64,
}

impl Gear {
    /// A gear with checked values.
    ///
    /// # Errors
    /// Arms not finite, stiffness not positive, damping negative.
    pub fn new(name: &str, x: f64, y: f64, stiffness: f64, damping: f64) -> Result<Self> {
        let gear = Self { name: name.to_owned(), x, y, stiffness, damping };
        gear.check(Place::from)?;
        Ok(gear)
    }

    /// Checks the values; `place` says where a field stands.
    fn check(&self, place: impl Fn(&'static str) -> Place) -> Result<()> {
        finite(place("x"), self.x)?;
        finite(place("y"), self.y)?;
        positive(place("stiffness"), self.stiffness)?;
        not_negative(place("damping"), self.damping)?;
        Ok(())
    }

    /// Geometry row [1, x, y]: gear displacement = row · {bounce, pitch, roll} (Eq. 1).
    #[must_use]
    pub fn row(&self) -> Vector3<f64> {
        Vector3::new(1.0, self.x, self.y)
    }
}

/// Stiffness of two springs in series, 1/k = 1/k₁ + 1/k₂ (Table 2).
///
/// # Errors
/// A stiffness that is not positive.
pub fn series(strut: f64, tire: f64) -> Result<f64> {
    positive("strut", strut)?;
    positive("tire", tire)?;
    // Divided by the larger: no overflow, no underflow.
    let (soft, stiff) = if strut < tire { (strut, tire) } else { (tire, strut) };
    Ok(soft / (1.0 + soft / stiff))
}

/// Masses and gravity, in one consistent unit system.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Inertia {
    /// M.
    pub mass: f64,
    /// `I_P`, about the lateral axis.
    pub pitch: f64,
    /// `I_R`, about the longitudinal axis.
    pub roll: f64,
    /// g.
    pub gravity: f64,
}

impl Inertia {
    /// Diagonal of the mass matrix.
    #[must_use]
    pub fn diagonal(&self) -> Vector3<f64> {
        Vector3::new(self.mass, self.pitch, self.roll)
    }
}

/// A checked aircraft with its static loads.
#[derive(Clone, Debug, PartialEq)]
pub struct Aircraft {
    inertia: Inertia,
    gears: Vec<Gear>,
    static_load: Vec<f64>,
    rank: usize,
}

impl Aircraft {
    /// Checks the data and finds the static loads.
    ///
    /// # Errors
    /// A value out of range, no gear, two gears of one name, or gears that cannot carry
    /// the weight in equilibrium, or only if one of them pulls.
    pub fn new(inertia: Inertia, gears: Vec<Gear>) -> Result<Self> {
        positive("mass", inertia.mass)?;
        positive("pitch_inertia", inertia.pitch)?;
        positive("roll_inertia", inertia.roll)?;
        not_negative("gravity", inertia.gravity)?;
        if gears.is_empty() {
            return Err(Error::TooShort { argument: "gears", found: 0, least: 1 });
        }
        for (second, gear) in gears.iter().enumerate() {
            gear.check(|field| Place::gear(second, field))?;
            if let Some(first) = gears[..second].iter().position(|g| g.name == gear.name) {
                return Err(Error::DuplicateGear { name: gear.name.clone(), first, second });
            }
        }
        check_range(&inertia, &gears)?;
        let (static_load, rank) = statics(&inertia, &gears)?;
        Ok(Self { inertia, gears, static_load, rank })
    }

    /// Masses and gravity.
    #[must_use]
    pub fn inertia(&self) -> &Inertia {
        &self.inertia
    }

    /// The gears, in the order given.
    #[must_use]
    pub fn gears(&self) -> &[Gear] {
        &self.gears
    }

    /// Compression load of each gear in equilibrium on a level runway.
    #[must_use]
    pub fn static_load(&self) -> &[f64] {
        &self.static_load
    }

    /// Number of degrees of freedom the gears hold: the number of modes.
    #[must_use]
    pub fn rank(&self) -> usize {
        self.rank
    }

    /// `K_D` = Gᵀ k G (Eq. 5).
    #[must_use]
    pub fn stiffness_matrix(&self) -> Matrix3<f64> {
        gram(self.gears.iter().map(|gear| (gear.row(), gear.stiffness)))
    }

    /// `C_D` = Gᵀ c G (Eq. 5).
    #[must_use]
    pub fn damping_matrix(&self) -> Matrix3<f64> {
        gram(self.gears.iter().map(|gear| (gear.row(), gear.damping)))
    }

    /// Geometry rows with coordinates scaled by 1/√mass, so that the mass matrix is the identity.
    pub(crate) fn normal_row(&self, gear: &Gear) -> Vector3<f64> {
        gear.row().component_div(&self.inertia.diagonal().map(f64::sqrt))
    }
}

/// Σ w r rᵀ.
pub(crate) fn gram(rows: impl Iterator<Item = (Vector3<f64>, f64)>) -> Matrix3<f64> {
    rows.fold(Matrix3::zeros(), |sum, (row, weight)| sum + (row * weight) * row.transpose())
}

/// Squared frequencies and dampings of the single springs must fit double precision.
fn check_range(inertia: &Inertia, gears: &[Gear]) -> Result<()> {
    const WHY: &str = "with these masses and arms the frequencies leave the range of double precision";
    let fits = |value: f64| (1e-200..1e200).contains(&value);
    if inertia.gravity != 0.0 && !fits(inertia.mass * inertia.gravity) {
        let (name, value) =
            if is_moderate(inertia.mass) { ("gravity", inertia.gravity) } else { ("mass", inertia.mass) };
        return Err(Error::OutOfRange {
            place: name.into(),
            value,
            why: "mass · gravity must lie between 1e-200 and 1e200",
        });
    }
    let axes = ["", "x", "y"].into_iter().zip(["mass", "pitch_inertia", "roll_inertia"]);
    for (axis, (arm, mass_name)) in axes.enumerate() {
        let mass = inertia.diagonal()[axis];
        for (i, gear) in gears.iter().enumerate() {
            let value = gear.row()[axis];
            if value != 0.0 && !fits(value * value) {
                return Err(Error::OutOfRange { place: Place::gear(i, arm), value, why: WHY });
            }
            for (name, rate) in [("stiffness", gear.stiffness), ("damping", gear.damping)] {
                if rate != 0.0 && value != 0.0 && !fits(rate * (value * value) / mass) {
                    // The one that is itself extreme is to blame.
                    let (place, value) = if is_moderate(mass) {
                        (Place::gear(i, name), rate)
                    } else {
                        (mass_name.into(), mass)
                    };
                    return Err(Error::OutOfRange { place, value, why: WHY });
                }
            }
        }
    }
    Ok(())
}

/// Static loads F with Gᵀ F = {W, 0, 0}, and the rank of G.
///
/// As many gears as freedoms: F follows from equilibrium alone. More: the one that springs
/// on a rigid body share, the least Σ F²/k. Both are the shortest solution of a system whose
/// columns are scaled by √k only in the second case, so soft and stiff gears side by side
/// cost a determinate aircraft no digits.
fn statics(inertia: &Inertia, gears: &[Gear]) -> Result<(Vec<f64>, usize)> {
    let rows: Vec<_> = gears.iter().map(Gear::row).collect();
    let size = rows.iter().fold(Vector3::zeros(), |size: Vector3<f64>, row| size.sup(&row.abs()));
    let scale = size.map(|size| if size > 0.0 { 1.0 / size } else { 1.0 });
    let arms: Vec<_> = rows.iter().map(|row| row.component_mul(&scale)).collect();
    let rank = Strains::new(&arms, RANK_TOLERANCE).rank();

    let stiffest = gears.iter().map(|g| g.stiffness).fold(0.0, f64::max);
    let share = |g: &Gear| if gears.len() > rank { (g.stiffness / stiffest).sqrt() } else { 1.0 };
    let share: Vec<f64> = gears.iter().map(share).collect();
    let system: Vec<_> = arms.iter().zip(&share).map(|(arm, share)| arm * *share).collect();
    let solver = Strains::new(&system, RANK_TOLERANCE);
    // The bounce row of `arms` is all ones: its scale is 1, so unit weight stays unit weight.
    let weight = Vector3::x();
    let mut load = vec![0.0; gears.len()];
    let mut residual = weight;
    for _ in 0..2 {
        // The second pass takes back the rounding of the first.
        for ((load, step), share) in load.iter_mut().zip(solver.solve(&residual)).zip(&share) {
            *load += step * share;
        }
        residual = weight - arms.iter().zip(&load).map(|(arm, load)| arm * *load).sum::<Vector3<f64>>();
    }
    if residual.amax() > 1e-9 {
        let freedom = if residual[1].abs() >= residual[2].abs() { 1 } else { 2 };
        let moment: f64 = rows.iter().zip(&load).map(|(row, load)| row[freedom] * load).sum();
        let arm = moment / load.iter().sum::<f64>();
        return Err(Error::Unsupported { freedom: FREEDOMS[freedom], gears: gears.len(), arm });
    }
    let total = inertia.mass * inertia.gravity;
    if let Some(index) = load.iter().position(|share| *share < -NO_LOAD)
        && total > 0.0
    {
        return Err(Error::Pulling { index, name: gears[index].name.clone(), load: load[index] * total });
    }
    Ok((load.iter().map(|share| share * total).collect(), rank))
}
