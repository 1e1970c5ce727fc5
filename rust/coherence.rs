//! How alike parallel tracks over an isotropic surface are (Dodds and Robson, *The description
//! of road surface roughness*, J. Sound and Vibration 31, 1973).

use std::f64::consts::TAU;

use libm::{cosh, exp, pow, tgamma};

/// Spacing of the trapezoidal rule for K, which converges like e^(−π² ÷ step): the error is
/// below rounding.
const STEP: f64 = 0.25;

/// Below this 2πnd the tracks are one. The nodes reach to where its integrand has vanished.
const LEAST: f64 = 1e-12;
const NODES: usize = 135;

/// A pivot this small is the rounding of 1: the track is a combination of those before it.
const PIVOT: f64 = 1e-14;

/// Coherency of two tracks over an isotropic surface of one waviness.
#[derive(Clone, Debug)]
pub struct Coherency {
    /// w ÷ 2, the order of the Bessel function.
    order: f64,
    /// 2 ÷ Γ(order).
    scale: f64,
    /// cosh t and cosh(order · t) at the nodes.
    nodes: Vec<(f64, f64)>,
}

impl Coherency {
    /// For a surface whose profiles have the waviness w > 0.
    #[must_use]
    pub fn new(waviness: f64) -> Self {
        let order = 0.5 * waviness;
        let node = |i: usize| (cosh(STEP * i as f64), cosh(order * STEP * i as f64));
        Self { order, scale: 2.0 / tgamma(order), nodes: (0..NODES).map(node).collect() }
    }

    /// γ(n) of tracks a distance d > 0 apart, from 1 down to 0; their cross spectrum is γ G.
    ///
    /// γ = [2 ÷ Γ(w/2)] (πnd)^(w/2) `K_w/2`(2πnd), to an absolute 1e-15.
    #[must_use]
    pub fn at(&self, n: f64, distance: f64) -> f64 {
        let x = TAU * n * distance;
        if x < LEAST {
            return 1.0;
        }
        (self.scale * pow(0.5 * x, self.order) * self.bessel_k(x)).min(1.0)
    }

    /// `K_order(x)` = ∫ exp(−x cosh t) cosh(order · t) dt from 0 to infinity. For x > 20, where
    /// it is tiny, only its size is right.
    fn bessel_k(&self, x: f64) -> f64 {
        let mut sum = 0.5 * exp(-x);
        for &(slow, fast) in &self.nodes[1..] {
            let term = exp(-x * slow) * fast;
            sum += term;
            // Past the hump the terms fall faster than any power.
            if term <= 1e-3 * f64::EPSILON * sum && x * slow > self.order {
                break;
            }
        }
        STEP * sum
    }

    /// Appends the lower triangle, row by row, of L with L Lᵀ = coherencies of the tracks at `y`.
    pub fn factor(&self, n: f64, y: &[f64], triangles: &mut Vec<f64>) {
        let start = triangles.len();
        // Aircraft are symmetrical: few distances differ, and each costs a Bessel function.
        let mut known: Vec<(f64, f64)> = vec![];
        let mut coherency = |distance: f64| {
            if let Some(&(_, found)) = known.iter().find(|(other, _)| *other == distance) {
                return found;
            }
            known.push((distance, if distance == 0.0 { 1.0 } else { self.at(n, distance) }));
            known[known.len() - 1].1
        };
        let at = |i: usize, j: usize| start + i * (i + 1) / 2 + j;
        for i in 0..y.len() {
            for j in 0..=i {
                let explained = |rest: f64, k: usize| rest - triangles[at(i, k)] * triangles[at(j, k)];
                let rest = (0..j).fold(coherency((y[i] - y[j]).abs()), explained);
                let entry = if i == j {
                    if rest > PIVOT { rest.sqrt() } else { 0.0 }
                } else {
                    let pivot = triangles[at(j, j)];
                    if pivot > 0.0 { rest / pivot } else { 0.0 }
                };
                triangles.push(entry);
            }
        }
    }
}
