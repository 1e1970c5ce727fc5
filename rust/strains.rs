//! Directions in which springs are strained independently of each other.
//!
//! This is the singular value decomposition of the springs' rows by one-sided Jacobi rotations
//! (Demmel and Veselić, *Jacobi's method is more accurate than QR*, 1992). Nothing is squared:
//! every direction, however soft beside the others, has its own full precision.

use nalgebra::{Matrix3, Vector3};

/// Turns orthonormal directions until the strains of any two are orthogonal to rounding.
pub(crate) fn orthogonal_strains(springs: &[Vector3<f64>], mut directions: Matrix3<f64>) -> Matrix3<f64> {
    /// More than ever needed: they converge quadratically.
    const SWEEPS: usize = 30;
    for _ in 0..SWEEPS {
        let mut turned = false;
        for (i, j) in [(0, 1), (0, 2), (1, 2)] {
            let (a, b) = (directions.column(i).into_owned(), directions.column(j).into_owned());
            let (aa, ab, bb) = (work(springs, &a, &a), work(springs, &a, &b), work(springs, &b, &b));
            if ab.abs() > f64::EPSILON * (aa.sqrt() * bb.sqrt()) {
                let half = (bb - aa) / (2.0 * ab);
                let tangent = half.signum() / (half.abs() + (1.0 + half * half).sqrt());
                let cosine = 1.0 / (1.0 + tangent * tangent).sqrt();
                directions.set_column(i, &((a - b * tangent) * cosine));
                directions.set_column(j, &((a * tangent + b) * cosine));
                turned = true;
            }
        }
        if !turned {
            break;
        }
    }
    directions
}

/// Sum over the springs of their strains in two directions, multiplied.
fn work(springs: &[Vector3<f64>], a: &Vector3<f64>, b: &Vector3<f64>) -> f64 {
    springs.iter().map(|spring| spring.dot(a) * spring.dot(b)).sum()
}

/// Springs with their independent directions, for the shortest solutions of Σ sᵢ fᵢ = b.
pub(crate) struct Strains<'a> {
    springs: &'a [Vector3<f64>],
    /// Directions that strain some spring, and the squares of their singular values.
    held: Vec<(Vector3<f64>, f64)>,
}

impl<'a> Strains<'a> {
    /// A direction that strains the springs by less than `tolerance` of the most strained one
    /// does not count.
    pub fn new(springs: &'a [Vector3<f64>], tolerance: f64) -> Self {
        let directions = orthogonal_strains(springs, Matrix3::identity());
        let squared = |u: Vector3<f64>| (u, work(springs, &u, &u));
        let mut held: Vec<_> = directions.column_iter().map(|u| squared(u.into_owned())).collect();
        let most = held.iter().map(|(_, square)| *square).fold(0.0, f64::max);
        held.retain(|(_, square)| *square > tolerance * tolerance * most);
        Self { springs, held }
    }

    /// Number of independent directions.
    pub fn rank(&self) -> usize {
        self.held.len()
    }

    /// The shortest f with Σ sᵢ fᵢ nearest to b.
    pub fn solve(&self, b: &Vector3<f64>) -> Vec<f64> {
        let part = |(u, square): &(Vector3<f64>, f64)| u * (u.dot(b) / square);
        let pull: Vector3<f64> = self.held.iter().map(part).sum();
        self.springs.iter().map(|spring| spring.dot(&pull)).collect()
    }
}
