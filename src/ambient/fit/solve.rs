//! Conjugate gradients (Magnus Hestenes and Eduard Stiefel, 1952), divided by the diagonal.

use super::folds::Fold;
use super::pieces::Pieces;

/// The residual, against the right side, at which values as `f32` do not change any more: half a step of
/// 2⁻²⁴, and 2⁸ for the condition of the matrix.
const ENOUGH: f64 = 1.0 / (1_u64 << 32) as f64;

/// The matrix is that of masses, whose condition does not depend on the mesh, and a little more: some tens
/// of steps.
const MOST_STEPS: usize = 500;

/// Solves (M + R) x = `right` from a first x. One thread, in a fixed order: the result is the same
/// everywhere.
pub(super) fn solve(cut: &Pieces<'_>, folds: &[Fold], right: &[f64], x: &mut [f64]) {
    let diagonal = diagonal(cut, folds);
    let mut product = vec![0.0; x.len()];
    times(cut, folds, x, &mut product);
    let mut rest: Vec<f64> = right.iter().zip(&product).map(|(b, product)| b - product).collect();
    let scaled = |rest: &[f64]| -> Vec<f64> {
        rest.iter().zip(&diagonal).map(|(r, d)| if *d > 0.0 { r / d } else { 0.0 }).collect()
    };
    let limit = ENOUGH * ENOUGH * dot(right, &scaled(right));
    let mut step = scaled(&rest);
    let mut size = dot(&rest, &step);
    for _ in 0..MOST_STEPS {
        times(cut, folds, &step, &mut product);
        let bend = dot(&step, &product);
        if size <= limit || bend <= 0.0 {
            break;
        }
        let length = size / bend;
        for i in 0..x.len() {
            x[i] += length * step[i];
            rest[i] -= length * product[i];
        }
        let next = scaled(&rest);
        let next_size = dot(&rest, &next);
        for (step, next) in step.iter_mut().zip(next) {
            *step = next + next_size / size * *step;
        }
        size = next_size;
    }
}

/// (M + R) x. The hat functions of a face with the area a have the integrals a/6 with themselves, and a/12
/// with each other.
fn times(cut: &Pieces<'_>, folds: &[Fold], x: &[f64], product: &mut [f64]) {
    product.fill(0.0);
    for (face, corners) in cut.faces() {
        let part = cut.area(face) / 12.0;
        let sum: f64 = corners.iter().map(|&corner| x[corner as usize]).sum();
        for corner in corners.map(|corner| corner as usize) {
            product[corner] += part * (sum + x[corner]);
        }
    }
    for fold in folds {
        let folded = fold.weight * fold.of(x);
        for (&corner, share) in fold.corners.iter().zip(fold.shares) {
            product[corner as usize] += share * folded;
        }
    }
}

fn diagonal(cut: &Pieces<'_>, folds: &[Fold]) -> Vec<f64> {
    let mut diagonal = vec![0.0; cut.receivers()];
    for (face, corners) in cut.faces() {
        corners.iter().for_each(|&corner| diagonal[corner as usize] += cut.area(face) / 6.0);
    }
    for fold in folds {
        for (&corner, share) in fold.corners.iter().zip(fold.shares) {
            diagonal[corner as usize] += fold.weight * share * share;
        }
    }
    diagonal
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
