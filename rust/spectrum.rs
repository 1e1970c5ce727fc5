//! One-sided displacement spectra: piecewise power laws inside a band, zero outside.

use libm::{expm1, log, log1p, pow};

use crate::error::{Error, Place, Result, finite, is_moderate, positive};

/// One-sided power spectral density of elevation against spatial frequency n, in cycles per
/// length; its integral over n is the variance of the elevation.
#[derive(Clone, Debug, PartialEq)]
pub struct Spectrum {
    pieces: Vec<PowerLaw>,
}

/// G(n) = coefficient · (n ÷ reference)^−waviness for low ≤ n ≤ high.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PowerLaw {
    /// G at the reference frequency, length³.
    pub coefficient: f64,
    /// w.
    pub waviness: f64,
    /// Reference frequency, cycles per length.
    pub reference: f64,
    /// The ends of the band, cycles per length.
    pub band: (f64, f64),
}

impl PowerLaw {
    fn at(&self, n: f64) -> f64 {
        self.coefficient * pow(n / self.reference, -self.waviness)
    }

    /// ∫ G and ∫ n G over low ≤ n ≤ high, within the band. Nothing cancels, however narrow the interval
    /// or near to 1 the waviness.
    fn integrals(&self, low: f64, high: f64) -> [f64; 2] {
        let (low, high) = (low.max(self.band.0), high.min(self.band.1));
        if low >= high {
            return [0.0; 2];
        }
        let log_ratio = log1p((high - low) / low);
        let growth = |power: f64| {
            let exponent = (power - self.waviness) * log_ratio;
            if exponent == 0.0 { 1.0 } else { expm1(exponent) / exponent }
        };
        let first = self.at(low) * low * log_ratio;
        [first * growth(1.0), first * low * growth(2.0)]
    }
}

impl Spectrum {
    /// One power law, as ISO 8608 has it.
    ///
    /// # Errors
    /// Values not finite, not positive, a band that is empty, densities out of range.
    pub fn power_law(law: PowerLaw) -> Result<Self> {
        positive("coefficient", law.coefficient)?;
        finite("waviness", law.waviness)?;
        positive("reference", law.reference)?;
        let (low, high) = law.band;
        positive(Place::at("band", 0), low)?;
        if finite(Place::at("band", 1), high)? <= low {
            let why = "the band's upper end must exceed its lower end";
            return Err(Error::OutOfRange { place: Place::at("band", 1), value: high, why });
        }
        for n in [low, high] {
            check_range("coefficient", law.coefficient, law.at(n))?;
        }
        check_range("coefficient", law.coefficient, law.integrals(low, high)[0])?;
        Ok(Self { pieces: vec![law] })
    }

    /// A table of frequencies and densities: power laws, straight in log G against log n,
    /// from point to point.
    ///
    /// # Errors
    /// Fewer than two points, lengths that differ, values not positive, frequencies that do not
    /// increase.
    pub fn table(n: &[f64], density: &[f64]) -> Result<Self> {
        if n.len() < 2 {
            return Err(Error::TooShort { argument: "n", found: n.len(), least: 2 });
        }
        if density.len() != n.len() {
            let why = "one per frequency";
            return Err(Error::WrongLength { argument: "psd", found: density.len(), expected: n.len(), why });
        }
        for i in 0..n.len() {
            positive(Place::at("n", i), n[i])?;
            check_range(Place::at("psd", i), density[i], positive(Place::at("psd", i), density[i])?)?;
            if i > 0 && n[i] <= n[i - 1] {
                let why = "frequencies must increase";
                return Err(Error::OutOfRange { place: Place::at("n", i), value: n[i], why });
            }
        }
        let piece = |i: usize| PowerLaw {
            coefficient: density[i],
            waviness: -log(density[i + 1] / density[i]) / log(n[i + 1] / n[i]),
            reference: n[i],
            band: (n[i], n[i + 1]),
        };
        Ok(Self { pieces: (0..n.len() - 1).map(piece).collect() })
    }

    /// The band's ends.
    ///
    /// # Panics
    /// Never: there is at least one piece.
    #[must_use]
    pub fn band(&self) -> (f64, f64) {
        (self.pieces[0].band.0, self.pieces.last().unwrap().band.1)
    }

    /// G(n).
    #[must_use]
    pub fn density(&self, n: f64) -> f64 {
        let inside = |piece: &&PowerLaw| piece.band.0 <= n && n <= piece.band.1;
        self.pieces.iter().find(inside).map_or(0.0, |piece| piece.at(n))
    }

    /// Variance of the elevation that comes from low ≤ n ≤ high.
    #[must_use]
    pub fn variance(&self, low: f64, high: f64) -> f64 {
        self.integrals(low, high)[0]
    }

    /// Mean frequency of the elevation that comes from low ≤ n ≤ high; NaN if none does.
    pub(crate) fn mean_frequency(&self, low: f64, high: f64) -> f64 {
        let [variance, moment] = self.integrals(low, high);
        moment / variance
    }

    fn integrals(&self, low: f64, high: f64) -> [f64; 2] {
        let first = self.pieces.partition_point(|piece| piece.band.1 <= low);
        let end = self.pieces.partition_point(|piece| piece.band.0 < high);
        let pieces = self.pieces[first..end.max(first)].iter().map(|piece| piece.integrals(low, high));
        pieces.fold([0.0; 2], |[a, b], [more_a, more_b]| [a + more_a, b + more_b])
    }

    /// The waviness, where it is the same in the whole band.
    #[must_use]
    pub fn waviness(&self) -> Option<f64> {
        match self.pieces[..] {
            [piece] => Some(piece.waviness),
            _ => None,
        }
    }
}

fn check_range(place: impl Into<Place>, value: f64, consequence: f64) -> Result<()> {
    if is_moderate(consequence) {
        return Ok(());
    }
    let why = "densities and variance must lie between 1e-100 and 1e100 all over the band";
    Err(Error::OutOfRange { place: place.into(), value, why })
}
