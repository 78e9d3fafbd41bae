//! The Bayes risk of weighted photographs: convex in the weights.

use nalgebra::DVector;
use rayon::prelude::*;

use crate::lab::error::LabError;
use crate::lab::studies::sensitivity::joined;
use crate::matrix::Matrix;
use crate::num::linalg::{Cholesky, gram_product, product, svd, tr_product};

/// Candidates that are summed together.
const TOGETHER: usize = 32;

/// Candidates, as far as the picture goes.
///
/// Unknowns are coordinates z ~ N(0, 1): the picture is ρ = ½ + L z, K = L Lᵀ; parameters of the
/// geometry follow it, z_k = θ_k/σ_k. A candidate s adds the information H_s = R_sᵀR_s, and
///
/// > risk(w) = tr (B A⁻¹ Bᵀ)/tr K,   A = 1 + Σ_s w_s H_s,   B = \[L, 0\]:
///
/// the share of the picture's variance that is left. It is convex in w, since the inverse of a
/// matrix is (Pukelsheim 1993), and its slopes are −g_s, g_s = tr (B A⁻¹ H_s A⁻¹ Bᵀ)/tr K.
///
/// Information spans far more than the sixteen digits of its entries. Everything is therefore
/// turned to the right singular vectors V of all R_s together: there H_s is graded, its rounding is
/// that of √(H_ii H_jj), and Cholesky's factor of A loses nothing by the grades (Demmel 1989).
#[derive(Clone, Debug)]
pub(super) struct Design {
    /// V, n × n.
    basis: Matrix,
    /// H_s in the basis.
    information: Vec<Matrix>,
    /// B in the basis, r × n.
    picture: Matrix,
    /// tr K.
    before: f64,
}

/// What a layout leaves, by the singular values of all of its photographs together.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Left {
    /// Share of the picture's variance.
    pub risk: f64,
    /// Directions of all unknowns whose signal is above the noise.
    pub directions: usize,
}

/// B = \[L, 0\], r × n.
fn picture(factor: &Matrix, n: usize) -> Matrix {
    let mut picture = Matrix::zeros(factor.nrows(), n);
    picture.columns_mut(0, factor.ncols()).copy_from(factor);
    picture
}

/// What photographs with these triangles leave: with R = U S Vᵀ of all together
///
/// > risk = Σ_i |B v_i|²/(1 + s_i²)/tr K.
///
/// # Errors
/// [`LabError::Linalg`].
pub(super) fn left(triangles: Vec<Matrix>, factor: &Matrix) -> Result<Left, LabError> {
    let found = svd(&square(joined(triangles)?))?;
    let seen = picture(factor, found.vt.ncols()) * found.vt.transpose();
    let kept = seen.column_iter().zip(found.sigma.iter());
    let kept = kept.map(|(v, s)| v.norm_squared() / (1.0 + s * s));
    Ok(Left {
        risk: kept.sum::<f64>() / factor.norm_squared(),
        directions: found.sigma.iter().filter(|s| **s > 1.0).count(),
    })
}

/// The same with rows of zeros, up to as many as columns: a decomposition then leaves no direction
/// out.
fn square(triangle: Matrix) -> Matrix {
    let n = triangle.nrows().max(triangle.ncols());
    triangle.resize_vertically(n, 0.0)
}

impl Design {
    /// Of candidates with these triangles, each of n columns.
    ///
    /// # Errors
    /// [`LabError::Linalg`].
    pub(super) fn new(triangles: &[Matrix], factor: &Matrix) -> Result<Self, LabError> {
        let all = square(joined(triangles.to_vec())?);
        let n = all.ncols();
        let basis = svd(&all)?.vt.transpose();
        let mut design = Self {
            information: Vec::new(),
            picture: product(&picture(factor, n), &basis),
            before: factor.norm_squared(),
            basis,
        };
        let of = |r: &Matrix| design.information_of(r);
        design.information = triangles.par_iter().map(of).collect();
        Ok(design)
    }

    /// H = RᵀR in the basis.
    pub(super) fn information_of(&self, triangle: &Matrix) -> Matrix {
        let n = self.basis.ncols();
        let mut h = Matrix::zeros(n, n);
        gram_product(&mut h, &product(triangle, &self.basis));
        h
    }

    /// H_s of each candidate, in the basis.
    pub(super) fn candidates(&self) -> &[Matrix] {
        &self.information
    }

    /// A = 1 + Σ_s w_s H_s.
    pub(super) fn weighted(&self, weights: &[f64]) -> Matrix {
        let n = self.basis.ncols();
        let add = |mut sum: Matrix, (h, w): (&Matrix, &f64)| {
            if *w > 0.0 {
                sum.zip_apply(h, |sum, h| *sum += w * h);
            }
            sum
        };
        let some = |(h, w): (&[Matrix], &[f64])| h.iter().zip(w).fold(Matrix::zeros(n, n), add);
        let parts = self.information.par_chunks(TOGETHER);
        let sums: Vec<Matrix> = parts.zip(weights.par_chunks(TOGETHER)).map(some).collect();
        sums.iter()
            .fold(Matrix::identity(n, n), |sum, part| sum + part)
    }

    /// A of photographs with this information.
    pub(super) fn of<'a>(&self, all: impl Iterator<Item = &'a Matrix>) -> Matrix {
        let n = self.basis.ncols();
        all.fold(Matrix::identity(n, n), |sum, h| sum + h)
    }

    /// tr (B A⁻¹ Bᵀ)/tr K.
    ///
    /// # Errors
    /// [`LabError::Unsuited`] where A is beyond the range of numbers.
    pub(super) fn risk(&self, a: &Matrix) -> Result<f64, LabError> {
        let left = factor(a)?.forward(self.picture.transpose());
        Ok(left.norm_squared() / self.before)
    }

    /// g_s of each candidate at A.
    ///
    /// # Errors
    /// Those of [`Self::risk`].
    pub(super) fn gains(&self, a: &Matrix) -> Result<Vec<f64>, LabError> {
        let factor = factor(a)?;
        let mut y = self.picture.clone();
        for mut row in y.row_iter_mut() {
            let solved = factor.solve(&DVector::from_iterator(row.ncols(), row.iter().copied()));
            row.copy_from(&solved.transpose());
        }
        let x = tr_product(&y, &y);
        let of = |h: &Matrix| h.dot(&x) / self.before;
        Ok(self.information.par_iter().map(of).collect())
    }
}

fn factor(a: &Matrix) -> Result<Cholesky, LabError> {
    Cholesky::new(a).ok_or(LabError::Unsuited(
        "what the photographs say spans more than numbers hold; use a larger --level",
    ))
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::num::stream::{Key, Sampling, Stream};

    /// Triangles of `all` candidates of n unknowns and `rows` rows, whose directions differ in size
    /// by `grade` each.
    pub(in crate::lab::studies::layout) fn triangles(
        all: usize,
        (rows, n): (usize, usize),
        grade: f64,
    ) -> Vec<Matrix> {
        let one = |s: usize| {
            let key = Key {
                seed: 5,
                spot: s as u32,
                pixel: 0,
                block: 0,
            };
            let mut stream = Stream::new(Sampling::Pcg, key);
            Matrix::from_fn(rows, n, |_, k| {
                (stream.uniform() - 0.3) * libm::pow(grade, k as f64)
            })
        };
        (0..all).map(one).collect()
    }

    /// L of a prior that ties neighbours.
    pub(in crate::lab::studies::layout) fn tied(n: usize) -> Matrix {
        let k = Matrix::from_fn(n, n, |i, j| 0.25 * libm::pow(0.5, i.abs_diff(j) as f64));
        Cholesky::new(&k).unwrap().lower().clone()
    }

    /// One element of K = τ² and triangles h_s: risk = 1/(1 + τ² Σ h_s²), where R_s = h_s τ.
    #[test]
    fn one_element_in_closed_form() {
        let tau = 0.5;
        let h = [0.3, 2.0, 1e7];
        let all = h.map(|h| Matrix::from_element(1, 1, h * tau));
        let factor = Matrix::from_element(1, 1, tau);
        let design = Design::new(&all, &factor).unwrap();
        for some in [vec![0], vec![0, 1], vec![0, 1, 2]] {
            let information: f64 = some.iter().map(|s: &usize| h[*s] * h[*s]).sum();
            let want = 1.0 / (1.0 + tau * tau * information);
            let a = design.of(some.iter().map(|s| &design.candidates()[*s]));
            assert!((design.risk(&a).unwrap() / want - 1.0).abs() < 1e-12);
            let chosen = some.iter().map(|s| all[*s].clone()).collect();
            let left = left(chosen, &factor).unwrap();
            assert!((left.risk - want).abs() < 1e-15, "{left:?}");
        }
    }

    /// Directions from 1e8 to 1e-3 standard deviations of noise, information over 22 decades: the
    /// risk by Cholesky's factor is that by the singular values of the photographs.
    #[test]
    fn information_over_many_decades_keeps_its_digits() {
        let n = 12;
        let turn = |r: &Matrix| {
            // A basis in which no unknown is a direction: Householder's for the vector of ones.
            let ones = DVector::from_element(n, 1.0);
            r - (r * &ones) * ones.transpose() * (2.0 / n as f64)
        };
        let all: Vec<Matrix> = triangles(9, (n, n), 0.1)
            .iter()
            .map(|r| turn(r) * 1e8)
            .collect();
        let factor = tied(n);
        let design = Design::new(&all, &factor).unwrap();
        let chosen = [1, 4, 6];
        let risk = design.risk(&design.of(chosen.iter().map(|s| &design.candidates()[*s])));
        let left = left(chosen.iter().map(|s| all[*s].clone()).collect(), &factor).unwrap();
        let risk = risk.unwrap();
        assert!((0.01..0.5).contains(&risk), "{risk}");
        assert!((risk / left.risk - 1.0).abs() < 1e-6, "{risk} {left:?}");
        // Without the turn to singular vectors rounding of 1e16 is as large as the prior.
        let naive = chosen.iter().fold(Matrix::identity(n, n), |sum, s| {
            sum + all[*s].transpose() * &all[*s]
        });
        let naive = Cholesky::new(&naive)
            .map(|c| c.forward(factor.transpose()).norm_squared() / factor.norm_squared());
        assert!(naive.is_none_or(|naive| (naive / left.risk - 1.0).abs() > 1e-6));
    }

    /// g_s against central differences of the risk, with an unknown that is no part of the picture.
    #[test]
    fn slopes_are_those_of_the_risk() {
        let all = triangles(6, (3, 5), 0.5);
        let design = Design::new(&all, &tied(4)).unwrap();
        let weights = [0.2, 0.9, 0.4, 0.0, 0.7, 0.3];
        let gains = design.gains(&design.weighted(&weights)).unwrap();
        for s in [0, 1, 5] {
            let at = |step: f64| {
                let mut moved = weights;
                moved[s] += step;
                design.risk(&design.weighted(&moved)).unwrap()
            };
            let slope = (at(-1e-5) - at(1e-5)) / 2e-5;
            assert!(
                (gains[s] / slope - 1.0).abs() < 1e-7,
                "{s}: {} {slope}",
                gains[s]
            );
        }
    }

    /// What is unsure costs: with θ free, as much as where its direction is taken out of the
    /// photographs; known exactly, nothing.
    #[test]
    fn an_unsure_geometry_costs_its_direction() {
        let one = triangles(1, (7, 4), 1.0).remove(0);
        let (picture, slope) = (one.columns(0, 3).into_owned(), one.column(3).into_owned());
        let factor = tied(3);
        let of = |deviation: f64| {
            let mut all = Matrix::zeros(7, 4);
            all.columns_mut(0, 3).copy_from(&picture);
            all.column_mut(3).copy_from(&(&slope * deviation));
            left(vec![all], &factor).unwrap().risk
        };
        let along = slope.normalize();
        let without = &picture - &along * (along.transpose() * &picture);
        let known = left(vec![picture.clone()], &factor).unwrap().risk;
        let lost = left(vec![without], &factor).unwrap().risk;
        assert!((of(0.0) - known).abs() < 1e-12);
        assert!((of(1e6) - lost).abs() < 1e-9 && lost > known);
    }
}
