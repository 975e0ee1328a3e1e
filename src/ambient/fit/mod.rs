//! Values of receivers that fit what is inside faces, not at their corners alone (Ladislav Kavan, Adam W.
//! Bargteil and Peter-Pike Sloan, *Least Squares Vertex Baking*, 2011).
//!
//! A viewer draws values linearly over each face. The fit is the piecewise linear function x that is nearest
//! to the openness f inside faces: it makes ∫ (x − f)² least, plus a small share of how much x folds at each
//! edge between two faces. Where x is zero in its derivative this is (M + R) x = b, with M the mass matrix of
//! the hat functions φ, b = ∫ f φ, and R the folds. A function that is linear over a plane does not fold, and
//! is found again exactly.

mod folds;
mod pieces;
mod solve;
#[cfg(test)]
mod tests;

use super::{Receiver, Receivers};
use crate::mesh::FaceId;
use folds::Fold;
use pieces::{Pieces, Point};

/// How far values, drawn linearly over faces, are from the openness inside them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InsideError {
    /// The face with the largest error, among those of all meshes in sequence.
    pub face: FaceId,
    /// The largest error.
    pub error: f64,
    /// The mean error over the area of all faces.
    pub mean: f64,
    /// The number of points inside faces that were asked about.
    pub samples: u64,
}

/// The share of the folds. Enough to spread the noise of few rays over neighbors, and too little to blur.
const FOLDS: f64 = 0.02;

/// The most points inside faces that can be asked for, beside those of the least number a face.
pub const MOST_INSIDE: u32 = 1 << 24;

/// Works out the openness of some receivers.
pub type Ask<'a> = &'a mut dyn FnMut(&Receivers) -> Vec<f32>;

impl Receivers {
    /// The values that fit the openness inside faces best, from 0 to 1. `known` has a value for each
    /// receiver; it is where the search begins, and stays where a receiver has no face with an area. `ask`
    /// gives the openness of further receivers, inside faces: three for each of some `pieces` triangles of
    /// even size that faces are cut into; a small face is one piece. They come in lots of at most 65,536.
    ///
    /// For receivers per vertex or per corner. Memory: about 100 bytes a face, and one lot.
    ///
    /// ```
    /// use umbrage::ambient::{Per, Receivers};
    /// use umbrage::testing::shapes;
    /// let floor = Receivers::of(&[&shapes::sheet(2)], Per::Vertex);
    /// let known = vec![0.0; floor.list().len()];
    /// let fit = floor.fit(&known, 100, &mut |inside| {
    ///     inside.list().iter().map(|receiver| 0.5 + 0.25 * receiver.point[0]).collect()
    /// });
    /// let at = floor.list().iter().map(|receiver| 0.5 + 0.25 * receiver.point[0]);
    /// assert!(at.zip(fit).all(|(at, fit)| (at - fit).abs() <= 8.0 * f32::EPSILON));
    /// ```
    #[must_use]
    pub fn fit(&self, known: &[f32], pieces: u32, ask: Ask<'_>) -> Vec<f32> {
        let cut = Pieces::of(self, pieces);
        let weight = |face, points| cut.area(face) / points;
        fit_with(&cut, known, FOLDS, &weight, ask)
    }

    /// How far `values` of the receivers are from the openness inside faces, at the middle of each of some
    /// `pieces` triangles as for [`Receivers::fit`]. `None` without faces.
    ///
    /// ```
    /// use umbrage::ambient::{Per, Receivers};
    /// use umbrage::testing::shapes;
    /// let floor = Receivers::of(&[&shapes::sheet(1)], Per::Vertex);
    /// let dark = vec![0.0; floor.list().len()];
    /// let found = floor.inside_error(&dark, 50, &mut |inside| vec![0.25; inside.list().len()]).unwrap();
    /// assert_eq!((found.error, found.mean as f32), (0.25, 0.25)); // the mean is a sum over all triangles
    /// ```
    #[must_use]
    pub fn inside_error(&self, values: &[f32], pieces: u32, ask: Ask<'_>) -> Option<InsideError> {
        let cut = Pieces::of(self, pieces);
        let (mut worst, mut sum, mut samples): (Option<(FaceId, f64)>, f64, u64) = (None, 0.0, 0);
        cut.each(&pieces::MIDDLE, ask, &mut |point, open| {
            let drawn: f64 = (0..3).map(|i| point.at[i] * f64::from(values[point.corners[i] as usize])).sum();
            let error = (drawn - f64::from(open)).abs();
            if worst.is_none_or(|(_, most)| error > most) {
                worst = Some((point.face, error));
            }
            sum += error * cut.area(point.face) / point.points;
            samples += 1;
        });
        let whole = if cut.whole() > 0.0 { cut.whole() } else { 1.0 };
        worst.map(|(face, error)| InsideError { face, error, mean: sum / whole, samples })
    }
}

/// `folds` is the weight of the folds; `weight` gives that of a point, from its face and the points per face.
fn fit_with(
    cut: &Pieces<'_>,
    known: &[f32],
    folds: f64,
    weight: &dyn Fn(FaceId, f64) -> f64,
    ask: Ask<'_>,
) -> Vec<f32> {
    let mut right = vec![0.0; known.len()];
    cut.each(&pieces::EXACT, ask, &mut |point: &Point, open| {
        for (corner, at) in point.corners.iter().zip(point.at) {
            right[*corner as usize] += weight(point.face, point.points) * at * f64::from(open);
        }
    });
    let mut x: Vec<f64> = known.iter().map(|&open| f64::from(open)).collect();
    solve::solve(cut, &Fold::all(cut, folds), &right, &mut x);
    x.into_iter().map(|open| open.clamp(0.0, 1.0) as f32).collect()
}
