//! Random profiles from a spectrum: run 731 is the same profile in any batch, on any thread or
//! machine.
//!
//! A profile is a part of one period of a sum of waves,
//!
//! ```text
//! z(x) = Σ √vₖ (ξₖ cos 2πnₖx − ηₖ sin 2πnₖx)        nₖ = k ÷ period
//! ```
//!
//! with ξ, η standard normal and vₖ the spectrum's integral from halfway to the line before to
//! halfway to the line after, so that the variance is the spectrum's to the last bit that
//! matters. Where the mean frequency of such a part is not that of its line, as at the ends of the
//! band, a share goes to the next line on that side, so that the sum has the same mean. Every station is
//! Gaussian, and none is special: the process is stationary.
//!
//! The period exceeds the length by at least four of the longest waves: the ends of a profile
//! then have nearly nothing to do with each other, and the lines are close enough to follow the
//! spectrum where it is steepest. A band narrower than its lowest frequency beats slowly, as if by
//! longer waves: there it is four of its beats, and as many lines.

use multiversion::multiversion;

use crate::coherence::Coherency;
use crate::ensemble::{Reader, Shape, Simd, Source};
use crate::error::{Error, Result, finite, positive};
use crate::fourier::{NONE, Term, Transform, times};
use crate::parallel::{self, Tools};
use crate::random::{Deviates, LINES, Streams};
use crate::row::{RUNS, Row};
use crate::spectrum::Spectrum;
use crate::watch::{Pulse, Watch};

/// Longest waves, or beats of a narrow band, by which the period exceeds the length.
const MARGIN: f64 = 4.0;

/// Spacings in a period: half a gigabyte a track for a block of runs, and seconds to make it.
const MOST_SPACINGS: f64 = 8_388_608.0; // 2²³

/// Wavinesses of isotropic surfaces.
const MOST_WAVINESS: f64 = 10.0;

/// The stretch of runway that profiles are made of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stretch {
    /// From the first station to the last, at least.
    pub length: f64,
    /// Of the stations.
    pub spacing: f64,
}

/// Makes profiles: everything that does not depend on the run.
#[derive(Clone, Debug)]
pub struct Generator {
    seed: u64,
    spacing: f64,
    stations: usize,
    /// Distinct lateral positions, in order of appearance; and which of them each track has.
    tracks: usize,
    track_of: Vec<usize>,
    /// The lines in the band, in order of their first place: memory is then walked through, not
    /// jumped about in.
    lines: Vec<SpectralLine>,
    /// Half of √v L of each line, L the factor of the tracks' coherencies.
    triangles: Vec<f64>,
    transform: Transform,
}

/// A wave of the sum, and where it goes.
///
/// A real series of twice as many terms has its even stations as real parts, its odd ones as
/// imaginary parts; line k then goes into terms k and size − k.
#[derive(Clone, Copy, Debug)]
struct SpectralLine {
    number: u32,
    places: [u32; 2],
    /// e^(iπk ÷ size).
    turn: [f64; 2],
}

/// Room for the profiles of one block of runs.
#[derive(Clone, Debug)]
pub struct Block {
    tracks: Vec<Vec<Term>>,
    noise: Vec<Deviates>,
}

impl Block {
    /// Elevations at the stations under a distinct track.
    #[must_use]
    pub fn track(&self, distinct: usize) -> &[Row] {
        self.tracks[distinct].as_flattened()
    }
}

impl Generator {
    /// For parallel tracks at `y` on one isotropic surface; tracks at the same `y` are one.
    ///
    /// # Errors
    /// Values out of range, a spacing that the band's shortest waves do not fit, several tracks
    /// where the spectrum has no single waviness, or what `pulse` gives.
    pub fn new(spectrum: &Spectrum, stretch: Stretch, y: &[f64], seed: u64, pulse: Pulse) -> Result<Self> {
        let Stretch { length, spacing } = stretch;
        positive("length", length)?;
        positive("spacing", spacing)?;
        let (low, high) = spectrum.band();
        if 2.0 * spacing * high > 1.0 + 1e-9 {
            return Err(Error::TooCoarse { spacing, most: 0.5 / high });
        }
        // A length that is a whole number of spacings but for rounding is one.
        let segments = (length / spacing - 1e-9).ceil().max(1.0);
        let period = segments + (MARGIN / (low.min(high - low) * spacing)).ceil();
        if period > MOST_SPACINGS {
            // The error names what takes up most of the period.
            let (place, value, why) = if 2.0 * segments > period {
                (
                    "length",
                    length,
                    "with four of the band's longest waves or beats it holds more than 2^23 spacings",
                )
            } else if high - low < low {
                ("width of the band", high - low, "4 / width holds more than 2^23 spacings")
            } else {
                (
                    "spacing",
                    spacing,
                    "more than 2^23 of it fit into the length and four of the band's longest waves or beats",
                )
            };
            return Err(Error::OutOfRange { place: place.into(), value, why });
        }
        let (distinct, track_of) = distinct(y)?;
        let coherency = match (distinct.len(), spectrum.waviness()) {
            (1, _) => Coherency::new(1.0),
            (_, None) => return Err(Error::NoWaviness),
            (_, Some(waviness)) if waviness > 0.0 && waviness <= MOST_WAVINESS => Coherency::new(waviness),
            (_, Some(value)) => {
                let why = "an isotropic surface has a waviness above 0, at most 10";
                return Err(Error::OutOfRange { place: "waviness".into(), value, why });
            }
        };

        // Half a period of lines in as many complex terms.
        let size = Transform::fast_size((period as usize).div_ceil(2));
        let step = 1.0 / (2.0 * size as f64 * spacing);
        let (first, variances) = variances(spectrum, step, size - 1, pulse)?;
        let variance = |line: &SpectralLine| variances[line.number as usize - first];
        let transform = Transform::new(size, pulse)?;
        let line = |k: usize| SpectralLine {
            number: k as u32,
            places: [k, size - k].map(|k| transform.place(k)),
            turn: transform.turn(k),
        };
        let mut lines = parallel::list(first..first + variances.len(), pulse, line)?;
        lines.retain(|line| variance(line) > 0.0);
        parallel::sort_by_key(&mut lines, |line| line.places[0]);
        let triangle = |i: usize| {
            let half_deviation = 0.5 * variance(&lines[i]).sqrt();
            let mut triangle = Vec::with_capacity(distinct.len() * (distinct.len() + 1) / 2);
            coherency.factor(f64::from(lines[i].number) * step, &distinct, &mut triangle);
            for entry in &mut triangle {
                *entry *= half_deviation;
            }
            triangle
        };
        let triangles = parallel::list(0..lines.len(), pulse, triangle)?.concat();
        Ok(Self {
            seed,
            spacing,
            stations: segments as usize + 1,
            tracks: distinct.len(),
            track_of,
            lines,
            triangles,
            transform,
        })
    }

    /// Distance between stations.
    #[must_use]
    pub fn spacing(&self) -> f64 {
        self.spacing
    }

    /// Stations of a profile.
    #[must_use]
    pub fn stations(&self) -> usize {
        self.stations
    }

    /// Which distinct track each of the tracks is.
    #[must_use]
    pub fn track_of(&self) -> &[usize] {
        &self.track_of
    }

    /// An empty block: to fill it takes the memory.
    #[must_use]
    pub fn block(&self) -> Block {
        Block { tracks: vec![Vec::new(); self.tracks], noise: vec![[[Row::ZERO; LINES]; 2]; self.tracks] }
    }

    /// Makes the profiles of eight runs.
    ///
    /// # Errors
    /// What `pulse` gives; the block is then half made.
    pub fn fill(&self, runs: [u64; RUNS], block: &mut Block, pulse: Pulse) -> Result<()> {
        let mut watch = Watch::new(pulse);
        synthesize(self, &Streams::new(self.seed, runs), block, &mut watch);
        watch.outcome
    }

    /// Profiles of consecutive runs: (run, track, station), as many runs as fit.
    ///
    /// # Errors
    /// When the caller asks to stop.
    pub fn elevations(&self, first_run: u64, out: &mut [f64], pulse: Pulse) -> Result<()> {
        let run_size = self.track_of.len() * self.stations;
        let blocks = Tools::new();
        parallel::map(out.chunks_mut(RUNS * run_size).enumerate(), pulse, |(i, runs), pulse| {
            blocks.lend(
                || self.block(),
                |block| {
                    self.fill_from(first_run.wrapping_add((i * RUNS) as u64), block, pulse)?;
                    self.unpack(block, runs, pulse)
                },
            )
        })?;
        Ok(())
    }

    /// Takes the profiles of a block apart: (run, track, station).
    fn unpack(&self, block: &Block, runs: &mut [f64], pulse: Pulse) -> Result<()> {
        let mut watch = Watch::new(pulse);
        let run_size = self.track_of.len() * self.stations;
        for (t, &track) in self.track_of.iter().enumerate() {
            for (tile, rows) in block.track(track)[..self.stations].chunks(TILE).enumerate() {
                for (lane, run) in runs.chunks_mut(run_size).enumerate() {
                    let out = &mut run[t * self.stations + tile * TILE..][..rows.len()];
                    for (z, row) in out.iter_mut().zip(rows) {
                        *z = row[lane];
                    }
                }
                if !watch.go_on(TILE as u32) {
                    return watch.outcome;
                }
            }
        }
        Ok(())
    }

    /// Makes the profiles of eight consecutive runs.
    fn fill_from(&self, first: u64, block: &mut Block, pulse: Pulse) -> Result<()> {
        self.fill(std::array::from_fn(|lane| first.wrapping_add(lane as u64)), block, pulse)
    }
}

/// Consecutive runs as a source of elevations.
#[derive(Clone, Copy, Debug)]
pub struct Runs<'a> {
    /// What makes them.
    pub generator: &'a Generator,
    /// The first one's number.
    pub first: u64,
    /// So many.
    pub count: usize,
}

/// Makes a block of runs, then lets it be read.
#[derive(Debug)]
pub struct RunsReader<'a> {
    runs: Runs<'a>,
    block: Block,
}

impl Source for Runs<'_> {
    type Reader<'a>
        = RunsReader<'a>
    where
        Self: 'a;

    fn shape(&self) -> Shape {
        Shape { runs: self.count, tracks: self.generator.track_of.len(), stations: self.generator.stations }
    }

    fn reader(&self) -> RunsReader<'_> {
        RunsReader { runs: *self, block: self.generator.block() }
    }
}

impl Reader for RunsReader<'_> {
    fn open(&mut self, first: usize, _count: usize, pulse: Pulse) -> Result<()> {
        let Runs { generator, first: first_of_all, .. } = self.runs;
        generator.fill_from(first_of_all.wrapping_add(first as u64), &mut self.block, pulse)
    }

    #[inline(always)]
    fn read<S: Simd>(&mut self, _simd: S, track: usize, first: usize, out: &mut [Row]) {
        let track = self.block.track(self.runs.generator.track_of[track]);
        out.copy_from_slice(&track[first..][..out.len()]);
    }

    fn elevation(&self, run: usize, track: usize, station: usize) -> f64 {
        self.block.track(self.runs.generator.track_of[track])[station][run]
    }
}

/// Variances of the lines of a spectrum, a `step` apart, and the number of the first; none is beyond `last`.
/// See the module text.
fn variances(spectrum: &Spectrum, step: f64, last: usize, pulse: Pulse) -> Result<(usize, Vec<f64>)> {
    let (low, high) = spectrum.band();
    let (first, end) = (((low / step + 0.5) as usize).max(1), ((high / step + 0.5) as usize).min(last) + 1);
    let parts = parallel::list(first..end, pulse, |k| {
        let upper = if k == last { high } else { (k as f64 + 0.5) * step };
        let part = ((k as f64 - 0.5) * step, upper);
        let variance = spectrum.variance(part.0, part.1);
        // In steps, how far the part's mean is from its line.
        let off =
            if variance > 0.0 { spectrum.mean_frequency(part.0, part.1) / step - k as f64 } else { 0.0 };
        (variance, off)
    })?;
    // One more on either side, where there is one: neither waves without end nor beyond the last line.
    let numbers = (first - 1).max(1)..(end + 1).min(last + 1);
    let mut variances = vec![0.0; numbers.len()];
    for (k, (variance, off)) in (first..end).zip(parts) {
        let next = if off > 0.0 { k + 1 } else { k - 1 };
        let share = if numbers.contains(&next) { off.abs() } else { 0.0 };
        variances[k - numbers.start] += (1.0 - share) * variance;
        if share > 0.0 {
            variances[next - numbers.start] += share * variance;
        }
    }
    Ok((numbers.start, variances))
}

/// Stations turned from side by side to one after another at a time: they stay in the cache.
const TILE: usize = 64;

fn distinct(y: &[f64]) -> Result<(Vec<f64>, Vec<usize>)> {
    if y.is_empty() {
        return Err(Error::TooShort { argument: "y", found: 0, least: 1 });
    }
    let mut distinct: Vec<f64> = vec![];
    let mut track_of = vec![];
    for (i, &value) in y.iter().enumerate() {
        finite(crate::error::Place::at("y", i), value)?;
        let known = distinct.iter().position(|&other| other == value);
        track_of.push(known.unwrap_or_else(|| {
            distinct.push(value);
            distinct.len() - 1
        }));
    }
    Ok((distinct, track_of))
}

#[multiversion(targets("x86_64+avx512f", "x86_64+avx2"))]
fn synthesize(generator: &Generator, streams: &Streams, block: &mut Block, watch: &mut Watch) {
    synthesize_here(generator, streams, block, watch);
}

/// Draws the lines of all tracks, then sums them, track by track.
#[inline(always)]
fn synthesize_here(generator: &Generator, streams: &Streams, block: &mut Block, watch: &mut Watch) {
    for track in &mut block.tracks {
        track.clear();
        track.resize(generator.transform.size(), NONE);
        if !watch.go_on(track.len() as u32) {
            return;
        }
    }
    let mut triangles = generator.triangles.chunks_exact(generator.tracks * (generator.tracks + 1) / 2);
    for lines in generator.lines.chunks(LINES) {
        let numbers = std::array::from_fn(|i| lines.get(i).map_or(0, |line| line.number));
        for (t, noise) in block.noise.iter_mut().enumerate() {
            *noise = streams.normals(&numbers, t as u32);
        }
        for (i, (line, triangle)) in lines.iter().zip(&mut triangles).enumerate() {
            let [here, there] = line.places.map(|place| place as usize);
            let [cos, sin] = line.turn;
            let mut entries = triangle.iter();
            for (t, terms) in block.tracks.iter_mut().enumerate() {
                let mut wave = NONE;
                for (noise, factor) in block.noise[..=t].iter().zip(&mut entries) {
                    wave[0] += Row::all(*factor) * noise[0][i];
                    wave[1] += Row::all(*factor) * noise[1][i];
                }
                let [re, im] = times(wave, [1.0 - sin, cos]);
                terms[here] = [terms[here][0] + re, terms[here][1] + im];
                let [re, im] = times(wave, [1.0 + sin, -cos]);
                terms[there] = [terms[there][0] + re, terms[there][1] - im];
            }
        }
        if !watch.go_on((generator.tracks * LINES) as u32) {
            return;
        }
    }
    for terms in &mut block.tracks {
        generator.transform.sum(terms, watch);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spectrum::PowerLaw;

    /// As `synthesize` on a machine that has AVX2 and no more.
    #[multiversion(targets("x86_64+avx2"))]
    fn synthesize_avx2(generator: &Generator, streams: &Streams, block: &mut Block, watch: &mut Watch) {
        synthesize_here(generator, streams, block, watch);
    }

    /// The widest vectors of this machine, AVX2 and plain SSE2: `make same-bits` runs this on
    /// optimised code, where they are used.
    #[test]
    fn same_bits_at_any_width() {
        let law = PowerLaw { coefficient: 16e-6, waviness: 2.0, reference: 0.1, band: (0.02, 1.0) };
        let spectrum = Spectrum::power_law(law).unwrap();
        let go_on: Pulse = &mut || Ok(());
        // Transforms of 512, 384, 640 and 432 terms: every radix.
        for (length, size) in [(300.0, 512), (180.0, 384), (420.0, 640), (230.0, 432)] {
            let stretch = Stretch { length, spacing: 0.5 };
            let generator = Generator::new(&spectrum, stretch, &[0.0, 5.0, -5.0], 7, go_on).unwrap();
            assert_eq!(generator.transform.size(), size);
            let streams = Streams::new(7, std::array::from_fn(|lane| 100 * lane as u64));
            let made = [synthesize, synthesize_avx2, synthesize_here].map(|synthesize| {
                let mut block = generator.block();
                synthesize(&generator, &streams, &mut block, &mut Watch::new(go_on));
                block.tracks
            });
            assert!(made[0][1][7][0].0.iter().all(|&z| z != 0.0));
            assert_eq!(made[0], made[2]);
            assert_eq!(made[1], made[2]);
        }
    }
}
