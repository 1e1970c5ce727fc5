//! Largest and smallest values at kinks, and the chunks that may exceed them in between.

use std::ops::Range;

use pulp::Simd;

use super::super::records::Records;
use super::super::vector::{Part, Vector, parts};
use super::view::{View, value, with_view};
use super::{CHUNK, March, PERIODS, Row, ZERO};

/// Shorter runs, in periods, may hold a record on most of their chunks: these are sifted at once.
const SHORT: usize = 192;

/// How far one output may come on a chunk.
#[derive(Clone, Copy)]
pub(super) struct ChunkBounds {
    /// B of the longest span between two kinks: see `summits`.
    pub bend: Row,
    /// What F and −F stay below.
    pub bounds: [Row; 2],
}

impl March {
    /// Looks at all outputs at the ends of the block and at kinks, where their slopes may jump; keeps the
    /// chunks that may hold a record in between. Returns the chunks to sift at once.
    #[inline(always)]
    pub(super) fn look<S: Simd>(&mut self, simd: S, count: usize, legs: usize) -> Range<usize> {
        if count * legs == 0 {
            return 0..0;
        }
        // Apart while the rest is read.
        let mut records = std::mem::take(&mut self.records);
        let mut chunk_bounds = std::mem::take(&mut self.chunk_bounds);
        let mut over = [ZERO; PERIODS / CHUNK];
        for output in 0..self.constants.weights.len() {
            for part in parts(simd) {
                let bounds = &mut chunk_bounds[output];
                let block = (count, legs);
                with_view!(self, part, output, block, view => view.look(&mut records, bounds, &mut over));
            }
        }
        (self.records, self.chunk_bounds) = (records, chunk_bounds);
        // Whole chunks are kept; the last may be shorter.
        let kept = if self.layout.periods < SHORT { 0 } else { count / CHUNK };
        for (chunk, over) in over[..kept].iter().enumerate() {
            for lane in 0..self.runs {
                if over[lane] > 0.0 {
                    self.keep(chunk, lane);
                }
            }
        }
        if self.between { kept..count.div_ceil(CHUNK) } else { 0..0 }
    }

    /// The far side of the last station of all, where a damped output may jump.
    #[inline(always)]
    pub(super) fn look_back<S: Simd>(&mut self, simd: S, leg: usize) {
        for output in 0..self.constants.weights.len() {
            for part in parts(simd) {
                let weights = part.load_all(&self.constants.weights[output].state);
                let value = value::<S, true>(part, &weights, &self.states[leg], 0)
                    + self.lines(part, output, (leg, 0), false);
                self.records.update(part, output, value, value);
            }
        }
    }

    /// How far an output may bulge above its values at kinks: by what it bends on the longest span
    /// between two of them, and by what it swings.
    #[inline(always)]
    fn bulges<S: Simd>(&self, part: Part<S>, output: usize) -> [Vector<S>; 2] {
        let mut bounds = [part.all(0.0); 2];
        let [bend, swing] = &self.constants.weights[output].bulge;
        for ((bend, swing), norm) in bend.iter().zip(swing).zip(&self.norms) {
            let norm = part.load(norm);
            bounds[0] = bounds[0] + part.load(bend) * norm;
            bounds[1] = bounds[1] + part.load(swing) * norm;
        }
        bounds
    }
}

impl<S: Simd, const RATES: bool, const LINES: bool> View<'_, S, RATES, LINES> {
    /// See [`March::look`]; `over` holds by how much the runs may break a record on each chunk.
    #[inline(always)]
    fn look(
        &self,
        records: &mut Records,
        chunk_bounds: &mut [ChunkBounds; PERIODS / CHUNK],
        over: &mut [Row; PERIODS / CHUNK],
    ) {
        let Self { march, part, output, .. } = *self;
        let mut last = self.after((0, 0));
        let [mut top, mut bottom] = [last; 2];
        let mut edges = [[last; 2]; PERIODS / CHUNK];
        let edges = &mut edges[..self.count.div_ceil(CHUNK)];
        for (chunk, edges) in edges.iter_mut().enumerate() {
            let start = if LINES { self.after((0, CHUNK * chunk)) } else { last };
            (*edges, last) = self.edges(chunk, start);
            (top, bottom) = (top.max(edges[0]), bottom.min(edges[1]));
        }
        records.update(part, output, top, bottom);
        if !march.between {
            return;
        }
        let [high, low] = records.best(part, output);
        let [bend, swing] = march.bulges(part, output);
        let most = bend.min(swing);
        for (chunk, [top, bottom]) in edges.iter().enumerate() {
            let bounds = [*top + most, most - *bottom];
            part.store(bend, &mut chunk_bounds[chunk].bend);
            for side in 0..2 {
                part.store(bounds[side], &mut chunk_bounds[chunk].bounds[side]);
            }
            let beyond = (bounds[0] - high).max(bounds[1] - low);
            part.store(part.load(&over[chunk]).max(beyond), &mut over[chunk]);
        }
    }
}
