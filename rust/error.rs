//! The one error type. Where numbers are wrong, its variants carry them.

use std::fmt;

/// The result of everything that can fail.
pub type Result<T> = std::result::Result<T, Error>;

/// Where a value stands: an argument's name and, in an array, its indices; of a structure, its field.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Place {
    argument: &'static str,
    index: [Option<usize>; 3],
    field: Option<&'static str>,
}

impl Place {
    /// `argument[index]`.
    #[must_use]
    pub fn at(argument: &'static str, index: usize) -> Self {
        Self { index: [Some(index), None, None], ..argument.into() }
    }

    /// `argument[row, column]`.
    #[must_use]
    pub fn cell(argument: &'static str, row: usize, column: usize) -> Self {
        Self { index: [Some(row), Some(column), None], ..argument.into() }
    }

    /// `argument[run, track, station]`.
    #[must_use]
    pub fn station(argument: &'static str, run: usize, track: usize, station: usize) -> Self {
        Self { index: [Some(run), Some(track), Some(station)], ..argument.into() }
    }

    /// `gears[index].field`.
    #[must_use]
    pub fn gear(index: usize, field: &'static str) -> Self {
        Self { field: Some(field), ..Self::at("gears", index) }
    }
}

impl From<&'static str> for Place {
    fn from(argument: &'static str) -> Self {
        Self { argument, index: [None; 3], field: None }
    }
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.argument)?;
        match self.index {
            [Some(row), Some(column), Some(layer)] => write!(f, "[{row}, {column}, {layer}]"),
            [Some(row), Some(column), None] => write!(f, "[{row}, {column}]"),
            [Some(row), ..] => write!(f, "[{row}]"),
            _ => Ok(()),
        }?;
        self.field.map_or(Ok(()), |field| write!(f, ".{field}"))
    }
}

/// So many entries, in words.
fn entries(count: usize) -> String {
    if count == 1 { "1 entry".into() } else { format!("{count} entries") }
}

/// What is wrong, where, and with which value.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
#[allow(missing_docs, reason = "each message says what its fields are")]
pub enum Error {
    /// NaN or an infinity.
    #[error("{place} = {value} is not finite")]
    NotFinite { place: Place, value: f64 },
    /// Zero or negative where only positive makes sense.
    #[error("{place} = {value:?} is not positive")]
    NotPositive { place: Place, value: f64 },
    /// Negative where zero is the least.
    #[error("{place} = {value:?} is negative")]
    Negative { place: Place, value: f64 },
    /// A sequence that decreases.
    #[error("{place} = {value:?} is less than {previous:?} before it: values may not decrease")]
    Decreasing { place: Place, value: f64, previous: f64 },
    /// An array with too few entries.
    #[error("{argument} has {}, at least {least} needed", entries(*.found))]
    TooShort { argument: &'static str, found: usize, least: usize },
    /// An array whose length does not match another's.
    #[error("{argument} has {}, {expected} expected ({why})", entries(*.found))]
    WrongLength { argument: &'static str, found: usize, expected: usize, why: &'static str },
    /// Two gears with the same name.
    #[error("gears[{second}].name = '{name}' repeats the name of gears[{first}]")]
    DuplicateGear { name: String, first: usize, second: usize },
    /// The gears cannot carry the weight in equilibrium.
    #[error(
        "gears: {freedom} has no stiffness, and the weight does not balance in it \
         ({gears} gear(s), unbalanced arm {arm:?} from the centre of gravity)"
    )]
    Unsupported { freedom: &'static str, gears: usize, arm: f64 },
    /// A gear that would have to pull at rest.
    #[error(
        "gears[{index}] = '{name}' would have to hold the aircraft down at rest, static load {load:?}: \
         check the arms (x is forward of the centre of gravity, y to the left)"
    )]
    Pulling { index: usize, name: String, load: f64 },
    /// A value whose consequences leave the range of double precision.
    #[error("{place} = {value:?} is out of range: {why}")]
    OutOfRange { place: Place, value: f64, why: &'static str },
    /// Stations too far apart for the waves of a random profile.
    #[error(
        "spacing = {spacing:?} is too coarse: the band's shortest wave needs two stations, so {most:?} \
         at most, or a lower upper end of the band"
    )]
    TooCoarse { spacing: f64, most: f64 },
    /// Mode shapes that are not orthogonal with respect to the mass matrix (Eq. 7).
    #[error(
        "shapes: columns {row} and {column} have shapesᵀ M shapes = {value:?}, \
         0 ± {tolerance:?} expected (orthonormal shapes, Eq. 7)"
    )]
    NotOrthogonal { row: usize, column: usize, value: f64, tolerance: f64 },
    /// A mode shape whose norm with respect to the mass matrix is not 1 (Eq. 7).
    #[error(
        "shapes: column {column} has shapeᵀ M shape = {value:?}, 1 ± {tolerance:?} expected \
         (orthonormal shapes, Eq. 7): divide it by {size:?}",
        size = value.sqrt()
    )]
    NotNormal { column: usize, value: f64, tolerance: f64 },
    /// Coherent tracks from a spectrum that is not a single power law.
    #[error(
        "tracks a distance apart need a spectrum of one waviness: the coherency on an isotropic \
         surface is known for power laws, not for a table of several"
    )]
    NoWaviness,
    /// The eigenvalue iteration did not converge.
    #[error("the eigenvalue iteration did not converge in {iterations} steps")]
    NotConverged { iterations: usize },
    /// A result overflowed.
    #[error("{quantity} left the range of double precision by time {time:?}")]
    Overflow { quantity: &'static str, time: f64 },
    /// A search that would take more runs than allowed.
    #[error(
        "tolerance = {tolerance:?} takes more runs than max_runs = {max_runs} allows: after {runs} runs \
         the worst value found is {value:?}, at speed {speed:?}, and none is beyond {bound:?}"
    )]
    Unresolved { tolerance: f64, max_runs: usize, runs: usize, value: f64, speed: f64, bound: f64 },
    /// A count below what makes sense.
    #[error("{argument} = {value} is too few, {least} at least")]
    TooFew { argument: &'static str, value: usize, least: usize },
    /// A gear's number that no gear has.
    #[error("there is no gear number {index}: {gears} gear(s), counted from 0")]
    NoSuchGear { index: usize, gears: usize },
    /// A run of many whose arithmetic left the range.
    #[error("{place}: a result left the range of double precision")]
    RunOverflow { place: Place },
    /// Results that do not fit in memory.
    #[error("runs = {runs}: there is no memory for so many results")]
    NoRoom { runs: usize },
    /// The caller asked to stop.
    #[error("interrupted")]
    Interrupted,
}

impl Error {
    /// Whether the arithmetic failed, rather than the input being wrong.
    #[must_use]
    pub fn is_numerical(&self) -> bool {
        matches!(self, Self::NotConverged { .. } | Self::Overflow { .. } | Self::RunOverflow { .. })
    }
}

/// Passes a finite value.
///
/// # Errors
/// [`Error::NotFinite`].
pub fn finite(place: impl Into<Place>, value: f64) -> Result<f64> {
    if value.is_finite() { Ok(value) } else { Err(Error::NotFinite { place: place.into(), value }) }
}

/// Passes a finite value > 0.
///
/// # Errors
/// [`Error::NotFinite`], [`Error::NotPositive`].
pub fn positive(place: impl Into<Place>, value: f64) -> Result<f64> {
    let place = place.into();
    if finite(place, value)? > 0.0 { Ok(value) } else { Err(Error::NotPositive { place, value }) }
}

/// Passes a value whose powers stay in the range of double precision, 1e-100 to 1e100.
///
/// # Errors
/// [`Error::NotFinite`], [`Error::NotPositive`], [`Error::OutOfRange`].
pub fn moderate(place: impl Into<Place>, value: f64) -> Result<f64> {
    let place = place.into();
    if is_moderate(positive(place, value)?) {
        Ok(value)
    } else {
        Err(Error::OutOfRange { place, value, why: "1e-100 to 1e100 is allowed" })
    }
}

/// Whether powers of a positive value stay in the range of double precision.
#[must_use]
pub fn is_moderate(value: f64) -> bool {
    (1e-100..=1e100).contains(&value)
}

/// Passes a finite value ≥ 0.
///
/// # Errors
/// [`Error::NotFinite`], [`Error::Negative`].
pub fn not_negative(place: impl Into<Place>, value: f64) -> Result<f64> {
    let place = place.into();
    if finite(place, value)? >= 0.0 { Ok(value) } else { Err(Error::Negative { place, value }) }
}

/// Passes a finite sequence that never decreases.
///
/// # Errors
/// [`Error::NotFinite`], [`Error::Decreasing`].
pub fn non_decreasing(argument: &'static str, values: &[f64]) -> Result<()> {
    let mut previous = f64::NEG_INFINITY;
    for (i, &value) in values.iter().enumerate() {
        let place = Place::at(argument, i);
        if finite(place, value)? < previous {
            return Err(Error::Decreasing { place, value, previous });
        }
        previous = value;
    }
    Ok(())
}
